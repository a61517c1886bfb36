//! Closed loops.

use super::{model, reference, scene};
use crate::case::{Case, Expected};
use crate::closed;

const ANDREWS: &str = "ivp_quad.json: index-1 form in quad precision, constraints to 1e-28";
const IFTOMM: &str = "iftomm_rigid.json: quad precision Gragg-Bulirsch-Stoer";

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "planetary_gear",
        scene: scene!("planetary_gear"),
        expected: closed::planetary,
        bite: ("M", "0.404"),
        source: "closed form: Willis, Lagrange",
        ..Case::USUAL
    },
    Case {
        name: "rack_and_pinion",
        scene: scene!("rack_and_pinion"),
        expected: closed::rack,
        bite: ("r", "5.05 cm"),
        source: "closed form: harmonic oscillation",
        ..Case::USUAL
    },
    Case {
        name: "andrews",
        scene: model!("andrews"),
        expected: || andrews("/andrews/ivp_initial_data", &["0.03"]),
        bite: ("m7", "0.0555"),
        source: ANDREWS,
        ..Case::USUAL
    },
    Case {
        name: "andrews_iftomm",
        scene: model!("andrews"),
        // `andrews_iftomm_consistent_q0` of the file
        set: &[
            ("beta0", "-0.062"),
            ("Theta0", "2.14586853799515318889045224244354e-04"),
            ("gamma0", "4.55279812100370224186187076582720e-01"),
            ("Phi0", "2.22668375903027473389944594524681e-01"),
            ("delta0", "4.87364981140632795726159984735699e-01"),
            ("Omega0", "-2.22668375903027473389944594524681e-01"),
            ("epsilon0", "1.23054743915660076255075478156499"),
        ],
        expected: || andrews("/andrews/iftomm_A03_beta0_-0.0620", &["0.01", "0.05"]),
        bite: ("m7", "0.0555"),
        source: ANDREWS,
        ..Case::USUAL
    },
    Case {
        name: "slider_crank",
        scene: model!("slider_crank"),
        expected: closed::slider_crank,
        bite: ("J2", "0.00458"),
        source: "closed form: energy of the crank, time by quadrature",
        ..Case::USUAL
    },
    Case {
        name: "four_bar_1",
        scene: model!("four_bar_n"),
        set: &[("N", "1")],
        tolerance: 1e-11,
        allowed: 2e-6, // see `four_bar`
        balance: 1e-6,
        expected: || four_bar("1"),
        bite: ("g", "9.9"),
        source: IFTOMM,
        ..Case::USUAL
    },
    Case {
        name: "four_bar_2",
        scene: model!("four_bar_n"),
        tolerance: 1e-11,
        allowed: 2e-6,
        balance: 1e-6,
        expected: || four_bar("2"),
        bite: ("g", "9.9"),
        source: IFTOMM,
        ..Case::USUAL
    },
    Case {
        name: "bricard",
        scene: model!("bricard"),
        expected: || {
            let times = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "10"];
            let pairs = [
                ("a", "P1"),
                ("b", "P2"),
                ("a", "P3"),
                ("b", "P4"),
                ("P3/0", "bar3.x"),
                ("P3/1", "bar3.y"),
                ("P3/2", "bar3.z"),
            ];
            reference!("iftomm_rigid").rows("/A04_bricard/values", &times, &pairs)
        },
        bite: ("s", "0.11"),
        source: IFTOMM,
        ..Case::USUAL
    },
    Case {
        name: "flyball",
        scene: model!("flyball"),
        expected: || {
            let times = ["0.5", "1.0", "2.0", "3.0", "5.0", "7.0", "10.0"];
            let pairs =
                [("s", "s"), ("alpha", "alpha_right"), ("alpha", "alpha_left"), ("omega_shaft", "shaft_angle'")];
            reference!("iftomm_rigid").rows("/A05_flyball/values", &times, &pairs)
        },
        bite: ("M", "5.05"),
        source: IFTOMM,
        ..Case::USUAL
    },
    Case {
        name: "car_axis",
        scene: model!("car_axis"),
        expected: || {
            let columns = ["left.x", "left.y", "right.x", "right.y", "left.x'", "left.y'", "right.vx", "right.vy"];
            let file = reference!("ivp_quad");
            let value = |i: usize| file.number(&format!("/car_axis_t3/y1..8, lambda1,2/{i}"));
            columns.into_iter().enumerate().map(|(i, c)| Expected::at(3.0, c, value(i))).collect()
        },
        bite: ("M", "10.1"),
        source: "ivp_quad.json: index-1 form in quad precision (published digits: ivp_testset.json)",
        ..Case::USUAL
    },
];

/// Angles, rates and accelerations.
fn andrews(pointer: &str, times: &[&str]) -> Vec<Expected> {
    let names = ["beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon"];
    let file = reference!("ivp_quad");
    let columns = ["", "'", "''"].into_iter().flat_map(|primes| names.map(|n| format!("{n}{primes}")));
    let mut list = Vec::new();
    for (i, column) in columns.enumerate() {
        list.extend(file.rows(pointer, times, &[(&format!("y1..27/{i}"), &column)]));
    }
    list
}

/// Every second the bars lie in a line once or twice. At an angle d from there a loop's equation has a slope of about d:
/// rounding of 1e-16 leaves the rockers' angles open by 1e-16/d, their rates by 1e-16/d^2, and the step over the place is
/// held to a hundred tolerances only. How near to it a stage falls is chance. Over 60 tolerances from 1e-11 to 2.2e-11 the
/// error was 3e-9 to 6e-7, mostly 1e-7; it grows with the tolerance, ten times for ten times.
fn four_bar(n: &str) -> Vec<Expected> {
    reference!("iftomm_rigid").rows(
        &format!("/A02_N_four_bar/values/{n}"),
        &["1", "2", "3", "4", "5", "6", "7", "8", "9", "10"],
        &[
            ("theta", "theta[1]"),
            ("theta", "theta[2]"),
            ("thetadot", "theta[1]'"),
            ("B0_x", "B[1].x"),
            ("B0_y", "B[1].y"),
            ("B0_vx", "B[1].vx"),
            ("B0_vy", "B[1].vy"),
        ],
    )
}
