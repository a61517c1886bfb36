//! What must hold of any equations of motion, at pseudo-random states of several scenes.

mod common;

use approx::assert_relative_eq;
use common::{
    Random, accelerations, along, build, cartesian_train, derived, double_pendulum, prescribed_pivot, sleigh, state,
    train, turning_rails,
};
use headland_dynamics::solve::packed;
use headland_dynamics::{Algorithm, DeriveError, DeriveOptions, Equations, derive};
use headland_expr::NodeId;
use headland_model::{ElementKind, Model, RowForm, Scene, StructureForm};
use nalgebra::DMatrix;

const STATES: usize = 8;

fn scenes() -> Vec<Scene> {
    let mut scenes = vec![double_pendulum(), sleigh("geometric"), sleigh("rates"), prescribed_pivot(), turning_rails()];
    scenes.extend((1..=5).map(train));
    scenes.extend((1..=5).map(cartesian_train));
    scenes
}

fn at_states(mut check: impl FnMut(&Model, &Equations, &[f64])) {
    for scene in scenes() {
        let model = build(&scene);
        let equations = derived(&model);
        let mut random = Random(7);
        for _ in 0..STATES {
            check(&model, &equations, &state(&model, &equations, &mut random));
        }
    }
}

fn mass_matrix(model: &Model, equations: &Equations, x: &[f64]) -> DMatrix<f64> {
    let m = model.graph.eval(&equations.mass, x);
    let n = equations.kinematics.quasi.len();
    DMatrix::from_fn(n, n, |i, j| m[packed(i.max(j), i.min(j))])
}

fn quasi(model: &Model, equations: &Equations, x: &[f64]) -> Vec<f64> {
    equations.kinematics.quasi.iter().map(|u| x[model.input_index(u.u)]).collect()
}

/// `½ Σ J d′²`, with d′ of geometric structures by dual numbers along the motion.
fn kinetic_energy(model: &Model, x: &[f64]) -> f64 {
    let inertia: Vec<_> = model.elements.iter().filter(|e| e.kind == ElementKind::Inertia).collect();
    let values = model.graph.eval(&inertia.iter().map(|e| e.value).collect::<Vec<_>>(), x);
    let structures = along(model, &inertia.iter().map(|e| e.structure).collect::<Vec<_>>(), x);
    let rates =
        inertia.iter().zip(structures).map(|(e, d)| if e.form == StructureForm::Geometric { d.dot } else { d.value });
    rates.zip(values).map(|(d, j)| 0.5 * j * d * d).sum()
}

#[test]
fn kinetic_energy_is_that_of_the_elements_and_of_the_mass_matrix() {
    let mut without_drift = 0;
    at_states(|model, equations, x| {
        let t = kinetic_energy(model, x);
        assert_relative_eq!(t, model.graph.eval(&[equations.energies.kinetic], x)[0], max_relative = 1e-12);
        if equations.energies.drives.is_none() && model.title != "two particles on turning rails" {
            let m = mass_matrix(model, equations, x);
            let u = nalgebra::DVector::from_vec(quasi(model, equations, x));
            assert_relative_eq!(0.5 * (u.transpose() * m * u)[0], t, max_relative = 1e-12);
            without_drift += 1;
        }
    });
    assert!(without_drift >= 13 * STATES, "{without_drift}");
}

#[test]
fn work_is_the_change_of_energy() {
    at_states(|model, equations, x| {
        let e = &equations.energies;
        let energy = along(model, &[e.kinetic, e.potential], x);
        let nodes: Vec<NodeId> = e.powers.iter().map(|(_, p)| *p).chain(e.drives).collect();
        let powers = model.graph.eval(&nodes, x);
        let size = powers.iter().map(|p| p.abs()).sum::<f64>() + energy[0].dot.abs() + energy[1].dot.abs();
        let defect = energy[0].dot + energy[1].dot - powers.iter().sum::<f64>();
        assert!(defect.abs() <= 1e-11 * size, "{}: {defect:e} of {size:e}", model.title);
    });
}

#[test]
fn the_mass_matrix_is_positive_definite() {
    at_states(|model, equations, x| {
        let m = mass_matrix(model, equations, x);
        let values = m.symmetric_eigenvalues();
        assert!(values.min() > 1e-9 * values.max(), "{}: {values}", model.title);
    });
}

