//! The recursive algorithms over a model's tree of joints: linear in the number of bodies where sums over pairs are cubic.
//!
//! They serve where nothing binds the joints' velocities. Forces of elements enter as joint forces `τ = Σ Wᵀ P`.

use headland_expr::{Expr, NodeId, Scalar};
use headland_model::tree::{JointTree, LinkMotion};
use headland_model::{ElementKind, Model, RowForm};
use headland_spatial::{Axis, Inertia, Pose, Rotation, Symmetric, Vector};

use crate::direct::MassForm;
use crate::kinematics::Kinematics;
use crate::structures::Structures;
use crate::tree::{Joint, Loads, Tree, Workspace, aba, crba, rnea};

/// A model's tree over some scalar, with where its coordinates and velocities stand.
#[derive(Clone, Debug)]
pub struct ModelTree<S> {
    /// The tree.
    pub tree: Tree<S>,
    /// Acceleration of free fall.
    pub gravity: Vector<S>,
    /// Position of each of the tree's coordinates among the model's.
    pub q: Vec<usize>,
    /// Position of each of the tree's velocities among the quasi-velocities.
    pub u: Vec<usize>,
}

/// The tree, if the recursions apply: the joints' velocities are the quasi-velocities, and the tree has all inertia.
pub fn tree_of<'m>(model: &'m Model, kinematics: &Kinematics) -> Option<&'m JointTree> {
    let tree = model.tree.as_ref()?;
    let bound = model.kinematics.iter().any(|r| matches!(r.form, RowForm::Zero(_)));
    let foreign = model.elements.iter().any(|e| e.kind == ElementKind::Inertia);
    let count: usize = tree.links.iter().map(|l| l.u.len()).sum();
    (!bound && !foreign && count == kinematics.quasi.len()).then_some(tree)
}

/// The tree over a scalar, given what a node becomes.
pub fn map_tree<S: Scalar>(tree: &JointTree, kinematics: &Kinematics, mut of: impl FnMut(NodeId) -> S) -> ModelTree<S> {
    let mut result = Tree::new();
    let (mut q, mut u) = (Vec::new(), Vec::new());
    for link in &tree.links {
        let position = Vector(link.position.map(&mut of));
        let inertia =
            Inertia::new(of(link.mass), Vector(link.centre.map(&mut of)), Symmetric(link.tensor.map(&mut of)));
        let joint = joint(link.motion);
        match &link.rotation {
            None => result.push(link.parent, position, joint, inertia),
            Some(rows) => {
                let rotation = Rotation(rows.map(|row| row.map(&mut of)));
                result.push(link.parent, Pose::new(rotation, position), joint, inertia)
            }
        };
        q.extend(&link.q);
        let place = |v: &usize| kinematics.quasi.iter().position(|u| u.velocity == *v).unwrap_or(usize::MAX);
        u.extend(link.u.iter().map(place));
    }
    let gravity = tree.gravity.map_or(Vector::zero(), |g| Vector(g.map(&mut of)));
    ModelTree { tree: result, gravity, q, u }
}

fn joint<S: Scalar>(motion: LinkMotion) -> Joint<S> {
    let along = |a: &[f64; 3]| {
        Axis::ALL.into_iter().find(|axis| (0..3).all(|i| a[i] == f64::from(u8::from(i == axis.index()))))
    };
    match motion {
        LinkMotion::Fixed => Joint::Fixed,
        LinkMotion::Turn(a) => along(&a).map_or(Joint::RevoluteAbout(Vector::constant(a)), Joint::Revolute),
        LinkMotion::Slide(a) => along(&a).map_or(Joint::PrismaticAlong(Vector::constant(a)), Joint::Prismatic),
        LinkMotion::Ball => Joint::Spherical,
        LinkMotion::Free => Joint::Free,
    }
}

/// `τ = Σ Wᵀ P` of all elements and loads by quasi-velocities; weights are the recursions' own.
pub fn joint_forces<'g>(model: &Model, kinematics: &Kinematics, s: &Structures<'g>) -> Vec<Expr<'g>> {
    let mut tau = vec![Expr::Const(0.0); kinematics.quasi.len()];
    let (first, last) = (model.elements.len(), model.elements.len() + 6 * model.bodies.len());
    for e in (0..s.rate.len()).filter(|e| !(first..last).contains(e)) {
        for (t, w) in tau.iter_mut().zip(&s.w[e]) {
            *t = *t + *w * s.force[e];
        }
    }
    tau
}

/// `M u′ = F` by composite bodies and the recursive Newton-Euler algorithm.
pub fn derive_recursive<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    tree: &JointTree,
    tau: &[Expr<'g>],
) -> MassForm<'g> {
    let graph = &model.graph;
    let t = map_tree(tree, kinematics, |n| graph.expr(n));
    let n = kinematics.quasi.len();
    let mut work = Workspace::new(&t.tree);
    let (q, u) = inputs(model, kinematics, &t);
    let zero = Expr::Const(0.0);
    let mut packed = vec![zero; n * (n + 1) / 2];
    crba(&t.tree, &q, &mut work, &mut packed);
    let mut bias = vec![zero; n];
    rnea(&t.tree, &q, &u, &vec![zero; n], &Loads::gravity(t.gravity), &mut work, &mut bias);
    // from the tree's order into that of the quasi-velocities
    let (mut m, mut f) = (vec![zero; packed.len()], tau.to_vec());
    for i in 0..n {
        f[t.u[i]] = f[t.u[i]] - bias[i];
        for j in 0..=i {
            let (a, b) = (t.u[i].max(t.u[j]), t.u[i].min(t.u[j]));
            m[crate::solve::packed(a, b)] = packed[crate::solve::packed(i, j)];
        }
    }
    MassForm { m, f }
}

/// `u′` by articulated bodies.
pub fn accelerations<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    tree: &JointTree,
    tau: &[Expr<'g>],
) -> Vec<Expr<'g>> {
    let graph = &model.graph;
    let t = map_tree(tree, kinematics, |n| graph.expr(n));
    let n = kinematics.quasi.len();
    let mut work = Workspace::new(&t.tree);
    let (q, u) = inputs(model, kinematics, &t);
    let own: Vec<Expr<'g>> = t.u.iter().map(|&k| tau[k]).collect();
    let mut a = vec![Expr::Const(0.0); n];
    aba(&t.tree, &q, &u, &own, &Loads::gravity(t.gravity), &mut work, &mut a);
    let mut result = vec![Expr::Const(0.0); n];
    for (&k, e) in t.u.iter().zip(a) {
        result[k] = e;
    }
    result
}

#[allow(clippy::type_complexity)]
fn inputs<'g>(model: &'g Model, kinematics: &Kinematics, t: &ModelTree<Expr<'g>>) -> (Vec<Expr<'g>>, Vec<Expr<'g>>) {
    let graph = &model.graph;
    let q = t.q.iter().map(|&i| graph.expr(model.coordinates[i].q)).collect();
    let u = t.u.iter().map(|&k| graph.expr(kinematics.quasi[k].u)).collect();
    (q, u)
}
