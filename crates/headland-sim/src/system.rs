//! [`System`]: equations compiled for one set of parameters; [`Problem`]: what an integrator sees of it.
//!
//! All functions take `x = [t, y, u′]` with the state `y = [q, u]`; parameters are folded into the code.

use std::cell::OnceCell;
use std::rc::Rc;

use headland_code::{Evaluator, Function, Jacobian, TapeEvaluator, TapeFunction};
#[cfg(feature = "ida")]
use headland_dynamics::descriptor::{ByMultipliers, Descriptor};
use headland_dynamics::solve::{packed, solve_crout, solve_ldl, unpack};
use headland_dynamics::{Equations, Kinematics};
use headland_expr::{Expr, Graph, NodeId};
use headland_model::{LinearSolver, Mode, Model, RowForm};
use headland_solve::{EvalFailure, OdeProblem, Pattern};

use crate::loops::{LoopScratch, Loops};
use crate::project::{Positions, Projector};

/// An event function of the system.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Watch {
    /// An event of the scene, by its position.
    Event(usize),
    /// A guard that stops the run, by its position.
    Guard(usize),
    /// A guard's warning, by its position.
    Warning(usize),
    /// A corner of forces, by its position among the model's switches.
    Switch(usize),
    /// Where the gap of a free contact is smallest or largest: nothing happens there.
    Nearest,
    /// What may end the mode of a contact, by its position; only where it falls below zero.
    Contact(usize, Limit),
}

/// What may end the mode of a contact.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Limit {
    /// Free: the gap.
    Gap,
    /// Touching: the normal force.
    Normal,
    /// Rolling: what friction is left.
    Cone,
    /// Sliding: the slip.
    Slip,
}

/// A compiled function of `x = [t, y, u′]` that knows whether it reads u′: if not, none has to be found for it.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The function.
    pub function: TapeFunction,
    /// Whether it reads u′.
    pub reads_accelerations: bool,
}

/// Equations compiled for one set of parameters.
pub struct System {
    /// Coordinates and quasi-velocities.
    pub kinematics: Kinematics,
    /// Names of the states y.
    pub names: Vec<String>,
    /// Number of coordinates.
    pub nq: usize,
    /// Number of quasi-velocities.
    pub nu: usize,
    /// The graph over `x = [t, y, u′]`.
    pub graph: Graph,
    /// What the right-hand side needs: rates, then u′ or (lower triangle of M, F).
    rhs_roots: Vec<NodeId>,
    unrolled: bool,
    linear_solver: LinearSolver,
    rhs: TapeFunction,
    loops: Option<Loops>,
    jacobian: OnceCell<(Jacobian<TapeFunction>, Pattern)>,
    /// Columns.
    pub outputs: Compiled,
    /// Kinetic energy, potential energy, all power.
    pub energies: Compiled,
    /// Quantities of the guards.
    pub guards: Compiled,
    /// Residuals of the velocity constraints in form (1).
    pub residuals: Compiled,
    /// Pivots of the elimination: where one changes sign, the constraints lost rank on the way.
    pub pivots: Compiled,
    /// The constraint of each pivot, by row of the model's kinematics.
    pub pivot_rows: Vec<usize>,
    /// Constraints on positions.
    pub positions: Positions,
    /// Which of the residuals belong to rows that were left out as redundant.
    pub redundant: Vec<usize>,
    /// Scaled entries of G of the dependent rates: the growth of the partition.
    pub growth: Compiled,
    /// What is known of each contact, in the order of [`crate::contact::nodes_of`], then the lower triangle of M.
    contacts: Vec<NodeId>,
    contact_function: OnceCell<TapeFunction>,
    /// What each contact does.
    pub modes: Vec<Mode>,
    /// Slip velocities of contacts that slide, then the matrix of their normal forces.
    pub(crate) slides: Compiled,
    /// First of the inputs that say in which direction contacts slide: six each, direction and shift.
    pub(crate) slides_from: usize,
    pub(crate) events: Compiled,
    /// What each event function watches.
    pub watches: Vec<Watch>,
    /// Multipliers that stand as inputs behind u′: none with elimination.
    pub multipliers: usize,
    /// The residual for IDA, of a system in which nothing is eliminated.
    #[cfg(feature = "ida")]
    pub dae: Option<crate::dae::DaeFunctions>,
}

