//! Wheels, discs, rims and ellipsoids that roll on curved ground, and bodies that roll on bodies.

mod common;

use common::{done, read, run_with};
use headland_sim::Run;

const FORMS: [(&str, &str); 4] = [
    ("ball", "radius = 0.3\n"),
    ("disc", "radius = 0.3\naxis = \"y\"\n"),
    ("rim", "radius = 0.25\naxis = \"y\"\ntube = 0.05\n"),
    ("ellipsoid", "semi_axes = [0.3, 0.2, 0.4]\n"),
];

/// A body without symmetry that rolls by a form on a ground.
fn roller(form: &str, ground: &str, extra: &str) -> String {
    format!(
        "[world]\ngravity = [0, 0, -9.81]\n\
         [[body]]\nname = \"b\"\nmass = 1\ninertia = [0.03, 0.05, 0.04, 0.001, 0.002, -0.001]\n\
         [[rolling]]\nname = \"c\"\nbody = \"b\"\ncenter = [0.01, 0.02, -0.01]\n{form}{ground}\
         [initial]\n\"b.x\" = 0.2\n\"b.y\" = 0.1\n\"b.qw\" = 1\n\"b.qx\" = 0.1\n\"b.qy\" = 0.1\n\"b.qz\" = 0.05\n\
         \"b.wx\" = 0.1\n\"b.wy\" = 6\n\"b.wz\" = 0.5\n{extra}\
         [outputs]\ncolumns = [\"b.x\", \"b.y\", \"b.z\", \"b.qw\", \"b.omega_x\", \"b.wy\", \"c.normal\", \"c.fx\", \
         \"c.fy\", \"c.fz\", \"system.px'\", \"system.py'\", \"system.pz' + 9.81[N]\"]\n"
    )
}

fn run(text: &str, until: f64, tolerance: f64) -> Run {
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| (o.tolerance, o.until) = (tolerance, until));
    assert!(run.report.energy_balance.is_some_and(|b| b < 1e-10), "{text}{:?}", run.report.energy_balance);
    run
}

/// All columns up to the given one, relative to max(1, |value|).
fn difference(a: &Run, b: &Run, columns: usize) -> f64 {
    assert_eq!(a.trajectory.rows.len(), b.trajectory.rows.len());
    let rows = a.trajectory.rows.iter().zip(&b.trajectory.rows);
    rows.flat_map(|(a, b)| a.iter().zip(b).take(columns))
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0))
        .fold(0.0, f64::max)
}

/// The last three columns are what the contact force makes of the momentum; x is an axis of every ground.
fn force_moves_the_body(run: &Run) {
    let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for row in &run.trajectory.rows {
        let (force, change) = row[7..].split_at(3);
        let worst = (force[0] - change[0]).abs().max((size(force) - size(change)).abs());
        assert!(worst < 1e-8, "{worst:e}: {row:?}");
    }
}

#[test]
fn a_plane_by_its_height_is_a_plane() {
    let (a, b) = (0.1_f64, -0.2_f64);
    let n = (1.0 + a * a + b * b).sqrt();
    let (roll, pitch) = ((b / n).asin(), (-a).atan2(1.0));
    let plane = format!("on = \"p\"\n[[frame]]\nname = \"p\"\nrpy = [{roll:?}, {pitch:?}, 0]\n");
    let height = format!("surface = \"height\"\nheight = \"{a}*c.s + ({b})*c.t\"\n");
    for (name, form) in FORMS {
        let [by_plane, by_height] = [&plane, &height].map(|ground| run(&roller(form, ground, ""), 2.0, 1e-12));
        let d = difference(&by_height, &by_plane, 7); // up to the force along the normal
        println!("{name}: {d:e}");
        assert!(d < 1e-11, "{name}: {d:e}");
        force_moves_the_body(&by_height);
    }
}

const GROUNDS: [(&str, &str); 5] = [
    ("surface = \"height\"\nheight = \"0.1[m]*sin(2*c.s/1[m])*cos(1.5*c.t/1[m])\"\n", ""),
    ("surface = \"sphere\"\nsurface_radius = 1.5\n", "\"b.z\" = -1.17\n"),
    ("surface = \"sphere\"\nsurface_radius = 1.5\noutside = true\n", "\"b.z\" = 1.77\n"),
    (
        "surface = \"cylinder\"\nsurface_radius = 1.5\non = \"pipe\"\n[[frame]]\nname = \"pipe\"\nrpy = [\"90 deg\", 0, 0]\n",
        "\"b.z\" = -1.17\n",
    ),
    (
        "surface = \"cylinder\"\nsurface_radius = 1.5\noutside = true\non = \"pipe\"\n\
         [[frame]]\nname = \"pipe\"\nrpy = [\"90 deg\", 0, 0]\n",
        "\"b.z\" = 1.77\n",
    ),
];

