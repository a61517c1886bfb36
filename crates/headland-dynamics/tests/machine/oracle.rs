//! The oracle: each body by Newton and Euler in its own six coordinates, joints and contacts as constraints between
//! poses, differentiated by nested dual numbers and solved for all accelerations and multipliers at once.
//!
//! Nothing of it is the program's: neither joint coordinates nor elimination nor structures.

use headland_expr::{Dual, Scalar};
use headland_spatial::{Pose, Rotation, Vector};
use nalgebra::{DMatrix, DVector};

use super::state::{Moment, Moving};
use super::{Contact, Kind, Link, Machine, Shape, coordinates, driven, joint_pose, lift, lift_pose};

type Second = Dual<Dual<f64>>;
type First = Dual<f64>;

/// A row of constraints: how it belongs, and what it forbids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    Link(usize),
    Contact(usize),
    Edge(usize),
}

/// Accelerations and multipliers.
pub struct Solution {
    /// Angular (axes of the body) and linear (of the origin, axes of the world) a body.
    pub accelerations: Vec<[f64; 6]>,
    rows: Vec<(Owner, DVector<f64>)>,
    multipliers: DVector<f64>,
    /// Whether all rows are independent.
    pub unique: bool,
    /// Largest violation of the constraints at position and velocity.
    pub violation: f64,
}

fn second(value: f64, dot: f64, dot_dot: f64) -> Second {
    Dual::new(Dual::new(value, dot), Dual::new(dot, dot_dot))
}

fn cross_matrix<S: Scalar>(w: Vector<S>) -> Rotation<S> {
    let o = S::constant(0.0);
    Rotation([[o, -w[2], w[1]], [w[2], o, -w[0]], [-w[1], w[0], o]])
}

fn add(a: [[f64; 3]; 3], b: [[f64; 3]; 3], k: f64) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + k * b[i][j]))
}

/// Pose as a function of time to second order.
fn pose2(m: &Moving, acceleration: [f64; 6]) -> Pose<Second> {
    let [e0, e1, e2, a0, a1, a2] = acceleration;
    let (r, w, e) = (m.pose.rotation, cross_matrix(m.w), cross_matrix(Vector([e0, e1, e2])));
    let rate = (r * w).0;
    let rate_rate = (r * Rotation(add((w * w).0, e.0, 1.0))).0;
    let rotation = std::array::from_fn(|i| std::array::from_fn(|j| second(r.0[i][j], rate[i][j], rate_rate[i][j])));
    let (p, v, a) = (m.pose.position, m.v, [a0, a1, a2]);
    Pose::new(Rotation(rotation), Vector(std::array::from_fn(|i| second(p[i], v[i], a[i]))))
}

/// Pose, angular velocity and velocity to first order.
fn moving1(m: &Moving, acceleration: [f64; 6]) -> (Pose<First>, Vector<First>, Vector<First>) {
    let [e0, e1, e2, a0, a1, a2] = acceleration;
    let (r, p) = (m.pose.rotation, m.pose.position);
    let rate = (r * cross_matrix(m.w)).0;
    let rotation = std::array::from_fn(|i| std::array::from_fn(|j| Dual::new(r.0[i][j], rate[i][j])));
    let pair = |x: Vector<f64>, y: [f64; 3]| Vector(std::array::from_fn(|i| Dual::new(x[i], y[i])));
    (Pose::new(Rotation(rotation), pair(p, m.v.0)), pair(m.w, [e0, e1, e2]), pair(m.v, [a0, a1, a2]))
}

/// Two unit vectors across a unit vector.
fn across(a: Vector<f64>) -> [Vector<f64>; 2] {
    let k = (0..3).min_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs())).unwrap_or(0);
    let b = a.cross(Vector(std::array::from_fn(|i| f64::from(u8::from(i == k))))).unit();
    [b, a.cross(b)]
}

