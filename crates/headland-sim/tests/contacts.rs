//! Hard contacts: rolling, sliding, flight and impacts against closed forms and integrations of their own.

mod common;

use common::{build, done, read, run_with, set};
use headland_sim::{Run, RunOptions, Silent, Status, run};

const G: f64 = 9.81;

/// A homogeneous ball over the floor z = 0 or a plane that leans by `slope`, down along x.
const BALL: &str = r#"
[parameters]
r = "0.1 m"
mu = 0.3
mu_s = "mu"
e = 0
slope = "0 rad"
g = "9.81 m/s^2"
[world]
gravity = ["g*sin(slope)", 0, "-g*cos(slope)"]
[[body]]
name = "ball"
mass = "2 kg"
shape = "sphere"
size = "r"
[[contact]]
name = "floor"
body = "ball"
radius = "r"
friction = "mu"
static_friction = "mu_s"
restitution = "e"
[initial]
"ball.x" = 0
"ball.y" = 0
"ball.z" = "r"
"ball.x'" = 0
"ball.y'" = 0
"ball.z'" = 0
"ball.wx" = 0
"ball.wy" = 0
"ball.wz" = 0
[outputs]
columns = ["ball.x", "ball.y", "ball.z", "ball.vx", "ball.vy", "ball.vz", "ball.omega_x", "ball.omega_y", "ball.omega_z", "floor.normal", "floor.slip", "floor.gap"]
"#;

fn ball(settings: &[(&str, &str)], tolerance: f64, at: &[f64]) -> Run {
    let mut scene = read(BALL);
    set(&mut scene, settings);
    done(&build(&scene), |o| {
        o.tolerance = tolerance;
        o.until = at[at.len() - 1];
        o.at = Some(at.to_vec());
    })
}

/// Times of the messages that have a text in them.
fn times(run: &Run, text: &str) -> Vec<f64> {
    run.report.log.iter().filter(|e| e.message.contains(text)).map(|e| e.t).collect()
}

fn last(run: &Run, name: &str) -> f64 {
    run.trajectory.named(name).and_then(|c| c.last().copied()).unwrap_or_else(|| panic!("no column {name}"))
}

/// Spin about a horizontal axis turns into rolling: v = 2 w₀ r/7 at t = 2 w₀ r/(7 μ g).
#[test]
fn a_spinning_ball_comes_to_roll() {
    let (spin, r, mu) = (20.0, 0.1, 0.3);
    let exact = 2.0 * spin * r / (7.0 * mu * G);
    let mut before = f64::INFINITY;
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let run = ball(&[("ball.wy", "20")], tolerance, &[0.5 * exact, 1.0]);
        let found = times(&run, "rolling, was sliding");
        assert_eq!(found.len(), 1, "{:?}", run.report.log);
        let error = (found[0] - exact).abs();
        println!("tolerance {tolerance:e}: error of the time {error:e} s");
        assert!(error <= tolerance * exact && error <= before.max(1e-15), "{tolerance:e}: {error:e}");
        before = error;
        assert!((last(&run, "ball.vx") - 2.0 * spin * r / 7.0).abs() <= 10.0 * tolerance);
        // on the way v = μ g t
        assert!((run.trajectory.rows[0][3] - mu * G * 0.5 * exact).abs() <= 10.0 * tolerance);
    }
}

