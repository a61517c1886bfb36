//! Surfaces that bodies touch.

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
pub use height::{Bounds, Function, Ground, Height, HeightError, HeightFunction};
#[cfg(feature = "mesh")]
pub use mesh::{Mesh, MeshError, MeshErrors, MeshOptions};
pub use revolution::{Profile, Revolution, RevolutionError};
pub use shape::{Shape, ShapeError, Side};