/// What a joint forbids between frame A and frame B, given `X_AB`.
fn forbidden<S: Scalar>(l: &Link, x: &Pose<S>, t: S) -> Vec<S> {
    let turned = |v: Vector<f64>| x.rotation * lift::<S>(v);
    let skew = |r: &Rotation<S>| vec![r.0[2][1] - r.0[1][2], r.0[0][2] - r.0[2][0], r.0[1][0] - r.0[0][1]];
    if l.drive.is_some() {
        let rest = joint_pose(l, &driven(l, t)).inverse() * *x;
        return rest.position.0.into_iter().chain(skew(&rest.rotation)).collect();
    }
    let p = x.position;
    let [b, c] = across(l.axis);
    let aside = |v: Vector<S>| vec![v.dot(lift(b)), v.dot(lift(c))];
    let [ex, ey, ez] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector);
    match l.kind {
        Kind::Weld => [p.0.to_vec(), skew(&x.rotation)].concat(),
        Kind::Revolute => [p.0.to_vec(), aside(turned(l.axis))].concat(),
        Kind::Prismatic => [aside(p), skew(&x.rotation)].concat(),
        Kind::Cylindrical => [aside(p), aside(turned(l.axis))].concat(),
        Kind::Screw => {
            // near the angle zero; states stay away from half a turn
            let angle = turned(b).dot(lift(c)).atan2(turned(b).dot(lift(b)));
            let way = p.dot(lift(l.axis)) - angle * S::constant(l.lead / std::f64::consts::TAU);
            [vec![way], aside(p), aside(turned(l.axis))].concat()
        }
        Kind::Universal => [p.0.to_vec(), vec![turned(ey).dot(lift(ex))]].concat(),
        Kind::Planar => vec![p[2], turned(ez)[0], turned(ez)[1]],
        Kind::Spherical => p.0.to_vec(),
        Kind::Free => Vec::new(),
    }
}

/// Contact point from the centre, along the plane's axes, by the pose of the shape on the plane.
fn contact_point<S: Scalar>(shape: &Shape, r: &Rotation<S>) -> Vector<S> {
    let n = Vector::constant([0.0, 0.0, 1.0]);
    match *shape {
        Shape::Ball(radius) => n * S::constant(-radius),
        Shape::Disc { axis, radius, tube } => {
            // the lowest direction in the plane of the circle
            let a = *r * lift::<S>(axis);
            let side = a.cross(n).unit();
            side.cross(a) * S::constant(-radius) - n * S::constant(tube)
        }
        Shape::Ellipsoid(axes) => {
            // x = A s of the unit sphere: lowest where s is along -A n
            let along = r.apply_inverse(n);
            let s = Vector(std::array::from_fn(|i| S::constant(axes[i]) * along[i])).unit();
            *r * Vector(std::array::from_fn(|i| S::constant(-axes[i]) * s[i]))
        }
    }
}

impl Machine {
    fn moving(&self, moment: &Moment, body: Option<usize>) -> Moving {
        let zero = Vector::zero();
        let still = Moving { pose: Pose::identity(), w: zero, v: zero, w_rate: zero, a: zero };
        body.map_or(still, |b| moment.bodies[b])
    }

    /// Rows of one owner: value and rate of what is held, and its second rate at the given accelerations of its bodies.
    fn rows(&self, moment: &Moment, owner: Owner, on: [[f64; 6]; 2]) -> Vec<[f64; 3]> {
        match owner {
            Owner::Link(k) => {
                let l = &self.links[k];
                let x = [(l.from, l.at), (l.to, l.to_at)];
                let [a, b] = [0, 1].map(|i| {
                    let (body, place) = x[i];
                    pose2(&self.moving(moment, body), on[i]) * lift_pose::<Second>(&place)
                });
                let rows = forbidden(l, &(a.inverse() * b), second(moment.t, 1.0, 0.0));
                rows.into_iter().map(|x| [x.value.value, x.value.dot, x.dot.dot]).collect()
            }
            Owner::Contact(k) => {
                let c = &self.contacts[k];
                let ((ground, w0, v0), (body, w1, v1)) =
                    (moving1(&self.moving(moment, c.on), on[0]), moving1(&self.moving(moment, Some(c.body)), on[1]));
                let plane = ground * lift_pose::<First>(&c.plane);
                let shape = body * lift_pose::<First>(&c.centre);
                let p = contact_point(&c.shape, &(plane.rotation.transpose() * shape.rotation));
                let point = shape.position + plane.rotation * p;
                let speed =
                    |x: Pose<First>, w: Vector<First>, v: Vector<First>| v + (x.rotation * w).cross(point - x.position);
                let slip = plane.rotation.apply_inverse(speed(body, w1, v1) - speed(ground, w0, v0));
                let height = plane.rotation.apply_inverse(point - plane.position)[2];
                let held = |i: usize| if i == 2 { height.value } else { 0.0 };
                (0..3).map(|i| [held(i), slip[i].value, slip[i].dot]).collect()
            }
            Owner::Edge(k) => {
                let e = &self.edges[k];
                let (x, w, v) = moving1(&self.moving(moment, Some(e.body)), on[1]);
                let point = x.rotation * lift(e.at.position);
                let side = x.rotation * lift(e.at.rotation * e.side);
                let speed = (v + (x.rotation * w).cross(point)).dot(side);
                vec![[0.0, speed.value, speed.dot]]
            }
        }
    }

