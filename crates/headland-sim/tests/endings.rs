//! How runs end: events, guards, and numbers that are no numbers.

mod common;

use common::{build, done, particle, read, run_with, set};
use headland_model::Scene;
use headland_sim::{Observer, Run, RunOptions, Status, run};

/// A stone of 2 kg at 10 m over the ground, thrown with 3 m/s upwards; `x` points up.
fn stone() -> Scene {
    let mut s = particle();
    set(&mut s, &[("x", "10"), ("x'", "3")]);
    s.element("force", &[("name", "weight"), ("value", "-m*9.81[m/s^2]"), ("geometric", "x")]);
    s
}

fn event(s: &mut Scene, name: &str, quantity: &str, direction: &str, stop: bool) {
    let mut fields = vec![("name", name), ("quantity", quantity)];
    if !direction.is_empty() {
        fields.push(("direction", direction));
    }
    s.element("event", &fields);
    if let Some(element) = s.elements.get_mut("event").and_then(|e| e.last_mut()) {
        let data = headland_model::Data::Flag(stop);
        let value = headland_model::Value { data, place: headland_model::Place::Program };
        let key_place = headland_model::Place::Program;
        element.fields.push(headland_model::Entry { key: "stop".into(), key_place, value });
    }
}

fn landing(height: f64) -> f64 {
    (3.0 + (9.0 + 2.0 * 9.81 * height).sqrt()) / 9.81
}

fn times(run: &Run, what: &str) -> Vec<f64> {
    run.report.log.iter().filter(|l| l.message.contains(what)).map(|l| l.t).collect()
}

/// A spring whose ends meet on the way: the slide of one end stops, exactly, where the other is.
#[test]
fn a_spring_that_loses_its_direction_is_named() {
    let text = "[[body]]\nname = \"a\"\nmass = 1\n[[joint]]\nname = \"z\"\nkind = \"prismatic\"\nto = \"a\"\n\
                [[body]]\nname = \"hand\"\nmass = 1\n[[joint]]\nname = \"y\"\nkind = \"prismatic\"\naxis = \"y\"\nto = \"hand\"\n\
                [prescribed]\ny = \"max(1[m] - t*1[m/s], 0[m])\"\n\
                [[spring]]\nname = \"s\"\nfrom = \"hand\"\nto = \"a\"\nstiffness = 1\nfree_length = 0.1\n\
                [run]\nuntil = 2\n";
    let run = run_with(&build(&read(text)), |_| {});
    let Status::Failed(reason) = &run.report.status else { panic!("{:?}", run.report.status) };
    assert!(reason.contains("the ends of the spring `s` are in the same place"), "{reason}");
    assert!(reason.contains("at t = 1"), "{reason}");
}

#[test]
fn the_ground_is_hit_when_it_is_hit() {
    let methods: &[&str] = if cfg!(feature = "cvode") { &["auto", "cvode-bdf", "cvode-adams"] } else { &["auto"] };
    for method in methods {
        let mut s = stone();
        event(&mut s, "ground", "x", "", true);
        let run = run_with(&build(&s), |o| {
            o.method = (*method).into();
            o.tolerance = 1e-11;
        });
        let exact = landing(10.0);
        let Status::Stopped(reason) = &run.report.status else { panic!("{method}: {:?}", run.report.status) };
        assert!(reason.contains("`ground`") && reason.contains("t = 1.7"), "{reason}");
        let tolerance = if *method == "auto" { 1e-10 } else { 1e-8 };
        assert!((run.report.t_end - exact).abs() < tolerance, "{method}: {} for {exact}", run.report.t_end);
        assert_eq!(times(&run, "event `ground`"), [run.report.t_end]);
        assert!(run.trajectory.t.iter().all(|t| *t <= run.report.t_end));
        // the rows until then, and the one at which it ended
        assert_eq!(run.trajectory.t.len(), 2 + (run.report.t_end / (10.0 / 300.0)).floor() as usize);
        assert_eq!(run.trajectory.t.last(), Some(&run.report.t_end));
        assert!(run.trajectory.rows.iter().flatten().all(|x| x.is_finite()));
    }
}

#[test]
fn events_have_a_direction() {
    let height = 10.4; // passed upwards and downwards
    for (direction, count) in [("rising", 1), ("falling", 1), ("both", 2), ("", 2)] {
        let mut s = stone();
        event(&mut s, "level", &format!("x - {height}[m]"), direction, false);
        let run = done(&build(&s), |o| {
            o.tolerance = 1e-11;
            o.until = 1.5;
        });
        let root = (9.0 - 2.0 * 9.81 * 0.4_f64).sqrt();
        let exact = [(3.0 - root) / 9.81, (3.0 + root) / 9.81];
        let found = times(&run, "event `level`");
        assert_eq!(found.len(), count, "{direction}: {found:?}");
        let exact = match direction {
            "rising" => &exact[..1],
            "falling" => &exact[1..],
            _ => &exact[..],
        };
        for (a, b) in found.iter().zip(exact) {
            assert!((a - b).abs() < 1e-10, "{direction}: {a} for {b}");
        }
    }
}

