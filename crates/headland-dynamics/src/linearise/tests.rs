use super::*;
use crate::derive::{DeriveOptions, derive};
use headland_model::Scene;

const DISC: &str = include_str!("../../../../validation/scenes/rolling_disc.toml");

fn linear(text: &str, set: &[(&str, &str)], inputs: &[&str]) -> Result<Linearised, LineariseError> {
    let mut scene = Scene::parse("test.toml", text).unwrap_or_else(|e| panic!("{e}"));
    for (name, value) in set {
        scene.set(name, value).unwrap_or_else(|e| panic!("{e}"));
    }
    let model = scene.build().unwrap_or_else(|e| panic!("{e}"));
    let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let y = start_of(&model, &equations).unwrap_or_else(|e| panic!("{e}"));
    let inputs: Vec<String> = inputs.iter().map(|s| (*s).to_string()).collect();
    linearise(&model, &equations, model.run.from, &y, &inputs)
}

fn good(text: &str, set: &[(&str, &str)], inputs: &[&str]) -> Linearised {
    linear(text, set, inputs).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(text: &str, set: &[(&str, &str)], inputs: &[&str], parts: &[&str]) {
    match linear(text, set, inputs) {
        Ok(linear) => panic!("{set:?}: linearised: {}", linear.a),
        Err(error) => {
            let message = error.to_string();
            for part in parts {
                assert!(message.contains(part), "no `{part}` in\n{message}");
            }
        }
    }
}

fn names(linear: &Linearised, cyclic: bool) -> Vec<&str> {
    linear.states.iter().filter(|s| s.cyclic == cyclic).map(|s| s.name.as_str()).collect()
}

/// Each eigenvalue is there, and no other.
#[track_caller]
fn has_eigenvalues(linear: &Linearised, expected: &[(f64, f64)], tolerance: f64) {
    let mut modes = linear.modes().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(modes.len(), expected.len(), "{modes:?}");
    for &(re, im) in expected {
        let distance = |m: &Mode| (m.re - re).hypot(m.im - im);
        let nearest = (0..modes.len()).min_by(|&i, &k| distance(&modes[i]).total_cmp(&distance(&modes[k])));
        let found = modes.remove(nearest.unwrap_or_default());
        let size = re.hypot(im).max(1.0);
        assert!(distance(&found) <= tolerance * size, "{re} + {im} i: {found:?} is the nearest");
    }
}

fn close(a: Option<f64>, b: f64) {
    let a = a.unwrap_or(f64::NAN);
    assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} for {b}");
}

const OSCILLATOR: &str = r#"
title = "oscillator"
[parameters]
m = "2 kg"
b = "0.6 N*s/m"
c = "50 N/m"
F = "0 N"
rest = "0.1 m"
[coordinates]
x = "m"
[[inertia]]
name = "m"
value = "m"
geometric = "x"
[[elastic]]
name = "c"
value = "c"
geometric = "x - rest"
[[dissipative]]
name = "b"
value = "b"
geometric = "x"
[[force]]
name = "F"
value = "F"
geometric = "x"
[initial]
x = "rest"
"x'" = 0
"#;

#[test]
fn damped_oscillator() {
    let linear = good(OSCILLATOR, &[], &["F", "rest"]);
    assert!(linear.at_rest);
    assert_eq!(linear.a, DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -25.0, -0.3]));
    assert_eq!(linear.b, DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.5, 25.0]));
    let damped = (25.0_f64 - 0.15 * 0.15).sqrt();
    has_eigenvalues(&linear, &[(-0.15, damped), (-0.15, -damped)], 1e-15);
    let mode = &linear.modes().unwrap()[0];
    assert!((mode.frequency() - damped / std::f64::consts::TAU).abs() < 1e-15);
    assert!((mode.damping().unwrap() - 0.03).abs() < 1e-15);
    assert!((mode.half_life().unwrap() - std::f64::consts::LN_2 / 0.15).abs() < 1e-13);
}

#[test]
fn what_is_no_equilibrium_is_refused() {
    refused(OSCILLATOR, &[("x", "0.3")], &[], &["neither an equilibrium", "(x')′ = -5.000e0 m/s^2", "--set"]);
    refused(OSCILLATOR, &[("F", "3")], &[], &["(x')′ = 1.500e0"]);
    // u′ = 0 for an instant only: at the largest speed without damping
    refused(OSCILLATOR, &[("x'", "1"), ("b", "0")], &[], &["neither an equilibrium", "s later"]);
    refused(OSCILLATOR, &[], &["f"], &["the input `f` is not a parameter", "m, b, c, F, rest"]);
}

