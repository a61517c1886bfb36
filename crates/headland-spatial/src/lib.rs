//! Spatial algebra over any [`Scalar`](headland_expr::Scalar): numbers, lanes, dual numbers or expressions.
//!
//! ```
//! use headland_spatial::{Axis, Inertia, Pose, Rotation, Twist, Vector};
//!
//! // a rod of 2 kg and 1 m along x, held at one end, turning about z at 3 rad/s
//! let rod = Inertia::rod(2.0, 1.0, Axis::X);
//! let X_end = Pose::new(Rotation::identity(), Vector::new(0.5, 0.0, 0.0));
//! let V_end = Twist::new(Vector::new(0.0, 0.0, 3.0), Vector::zero());
//! let momentum = rod.out_of_frame(&X_end).momentum(V_end);
//! assert!((momentum.torque.z() - 2.0 / 3.0 * 3.0).abs() < 1e-15); // m l²/3 ω
//! assert!((momentum.force.y() - 2.0 * 0.5 * 3.0).abs() < 1e-15); // m ω l/2
//! ```
//!
//! Conventions, all through: `X_AB` is the pose of frame B in frame A, `p_AP = R_AB p_BP + p_AB`; a twist is the
//! angular velocity and the velocity of the frame's origin, a wrench the torque about the frame's origin and the force,
//! both written in the frame's axes, angular part first; quaternions are (w, x, y, z). SI units. Nothing multiplies by a literal
//! zero that it could leave out, so expressions stay as small as hand-written ones.
//!
//! In order: [`vector`] and [`symmetric`] are the arithmetic, [`rotation`] and [`quaternion`] orientations, [`pose`]
//! frames, [`twist`] and [`wrench`] what moves and what acts, [`inertia`] what resists, [`principal`] its axes and its
//! consistency, [`shapes`] inertias of bodies of simple form, [`convert`] the way to and from nalgebra.
#![allow(non_snake_case)] // X_AB, V_WB: monogram notation

pub mod convert;
pub mod inertia;
pub mod pose;
pub mod principal;
pub mod quaternion;
pub mod rotation;
pub mod shapes;
pub mod symmetric;
pub mod twist;
pub mod vector;
pub mod wrench;

pub use inertia::{Inertia, OriginInertia};
pub use pose::Pose;
pub use principal::{InertiaError, Principal};
pub use quaternion::Quaternion;
pub use rotation::Rotation;
pub use symmetric::Symmetric;
pub use twist::Twist;
pub use vector::{Axis, Vector};
pub use wrench::Wrench;
