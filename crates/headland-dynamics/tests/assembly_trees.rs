//! Scenes of bodies and joints against the recursions of `tree`, built from the same data by another way.
#![allow(non_snake_case)]

mod machine;

use headland_dynamics::tree::{Joint, Loads, Mount, Tree, Workspace, aba, crba, rnea};
use headland_dynamics::{Algorithm, DeriveError, DeriveOptions};
use headland_spatial::{Inertia, Pose, Quaternion, Rotation, Symmetric, Vector};
use machine::oracle::check;
use machine::state::Derived;
use machine::{Kind, Link, Machine, PLAIN, Random, coordinates};
use nalgebra::{DMatrix, DVector};

/// Where a coordinate or quasi-velocity of the tree comes from.
enum Source {
    /// The scene's `name` or `name'`.
    Same(String),
    /// Three angular velocities and a quaternion of a ball that is walked from `to` to `from`.
    Reversed([String; 4], [String; 3]),
    /// A ball's as it is.
    Ball([String; 4], [String; 3]),
}

/// The machine as a tree of `tree`, with what its coordinates are.
struct Twin {
    tree: Tree<f64>,
    sources: Vec<Source>,
}

fn massless() -> Inertia<f64> {
    Inertia::new(0.0, Vector::zero(), Symmetric::zero())
}

fn align(axis: Vector<f64>) -> Pose<f64> {
    let k = (0..3).min_by(|&i, &j| axis[i].abs().total_cmp(&axis[j].abs())).unwrap_or(0);
    let x = axis.cross(Vector(std::array::from_fn(|i| f64::from(u8::from(i == k))))).unit();
    let y = axis.cross(x);
    Pose::new(Rotation(std::array::from_fn(|i| [x[i], y[i], axis[i]])), Vector::zero())
}

/// A simple joint, where it stands behind the one before, and its coordinates.
type Step = (Pose<f64>, Joint<f64>, Source);

/// The joint as simple ones in a row, from parent to child, and what is fixed behind the last.
fn chain(l: &Link, reversed: bool) -> (Vec<Step>, Pose<f64>) {
    let name = |part: &str| Source::Same(if part.is_empty() { l.name.clone() } else { format!("{}.{part}", l.name) });
    let sign = if reversed { -1.0 } else { 1.0 };
    let none = Pose::identity();
    let (mut before, mut behind) = (none, none);
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|v| Vector(v) * sign);
    let axis = l.axis * sign;
    let ball = || {
        let q = ["qw", "qx", "qy", "qz"].map(|p| format!("{}.{p}", l.name));
        let w = ["wx", "wy", "wz"].map(|p| format!("{}.{p}", l.name));
        if reversed { Source::Reversed(q, w) } else { Source::Ball(q, w) }
    };
    let turns = |list: &mut Vec<(Joint<f64>, Source)>| match l.rpy {
        true => list.extend([
            (Joint::RevoluteAbout(z), name("yaw")),
            (Joint::RevoluteAbout(y), name("pitch")),
            (Joint::RevoluteAbout(x), name("roll")),
        ]),
        false => list.push((Joint::Spherical, ball())),
    };
    let mut list = Vec::new();
    match l.kind {
        Kind::Weld => list.push((Joint::Fixed, Source::Same(String::new()))),
        Kind::Revolute => list.push((Joint::RevoluteAbout(axis), name(""))),
        Kind::Prismatic => list.push((Joint::PrismaticAlong(axis), name(""))),
        Kind::Screw => {
            (before, behind) = (align(axis), align(axis).inverse());
            let pitch = l.lead / std::f64::consts::TAU;
            list.push((Joint::Helical { axis: headland_spatial::Axis::Z, pitch }, name("")));
        }
        Kind::Cylindrical => {
            list.push((Joint::RevoluteAbout(axis), name("angle")));
            list.push((Joint::PrismaticAlong(axis), name("slide")));
        }
        Kind::Universal => {
            list.push((Joint::RevoluteAbout(x), name("a")));
            list.push((Joint::RevoluteAbout(y), name("b")));
        }
        Kind::Planar => {
            list.push((Joint::PrismaticAlong(x), name("x")));
            list.push((Joint::PrismaticAlong(y), name("y")));
            list.push((Joint::RevoluteAbout(z), name("angle")));
        }
        Kind::Spherical => turns(&mut list),
        Kind::Free => {
            for (axis, part) in [(x, "x"), (y, "y"), (z, "z")] {
                list.push((Joint::PrismaticAlong(axis), name(part)));
            }
            turns(&mut list);
        }
    }
    if reversed {
        list.reverse();
    }
    let joints = list.into_iter().map(|(j, s)| (std::mem::replace(&mut before, none), j, s)).collect();
    (joints, behind)
}