/// Slip across and down an incline: s′ = A x − B s/|s| with A = g sin α, B = 7/2 μ g cos α, so that |s| (B + A cos φ) falls
/// at the rate B² − A², φ the angle between the slip and down. Time when it ends, and the place then, which is the integral of
/// the friction.
#[test]
fn a_slide_across_an_incline_ends_when_it_must() {
    let (slope, mu, vx, vy) = (0.3_f64, 0.25, -0.4_f64, 1.5_f64);
    let (a, b) = (G * slope.sin(), 3.5 * mu * G * slope.cos());
    let exact = (vx.hypot(vy) * b + a * vx) / (b * b - a * a);
    let settings = [("slope", "0.3"), ("mu", "0.25"), ("mu_s", "0.4"), ("ball.x'", "-0.4"), ("ball.y'", "1.5")];
    let mut before = f64::INFINITY;
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let run = ball(&settings, tolerance, &[exact * 0.9, 1.0]);
        let found = times(&run, "rolling, was sliding");
        assert_eq!(found.len(), 1, "{:?}", run.report.log);
        let error = (found[0] - exact).abs();
        println!("tolerance {tolerance:e}: error of the time {error:e} s");
        assert!(error <= 10.0 * tolerance && error < before, "{tolerance:e}: {error:e}");
        before = error;
        // v = s/3.5 + what rolling makes of gravity: the part 5/7 of it is the same, sliding or rolling
        let (v, s) = ([last(&run, "ball.vx"), last(&run, "ball.vy")], [vx, vy]);
        let rolls = [5.0 / 7.0 * (s[0] + a), 5.0 / 7.0 * s[1]];
        assert!((v[0] - rolls[0]).hypot(v[1] - rolls[1]) < 100.0 * tolerance, "{v:?} {rolls:?}");
        let slides = by_runge_kutta([vx, vy], a, b, 0.9 * exact);
        let row = &run.trajectory.rows[0];
        for (found, expected) in [row[0], row[1], row[3], row[4]].into_iter().zip(slides) {
            assert!((found - expected).abs() < 100.0 * tolerance, "{found} {expected}");
        }
    }
}