    fn ends(&self, owner: Owner) -> [Option<usize>; 2] {
        match owner {
            Owner::Link(k) => [self.links[k].from, self.links[k].to],
            Owner::Contact(k) => [self.contacts[k].on, Some(self.contacts[k].body)],
            Owner::Edge(k) => [None, Some(self.edges[k].body)],
        }
    }

    /// Wrench on each body beside those of the constraints: torque about its origin in its axes, force in the world's.
    fn applied(&self, moment: &Moment) -> Vec<[f64; 6]> {
        let n = self.parts.len();
        let mut sum = vec![[0.0; 6]; n];
        let mut push = |body: Option<usize>, point: Vector<f64>, force: Vector<f64>, torque: Vector<f64>| {
            let Some(b) = body else { return };
            let x = moment.bodies[b].pose;
            let torque = x.rotation.apply_inverse((point - x.position).cross(force) + torque);
            for i in 0..3 {
                sum[b][i] += torque[i];
                sum[b][3 + i] += force[i];
            }
        };
        let zero = Vector::zero();
        for (b, p) in self.parts.iter().enumerate() {
            push(Some(b), moment.bodies[b].pose.point(p.centre), Vector(self.gravity) * p.mass, zero);
        }
        for s in &self.springs {
            let (m0, m1) = (self.moving(moment, s.from), self.moving(moment, Some(s.to)));
            let at = |m: &Moving, p: Vector<f64>| (m.pose.point(p), m.v + m.pose.rotation * m.w.cross(p));
            let ((p0, v0), (p1, v1)) = (at(&m0, s.at), at(&m1, s.to_at));
            let along = (p1 - p0).unit();
            let stretch = (p1 - p0).norm() - s.free_length;
            let force = along * (-s.stiffness * stretch - s.damping * along.dot(v1 - v0));
            push(Some(s.to), p1, force, zero);
            push(s.from, p0, -force, zero);
        }
        for p in &self.pushes {
            let x = moment.bodies[p.on].pose;
            let turn = |v: Vector<f64>| if p.own_axes { x.rotation * v } else { v };
            push(Some(p.on), x.point(p.at), turn(p.force), turn(p.torque));
        }
        for l in self.links.iter().filter(|l| l.spring.is_some()) {
            let b = self.moving(moment, l.to).pose * l.to_at;
            let along = b.rotation * l.axis * (-l.spring.unwrap_or(0.0) * moment.q[&l.name][0]);
            let (force, torque) = if l.kind == Kind::Prismatic { (along, zero) } else { (zero, along) };
            push(l.to, b.position, force, torque);
            push(l.from, b.position, -force, -torque);
        }
        sum
    }

