//! Identities of the recursions on random trees.
#![allow(non_snake_case)]

mod trees;

use headland_code::Lanes;
use headland_code::lanes::{Lanes4, Lanes8};
use headland_dynamics::solve::unpack;
use headland_dynamics::tree::{
    Frames, Joint, Loads, Mount, Reduction, Tree, Workspace, body_jacobian, frames, mass_times, project, rnea,
};
use headland_expr::{Dual, Expr, Graph, Scalar};
use headland_spatial::{Axis, Inertia, Pose, Rotation, Twist, Vector, Wrench};
use trees::{Random, State, aba, bias, mass, near};

/// `|M u̇ + h − τ| ≤ bound (|M| |u̇| + |h| + |τ|)`, row by row.
fn backward_error(tree: &Tree<f64>, s: &State, a: &[f64]) -> f64 {
    let n = tree.nu();
    let (m, h) = (unpack(&mass(tree, &s.q), n), bias(tree, s));
    let norm = |x: &[f64]| x.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let rows = (0..n).map(|i| (0..n).map(|j| m[i * n + j].abs()).sum::<f64>()).fold(0.0, f64::max);
    let residual = (0..n).map(|i| (0..n).map(|j| m[i * n + j] * a[j]).sum::<f64>() + h[i] - s.tau[i]);
    let residual = residual.fold(0.0f64, |m, x| m.max(x.abs()));
    residual / (rows * norm(a) + norm(&h) + norm(&s.tau) + 1e-300)
}

#[test]
fn accelerations_solve_the_equations_of_motion() {
    for seed in 0..300 {
        let mut r = Random(seed);
        let n = 1 + r.below(30);
        let tree = r.tree(n);
        let s = r.state(&tree);
        let error = backward_error(&tree, &s, &aba(&tree, &s));
        assert!(error < 1e-13, "seed {seed}: {error:.1e}");
    }
}

#[test]
fn mass_ratios_of_a_million_do_no_harm() {
    for seed in 0..200 {
        let mut r = Random(seed);
        let mut tree = r.tree(12);
        for b in 0..tree.len() {
            let k = 10f64.powi(6 * (r.below(3) as i32 - 1));
            let i = tree.bodies()[b].inertia;
            tree.set_inertia(b, Inertia::new(i.mass * k, i.centre, i.tensor * k));
        }
        let s = r.state(&tree);
        let error = backward_error(&tree, &s, &aba(&tree, &s));
        assert!(error < 1e-12, "seed {seed}: {error:.1e}");
    }
}

#[test]
fn inverse_dynamics_undoes_accelerations() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let tree = r.tree(10);
        let s = r.state(&tree);
        let (a, mut tau) = (aba(&tree, &s), vec![0.0; tree.nu()]);
        let mut work = Workspace::new(&tree);
        rnea(&tree, &s.q, &s.u, &a, &s.loads(), &mut work, &mut tau);
        let size = a.iter().fold(1.0f64, |m, x| m.max(x.abs()));
        near(&tau, &s.tau, 1e-12 * size);
        let (mut product, h) = (vec![0.0; tree.nu()], bias(&tree, &s));
        mass_times(&tree, &a, &mut work, &mut product);
        let sum: Vec<f64> = product.iter().zip(&h).map(|(p, h)| p + h).collect();
        near(&sum, &s.tau, 1e-12 * size);
    }
}

/// All that is computed, as one list.
fn everything<S: Scalar>(tree: &Tree<S>, q: &[S], u: &[S], tau: &[S], gravity: Vector<S>, f: &[Wrench<S>]) -> Vec<S> {
    let zero = S::constant(0.0);
    let (nu, mut work) = (tree.nu(), Workspace::new(tree));
    let loads = Loads { gravity, wrenches: f };
    let (mut a, mut t, mut m) = (vec![zero; nu], vec![zero; nu], vec![zero; nu * (nu + 1) / 2]);
    headland_dynamics::tree::aba(tree, q, u, tau, &loads, &mut work, &mut a);
    rnea(tree, q, u, tau, &loads, &mut work, &mut t);
    headland_dynamics::tree::crba(tree, q, &mut work, &mut m);
    let mut all = Frames::new(tree);
    frames(tree, q, u, &mut work, &mut all);
    let energies = [all.kinetic_energy(tree), all.potential_energy(tree, gravity)];
    let mut rates = vec![zero; tree.nq()];
    tree.q_dot(q, u, &mut rates);
    [a, t, m, energies.to_vec(), rates].concat()
}