#[test]
fn double_pendulum() {
    let text = r#"
title = "double pendulum"
[parameters]
m = "1 kg"
l = "0.7 m"
g = "9.81 m/s^2"
[world]
gravity = ["0", "0", "-g"]
[[body]]
name = "one"
mass = "m"
center = ["0", "0", "-l"]
[[body]]
name = "two"
mass = "m"
center = ["0", "0", "-l"]
[[joint]]
name = "a"
kind = "revolute"
to = "one"
axis = "y"
[[joint]]
name = "b"
kind = "revolute"
from = "one"
at = ["0", "0", "-l"]
to = "two"
axis = "y"
[initial]
a = 0
"#;
    let linear = good(text, &[], &[]);
    let w = |sign: f64| (9.81 / 0.7 * (2.0 + sign * 2.0_f64.sqrt())).sqrt();
    has_eigenvalues(&linear, &[(0.0, w(1.0)), (0.0, -w(1.0)), (0.0, w(-1.0)), (0.0, -w(-1.0))], 1e-14);
    // upside down, both ways of standing: as many growing modes as links stand
    let inverted = good(text, &[("a", "pi")], &[]);
    let real = |sign: f64| (9.81 / 0.7 * (2.0 + sign * 2.0_f64.sqrt())).sqrt();
    has_eigenvalues(&inverted, &[(real(1.0), 0.0), (-real(1.0), 0.0), (real(-1.0), 0.0), (-real(-1.0), 0.0)], 1e-13);
}

#[test]
fn disc_rolling_straight_is_stable_above_its_speed() {
    let (g, r) = (9.81, 0.3);
    let limit = f64::sqrt(g / (3.0 * r));
    for spin in [0.0, 0.5, 0.99 * limit, 1.01 * limit, 8.0] {
        let u_2 = spin.to_string();
        let linear = good(DISC, &[("lean", "0"), ("u_1", "0"), ("u_2", &u_2), ("u_3", "0")], &[]);
        assert_eq!(names(&linear, true), ["x", "y", "yaw", "spin"]);
        assert_eq!(names(&linear, false), ["lean", "u_1", "u_2", "u_3"]);
        let square: f64 = 0.8 * (g / r - 3.0 * spin * spin);
        let root = square.abs().sqrt();
        let pair = if square > 0.0 { [(root, 0.0), (-root, 0.0)] } else { [(0.0, root), (0.0, -root)] };
        has_eigenvalues(&linear, &[pair[0], pair[1], (0.0, 0.0), (0.0, 0.0)], 1e-12);
        let grows = linear.modes().unwrap()[0].re > 1e-9;
        assert_eq!(grows, spin < limit, "spin {spin}");
        assert_eq!(linear.at_rest, spin == 0.0);
    }
}

/// Sympy's rolling disc: 5 r u1′ = 4 g sin θ + 6 r u2 u3 − r u3² tan θ, 3 u2′ = −2 u1 u3, u3′ = −2 u1 u2 + u1 u3 tan θ.
#[test]
fn disc_rolling_in_a_circle() {
    let (g, r, lean, u3): (f64, f64, f64, f64) = (9.81, 0.3, 0.35, 1.7);
    let (sin, cos, tan) = (lean.sin(), lean.cos(), lean.tan());
    let u2 = (r * u3 * u3 * tan - 4.0 * g * sin) / (6.0 * r * u3);
    let (text_2, text_3, text_lean) = (format!("{u2:.17e}"), u3.to_string(), lean.to_string());
    let set = [("lean", text_lean.as_str()), ("u_1", "0"), ("u_2", &text_2), ("u_3", &text_3)];
    let linear = good(DISC, &set, &[]);
    assert_eq!(names(&linear, true), ["x", "y", "yaw", "spin"]);
    close(linear.entry("lean", "u_1"), 1.0);
    close(linear.entry("u_1", "lean"), (4.0 * g * cos - u3 * u3 * r / (cos * cos)) / (5.0 * r));
    close(linear.entry("u_1", "u_2"), 1.2 * u3);
    close(linear.entry("u_1", "u_3"), 1.2 * u2 - 0.4 * u3 * tan);
    close(linear.entry("u_2", "u_1"), -2.0 / 3.0 * u3);
    close(linear.entry("u_3", "u_1"), -2.0 * u2 + u3 * tan);
    for (row, column) in [("u_1", "u_1"), ("u_2", "lean"), ("u_2", "u_2"), ("u_3", "lean"), ("u_3", "u_3")] {
        close(linear.entry(row, column), 0.0);
    }
    // a little beside the circle
    refused(DISC, &[set[0], set[1], ("u_2", "-8"), set[3]], &[], &["(u_1)′"]);
}