/// A quantity that is zero at the start is no event there, and the one that follows is found.
#[test]
fn a_start_on_the_ground() {
    let mut s = stone();
    set(&mut s, &[("x", "0")]);
    event(&mut s, "ground", "x", "falling", true);
    let run = run_with(&build(&s), |o| o.tolerance = 1e-11);
    assert!(matches!(run.report.status, Status::Stopped(_)), "{:?}", run.report.status);
    assert!((run.report.t_end - landing(0.0)).abs() < 1e-10, "{}", run.report.t_end);
}

#[test]
fn several_events_are_logged_in_order() {
    let mut s = stone();
    for level in [9, 8, 7, 3, 2] {
        event(&mut s, &format!("level {level}"), &format!("x - {level}[m]"), "falling", false);
    }
    event(&mut s, "clock", "t - 0.75[s]", "rising", false);
    event(&mut s, "ground", "x", "falling", true);
    let run = run_with(&build(&s), |o| o.tolerance = 1e-11);
    let found: Vec<(f64, &str)> = run.report.log.iter().map(|l| (l.t, l.message.as_str())).collect();
    assert!(found.iter().map(|(t, _)| *t).is_sorted(), "{found:?}");
    assert_eq!(found.len(), 7, "{found:?}");
    assert_eq!(run.report.events, 7);
    for level in [9.0, 8.0, 7.0, 3.0, 2.0] {
        let t = times(&run, &format!("event `level {level}`"));
        assert!(t.len() == 1 && (t[0] - landing(10.0 - level)).abs() < 1e-10, "{level}: {t:?}");
    }
    assert!(times(&run, "clock").iter().all(|t| (t - 0.75).abs() < 1e-12));
}

/// Two crossings within one step may go unseen; the longest step says what must be seen.
#[test]
fn a_short_excursion_is_seen_with_short_steps() {
    let mut s = stone();
    event(&mut s, "top", "x - 10.458[m]", "", false); // the top is at 10.4587: 24 ms above
    let run = done(&build(&s), |o| {
        o.until = 1.5;
        o.max_step = 0.05;
    });
    assert_eq!(times(&run, "event `top`").len(), 2, "{:?}", run.report.log);
}

struct Heard(Vec<String>);
impl Observer for Heard {
    fn message(&mut self, _t: f64, message: &str) {
        self.0.push(message.into());
    }
}

/// Asks for the end once the time has passed.
struct Until(f64, f64);
impl Observer for Until {
    fn step(&mut self, t: f64, _h: f64) {
        self.1 = t;
    }
    fn stop(&mut self) -> Option<String> {
        (self.1 >= self.0).then(|| "that is enough".into())
    }
}

