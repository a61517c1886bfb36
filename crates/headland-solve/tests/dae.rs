//! Differential-algebraic problems by IDA: Robertson's reactions, the pendulum in Cartesian
//! coordinates, the car axis; events, stops, restarts, and what failures say.
#![cfg(feature = "ida")]

use headland_solve::{
    DaeProblem, EvalFailure, Ida, Method, OdeProblem, Options, Pattern, SolveError, StartLevel, Step, Unknown,
};

type Eval = Result<(), EvalFailure>;

const G: f64 = 9.81;

/// Robertson's reactions with the sum of the fractions for the third equation.
struct Robertson(Pattern);

impl DaeProblem for Robertson {
    fn len(&self) -> usize {
        3
    }
    fn differential(&self) -> &[bool] {
        &[true, true, false]
    }
    fn residual(&mut self, _t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Eval {
        let (a, b, c) = (0.04 * y[0], 3e7 * y[1] * y[1], 1e4 * y[1] * y[2]);
        r.copy_from_slice(&[dy[0] + a - c, dy[1] - a + c + b, y[0] + y[1] + y[2] - 1.0]);
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.0)
    }
    fn jacobian(&mut self, _t: f64, y: &[f64], _dy: &[f64], c: f64, j: &mut [f64]) -> Eval {
        let (b, d, e) = (6e7 * y[1], 1e4 * y[2], 1e4 * y[1]);
        j.copy_from_slice(&[c + 0.04, -0.04, 1.0, -d, c + d + b, 1.0, -e, e, 1.0]);
        Ok(())
    }
}

#[test]
fn robertson() {
    let reference = [0.2083340149701255e-7, 0.8333360770334713e-13, 0.999999979166505];
    for (rtol, least) in [(1e-6, 3.0), (1e-8, 5.0)] {
        let mut problem = Robertson(Pattern::dense(3, 3));
        let atol = [1e-10, 1e-15, 1e-2].map(|floor| floor * rtol).to_vec();
        let mut ida = Ida::new(3, Options::new(rtol, atol)).unwrap();
        let (mut y, mut dy) = ([1.0, 0.0, 0.5], [0.0; 3]);
        let report = ida.make_consistent(&mut problem, 0.0, &mut y, &mut dy).unwrap();
        let changed: Vec<&str> = report.changes.iter().map(|c| c.component.as_str()).collect();
        assert_eq!(changed, ["y[2]", "d/dt y[0]", "d/dt y[1]"]);
        assert!(report.undetermined.is_empty() && report.redundant.is_empty());
        assert!(y[2].abs() < 1e-15 && (dy[0] + 0.04).abs() < 1e-15, "{y:?} {dy:?}");
        ida.start(&mut problem, 0.0, &y, &dy).unwrap();
        run(&mut ida, &mut problem, 1e11).unwrap();
        let found = digits(ida.y(), &reference);
        println!("robertson rtol {rtol:e}: {found:.2} digits, {:?}", ida.stats());
        assert!(found > least, "{found}");
        assert!((ida.y().iter().sum::<f64>() - 1.0).abs() < 1e-13);
    }
}

/// Which form of the pendulum `x² + y² = 1`.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Form {
    /// The constraint differentiated twice: a multiplier of index 1.
    Acceleration,
    /// Gear, Gupta, Leimkuhler: positions and velocities kept, two multipliers of index 2.
    Stabilised,
}

/// ```text
/// q̇ = v − q μ    v̇ = −q λ − g e_y    0 = q·v,  0 = ½ (q·q − 1)     or, without μ,  0 = v·v − λ q·q − g y
/// ```
struct Pendulum {
    form: Form,
    exact: Option<Pattern>,
    /// Says the constraints of the stabilised form twice, the second time for this length.
    second: Option<f64>,
    t_latest: f64,
    event: bool,
    differential: Vec<bool>,
}

impl Pendulum {
    fn new(form: Form) -> Self {
        let algebraic = if form == Form::Acceleration { 1 } else { 2 };
        let differential = (0..4 + algebraic).map(|i| i < 4).collect();
        let exact = (form == Form::Stabilised).then(|| Pattern::dense(6, 6));
        Self { form, exact, second: None, t_latest: 0.0, event: false, differential }
    }

    fn doubled(length: f64) -> Self {
        let differential = (0..8).map(|i| i < 4).collect();
        Self { second: Some(length), exact: None, differential, ..Self::new(Form::Stabilised) }
    }

    /// At rest, horizontally.
    fn start(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut y, mut dy) = (vec![0.0; self.len()], vec![0.0; self.len()]);
        (y[0], dy[3]) = (1.0, -G);
        (y, dy)
    }
}

