//! Compiled functions `y = f(x)`: from a graph of expressions to code that runs.
//!
//! ```
//! use headland_code::{Evaluator, Function, TapeFunction};
//! use headland_expr::{Graph, Scalar};
//!
//! let graph = Graph::new();
//! let (length, angle) = (graph.input("l"), graph.input("phi"));
//! let (sin, cos) = angle.sin_cos();
//! let outputs = [graph.id(length * cos), graph.id(length * sin)];
//!
//! let f = TapeFunction::compile(&graph, &outputs);
//! let mut evaluator = f.evaluator();
//! assert_eq!(evaluator.eval(&[2.0, 0.0]), [2.0, 0.0]);
//!
//! // Many points at once: four or eight a pass.
//! let y = evaluator.eval_many(&[&[1.0, 2.0, 3.0], &[0.0; 3]]);
//! assert_eq!(y[0], [1.0, 2.0, 3.0]);
//!
//! // Less of it: one output, a known length.
//! let height = f.keep_outputs(&[1]).bind(&[(0, 1.0)]);
//! assert_eq!((f.operations(), height.operations()), (4, 1));
//! ```
//!
//! In order: [`function`] is what a back end offers; the graph is packed into a program that threads can share, lowered
//! to straight-line code, its equal operations grouped, its values given slots; [`tape`] interprets that over numbers
//! or [`lanes`]; [`jacobian`] compiles derivatives; [`suite`] is what every back end must pass.
//!
//! One rule holds for all of it: scalar, lanes and [`Graph::eval`](headland_expr::Graph::eval) agree to the last bit.

pub mod function;
mod group;
pub mod jacobian;
pub mod lanes;
mod lower;
mod program;
pub mod suite;
pub mod tape;

pub use function::{Evaluator, Function};
pub use jacobian::Jacobian;
pub use lanes::{Lanes, Lanes4, Lanes8};
pub use tape::{TapeEvaluator, TapeFunction};
