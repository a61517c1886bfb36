//! Motion on ground given by points: the same as on the formula where the spline has it exactly.

mod common;

use common::{done, read};

/// A bowl, a polynomial of degree 5 at most along each axis, so that a spline of degree 5 is it.
fn bowl(x: f64, y: f64) -> f64 {
    0.2 * x * x + 0.3 * y * y + 0.05 * x * y + 0.02 * x * x * x * y
}
const FORMULA: &str = "0.2*(A)^2 + 0.3*(B)^2 + 0.05*(A)*(B) + 0.02*(A)^3*(B)";

/// The bowl as a table of SI numbers over 4 m × 4 m.
fn table() -> String {
    let places: Vec<f64> = (-8..=8).map(|i| 0.25 * f64::from(i)).collect();
    let rows: Vec<Vec<f64>> = places.iter().map(|y| places.iter().map(|x| bowl(*x, *y)).collect()).collect();
    format!(
        "[tables]\nground = {{ x = {places:?}, y = {places:?}, z = {rows:?}, x_unit = \"m\", y_unit = \"m\", z_unit = \"m\" }}\n"
    )
}

/// The formula with places in metres.
fn formula(a: &str, b: &str) -> String {
    format!("1[m]*({})", FORMULA.replace('A', &format!("{a}/1[m]")).replace('B', &format!("{b}/1[m]")))
}

/// Runs the scene with the height from the table and from the formula; all columns agree.
fn alike(scene: impl Fn(&str) -> String, places: [&str; 2], methods: &[(&str, f64)]) {
    let by_table = format!("{}{}", table(), scene(&format!("ground({}, {})", places[0], places[1])));
    let by_formula = scene(&formula(places[0], places[1]));
    for (method, tolerance) in methods {
        let runs = [&by_table, &by_formula].map(|text| {
            let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
            done(&model, |o| {
                o.method = (*method).into();
                o.tolerance = 1e-10;
                o.until = 3.0;
            })
        });
        assert!(
            runs[0].report.energy_balance.is_some_and(|b| b < 1e-6),
            "{method}: {:?}",
            runs[0].report.energy_balance
        );
        let mut moved = 0.0f64;
        for (a, b) in runs[0].trajectory.rows.iter().zip(&runs[1].trajectory.rows) {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < *tolerance), "{method}: {a:?}\n{b:?}");
            moved = moved.max((a[1] - runs[0].trajectory.rows[0][1]).abs());
        }
        assert!(moved > 0.5, "{method}: moved {moved}");
    }
}

fn methods() -> Vec<(&'static str, f64)> {
    let mut methods = vec![("dop853", 1e-7)];
    if cfg!(feature = "cvode") {
        methods.push(("cvode-bdf", 1e-5));
    }
    if cfg!(feature = "ida") {
        methods.push(("ida", 1e-4));
    }
    methods
}

/// A constraint on positions: the rows need the gradient, their rates the second, an exact Jacobian the third derivatives.
#[test]
fn a_bead_on_a_table_moves_as_on_its_formula() {
    let scene = |height: &str| {
        format!(
            "[coordinates]\nx = \"m\"\ny = \"m\"\nz = \"m\"\n\
             [initial]\nx = 1\ny = 0.4\nz = 0.276\n\"x'\" = 0.2\n\"y'\" = 0.9\n\
             [[constraint]]\nname = \"c\"\nequation = \"z = {height}\"\n\
             [[inertia]]\nname = \"m\"\nmass = \"1 kg\"\nposition = [\"x\", \"y\", \"z\"]\n\
             [[force]]\nname = \"g\"\nforce = [\"0\", \"0\", \"-9.81[N]\"]\nposition = [\"x\", \"y\", \"z\"]\n\
             [outputs]\ncolumns = [\"x\", \"y\", \"z\", \"x'\"]\n"
        )
    };
    alike(scene, ["x", "y"], &methods());
}

/// A ball on a surface given by its height: the normal's rate is in the equations, so an exact Jacobian would need fourth
/// derivatives; implicit methods then take differences.
#[test]
fn a_ball_rolls_on_a_table_as_on_its_formula() {
    let scene = |height: &str| {
        format!(
            "[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"ball\"\nmass = 1\nshape = \"sphere\"\nsize = 0.2\n\
             [[rolling]]\nname = \"c\"\nbody = \"ball\"\nradius = 0.2\nsurface = \"height\"\nheight = \"{height}\"\n\
             [initial]\n\"c.s\" = 0.9\n\"c.t\" = 0.3\n\"ball.x'\" = 0\n\"ball.y'\" = 0.8\n\"ball.wz\" = 0.5\n\
             [outputs]\ncolumns = [\"ball.x\", \"ball.y\", \"ball.z\", \"ball.wx\"]\n"
        )
    };
    alike(scene, ["c.s", "c.t"], &methods());
}
