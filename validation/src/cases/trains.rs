//! Trains of bogies and road trains.

use super::{model, reference};
use crate::case::{Case, Expected, Moment};
use crate::closed::radii;

const PAPER: &str = "paper_train.json: energy form of (12)-(16), 80-bit Taylor series";
const TRAINS: &str = "trains.json: quad precision Gragg-Bulirsch-Stoer, confirmed by a multiplier model";
const RADII: &str = "closed form: R_k^2 = R_(k-1)^2 + a_(k-1)^2 - l_k^2";

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "paper_train",
        scene: model!("paper_train"),
        tolerance: 1e-11,
        expected: paper_train,
        bite: ("m[2]", "12120"),
        source: PAPER,
        ..Case::USUAL
    },
    Case {
        name: "paper_train_cartesian",
        scene: model!("paper_train_cartesian"),
        tolerance: 1e-12,
        expected: paper_train,
        bite: ("m[2]", "12120"),
        source: PAPER,
        ..Case::USUAL
    },
    Case {
        name: "paper_train_bdf",
        scene: model!("paper_train"),
        method: "cvode-bdf",
        tolerance: 1e-10,
        allowed: 1e-6,
        balance: 1e-6,
        expected: paper_train,
        bite: ("m[2]", "12120"),
        source: PAPER,
        ..Case::USUAL
    },
    Case {
        name: "paper_train_spatial",
        scene: model!("paper_train_spatial"),
        tolerance: 1e-12,
        allowed: 1e-10,
        expected: paper_train,
        bite: ("m[2]", "12120"),
        source: PAPER,
        ..Case::USUAL
    },
    Case {
        name: "paper_train_spatial_tilted",
        scene: model!("paper_train_spatial"),
        set: &[("tilt", "[0.4, -0.7, 1.1]")],
        tolerance: 1e-12,
        allowed: 1e-10,
        expected: paper_train,
        bite: ("m[2]", "12120"),
        source: PAPER,
        ..Case::USUAL
    },
    Case {
        name: "paper_train_steady_turn",
        scene: model!("paper_train"),
        columns: &["v_B[k]/omega[k]"],
        tolerance: 1e-11,
        expected: || radii(0.03, &[4.0, 6.0, 6.0], &[1.0, 1.2], 60.0),
        bite: ("l[2]", "6.06"),
        source: RADII,
        ..Case::USUAL
    },
    Case {
        name: "paper_train_figures",
        scene: model!("paper_train_figures"),
        tolerance: 1e-10,
        expected: figures,
        bite: ("F0", "10057"),
        source: "the article's figure 3b: extremes read off, 1 % of the figures' spans",
        ..Case::USUAL
    },
    Case {
        name: "road_train_sine",
        scene: model!("road_train"),
        expected: || road_train("tractor_2trailers_sine", &["5", "10", "15"], 3),
        bite: ("m[2]", "3030"),
        source: TRAINS,
        ..Case::USUAL
    },
    Case {
        name: "road_train_lock_turn",
        scene: model!("road_train"),
        set: &[
            ("m", "[5000, 2000]"),
            ("J", "[6000, 2500]"),
            ("l", "[2.5, 3]"),
            ("a", "[1.2, 0]"),
            ("c", "[1, 0.2]"),
            ("F", "[0, 0]"),
            ("c_air", "0"),
            ("v0", "3"),
            ("delta", "0.4*tanh(t/1[s])"),
        ],
        expected: || road_train("free_rolling_lock_turn", &["5", "10"], 2),
        bite: ("m[2]", "2020"),
        source: TRAINS,
        ..Case::USUAL
    },
    Case {
        name: "road_train_steady_turn",
        scene: model!("road_train"),
        set: &[("F", "[0, 0, 0]"), ("c_air", "0"), ("delta", "0.2*tanh(t/1[s])")],
        columns: &["v_B[k]/omega[k]"],
        expected: || radii(0.2, &[2.86, 3.2, 4.5], &[0.9, 0.8], 60.0),
        bite: ("a[1]", "0.909"),
        source: RADII,
        ..Case::USUAL
    },
    Case {
        name: "tractor_implement_relaxation_tyres",
        scene: model!("tractor_implement"),
        expected: tractor_implement,
        bite: ("C[3]", "131.3"),
        source: TRAINS,
        ..Case::USUAL
    },
];

/// X, Y, ψ₁, ψ₂, v_y, r₁, r₂ and three slip angles.
fn tractor_implement() -> Vec<Expected> {
    let reference = reference!("trains");
    let columns = ["X", "Y", "psi1", "psi2", "vy", "r1", "r2", "alpha[1]", "alpha[2]", "alpha[3]"];
    let places: Vec<String> = (0..columns.len()).map(|i| i.to_string()).collect();
    let parts: Vec<(&str, &str)> = places.iter().map(String::as_str).zip(columns).collect();
    reference.rows("/tractor_implement_relaxation_tyres/values", &["2", "4", "10"], &parts)
}

fn paper_train() -> Vec<Expected> {
    let reference = reference!("paper_train");
    let mut list = Vec::new();
    for row in 0..4 {
        let at = |key: &str| reference.number(&format!("/values/{row}/{key}"));
        let t = at("t");
        for (key, column) in
            [("x_A1", "x_A1"), ("y_A1", "y_A1"), ("v", "v"), ("drive_force", "F_A1"), ("power", "power")]
        {
            list.push(Expected::at(t, column, at(key)));
        }
        for name in ["theta", "psi", "v_C", "omega"] {
            let member = |k: usize| Expected::at(t, format!("{name}[{}]", k + 1), at(&format!("{name}/{k}")));
            list.extend((0..3).map(member));
        }
    }
    list
}

/// Figure 3b: speeds of the mass centres over 0.28 m/s, power over 14 kW.
fn figures() -> Vec<Expected> {
    let speeds = ["v_C[1]", "v_C[2]", "v_C[3]"];
    vec![
        Expected::extreme(Moment::Least, &speeds, 17.86, 0.0028),
        Expected::extreme(Moment::Most, &speeds, 18.14, 0.0028),
        Expected::extreme(Moment::Least, &["power"], 172e3, 140.0),
        Expected::extreme(Moment::Most, &["power"], 186e3, 140.0),
    ]
}

fn road_train(problem: &str, times: &[&str], units: usize) -> Vec<Expected> {
    let reference = reference!("trains");
    let pointer = format!("/{problem}/values");
    let mut list = reference.rows(&pointer, times, &[("x_rear_axle", "x"), ("y_rear_axle", "y"), ("v", "v")]);
    for k in 0..units {
        list.extend(reference.rows(&pointer, times, &[(&format!("psi/{k}"), &format!("psi[{}]", k + 1))]));
    }
    list
}
