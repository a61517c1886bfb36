//! [`derive()`]: a model to its equations of motion, by both algorithms where both are cheap.

use headland_expr::{Dual, Expr, NodeId};
use headland_model::tree::JointTree;
use headland_model::{Body, Derived, ElementKind, LinearSolver, Mode, Model, StructureForm};

use crate::combine::{MOST_VELOCITIES, derive_combined, does_not_apply};
use crate::compare::compare_derivations;
use crate::direct::{MassForm, derive_direct};
use crate::energy::{Energies, form_energies};
use crate::error::DeriveError;
use crate::friction::close_friction;
use crate::initial::{assemble, check_defined};
use crate::kinematics::{Kinematics, by_quasi_velocities, solve_kinematics, velocity_inputs};
use crate::reactions::form_derived;
use crate::recursive::{accelerations, derive_recursive, joint_forces, tree_of};
use crate::sample::first_not_finite;
use crate::scalar_inertia::check_scalar_inertia;
use crate::solve::{packed, solve_crout, solve_ldl, unpack};
use crate::structures::form_structures;

/// Which derivation.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Algorithm {
    /// Both where both apply and are cheap; the one with fewer operations is kept.
    #[default]
    Cheaper,
    /// [10]: structures differentiated by the quasi-velocities.
    Direct,
    /// [9]: holonomic equations combined with G.
    Combine,
}

/// What is asked of a derivation.
#[derive(Clone, Copy, Debug)]
pub struct DeriveOptions {
    /// Which derivation.
    pub algorithm: Algorithm,
    /// Compare both at random states; on by default in debug builds.
    pub compare: bool,
    /// Largest number of quasi-velocities for which the solution of `M u′ = F` is unrolled.
    pub unroll: usize,
}

impl Default for DeriveOptions {
    fn default() -> Self {
        Self { algorithm: Algorithm::Cheaper, compare: cfg!(debug_assertions), unroll: 8 }
    }
}

/// Equations (2) and (9) over the model's graph.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Quasi-velocities and rates.
    pub kinematics: Kinematics,
    /// `G`, one row a velocity: rates of the coordinates, then named quasi-velocities.
    pub g: Vec<Vec<NodeId>>,
    /// Lower triangle of M, row by row.
    pub mass: Vec<NodeId>,
    /// F
    pub force: Vec<NodeId>,
    /// `u′` unrolled, where there are few quasi-velocities.
    pub accelerations: Option<Vec<NodeId>>,
    /// Joint forces `Σ Wᵀ P` by quasi-velocities where the recursive algorithms apply.
    pub joint_forces: Option<Vec<NodeId>>,
    /// Rates of the structures, one a row: scalar elements, six a body, three a load.
    pub structure_rates: Vec<NodeId>,
    /// Structural matrices, in the same order.
    pub structure_matrix: Vec<Vec<NodeId>>,
    /// Energies and powers.
    pub energies: Energies,
    /// Matrix of the normal forces of sliding contacts, row by row: its determinant must stay positive.
    pub friction_pivots: Vec<NodeId>,
    /// Values of the model's derived quantities, by u′.
    pub derived: Vec<NodeId>,
    /// Which solver of `M u′ = F`.
    pub linear_solver: LinearSolver,
    /// Which algorithm was kept, and why.
    pub algorithm: &'static str,
    /// Why, in a sentence.
    pub why: String,
    /// Largest relative difference of the two algorithms at random states, where they were compared.
    pub difference: Option<f64>,
}

/// Derives the equations of motion; the start of the model chooses the independent rates.
///
/// # Errors
/// [`DeriveError`] says what the model lacks.
pub fn derive(model: &Model, options: &DeriveOptions) -> Result<Equations, DeriveError> {
    derive_at(model, &assemble(model)?.0, options)
}