fn numbers(tree: &Tree<f64>, s: &State) -> Vec<f64> {
    everything(tree, &s.q, &s.u, &s.tau, s.gravity, &s.wrenches)
}

fn lift<S: Scalar>(f: &[Wrench<f64>]) -> Vec<Wrench<S>> {
    f.iter().map(|f| Wrench::new(f.torque.map(S::constant), f.force.map(S::constant))).collect()
}

#[test]
fn expressions_duals_and_lanes_say_what_numbers_say() {
    for seed in 0..20 {
        let mut r = Random(seed);
        let tree = r.tree(6);
        let s = r.state(&tree);
        let expected = numbers(&tree, &s);

        let graph = Graph::new();
        let input = |x: &[f64]| -> Vec<Expr<'_>> { x.iter().map(|_| graph.input("x")).collect() };
        let (q, u, tau) = (input(&s.q), input(&s.u), input(&s.tau));
        let gravity = s.gravity.map(Expr::constant);
        let symbolic = everything(&tree.map(Expr::constant), &q, &u, &tau, gravity, &lift(&s.wrenches));
        let roots: Vec<_> = symbolic.into_iter().map(|e| graph.id(e)).collect();
        near(&graph.eval(&roots, &[s.q.clone(), s.u.clone(), s.tau.clone()].concat()), &expected, 1e-13);

        let dual = |x: &[f64]| -> Vec<Dual<f64>> { x.iter().map(|x| Dual::new(*x, 1.0)).collect() };
        let duals = everything(
            &tree.map(Dual::constant),
            &dual(&s.q),
            &dual(&s.u),
            &dual(&s.tau),
            s.gravity.map(Dual::constant),
            &lift(&s.wrenches),
        );
        near(&duals.iter().map(|d| d.value).collect::<Vec<_>>(), &expected, 1e-13);
        lanes::<Lanes4>(&tree, &mut r);
        lanes::<Lanes8>(&tree, &mut r);
    }
}

fn lanes<L: Lanes>(tree: &Tree<f64>, r: &mut Random) {
    let states: Vec<State> = (0..L::WIDTH).map(|_| r.state(tree)).collect();
    let load = |get: &dyn Fn(&State) -> f64| L::load(&states.iter().map(get).collect::<Vec<_>>());
    let list = |n: usize, get: fn(&State) -> &[f64]| -> Vec<L> { (0..n).map(|i| load(&|s| get(s)[i])).collect() };
    let (q, u, tau) = (list(tree.nq(), |s| &s.q), list(tree.nu(), |s| &s.u), list(tree.nu(), |s| &s.tau));
    let gravity = Vector(std::array::from_fn(|i| load(&|s| s.gravity[i])));
    let wrenches: Vec<_> = (0..tree.len())
        .map(|b| {
            let part = |get: fn(&Wrench<f64>) -> Vector<f64>| {
                Vector(std::array::from_fn(|i| load(&|s: &State| get(&s.wrenches[b])[i])))
            };
            Wrench::new(part(|f| f.torque), part(|f| f.force))
        })
        .collect();
    let all = everything(&tree.map(L::constant), &q, &u, &tau, gravity, &wrenches);
    for (lane, s) in states.iter().enumerate() {
        let mut out = [0.0; 8];
        let one: Vec<f64> = all
            .iter()
            .map(|y| {
                y.store(&mut out);
                out[lane]
            })
            .collect();
        near(&one, &numbers(tree, s), 1e-13);
    }
}

