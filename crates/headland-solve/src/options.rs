//! What is asked of an integrator.

use crate::SolveError;

/// Tolerances, step limits and method settings.
///
/// A step is accepted when `error_i / (atol_i + rtol |y_i|)` is at most 1: for every component with `dop853`, in the
/// root mean square over the components with CVODE and IDA.
///
/// ```
/// let mut options = headland_solve::Options::new(1e-8, vec![1e-10; 3]);
/// options.h_max = 0.01;
/// ```
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Options {
    /// Relative tolerance, from 2.3e-15 (ten roundings of a double) to below 1.
    pub rtol: f64,
    /// Absolute tolerance of each component, in its unit; positive.
    pub atol: Vec<f64>,
    /// First step after each start; `None`: the method guesses.
    pub h_first: Option<f64>,
    /// Longest step; infinite by default.
    pub h_max: f64,
    /// Accepted steps over the whole run, restarts included; no limit by default.
    pub max_steps: u64,
    /// Places inside a step at which the signs of the event functions are looked at, besides its
    /// end; 3 by default. With 0, two changes of sign of one function within a step go unseen. Each
    /// costs one evaluation of the event functions on a cheap interpolant.
    pub event_samples: u32,
    /// Highest order of the multistep methods (BDF 5, Adams 12); `None`: all that there is.
    pub max_order: Option<u8>,
    /// BDF: whether the order is lowered when a mode close to the imaginary axis makes orders 3 to
    /// 5 unstable. Off by default.
    pub stability_limit_detection: bool,
    /// IDA: whether all algebraic components are left out of the error test. Off by default; wanted
    /// for problems of index 2, whose multipliers are less accurate than the rest.
    pub suppress_algebraic: bool,
    /// IDA: part of the tolerances to which Newton's iteration is driven; 0.33 by default, that of the library.
    pub iteration_tolerance: f64,
}

impl Options {
    /// The defaults with these tolerances.
    #[must_use]
    pub fn new(rtol: f64, atol: Vec<f64>) -> Self {
        Self {
            rtol,
            atol,
            h_first: None,
            h_max: f64::INFINITY,
            max_steps: u64::MAX,
            event_samples: 3,
            max_order: None,
            stability_limit_detection: false,
            suppress_algebraic: false,
            iteration_tolerance: 0.33,
        }
    }

    /// Whether a method for `n` components can work with them.
    ///
    /// # Errors
    /// [`SolveError::InvalidOption`], which says what would be right.
    pub fn check(&self, n: usize) -> Result<(), SolveError> {
        let wrong = |option: &str, value: String, expected: String| {
            Err(SolveError::InvalidOption { option: option.to_owned(), value, expected })
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !(10.0 * f64::EPSILON..1.0).contains(&self.rtol) {
            let value = format!("{:e}", self.rtol);
            return wrong("rtol", value, "from 2.3e-15 to below 1".to_owned());
        }
        if self.atol.len() != n {
            let value = format!("{} values", self.atol.len());
            return wrong("atol", value, format!("one for each of {n} components"));
        }
        if let Some(i) = (0..n).find(|&i| !positive(self.atol[i])) {
            let value = format!("{:e}", self.atol[i]);
            return wrong(&format!("atol[{i}]"), value, "positive, finite".to_owned());
        }
        if let Some(h) = self.h_first.filter(|&h| !positive(h)) {
            return wrong("h_first", format!("{h:e}"), "positive, finite".to_owned());
        }
        if !positive(self.iteration_tolerance) {
            return wrong(
                "iteration_tolerance",
                format!("{:e}", self.iteration_tolerance),
                "positive, finite".to_owned(),
            );
        }
        if self.h_max.is_nan() || self.h_max <= 0.0 {
            return wrong("h_max", format!("{:e}", self.h_max), "positive".to_owned());
        }
        Ok(())
    }
}
