//! Surfaces that bodies touch.

pub mod shape;

pub use shape::{Shape, ShapeError, Side};
