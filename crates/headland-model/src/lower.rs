//! Expressions of a scene into the graph, with dimensions checked and definitions made in the order of need.
//!
//! Nothing recurses over expressions: a program is run on a stack, and definitions are walked with an explicit one, so
//! that a train of thousands of members is no deeper than one of three.

use crate::assembly::{Motion, QUANTITIES, quantity};
use crate::definitions::{Instance, State};
use crate::depend::{Dependence, Kinds};
use crate::dimension::{Dimension, Ratio, Unifier};
use crate::functions::not;
use crate::model::{Coordinate, Derived, DerivedQuantity, QuasiVelocity};
use crate::place::{Diagnostic, Place};
use crate::symbols::{Binding, Formula, Rule, Symbol, Symbols, member_name};
use crate::units::parse_unit;
use headland_expr::parse::{Comparison, Item, Program, parse, suggestion};
use headland_expr::{Expr, Graph, NodeId, Op, Scalar};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::sync::Arc;

/// An expression with its dimension.
#[derive(Clone, Debug)]
pub struct Typed<'g> {
    /// The expression.
    pub expr: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
    /// True for angles, which count as pure numbers but are shown in radians.
    pub angle: bool,
    /// True for a comparison: non-negative where it holds.
    pub(crate) condition: bool,
}

impl Typed<'_> {
    pub(crate) fn number(x: f64, dimension: Dimension) -> Self {
        Self { expr: Expr::Const(x), dimension, angle: false, condition: false }
    }
}

/// Turns programs into typed expressions.
pub struct Lowering<'g> {
    /// The graph.
    pub graph: &'g Graph,
    /// Input of the time.
    pub time: NodeId,
    /// All names.
    pub symbols: Symbols,
    /// Coordinates made so far.
    pub coordinates: Vec<Coordinate>,
    /// Dimension of each coordinate and whether it is an angle.
    pub coordinate_types: Vec<(Dimension, bool)>,
    /// Quasi-velocities made so far.
    pub quasi_velocities: Vec<QuasiVelocity>,
    /// Dimension of each quasi-velocity and whether it counts angles.
    pub quasi_types: Vec<(Dimension, bool)>,
    /// What expressions depend on.
    pub dependence: Dependence,
    /// What is known about literals.
    pub unifier: Unifier,
    /// What is wrong so far.
    pub diagnostics: Vec<Diagnostic>,
    /// Prescribed coordinates that were declared with a unit.
    pub declared: FxHashMap<String, (Dimension, bool)>,
    pub(crate) instances: FxHashMap<Instance, State<'g>>,
    derivatives: FxHashMap<(NodeId, u8), Expr<'g>>,
    /// Arrays used as `name[k]`, with the index and its number of members.
    pub indexed: BTreeMap<String, (Arc<str>, i64)>,
    /// Definitions made, in order.
    pub made: Vec<Made>,
    /// What the equations can tell, by name, with its dimension; known when outputs are made.
    pub(crate) derived_names: FxHashMap<String, (Derived, Dimension)>,
    /// Sums over all bodies, by name.
    pub(crate) totals: Vec<(String, Typed<'g>)>,
    /// Those that were used.
    pub(crate) derived: Vec<DerivedQuantity>,
    /// Motions of the frames, once they are known.
    pub(crate) frames: Vec<Option<Motion<'g>>>,
}

/// A definition that was made.
#[derive(Clone, Debug)]
pub struct Made {
    /// Name with index.
    pub name: String,
    /// Its expression.
    pub id: NodeId,
    /// Its dimension.
    pub dimension: Dimension,
    /// True for an angle.
    pub angle: bool,
    /// Where it was written.
    pub place: Place,
}

/// Marks that the reason was reported.
#[derive(Clone, Copy, Debug)]
pub struct Reported;