/// The disc by joints: a carrier without mass that yaws and leans, or a quaternion.
const BODY: &str = r#"
title = "disc by joints"
[parameters]
m = "1 kg"
r = "0.3 m"
g = "9.81 m/s^2"
push = "0 N*m"
[world]
gravity = ["0", "0", "-g"]
[[body]]
name = "disc"
mass = "m"
shape = "disc"
axis = "y"
size = "r"
[[rolling]]
name = "contact"
body = "disc"
axis = "y"
radius = "r"
"#;

const CARRIED: &str = r#"
[[body]]
name = "carrier"
[[body]]
name = "lift"
[[body]]
name = "yoke"
[[joint]]
name = "ground"
kind = "planar"
to = "carrier"
[[joint]]
name = "height"
kind = "prismatic"
from = "carrier"
to = "lift"
[[joint]]
name = "lean"
kind = "revolute"
axis = "x"
from = "lift"
to = "yoke"
[[joint]]
name = "spin"
kind = "revolute"
axis = "y"
from = "yoke"
to = "disc"
[[force]]
name = "push"
value = "push"
geometric = "spin"
[run]
independent = ["ground.angle'", "lean'", "spin'"]
[initial]
height = "r"
"ground.angle" = 0
"spin" = 0
"ground.angle'" = 0
"lean'" = 0
"spin'" = "4 rad/s"
"#;

const QUATERNION: &str = r#"
[initial]
"disc.z" = "r"
"disc.wy" = 0
"disc.wx" = 0
"disc.wz" = 0
"#;

#[test]
fn disc_by_joints() {
    let text = format!("{BODY}{CARRIED}");
    for (yaw, spin) in [("0", "0"), ("0.7", "0.4"), ("-2.1", "5")] {
        let linear = good(&text, &[("ground.angle", yaw), ("spin", spin)], &["push"]);
        assert_eq!(names(&linear, true), ["ground.x", "ground.y", "ground.angle", "spin"]);
        let root = (0.8_f64 * (3.0 * 16.0 - 9.81 / 0.3)).sqrt();
        has_eigenvalues(&linear, &[(0.0, root), (0.0, -root), (0.0, 0.0), (0.0, 0.0)], 1e-12);
        let row = linear.states.iter().position(|s| s.name == "spin'").unwrap();
        assert!((linear.b[(row, 0)] - 1.0 / (1.5 * 0.09)).abs() < 1e-12);
    }
    // a contact point that would have to jump
    refused(&text, &[], &["r"], &["`r` cannot be an input"]);
}

#[test]
fn disc_with_a_quaternion() {
    let text = format!("{BODY}{QUATERNION}");
    let standing = good(&text, &[], &[]);
    let root = (0.8 * 9.81 / 0.3_f64).sqrt();
    assert!(standing.at_rest);
    assert!(names(&standing, false).contains(&"∫disc.wx"), "{:?}", standing.states);
    has_eigenvalues(&standing, &[(root, 0.0), (-root, 0.0), (0.0, 0.0), (0.0, 0.0)], 1e-12);
}

/// The disc or ring as a free body: on its way with the lean, spun by an angle before, headed anywhere.
fn rolling_freely(
    body: &str,
    [heading, lean, spun]: [f64; 3],
    [u2, u3]: [f64; 2],
) -> Result<Linearised, LineariseError> {
    let half = |angle: f64| (0.5 * angle).sin_cos();
    let product = |[a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]| {
        let (w, x) = (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g);
        [w, x, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e]
    };
    let (z, x, y) = (half(heading), half(lean), half(spun));
    let about = product([z.1, 0.0, 0.0, z.0], [x.1, x.0, 0.0, 0.0]);
    let [qw, qx, qy, qz] = product(about, [y.1, 0.0, y.0, 0.0]);
    let (wx, wz) = (-spun.sin() * u3, spun.cos() * u3);
    let text = format!(
        "{body}[initial]\n\"disc.qw\" = {qw:e}\n\"disc.qx\" = {qx:e}\n\"disc.qy\" = {qy:e}\n\"disc.qz\" = {qz:e}\n\
         \"disc.wx\" = {wx:e}\n\"disc.wy\" = {u2:e}\n\"disc.wz\" = {wz:e}\n"
    );
    linear(&text, &[], &[])
}