#[test]
fn an_observer_ends_the_run_and_keeps_what_was_computed() {
    let model = build(&stone());
    let mut options = RunOptions::of(&model);
    options.max_step = 0.01;
    let result = run(&model, &options, &mut Until(0.5, 0.0)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(result.report.status, Status::Stopped("that is enough".into()));
    assert!((result.report.t_end - 0.5).abs() < 0.0101, "{}", result.report.t_end);
    assert_eq!(result.trajectory.t.last(), Some(&result.report.t_end));
    assert!(result.trajectory.t.len() > 15);
}

#[test]
fn guards_warn_and_stop() {
    let mut s = stone();
    let guard = [
        ("name", "height"),
        ("quantity", "x"),
        ("warn_below", "5[m]"),
        ("stop_below", "2[m]"),
        ("message", "the lawn is wet"),
    ];
    s.element("guard", &guard);
    let model = build(&s);
    let mut options = RunOptions::of(&model);
    options.tolerance = 1e-11;
    let mut heard = Heard(Vec::new());
    let result = run(&model, &options, &mut heard).unwrap_or_else(|e| panic!("{e}"));
    let Status::Failed(reason) = &result.report.status else { panic!("{:?}", result.report.status) };
    assert!(reason.contains("height") && reason.contains("2") && reason.contains("the lawn is wet"), "{reason}");
    assert!((result.report.t_end - landing(8.0)).abs() < 1e-10, "{} for {}", result.report.t_end, landing(8.0));
    let warnings = times(&result, "warning: height");
    assert!(warnings.len() == 1 && (warnings[0] - landing(5.0)).abs() < 1e-9, "{:?}", result.report.log);
    assert!(heard.0.iter().any(|m| m.contains("below 5") && m.contains("the lawn is wet")), "{:?}", heard.0);
    let rows = result.trajectory.rows.len();
    assert!(rows > 30 && result.trajectory.t[rows - 1] <= result.report.t_end, "{rows}");
    assert!(result.trajectory.rows.iter().all(|r| r[0] >= 2.0 - 1e-9));
}

#[test]
fn a_guard_below_its_limit_at_the_start_stops_at_once() {
    let mut s = stone();
    s.element("guard", &[("name", "height"), ("quantity", "x"), ("stop_below", "12[m]")]);
    let run = run_with(&build(&s), |_| {});
    assert!(matches!(&run.report.status, Status::Failed(why) if why.contains("height")), "{:?}", run.report.status);
    assert_eq!((run.report.t_end, run.report.steps), (0.0, 0));
    assert_eq!(run.trajectory.t, [0.0]);
}

/// `√x` as a damping where x falls below zero.
fn square_root() -> Scene {
    let mut s = stone();
    s.entry("definitions", "depth", "sqrt(x/1[m])");
    s.element("force", &[("name", "air"), ("value", "-0.1[N]*depth"), ("geometric", "x")]);
    s
}

#[test]
fn a_number_that_is_none_ends_the_run_with_its_name() {
    let methods: &[&str] =
        if cfg!(feature = "cvode") { &["auto", "dop853", "cvode-bdf", "cvode-adams"] } else { &["auto", "dop853"] };
    for method in methods {
        let run = run_with(&build(&square_root()), |o| o.method = (*method).into());
        let Status::Failed(reason) = &run.report.status else { panic!("{method}: {:?}", run.report.status) };
        assert!(
            reason.contains("`depth`") && reason.contains("NaN") && reason.contains("t = 1.7"),
            "{method}: {reason}"
        );
        assert!(reason.contains("last good state"), "{method}: {reason}");
        let t = run.report.t_end;
        assert!(t > 1.7 && t <= landing(10.0) + 0.01, "{method}: {t} for {}", landing(10.0));
        assert!(run.trajectory.rows.iter().flatten().all(|x| x.is_finite()), "{method}");
        let expected = 2 + (t / (10.0 / 300.0)).floor() as usize;
        assert_eq!(run.trajectory.t.len(), expected, "{method}: rows until t = {t}");
        assert!(run.report.rhs < 100_000, "{method}: {}", run.report.rhs);
    }
}

/// A trial step that went too far and was taken back is not to blame for what ends the run later.
#[test]
fn an_old_excursion_is_not_blamed() {
    let mut s = square_root();
    // the ground pushes back: x stays positive, but long trial steps go below
    s.element("force", &[("name", "ground"), ("value", "50[N]/(x/1[m] + 0.01)^2"), ("geometric", "x")]);
    s.element("guard", &[("name", "speed"), ("quantity", "30[m/s] - abs(x')"), ("stop_below", "0[m/s]")]);
    let run = run_with(&build(&s), |o| o.max_steps = 400);
    if let Status::Failed(reason) = &run.report.status {
        assert!(!reason.contains("NaN"), "{reason}");
    }
}

#[test]
fn nan_at_the_start_is_told() {
    let mut s = square_root();
    set(&mut s, &[("x", "-1")]);
    let model = build(&s);
    match run(&model, &RunOptions::of(&model), &mut headland_sim::Silent) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(run) => {
            let Status::Failed(reason) = &run.report.status else { panic!("{:?}", run.report.status) };
            assert!(reason.contains("`depth`"), "{reason}");
            assert_eq!(run.report.t_end, 0.0);
        }
    }
}

/// An output that is not a number while the motion is well: the run goes on.
#[test]
fn an_output_may_be_undefined() {
    let mut s = stone();
    set(&mut s, &[("outputs.columns", "[x, sqrt(x/1[m])]")]);
    let run = done(&build(&s), |o| o.until = 2.0);
    assert_eq!(run.trajectory.rows.len(), 301);
    assert!(run.trajectory.rows.iter().all(|r| r[0].is_finite() && r[1].is_nan() == (r[0] < 0.0)));
}

#[test]
fn a_stop_event_before_the_first_output() {
    let mut s = stone();
    event(&mut s, "soon", "t - 0.001[s]", "rising", true);
    let run = run_with(&build(&s), |o| o.points = 2);
    assert!(matches!(run.report.status, Status::Stopped(_)));
    assert_eq!(run.trajectory.t, [0.0, run.report.t_end]);
    assert!((run.report.t_end - 0.001).abs() < 1e-12);
}

#[test]
fn the_train_stops_where_its_form_fails() {
    let mut s = read(common::TRAIN);
    set(&mut s, &[("gamma", "0.3*t/1[s]")]);
    let run = run_with(&build(&s), |o| o.until = 15.0);
    let Status::Failed(reason) = &run.report.status else { panic!("{:?}", run.report.status) };
    assert!(reason.contains("cos psi") && reason.contains("right angles"), "{reason}");
    assert!(run.report.log.iter().any(|l| l.message.contains("warning: cos psi")), "{:?}", run.report.log);
    assert!(run.trajectory.rows.len() > 10 && run.trajectory.rows.iter().flatten().all(|x| x.is_finite()));
}
