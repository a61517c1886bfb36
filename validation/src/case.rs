//! [`Case`]: a scene, what is set in it, and the values that it must reach.

use std::time::Instant;

use headland::model::Data;
use headland::{Error, Method, Model, Run, RunOptions, Scene, Silent, Status};
use serde::Serialize;

/// A reference problem.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// File name and text of the scene.
    pub scene: (&'static str, &'static str),
    /// What is set in the scene, as `--set name=value` does.
    pub set: &'static [(&'static str, &'static str)],
    /// Columns that the scene does not have.
    pub columns: &'static [&'static str],
    /// Method of integration.
    pub method: &'static str,
    /// Tolerance of the run.
    pub tolerance: f64,
    /// Allowed error of the values, absolute relative to `max(1, |reference|)`.
    pub allowed: f64,
    /// Allowed defect of work against energy.
    pub balance: f64,
    /// The values to reach.
    pub expected: fn() -> Vec<Expected>,
    /// A change of the scene by about one per cent that must make the case fail.
    pub bite: (&'static str, &'static str),
    /// Where the values come from.
    pub source: &'static str,
}

/// When an output is compared.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Moment {
    /// At a time, s.
    At(f64),
    /// Its least value over the run.
    Least,
    /// Its largest value over the run.
    Most,
}

/// A value that an output must have.
#[derive(Clone, PartialEq, Debug)]
pub struct Expected {
    /// Names of columns; of several the extreme counts.
    pub columns: Vec<String>,
    /// When.
    pub moment: Moment,
    /// The reference.
    pub value: f64,
    /// Allowed absolute error, instead of the case's.
    pub allowed: Option<f64>,
}

impl Expected {
    /// A column at a time.
    pub fn at(t: f64, column: impl Into<String>, value: f64) -> Self {
        Self { columns: vec![column.into()], moment: Moment::At(t), value, allowed: None }
    }

    /// The extreme of several columns over the run.
    pub fn extreme(moment: Moment, columns: &[&str], value: f64, allowed: f64) -> Self {
        let columns = columns.iter().map(|c| (*c).to_string()).collect();
        Self { columns, moment, value, allowed: Some(allowed) }
    }
}

/// One value against its reference.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Comparison {
    /// Column or columns.
    pub quantity: String,
    /// When.
    pub moment: Moment,
    /// As computed.
    pub value: f64,
    /// The reference.
    pub reference: f64,
    /// Error, absolute relative to `max(1, |reference|)`.
    pub error: f64,
    /// Allowed error in the same measure.
    pub allowed: f64,
}

impl Comparison {
    pub(crate) fn new(quantity: String, moment: Moment, value: f64, expected: f64, allowed: Result<f64, f64>) -> Self {
        let size = expected.abs().max(1.0);
        let error = (value - expected).abs() / size;
        let allowed = allowed.unwrap_or_else(|absolute| absolute / size);
        Self { quantity, moment, value, reference: expected, error, allowed }
    }

    /// Error over what is allowed; infinite if the value is not a number.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        let ratio = self.error / self.allowed;
        if ratio.is_nan() { f64::INFINITY } else { ratio }
    }
}

/// How one problem went.
#[derive(Clone, Debug, Serialize)]
pub struct CaseResult {
    /// Its name.
    pub name: &'static str,
    /// Where the reference values come from.
    pub source: &'static str,
    /// Largest error over what is allowed, the energy balance included; infinite if the run failed.
    pub ratio: f64,
    /// Number of values compared.
    pub compared: usize,
    /// The comparison that is nearest to its bound.
    pub worst: Option<Comparison>,
    /// Largest defect of work against energy.
    pub energy_balance: Option<f64>,
    /// What is allowed of it.
    pub allowed_balance: f64,
    /// Method of integration.
    pub method: String,
    /// Evaluations of the right-hand side.
    pub rhs: u64,
    /// Derivation, compilation and integration together, s.
    pub seconds: f64,
    /// Why there are no values.
    pub failure: Option<String>,
}

impl CaseResult {
    /// Whether it is within tolerance.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.ratio <= 1.0
    }
}

impl Case {
    /// What cases have unless they say otherwise.
    pub(crate) const USUAL: Self = Self {
        name: "",
        scene: ("", ""),
        set: &[],
        columns: &[],
        method: "auto",
        tolerance: 1e-12,
        allowed: 1e-9,
        balance: 1e-8,
        expected: Vec::new,
        bite: ("", ""),
        source: "",
    };