/// Straight on: `(I + m r²) lean″ = (m g r − J (J + m r²) w²/I) lean`, I across, J about the axis. A disc stands from
/// v² = g r/3 on, a ring from g r/4.
#[test]
fn disc_and_ring_with_a_quaternion_roll_straight() {
    let ring =
        BODY.replace("shape = \"disc\"\naxis = \"y\"\nsize = \"r\"", "inertia = [\"m*r^2/2\", \"m*r^2\", \"m*r^2/2\"]");
    let (g, r): (f64, f64) = (9.81, 0.3);
    for (body, across, axial, limit) in [(BODY, 0.25, 0.5, g * r / 3.0), (ring.as_str(), 0.5, 1.0, g * r / 4.0)] {
        for part in [0.5_f64, 1.0 - 1e-4, 1.0 + 1e-4, 3.0] {
            let spin = (part * limit).sqrt() / r;
            let square = (g / r - axial * (axial + 1.0) / across * spin * spin) / (across + 1.0);
            let root = square.abs().sqrt();
            for angles in [[0.0; 3], [0.7, 0.0, 0.4], [-2.1, 0.0, 5.0]] {
                let linear = rolling_freely(body, angles, [spin, 0.0]).unwrap_or_else(|e| panic!("{angles:?}: {e}"));
                assert!(
                    names(&linear, true).starts_with(&["precession of disc", "spin of disc"]),
                    "{:?}",
                    linear.states
                );
                let pair = if square > 0.0 { [(root, 0.0), (-root, 0.0)] } else { [(0.0, root), (0.0, -root)] };
                has_eigenvalues(&linear, &[pair[0], pair[1], (0.0, 0.0), (0.0, 0.0)], 1e-10);
                assert_eq!(linear.modes().unwrap()[0].re > 1e-6, part < 1.0, "{part}");
            }
        }
    }
}

/// In a circle, by sympy's equations as in [`disc_rolling_in_a_circle`].
#[test]
fn disc_with_a_quaternion_rolls_in_a_circle() {
    let (g, r, lean, u3): (f64, f64, f64, f64) = (9.81, 0.3, 0.35, 1.7);
    let (sin, cos, tan) = (lean.sin(), lean.cos(), lean.tan());
    let u2 = (r * u3 * u3 * tan - 4.0 * g * sin) / (6.0 * r * u3);
    let of_lean = (4.0 * g * cos - u3 * u3 * r / (cos * cos)) / (5.0 * r);
    let square = of_lean - 0.8 * u3 * u3 + (1.2 * u2 - 0.4 * u3 * tan) * (u3 * tan - 2.0 * u2);
    let root = square.abs().sqrt();
    let pair = if square > 0.0 { [(root, 0.0), (-root, 0.0)] } else { [(0.0, root), (0.0, -root)] };
    for angles in [[0.0, lean, 0.0], [0.7, lean, 0.4], [-2.1, lean, 5.0]] {
        let linear = rolling_freely(BODY, angles, [u2, u3]).unwrap_or_else(|e| panic!("{angles:?}: {e}"));
        assert!(names(&linear, true).starts_with(&["precession of disc", "spin of disc"]), "{:?}", linear.states);
        assert!(!linear.at_rest);
        has_eigenvalues(&linear, &[pair[0], pair[1], (0.0, 0.0), (0.0, 0.0)], 1e-10);
    }
    // a little beside the circle, and a body that is not round, whatever its axes
    let beside = rolling_freely(BODY, [0.0, lean, 0.0], [u2 - 0.1, u3]);
    assert!(matches!(beside, Err(LineariseError::NotSteady { .. })), "{beside:?}");
    let oblong = BODY.replace("shape = \"disc\"\naxis = \"y\"\nsize = \"r\"", "inertia = [0.02, 0.045, 0.03]");
    let oblong = rolling_freely(&oblong, [0.0; 3], [4.0, 0.0]);
    assert!(matches!(oblong, Err(LineariseError::Changing { .. })), "{oblong:?}");
}

