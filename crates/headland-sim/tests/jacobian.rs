//! The exact Jacobian against dual numbers: unrolled equations, equations solved by numbers, both linear solvers.

mod common;

use std::rc::Rc;

use common::{CARTESIAN, DOUBLE, PIVOT, ROAD, SLEIGH, SNAKEBOARD, TRAIN, build, chain, pendulums, read};
use headland_dynamics::sample::start_inputs;
use headland_dynamics::solve::solve_ldl;
use headland_dynamics::{DeriveOptions, Equations, derive, initial_velocities};
use headland_expr::Dual;
use headland_model::{Model, Scene};
use headland_sim::{Problem, System};
use headland_solve::OdeProblem;

/// `[q′, u′]` over dual numbers on the model's own graph, with derivatives along state `j`.
fn column(model: &Model, equations: &Equations, t: f64, y: &[f64], j: usize) -> Vec<Dual<f64>> {
    let mut x: Vec<Dual<f64>> = start_inputs(model).iter().map(|v| Dual::new(*v, 0.0)).collect();
    x[model.input_index(model.time)] = Dual::new(t, 0.0);
    let states = model.coordinates.iter().map(|c| c.q).chain(equations.kinematics.quasi.iter().map(|u| u.u));
    for (i, (node, value)) in states.zip(y).enumerate() {
        x[model.input_index(node)] = Dual::new(*value, if i == j { 1.0 } else { 0.0 });
    }
    let mut dy = model.graph.eval(&equations.kinematics.rates, &x);
    let (mut m, mut f) = (model.graph.eval(&equations.mass, &x), model.graph.eval(&equations.force, &x));
    solve_ldl(&mut m, &mut f);
    dy.extend(f);
    dy
}

/// Largest difference relative to the largest entry of its row.
fn compare(scene: &Scene, unrolled: bool) {
    let model = build(scene);
    let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(equations.accelerations.is_some(), unrolled, "{}", model.title);
    let system = Rc::new(System::new(&model, &equations));
    let n = system.len();
    let mut problem = Problem::new(system.clone(), true);
    let start: Vec<f64> = {
        let inputs = start_inputs(&model);
        let u = initial_velocities(&model, &equations.kinematics).unwrap_or_else(|e| panic!("{e}"));
        model.coordinates.iter().map(|c| inputs[model.input_index(c.q)]).chain(u).collect()
    };
    for k in 0..4 {
        let t = 0.37 + 1.1 * f64::from(k);
        let y: Vec<f64> = (0..n).map(|i| start[i] + 0.2 * (1.7 * i as f64 + 0.9 * f64::from(k)).sin()).collect();
        let pattern = problem.pattern().cloned().unwrap_or_else(|| panic!("no pattern"));
        let mut values = vec![0.0; pattern.nnz()];
        problem.jacobian(t, &y, &mut values).unwrap_or_else(|_| panic!("no Jacobian"));
        let mut exact = vec![vec![0.0; n]; n];
        let mut dy = vec![0.0; n];
        problem.rhs(t, &y, &mut dy).unwrap_or_else(|_| panic!("no right-hand side"));
        for j in 0..n {
            for (i, d) in column(&model, &equations, t, &y, j).into_iter().enumerate() {
                exact[i][j] = d.dot;
                assert!((d.value - dy[i]).abs() <= 1e-12 * d.value.abs().max(1.0), "{}: f_{i}", model.title);
            }
        }
        let mut found = vec![vec![0.0; n]; n];
        for ((i, j), value) in pattern.entries().zip(&values) {
            found[i][j] = *value;
        }
        for i in 0..n {
            let size = exact[i].iter().fold(1e-3_f64, |a, x| a.max(x.abs()));
            for j in 0..n {
                let difference = (found[i][j] - exact[i][j]).abs() / size;
                assert!(difference <= 1e-12, "{}, [{i}, {j}]: {} for {}", model.title, found[i][j], exact[i][j]);
            }
        }
    }
}

fn with_crout(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.set("run.linear_solver", "crout").unwrap_or_else(|e| panic!("{e}"));
    scene
}

#[test]
fn unrolled() {
    for text in [SLEIGH, DOUBLE, TRAIN, CARTESIAN, PIVOT, ROAD, SNAKEBOARD] {
        compare(&read(text), true);
    }
    for scene in [chain(4), pendulums(3), chain(8)] {
        compare(&scene, true);
        compare(&with_crout(&scene), true);
    }
}

#[test]
fn solved_by_numbers() {
    for scene in [pendulums(10), pendulums(12)] {
        compare(&scene, false);
        compare(&with_crout(&scene), false);
    }
}

/// Masses on springs: M is diagonal, and stays unrolled however many there are.
#[test]
fn sparse_mass_matrices() {
    for scene in [chain(9), chain(12), chain(40)] {
        compare(&scene, true);
        compare(&with_crout(&scene), true);
    }
}

/// Tyres in both branches of their laws, lifted and pressed in, and states of the first order.
#[test]
fn tyres() {
    for text in [
        include_str!("../../../models/tractor_implement.toml"),
        include_str!("../../../models/paper_train_tyres.toml"),
        include_str!("../../../models/quarter_tractor.toml"),
    ] {
        compare(&read(text), true);
    }
    compare(&read(include_str!("../../../models/tractor.toml")), false);
}
