//! [`Stepper`]: what steps a run: an integrator for ordinary differential equations, or IDA on the constraints.

use headland_solve::{Integrator, SolveError, Stats, Step};

use crate::system::Problem;

/// The method at work on a [`Problem`]; the same contract as [`Integrator`].
pub enum Stepper {
    /// On the state `y = [q, u]`.
    Ode(Box<dyn Integrator>),
    /// On coordinates, all velocities and multipliers; seen as `[q, v, v′, λ]`.
    #[cfg(feature = "ida")]
    Dae(Box<crate::dae::DaeStepper>),
}

impl Stepper {
    /// Starts or restarts. What had to be changed to make the start consistent is in [`Self::take_notes`].
    ///
    /// # Errors
    /// As [`Integrator::start`].
    pub fn start(&mut self, problem: &mut Problem, t: f64, y: &[f64]) -> Result<(), SolveError> {
        match self {
            Self::Ode(integrator) => integrator.start(problem, t, y),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.start(problem, t, y),
        }
    }

    /// One accepted step.
    ///
    /// # Errors
    /// As [`Integrator::step`].
    pub fn step(&mut self, problem: &mut Problem, t_stop: f64) -> Result<Step, SolveError> {
        match self {
            Self::Ode(integrator) => integrator.step(problem, t_stop),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.step(problem, t_stop),
        }
    }

    /// Time reached.
    pub fn t(&self) -> f64 {
        match self {
            Self::Ode(integrator) => integrator.t(),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.ida.t(),
        }
    }

    /// Where the last step set out.
    pub fn t_previous(&self) -> f64 {
        match self {
            Self::Ode(integrator) => integrator.t_previous(),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.ida.t_previous(),
        }
    }

    /// State at [`Self::t`].
    pub fn y(&self) -> &[f64] {
        match self {
            Self::Ode(integrator) => integrator.y(),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => &dae.view,
        }
    }

    /// State inside the last step.
    ///
    /// # Errors
    /// As [`Integrator::interpolate`].
    pub fn interpolate(&mut self, problem: &mut Problem, t: f64, y: &mut [f64]) -> Result<(), SolveError> {
        match self {
            Self::Ode(integrator) => integrator.interpolate(problem, t, y),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.interpolate(problem, t, y),
        }
    }

    /// Changes the longest step.
    pub fn set_h_max(&mut self, h: f64) {
        match self {
            Self::Ode(integrator) => integrator.set_h_max(h),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.ida.set_h_max(h),
        }
    }

    /// The step that would be taken next, where the method says so.
    pub fn proposed_step(&self) -> Option<f64> {
        match self {
            Self::Ode(integrator) => integrator.proposed_step(),
            #[cfg(feature = "ida")]
            Self::Dae(_) => None,
        }
    }

    /// As [`Integrator::set_leniency`].
    pub fn set_leniency(&mut self, factor: f64) {
        match self {
            Self::Ode(integrator) => integrator.set_leniency(factor),
            #[cfg(feature = "ida")]
            Self::Dae(_) => {}
        }
    }

    /// Whether an implicit method would take longer steps.
    pub fn looks_stiff(&self) -> bool {
        match self {
            Self::Ode(integrator) => integrator.looks_stiff(),
            #[cfg(feature = "ida")]
            Self::Dae(_) => false,
        }
    }

    /// Events at the time reached that are not told yet.
    pub fn events_waiting(&self) -> usize {
        match self {
            Self::Ode(integrator) => integrator.events_waiting(),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.ida.events_waiting(),
        }
    }

    /// What was counted.
    pub fn stats(&self) -> &Stats {
        match self {
            Self::Ode(integrator) => integrator.stats(),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => dae.ida.stats(),
        }
    }

    /// What the last start changed.
    pub fn take_notes(&mut self) -> Vec<String> {
        match self {
            Self::Ode(_) => Vec::new(),
            #[cfg(feature = "ida")]
            Self::Dae(dae) => std::mem::take(&mut dae.notes),
        }
    }
}
