//! The assembly level: bodies, frames and joints, lowered to coordinates, kinematics and elements of equation (7).
//!
//! Names and coordinates are declared first ([`Builder::declare_assembly`]), with a spanning tree over the joints: each
//! body hangs on one joint, joints left over close loops. Motions, elements and constraints are built when all names
//! are known ([`Builder::build_assembly`]).

mod closures;
mod compliant;
mod contact;
mod curved;
mod facets;
mod fields;
mod forces;
mod gears;
mod joints;
mod links;
mod motion;
mod quantities;
mod reactions;
mod rolling;
mod surfaces;
mod touching;
mod tree;
mod tyre;
mod tyre_law;

use headland_expr::{Expr, Scalar};
use headland_spatial::{Pose, Symmetric, Vector};

use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::model::{Body, Reaction, VectorStructure};
use crate::place::Place;
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Value};
use crate::symbols::{Binding, Members, Symbol};

use joints::JointKind;
pub(crate) use motion::Motion;
use quantities::is_round;
pub(crate) use quantities::{QUANTITIES, quantity};

/// What a frame is fixed to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Carrier {
    World,
    Body,
    /// Another frame, by position.
    Frame(usize),
}

/// The world, a body or a frame.
struct FrameEntry<'s, 'g> {
    name: String,
    place: Place,
    carrier: Carrier,
    element: Option<(&'s SceneElement, Binding)>,
    motion: Option<Motion<'g>>,
    /// True for one that a `[[surface]]` stands in.
    is_surface: bool,
}

/// A joint of the scene, or the free motion of a body on which no joint acts.
struct JointEntry<'s> {
    name: String,
    place: Place,
    kind: JointKind,
    from: usize,
    to: usize,
    /// None for a free motion that the scene does not mention.
    element: Option<(&'s SceneElement, Binding)>,
    /// True where the scene says that it closes a loop.
    cut: bool,
    by_angles: bool,
    /// The angular velocity is a quasi-velocity by components along the world's axes.
    in_world: bool,
}

/// Bodies, frames and joints of a scene.
#[derive(Default)]
pub(crate) struct Assembly<'s, 'g> {
    /// The world comes first.
    frames: Vec<FrameEntry<'s, 'g>>,
    joints: Vec<JointEntry<'s>>,
    /// Tree joints from the world outward: joint, and whether it is walked from `to` to `from`.
    tree: Vec<(usize, bool)>,
    /// Joints that close loops.
    closing: Vec<usize>,
    /// Joints whose force is asked for, with their virtual displacements.
    virtuals: Vec<reactions::Virtual>,
    links: links::Links<'g>,
    /// Mass, momentum and the like of all bodies.
    total: quantities::Total<'g>,
    /// Torques of joints that close loops.
    closing_forces: Vec<(String, Reaction, bool)>,
    /// Gears whose offset follows from the start.
    meshes: Vec<gears::Mesh<'g>>,
    /// Places of contact on curved ground.
    touches: Vec<touching::Touch<'g>>,
    /// Discs that roll: contact, place, and sine of the angle between axis and normal.
    tilts: Vec<(String, Place, headland_expr::NodeId)>,
}

const SECTIONS: [&str; 11] =
    ["body", "frame", "surface", "joint", "rolling", "contact", "tyre", "skate", "gear", "spring", "bushing"];

impl<'s, 'g> Builder<'s, 'g> {
    /// Declares bodies, frames, joints and their coordinates.
    pub(crate) fn declare_assembly(&mut self) {
        if SECTIONS.iter().all(|s| self.scene.section_elements(s).is_empty()) {
            return;
        }
        let world = FrameEntry {
            name: "world".into(),
            place: Place::Program,
            carrier: Carrier::World,
            element: None,
            motion: None,
            is_surface: false,
        };
        self.assembly.frames.push(world);
        self.low.symbols.by_name.insert("world".into(), Symbol::Frame(Members::single(0)));
        self.declare_frames("body", "a body");
        self.declare_frames("frame", "a frame");
        self.declare_frames("surface", "a surface");
        self.place_frames();
        self.declare_joints();
        if self.low.diagnostics.is_empty() {
            self.span_tree();
            self.declare_joint_coordinates();
            self.declare_places();
            self.declare_tyres();
        }
    }

