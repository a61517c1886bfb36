//! What IDA says when a differential-algebraic problem cannot be started or brought further.
#![cfg(feature = "ida")]

use std::panic::{AssertUnwindSafe, catch_unwind};

use headland_solve::{DaeProblem, EvalFailure, Ida, Options, SolveError, Step};

type Eval = Result<(), EvalFailure>;
type Residual = Box<dyn FnMut(f64, &[f64], &[f64], &mut [f64]) -> Eval>;

/// A problem of closures.
struct Problem {
    differential: Vec<bool>,
    residual: Residual,
}

impl Problem {
    fn new(differential: &[bool], residual: impl FnMut(f64, &[f64], &[f64], &mut [f64]) -> Eval + 'static) -> Self {
        Self { differential: differential.to_vec(), residual: Box::new(residual) }
    }
}

impl DaeProblem for Problem {
    fn len(&self) -> usize {
        self.differential.len()
    }
    fn differential(&self) -> &[bool] {
        &self.differential
    }
    fn residual(&mut self, t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Eval {
        (self.residual)(t, y, dy, r)
    }
    fn component_name(&self, i: usize) -> String {
        format!("x{i}")
    }
    fn equation_name(&self, i: usize) -> String {
        format!("eq{i}")
    }
}

fn ida(n: usize) -> Ida {
    let mut options = Options::new(1e-6, vec![1e-6; n]);
    options.max_steps = 10_000;
    Ida::new(n, options).unwrap()
}

/// From a start as given to `t = 1`.
fn run(ida: &mut Ida, problem: &mut Problem, y: &[f64], dy: &[f64]) -> Result<(), SolveError> {
    ida.start(problem, 0.0, y, dy)?;
    while !matches!(ida.step(problem, 1.0)?, Step::End { .. }) {}
    Ok(())
}

#[test]
fn an_equation_without_unknowns_is_named() {
    let mut problem = Problem::new(&[true, false], |_, y, dy, r| {
        r.copy_from_slice(&[dy[0] + y[0], 0.0]);
        Ok(())
    });
    let mut ida = ida(2);
    let error = run(&mut ida, &mut problem, &[1.0, 0.0], &[-1.0, 0.0]).unwrap_err();
    let message = "the equations are singular at t = 0 s: `eq1` contains none of the unknowns; nothing determines `x1`";
    assert_eq!(error.to_string(), message);
    let error = ida.make_consistent(&mut problem, 0.0, &mut [1.0, 0.0], &mut [0.0; 2]).unwrap_err();
    assert_eq!(error.to_string(), message);
}

#[test]
fn an_equation_that_cannot_be_satisfied_is_named() {
    let mut problem = Problem::new(&[true, false], |_, y, dy, r| {
        r.copy_from_slice(&[dy[0] + y[0], y[1] * y[1] + 1.0]);
        Ok(())
    });
    let (mut y, mut dy) = ([1.0, 0.5], [0.0; 2]);
    let error = ida(2).make_consistent(&mut problem, 0.0, &mut y, &mut dy).unwrap_err();
    println!("{error}");
    let SolveError::InconsistentStart { equations, .. } = &error else { panic!("{error}") };
    assert_eq!(equations[0].equation, "eq1");
    assert!(equations[0].residual >= 1.0);
    assert_eq!((y, dy), ([1.0, 0.5], [0.0; 2]));
}

#[test]
fn a_hidden_constraint_is_told() {
    // Index 2: y0 = sin t is given, so y1 = y0' = cos t, which no equation says.
    let residual = |t: f64, y: &[f64], dy: &[f64], r: &mut [f64]| {
        r.copy_from_slice(&[dy[0] - y[1], y[0] - t.sin()]);
        Ok(())
    };
    let mut problem = Problem::new(&[true, false], residual);
    let mut ida = ida(2);
    let (mut y, mut dy) = ([0.0, 0.0], [0.0, 0.0]);
    let report = ida.make_consistent(&mut problem, 0.0, &mut y, &mut dy).unwrap();
    assert_eq!(report.undetermined, ["x1", "d/dt x0"]);
    let error = run(&mut ida, &mut problem, &y, &dy).unwrap_err();
    println!("{error}");
    let SolveError::HiddenConstraint { undetermined, .. } = &error else { panic!("{error}") };
    assert_eq!(undetermined, &["x1", "d/dt x0"]);
    // A differential component that contradicts its equation cannot be moved.
    let error = ida.make_consistent(&mut problem, 0.0, &mut [0.5, 0.0], &mut [0.0; 2]).unwrap_err();
    let SolveError::InconsistentStart { equations, .. } = &error else { panic!("{error}") };
    assert_eq!((equations.len(), equations[0].equation.as_str()), (1, "eq1"));
    // From the right start it runs, with the multiplier out of the error test.
    let mut options = Options::new(1e-6, vec![1e-6; 2]);
    options.suppress_algebraic = true;
    ida = Ida::new(2, options).unwrap();
    run(&mut ida, &mut problem, &[0.0, 1.0], &[1.0, 0.0]).unwrap();
    assert!((ida.y()[1] - 1f64.cos()).abs() < 1e-4);
}

#[test]
fn values_that_are_not_finite_name_the_equation() {
    let mut problem = Problem::new(&[true, false], |t, y, dy, r| {
        let bad = if t > 0.5 { f64::NAN } else { 0.0 };
        r.copy_from_slice(&[dy[0] + y[0], y[1] - y[0] + bad]);
        Ok(())
    });
    let mut ida = ida(2);
    let error = run(&mut ida, &mut problem, &[1.0, 1.0], &[-1.0, 0.0]).unwrap_err();
    let SolveError::NotFinite { component, .. } = &error else { panic!("{error}") };
    assert_eq!(component, "eq1");
    assert!(ida.t() > 0.49 && ida.t() <= 0.5 && (ida.y()[0] - (-ida.t()).exp()).abs() < 1e-4);
    let error = ida.make_consistent(&mut problem, 1.0, &mut [1.0; 2], &mut [0.0; 2]).unwrap_err();
    assert!(matches!(error, SolveError::NotFinite { .. }), "{error}");
    let error = ida.start(&mut problem, 0.0, &[1.0, f64::NAN], &[0.0; 2]).unwrap_err();
    assert_eq!(error.to_string(), "cannot start at t = 0 s: `x1` is NaN");
}

#[test]
fn failures_and_panics_come_through() {
    let mut problem = Problem::new(&[true], |t, y, dy, r| {
        r[0] = dy[0] + y[0];
        if t > 0.5 { Err(EvalFailure::Fatal) } else { Ok(()) }
    });
    let error = run(&mut ida(1), &mut problem, &[1.0], &[-1.0]).unwrap_err();
    assert!(error.to_string().starts_with("residual of the equations could not be evaluated"), "{error}");

    let mut problem = Problem::new(&[true], |t, y, dy, r| {
        assert!(t < 0.5, "far enough");
        r[0] = dy[0] + y[0];
        Ok(())
    });
    let mut ida = ida(1);
    let caught = catch_unwind(AssertUnwindSafe(|| run(&mut ida, &mut problem, &[1.0], &[-1.0])));
    assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"far enough"));
    // It can be started again.
    ida.start(&mut problem, 0.0, &[1.0], &[-1.0]).unwrap();
    while !matches!(ida.step(&mut problem, 0.4).unwrap(), Step::End { .. }) {}
    assert!((ida.y()[0] - (-0.4f64).exp()).abs() < 1e-5);
}

