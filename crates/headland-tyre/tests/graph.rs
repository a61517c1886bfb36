//! The laws as expressions: the same numbers as over `f64`, the same derivatives as over dual numbers, and all of them finite
//! where slip, speed or load vanish. In a graph both branches of a `select` are differentiated, so a guard that stands
//! after the operation shows here.

mod common;

use headland_expr::{Dual, Graph, NodeId, Scalar, Spline};
use headland_tyre::tmeasy::TMeasy;
use headland_tyre::{
    Brake, Brush, Draught, Engine, Governor, KnownSoil, Linear, Motion, Pac2002, Relaxation, Slip, SlipLaw, SoftWheel,
    Stiffness, Vertical,
};

/// A function of numbers, written over any scalar.
trait Formula {
    fn at<S: Scalar>(&self, x: &[S]) -> Vec<S>;
}

/// Holds the graph of `formula` against numbers and dual numbers at `points`.
fn hold(name: &str, formula: &impl Formula, points: &[Vec<f64>]) {
    let graph = Graph::new();
    let inputs: Vec<_> = (0..points[0].len()).map(|i| graph.input(&format!("x{i}"))).collect();
    let roots: Vec<NodeId> = formula.at(&inputs).into_iter().map(|y| graph.id(y)).collect();
    let ids: Vec<NodeId> = inputs.iter().map(|x| graph.id(*x)).collect();
    let jacobian = graph.jacobian(&roots, &ids);
    let entries: Vec<NodeId> = jacobian.iter().map(|(.., e)| graph.id(*e)).collect();
    for x in points {
        let values = graph.eval(&roots, x);
        let expected = formula.at(x);
        for (a, b) in values.iter().zip(&expected) {
            assert!((a - b).abs() <= 1e-10 * (1.0 + b.abs()), "{name} at {x:?}: {values:?} {expected:?}");
        }
        let found = graph.eval(&entries, x);
        for ((row, column, _), found) in jacobian.iter().zip(found) {
            let seeded: Vec<_> =
                x.iter().enumerate().map(|(i, x)| Dual::new(*x, if i == *column { 1.0 } else { 0.0 })).collect();
            let dot = formula.at(&seeded)[*row].dot;
            let close = (found - dot).abs() <= 1e-8 * (1.0 + dot.abs());
            assert!(close && found.is_finite(), "{name}: row {row}, column {column} at {x:?}: {found} {dot}");
        }
    }
}

/// All combinations of values, one list an input.
fn grid(lists: &[&[f64]]) -> Vec<Vec<f64>> {
    lists.iter().fold(vec![Vec::new()], |points, list| {
        let with = |p: &Vec<f64>, x: f64| p.iter().copied().chain([x]).collect();
        points.iter().flat_map(|p| list.iter().map(move |x| with(p, *x))).collect()
    })
}

enum Law {
    Linear,
    Brush,
    TMeasy,
    Pac(Box<Pac2002>),
}

impl Formula for Law {
    fn at<S: Scalar>(&self, x: &[S]) -> Vec<S> {
        let num = S::constant;
        let slip = Slip { kappa: x[1], tan_alpha: x[2], camber: x[3], speed: x[4], direction: x[4] / num(20.0) };
        let one = num(1.0);
        let f = match self {
            Self::Linear => Linear {
                longitudinal: num(2e5),
                cornering: num(1e5),
                camber: num(1e4),
                trail: num(0.05),
                load: Some(num(2e4)),
            }
            .forces(x[0], one, &slip),
            Self::Brush => Brush {
                longitudinal: num(2e5),
                cornering: num(1.2e5),
                camber: num(1e4),
                friction: num(0.8),
                half_length: num(0.1),
                load: num(2e4),
                proportional: true,
            }
            .forces(x[0], one, &slip),
            Self::TMeasy => TMeasy::truck(num(2e4), num(0.24), num(0.5)).forces(x[0], one, &slip),
            Self::Pac(tyre) => tyre.forces(x[0], one, &slip),
        };
        vec![f.fx, f.fy, f.mx, f.my, f.mz]
    }
}