impl System {
    /// Compiles the equations with the model's parameters folded in.
    pub fn new(model: &Model, equations: &Equations) -> Self {
        let graph = Graph::new();
        let copy = Copy::new(model, &equations.kinematics, &graph);
        let made = Self::compile(model, equations, &graph, &copy, Expr::Const(0.0));
        Self { graph, ..made }
    }

    /// Compiles the equations in which nothing is eliminated, for IDA. Functions take `x = [t, q, v, v′, λ, μ, q′]`.
    #[cfg(feature = "ida")]
    pub fn of_descriptor(model: &Model, descriptor: &Descriptor, form: crate::dae::Form) -> Self {
        let graph = Graph::new();
        let kinematics = &descriptor.equations.kinematics;
        let mut copy = Copy::new(model, kinematics, &graph);
        let lambda = crate::dae::multiplier_inputs(descriptor, &graph);
        let by_multipliers = |copy: &Copy<'_>, value: &ByMultipliers| {
            let node = |id: NodeId| copy.nodes(&[id])[0];
            value
                .parts
                .iter()
                .fold(graph.expr(node(value.own)), |sum, (k, part)| sum + graph.expr(node(*part)) * lambda[*k])
        };
        let derived: Vec<Expr<'_>> = descriptor.derived.iter().map(|value| by_multipliers(&copy, value)).collect();
        for (quantity, value) in model.derived.iter().zip(derived) {
            copy.inputs[model.input_index(quantity.input)] = Some(value);
        }
        let drives = by_multipliers(&copy, &descriptor.drives);
        let scales = model.coordinates.iter().map(|c| c.scale).chain(kinematics.quasi.iter().map(|u| u.scale));
        let scales: Vec<f64> = scales.collect();
        let functions = crate::dae::DaeFunctions::new(descriptor, form, &scales, &graph, &copy);
        let made = Self::compile(model, &descriptor.equations, &graph, &copy, drives);
        Self { graph, multipliers: descriptor.constraints.len(), dae: Some(functions), ..made }
    }

    /// Everything but the graph; `drives` is power besides that of the equations.
    fn compile(model: &Model, equations: &Equations, graph: &Graph, copy: &Copy<'_>, drives: Expr<'_>) -> Self {
        let kinematics = equations.kinematics.clone();
        let (nq, nu) = (kinematics.rates.len(), kinematics.quasi.len());
        let unrolled = equations.accelerations.is_some();

        let mut roots = kinematics.rates.clone();
        match &equations.accelerations {
            Some(u) => roots.extend(u),
            None => roots.extend(equations.mass.iter().chain(&equations.force)),
        }
        let rhs_roots = copy.nodes(&roots);
        let by_state = |nodes: Vec<NodeId>| copy.nodes(&equations.by_state(model, &nodes));
        let outputs = by_state(model.outputs.iter().map(|o| o.node).collect());
        let guards = by_state(model.guards.iter().map(|g| g.quantity).collect());
        let rows = model.kinematics.iter().filter_map(|r| match r.form {
            RowForm::Zero(node) => Some(node),
            RowForm::Rate(..) => None,
        });
        let residuals = by_state(rows.collect());
        let (pivot_rows, pivots): (Vec<usize>, Vec<NodeId>) =
            kinematics.factors.moving_pivots(model).into_iter().unzip();
        let pivots = copy.nodes(&pivots);
        let holonomic: Vec<NodeId> = model.kinematics.iter().filter_map(|r| r.position).collect();
        let holonomic = copy.nodes(&holonomic);
        let constraints = model.kinematics.iter().enumerate().filter(|(_, r)| matches!(r.form, RowForm::Zero(_)));
        let redundant = constraints.enumerate().filter(|(_, (row, _))| kinematics.redundant.contains(row));
        let redundant: Vec<usize> = redundant.map(|(position, _)| position).collect();
        let (mut watches, mut events) =
            Self::event_nodes(model, graph, &guards, &by_state(model.events.iter().map(|e| e.quantity).collect()));
        let contacts = by_state(model.contacts.iter().flat_map(crate::contact::nodes_of).collect());
        for (watch, node) in crate::contact::limits(model, graph, &contacts, 1 + nq + 2 * nu) {
            watches.push(watch);
            events.push(node);
        }
        let sliding = model.contacts.iter().filter(|c| c.mode == Mode::Sliding).flat_map(|c| c.slip).collect();
        let slides = [by_state(sliding), copy.nodes(&equations.friction_pivots)].concat();
        for (i, node) in by_state(model.switches.iter().map(|s| s.quantity).collect()).into_iter().enumerate() {
            watches.push(Watch::Switch(i));
            events.push(node);
        }
        let growth = Self::growth_nodes(equations, graph, copy);
        let energies = Self::energy_nodes(equations, graph, copy, drives);

        let plain = |nodes: &[NodeId]| TapeFunction::compile(graph, nodes);
        let loops = Loops::new(model, equations, &kinematics);
        let by_loops = loops.as_ref().map(|l| [&rhs_roots[..nq], &copy.nodes(&l.forces)].concat());
        let compile = |nodes: &[NodeId]| {
            let reads = graph.depends(nodes, |input| input > nq + nu && input <= nq + 2 * nu);
            Compiled { function: plain(nodes), reads_accelerations: reads.contains(&true) }
        };
        let names =
            model.coordinates.iter().map(|c| c.name.clone()).chain(kinematics.quasi.iter().map(|u| u.name.clone()));
        Self {
            names: names.collect(),
            nq,
            nu,
            rhs: plain(by_loops.as_ref().unwrap_or(&rhs_roots)),
            loops,
            outputs: compile(&outputs),
            energies: compile(&energies),
            guards: compile(&guards),
            residuals: compile(&residuals),
            pivots: compile(&pivots),
            pivot_rows,
            positions: Positions::new(graph, &holonomic, nq),
            redundant,
            growth: compile(&growth),
            contacts: if contacts.is_empty() { contacts } else { [contacts, copy.nodes(&equations.mass)].concat() },
            contact_function: OnceCell::new(),
            modes: model.modes(),
            slides: compile(&slides),
            slides_from: 1 + nq + 2 * nu,
            events: compile(&events),
            jacobian: OnceCell::new(),
            linear_solver: equations.linear_solver,
            kinematics,
            rhs_roots,
            unrolled,
            watches,
            multipliers: 0,
            #[cfg(feature = "ida")]
            dae: None,
            graph: Graph::new(),
        }
    }

    fn event_nodes(model: &Model, graph: &Graph, guards: &[NodeId], events: &[NodeId]) -> (Vec<Watch>, Vec<NodeId>) {
        let mut watches: Vec<Watch> = (0..events.len()).map(Watch::Event).collect();
        let mut nodes = events.to_vec();
        for (i, guard) in model.guards.iter().enumerate() {
            let limits = [(guard.stop_below, Watch::Guard(i)), (guard.warn_below, Watch::Warning(i))];
            for (limit, watch) in limits.into_iter().filter_map(|(limit, watch)| Some((limit?, watch))) {
                watches.push(watch);
                nodes.push(graph.id(graph.expr(guards[i]) - Expr::Const(limit)));
            }
        }
        (watches, nodes)
    }

    /// `G_ik √(M_i/M_k)` for eliminated rates i and independent rates k.
    fn growth_nodes(equations: &Equations, graph: &Graph, copy: &Copy<'_>) -> Vec<NodeId> {
        let scale = |i: usize| equations.kinematics.mass[i].sqrt();
        let mut nodes = Vec::new();
        for &i in &equations.kinematics.dependent {
            for (k, u) in equations.kinematics.quasi.iter().enumerate() {
                let j = u.velocity;
                let entry = graph.expr(copy.nodes(&[equations.g[i][k]])[0]);
                if entry.value().is_none() && scale(i) > 0.0 && scale(j) > 0.0 {
                    nodes.push(graph.id(entry * Expr::Const(scale(i) / scale(j))));
                }
            }
        }
        nodes
    }

    fn energy_nodes(equations: &Equations, graph: &Graph, copy: &Copy<'_>, drives: Expr<'_>) -> Vec<NodeId> {
        let e = &equations.energies;
        let powers: Vec<NodeId> = e.powers.iter().map(|(_, node)| *node).chain(e.drives).collect();
        let drives = graph.expr(graph.id(drives));
        let total = copy.nodes(&powers).into_iter().fold(drives, |sum, p| sum + graph.expr(p));
        let mut nodes = copy.nodes(&[e.kinetic, e.potential]);
        nodes.push(graph.id(total));
        nodes
    }

    /// Length of the state.
    pub fn len(&self) -> usize {
        self.nq + self.nu
    }

    /// True for a system without states.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Operations of one evaluation of the right-hand side, or of the residual for IDA; with loops over bodies those of the forces alone.
    pub fn operations(&self) -> usize {
        #[cfg(feature = "ida")]
        if let Some(dae) = &self.dae {
            return dae.operations();
        }
        self.rhs.operations()
    }

    /// How the right-hand side is evaluated.
    pub fn evaluator(&self) -> &'static str {
        if self.loops.is_some() { "loops" } else { "tape" }
    }

    /// What the right-hand side is made of, as nodes of [`Self::graph`]: rates, then u′ or (lower triangle of M, F).
    pub fn roots(&self) -> &[NodeId] {
        &self.rhs_roots
    }

    /// The exact Jacobian of `[q′, u′]` (unrolled) or of `[q′, M a − F]`, made when first asked for.
    fn jacobian(&self) -> &(Jacobian<TapeFunction>, Pattern) {
        self.jacobian.get_or_init(|| {
            let graph = &self.graph;
            let states: Vec<NodeId> = (1..=self.len()).map(|i| graph.input_id(i)).collect();
            let roots: Vec<NodeId> = if self.unrolled { self.rhs_roots.clone() } else { self.residual_roots() };
            let jacobian = Jacobian::<TapeFunction>::new(graph, &roots, &states);
            let (n, nq) = (self.len(), self.nq);
            let pattern = if self.unrolled {
                Pattern::new(n, n, jacobian.col_ptr().to_vec(), jacobian.row_index().to_vec())
            } else {
                // u′ = M⁻¹ F couples everything below the rates
                let entries = (0..n).flat_map(|j| {
                    let rates = jacobian.row_index()[jacobian.col_ptr()[j]..jacobian.col_ptr()[j + 1]].iter();
                    rates.filter(|i| **i < nq).map(|i| (*i, j)).chain((nq..n).map(|i| (i, j))).collect::<Vec<_>>()
                });
                Pattern::from_entries(n, n, entries)
            };
            (jacobian, pattern)
        })
    }

    /// `[q′, M a − F]` with a the inputs u′.
    fn residual_roots(&self) -> Vec<NodeId> {
        let (nq, triangle) = (self.nq, self.nu * (self.nu + 1) / 2);
        let mut roots = self.rhs_roots[..nq].to_vec();
        let (mass, force) = self.rhs_roots[nq..].split_at(triangle);
        roots.extend(force_residuals(&self.graph, 1 + self.len(), mass, force));
        roots
    }

    /// The function of all contacts, compiled; for what happens at events.
    pub(crate) fn contact_function(&self) -> &TapeFunction {
        self.contact_function.get_or_init(|| TapeFunction::compile(&self.graph, &self.contacts))
    }
}

