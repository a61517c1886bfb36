//! Surfaces that bodies touch.

mod implicit;

pub mod ellipsoid;
pub mod height;
pub mod revolution;
pub mod shape;

pub use ellipsoid::Ellipsoid;
pub use height::{Bounds, Function, Ground, Height, HeightError, HeightFunction};
pub use revolution::{Profile, Revolution, RevolutionError};
pub use shape::{Shape, ShapeError, Side};
