//! Bodies that roll or slide on edges.

use super::{model, reference, scene};
use crate::case::{Case, Expected};
use crate::closed;

const DISC: &str = "rolling_and_tops.json: sympy's disc equations in quad precision";
const EXACT: &str = "exact_nonholonomic.json: quad precision Gragg-Bulirsch-Stoer";
const SNAKE: &str = "rolling_and_tops.json: quad precision, reduced and multiplier forms agree";
const TURNTABLE: &str = "closed form (exact_nonholonomic.json, homogeneous_sphere_on_turntable)";

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "body_rolling_disc",
        scene: model!("rolling_disc"),
        expected: || {
            let pairs =
                [("yaw", "yaw"), ("lean", "lean"), ("q3", "spin"), ("u/0", "u_1"), ("u/1", "u_2"), ("u/2", "u_3")];
            reference!("rolling_and_tops").rows("/rolling_disc/values", &["1", "5", "10"], &pairs)
        },
        bite: ("r", "0.303"),
        source: DISC,
        ..Case::USUAL
    },
    Case {
        name: "body_rolling_disc_lie_group",
        scene: model!("rolling_disc"),
        set: &[("m", "15"), ("r", "1"), ("lean0", "15 deg"), ("u1", "0"), ("u2", "5"), ("u3", "15")],
        expected: || with_axis("/lie_group_rolling_disc/values", &["1", "2"], "disc", "ey"),
        bite: ("r", "1.01"),
        source: EXACT,
        ..Case::USUAL
    },
    Case {
        name: "body_chaplygin_ball",
        scene: model!("chaplygin_ball"),
        expected: chaplygin_ball,
        bite: ("I[2]", "0.404"),
        source: EXACT,
        ..Case::USUAL
    },
    Case {
        name: "rattleback",
        scene: model!("rattleback"),
        // 10 000 steps over a rattle that begins as an instability: 1e-12 leaves 9e-10
        tolerance: 1e-13,
        expected: rattleback,
        bite: ("Ixy", "-2.02e-5"),
        source: "rolling_and_tops.json: quad precision Gragg-Bulirsch-Stoer",
        ..Case::USUAL
    },
    Case {
        name: "eccentric_sphere",
        scene: scene!("eccentric_sphere"),
        expected: || {
            let jellett = reference!("exact_nonholonomic").number("/rolling_eccentric_sphere/jellett");
            let mut list = with_axis("/rolling_eccentric_sphere/values", &["1", "2", "5"], "ball", "ez");
            list.extend([1.0, 2.0, 5.0].map(|t| Expected::at(t, "jellett", jellett)));
            list
        },
        bite: ("e", "0.0303"),
        source: EXACT,
        ..Case::USUAL
    },
    Case {
        name: "sphere_on_incline",
        scene: scene!("sphere_on_incline"),
        expected: || closed::incline(0.4),
        bite: ("ratio", "0.404"),
        source: "closed form (exact_nonholonomic.json, homogeneous_sphere_on_incline)",
        ..Case::USUAL
    },
    Case {
        name: "body_sphere_on_turntable",
        scene: scene!("turntable"),
        expected: || closed::turntable(0.4),
        bite: ("Omega", "3.03"),
        source: TURNTABLE,
        ..Case::USUAL
    },
    Case {
        name: "body_hollow_sphere_on_turntable",
        scene: scene!("turntable"),
        set: &[("ratio", "2/3")],
        expected: || closed::turntable(2.0 / 3.0),
        bite: ("ratio", "0.673"),
        source: TURNTABLE,
        ..Case::USUAL
    },
    Case {
        name: "ball_in_cylinder",
        scene: scene!("ball_in_cylinder"),
        expected: closed::cylinder,
        bite: ("Phi", "5.05"),
        source: "closed form (exact_nonholonomic.json, homogeneous_sphere_inside_vertical_cylinder)",
        ..Case::USUAL
    },
    Case {
        name: "ball_in_cylinder_wall",
        scene: scene!("ball_in_cylinder_wall"),
        expected: closed::cylinder,
        bite: ("Phi", "5.05"),
        source: "closed form (exact_nonholonomic.json, homogeneous_sphere_inside_vertical_cylinder)",
        ..Case::USUAL
    },
    Case {
        name: "vertical_disc",
        scene: scene!("vertical_disc"),
        expected: closed::vertical_disc,
        bite: ("r", "0.2525"),
        source: "closed form (exact_nonholonomic.json, vertical_rolling_disc)",
        ..Case::USUAL
    },
    Case {
        name: "disc_in_bowl",
        scene: scene!("disc_in_bowl"),
        // the motion is unstable: what 1e-12 leaves grows
        tolerance: 1e-13,
        expected: closed::bowl,
        bite: ("lean", "0.505 rad"),
        source: "closed form: Newton and Euler for a steady motion",
        ..Case::USUAL
    },
    Case {
        name: "body_sleigh",
        scene: scene!("sleigh_body"),
        expected: closed::sleigh,
        bite: ("b", "0.303"),
        source: "closed form (rolling_and_tops.json, chaplygin_sleigh_exact)",
        ..Case::USUAL
    },
    Case {
        name: "body_snakeboard_drive",
        scene: scene!("snakeboard_bodies"),
        expected: || super::nonholonomic::snakeboard("drive_1_1"),
        bite: ("Jr", "0.0727"),
        source: SNAKE,
        ..Case::USUAL
    },
    Case {
        name: "body_snakeboard_rotate",
        scene: scene!("snakeboard_bodies"),
        set: &[("psi", "amplitude*sin(2*omega*t)")],
        expected: || super::nonholonomic::snakeboard("rotate_2_1"),
        bite: ("Jr", "0.0727"),
        source: SNAKE,
        ..Case::USUAL
    },
    Case {
        name: "bicycle",
        scene: model!("bicycle"),
        expected: bicycle,
        bite: ("mH", "4.04"),
        source: "bicycle.json: benchmark bicycle, nonlinear, quad precision, confirmed by maximal coordinates",
        ..Case::USUAL
    },
    Case {
        name: "bicycle_basu_mandal",
        scene: model!("bicycle"),
        // The input of the published point in the scene's angles: its frame has x ahead, y down, z to the left and goes
        // along -x; R = Rz(theta) Rx(psi) Rz(phi) of it is Rz(yaw) Ry(pitch) Rx(roll) of ours.
        set: &[
            ("yaw0", "3.1323535692389224"),
            ("roll0", "0.6207267384858376"),
            ("steer0", "0.2311385135743"),
            ("v", "2.674027811354255"),
            ("roll_rate", "-0.6067777677365546"),
            ("steer_rate", "0.4859824687093"),
        ],
        columns: &["R.vx", "R.vy", "R.vz", "front'", "R.ax", "R.ay", "R.az", "steer''", "rear''", "front''"],
        allowed: 1e-12, // as published: 13 decimals
        expected: basu_mandal,
        bite: ("mH", "4.04"),
        source: "bicycle.json: Basu-Mandal, Chatterjee, Papadopoulos 2007, Table 1",
        ..Case::USUAL
    },
];