/// `M a − F` with a the inputs u′, which begin at `first`.
pub(crate) fn force_residuals(graph: &Graph, first: usize, mass: &[NodeId], force: &[NodeId]) -> Vec<NodeId> {
    let nu = force.len();
    let row = |i: usize| {
        let mut sum = -graph.expr(force[i]);
        for j in 0..nu {
            sum = sum + graph.expr(mass[packed(i.max(j), i.min(j))]) * graph.expr(graph.input_id(first + j));
        }
        graph.id(sum)
    };
    (0..nu).map(row).collect()
}

/// Copies nodes of the model's graph into the system's, states and time renumbered, parameters as numbers.
pub(crate) struct Copy<'t> {
    source: &'t Graph,
    target: &'t Graph,
    inputs: Vec<Option<Expr<'t>>>,
}

impl<'t> Copy<'t> {
    pub(crate) fn new(model: &'t Model, kinematics: &Kinematics, target: &'t Graph) -> Self {
        let mut inputs = vec![None; model.graph.input_count()];
        inputs[model.input_index(model.time)] = Some(target.input("t"));
        for c in &model.coordinates {
            inputs[model.input_index(c.q)] = Some(target.input(&c.name));
        }
        for u in &kinematics.quasi {
            inputs[model.input_index(u.u)] = Some(target.input(&u.name));
        }
        for u in &kinematics.quasi {
            inputs[model.input_index(u.acceleration)] = Some(target.input(&format!("{}'", u.name)));
        }
        for contact in &model.contacts {
            for (part, input) in contact.friction.iter().flat_map(|f| f.direction.iter().chain(&f.shift)).enumerate() {
                inputs[model.input_index(*input)] = Some(target.input(&format!("{} {part}", contact.name)));
            }
        }
        for p in &model.parameters {
            inputs[p.input] = Some(Expr::Const(p.value));
        }
        Self { source: &model.graph, target, inputs }
    }