#[test]
fn energy_grows_by_the_power_of_what_acts() {
    for seed in 0..200 {
        let mut r = Random(seed);
        let tree = r.tree(8);
        let s = r.state(&tree);
        let (a, mut rates) = (aba(&tree, &s), vec![0.0; tree.nq()]);
        tree.q_dot(&s.q, &s.u, &mut rates);
        let along = |x: &[f64], dx: &[f64]| -> Vec<_> { x.iter().zip(dx).map(|(x, d)| Dual::new(*x, *d)).collect() };
        let moving = tree.map(Dual::constant);
        let mut all = Frames::new(&moving);
        frames(&moving, &along(&s.q, &rates), &along(&s.u, &a), &mut Workspace::new(&moving), &mut all);
        let energy = all.kinetic_energy(&moving) + all.potential_energy(&moving, s.gravity.map(Dual::constant));
        let power: f64 = s.tau.iter().zip(&s.u).map(|(t, u)| t * u).sum();
        let value = |v: Vector<Dual<f64>>| v.map(|x| x.value);
        let twists = all.twists.iter().map(|v| Twist::new(value(v.angular), value(v.linear)));
        let applied: f64 = twists.zip(&s.wrenches).map(|(v, f)| v.power(*f)).sum();
        let size = 1.0 + energy.value.abs() + applied.abs() + a.iter().map(|x| x.abs()).sum::<f64>();
        assert!((energy.dot - power - applied).abs() < 1e-12 * size, "seed {seed}: {} {}", energy.dot, power + applied);
    }
}

#[test]
fn twists_are_the_rates_of_poses() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let tree = r.tree(8);
        let s = r.state(&tree);
        let mut rates = vec![0.0; tree.nq()];
        tree.q_dot(&s.q, &s.u, &mut rates);
        let q: Vec<_> = s.q.iter().zip(&rates).map(|(x, d)| Dual::new(*x, *d)).collect();
        let u: Vec<_> = s.u.iter().map(|x| Dual::constant(*x)).collect();
        let moving = tree.map(Dual::constant);
        let mut all = Frames::new(&moving);
        frames(&moving, &q, &u, &mut Workspace::new(&moving), &mut all);
        for (X, V) in all.poses.iter().zip(&all.twists) {
            let (R, w) = (X.rotation.0.map(|row| row.map(|x| x.value)), V.angular.map(|x| x.value));
            near(&X.position.map(|x| x.dot).0, &(Rotation(R) * V.linear.map(|x| x.value)).0, 1e-12);
            for axis in Axis::ALL {
                let column = X.rotation.axis(axis).map(|x| x.dot);
                near(&column.0, &(Rotation(R) * w.cross(Vector::along(axis, 1.0))).0, 1e-12);
            }
        }
    }
}

#[test]
fn body_jacobians_give_twists_and_the_mass_matrix_gives_energy() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let tree = r.tree(9);
        let s = r.state(&tree);
        let (mut work, mut all) = (Workspace::new(&tree), Frames::new(&tree));
        frames(&tree, &s.q, &s.u, &mut work, &mut all);
        let mut columns = vec![Twist::zero(); tree.nu()];
        for b in 0..tree.len() {
            body_jacobian(&tree, b, &work, &mut columns);
            let v = columns.iter().zip(&s.u).fold(Twist::zero(), |sum, (c, u)| sum + *c * *u);
            near(&v.angular.0, &all.twists[b].angular.0, 1e-13);
            near(&v.linear.0, &all.twists[b].linear.0, 1e-13);
        }
        let (n, m) = (tree.nu(), unpack(&mass(&tree, &s.q), tree.nu()));
        let twice: f64 = (0..n * n).map(|k| s.u[k / n] * m[k] * s.u[k % n]).sum();
        near(&[0.5 * twice], &[all.kinetic_energy(&tree)], 1e-13);
    }
}

#[test]
fn a_rigid_move_of_everything_changes_nothing() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let (tree, X) = (r.tree(10), r.pose());
        let mut s = r.state(&tree);
        let mut moved = Tree::new();
        for b in tree.bodies() {
            let mount = if b.parent.is_none() { Mount::Pose(X * b.mount.pose()) } else { b.mount };
            moved.push(b.parent, mount, b.joint, b.inertia);
        }
        let a = aba(&tree, &s);
        s.gravity = X.rotation * s.gravity;
        near(&aba(&moved, &s), &a, 1e-11);
    }
}

