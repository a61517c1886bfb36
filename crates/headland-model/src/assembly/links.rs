//! The tree of links beside the motions: what the recursive algorithms read.

use headland_expr::Expr;
use headland_spatial::{Inertia, Pose, Symmetric, Vector};

use super::motion::Step;
use super::number;
use crate::build::Builder;
use crate::tree::{JointTree, Link, LinkMotion};

/// Links so far, and the link and pose of each frame that is a body.
#[derive(Default)]
pub(crate) struct Links<'g> {
    tree: JointTree,
    of_body: Vec<(usize, Option<usize>, Pose<Expr<'g>>)>,
    /// True where a joint is none that the recursions know.
    foreign: bool,
}

impl<'g> Builder<'_, 'g> {
    /// Hangs the body `far` from the body `near` by the steps of a joint.
    pub(super) fn hang(
        &mut self,
        near: usize,
        near_pose: &Pose<Expr<'g>>,
        steps: &[Step<'g>],
        far: usize,
        far_pose: &Pose<Expr<'g>>,
    ) {
        let known = self.assembly.links.of_body.iter().find(|(body, ..)| *body == near);
        let (parent, pose) = known.map_or((None, Pose::identity()), |(_, link, pose)| (*link, *pose));
        let mut mount = pose * *near_pose;
        let mut parent = parent;
        let Some(motions) = self.link_motions(steps) else {
            self.assembly.links.foreign = true;
            return;
        };
        for (motion, q, u) in motions {
            let graph = self.low.graph;
            let ids = |v: Vector<Expr<'g>>| v.0.map(|e| graph.id(e));
            let parallel = (0..3).all(|i| (0..3).all(|k| mount.rotation.0[i][k].is(f64::from(u8::from(i == k)))));
            let zero = graph.id(number(0.0));
            self.assembly.links.tree.links.push(Link {
                parent,
                rotation: (!parallel).then(|| mount.rotation.0.map(|row| ids(Vector(row)))),
                position: ids(mount.position),
                motion,
                q,
                u,
                mass: zero,
                centre: [zero; 3],
                tensor: [zero; 6],
            });
            parent = Some(self.assembly.links.tree.links.len() - 1);
            mount = Pose::identity();
        }
        self.assembly.links.of_body.push((far, parent, *far_pose));
    }

    /// Motions of single links, with coordinates and velocities; `None` if there is one that the recursions do not know.
    #[allow(clippy::type_complexity)]
    fn link_motions(&self, steps: &[Step<'g>]) -> Option<Vec<(LinkMotion, Vec<usize>, Vec<usize>)>> {
        let nq = self.low.coordinates.len();
        let constant = |axis: &Vector<Expr<'g>>, sign: f64| -> Option<[f64; 3]> {
            let [x, y, z] = axis.0.map(|e| e.value());
            Some([sign * x?, sign * y?, sign * z?])
        };
        let ball = |of: ([usize; 4], [usize; 3])| (of.0.to_vec(), of.1.iter().map(|k| nq + k).collect::<Vec<_>>());
        if let [Step::Slide(_, x), Step::Slide(_, y), Step::Slide(_, z), Step::Ball(b)] = steps {
            let ([x, y, z], of) = ([x.of?, y.of?, z.of?], b.of?);
            let (quaternion, spin) = ball(of);
            let q = [x.0, y.0, z.0].into_iter().chain(quaternion).collect();
            return Some(vec![(LinkMotion::Free, q, spin.into_iter().chain([x.0, y.0, z.0]).collect())]);
        }
        if steps.is_empty() {
            return Some(vec![(LinkMotion::Fixed, Vec::new(), Vec::new())]);
        }
        let one = |step: &Step<'g>| match step {
            Step::Turn(axis, d) => {
                d.of.and_then(|(i, sign)| Some((LinkMotion::Turn(constant(axis, sign)?), vec![i], vec![i])))
            }
            Step::Slide(axis, d) => {
                d.of.and_then(|(i, sign)| Some((LinkMotion::Slide(constant(axis, sign)?), vec![i], vec![i])))
            }
            Step::Ball(b) => b.of.map(|of| {
                let (q, u) = ball(of);
                (LinkMotion::Ball, q, u)
            }),
        };
        steps.iter().map(one).collect()
    }

    /// Gives the link of a body its inertia.
    pub(super) fn link_inertia(
        &mut self,
        body: usize,
        mass: Expr<'g>,
        centre: Vector<Expr<'g>>,
        tensor: Symmetric<Expr<'g>>,
    ) {
        let found = self.assembly.links.of_body.iter().find(|(b, ..)| *b == body);
        let Some((_, Some(link), pose)) = found.copied() else { return };
        let there = Inertia::new(mass, centre, tensor).out_of_frame(&pose);
        let graph = self.low.graph;
        let link = &mut self.assembly.links.tree.links[link];
        link.mass = graph.id(there.mass);
        link.centre = there.centre.0.map(|e| graph.id(e));
        link.tensor = there.tensor.0.map(|e| graph.id(e));
    }

    /// The tree, if it is all there is of inertia and all joints are known.
    pub(crate) fn joint_tree(&mut self) -> Option<JointTree> {
        let links = std::mem::take(&mut self.assembly.links);
        let only = self.scene.section_elements("inertia").is_empty() && self.scene.section("coordinates").is_empty();
        let gravity = self.world_gravity().0.map(|e| self.low.graph.id(e));
        let there = !links.foreign && only && !links.tree.links.is_empty();
        there.then_some(JointTree { gravity: Some(gravity), ..links.tree })
    }
}