    pub(crate) fn nodes(&self, nodes: &[NodeId]) -> Vec<NodeId> {
        let name = |i: usize| self.source.input_name(i);
        self.source
            .rebuild(nodes, self.target, |i| {
                self.inputs[i].unwrap_or_else(|| unreachable!("`{}` was put in by (2)", name(i)))
            })
            .into_iter()
            .map(|e| self.target.id(e))
            .collect()
    }
}

/// A system with one thread's scratch, as an integrator sees it.
pub struct Problem {
    /// The system.
    pub system: Rc<System>,
    rhs: TapeEvaluator,
    jacobian: Option<TapeEvaluator>,
    events: TapeEvaluator,
    projector: Projector,
    loops: Option<LoopScratch>,
    #[cfg(feature = "ida")]
    pub(crate) dae: Option<crate::dae::DaeScratch>,
    pub(crate) x: Vec<f64>,
    mass: Vec<f64>,
    force: Vec<f64>,
    dy: Vec<f64>,
    /// Time is kept inside: functions of time are those between two breakpoints, also at its ends.
    span: (f64, f64),
    exact_jacobian: bool,
    /// The first state at which the right-hand side was not finite.
    pub not_finite: Option<(f64, Vec<f64>)>,
}

impl Problem {
    /// Scratch for a system; with `exact_jacobian` the Jacobian is derived.
    pub fn new(system: Rc<System>, exact_jacobian: bool) -> Self {
        Self {
            rhs: system.rhs.evaluator(),
            jacobian: None,
            events: system.events.function.evaluator(),
            projector: system.positions.projector(),
            loops: system.loops.as_ref().map(Loops::scratch),
            #[cfg(feature = "ida")]
            dae: system.dae.as_ref().map(crate::dae::DaeFunctions::scratch),
            x: vec![0.0; system.graph.input_count()],
            mass: Vec::new(),
            force: Vec::new(),
            dy: Vec::new(),
            span: (f64::NEG_INFINITY, f64::INFINITY),
            exact_jacobian,
            not_finite: None,
            system,
        }
    }