impl<'g> Lowering<'g> {
    /// Nothing known but the time.
    pub fn new(graph: &'g Graph) -> Self {
        let mut dependence = Dependence::default();
        let time = dependence.input(graph, "t", Kinds::TIME);
        let mut symbols = Symbols::default();
        symbols.by_name.insert("t".into(), Symbol::Time);
        Self {
            graph,
            time,
            symbols,
            coordinates: Vec::new(),
            coordinate_types: Vec::new(),
            quasi_velocities: Vec::new(),
            quasi_types: Vec::new(),
            unifier: Unifier::default(),
            dependence,
            diagnostics: Vec::new(),
            declared: FxHashMap::default(),
            instances: FxHashMap::default(),
            derivatives: FxHashMap::default(),
            indexed: BTreeMap::new(),
            made: Vec::new(),
            frames: Vec::new(),
            derived_names: FxHashMap::default(),
            derived: Vec::new(),
            totals: Vec::new(),
        }
    }

    /// A new coordinate with its rates; gives its position.
    pub fn add_coordinate(&mut self, name: String, dimension: &Dimension, angle: bool, place: &Place) -> usize {
        let graph = self.graph;
        let mut input = |suffix: &str, kind| self.dependence.input(graph, &format!("{name}{suffix}"), kind);
        let (q, rate) = (input("", Kinds::COORDINATE), input("'", Kinds::RATE));
        let acceleration = input("''", Kinds::ACCELERATION);
        self.coordinates.push(Coordinate {
            unit: dimension.unit(angle),
            rate_unit: per_time(dimension, 1).unit(angle),
            q,
            rate,
            acceleration,
            initial: None,
            initial_rate: None,
            guess: None,
            scale: 1.0,
            place: place.clone(),
            name,
        });
        self.coordinate_types.push((dimension.clone(), angle));
        self.coordinates.len() - 1
    }

    /// A new quasi-velocity; gives its position.
    pub fn add_quasi_velocity(&mut self, name: String, dimension: &Dimension, angle: bool, place: &Place) -> usize {
        self.add_velocity(name, dimension, angle, place, Kinds::QUASI)
    }

    /// A new velocity of a joint, which constraints may make dependent; gives its position.
    pub fn add_joint_velocity(&mut self, name: String, dimension: &Dimension, angle: bool, place: &Place) -> usize {
        self.add_velocity(name, dimension, angle, place, Kinds::JOINT)
    }

    fn add_velocity(&mut self, name: String, dimension: &Dimension, angle: bool, place: &Place, kind: Kinds) -> usize {
        let u = self.dependence.input(self.graph, &name, kind);
        let acceleration = self.dependence.input(self.graph, &format!("{name}'"), Kinds::ACCELERATION);
        self.quasi_velocities.push(QuasiVelocity {
            unit: dimension.unit(angle),
            u,
            acceleration,
            initial: None,
            of_joint: kind == Kinds::JOINT,
            scale: 1.0,
            place: place.clone(),
            name,
        });
        self.quasi_types.push((dimension.clone(), angle));
        self.quasi_velocities.len() - 1
    }

    /// Reports an error.
    pub fn report(&mut self, place: Place, message: impl Into<String>) -> Reported {
        self.diagnostics.push(Diagnostic { place, message: message.into() });
        Reported
    }

    /// Parses a text of the scene.
    pub fn formula(&mut self, text: &str, place: &Place) -> Result<Formula, Reported> {
        let parsed = parse(text).map_err(|e| (e.span, e.message)).and_then(|mut program| {
            self.symbols.fold_lengths(&mut program).map_err(|message| (0..text.len(), message))?;
            Ok(program)
        });
        match parsed {
            Ok(program) => Ok(Formula { program, text: text.into(), place: place.clone() }),
            Err((span, message)) => Err(self.report(place.part(&span), format!("{message}, in `{text}`"))),
        }
    }