/// `u′` of the unrolled solution fulfils `M u′ = F`, by both solvers.
#[test]
fn accelerations_solve_the_equations() {
    for crout in [false, true] {
        for mut scene in scenes() {
            if crout {
                scene.entry("run", "linear_solver", "crout");
            }
            let model = build(&scene);
            let equations = derived(&model);
            let mut random = Random(11);
            for _ in 0..STATES {
                let x = state(&model, &equations, &mut random);
                let m = mass_matrix(&model, &equations, &x);
                let f = nalgebra::DVector::from_vec(model.graph.eval(&equations.force, &x));
                let a = nalgebra::DVector::from_vec(accelerations(&model, &equations, &x));
                let size = f.amax() + (m.abs() * a.abs()).amax();
                assert!((&m * a - f).amax() <= 1e-12 * size, "{}", model.title);
            }
        }
    }
}

#[test]
fn both_algorithms_agree() {
    let mut compared = 0;
    for scene in scenes() {
        let model = build(&scene);
        let with = |algorithm| derive(&model, &DeriveOptions { algorithm, compare: true, ..DeriveOptions::default() });
        let direct = with(Algorithm::Direct).unwrap_or_else(|e| panic!("{e}"));
        let combined = match with(Algorithm::Combine) {
            Ok(equations) => equations,
            Err(DeriveError::CombineDoesNotApply { .. }) => {
                assert!(model.elements.iter().any(|e| e.form == StructureForm::Explicit), "{}", model.title);
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        compared += 1;
        assert_eq!((direct.algorithm, combined.algorithm), ("direct", "combine"));
        assert!(direct.difference.is_some_and(|d| d < 1e-11), "{}: {:?}", model.title, direct.difference);
        let mut random = Random(13);
        for _ in 0..STATES {
            let x = state(&model, &direct, &mut random);
            let (a, b) = (mass_matrix(&model, &direct, &x), mass_matrix(&model, &combined, &x));
            assert!((&a - b).amax() <= 1e-12 * a.amax(), "{}", model.title);
            let (a, b) = (model.graph.eval(&direct.force, &x), model.graph.eval(&combined.force, &x));
            let size = a.iter().fold(0.0_f64, |s, f| s.max(f.abs()));
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() <= 1e-10 * size, "{}: F {a} against {b}", model.title);
            }
        }
    }
    assert!(compared >= 8, "{compared}");
}

/// Forces that cancel leave rounding, which is no disagreement: a free pendulum on a pivot of constant speed.
#[test]
fn rounding_is_no_disagreement() {
    let mut scene = Scene::new("free pendulum on a moving pivot");
    scene.entry("parameters", "m", "0.4 kg").entry("parameters", "l", "0.25 m").entry("parameters", "c", "3.6 m/s");
    scene.entry("coordinates", "phi", "rad").entry("coordinates", "p", "m").entry("prescribed", "p", "c*t");
    scene.element("inertia", &[("name", "x"), ("value", "m"), ("geometric", "l*sin(phi)")]);
    scene.element("inertia", &[("name", "y"), ("value", "m"), ("geometric", "p - l*cos(phi)")]);
    scene.entry("initial", "phi'", 0.0);
    for k in 0..40 {
        let mut scene = scene.clone();
        scene.entry("initial", "phi", 0.17 * f64::from(k));
        let model = build(&scene);
        let compared = derive(&model, &DeriveOptions { compare: true, ..DeriveOptions::default() });
        assert!(compared.as_ref().is_ok_and(|e| e.difference.is_some_and(|d| d < 1e-12)), "{:?}", compared.err());
    }
}

/// The rows in form (1) at the rates of a state, over the sum of what is added in them.
fn residuals(model: &Model, x: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for row in &model.kinematics {
        let RowForm::Zero(node) = row.form else { continue };
        let residual = model.graph.eval(&[node], x)[0];
        let mut size = 1e-3;
        for c in &model.coordinates {
            let mut y = x.to_vec();
            y[model.input_index(c.rate)] = 0.0;
            size += (residual - model.graph.eval(&[node], &y)[0]).abs();
        }
        worst = worst.max(residual.abs() / size);
    }
    worst
}

/// All choices of m out of n.
fn subsets(n: usize, m: usize) -> Vec<Vec<usize>> {
    (0..1_usize << n)
        .filter(|s| s.count_ones() as usize == m)
        .map(|s| (0..n).filter(|i| s >> i & 1 == 1).collect())
        .collect()
}