    /// All accelerations and multipliers at a state.
    pub fn solve(&self, moment: &Moment) -> Solution {
        let n = self.parts.len();
        let links = (0..self.links.len()).map(Owner::Link);
        let contacts = (0..self.contacts.len()).map(Owner::Contact);
        let owners: Vec<Owner> = links.chain(contacts).chain((0..self.edges.len()).map(Owner::Edge)).collect();
        // columns of the world come last
        let (mut rows, mut constants, mut violation) = (Vec::new(), Vec::new(), 0.0_f64);
        for owner in owners {
            let rest = self.rows(moment, owner, [[0.0; 6]; 2]);
            let mut own: Vec<DVector<f64>> = rest.iter().map(|_| DVector::zeros(6 * n + 6)).collect();
            for (end, body) in self.ends(owner).into_iter().enumerate() {
                for k in 0..6 {
                    let mut on = [[0.0; 6]; 2];
                    on[end][k] = 1.0;
                    for (row, (with, without)) in own.iter_mut().zip(self.rows(moment, owner, on).iter().zip(&rest)) {
                        row[6 * body.unwrap_or(n) + k] += with[2] - without[2];
                    }
                }
            }
            for (row, r) in own.into_iter().zip(rest) {
                violation = violation.max(r[0].abs()).max(r[1].abs());
                rows.push((owner, row));
                constants.push(r[2]);
            }
        }
        let c = rows.len();
        let mut kkt = DMatrix::zeros(6 * n + c, 6 * n + c);
        let mut right = DVector::zeros(6 * n + c);
        let applied = self.applied(moment);
        for (b, (p, m)) in self.parts.iter().zip(&moment.bodies).enumerate() {
            let o = 6 * b;
            let (r, w) = (m.pose.rotation, m.w);
            let arm = cross_matrix(p.centre);
            let tensor = headland_spatial::Inertia::new(p.mass, p.centre, p.tensor).tensor_about(Vector::zero());
            let coupling = (arm * r.transpose()).0;
            for i in 0..3 {
                kkt[(o + 3 + i, o + 3 + i)] = p.mass;
                for j in 0..3 {
                    kkt[(o + i, o + j)] = tensor.get(i, j);
                    kkt[(o + i, o + 3 + j)] = p.mass * coupling[i][j];
                    kkt[(o + 3 + j, o + i)] = p.mass * coupling[i][j];
                }
            }
            let gyroscopic = w.cross(tensor * w);
            let central = r * w.cross(w.cross(p.centre)) * p.mass;
            for i in 0..3 {
                right[o + i] = applied[b][i] - gyroscopic[i];
                right[o + 3 + i] = applied[b][3 + i] - central[i];
            }
        }
        for (i, ((_, row), constant)) in rows.iter().zip(&constants).enumerate() {
            for j in 0..6 * n {
                kkt[(6 * n + i, j)] = row[j];
                kkt[(j, 6 * n + i)] = -row[j];
            }
            right[6 * n + i] = -constant;
        }
        let svd = kkt.svd(true, true);
        let largest = svd.singular_values.max();
        let unique = svd.singular_values.min() > 1e-9 * largest;
        let solution = svd.solve(&right, 1e-11 * largest).unwrap_or_else(|e| panic!("{e}"));
        let accelerations = (0..n).map(|b| std::array::from_fn(|k| solution[6 * b + k])).collect();
        Solution { accelerations, multipliers: solution.rows(6 * n, c).into_owned(), rows, unique, violation }
    }
}

impl Solution {
    /// Wrench of an owner on its second end: torque about the body's origin in its axes, force in the world's.
    fn wrench(&self, machine: &Machine, owner: Owner) -> (Vector<f64>, Vector<f64>) {
        let n = machine.parts.len();
        let at = 6 * machine.ends(owner)[1].unwrap_or(n);
        let mut sum = [0.0; 6];
        for ((of, row), lambda) in self.rows.iter().zip(self.multipliers.iter()) {
            if *of == owner {
                (0..6).for_each(|k| sum[k] += row[at + k] * lambda);
            }
        }
        (Vector([sum[0], sum[1], sum[2]]), Vector([sum[3], sum[4], sum[5]]))
    }

    /// Force and torque of a joint on `to`, in the axes of its frame there, with that of the spring on its coordinate.
    pub fn reaction(&self, machine: &Machine, moment: &Moment, k: usize) -> [f64; 6] {
        let l = &machine.links[k];
        let (torque, force) = self.wrench(machine, Owner::Link(k));
        let force = machine.moving(moment, l.to).pose.rotation.apply_inverse(force);
        let torque = torque - l.to_at.position.cross(force);
        let turn = |v: Vector<f64>| l.to_at.rotation.apply_inverse(v);
        let (mut force, mut torque) = (turn(force), turn(torque));
        if let Some(c) = l.spring {
            let along = l.axis * (-c * moment.q[&l.name][0]);
            let of = if l.kind == Kind::Prismatic { &mut force } else { &mut torque };
            *of = *of + along;
        }
        [force[0], force[1], force[2], torque[0], torque[1], torque[2]]
    }

    /// Multipliers of an owner's rows: of a contact, the force on what rolls in the plane's axes.
    pub fn multipliers(&self, owner: Owner) -> Vec<f64> {
        let of = self.rows.iter().zip(self.multipliers.iter()).filter(|((o, _), _)| *o == owner);
        of.map(|(_, lambda)| *lambda).collect()
    }
}

