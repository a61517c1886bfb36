//! What has no right equations is refused, and the message says what and why.

mod common;

use common::{build, derived, prescribed_pivot, sleigh, train};
use headland_dynamics::{Algorithm, DeriveError, DeriveOptions, derive, initial_velocities};
use headland_model::Scene;

fn refused(scene: &Scene) -> DeriveError {
    let model = build(scene);
    match derive(&model, &DeriveOptions::default()) {
        Ok(_) => panic!("{} was derived", model.title),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            error
        }
    }
}

/// Coordinates in metres with a mass each; rows in form (1).
fn particle(names: &[&str], rows: &[&str]) -> Scene {
    let mut s = Scene::new("particle");
    for name in names {
        s.entry("coordinates", name, "m").entry("initial", name, 0.2);
        s.element("inertia", &[("name", &format!("m, {name}")), ("value", "1 kg"), ("geometric", name)]);
    }
    for (i, row) in rows.iter().enumerate() {
        s.element("constraint", &[("name", &format!("row {}", i + 1)), ("equation", row)]);
    }
    s
}

#[test]
fn the_sleigh_by_body_velocities_is_refused() {
    for how in ["explicit", "implicit"] {
        let error = refused(&sleigh(how));
        let DeriveError::ScalarInertia { name, count, quasi } = &error else { panic!("{how}: {error}") };
        assert!(name.starts_with("m, l"), "{how}: {name}");
        assert_eq!((*count, quasi.as_str()), (2, "v, w"));
        assert!(error.to_string().contains("b w^2") && error.to_string().contains("geometric"), "{error}");
    }
    for how in ["geometric", "rates"] {
        derived(&build(&sleigh(how)));
    }
}

/// With one quasi-velocity a speed serves; the article's trains are of this kind.
#[test]
fn one_quasi_velocity_may_have_speeds() {
    for n in [1, 3] {
        derived(&build(&train(n)));
    }
    let mut wheel = Scene::new("wheel");
    wheel.entry("coordinates", "x", "m").entry("coordinates", "phi", "rad").entry("quasi_velocities", "v", "m/s");
    wheel.entry("kinematics", "x'", "v*cos(phi)").entry("kinematics", "phi'", "v/2[m]");
    wheel.element("inertia", &[("name", "m"), ("value", "1 kg"), ("explicit", "v*sqrt(1 + x^2/1[m^2])")]);
    wheel.entry("initial", "x", 0.0).entry("initial", "phi", 0.0).entry("initial", "v", 1.0);
    derived(&build(&wheel));
}

/// A speed with a part that is there at u = 0 is not `W u`, even with one quasi-velocity.
#[test]
fn a_speed_with_drift_is_refused() {
    let mut s = Scene::new("on a moving belt");
    s.entry("coordinates", "x", "m").entry("coordinates", "y", "m").entry("coordinates", "phi", "rad");
    s.entry("prescribed", "phi", "0.3*t").entry("quasi_velocities", "v", "m/s");
    s.entry("kinematics", "x'", "v*cos(phi)").entry("kinematics", "y'", "v*sin(phi) + 0.5*sin(3*(t/1[s]))");
    s.entry("initial", "x", 0.0).entry("initial", "y", 0.0).entry("initial", "v", 1.0);
    let with = |form: &str, structure: &str| {
        let mut s = s.clone();
        s.element("inertia", &[("name", "m"), ("value", "1 kg"), (form, structure)]);
        s
    };
    for (form, structure) in [("explicit", "v + 0.2*x/1[s]"), ("implicit", "x'*cos(phi) + y'*sin(phi)")] {
        let error = refused(&with(form, structure));
        assert!(matches!(&error, DeriveError::ScalarInertia { name, count: 1, .. } if name == "m"), "{error}");
    }
    derived(&build(&with("geometric", "x + y")));
    derived(&build(&with("implicit", "x' + y'")));
}

