//! Joints that close loops: what they forbid, at position, velocity and acceleration.
//!
//! With frame A of the joint on `from`, frame B on `to`, all in A's axes turned so that z is the joint's axis:
//!
//! ```text
//! d = R_Aᵀ (p_B − p_A)         d′ = R_AB v_B − v_A − w_A × d
//! d″ = R_AB a_B − a_A − w_A′ × d − w_A × (w_A × d) − 2 w_A × d′
//! R_AB′ = R_AB [w]×            w = w_B − R_ABᵀ w_A
//! R_AB″ = R_AB ([w]×[w]× + [w′]×),   w′ = w_B′ − R_ABᵀ w_A′ + w × R_ABᵀ w_A
//! ```

use headland_expr::{Expr, NodeId, Scalar};
use headland_spatial::{Pose, Rotation, Vector};

use super::motion::Motion;
use super::number;
use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::lower::{Reported, per_time};
use crate::model::{KinematicRow, Reaction, RowForm};
use crate::place::Place;

/// A function of the motion with its first two rates.
pub(super) type Row<'g> = [Expr<'g>; 3];

impl<'g> Builder<'_, 'g> {
    pub(super) fn close_loop(&mut self, j: usize) -> Made<()> {
        let joint = &self.assembly.joints[j];
        let (kind, name, place) = (joint.kind, joint.name.clone(), joint.place.clone());
        if kind == super::joints::JointKind::Screw {
            let message =
                format!("the screw `{name}` closes a loop; that is not known: cut the loop elsewhere (`cut = true`)");
            return Err(self.low.report(place, message));
        }
        let align = Pose::new(align_z(self.joint_axis(j)?), Vector::constant([0.0; 3]));
        let mut ends = Vec::new();
        for at_child in [false, true] {
            let (body, pose) = self.joint_frame(j, at_child)?;
            let Some(motion) = self.motion(body) else { return Err(Reported) };
            ends.push(motion.fixed(&(pose * align)));
        }
        let relative = Relative::new(&ends[0], &ends[1]);
        let mut forces = Vec::new(); // row, and force and torque on `to` for a unit of its multiplier, axes of B
        let zero = Vector::constant([0.0; 3]);
        let axes = ["x", "y", "z"];
        for &i in kind.fixed_positions() {
            if let Some(row) = self.hold(&format!("{name}.{}", axes[i]), relative.distance(i), &place) {
                forces.push((row, Vector(relative.r.0[i]), zero));
            }
        }
        for &(i, k) in kind.fixed_rotations() {
            if let Some(row) = self.hold(&format!("{name}.{}{}", axes[i], axes[k]), relative.rotation(i, k), &place) {
                self.parts.kinematics[row].dimension = per_time(&Dimension::NONE, 1);
                forces.push((row, zero, Vector([0, 1, 2].map(|m| relative.turned(i, k, m)))));
            }
        }
        for (m, (component, torque)) in super::reactions::COMPONENTS.into_iter().enumerate() {
            let part = |(row, force, moment): &(usize, Vector<Expr<'g>>, Vector<Expr<'g>>)| {
                let vector = align.rotation.apply(if torque { *moment } else { *force });
                (*row, self.low.graph.id(-vector[m % 3]))
            };
            let constraints = forces.iter().map(part).collect();
            self.name_sum(format!("{name}.{component}"), constraints, torque);
        }
        Ok(())
    }

    /// Names a force or torque that several rows make together, each with its part, negative.
    pub(super) fn name_sum(&mut self, name: String, constraints: Vec<(usize, NodeId)>, torque: bool) {
        let reaction = Reaction { rows: Vec::new(), constraints };
        self.assembly.closing_forces.push((name, reaction, torque));
    }

    /// Names the force of the row that was made last.
    pub(super) fn name_force(&mut self, name: String, dimension: Dimension) {
        if let Some(row) = self.parts.kinematics.last_mut() {
            row.force = Some((name, dimension));
        }
    }

    /// A constraint on positions, `row = 0`, with its rates; gives its place among the rows.
    pub(super) fn hold(&mut self, name: &str, row: Row<'g>, place: &Place) -> Option<usize> {
        if row.iter().all(|e| e.is(0.0)) {
            return None; // fulfilled whatever the motion
        }
        let graph = self.low.graph;
        let [position, rate, second] = row.map(|e| graph.id(e));
        let form = RowForm::Zero(rate);
        let row = KinematicRow::new(name, place, form);
        let row = KinematicRow { position: Some(position), rate: Some(second), may_be_redundant: true, ..row };
        self.parts.kinematics.push(row);
        Some(self.parts.kinematics.len() - 1)
    }
}