impl DaeProblem for Pendulum {
    fn len(&self) -> usize {
        self.differential.len()
    }
    fn differential(&self) -> &[bool] {
        &self.differential
    }
    fn residual(&mut self, t: f64, s: &[f64], ds: &[f64], r: &mut [f64]) -> Eval {
        self.t_latest = self.t_latest.max(t);
        let [x, y, u, v] = s[..4].try_into().unwrap();
        let (mut lambda, mut mu) = (s[4], 0.0);
        match self.form {
            Form::Acceleration => r[4] = u * u + v * v - lambda * (x * x + y * y) - G * y,
            Form::Stabilised => {
                mu = s[5];
                r[4] = x * u + y * v;
                r[5] = 0.5 * (x * x + y * y - 1.0);
            }
        }
        if let Some(length) = self.second {
            lambda += s[6];
            mu += s[7];
            r[6] = x * u + y * v;
            r[7] = 0.5 * (x * x + y * y - length * length);
        }
        r[0] = ds[0] - u + x * mu;
        r[1] = ds[1] - v + y * mu;
        r[2] = ds[2] + x * lambda;
        r[3] = ds[3] + y * lambda + G;
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        self.exact.as_ref()
    }
    fn jacobian(&mut self, _t: f64, s: &[f64], _ds: &[f64], c: f64, j: &mut [f64]) -> Eval {
        let [x, y, u, v, lambda, mu] = s.try_into().unwrap();
        j.fill(0.0);
        for (row, column, value) in [
            (0, 0, c + mu),
            (0, 2, -1.0),
            (0, 5, x),
            (1, 1, c + mu),
            (1, 3, -1.0),
            (1, 5, y),
            (2, 2, c),
            (2, 0, lambda),
            (2, 4, x),
            (3, 3, c),
            (3, 1, lambda),
            (3, 4, y),
            (4, 0, u),
            (4, 1, v),
            (4, 2, x),
            (4, 3, y),
            (5, 0, x),
            (5, 1, y),
        ] {
            j[6 * column + row] = value;
        }
        Ok(())
    }
    fn event_count(&self) -> usize {
        usize::from(self.event)
    }
    fn events(&mut self, t: f64, s: &[f64], _ds: &[f64], g: &mut [f64]) -> Eval {
        self.t_latest = self.t_latest.max(t);
        g[0] = s[0];
        Ok(())
    }
    fn start_levels(&self) -> Vec<StartLevel> {
        let names = |what: &str| {
            let second = self.second.map(|_| format!("second {what}"));
            [format!("{what} of the rod")].into_iter().chain(second).collect::<Vec<_>>()
        };
        let mut dynamics: Vec<String> = (0..4).map(|i| self.equation_name(i)).collect();
        dynamics.push("acceleration of the rod".to_owned());
        dynamics.extend((self.form == Form::Stabilised).then(|| "no correction".to_owned()));
        let mut unknowns: Vec<Unknown> = (0..4).map(Unknown::Dy).collect();
        unknowns.extend((4..self.len()).map(Unknown::Y));
        vec![
            StartLevel::new(names("length"), vec![Unknown::Y(0), Unknown::Y(1)]),
            StartLevel::new(names("velocity"), vec![Unknown::Y(2), Unknown::Y(3)]),
            StartLevel::new(dynamics, unknowns),
        ]
    }
    fn start_residual(&mut self, level: usize, t: f64, s: &[f64], ds: &[f64], r: &mut [f64]) -> Eval {
        let [x, y, u, v] = s[..4].try_into().unwrap();
        match level {
            0 => {
                r[0] = 0.5 * (x * x + y * y - 1.0);
                if let Some(length) = self.second {
                    r[1] = 0.5 * (x * x + y * y - length * length);
                }
            }
            1 => r.fill(x * u + y * v),
            _ => {
                let mut all = vec![0.0; self.len()];
                self.residual(t, s, ds, &mut all)?;
                r[..4].copy_from_slice(&all[..4]);
                r[4] = u * u + v * v + x * ds[2] + y * ds[3];
                if self.form == Form::Stabilised {
                    r[5] = s[5];
                }
            }
        }
        Ok(())
    }
    fn component_name(&self, i: usize) -> String {
        ["x", "y", "u", "v", "lambda", "mu", "lambda2", "mu2"][i].to_owned()
    }
    fn equation_name(&self, i: usize) -> String {
        let last = if self.form == Form::Acceleration { "acceleration" } else { "velocity" };
        ["dx/dt", "dy/dt", "du/dt", "dv/dt", last, "length", "velocity again", "length again"][i].to_owned()
    }
}

/// The same pendulum by its angle.
struct Angle;

