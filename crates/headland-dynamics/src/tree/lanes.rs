//! [`LaneJacobian`]: Jacobians of the accelerations by dual numbers.

use headland_code::Lanes;
use headland_expr::Scalar;
use headland_spatial::{Vector, Wrench};

use super::bodies::Tree;
use super::derivative::Jacobians;
use super::tangent::Tangent;
use super::workspace::{Loads, Workspace};

/// Jacobians of [`aba`](super::aba()) by dual numbers, as many directions at a time as `L` has lanes.
///
/// Slower than [`aba_jacobian`](super::aba_jacobian) but independent of it: nothing is differentiated by hand.
#[derive(Clone, Debug)]
pub struct LaneJacobian<L> {
    tree: Tree<Tangent<L>>,
    work: Workspace<Tangent<L>>,
    /// q, u, τ.
    inputs: Vec<Tangent<L>>,
    wrenches: Vec<Wrench<Tangent<L>>>,
    acceleration: Vec<Tangent<L>>,
}

impl<L: Lanes> LaneJacobian<L> {
    /// For one tree.
    pub fn new(tree: &Tree<f64>) -> Self {
        let tree = tree.map(Tangent::constant);
        let (zero, work) = (Tangent::constant(0.0), Workspace::new(&tree));
        let inputs = vec![zero; tree.nq() + 2 * tree.nu()];
        Self { work, inputs, wrenches: Vec::with_capacity(tree.len()), acceleration: vec![zero; tree.nu()], tree }
    }

    /// Jacobians at a state.
    ///
    /// # Panics
    /// If a length is wrong.
    pub fn eval(&mut self, q: &[f64], u: &[f64], tau: &[f64], loads: &Loads<'_, f64>, jacobians: &mut Jacobians<f64>) {
        let (nq, nu) = (self.tree.nq(), self.tree.nu());
        let lift = |v: Vector<f64>| v.map(Tangent::constant);
        self.wrenches.clear();
        self.wrenches.extend(loads.wrenches.iter().map(|f| Wrench::new(lift(f.torque), lift(f.force))));
        let loads = Loads { gravity: lift(loads.gravity), wrenches: &self.wrenches };
        for start in (0..nq + 2 * nu).step_by(L::WIDTH) {
            for (i, x) in q.iter().chain(u).chain(tau).enumerate() {
                let mut seed = [0.0; 16];
                if let Some(lane) = i.checked_sub(start).filter(|lane| *lane < L::WIDTH) {
                    seed[lane] = 1.0;
                }
                self.inputs[i] = Tangent::new(*x, L::load(&seed));
            }
            let (q, rest) = self.inputs.split_at(nq);
            let (u, tau) = rest.split_at(nu);
            super::aba::aba(&self.tree, q, u, tau, &loads, &mut self.work, &mut self.acceleration);
            for (row, a) in self.acceleration.iter().enumerate() {
                let mut dot = [0.0; 16];
                a.dot.store(&mut dot);
                for (i, x) in (start..nq + 2 * nu).zip(&dot[..L::WIDTH]) {
                    match i {
                        _ if i < nq => jacobians.by_q[row * nq + i] = *x,
                        _ if i < nq + nu => jacobians.by_u[row * nu + i - nq] = *x,
                        _ => jacobians.by_tau[row * nu + i - nq - nu] = *x,
                    }
                }
            }
        }
    }
}
