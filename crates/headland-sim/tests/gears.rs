//! Gears and racks: torques, offsets from the start, drives; what is wrong with one is told.

mod common;

use common::{done, read};

fn two(joints: [&str; 2], rest: &str) -> String {
    let body = |k: usize| {
        format!(
            "[[body]]\nname = \"b{k}\"\nmass = 2\ninertia = [0.{k}, 0.{k}, 0.{k}]\n[[joint]]\nname = \"j{k}\"\nto = \"b{k}\"\n\
             at = [{k}, 0, 0]\n{}\n",
            joints[k - 1]
        )
    };
    format!("{}{}{rest}", body(1), body(2))
}

const TURNS: &str = "kind = \"revolute\"";
const SHIFTS: &str = "kind = \"prismatic\"";

/// `J1 + n² J2`, torques of the pair, and an offset from the start that is kept to rounding.
#[test]
fn a_pair_is_one_inertia() {
    let gear = "[[gear]]\nname = \"g\"\nfrom = \"j1\"\nto = \"j2\"\nteeth = [20, 30]\n\
                [[force]]\nname = \"m\"\nvalue = 3\ngeometric = \"j1\"\n\
                [initial]\nj1 = 0.3\nj2 = 0.4\n\"j1'\" = 1\n[outputs]\ncolumns = [\"j1\", \"j2\", \"g.torque\", \"j1.tz\"]\n";
    let model = read(&two([TURNS; 2], gear)).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| (o.tolerance, o.until) = (1e-10, 50.0));
    let n = -20.0 / 30.0;
    let acceleration = 3.0 / (0.1 + n * n * 0.2);
    for (t, row) in run.trajectory.t.iter().zip(&run.trajectory.rows) {
        let turned = t + 0.5 * acceleration * t * t;
        let expected = [0.3 + turned, 0.4 + n * turned, 0.2 * n * acceleration, 0.1 * acceleration];
        for (found, expected) in row.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{row:?} {expected}");
        }
        let drift = (row[1] - 0.4) - n * (row[0] - 0.3);
        assert!(drift.abs() < 1e-14 * row[0].abs().max(1.0), "{drift:e}");
    }
}

/// With one coordinate at the start the other is found; a prescribed wheel drives the other; a rack by its wheel.
#[test]
fn starts_and_drives_go_through_gears() {
    let out = "[outputs]\ncolumns = [\"j2\"]\n";
    let gear = "[[gear]]\nname = \"g\"\nfrom = \"j1\"\nto = \"j2\"\n";
    let found = format!("{gear}ratio = 3\noffset = 0.5\n[initial]\nj1 = 0.2\n\"j1'\" = 0\n{out}");
    let turned = |text: &str, until: f64| {
        let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
        done(&model, |o| (o.tolerance, o.until) = (1e-10, until)).trajectory.rows.last().unwrap_or(&Vec::new())[0]
    };
    assert!((turned(&two([TURNS; 2], &found), 1.0) - 1.1).abs() < 1e-12);
    // something else must be free
    let third = "[[body]]\nname = \"b3\"\nmass = 1\n[[joint]]\nname = \"j3\"\nkind = \"prismatic\"\nto = \"b3\"\n";
    let driven = format!("{third}{gear}radius = 0.2\n[prescribed]\nj1 = \"1 + sin(t)\"\n[initial]\nj2 = 0.7\n{out}");
    assert!((turned(&two([TURNS, SHIFTS], &driven), 2.0) - 0.7 - 0.2 * 2.0_f64.sin()).abs() < 1e-9);
}

#[test]
fn what_is_wrong_with_a_gear_is_told() {
    let gear = "[[gear]]\nname = \"g\"\nfrom = \"j1\"\n";
    let ball = "kind = \"spherical\"";
    let rod = "kind = \"cylindrical\"";
    for (expected, joints, rest) in [
        ("`g` binds `j1` to itself", [TURNS; 2], "to = \"j1\"\nratio = 2"),
        ("needs one of `ratio`", [TURNS; 2], "to = \"j2\""),
        ("found ratio, radii", [TURNS; 2], "to = \"j2\"\nratio = 2\nradii = [1, 2]"),
        ("`ratio` is zero", [TURNS; 2], "to = \"j2\"\nratio = 0"),
        ("whole number of teeth, not 0", [TURNS; 2], "to = \"j2\"\nteeth = [20, 0]"),
        ("whole number of teeth, not 2.5", [TURNS; 2], "to = \"j2\"\nteeth = [2.5, 10]"),
        ("`radii` is -1 m", [TURNS; 2], "to = \"j2\"\nradii = [-1, 2]"),
        ("`teeth` is a list of 2", [TURNS; 2], "to = \"j2\"\nteeth = [2, 3, 4]"),
        ("both turn: `radii` or `teeth`", [TURNS; 2], "to = \"j2\"\nradius = 1"),
        ("`j2` shifts; a pinion with its rack has `radius`", [TURNS, SHIFTS], "to = \"j2\"\nteeth = [20, 30]"),
        ("`j2` is spherical; a gear takes joints", [TURNS, ball], "to = \"j2\"\nratio = 2"),
        ("name `j2.angle` or `j2.slide`", [TURNS, rod], "to = \"j2\"\nratio = 2"),
        ("`j2` is revolute and has no coordinate `slide`", [TURNS; 2], "to = \"j2.slide\"\nratio = 2"),
        ("`b2` is no joint", [TURNS; 2], "to = \"b2\"\nratio = 2"),
        ("`internal` means nothing here", [TURNS; 2], "to = \"j2\"\nratio = 2\ninternal = true"),
        ("`ratio` is a length [m], but `2 kg` is a mass", [TURNS, SHIFTS], "to = \"j2\"\nratio = \"2 kg\""),
        ("all prescribed", [TURNS; 2], "to = \"j2\"\nratio = 2\n[prescribed]\nj1 = \"t/1[s]\"\nj2 = \"2*t/1[s]\""),
        (
            "hang on different bodies, `world` and `b1`",
            [TURNS, "kind = \"revolute\"\nfrom = \"b1\""],
            "to = \"j2\"\nteeth = [2, 3]",
        ),
        ("cannot be its carrier too", [TURNS; 2], "to = \"j2\"\nteeth = [2, 3]\ncarrier = \"j1\""),
    ] {
        let text = two(joints, &format!("{gear}{rest}\n"));
        let Err(error) = read(&text).build() else { panic!("{expected}\n{text}") };
        assert!(error.to_string().contains(expected), "expected {expected}\n{error}");
    }
}