/// Position and angular velocity of a body, axes of the world, and the axis of the body that the file calls d.
fn with_axis(pointer: &str, times: &[&str], body: &str, axis: &str) -> Vec<Expected> {
    let columns = [
        ("x", format!("{body}.x")),
        ("y", format!("{body}.y")),
        ("wx", format!("{body}.omega_x")),
        ("wy", format!("{body}.omega_y")),
        ("wz", format!("{body}.omega_z")),
        ("dx", format!("{body}.{axis}x")),
        ("dy", format!("{body}.{axis}y")),
        ("dz", format!("{body}.{axis}z")),
    ];
    let pairs: Vec<(&str, &str)> = columns.iter().map(|(key, column)| (*key, column.as_str())).collect();
    reference!("exact_nonholonomic").rows(pointer, times, &pairs)
}

fn chaplygin_ball() -> Vec<Expected> {
    let file = reference!("exact_nonholonomic");
    let times = ["1", "5", "10"];
    let mut list = file.rows(
        "/chaplygin_ball/values",
        &times,
        &[
            ("x", "ball.x"),
            ("y", "ball.y"),
            ("w1", "ball.wx"),
            ("w2", "ball.wy"),
            ("w3", "ball.wz"),
            ("gamma1", "ball.exz"),
            ("gamma2", "ball.eyz"),
            ("gamma3", "ball.ezz"),
        ],
    );
    for t in [1.0, 5.0, 10.0] {
        list.push(Expected::at(t, "energy", file.number("/chaplygin_ball/parameters/E")));
        list.push(Expected::at(t, "M_squared", file.number("/chaplygin_ball/parameters/M2")));
    }
    list
}

fn rattleback() -> Vec<Expected> {
    reference!("rolling_and_tops").rows(
        "/rattleback/values/spin -5",
        &["0.5", "1", "2", "5", "10"],
        &[
            ("gamma/0", "stone.exz"),
            ("gamma/1", "stone.eyz"),
            ("gamma/2", "stone.ezz"),
            ("omega_body/0", "stone.wx"),
            ("omega_body/1", "stone.wy"),
            ("omega_body/2", "stone.wz"),
            ("omega_dot_gamma", "spin_up"),
        ],
    )
}

/// The file has radians where the scene's columns are in degrees.
fn bicycle() -> Vec<Expected> {
    let file = reference!("bicycle");
    let (pointer, times) = ("/nonlinear_uncontrolled_bicycle/M2", ["1", "2", "3", "4", "5"]);
    let turns = [("lean", "lean"), ("steer", "steer"), ("yaw", "yaw"), ("steer_rate", "steer'")];
    let mut list = file.rows(pointer, &times, &turns);
    list.iter_mut().for_each(|e| e.value = e.value.to_degrees());
    list.extend(file.rows(
        pointer,
        &times,
        &[
            ("rear_wheel_rate_rel_frame", "rear'"),
            ("rear_frame_COM/0", "rider.x"),
            ("rear_frame_COM/1", "rider.y"),
            ("rear_frame_COM/2", "rider.z"),
        ],
    ));
    list
}

/// Velocities that follow from the given ones, and accelerations; x, y, z of the rear wheel's centre.
fn basu_mandal() -> Vec<Expected> {
    let file = reference!("bicycle");
    let at = |place: &str, key: &str, column: &str| {
        Expected::at(0.0, column, file.number(&format!("/basu_mandal_nonlinear_point/{place}/{key}")))
    };
    vec![
        at("input", "xd", "R.vx"),
        at("input", "yd", "R.vy"),
        at("input", "zd", "R.vz"),
        at("input", "betard", "rear'"),
        at("input", "betafd", "front'"),
        at("accelerations", "xdd", "R.ax"),
        at("accelerations", "ydd", "R.ay"),
        at("accelerations", "zdd", "R.az"),
        at("accelerations", "psifdd", "steer''"),
        at("accelerations", "betardd", "rear''"),
        at("accelerations", "betafdd", "front''"),
    ]
}
