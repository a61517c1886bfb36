//! The rigid problems A01 to A05 of the IFToMM library: time against error, beside published times. Prints a Markdown table.
//!
//! Errors are against `validation/reference` (quad precision, equations derived otherwise). The time is that of the
//! integration with the outputs that the errors need, the least of several; derivation and compilation stand beside it.

use headland::{Model, RunOptions, Scene, Silent, Status, run};
use serde_json::Value;

/// A problem of the library.
struct Problem {
    name: &'static str,
    scene: &'static str,
    settings: &'static [(&'static str, &'static str)],
    until: f64,
    /// Columns, each with its value at a time of the reference.
    expected: Vec<(f64, &'static str, f64)>,
    /// Whether the energy stays.
    conservative: bool,
    /// Published: seconds of OpenSim 3.2 (Simbody) on an i5-4570 at 3.2 GHz; of Exudyn on laptops.
    published: [Option<f64>; 2],
}

const PENDULUM: &str = "[world]\ngravity = [0, -9.81, 0]\n[[body]]\nname = \"mass\"\nmass = 1\ncenter = [1, 0, 0]\n\
                        [[joint]]\nname = \"theta\"\nkind = \"revolute\"\nto = \"mass\"\n\
                        [[frame]]\nname = \"P\"\non = \"mass\"\nat = [1, 0, 0]\n\
                        [initial]\ntheta = \"180 deg\"\n[outputs]\ncolumns = [\"P.x\", \"P.y\"]\n";

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

fn number(v: &Value) -> f64 {
    v.as_str().and_then(|s| s.parse().ok()).or(v.as_f64()).expect("a number")
}

/// Values of one problem: `pairs` of a pointer inside a time's entry and the column.
fn expected(at_times: &Value, times: &[&str], pairs: &[(&str, &'static str)]) -> Vec<(f64, &'static str, f64)> {
    let at = |time: &&str| {
        let of = at_times[*time].clone();
        let t = time.parse().expect("a time");
        pairs.iter().map(move |(p, c)| (t, *c, number(of.pointer(p).expect("is there")))).collect::<Vec<_>>()
    };
    times.iter().flat_map(at).collect()
}

fn problems() -> Vec<Problem> {
    let file = json(include_str!("../../../validation/reference/iftomm_rigid.json"));
    let quad = json(include_str!("../../../validation/reference/ivp_quad.json"));
    let seconds = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "10"];
    let of = |pointer: &str| file.pointer(pointer).expect("is there").clone();
    let tip = [("/B0_x", "B[1].x"), ("/B0_y", "B[1].y")];
    let p3 = [("/P3/0", "bar3.x"), ("/P3/1", "bar3.y"), ("/P3/2", "bar3.z")];
    vec![
        Problem {
            name: "A01 pendulum",
            scene: PENDULUM,
            settings: &[],
            until: 10.0,
            expected: expected(&of("/A01_simple_pendulum/values"), &seconds, &[("/x", "P.x"), ("/y", "P.y")]),
            conservative: true,
            published: [Some(0.637), Some(0.037)],
        },
        Problem {
            name: "A02 four-bar, N = 2",
            scene: include_str!("../../../models/four_bar_n.toml"),
            settings: &[("N", "2")],
            until: 10.0,
            expected: expected(&of("/A02_N_four_bar/values/2"), &seconds, &tip),
            conservative: true,
            published: [Some(0.455), Some(0.0776)],
        },
        Problem {
            name: "A03 squeezer",
            scene: include_str!("../../../models/andrews.toml"),
            settings: &[
                ("beta0", "-0.062"),
                ("Theta0", "2.14586853799515318889045224244354e-04"),
                ("gamma0", "4.55279812100370224186187076582720e-01"),
                ("Phi0", "2.22668375903027473389944594524681e-01"),
                ("delta0", "4.87364981140632795726159984735699e-01"),
                ("Omega0", "-2.22668375903027473389944594524681e-01"),
                ("epsilon0", "1.23054743915660076255075478156499"),
            ],
            until: 0.05,
            expected: {
                let values = quad.pointer("/andrews/iftomm_A03_beta0_-0.0620").expect("is there");
                expected(values, &["0.01", "0.05"], &[("/y1..27/0", "beta"), ("/y1..27/2", "gamma")])
            },
            conservative: false,
            published: [Some(0.384), None],
        },
        Problem {
            name: "A04 Bricard",
            scene: include_str!("../../../models/bricard.toml"),
            settings: &[],
            until: 10.0,
            expected: expected(&of("/A04_bricard/values"), &seconds, &p3),
            conservative: true,
            published: [Some(0.258), None],
        },
        Problem {
            name: "A05 flyball",
            scene: include_str!("../../../models/flyball.toml"),
            settings: &[],
            until: 10.0,
            expected: expected(&of("/A05_flyball/values"), &["0.5", "1.0", "2.0", "5.0", "10.0"], &[("/s", "s")]),
            conservative: false,
            published: [Some(0.233), None],
        },
    ]
}

/// The problem as a model whose first two columns are the energies.
fn model(problem: &Problem) -> Model {
    let energies = "columns = [\"system.kinetic_energy\", \"system.potential_energy\", ";
    let text = problem.scene.replacen("columns = [", energies, 1);
    let mut scene = Scene::parse(problem.name, &text).expect("reads");
    for (name, value) in problem.settings {
        scene.set(name, value).expect("is set");
    }
    scene.build().unwrap_or_else(|e| panic!("{e}"))
}

fn row(problem: &Problem, model: &Model, tolerance: f64) {
    let mut times: Vec<f64> = (0..=100).map(|k| problem.until * f64::from(k) / 100.0).collect();
    times.extend(problem.expected.iter().map(|e| e.0));
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut options = RunOptions::of(model);
    (options.tolerance, options.until, options.at) = (tolerance, problem.until, Some(times));
    (options.balance, options.repeat) = (false, 7);
    let result = run(model, &options, &mut Silent).expect("starts");
    let report = &result.report;
    if let Status::Failed(reason) = &report.status {
        println!("| {} | {tolerance:.0e} | {reason} |", problem.name);
        return;
    }
    let trajectory = &result.trajectory;
    let error = problem.expected.iter().map(|(t, column, value)| {
        let row = trajectory.t.iter().position(|x| x == t).expect("a row");
        let names = &trajectory.names;
        let column = names.iter().position(|n| n == column).expect("a column");
        (trajectory.rows[row][column] / model.outputs[column].factor - value).abs()
    });
    let error = error.fold(0.0, f64::max);
    let energy = |row: &Vec<f64>| row[0] + row[1];
    let first = energy(&trajectory.rows[0]);
    let drift = trajectory.rows.iter().map(|row| (energy(row) - first).abs()).fold(0.0, f64::max);
    let drift = if problem.conservative { format!("{drift:.1e}") } else { "-".into() };
    let published = problem.published.map(|p| p.map_or("-".into(), |s| format!("{:.0}", 1e3 * s)));
    println!(
        "| {} | {} | {tolerance:.0e} | {error:.1e} | {drift} | {} | {} | {:.2} | {:.1} | {} | {} |",
        problem.name,
        report.method,
        report.steps,
        report.rhs,
        1e3 * report.run_s,
        1e3 * (report.derive_s + report.compile_s),
        published[0],
        published[1]
    );
}

fn main() {
    if !std::env::args().any(|a| a == "--bench") {
        return; // run as a test: it is enough that it builds
    }
    println!(
        "| problem | method | tolerance | error, m or rad | energy, J | steps | rhs | run, ms | derive, ms | OpenSim, ms | \
         Exudyn, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for problem in problems() {
        let model = model(&problem);
        for tolerance in [1e-4, 1e-6, 1e-9] {
            row(&problem, &model, tolerance);
        }
    }
}
