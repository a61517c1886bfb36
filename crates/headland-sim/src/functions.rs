//! [`StateFunctions`]: M, F, q′, u′ and their Jacobian at states that someone else chooses.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use headland_code::{Evaluator, Function, Jacobian, TapeEvaluator, TapeFunction};
use headland_dynamics::solve::{packed, solve_crout, solve_ldl, unpack};
use headland_dynamics::{DeriveError, Equations};
use headland_expr::{Graph, NodeId};
use headland_model::{LinearSolver, Model};

use crate::system::{Copy, force_residuals, solve_factored};
use crate::work::start_state;

/// Points evaluated in one pass: enough for all lanes, few enough for the cache.
const BLOCK: usize = 256;

/// A function of a state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StateFunction {
    /// Rates of the coordinates `q′ = G u + g`: nq.
    Rates,
    /// Mass matrix M, whole: nu × nu.
    Mass,
    /// Generalised forces F, everything of `M u′ = F` that is not `M u′`: nu.
    Force,
    /// `u′ = M⁻¹ F`: nu.
    Accelerations,
    /// `∂[q′, u′]/∂[q, u]`, exact: n × n with `n = nq + nu`. NaN where it needs a derivative that a surface or table of two
    /// variables does not have ([`Jacobian::is_known`]).
    Jacobian,
}

/// The equations of motion as functions of `t` and the state `y = [q, u]`, compiled with the model's parameters folded
/// in. Shared between threads and cheap to clone; the scratch of one thread is a [`StateEvaluator`].
///
/// The independent rates are those of the equations, whatever the state; functions of time are taken as they are
/// written, also at their jumps.
///
/// ```
/// use headland_dynamics::{DeriveOptions, derive};
/// use headland_model::Scene;
/// use headland_sim::{StateFunction, StateFunctions};
///
/// let mut scene = Scene::new("oscillator");
/// scene.entry("coordinates", "x", "m").entry("initial", "x", 1.0).entry("initial", "x'", 0.5);
/// scene.element("inertia", &[("name", "m"), ("value", "2"), ("geometric", "x")]);
/// scene.element("elastic", &[("name", "c"), ("value", "8"), ("geometric", "x")]);
/// let model = scene.build()?;
/// let functions = StateFunctions::new(&model, &derive(&model, &DeriveOptions::default())?);
/// let mut evaluator = functions.evaluator();
///
/// let mut a = [0.0; 2]; // two states at once
/// evaluator.eval(StateFunction::Accelerations, &[0.0, 0.0], &[1.0, 0.5, 0.25, 0.0], &mut a);
/// assert_eq!(a, [-4.0, -1.0]);
/// let mut j = [0.0; 4];
/// evaluator.eval(StateFunction::Jacobian, &[0.0], &[1.0, 0.5], &mut j);
/// assert_eq!(j, [0.0, 1.0, -4.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct StateFunctions(Arc<Compiled>);

struct Compiled {
    nq: usize,
    nu: usize,
    /// Whether u′ is unrolled; if not, M and F are evaluated and solved by numbers.
    unrolled: bool,
    linear_solver: LinearSolver,
    rates: TapeFunction,
    mass: TapeFunction,
    force: TapeFunction,
    /// u′, or the lower triangle of M and F.
    dynamics: TapeFunction,
    /// Of `[q′, u′]`, or of `[q′, M a − F]` with a the inputs u′; made when first asked for.
    jacobian: OnceLock<Jacobian<TapeFunction>>,
    source: Mutex<JacobianSource>,
}

/// What the Jacobian is made of, over `x = [t, y, u′]`.
struct JacobianSource {
    graph: Graph,
    rates: Vec<NodeId>,
    dynamics: Vec<NodeId>,
}

impl StateFunctions {
    /// Compiles the equations with the model's parameters folded in.
    pub fn new(model: &Model, equations: &Equations) -> Self {
        let graph = Graph::new();
        let copy = Copy::new(model, &equations.kinematics, &graph);
        let rates = copy.nodes(&equations.kinematics.rates);
        let mass = copy.nodes(&equations.mass);
        let force = copy.nodes(&equations.force);
        let dynamics = match &equations.accelerations {
            Some(accelerations) => copy.nodes(accelerations),
            None => [mass.as_slice(), force.as_slice()].concat(),
        };
        let compile = |nodes: &[NodeId]| TapeFunction::compile(&graph, nodes);
        Self(Arc::new(Compiled {
            nq: rates.len(),
            nu: force.len(),
            unrolled: equations.accelerations.is_some(),
            linear_solver: equations.linear_solver,
            rates: compile(&rates),
            mass: compile(&mass),
            force: compile(&force),
            dynamics: compile(&dynamics),
            jacobian: OnceLock::new(),
            source: Mutex::new(JacobianSource { graph, rates, dynamics }),
        }))
    }