#[test]
fn steps_are_bounded() {
    let mut problem = Problem::new(&[true], |_, y, dy, r| {
        r[0] = dy[0] + y[0];
        Ok(())
    });
    let mut options = Options::new(1e-4, vec![1e-4]);
    options.h_max = 0.01;
    let mut ida = Ida::new(1, options.clone()).unwrap();
    ida.start(&mut problem, 0.0, &[1.0], &[-1.0]).unwrap();
    while ida.t() < 0.5 {
        ida.step(&mut problem, 1.0).unwrap();
        assert!(ida.t() - ida.t_previous() < 0.01 * (1.0 + 1e-12));
    }
    ida.set_h_max(0.001);
    ida.step(&mut problem, 1.0).unwrap();
    assert!(ida.t() - ida.t_previous() < 0.001 * (1.0 + 1e-12));

    options.max_steps = 5;
    let mut ida = Ida::new(1, options.clone()).unwrap();
    let error = run(&mut ida, &mut problem, &[1.0], &[-1.0]).unwrap_err();
    assert!(matches!(error, SolveError::TooManySteps { steps: 5, .. }), "{error}");
    options.max_order = Some(6);
    assert!(matches!(Ida::new(1, options), Err(SolveError::InvalidOption { .. })));
}

#[test]
fn nothing_at_all_can_be_run() {
    let mut problem = Problem::new(&[], |_, _, _, _| Ok(()));
    let mut ida = ida(0);
    ida.make_consistent(&mut problem, 0.0, &mut [], &mut []).unwrap();
    run(&mut ida, &mut problem, &[], &[]).unwrap();
    assert_eq!(ida.t(), 1.0);
}
