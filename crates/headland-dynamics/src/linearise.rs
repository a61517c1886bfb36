//! Linearisation about an equilibrium or a relative equilibrium, constraints on positions and on velocities respected.
//!
//! ```text
//! q = q₀(t) + T s,   u = u₀ + w        s: displacements along the constraints on positions, T = T(q, t)
//! s′ = T⁺ ((∂f/∂q) T − T′) s + T⁺ (∂f/∂u) w + T⁺ (∂f/∂p) p        f = G u + g = q′
//! w′ = (∂a/∂q) T s + (∂a/∂u) w + (∂a/∂p) p                          a = M⁻¹ F = u′
//! ```
//! Wheels that roll bind velocities, not displacements: u are the independent velocities of the equations, s is whatever
//! the joints and the constraints on positions leave (so a sleigh has three displacements and two velocities). A ball's
//! three displacements are turns about the axes of its angular velocity. `T′` is the rate of T along the motion. All
//! derivatives are those of dual numbers: exact, no differences.
//!
//! A displacement on which nothing depends (a place, a heading, the angle of a wheel) is *cyclic*: it follows from the
//! others and is left out of the eigenvalues and of the test that A is constant.
//!
//! In order: [`linearise`] is the whole, `tangent` makes T, `derivatives` the matrices, `steady` refuses a state that
//! is neither equilibrium nor relative equilibrium, `carried` takes other axes for a body that spins, [`modes`] has the
//! eigenvalues.
//!
//! # References
//! Meijaard, Papadopoulos, Ruina, Schwab, *Linearized dynamics equations for the balance and steer of a bicycle*,
//! 2007, section 5; Peterson, Gede, Hubbard, *Symbolic linearization of equations of motion of constrained multibody
//! systems*, 2015 (the split into positions and velocities).

mod carried;
mod derivatives;
pub mod modes;
mod steady;
mod tangent;

use headland_model::Model;
use nalgebra::DMatrix;

use crate::derive::Equations;
use crate::error::DeriveError;
use crate::initial::{assemble, initial_velocities};
use derivatives::Derivatives;
pub use modes::{Mode, modes};
pub use steady::pattern;

/// A state of the linear system, or one of its inputs.
#[derive(Clone, PartialEq, Debug)]
pub struct LinearState {
    /// Name: a coordinate's, `∫w` for the turn that belongs to a joint's velocity `w`, or a quasi-velocity's; `lean of b`,
    /// `precession of b`, `spin of b` where the turns and velocities of b are along axes that do not spin with it.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Its value in the motion about which the system is linear; turns count from there.
    pub value: f64,
    /// True for a displacement on which nothing depends.
    pub cyclic: bool,
}

/// `x′ = A x + B p` with `x = [s, w]`, in SI units.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// Time of the state, s.
    pub t: f64,
    /// True if nothing moves; else the motion is steady.
    pub at_rest: bool,
    /// Displacements, then velocities.
    pub states: Vec<LinearState>,
    /// How many of the states are displacements.
    pub displacements: usize,
    /// Parameters that serve as inputs.
    pub inputs: Vec<LinearState>,
    /// A, cyclic displacements included.
    pub a: DMatrix<f64>,
    /// B, cyclic displacements included.
    pub b: DMatrix<f64>,
    /// Mass matrix of the velocities.
    pub mass: DMatrix<f64>,
}

impl Linearised {
    /// States that are not cyclic, by position.
    pub fn kept(&self) -> Vec<usize> {
        (0..self.states.len()).filter(|&i| !self.states[i].cyclic).collect()
    }

    /// A of the states that are not cyclic.
    pub fn reduced_a(&self) -> DMatrix<f64> {
        let kept = self.kept();
        DMatrix::from_fn(kept.len(), kept.len(), |i, j| self.a[(kept[i], kept[j])])
    }

    /// B of the states that are not cyclic.
    pub fn reduced_b(&self) -> DMatrix<f64> {
        let kept = self.kept();
        DMatrix::from_fn(kept.len(), self.inputs.len(), |i, j| self.b[(kept[i], j)])
    }

    /// Entry of A by names.
    pub fn entry(&self, row: &str, column: &str) -> Option<f64> {
        let find = |name: &str| self.states.iter().position(|s| s.name == name);
        Some(self.a[(find(row)?, find(column)?)])
    }

    /// Eigenvalues of [`Self::reduced_a`], the fastest growing first.
    ///
    /// # Errors
    /// [`LineariseError::NoEigenvalues`].
    pub fn modes(&self) -> Result<Vec<Mode>, LineariseError> {
        modes(&self.reduced_a())
    }
}

