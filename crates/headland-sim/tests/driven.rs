//! Mechanisms of which every motion is given: no freedom is left, forces are found.

mod common;

use common::{read, run_with};
use headland_model::Model;
use headland_sim::{Run, Status};

const CRANK: &str = include_str!("../../../models/slider_crank.toml");

/// Amplitude and frequency of the unevenness of the drive.
const UNEVEN: (f64, f64) = (0.3, 100.0);

const COLUMNS: &str = "columns = [\"phi\", \"pin\", \"x\", \"x'\", \"x''\", \"phi.tz\", \"piston.fx\", \"piston.fy\"]";

/// The crank of the model, driven by the given text.
fn driven(drive: &str, columns: &str) -> Model {
    let text = CRANK.replace("phi = 0\n", "").replace("\"phi'\" = \"Omega\"\n", "");
    let (text, _) = text.split_once("[outputs]").unwrap_or_default();
    let text = format!("{text}[outputs]\n{columns}\n{drive}");
    read(&text).build().unwrap_or_else(|e| panic!("{e}"))
}

fn done(model: &Model, method: &str) -> Run {
    let run = run_with(model, |o| {
        o.method = method.into();
        o.tolerance = 1e-10;
        o.until = 0.1;
        o.points = 40;
    });
    assert_eq!(run.report.status, Status::Done);
    assert_eq!(run.report.degrees_of_freedom, 0);
    run
}

/// Angle of the rod, place of the slider and their rates; torque of the drive by Lagrange's equation; force of the rod on
/// the slider by Newton's and Euler's for the rod.
fn closed_form(t: f64) -> [f64; 8] {
    let (l1, l2, m2, m3, j1) = (0.15, 0.30, 0.151104, 0.075552, 0.002727);
    let jc = 0.0045339259 - m2 * l2 * l2 / 4.0;
    let (a, w) = UNEVEN;
    let phi = 150.0 * t + a * (w * t).sin();
    let (speed, rate) = (150.0 + a * w * (w * t).cos(), -a * w * w * (w * t).sin());
    let (s, c) = phi.sin_cos();
    // sin ψ = −k sin φ, by φ: ψ₁ cos ψ = −k cos φ, ψ₂ cos ψ − ψ₁² sin ψ = k sin φ, ..
    let k = l1 / l2;
    let sin_psi = -k * s;
    let cos_psi = (1.0 - sin_psi * sin_psi).sqrt();
    let p1 = -k * c / cos_psi;
    let p2 = (k * s + p1 * p1 * sin_psi) / cos_psi;
    let x1 = -l1 * s - l2 * sin_psi * p1;
    let x2 = -l1 * c - l2 * (cos_psi * p1 * p1 + sin_psi * p2);
    // centre of the rod
    let v = [-l1 * s - 0.5 * l2 * sin_psi * p1, l1 * c + 0.5 * l2 * cos_psi * p1];
    let b = [
        -l1 * c - 0.5 * l2 * (cos_psi * p1 * p1 + sin_psi * p2),
        -l1 * s + 0.5 * l2 * (cos_psi * p2 - sin_psi * p1 * p1),
    ];
    let inertia = j1 + m2 * (v[0] * v[0] + v[1] * v[1]) + jc * p1 * p1 + m3 * x1 * x1;
    let half_slope = m2 * (v[0] * b[0] + v[1] * b[1]) + jc * p1 * p2 + m3 * x1 * x2;
    let torque = inertia * rate + half_slope * speed * speed;
    let second = |first: f64, second: f64| first * rate + second * speed * speed;
    let slider = second(x1, x2);
    let centre = [second(v[0], b[0]), second(v[1], b[1])];
    let r = [0.5 * l2 * cos_psi, 0.5 * l2 * sin_psi];
    let fx = m3 * slider;
    let moment = -jc * second(p1, p2) - m2 * (r[0] * centre[1] - r[1] * centre[0]);
    let fy = (r[1] * fx + 0.5 * moment) / r[0];
    [phi, sin_psi.asin() - phi, l1 * c + l2 * cos_psi, x1 * speed, slider, torque, fx, fy]
}

fn holds(run: &Run, allowed: f64) {
    let mut largest = [1.0_f64; 8];
    for t in &run.trajectory.t {
        closed_form(*t).iter().zip(&mut largest).for_each(|(e, l)| *l = l.max(e.abs()));
    }
    for (t, row) in run.trajectory.t.iter().zip(&run.trajectory.rows) {
        for (i, exact) in closed_form(*t).iter().enumerate() {
            let error = (row[i] - exact).abs() / largest[i];
            assert!(error < allowed, "{} at {t}: {} for {exact}", run.trajectory.names[i], row[i]);
        }
    }
}

#[test]
fn a_driven_slider_crank_tells_its_forces() {
    let (a, w) = UNEVEN;
    let drive = format!("[prescribed]\nphi = \"Omega*t + {a}*sin({w}[1/s]*t)\"\n");
    let model = driven(&drive, COLUMNS);
    let run = done(&model, "auto");
    holds(&run, 1e-12); // positions are solved at every row
    assert!(run.report.energy_balance.is_some_and(|b| b < 1e-9), "{:?}", run.report.energy_balance);
    #[cfg(feature = "ida")]
    holds(&done(&model, "ida"), 1e-6);
}

#[test]
fn the_same_by_a_constraint_that_depends_on_time() {
    let (a, w) = UNEVEN;
    let drive = format!("[[constraint]]\nname = \"drive\"\nequation = \"phi = Omega*t + {a}*sin({w}[1/s]*t)\"\n");
    let columns = COLUMNS.replace("phi.tz", "drive.force");
    let model = driven(&drive, &columns);
    holds(&done(&model, "auto"), 1e-12);
}

/// A pendulum turned by hand: no coordinate at all.
#[test]
fn a_prescribed_pendulum_has_a_torque() {
    let text = "[world]\ngravity = [0, -9.81, 0]\n[[body]]\nname = \"rod\"\nmass = 2\ncenter = [0.5, 0, 0]\n\
                inertia = [0, 0.1, 0.1]\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"rod\"\n\
                [prescribed]\nh = \"0.7*sin(3[1/s]*t)\"\n[outputs]\ncolumns = [\"rod.yaw\", \"h.tz\", \"h.fx\"]\n[run]\nuntil = 2\n";
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = run_with(&model, |_| {});
    assert_eq!(run.report.status, Status::Done);
    for (t, row) in run.trajectory.t.iter().zip(&run.trajectory.rows) {
        let h = 0.7 * (3.0 * t).sin();
        let torque = -9.0 * h * (0.1 + 2.0 * 0.25) + 2.0 * 9.81 * 0.5 * h.cos();
        let speed = 2.1 * (3.0 * t).cos();
        let along = -2.0 * 0.5 * speed * speed + 2.0 * 9.81 * h.sin();
        assert!((row[0] - h).abs() < 1e-14 && (row[1] - torque).abs() < 1e-12, "{t}: {row:?}");
        assert!((row[2] - along).abs() < 1e-12, "{t}: {row:?}");
    }
}
