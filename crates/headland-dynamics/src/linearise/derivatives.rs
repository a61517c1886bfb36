//! [`Derivatives`]: A and B at a state, column by column with dual numbers.

use headland_expr::timeline::timeline;
use headland_expr::{Dual, NodeId};
use headland_model::Model;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, LU};

use super::carried::{Carried, triples};
use super::tangent::Tangent;
use super::{LinearState, LineariseError};
use crate::derive::Equations;
use crate::initial::Positions;
use crate::sample::first_not_finite;
use crate::solve::packed;

/// What is differentiated, and by what.
pub(super) struct Derivatives<'m> {
    pub(super) model: &'m Model,
    pub(super) equations: &'m Equations,
    tangent: Tangent,
    /// Rates, lower triangle of M, F.
    roots: Vec<NodeId>,
    /// Parameters by position.
    parameters: Vec<usize>,
    /// Axes that do not spin with their bodies.
    carried: Vec<Carried>,
    /// When they coincide with the bodies'.
    start: f64,
}

/// The matrices at a state.
pub(super) struct Point {
    /// `[q′, u′]`
    pub(super) rates: Vec<f64>,
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) mass: DMatrix<f64>,
}

/// Largest residual of a constraint on positions at a state to linearise about.
const ON_CONSTRAINTS: f64 = 1e-8;

impl<'m> Derivatives<'m> {
    pub(super) fn new(
        model: &'m Model,
        equations: &'m Equations,
        t: f64,
        y: &[f64],
        inputs: &[String],
    ) -> Result<Self, LineariseError> {
        let find = |name: &String| {
            let known = || model.parameters.iter().map(|p| p.name.clone()).collect::<Vec<_>>().join(", ");
            let found = model.parameters.iter().position(|p| p.name == *name);
            found.ok_or_else(|| LineariseError::UnknownInput { name: name.clone(), known: known() })
        };
        let parameters = inputs.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        let roots = [equations.kinematics.rates.as_slice(), &equations.mass, &equations.force].concat();
        let x = inputs_at(model, equations, t, y);
        let residual = Positions::new(model).residual(&x);
        if residual.is_nan() || residual > ON_CONSTRAINTS {
            return Err(LineariseError::OffConstraints { residual });
        }
        let tangent = Tangent::new(model, &equations.kinematics, &x)?;
        if let Some(&p) = parameters.iter().find(|p| tangent.depends_on(model.parameters[**p].input)) {
            return Err(LineariseError::InputMovesConstraints { name: model.parameters[p].name.clone() });
        }
        Ok(Self { model, equations, tangent, roots, parameters, carried: Vec::new(), start: t })
    }

    /// Takes axes that do not spin with balls, as the motion at the state suggests; false if there is nothing to take.
    pub(super) fn carry(&mut self, t: f64, y: &[f64]) -> Result<bool, LineariseError> {
        let (nq, ns) = (self.sizes().0, self.displacements());
        let here = self.at(t, y)?;
        let second = self.second_rates(t, y, &here.rates);
        let turns: Vec<&str> = self.tangent.displacements.iter().map(|(name, ..)| name.as_str()).collect();
        let velocities: Vec<&str> = self.equations.kinematics.quasi.iter().map(|u| u.name.as_str()).collect();
        let found = triples(&turns, &velocities).into_iter().filter_map(|triple| {
            let of = |values: &[f64]| triple.velocities.map(|k| values[k]);
            Carried::new(triple.clone(), of(&y[nq..]), of(&here.rates[nq..]), of(&second), &here.a, ns)
        });
        self.carried = found.collect();
        Ok(!self.carried.is_empty())
    }

    /// u″ along the motion.
    fn second_rates(&self, t: f64, y: &[f64], rates: &[f64]) -> Vec<f64> {
        let (nq, nu) = self.sizes();
        let model = self.model;
        let numbers = inputs_at(model, self.equations, t, y);
        let mut x: Vec<Dual<f64>> = numbers.iter().map(|v| Dual::new(*v, 0.0)).collect();
        x[model.input_index(model.time)].dot = 1.0;
        model.coordinates.iter().zip(rates).for_each(|(c, rate)| x[model.input_index(c.q)].dot = *rate);
        let quasi = &self.equations.kinematics.quasi;
        quasi.iter().zip(&rates[nq..]).for_each(|(u, rate)| x[model.input_index(u.u)].dot = *rate);
        let values = model.graph.eval(&self.roots, &x);
        let rest = &values[nq..];
        let m = DMatrix::from_fn(nu, nu, |i, j| rest[packed(i.max(j), i.min(j))].value);
        let force = |i: usize| {
            let turned: f64 = (0..nu).map(|j| rest[packed(i.max(j), i.min(j))].dot * rates[nq + j]).sum();
            rest[nu * (nu + 1) / 2 + i].dot - turned
        };
        solve(&m.lu(), DVector::from_fn(nu, |i, _| force(i))).iter().copied().collect()
    }

