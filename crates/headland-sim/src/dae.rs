//! Constrained models as differential-algebraic equations for IDA: [`Descriptor`] compiled, and its steps.
//!
//! ```text
//! y = [q, v, λ, μ]     q′ = G₀ v + g₀ + Φᵀ μ     H v′ + h = Aᵀ λ     A v + a = 0     φ(q, t) = 0        Φ = ∂φ/∂q
//! y = [q, v, λ]        q′ = G₀ v + g₀            H v′ + h = Aᵀ λ     A v′ + A′ v + a′ = 0               (index 1)
//! ```
//! The first form, of index 2, keeps positions and velocities on the constraints; μ is zero but for the error of the
//! method. The second drifts off both. λ and μ are left out of the error test.
//!
//! All functions take `x = [t, q, v, v′, λ, μ, q′]`. Outputs see the state as `[q, v, v′, λ]`, with v′ and λ that follow from q
//! and v ([`crate::rates`]).
//!
//! # References
//! Gear, Gupta, Leimkuhler, *Automatic integration of Euler-Lagrange equations with constraints*, J. Comput. Appl. Math.
//! 12 (1985).

use headland_code::{Evaluator, Function, Jacobian, TapeEvaluator, TapeFunction};
use headland_dynamics::Descriptor;
use headland_expr::{Expr, Graph, NodeId};
use headland_solve::{
    DaeProblem, EvalFailure, Ida, OdeProblem, Options, Pattern, SolveError, StartLevel, Step, Unknown,
};

use crate::rates::{Rates, RatesScratch};
use crate::system::{Copy, Problem};

/// The residual of a descriptor and its exact Jacobian, compiled.
pub struct DaeFunctions {
    /// Names of y.
    names: Vec<String>,
    equations: Vec<String>,
    /// Names of the constraints with a multiplier, and of those on positions.
    constraints: Vec<String>,
    holonomic: Vec<String>,
    differential: Vec<bool>,
    residual: TapeFunction,
    jacobian: Jacobian<TapeFunction>,
    pattern: Pattern,
    /// Of each entry of the compiled Jacobian: its place in the pattern, and whether it is by ẏ.
    places: Vec<(usize, bool)>,
    levels: Vec<StartLevel>,
    /// Residuals of the levels one after the other.
    level_residuals: Vec<TapeFunction>,
    rates: Rates,
    nq: usize,
    nv: usize,
}

/// Which equations stand for the constraints.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// Stabilised index 2.
    Stabilised,
    /// Index 1.
    Index1,
}

/// λ as inputs of the system's graph, declared behind v′.
pub(crate) fn multiplier_inputs<'g>(descriptor: &Descriptor, graph: &'g Graph) -> Vec<Expr<'g>> {
    descriptor.constraints.iter().map(|c| graph.input(&format!("lambda of {}", c.name))).collect()
}