/// Derives the equations with the independent rates chosen at the given inputs of the graph.
///
/// # Errors
/// As [`derive()`].
pub fn derive_at(model: &Model, inputs: &[f64], options: &DeriveOptions) -> Result<Equations, DeriveError> {
    let graph = &model.graph;
    let mass_diagonal = mass_diagonal(model, inputs);
    let kinematics = solve_kinematics(model, inputs, &mass_diagonal)?;
    let n = kinematics.quasi.len();
    let tree = tree_of(model, &kinematics);
    let slides = model.contacts.iter().any(|c| c.mode == Mode::Sliding && c.friction.is_some());
    let recursive = tree.filter(|_| n > options.unroll && options.algorithm == Algorithm::Cheaper && !slides);
    let tells_reactions = model.derived.iter().any(|d| matches!(d.what, Derived::Reaction(_) | Derived::Contact(..)));
    let compared = options.compare && n <= MOST_VELOCITIES;
    let structures = form_structures(model, &kinematics, recursive.is_none() || tells_reactions || compared)?;
    let ids = |es: &[Expr<'_>]| -> Vec<NodeId> { es.iter().map(|e| graph.id(*e)).collect() };
    check_fields(model, "the rates", &[&kinematics.velocities, &kinematics.drift, &kinematics.rates])?;
    check_fields(
        model,
        "the forces and inertias",
        &[ids(&structures.bias), ids(&structures.force), ids(&structures.inertia)],
    )?;
    check_scalar_inertia(model, &kinematics, &structures)?;
    let tau = tree.map(|_| joint_forces(model, &kinematics, &structures));
    let chosen = match recursive {
        Some(tree) => {
            choose_recursive(model, &kinematics, &structures, tree, &tau.clone().unwrap_or_default(), compared)?
        }
        None => choose(model, &kinematics, &structures, options)?,
    };
    check_mass(model, &kinematics, &chosen.form, inputs)?;

    let solver = model.run.linear_solver;
    let forces =
        tau.as_ref().filter(|_| solver == LinearSolver::Ldl).map(|tau| tau.iter().map(|e| graph.id(*e)).collect());
    let by_bodies = tree.zip(tau).filter(|_| solver == LinearSolver::Ldl);
    let by_bodies = by_bodies.map(|(tree, tau)| accelerations(model, &kinematics, tree, &tau));
    let by_bodies = by_bodies.map(|es| es.into_iter().map(|e| graph.id(e)).collect::<Vec<_>>());
    let solved = (n <= options.unroll || slides || is_sparse(&chosen.form.m, n)).then(|| {
        let mut f = chosen.form.f.clone();
        match solver {
            _ if is_diagonal(&chosen.form.m, n) => {
                (0..n).for_each(|i| f[i] = f[i] / chosen.form.m[packed(i, i)]);
            }
            LinearSolver::Ldl => solve_ldl(&mut chosen.form.m.clone(), &mut f),
            LinearSolver::Crout => solve_crout(&mut unpack(&chosen.form.m, n), &mut f),
        }
        f.into_iter().map(|e| graph.id(e)).collect::<Vec<_>>()
    });
    let accelerations = match (by_bodies, solved) {
        (Some(a), Some(b)) => Some(if graph.operations(&a) < graph.operations(&b) { a } else { b }),
        (a, b) => a.or(b),
    };
    check_fields(model, "the equations of motion", &[&ids(&chosen.form.m), &ids(&chosen.form.f)])?;
    let g = by_quasi_velocities(model, &kinematics.quasi, &kinematics.velocities);
    let energies = form_energies(model, &kinematics, &structures);
    let mut equations = Equations {
        friction_pivots: Vec::new(),
        derived: form_derived(model, &kinematics, &structures, &energies),
        g,
        mass: ids(&chosen.form.m),
        force: ids(&chosen.form.f),
        accelerations,
        joint_forces: forces,
        structure_rates: ids(&structures.rate),
        structure_matrix: structures.w.iter().map(|row| ids(row)).collect(),
        energies,
        linear_solver: solver,
        algorithm: chosen.algorithm,
        why: chosen.why,
        difference: chosen.difference,
        kinematics,
    };
    close_friction(model, &mut equations);
    Ok(equations)
}

/// Refuses derivatives that fields do not have, before they are met as NaN.
fn check_fields(model: &Model, what: &'static str, nodes: &[impl AsRef<[NodeId]>]) -> Result<(), DeriveError> {
    let missing = nodes.iter().find_map(|nodes| model.graph.beyond_fields(nodes.as_ref()));
    missing.map_or(Ok(()), |field| Err(DeriveError::BeyondField { what, field: field.name().into() }))
}

/// The coordinates whose rates would be eliminated at the given inputs of the graph, in the order of elimination.
///
/// # Errors
/// As [`derive()`], of the kinematics.
pub fn choose_dependent(model: &Model, inputs: &[f64]) -> Result<Vec<usize>, DeriveError> {
    Ok(solve_kinematics(model, inputs, &mass_diagonal(model, inputs))?.dependent)
}

struct Chosen<'g> {
    form: MassForm<'g>,
    algorithm: &'static str,
    why: String,
    difference: Option<f64>,
}

/// Composite bodies, held against [10] where that is cheap.
fn choose_recursive<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    structures: &crate::structures::Structures<'g>,
    tree: &JointTree,
    tau: &[Expr<'g>],
    compare: bool,
) -> Result<Chosen<'g>, DeriveError> {
    let form = derive_recursive(model, kinematics, tree, tau);
    let difference = if compare {
        let direct = derive_direct(kinematics, structures);
        Some(compare_derivations(model, &direct, &form, structures)?)
    } else {
        None
    };
    let why = format!("{} velocities along a tree: sums over pairs of bodies would cost more", kinematics.quasi.len());
    Ok(Chosen { form, algorithm: "recursive", why, difference })
}