impl OdeProblem for Angle {
    fn len(&self) -> usize {
        2
    }
    fn rhs(&mut self, _t: f64, s: &[f64], ds: &mut [f64]) -> Eval {
        ds.copy_from_slice(&[s[1], -G * s[0].sin()]);
        Ok(())
    }
    fn event_count(&self) -> usize {
        1
    }
    fn events(&mut self, _t: f64, s: &[f64], g: &mut [f64]) -> Eval {
        g[0] = s[0];
        Ok(())
    }
}

/// Position and velocity at the end, and the times at which the pendulum hangs down.
fn exact(t_end: f64) -> ([f64; 4], Vec<f64>) {
    let mut integrator = Method::Dop853.create(2, Options::new(1e-13, vec![1e-14; 2])).unwrap();
    integrator.start(&mut Angle, 0.0, &[0.5 * std::f64::consts::PI, 0.0]).unwrap();
    let mut hanging = Vec::new();
    loop {
        match integrator.step(&mut Angle, t_end).unwrap() {
            Step::Advanced { .. } => {}
            Step::Event { t, .. } => hanging.push(t),
            Step::End { .. } => break,
        }
    }
    let [angle, rate] = integrator.y().try_into().unwrap();
    let (s, c) = angle.sin_cos();
    ([s, -c, rate * c, rate * s], hanging)
}

fn options(problem: &dyn DaeProblem, rtol: f64) -> Options {
    let mut options = Options::new(rtol, vec![rtol; problem.len()]);
    options.suppress_algebraic = true;
    options.max_steps = 200_000;
    options
}

fn run(ida: &mut Ida, problem: &mut dyn DaeProblem, t_stop: f64) -> Result<Vec<f64>, SolveError> {
    let mut events = Vec::new();
    loop {
        match ida.step(problem, t_stop)? {
            Step::Advanced { .. } => {}
            Step::Event { t, .. } => events.push(t),
            Step::End { .. } => return Ok(events),
        }
    }
}

/// `-log10` of the largest relative error.
fn digits(y: &[f64], reference: &[f64]) -> f64 {
    let worst = y.iter().zip(reference).map(|(y, r)| ((y - r) / r).abs()).fold(0.0, f64::max);
    -worst.log10()
}

#[test]
fn pendulum_in_both_forms() {
    let (expected, _) = exact(10.0);
    for (form, rtol, error, position) in [
        (Form::Acceleration, 1e-6, 1e-2, 1e-3),
        (Form::Acceleration, 1e-9, 1e-5, 1e-6),
        (Form::Stabilised, 1e-6, 1e-2, 1e-5),
        (Form::Stabilised, 1e-9, 1e-5, 1e-8),
    ] {
        let mut problem = Pendulum::new(form);
        let mut ida = Ida::new(problem.len(), options(&problem, rtol)).unwrap();
        let (y, dy) = problem.start();
        ida.start(&mut problem, 0.0, &y, &dy).unwrap();
        let (mut length, mut along) = (0f64, 0f64);
        while !matches!(ida.step(&mut problem, 10.0).unwrap(), Step::End { .. }) {
            let [x, y, u, v] = ida.y()[..4].try_into().unwrap();
            length = length.max((f64::hypot(x, y) - 1.0).abs());
            along = along.max((x * u + y * v).abs());
        }
        let worst = ida.y().iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!(
            "{form:?} rtol {rtol:e}: error {worst:.1e}, length {length:.1e}, along {along:.1e}, {:?}",
            ida.stats()
        );
        assert!(worst < error && length < position, "{form:?} {rtol:e}: {worst:e} {length:e}");
    }
}

#[test]
fn events_are_found_and_stops_are_exact() {
    let (_, hanging) = exact(10.0);
    let mut problem = Pendulum { event: true, ..Pendulum::new(Form::Stabilised) };
    let mut ida = Ida::new(6, options(&problem, 1e-9)).unwrap();
    let (y, dy) = problem.start();
    ida.start(&mut problem, 0.0, &y, &dy).unwrap();
    let mut found = Vec::new();
    let (mut state, mut rates) = ([0.0; 6], [0.0; 6]);
    for k in 1..=30 {
        let t_stop = 10.0 * f64::from(k) / 30.0;
        found.extend(run(&mut ida, &mut problem, t_stop).unwrap());
        assert_eq!(ida.t(), t_stop);
        assert!(problem.t_latest <= t_stop);
        let t = 0.5 * (ida.t() + ida.t_previous());
        ida.interpolate(&mut problem, t, &mut state, &mut rates).unwrap();
        assert!((state[0] * state[0] + state[1] * state[1] - 1.0).abs() < 1e-6);
        assert!((rates[0] - state[2]).abs() < 1e-4, "{rates:?} {state:?}");
    }
    assert_eq!(found.len(), hanging.len());
    let worst = found.iter().zip(&hanging).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("events off by {worst:.1e}");
    assert!(worst < 1e-6, "{worst:e}");
    assert_eq!(ida.stats().events, hanging.len() as u64);
}