    /// Sets the span between two breakpoints in which functions of time are evaluated.
    ///
    /// Roots are known to an ulp or two; the span is drawn in by four, so that no condition is seen from the other side.
    pub fn set_span(&mut self, from: f64, to: f64) {
        let inward = |t: f64| if t.is_finite() { 4.0 * f64::EPSILON * t.abs() } else { 0.0 };
        self.span = (from + inward(from), to - inward(to));
    }

    /// `x = [t, y, u′]` with u′ as it was, or as the longer `y = [q, v, v′, λ]` of IDA has it.
    pub(crate) fn load(&mut self, t: f64, y: &[f64]) {
        self.x[0] = if self.span.0 <= self.span.1 {
            t.clamp(self.span.0, self.span.1)
        } else {
            0.5 * (self.span.0 + self.span.1)
        };
        self.x[1..=y.len()].copy_from_slice(y);
    }

    /// Sets inputs behind the rates of the velocities.
    pub(crate) fn set_inputs(&mut self, first: usize, values: &[f64]) {
        self.x[first..first + values.len()].copy_from_slice(values);
    }

    /// Event functions at `x`.
    pub(crate) fn watch(&mut self, g: &mut [f64]) {
        g.copy_from_slice(self.events.eval(&self.x));
    }

    /// Largest residual of the constraints on positions.
    pub fn position_residual(&mut self, t: f64, y: &[f64]) -> f64 {
        self.load(t, y);
        self.projector.worst(&self.x)
    }

