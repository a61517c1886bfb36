//! The spanning tree over the joints, their coordinates, and the motions that they make.

use std::collections::VecDeque;

use headland_expr::parse::suggestion;
use headland_expr::{Expr, NodeId, Scalar};
use headland_spatial::{Pose, Quaternion, Rotation, Vector};

use super::joints::{Freedom, JointKind};
use super::motion::{Ball, Drive, Step};
use super::{Carrier, JointEntry, number};
use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::lower::{Reported, per_time};
use crate::model::{Guard, Hazard, KinematicRow, RowForm};
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Value};
use crate::symbols::{Binding, Members, Symbol};

impl<'s, 'g> Builder<'s, 'g> {
    pub(super) fn declare_joints(&mut self) {
        for element in self.scene.section_elements("joint") {
            let Ok(name) = self.text_field(element, "name") else { continue };
            for binding in self.bindings_of(element).unwrap_or_default() {
                if self.declare_joint(element, &name, binding).is_err() {
                    break;
                }
            }
        }
    }

    fn declare_joint(&mut self, element: &'s SceneElement, name: &str, binding: Binding) -> Made<()> {
        let kind = self.joint_kind(element)?;
        let from = self.frame_field(element, "from", &binding, Some(0))?;
        let to = self.frame_field(element, "to", &binding, None)?;
        let by_angles = match element.get("orientation") {
            None => false,
            Some(Value { data: Data::Text(word), .. }) if word == "quaternion" => false,
            Some(Value { data: Data::Text(word), .. }) if word == "rpy" => true,
            Some(other) => {
                return Err(self.low.report(other.place.clone(), "`orientation` is \"quaternion\" or \"rpy\""));
            }
        };
        self.refuse_idle_keys(element, kind)?;
        let cut = matches!(element.get("cut").map(|v| &v.data), Some(Data::Flag(true)));
        let position = self.assembly.joints.len();
        let full = self.declare_member(element, name, &binding, "a joint", position)?;
        if self.carrier_of(from) == self.carrier_of(to) {
            let body = &self.assembly.frames[self.carrier_of(to)].name;
            let message = format!("the joint `{full}` binds `{body}` to itself: `from` and `to` are on the same body");
            return Err(self.low.report(element.place.clone(), message));
        }
        let place = element.place.clone();
        let element = Some((element, binding));
        self.assembly.joints.push(JointEntry {
            name: full,
            place,
            kind,
            from,
            to,
            element,
            cut,
            by_angles,
            in_world: false,
        });
        Ok(())
    }

    /// A key that says nothing to a kind of joint was meant to.
    fn refuse_idle_keys(&mut self, element: &SceneElement, kind: JointKind) -> Made<()> {
        let serves = [
            ("axis", kind.has_axis(), "its axes are those of its frame, which `rpy` turns"),
            ("lead", kind == JointKind::Screw, "it belongs to a screw"),
            ("orientation", kind.is_ball(), "it belongs to `spherical` and `free`"),
        ];
        for (key, _, why) in serves.into_iter().filter(|(_, serves, _)| !serves) {
            if let Some(value) = element.get(key) {
                let word = kind.word();
                let place = value.place.clone();
                return Err(self.low.report(place, format!("`{key}` says nothing to a joint of kind `{word}`: {why}")));
            }
        }
        Ok(())
    }

    fn joint_kind(&mut self, element: &SceneElement) -> Made<JointKind> {
        let word = self.text_field(element, "kind")?;
        match JointKind::ALL.iter().find(|(name, _)| *name == word) {
            Some((_, kind)) => Ok(*kind),
            None => {
                let hint = suggestion(&word, JointKind::ALL.iter().map(|(n, _)| *n));
                let known: Vec<&str> = JointKind::ALL.iter().map(|(n, _)| *n).collect();
                let place = element.get("kind").map_or(element.place.clone(), |v| v.place.clone());
                let message = format!("unknown kind of joint `{word}`{hint}; known: {}", known.join(", "));
                Err(self.low.report(place, message))
            }
        }
    }

    /// The body, or the world, that carries a frame.
    pub(super) fn carrier_of(&self, mut frame: usize) -> usize {
        while let Carrier::Frame(on) = self.assembly.frames[frame].carrier {
            frame = on;
        }
        frame
    }

