//! Laws of compliant contact over any [`Scalar`](headland_expr::Scalar): numbers, lanes, dual numbers or expressions.
//!
//! ```
//! use headland_contact::{Coefficient, Coulomb, Normal, Regularization};
//! use headland_spatial::Vector;
//!
//! // a ball pressed in by 0.1 mm that sinks at 1 cm/s and slips along x at 0.2 m/s
//! let normal = Normal { stiffness: 1e6, exponent: 1.0, damping: 0.5 }.force(1e-4, 0.01);
//! assert!((normal - 100.0 * 1.005).abs() < 1e-12);
//! let coefficient = Coefficient { kinetic: 0.3, stribeck: None };
//! let law = Coulomb { coefficient, speed: 1e-3, regularization: Regularization::Root };
//! let friction = law.force(normal, Vector::new(0.2, 0.0, 0.0));
//! assert!((friction.x() / (-0.3 * normal) - 1.0).abs() < 2e-5);
//! ```
//!
//! SI units. Laws are finite, with finite first derivatives, at zero slip, at rest and where the surfaces just touch; none
//! pulls, and none gives energy away but what its spring has stored.
//!
//! In order: [`normal`] presses, [`friction`] holds back, [`resistance`] brakes turning.

pub mod friction;
pub mod normal;
pub mod resistance;

pub use friction::{Coefficient, Coulomb, LuGre, Regularization, speed};
pub use normal::{Material, Normal, hertz_stiffness, restitution};
pub use resistance::{Resistance, Torques};