    /// Number of coordinates.
    pub fn nq(&self) -> usize {
        self.0.nq
    }

    /// Number of quasi-velocities.
    pub fn nu(&self) -> usize {
        self.0.nu
    }

    /// Rows and columns of a function's value, which is stored row by row; a vector has one column.
    pub fn shape(&self, what: StateFunction) -> (usize, usize) {
        let (nq, nu) = (self.0.nq, self.0.nu);
        match what {
            StateFunction::Rates => (nq, 1),
            StateFunction::Mass => (nu, nu),
            StateFunction::Force | StateFunction::Accelerations => (nu, 1),
            StateFunction::Jacobian => (nq + nu, nq + nu),
        }
    }

    /// New scratch; one a thread.
    pub fn evaluator(&self) -> StateEvaluator {
        StateEvaluator {
            functions: self.clone(),
            evaluators: Default::default(),
            x: Vec::new(),
            raw: Vec::new(),
            m: Vec::new(),
            f: Vec::new(),
        }
    }
}

impl Compiled {
    fn jacobian(&self) -> &Jacobian<TapeFunction> {
        self.jacobian.get_or_init(|| {
            let source = self.source.lock().unwrap_or_else(PoisonError::into_inner);
            let graph = &source.graph;
            let states: Vec<NodeId> = (1..=self.nq + self.nu).map(|i| graph.input_id(i)).collect();
            let mut roots = source.rates.clone();
            if self.unrolled {
                roots.extend(&source.dynamics);
            } else {
                let (mass, force) = source.dynamics.split_at(self.nu * (self.nu + 1) / 2);
                roots.extend(force_residuals(graph, 1 + self.nq + self.nu, mass, force));
            }
            Jacobian::new(graph, &roots, &states)
        })
    }

    fn function(&self, what: StateFunction) -> &TapeFunction {
        match what {
            StateFunction::Rates => &self.rates,
            StateFunction::Mass => &self.mass,
            StateFunction::Force => &self.force,
            StateFunction::Accelerations => &self.dynamics,
            StateFunction::Jacobian => self.jacobian().function(),
        }
    }
}

/// Scratch of one thread for [`StateFunctions`].
pub struct StateEvaluator {
    functions: StateFunctions,
    evaluators: [Option<TapeEvaluator>; 5],
    /// `x[input][point]`
    x: Vec<Vec<f64>>,
    /// What a compiled function gave at one point.
    raw: Vec<f64>,
    m: Vec<f64>,
    f: Vec<f64>,
}

impl StateEvaluator {
    /// Evaluates at many states: `t[point]`, `y[point][state]` row by row, `out[point][row][column]`.
    ///
    /// The same bits as state by state.
    ///
    /// # Panics
    /// If `y` or `out` is not as long as the number of times asks for.
    pub fn eval(&mut self, what: StateFunction, t: &[f64], y: &[f64], out: &mut [f64]) {
        let (rows, columns) = self.functions.shape(what);
        let (n, size) = (self.functions.nq() + self.functions.nu(), rows * columns);
        assert_eq!(y.len(), n * t.len(), "eval: states are times by {n}");
        assert_eq!(out.len(), size * t.len(), "eval: values are times by {size}");
        let by_points = what == StateFunction::Jacobian && !self.functions.0.unrolled; // a factorization each
        let block = if by_points { 1 } else { BLOCK };
        for from in (0..t.len()).step_by(block) {
            let until = (from + block).min(t.len());
            self.load(&t[from..until], &y[n * from..n * until]);
            if by_points {
                self.solve_for_accelerations();
            }
            self.eval_block(what, until - from, &mut out[size * from..size * until]);
        }
    }

    /// `x = [t, y, u′]` with u′ zero.
    fn load(&mut self, t: &[f64], y: &[f64]) {
        let n = self.functions.nq() + self.functions.nu();
        self.x.resize(1 + n + self.functions.nu(), Vec::new());
        for (i, row) in self.x.iter_mut().enumerate() {
            row.clear();
            match i {
                0 => row.extend_from_slice(t),
                i if i <= n => row.extend((0..t.len()).map(|p| y[n * p + i - 1])),
                _ => row.resize(t.len(), 0.0),
            }
        }
    }