impl Twin {
    fn new(m: &Machine) -> Self {
        let (mut tree, mut sources) = (Tree::new(), Vec::new());
        // index in the tree, and the pose of the body's frame on the tree's
        let mut placed: Vec<Option<(usize, Pose<f64>)>> = vec![None; m.parts.len()];
        for (b, p) in m.parts.iter().enumerate() {
            let l = m.links.iter().find(|l| l.from.max(l.to) == Some(b)).unwrap_or_else(|| panic!("{b}"));
            let reversed = l.from == Some(b);
            let (parent, near, far) = if reversed { (l.to, l.to_at, l.at) } else { (l.from, l.at, l.to_at) };
            let (joints, behind) = chain(l, reversed);
            let (mut parent, mut mount) = match parent.and_then(|p| placed[p]) {
                Some((index, on)) => (Some(index), on * near),
                None => (None, near),
            };
            let own = behind * far.inverse(); // the body's frame on the last joint's
            let count = joints.len();
            for (i, (before, joint, source)) in joints.into_iter().enumerate() {
                let inertia = match i + 1 == count {
                    true => Inertia::new(p.mass, p.centre, p.tensor).out_of_frame(&own),
                    false => massless(),
                };
                parent = Some(tree.push(parent, Mount::Pose(mount * before), joint, inertia));
                mount = Pose::identity();
                sources.push(source);
            }
            placed[b] = parent.map(|index| (index, own));
        }
        Self { tree, sources }
    }

    /// Coordinates of the tree, and `T` of `u_tree = T u`, by the coordinates and the names of the quasi-velocities.
    fn at(&self, q: &dyn Fn(&str) -> f64, quasi: &[String]) -> (Vec<f64>, DMatrix<f64>) {
        let (mut place, mut t) = (Vec::new(), DMatrix::zeros(self.tree.nu(), quasi.len()));
        let column = |name: &str| quasi.iter().position(|u| u == name).unwrap_or_else(|| panic!("{name} in {quasi:?}"));
        let mut row = 0;
        for (source, body) in self.sources.iter().zip(self.tree.bodies()) {
            match source {
                Source::Same(name) if body.joint.nu() == 1 => {
                    place.push(q(name));
                    t[(row, column(&format!("{name}'")))] = 1.0;
                    row += 1;
                }
                Source::Same(_) => {}
                Source::Ball(names, rates) | Source::Reversed(names, rates) => {
                    let mut turn = Quaternion([0, 1, 2, 3].map(|i| q(&names[i])));
                    turn = Quaternion(turn.0.map(|x| x / turn.norm()));
                    let reversed = matches!(source, Source::Reversed(..));
                    let r =
                        if reversed { turn.rotation().0.map(|row| row.map(|x| -x)) } else { Rotation::identity().0 };
                    place.extend(if reversed { turn.conjugate().0 } else { turn.0 });
                    for i in 0..3 {
                        for (j, name) in rates.iter().enumerate() {
                            t[(row + i, column(name))] = r[i][j];
                        }
                    }
                    row += 3;
                }
            }
        }
        (place, t)
    }
}

/// Backward errors of M, of F, and of `M u' = F` with the accelerations of the recursion, at random states.
fn compare(m: &Machine, d: &Derived, r: &mut Random, states: usize) -> f64 {
    let twin = Twin::new(m);
    let quasi: Vec<String> = d.equations.kinematics.quasi.iter().map(|u| u.name.clone()).collect();
    assert_eq!(quasi.len(), twin.tree.nu());
    let mut worst = 0.0_f64;
    for _ in 0..states {
        let mut x = d.state(r, 0.8);
        normalize(m, d, &mut x);
        let value = |name: &str| {
            let c = d.model.coordinates.iter().find(|c| c.name == name).unwrap_or_else(|| panic!("{name}"));
            x[d.model.input_index(c.q)]
        };
        let (q, t) = twin.at(&value, &quasi);
        let u = DVector::from_iterator(
            quasi.len(),
            d.equations.kinematics.quasi.iter().map(|u| x[d.model.input_index(u.u)]),
        );
        let u_tree = &t * &u;
        let (n, mut work) = (twin.tree.nu(), Workspace::new(&twin.tree));
        let loads = Loads::gravity(Vector(m.gravity));
        let (mut packed, mut h, mut a) = (vec![0.0; n * (n + 1) / 2], vec![0.0; n], vec![0.0; n]);
        crba(&twin.tree, &q, &mut work, &mut packed);
        rnea(&twin.tree, &q, u_tree.as_slice(), &vec![0.0; n], &loads, &mut work, &mut h);
        aba(&twin.tree, &q, u_tree.as_slice(), &vec![0.0; n], &loads, &mut work, &mut a);
        // u_tree' = T u' without more: T of a reversed ball is -R, and (R w)' = R w'
        let unpack = |p: &[f64]| DMatrix::from_fn(n, n, |i, j| p[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)]);
        let expected = t.transpose() * unpack(&packed) * &t;
        let force = -(t.transpose() * DVector::from_vec(h));
        let a = t.transpose() * DVector::from_vec(a); // T is orthogonal
        let mass = unpack(&d.model.graph.eval(&d.equations.mass, &x));
        let f = DVector::from_vec(d.model.graph.eval(&d.equations.force, &x));
        let size = mass.amax();
        assert!((&mass - &expected).amax() <= 1e-12 * size, "M: {:e}", (&mass - &expected).amax() / size);
        let size = (mass.abs() * u.abs()).amax() + f.amax();
        assert!((&f - &force).amax() <= 1e-12 * size, "F: {:e}", (&f - &force).amax() / size);
        let error = (&mass * &a - &f).amax() / ((mass.abs() * a.abs()).amax() + f.amax());
        assert!(error <= 1e-12, "M u' = F: {error:e}");
        worst = worst.max(error);
    }
    worst
}