#[test]
fn slip_laws() {
    let points = grid(&[
        &[0.0, 1.3e4, 5e4],
        &[-1.0, -0.07, 0.0, 0.02, 2.0],
        &[-0.6, 0.0, 0.03],
        &[0.0, 0.05],
        &[-3.0, 0.0, 12.0],
    ]);
    let mut laws = vec![("linear".to_string(), Law::Linear), ("brush".to_string(), Law::Brush)];
    laws.push(("tmeasy".to_string(), Law::TMeasy));
    for (name, text) in common::files() {
        let tyre = Pac2002::parse(&text).unwrap();
        // without shifts all slips vanish together
        let mut centred = tyre.clone();
        for key in "LHX LVX LHY LVY LKG QHZ1 QHZ2 QHZ3 QHZ4".split_whitespace() {
            assert!(centred.set_coefficient(key, 0.0));
        }
        laws.push((format!("{name}, centred"), Law::Pac(Box::new(centred))));
        laws.push((name, Law::Pac(Box::new(tyre))));
    }
    for (name, law) in &laws {
        hold(name, law, &points);
    }
}

struct Around;

impl Formula for Around {
    fn at<S: Scalar>(&self, x: &[S]) -> Vec<S> {
        let num = S::constant;
        let mut out = Vec::new();
        let power = Stiffness::Power { load: num(2e4), deflection: num(0.05), exponent: num(1.3) };
        for spring in [power, Stiffness::Linear { stiffness: num(3e5) }] {
            out.push(Vertical { spring, damping: num(1e3), onset: num(1e-3) }.load(x[0], x[1]));
        }
        let motion = Motion { forward: x[1], slip_x: x[2], slip_y: x[0], spin: x[2], camber: num(0.0), turn: num(0.0) };
        let r = Relaxation {
            length: [num(0.3), num(0.5)],
            low_speed: num(1.0),
            damping: [num(1e3), num(2e3)],
            limit: [num(0.5), num(0.7)],
        };
        out.extend(r.rates([x[0], x[2]], &motion));
        let slip = r.slip([x[0], x[2]], &motion, [x[0] * num(1e5), num(1e5)], num(0.1));
        out.extend([slip.kappa, slip.tan_alpha, slip.direction]);
        let slip = motion.slip(num(0.1));
        out.extend([slip.kappa, slip.tan_alpha, motion.turn_slip(num(0.1))]);
        let brake = Brake { windup: num(1e-3), damping: num(0.02), fade: num(0.1) };
        out.extend([brake.rate(x[1], x[2]), brake.torque(x[0], x[1], x[2])]);
        out.push(Governor { set: num(0.5), droop: num(0.1), lag: num(0.1) }.fuel(x[1]));
        let table = Spline::new("engine", &[-1.0, 0.0, 2.0], &[5.0, 6.0, 4.5]).unwrap();
        out.push(Engine { full_load: table, drag: num(1.0), rated: num(2.0) }.torque(x[1], x[2]));
        let [f, a, b, c, w, creep, depth] = [0.7, 600.0, 2.0, 5.0, 1.5, 1e-3, 0.3].map(num);
        let tool = Draught { soil: f, constant: a, linear: b, quadratic: c, width: w, creep, depth };
        out.push(tool.force(x[1], x[0]));
        let soil = KnownSoil::named("dry_sand").unwrap().soil().unwrap();
        let f = SoftWheel { soil, radius: num(0.6), width: num(0.4) }.forces(x[0], x[2]);
        out.extend([f.load, f.resistance, f.thrust, f.torque]);
        out
    }
}

#[test]
fn all_that_is_around_the_wheel() {
    hold("around", &Around, &grid(&[&[-0.1, 0.0, 0.03], &[-2.0, 0.0, 0.3, 0.53], &[-0.8, 0.0, 0.2]]));
}