impl DaeFunctions {
    /// Compiles; μ and q′ become inputs of the graph, behind λ.
    pub(crate) fn new(descriptor: &Descriptor, form: Form, scales: &[f64], graph: &Graph, copy: &Copy<'_>) -> Self {
        let kinematics = &descriptor.equations.kinematics;
        let (nq, nv) = (kinematics.rates.len(), kinematics.quasi.len());
        let constraints: Vec<String> = descriptor.constraints.iter().map(|c| c.name.clone()).collect();
        let nl = constraints.len();
        let position = |c: &headland_dynamics::descriptor::Constraint| Some((c.name.clone(), c.position?));
        let (holonomic, phi): (Vec<String>, Vec<NodeId>) = descriptor.constraints.iter().filter_map(position).unzip();
        let coordinate = |i: usize| graph.input_name(1 + i);
        let mut names: Vec<String> = (0..nq).map(coordinate).collect();
        names.extend(kinematics.quasi.iter().map(|u| u.name.clone()));
        names.extend(constraints.iter().map(|c| format!("multiplier of {c}")));

        let expr = |node: NodeId| graph.expr(copy.nodes(&[node])[0]);
        let input = |i: usize| graph.expr(graph.input_id(i));
        let lambda = |k: usize| input(1 + nq + 2 * nv + k);
        let phi = copy.nodes(&phi);
        let q_inputs: Vec<NodeId> = (1..=nq).map(|i| graph.input_id(i)).collect();
        let gradient = graph.jacobian(&phi, &q_inputs);
        let mu: Vec<Expr<'_>> = holonomic.iter().map(|c| graph.input(&format!("mu of {c}"))).collect();
        let rates: Vec<Expr<'_>> = (0..nq).map(|i| graph.input(&format!("d/dt {}", coordinate(i)))).collect();

        // q′ and its equations
        let mut kinematic: Vec<Expr<'_>> = kinematics.rates.iter().zip(&rates).map(|(r, q)| *q - expr(*r)).collect();
        if form == Form::Stabilised {
            for &(k, i, part) in &gradient {
                kinematic[i] = kinematic[i] - part * mu[k];
            }
        }
        let mut dynamic: Vec<Expr<'_>> = descriptor.balance.iter().map(|b| expr(*b)).collect();
        for (k, c) in descriptor.constraints.iter().enumerate() {
            for &(j, a) in &c.entries {
                dynamic[j] = dynamic[j] - expr(a) * lambda(k);
            }
        }
        let velocity: Vec<Expr<'_>> = descriptor.constraints.iter().map(|c| expr(c.velocity)).collect();
        let acceleration: Vec<Expr<'_>> = descriptor.constraints.iter().map(|c| expr(c.acceleration)).collect();
        let position: Vec<Expr<'_>> = phi.iter().map(|p| graph.expr(*p)).collect();
        // φ′ by q′, for μ at the start
        let time = graph.tangent(&phi, |i| (i == 0).then_some(Expr::Const(1.0)));
        let mut drift = time;
        for &(k, i, part) in &gradient {
            drift[k] = drift[k] + part * rates[i];
        }

        let ids = |parts: &[&[Expr<'_>]]| -> Vec<NodeId> {
            parts.iter().flat_map(|p| p.iter()).map(|e| graph.id(*e)).collect()
        };
        let stabilised = form == Form::Stabilised;
        let roots = match form {
            Form::Stabilised => ids(&[&kinematic, &dynamic, &velocity, &position]),
            Form::Index1 => ids(&[&kinematic, &dynamic, &acceleration]),
        };
        if stabilised {
            names.extend(holonomic.iter().map(|c| format!("correction of {c}")));
        }
        let n = names.len();
        let y_inputs = (1..=nq + nv).chain(1 + nq + 2 * nv..1 + nq + 2 * nv + n - nq - nv);
        let first_rate = graph.input_count() - nq;
        let dy_inputs = (first_rate..first_rate + nq).chain(1 + nq + nv..1 + nq + 2 * nv);
        let wanted: Vec<NodeId> = y_inputs.chain(dy_inputs).map(|i| graph.input_id(i)).collect();
        let jacobian = Jacobian::<TapeFunction>::new(graph, &roots, &wanted);
        let (pattern, places) = merge(&jacobian, n);

        let state = |from: usize, to: usize| (from..to).map(Unknown::Y);
        let rate = |from: usize, to: usize| (from..to).map(Unknown::Dy);
        let balance_names = kinematics.quasi.iter().map(|u| format!("balance of {}", u.name));
        let rate_names: Vec<String> = (0..nq).map(|i| format!("rate of {}", coordinate(i))).collect();
        let mut equations = rate_names.clone();
        equations.extend(balance_names.clone());
        let at =
            |what: &str, names: &[String]| -> Vec<String> { names.iter().map(|c| format!("{c} ({what})")).collect() };
        if stabilised {
            equations.extend(at("velocity", &constraints));
            equations.extend(at("position", &holonomic));
        } else {
            equations.extend(at("acceleration", &constraints));
        }

        let mut levels = Vec::new();
        let mut level_residuals = Vec::new();
        let mut level = |names: Vec<String>, unknowns: Vec<Unknown>, scales: Vec<f64>, roots: Vec<NodeId>| {
            if !names.is_empty() {
                levels.push(StartLevel { scales, ..StartLevel::new(names, unknowns) });
                level_residuals.push(TapeFunction::compile(graph, &roots));
            }
        };
        level(at("position", &holonomic), state(0, nq).collect(), scales[..nq].to_vec(), ids(&[&position]));
        level(at("velocity", &constraints), state(nq, nq + nv).collect(), scales[nq..].to_vec(), ids(&[&velocity]));
        let mut third = balance_names.collect::<Vec<_>>();
        third.extend(at("acceleration", &constraints));
        let unknowns: Vec<Unknown> = rate(nq, nq + nv).chain(state(nq + nv, nq + nv + nl)).collect();
        let ones = vec![1.0; unknowns.len()];
        let accelerated = ids(&[&dynamic, &acceleration]);
        level(third, unknowns, ones, accelerated.clone());
        if stabilised && !holonomic.is_empty() {
            let mut fourth = rate_names;
            fourth.extend(at("drift", &holonomic));
            let unknowns: Vec<Unknown> = rate(0, nq).chain(state(nq + nv + nl, n)).collect();
            let ones = vec![1.0; unknowns.len()];
            level(fourth, unknowns, ones, ids(&[&kinematic, &drift]));
        }

        Self {
            differential: (0..n).map(|i| i < nq + nv).collect(),
            residual: TapeFunction::compile(graph, &roots),
            names,
            equations,
            constraints,
            holonomic,
            jacobian,
            pattern,
            places,
            levels,
            level_residuals,
            rates: Rates::new(graph, &accelerated, 1 + nq + nv, nv),
            nq,
            nv,
        }
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Operations of one evaluation of the residual.
    pub fn operations(&self) -> usize {
        self.residual.operations()
    }

    /// Length of `[q, v, v′, λ]`.
    pub fn view_len(&self) -> usize {
        self.nq + 2 * self.nv + self.constraints.len()
    }

    /// How many constraints have a multiplier, and how many of them are on positions.
    pub fn constraints(&self) -> (usize, usize) {
        (self.constraints.len(), self.holonomic.len())
    }

    pub(crate) fn scratch(&self) -> DaeScratch {
        DaeScratch {
            residual: self.residual.evaluator(),
            jacobian: self.jacobian.function().evaluator(),
            levels: self.level_residuals.iter().map(Function::evaluator).collect(),
            rates: self.rates.scratch(),
        }
    }
}

/// The pattern of `∂F/∂y + c ∂F/∂ẏ` from the Jacobian by `[y, ẏ_differential]`.
fn merge(jacobian: &Jacobian<TapeFunction>, n: usize) -> (Pattern, Vec<(usize, bool)>) {
    let (ptr, rows) = (jacobian.col_ptr(), jacobian.row_index());
    let columns = ptr.len() - 1;
    let entries: Vec<(usize, usize, bool)> = (0..columns)
        .flat_map(|j| {
            rows[ptr[j]..ptr[j + 1]].iter().map(move |i| if j < n { (*i, j, false) } else { (*i, j - n, true) })
        })
        .collect();
    let pattern = Pattern::from_entries(n, n, entries.iter().map(|(i, j, _)| (*i, *j)));
    let place = |i: usize, j: usize| {
        let column = pattern.col_ptr()[j]..pattern.col_ptr()[j + 1];
        column.clone().find(|&k| pattern.row_idx()[k] == i).unwrap_or(column.start)
    };
    let places = entries.iter().map(|&(i, j, by_rate)| (place(i, j), by_rate)).collect();
    (pattern, places)
}

/// One thread's scratch.
pub(crate) struct DaeScratch {
    residual: TapeEvaluator,
    jacobian: TapeEvaluator,
    levels: Vec<TapeEvaluator>,
    rates: RatesScratch,
}

impl Problem {
    /// `x` from `y = [q, v, λ, μ]` and ẏ.
    fn load_dae(&mut self, t: f64, y: &[f64], dy: &[f64]) {
        let (nq, nv) = (self.system.nq, self.system.nu);
        self.load(t, &y[..nq + nv]);
        let x = &mut self.x;
        x[1 + nq + nv..1 + nq + 2 * nv].copy_from_slice(&dy[nq..nq + nv]);
        let algebraic = &y[nq + nv..];
        x[1 + nq + 2 * nv..1 + nq + 2 * nv + algebraic.len()].copy_from_slice(algebraic);
        let first = x.len() - nq;
        x[first..].copy_from_slice(&dy[..nq]);
    }
}

impl Problem {
    /// v′ and λ in `x = [t, q, v, v′, λ, ..]` as they follow from q and v.
    pub(crate) fn settle_rates(&mut self) {
        let system = self.system.clone();
        if let (Some(functions), Some(scratch)) = (&system.dae, &mut self.dae) {
            scratch.rates.solve(&functions.rates, &mut self.x);
        }
    }
}

impl DaeProblem for Problem {
    fn len(&self) -> usize {
        self.system.dae.as_ref().map_or(0, DaeFunctions::len)
    }

    fn differential(&self) -> &[bool] {
        self.system.dae.as_ref().map_or(&[], |d| &d.differential)
    }

    fn residual(&mut self, t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Result<(), EvalFailure> {
        self.load_dae(t, y, dy);
        let scratch = self.dae.as_mut().ok_or(EvalFailure::Fatal)?;
        r.copy_from_slice(scratch.residual.eval(&self.x));
        if self.not_finite.is_none() && r.iter().any(|x| !x.is_finite()) {
            self.not_finite = Some((t, y[..self.system.len()].to_vec()));
        }
        Ok(())
    }

    fn pattern(&self) -> Option<&Pattern> {
        self.system.dae.as_ref().filter(|d| d.jacobian.is_known()).map(|d| &d.pattern)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], dy: &[f64], c: f64, values: &mut [f64]) -> Result<(), EvalFailure> {
        self.load_dae(t, y, dy);
        let system = self.system.clone();
        let (Some(functions), Some(scratch)) = (&system.dae, &mut self.dae) else { return Err(EvalFailure::Fatal) };
        values.fill(0.0);
        for (value, (place, by_rate)) in scratch.jacobian.eval(&self.x).iter().zip(&functions.places) {
            values[*place] += if *by_rate { c * value } else { *value };
        }
        Ok(())
    }

    fn in_error_test(&self, i: usize) -> bool {
        i < self.system.len()
    }

    fn event_count(&self) -> usize {
        self.system.watches.len()
    }

    fn events(&mut self, t: f64, y: &[f64], dy: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
        self.load_dae(t, y, dy);
        if self.system.events.reads_accelerations {
            self.settle_rates();
        }
        self.watch(g);
        Ok(())
    }

    fn start_levels(&self) -> Vec<StartLevel> {
        self.system.dae.as_ref().map_or_else(Vec::new, |d| d.levels.clone())
    }

    fn start_residual(
        &mut self,
        level: usize,
        t: f64,
        y: &[f64],
        dy: &[f64],
        r: &mut [f64],
    ) -> Result<(), EvalFailure> {
        self.load_dae(t, y, dy);
        let scratch = self.dae.as_mut().ok_or(EvalFailure::Fatal)?;
        r.copy_from_slice(scratch.levels[level].eval(&self.x));
        Ok(())
    }

    fn component_name(&self, i: usize) -> String {
        self.system.dae.as_ref().map_or_else(String::new, |d| d.names[i].clone())
    }

    fn equation_name(&self, i: usize) -> String {
        self.system.dae.as_ref().map_or_else(String::new, |d| d.equations[i].clone())
    }
}

/// Absolute tolerance of λ and μ while stepping: none. What rounding leaves in a velocity or a position is in them, divided
/// by the step; Newton's iteration, which alone looks at them, would fail by that at short steps, the more the shorter. What
/// they do is in the velocities and coordinates, which are looked at.
const UNTESTED: f64 = 1e9;

/// Part of the tolerances to which Newton's iteration is driven: with the library's 0.33, and multipliers not looked at, what
/// the iteration leaves disturbs the choice of steps, which are half as many again.
const ITERATION: f64 = 0.01;

/// IDA at work on a [`Problem`] whose system has [`DaeFunctions`].
pub struct DaeStepper {
    pub(crate) ida: Ida,
    /// Makes starts consistent, multipliers included.
    strict: Ida,
    /// `[q, v, v′, λ]`
    pub(crate) view: Vec<f64>,
    pub(crate) notes: Vec<String>,
    options: Options,
    started: bool,
    y: Vec<f64>,
    dy: Vec<f64>,
    nq: usize,
    nv: usize,
    nl: usize,
}

impl DaeStepper {
    /// For a system; `options` are those for `[q, v]`.
    ///
    /// # Errors
    /// As [`Ida::new`].
    pub fn new(functions: &DaeFunctions, mut options: Options) -> Result<Self, SolveError> {
        let n = functions.len();
        let (nq, nv, nl) = (functions.nq, functions.nv, functions.constraints.len());
        options.atol.resize(n, options.rtol);
        let strict = Ida::new(n, options.clone())?;
        options.atol[nq + nv..].fill(UNTESTED);
        options.iteration_tolerance = ITERATION;
        let view = vec![0.0; functions.view_len()];
        let (y, dy) = (vec![0.0; n], vec![0.0; n]);
        Ok(Self {
            ida: Ida::new(n, options.clone())?,
            strict,
            options,
            started: false,
            view,
            notes: Vec::new(),
            y,
            dy,
            nq,
            nv,
            nl,
        })
    }

    /// Starts at `[q, v]` or `[q, v, v′, λ]`, made consistent.
    pub(crate) fn start(&mut self, problem: &mut Problem, t: f64, state: &[f64]) -> Result<(), SolveError> {
        let (nq, nv) = (self.nq, self.nv);
        self.y.fill(0.0);
        self.dy.fill(0.0);
        self.y[..nq + nv].copy_from_slice(&state[..nq + nv]);
        let mut rates = vec![0.0; nq + nv];
        let _ = OdeProblem::rhs(problem, t, &state[..nq + nv], &mut rates);
        self.dy[..nq].copy_from_slice(&rates[..nq]);
        if state.len() > nq + nv {
            self.dy[nq..nq + nv].copy_from_slice(&state[nq + nv..nq + 2 * nv]);
            self.y[nq + nv..nq + nv + self.nl].copy_from_slice(&state[nq + 2 * nv..]);
        }
        let report = self.strict.make_consistent(problem, t, &mut self.y, &mut self.dy)?;
        for change in &report.changes {
            let name = &change.component;
            if (0..nq + nv).any(|i| DaeProblem::component_name(problem, i) == *name) {
                let (before, after) = (change.before, change.after);
                self.notes.push(format!("start: `{name}` changed from {before} to {after} to fulfil the constraints"));
            }
        }
        for set in &report.redundant {
            self.notes.push(format!("start: these constraints say the same: {}", set.join(", ")));
        }
        if !self.started {
            self.options.h_first = self.first_step();
            self.ida = Ida::new(self.y.len(), self.options.clone())?;
            self.started = true;
        }
        self.ida.start(problem, t, &self.y, &self.dy)?;
        self.show();
        Ok(())
    }

    /// A first step for a formula of order 1. The library's own guess holds the rates against the tolerances, and where a
    /// machine starts from rest that is so short that rounding hides the constraints.
    fn first_step(&self) -> Option<f64> {
        let rtol = self.options.rtol;
        let time = |i: usize| (self.options.atol[i] / rtol + self.y[i].abs()) / self.dy[i].abs();
        let shortest = (0..self.nq + self.nv).map(time).fold(f64::INFINITY, f64::min);
        let h = 0.1 * rtol.sqrt() * shortest;
        (h > 0.0 && h.is_finite()).then_some(h.min(self.options.h_max))
    }

    pub(crate) fn step(&mut self, problem: &mut Problem, t_stop: f64) -> Result<Step, SolveError> {
        let step = self.ida.step(problem, t_stop);
        self.y.copy_from_slice(self.ida.y());
        self.dy.copy_from_slice(self.ida.dy());
        self.show();
        step
    }

    pub(crate) fn interpolate(&mut self, problem: &mut Problem, t: f64, view: &mut [f64]) -> Result<(), SolveError> {
        self.ida.interpolate(problem, t, &mut self.y, &mut self.dy)?;
        write_view(&self.y, &self.dy, (self.nq, self.nv), view);
        Ok(())
    }

    fn show(&mut self) {
        let mut view = std::mem::take(&mut self.view);
        write_view(&self.y, &self.dy, (self.nq, self.nv), &mut view);
        self.view = view;
    }
}

fn write_view(y: &[f64], dy: &[f64], (nq, nv): (usize, usize), view: &mut [f64]) {
    let s = nq + nv;
    view[..s].copy_from_slice(&y[..s]);
    view[s..s + nv].copy_from_slice(&dy[nq..s]);
    let nl = view.len() - s - nv;
    view[s + nv..].copy_from_slice(&y[s..s + nl]);
}