#[test]
fn general_products_agree_with_specialised_ones() {
    for seed in 0..100 {
        let mut r = Random(seed);
        let (mut special, mut general) = (Tree::new(), Tree::new());
        for b in 0..12usize {
            let (axis, p, inertia) = (Axis::ALL[r.below(3)], r.vector(), r.inertia());
            let e = Vector::along(axis, 1.0);
            let (one, other) = match r.below(4) {
                0 => (Joint::Prismatic(axis), Joint::PrismaticAlong(e)),
                1 => (Joint::Revolute(axis), Joint::Helical { axis, pitch: 0.0 }),
                2 => (Joint::Revolute(axis), Joint::RevoluteAbout(e)),
                _ => (Joint::Revolute(axis), Joint::Revolute(axis)),
            };
            let parent = b.checked_sub(1 + r.below(2));
            special.push(parent, p, one, inertia);
            general.push(parent, Pose::at(p), other, inertia);
        }
        let s = r.state(&special);
        near(&numbers(&general, &s), &numbers(&special, &s), 1e-11);
    }
}

#[test]
fn compound_joints_are_their_parts() {
    for seed in 0..50 {
        let mut r = Random(seed);
        let (mount, base, body) = (r.mount(), r.inertia(), r.inertia());
        let mut free = Tree::new();
        free.push(None, r.mount(), Joint::Revolute(Axis::X), base);
        let mut parts = free.clone();
        free.push(Some(0), mount, Joint::Free, body);
        parts.push(Some(0), mount, Joint::Prismatic(Axis::X), Inertia::zero());
        parts.push(Some(1), Mount::origin(), Joint::Prismatic(Axis::Y), Inertia::zero());
        parts.push(Some(2), Mount::origin(), Joint::Prismatic(Axis::Z), Inertia::zero());
        parts.push(Some(3), Mount::origin(), Joint::Spherical, body);
        let mut s = r.state(&free);
        s.wrenches.clear();
        let a = aba(&free, &s);
        let reorder = |x: &[f64]| vec![x[0], x[4], x[5], x[6], x[1], x[2], x[3]];
        let t = State { q: s.q, u: reorder(&s.u), tau: reorder(&s.tau), gravity: s.gravity, wrenches: vec![] };
        near(&aba(&parts, &t), &reorder(&a), 1e-10);

        let (mut planar, mut parts) = (Tree::new(), Tree::new());
        planar.push(None, mount, Joint::Planar, body);
        parts.push(None, mount, Joint::Prismatic(Axis::X), Inertia::zero());
        parts.push(Some(0), Mount::origin(), Joint::Prismatic(Axis::Y), Inertia::zero());
        parts.push(Some(1), Mount::origin(), Joint::Revolute(Axis::Z), body);
        let mut s = r.state(&planar);
        s.wrenches.clear();
        near(&aba(&parts, &s), &aba(&planar, &s), 1e-12);
    }
}

#[test]
fn projection_is_the_dense_product() {
    for seed in 0..50 {
        let mut r = Random(seed);
        let tree = r.tree(8);
        let (s, n, k) = (r.state(&tree), tree.nu(), 3);
        let columns: Vec<Vec<f64>> = (0..k).map(|_| r.numbers(n)).collect();
        let drift = r.numbers(n);
        let (mut m, mut f) = (vec![0.0; k * (k + 1) / 2], vec![0.0; k]);
        let reduction = Reduction { columns: &columns, drift: &drift };
        project(&tree, &s.q, &s.u, &s.tau, &s.loads(), &reduction, &mut Workspace::new(&tree), &mut m, &mut f);
        let (full, h) = (unpack(&mass(&tree, &s.q), n), bias(&tree, &s));
        let times = |x: &[f64]| -> Vec<f64> { (0..n).map(|i| (0..n).map(|j| full[i * n + j] * x[j]).sum()).collect() };
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let rest: Vec<f64> = times(&drift).iter().zip(&h).zip(&s.tau).map(|((d, h), t)| t - h - d).collect();
        near(&f, &columns.iter().map(|g| dot(g, &rest)).collect::<Vec<_>>(), 1e-12);
        let dense: Vec<f64> = (0..k)
            .flat_map(|i| (0..=i).map(move |j| (i, j)))
            .map(|(i, j)| dot(&columns[j], &times(&columns[i])))
            .collect();
        near(&m, &dense, 1e-12);
    }
}

