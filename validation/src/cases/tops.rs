//! Bodies that turn in space: tops, pendulums, chains.

use super::{model, reference, scene};
use crate::case::{Case, Expected};

const STRESS: &str = "stress.json: quad precision Gragg-Bulirsch-Stoer";
const FREE: &str = "rolling_and_tops.json: quad precision, confirmed by a 32-digit Taylor series";
const BOOT: &str = "babyboot.json: quad precision; Drake's published values agree";

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "heavy_top",
        scene: model!("heavy_top"),
        expected: heavy_top,
        bite: ("J[3]", "0.2367"),
        source: STRESS,
        ..Case::USUAL
    },
    Case {
        name: "free_body_1s",
        scene: scene!("free_body"),
        expected: || free_body("1"),
        bite: ("I[2]", "2.02"),
        source: FREE,
        ..Case::USUAL
    },
    Case {
        name: "free_body_10s",
        scene: scene!("free_body"),
        tolerance: 1e-13,
        // The start is 2e-8 from the separatrix: the time of a flip moves with the logarithm of that distance, so a
        // relative error of 1e-16 in the velocities grows by 2e8 and more until the first flip.
        allowed: 1e-7,
        expected: || free_body("10"),
        bite: ("I[2]", "2.02"),
        source: FREE,
        ..Case::USUAL
    },
    Case {
        name: "free_body_100s",
        scene: scene!("free_body"),
        tolerance: 1e-13,
        allowed: 1e-5, // as above, over ten flips
        expected: || ["50", "100"].into_iter().flat_map(free_body).collect(),
        bite: ("I[2]", "2.02"),
        source: FREE,
        ..Case::USUAL
    },
    Case {
        name: "body_babyboot_1s",
        scene: scene!("babyboot_bodies"),
        allowed: 1e-10,
        expected: || super::pendulums::babyboot("1"),
        bite: ("IBy", "505e-7"),
        source: BOOT,
        ..Case::USUAL
    },
    Case {
        name: "body_babyboot_5s",
        scene: scene!("babyboot_bodies"),
        allowed: 1e-8, // chaotic: two digits lost since 1 s
        expected: || super::pendulums::babyboot("5"),
        bite: ("IBy", "505e-7"),
        source: BOOT,
        ..Case::USUAL
    },
    Case {
        name: "body_babyboot_10s",
        scene: scene!("babyboot_bodies"),
        tolerance: 1e-13,
        allowed: 1e-5, // double precision keeps 6 to 7 digits, babyboot.json
        expected: || super::pendulums::babyboot("10"),
        bite: ("IBy", "505e-7"),
        source: BOOT,
        ..Case::USUAL
    },
    Case {
        name: "spherical_double_pendulum",
        scene: scene!("spherical_double_pendulum"),
        expected: spherical_pendulum,
        bite: ("m2", "0.808"),
        source: "spherical_pendulum.json: Newton and Euler with joint forces, 36-digit decimal extrapolation",
        ..Case::USUAL
    },
    Case {
        name: "simple_pendulum",
        scene: scene!("pendulum"),
        expected: || {
            let times = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "9.99", "10"];
            let pairs = [("theta", "theta"), ("x", "bob.x"), ("y", "bob.y")];
            reference!("iftomm_rigid").rows("/A01_simple_pendulum/values", &times, &pairs)
        },
        bite: ("L", "1.01"),
        source: "iftomm_rigid.json, A01: quad precision Gragg-Bulirsch-Stoer",
        ..Case::USUAL
    },
    Case {
        name: "body_double_pendulum",
        scene: model!("chain"),
        set: &[("m", "[1, 1]"), ("turn", "[0, 0]"), ("phi0", "[90, 0]"), ("c", "l"), ("ratio", "0")],
        expected: || chain("N2", &["1", "2", "5", "10"]),
        bite: ("m[2]", "1.01"),
        source: STRESS,
        ..Case::USUAL
    },
    Case {
        name: "body_chain_of_10_links",
        scene: model!("chain"),
        set: &[
            ("m", "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"),
            ("turn", "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0]"),
            ("phi0", "[90, 0, 0, 0, 0, 0, 0, 0, 0, 0]"),
            ("c", "l"),
            ("ratio", "0"),
        ],
        expected: || chain("N10", &["1", "2", "3"]),
        bite: ("m[10]", "1.01"),
        source: STRESS,
        ..Case::USUAL
    },
];

fn heavy_top() -> Vec<Expected> {
    reference!("stress").rows(
        "/heavy_top_lie_group/values",
        &["0.1", "0.5", "0.8", "1", "1.5", "2"],
        &[
            ("com/0", "centre.x"),
            ("com/1", "centre.y"),
            ("com/2", "centre.z"),
            ("omega_body_1_3/0", "pivot.wx"),
            ("omega_body_1_3/1", "pivot.wz"),
        ],
    )
}

/// With energy and momentum, which do not depend on when the body flips.
fn free_body(time: &str) -> Vec<Expected> {
    let mut list = reference!("rolling_and_tops").rows(
        "/free_body_I_1_2_3/values",
        &[time],
        &[
            ("omega_body/0", "body.wx"),
            ("omega_body/1", "body.wy"),
            ("omega_body/2", "body.wz"),
            ("quat_wxyz/0", "body.qw"),
            ("quat_wxyz/1", "body.qx"),
            ("quat_wxyz/2", "body.qy"),
            ("quat_wxyz/3", "body.qz"),
        ],
    );
    let (energy, momentum) = (0.5 * (1e-6 + 2.0 * 25.0 + 3e-6), f64::sqrt(1e-6 + 4.0 * 25.0 + 9e-6));
    let t = time.parse().expect("times are numbers");
    for (column, value) in [("energy", energy), ("momentum", momentum)] {
        list.push(Expected { allowed: Some(1e-9 * value), ..Expected::at(t, column, value) });
    }
    list
}

fn spherical_pendulum() -> Vec<Expected> {
    let columns = [
        ("elbow", ["x", "y", "z"]),
        ("centre", ["centre.x", "centre.y", "centre.z"]),
        ("w1", ["upper.wx", "upper.wy", "upper.wz"]),
        ("w2", ["lower.wx", "lower.wy", "lower.wz"]),
    ];
    let file = reference!("spherical_pendulum");
    let mut list = Vec::new();
    for (key, names) in columns {
        for (i, name) in names.into_iter().enumerate() {
            list.extend(file.rows("/values", &["1", "2", "3"], &[(&format!("{key}/{i}"), name)]));
        }
    }
    list
}

/// Point masses on massless rods in a plane, horizontal at first.
fn chain(n: &str, times: &[&str]) -> Vec<Expected> {
    let pairs = [("x", "x"), ("y", "z"), ("th_first", "phi[1]"), ("th_last", "total")];
    reference!("stress").rows(&format!("/chain_point_masses/{n}"), times, &pairs)
}