/// The rates of coordinates, and closed combinations of them, serve with any number of quasi-velocities.
#[test]
fn rates_of_coordinates_are_accepted() {
    let mut s = particle(&["x", "y", "z"], &[]);
    s.element("inertia", &[("name", "rate"), ("value", "1 kg"), ("implicit", "x'")]);
    s.element("inertia", &[("name", "sum"), ("value", "1 kg"), ("implicit", "2*x' - y'")]);
    s.element("inertia", &[("name", "gradient"), ("value", "1 kg"), ("implicit", "(x*y' + y*x')/1[m]")]);
    for name in ["x'", "y'", "z'"] {
        s.entry("initial", name, 0.0);
    }
    derived(&build(&s));
    s.element("inertia", &[("name", "area"), ("value", "1 kg"), ("implicit", "(x*y' - y*x')/1[m]")]);
    let error = refused(&s);
    assert!(matches!(&error, DeriveError::ScalarInertia { name, count: 3, .. } if name == "area"), "{error}");
}

#[test]
fn rows_that_are_not_linear_are_named() {
    let error = refused(&particle(&["x", "y", "z"], &["x' = y'", "x'^2 = y'*1[m/s]"]));
    let DeriveError::NotLinear { what, input, .. } = &error else { panic!("{error}") };
    assert!(what.contains("row 2") && input == "x'", "{error}");

    let mut s = sleigh("geometric");
    s.set("kinematics.x'", "v^2/1[m/s]*cos(theta)").unwrap_or_else(|e| panic!("{e}"));
    let error = refused(&s);
    assert!(matches!(&error, DeriveError::NotLinear { what, .. } if what.contains("`x`")), "{error}");

    let mut s = sleigh("geometric");
    s.element("force", &[("name", "air"), ("value", "-1 N"), ("explicit", "v*abs(v)/1[m/s]")]);
    let error = refused(&s);
    assert!(matches!(&error, DeriveError::NotLinear { what, .. } if what.contains("air")), "{error}");
}

#[test]
fn rows_that_follow_or_contradict_are_named() {
    let how = |rows: &[&str]| match refused(&particle(&["x", "y", "z"], rows)) {
        DeriveError::SingularConstraint { name, how, .. } => (name, how),
        other => panic!("{rows:?}: {other}"),
    };
    let (name, why) = how(&["x' = y'", "x' = y'"]);
    assert!(name.starts_with("row") && why.contains("redundant"), "{name}: {why}");
    let (name, why) = how(&["x' + y' = 0", "2*x' + 2*y' = 0"]);
    assert!(name == "row 2" && why.contains("redundant"), "{name}: {why}");
    let (name, why) = how(&["x' = y'", "x' = y' + 1[m/s]"]);
    assert!(name.starts_with("row") && why.contains("contradictory"), "{name}: {why}");
    let (name, why) = how(&["x*x' + y*y' = 0", "x*x' + y*y' = 1[m^2/s]"]);
    assert!(name.starts_with("row") && why.contains("contradictory"), "{name}: {why}");
    // acts nowhere at the start, x = y
    let (name, why) = how(&["(x - y)*x' = 0"]);
    assert!(name == "row 1" && why.contains("singular"), "{name}: {why}");
}

#[test]
fn a_velocity_without_inertia_is_named() {
    let mut s = Scene::new("massless");
    s.entry("coordinates", "x", "m").entry("coordinates", "y", "m");
    s.element("inertia", &[("name", "m"), ("value", "1 kg"), ("geometric", "x")]);
    s.element("elastic", &[("name", "c"), ("value", "1 N/m"), ("geometric", "y - x")]);
    for name in ["x", "y", "x'", "y'"] {
        s.entry("initial", name, 0.0);
    }
    let error = refused(&s);
    assert!(matches!(&error, DeriveError::SingularMass { name, .. } if name == "y'"), "{error}");
    s.element("inertia", &[("name", "negative"), ("value", "-1 kg"), ("geometric", "y")]);
    let error = refused(&s);
    assert!(matches!(&error, DeriveError::SingularMass { name, pivot } if name == "y'" && *pivot < 0.0), "{error}");
}