    /// Whether a frame's body moves on the world by a joint of its own.
    pub(super) fn hangs_on_world(&self, frame: usize) -> bool {
        let body = self.carrier_of(frame);
        self.assembly.tree.iter().any(|&(j, _)| {
            let joint = &self.assembly.joints[j];
            let ends = [self.carrier_of(joint.from), self.carrier_of(joint.to)];
            ends.contains(&body) && ends.contains(&0)
        })
    }

    /// Breadth first from the world over the joints in the order of the file; a body that none reaches is free.
    pub(super) fn span_tree(&mut self) {
        let mut reached = vec![false; self.assembly.frames.len()];
        let mut used = vec![false; self.assembly.joints.len()];
        reached[0] = true;
        let mut queue = VecDeque::from([0]);
        loop {
            while let Some(body) = queue.pop_front() {
                for j in 0..self.assembly.joints.len() {
                    let joint = &self.assembly.joints[j];
                    let ends = [self.carrier_of(joint.from), self.carrier_of(joint.to)];
                    if used[j] || joint.cut || !ends.contains(&body) {
                        continue;
                    }
                    let reversed = ends[1] == body;
                    let other = if reversed { ends[0] } else { ends[1] };
                    if !reached[other] {
                        (reached[other], used[j]) = (true, true);
                        self.assembly.tree.push((j, reversed));
                        queue.push_back(other);
                    }
                }
            }
            let is_body = |i: &usize| self.assembly.frames[*i].carrier == Carrier::Body;
            let Some(free) = (1..reached.len()).filter(is_body).find(|i| !reached[*i]) else { break };
            let frame = &self.assembly.frames[free];
            let (name, place) = (frame.name.clone(), frame.place.clone());
            let kind = JointKind::Free;
            let in_world = self.turns_in_world(free);
            self.assembly.tree.push((self.assembly.joints.len(), false));
            let (element, cut, by_angles) = (None, false, false);
            let joint = JointEntry { name, place, kind, from: 0, to: free, element, cut, by_angles, in_world };
            self.assembly.joints.push(joint);
            used.push(true);
            reached[free] = true;
            queue.push_back(free);
        }
        self.assembly.closing = (0..used.len()).filter(|j| !used[*j]).collect();
    }

    /// What a free body says of the axes of its angular velocity.
    fn turns_in_world(&mut self, frame: usize) -> bool {
        let Some((element, _)) = self.assembly.frames[frame].element.clone() else { return false };
        match element.get("angular_velocity").map(|v| (&v.data, v.place.clone())) {
            None => false,
            Some((Data::Text(word), _)) if word == "body" => false,
            Some((Data::Text(word), _)) if word == "world" => true,
            Some((_, place)) => {
                let _ = self.low.report(place, "`angular_velocity` is \"body\" (default) or \"world\"");
                false
            }
        }
    }

    /// Coordinates and quasi-velocities of the tree's joints, in the order of the file.
    pub(super) fn declare_joint_coordinates(&mut self) {
        let mut joints: Vec<usize> = self.assembly.tree.iter().map(|(j, _)| *j).collect();
        joints.sort_unstable();
        for j in joints {
            let _ = self.joint_coordinates(j);
        }
    }

    fn joint_coordinates(&mut self, j: usize) -> Made<()> {
        let (kind, by_angles) = (self.assembly.joints[j].kind, self.assembly.joints[j].by_angles);
        for (part, freedom) in kind.coordinates() {
            self.joint_coordinate(j, part, *freedom, Some(0.0))?;
        }
        if kind.is_ball() && by_angles {
            for part in ["roll", "pitch", "yaw"] {
                self.joint_coordinate(j, part, Freedom::Angle, Some(0.0))?;
            }
        } else if kind.is_ball() {
            for (part, guess) in [("qw", 1.0), ("qx", 0.0), ("qy", 0.0), ("qz", 0.0)] {
                self.named_coordinate(j, part, &Dimension::NONE, false, Some(guess))?;
            }
            for part in self.turns_of(j) {
                self.joint_velocity(j, part)?;
            }
        }
        Ok(())
    }

    /// Names of the components of a ball's angular velocity.
    fn turns_of(&self, j: usize) -> [&'static str; 3] {
        if self.assembly.joints[j].in_world { ["omega_x", "omega_y", "omega_z"] } else { ["wx", "wy", "wz"] }
    }

