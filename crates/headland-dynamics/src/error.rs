//! [`DeriveError`]: why a model has no equations of motion.

use headland_model::{Model, Place};

/// Why the equations of motion could not be derived.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeriveError {
    /// An expression that must be linear in the velocities is not.
    #[error("{what} is not linear in {variables}: its derivative depends on `{input}`")]
    NotLinear {
        /// The row or structure.
        what: String,
        /// In which variables it should be linear.
        variables: &'static str,
        /// A velocity that is left in the derivative.
        input: String,
    },
    /// A scalar inertia element on a speed whose equation would lose a term.
    #[error(
        "the scalar inertia element `{name}` is given on a speed that is not the rate of any coordinate; with the \
         quasi-velocities {quasi} ({count}) its equation would lose a term (as the sleigh {{m, v_long}}, {{m, v_lat}}, \
         {{J, theta}} loses b w^2). Give the mass two elements on the coordinates of its centre, `geometric = \"x + ..\"` \
         and `geometric = \"y + ..\"`"
    )]
    ScalarInertia {
        /// The element.
        name: String,
        /// How many quasi-velocities there are.
        count: usize,
        /// Their names.
        quasi: String,
    },
    /// A constraint follows from the others, or contradicts them.
    #[error("the constraint `{name}` is {how} at the start; left after elimination: {residue:.3e}")]
    SingularConstraint {
        /// The constraint.
        name: String,
        /// Redundant, contradictory or singular.
        how: &'static str,
        /// The largest scaled coefficient that is left.
        residue: f64,
    },
    /// The user's choice of independent rates does not work.
    #[error("`independent` names {given} rate(s) but {wanted} are independent; candidates: {candidates}")]
    WrongIndependent {
        /// How many were named.
        given: usize,
        /// How many are independent.
        wanted: usize,
        /// Names of the rates.
        candidates: String,
    },
    /// Nothing can move.
    #[error("no degree of freedom is left: {coordinates} coordinates, {constraints} constraints")]
    NoFreedom {
        /// Coordinates.
        coordinates: usize,
        /// Constraints.
        constraints: usize,
    },
    /// The mass matrix has no inverse.
    #[error(
        "the mass matrix is {} at the start (pivot {pivot:.3e} for `{name}`); {}",
        if *pivot < 0.0 { "not positive" } else { "singular" },
        if *pivot < 0.0 {
            "a mass or a moment of inertia is negative"
        } else {
            "every quasi-velocity needs an inertia element whose structure contains it"
        }
    )]
    SingularMass {
        /// The quasi-velocity whose pivot vanishes.
        name: String,
        /// The pivot of L D Lᵀ.
        pivot: f64,
    },
    /// Something is not finite at the start.
    #[error("{name} at the start, so the mass matrix is {value}")]
    NotFinite {
        /// What it is.
        name: String,
        /// Its value.
        value: f64,
    },
    /// The start is where the equations are not defined.
    #[error("{message}")]
    Undefined {
        /// What is wrong, and what helps.
        message: String,
        /// Where the scene says so.
        place: Place,
    },
    /// Too few initial rates for the quasi-velocities.
    #[error(
        "too few initial values: the initial rates given ({given}) do not determine {missing}; give one of {candidates}"
    )]
    TooFewInitialRates {
        /// The rates given.
        given: String,
        /// A quasi-velocity that is not determined.
        missing: String,
        /// Rates that would help.
        candidates: String,
    },
    /// Constraints on positions that no position near the start fulfils.
    #[error(
        "the start cannot be assembled. Constraints that cannot hold together near it, with what is left of each where all \
         are nearest to it: {rows}"
    )]
    CannotAssemble {
        /// The constraints that conflict, one set after the other, with what is left of them.
        rows: String,
    },
    /// Initial rates that contradict the constraints.
    #[error(
        "the initial rates contradict the constraints: `{name}` was given as {given} but the others make it {found}"
    )]
    InconsistentStart {
        /// The rate.
        name: String,
        /// As given.
        given: f64,
        /// As the other rates and the constraints make it.
        found: f64,
    },
    /// The two derivations disagree: a defect of this program.
    #[error(
        "the two derivations disagree in {what} at a random state: {direct:.17e} (direct) against {combined:.17e} \
         (combined); please report this as a defect"
    )]
    Disagreement {
        /// Which entry.
        what: String,
        /// By algorithm [10].
        direct: f64,
        /// By algorithm [9].
        combined: f64,
    },
    /// A derivative of a surface or table that it does not have.
    #[error(
        "{what} need a derivative of `{field}` of fourth or higher order, which it does not have: what is made of its \
         derivatives can be differentiated once less"
    )]
    BeyondField {
        /// What needs it.
        what: &'static str,
        /// The field.
        field: String,
    },
    /// Algorithm [9] was asked for but does not apply.
    #[error("algorithm `combine` does not apply: {reason}")]
    CombineDoesNotApply {
        /// Why.
        reason: String,
    },
}

impl DeriveError {
    /// Where the scene says what is wrong: the place of the element, constraint or state that the error names.
    pub fn place(&self, model: &Model) -> Option<Place> {
        let element = |name: &str| model.elements.iter().find(|e| e.name == name).map(|e| e.place.clone());
        let row = |name: &str| model.kinematics.iter().find(|r| r.name == name).map(|r| r.place.clone());
        let state = |name: &str| {
            let base = name.trim_end_matches('\'');
            let coordinate = model.coordinates.iter().find(|c| c.name == base).map(|c| c.place.clone());
            coordinate.or_else(|| model.quasi_velocities.iter().find(|u| u.name == base).map(|u| u.place.clone()))
        };
        match self {
            Self::ScalarInertia { name, .. } => element(name),
            Self::Undefined { place, .. } => Some(place.clone()),
            Self::SingularConstraint { name, .. } => row(name),
            Self::CannotAssemble { rows } => row(rows.split('`').nth(1)?),
            Self::SingularMass { name, .. } | Self::InconsistentStart { name, .. } => state(name),
            Self::TooFewInitialRates { missing, .. } => state(missing.trim_matches('`')),
            Self::NotLinear { what, .. } => {
                let name = what.split('`').nth(1)?;
                element(name).or_else(|| row(name)).or_else(|| row(&format!("{name}'")))
            }
            _ => None,
        }
    }
}