#[test]
fn a_wrong_choice_of_independent_rates_is_told() {
    let mut s = particle(&["x", "y", "z"], &["x' = 2*y'"]);
    s.entry("initial", "x'", 0.0).entry("initial", "z'", 0.0);
    s.entry("run", "independent", &["x'"][..]);
    let error = refused(&s);
    assert!(matches!(error, DeriveError::WrongIndependent { given: 1, wanted: 2, .. }), "{error}");
    assert!(error.to_string().contains("x', y', z'"), "{error}");
    s.set("run.independent", "[x', y', z']").unwrap_or_else(|e| panic!("{e}"));
    assert!(matches!(refused(&s), DeriveError::WrongIndependent { given: 3, .. }));
    // x' and y' depend on each other: not two independent rates
    s.set("run.independent", "[x', y']").unwrap_or_else(|e| panic!("{e}"));
    let error = refused(&s);
    assert!(matches!(&error, DeriveError::SingularConstraint { name, .. } if name == "row 1"), "{error}");
    s.set("run.independent", "[y', z']").unwrap_or_else(|e| panic!("{e}"));
    let quasi: Vec<String> = derived(&build(&s)).kinematics.quasi.iter().map(|u| u.name.clone()).collect();
    assert_eq!(quasi, ["y'", "z'"]);
}

#[test]
fn no_freedom_is_told() {
    let error = refused(&particle(&["x", "y"], &["x' = 0", "y' = x'"]));
    assert!(matches!(error, DeriveError::NoFreedom { coordinates: 2, constraints: 2 }), "{error}");
    let error = refused(&particle(&["x"], &["x' = 1[m/s]", "x' = 2[m/s]"]));
    assert!(matches!(error, DeriveError::SingularConstraint { .. } | DeriveError::NoFreedom { .. }), "{error}");
}

#[test]
fn starts_that_are_not_finite_are_told() {
    let mut s = particle(&["x", "y"], &[]);
    s.entry("initial", "x'", 0.0).entry("initial", "y'", 0.0);
    s.element("inertia", &[("name", "far"), ("value", "1 kg"), ("geometric", "1[m]*sqrt((x - 1[m])/1[m])")]);
    let error = refused(&s);
    assert!(matches!(error, DeriveError::NotFinite { .. }), "{error}");
}

#[test]
fn initial_rates_are_checked() {
    let start = |s: &Scene| {
        let model = build(s);
        let equations = derived(&model);
        initial_velocities(&model, &equations.kinematics)
    };
    let rows = ["x' = 2*y'"];
    let mut s = particle(&["x", "y", "z"], &rows);
    s.entry("initial", "x'", 1.0);
    let error = start(&s).unwrap_err();
    let DeriveError::TooFewInitialRates { given, missing, candidates } = &error else { panic!("{error}") };
    assert_eq!((given.as_str(), missing.as_str(), candidates.as_str()), ("`x'`", "`z'`", "`z'`"));

    s.entry("initial", "z'", 3.0);
    let u = start(&s).unwrap_or_else(|e| panic!("{e}"));
    assert!(u.len() == 2 && u.contains(&3.0), "{u:?}");

    s.entry("initial", "y'", 0.5); // more than needed, in agreement
    assert!(start(&s).is_ok());
    s.set("initial.y'", "0.6").unwrap_or_else(|e| panic!("{e}"));
    let error = start(&s).unwrap_err();
    assert!(matches!(&error, DeriveError::InconsistentStart { name, .. } if name == "x'" || name == "y'"), "{error}");

    let none = particle(&["x", "y", "z"], &rows);
    let error = start(&none).unwrap_err();
    assert!(matches!(&error, DeriveError::TooFewInitialRates { given, .. } if given == "none"), "{error}");
}

#[test]
fn combine_says_why_it_does_not_apply() {
    let combine = DeriveOptions { algorithm: Algorithm::Combine, ..DeriveOptions::default() };
    let error = derive(&build(&train(2)), &combine).unwrap_err();
    let DeriveError::CombineDoesNotApply { reason } = &error else { panic!("{error}") };
    assert!(reason.contains("`m[1]`") && reason.contains("quasi-velocities"), "{reason}");

    let names: Vec<String> = (0..25).map(|i| format!("x{i}")).collect();
    let mut s = particle(&names.iter().map(String::as_str).collect::<Vec<_>>(), &[]);
    for name in &names {
        s.entry("initial", &format!("{name}'"), 0.0);
    }
    let error = derive(&build(&s), &combine).unwrap_err();
    assert!(matches!(&error, DeriveError::CombineDoesNotApply { reason } if reason.contains("25")), "{error}");
    assert_eq!(derived(&build(&s)).algorithm, "direct");
    assert!(derive(&build(&prescribed_pivot()), &combine).is_ok());
}
