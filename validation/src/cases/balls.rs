//! Balls in recesses that are fixed or move, by a general body on a general surface; and a top that slides.

use super::{model, reference};
use crate::case::{Case, Expected};
use crate::reduced::{Ball, reduced};

const SPINNING: &str = "ball_recess_spinning.json: Neimark & Fufaev, integrated in extended precision";
const RECESS: &str = "ball_in_recess.json: quad precision Gragg-Bulirsch-Stoer";
const REDUCED: &str = "reduced equations of a ball in a sphere (Routh 1905), Runge-Kutta here";
const TIMES: [&str; 3] = ["1", "5", "10"];
/// What a run at 1e-12 must keep of the values, and of the integrals.
const ALLOWED: f64 = 1e-10;
const KEPT: f64 = 1e-12;

const COMPLIANT: &[(&str, &str)] =
    &[("R", "0.5"), ("r", "0.05"), ("azimuth_speed", "1.2"), ("spin", "5"), ("stiffness", "1e7"), ("v_reg", "1e-5")];

/// Where the centre of the rigid ball is.
fn compliant() -> Vec<Expected> {
    let place = |e: &Expected| e.columns.iter().all(|c| ["x", "y", "z"].contains(&c.as_str()));
    reduced(&Ball::USUAL, 1.0).into_iter().filter(place).collect()
}

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "ball_in_recess",
        scene: model!("ball_in_recess"),
        expected: spinning,
        allowed: ALLOWED,
        bite: ("r", "0.0505"),
        source: SPINNING,
        ..Case::USUAL
    },
    Case {
        name: "ball_in_recess_planar",
        scene: model!("ball_in_recess"),
        set: &[("R", "1"), ("r", "0.2"), ("polar", "30 deg"), ("azimuth_speed", "0"), ("spin", "0")],
        expected: || fixed("A_planar_30deg_rest"),
        allowed: ALLOWED,
        bite: ("R", "1.01"),
        source: RECESS,
        ..Case::USUAL
    },
    Case {
        name: "ball_in_recess_whirl",
        scene: model!("ball_in_recess"),
        // n' = 2 sin 40° along y
        set: &[("R", "1"), ("r", "0.2"), ("azimuth_speed", "1.6[m/s]*sin(polar)"), ("spin", "15")],
        expected: || fixed("B_spin"),
        allowed: ALLOWED,
        bite: ("spin", "15.15"),
        source: RECESS,
        ..Case::USUAL
    },
    // what gives against what does not: the errors are the model's, of order 1/stiffness and v_reg
    Case {
        name: "ball_in_recess_compliant",
        scene: model!("ball_in_recess_compliant"),
        set: COMPLIANT,
        method: "cvode-bdf",
        tolerance: 1e-9,
        expected: compliant,
        allowed: 5e-6,
        balance: 1e-6,
        bite: ("R", "0.505"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "ball_in_recess_hollow",
        scene: model!("ball_in_recess"),
        set: &[("inertia_factor", "2/3"), ("polar", "100 deg"), ("azimuth_speed", "4"), ("spin", "-30"), ("r", "0.2")],
        expected: || reduced(&Ball { k: 2.0 / 3.0, r: 0.2, polar: 100.0, speed: 4.0, spin: -30.0 }, 10.0),
        allowed: ALLOWED,
        bite: ("inertia_factor", "0.673"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "ball_in_recess_fast_spin",
        scene: model!("ball_in_recess"),
        set: &[("spin", "1000")],
        expected: || reduced(&Ball { spin: 1000.0, ..Ball::USUAL }, 1.0),
        allowed: ALLOWED,
        bite: ("spin", "1010"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "ball_nearly_fills_recess",
        scene: model!("ball_in_recess"),
        set: &[("r", "0.495"), ("azimuth_speed", "0.05")],
        expected: || reduced(&Ball { r: 0.495, speed: 0.05, ..Ball::USUAL }, 1.0),
        allowed: ALLOWED,
        bite: ("r", "0.4949"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "tiny_ball_in_recess",
        scene: model!("ball_in_recess"),
        set: &[("r", "0.0005")],
        expected: || reduced(&Ball { r: 0.0005, ..Ball::USUAL }, 1.0),
        allowed: ALLOWED,
        bite: ("polar", "40.4 deg"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "ball_from_the_bottom",
        scene: model!("ball_in_recess"),
        set: &[("polar", "0")],
        expected: || reduced(&Ball { polar: 0.0, ..Ball::USUAL }, 10.0),
        allowed: ALLOWED,
        bite: ("azimuth_speed", "1.212"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "ball_round_the_vertical",
        scene: model!("ball_in_recess"),
        // over the top of the recess and the bottom again and again: both poles of the polar angle
        set: &[("polar", "0"), ("azimuth_speed", "6"), ("spin", "0")],
        expected: || reduced(&Ball { polar: 0.0, speed: 6.0, spin: 0.0, ..Ball::USUAL }, 10.0),
        allowed: ALLOWED,
        bite: ("azimuth_speed", "6.06"),
        source: REDUCED,
        ..Case::USUAL
    },
    Case {
        name: "ball_absorber",
        scene: model!("ball_absorber"),
        expected: || {
            let pairs = [("x", "x"), ("theta", "theta"), ("xdot", "x'"), ("thetadot", "theta'")];
            let mut list = reference!("ball_in_recess").rows("/carrier_on_spring_planar/values", &TIMES, &pairs);
            list.extend(kept(&[("ball.y", 0.0), ("normal_spin", 0.0)]));
            list
        },
        allowed: ALLOWED,
        bite: ("k", "202"),
        source: RECESS,
        ..Case::USUAL
    },
    Case {
        name: "ball_absorber_pendulum_planar",
        scene: model!("ball_absorber_pendulum"),
        expected: pendulum_planar,
        allowed: ALLOWED,
        bite: ("kt", "80.8"),
        source: RECESS,
        ..Case::USUAL
    },
    Case {
        name: "ball_absorber_pendulum",
        scene: model!("ball_absorber_pendulum"),
        expected: || pendulum("case0"),
        allowed: ALLOWED,
        bite: ("m", "2.02"),
        source: RECESS,
        ..Case::USUAL
    },
    Case {
        name: "ball_absorber_pendulum_spatial",
        scene: model!("ball_absorber_pendulum"),
        // y0 of the file; the centre's velocity follows from rolling
        set: &[
            ("beta0", "0.05"),
            ("pivot.a'", "0.2"),
            ("pivot.b'", "-0.1"),
            ("ball.x", "0.14586427699151892885"),
            ("ball.y", "-0.099708650872138775146"),
            ("ball.z", "0.81824415678742972343"),
            ("ball.omega_x", "-2.0749233011766291349"),
            ("ball.omega_y", "-0.29850124958340772983"),
            ("ball.omega_z", "-1.1335357656676897223"),
        ],
        expected: || pendulum("case1"),
        allowed: ALLOWED,
        bite: ("J3", "0.102"),
        source: RECESS,
        ..Case::USUAL
    },
    Case {
        name: "tippe_top",
        scene: model!("tippe_top"),
        expected: tippe_top,
        bite: ("mu", "0.303"),
        source: "exact_nonholonomic.json: quad precision Gragg-Bulirsch-Stoer",
        ..Case::USUAL
    },
];

/// Columns that have the same value at all times, to [`KEPT`].
fn kept(columns: &[(&str, f64)]) -> Vec<Expected> {
    let at = |t: f64| {
        columns.iter().map(move |(c, value)| Expected {
            allowed: Some(KEPT * value.abs().max(1.0)),
            ..Expected::at(t, *c, *value)
        })
    };
    [1.0, 5.0, 10.0].into_iter().flat_map(at).collect()
}

fn spinning() -> Vec<Expected> {
    let file = reference!("ball_recess_spinning");
    let groups: [(&str, &[&str]); 4] = [
        ("position", &["x", "y", "z"]),
        ("velocity", &["vx", "vy", "vz"]),
        ("angular_velocity", &["wx", "wy", "wz"]),
        ("quaternion_wxyz", &["qw", "qx", "qy", "qz"]),
    ];
    let mut list = Vec::new();
    for row in 0..5 {
        let at = |key: &str| file.number(&format!("/trajectory/{row}/{key}"));
        for (group, columns) in groups {
            let values = columns.iter().enumerate();
            list.extend(values.map(|(i, column)| Expected::at(at("t"), *column, at(&format!("{group}/{i}")))));
        }
    }
    let integral = |name: &str| file.number(&format!("/integrals/{name}"));
    // the file's integral is over (m + J/r²) a²
    let routh = integral("routh") * 1.4 * 0.45 * 0.45;
    list.extend(kept(&[("energy", integral("energy")), ("routh", routh), ("normal_spin", integral("spin"))]));
    list.extend(kept(&["energy_drift", "spin_drift", "routh_drift"].map(|column| (column, 0.0))));
    list
}

/// n is the unit vector from the recess's centre to the ball's; a = 0.8 m.
fn fixed(case: &str) -> Vec<Expected> {
    const A: f64 = 0.8;
    let file = reference!("ball_in_recess");
    let mut list = Vec::new();
    for t in [1.0, 5.0, 10.0] {
        for (i, axis) in ["x", "y", "z"].iter().enumerate() {
            let at = |key: &str| file.number(&format!("/fixed_bowl/values/{case}/{t}/{key}/{i}"));
            list.push(Expected::at(t, *axis, A * at("n")));
            list.push(Expected::at(t, format!("v{axis}"), A * at("ndot")));
            list.push(Expected::at(t, format!("w{axis}"), at("omega_ball")));
        }
    }
    let energy = file.number(&format!("/fixed_bowl/values/{case}/E"));
    let vertical = file.number(&format!("/fixed_bowl/values/{case}/Jz"));
    list.extend(kept(&[("energy", energy), ("routh", vertical), ("spin_drift", 0.0)]));
    list
}

/// In the plane across x: the mast's lean is the angle about x, the ball's angle its deviation from the vertical below the
/// recess's centre.
fn pendulum_planar() -> Vec<Expected> {
    let file = reference!("ball_in_recess");
    let mut list = Vec::new();
    for (t, seconds) in TIMES.iter().zip([1.0, 5.0, 10.0]) {
        let at = |key: &str| file.number(&format!("/inverted_pendulum_planar/values/{t}/{key}"));
        let (psi, theta) = (at("psi"), at("theta"));
        let (psi_rate, theta_rate) = (at("psidot"), at("thetadot"));
        let values = [
            ("alpha", psi),
            ("alpha'", psi_rate),
            ("ball.y", -psi.sin() - 0.2 * theta.sin()),
            ("ball.z", psi.cos() - 0.2 * theta.cos()),
            ("ball.vy", -psi.cos() * psi_rate - 0.2 * theta.cos() * theta_rate),
            ("ball.x", 0.0),
        ];
        list.extend(values.map(|(column, value)| Expected::at(seconds, column, value)));
    }
    list
}

fn pendulum(case: &str) -> Vec<Expected> {
    const ORDER: [&str; 13] = [
        "alpha",
        "beta",
        "ball.x",
        "ball.y",
        "ball.z",
        "alpha'",
        "beta'",
        "ball.vx",
        "ball.vy",
        "ball.vz",
        "ball.omega_x",
        "ball.omega_y",
        "ball.omega_z",
    ];
    let file = reference!("ball_in_recess");
    let start = (0..13).map(|i| (0.0, i, file.number(&format!("/inverted_pendulum_spatial/y0/{case}/{i}"))));
    let later = TIMES.iter().zip([1.0, 5.0, 10.0]).flat_map(|(t, seconds)| {
        let value = |i| file.number(&format!("/inverted_pendulum_spatial/values/{case}/{t}/{i}"));
        (0..13).map(move |i| (seconds, i, value(i))).collect::<Vec<_>>()
    });
    start.chain(later).map(|(t, i, value)| Expected::at(t, ORDER[i], value)).collect()
}

/// Double precision keeps 8 to 9 digits at 5 s, when it falls over; after that it comes to rest upside down.
fn tippe_top() -> Vec<Expected> {
    const NAMES: [(&str, &str); 11] = [
        ("theta", "theta"),
        ("x", "top.x"),
        ("y", "top.y"),
        ("vx", "top.vx"),
        ("vy", "top.vy"),
        ("wx", "top.omega_x"),
        ("wy", "top.omega_y"),
        ("wz", "top.omega_z"),
        ("dx", "top.ezx"),
        ("dy", "top.ezy"),
        ("dz", "top.ezz"),
    ];
    let file = reference!("exact_nonholonomic");
    let mut list = file.rows("/tippe_top/values", &["1", "3"], &NAMES);
    let mut late = file.rows("/tippe_top/values", &["5", "6", "8"], &NAMES);
    late.iter_mut().for_each(|e| e.allowed = Some(1e-8 * e.value.abs().max(1.0)));
    list.extend(late);
    let jellett: f64 = -6.894_441_319_558_016e-6; // the file has words behind the number
    for t in [1.0, 3.0, 5.0, 6.0, 8.0] {
        list.push(Expected { allowed: Some(1e-9 * jellett.abs()), ..Expected::at(t, "jellett", jellett) });
        list.push(Expected { allowed: Some(1e-9), ..Expected::at(t, "jellett_drift", 0.0) });
    }
    list
}
