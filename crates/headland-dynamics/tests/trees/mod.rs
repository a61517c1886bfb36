//! Random trees of bodies and states of theirs, the same for the same seed.
#![allow(non_snake_case, dead_code)]

use headland_dynamics::tree::{Joint, Loads, Mount, Tree, Workspace, rnea};
use headland_spatial::{Axis, Inertia, Pose, Quaternion, Rotation, Vector, Wrench};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// Uniform on (−1, 1).
    pub fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    pub fn numbers(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.number()).collect()
    }
    pub fn vector(&mut self) -> Vector<f64> {
        Vector(std::array::from_fn(|_| self.number()))
    }
    pub fn rotation(&mut self) -> Rotation<f64> {
        Quaternion::new(1.0, self.vector() * 1.5).rotation()
    }
    pub fn pose(&mut self) -> Pose<f64> {
        Pose::new(self.rotation(), self.vector())
    }
    pub fn wrench(&mut self) -> Wrench<f64> {
        Wrench::new(self.vector(), self.vector())
    }
    /// Of four points of mass: a full tensor.
    pub fn inertia(&mut self) -> Inertia<f64> {
        let mut point = || Inertia::point(1.0 + 0.9 * self.number(), self.vector());
        point() + point() + point() + point()
    }
    pub fn joint(&mut self) -> Joint<f64> {
        let axis = Axis::ALL[self.below(3)];
        match self.below(12) {
            0 => Joint::Fixed,
            1 | 2 => Joint::Prismatic(axis),
            3 => Joint::RevoluteAbout(self.vector().unit()),
            4 => Joint::PrismaticAlong(self.vector().unit()),
            5 => Joint::Helical { axis, pitch: 0.3 },
            6 => Joint::Spherical,
            7 => Joint::Planar,
            8 => Joint::Free,
            _ => Joint::Revolute(axis),
        }
    }
    pub fn mount(&mut self) -> Mount<f64> {
        if self.below(2) == 0 { Mount::At(self.vector()) } else { Mount::Pose(self.pose()) }
    }

    /// `n` bodies with random joints, each hung from a random earlier one, now and then from the world.
    pub fn tree(&mut self, n: usize) -> Tree<f64> {
        let mut tree = Tree::new();
        for b in 0..n {
            let parent = if b == 0 || self.below(8) == 0 { None } else { Some(self.below(b)) };
            let (mount, joint, inertia) = (self.mount(), self.joint(), self.inertia());
            tree.push(parent, mount, joint, inertia);
        }
        tree
    }

    /// A state with loads on everything.
    pub fn state(&mut self, tree: &Tree<f64>) -> State {
        let q = tree.neutral().into_iter().map(|x| x + 0.8 * self.number()).collect();
        let (u, tau) = (self.numbers(tree.nu()), self.numbers(tree.nu()));
        let wrenches = (0..tree.len()).map(|_| self.wrench()).collect();
        State { q, u, tau, gravity: self.vector() * 9.0, wrenches }
    }
}

/// Where, how fast, under what.
pub struct State {
    pub q: Vec<f64>,
    pub u: Vec<f64>,
    pub tau: Vec<f64>,
    pub gravity: Vector<f64>,
    pub wrenches: Vec<Wrench<f64>>,
}

impl State {
    pub fn loads(&self) -> Loads<'_, f64> {
        Loads { gravity: self.gravity, wrenches: &self.wrenches }
    }
}

/// Accelerations.
pub fn aba(tree: &Tree<f64>, s: &State) -> Vec<f64> {
    let mut a = vec![0.0; tree.nu()];
    headland_dynamics::tree::aba(tree, &s.q, &s.u, &s.tau, &s.loads(), &mut Workspace::new(tree), &mut a);
    a
}

/// `h(q, u)`.
pub fn bias(tree: &Tree<f64>, s: &State) -> Vec<f64> {
    let (zero, mut h) = (vec![0.0; tree.nu()], vec![0.0; tree.nu()]);
    rnea(tree, &s.q, &s.u, &zero, &s.loads(), &mut Workspace::new(tree), &mut h);
    h
}

/// The mass matrix, packed.
pub fn mass(tree: &Tree<f64>, q: &[f64]) -> Vec<f64> {
    let nu = tree.nu();
    let mut m = vec![0.0; nu * (nu + 1) / 2];
    headland_dynamics::tree::crba(tree, q, &mut Workspace::new(tree), &mut m);
    m
}

#[track_caller]
pub fn near(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    let size = a.iter().chain(b).fold(1.0, |m: f64, x| m.max(x.abs()));
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        assert!((x - y).abs() <= tolerance * size, "entry {i}: {x} {y}, relative {:.1e}", (x - y).abs() / size);
    }
}
