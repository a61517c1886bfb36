//! Jacobians of trees: by recursion, by dual numbers, by symbols.
#![allow(non_snake_case)]

mod trees;

use headland_code::{Lanes, Lanes4, Lanes8};
use headland_dynamics::tree::{
    JacobianWorkspace, Jacobians, LaneJacobian, Loads, Tree, Workspace, aba_jacobian, rnea, rnea_jacobian,
};
use headland_expr::{Dual, Expr, Graph, Scalar};
use headland_spatial::{Vector, Wrench};
use trees::{Random, State, aba, near};

fn recursive(tree: &Tree<f64>, s: &State) -> (Vec<f64>, Jacobians<f64>) {
    let (mut a, mut jacobians) = (vec![0.0; tree.nu()], Jacobians::new(tree));
    let mut work = JacobianWorkspace::new(tree);
    aba_jacobian(tree, &s.q, &s.u, &s.tau, &s.loads(), &mut work, &mut a, &mut jacobians);
    (a, jacobians)
}

fn by_lanes<L: Lanes>(tree: &Tree<f64>, s: &State) -> Jacobians<f64> {
    let mut jacobians = Jacobians::new(tree);
    LaneJacobian::<L>::new(tree).eval(&s.q, &s.u, &s.tau, &s.loads(), &mut jacobians);
    jacobians
}

fn agree(a: &Jacobians<f64>, b: &Jacobians<f64>, tolerance: f64) {
    near(&a.by_q, &b.by_q, tolerance);
    near(&a.by_u, &b.by_u, tolerance);
    near(&a.by_tau, &b.by_tau, tolerance);
}

#[test]
fn recursion_and_dual_numbers_agree() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let tree = r.tree(8);
        let s = r.state(&tree);
        let (a, jacobians) = recursive(&tree, &s);
        near(&a, &aba(&tree, &s), 1e-14);
        agree(&jacobians, &by_lanes::<Lanes8>(&tree, &s), 1e-10);
        if seed < 10 {
            agree(&by_lanes::<f64>(&tree, &s), &by_lanes::<Lanes4>(&tree, &s), 1e-15);
        }
    }
}

#[test]
fn derivatives_of_forces_are_exact() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let tree = r.tree(10);
        let (s, a, nq, nu) = (r.state(&tree), r.numbers(tree.nu()), tree.nq(), tree.nu());
        let (mut by_q, mut by_u) = (vec![0.0; nu * nq], vec![0.0; nu * nu]);
        let mut work = JacobianWorkspace::new(&tree);
        rnea_jacobian(&tree, &s.q, &s.u, &a, &s.loads(), &mut work, &mut by_q, &mut by_u);
        // along one direction of everything
        let (dq, du) = (r.numbers(nq), r.numbers(nu));
        let along = |x: &[f64], dx: &[f64]| -> Vec<_> { x.iter().zip(dx).map(|(x, d)| Dual::new(*x, *d)).collect() };
        let moving = tree.map(Dual::constant);
        let lift = |v: Vector<f64>| v.map(Dual::constant);
        let wrenches: Vec<_> = s.wrenches.iter().map(|f| Wrench::new(lift(f.torque), lift(f.force))).collect();
        let loads = Loads { gravity: lift(s.gravity), wrenches: &wrenches };
        let mut tau = vec![Dual::constant(0.0); nu];
        let fixed = along(&a, &vec![0.0; nu]);
        rnea(&moving, &along(&s.q, &dq), &along(&s.u, &du), &fixed, &loads, &mut Workspace::new(&moving), &mut tau);
        let sum = |row: &[f64], d: &[f64]| -> f64 { row.iter().zip(d).map(|(x, d)| x * d).sum() };
        let rows = (0..nu).map(|i| sum(&by_q[i * nq..(i + 1) * nq], &dq) + sum(&by_u[i * nu..(i + 1) * nu], &du));
        near(&rows.collect::<Vec<_>>(), &tau.iter().map(|t| t.dot).collect::<Vec<_>>(), 1e-12);
    }
}

#[test]
fn symbolic_jacobians_agree() {
    for seed in 0..10 {
        let mut r = Random(seed);
        let tree = r.tree(4);
        let mut s = r.state(&tree);
        s.wrenches.clear();
        let (nq, nu) = (tree.nq(), tree.nu());
        let graph = Graph::new();
        let inputs: Vec<Expr<'_>> = (0..nq + 2 * nu).map(|i| graph.input(&format!("x{i}"))).collect();
        let (q, rest) = inputs.split_at(nq);
        let (u, tau) = rest.split_at(nu);
        let symbolic = tree.map(Expr::constant);
        let loads = Loads::gravity(s.gravity.map(Expr::constant));
        let (mut a, mut recursion) = (vec![Expr::Const(0.0); nu], Jacobians::new(&symbolic));
        let mut work = JacobianWorkspace::new(&symbolic);
        aba_jacobian(&symbolic, q, u, tau, &loads, &mut work, &mut a, &mut recursion);

        let x = [s.q.clone(), s.u.clone(), s.tau.clone()].concat();
        let values = |list: &[Expr<'_>]| graph.eval(&list.iter().map(|e| graph.id(*e)).collect::<Vec<_>>(), &x);
        let expected = recursive(&tree, &s).1;
        let of_graph = Jacobians {
            by_q: values(&recursion.by_q),
            by_u: values(&recursion.by_u),
            by_tau: values(&recursion.by_tau),
        };
        agree(&of_graph, &expected, 1e-11);

        let roots: Vec<_> = a.iter().map(|e| graph.id(*e)).collect();
        let ids: Vec<_> = inputs.iter().map(|e| graph.id(*e)).collect();
        let mut differentiated = Jacobians::new(&tree);
        for (i, j, e) in graph.jacobian(&roots, &ids) {
            let x = values(&[e])[0];
            match j {
                _ if j < nq => differentiated.by_q[i * nq + j] = x,
                _ if j < nq + nu => differentiated.by_u[i * nu + j - nq] = x,
                _ => differentiated.by_tau[i * nu + j - nq - nu] = x,
            }
        }
        agree(&differentiated, &expected, 1e-10);
    }
}
