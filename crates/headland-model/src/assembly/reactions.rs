//! Forces in joints, and what else the equations can tell: names for outputs, and what a joint's force is the sum of.
//!
//! For a joint whose force is asked for, six further displacements stand behind its own, three shifts and three turns of
//! the `to` side along the axes of the joint's frame there. They are zero; but by what each would move, the principle of
//! virtual power gives the force along it. When all is built, zero is put in for them.

use headland_expr::{Expr, NodeId};
use headland_spatial::Vector;

use super::motion::{Drive, Step};
use super::number;
use crate::build::Builder;
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::model::{Derived, ElementKind, Reaction, RowForm, StructureForm};
use crate::scene::{Data, Value};

/// Names of the components, and whether they are torques.
pub(super) const COMPONENTS: [(&str, bool); 6] =
    [("fx", false), ("fy", false), ("fz", false), ("tx", true), ("ty", true), ("tz", true)];

/// Virtual displacements of a joint: the joint, and for each component the displacement and its rate.
pub(crate) type Virtual = (usize, [(NodeId, NodeId); 6]);

impl<'g> Builder<'_, 'g> {
    /// Whether any text of the scene may ask for the force in a joint.
    fn is_asked_for(&self, joint: usize) -> bool {
        let base = self.assembly.joints[joint].name.split('[').next().unwrap_or_default().to_string();
        let asks = |text: &str| {
            text.match_indices(&base).any(|(i, _)| COMPONENTS.iter().any(|(c, _)| text[i..].contains(&format!(".{c}"))))
        };
        let mut values: Vec<&Value> = Vec::new();
        for section in ["definitions", "outputs"] {
            values.extend(self.scene.section(section).iter().map(|e| &e.value));
        }
        for section in ["guard", "event"] {
            values.extend(self.scene.section_elements(section).iter().flat_map(|e| e.fields.iter().map(|f| &f.value)));
        }
        while let Some(value) = values.pop() {
            match &value.data {
                Data::Array(items) => values.extend(items),
                Data::Text(text) if asks(text) => return true,
                _ => {}
            }
        }
        false
    }

    /// Steps of the virtual displacements behind those of the joint, if its force is asked for.
    pub(super) fn virtual_steps(&mut self, joint: usize) -> Vec<Step<'g>> {
        if self.assembly.joints[joint].element.is_none() || !self.is_asked_for(joint) {
            return Vec::new();
        }
        let graph = self.low.graph;
        let name = self.assembly.joints[joint].name.clone();
        let mut steps = Vec::new();
        let inputs = [0, 1, 2, 3, 4, 5].map(|k| {
            let (component, torque) = COMPONENTS[k];
            let mut input = |suffix: &str| {
                self.low.dependence.input(graph, &format!("{name}.{component} displacement{suffix}"), Kinds::VIRTUAL)
            };
            let (value, rate) = (input(""), input("'"));
            let mut axis = [0.0; 3];
            axis[k % 3] = 1.0;
            let drive = Drive { value: graph.expr(value), rate: graph.expr(rate), acceleration: number(0.0), of: None };
            let axis = Vector::constant(axis);
            steps.push(if torque { Step::Turn(axis, drive) } else { Step::Slide(axis, drive) });
            (value, rate)
        });
        self.assembly.virtuals.push((joint, inputs));
        steps
    }

    /// Names that outputs may use for what the equations can tell.
    pub(crate) fn publish_derived(&mut self) {
        let (newton, newton_metre) = (Dimension::of(1, 1, -2), Dimension::of(1, 2, -2));
        let (joule, watt) = (Dimension::of(1, 2, -2), Dimension::of(1, 2, -3));
        let mut names: Vec<(String, Derived, Dimension)> = vec![
            ("system.kinetic_energy".into(), Derived::Kinetic, joule.clone()),
            ("system.potential_energy".into(), Derived::Potential, joule),
        ];
        for (joint, _) in &self.assembly.virtuals {
            let name = &self.assembly.joints[*joint].name;
            for (component, torque) in COMPONENTS {
                let dimension = if torque { &newton_metre } else { &newton };
                names.push((format!("{name}.{component}"), Derived::Reaction(Reaction::default()), dimension.clone()));
            }
        }
        for (row, of) in self.parts.kinematics.iter().enumerate() {
            let Some((name, dimension)) = &of.force else { continue };
            names.push((name.clone(), Derived::Multiplier(row), dimension.clone()));
        }
        for (name, reaction, torque) in std::mem::take(&mut self.assembly.closing_forces) {
            let dimension = if torque { &newton_metre } else { &newton };
            names.push((name, Derived::Reaction(reaction), dimension.clone()));
        }
        let scalars =
            self.parts.elements.iter().filter(|e| !matches!(e.kind, ElementKind::Inertia | ElementKind::Elastic));
        let powers = scalars.map(|e| &e.name).chain(self.parts.loads.iter().map(|l| &l.name));
        names.extend(powers.map(|name| (format!("{name}.power"), Derived::Power(name.clone()), watt.clone())));
        for (name, what, dimension) in names {
            self.low.derived_names.entry(name).or_insert((what, dimension));
        }
    }

    /// What each virtual displacement moves; then zero for all of them.
    pub(crate) fn finish_reactions(&mut self) {
        self.parts.derived = std::mem::take(&mut self.low.derived);
        let virtuals = std::mem::take(&mut self.assembly.virtuals);
        if virtuals.is_empty() {
            return;
        }
        for (joint, inputs) in &virtuals {
            for ((component, _), (displacement, rate)) in COMPONENTS.iter().zip(inputs) {
                let name = format!("{}.{component}", self.assembly.joints[*joint].name);
                if let Some(k) = self.parts.derived.iter().position(|d| d.name == name) {
                    self.parts.derived[k].what = Derived::Reaction(self.moved_by(*displacement, *rate));
                }
            }
        }
        let graph = self.low.graph;
        let mut is_virtual = vec![false; graph.input_count()];
        for node in virtuals.iter().flat_map(|(_, inputs)| inputs.iter().flat_map(|(a, b)| [*a, *b])) {
            is_virtual[graph.node(node).args[0] as usize] = true;
        }
        self.for_all_nodes(|nodes| {
            let zero = graph.substitute(nodes, |i| is_virtual[i].then_some(Expr::Const(0.0)));
            zero.into_iter().map(|e| graph.id(e)).collect()
        });
    }

    /// Parts of a virtual velocity in all structures and constraints.
    fn moved_by(&self, displacement: NodeId, rate: NodeId) -> Reaction {
        let graph = self.low.graph;
        let along = |input: NodeId, nodes: &[NodeId]| -> Vec<(usize, NodeId)> {
            let slot = graph.node(input).args[0] as usize;
            let found = graph.tangent(nodes, |i| (i == slot).then_some(Expr::Const(1.0))).into_iter().enumerate();
            found.filter(|(_, e)| !e.is(0.0)).map(|(k, e)| (k, graph.id(e))).collect()
        };
        // a structure given by its place moves with the displacement, one given by its rate with the rate
        let by_place = |form, given: Option<NodeId>| form == StructureForm::Geometric && given.is_none();
        let zero = graph.id(Expr::Const(0.0));
        let places: Vec<NodeId> =
            self.parts.elements.iter().map(|e| if by_place(e.form, e.rate) { e.structure } else { zero }).collect();
        let scalars = self
            .parts
            .elements
            .iter()
            .map(|e| if by_place(e.form, e.rate) { zero } else { e.rate.unwrap_or(e.structure) });
        let bodies = self.parts.bodies.iter().flat_map(|b| b.velocity.rate.into_iter().chain(b.spin.rate));
        let rates: Vec<NodeId> = scalars.chain(bodies).chain(self.parts.loads.iter().flat_map(|l| l.rate)).collect();
        let mut rows = along(displacement, &places);
        rows.extend(along(rate, &rates));
        let held: Vec<NodeId> = self.parts.kinematics.iter().map(|r| r.position.unwrap_or(zero)).collect();
        let bound = self.parts.kinematics.iter().map(|r| match r.form {
            RowForm::Zero(node) if r.position.is_none() => node,
            _ => zero,
        });
        let bound: Vec<NodeId> = bound.collect();
        let mut constraints = along(displacement, &held);
        constraints.extend(along(rate, &bound));
        Reaction { rows, constraints }
    }

    /// Replaces every node of the parts.
    fn for_all_nodes(&mut self, replace: impl Fn(&[NodeId]) -> Vec<NodeId>) {
        let parts = &mut *self.parts;
        let mut slots: Vec<&mut NodeId> = Vec::new();
        for row in &mut parts.kinematics {
            match &mut row.form {
                RowForm::Rate(_, node) | RowForm::Zero(node) => slots.push(node),
            }
            slots.extend(row.position.iter_mut().chain(&mut row.rate));
        }
        for e in &mut parts.elements {
            slots.extend([&mut e.value, &mut e.structure]);
            slots.extend(&mut e.rate);
        }
        for b in &mut parts.bodies {
            for structure in [&mut b.velocity, &mut b.spin] {
                slots.extend(&mut structure.rate);
                slots.extend(structure.acceleration.iter_mut().flatten());
            }
            slots.extend(&mut b.weight);
            slots.push(&mut b.potential);
        }
        for l in &mut parts.loads {
            slots.extend(l.force.iter_mut().chain(&mut l.rate).chain(&mut l.potential));
        }
        for d in &mut parts.derived {
            if let Derived::Reaction(r) = &mut d.what {
                slots.extend(r.rows.iter_mut().chain(&mut r.constraints).map(|(_, node)| node));
            }
        }
        for c in &mut parts.contacts {
            slots.extend(c.gap.iter_mut().chain(&mut c.normal).chain(&mut c.slip).chain(&mut c.slip_rate));
            slots.extend(c.friction.iter_mut().flat_map(|f| &mut f.force));
        }
        slots.extend(parts.outputs.iter_mut().map(|o| &mut o.node));
        slots.extend(parts.guards.iter_mut().map(|g| &mut g.quantity));
        slots.extend(parts.hazards.iter_mut().map(|h| &mut h.quantity));
        slots.extend(parts.events.iter_mut().map(|e| &mut e.quantity));
        slots.extend(parts.switches.iter_mut().map(|s| &mut s.quantity));
        slots.extend(self.low.made.iter_mut().map(|m| &mut m.id));
        let nodes: Vec<NodeId> = slots.iter().map(|n| **n).collect();
        for (slot, node) in slots.into_iter().zip(replace(&nodes)) {
            *slot = node;
        }
    }
}
