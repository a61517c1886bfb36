//! From a model to its equations of motion.
//!
//! ```
//! use headland_dynamics::{DeriveOptions, derive};
//! use headland_model::Scene;
//!
//! let mut scene = Scene::new("pendulum");
//! scene.entry("parameters", "m", "1 kg").entry("parameters", "l", "2 m").entry("parameters", "g", "9.81 m/s^2");
//! scene.entry("coordinates", "phi", "rad").entry("initial", "phi", 0.5).entry("initial", "phi'", 0.0);
//! scene.element("inertia", &[("name", "x"), ("value", "m"), ("geometric", "l*sin(phi)")]);
//! scene.element("inertia", &[("name", "y"), ("value", "m"), ("geometric", "-l*cos(phi)")]);
//! scene.element("force", &[("name", "weight"), ("value", "-m*g"), ("geometric", "-l*cos(phi)")]);
//! let model = scene.build()?;
//! let equations = derive(&model, &DeriveOptions::default())?;
//! assert_eq!(equations.kinematics.quasi[0].name, "phi'");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! In order: [`kinematics`] makes (2) of (1), [`structures`] differentiates what the elements are given on,
//! [`scalar_inertia`] refuses what would be wrong, [`direct`] and [`combine`] are algorithms [10] and [9] of the
//! article, [`compare`] holds one against the other, [`solve`] is `M u′ = F`, [`energy`] the balance, [`initial`] the
//! start, [`derive`](mod@derive) does it all, and [`present`] writes it down. [`descriptor`] has the same equations with
//! nothing eliminated, by multipliers.

pub mod combine;
pub mod compare;
pub mod derive;
pub mod descriptor;
pub mod direct;
pub mod eliminate;
pub mod energy;
pub mod error;
mod friction;
pub mod initial;
pub mod kinematics;
pub mod linearise;
pub mod present;
pub mod reactions;
pub mod recursive;
pub mod sample;
pub mod scalar_inertia;
pub mod solve;
pub mod structures;
pub mod tree;

pub use derive::{Algorithm, DeriveOptions, Equations, choose_dependent, derive, derive_at};
pub use descriptor::{Descriptor, form_descriptor};
pub use energy::Energies;
pub use error::DeriveError;
pub use initial::initial_velocities;
pub use kinematics::{Kinematics, Quasi};
pub use linearise::{LinearState, LineariseError, Linearised, Mode, linearise};
