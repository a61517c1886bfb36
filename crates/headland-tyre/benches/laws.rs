//! Time of one evaluation of each law, for numbers and for dual numbers.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use headland_expr::{Dual, Field, Scalar, Spline};
use headland_tyre::road::Part;
use headland_tyre::{
    Brake, Brush, Draught, Engine, KnownSoil, Linear, Motion, Pac2002, RandomRoad, Relaxation, Road, Roughness, Slip,
    SlipLaw, SoftWheel, Stiffness, TMeasy, Vertical,
};

const PAC: &str = "[UNITS]\nLENGTH='meter'\nFORCE='newton'\nANGLE='radians'\nMASS='kg'\nTIME='second'\n\
    [DIMENSION]\nUNLOADED_RADIUS=0.5\n[VERTICAL]\nFNOMIN=30000\nVERTICAL_STIFFNESS=8e5\n\
    [LONGITUDINAL_COEFFICIENTS]\nPCX1=1.7\nPDX1=0.8\nPKX1=15\nRBX1=11\nRBX2=-12\nRCX1=1\n\
    [LATERAL_COEFFICIENTS]\nPCY1=1.6\nPDY1=0.8\nPKY1=-10\nPKY2=3\nRBY1=13\nRBY2=5\nRCY1=1\nRVY1=0.01\nRVY5=2\nRVY6=-8\n\
    [ALIGNING_COEFFICIENTS]\nQBZ1=6\nQCZ1=1.5\nQDZ1=0.09\nQBZ9=10\n[ROLLING_COEFFICIENTS]\nQSY1=0.01\n";

fn laws<S: Scalar + 'static>(c: &mut Criterion, kind: &str, seed: impl Fn(f64) -> S) {
    let num = S::constant;
    let mut group = c.benchmark_group(kind);
    let pac = Pac2002::parse(PAC).expect("a tyre");
    let brush = Brush {
        longitudinal: num(2e5),
        cornering: num(1.2e5),
        camber: num(1e4),
        friction: num(0.8),
        half_length: num(0.1),
        load: num(2e4),
        proportional: true,
    };
    let linear = Linear { longitudinal: num(2e5), cornering: num(1e5), camber: num(0.0), trail: num(0.05), load: None };
    let tmeasy = TMeasy::truck(num(2e4), num(0.24), num(0.5));
    let slip = Slip { camber: num(0.02), ..Slip::forward(seed(0.03), seed(-0.04)) };
    let load = seed(2.1e4);
    group.bench_function("linear", |b| b.iter(|| linear.forces(black_box(load), num(1.0), black_box(&slip))));
    group.bench_function("brush", |b| b.iter(|| brush.forces(black_box(load), num(1.0), black_box(&slip))));
    group.bench_function("tmeasy", |b| b.iter(|| tmeasy.forces(black_box(load), num(1.0), black_box(&slip))));
    group.bench_function("pac2002", |b| b.iter(|| pac.forces(black_box(load), num(1.0), black_box(&slip))));

    let vertical = Vertical {
        spring: Stiffness::Power { load: num(2e4), deflection: num(0.05), exponent: num(1.2) },
        damping: num(2e3),
        onset: num(1e-3),
    };
    group.bench_function("vertical_power", |b| b.iter(|| vertical.load(black_box(seed(0.04)), seed(0.1))));
    let motion = Motion {
        forward: seed(0.4),
        slip_x: seed(0.1),
        slip_y: seed(0.2),
        spin: seed(1.0),
        camber: num(0.0),
        turn: num(0.0),
    };
    let relaxation = Relaxation {
        length: [num(0.3), num(0.5)],
        low_speed: num(1.0),
        damping: [num(1e3), num(1e3)],
        limit: [num(0.5), num(0.5)],
    };
    group.bench_function("relaxation", |b| {
        b.iter(|| relaxation.rates(black_box([seed(0.1), seed(0.2)]), black_box(&motion)));
    });
    let soil = KnownSoil::named("lete_sand").expect("a soil").soil().expect("complete");
    let wheel = SoftWheel { soil, radius: num(0.6), width: num(0.4) };
    group.bench_function("soft_wheel", |b| b.iter(|| wheel.forces(black_box(seed(0.05)), seed(0.2))));
    let full_load = Spline::new("engine", &[80.0, 150.0, 220.0], &[500.0, 600.0, 450.0]).expect("a table");
    let engine = Engine { full_load, drag: num(60.0), rated: num(220.0) };
    group.bench_function("engine", |b| b.iter(|| engine.torque(black_box(seed(180.0)), seed(0.7))));
    let brake = Brake { windup: num(1e-3), damping: num(0.02), fade: num(0.1) };
    group.bench_function("brake", |b| b.iter(|| brake.torque(num(1e3), black_box(seed(0.3)), seed(0.7))));
    let [f, a, bb, cc, w, creep, depth] = [0.7, 600.0, 2.0, 5.0, 1.5, 1e-3, 0.3].map(num);
    let tool = Draught { soil: f, constant: a, linear: bb, quadratic: cc, width: w, creep, depth };
    group.bench_function("draught", |b| b.iter(|| tool.force(black_box(seed(2.0)), seed(0.2))));
    group.finish();
}

fn every(c: &mut Criterion) {
    laws::<f64>(c, "f64", |x| x);
    laws::<Dual<f64>>(c, "dual", |x| Dual::new(x, 1.0));
    let rough = RandomRoad::new(&Roughness::of_class('C', 1).expect("a class")).expect("in range");
    let road = Road::new("road", vec![Part::Random(rough)]).expect("in range");
    let mut out = [0.0; 20];
    for order in [0, 2, 3] {
        c.bench_function(&format!("road_256_waves_order_{order}"), |b| {
            b.iter(|| road.eval(black_box([12.3, 0.9, 0.0]), order, &mut out));
        });
    }
}

criterion_group!(benches, every);
criterion_main!(benches);