#[test]
fn sleeping_top() {
    let text = r#"
title = "top"
[parameters]
spin = "1 rad/s"
[world]
gravity = [0, 0, "-9.81 m/s^2"]
[[body]]
name = "top"
mass = "0.5 kg"
center = ["0 m", "0 m", "0.1 m"]
inertia = ["0.003 kg*m^2", "0.003 kg*m^2", "0.004 kg*m^2"]
[[joint]]
name = "tip"
kind = "spherical"
to = "top"
[initial]
"tip.wz" = "spin"
"tip.wx" = 0
"tip.wy" = 0
"#;
    let (i1, i3, moment): (f64, f64, f64) = (0.003 + 0.5 * 0.01, 0.004, 0.5 * 9.81 * 0.1);
    let limit = (4.0 * i1 * moment).sqrt() / i3;
    for spin in [0.9 * limit, 1.1 * limit] {
        let linear = good(text, &[("spin", &format!("{spin:.17e}"))], &[]);
        assert_eq!(names(&linear, true), ["∫tip.wz"]);
        // in axes that stand: I1 λ² − i I3 Ω λ − m g h = 0; axes of the body turn by Ω
        let inside: f64 = 4.0 * i1 * moment - (i3 * spin).powi(2);
        let (re, im) = if inside > 0.0 { (inside.sqrt(), 0.0) } else { (0.0, (-inside).sqrt()) };
        let plus = |sign: f64| (sign * re / (2.0 * i1), (i3 * spin + sign * im) / (2.0 * i1) - spin);
        let (a, b) = (plus(1.0), plus(-1.0));
        has_eigenvalues(&linear, &[a, b, (a.0, -a.1), (b.0, -b.1), (0.0, 0.0)], 1e-11);
        assert_eq!(linear.modes().unwrap()[0].re > 1e-6, spin < limit, "spin {spin}");
    }
}

/// Two hanging links and a coupler between their ends, symmetric, against its equation with one coordinate.
#[test]
fn four_bar() {
    let text = r#"
title = "four-bar"
[parameters]
m = "0.8 kg"
mc = "1.3 kg"
J = "0.04 kg*m^2"
l = "0.6 m"
b = "0.25 m"
a = "b + l*sin(phi)"
phi = "0.4 rad"
[world]
gravity = [0, 0, "-9.81 m/s^2"]
[[body]]
name = "left"
mass = "m"
center = ["0", "0", "-l"]
[[body]]
name = "right"
mass = "m"
center = ["0", "0", "-l"]
[[body]]
name = "coupler"
mass = "mc"
center = ["b", "0", "0"]
inertia = ["J", "J", "J"]
[[joint]]
name = "A"
kind = "revolute"
axis = "y"
at = ["-a", "0", "0"]
to = "left"
[[joint]]
name = "D"
kind = "revolute"
axis = "y"
at = ["a", "0", "0"]
to = "right"
[[joint]]
name = "B"
kind = "revolute"
axis = "y"
from = "left"
at = ["0", "0", "-l"]
to = "coupler"
[[joint]]
name = "C"
kind = "revolute"
axis = "y"
from = "coupler"
at = ["2*b", "0", "0"]
to = "right"
to_at = ["0", "0", "-l"]
cut = true
[initial]
A = "-phi"
D = "phi"
B = "phi"
"#;
    let (m, mc, j, l, b, phi): (f64, f64, f64, f64, f64, f64) = (0.8, 1.3, 0.04, 0.6, 0.25, 0.4);
    let (s, c) = phi.sin_cos();
    // φ₂″ of φ₂(φ₁) from |P₁P₂| = 2b at φ₂ = −φ₁
    let second = -(4.0 * l * s * s + 4.0 * b * s) / (2.0 * b * c);
    let stiffness = (m + 0.5 * mc) * 9.81 * l * (2.0 * c - s * second);
    let mass = 2.0 * m * l * l + mc * l * l * c * c + j * (l * s / b).powi(2);
    let w = (stiffness / mass).sqrt();
    let linear = good(text, &[], &[]);
    assert_eq!(linear.displacements, 1);
    has_eigenvalues(&linear, &[(0.0, w), (0.0, -w)], 1e-12);
    refused(text, &[("A", "-0.5"), ("D", "0.3")], &[], &["neither an equilibrium"]);
}

#[test]
fn what_depends_on_time_is_refused() {
    let text = OSCILLATOR.replace("value = \"F\"", "value = \"F*sin(t/1[s])\"");
    refused(&text, &[("F", "3")], &[], &["neither an equilibrium", "s later"]);
    let late = OSCILLATOR.replace("value = \"F\"", "value = \"if(t >= 5.803[s] and t < 5.807[s], F, 0)\"");
    let late = format!("{late}[run]\nuntil = 10\n");
    refused(&late, &[("F", "3")], &[], &["neither an equilibrium", "5.80e0 s later"]);
    assert!(good(&late, &[], &["F"]).at_rest);
    let shaken = OSCILLATOR.replace("value = \"F\"", "value = \"10[N/m]*sin(t)*(x - rest)\"");
    refused(&shaken, &[], &[], &["steady but its linear system is not", "∂(x')′/∂(x) goes from"]);
}