/// x, y, v of the slide above from the slip alone: `v′ = A − 2/7 B s/|s|`.
fn by_runge_kutta(v: [f64; 2], a: f64, b: f64, until: f64) -> [f64; 4] {
    // x, y, vx, vy, slip
    let rate = |y: [f64; 6]| {
        let size = y[4].hypot(y[5]);
        let (c, s) = (y[4] / size, y[5] / size);
        [y[2], y[3], a - 2.0 / 7.0 * b * c, -2.0 / 7.0 * b * s, a - b * c, -b * s]
    };
    let n = 20_000;
    let h = until / f64::from(n);
    let mut y = [0.0, 0.0, v[0], v[1], v[0], v[1]];
    for _ in 0..n {
        let add = |k: [f64; 6], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
        let k1 = rate(y);
        let k2 = rate(add(k1, h / 2.0));
        let k3 = rate(add(k2, h / 2.0));
        let k4 = rate(add(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    [y[0], y[1], y[2], y[3]]
}

/// Bounces lose 1 − e of the speed; they end at T = t₁ + 2 e v/(g (1 − e)), v the speed of the first impact at t₁.
#[test]
fn bounces_end_at_zenos_time() {
    for e in [0.5, 0.9] {
        let (h, r) = (1.0, 0.1);
        let first = (2.0 * h / G).sqrt();
        let v = G * first;
        let rest = first + 2.0 * e * v / (G * (1.0 - e));
        let run = ball(&[("e", &e.to_string()), ("ball.z", "1.1")], 1e-12, &[first + 0.9 * e * v / G, rest + 0.5]);
        let told = run.report.log.iter().find(|l| l.message.contains("comes to rest")).expect("told");
        let at: f64 =
            told.message.split("t = ").nth(1).and_then(|s| s.split(' ').next()).expect("time").parse().expect("number");
        println!("e = {e}: rest at {at}, exactly {rest}: {:e}; {}", (at - rest).abs(), told.message);
        assert!((at - rest).abs() < 1e-9, "{e}: {at} {rest}");
        // the last bounce that is told is 1e-11 m high
        assert!(told.t < rest && rest - told.t < 1e-4);
        let z = run.trajectory.rows[0][2];
        let t = 0.9 * e * v / G;
        assert!((z - (r + e * v * t - G * t * t / 2.0)).abs() < 1e-10, "{z}");
        assert!((last(&run, "ball.z") - r).abs() < 1e-12 && last(&run, "ball.vz").abs() < 1e-12);
        assert!((last(&run, "floor.normal") - 2.0 * G).abs() < 1e-9);
    }
}

/// One impact of a spinning ball. Little friction slips through it: Δv = μ (1 + e) v_n. Much friction stops the slip:
/// Δv = 2/7 of it.
#[test]
fn a_spinning_ball_bounces_sideways() {
    let (h, e, spin, vx): (f64, f64, f64, f64) = (0.5, 0.8, 30.0, 0.7);
    let fall = (2.0 * h / G).sqrt();
    let speed = G * fall;
    let slip = vx - spin * 0.1;
    for mu in [0.02, 0.3] {
        let at = fall + 0.1;
        let settings = [
            ("mu", mu.to_string()),
            ("e", e.to_string()),
            ("ball.z", "0.6".into()),
            ("ball.x'", vx.to_string()),
            ("ball.wy", spin.to_string()),
        ];
        let settings: Vec<(&str, &str)> = settings.iter().map(|(n, v)| (*n, v.as_str())).collect();
        let run = ball(&settings, 1e-12, &[at]);
        let most = 2.0 / 7.0 * slip.abs();
        let change = (mu * (1.0 + e) * speed).min(most);
        assert_eq!(change < most, mu < 0.1);
        assert!((last(&run, "ball.vx") - (vx + change)).abs() < 1e-12);
        assert!((last(&run, "ball.omega_y") - (spin - 2.5 * change / 0.1)).abs() < 1e-10);
        assert!((last(&run, "ball.vz") - (e * speed - G * 0.1)).abs() < 1e-11);
        assert!(run.report.energy_balance.is_some_and(|b| b < 1e-12));
    }
}

/// μ = 2/7 tan α is just enough for rolling: it rolls all the way and does not flutter; a little less and it slides.
#[test]
fn friction_exactly_at_the_limit_rolls() {
    let settings = [("slope", "0.4"), ("mu", "2/7*tan(slope)")];
    let run = ball(&settings, 1e-12, &[1.0, 2.0]);
    assert!(times(&run, "sliding").is_empty(), "{:?}", run.report.log);
    assert!((last(&run, "ball.x") - 0.5 * 5.0 / 7.0 * G * 0.4_f64.sin() * 4.0).abs() < 1e-10);
    let less = 0.999 * 2.0 / 7.0 * 0.4_f64.tan();
    let run = ball(&[settings[0], ("mu", "0.999*2/7*tan(slope)")], 1e-12, &[1.0, 2.0]);
    assert_eq!(run.report.mode_changes, 1, "{:?}", run.report.log);
    let expected = 2.0 * G * (0.4_f64.sin() - less * 0.4_f64.cos());
    assert!((last(&run, "ball.x") - expected).abs() < 1e-8, "{} {expected}", last(&run, "ball.x"));
}

/// Two floors that lean against each other; a ball that falls between them straight down hits both at once.
const GROOVE: &str = r#"
[parameters]
r = "0.1 m"
m = "1 kg"
lean = "30 deg"
h = "0.3 m"
e = 0
mu = 0.5
off = "0 m"
[world]
gravity = [0, 0, "-9.81 m/s^2"]
[[body]]
name = "ball"
mass = "m"
shape = "sphere"
size = "r"
[[surface]]
name = "left"
shape = "plane"
rpy = [0, "lean", 0]
[[surface]]
name = "right"
shape = "plane"
rpy = [0, "-lean", 0]
[[contact]]
name = "a"
body = "ball"
on = "left"
radius = "r"
friction = "mu"
restitution = "e"
[[contact]]
name = "b"
body = "ball"
on = "right"
radius = "r"
friction = "mu"
restitution = "e"
[initial]
"ball.x" = "off"
"ball.y" = 0
"ball.z" = "r/cos(lean) + h"
[outputs]
columns = ["ball.x", "ball.z", "ball.vx", "ball.vz", "ball.omega_y", "a.normal", "b.normal", "a.gap", "b.gap"]
"#;

#[test]
fn a_ball_falls_into_a_groove() {
    for (h, off, e) in
        [("0", "0", "0"), ("0.3", "0", "0"), ("0.3", "0.01", "0"), ("0.3", "0.01", "0.3"), ("0.3", "0", "0.3")]
    {
        let mut scene = read(GROOVE);
        set(&mut scene, &[("h", h), ("off", off), ("e", e)]);
        let run = run_with(&build(&scene), |o| (o.tolerance, o.until) = (1e-10, 10.0));
        assert_eq!(run.report.status, Status::Done, "{h} {off} {e}: {:?}", run.report.log);
        let least = |c: &str| run.trajectory.named(c).expect("column").into_iter().fold(f64::INFINITY, f64::min);
        assert!(
            least("a.gap") > -1e-9 && least("b.gap") > -1e-9,
            "{h} {off} {e}: {:e} {:e}",
            least("a.gap"),
            least("b.gap")
        );
        // at rest at the bottom, each side carries its share
        let lean = 30.0_f64.to_radians();
        assert!((last(&run, "ball.z") - 0.1 / lean.cos()).abs() < 1e-8, "{h} {off} {e}: {}", last(&run, "ball.z"));
        let weight = (last(&run, "a.normal") + last(&run, "b.normal")) * lean.cos();
        assert!(weight <= 1.0001 * G && weight > 0.5 * G, "{h} {off} {e}: {weight}");
    }
}

/// Over the crest of a ball and down on the floor, again and again: a marble on top of a sphere leaves it where
/// cos θ = 10/17 (rolling without slipping from rest), and lands.
const CREST: &str = r#"
[parameters]
R = "1 m"
r = "0.1 m"
start = "0.01 rad"
[world]
gravity = [0, 0, "-9.81 m/s^2"]
[[body]]
name = "ball"
mass = "1 kg"
shape = "sphere"
size = "r"
[[surface]]
name = "dome"
shape = "sphere"
radius = "R"
[[contact]]
name = "top"
body = "ball"
on = "dome"
radius = "r"
friction = 100
[[contact]]
name = "floor"
body = "ball"
radius = "r"
friction = 0.3
restitution = 0.5
[initial]
"ball.x" = "(R + r)*sin(start)"
"ball.y" = 0
"ball.z" = "(R + r)*cos(start)"
[outputs]
columns = ["ball.x", "ball.z", "ball.vx", "ball.vz", "top.gap", "floor.gap", "ball.z/(R + r)"]
"#;

#[test]
fn a_ball_rolls_off_a_dome_and_lands() {
    // with friction the ball slides for a moment before it leaves, for there friction is at its limit, however large
    for (text, leaving) in
        [(CREST.to_string(), "free, was sliding"), (CREST.replace("friction = 100\n", ""), "free, was rolling")]
    {
        let model = build(&read(&text));
        let run = done(&model, |o| (o.tolerance, o.until, o.points) = (1e-12, 5.0, 5000));
        let leaves = times(&run, leaving);
        assert_eq!(leaves.len(), 1, "{:?}", run.report.log);
        // 7/10 v² = g a (cos θ₀ − cos θ), v² = g a cos θ: cos θ = 10/17 cos θ₀
        let again = done(&model, |o| (o.tolerance, o.until, o.at) = (1e-12, leaves[0], Some(vec![leaves[0]])));
        let error = (last(&again, "ball.z/(R + r)") - 10.0 / 17.0 * 0.01_f64.cos()).abs();
        assert!(error < if leaving.contains("rolling") { 1e-10 } else { 1e-3 }, "{leaving}: {error:e}");
        let least = run.trajectory.named("floor.gap").expect("column").into_iter().fold(f64::INFINITY, f64::min);
        assert!(least > -1e-9, "{least:e}");
        assert!(last(&run, "ball.z") < 0.1 + 1e-9);
    }
}

/// A ball falls on two that lie side by side on the floor: three contacts of balls with balls, two with the floor.
const HEAP: &str = r#"
[parameters]
r = "0.1 m"
h = "0.2 m"
e = 0
mu = 0.3
[world]
gravity = [0, 0, "-9.81 m/s^2"]
[[body]]
name = "left"
mass = "1 kg"
shape = "sphere"
size = "r"
[[body]]
name = "right"
mass = "1 kg"
shape = "sphere"
size = "r"
[[body]]
name = "top"
mass = "1 kg"
shape = "sphere"
size = "r"
[[surface]]
name = "left_skin"
on = "left"
shape = "sphere"
radius = "r"
[[surface]]
name = "right_skin"
on = "right"
shape = "sphere"
radius = "r"
[[contact]]
name = "under left"
body = "left"
radius = "r"
friction = "mu"
restitution = "e"
[[contact]]
name = "under right"
body = "right"
radius = "r"
friction = "mu"
restitution = "e"
[[contact]]
name = "between"
body = "right"
on = "left_skin"
radius = "r"
friction = "mu"
restitution = "e"
[[contact]]
name = "on left"
body = "top"
on = "left_skin"
radius = "r"
friction = "mu"
restitution = "e"
[[contact]]
name = "on right"
body = "top"
on = "right_skin"
radius = "r"
friction = "mu"
restitution = "e"
[initial]
"left.x" = "-r"
"left.z" = "r"
"right.x" = "r"
"right.z" = "r"
"top.z" = "r + sqrt(3)*r + h"
[outputs]
columns = ["left.x", "left.z", "right.x", "right.z", "top.x", "top.z", "left.vx", "right.vx", "top.vz"]
"#;

#[test]
fn a_ball_falls_between_two() {
    for e in ["0", "0.5"] {
        let mut scene = read(HEAP);
        set(&mut scene, &[("e", e)]);
        let run = run_with(&build(&scene), |o| (o.tolerance, o.until, o.points) = (1e-10, 0.5, 500));
        assert_eq!(run.report.status, Status::Done, "{e}: {:?}", run.report.log);
        assert!(run.report.energy_balance.is_some_and(|b| b < 1e-8));
        for row in &run.trajectory.rows {
            assert!((row[0] + row[2]).abs() < 1e-7 && row[4].abs() < 1e-7, "{e}: not symmetric any more: {row:?}");
            let apart = |a: usize, b: usize| (row[a] - row[b]).hypot(row[a + 1] - row[b + 1]) - 0.2;
            assert!(
                row[1] > 0.1 - 1e-8 && apart(0, 2).min(apart(0, 4)).min(apart(2, 4)) > -1e-8,
                "{e}: inside: {row:?}"
            );
        }
    }
}

const RECESS: &str = include_str!("../../../models/ball_in_recess.toml");
const SLIDING: &str = include_str!("../../../models/ball_in_recess_sliding.toml");

/// What is said of a scene with settings; nothing where it can be built.
fn refusal(text: &str, settings: &[(&str, &str)]) -> String {
    let mut scene = read(text);
    set(&mut scene, settings);
    match scene.build() {
        Ok(model) => match run(&model, &RunOptions::of(&model), &mut Silent) {
            Ok(run) => format!("{:?}", run.report.status),
            Err(error) => error.to_string(),
        },
        Err(error) => error.to_string(),
    }
}

#[test]
fn wrong_input_has_its_own_message() {
    for (text, settings, said) in [
        (RECESS, ("r", "0.6"), "a ball of radius 0.6 m does not fit into the sphere of radius 0.5 m"),
        (RECESS, ("r", "0.5"), "does not fit"),
        (SLIDING, ("r", "0.6"), "does not fit"),
        (RECESS, ("r", "-0.1"), "`radius` is -0.1 m; it must be above 0"),
        (RECESS, ("ball.x'", "1"), "the initial rates contradict the constraints: `ball.x'` was given as 1"),
        (SLIDING, ("mu", "-0.1"), "`friction` is -0.1; it must be at least 0"),
        (SLIDING, ("restitution", "1.5"), "`restitution` lies between 0 and 1"),
        (SLIDING, ("ball.x", "0.6 m"), "starts 2.420e-1 m inside its surface; move the body"),
    ] {
        let message = refusal(text, &[settings]);
        assert!(message.contains(said), "{settings:?}: {message}");
        assert!(!message.contains("undefined name"), "{settings:?}: what follows is told again: {message}");
    }
    // one that starts outside its recess and rolls is moved, and that is said
    let mut scene = read(RECESS);
    set(&mut scene, &[("ball.x", "0.6 m"), ("azimuth_speed", "0"), ("spin", "0")]);
    let run = run_with(&build(&scene), |o| o.until = 0.1);
    assert_eq!(run.report.status, Status::Done);
    assert!(run.report.log.iter().any(|e| e.message.contains("ball.x")), "{:?}", run.report.log);
}

/// Thrown against the recess at the start: an impact before the first step, its loss in the balance.
#[test]
fn an_impact_at_the_start_is_accounted_for() {
    let mut scene = read(SLIDING);
    set(&mut scene, &[("ball.x'", "1")]);
    let run = run_with(&build(&scene), |o| (o.tolerance, o.until) = (1e-10, 0.1));
    assert_eq!(run.report.status, Status::Done);
    assert_eq!(times(&run, "hits at 0.642788 m/s"), [0.0]);
    assert!(run.report.energy_balance.is_some_and(|b| b < 1e-9), "{:?}", run.report.energy_balance);
}

/// In flight nothing of the friction is used.
#[test]
fn friction_used_in_flight_is_none() {
    let mut scene = read(SLIDING);
    set(&mut scene, &[("ball.z'", "1"), ("azimuth_speed", "0")]);
    let run = run_with(&build(&scene), |o| (o.tolerance, o.until) = (1e-8, 0.02));
    assert_eq!(run.trajectory.named("contact.used").expect("column").iter().copied().fold(0.0, f64::max), 0.0);
    assert!(times(&run, "not finite").is_empty(), "{:?}", run.report.log);
}
