//! Compliant contact: closed forms, convergence to the rolling ball, exact Jacobians, corners, stiff contacts.

mod common;

use std::rc::Rc;

use common::{build, done, read, set};
use headland_contact::restitution;
use headland_dynamics::{DeriveOptions, derive};
use headland_model::{Model, Scene};
use headland_sim::{Problem, Run, System};
use headland_solve::OdeProblem;

const RECESS: &str = include_str!("../../../models/ball_in_recess_compliant.toml");

/// A ball of 1 kg and 0.1 m over the plane z = 0.
fn ball(contact: &str, initial: &str, columns: &str, until: f64) -> Model {
    let text = format!(
        "[parameters]\nr = \"0.1 m\"\n[world]\ngravity = [0, 0, \"-9.81 m/s^2\"]\n\
         [[body]]\nname = \"b\"\nmass = 1\nshape = \"sphere\"\nsize = [\"r\"]\n\
         [[contact]]\nname = \"c\"\nbody = \"b\"\nradius = \"r\"\n{contact}\n\
         [initial]\n{initial}\n[outputs]\ncolumns = [{columns}]\n[run]\nuntil = {until}\npoints = 100\n"
    );
    build(&read(&text))
}

fn last(run: &Run) -> &[f64] {
    run.trajectory.rows.last().unwrap_or_else(|| panic!("no rows"))
}

/// Largest distance of the first three columns in all rows.
fn apart(a: &Run, b: &Run) -> f64 {
    assert_eq!(a.trajectory.rows.len(), b.trajectory.rows.len());
    let rows = a.trajectory.rows.iter().zip(&b.trajectory.rows);
    let distance = |(a, b): (&Vec<f64>, &Vec<f64>)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    rows.map(distance).fold(0.0, f64::max)
}

fn balanced(run: &Run, limit: f64) {
    let defect = run.report.energy_balance.unwrap_or(f64::NAN);
    assert!(defect < limit, "work and energy disagree by {defect:e}");
}

#[test]
fn a_ball_that_falls_bounces_as_hunt_and_crossley_say() {
    for method in ["dop853", "cvode-bdf", "cvode-adams"] {
        for (exponent, damping) in [(1.0, 0.0), (1.0, 0.3), (1.5, 0.1), (1.5, 2.0)] {
            // without gravity nothing but the law is left
            let contact = format!("stiffness = 1e7\nexponent = {exponent}\ndamping = {damping}\nfriction = 0");
            let model = ball(&contact, "\"b.z\" = 0.5\n\"b.z'\" = -2", "\"b.vz\", \"b.z\", \"c.normal\"", 0.3);
            let text = model.source.text.replace("-9.81 m/s^2", "0 m/s^2");
            let run = done(&build(&read(&text)), |o| (o.method, o.tolerance) = (method.into(), 1e-10));
            let expected = 2.0 * restitution(damping, 2.0);
            let found = last(&run)[0];
            println!("{method} {exponent} {damping}: {:e}", found / expected - 1.0);
            assert!(
                (found / expected - 1.0).abs() < if method == "dop853" { 1e-9 } else { 1e-7 },
                "{found} {expected}"
            );
            assert!(run.report.events >= 2, "it touches and parts");
            balanced(&run, if method == "dop853" { 2e-9 } else { 2e-7 }); // energy goes with the speed squared
        }
    }
}

/// A linear spring under a ball of mass m: `δ = g/ω² (1 − cos ωt) + v/ω sin ωt`, as long as it touches.
#[test]
fn a_linear_spring_is_an_oscillator() {
    let model =
        ball("stiffness = 1e4\nfriction = 0", "\"b.z\" = 0.1\n\"b.z'\" = -0.01", "\"c.gap\", \"c.normal\"", 0.05);
    let run = done(&model, |o| (o.method, o.tolerance) = ("dop853".into(), 1e-12));
    for (row, t) in run.trajectory.rows.iter().zip(&run.trajectory.t) {
        let (w, g, v) = (100.0, 9.81, 0.01);
        let depth = g / (w * w) * (1.0 - (w * t).cos()) + v / w * (w * t).sin();
        if depth > 0.0 {
            assert!((row[0] + depth).abs() < 1e-12, "{t}: {:e}", row[0] + depth);
            assert!((row[1] - 1e4 * depth).abs() < 1e-8);
        }
    }
}