fn is_diagonal(m: &[Expr<'_>], n: usize) -> bool {
    (0..n).all(|i| (0..i).all(|j| m[packed(i, j)].is(0.0)))
}

/// Whether `L D Lᵀ` unrolled has few operations for its size: counted on the pattern, fill included.
fn is_sparse(m: &[Expr<'_>], n: usize) -> bool {
    if n > 200 {
        return is_diagonal(m, n);
    }
    let mut there: Vec<bool> = m.iter().map(|e| !e.is(0.0)).collect();
    let mut products = 0;
    for k in 0..n {
        let below: Vec<usize> = (k + 1..n).filter(|&i| there[packed(i, k)]).collect();
        for (a, &i) in below.iter().enumerate() {
            for &j in &below[..=a] {
                there[packed(i, j)] = true;
                products += 1;
            }
        }
    }
    products <= 10 * n
}

/// Both derivations where that is wanted; the cheaper one is kept.
fn choose<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    structures: &crate::structures::Structures<'g>,
    options: &DeriveOptions,
) -> Result<Chosen<'g>, DeriveError> {
    let graph = &model.graph;
    let obstacle = does_not_apply(model);
    if let (Algorithm::Combine, Some(reason)) = (options.algorithm, &obstacle) {
        return Err(DeriveError::CombineDoesNotApply { reason: reason.clone() });
    }
    let direct = derive_direct(kinematics, structures);
    if let Some(reason) = obstacle {
        let why = format!("`combine` does not apply: {reason}");
        return Ok(Chosen { form: direct, algorithm: "direct", why, difference: None });
    }
    if options.algorithm == Algorithm::Direct && !options.compare {
        return Ok(Chosen { form: direct, algorithm: "direct", why: "asked for".into(), difference: None });
    }
    let combined = derive_combined(model, kinematics, structures);
    let difference =
        if options.compare { Some(compare_derivations(model, &direct, &combined, structures)?) } else { None };
    let operations = |form: &MassForm<'g>| {
        let ids: Vec<NodeId> = form.m.iter().chain(&form.f).map(|e| graph.id(*e)).collect();
        graph.operations(&ids)
    };
    let (a, b) = (operations(&direct), operations(&combined));
    let asked = options.algorithm != Algorithm::Cheaper;
    let keep_direct = if asked { options.algorithm == Algorithm::Direct } else { a <= b };
    let why = if asked { "asked for".into() } else { format!("{a} operations by direct, {b} by combine") };
    let (form, algorithm) = if keep_direct { (direct, "direct") } else { (combined, "combine") };
    Ok(Chosen { form, algorithm, why, difference })
}

/// Positive pivots of `L D Lᵀ` at the start.
fn check_mass(model: &Model, kinematics: &Kinematics, form: &MassForm<'_>, inputs: &[f64]) -> Result<(), DeriveError> {
    let graph = &model.graph;
    let n = kinematics.quasi.len();
    let ids: Vec<NodeId> = form.m.iter().map(|e| graph.id(*e)).collect();
    let mut m = graph.eval(&ids, inputs);
    let diagonal: Vec<f64> = (0..n).map(|i| m[packed(i, i)]).collect();
    if let Some(k) = m.iter().position(|x| !x.is_finite()) {
        check_defined(model, inputs)?;
        let name = first_not_finite(model, &[], inputs).unwrap_or(format!("entry {k} of the mass matrix"));
        return Err(DeriveError::NotFinite { name, value: m[k] });
    }
    solve_ldl(&mut m, &mut vec![0.0; n]);
    for i in 0..n {
        let pivot = m[packed(i, i)];
        if pivot.is_nan() || pivot <= 1e-13 * diagonal[i].abs() {
            check_defined(model, inputs)?;
            return Err(DeriveError::SingularMass { name: kinematics.quasi[i].name.clone(), pivot });
        }
    }
    Ok(())
}

