//! Recursive dynamics of trees of bodies, over any [`Scalar`](headland_expr::Scalar).
//!
//! ```
//! use headland_dynamics::tree::{Joint, Loads, Mount, Tree, Workspace, aba};
//! use headland_spatial::{Axis, Inertia, Vector};
//!
//! // a rod of 2 m hung from its end, horizontal, about to fall
//! let mut tree = Tree::new();
//! let rod = Inertia::rod(3.0, 2.0, Axis::X).with_centre(Vector([1.0, 0.0, 0.0]));
//! tree.push(None, Mount::origin(), Joint::Revolute(Axis::Y), rod);
//! let mut work = Workspace::new(&tree);
//! let mut acceleration = [0.0];
//! let gravity = Loads::gravity(Vector([0.0, 0.0, -9.81]));
//! aba(&tree, &[0.0], &[0.0], &[0.0], &gravity, &mut work, &mut acceleration);
//! assert!((acceleration[0] - 1.5 * 9.81 / 2.0).abs() < 1e-14);
//! ```
//!
//! A [`Tree`] is plain data; the algorithms are functions on it with a [`Workspace`]. Twists and wrenches of a body are taken
//! at the origin of its frame, in its axes. The constants of `f64` become those of any other scalar by [`Tree::map`].
//!
//! In order: [`joint`] and [`bodies`] are the data, [`workspace`] the scratch, [`frames`](mod@frames) forward kinematics and body
//! Jacobians, [`rnea`](mod@rnea) inverse dynamics, [`crba`](mod@crba) the mass matrix, [`aba`](mod@aba) accelerations,
//! [`project`](mod@project) the same on fewer quasi-velocities, [`derivative`] exact Jacobians by
//! recursion, [`lanes`] by the dual numbers of [`tangent`]. `products` says what the
//! recursions ask of a joint, `revolute` and `general` answer, `articulated` is their inertia.
#![allow(non_snake_case)] // X_PB, V_WB_B: monogram notation

pub mod aba;
mod articulated;
pub mod bodies;
pub mod crba;
pub mod derivative;
pub mod frames;
mod general;
pub mod joint;
pub mod lanes;
mod products;
pub mod project;
mod revolute;
pub mod rnea;
pub mod tangent;
pub mod workspace;

pub use aba::aba;
pub use bodies::{Body, Mount, Tree};
pub use crba::crba;
pub use derivative::{JacobianWorkspace, Jacobians, aba_jacobian, rnea_jacobian};
pub use frames::{Frames, body_jacobian, frames};
pub use joint::Joint;
pub use lanes::LaneJacobian;
pub use project::{Reduction, project};
pub use rnea::{mass_times, rnea};
pub use tangent::Tangent;
pub use workspace::{Loads, Workspace};
