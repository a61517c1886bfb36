//! [`Model`]: what there is; frozen, checked, units resolved. Equations are derived from it.

use headland_expr::{Graph, NodeId};

use crate::contact::Contact;
use crate::dimension::Dimension;
use crate::place::{Diagnostic, Place, Source};
use crate::tree::JointTree;

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
    /// Of a joint: where the search for a start begins if none is given.
    pub guess: Option<f64>,
    /// True for a state of the first order: its rate is any function of q, u, t, and no structure and no constraint depends
    /// on it.
    pub first_order: bool,
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
    /// True for a joint's own: constraints may make it dependent.
    pub of_joint: bool,
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
    /// Of a holonomic constraint: what must be zero, a function of q and t. The row is its rate.
    pub position: Option<NodeId>,
    /// The row's rate by q″ and u′, where it is known in a shorter form than the derivative.
    pub rate: Option<NodeId>,
    /// True where it may follow from other rows without harm: rows of joints and of rolling.
    pub may_be_redundant: bool,
    /// Name and dimension of the force with which it is enforced.
    pub force: Option<(String, Dimension)>,
    /// Dimension of what must be zero, of the velocities.
    pub dimension: Dimension,
}

impl KinematicRow {
    /// A row of form (2), or a velocity constraint, in m/s.
    pub fn new(name: impl Into<String>, place: &Place, form: RowForm) -> Self {
        let (name, place) = (name.into(), place.clone());
        let dimension = Dimension::of(0, 1, -1);
        Self { name, place, form, position: None, rate: None, may_be_redundant: false, force: None, dimension }
    }
}

/// How an equation of the kinematics is given.
#[derive(Clone, Copy, Debug)]
pub enum RowForm {
    /// Form (2): the rate of a coordinate, `q′_i = f(q, u, t)`; linear in `u` unless that is of the
    /// [first order](Coordinate::first_order).
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
    /// Its rate d′ by q, q′, u, t, where it is known in a shorter form than the derivative.
    pub rate: Option<NodeId>,
    /// Where it was written.
    pub place: Place,
    /// SI unit of the value.
    pub unit: String,
}

/// Three components along orthogonal axes.
pub type VectorNodes = [NodeId; 3];

/// A velocity or angular velocity as the structure of a vector element, by q, q′, u, t.
#[derive(Clone, Copy, Debug)]
pub struct VectorStructure {
    /// Its components along the element's axes.
    pub rate: VectorNodes,
    /// Components of the acceleration along the same axes by q″ and u′, with what comes from their turning; `None` where
    /// the axes do not turn and the rate's derivative serves.
    pub acceleration: Option<VectorNodes>,
}

/// A rigid body as inertia element of equation (7).
#[derive(Clone, Debug)]
pub struct Body {
    /// Name with index.
    pub name: String,
    /// Mass.
    pub mass: NodeId,
    /// Velocity of the mass centre.
    pub velocity: VectorStructure,
    /// Tensor about the mass centre in body axes: xx, yy, zz, xy, xz, yz as they stand in the matrix.
    pub tensor: [NodeId; 6],
    /// Angular velocity in body axes.
    pub spin: VectorStructure,
    /// Weight along the axes of the velocity, and its potential energy.
    pub weight: VectorNodes,
    /// Potential energy of the weight.
    pub potential: NodeId,
    /// Where it was written.
    pub place: Place,
}

/// A force at a point, or a torque, as force element of equation (7).
#[derive(Clone, Debug)]
pub struct Load {
    /// Name with index.
    pub name: String,
    /// Force or torque.
    pub force: VectorNodes,
    /// Velocity of the point, or angular velocity, along the same axes, by q, q′, u, t.
    pub rate: VectorNodes,
    /// Its potential energy where it has one.
    pub potential: Option<NodeId>,
    /// Where it was written.
    pub place: Place,
}

/// A quantity that follows from the equations of motion; expressions of outputs use it as an input.
#[derive(Clone, Debug)]
pub struct DerivedQuantity {
    /// Name with index.
    pub name: String,
    /// Its input.
    pub input: NodeId,
    /// What it is.
    pub what: Derived,
}

/// What the equations leave out but can tell.
#[derive(Clone, Debug)]
pub enum Derived {
    /// The force of a constraint: the multiplier of a row of the kinematics.
    Multiplier(usize),
    /// Kinetic energy of everything.
    Kinetic,
    /// Energy of elastic elements and weights.
    Potential,
    /// Power of a force element or damper.
    Power(String),
    /// A component of the force or torque in a joint.
    Reaction(Reaction),
    /// A component of the force of a hard contact along the axes of its surface, or along its normal.
    Contact(usize, Option<usize>),
    /// What a hard contact does: 0 free, 1 sliding, 2 rolling.
    Mode(usize),
}

/// What a velocity that a joint forbids would move: the joint's force along it is the sum of what that takes.
#[derive(Clone, Debug, Default)]
pub struct Reaction {
    /// Structures by row (scalar elements, six a body, three a load) and their part of that velocity.
    pub rows: Vec<(usize, NodeId)>,
    /// Constraints by row of the kinematics and their part of it.
    pub constraints: Vec<(usize, NodeId)>,
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

/// A place where the equations are not defined.
#[derive(Clone, Debug)]
pub struct Hazard {
    /// What must be above the limit, in SI units.
    pub quantity: NodeId,
    /// The limit.
    pub limit: f64,
    /// What is wrong at or below it, and what helps.
    pub message: String,
    /// Where the scene says so.
    pub place: Place,
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

/// A place on the way where forces have a corner, located while running without a word.
#[derive(Clone, Debug)]
pub struct Switch {
    /// It is where this changes sign.
    pub quantity: NodeId,
    /// Whether the method begins anew there.
    pub restarts: bool,
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
    /// Velocities that are independent, by the user's choice: coordinates (their rates), then quasi-velocities.
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
    /// Rigid bodies as inertia elements.
    pub bodies: Vec<Body>,
    /// Forces at points and torques as force elements.
    pub loads: Vec<Load>,
    /// Reactions, energies and powers that outputs use.
    pub derived: Vec<DerivedQuantity>,
    /// Hard contacts, which may roll, slide and leave.
    pub contacts: Vec<Contact>,
    /// Where forces of compliant contacts have corners.
    pub switches: Vec<Switch>,
    /// The joints as a tree, where the bodies on it are all that has inertia.
    pub tree: Option<JointTree>,
    /// Definitions that something uses, in order of use.
    pub definitions: Vec<Quantity>,
    /// Columns.
    pub outputs: Vec<Quantity>,
    /// Limits of validity.
    pub guards: Vec<Guard>,
    /// Places where the equations are not defined.
    pub hazards: Vec<Hazard>,
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

    /// The first place without equations at which the given inputs of the graph are.
    pub fn hazard(&self, inputs: &[f64]) -> Option<&Hazard> {
        let values = self.graph.eval(&self.hazards.iter().map(|h| h.quantity).collect::<Vec<_>>(), inputs);
        self.hazards.iter().zip(values).find(|(h, value)| *value <= h.limit).map(|(h, _)| h)
    }

    /// Number of elements of a kind.
    pub fn count(&self, kind: ElementKind) -> usize {
        let vectors = match kind {
            ElementKind::Inertia => self.bodies.len(),
            ElementKind::Force => self.loads.len(),
            _ => 0,
        };
        vectors + self.elements.iter().filter(|e| e.kind == kind).count()
    }
}