/// Diagonal of the mass matrix of the velocities without constraints, `Σ J (∂d′/∂v_j)²`, as numbers.
fn mass_diagonal(model: &Model, inputs: &[f64]) -> Vec<f64> {
    let velocities = velocity_inputs(model);
    if model.kinematics.iter().all(|r| matches!(r.form, headland_model::RowForm::Rate(..))) {
        return vec![0.0; velocities.len()]; // nothing to choose
    }
    let inertial: Vec<_> =
        model.elements.iter().filter(|e| e.kind == ElementKind::Inertia && e.form != StructureForm::Explicit).collect();
    let geometric: Vec<bool> = inertial.iter().map(|e| e.form == StructureForm::Geometric).collect();
    let scalars = inertial.iter().map(|e| (e.value, e.structure));
    let of_body = |b: &Body| {
        let linear = b.velocity.rate.map(|rate| (b.mass, rate));
        let angular = [0, 1, 2].map(|i| (b.tensor[i], b.spin.rate[i]));
        linear.into_iter().chain(angular)
    };
    let (values, structures): (Vec<NodeId>, Vec<NodeId>) = scalars.chain(model.bodies.iter().flat_map(of_body)).unzip();
    let values = model.graph.eval(&values, inputs);
    let mut x: Vec<Dual<f64>> = inputs.iter().map(|v| Dual::new(*v, 0.0)).collect();
    let mut along = |slot: usize, wanted: bool| {
        x[slot].dot = 1.0;
        let rates = model.graph.eval(&structures, &x);
        x[slot].dot = 0.0;
        let terms = rates.iter().zip(&values).enumerate();
        let terms = terms.filter(|(e, _)| geometric.get(*e).is_some_and(|g| *g) == wanted);
        terms.map(|(_, (w, j))| j * w.dot * w.dot).filter(|x| x.is_finite()).sum::<f64>()
    };
    let mut diagonal: Vec<f64> = velocities.iter().map(|(input, _)| along(model.input_index(*input), false)).collect();
    for (sum, c) in diagonal.iter_mut().zip(&model.coordinates) {
        *sum += along(model.input_index(c.q), true);
    }
    diagonal
}

impl Equations {
    /// The nodes with rates and second rates of the coordinates put in: functions of t, q, u and u′ alone.
    pub fn by_state(&self, model: &Model, nodes: &[NodeId]) -> Vec<NodeId> {
        let graph = &model.graph;
        let mut replaced: Vec<Option<Expr<'_>>> = vec![None; graph.input_count()];
        for (v, (input, rate)) in velocity_inputs(model).into_iter().enumerate() {
            if self.kinematics.velocities[v] == input {
                continue; // independent: a quasi-velocity itself
            }
            replaced[model.input_index(input)] = Some(graph.expr(self.kinematics.velocities[v]));
            let mut second = graph.expr(self.kinematics.drift[v]);
            for (k, u) in self.kinematics.quasi.iter().enumerate() {
                second = second + graph.expr(self.g[v][k]) * graph.expr(u.acceleration);
            }
            replaced[model.input_index(rate)] = Some(second);
        }
        for (quantity, value) in model.derived.iter().zip(&self.derived) {
            replaced[model.input_index(quantity.input)] = Some(graph.expr(*value));
        }
        graph.substitute(nodes, |i| replaced[i]).into_iter().map(|e| graph.id(e)).collect()
    }

    /// Degrees of freedom in a sentence: coordinates, less constraints, less prescribed motions.
    pub fn freedom(&self, model: &Model) -> String {
        let (s, p) = (model.coordinates.len(), model.prescribed.len());
        format!(
            "{} of freedom = {} coordinates - {} velocity constraints - {} prescribed",
            match self.kinematics.quasi.len() {
                1 => "1 degree".to_string(),
                n => format!("{n} degrees"),
            },
            s + p,
            self.kinematics.constraints,
            p
        )
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use headland_expr::{Field, Scalar, Wave, field_part};
    use headland_model::Scene;

    use super::*;

    #[test]
    fn derivatives_that_a_field_does_not_have_are_refused() {
        let mut scene = Scene::new("particle");
        scene.entry("coordinates", "x", "m").entry("initial", "x", 0.0).entry("initial", "x'", 0.0);
        scene.element("inertia", &[("name", "m"), ("value", "2 kg"), ("geometric", "x")]);
        let model = scene.build().expect("a right scene");
        let graph = &model.graph;
        let field: Arc<dyn Field> = Arc::new(Wave { name: "road".into(), rate: [1.0; 3], phase: [0.0; 3] });
        let x = graph.expr(model.coordinates[0].q);
        let third = graph.id(Expr::field([x, x, x], &field, field_part(1, 1, 1)).sin());
        assert!(check_fields(&model, "the rates", &[[third]]).is_ok());
        let fourth = graph.id(graph.gradient(third, &[model.coordinates[0].q])[0]);
        let error = check_fields(&model, "the rates", &[vec![third], vec![fourth]]).expect_err("of fourth order");
        assert!(matches!(&error, DeriveError::BeyondField { what: "the rates", field } if field == "road"), "{error}");
    }
}
