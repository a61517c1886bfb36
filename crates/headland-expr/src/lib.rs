//! Scalars and the expression graph: the ground of headland.
//!
//! The mechanics is written once, generic over [`Scalar`]; this crate supplies the scalars that are not plain numbers
//! and everything that a symbolic expression needs.
//!
//! ```
//! use headland_expr::{Graph, Scalar};
//!
//! let graph = Graph::new();
//! let (x, y) = (graph.input("x"), graph.input("y"));
//! let e = x * y.sin() + x.powi(2);
//! let root = graph.id(e);
//! assert_eq!(graph.eval(&[root], &[3.0, 0.0])[0], 9.0);
//!
//! let dx = graph.gradient(root, &[graph.id(x)])[0]; // sin y + 2 x
//! assert_eq!(graph.eval(&[graph.id(dx)], &[3.0, 0.0])[0], 6.0);
//! ```
//!
//! In order: [`scalar`] is the trait, [`ops`] the one table of operators, [`graph`] the hash-consed arena, [`expr`] its
//! handles with their simplifications, [`derivative`] forward and reverse, [`dual`] derivatives without symbols,
//! [`spline`] table interpolation, [`field`] functions of a point that are known by numbers, [`frozen`] expressions
//! for other threads and scalars, [`interval`] ranges, [`timeline`](mod@timeline) where functions of time bend, [`parse`] from text, [`print`](mod@print) back to text, LaTeX
//! and C.

pub mod derivative;
pub mod dual;
pub mod expr;
pub mod field;
pub mod frozen;
pub mod graph;
pub mod interval;
pub mod ops;
pub mod parse;
pub mod print;
pub mod scalar;
pub mod spline;
pub mod timeline;

pub use dual::Dual;
pub use expr::Expr;
pub use field::{FIELD_BEYOND, FIELD_PARTS, Field, Wave, field_part};
pub use frozen::Frozen;
pub use graph::{Graph, NodeId};
pub use interval::Interval;
pub use ops::Op;
pub use scalar::Scalar;
pub use spline::{Spline, SplineError};
