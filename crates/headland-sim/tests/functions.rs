//! M, F, q′, u′ and the Jacobian at chosen states: against the integrator's view of the same equations.

mod common;

use std::rc::Rc;

use common::{PIVOT, SNAKEBOARD, TRAIN, build, chain, pendulums, read};
use headland_dynamics::{DeriveOptions, derive};
use headland_model::Scene;
use headland_sim::{Problem, StateFunction, StateFunctions, System, initial_state};
use headland_solve::OdeProblem;

fn scenes() -> Vec<Scene> {
    let mut crout = pendulums(10);
    crout.set("run.linear_solver", "crout").unwrap_or_else(|e| panic!("{e}"));
    vec![read(TRAIN), read(PIVOT), read(SNAKEBOARD), chain(12), pendulums(3), pendulums(10), crout]
}

#[test]
fn functions_are_what_the_integrator_sees() {
    for scene in scenes() {
        let model = build(&scene);
        let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        let functions = StateFunctions::new(&model, &equations);
        let mut evaluator = functions.evaluator();
        let mut problem = Problem::new(Rc::new(System::new(&model, &equations)), true);
        let start = initial_state(&model, &equations).unwrap_or_else(|e| panic!("{e}"));
        let (nq, nu, n) = (functions.nq(), functions.nu(), start.len());

        // more states than go into a pass; the first is the start
        let points = 300;
        let t: Vec<f64> = (0..points).map(|k| 0.01 * f64::from(k)).collect();
        let state = |p: usize| (0..n).map(move |i| 0.2 * (1.7 * i as f64 * p as f64).sin());
        let y: Vec<f64> = (0..points as usize)
            .flat_map(|p| start.iter().zip(state(p)).map(|(y, d)| y + d).collect::<Vec<_>>())
            .collect();
        let mut many = |what| {
            let (rows, columns) = functions.shape(what);
            let mut out = vec![f64::NAN; rows * columns * t.len()];
            evaluator.eval(what, &t, &y, &mut out);
            out
        };
        let (rates, mass, force) = (many(StateFunction::Rates), many(StateFunction::Mass), many(StateFunction::Force));
        let (accelerations, jacobian) = (many(StateFunction::Accelerations), many(StateFunction::Jacobian));

        let mut dy = vec![0.0; n];
        let pattern = problem.pattern().cloned().unwrap_or_else(|| panic!("no pattern"));
        let mut values = vec![0.0; pattern.nnz()];
        for p in (0..t.len()).step_by(37) {
            let state = &y[n * p..n * (p + 1)];
            problem.rhs(t[p], state, &mut dy).unwrap_or_else(|_| panic!("no right-hand side"));
            assert_eq!(rates[nq * p..nq * (p + 1)], dy[..nq], "{}", model.title);
            let a = &accelerations[nu * p..nu * (p + 1)];
            assert_eq!(*a, dy[nq..], "{}", model.title);
            for i in 0..nu {
                let row = &mass[nu * (nu * p + i)..nu * (nu * p + i + 1)];
                let size: f64 = row.iter().zip(a).map(|(m, a)| (m * a).abs()).sum::<f64>() + force[nu * p + i].abs();
                let left = row.iter().zip(a).map(|(m, a)| m * a).sum::<f64>() - force[nu * p + i];
                assert!(left.abs() <= 1e-12 * size, "{}: M u' - F = {left}", model.title);
            }
            problem.jacobian(t[p], state, &mut values).unwrap_or_else(|_| panic!("no Jacobian"));
            let mut dense = vec![0.0; n * n];
            for ((i, j), value) in pattern.entries().zip(&values) {
                dense[n * i + j] = *value;
            }
            let found = &jacobian[n * n * p..n * n * (p + 1)];
            for (found, exact) in found.chunks(n).zip(dense.chunks(n)) {
                let size = exact.iter().fold(1e-3_f64, |a, x| a.max(x.abs()));
                let near = found.iter().zip(exact).all(|(a, b)| (a - b).abs() <= 1e-13 * size);
                assert!(near, "{}: {found:?} for {exact:?}", model.title); // u' by L D L^T here, maybe by Crout there
            }

            let mut alone = vec![0.0; n * n];
            functions.evaluator().eval(StateFunction::Jacobian, &t[p..=p], state, &mut alone);
            assert_eq!(alone, found, "{}: one state alone", model.title);
        }
    }
}

#[test]
fn threads_share_the_functions() {
    let model = build(&pendulums(10));
    let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let functions = StateFunctions::new(&model, &equations);
    let y = initial_state(&model, &equations).unwrap_or_else(|e| panic!("{e}"));
    let eval = || {
        let mut out = vec![0.0; y.len() * y.len()];
        functions.evaluator().eval(StateFunction::Jacobian, &[0.0], &y, &mut out);
        out
    };
    let all: Vec<Vec<f64>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(eval)).collect();
        threads.into_iter().map(|t| t.join().unwrap_or_else(|_| panic!("a thread failed"))).collect()
    });
    assert!(all.iter().all(|j| *j == all[0]));
}

/// A model derives to the same bytes again if it is cloned before.
#[test]
fn a_clone_derives_the_same() {
    for scene in scenes() {
        let model = build(&scene);
        let derive_a_clone = || {
            let model = model.clone();
            let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
            headland_dynamics::present::equations_text(&model, &equations, headland_dynamics::present::Form::C)
        };
        assert_eq!(derive_a_clone(), derive_a_clone(), "{}", model.title);
    }
}