/// A rolling ball slows down by `b g/(r (1 + 2/5))`, a spinning one by `d m g/I`.
#[test]
fn resistances_brake_as_their_levers_say() {
    let depth = 9.81 / 1e6;
    let contact =
        "stiffness = 1e6\nfriction = 0.5\nslip_speed = 1e-5\nrolling_resistance = 2e-3\nspinning_resistance = 1e-4";
    let initial = format!("\"b.z\" = {:?}\n\"b.x'\" = 1\n\"b.wy\" = 10\n\"b.wz\" = 30", 0.1 - depth);
    let model = ball(contact, &initial, "\"b.vx\", \"b.omega_z\", \"c.torque\"", 1.0);
    let run = done(&model, |o| (o.method, o.tolerance) = ("cvode-bdf".into(), 1e-11));
    let (v, w) = (1.0 - 2e-3 * 9.81 / (0.1 * 1.4), 30.0 - 1e-4 * 9.81 / 0.004);
    println!("{:?} for {v}, {w}", last(&run));
    assert!((last(&run)[0] - v).abs() < 3e-5, "{:?} for {v}", last(&run)); // it creeps, 1e-5 m/s
    assert!((last(&run)[1] - w).abs() < 1e-6, "{:?} for {w}", last(&run));
    assert!((last(&run)[2] - 9.81 * 2e-3_f64.hypot(1e-4)).abs() < 1e-6);
    balanced(&run, 1e-6);
}

/// Pure spin about a horizontal axis: it rolls with `v = 2 w r/7` from `t = 2 w r/(7 μ g)` on.
#[test]
fn a_spinning_ball_comes_to_roll() {
    for speed in [1e-3, 1e-4] {
        let contact = format!("stiffness = 1e6\nfriction = 0.3\nslip_speed = {speed}");
        let initial = format!("\"b.z\" = {:?}\n\"b.wy\" = 20", 0.1 - 9.81 / 1e6);
        let run = done(&ball(&contact, &initial, "\"b.vx\", \"c.used\", \"c.slip\"", 0.5), |o| o.tolerance = 1e-9);
        assert!((last(&run)[0] - 4.0 / 7.0).abs() < 1e-9, "{:?}", last(&run));
        assert!(last(&run)[1] < 1e-3 && last(&run)[2] < 1e-6);
        let rolls = 2.0 * 20.0 * 0.1 / (7.0 * 0.3 * 9.81);
        for (row, t) in run.trajectory.rows.iter().zip(&run.trajectory.t) {
            // before, all friction is used, and the slip falls with 7/2 μ g; after, it is gone at once
            let slip = 2.0 - 3.5 * 0.3 * 9.81 * t;
            if *t < rolls - 30.0 * speed {
                assert!((row[2] - slip).abs() < 2.0 * speed && row[1] > 0.99, "{t}: {row:?} for {slip}");
            } else if *t > rolls + 30.0 * speed {
                assert!(row[2] < speed && row[1] < 0.5, "{t}: {row:?}");
            }
        }
    }
}

/// The recess with the ball held by a constraint instead: no depth, no creep.
fn rolling() -> Scene {
    let mut text = RECESS.to_string();
    let from = text.find("stiffness = \"stiffness").unwrap_or_else(|| panic!("no stiffness"));
    let until = from + text[from..].find("[initial]").unwrap_or_else(|| panic!("no start"));
    text.replace_range(from..until, "\n");
    let text = text.replace("[[contact]]", "[[rolling]]").replace(" + depth", "");
    let outputs = text.find("    \"contact.gap").unwrap_or_else(|| panic!("no outputs"));
    let end = outputs + text[outputs..].find(']').unwrap_or_else(|| panic!("no end"));
    let end = end + text[end..].find("\n]").unwrap_or_else(|| panic!("no end"));
    let mut text = text;
    text.replace_range(outputs..end, "");
    read(&text)
}

