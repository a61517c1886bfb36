//! Gears, and racks with their pinions: two joints whose coordinates go in a fixed ratio.
//!
//! ```text
//! b − i a − offset = 0,      i = ∓ r_a/r_b  (external, internal),   ∓ z_a/z_b,   r  (rack b, pinion a),   or given
//! wheels on an arm c:        a − c in place of a where the wheel's joint hangs on what the arm's joint hangs on (Willis 1841)
//! ```
//! The relation is one of positions: it does not drift. Its multiplier is the torque or force on b; on a it is −i times that.

use headland_expr::parse::suggestion;
use headland_expr::{Expr, NodeId};
use headland_spatial::Vector;

use super::closures::Row;
use super::joints::{Freedom, JointKind};
use super::motion::Drive;
use super::number;
use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::place::Place;
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Value};
use crate::symbols::{Binding, member_name, parse_key};

/// One coordinate of a joint.
struct Side<'g> {
    joint: usize,
    name: String,
    freedom: Freedom,
    drive: Drive<'g>,
    place: Place,
}

/// A gear whose offset is known when starts are.
pub(crate) struct Mesh<'g> {
    row: usize,
    /// `b − i a` without offset.
    position: Expr<'g>,
    /// Coordinates in it, and whether all of them have starts is not known yet.
    coordinates: Vec<usize>,
}

