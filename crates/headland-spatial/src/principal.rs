//! Principal axes of an inertia, and whether any body could have it.

use headland_expr::Scalar;
use nalgebra::{Matrix3, SymmetricEigen};

use crate::inertia::Inertia;
use crate::rotation::Rotation;
use crate::vector::{Axis, Vector};

/// Relative to the trace: what rounding of the input may break.
const TOLERANCE: f64 = 1e-9;

/// Principal moments and axes about the mass centre.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Principal {
    /// Moments (kg·m²), ascending.
    pub moments: [f64; 3],
    /// `R_BP`: columns are the principal axes in the body frame; right-handed, the largest component of the first two
    /// positive.
    pub axes: Rotation<f64>,
}

/// What no rigid body has.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InertiaError {
    /// NaN or infinity.
    #[error("{what} is {value}; a finite number was expected")]
    NotFinite {
        /// Mass, a component of the mass centre, an entry of the tensor.
        what: String,
        /// What was found.
        value: f64,
    },
    /// Mass below zero.
    #[error("mass {mass} kg is negative")]
    NegativeMass {
        /// kg.
        mass: f64,
    },
    /// A tensor without mass.
    #[error("mass is 0 kg but the inertia tensor is not zero (largest principal moment {largest} kg·m²)")]
    TensorWithoutMass {
        /// kg·m².
        largest: f64,
    },
    /// A principal moment below zero.
    #[error(
        "the inertia tensor is not positive semidefinite: principal moments {moments:?} kg·m², the negative one about \
         {axis} (products are entries of the matrix: xy = -∫ x y dm)"
    )]
    NotPositive {
        /// kg·m², ascending.
        moments: [f64; 3],
        /// The axis, by name or by components.
        axis: String,
    },
    /// A principal moment larger than the other two together.
    #[error(
        "principal moments {moments:?} kg·m² break the triangle inequality: {largest} about {axis} exceeds the sum of the \
         other two, {sum}"
    )]
    Triangle {
        /// kg·m², ascending.
        moments: [f64; 3],
        /// kg·m².
        largest: f64,
        /// kg·m².
        sum: f64,
        /// The axis of the largest, by name or by components.
        axis: String,
    },
}

impl Inertia<f64> {
    /// Principal moments in ascending order and their axes; the same bytes for the same tensor.
    pub fn principal(&self) -> Principal {
        let [_, _, _, xy, xz, yz] = self.tensor.0;
        let (values, vectors) = if xy == 0.0 && xz == 0.0 && yz == 0.0 {
            ([self.tensor.0[0], self.tensor.0[1], self.tensor.0[2]], Matrix3::identity())
        } else {
            let eigen = SymmetricEigen::new(Matrix3::from(self.tensor));
            (eigen.eigenvalues.into(), eigen.eigenvectors)
        };
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let column = |k: usize| {
            let v: Vector<f64> = vectors.column(order[k]).into_owned().into();
            let largest = v.0.iter().fold(0.0, |best: f64, x| if x.abs() > best.abs() + 1e-12 { *x } else { best });
            if largest < 0.0 { -v } else { v }
        };
        let (a, b) = (column(0), column(1));
        let c = a.cross(b);
        let axes = Rotation(std::array::from_fn(|i| [a[i], b[i], c[i]]));
        Principal { moments: order.map(|i| values[i]), axes }
    }

    /// Whether a rigid body can have this inertia. A body without inertia passes.
    ///
    /// # Errors
    /// A number that is not finite, a negative mass, a tensor without mass, a negative principal moment, or one larger than the
    /// other two together (beyond 1e-9 of the trace).
    pub fn check(&self) -> Result<(), InertiaError> {
        self.check_finite()?;
        if self.mass < 0.0 {
            return Err(InertiaError::NegativeMass { mass: self.mass });
        }
        let Principal { moments, axes } = self.principal();
        let slack = TOLERANCE * moments.iter().map(|m| m.abs()).sum::<f64>();
        if moments[0] < -slack {
            return Err(InertiaError::NotPositive { moments, axis: axis_name(&axes, Axis::X) });
        }
        if self.mass == 0.0 && moments[2] > 0.0 {
            return Err(InertiaError::TensorWithoutMass { largest: moments[2] });
        }
        let sum = moments[0] + moments[1];
        if moments[2] > sum + slack {
            return Err(InertiaError::Triangle { moments, largest: moments[2], sum, axis: axis_name(&axes, Axis::Z) });
        }
        Ok(())
    }

    fn check_finite(&self) -> Result<(), InertiaError> {
        let tensor = ["xx", "yy", "zz", "xy", "xz", "yz"].into_iter().zip(self.tensor.0);
        let centre =
            Axis::ALL.into_iter().map(|a| (format!("{} of the mass centre", a.name()), self.centre[a.index()]));
        let numbers = std::iter::once(("mass".to_string(), self.mass))
            .chain(centre)
            .chain(tensor.map(|(name, x)| (format!("entry {name} of the inertia tensor"), x)));
        for (what, value) in numbers {
            if !value.is_finite() {
                return Err(InertiaError::NotFinite { what, value });
            }
        }
        Ok(())
    }
}

/// `x`, `y`, `z`, or the components of an axis between them.
fn axis_name(axes: &Rotation<f64>, column: Axis) -> String {
    let v = axes.axis(column);
    match Axis::ALL.into_iter().find(|a| Scalar::abs(v[a.index()]) > 1.0 - 1e-9) {
        Some(axis) => axis.name().to_string(),
        None => format!("({:.4}, {:.4}, {:.4})", v[0], v[1], v[2]),
    }
}