/// As stiffness and 1/slip_speed grow together: like 1/k for a linear spring, like k^(−2/3) after Hertz.
#[test]
fn the_compliant_ball_goes_over_into_the_rolling_one() {
    let exact = done(&build(&rolling()), |o| (o.until, o.tolerance, o.method) = (2.0, 1e-12, "dop853".into()));
    for (exponent, order) in [("1", 1.0), ("1.5", 2.0 / 3.0)] {
        let mut errors: Vec<f64> = Vec::new();
        let stiffness = [1e4, 1e5, 1e6];
        for k in stiffness {
            let speed = if order == 1.0 { 1e3 / k } else { 0.1 * (1e4_f64 / k).powf(order) };
            let mut scene = read(RECESS);
            set(&mut scene, &[("exponent", exponent), ("stiffness", &format!("{k:?}"))]);
            set(&mut scene, &[("v_reg", &format!("{speed:?} m/s"))]);
            let run = done(&build(&scene), |o| (o.until, o.tolerance) = (2.0, 1e-9));
            balanced(&run, 1e-6);
            errors.push(apart(&run, &exact));
        }
        let fitted = (errors[0] / errors[2]).ln() / (stiffness[2] / stiffness[0]).ln();
        println!("exponent {exponent}: {errors:?}, order {fitted}");
        assert!((fitted - order).abs() < 0.01, "exponent {exponent}: {errors:?}, order {fitted}");
    }
}

#[test]
fn stiff_contacts_and_fast_spin_keep_the_tolerance() {
    for k in ["1e4", "1e6", "1e9"] {
        for (method, tolerance) in [("cvode-bdf", 1e-7), ("auto", 1e-7)] {
            let mut scene = read(RECESS);
            set(&mut scene, &[("stiffness", k), ("spin", "1000 rad/s")]);
            let model = build(&scene);
            let run = |tolerance| {
                done(&model, |o| (o.until, o.points, o.tolerance, o.method) = (0.1, 20, tolerance, method.into()))
            };
            let (loose, tight) = (run(tolerance), run(0.01 * tolerance));
            let error = apart(&loose, &tight);
            println!("{k} {method}: {error:e}");
            assert!(error < 10.0 * tolerance, "{k} {method}: {error:e}");
        }
    }
}

/// The Jacobian that CVODE gets, against central differences, pressed in and in flight.
#[test]
fn the_jacobian_is_exact() {
    let mut scene = read(RECESS);
    set(&mut scene, &[("rolling_resistance", "1 mm"), ("spinning_resistance", "0.1 mm"), ("v_reg", "0.1 m/s")]);
    for exponent in ["1", "1.5"] {
        set(&mut scene, &[("exponent", exponent), ("stiffness", "1e4")]);
        let model = build(&scene);
        let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        let system = Rc::new(System::new(&model, &equations));
        let n = system.len();
        let mut problem = Problem::new(system.clone(), true);
        let pattern = problem.pattern().cloned().unwrap_or_else(|| panic!("no pattern"));
        for k in 0..12 {
            let wave = |i: usize| (1.7 * i as f64 + 0.9 * f64::from(k)).sin();
            let mut y: Vec<f64> = (0..n).map(wave).collect();
            // the centre at 0.8 m but for a few millimetres, some states pressed in, some free
            let at = |name: &str| system.names.iter().position(|x| x == name).unwrap_or_else(|| panic!("{name}"));
            let centre = [at("ball.x"), at("ball.y"), at("ball.z")];
            let size = centre.iter().map(|&i| y[i] * y[i]).sum::<f64>().sqrt();
            let radius = 0.8 + if k % 3 == 0 { -0.003 } else { 0.002 };
            centre.iter().for_each(|&i| y[i] *= radius / size);
            let mut values = vec![0.0; pattern.nnz()];
            problem.jacobian(0.0, &y, &mut values).unwrap_or_else(|_| panic!("no Jacobian"));
            let mut found = vec![vec![0.0; n]; n];
            pattern.entries().zip(&values).for_each(|((i, j), value)| found[i][j] = *value);
            for j in 0..n {
                let h = 1e-6;
                let mut side = |h: f64| {
                    let (mut x, mut dy) = (y.clone(), vec![0.0; n]);
                    x[j] += h;
                    problem.rhs(0.0, &x, &mut dy).unwrap_or_else(|_| panic!("no rates"));
                    dy
                };
                let (a, b) = (side(h), side(-h));
                for i in 0..n {
                    let slope = (a[i] - b[i]) / (2.0 * h);
                    let row = found[i].iter().fold(1.0_f64, |m, x| m.max(x.abs()));
                    assert!((found[i][j] - slope).abs() < 1e-6 * row, "{k} [{i}, {j}]: {} for {slope}", found[i][j]);
                }
            }
        }
    }
}