/// Rates of every partition fulfil the rows; accelerations of all coordinates do not depend on the partition.
#[test]
fn the_partition_does_not_matter() {
    for scene in [cartesian_train(1), cartesian_train(2), cartesian_train(3), turning_rails()] {
        let mut model = build(&scene);
        let first = derived(&model);
        let mut random = Random(17);
        let states: Vec<Vec<f64>> = (0..STATES)
            .map(|_| {
                let mut x = state(&model, &first, &mut random);
                x[model.input_index(model.time)] = 1.0 + random.between(0.0, 1.0); // away from tan(t + 1) and the like
                common::put_rates(&model, &first, &mut x);
                x
            })
            .collect();
        let mut partitions = 0;
        for choice in subsets(model.coordinates.len(), first.kinematics.quasi.len()) {
            model.run.independent = Some(choice.clone());
            let other = match derive(&model, &DeriveOptions { unroll: 0, ..DeriveOptions::default() }) {
                Ok(equations) => equations,
                Err(DeriveError::SingularConstraint { .. }) => continue, // these rates are not independent at the start
                Err(error) => panic!("{}, {choice:?}: {error}", model.title),
            };
            assert_eq!(other.kinematics.quasi.iter().map(|u| u.velocity).collect::<Vec<_>>(), choice);
            partitions += 1;
            for x in &states {
                let growth = model.graph.eval(&other.g.concat(), x).iter().fold(0.0_f64, |a, g| a.max(g.abs()));
                if growth > 30.0 {
                    continue; // badly conditioned there, not wrong
                }
                let mut y = x.clone();
                common::put_rates(&model, &other, &mut y);
                assert!(residuals(&model, &y) < 1e-13, "{}, {choice:?}: {:e}", model.title, residuals(&model, &y));
                let accelerations = |x: &[f64]| -> Vec<f64> {
                    model.coordinates.iter().map(|c| x[model.input_index(c.acceleration)]).collect()
                };
                let (a, b) = (accelerations(x), accelerations(&y));
                let size = a.iter().fold(0.0_f64, |s, a| s.max(a.abs()));
                for (a, b) in a.iter().zip(&b) {
                    assert!((a - b).abs() <= 1e-11 * size, "{}, {choice:?}: q'' {a} against {b}", model.title);
                }
            }
        }
        assert!(partitions >= 3, "{}: {partitions}", model.title);
    }
}

/// `q″` is the derivative of `q′` along the motion, and the rows hold for it too.
#[test]
fn second_rates_are_derivatives_of_rates() {
    at_states(|model, equations, x| {
        let rates = along(model, &equations.kinematics.rates, x);
        for (c, rate) in model.coordinates.iter().zip(&rates) {
            let second = x[model.input_index(c.acceleration)];
            assert_relative_eq!(rate.dot, second, max_relative = 1e-10, epsilon = 1e-10);
        }
        let rows: Vec<NodeId> = model
            .kinematics
            .iter()
            .filter_map(|r| if let RowForm::Zero(n) = r.form { Some(n) } else { None })
            .collect();
        for (row, d) in along(model, &rows, x).iter().enumerate() {
            assert!(d.dot.abs() < 1e-8, "{}, row {row}: {:e}", model.title, d.dot);
        }
    });
}

/// The geometric and the rate form of the same mass give the same equations; so does a train in both coordinates.
#[test]
fn the_form_of_a_structure_does_not_matter() {
    let (a, b) = (build(&sleigh("geometric")), build(&sleigh("rates")));
    let (ea, eb) = (derived(&a), derived(&b));
    let mut random = Random(19);
    for _ in 0..STATES {
        let x = state(&a, &ea, &mut random);
        for (p, q) in accelerations(&a, &ea, &x).iter().zip(accelerations(&b, &eb, &x)) {
            assert_relative_eq!(*p, q, max_relative = 1e-12);
        }
    }
    for n in 1..=4 {
        let (a, b) = (build(&train(n)), build(&cartesian_train(n)));
        let (ea, eb) = (derived(&a), derived(&b));
        let mut random = Random(23);
        for _ in 0..STATES {
            let mut x = headland_dynamics::sample::start_inputs(&a);
            let t = random.between(0.0, 5.0);
            let q: Vec<f64> = a.coordinates.iter().map(|_| random.between(-0.2, 0.2)).collect();
            x[a.input_index(a.time)] = t;
            a.coordinates.iter().zip(&q).for_each(|(c, q)| x[a.input_index(c.q)] = *q);
            x[a.input_index(a.quasi_velocities[0].u)] = random.between(5.0, 20.0);
            common::put_rates(&a, &ea, &mut x);
            let mut y = headland_dynamics::sample::start_inputs(&b);
            y[b.input_index(b.time)] = t;
            for (i, c) in b.coordinates.iter().enumerate() {
                y[b.input_index(c.q)] = q[i];
                y[b.input_index(c.rate)] = x[a.input_index(a.coordinates[i].rate)];
            }
            common::put_rates(&b, &eb, &mut y);
            for (p, q) in a.coordinates.iter().zip(&b.coordinates) {
                let (p, q) = (x[a.input_index(p.acceleration)], y[b.input_index(q.acceleration)]);
                assert_relative_eq!(p, q, max_relative = 1e-10, epsilon = 1e-10);
            }
        }
    }
}