#[test]
fn a_restart_goes_on_counting() {
    let mut problem = Pendulum::new(Form::Stabilised);
    let mut ida = Ida::new(6, options(&problem, 1e-8)).unwrap();
    let (y, dy) = problem.start();
    ida.start(&mut problem, 0.0, &y, &dy).unwrap();
    run(&mut ida, &mut problem, 2.0).unwrap();
    let (first, once) = (ida.y().to_vec(), *ida.stats());
    ida.start(&mut problem, 0.0, &y, &dy).unwrap();
    run(&mut ida, &mut problem, 2.0).unwrap();
    assert_eq!(ida.y(), first);
    assert_eq!((ida.stats().restarts, ida.stats().steps), (1, 2 * once.steps));
    assert_eq!(ida.stats().jacobians, 2 * once.jacobians);
    // From where it is, with a correction.
    let (mut y, mut dy) = (ida.y().to_vec(), ida.dy().to_vec());
    let report = ida.make_consistent(&mut problem, 2.0, &mut y, &mut dy).unwrap();
    assert!(report.changes.iter().all(|c| (c.after - c.before).abs() < 1e-3), "{report:?}");
    ida.start(&mut problem, 2.0, &y, &dy).unwrap();
    run(&mut ida, &mut problem, 10.0).unwrap();
    let worst = ida.y().iter().zip(exact(10.0).0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-4, "{worst:e}");
}

#[test]
fn an_inconsistent_start_is_corrected_and_told() {
    let mut problem = Pendulum::new(Form::Stabilised);
    let mut ida = Ida::new(6, options(&problem, 1e-8)).unwrap();
    let (mut y, mut dy) = ([0.66, 0.88, 1.0, 0.0, 5.0, 0.1], [0.0; 6]);
    let error = ida.start(&mut problem, 0.0, &y, &dy).unwrap_err();
    assert!(matches!(error, SolveError::StartNotConsistent { .. }));
    println!("{error}");
    let report = ida.make_consistent(&mut problem, 0.0, &mut y, &mut dy).unwrap();
    println!("{report:?}");
    // The nearest point of the circle, the velocity without its part along the rod.
    let (lambda, u, v) = (0.64 - 0.8 * G, 0.64, -0.48);
    let expected = [0.6, 0.8, u, v, lambda, 0.0];
    for (y, expected) in y.iter().zip(expected) {
        assert!((y - expected).abs() < 1e-9, "{y} {expected}");
    }
    for (dy, expected) in dy.iter().zip([u, v, -0.6 * lambda, -0.8 * lambda - G]) {
        assert!((dy - expected).abs() < 1e-9, "{dy} {expected}");
    }
    assert_eq!(report.changes.len(), 10, "{report:?}");
    assert!(report.undetermined.is_empty() && report.redundant.is_empty());
    ida.start(&mut problem, 0.0, &y, &dy).unwrap();
    run(&mut ida, &mut problem, 1.0).unwrap();
}

#[test]
fn redundant_and_contradicting_constraints_are_named() {
    let mut problem = Pendulum::doubled(1.0);
    let mut ida = Ida::new(8, options(&problem, 1e-8)).unwrap();
    let (y, dy) = problem.start();
    let error = ida.make_consistent(&mut problem, 0.0, &mut y.clone(), &mut dy.clone()).unwrap_err();
    println!("{error}");
    let SolveError::SingularEquations { equations, unknowns, .. } = &error else { panic!("{error}") };
    assert!(equations.contains(&vec!["length".to_owned(), "length again".to_owned()]), "{error}");
    assert_eq!(unknowns.len(), 4, "{error}");
    // The same when it is run all the same.
    ida.start(&mut problem, 0.0, &y, &dy).unwrap();
    let error = run(&mut ida, &mut problem, 1.0).unwrap_err();
    assert!(matches!(error, SolveError::SingularEquations { .. }), "{error}");
    assert!(ida.t() < 1e-3);

    let mut problem = Pendulum::doubled(1.1);
    let (mut y, mut dy) = problem.start();
    let kept = y.clone();
    let error = ida.make_consistent(&mut problem, 0.0, &mut y, &mut dy).unwrap_err();
    println!("{error}");
    let SolveError::InconsistentStart { equations, .. } = &error else { panic!("{error}") };
    let mut names: Vec<&str> = equations.iter().map(|e| e.equation.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["length of the rod", "second length"]);
    assert_eq!(y, kept);
}