/// A ball flies past a small sphere and only just touches it, far away from where it starts: in flight a method's step is
/// as long as the run, and the contact a short part of it.
#[test]
fn no_contact_is_jumped_over() {
    let text = "[[body]]\nname = \"b\"\nmass = 1\nshape = \"sphere\"\nsize = [0.01]\n\
                [[surface]]\nname = \"s\"\nshape = \"sphere\"\nradius = 0.05\n\
                [[contact]]\nname = \"c\"\nbody = \"b\"\non = \"s\"\nradius = 0.01\nstiffness = 1e4\nfriction = 0\n\
                [initial]\n\"b.x\" = -37.3\n\"b.z\" = 0.0595\n\"b.x'\" = 5\n\
                [outputs]\ncolumns = [\"b.z\", \"b.vz\", \"b.vx\"]\n[run]\nuntil = 20\n";
    let model = build(&read(text));
    let exact = done(&model, |o| (o.max_step, o.tolerance, o.method) = (1e-3, 1e-11, "dop853".into()));
    assert!(last(&exact)[1] > 5e-3, "it is thrown upward: {:?}", last(&exact));
    for method in ["auto", "dop853", "cvode-bdf", "cvode-adams"] {
        let run = done(&model, |o| (o.tolerance, o.method) = (1e-9, method.into()));
        println!("{method}: {} steps, vz {:?}", run.report.steps, last(&run)[1]);
        assert!((last(&run)[1] - last(&exact)[1]).abs() < 1e-7, "{method}: {:?}", last(&run));
        balanced(&run, 1e-6);
    }
    // a hard one throws it off where the gap closes: the normal velocity turns round
    let hard = text.replace("stiffness = 1e4", "restitution = 1");
    let (distance, height) = (0.06_f64, 0.0595_f64);
    let (sin, cos) = (height / distance, (1.0 - (height / distance).powi(2)).sqrt());
    for method in ["auto", "dop853", "cvode-bdf", "cvode-adams"] {
        let run = done(&build(&read(&hard)), |o| (o.tolerance, o.method) = (1e-9, method.into()));
        let thrown = 2.0 * 5.0 * cos * sin;
        println!("{method}: {} steps, vz {:?} for {thrown}", run.report.steps, last(&run)[1]);
        assert!((last(&run)[1] - thrown).abs() < 1e-6, "{method}: {:?} for {thrown}", last(&run));
    }
}