    fn declare_frames(&mut self, section: &str, new: &str) {
        for element in self.scene.section_elements(section) {
            let Ok(name) = self.text_field(element, "name") else { continue };
            for binding in self.bindings_of(element).unwrap_or_default() {
                let carrier = if section == "body" { Carrier::Body } else { Carrier::Frame(0) };
                let position = self.assembly.frames.len();
                let Ok(full) = self.declare_member(element, &name, &binding, new, position) else { break };
                self.assembly.frames.push(FrameEntry {
                    name: full,
                    place: element.place.clone(),
                    carrier,
                    element: Some((element, binding)),
                    motion: None,
                    is_surface: section == "surface",
                });
            }
        }
    }

    /// What each `[[frame]]` is fixed to.
    fn place_frames(&mut self) {
        for i in 1..self.assembly.frames.len() {
            let Some((element, binding)) = self.assembly.frames[i].element.clone() else { continue };
            if self.assembly.frames[i].carrier != Carrier::Body
                && let Ok(on) = self.frame_field(element, "on", &binding, Some(0))
            {
                self.assembly.frames[i].carrier = Carrier::Frame(on);
            }
        }
        for i in 1..self.assembly.frames.len() {
            let (mut at, mut steps) = (i, 0);
            while let Carrier::Frame(on) = self.assembly.frames[at].carrier {
                (at, steps) = (on, steps + 1);
                if steps > self.assembly.frames.len() {
                    let (place, name) = (self.assembly.frames[i].place.clone(), &self.assembly.frames[i].name);
                    let message = format!("the frame `{name}` is fixed to itself by way of others");
                    self.low.report(place, message);
                    return;
                }
            }
        }
    }

    /// The body (or the world) that carries a frame, and the frame's pose on it.
    fn on_body(&mut self, frame: usize) -> Made<(usize, Pose<Expr<'g>>)> {
        let (mut at, mut pose) = (frame, Pose::identity());
        while let Carrier::Frame(on) = self.assembly.frames[at].carrier {
            if let Some((element, binding)) = self.assembly.frames[at].element.clone() {
                pose = self.pose_field(element, "at", "rpy", &binding)? * pose;
            }
            at = on;
        }
        Ok((at, pose))
    }

    /// Builds motions, then what acts on them.
    pub(crate) fn build_assembly(&mut self) {
        if self.assembly.frames.is_empty() {
            return;
        }
        let gravity = match self.scene.get("world", "gravity").cloned() {
            Some(value) => self.vector_value(&value, "gravity", &None, &Dimension::of(0, 1, -2), false),
            None => Ok(Vector::zero()),
        };
        let Ok(gravity) = gravity else { return };
        for e in gravity.0 {
            if let Some(name) = self.depends(e, crate::depend::Kinds::PARAMETER.not()) {
                if let Some(value) = self.scene.get("world", "gravity") {
                    let message =
                        format!("`gravity` is made of parameters, not of `{name}`; what changes is a `[[force]]`");
                    let _ = self.low.report(value.place.clone(), message);
                }
                return;
            }
        }
        self.assembly.frames[0].motion = Some(Motion::world(gravity));
        for k in 0..self.assembly.tree.len() {
            let (joint, reversed) = self.assembly.tree[k];
            if self.build_joint(joint, reversed).is_err() {
                return;
            }
        }
        for i in 1..self.assembly.frames.len() {
            if self.assembly.frames[i].motion.is_none()
                && let Ok((body, pose)) = self.on_body(i)
            {
                let motion = self.assembly.frames[body].motion.map(|m| m.fixed(&pose));
                self.assembly.frames[i].motion = motion;
            }
        }
        for i in 1..self.assembly.frames.len() {
            if self.assembly.frames[i].carrier == Carrier::Body {
                let _ = self.body(i);
            }
        }
        self.publish_frames();
        for k in 0..self.assembly.closing.len() {
            let _ = self.close_loop(self.assembly.closing[k]);
        }
    }

    /// Keeps the name of an element in which something is wrong.
    fn remember(&mut self, made: Made<()>, element: &SceneElement) {
        if let (Err(_), Some(Data::Text(name))) = (made, element.get("name").map(|v| &v.data)) {
            self.low.unmade.push(name.split('[').next().unwrap_or_default().trim().into());
        }
    }