    /// Moves the coordinates of `y` onto the constraints on positions, as far as that succeeds.
    pub(crate) fn settle_positions(&mut self, t: f64, y: &mut [f64]) {
        self.load(t, y);
        let system = self.system.clone();
        if self.projector.project(&system.positions, &mut self.x) {
            y[..system.nq].copy_from_slice(&self.x[1..=system.nq]);
        }
    }

    /// `x` for a compiled function: with u′ only if it reads them.
    pub fn inputs_for(&mut self, function: &Compiled, t: f64, y: &[f64]) -> &[f64] {
        if function.reads_accelerations {
            return self.full_inputs(t, y);
        }
        self.load(t, y);
        &self.x
    }

    /// `x = [t, y, u′]` with u′ as the equations make it.
    pub fn full_inputs(&mut self, t: f64, y: &[f64]) -> &[f64] {
        if y.len() > self.system.len() {
            self.load(t, y);
            #[cfg(feature = "ida")]
            self.settle_rates();
            return &self.x;
        }
        let mut dy = std::mem::take(&mut self.dy);
        dy.resize(y.len(), 0.0);
        let _ = self.rhs(t, y, &mut dy);
        self.x[1 + y.len()..1 + y.len() + self.system.nu].copy_from_slice(&dy[self.system.nq..]);
        self.dy = dy;
        &self.x
    }
}

impl OdeProblem for Problem {
    fn len(&self) -> usize {
        self.system.len()
    }

    fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        self.load(t, y);
        let system = self.system.clone();
        let (nq, nu) = (system.nq, system.nu);
        let out = self.rhs.eval(&self.x);
        if let (Some(loops), Some(scratch)) = (&system.loops, &mut self.loops) {
            dy[..nq].copy_from_slice(&out[..nq]);
            loops.accelerations(scratch, y, nq, &out[nq..], &mut dy[nq..]);
        } else if system.unrolled {
            dy.copy_from_slice(out);
        } else {
            dy[..nq].copy_from_slice(&out[..nq]);
            let triangle = nu * (nu + 1) / 2;
            self.mass.clear();
            self.mass.extend_from_slice(&out[nq..nq + triangle]);
            dy[nq..].copy_from_slice(&out[nq + triangle..]);
            match system.linear_solver {
                LinearSolver::Ldl => solve_ldl(&mut self.mass, &mut dy[nq..]),
                LinearSolver::Crout => solve_crout(&mut unpack(&self.mass, nu), &mut dy[nq..]),
            }
        }
        if self.not_finite.is_none() && dy.iter().any(|x| !x.is_finite()) {
            self.not_finite = Some((t, y.to_vec()));
        }
        Ok(())
    }

    fn pattern(&self) -> Option<&Pattern> {
        // the symbolic Jacobian of a long recursion costs more than differences
        let wanted = self.exact_jacobian && (self.system.loops.is_none() || self.system.nu <= 16);
        let known = || Some(self.system.jacobian()).filter(|(jacobian, _)| jacobian.is_known());
        wanted.then(known).flatten().map(|(_, pattern)| pattern)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Result<(), EvalFailure> {
        let system = self.system.clone();
        let (jacobian, pattern) = system.jacobian();
        let (n, nq, nu) = (system.len(), system.nq, system.nu);
        if !system.unrolled {
            self.full_inputs(t, y);
            if system.linear_solver == LinearSolver::Crout {
                solve_ldl(&mut self.mass, &mut vec![0.0; nu]); // M as it is so far: the columns below want L and D
            }
        }
        self.load(t, y);
        let evaluator = self.jacobian.get_or_insert_with(|| jacobian.function().evaluator());
        let raw = evaluator.eval(&self.x);
        if system.unrolled {
            values.copy_from_slice(raw);
            return Ok(());
        }
        // u′_y = −M⁻¹ ∂(M a − F)/∂y, one column after the other with one factorization
        for j in 0..n {
            self.force.clear();
            self.force.resize(nu, 0.0);
            let mut k = pattern.col_ptr()[j];
            for i in jacobian.col_ptr()[j]..jacobian.col_ptr()[j + 1] {
                let row = jacobian.row_index()[i];
                if row < nq {
                    values[k] = raw[i];
                    k += 1;
                } else {
                    self.force[row - nq] = -raw[i];
                }
            }
            solve_factored(&self.mass, &mut self.force);
            values[k..pattern.col_ptr()[j + 1]].copy_from_slice(&self.force);
        }
        Ok(())
    }

    fn event_count(&self) -> usize {
        self.system.watches.len()
    }

    fn events(&mut self, t: f64, y: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
        if self.system.events.reads_accelerations {
            self.full_inputs(t, y);
        } else {
            self.load(t, y);
        }
        self.watch(g);
        Ok(())
    }

    fn has_projection(&self) -> bool {
        !self.system.positions.is_empty()
    }

    fn project(&mut self, t: f64, y: &[f64], correction: &mut [f64]) -> Result<(), EvalFailure> {
        self.load(t, y);
        let system = self.system.clone();
        if !self.projector.project(&system.positions, &mut self.x) {
            return Err(EvalFailure::Recoverable);
        }
        for ((c, y), x) in correction.iter_mut().zip(y).zip(&self.x[1..]) {
            *c = x - y;
        }
        Ok(())
    }

    fn component_name(&self, i: usize) -> String {
        self.system.names[i].clone()
    }
}

/// Solves with the L and D that [`solve_ldl`] left behind.
pub(crate) fn solve_factored(m: &[f64], f: &mut [f64]) {
    let n = f.len();
    for i in 0..n {
        for j in 0..i {
            f[i] -= m[packed(i, j)] * f[j];
        }
    }
    for i in 0..n {
        f[i] /= m[packed(i, i)];
    }
    for i in (0..n).rev() {
        for j in 0..i {
            f[j] -= m[packed(i, j)] * f[i];
        }
    }
}
