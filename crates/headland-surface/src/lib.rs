//! Surfaces that bodies touch: signed distance, nearest point, normal, curvature.
//!
//! ```
//! use headland_surface::{Shape, Side, Surface};
//!
//! // a ball's centre in a recess of radius 1 m, 0.3 m below the middle
//! let recess = Surface::from(Shape::Sphere { radius: 1.0, side: Side::Inside });
//! let contact = recess.query([0.0, 0.0, -0.3])?;
//! assert_eq!(contact.distance, 0.7);
//! assert_eq!(contact.normal, [0.0, 0.0, 1.0]);
//! assert_eq!(contact.curvatures, Some([-1.0, -1.0]));
//! # Ok::<(), headland_surface::ContactError>(())
//! ```
//!
//! Three kinds, by what is known of them:
//!
//! - [`shape`]: closed forms, over any scalar: plane, sphere, cylinder, cone, torus.
//! - Fields of signed distance with all derivatives up to order 3, found by Newton's method: [`ellipsoid`], [`revolution`] of
//!   a profile, [`height`] over x and y, given by a function or by a [`grid`] of measured heights. They can be rolled on: the
//!   distance is at least three times differentiable.
//! - `mesh` (feature `mesh`): triangles and raw heights, through parry. For compliant contact only, with the error told.
//!
//! [`contact`] asks any of them the same question.

mod implicit;

pub mod contact;
pub mod ellipsoid;
pub mod grid;
pub mod height;
#[cfg(feature = "mesh")]
pub mod mesh;
pub mod revolution;
pub mod shape;

pub use contact::{Contact, ContactError, Surface};
pub use ellipsoid::Ellipsoid;
pub use grid::{Grid, GridError, Layout, read_csv};
pub use height::{Bounds, Formula, Function, Ground, Height, HeightError, HeightFunction};
#[cfg(feature = "mesh")]
pub use mesh::{Mesh, MeshError, MeshErrors, MeshOptions};
pub use revolution::{Profile, Revolution, RevolutionError};
pub use shape::{Shape, ShapeError, Side};