    /// Puts `u′ = M⁻¹ F` into x, for a single point; L and D stay in `m`.
    fn solve_for_accelerations(&mut self) {
        let functions = self.functions.0.clone();
        let triangle = functions.nu * (functions.nu + 1) / 2;
        let Self { evaluators, x, m, f, .. } = self;
        point(evaluators, &functions, StateFunction::Accelerations, x, &mut self.raw);
        m.clear();
        m.extend_from_slice(&self.raw[..triangle]);
        f.clear();
        f.extend_from_slice(&self.raw[triangle..]);
        solve_ldl(m, f);
        let first = x.len() - functions.nu;
        for (row, a) in x[first..].iter_mut().zip(f) {
            row[0] = *a;
        }
    }

    fn eval_block(&mut self, what: StateFunction, points: usize, out: &mut [f64]) {
        let functions = self.functions.0.clone();
        let size = out.len() / points;
        if points == 1 {
            let mut raw = std::mem::take(&mut self.raw);
            point(&mut self.evaluators, &functions, what, &self.x, &mut raw);
            self.finish(&functions, what, &raw, out);
            self.raw = raw;
            return;
        }
        let x: Vec<&[f64]> = self.x.iter().map(Vec::as_slice).collect();
        let mut evaluator =
            self.evaluators[what as usize].take().unwrap_or_else(|| functions.function(what).evaluator());
        let values = evaluator.eval_many(&x);
        let mut raw = std::mem::take(&mut self.raw);
        for p in 0..points {
            raw.clear();
            raw.extend(values.iter().map(|row| row[p]));
            self.finish(&functions, what, &raw, &mut out[size * p..size * (p + 1)]);
        }
        self.raw = raw;
        self.evaluators[what as usize] = Some(evaluator);
    }

    /// The value of a function at one point, from what was compiled of it.
    fn finish(&mut self, functions: &Compiled, what: StateFunction, raw: &[f64], out: &mut [f64]) {
        let (nu, n) = (functions.nu, functions.nq + functions.nu);
        let triangle = nu * (nu + 1) / 2;
        match what {
            StateFunction::Mass => {
                for i in 0..nu {
                    for j in 0..nu {
                        out[nu * i + j] = raw[packed(i.max(j), i.min(j))];
                    }
                }
            }
            StateFunction::Accelerations if !functions.unrolled => {
                out.copy_from_slice(&raw[triangle..]);
                match functions.linear_solver {
                    LinearSolver::Ldl => {
                        self.m.clear();
                        self.m.extend_from_slice(&raw[..triangle]);
                        solve_ldl(&mut self.m, out);
                    }
                    LinearSolver::Crout => solve_crout(&mut unpack(&raw[..triangle], nu), out),
                }
            }
            StateFunction::Jacobian => {
                out.fill(0.0);
                let jacobian = functions.jacobian();
                for j in 0..n {
                    let column = jacobian.col_ptr()[j]..jacobian.col_ptr()[j + 1];
                    for (row, value) in jacobian.row_index()[column.clone()].iter().zip(&raw[column]) {
                        out[n * row + j] = *value;
                    }
                    if !functions.unrolled {
                        self.solve_column(j, out);
                    }
                }
            }
            _ => out.copy_from_slice(raw),
        }
    }

    /// `u′_y = −M⁻¹ ∂(M a − F)/∂y` for the state `j`, with the L and D that are left in `m`.
    fn solve_column(&mut self, j: usize, out: &mut [f64]) {
        let (nq, nu) = (self.functions.nq(), self.functions.nu());
        let n = nq + nu;
        self.f.clear();
        self.f.extend((nq..n).map(|i| -out[n * i + j]));
        solve_factored(&self.m, &mut self.f);
        for (i, value) in (nq..n).zip(&self.f) {
            out[n * i + j] = *value;
        }
    }
}

/// A compiled function at the first point of x.
fn point(
    evaluators: &mut [Option<TapeEvaluator>; 5],
    functions: &Compiled,
    what: StateFunction,
    x: &[Vec<f64>],
    out: &mut Vec<f64>,
) {
    let evaluator = evaluators[what as usize].get_or_insert_with(|| functions.function(what).evaluator());
    out.clear();
    out.extend(x.iter().map(|row| row[0]));
    let values = evaluator.eval(out);
    out.clear();
    out.extend_from_slice(values);
}

/// The state `y = [q, u]` at the start of a model, for the independent rates of its equations.
///
/// # Errors
/// Initial rates that do not determine the motion, or contradict the constraints.
pub fn initial_state(model: &Model, equations: &Equations) -> Result<Vec<f64>, DeriveError> {
    Ok(start_state(model, equations, model.run.from)?.0)
}
