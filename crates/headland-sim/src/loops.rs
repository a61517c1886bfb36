//! [`Loops`]: the right-hand side of a tree by loops over its bodies instead of straight-line code.
//!
//! The articulated-body recursion over numbers costs a tenth of a microsecond a body; the same recursion as a tape of
//! operations several times that, from four bodies on.

use headland_dynamics::recursive::{ModelTree, map_tree, tree_of};
use headland_dynamics::tree::{Loads, Workspace, aba};
use headland_dynamics::{Equations, Kinematics};
use headland_expr::NodeId;
use headland_model::Model;

/// Least number of quasi-velocities for which loops are taken.
const LEAST: usize = 4;

/// A model's tree with its numbers.
#[derive(Clone, Debug)]
pub struct Loops {
    tree: ModelTree<f64>,
    /// Joint forces `Σ Wᵀ P` of elements and loads, in the order of the quasi-velocities; over the model's graph.
    pub forces: Vec<NodeId>,
}

/// One thread's scratch.
#[derive(Clone, Debug)]
pub struct LoopScratch {
    work: Workspace<f64>,
    q: Vec<f64>,
    u: Vec<f64>,
    tau: Vec<f64>,
    a: Vec<f64>,
}

impl Loops {
    /// The loops of a model, if its equations came from a tree and it is large enough.
    pub fn new(model: &Model, equations: &Equations, kinematics: &Kinematics) -> Option<Self> {
        let forces = equations.joint_forces.clone().filter(|f| f.len() >= LEAST)?;
        let tree = tree_of(model, kinematics)?;
        let inputs = model.inputs();
        let tree = map_tree(tree, kinematics, |node| model.graph.eval(&[node], &inputs)[0]);
        Some(Self { tree, forces })
    }

    /// Scratch for one thread.
    pub fn scratch(&self) -> LoopScratch {
        let (nq, nu) = (self.tree.q.len(), self.tree.u.len());
        LoopScratch {
            work: Workspace::new(&self.tree.tree),
            q: vec![0.0; nq],
            u: vec![0.0; nu],
            tau: vec![0.0; nu],
            a: vec![0.0; nu],
        }
    }

    /// `u′` at `y = [q, u]` under joint forces in the order of the quasi-velocities.
    pub fn accelerations(&self, s: &mut LoopScratch, y: &[f64], nq: usize, forces: &[f64], out: &mut [f64]) {
        for (slot, &i) in s.q.iter_mut().zip(&self.tree.q) {
            *slot = y[i];
        }
        for ((u, tau), &k) in s.u.iter_mut().zip(&mut s.tau).zip(&self.tree.u) {
            (*u, *tau) = (y[nq + k], forces[k]);
        }
        let loads = Loads::gravity(self.tree.gravity);
        aba(&self.tree.tree, &s.q, &s.u, &s.tau, &loads, &mut s.work, &mut s.a);
        for (&k, a) in self.tree.u.iter().zip(&s.a) {
            out[k] = *a;
        }
    }
}
