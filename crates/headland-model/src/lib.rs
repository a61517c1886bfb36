//! Scene files and the models that equations are derived from.
//!
//! ```
//! let text = r#"
//! title = "pendulum"
//! [parameters]
//! m = "1 kg"
//! l = "0.5 m"
//! g = "9.81 m/s^2"
//! [coordinates]
//! phi = "rad"
//! [[inertia]]
//! name = "bob, x"
//! value = "m"
//! geometric = "l*sin(phi)"
//! [[inertia]]
//! name = "bob, y"
//! value = "m"
//! geometric = "-l*cos(phi)"
//! [[force]]
//! name = "weight"
//! value = "-m*g"
//! geometric = "-l*cos(phi)"
//! [initial]
//! phi = "30 deg"
//! "phi'" = 0
//! "#;
//! let mut scene = headland_model::Scene::parse("pendulum.toml", text)?;
//! scene.set("l", "0.4")?; // still metres
//! let model = scene.build()?;
//! assert_eq!(model.coordinates[0].name, "phi");
//! # Ok::<(), headland_model::ModelError>(())
//! ```
//!
//! In order: [`format`](mod@format) is the table of sections and keys, [`read`] makes a [`Scene`] of TOML, [`scene`] holds it as plain
//! data, [`units`] and [`dimension`] know quantities, [`symbols`] the scene's names and families, [`lower`] turns
//! expressions into the graph with their dimensions checked, [`build`] puts the [`Model`] together.

mod agree;
mod assembly;
pub mod build;
pub mod contact;
mod declare;
mod definitions;
pub mod depend;
pub mod dimension;
mod first_order;
pub mod format;
mod functions;
pub mod lower;
mod mechanics;
pub mod model;
mod names;
pub mod place;
mod present;
pub mod read;
mod residuals;
pub mod scene;
mod start;
pub mod symbols;
mod tables;
pub mod tree;
pub mod units;

pub use contact::{Contact, Friction, Mode};
pub use model::{
    Body, Coordinate, Derived, DerivedQuantity, Direction, Element, ElementKind, Event, Guard, Hazard, KinematicRow,
    LinearSolver, Load, Model, Parameter, Plot, Quantity, QuasiVelocity, Reaction, RowForm, RunSettings, StructureForm,
    Switch, VectorNodes, VectorStructure,
};
pub use place::{Diagnostic, ModelError, Place, Source};
pub use scene::{Adding, Data, Entry, Scene, Value};
