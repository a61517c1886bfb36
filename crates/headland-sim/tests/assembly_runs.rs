//! Runs of machines with loops and rolling: energy and constraints are kept, redundant joints do no harm.

mod common;

use common::{done, read};

/// Bodies of a planar linkage standing askew in space, so that nothing is along an axis.
fn linkage(cranks: &[f64], tip: [f64; 2], extra: &str) -> String {
    let mut s = String::from("[world]\ngravity = [1, -9, 3]\n[[frame]]\nname = \"base\"\nrpy = [0.4, 0.9, -1.3]\n");
    s += "[[body]]\nname = \"coupler\"\nmass = 2\ncenter = [0.7, 0.1, 0]\ninertia = [0.4, 0.5, 0.6, 0.05, 0, 0]\n";
    for (k, x) in cranks.iter().enumerate() {
        s += &format!("[[body]]\nname = \"crank{k}\"\nmass = 1\ncenter = [0.2, 0.4, 0]\ninertia = [0.2, 0.1, 0.25]\n");
        s += &format!(
            "[[joint]]\nname = \"a{k}\"\nkind = \"revolute\"\nfrom = \"base\"\nat = [{x}, 0, 0]\nto = \"crank{k}\"\n"
        );
        s += &format!("[[joint]]\nname = \"b{k}\"\nkind = \"revolute\"\nfrom = \"crank{k}\"\nto = \"coupler\"\n");
        s += &format!("at = [{}, {}, 0]\nto_at = [{x}, 0, 0]\n", tip[0], tip[1]);
    }
    s + extra
}

fn check(text: &str, until: f64) {
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| {
        o.tolerance = 1e-10;
        o.until = until;
    });
    let report = &run.report;
    assert!(report.energy_balance.is_some_and(|b| b < 1e-7), "{}: energy {:?}", model.title, report.energy_balance);
    assert!(report.constraint_velocity.is_some_and(|v| v < 1e-9), "velocities {:?}", report.constraint_velocity);
    assert!(report.constraint_position.is_some_and(|v| v < 1e-9), "positions {:?}", report.constraint_position);
}

/// The cranks stay away from the places where they lie in line with the coupler and can go two ways.
#[test]
fn redundant_parallelograms_keep_energy_and_places() {
    let run = "[initial]\na0 = 0.3\n\"a0'\" = 2\n";
    check(&linkage(&[0.0, 1.0], [0.4, 0.8], run), 3.0);
    check(&linkage(&[0.0, 1.0, 2.5], [0.4, 0.8], run), 3.0);
}

/// Six hinges in space, of whose constraints one follows from the others.
#[test]
fn bricard_keeps_energy_and_places() {
    let text = include_str!("../../../models/bricard.toml");
    check(text, 4.0);
}

#[test]
fn a_tilted_disc_and_a_moving_plane_keep_their_contact() {
    let wheel = "[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"wheel\"\nmass = 1\nshape = \"disc\"\nsize = 0.5\naxis = \"y\"\n\
                 [[frame]]\nname = \"plane\"\nrpy = [0.2, 0.1, 0]\n\
                 [[rolling]]\nname = \"c\"\nbody = \"wheel\"\non = \"plane\"\nradius = 0.5\naxis = \"y\"\n";
    check(&format!("{wheel}[initial]\n\"wheel.z\" = 0.5\n\"wheel.wy\" = 6\n\"wheel.wx\" = 0.3\n"), 2.0);
    let moving = wheel.replace("name = \"plane\"\n", "name = \"plane\"\non = \"table\"\n")
        + "[[body]]\nname = \"table\"\nmass = 5\ninertia = [1, 1, 1]\n\
           [[joint]]\nname = \"shake\"\nkind = \"planar\"\nto = \"table\"\n[prescribed]\n\"shake.x\" = \"0.1[m]*sin(3*t)\"\n\
           \"shake.y\" = \"0\"\n\"shake.angle\" = \"0.2*sin(2*t)\"\n";
    check(&format!("{moving}[initial]\n\"wheel.z\" = 0.5\n\"wheel.wy\" = 6\n"), 2.0);
}