/// Why there is no linear system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineariseError {
    /// The derivation.
    #[error(transparent)]
    Derive(#[from] DeriveError),
    /// Not a parameter.
    #[error("the input `{name}` is not a parameter of the scene; its parameters: {known}")]
    UnknownInput {
        /// As asked for.
        name: String,
        /// The parameters.
        known: String,
    },
    /// A parameter that moves the constraints: a step of it would be a jump of the coordinates.
    #[error(
        "the parameter `{name}` cannot be an input: a constraint on positions depends on it, and a change would move the \
         coordinates at once; take a force or a torque, or a prescribed motion"
    )]
    InputMovesConstraints {
        /// The parameter.
        name: String,
    },
    /// The state does not fulfil the constraints.
    #[error("the state violates the constraints on positions by {residual:.1e}; nothing was linearised")]
    OffConstraints {
        /// Largest residual.
        residual: f64,
    },
    /// Something is not finite.
    #[error("{what} is not finite at t = {t} s; nothing was linearised")]
    NotFinite {
        /// What.
        what: String,
        /// When.
        t: f64,
    },
    /// Velocities change.
    #[error(
        "the state is neither an equilibrium nor a steady motion{}: {list}. A linear system with constant matrices exists \
         only where all u′ are zero and stay zero: change the start (coordinates, velocities, forces; `--set NAME=VALUE`) \
         to one that does{}",
        if *after > 0.0 { format!(" ({after:.2e} s later)") } else { String::new() },
        if *turning { "; where only the axes of a body turn that spins freely, give its joint `orientation = \"rpy\"`, or \
         put massless bodies between, so that the velocities of the steady motion are constant" } else { "" }
    )]
    NotSteady {
        /// The rates, `u′ = value unit`.
        list: String,
        /// How long after the state, s.
        after: f64,
        /// Whether a ball's angular velocity is among them.
        turning: bool,
    },
    /// The matrix changes along the motion.
    #[error(
        "the motion is steady but its linear system is not: {list} after {after:.2e} s. Choose coordinates and \
         velocities that go with the motion: {}quasi-velocities along the axes of a moving body, not of the world; a \
         motion that depends on time itself has no constant matrix",
        if *turning { "`orientation = \"rpy\"` or massless bodies between in place of a ball that spins; " } else { "" }
    )]
    Changing {
        /// The entries that change most.
        list: String,
        /// How long after the state, s.
        after: f64,
        /// Whether there are balls.
        turning: bool,
    },
    /// The eigenvalues were not found.
    #[error("the eigenvalues of the linear system did not converge")]
    NoEigenvalues,
}

impl LineariseError {
    /// Whether axes of a body that turn may be why there are no constant matrices.
    fn turning(&self) -> bool {
        matches!(self, Self::NotSteady { turning: true, .. } | Self::Changing { turning: true, .. })
    }
}

/// The state `[q, u]` at the start of the model, for the independent velocities of its equations.
///
/// # Errors
/// A start that cannot be assembled or whose rates do not determine the motion.
pub fn start_of(model: &Model, equations: &Equations) -> Result<Vec<f64>, DeriveError> {
    let inputs = assemble(model)?.0;
    let mut y: Vec<f64> = model.coordinates.iter().map(|c| inputs[model.input_index(c.q)]).collect();
    y.extend(initial_velocities(model, &equations.kinematics)?);
    Ok(y)
}

/// Linearises the equations of motion about the motion through the state `y = [q, u]` at the time t; `inputs` names
/// parameters. A parameter that is computed from another counts as a number of its own.
///
/// ```
/// use headland_dynamics::{DeriveOptions, derive};
/// use headland_dynamics::linearise::{linearise, start_of};
/// use headland_model::Scene;
///
/// let mut scene = Scene::new("oscillator");
/// scene.entry("parameters", "pull", "0 N");
/// scene.entry("coordinates", "x", "m").entry("initial", "x", 0.0).entry("initial", "x'", 0.0);
/// scene.element("inertia", &[("name", "m"), ("value", "2"), ("geometric", "x")]);
/// scene.element("elastic", &[("name", "c"), ("value", "8"), ("geometric", "x")]);
/// scene.element("force", &[("name", "pull"), ("value", "pull"), ("geometric", "x")]);
/// let model = scene.build()?;
/// let equations = derive(&model, &DeriveOptions::default())?;
/// let y = start_of(&model, &equations)?;
/// let linear = linearise(&model, &equations, 0.0, &y, &["pull".into()])?;
/// assert_eq!(linear.entry("x'", "x"), Some(-4.0));
/// assert_eq!(linear.b[(1, 0)], 0.5);
/// assert!((linear.modes()?[0].frequency() - 2.0 / std::f64::consts::TAU).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LineariseError`]: a state that is neither an equilibrium nor in steady motion, an input that is none.
///
/// # Panics
/// If `y` is not as long as coordinates and quasi-velocities together.
pub fn linearise(
    model: &Model,
    equations: &Equations,
    t: f64,
    y: &[f64],
    inputs: &[String],
) -> Result<Linearised, LineariseError> {
    if equations.kinematics.quasi.is_empty() {
        let (coordinates, constraints) = (model.coordinates.len(), model.kinematics.len());
        return Err(DeriveError::NoFreedom { coordinates, constraints }.into());
    }
    let mut derivatives = Derivatives::new(model, equations, t, y, inputs)?;
    let (here, cyclic) = match constant_matrices(&derivatives, t, y) {
        Err(refused) if refused.turning() && derivatives.carry(t, y)? => {
            constant_matrices(&derivatives, t, y).map_err(|_| refused)?
        }
        found => found?,
    };
    let states = derivatives.states(y, &cyclic);
    let speeds = model.coordinates.iter().zip(&here.rates).map(|(c, rate)| rate.abs() / c.scale);
    let at_rest = speeds.fold(0.0, f64::max) < 1e-12;
    let (displacements, inputs) = (derivatives.displacements(), derivatives.inputs());
    Ok(Linearised { t, at_rest, states, displacements, inputs, a: here.a, b: here.b, mass: here.mass })
}

/// The matrices, if they are those of an equilibrium or a steady motion, and which displacements are cyclic.
fn constant_matrices(
    derivatives: &Derivatives<'_>,
    t: f64,
    y: &[f64],
) -> Result<(derivatives::Point, Vec<bool>), LineariseError> {
    let here = derivatives.at(t, y)?;
    steady::check_rates(derivatives, &here, 0.0)?;
    let cyclic = steady::cyclic(&here.a, derivatives.displacements());
    steady::check_constant(derivatives, &here, t, y, &cyclic)?;
    Ok((here, cyclic))
}

#[cfg(test)]
mod tests;