    /// Constraints and forces between frames; definitions may be used here.
    pub(crate) fn assembly_elements(&mut self) {
        for section in ["rolling", "contact", "tyre", "skate", "gear", "spring", "bushing"] {
            self.no_name_twice(section);
        }
        for element in self.scene.section_elements("rolling") {
            let made = self.rolling(element);
            self.remember(made, element);
        }
        for element in self.scene.section_elements("contact") {
            let made = self.contact(element);
            self.remember(made, element);
        }
        for element in self.scene.section_elements("tyre") {
            let _ = self.tyre(element);
        }
        for element in self.scene.section_elements("skate") {
            let _ = self.skate(element);
        }
        for element in self.scene.section_elements("gear") {
            let _ = self.gear(element);
        }
        for element in self.scene.section_elements("spring") {
            let _ = self.spring(element);
        }
        for element in self.scene.section_elements("bushing") {
            let _ = self.bushing(element);
        }
    }

    /// Two elements of a section with the same name would share the names of their forces.
    pub(crate) fn no_name_twice(&mut self, section: &str) {
        let elements = self.scene.section_elements(section);
        for (i, element) in elements.iter().enumerate() {
            let Some(Value { data: Data::Text(name), place }) = element.get("name") else { continue };
            let is_same = |e: &SceneElement| matches!(e.get("name"), Some(v) if v.data == Data::Text(name.clone()));
            if elements[..i].iter().any(is_same) {
                self.low.report(place.clone(), format!("two elements of [[{section}]] are named `{name}`"));
            }
        }
    }

    /// Names of the rows by which the joints would close loops, were they not on the tree.
    pub(crate) fn rows_of_joints(&self) -> Vec<(String, bool)> {
        let rows = |joint: &JointEntry<'_>| {
            let axes = ["x", "y", "z"];
            let positions =
                joint.kind.fixed_positions().iter().map(|&i| (format!("{}.{}", joint.name, axes[i]), false));
            let rotations = joint.kind.fixed_rotations().iter();
            let rotations = rotations.map(|&(i, k)| (format!("{}.{}{}", joint.name, axes[i], axes[k]), true));
            positions.chain(rotations).collect::<Vec<_>>()
        };
        self.assembly.joints.iter().filter(|joint| joint.element.is_some()).flat_map(rows).collect()
    }

    /// Mass, centre and tensor of a body as an element of equation (7).
    fn body(&mut self, frame: usize) -> Made<()> {
        let Some((element, binding)) = self.assembly.frames[frame].element.clone() else { return Ok(()) };
        let Some(motion) = self.assembly.frames[frame].motion else { return Ok(()) };
        let (mass, centre, tensor) = self.inertia_fields(element, &binding)?;
        let is_free = |j: &JointEntry<'_>| j.element.is_none() && j.to == frame;
        if !self.assembly.joints.iter().any(is_free) {
            self.without(element, &["angular_velocity"], "the body is not free: its joint has the velocities")?;
        }
        self.link_inertia(frame, mass, centre, tensor);
        let c = motion.fixed(&Pose::at(centre));
        let graph = self.low.graph;
        let ids = |v: Vector<Expr<'g>>| v.0.map(|e| graph.id(e));
        let (velocity, acceleration, gravity) = match c.level {
            Some((v, a)) => (v, a, self.world_gravity()),
            None => (c.velocity, c.acceleration, c.gravity),
        };
        let potential = -(self.world_gravity().dot(c.position) * mass);
        let weight = gravity * mass;
        let (spin, spin_rate) = match c.level_spin {
            Some(level) if is_round(&tensor) => level,
            _ => (c.spin, c.spin_rate),
        };
        let Symmetric(entries) = tensor;
        self.assembly.total.add(mass, &c, tensor);
        self.parts.bodies.push(Body {
            name: self.assembly.frames[frame].name.clone(),
            mass: graph.id(mass),
            velocity: VectorStructure { rate: ids(velocity), acceleration: Some(ids(acceleration)) },
            tensor: entries.map(|e| graph.id(e)),
            spin: VectorStructure { rate: ids(spin), acceleration: Some(ids(spin_rate)) },
            weight: ids(weight),
            potential: graph.id(potential),
            place: element.place.clone(),
        });
        Ok(())
    }

    fn world_gravity(&self) -> Vector<Expr<'g>> {
        self.motion(0).map_or(Vector::constant([0.0; 3]), |m| m.gravity)
    }

    /// Motion of a frame, once motions are built.
    fn motion(&self, frame: usize) -> Option<Motion<'g>> {
        self.assembly.frames.get(frame).and_then(|f| f.motion)
    }
}

/// `½`, `2`, .. as an expression.
fn number<'g>(x: f64) -> Expr<'g> {
    Expr::constant(x)
}