    pub(super) fn displacements(&self) -> usize {
        self.tangent.displacements.len()
    }

    /// Number of coordinates and of quasi-velocities.
    pub(super) fn sizes(&self) -> (usize, usize) {
        (self.model.coordinates.len(), self.equations.kinematics.quasi.len())
    }

    /// Whether the equations contain the time itself.
    pub(super) fn depends_on_time(&self) -> bool {
        let time = self.model.input_index(self.model.time);
        self.model.graph.depends(&self.roots, |i| i == time).contains(&true) || self.tangent.depends_on(time)
    }

    /// Times after t at which functions of time show whether they change: spread over the run, and between breakpoints.
    pub(super) fn telling_times(&self, t: f64) -> Vec<f64> {
        let (model, until) = (self.model, self.model.run.until);
        let (inputs, time) = (model.inputs(), model.input_index(model.time));
        let mut varying = vec![true; inputs.len()];
        varying[time] = false;
        model.parameters.iter().for_each(|p| varying[p.input] = false);
        let found = timeline(&model.graph, &self.roots, time, &inputs, |i| varying[i], t, until);
        let mut borders = found.breakpoints;
        borders.extend(found.windows.iter().flat_map(|w| [w.start, w.end]));
        borders.extend((0..=16).map(|k| t + (until - t) * f64::from(k) / 16.0));
        borders.retain(|b| (t..=until).contains(b));
        borders.sort_by(f64::total_cmp);
        borders.dedup();
        // not in the middle: what swings may be zero there
        borders.windows(2).take(500).map(|ends| ends[0] + 0.37 * (ends[1] - ends[0])).collect()
    }

    pub(super) fn states(&self, y: &[f64], cyclic: &[bool]) -> Vec<LinearState> {
        let displacements = self.tangent.displacements.iter().zip(cyclic).map(|((name, unit, coordinate), cyclic)| {
            let value = coordinate.map_or(0.0, |i| y[i]);
            LinearState { name: name.clone(), unit: unit.clone(), value, cyclic: *cyclic }
        });
        let (quasi, u) = (&self.equations.kinematics.quasi, &y[self.sizes().0..]);
        let velocities = quasi.iter().zip(u).map(|(u, value)| LinearState {
            name: u.name.clone(),
            unit: u.unit.clone(),
            value: *value,
            cyclic: false,
        });
        let mut states: Vec<LinearState> = displacements.chain(velocities).collect();
        for carried in &self.carried {
            for (turn, name) in carried.triple.turns.into_iter().zip(carried.names()) {
                states[turn].name = name;
            }
        }
        states
    }

    pub(super) fn inputs(&self) -> Vec<LinearState> {
        let parameters = self.parameters.iter().map(|&p| &self.model.parameters[p]);
        let state = |p: &headland_model::model::Parameter| LinearState {
            name: p.name.clone(),
            unit: p.unit.clone(),
            value: p.value,
            cyclic: false,
        };
        parameters.map(state).collect()
    }

    /// `[q′, u′]`
    pub(super) fn rates(&self, t: f64, y: &[f64]) -> Result<Vec<f64>, LineariseError> {
        let x = inputs_at(self.model, self.equations, t, y);
        let values = self.model.graph.eval(&self.roots, &x);
        let (nq, nu) = self.sizes();
        let solver = self.factor(&values[nq..], t, &x)?;
        let u = solve(&solver, DVector::from_column_slice(&values[values.len() - nu..]));
        Ok(values[..nq].iter().chain(u.iter()).copied().collect())
    }

    /// M, factored.
    fn factor(&self, values: &[f64], t: f64, x: &[f64]) -> Result<LU<f64, Dyn, Dyn>, LineariseError> {
        let nu = self.sizes().1;
        let m = DMatrix::from_fn(nu, nu, |i, j| values[packed(i.max(j), i.min(j))]);
        let finite = values.iter().all(|v| v.is_finite());
        let factored = if finite { Some(m.lu()) } else { None };
        factored.filter(LU::is_invertible).ok_or_else(|| {
            let found = first_not_finite(self.model, &[], x);
            let what = found.unwrap_or_else(|| "the inverse of the mass matrix".into());
            LineariseError::NotFinite { what, t }
        })
    }

