//! Springs between points, forces and torques on bodies, and vector elements by their structures, equation (7).

use headland_expr::Expr;
use headland_spatial::{Pose, Vector};

use super::closures::Relative;
use super::number;
use crate::build::{Builder, Made, bound_name};
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::{Reported, per_time};
use crate::model::{Body, Element, ElementKind, Hazard, Load, StructureForm, VectorStructure};
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Value};
use crate::symbols::Binding;

const NEWTON: [i64; 3] = [1, 1, -2];
const NEWTON_METRE: [i64; 3] = [1, 2, -2];

fn dimension([kg, m, s]: [i64; 3]) -> Dimension {
    Dimension::of(kg, m, s)
}

impl<'g> Builder<'_, 'g> {
    /// A spring and damper along the line between two points.
    pub(super) fn spring(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let mut ends = Vec::new();
            for (frame, at) in [("from", "at"), ("to", "to_at")] {
                let default = if frame == "from" { Some(0) } else { None };
                let frame = self.frame_field(element, frame, &binding, default)?;
                let pose = self.pose_field(element, at, "rpy", &binding)?;
                let Some(motion) = self.motion(frame) else { return Err(Reported) };
                ends.push(motion.fixed(&pose));
            }
            let d = ends[1].position - ends[0].position;
            let d_rate = ends[1].velocity_in_world() - ends[0].velocity_in_world();
            let stiffness = self.scalar_field(element, "stiffness", &binding, &Dimension::of(1, 0, -2))?;
            let damping = self.scalar_field(element, "damping", &binding, &Dimension::of(1, 0, -1))?;
            let free = self.scalar_field(element, "free_length", &binding, &Dimension::of(0, 1, 0))?;
            if stiffness.is_none() && damping.is_none() {
                let message = format!("the spring `{full}` has neither `stiffness` nor `damping`");
                return Err(self.low.report(element.place.clone(), message));
            }
            for (key, e) in [("stiffness", stiffness), ("damping", damping), ("free_length", free)] {
                let Some(e) = e else { continue };
                self.without_accelerations(element, key, &full, e)?;
                let velocities = Kinds::RATE.or(Kinds::QUASI).or(Kinds::JOINT);
                let (wrong, allowed) = match key {
                    "stiffness" => (Kinds::PARAMETER.not(), "parameters"),
                    "free_length" => (velocities, "parameters, time and coordinates"),
                    _ => continue,
                };
                if let Some(input) = self.depends(e, wrong) {
                    let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
                    let message = format!("`{key}` of `{full}` depends on `{input}`; it is made of {allowed}");
                    return Err(self.low.report(place, message));
                }
            }
            let free = free.unwrap_or(number(0.0));
            let length = d.norm();
            // a free length that changes, by a winch or a given function, is part of the stretch
            let free_rate = self.low.time_derivative(free, 1).map_err(|m| self.low.report(element.place.clone(), m))?;
            let rate = d.dot(d_rate) / length;
            if damping.is_some() || !free.is(0.0) {
                let message = format!(
                    "the ends of the spring `{full}` are in the same place: it has no direction there; set them apart{}",
                    if damping.is_none() { ", or leave out `free_length`" } else { "" }
                );
                let quantity = self.low.graph.id(length);
                self.parts.hazards.push(Hazard { quantity, limit: 1e-12, message, place: element.place.clone() });
            }
            let mut add = |kind, value, structure, rate| self.add_scalar(element, &full, kind, value, structure, rate);
            match stiffness {
                // without a free length the force is c d, also where d is nothing
                Some(c) if free.is(0.0) => (0..3).for_each(|i| add(ElementKind::Elastic, c, d[i], d_rate[i])),
                Some(c) => add(ElementKind::Elastic, c, length - free, rate - free_rate),
                None => {}
            }
            if let Some(b) = damping {
                add(ElementKind::Dissipative, b, rate, rate);
            }
        }
        Ok(())
    }

    /// Refuses what depends on accelerations.
    fn without_accelerations(&mut self, element: &SceneElement, key: &str, full: &str, e: Expr<'g>) -> Made<()> {
        let typed = crate::lower::Typed { expr: e, ..crate::lower::Typed::number(0.0, Dimension::NONE) };
        let place = element.get(key).map_or(&element.place, |v| &v.place);
        self.no_accelerations(&typed, place, &format!("`{key}` of `{full}`"))
    }

    /// Springs and dampers along and about the three axes of a frame on `from`.
    pub(super) fn bushing(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let mut ends = Vec::new();
            for (frame, at, rpy) in [("from", "at", "rpy"), ("to", "to_at", "to_rpy")] {
                let default = if frame == "from" { Some(0) } else { None };
                let frame = self.frame_field(element, frame, &binding, default)?;
                let pose = self.pose_field(element, at, rpy, &binding)?;
                let Some(motion) = self.motion(frame) else { return Err(Reported) };
                ends.push(motion.fixed(&pose));
            }
            let relative = Relative::new(&ends[0], &ends[1]);
            let angles = relative.angles();
            let keys = [
                ("stiffness", ElementKind::Elastic, Dimension::of(1, 0, -2), false),
                ("damping", ElementKind::Dissipative, Dimension::of(1, 0, -1), false),
                ("turn_stiffness", ElementKind::Elastic, dimension(NEWTON_METRE), true),
                ("turn_damping", ElementKind::Dissipative, Dimension::of(1, 2, -1), true),
            ];
            for (key, kind, dimension, turns) in keys {
                let values = self.vector_field(element, key, &binding, &dimension, false)?;
                for i in (0..3).filter(|i| !values[*i].is(0.0)) {
                    self.without_accelerations(element, key, &full, values[i])?;
                    if kind == ElementKind::Elastic
                        && let Some(input) = self.depends(values[i], Kinds::PARAMETER.not())
                    {
                        let message = format!("`{key}` of `{full}` depends on `{input}`; it is made of parameters");
                        return Err(self.low.report(element.place.clone(), message));
                    }
                    let name = format!("{full}.{}{}", if turns { "t" } else { "" }, ["x", "y", "z"][i]);
                    if turns {
                        self.add_turned(element, &name, kind, values[i], angles[i]);
                    } else {
                        let [d, rate, _] = relative.distance(i);
                        self.add_scalar(
                            element,
                            &name,
                            kind,
                            values[i],
                            if kind == ElementKind::Elastic { d } else { rate },
                            rate,
                        );
                    }
                }
            }
        }
        Ok(())
    }

    /// A spring or damper on an angle, whose rate is its derivative.
    fn add_turned(&mut self, element: &SceneElement, name: &str, kind: ElementKind, value: Expr<'g>, angle: Expr<'g>) {
        let graph = self.low.graph;
        self.parts.elements.push(Element {
            name: name.into(),
            kind,
            value: graph.id(value),
            form: StructureForm::Geometric,
            structure: graph.id(angle),
            rate: None,
            place: element.place.clone(),
            unit: if kind == ElementKind::Elastic { "N*m" } else { "N*m*s" }.into(),
        });
    }

    fn add_scalar(
        &mut self,
        element: &SceneElement,
        name: &str,
        kind: ElementKind,
        value: Expr<'g>,
        structure: Expr<'g>,
        rate: Expr<'g>,
    ) {
        let graph = self.low.graph;
        let (form, unit) = match kind {
            ElementKind::Elastic => (StructureForm::Geometric, "N/m"),
            _ => (StructureForm::Implicit, "N*s/m"),
        };
        self.parts.elements.push(Element {
            name: name.into(),
            kind,
            value: graph.id(value),
            form,
            structure: graph.id(structure),
            rate: Some(graph.id(rate)),
            place: element.place.clone(),
            unit: unit.into(),
        });
    }

    /// `[[force]]` with `force` or `torque`: on a frame, or by a structure.
    pub(crate) fn vector_force(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        self.without(element, &["value", "geometric", "implicit", "explicit"], "`force` and `torque` are vectors")?;
        if element.get("on").is_some() {
            self.without(element, &["position", "velocity", "spin"], "the frame in `on` says where it acts")?;
        } else {
            self.without(element, &["at", "axes"], "they belong to a frame in `on`")?;
        }
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            for (key, of) in [("force", NEWTON), ("torque", NEWTON_METRE)] {
                if element.get(key).is_none() {
                    continue;
                }
                let force = self.vector_field(element, key, &binding, &dimension(of), false)?;
                for e in force.0 {
                    let typed = crate::lower::Typed { expr: e, ..crate::lower::Typed::number(0.0, dimension(of)) };
                    self.no_accelerations(&typed, &element.place, &format!("the {key} of `{full}`"))?;
                }
                let rate = match element.get("on") {
                    Some(_) => self.rate_on_frame(element, &binding, key == "force")?,
                    None if key == "force" => self.point_velocity(element, &full, &binding)?,
                    None => self.spin_structure(element, &full, &binding)?,
                };
                let graph = self.low.graph;
                self.parts.loads.push(Load {
                    name: full.clone(),
                    force: force.0.map(|e| graph.id(e)),
                    rate: rate.0.map(|e| graph.id(e)),
                    potential: None,
                    place: element.place.clone(),
                });
            }
        }
        Ok(())
    }

    /// Velocity of a point of a frame, or the frame's angular velocity, along the axes in which the force is given.
    fn rate_on_frame(&mut self, element: &SceneElement, binding: &Binding, linear: bool) -> Made<Vector<Expr<'g>>> {
        let frame = self.frame_field(element, "on", binding, None)?;
        let at = self.pose_field(element, "at", "rpy", binding)?;
        let Some(motion) = self.motion(frame) else { return Err(Reported) };
        let m = motion.fixed(&Pose::at(at.position));
        let own = match element.get("axes").map(|v| (&v.data, v.place.clone())) {
            None => false,
            Some((Data::Text(word), _)) if word == "world" => false,
            Some((Data::Text(word), _)) if word == "frame" => true,
            Some((_, place)) => {
                return Err(self
                    .low
                    .report(place, "`axes` is \"world\" (default) or \"frame\": those of the frame in `on`"));
            }
        };
        Ok(match (linear, own) {
            (true, true) => m.velocity,
            (true, false) => m.velocity_in_world(),
            (false, true) => m.spin,
            (false, false) => m.rotation.apply(m.spin),
        })
    }

    /// `[[inertia]]` with `mass` or `tensor`: a body of equation (7) by its structures.
    pub(crate) fn vector_inertia(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        let scalar = ["value", "geometric", "implicit", "explicit"];
        self.without(element, &scalar, "`mass` and `tensor` make a vector element")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let mass = self.scalar_field(element, "mass", &binding, &Dimension::of(1, 0, 0))?;
            let tensor = match element.get("tensor").cloned() {
                Some(value) => Some(self.tensor_value(&value, &binding)?),
                None => None,
            };
            let zero = Vector::constant([0.0; 3]);
            let velocity = if mass.is_some() { self.point_velocity(element, &full, &binding)? } else { zero };
            let spin = if tensor.is_some() { self.spin_structure(element, &full, &binding)? } else { zero };
            let tensor = tensor.map_or([number(0.0); 6], |t| t.0);
            let mass = mass.unwrap_or(number(0.0));
            for e in [mass].into_iter().chain(tensor) {
                if let Some(input) = self.depends(e, Kinds::PARAMETER.not()) {
                    let message = format!("mass and tensor of `{full}` are made of parameters, not of `{input}`");
                    return Err(self.low.report(element.place.clone(), message));
                }
            }
            let graph = self.low.graph;
            let structure =
                |v: Vector<Expr<'g>>| VectorStructure { rate: v.0.map(|e| graph.id(e)), acceleration: None };
            self.parts.bodies.push(Body {
                name: full,
                mass: graph.id(mass),
                velocity: structure(velocity),
                tensor: tensor.map(|e| graph.id(e)),
                spin: structure(spin),
                weight: zero.0.map(|e| graph.id(e)),
                potential: graph.id(number(0.0)),
                place: element.place.clone(),
            });
        }
        Ok(())
    }

    /// `position` (differentiated) or `velocity` of a point, axes of the world.
    fn point_velocity(&mut self, element: &SceneElement, name: &str, binding: &Binding) -> Made<Vector<Expr<'g>>> {
        let length = Dimension::of(0, 1, 0);
        match (element.get("position").cloned(), element.get("velocity").cloned()) {
            (Some(value), None) => {
                let position = self.structure_value(&value, "position", name, binding, &length)?;
                for e in position.0 {
                    if let Some(input) = self.depends(e, Kinds::RATE.or(Kinds::QUASI).or(Kinds::JOINT)) {
                        let message =
                            format!("`position` of `{name}` depends on the velocity `{input}`; give `velocity`");
                        return Err(self.low.report(value.place.clone(), message));
                    }
                }
                let mut rate = [number(0.0); 3];
                for (r, e) in rate.iter_mut().zip(position.0) {
                    *r = self.low.time_derivative(e, 1).map_err(|m| self.low.report(value.place.clone(), m))?;
                }
                Ok(Vector(rate))
            }
            (None, Some(value)) => self.structure_value(&value, "velocity", name, binding, &per_time(&length, 1)),
            _ => {
                let message = format!(
                    "`{name}` needs one structure of its point: `position` or `velocity`, three components in the world"
                );
                Err(self.low.report(element.place.clone(), message))
            }
        }
    }

    fn spin_structure(&mut self, element: &SceneElement, name: &str, binding: &Binding) -> Made<Vector<Expr<'g>>> {
        match element.get("spin").cloned() {
            Some(value) => self.structure_value(&value, "spin", name, binding, &per_time(&Dimension::NONE, 1)),
            None => {
                let message = format!("`{name}` needs `spin`: its angular velocity in body axes");
                Err(self.low.report(element.place.clone(), message))
            }
        }
    }

    fn structure_value(
        &mut self,
        value: &Value,
        key: &str,
        name: &str,
        binding: &Binding,
        dimension: &Dimension,
    ) -> Made<Vector<Expr<'g>>> {
        let vector = self.vector_value(value, key, binding, dimension, false)?;
        for e in vector.0 {
            let typed = crate::lower::Typed { expr: e, ..crate::lower::Typed::number(0.0, dimension.clone()) };
            self.no_accelerations(&typed, &value.place, &format!("`{key}` of `{name}`"))?;
        }
        Ok(vector)
    }
}