    fn joint_coordinate(&mut self, j: usize, part: &str, freedom: Freedom, guess: Option<f64>) -> Made<()> {
        let (dimension, angle) = match freedom {
            Freedom::Angle => (Dimension::NONE, true),
            Freedom::Length => (Dimension::of(0, 1, 0), false),
        };
        self.named_coordinate(j, part, &dimension, angle, guess)
    }

    fn named_coordinate(
        &mut self,
        j: usize,
        part: &str,
        dimension: &Dimension,
        angle: bool,
        guess: Option<f64>,
    ) -> Made<()> {
        let (family, member, full) = self.part_name(j, part)?;
        let place = self.assembly.joints[j].place.clone();
        let is_given =
            |key: &str| key == full || key.replace(|c: char| c.is_whitespace(), "").starts_with(&format!("{family}["));
        if self.scene.section("prescribed").iter().any(|p| is_given(&p.key)) {
            self.low.declared.insert(family, (dimension.clone(), angle)); // a given function of time: made there
            return Ok(());
        }
        let position = self.low.add_coordinate(full.clone(), dimension, angle, &place);
        self.low.coordinates[position].guess = guess;
        let own_name = part.is_empty(); // the joint's own name stands for its only coordinate
        match self.low.symbols.by_name.get_mut(family.as_str()) {
            Some(Symbol::Coordinate(members)) => {
                members.insert(member, position);
            }
            Some(Symbol::Joint(_)) if !own_name => {
                return Err(self.low.report(place, format!("`{full}` has a meaning already")));
            }
            Some(Symbol::Joint(_)) | None => {
                let members = Members::family([(member, position)]);
                self.low.symbols.by_name.insert(family.as_str().into(), Symbol::Coordinate(members));
            }
            Some(_) => return Err(self.low.report(place, format!("`{full}` has a meaning already"))),
        }
        Ok(())
    }

    fn joint_velocity(&mut self, j: usize, part: &str) -> Made<()> {
        let (family, member, full) = self.part_name(j, part)?;
        let place = self.assembly.joints[j].place.clone();
        let rate = per_time(&Dimension::NONE, 1);
        let position = self.low.add_joint_velocity(full, &rate, true, &place);
        match self.low.symbols.by_name.get_mut(family.as_str()) {
            Some(Symbol::QuasiVelocity(members)) => {
                members.insert(member, position);
            }
            _ => {
                let members = Members::family([(member, position)]);
                self.low.symbols.by_name.insert(family.as_str().into(), Symbol::QuasiVelocity(members));
            }
        }
        Ok(())
    }

    /// `(hitch.qw, 2, hitch[2].qw)`
    fn part_name(&mut self, j: usize, part: &str) -> Made<(String, i64, String)> {
        let (name, place) = (self.assembly.joints[j].name.clone(), self.assembly.joints[j].place.clone());
        let (base, member) = self.split_name(&name, &place)?;
        if part.is_empty() {
            return Ok((base, member, name));
        }
        Ok((format!("{base}.{part}"), member, format!("{name}.{part}")))
    }

    /// Pose of the joint's frame on the body at one end.
    pub(super) fn joint_frame(&mut self, j: usize, at_child: bool) -> Made<(usize, Pose<Expr<'g>>)> {
        let joint = &self.assembly.joints[j];
        let (frame, element) = (if at_child { joint.to } else { joint.from }, joint.element.clone());
        let (body, pose) = self.on_body(frame)?;
        let Some((element, binding)) = element else { return Ok((body, pose)) };
        let (at, rpy) = if at_child { ("to_at", "to_rpy") } else { ("at", "rpy") };
        Ok((body, pose * self.pose_field(element, at, rpy, &binding)?))
    }

    /// The motion of the body at the far end of a joint of the tree.
    pub(super) fn build_joint(&mut self, j: usize, reversed: bool) -> Made<()> {
        let (near, near_pose) = self.joint_frame(j, reversed)?;
        let (far, far_pose) = self.joint_frame(j, !reversed)?;
        let mut steps = self.steps(j)?;
        let turn_round = |steps: Vec<Step<'g>>| steps.into_iter().rev().map(Step::reversed).collect();
        let own: Vec<Step<'g>> = if reversed { turn_round(steps.clone()) } else { steps.clone() };
        self.hang(near, &near_pose, &own, far, &far_pose.inverse());
        steps.extend(self.virtual_steps(j));
        if reversed {
            steps = turn_round(steps);
        }
        let Some(base) = self.motion(near) else { return Err(Reported) };
        let joint = steps.iter().fold(base.fixed(&near_pose), |motion, step| motion.step(step));
        self.assembly.frames[far].motion = Some(joint.fixed(&far_pose.inverse()));
        Ok(())
    }