/// A rope whose free length a drum pays out pulls at the drum, too.
#[test]
fn a_winch_feels_its_rope() {
    let text = "[[body]]\nname = \"load\"\nmass = 1\n[[joint]]\nname = \"z\"\nkind = \"prismatic\"\nto = \"load\"\n\
                [[body]]\nname = \"wheel\"\nmass = 1\ninertia = [0.1, 0.1, 0.1]\n\
                [[joint]]\nname = \"drum\"\nkind = \"revolute\"\nto = \"wheel\"\n\
                [[spring]]\nname = \"rope\"\nto = \"load\"\nstiffness = \"10 N/m\"\nfree_length = \"0.3[m] + 0.1[m]*drum\"\n\
                [initial]\nz = 0.5\n\"drum'\" = 1\n[outputs]\ncolumns = [\"z\", \"drum\"]\n";
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| {
        o.tolerance = 1e-11;
        o.until = 2.0;
    });
    // s = z − 0.3 − 0.1 φ: s″ = −10 (1 + 0.1²/0.1) s, s(0) = 0.2, s′(0) = −0.1
    let (w, t) = (11.0_f64.sqrt(), 2.0);
    let s = 0.2 * (w * t).cos() - 0.1 / w * (w * t).sin();
    let row = &run.trajectory.rows[run.trajectory.rows.len() - 1];
    assert!((row[0] - 0.3 - 0.1 * row[1] - s).abs() < 1e-9, "{row:?}");
    assert!((row[1] + row[0] - (1.0 * t + 0.5)).abs() < 1e-9, "{row:?}"); // 0.1 φ″ = 0.1 F, z″ = −F: z + φ moves evenly
    assert!(run.report.energy_balance.is_some_and(|b| b < 1e-9));
}

/// A linkage that is to be found from a folded guess.
#[test]
fn folded_places_do_not_hold_the_search_for_a_start() {
    let run = "[initial]\na0 = 0.3\n\"a0'\" = 1\n";
    let text = linkage(&[0.0, 1.0], [0.4, 0.8], run).replace("at = [1, 0, 0]", "at = [1.3, 0, 0]");
    check(&text, 1.0);
}

/// A bowl as a sphere and as a surface given by its height: the same motion and contact force; and waves keep the energy.
#[test]
fn balls_roll_alike_on_a_sphere_and_on_its_height() {
    let ball = "[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"ball\"\nmass = 1\nshape = \"sphere\"\nsize = 0.2\n\
                [[rolling]]\nname = \"c\"\nbody = \"ball\"\nradius = 0.2\n";
    let start = "[initial]\n\"ball.x\" = 0.5\n\"ball.z\" = \"-1[m]*sqrt(0.64 - 0.25)\"\n\"ball.y'\" = 1\n\"ball.x'\" = 0\n\"ball.wx\" = 3\n\
                 [outputs]\ncolumns = [\"ball.x\", \"ball.y\", \"ball.z\", \"ball.wx\", \"c.fx\", \"c.fy\", \"c.fz\", \"system.px'\"]\n";
    let sphere = format!("{ball}surface = \"sphere\"\nsurface_radius = 1\n{start}");
    let height = "surface = \"height\"\nheight = \"-1[m]*sqrt(1 - (c.s/1[m])^2 - (c.t/1[m])^2)\"\n";
    let runs = [sphere, format!("{ball}{height}{start}")].map(|text| {
        let model = read(&text).build().unwrap_or_else(|e| panic!("{e}"));
        done(&model, |o| {
            o.tolerance = 1e-11;
            o.until = 3.0;
        })
    });
    for (a, b) in runs[0].trajectory.rows.iter().zip(&runs[1].trajectory.rows) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7 * a.abs().max(1.0)), "{a:?}\n{b:?}");
        assert!((a[4] - a[7]).abs() < 1e-9 && (b[4] - b[7]).abs() < 1e-9, "the contact alone acts along x: {a:?}");
    }
    let waves = "surface = \"height\"\nheight = \"0.1[m]*sin(2*c.s/1[m])*cos(1.5*c.t/1[m])\"\n";
    check(&format!("{ball}{waves}[initial]\n\"c.s\" = 0.3\n\"c.t\" = 0.2\n\"ball.x'\" = 1\n\"ball.y'\" = 0.4\n"), 5.0);
}
