//! Surfaces that bodies touch.

mod implicit;

pub mod ellipsoid;
pub mod grid;
pub mod height;
pub mod revolution;
pub mod shape;

pub use ellipsoid::Ellipsoid;
pub use grid::{Grid, GridError, Layout, read_csv};
pub use height::{Bounds, Function, Ground, Height, HeightError, HeightFunction};
pub use revolution::{Profile, Revolution, RevolutionError};
pub use shape::{Shape, ShapeError, Side};