#[test]
fn a_workspace_serves_every_tree_of_its_size() {
    let mut r = Random(3);
    let (mut one, mut other) = (Tree::new(), Tree::new());
    for tree in [&mut one, &mut other] {
        for b in 0..4usize {
            tree.push(b.checked_sub(1), r.vector(), Joint::Revolute(Axis::ALL[b % 3]), r.inertia());
        }
    }
    let (s, mut used, mut fresh) = (r.state(&other), Workspace::new(&one), Workspace::new(&other));
    let (mut a, mut b) = (Frames::new(&other), Frames::new(&other));
    frames(&other, &s.q, &s.u, &mut used, &mut a);
    frames(&other, &s.q, &s.u, &mut fresh, &mut b);
    assert_eq!((a.poses, a.twists), (b.poses, b.twists));
}

/// In symbols, with loads on nothing; the operations that it takes are printed.
#[test]
fn a_free_ball_falls() {
    let graph = Graph::new();
    let mut ball = Tree::new();
    let sphere = Inertia::solid_sphere(2.0, 0.1);
    ball.push(None, Mount::origin(), Joint::Free, sphere);
    let input = |n: usize| -> Vec<Expr<'_>> { (0..n).map(|_| graph.input("x")).collect() };
    let (q, u, mut a) = (input(7), input(6), input(6));
    let (tree, zero) = (ball.map(Expr::constant), [Expr::Const(0.0); 6]);
    let loads = Loads::gravity(Vector([0.0, 0.0, -9.81]).map(Expr::constant));
    headland_dynamics::tree::aba(&tree, &q, &u, &zero, &loads, &mut Workspace::new(&tree), &mut a);
    let roots: Vec<_> = a.iter().map(|e| graph.id(*e)).collect();
    let x: Vec<f64> = Random(1).numbers(19);
    near(&graph.eval(&roots, &x), &[0.0, 0.0, 0.0, 0.0, 0.0, -9.81], 1e-15);
    eprintln!("a free ball: {} operations", graph.operations(&roots));
}

/// Two rods of length l and mass m, angles from the vertical, both absolute in the formula.
///
/// ```text
/// (4/3) φ″ + ½ ψ″ cos(φ−ψ) + ½ ψ′² sin(φ−ψ) + (3/2) (g/l) sin φ = 0
/// ½ φ″ cos(φ−ψ) + (1/3) ψ″ − ½ φ′² sin(φ−ψ) + ½ (g/l) sin ψ = 0
/// ```
#[test]
fn the_double_pendulum_is_that_of_the_textbook() {
    let (m, l, g) = (1.3, 0.7, 9.81);
    let rod = Inertia::rod(m, l, Axis::Z).with_centre(Vector([0.0, 0.0, -l / 2.0]));
    let mut tree = Tree::new();
    tree.push(None, Mount::origin(), Joint::Revolute(Axis::Y), rod);
    tree.push(Some(0), Vector([0.0, 0.0, -l]), Joint::Revolute(Axis::Y), rod);
    let mut r = Random(5);
    for _ in 0..20 {
        let (phi, psi, dphi, dpsi) = (r.number() * 3.0, r.number() * 3.0, r.number() * 5.0, r.number() * 5.0);
        let s = State {
            q: vec![phi, psi - phi],
            u: vec![dphi, dpsi - dphi],
            tau: vec![0.0; 2],
            gravity: Vector([0.0, 0.0, -g]),
            wrenches: vec![],
        };
        let a = aba(&tree, &s);
        let (ddphi, ddpsi) = (a[0], a[0] + a[1]);
        let (sin, cos) = (phi - psi).sin_cos();
        let first = 4.0 / 3.0 * ddphi + 0.5 * ddpsi * cos + 0.5 * dpsi * dpsi * sin + 1.5 * g / l * phi.sin();
        let second = 0.5 * ddphi * cos + ddpsi / 3.0 - 0.5 * dphi * dphi * sin + 0.5 * g / l * psi.sin();
        near(&[first / 100.0, second / 100.0], &[0.0, 0.0], 1e-14);
    }
}