/// The surface's body feels the reaction: momentum and angular momentum of both together stay.
#[test]
fn forces_come_in_pairs() {
    let text = "[[body]]\nname = \"a\"\nmass = 3\ninertia = [1.1, 1.2, 1.3]\n\
                [[body]]\nname = \"b\"\nmass = 1\nshape = \"sphere\"\nsize = [0.2]\n\
                [[surface]]\nname = \"s\"\non = \"a\"\nat = [0.1, 0.05, 0.02]\nshape = \"sphere\"\nradius = 1\ninside = true\n\
                [[contact]]\nname = \"c\"\nbody = \"b\"\non = \"s\"\nradius = 0.2\nstiffness = 1e4\ndamping = 0.2\n\
                friction = 0.3\nrolling_resistance = 1e-3\nspinning_resistance = 1e-3\nslip_speed = 0.01\n\
                [initial]\n\"b.x\" = 0.2\n\"b.x'\" = 3\n\"b.y'\" = 1\n\"b.wz\" = 20\n\"a.wx\" = 1\n\
                [outputs]\ncolumns = [\"system.px\", \"system.py\", \"system.pz\", \"b.vx\"]\n[run]\nuntil = 5\n";
    let model = build(&read(text));
    let run = done(&model, |o| (o.method, o.tolerance) = ("dop853".into(), 1e-10));
    for row in &run.trajectory.rows {
        assert!((row[0] - 3.0).abs() < 1e-7 && (row[1] - 1.0).abs() < 1e-7 && row[2].abs() < 1e-7, "{row:?}");
    }
    assert!(run.report.events > 4, "it hits the recess again and again");
    balanced(&run, 1e-7);
}

#[test]
fn what_cannot_be_meant_is_told() {
    let base = "stiffness = 1e6\nfriction = 0.3";
    let wrong = [
        ("stiffness = 0\nfriction = 0.3", "`stiffness` is 0; it must be above 0"),
        ("stiffness = -1\nfriction = 0.3", "`stiffness` is -1; it must be above 0"),
        ("stiffness = 1e6\nfriction = -0.1", "`friction` is -0.1; it must be at least 0"),
        ("stiffness = 1e6\nfriction = 0.3\ndamping = -0.5", "`damping` is -0.5; it must be at least 0"),
        ("stiffness = 1e6\nfriction = 0.3\nexponent = 0.5", "it must be at least 1"),
        ("stiffness = 1e6\nfriction = 0.3\nslip_speed = 0", "`slip_speed` is 0; it must be above 0"),
        ("stiffness = 1e6\nfriction = 0.3\nrestitution = 0.5", "`restitution` means nothing here"),
        ("stiffness = 1e6\nfriction = 0.3\nstart = \"free\"", "`start` means nothing here"),
        ("stiffness = 1e6", "needs `friction`"),
        ("stiffness = 1e6\nfriction = 0.3\nstatic_friction = 0.4", "go together"),
        ("stiffness = 1e6\nfriction = 0.3\nstribeck_speed = 0.4", "go together"),
        ("stiffness = \"1e6 N/m^2\"\nfriction = 0.3", "`stiffness`"),
        ("friction = 0.3\ndamping = 0.5", "without `stiffness` the contact is hard"),
        ("stiffness = \"1e6[N/m]*(1 + t/1[s])\"\nfriction = 0.3", "made of numbers and parameters"),
    ];
    let text = |contact: &str, z: f64| {
        format!(
            "[[body]]\nname = \"b\"\nmass = 1\nshape = \"sphere\"\nsize = [0.1]\n\
             [[contact]]\nname = \"c\"\nbody = \"b\"\nradius = 0.1\n{contact}\n[initial]\n\"b.z\" = {z:?}\n"
        )
    };
    for (contact, expected) in wrong {
        match read(&text(contact, 0.2)).build() {
            Ok(_) => panic!("{contact}: no error"),
            Err(e) => assert!(e.to_string().contains(expected), "{contact}: {e}"),
        }
    }
    let deep = build(&read(&text(base, -0.05)));
    let error = headland_sim::run(&deep, &headland_sim::RunOptions::of(&deep), &mut headland_sim::Silent);
    match error {
        Ok(run) => panic!("a ball inside the ground: {:?}", run.report.status),
        Err(e) => assert!(e.to_string().contains("deeper inside the surface than its radius"), "{e}"),
    }
}