    /// Makes the expression of a formula and everything that it needs.
    pub fn lower(&mut self, formula: &Formula, binding: &Binding) -> Result<Typed<'g>, Reported> {
        let bindings: Vec<(Arc<str>, i64)> = binding.iter().cloned().collect();
        self.require(formula, &bindings)?;
        self.run(&formula.program, formula, &bindings)
    }

    /// Runs a program whose definitions are made.
    pub(crate) fn run(
        &mut self,
        program: &Program,
        formula: &Formula,
        bindings: &[(Arc<str>, i64)],
    ) -> Result<Typed<'g>, Reported> {
        let mut stack: Vec<(Typed<'g>, std::ops::Range<usize>)> = Vec::with_capacity(8);
        for (item, span) in program.items.iter().zip(&program.spans) {
            let place = || formula.place.part(span);
            let arity = match item {
                Item::Number(..) | Item::Name { .. } | Item::Sum { .. } => 0,
                Item::Operator(Op::Neg) | Item::Not => 1,
                Item::Operator(_) | Item::Compare(_) | Item::And | Item::Or => 2,
                Item::Call { args, .. } => *args,
            };
            let args: Vec<_> = stack.split_off(stack.len().saturating_sub(arity));
            let result = match item {
                Item::Number(x, unit) => self.number(*x, unit.as_deref(), place())?,
                Item::Name { name, index, primes } => self.name(name, index.as_ref(), *primes, bindings, place())?,
                Item::Operator(op) => self.operator(*op, args, formula, place())?,
                Item::Compare(comparison) => self.compare(*comparison, args, formula, place())?,
                Item::And | Item::Or | Item::Not => self.logic(item, args, place())?,
                Item::Call { function, .. } => self.call(function, args, formula, place())?,
                Item::Sum { index, body } => self.sum(index, body, formula, bindings, place())?,
            };
            stack.push((result, span.clone()));
        }
        match stack.pop() {
            Some((result, span)) => match result.expr.value() {
                Some(x) if !x.is_finite() => Err(self.report(
                    formula.place.part(&span),
                    format!("`{}` is {x}: a division by zero or a function outside its domain", formula.text),
                )),
                _ => Ok(result),
            },
            None => Err(self.report(formula.place.clone(), "empty expression")),
        }
    }

    pub(crate) fn number(&mut self, x: f64, unit: Option<&str>, place: Place) -> Result<Typed<'g>, Reported> {
        match unit.map(parse_unit) {
            None => Ok(Typed::number(x, self.unifier.unknown())),
            Some(Ok(unit)) => Ok(Typed { angle: unit.angle, ..Typed::number(unit.to_si(x), unit.dimension.clone()) }),
            Some(Err(message)) => Err(self.report(place, message)),
        }
    }

    pub(crate) fn name(
        &mut self,
        name: &str,
        index: Option<&Program>,
        primes: u8,
        bindings: &[(Arc<str>, i64)],
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        if index.is_none() && primes == 0 {
            if let Some((_, k)) = bindings.iter().rev().find(|(n, _)| **n == *name) {
                return Ok(Typed::number(*k as f64, Dimension::NONE));
            }
            if name == "pi" || name == "π" {
                return Ok(Typed { angle: true, ..Typed::number(std::f64::consts::PI, Dimension::NONE) });
            }
        }
        if let Some(found) = self.derived_quantity(name, index, primes, bindings, &place) {
            return found;
        }
        if let Some(found) = self.frame_quantity(name, index, primes, bindings, &place) {
            return found;
        }
        let Some((symbol, _, kind)) = self.symbols.by_name.get_full(name) else {
            let names = self.symbols.by_name.keys().map(|k| &**k).chain(["pi"]);
            let hint = suggestion(name, names);
            return Err(self.report(place, format!("undefined name `{name}`{hint}")));
        };
        let member = match index.map(|i| self.symbols.index_value(i, bindings)) {
            None => 0,
            Some(Ok(member)) => member,
            Some(Err(message)) => return Err(self.report(place, message)),
        };
        let count = match kind {
            Symbol::Parameter(values, true) => values.len() as i64,
            Symbol::Parameter(_, false) => 0,
            Symbol::Coordinate(m) | Symbol::QuasiVelocity(m) | Symbol::Frame(m) | Symbol::Joint(m) => m.last(),
            Symbol::Definition(rules, _) if rules.contains_key(&0) => 0,
            Symbol::Definition(rules, _) => rules.len() as i64,
            _ => 0,
        };
        let family = count > 0 || matches!(kind, Symbol::Parameter(_, true));
        if index.is_none() && family {
            return Err(self
                .report(place, format!("`{name}` has {count} members; which one? Write `{name}[1]` or `{name}[k]`")));
        }
        if index.is_some() && !family {
            return Err(self.report(place, format!("`{name}` is {} without members; it takes no index", kind.kind())));
        }
        let missing = match kind {
            Symbol::Definition(rules, _) => !rules.contains_key(&member),
            Symbol::Coordinate(m) | Symbol::QuasiVelocity(m) => m.get(member).is_none(),
            _ => index.is_some() && !(1..=count).contains(&member),
        };
        if missing {
            let last = |rules: &FxHashMap<i64, Rule>| rules.keys().copied().max().unwrap_or(0);
            let count = if let Symbol::Definition(rules, _) = kind { last(rules) } else { count };
            return Err(self.report(place, format!("`{name}[{member}]` does not exist; members run from 1 to {count}")));
        }
        let wrong_prime = |kind: &Symbol| format!("`{name}` is {}: it has no rate", kind.kind());
        match kind {
            Symbol::Time if primes == 0 => Ok(Typed {
                expr: self.graph.expr(self.time),
                dimension: Dimension::time(),
                angle: false,
                condition: false,
            }),
            Symbol::Parameter(values, array) if primes == 0 => {
                if *array
                    && let Some(Item::Name { name: variable, index: None, .. }) = index.and_then(|i| i.items.first())
                    && index.is_some_and(|i| i.items.len() == 1)
                    && let Some((variable, Symbol::Index(n))) = self.symbols.by_name.get_key_value(variable.as_str())
                {
                    let (variable, n) = (variable.clone(), *n);
                    let longest = self.indexed.entry(name.to_string()).or_insert((variable.clone(), n));
                    if longest.1 < n {
                        *longest = (variable, n);
                    }
                }
                let (id, dimension, angle) = values[member.max(1) as usize - 1].clone();
                Ok(Typed { expr: self.graph.expr(id), dimension, angle, condition: false })
            }
            Symbol::Index(n) if primes == 0 => {
                let message = format!(
                    "the index `{name}` (1 to {n}) has no value here; a name with `[{name}]` on the left gives it one"
                );
                Err(self.report(place, message))
            }
            Symbol::Coordinate(members) => {
                let i = members.get(member).unwrap_or_default();
                let c = &self.coordinates[i];
                let id = [c.q, c.rate, c.acceleration][primes as usize];
                let (dimension, angle) = &self.coordinate_types[i];
                Ok(Typed {
                    expr: self.graph.expr(id),
                    dimension: per_time(dimension, primes),
                    angle: *angle,
                    condition: false,
                })
            }
            Symbol::QuasiVelocity(members) if primes < 2 => {
                let i = members.get(member).unwrap_or_default();
                let u = &self.quasi_velocities[i];
                let id = [u.u, u.acceleration][primes as usize];
                let (dimension, angle) = &self.quasi_types[i];
                Ok(Typed {
                    expr: self.graph.expr(id),
                    dimension: per_time(dimension, primes),
                    angle: *angle,
                    condition: false,
                })
            }
            Symbol::Definition(..) => {
                let Some(State::Done(typed)) = self.instances.get(&(symbol, member)) else { return Err(Reported) };
                let typed = typed.clone();
                if primes == 0 {
                    return Ok(typed);
                }
                let expr = self.time_derivative(typed.expr, primes).map_err(|message| {
                    self.report(
                        place,
                        format!("`{}{}`: {message}", member_name(name, member), "'".repeat(primes as usize)),
                    )
                })?;
                Ok(Typed { expr, dimension: per_time(&typed.dimension, primes), ..typed })
            }
            Symbol::Table(..) => {
                Err(self.report(place, format!("`{name}` is a table; it is used as a function: `{name}(x)`")))
            }
            kind => {
                let message = wrong_prime(kind);
                Err(self.report(place, message))
            }
        }
    }

    /// `contact.fz`, `hitch[2].tx`, `F_A1.power`: an input for what the equations can tell.
    fn derived_quantity(
        &mut self,
        name: &str,
        index: Option<&Program>,
        primes: u8,
        bindings: &[(Arc<str>, i64)],
        place: &Place,
    ) -> Option<Result<Typed<'g>, Reported>> {
        let (_, part) = name.split_once('.')?;
        let member = index.map_or(Ok(0), |i| self.symbols.index_value(i, bindings)).ok()?;
        let full = member_name(name, member);
        if let Some((_, total)) = self.totals.iter().find(|(name, _)| *name == full) {
            let total = total.clone();
            return Some(match self.time_derivative(total.expr, primes) {
                Ok(expr) => Ok(Typed { expr, dimension: per_time(&total.dimension, primes), ..total }),
                Err(message) => Err(self.report(place.clone(), format!("`{full}`: {message}"))),
            });
        }
        let Some((what, dimension)) = self.derived_names.get(&full).cloned() else {
            let known = ["fx", "fy", "fz", "tx", "ty", "tz", "force", "power", "kinetic_energy", "potential_energy"];
            if !known.contains(&part) || self.symbols.by_name.contains_key(name) {
                return None;
            }
            let hint = suggestion(&full, self.derived_names.keys().map(String::as_str));
            let message = if self.derived_names.is_empty() {
                format!(
                    "`{full}` follows from the equations of motion; it can stand in outputs, guards and events only"
                )
            } else {
                format!("undefined name `{full}`{hint}")
            };
            return Some(Err(self.report(place.clone(), message)));
        };
        if primes > 0 {
            return Some(Err(self.report(place.clone(), format!("`{full}` has no rate that is known"))));
        }
        let input = match self.derived.iter().find(|d| d.name == full) {
            Some(known) => known.input,
            None => {
                let input = self.dependence.input(self.graph, &full, Kinds::ACCELERATION);
                self.derived.push(DerivedQuantity { name: full, input, what });
                input
            }
        };
        Some(Ok(Typed { expr: self.graph.expr(input), ..Typed::number(0.0, dimension) }))
    }

    /// `bogie[2].x`: a part of the motion of a frame; `None` if the name is not of that kind.
    fn frame_quantity(
        &mut self,
        name: &str,
        index: Option<&Program>,
        primes: u8,
        bindings: &[(Arc<str>, i64)],
        place: &Place,
    ) -> Option<Result<Typed<'g>, Reported>> {
        let (owner, part) = name.split_once('.')?;
        let Some(Symbol::Frame(members)) = self.symbols.by_name.get(owner) else { return None };
        let member = match index.map(|i| self.symbols.index_value(i, bindings)) {
            None => 0,
            Some(Ok(member)) => member,
            Some(Err(message)) => return Some(Err(self.report(place.clone(), message))),
        };
        // a coordinate of the same name means the same and is shorter
        match self.symbols.by_name.get(name) {
            Some(Symbol::Coordinate(m) | Symbol::QuasiVelocity(m)) if m.get(member).is_some() => return None,
            _ => {}
        }
        let full = member_name(owner, member);
        let Some(frame) = members.get(member) else {
            let message = match (members.is_family(), index.is_some()) {
                (true, false) => {
                    format!("`{owner}` has {} members; which one? Write `{owner}[1].{part}`", members.last())
                }
                (false, true) => format!("`{owner}` has no members; it takes no index"),
                _ => format!("`{full}` does not exist; members run to {}", members.last()),
            };
            return Some(Err(self.report(place.clone(), message)));
        };
        let Some(motion) = self.frames.get(frame).copied().flatten() else {
            let message = format!("`{full}.{part}` moves; only what is constant can stand here");
            return Some(Err(self.report(place.clone(), message)));
        };
        let Some(mut typed) = quantity(&motion, part) else {
            let hint = suggestion(part, QUANTITIES.iter().map(|(n, _)| *n));
            let message =
                format!("`{full}` has no `{part}`{hint}; known: x, vx, ax, wx, omega_x, exx, roll, pitch, yaw, qw, ..");
            return Some(Err(self.report(place.clone(), message)));
        };
        if primes > 0 {
            // the rate of a position is at hand
            let (short, primes_left) = match (part, primes) {
                ("x" | "y" | "z", 1) => (quantity(&motion, &format!("v{part}")), 0),
                ("x" | "y" | "z", _) | ("vx" | "vy" | "vz", 1) => {
                    (quantity(&motion, &format!("a{}", part.trim_start_matches('v'))), 0)
                }
                _ => (None, primes),
            };
            typed = match short {
                Some(short) => short,
                None => match self.time_derivative(typed.expr, primes_left) {
                    Ok(expr) => Typed { expr, dimension: per_time(&typed.dimension, primes), ..typed },
                    Err(message) => {
                        return Some(Err(self.report(place.clone(), format!("`{full}.{part}`: {message}"))));
                    }
                },
            };
        }
        Some(Ok(typed))
    }

    /// Total derivative in time by the rates q′, q″, u′.
    pub(crate) fn time_derivative(&mut self, e: Expr<'g>, primes: u8) -> Result<Expr<'g>, String> {
        let mut e = e;
        for order in 0..primes {
            let id = self.graph.id(e);
            if let Some(known) = self.derivatives.get(&(id, 1)) {
                e = *known;
                continue;
            }
            let mut rate: FxHashMap<usize, NodeId> = FxHashMap::default();
            let input = |id: NodeId| self.graph.node(id).args[0] as usize;
            for c in &self.coordinates {
                rate.insert(input(c.q), c.rate);
                rate.insert(input(c.rate), c.acceleration);
            }
            for u in &self.quasi_velocities {
                rate.insert(input(u.u), u.acceleration);
            }
            if self.dependence.any(e, Kinds::ACCELERATION) {
                let what = if order == 0 { "it" } else { "its rate" };
                return Err(format!("{what} contains accelerations, whose rates are not known"));
            }
            let time = input(self.time);
            let derivative = self.graph.tangent(&[id], |i| {
                if i == time { Some(Expr::Const(1.0)) } else { rate.get(&i).map(|r| self.graph.expr(*r)) }
            })[0];
            self.derivatives.insert((id, 1), derivative);
            e = derivative;
        }
        Ok(e)
    }

    fn operator(
        &mut self,
        op: Op,
        args: Vec<(Typed<'g>, std::ops::Range<usize>)>,
        formula: &Formula,
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        self.no_conditions(&args, formula)?;
        let a = &args[0].0;
        if op == Op::Neg {
            return Ok(Typed { expr: -a.expr, ..a.clone() });
        }
        let b = &args[1].0;
        let (expr, dimension, angle) = match op {
            Op::Add | Op::Sub => {
                let verb = if op == Op::Add { "add" } else { "subtract" };
                self.same(&args[0], &args[1], formula, &place, verb)?;
                let expr = if op == Op::Add { a.expr + b.expr } else { a.expr - b.expr };
                let dimension = if a.dimension.is_known() { a.dimension.clone() } else { b.dimension.clone() };
                (expr, dimension, a.angle || b.angle)
            }
            Op::Mul => {
                let pure = |x: &Typed<'_>| x.dimension.is_none() || matches!(x.expr, Expr::Const(_));
                let angle = a.angle && pure(b) || b.angle && pure(a);
                (a.expr * b.expr, &a.dimension + &b.dimension, angle)
            }
            Op::Div => {
                let angle = a.angle
                    && (b.dimension.is_none() && !b.angle
                        || matches!(b.expr, Expr::Const(_))
                        || b.dimension == Dimension::time());
                (a.expr / b.expr, &a.dimension - &b.dimension, angle)
            }
            _ => {
                let exponent = b.expr.value().and_then(Ratio::from_f64);
                self.pure(&args[1], formula, "an exponent")?;
                let dimension = match exponent {
                    Some(p) => a.dimension.power(p),
                    None => {
                        self.pure(&args[0], formula, "the base of a power whose exponent is not a number")?;
                        Dimension::NONE
                    }
                };
                (a.expr.pow(b.expr), dimension, false)
            }
        };
        Ok(Typed { expr, dimension, angle, condition: false })
    }

    fn compare(
        &mut self,
        comparison: Comparison,
        args: Vec<(Typed<'g>, std::ops::Range<usize>)>,
        formula: &Formula,
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        self.no_conditions(&args, formula)?;
        self.same(&args[0], &args[1], formula, &place, "compare")?;
        let (a, b) = (args[0].0.expr, args[1].0.expr);
        let expr = match comparison {
            Comparison::GreaterEqual => a - b,
            Comparison::LessEqual => b - a,
            Comparison::Less => not(a - b),
            Comparison::Greater => not(b - a),
        };
        Ok(Typed { expr, dimension: Dimension::NONE, angle: false, condition: true })
    }

    fn logic(
        &mut self,
        item: &Item,
        args: Vec<(Typed<'g>, std::ops::Range<usize>)>,
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        if args.iter().any(|(a, _)| !a.condition) {
            return Err(self.report(place, "`and`, `or`, `not` join comparisons such as `x > 0`"));
        }
        let a = args[0].0.expr;
        let expr = match item {
            Item::And => a.min(args[1].0.expr),
            Item::Or => a.max(args[1].0.expr),
            _ => not(a),
        };
        Ok(Typed { expr, dimension: Dimension::NONE, angle: false, condition: true })
    }

    fn sum(
        &mut self,
        index: &str,
        body: &Program,
        formula: &Formula,
        bindings: &[(Arc<str>, i64)],
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        let Some((key, Symbol::Index(n))) = self.symbols.by_name.get_key_value(index) else {
            let names = self.symbols.by_name.iter().filter(|(_, s)| matches!(s, Symbol::Index(_))).map(|(n, _)| &**n);
            let hint = suggestion(index, names);
            return Err(self.report(place, format!("`{index}` is not an index of the section [indices]{hint}")));
        };
        let (key, n) = (key.clone(), *n);
        let mut total: Option<Typed<'g>> = None;
        let mut inner = bindings.to_vec();
        for k in 1..=n {
            inner.push((key.clone(), k));
            let term = self.run(body, formula, &inner)?;
            inner.pop();
            total = Some(match total {
                None => term,
                Some(sum) => {
                    let expr = sum.expr + term.expr;
                    self.same(&(sum.clone(), 0..0), &(term, 0..0), formula, &place, "add")?;
                    Typed { expr, ..sum }
                }
            });
        }
        Ok(total.unwrap_or(Typed::number(0.0, self.unifier.unknown())))
    }
}

/// The dimension of a rate.
pub fn per_time(d: &Dimension, primes: u8) -> Dimension {
    (0..primes).fold(d.clone(), |d, _| &d - &Dimension::time())
}
