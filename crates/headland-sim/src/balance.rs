//! The energy balance: work of all forces and drives against the change of energy.
//!
//! ```text
//! defect = max over t of |T + V − (T₀ + V₀) − ∫ Σ P d′ dt|,   relative to the largest energy and work of the run
//! ```
//! The integral is taken over each accepted step by Gauss' rule with four points (order 8) on the dense output.

use std::rc::Rc;

use headland_code::{Evaluator, Function, TapeEvaluator};
use headland_solve::SolveError;

use crate::stepper::Stepper;
use crate::system::{Problem, System};

/// Abscissas on (0, 1) and weights of Gauss' rule with four points.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Work and energy since the start.
pub struct Balance {
    system: Rc<System>,
    energies: TapeEvaluator,
    y: Vec<f64>,
    start: Option<f64>,
    work: f64,
    /// `∫ |Σ P d′| dt` and the largest energy: what a defect is measured by.
    turnover: f64,
    largest: f64,
    /// Largest defect so far, J.
    worst: f64,
    /// Evaluations of energies and power.
    pub evaluations: u64,
}

impl Balance {
    /// Starts the account.
    pub fn new(system: Rc<System>) -> Self {
        Self {
            energies: system.energies.function.evaluator(),
            y: vec![0.0; system.len()],
            system,
            start: None,
            work: 0.0,
            turnover: 0.0,
            largest: 0.0,
            worst: 0.0,
            evaluations: 0,
        }
    }

    /// The account goes on with another system (a new partition).
    pub fn change_system(&mut self, system: Rc<System>) {
        self.energies = system.energies.function.evaluator();
        self.y.resize(system.len(), 0.0);
        self.system = system;
    }

    /// Energy `T + V` and power at a state.
    fn evaluate(&mut self, problem: &mut Problem, t: f64, y: &[f64]) -> (f64, f64, f64) {
        self.evaluations += 1;
        let out = self.energies.eval(problem.inputs_for(&self.system.energies, t, y));
        (out[0], out[1], out[2])
    }

    /// Notes the state at the start.
    pub fn open(&mut self, problem: &mut Problem, t: f64, y: &[f64]) {
        let (kinetic, potential, _) = self.evaluate(problem, t, y);
        // impacts at the start were before this state
        self.start = Some(kinetic + potential - self.work);
        self.largest = kinetic.abs() + potential.abs();
    }

    /// Adds the last step of the integrator.
    ///
    /// # Errors
    /// If the dense output cannot be evaluated.
    pub fn add_step(&mut self, problem: &mut Problem, integrator: &mut Stepper) -> Result<(), SolveError> {
        let (t0, t1) = (integrator.t_previous(), integrator.t());
        let h = t1 - t0;
        if h > 0.0 {
            for (c, weight) in GAUSS {
                let mut y = std::mem::take(&mut self.y);
                y.resize(integrator.y().len(), 0.0);
                integrator.interpolate(problem, t0 + c * h, &mut y)?;
                let (_, _, power) = self.evaluate(problem, t0 + c * h, &y);
                self.y = y;
                self.work += weight * h * power;
                self.turnover += weight * h * power.abs();
            }
        }
        let y = integrator.y().to_vec();
        let (kinetic, potential, _) = self.evaluate(problem, t1, &y);
        self.largest = self.largest.max(kinetic.abs() + potential.abs());
        if let Some(start) = self.start {
            self.worst = self.worst.max((kinetic + potential - start - self.work).abs());
        }
        Ok(())
    }

    /// Work done at once, by an impact.
    pub fn add_work(&mut self, work: f64) {
        self.work += work;
        self.turnover += work.abs();
    }

    /// The largest defect relative to the largest energy and work; 0 where nothing has energy.
    pub fn defect(&self) -> f64 {
        let size = self.largest.max(self.turnover);
        if size > 0.0 { self.worst / size } else { 0.0 }
    }
}
