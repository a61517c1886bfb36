//! Balls on every `[[surface]]`: energy, the same surface said in two ways, and what is wrong is told.

mod common;

use common::{done, read, run_with};
use headland_sim::Run;

/// A ball on a surface by `[[rolling]]` or `[[contact]]`, from a place with velocities.
fn scene(section: &str, keys: &str, surface: &str, start: &str) -> String {
    format!(
        "[world]\ngravity = [0, 0, -9.81]\n\
         [[body]]\nname = \"ball\"\nmass = 1.2\nshape = \"sphere\"\nsize = 0.1\n\
         [[surface]]\nname = \"ground\"\n{surface}\
         [[{section}]]\nname = \"c\"\nbody = \"ball\"\non = \"ground\"\nradius = 0.1\n{keys}\
         [initial]\n{start}\
         [outputs]\ncolumns = [\"ball.x\", \"ball.y\", \"ball.z\", \"ball.omega_x\", \"ball.omega_y\", \"ball.omega_z\"]\n"
    )
}

fn run(text: &str, until: f64) -> Run {
    let model = read(text).build().unwrap_or_else(|e| panic!("{text}\n{e}"));
    done(&model, |o| (o.tolerance, o.until, o.method) = (1e-13, until, "dop853".into()))
}

/// Largest difference of any column.
fn difference(a: &Run, b: &Run) -> f64 {
    assert_eq!(a.trajectory.rows.len(), b.trajectory.rows.len());
    let rows = a.trajectory.rows.iter().zip(&b.trajectory.rows);
    rows.flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Both begin with what the scene leaves open of the spin found from no slip.
const SECTIONS: [(&str, &str); 2] = [("rolling", ""), ("contact", "start = \"rolling\"\n")];
const FUNNEL: &str = "shape = \"cone\"\nhalf_angle = \"50 deg\"\ninside = true\n";
const TUBE: &str = "shape = \"torus\"\nradius = 2\ntube = 0.5\ninside = true\n";
const BOWL: &str = "shape = \"ellipsoid\"\nsemi_axes = [1.5, 1.2, 0.9]\ninside = true\n";
const ON_FUNNEL: &str = "\"ball.x\" = 0.5\n\"ball.y\" = 0\n\"ball.z\" = \"(0.1[m] + 0.5[m]*cos(50[deg]))/sin(50[deg])\"\n\
    \"ball.y'\" = 1.2\n\"ball.wz\" = 3\n";
const IN_TUBE: &str =
    "\"ball.x\" = 2.1\n\"ball.y\" = 0\n\"ball.z\" = \"-sqrt(0.15[m^2])\"\n\"ball.y'\" = 0.7\n\"ball.wz\" = 2\n";
const IN_BOWL: &str =
    "\"ball.x\" = 0\n\"ball.y\" = 0\n\"ball.z\" = -0.8\n\"ball.x'\" = 0.6\n\"ball.y'\" = 1.8\n\"ball.wz\" = 4\n";

#[test]
fn energy_is_kept_on_cone_torus_and_ellipsoid() {
    for (name, surface, start) in [("cone", FUNNEL, ON_FUNNEL), ("torus", TUBE, IN_TUBE), ("ellipsoid", BOWL, IN_BOWL)]
    {
        for (section, keys) in SECTIONS {
            let run = run(&scene(section, keys, surface, start), 10.0);
            let balance = run.report.energy_balance.expect("a balance");
            let moved =
                run.trajectory.rows.iter().map(|r| (r[1] - run.trajectory.rows[0][1]).abs()).fold(0.0, f64::max);
            println!("{name} {section}: {balance:e}, moved {moved}");
            assert!(balance < 1e-11 && moved > 0.1, "{name} {section}: {balance:e}, moved {moved}");
        }
    }
}

#[test]
fn one_surface_said_in_two_ways() {
    let sphere = "shape = \"sphere\"\nradius = 1\ninside = true\n";
    let in_sphere =
        "\"ball.x\" = 0.4\n\"ball.y\" = 0.2\n\"ball.z\" = \"-sqrt(0.61[m^2])\"\n\"ball.y'\" = 0.5\n\"ball.wz\" = 4\n";
    let out_sphere = "shape = \"sphere\"\nradius = 1\n";
    let on_top = "\"ball.x\" = 0.02\n\"ball.y\" = 0.01\n\"ball.z\" = \"sqrt(1.2095[m^2])\"\n\"ball.y'\" = 0.1\n\"ball.wz\" = 4\n";
    let plane = "shape = \"plane\"\nrpy = [\"atan(0.2)\", 0, 0]\n";
    let rests = "\"ball.x\" = 0.4\n\"ball.y\" = 0.2\n\"ball.z\" = \"0.04[m] + 0.1[m]*sqrt(1.04)\"\n\"ball.x'\" = 0.5\n\"ball.wz\" = 4\n";
    let cases = [
        ("ellipsoid", sphere, "shape = \"ellipsoid\"\nsemi_axes = [1, 1, 1]\ninside = true\n", in_sphere, 5.0),
        ("bowl by z", sphere, "shape = \"height\"\nheight = \"-sqrt(1[m^2] - x^2 - y^2)\"\n", in_sphere, 5.0),
        ("cap", out_sphere, "shape = \"height\"\nheight = \"sqrt(1[m^2] - x^2 - y^2)\"\n", on_top, 0.5), // before errors have grown
        (
            "bowl of revolution",
            sphere,
            "shape = \"revolution\"\nprofile = \"-sqrt(1[m^2] - r^2)\"\nrange = [0, 0.99]\n",
            in_sphere,
            5.0,
        ),
        ("plane by z", plane, "shape = \"height\"\nheight = \"0.2*y\"\n", rests, 2.0),
    ];
    for (name, one, other, start, until) in cases {
        for (section, keys) in SECTIONS {
            let runs = [one, other].map(|surface| run(&scene(section, keys, surface, start), until));
            let worst = difference(&runs[0], &runs[1]);
            println!("{name} {section}: {worst:e}");
            assert!(worst < 1e-11, "{name} {section}: {worst:e}");
        }
    }
}

/// A polynomial that a spline of degree 5 has exactly, by its table, by its formula, and half by each.
#[test]
fn a_table_is_ground_as_its_formula_is() {
    let places: Vec<f64> = (-8..=8).map(|i| 0.25 * f64::from(i)).collect();
    let bowl = |x: f64, y: f64| 0.2 * x * x + 0.3 * y * y + 0.05 * x * x * x * y;
    let rows: Vec<Vec<f64>> = places.iter().map(|y| places.iter().map(|x| bowl(*x, *y)).collect()).collect();
    let start = format!(
        "\"ball.x\" = 0\n\"ball.y\" = 0\n\"ball.z\" = 0.1\n\"ball.x'\" = 1.1\n\"ball.y'\" = 0.8\n\"ball.wz\" = 3\n\
         [tables]\nhills = {{ x = {places:?}, y = {places:?}, z = {rows:?}, x_unit = \"m\", y_unit = \"m\", z_unit = \"m\" }}\n"
    );
    let formula = "0.2[1/m]*x^2 + 0.3[1/m]*y^2 + 0.05[1/m^3]*x^3*y";
    for (section, keys) in SECTIONS {
        let by = |height: &str| {
            run(&scene(section, keys, &format!("shape = \"height\"\nheight = \"{height}\"\n"), &start), 3.0)
        };
        let wanted = by(formula);
        for height in ["hills(x, y)".to_string(), format!("0.5*hills(x, y) + 0.5*({formula})")] {
            let worst = difference(&by(&height), &wanted);
            println!("{section} {height}: {worst:e}");
            assert!(worst < 1e-11, "{section} {height}: {worst:e}");
        }
    }
}

/// What is no ball has a place of contact with coordinates of its own: with the third derivatives of the distance.
#[test]
fn discs_keep_their_energy_in_ellipsoids_and_on_heights() {
    let surfaces = [
        BOWL,
        "shape = \"height\"\nheight = \"0.2[1/m]*x^2 + 0.3[1/m]*y^2\"\nat = [0, 0, -0.9]\n",
        "shape = \"revolution\"\nprofile = \"0.3*r^2/1[m] - 0.9[m]\"\nrange = [0, 2]\n",
    ];
    for surface in surfaces {
        let start = "\"ball.x\" = 0.1\n\"ball.y\" = 0\n\"ball.qw\" = 1\n\"ball.qx\" = 0.1\n\"ball.qy\" = 0\n\"ball.qz\" = 0\n\
                     \"ball.z\" = -0.8\n\"ball.wy\" = 6\n\"ball.wx\" = 0\n\"ball.wz\" = 0.5\n";
        let run = run(&scene("rolling", "axis = \"y\"\n", surface, start), 2.0);
        let balance = run.report.energy_balance.expect("a balance");
        let moved = run.trajectory.rows.iter().map(|r| (r[0] - run.trajectory.rows[0][0]).abs()).fold(0.0, f64::max);
        println!("{surface}{balance:e}, moved {moved}");
        assert!(balance < 1e-11 && moved > 0.1, "{surface}{balance:e}, moved {moved}");
    }
}

/// Builds or begins, and must say why not.
fn refused(text: &str) -> String {
    match read(text).build() {
        Err(error) => error.to_string(),
        Ok(model) => format!("{:?}", run_with(&model, |o| o.until = 2.0).report.status),
    }
}

#[test]
fn what_is_wrong_is_told() {
    let start = "\"ball.z\" = 0.5\n";
    let cases = [
        ("shape = \"bowl\"\n", "unknown shape \"bowl\"; known: plane, sphere"),
        ("shape = \"sphere\"\n", "this surface needs `radius`"),
        ("shape = \"sphere\"\nradius = -1\n", "`radius` is -1 m; it must be above 0"),
        ("shape = \"sphere\"\nradius = 0.1\ninside = true\n", "a ball of radius 0.1 m does not fit inside the sphere"),
        (
            "shape = \"sphere\"\nradius = 1\ntube = 0.1\n",
            "`tube` means nothing here: the shape is \"sphere\"; it belongs to \"torus\"",
        ),
        ("shape = \"plane\"\ninside = true\n", "`inside` means nothing here"),
        ("shape = \"cone\"\n", "this surface needs `half_angle`"),
        ("shape = \"cone\"\nhalf_angle = \"95 deg\"\n", "half-angle is 95"),
        ("shape = \"torus\"\nradius = 1\ntube = 2\n", "closes its hole"),
        ("shape = \"torus\"\nradius = 1\ntube = 0.09\ninside = true\n", "does not fit inside the tube of the torus"),
        ("shape = \"ellipsoid\"\n", "this surface needs `semi_axes = [a, b, c]`"),
        ("shape = \"ellipsoid\"\nsemi_axes = [1, 1, 0]\n", "`semi_axes` is 0 m"),
        ("shape = \"ellipsoid\"\nsemi_axes = [1, 1, 0.3]\ninside = true\n", "ellipsoid's sharpest bend"),
        ("shape = \"revolution\"\nrange = [0, 1]\n", "this surface needs `profile`"),
        ("shape = \"revolution\"\nprofile = \"r^2/1[m]\"\n", "this surface needs `range = [from, to]`"),
        ("shape = \"revolution\"\nprofile = \"r + z\"\nrange = [0, 1]\n", "not of both"),
        ("shape = \"revolution\"\nprofile = \"r\"\nrange = [0, 1]\n", "slope 1 on the axis"),
        ("shape = \"revolution\"\nprofile = \"z\"\nrange = [-1, 1]\n", "a radius positive"),
        ("shape = \"height\"\n", "this surface needs `height`"),
        (
            "shape = \"height\"\nheight = \"0.1*x + 0.01[m/s]*t\"\n",
            "`height` depends on `t`; it is made of `x`, `y` and parameters",
        ),
        ("shape = \"height\"\nheight = \"x^2\"\n", "`height` is a length [m]"),
        // a valley that narrows downhill: its curvature goes through that of the ball
        ("shape = \"height\"\nheight = \"-0.1*x + (2[1/m] + 8[1/m^2]*x)*y^2\"\n", "touch in more than one place"),
        ("shape = \"height\"\nheight = \"1[m] + 0.1*x\"\n", "inside its surface"),
    ];
    for (surface, wanted) in cases {
        let start = if surface.contains("8[1/m^2]") { "\"ball.z\" = \"0.1[m]*sqrt(1.01)\"\n" } else { start };
        let message = refused(&scene("contact", "", surface, start));
        assert!(message.contains(wanted), "{surface}wanted: {wanted}\nfound: {message}");
    }
}
