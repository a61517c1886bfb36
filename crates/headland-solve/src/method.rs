//! The methods by name.

use crate::dop853::Dop853;
use crate::driver::Driver;
use crate::{Integrator, Options, SolveError};

/// An integration method.
///
/// ```
/// # use headland_solve::Method;
/// assert_eq!(Method::parse("dop853")?, Method::Dop853);
/// # Ok::<(), headland_solve::SolveError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum Method {
    /// Explicit Runge-Kutta of order 8 with dense output of order 7 (Dormand-Prince 8(5,3)): for
    /// smooth problems that are not stiff.
    Dop853,
    /// SUNDIALS CVODE, backward differentiation formulas of order 1 to 5 with Newton's method: for
    /// stiff problems.
    CvodeBdf,
    /// SUNDIALS CVODE, Adams-Moulton formulas of order 1 to 12 with fixed-point iteration: for
    /// problems that are not stiff and whose right-hand side is expensive. No projection.
    CvodeAdams,
    /// SUNDIALS IDA on the equations with constraints and multipliers, stabilised index 2: a method for
    /// [`DaeProblem`](crate::Ida)s, which [`create`](Self::create) does not make.
    Ida,
    /// The same in index 1: constraints on accelerations only.
    IdaIndex1,
}

impl Method {
    /// All of them, whether in this build or not.
    pub const ALL: [Self; 5] = [Self::Dop853, Self::CvodeBdf, Self::CvodeAdams, Self::Ida, Self::IdaIndex1];

    /// Its name, as [`parse`](Self::parse) reads it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Dop853 => "dop853",
            Self::CvodeBdf => "cvode-bdf",
            Self::CvodeAdams => "cvode-adams",
            Self::Ida => "ida",
            Self::IdaIndex1 => "ida-index1",
        }
    }

    /// Whether it is in this build.
    #[must_use]
    pub fn is_built(self) -> bool {
        match self {
            Self::Dop853 => true,
            Self::CvodeBdf | Self::CvodeAdams => cfg!(feature = "cvode"),
            Self::Ida | Self::IdaIndex1 => cfg!(feature = "ida"),
        }
    }

    /// Whether it solves implicit equations, and so profits from a Jacobian.
    #[must_use]
    pub fn is_implicit(self) -> bool {
        self == Self::CvodeBdf || self.is_dae()
    }

    /// Whether it is for differential-algebraic problems.
    #[must_use]
    pub fn is_dae(self) -> bool {
        matches!(self, Self::Ida | Self::IdaIndex1)
    }

    /// The method of that name.
    ///
    /// # Errors
    /// [`SolveError::UnknownMethod`], with the names of this build.
    pub fn parse(name: &str) -> Result<Self, SolveError> {
        let found = Self::ALL.into_iter().find(|m| m.name() == name);
        found.ok_or_else(|| SolveError::UnknownMethod { name: name.to_owned(), known: method_names().join(", ") })
    }

    /// An integrator for `n` components.
    ///
    /// # Errors
    /// [`SolveError::InvalidOption`], [`SolveError::NotBuilt`], or [`SolveError::ForDae`].
    pub fn create(self, n: usize, options: Options) -> Result<Box<dyn Integrator>, SolveError> {
        options.check(n)?;
        match self {
            Self::Dop853 => Ok(Box::new(Driver::new(Dop853::new(n, &options), n, &options))),
            #[cfg(feature = "cvode")]
            Self::CvodeBdf | Self::CvodeAdams => {
                let cvode = crate::cvode::Cvode::new(self == Self::CvodeBdf, n, &options)?;
                Ok(Box::new(Driver::new(cvode, n, &options)))
            }
            Self::Ida | Self::IdaIndex1 if self.is_built() => Err(SolveError::ForDae { method: self.name() }),
            Self::Ida | Self::IdaIndex1 => Err(SolveError::NotBuilt { method: self.name(), feature: "ida" }),
            #[cfg(not(feature = "cvode"))]
            Self::CvodeBdf | Self::CvodeAdams => Err(SolveError::NotBuilt { method: self.name(), feature: "cvode" }),
        }
    }
}

/// Names of the methods in this build.
#[must_use]
pub fn method_names() -> Vec<&'static str> {
    let built = Method::ALL.into_iter().filter(|m| m.is_built());
    built.map(Method::name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back() {
        for method in Method::ALL {
            assert_eq!(Method::parse(method.name()), Ok(method));
        }
        let message = Method::parse("rk5").unwrap_err().to_string();
        assert!(message.starts_with("no method `rk5`; there are dop853"));
    }

    #[test]
    #[cfg(feature = "ida")]
    fn what_is_for_other_problems_says_so() {
        let made = Method::Ida.create(1, Options::new(1e-6, vec![1e-6]));
        let message = made.err().map(|e| e.to_string()).unwrap_or_default();
        assert!(message.starts_with("method ida is for differential-algebraic problems"), "{message}");
    }

    #[test]
    #[cfg(not(feature = "cvode"))]
    fn a_method_left_out_says_which_feature_brings_it() {
        let made = Method::CvodeBdf.create(1, Options::new(1e-6, vec![1e-6]));
        let message = made.err().unwrap().to_string();
        assert_eq!(message, "method cvode-bdf is not in this build; it needs the feature `cvode`");
    }
}