    /// Whether its method is built.
    #[must_use]
    pub fn is_built(&self) -> bool {
        self.method == "auto" || Method::parse(self.method).is_ok_and(Method::is_built)
    }

    /// Integrates and compares.
    #[must_use]
    pub fn run(&self) -> CaseResult {
        self.run_with(&[])
    }

    /// As [`run`](Self::run), with more set in the scene.
    #[must_use]
    pub fn run_with(&self, more: &[(&str, &str)]) -> CaseResult {
        let clock = Instant::now();
        let expected = (self.expected)();
        let outcome = self.integrate(&expected, more);
        let mut result = CaseResult {
            name: self.name,
            source: self.source,
            ratio: f64::INFINITY,
            compared: 0,
            worst: None,
            energy_balance: None,
            allowed_balance: self.balance,
            method: self.method.into(),
            rhs: 0,
            seconds: clock.elapsed().as_secs_f64(),
            failure: None,
        };
        match outcome {
            Ok(run) => self.compare(&expected, &run, &mut result),
            Err(error) => result.failure = Some(error.to_string()),
        }
        result
    }

    fn integrate(&self, expected: &[Expected], more: &[(&str, &str)]) -> Result<Run, Error> {
        let (model, options) = self.prepare(expected, more)?;
        Ok(headland::run(&model, &options, &mut Silent)?)
    }

    /// The model with what is set, and how it is to be run for the expected values.
    ///
    /// # Errors
    /// If the scene is wrong.
    pub fn prepare(&self, expected: &[Expected], more: &[(&str, &str)]) -> Result<(Model, RunOptions), Error> {
        let mut scene = Scene::parse(self.scene.0, self.scene.1)?;
        for (name, value) in self.set.iter().chain(more) {
            scene.set(name, value)?;
        }
        let outputs = scene.tables.get_mut("outputs").into_iter().flatten().find(|e| e.key == "columns");
        if let Some(Data::Array(columns)) = outputs.map(|e| &mut e.value.data) {
            columns.extend(self.columns.iter().map(|c| (*c).into()));
        }
        let model = scene.build()?;
        let mut options = RunOptions::of(&model);
        options.tolerance = self.tolerance;
        options.method = self.method.into();
        let times: Vec<f64> =
            expected.iter().filter_map(|e| if let Moment::At(t) = e.moment { Some(t) } else { None }).collect();
        if times.len() == expected.len() {
            options.until = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            options.at = Some(times);
        } else {
            options.points = 3000;
        }
        Ok((model, options))
    }

    fn compare(&self, expected: &[Expected], run: &Run, result: &mut CaseResult) {
        result.method.clone_from(&run.report.method);
        result.rhs = run.report.rhs;
        result.energy_balance = run.report.energy_balance;
        if let Status::Failed(reason) = &run.report.status {
            result.failure = Some(reason.clone());
            return;
        }
        let mut worst: Option<Comparison> = None;
        for e in expected {
            let Some(value) = value_of(run, e) else {
                result.failure = Some(format!("the scene has no column {} at that time", e.columns.join(", ")));
                return;
            };
            let allowed = e.allowed.map_or(Ok(self.allowed), Err);
            let comparison = Comparison::new(e.columns.join(", "), e.moment, value, e.value, allowed);
            if worst.as_ref().is_none_or(|w| comparison.ratio() > w.ratio()) {
                worst = Some(comparison);
            }
        }
        result.compared = expected.len();
        let defect = run.report.energy_balance.map_or(f64::INFINITY, |b| if b.is_nan() { f64::INFINITY } else { b });
        result.ratio = worst.as_ref().map_or(f64::INFINITY, Comparison::ratio).max(defect / self.balance);
        result.worst = worst;
    }
}

/// The value that a run has for what is expected; `None` if it has no such column or time.
#[must_use]
pub fn value_of(run: &Run, expected: &Expected) -> Option<f64> {
    let columns: Option<Vec<Vec<f64>>> = expected.columns.iter().map(|c| run.trajectory.named(c)).collect();
    let columns = columns?;
    let all = columns.iter().flatten().copied();
    match expected.moment {
        Moment::At(t) => {
            let row = run.trajectory.t.iter().position(|x| *x == t)?;
            columns.first()?.get(row).copied()
        }
        Moment::Least => all.reduce(f64::min),
        Moment::Most => all.reduce(f64::max),
    }
}
