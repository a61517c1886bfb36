//! Knife edges, wheels and rolling bodies.

use super::{model, reference, scene};
use crate::case::{Case, Expected};
use crate::closed;

const SLEIGH: &str = "closed form (rolling_and_tops.json, chaplygin_sleigh_exact)";
const SNAKE: &str = "rolling_and_tops.json: quad precision, reduced and multiplier forms agree";
const TURNTABLE: &str = "closed form (exact_nonholonomic.json, homogeneous_sphere_on_turntable)";

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "chaplygin_sleigh",
        scene: model!("chaplygin_sleigh"),
        expected: closed::sleigh,
        bite: ("b", "0.303"),
        source: SLEIGH,
        ..Case::USUAL
    },
    Case {
        name: "sleigh_constraint",
        scene: scene!("sleigh_constraint"),
        expected: closed::sleigh,
        bite: ("b", "0.303"),
        source: SLEIGH,
        ..Case::USUAL
    },
    Case {
        name: "skate_on_incline",
        scene: scene!("skate_on_incline"),
        expected: closed::skate,
        bite: ("g", "9.9"),
        source: "closed form (exact_nonholonomic.json, skate_on_incline)",
        ..Case::USUAL
    },
    Case {
        name: "snakeboard_drive",
        scene: model!("snakeboard"),
        expected: || snakeboard("drive_1_1"),
        bite: ("Jr", "0.0727"),
        source: SNAKE,
        ..Case::USUAL
    },
    Case {
        name: "snakeboard_rotate",
        scene: model!("snakeboard"),
        set: &[("psi", "amplitude*sin(2*omega*t)")],
        expected: || snakeboard("rotate_2_1"),
        bite: ("Jr", "0.0727"),
        source: SNAKE,
        ..Case::USUAL
    },
    Case {
        name: "snakeboard_constraints_drive",
        scene: scene!("snakeboard_constraints"),
        expected: || snakeboard("drive_1_1"),
        bite: ("Jw", "0.001313"),
        source: SNAKE,
        ..Case::USUAL
    },
    Case {
        name: "snakeboard_constraints_rotate",
        scene: scene!("snakeboard_constraints"),
        set: &[("psi", "amplitude*sin(2*omega*t)")],
        expected: || snakeboard("rotate_2_1"),
        bite: ("Jw", "0.001313"),
        source: SNAKE,
        ..Case::USUAL
    },
    Case {
        name: "sphere_on_turntable",
        scene: scene!("sphere_turntable"),
        expected: || closed::turntable(0.4),
        bite: ("Omega", "3.03"),
        source: TURNTABLE,
        ..Case::USUAL
    },
    Case {
        name: "hollow_sphere_on_turntable",
        scene: scene!("sphere_turntable"),
        set: &[("ratio", "2/3")],
        expected: || closed::turntable(2.0 / 3.0),
        bite: ("ratio", "0.673"),
        source: TURNTABLE,
        ..Case::USUAL
    },
    Case {
        name: "chaplygin_ball",
        scene: scene!("chaplygin_ball"),
        expected: chaplygin_ball,
        bite: ("I[2]", "0.404"),
        source: "exact_nonholonomic.json: quad precision Gragg-Bulirsch-Stoer",
        ..Case::USUAL
    },
    Case {
        name: "rolling_disc",
        scene: scene!("rolling_disc"),
        expected: rolling_disc,
        bite: ("r", "0.303"),
        source: "rolling_and_tops.json: sympy's disc equations in quad precision",
        ..Case::USUAL
    },
];

pub(super) fn snakeboard(input: &str) -> Vec<Expected> {
    reference!("rolling_and_tops").rows(
        &format!("/snakeboard/values/{input}"),
        &["5", "10", "20"],
        &[("x", "x"), ("y", "y"), ("theta", "theta"), ("u", "u")],
    )
}

fn chaplygin_ball() -> Vec<Expected> {
    reference!("exact_nonholonomic").rows(
        "/chaplygin_ball/values",
        &["1", "5", "10"],
        &[
            ("x", "x"),
            ("y", "y"),
            ("w1", "w[1]"),
            ("w2", "w[2]"),
            ("w3", "w[3]"),
            ("gamma1", "ez[1]"),
            ("gamma2", "ez[2]"),
            ("gamma3", "ez[3]"),
        ],
    )
}

fn rolling_disc() -> Vec<Expected> {
    reference!("rolling_and_tops").rows(
        "/rolling_disc/values",
        &["1", "5", "10"],
        &[("yaw", "yaw"), ("lean", "lean"), ("q3", "spin"), ("u/0", "u_1"), ("u/1", "u_2"), ("u/2", "u_3")],
    )
}
