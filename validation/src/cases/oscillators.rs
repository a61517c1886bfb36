//! Oscillators and pulses with closed solutions.

use super::scene;
use crate::case::Case;
use crate::closed;

const CLOSED: &str = "closed form";

const CHAIN: Case = Case {
    scene: scene!("spring_chain"),
    expected: closed::spring_chain,
    bite: ("c", "404"),
    source: "closed form: normal modes",
    ..Case::USUAL
};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "damped_oscillator",
        scene: scene!("damped_oscillator"),
        expected: closed::damped,
        bite: ("b", "1.515"),
        source: CLOSED,
        ..Case::USUAL
    },
    Case {
        name: "table_spring",
        scene: scene!("table_spring"),
        expected: closed::table_spring,
        bite: ("m", "2.02"),
        source: CLOSED,
        ..Case::USUAL
    },
    Case {
        name: "pulse_rectangular",
        scene: scene!("pulse"),
        tolerance: 1e-10,
        expected: closed::pulse_rectangular,
        bite: ("m", "3.03"),
        source: "closed form: momentum",
        ..Case::USUAL
    },
    Case {
        name: "pulse_smooth",
        scene: scene!("pulse"),
        set: &[("F", "impulse/(sqrt(2*pi)*0.001[s])*exp(-((t - start)/0.001)^2/2)")],
        tolerance: 1e-10,
        expected: closed::pulse_smooth,
        bite: ("m", "3.03"),
        source: "closed form: momentum",
        ..Case::USUAL
    },
    Case { name: "spring_chain", ..CHAIN },
    Case { name: "spring_chain_crout", set: &[("run.linear_solver", "crout")], ..CHAIN },
    Case { name: "spring_chain_bdf", method: "cvode-bdf", tolerance: 1e-10, allowed: 1e-6, balance: 1e-5, ..CHAIN },
    Case { name: "spring_chain_adams", method: "cvode-adams", tolerance: 1e-11, allowed: 1e-6, balance: 1e-5, ..CHAIN },
];
