//! Pendulums and chains of rigid links.

use super::{model, reference, scene};
use crate::case::{Case, Expected};

const CHAIN: &str = "stress.json: quad precision Gragg-Bulirsch-Stoer";
const BOOT: &str = "babyboot.json: quad precision; Drake's published values agree";

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "double_pendulum",
        scene: model!("double_pendulum"),
        expected: || {
            reference!("stress").rows(
                "/chain_point_masses/N2",
                &["1", "2", "5", "10"],
                &[("x", "x_2"), ("y", "y_2"), ("th_first", "phi_1"), ("th_last", "phi_2")],
            )
        },
        bite: ("m2", "1.01"),
        source: CHAIN,
        ..Case::USUAL
    },
    Case {
        name: "chain_of_10_links",
        scene: scene!("point_chain"),
        expected: || chain("/chain_point_masses/N10", &["1", "2", "3"], 10, true),
        bite: ("m[10]", "1.01"),
        source: CHAIN,
        ..Case::USUAL
    },
    Case {
        name: "chain_with_heavy_end",
        scene: scene!("point_chain"),
        set: &[("m", "[1, 1e6]")],
        allowed: 1e-6, // the light mass moves fast and chaotically
        expected: || chain("/mass_ratio_1e6_heavy_end/values", &["1", "2", "5"], 2, false),
        bite: ("g", "9.9"),
        source: CHAIN,
        ..Case::USUAL
    },
    Case {
        name: "pendulum_prescribed_pivot",
        scene: model!("pendulum_prescribed_pivot"),
        expected: || {
            let pairs = [("phi", "phi"), ("phi_dot", "phi'")];
            reference!("prescribed_pivot").rows("/values", &["0.5", "1", "2", "5"], &pairs)
        },
        bite: ("amplitude", "2.02"),
        source: "prescribed_pivot.json: Taylor series in 45-digit decimal arithmetic",
        ..Case::USUAL
    },
    Case {
        name: "babyboot_1s",
        scene: scene!("babyboot"),
        allowed: 1e-10,
        expected: || babyboot("1"),
        bite: ("IBy", "505e-7"),
        source: BOOT,
        ..Case::USUAL
    },
    Case {
        name: "babyboot_5s",
        scene: scene!("babyboot"),
        allowed: 1e-8,
        expected: || babyboot("5"),
        bite: ("IBy", "505e-7"),
        source: BOOT,
        ..Case::USUAL
    },
    Case {
        name: "babyboot_10s",
        scene: scene!("babyboot"),
        tolerance: 1e-13,
        allowed: 1e-5,
        expected: || babyboot("10"),
        bite: ("IBy", "505e-7"),
        source: BOOT,
        ..Case::USUAL
    },
    Case {
        name: "elastic_pendulum",
        scene: scene!("elastic_pendulum"),
        expected: || elastic_pendulum("k=1e4"),
        bite: ("k", "1.01e4"),
        source: CHAIN,
        ..Case::USUAL
    },
    Case {
        name: "elastic_pendulum_stiff",
        scene: scene!("elastic_pendulum"),
        set: &[("k", "1e9")],
        method: "dop853",
        tolerance: 1e-11,
        allowed: 1e-7,
        expected: || elastic_pendulum("k=1e9"),
        bite: ("g", "9.9"),
        source: CHAIN,
        ..Case::USUAL
    },
];

/// The heavy end alone where the light mass moves too fast to be known.
fn chain(pointer: &str, times: &[&str], n: usize, all: bool) -> Vec<Expected> {
    let (x, y, last) = (format!("x[{n}]"), format!("y[{n}]"), format!("phi[{n}]"));
    let mut pairs = vec![("x", x.as_str()), ("y", y.as_str())];
    if all {
        pairs.extend([("th_first", "phi[1]"), ("th_last", last.as_str())]);
    }
    reference!("stress").rows(pointer, times, &pairs)
}

pub(super) fn babyboot(t: &str) -> Vec<Expected> {
    let pairs =
        [("qA_deg", "q_A"), ("qB_deg", "q_B"), ("qAd", "q_A'"), ("qBd", "q_B'"), ("qAdd", "q_A''"), ("qBdd", "q_B''")];
    reference!("babyboot").rows("/values", &[t], &pairs)
}

fn elastic_pendulum(k: &str) -> Vec<Expected> {
    let pairs = [("x", "x"), ("y", "y"), ("vx", "x'"), ("vy", "y'")];
    reference!("stress").rows(&format!("/elastic_pendulum/{k}"), &["1", "2"], &pairs)
}