/// A rotation whose z axis is the given direction; a permutation of axes where that serves.
fn align_z<'g>(z: [f64; 3]) -> Rotation<Expr<'g>> {
    let largest = (0..3).max_by(|&i, &k| z[i].abs().total_cmp(&z[k].abs())).unwrap_or(2);
    let mut x = [0.0; 3];
    x[(largest + 1) % 3] = 1.0;
    let z = Vector(z);
    let dot = z.dot(Vector(x));
    let x = Vector([0, 1, 2].map(|i| x[i] - dot * z[i])).unit();
    let y = z.cross(x);
    Rotation([0, 1, 2].map(|i| [x[i], y[i], z[i]].map(number)))
}

/// Frame B as seen from frame A.
pub(super) struct Relative<'g> {
    d: Vector<Expr<'g>>,
    d_rate: Vector<Expr<'g>>,
    d_second: Vector<Expr<'g>>,
    r: Rotation<Expr<'g>>,
    w: Vector<Expr<'g>>,
    w_rate: Vector<Expr<'g>>,
    /// Both in A's axes, where they are the simpler form.
    level: Option<(Vector<Expr<'g>>, Vector<Expr<'g>>)>,
}

impl<'g> Relative<'g> {
    pub(super) fn new(a: &Motion<'g>, b: &Motion<'g>) -> Self {
        let r = a.rotation.transpose() * b.rotation;
        let d = a.rotation.apply_inverse(b.position - a.position);
        let stands = [a.spin, a.velocity, a.spin_rate, a.acceleration].iter().all(|v| (0..3).all(|i| v[i].is(0.0)));
        let (d_rate, d_second) = if stands {
            (a.rotation.apply_inverse(b.velocity_in_world()), a.rotation.apply_inverse(b.acceleration_in_world()))
        } else {
            let d_rate = r.apply(b.velocity) - a.velocity - a.spin.cross(d);
            let inertial = a.spin_rate.cross(d) + a.spin.cross(a.spin.cross(d)) + a.spin.cross(d_rate) * number(2.0);
            (d_rate, r.apply(b.acceleration) - a.acceleration - inertial)
        };
        let carried = r.apply_inverse(a.spin);
        let w = b.spin - carried;
        let w_rate = b.spin_rate - r.apply_inverse(a.spin_rate) + w.cross(carried);
        let level = b.level_spin.map(|(spin, rate)| {
            let [spin, rate] = [spin, rate].map(|v| a.rotation.apply_inverse(v));
            let relative = spin - a.spin;
            (relative, rate - a.spin_rate + relative.cross(a.spin))
        });
        Self { d, d_rate, d_second, r, w, w_rate, level }
    }

    /// `R_AB`.
    pub(super) fn turning(&self) -> Rotation<Expr<'g>> {
        self.r
    }

    /// Angular velocity of B relative to A, in B's axes.
    pub(super) fn spin(&self) -> Vector<Expr<'g>> {
        self.w
    }

    /// Rate of its components.
    pub(super) fn spin_rate(&self) -> Vector<Expr<'g>> {
        self.w_rate
    }

    /// Angular velocity of B relative to A, and that of its components in B's axes their rate, in A's axes.
    pub(super) fn turns(&self) -> [Vector<Expr<'g>>; 2] {
        let (w, rate) = self.level.unwrap_or_else(|| (self.r.apply(self.w), self.r.apply(self.w_rate)));
        [w, rate]
    }

    /// A component of `d`.
    pub(super) fn distance(&self, i: usize) -> Row<'g> {
        [self.d[i], self.d_rate[i], self.d_second[i]]
    }

    /// Cardan's angles of B in A, `R = Rx(a) Ry(b) Rz(c)`: each is the angle where only that one turns.
    pub(super) fn angles(&self) -> [Expr<'g>; 3] {
        let r = &self.r.0;
        let level = (r[0][0] * r[0][0] + r[0][1] * r[0][1]).sqrt();
        [(-r[1][2]).atan2(r[2][2]), r[0][2].atan2(level), (-r[0][1]).atan2(r[0][0])]
    }

    /// By how much the entry `e_i · R e_k` grows with a turn of B about its axis m.
    fn turned(&self, i: usize, k: usize, m: usize) -> Expr<'g> {
        let unit = |n: usize| Vector::constant([0, 1, 2].map(|c| f64::from(u8::from(c == n))));
        Vector(self.r.0[i]).dot(unit(m).cross(unit(k)))
    }

    /// The entry `e_i · R e_k`.
    pub(super) fn rotation(&self, i: usize, k: usize) -> Row<'g> {
        let mut e = [0.0; 3];
        e[k] = 1.0;
        let e = Vector::constant(e);
        let row = Vector(self.r.0[i]);
        let turned = self.w.cross(e);
        [row[k], row.dot(turned), row.dot(self.w.cross(turned) + self.w_rate.cross(e))]
    }
}