/// The rotation of a quaternion that is not of length one is none; a run keeps the length.
fn normalize(m: &Machine, d: &Derived, x: &mut [f64]) {
    for l in &m.links {
        let names: Vec<String> = coordinates(l).into_iter().filter(|n| n.contains(".q")).collect();
        let slot = |n: &String| d.model.coordinates.iter().find(|c| c.name == *n).map(|c| d.model.input_index(c.q));
        let slots: Vec<usize> = names.iter().filter_map(slot).collect();
        let length = slots.iter().map(|s| x[*s] * x[*s]).sum::<f64>().sqrt();
        slots.iter().for_each(|s| x[*s] /= length);
    }
}

#[test]
fn trees_agree_with_the_recursions() {
    let mut worst = 0.0_f64;
    for seed in 0..40 {
        let mut r = Random(1000 + seed);
        let n = 1 + r.below(8);
        let m = Machine::tree(&mut r, n);
        if m.links.iter().all(|l| l.kind == Kind::Weld) {
            continue;
        }
        for algorithm in [Algorithm::Direct, Algorithm::Combine] {
            let options = DeriveOptions { algorithm, compare: false, ..DeriveOptions::default() };
            let text = m.text(&PLAIN);
            let model = machine::state::read(&text).build().unwrap_or_else(|e| panic!("{e}\n{text}"));
            if let Err(DeriveError::CombineDoesNotApply { .. }) = headland_dynamics::derive(&model, &options) {
                continue;
            }
            let d = Derived::with(&m, &PLAIN, &options);
            worst = worst.max(compare(&m, &d, &mut r, 3));
        }
    }
    println!("worst backward error {worst:e}");
}

#[test]
fn thirty_bodies_agree_with_the_recursions() {
    let mut worst = 0.0_f64;
    for seed in 0..2 {
        let mut r = Random(77 + seed);
        let m = Machine::tree(&mut r, 30);
        let options = DeriveOptions { algorithm: Algorithm::Direct, compare: false, unroll: 0 };
        let d = Derived::with(&m, &PLAIN, &options);
        worst = worst.max(compare(&m, &d, &mut r, 2));
    }
    println!("worst backward error {worst:e}");
}

/// Every kind alone and reversed, with frames on frames, turned by angles or not.
#[test]
fn every_kind_alone() {
    for kind in Kind::ALL {
        for variant in 0..16 {
            let mut r = Random(10 * variant + kind as u64);
            let mut m = Machine::new(&format!("{kind:?} {variant}"));
            m.gravity = r.vector().0;
            m.parts = vec![machine::part(&mut r, "base"), machine::part(&mut r, "end")];
            m.links.push(machine::random_link(&mut r, "first", Kind::Revolute, None, Some(0)));
            let (from, to) = if variant % 2 == 0 { (Some(0), Some(1)) } else { (Some(1), Some(0)) };
            let mut l = machine::random_link(&mut r, "second", kind, from, to);
            l.rpy = variant / 2 % 2 == 0;
            m.links.push(l);
            let d = Derived::new(&m, &PLAIN);
            compare(&m, &d, &mut r, 2);
            let mut x = d.state(&mut r, 0.5);
            normalize(&m, &d, &mut x);
            let moment = d.moment(&mut x);
            check(&m, &moment, 1e-10);
        }
    }
}

/// Two ways of the test itself agree: the recursions and the oracle of Newton and Euler.
#[test]
fn trees_agree_with_newton_and_euler() {
    let mut worst = (0.0_f64, 0.0_f64);
    for seed in 0..12 {
        let mut r = Random(300 + seed);
        let n = 1 + r.below(5);
        let mut m = Machine::tree(&mut r, n);
        if m.links.iter().all(|l| l.kind == Kind::Weld) {
            continue;
        }
        m.forces = true;
        let d = Derived::new(&m, &PLAIN);
        let mut x = d.state(&mut r, 0.5);
        normalize(&m, &d, &mut x);
        let moment = d.moment(&mut x);
        let (a, f) = check(&m, &moment, 1e-10);
        worst = (worst.0.max(a), worst.1.max(f));
    }
    println!("worst relative errors: accelerations {:e}, forces {:e}", worst.0, worst.1);
}