    /// A and B, one column a direction of dual numbers.
    pub(super) fn at(&self, t: f64, y: &[f64]) -> Result<Point, LineariseError> {
        let ((nq, nu), ns, np) = (self.sizes(), self.displacements(), self.parameters.len());
        let model = self.model;
        let numbers = inputs_at(model, self.equations, t, y);
        let mut x: Vec<Dual<f64>> = numbers.iter().map(|v| Dual::new(*v, 0.0)).collect();
        let q_slots: Vec<usize> = model.coordinates.iter().map(|c| model.input_index(c.q)).collect();
        let u_slots: Vec<usize> = self.equations.kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();

        let here = model.graph.eval(&self.roots, &numbers);
        let solver = self.factor(&here[nq..], t, &numbers)?;
        let u_rate = solve(&solver, DVector::from_column_slice(&here[here.len() - nu..]));

        // T and its rate along the motion
        let time = model.input_index(model.time);
        x[time].dot = 1.0;
        q_slots.iter().zip(&here).for_each(|(&slot, rate)| x[slot].dot = *rate);
        let (basis, basis_rate) = self.tangent.eval(&x);
        x.iter_mut().for_each(|v| v.dot = 0.0);
        let left = LeftInverse::new(&basis);

        let mut a = DMatrix::zeros(ns + nu, ns + nu);
        let mut b = DMatrix::zeros(ns + nu, np);
        let along = |x: &[Dual<f64>]| {
            let values = model.graph.eval(&self.roots, x);
            let q = DVector::from_iterator(nq, values[..nq].iter().map(|v| v.dot));
            let rest = &values[nq..];
            let triangle = nu * (nu + 1) / 2;
            let force = |i: usize| {
                let turned: f64 = (0..nu).map(|j| rest[packed(i.max(j), i.min(j))].dot * u_rate[j]).sum();
                rest[triangle + i].dot - turned
            };
            (q, solve(&solver, DVector::from_fn(nu, |i, _| force(i))))
        };
        for j in 0..ns {
            q_slots.iter().enumerate().for_each(|(i, &slot)| x[slot].dot = basis[(i, j)]);
            let (q, u) = along(&x);
            put(&mut a, j, &left.apply(&(q - basis_rate.column(j))), &u);
        }
        q_slots.iter().for_each(|&slot| x[slot].dot = 0.0);
        for (k, &slot) in u_slots.iter().enumerate() {
            x[slot].dot = 1.0;
            let (q, u) = along(&x);
            put(&mut a, ns + k, &left.apply(&q), &u);
            x[slot].dot = 0.0;
        }
        for (k, &p) in self.parameters.iter().enumerate() {
            x[model.parameters[p].input].dot = 1.0;
            let (q, u) = along(&x);
            put(&mut b, k, &left.apply(&q), &u);
            x[model.parameters[p].input].dot = 0.0;
        }
        if a.iter().chain(b.iter()).any(|v| !v.is_finite()) {
            return Err(LineariseError::NotFinite { what: "a derivative of the equations of motion".into(), t });
        }
        let mass = DMatrix::from_fn(nu, nu, |i, j| here[nq + packed(i.max(j), i.min(j))]);
        let rates = here[..nq].iter().chain(u_rate.iter()).copied().collect();
        let mut point = Point { rates, a, b, mass };
        for carried in &self.carried {
            carried.apply(&mut point, t - self.start, &y[nq..], nq, ns);
        }
        Ok(point)
    }
}

/// `M⁻¹ F` with M in factors that were found to have an inverse.
fn solve(solver: &LU<f64, Dyn, Dyn>, mut force: DVector<f64>) -> DVector<f64> {
    if !solver.solve_mut(&mut force) {
        force.fill(f64::NAN);
    }
    force
}

fn put(matrix: &mut DMatrix<f64>, column: usize, s: &DVector<f64>, u: &DVector<f64>) {
    for (i, value) in s.iter().chain(u.iter()).enumerate() {
        matrix[(i, column)] = *value;
    }
}

/// `T⁺`, of columns that are independent: any left inverse serves, since what it is applied to is in their range.
struct LeftInverse(DMatrix<f64>);

impl LeftInverse {
    fn new(basis: &DMatrix<f64>) -> Self {
        let gram = basis.transpose() * basis;
        Self(Cholesky::new(gram).map_or_else(
            || basis.clone().pseudo_inverse(1e-12).unwrap_or_else(|_| basis.transpose()),
            |factored| factored.solve(&basis.transpose()),
        ))
    }

    fn apply(&self, q: &DVector<f64>) -> DVector<f64> {
        &self.0 * q
    }
}

/// The inputs of the graph at a state; rates of coordinates that are no quasi-velocities do not occur in the equations.
fn inputs_at(model: &Model, equations: &Equations, t: f64, y: &[f64]) -> Vec<f64> {
    let nq = model.coordinates.len();
    assert_eq!(y.len(), nq + equations.kinematics.quasi.len(), "linearise: the state is [q, u]");
    let mut x = model.inputs();
    x[model.input_index(model.time)] = t;
    model.coordinates.iter().zip(y).for_each(|(c, q)| x[model.input_index(c.q)] = *q);
    equations.kinematics.quasi.iter().zip(&y[nq..]).for_each(|(u, value)| x[model.input_index(u.u)] = *value);
    x
}