/// A ball as an ellipsoid of three equal axes; and every form keeps energy, and its contact force is what moves it.
#[test]
fn ellipsoids_of_equal_axes_are_balls() {
    let exact =
        [0.0, -(1.44_f64 - 0.05).sqrt(), (3.24_f64 - 0.05).sqrt(), -(1.44_f64 - 0.04).sqrt(), (3.24_f64 - 0.04).sqrt()];
    for ((ground, start), z) in GROUNDS.into_iter().zip(exact) {
        let start = if start.is_empty() { String::new() } else { format!("\"b.z\" = {z:?}\n") };
        let text = |form| roller(form, ground, &start).replace("center = [0.01, 0.02, -0.01]\n", "");
        let round = run(&text("semi_axes = [0.3, 0.3, 0.3]\n"), 2.0, 1e-12);
        let ball = run(&text(FORMS[0].1).replace("c.normal", "b.vz"), 2.0, 1e-12);
        let d = difference(&round, &ball, 6); // up to the force along the normal
        println!("{d:e}");
        assert!(d < 1e-10, "{ground}: {d:e}");
    }
}

#[test]
fn every_form_keeps_its_energy_on_every_ground() {
    for (_, form) in &FORMS[1..] {
        for (ground, start) in GROUNDS {
            force_moves_the_body(&run(&roller(form, ground, start), 1.5, 1e-11));
        }
    }
}

/// A disc whose contact runs round a horizontal circle at constant lean α, seen from the circle's middle.
///
/// With x from the middle to the contact at `P_x`, z up, disc towards the middle along `u = (−sin α, 0, cos α)`:
/// the centre is at `c_x = P_x − r sin α`, the spin about the axis `a = (cos α, 0, sin α)` is `s = −Ω P_x/r`, and
/// `Ω z × L = −r u × F`, with `F = (−m Ω² c_x, 0, m g)` and L of the disc, gives along y
///
/// ```text
/// Ω² [ r m c_x cos α + J_t cos α sin α − J_a cos α (sin α − P_x/r) ] = r m g sin α
/// ```
/// It is the same on any surface of revolution.
fn steady(ground: &str, place: [f64; 2], towards: f64, m: f64, r: f64) {
    let (g, alpha) = (9.81, towards);
    let (sin, cos) = alpha.sin_cos();
    let (j_t, j_a) = (m * r * r / 4.0, m * r * r / 2.0);
    let c = [place[0] - r * sin, place[1] + r * cos];
    let bracket = r * m * c[0] * cos + j_t * cos * sin - j_a * cos * (sin - place[0] / r);
    let omega = (r * m * g * sin / bracket).sqrt();
    let spin = -omega * place[0] / r;
    let [wy, wz] = [omega * sin + spin, omega * cos];
    let text = format!(
        "[world]\ngravity = [0, 0, -{g}]\n[[frame]]\nname = \"start\"\n\
         at = [{:?}, 0, {:?}]\nrpy = [{alpha:?}, 0, \"-90 deg\"]\n\
         [[body]]\nname = \"d\"\nmass = {m}\nshape = \"disc\"\nsize = {r}\naxis = \"y\"\n\
         [[joint]]\nname = \"j\"\nkind = \"free\"\nfrom = \"start\"\nto = \"d\"\n\
         [[rolling]]\nname = \"c\"\nbody = \"d\"\nradius = {r}\naxis = \"y\"\n{ground}\
         [initial]\n\"j.x\" = 0\n\"j.y\" = 0\n\"j.z\" = 0\n\"j.qw\" = 1\n\"j.qx\" = 0\n\"j.qy\" = 0\n\"j.qz\" = 0\n\
         \"j.wx\" = 0\n\"j.wy\" = {wy:?}\n\"j.wz\" = {wz:?}\n\
         [outputs]\ncolumns = [\"d.x\", \"d.y\", \"d.z\", \"d.eyz\", \"c.along\", \"hypot(c.fx, c.fy)\", \"c.fz\"]\n",
        c[0], c[1]
    );
    let run = run(&text, 2.0, 1e-12);
    let (rows, times) = (&run.trajectory.rows, &run.trajectory.t);
    for (row, t) in rows.iter().zip(times) {
        let phase = omega * t;
        let expected = [c[0] * phase.cos(), c[0] * phase.sin(), c[1], sin, 0.0, m * omega * omega * c[0].abs(), m * g];
        for (k, (found, expected)) in row.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < 1e-8, "{ground}column {k} at {t}: {found} {expected}, {omega}");
        }
    }
}

