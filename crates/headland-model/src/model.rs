//! [`Model`]: what there is; frozen, checked, units resolved. Equations are derived from it.

use headland_expr::{Graph, NodeId};

use crate::place::{Diagnostic, Place, Source};

/// A number that can change between runs without a new derivation.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Name with index.
    pub name: String,
    /// Its input in the graph.
    pub input: usize,
    /// Value in SI units.
    pub value: f64,
    /// SI unit.
    pub unit: String,
}

/// A generalised coordinate q with its first and second rates, all inputs of the graph.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// Name with index.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// SI unit of the rate.
    pub rate_unit: String,
    /// Input q.
    pub q: NodeId,
    /// Input q′.
    pub rate: NodeId,
    /// Input q″.
    pub acceleration: NodeId,
    /// Initial value, an expression of parameters.
    pub initial: Option<NodeId>,
    /// Initial rate, where one is given.
    pub initial_rate: Option<NodeId>,
    /// Typical size, for the absolute tolerance.
    pub scale: f64,
    /// Where it was declared.
    pub place: Place,
}

/// A named quasi-velocity u.
#[derive(Clone, Debug)]
pub struct QuasiVelocity {
    /// Name with index.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Input u.
    pub u: NodeId,
    /// Input u′.
    pub acceleration: NodeId,
    /// Initial value, an expression of parameters.
    pub initial: Option<NodeId>,
    /// Typical size, for the absolute tolerance.
    pub scale: f64,
    /// Where it was declared.
    pub place: Place,
}

/// One equation of the kinematics.
#[derive(Clone, Debug)]
pub struct KinematicRow {
    /// Its name, for messages.
    pub name: String,
    /// Where it was written.
    pub place: Place,
    /// What it says.
    pub form: RowForm,
}

/// How an equation of the kinematics is given.
#[derive(Clone, Copy, Debug)]
pub enum RowForm {
    /// Form (2): the rate of a coordinate, `q′_i = f(q, u, t)`.
    Rate(usize, NodeId),
    /// Form (1): `f(q, q′, u, t) = 0`, linear in `q′` and `u`.
    Zero(NodeId),
}

/// What an element does.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ElementKind {
    /// Inertia: mass or moment of inertia.
    Inertia,
    /// Elastic: stiffness of a geometric structure.
    Elastic,
    /// Dissipative: damping.
    Dissipative,
    /// Force or moment.
    Force,
}

/// How a structure is given, equations (4)-(6).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StructureForm {
    /// `d(q, t)`
    Geometric,
    /// `d′(q, q′, t)`
    Implicit,
    /// `d′(q, u, t)`
    Explicit,
}

/// An inertia, elastic, dissipative or force element with its (scalar) structure.
#[derive(Clone, Debug)]
pub struct Element {
    /// Name with index.
    pub name: String,
    /// What it does.
    pub kind: ElementKind,
    /// Mass, stiffness, damping or force.
    pub value: NodeId,
    /// How the structure is given.
    pub form: StructureForm,
    /// The structure: d or d′.
    pub structure: NodeId,
    /// Where it was written.
    pub place: Place,
    /// SI unit of the value.
    pub unit: String,
}

/// An expression with a name and a unit.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Name with index.
    pub name: String,
    /// Unit in which it is shown.
    pub unit: String,
    /// Shown value = `factor` times SI value.
    pub factor: f64,
    /// The expression, in SI units.
    pub node: NodeId,
    /// Where it was written.
    pub place: Place,
}

/// A limit of validity.
#[derive(Clone, Debug)]
pub struct Guard {
    /// Name with index.
    pub name: String,
    /// What is watched.
    pub quantity: NodeId,
    /// Its SI unit.
    pub unit: String,
    /// Warn below.
    pub warn_below: Option<f64>,
    /// Stop below.
    pub stop_below: Option<f64>,
    /// What it means.
    pub message: String,
}

/// Which way an event function crosses zero.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Direction {
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
    /// Either.
    Both,
}

/// An event located while running.
#[derive(Clone, Debug)]
pub struct Event {
    /// Name with index.
    pub name: String,
    /// The event is where this changes sign.
    pub quantity: NodeId,
    /// Which way.
    pub direction: Direction,
    /// True: the run ends there.
    pub stop: bool,
}

/// A plot of columns.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Title.
    pub title: String,
    /// Column on the x axis; `None` is time.
    pub x: Option<usize>,
    /// Columns on the y axis.
    pub y: Vec<usize>,
    /// Same scale along both axes.
    pub equal_axes: bool,
}

/// Which solution of `M u′ = F`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum LinearSolver {
    /// `L D Lᵀ`, unrolled into the equations when small.
    #[default]
    Ldl,
    /// Crout's LU, as the article does.
    Crout,
}

/// Settings of a run that the scene gives.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub until: f64,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Output intervals.
    pub points: usize,
    /// Method by name.
    pub method: String,
    /// Longest step, s.
    pub max_step: f64,
    /// Linear solver.
    pub linear_solver: LinearSolver,
    /// Coordinates whose rates are independent, by the user's choice.
    pub independent: Option<Vec<usize>>,
}

/// What there is: a checked scene over one expression graph.
///
/// A derivation adds nodes to the graph. A clone taken before derives the same bytes again, also in another thread.
#[derive(Clone, Debug)]
pub struct Model {
    /// Title.
    pub title: String,
    /// The scene's text, for messages.
    pub source: Source,
    /// All expressions.
    pub graph: Graph,
    /// Input of the time t.
    pub time: NodeId,
    /// Parameters in the order of the file.
    pub parameters: Vec<Parameter>,
    /// Coordinates, the prescribed ones left out.
    pub coordinates: Vec<Coordinate>,
    /// Coordinates that are given functions of time.
    pub prescribed: Vec<Quantity>,
    /// Named quasi-velocities.
    pub quasi_velocities: Vec<QuasiVelocity>,
    /// Equations (1) and (2).
    pub kinematics: Vec<KinematicRow>,
    /// Inertia, elastic, dissipative and force elements.
    pub elements: Vec<Element>,
    /// Definitions that something uses, in order of use.
    pub definitions: Vec<Quantity>,
    /// Columns.
    pub outputs: Vec<Quantity>,
    /// Limits of validity.
    pub guards: Vec<Guard>,
    /// Events.
    pub events: Vec<Event>,
    /// Plots.
    pub plots: Vec<Plot>,
    /// Settings.
    pub run: RunSettings,
    /// What deserves attention but is not wrong.
    pub warnings: Vec<Diagnostic>,
}

impl Model {
    /// Index of the graph's input behind a node made by [`Graph::input`].
    pub fn input_index(&self, node: NodeId) -> usize {
        self.graph.node(node).args[0] as usize
    }

    /// Inputs of the graph with the parameters filled in and zero for everything else.
    pub fn inputs(&self) -> Vec<f64> {
        let mut inputs = vec![0.0; self.graph.input_count()];
        for p in &self.parameters {
            inputs[p.input] = p.value;
        }
        inputs
    }

    /// A one-line summary of the mechanical model.
    pub fn count(&self, kind: ElementKind) -> usize {
        self.elements.iter().filter(|e| e.kind == kind).count()
    }
}