impl<'g> Builder<'_, 'g> {
    pub(super) fn gear(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let sides = [self.gear_side(element, "from", &binding)?, self.gear_side(element, "to", &binding)?];
            let [a, b] = &sides;
            if a.name == b.name {
                let message = format!("`{full}` binds `{}` to itself: a gear is between two joints", a.name);
                return Err(self.low.report(b.place.clone(), message));
            }
            let (ratio, lever) = self.gear_ratio(element, &binding, &full, &sides)?;
            let arm = self.arm(element, &binding, &full, &sides)?;
            if sides.iter().chain(&arm).all(|s| s.drive.of.is_none()) {
                let message = format!("`{full}` has nothing to move: the coordinates of its joints are all prescribed");
                return Err(self.low.report(element.place.clone(), message));
            }
            let row = self.mesh(element, &binding, &sides, &arm, ratio)?;
            let position = row[0];
            let Some(row) = self.hold(&full, row, &element.place) else { continue };
            let to_length = b.freedom == Freedom::Length;
            let unit = if to_length { Dimension::of(1, 1, -2) } else { Dimension::of(1, 2, -2) };
            self.name_force(format!("{full}.{}", if to_length { "force" } else { "torque" }), unit);
            if let Some(lever) = lever.filter(|_| !to_length) {
                let part = self.low.graph.id(number(-1.0) / lever);
                self.name_sum(format!("{full}.force"), vec![(row, part)], false);
            }
            if element.get("offset").is_none() {
                let coordinates = sides.iter().chain(&arm).filter_map(|s| s.drive.of).map(|(i, _)| i).collect();
                self.assembly.meshes.push(Mesh { row, position, coordinates });
            }
        }
        Ok(())
    }

    /// `b − i a − offset` with its rates; coordinates as they are seen from the arm.
    fn mesh(
        &mut self,
        element: &SceneElement,
        binding: &Binding,
        [a, b]: &[Side<'g>; 2],
        arm: &Option<Side<'g>>,
        ratio: Expr<'g>,
    ) -> Made<Row<'g>> {
        let rates = |s: &Side<'g>| [s.drive.value, s.drive.rate, s.drive.acceleration];
        let (mut from, mut to) = (rates(a), rates(b));
        if let Some(arm) = arm {
            for (side, row) in [(a, &mut from), (b, &mut to)] {
                let sign = self.beside_arm(side, arm)?;
                *row = [0, 1, 2].map(|k| row[k] - rates(arm)[k] * number(sign));
            }
        }
        let unit = if b.freedom == Freedom::Length { Dimension::of(0, 1, 0) } else { Dimension::NONE };
        let offset = match element.get("offset") {
            Some(value) => self.expression(value, "`offset`", binding, &unit, b.freedom == Freedom::Angle)?,
            None => number(0.0),
        };
        if self.evaluate(offset).is_none() {
            let place = element.get("offset").map_or(element.place.clone(), |v| v.place.clone());
            return Err(self.low.report(place, "`offset` must be made of numbers and parameters"));
        }
        let row = [0, 1, 2].map(|k| to[k] - ratio * from[k]);
        Ok([row[0] - offset, row[1], row[2]])
    }

    /// The coordinate of a joint that a field names: `hinge`, or `rod.angle` of a joint with two.
    fn gear_side(&mut self, element: &SceneElement, key: &str, binding: &Binding) -> Made<Side<'g>> {
        let (text, place) = match element.get(key) {
            Some(Value { data: Data::Text(text), place }) => (text.clone(), place.clone()),
            Some(other) => {
                let message = format!("`{key}` names a joint; found {}", other.data.kind());
                return Err(self.low.report(other.place.clone(), message));
            }
            None => return Err(self.low.report(element.place.clone(), format!("this gear lacks `{key}`, a joint"))),
        };
        let mut key = parse_key(&text).map_err(|m| self.low.report(place.clone(), m))?;
        let bindings: Vec<_> = binding.iter().cloned().collect();
        let member = match &mut key.index {
            None => 0,
            Some(index) => {
                let _ = self.low.symbols.fold_lengths(index);
                self.low.symbols.index_value(index, &bindings).map_err(|m| self.low.report(place.clone(), m))?
            }
        };
        let name = member_name(&key.name, member);
        let part = ["angle", "slide"].into_iter().find(|p| name.ends_with(&format!(".{p}"))).unwrap_or("");
        let base = name.strip_suffix(&format!(".{part}")).unwrap_or(&name).to_string();
        let Some(joint) = self.assembly.joints.iter().position(|j| j.name == base && j.element.is_some()) else {
            let joints = self.assembly.joints.iter().filter(|j| j.element.is_some()).map(|j| j.name.as_str());
            let hint = suggestion(&base, joints);
            return Err(self.low.report(place, format!("`{base}` is no joint{hint}")));
        };
        let kind = self.assembly.joints[joint].kind;
        let freedom = match (kind, part) {
            (JointKind::Revolute | JointKind::Screw, "") | (JointKind::Cylindrical, "angle") => Freedom::Angle,
            (JointKind::Prismatic, "") | (JointKind::Cylindrical, "slide") => Freedom::Length,
            (JointKind::Cylindrical, _) => {
                let message = format!("`{base}` turns and shifts: name `{base}.angle` or `{base}.slide`");
                return Err(self.low.report(place, message));
            }
            (_, "") => {
                let word = kind.word();
                let message = format!(
                    "`{base}` is {word}; a gear takes joints that turn about or shift along one axis: revolute, prismatic, \
                     screw, cylindrical"
                );
                return Err(self.low.report(place, message));
            }
            _ => {
                let message = format!("`{base}` is {} and has no coordinate `{part}`", kind.word());
                return Err(self.low.report(place, message));
            }
        };
        if self.assembly.closing.contains(&joint) {
            let message = format!(
                "`{base}` closes a loop and has no coordinate; `cut = true` at another joint of the loop gives it one"
            );
            return Err(self.low.report(place, message));
        }
        let drive = self.drive(joint, part)?;
        Ok(Side { joint, name, freedom, drive, place })
    }

    /// The ratio of the rates, to by from, and the radius at which the teeth of `to` are, if it is known.
    fn gear_ratio(
        &mut self,
        element: &SceneElement,
        binding: &Binding,
        name: &str,
        [a, b]: &[Side<'g>; 2],
    ) -> Made<(Expr<'g>, Option<Expr<'g>>)> {
        let keys: Vec<&str> =
            ["ratio", "radii", "teeth", "radius"].into_iter().filter(|k| element.get(k).is_some()).collect();
        let &[key] = keys.as_slice() else {
            let message = format!(
                "`{name}` needs one of `ratio` (rate of `to` by rate of `from`), `radii`, `teeth` (two wheels) and `radius` \
                 (of a pinion with its rack); found {}",
                if keys.is_empty() { "none".into() } else { keys.join(", ") }
            );
            return Err(self.low.report(element.place.clone(), message));
        };
        let place = element.get(key).map_or(element.place.clone(), |v| v.place.clone());
        if !matches!(key, "radii" | "teeth") {
            self.without(element, &["internal"], "it says that `radii` or `teeth` are those of a wheel in a ring")?;
        }
        let length = Dimension::of(0, 1, 0);
        let unit = |s: &Side<'g>| if s.freedom == Freedom::Length { length.clone() } else { Dimension::NONE };
        match (key, a.freedom, b.freedom) {
            ("ratio", ..) => {
                let wanted = &unit(b) - &unit(a);
                let ratio = self.scalar_field(element, key, binding, &wanted)?.ok_or(Reported)?;
                match self.evaluate(ratio) {
                    Some(0.0) => {
                        Err(self.low.report(place, format!("`ratio` is zero: `{}` would stand still", b.name)))
                    }
                    Some(_) => Ok((ratio, None)),
                    None => Err(self.low.report(place, "`ratio` must be made of numbers and parameters")),
                }
            }
            ("radii" | "teeth", Freedom::Angle, Freedom::Angle) => {
                let of = if key == "radii" { length.clone() } else { Dimension::NONE };
                let value = element.get(key).cloned().ok_or(Reported)?;
                let items = self.array(&value, key, &[2])?;
                let mut sizes = [number(0.0); 2];
                for (size, item) in sizes.iter_mut().zip(&items) {
                    *size = self.expression(item, &format!("`{key}`"), binding, &of, false)?;
                    if key == "radii" {
                        self.size(*size, key, &item.place, false)?;
                    } else {
                        self.whole(*size, &item.place)?;
                    }
                }
                let internal = matches!(element.get("internal").map(|v| &v.data), Some(Data::Flag(true)));
                let sign = number(if internal { 1.0 } else { -1.0 });
                Ok((sign * sizes[0] / sizes[1], (key == "radii").then_some(sizes[1])))
            }
            ("radius", Freedom::Angle, Freedom::Length) | ("radius", Freedom::Length, Freedom::Angle) => {
                let radius = self.scalar_field(element, key, binding, &length)?.ok_or(Reported)?;
                self.size(radius, key, &place, false)?;
                let forward = b.freedom == Freedom::Length;
                Ok((if forward { radius } else { number(1.0) / radius }, Some(radius)))
            }
            ("radius", ..) => {
                let message = format!(
                    "`radius` is that of a pinion with its rack: one joint turns, the other shifts; `{}` and `{}` {}",
                    a.name,
                    b.name,
                    if a.freedom == Freedom::Angle { "both turn: `radii` or `teeth`" } else { "both shift: `ratio`" }
                );
                Err(self.low.report(place, message))
            }
            _ => {
                let shifts = if a.freedom == Freedom::Length { a } else { b };
                let message = format!(
                    "`{key}` are those of two wheels, but `{}` shifts; a pinion with its rack has `radius`",
                    shifts.name
                );
                Err(self.low.report(place, message))
            }
        }
    }

    /// A number of teeth.
    fn whole(&mut self, teeth: Expr<'g>, place: &Place) -> Made<()> {
        match self.evaluate(teeth) {
            Some(n) if n >= 1.0 && n.fract() == 0.0 => Ok(()),
            Some(n) => Err(self.low.report(place.clone(), format!("a wheel has a whole number of teeth, not {n}"))),
            None => Err(self.low.report(place.clone(), "`teeth` must be made of numbers and parameters")),
        }
    }

    /// The joint that turns what carries the wheels.
    fn arm(
        &mut self,
        element: &SceneElement,
        binding: &Binding,
        name: &str,
        [a, b]: &[Side<'g>; 2],
    ) -> Made<Option<Side<'g>>> {
        if element.get("carrier").is_none() {
            let carriers = [a, b].map(|s| self.carrier_of(self.assembly.joints[s.joint].from));
            if element.get("ratio").is_none() && carriers[0] != carriers[1] {
                let [x, y] = carriers.map(|c| self.assembly.frames[c].name.clone());
                let message = format!(
                    "the wheels of `{name}` hang on different bodies, `{x}` and `{y}`: say with `carrier` which joint turns the \
                     arm that carries them (or, for whatever else goes in a fixed ratio, give `ratio`)"
                );
                return Err(self.low.report(element.place.clone(), message));
            }
            return Ok(None);
        }
        let arm = self.gear_side(element, "carrier", binding)?;
        if [a, b].iter().any(|s| s.name == arm.name) {
            let message = format!("`{}` is a wheel of `{name}` and cannot be its carrier too", arm.name);
            return Err(self.low.report(arm.place, message));
        }
        Ok(Some(arm))
    }

    /// 1 or −1 where a wheel's joint hangs on what the arm's joint hangs on, with the sense of its axis; 0 where it hangs on
    /// the arm.
    fn beside_arm(&mut self, side: &Side<'g>, arm: &Side<'g>) -> Made<f64> {
        let ends = |b: &Self, j: usize| {
            let joint = &b.assembly.joints[j];
            [b.carrier_of(joint.from), b.carrier_of(joint.to)]
        };
        let (wheel, carried) = (ends(self, side.joint), ends(self, arm.joint));
        if wheel[0] == carried[1] {
            return Ok(0.0);
        }
        let message = if wheel[0] != carried[0] {
            format!(
                "`{}` hangs neither on the arm that `{}` turns nor on what that hangs on: `from` of the wheel's joint is to be \
                 one of these",
                side.name, arm.name
            )
        } else if side.freedom != arm.freedom {
            format!("`{}` and its carrier `{}` do not both turn, or both shift", side.name, arm.name)
        } else {
            let [wheel, arm_axis] = [self.axis_on_body(side.joint)?, self.axis_on_body(arm.joint)?];
            let [Some((p, v)), Some((q, w))] = [wheel, arm_axis] else { return Err(Reported) };
            let between = (p - q).cross(w);
            let turned = v.cross(w);
            let small = |x: Vector<f64>, size: f64| x.norm() <= 1e-9 * size;
            if small(turned, 1.0) && (small(between, 1.0 + p.norm()) || side.freedom == Freedom::Length) {
                return Ok(v.dot(w).signum());
            }
            format!("`{}` and its carrier `{}` do not turn about the same axis", side.name, arm.name)
        };
        Err(self.low.report(side.place.clone(), message))
    }

    /// A point and the direction of a joint's axis on the body of `from`.
    #[allow(clippy::type_complexity)]
    fn axis_on_body(&mut self, j: usize) -> Made<Option<(Vector<f64>, Vector<f64>)>> {
        let (_, pose) = self.joint_frame(j, false)?;
        let axis = pose.rotation.apply(Vector::constant(self.joint_axis(j)?));
        let mut numbers = |v: Vector<Expr<'g>>| -> Option<Vector<f64>> {
            Some(Vector([self.evaluate(v[0])?, self.evaluate(v[1])?, self.evaluate(v[2])?]))
        };
        Ok(numbers(pose.position).zip(numbers(axis)))
    }

    /// Offsets of gears from the start, where it gives all their coordinates; else the coordinates left are found.
    pub(crate) fn offset_meshes(&mut self) {
        let graph = self.low.graph;
        for mesh in std::mem::take(&mut self.assembly.meshes) {
            let starts: Option<Vec<(usize, NodeId)>> = mesh
                .coordinates
                .iter()
                .map(|&i| Some((self.input_of(self.low.coordinates[i].q), self.low.coordinates[i].initial?)))
                .collect();
            let Some(starts) = starts else { continue };
            let time = self.input_of(self.low.time);
            let from = number(self.parts.run.as_ref().map_or(0.0, |r| r.from));
            let start = |i: usize| starts.iter().find(|(slot, _)| *slot == i).map(|(_, node)| graph.expr(*node));
            let offset = graph.substitute(&[graph.id(mesh.position)], start)[0];
            let offset = graph.substitute(&[graph.id(offset)], |i| (i == time).then_some(from))[0];
            self.parts.kinematics[mesh.row].position = Some(graph.id(mesh.position - offset));
        }
    }
}