#[test]
fn discs_run_round_bowls_and_pipes_as_newton_and_euler_say() {
    let at = |radius: f64, angle: f64| [radius * angle.sin(), -radius * angle.cos()];
    let sphere = "surface = \"sphere\"\nsurface_radius = 2\n";
    let bowl = "surface = \"height\"\nheight = \"-1[m]*sqrt(4 - (c.s/1[m])^2 - (c.t/1[m])^2)\"\n";
    for ground in [sphere, bowl] {
        steady(ground, at(2.0, 0.8), 0.5, 1.3, 0.3);
    }
    steady("surface = \"cylinder\"\nsurface_radius = 2\n", [2.0, 0.0], 1.1, 1.3, 0.3);
}

/// On the outside of a hill the disc leans the other way round: towards the middle as well.
#[test]
fn discs_run_round_hills() {
    let hill = "surface = \"height\"\nheight = \"-0.1*c.s^2/1[m] - 0.1*c.t^2/1[m]\"\n";
    steady(hill, [0.8, -0.064], 0.4, 1.3, 0.3);
}

/// A rim that is less curved than a groove would touch it on both sides.
#[test]
fn what_would_touch_in_two_places_is_told() {
    let ground = "surface = \"height\"\nheight = \"2*c.s^2/1[m]\"\n";
    let text = roller(FORMS[1].1, ground, "").replace("\"b.x\" = 0.2", "\"b.x\" = 0");
    let model = read(&text).build().unwrap_or_else(|e| panic!("{e}"));
    let status = format!("{:?}", run_with(&model, |_| {}).report.status);
    assert!(status.contains("would touch in more than one place"), "{status}");
}

/// A surface with a name, in a frame of its own, is the same ground.
#[test]
fn named_surfaces_are_ground_for_wheels() {
    let named = "on = \"bowl\"\n[[surface]]\nname = \"bowl\"\nshape = \"sphere\"\nradius = 1.5\ninside = true\n";
    let [a, b] = [GROUNDS[1].0, named].map(|ground| run(&roller(FORMS[2].1, ground, GROUNDS[1].1), 1.0, 1e-11));
    assert!(difference(&a, &b, 13) < 1e-12);
}

/// Bodies that roll on bodies, nothing else acting: momentum, angular momentum and energy stay, whichever of the two is the
/// ground.
#[test]
fn bodies_that_roll_on_bodies_keep_momentum() {
    let body = |name: &str, mass: f64, r: f64| {
        format!("[[body]]\nname = \"{name}\"\nmass = {mass}\nshape = \"sphere\"\nsize = {r}\n")
    };
    let columns = "[outputs]\ncolumns = [\"a.x\", \"a.y\", \"a.z\", \"b.x\", \"a.omega_x\", \"b.omega_z\", \"system.px\", \
                   \"system.py\", \"system.pz\", \"system.lx\", \"system.ly\", \"system.lz\", \"system.kinetic_energy\"]\n";
    let start = "[initial]\n\"a.x\" = 0\n\"a.y\" = 0\n\"a.z\" = 0\n\"b.x\" = 0.3\n\"b.y\" = 0.4\n\"b.z\" = 1.2\n\
                 \"a.wx\" = 1\n\"a.wy\" = -0.5\n\"a.wz\" = 0.7\n\"b.wx\" = 2\n\"b.wy\" = 1.5\n\"b.wz\" = -3\n\
                 \"a.x'\" = 0.1\n\"a.y'\" = 0.2\n\"a.z'\" = -0.3\n";
    let contact = |body: &str, on: &str, form: &str, radius: f64| {
        format!(
            "[[rolling]]\nname = \"c\"\nbody = \"{body}\"\non = \"{on}\"\n{form}surface = \"sphere\"\n\
             surface_radius = {radius}\noutside = true\n"
        )
    };
    let bodies = format!("{}{}", body("a", 2.0, 0.9), body("b", 1.0, 0.4));
    let texts = [
        contact("b", "a", "radius = 0.4\n", 0.9),
        contact("a", "b", "radius = 0.9\n", 0.4),
        contact("b", "a", "semi_axes = [0.4, 0.4, 0.4]\n", 0.9),
        contact("a", "b", "semi_axes = [0.9, 0.9, 0.9]\n", 0.4),
    ];
    let runs = texts.map(|contact| run(&format!("{bodies}{contact}{start}{columns}"), 2.0, 1e-12));
    for r in &runs {
        assert!(
            difference(r, &runs[0], 13) < 1e-9,
            "{:?}\n{:?}",
            r.trajectory.rows.last(),
            runs[0].trajectory.rows.last()
        );
        let first = &r.trajectory.rows[0];
        for row in &r.trajectory.rows {
            let worst = (6..13).map(|k| (row[k] - first[k]).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "{worst:e} {row:?}\n{first:?}");
        }
    }
}