/// Coordinates, poses, velocities and accelerations belong together: `X_WA X_AB(q) = X_WB` to second order in time.
pub fn check_kinematics(machine: &Machine, moment: &Moment) {
    for l in &machine.links {
        let given: Option<Vec<Second>> = match l.drive {
            Some(_) => Some(driven(l, second(moment.t, 1.0, 0.0))),
            None => {
                let of = |name: &String| moment.q.get(name).map(|[x, v, a]| second(*x, *v, *a));
                coordinates(l).iter().map(of).collect()
            }
        };
        let Some(q) = given else { continue }; // closes a loop
        let at = |body: Option<usize>, place: &Pose<f64>| {
            let m = machine.moving(moment, body);
            let (e, a) = (m.w_rate, m.a);
            pose2(&m, [e[0], e[1], e[2], a[0], a[1], a[2]]) * lift_pose::<Second>(place)
        };
        let (a, b) = (at(l.from, &l.at) * joint_pose(l, &q), at(l.to, &l.to_at));
        let mut pairs = Vec::new();
        for i in 0..3 {
            pairs.push((a.position[i], b.position[i]));
            (0..3).for_each(|j| pairs.push((a.rotation.0[i][j], b.rotation.0[i][j])));
        }
        let parts = |x: Second| [x.value.value, x.value.dot, x.dot.dot];
        for order in 0..3 {
            let size =
                pairs.iter().fold(1.0_f64, |s, (x, y)| s.max(parts(*x)[order].abs()).max(parts(*y)[order].abs()));
            for (x, y) in &pairs {
                let (x, y) = (parts(*x)[order], parts(*y)[order]);
                assert!((x - y).abs() <= 1e-10 * size, "{}, {}: rate {order}, {x} {y}", machine.title, l.name);
            }
        }
    }
}

/// Accelerations, and forces where they are asked for and determined, against the oracle. The largest relative errors.
pub fn check(machine: &Machine, moment: &Moment, tolerance: f64) -> (f64, f64) {
    check_kinematics(machine, moment);
    let s = machine.solve(moment);
    assert!(s.violation < 1e-9, "{}: constraints violated by {:e}", machine.title, s.violation);
    let found: Vec<f64> = moment.bodies.iter().flat_map(|m| m.w_rate.0.into_iter().chain(m.a.0)).collect();
    let expected: Vec<f64> = s.accelerations.concat();
    let worst = distance(&found, &expected);
    assert!(worst <= tolerance, "{}: accelerations {worst:e}\n{found:?}\n{expected:?}", machine.title);
    if !machine.forces || !s.unique {
        return (worst, 0.0);
    }
    let (mut found, mut expected, mut names) = (Vec::new(), Vec::new(), Vec::new());
    let mut compare = |name: String, value: f64| {
        found.push(moment.of[&name]);
        expected.push(value);
        names.push(name);
    };
    for (k, l) in machine.links.iter().enumerate().filter(|(_, l)| l.written) {
        for (c, x) in ["fx", "fy", "fz", "tx", "ty", "tz"].iter().zip(s.reaction(machine, moment, k)) {
            compare(format!("{}.{c}", l.name), x);
        }
    }
    for (k, Contact { name, .. }) in machine.contacts.iter().enumerate() {
        for (c, x) in ["fx", "fy", "fz"].iter().zip(s.multipliers(Owner::Contact(k))) {
            compare(format!("{name}.{c}"), x);
        }
    }
    for (k, edge) in machine.edges.iter().enumerate() {
        compare(format!("{}.force", edge.name), s.multipliers(Owner::Edge(k))[0]);
    }
    let forces = distance(&found, &expected);
    if forces > tolerance {
        let lines: Vec<String> =
            names.iter().zip(found.iter().zip(&expected)).map(|(n, (a, b))| format!("{n}: {a} for {b}")).collect();
        panic!("{}: forces {forces:e}\n{}", machine.title, lines.join("\n"));
    }
    (worst, forces)
}

/// Largest difference by the largest size.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().chain(b).fold(1.0_f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| if (x - y).is_nan() { f64::INFINITY } else { m.max((x - y).abs()) })
        / size
}
