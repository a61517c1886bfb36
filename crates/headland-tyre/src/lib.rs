//! Laws of tyres over any [`Scalar`](headland_expr::Scalar): numbers, lanes, dual numbers or expressions.
//!
//! ```
//! use headland_spatial::Vector;
//! use headland_tyre::{Brush, ContactAxes, Motion, SlipLaw, Vertical};
//!
//! // a braked wheel of 0.5 m radius, 2 cm deflected, that goes 10 m/s forward and 0.5 m/s to the left
//! let axes = ContactAxes::new(Vector::new(0.0, 1.0, 0.0), Vector::new(0.0, 0.0, 1.0));
//! let (v, omega) = (Vector::new(10.0, 0.5, 0.0), Vector::new(0.0, 19.0, 0.0));
//! let motion = Motion::new(v, omega, Vector::new(0.0, 1.0, 0.0), &axes, 0.48, 0.49);
//! let load = Vertical::linear(4e5, 2e3).load(0.02, 0.0);
//! let tyre = Brush { longitudinal: 1e5, cornering: 8e4, camber: 5e3, friction: 0.8, half_length: 0.1, load: 8e3,
//!     proportional: true };
//! let f = tyre.forces(load, 1.0, &motion.slip(0.1));
//! assert!(f.fx < 0.0 && f.fy < 0.0 && f.fx.hypot(f.fy) <= 0.8 * load);
//! assert!(motion.slip_power(&f) < 0.0);
//! ```
//!
//! Axes are those of ISO 8855 at the contact point: x forward, y to the left, z up along the ground's normal. SI units.
//! Laws are finite, with finite derivatives, at zero slip, at standstill, backwards and without load.
//!
//! In order: [`vertical`] gives the load, [`slip`] the motion of the contact and the states of relaxation, [`law`] says what
//! all slip laws have in common; these are [`linear`], [`brush`], [`tmeasy`] and [`pac2002`], read from files by [`tir`];
//! [`rolling`] adds moments where a law has none. A wheel without slip is a constraint, not a law.
//!
//! Around the wheel: [`soil`] is soft ground, [`road`] uneven ground with its [`profile`]s, [`envelope`] what a tyre
//! of some size sees of it, [`driveline`] what turns and stops
//! wheels, [`tillage`] what a tool in the ground pulls.

pub mod brush;
pub mod driveline;
pub mod envelope;
pub mod guard;
pub mod law;
pub mod linear;
pub mod pac2002;
pub mod profile;
pub mod road;
pub mod rolling;
pub mod slip;
pub mod soil;
pub mod tillage;
pub mod tir;
pub mod tmeasy;
pub mod vertical;

pub use brush::Brush;
pub use driveline::{Brake, Differential, Engine, Governor, Lock};
pub use envelope::{Envelope, GroundPlane};
pub use law::{Forces, Slip, SlipLaw};
pub use linear::Linear;
pub use pac2002::Pac2002;
pub use profile::{Obstacle, Profile, RoadError};
pub use road::{Coherence, RandomRoad, Road, Roughness};
pub use rolling::{Overturning, RollingResistance};
pub use slip::{ContactAxes, Motion, Relaxation, relax_towards};
pub use soil::{KnownSoil, SoftForces, SoftWheel, Soil};
pub use tillage::Draught;
pub use tir::{Note, Tir, TirError};
pub use tmeasy::TMeasy;
pub use vertical::{Stiffness, Vertical};