    /// The joint's motion from its frame on `from` to that on `to`.
    fn steps(&mut self, j: usize) -> Made<Vec<Step<'g>>> {
        let (kind, by_angles) = (self.assembly.joints[j].kind, self.assembly.joints[j].by_angles);
        let axis = Vector::constant(self.joint_axis(j)?);
        let [x, y, z] = [0, 1, 2].map(|i| Vector::constant([0, 1, 2].map(|k| f64::from(u8::from(i == k)))));
        let mut steps = match kind {
            JointKind::Weld | JointKind::Spherical => Vec::new(),
            JointKind::Revolute => vec![Step::Turn(axis, self.drive(j, "")?)],
            JointKind::Prismatic => vec![Step::Slide(axis, self.drive(j, "")?)],
            JointKind::Screw => {
                let drive = self.drive(j, "")?;
                let lead = self.lead(j)?;
                vec![Step::Turn(axis, drive), Step::Slide(axis, drive.scaled(lead))]
            }
            JointKind::Cylindrical => {
                vec![Step::Slide(axis, self.drive(j, "slide")?), Step::Turn(axis, self.drive(j, "angle")?)]
            }
            JointKind::Universal => vec![Step::Turn(x, self.drive(j, "a")?), Step::Turn(y, self.drive(j, "b")?)],
            JointKind::Planar => vec![
                Step::Slide(x, self.drive(j, "x")?),
                Step::Slide(y, self.drive(j, "y")?),
                Step::Turn(z, self.drive(j, "angle")?),
            ],
            JointKind::Free => vec![
                Step::Slide(x, self.drive(j, "x")?),
                Step::Slide(y, self.drive(j, "y")?),
                Step::Slide(z, self.drive(j, "z")?),
            ],
        };
        if kind.is_ball() && by_angles {
            for (part, axis) in [("yaw", z), ("pitch", y), ("roll", x)] {
                let drive = self.drive(j, part)?;
                if part == "pitch" && drive.of.is_some() {
                    self.guard_pitch(j, drive.value);
                }
                steps.push(Step::Turn(axis, drive));
            }
        } else if kind.is_ball() {
            steps.push(self.ball(j)?);
        }
        Ok(steps)
    }

    /// Roll and yaw turn about the same axis where the pitch is a right angle.
    fn guard_pitch(&mut self, j: usize, pitch: Expr<'g>) {
        let name = &self.assembly.joints[j].name;
        self.parts.hazards.push(Hazard {
            quantity: self.low.graph.id(pitch.cos()),
            limit: 1e-9,
            message: format!(
                "gimbal lock: the pitch of `{name}` is 90 deg, where roll and yaw turn about the same axis and their rates \
                 say nothing; start elsewhere, or take `orientation = \"quaternion\"`, which has no such place"
            ),
            place: self.assembly.joints[j].place.clone(),
        });
        self.parts.guards.push(Guard {
            name: format!("cos({name}.pitch)"),
            quantity: self.low.graph.id(pitch.cos()),
            unit: String::new(),
            warn_below: Some(0.02),
            stop_below: Some(1e-5),
            message: format!(
                "gimbal lock: at a pitch of 90 deg roll and yaw of `{name}` turn about the same axis and their rates have \
                 no bounds; `orientation = \"quaternion\"` has no such place"
            ),
        });
    }

    /// Advance of a screw per radian.
    fn lead(&mut self, j: usize) -> Made<Expr<'g>> {
        let joint = &self.assembly.joints[j];
        let (place, name, element) = (joint.place.clone(), joint.name.clone(), joint.element.clone());
        let lead = match &element {
            Some((element, binding)) => self.scalar_field(element, "lead", binding, &Dimension::of(0, 1, 0))?,
            None => None,
        };
        match lead {
            Some(lead) if self.evaluate(lead).is_none() => {
                Err(self.low.report(place, format!("`lead` of `{name}` must be made of numbers and parameters")))
            }
            Some(lead) => Ok(lead * number(1.0 / std::f64::consts::TAU)),
            None => Err(self.low.report(place, format!("the screw `{name}` needs `lead`, its advance a turn"))),
        }
    }

    /// The joint's axis, in its frame.
    pub(super) fn joint_axis(&mut self, j: usize) -> Made<[f64; 3]> {
        match self.assembly.joints[j].element.clone() {
            Some((element, binding)) => self.direction(element, "axis", &binding, [0.0, 0.0, 1.0]),
            None => Ok([0.0, 0.0, 1.0]),
        }
    }

    /// A coordinate of a joint, or the function of time that is given for it.
    pub(super) fn drive(&mut self, j: usize, part: &str) -> Made<Drive<'g>> {
        let (family, member, full) = self.part_name(j, part)?;
        let graph = self.low.graph;
        if let Some((position, _, Symbol::Definition(rules, _))) = self.low.symbols.by_name.get_full(family.as_str()) {
            if !rules.contains_key(&member) {
                let place = self.assembly.joints[j].place.clone();
                let message = format!(
                    "`{full}` has no function of time, but others of its family have: [prescribed] gives all members or none"
                );
                return Err(self.low.report(place, message));
            }
            let value = self.low.definition(position, member)?.expr;
            let place = self.assembly.joints[j].place.clone();
            let mut derivative = |n| {
                self.low.time_derivative(value, n).map_err(|m| self.low.report(place.clone(), format!("`{full}`: {m}")))
            };
            return Ok(Drive { value, rate: derivative(1)?, acceleration: derivative(2)?, of: None });
        }
        match self.low.symbols.by_name.get(family.as_str()) {
            Some(Symbol::Coordinate(members)) if members.get(member).is_some() => {
                let i = members.get(member).unwrap_or_default();
                let c = &self.low.coordinates[i];
                let [value, rate, acceleration] = [c.q, c.rate, c.acceleration].map(|n| graph.expr(n));
                Ok(Drive { value, rate, acceleration, of: Some((i, 1.0)) })
            }
            _ => Err(Reported),
        }
    }

    /// A quaternion with its rate as rows of form (2).
    fn ball(&mut self, j: usize) -> Made<Step<'g>> {
        let graph = self.low.graph;
        let place = self.assembly.joints[j].place.clone();
        let mut q = [(0, number(0.0)); 4];
        for (slot, part) in q.iter_mut().zip(["qw", "qx", "qy", "qz"]) {
            let (family, member, full) = self.part_name(j, part)?;
            let Some(Symbol::Coordinate(members)) = self.low.symbols.by_name.get(family.as_str()) else {
                let message = format!("`{full}` cannot be prescribed; give the joint `orientation = \"rpy\"` for that");
                return Err(self.low.report(place, message));
            };
            let i = members.get(member).unwrap_or_default();
            *slot = (i, graph.expr(self.low.coordinates[i].q));
        }
        let mut w: [(NodeId, NodeId); 3] = [(self.low.time, self.low.time); 3];
        let mut places = [0; 3];
        for ((slot, place), part) in w.iter_mut().zip(&mut places).zip(self.turns_of(j)) {
            let (family, member, _) = self.part_name(j, part)?;
            if let Some(Symbol::QuasiVelocity(members)) = self.low.symbols.by_name.get(family.as_str()) {
                *place = members.get(member).unwrap_or_default();
                let u = &self.low.quasi_velocities[*place];
                *slot = (u.u, u.acceleration);
            }
        }
        let quaternion = Quaternion(q.map(|(_, e)| e));
        let (turns, seconds) = (Vector(w.map(|(u, _)| graph.expr(u))), Vector(w.map(|(_, a)| graph.expr(a))));
        let in_world = self.assembly.joints[j].in_world;
        let rate = if in_world { quaternion.rate_from_world(turns) } else { quaternion.rate_from_body(turns) };
        for ((i, _), e) in q.iter().zip(rate.0) {
            let name = format!("{}'", self.low.coordinates[*i].name);
            self.parts.kinematics.push(KinematicRow::new(name, &place, RowForm::Rate(*i, graph.id(e))));
        }
        let of = Some((q.map(|(i, _)| i), places));
        if in_world {
            // d(Rᵀ w)/dt = Rᵀ w′, for w × w = 0; the recursive algorithms know velocities in the body's axes only
            let r = Rotation::from_quaternion(quaternion);
            let (spin, rate) = (r.apply_inverse(turns), r.apply_inverse(seconds));
            return Ok(Step::Ball(Ball { quaternion, spin, rate, of: None, level: Some((turns, seconds)) }));
        }
        Ok(Step::Ball(Ball { quaternion, spin: turns, rate: seconds, of, level: None }))
    }
}