/// A ball on top of a ball that turns about its middle as it likes, gravity down: while the line of centres stays in a plane
/// both only turn about its normal and
///
/// ```text
/// (m + k) L θ″ = m g sin θ,   k = 1/(R²/I_a + r²/I_b),   L = R + r
/// ```
/// No slip `R w_a + r w_b = L θ′`, both counted along their turn, one tangential force T on both,
/// `I_a w_a′ = R T`, `I_b w_b′ = r T`, `m L θ″ = m g sin θ − T`: `T = L θ″/(R²/I_a + r²/I_b)`.
#[test]
fn a_ball_rolls_off_a_ball_that_turns() {
    let (big, small, m_a, m, g) = (0.9_f64, 0.4_f64, 2.0_f64, 1.0_f64, 9.81_f64);
    let text = format!(
        "[world]\ngravity = [0, 0, -{g}]\n\
         [[body]]\nname = \"a\"\nmass = {m_a}\nshape = \"sphere\"\nsize = {big}\n\
         [[joint]]\nname = \"pivot\"\nkind = \"spherical\"\nto = \"a\"\n\
         [[body]]\nname = \"b\"\nmass = {m}\nshape = \"sphere\"\nsize = {small}\n\
         [[rolling]]\nname = \"c\"\nbody = \"b\"\non = \"a\"\nradius = {small}\nsurface = \"sphere\"\n\
         surface_radius = {big}\noutside = true\n\
         [initial]\n\"b.x\" = {:?}\n\"b.y\" = 0\n\"b.z\" = {:?}\n\"b.x'\" = 0\n\"b.z'\" = 0\n\"pivot.wy\" = 0\n\
         [outputs]\ncolumns = [\"b.x\", \"b.z\", \"a.wy\", \"b.wy\"]\n",
        1.3 * 0.2_f64.sin(),
        1.3 * 0.2_f64.cos(),
    );
    let run = run(&text, 0.6, 1e-12);
    let (i_a, i_b, l) = (0.4 * m_a * big * big, 0.4 * m * small * small, big + small);
    let k = 1.0 / (big * big / i_a + small * small / i_b); // T = k L θ″
    let rate = |theta: f64| m * g * theta.sin() / ((m + k) * l);
    // θ″ by Runge and Kutta's method of order 4 in small steps
    let (mut theta, mut omega, mut t) = (0.2_f64, 0.0_f64, 0.0_f64);
    for (row, &end) in run.trajectory.rows.iter().zip(&run.trajectory.t) {
        let n = ((end - t) / 1e-4).ceil().max(1.0);
        let h = (end - t) / n;
        for _ in 0..n as usize {
            let (k1, l1) = (omega, rate(theta));
            let (k2, l2) = (omega + 0.5 * h * l1, rate(theta + 0.5 * h * k1));
            let (k3, l3) = (omega + 0.5 * h * l2, rate(theta + 0.5 * h * k2));
            let (k4, l4) = (omega + h * l3, rate(theta + h * k3));
            theta += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            omega += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
        }
        t = end;
        let tangential = k * l * omega; // ∫ T
        // b moves to +x: it turns about +y; the ball below turns against it
        let expected = [l * theta.sin(), l * theta.cos(), big * tangential / i_a, small * tangential / i_b];
        for (k, (found, expected)) in row.iter().zip(expected).enumerate() {
            assert!((found.abs() - expected.abs()).abs() < 1e-9, "column {k} at {t}: {row:?} {expected}");
        }
    }
}
