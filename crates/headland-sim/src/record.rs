//! [`Recorder`]: rows of the trajectory at the output times, by dense output.

use headland_code::Evaluator;
use headland_model::Model;
use headland_solve::SolveError;

use crate::options::RunOptions;
use crate::report::Trajectory;
use crate::stepper::Stepper;
use crate::work::Work;

/// Output times and rows.
pub(crate) struct Recorder {
    pub(crate) trajectory: Trajectory,
    factors: Vec<f64>,
    /// Times still to come, last first.
    ahead: Vec<f64>,
    /// True for rows at given times only.
    exact: bool,
    pub(crate) residual: Option<f64>,
    pub(crate) position_residual: Option<f64>,
    pub(crate) evaluations: u64,
    y: Vec<f64>,
}

impl Recorder {
    pub(crate) fn new(model: &Model, options: &RunOptions) -> Self {
        let mut ahead: Vec<f64> = match &options.at {
            Some(at) => at.clone(),
            None => {
                let n = options.points.max(1);
                let at = |i: usize| options.from + (options.until - options.from) * i as f64 / n as f64;
                (0..=n).map(|i| if i == n { options.until } else { at(i) }).collect()
            }
        };
        ahead.sort_by(|a, b| b.total_cmp(a));
        ahead.dedup();
        let trajectory = Trajectory {
            names: model.outputs.iter().map(|o| o.name.clone()).collect(),
            units: model.outputs.iter().map(|o| o.unit.clone()).collect(),
            ..Trajectory::default()
        };
        let factors = model.outputs.iter().map(|o| o.factor).collect();
        Self {
            trajectory,
            factors,
            ahead,
            exact: options.at.is_some(),
            residual: None,
            position_residual: None,
            evaluations: 0,
            y: Vec::new(),
        }
    }

    fn row(&mut self, work: &mut Work, t: f64, y: &[f64]) {
        self.evaluations += 1;
        let out = work.outputs.eval(work.problem.inputs_for(&work.system.outputs, t, y));
        self.trajectory.rows.push(out.iter().zip(&self.factors).map(|(v, f)| v * f).collect());
        self.trajectory.t.push(t);
        if work.has_residuals {
            let x = work.problem.inputs_for(&work.system.residuals, t, y);
            let worst = work.residuals.eval(x).iter().fold(0.0_f64, |a, r| a.max(r.abs()));
            self.residual = Some(self.residual.unwrap_or(0.0).max(worst));
        }
        if !work.system.positions.is_empty() {
            let worst = work.problem.position_residual(t, y);
            self.position_residual = Some(self.position_residual.unwrap_or(0.0).max(worst));
        }
    }

    /// Columns that are not finite somewhere, with the first time.
    pub(crate) fn not_finite(&self) -> Vec<(String, f64)> {
        let rows = || self.trajectory.t.iter().zip(&self.trajectory.rows);
        let first = |i: usize| rows().find(|(_, row)| !row[i].is_finite()).map(|(t, _)| *t);
        let names = self.trajectory.names.iter().enumerate();
        names.filter_map(|(i, name)| first(i).map(|t| (name.clone(), t))).collect()
    }

    /// The row at which a run ended before its time, where rows are not asked for at given times.
    pub(crate) fn last_row(&mut self, work: &mut Work, t: f64, y: &[f64]) {
        if !self.exact && self.trajectory.t.last().is_some_and(|last| *last < t) {
            self.row(work, t, y);
        }
    }

    /// Rows for all output times up to where the integrator is.
    pub(crate) fn catch_up(&mut self, work: &mut Work, integrator: &mut Stepper) -> Result<(), SolveError> {
        while let Some(&t) = self.ahead.last().filter(|t| **t <= integrator.t()) {
            self.ahead.pop();
            let mut y = std::mem::take(&mut self.y);
            y.resize(integrator.y().len(), 0.0);
            if t == integrator.t() {
                y.copy_from_slice(integrator.y());
            } else {
                integrator.interpolate(&mut work.problem, t, &mut y)?;
            }
            if work.system.nu == 0 {
                // nothing moves of itself: the constraints give the positions, to rounding
                work.problem.settle_positions(t, &mut y);
            }
            self.row(work, t, &y);
            self.y = y;
        }
        Ok(())
    }
}
