//! Expressions of a scene into the graph, with dimensions checked and definitions made in the order of need.
//!
//! Nothing recurses over expressions: a program is run on a stack, and definitions are walked with an explicit one, so
//! that a train of thousands of members is no deeper than one of three.

use std::collections::BTreeMap;
use std::sync::Arc;

use headland_expr::parse::{Comparison, Item, Program, parse, suggestion};
use headland_expr::{Expr, Graph, NodeId, Op, Scalar};
use rustc_hash::FxHashMap;

use crate::depend::{Dependence, Kinds};
use crate::dimension::{Dimension, Ratio, Unifier};
use crate::model::{Coordinate, QuasiVelocity};
use crate::place::{Diagnostic, Place};
use crate::symbols::{Binding, Formula, Rule, Symbol, Symbols, member_name};
use crate::units::parse_unit;

/// Functions of the scene format that are not operators: name, least and most arguments.
const FUNCTIONS: &[(&str, usize, usize)] = &[
    ("if", 3, 3),
    ("smoothstep", 3, 3),
    ("clamp", 3, 3),
    ("step", 1, 1),
    ("hypot", 2, 2),
    ("ln", 1, 1),
    ("cot", 1, 1),
];

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
    fn number(x: f64, dimension: Dimension) -> Self {
        Self { expr: Expr::Const(x), dimension, angle: false, condition: false }
    }
}

/// A definition's member: symbol position and member.
type Instance = (usize, i64);

enum State<'g> {
    /// Its dependencies are being made.
    Open,
    Done(Typed<'g>),
    Failed,
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
    instances: FxHashMap<Instance, State<'g>>,
    derivatives: FxHashMap<(NodeId, u8), Expr<'g>>,
    /// Arrays used as `name[k]`, with the index and its number of members.
    pub indexed: BTreeMap<String, (Arc<str>, i64)>,
    /// Definitions made, in order.
    pub made: Vec<Made>,
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
        }
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

    /// Makes a member of a definition, by name.
    pub fn definition(&mut self, symbol: usize, member: i64) -> Result<Typed<'g>, Reported> {
        self.make_instances(vec![(symbol, member)])?;
        match self.instances.get(&(symbol, member)) {
            Some(State::Done(typed)) => Ok(typed.clone()),
            _ => Err(Reported),
        }
    }

    fn rule(&self, (symbol, member): Instance) -> Option<&Rule> {
        match self.symbols.by_name.get_index(symbol) {
            Some((_, Symbol::Definition(rules, _))) => rules.get(&member),
            _ => None,
        }
    }

    fn instance_name(&self, (symbol, member): Instance) -> String {
        let name = self.symbols.by_name.get_index(symbol).map_or("?", |(name, _)| name);
        member_name(name, member)
    }

    fn require(&mut self, formula: &Formula, bindings: &[(Arc<str>, i64)]) -> Result<(), Reported> {
        let needed = self.dependencies(&formula.program, bindings);
        self.make_instances(needed)
    }

    /// Makes definitions and what they need, depth first with an explicit stack.
    fn make_instances(&mut self, wanted: Vec<Instance>) -> Result<(), Reported> {
        let mut ok = true;
        let mut stack: Vec<Instance> = wanted.into_iter().rev().collect();
        while let Some(&top) = stack.last() {
            match self.instances.get(&top) {
                Some(State::Done(_)) => {
                    stack.pop();
                }
                Some(State::Failed) => {
                    ok = false;
                    stack.pop();
                }
                Some(State::Open) => {
                    stack.pop();
                    let made = self.make_instance(top);
                    ok &= made.is_ok();
                    self.instances.insert(top, made.map_or(State::Failed, State::Done));
                }
                None => {
                    let Some(rule) = self.rule(top) else {
                        stack.pop();
                        continue;
                    };
                    let (program, bindings) =
                        (rule.formula.program.clone(), rule.binding.iter().cloned().collect::<Vec<_>>());
                    self.instances.insert(top, State::Open);
                    let needed = self.dependencies(&program, &bindings);
                    if let Some(cycle) = needed.iter().find(|d| matches!(self.instances.get(d), Some(State::Open))) {
                        self.report_cycle(*cycle, &stack);
                        ok = false;
                        for open in &stack {
                            if matches!(self.instances.get(open), Some(State::Open)) {
                                self.instances.insert(*open, State::Failed);
                            }
                        }
                    } else {
                        stack.extend(needed.into_iter().rev());
                    }
                }
            }
        }
        if ok { Ok(()) } else { Err(Reported) }
    }

    fn make_instance(&mut self, instance: Instance) -> Result<Typed<'g>, Reported> {
        let Some(rule) = self.rule(instance).cloned() else { return Err(Reported) };
        let bindings: Vec<(Arc<str>, i64)> = rule.binding.iter().cloned().collect();
        let mut typed = self.run(&rule.formula.program, &rule.formula, &bindings)?;
        if typed.condition {
            return Err(self.report(rule.formula.place, "a comparison stands only inside `if(.., .., ..)`"));
        }
        let name = self.symbols.by_name.get_index(instance.0).map_or("", |(name, _)| name);
        if let Some((dimension, angle)) = self.declared.get(name).cloned() {
            let what = format!("`{}`", self.instance_name(instance));
            self.demand(&typed, &dimension, angle, &rule.formula, &what)?;
            typed = Typed { dimension, angle, ..typed };
        }
        let id = self.graph.id(typed.expr);
        let name = self.instance_name(instance);
        self.made.push(Made {
            name,
            id,
            dimension: typed.dimension.clone(),
            angle: typed.angle,
            place: rule.formula.place,
        });
        Ok(typed)
    }

    fn report_cycle(&mut self, first: Instance, stack: &[Instance]) {
        let mut path: Vec<String> = stack
            .iter()
            .skip_while(|i| **i != first)
            .filter(|i| matches!(self.instances.get(i), Some(State::Open)))
            .map(|i| format!("`{}`", self.instance_name(*i)))
            .collect();
        if path.len() > 6 {
            path.splice(3..path.len() - 2, ["…".to_string()]);
        }
        path.push(format!("`{}`", self.instance_name(first)));
        let place = self.rule(first).map_or(Place::Program, |r| r.formula.place.clone());
        self.report(place, format!("cyclic definition: {}", path.join(" needs ")));
    }

    /// The definitions that a program uses directly.
    fn dependencies(&self, program: &Program, bindings: &[(Arc<str>, i64)]) -> Vec<Instance> {
        let mut found = Vec::new();
        let mut work: Vec<(&Program, Vec<(Arc<str>, i64)>)> = vec![(program, bindings.to_vec())];
        while let Some((program, bindings)) = work.pop() {
            for item in &program.items {
                match item {
                    Item::Name { name, index, .. } => {
                        let Some((symbol, _, Symbol::Definition(rules, _))) =
                            self.symbols.by_name.get_full(name.as_str())
                        else {
                            continue;
                        };
                        let member = match index {
                            None => 0,
                            Some(index) => match self.symbols.index_value(index, &bindings) {
                                Ok(member) => member,
                                Err(_) => continue, // reported when the name is used
                            },
                        };
                        if rules.contains_key(&member) {
                            found.push((symbol, member));
                        }
                    }
                    Item::Sum { index, body } => {
                        if let Some((key, Symbol::Index(n))) = self.symbols.by_name.get_key_value(index.as_str()) {
                            for k in (1..=*n).rev() {
                                let mut inner = bindings.clone();
                                inner.push((key.clone(), k));
                                work.push((body, inner));
                            }
                        }
                    }
                    _ => {}
                }
            }
        }
        found
    }

    /// Runs a program whose definitions are made.
    fn run(
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

    fn number(&mut self, x: f64, unit: Option<&str>, place: Place) -> Result<Typed<'g>, Reported> {
        match unit.map(parse_unit) {
            None => Ok(Typed::number(x, self.unifier.unknown())),
            Some(Ok(unit)) => Ok(Typed { angle: unit.angle, ..Typed::number(unit.to_si(x), unit.dimension.clone()) }),
            Some(Err(message)) => Err(self.report(place, message)),
        }
    }

    fn name(
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
            Symbol::Parameter(values, array) => {
                if *array {
                    values.len() as i64
                } else {
                    0
                }
            }
            Symbol::Coordinate(_, n) | Symbol::QuasiVelocity(_, n) => *n,
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
                    self.indexed.insert(name.to_string(), (variable.clone(), *n));
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
            Symbol::Coordinate(base, _) => {
                let i = base + (member.max(1) - 1) as usize;
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
            Symbol::QuasiVelocity(base, _) if primes < 2 => {
                let i = base + (member.max(1) - 1) as usize;
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

    /// Total derivative in time by the rates q′, q″, u′.
    fn time_derivative(&mut self, e: Expr<'g>, primes: u8) -> Result<Expr<'g>, String> {
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

    fn call(
        &mut self,
        function: &str,
        args: Vec<(Typed<'g>, std::ops::Range<usize>)>,
        formula: &Formula,
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        let n = args.len();
        if let Some(Symbol::Table(spline, x, y)) = self.symbols.by_name.get(function) {
            let (spline, x, y) = (spline.clone(), x.clone(), y.clone());
            if n != 1 {
                return Err(self.report(place, format!("the table `{function}` takes 1 argument, found {n}")));
            }
            self.no_conditions(&args, formula)?;
            let wanted = (Typed::number(0.0, x), 0..0);
            self.same(&args[0], &wanted, formula, &place, "look up")?;
            return Ok(Typed { expr: args[0].0.expr.spline(&spline, 0), dimension: y, angle: false, condition: false });
        }
        let row = headland_expr::ops::OPS
            .iter()
            .find(|r| r.name == function && r.form == headland_expr::ops::Form::Call && r.op != Op::Select);
        let own = FUNCTIONS.iter().find(|f| f.0 == function);
        let (least, most) = match (row, own) {
            (Some(row), _) if matches!(row.op, Op::Min | Op::Max) => (2, usize::MAX),
            (Some(row), _) => (row.arity, row.arity),
            (None, Some((_, least, most))) => (*least, *most),
            (None, None) => {
                let known = headland_expr::ops::OPS.iter().filter(|r| r.form == headland_expr::ops::Form::Call);
                let names = known
                    .map(|r| r.name)
                    .filter(|n| *n != "select")
                    .chain(FUNCTIONS.iter().map(|f| f.0))
                    .chain(["sum", "len"]);
                let tables =
                    self.symbols.by_name.iter().filter(|(_, s)| matches!(s, Symbol::Table(..))).map(|(n, _)| &**n);
                let hint = suggestion(function, names.chain(tables));
                return Err(self.report(place, format!("unknown function `{function}`{hint}")));
            }
        };
        if n < least || n > most {
            let wanted = if most == usize::MAX { format!("at least {least}") } else { least.to_string() };
            return Err(self.report(place, format!("`{function}` takes {wanted} argument(s), found {n}")));
        }
        if function == "if" {
            return self.conditional(&args, formula, place);
        }
        self.no_conditions(&args, formula)?;
        let x: Vec<Expr<'g>> = args.iter().map(|a| a.0.expr).collect();
        let first = args[0].0.clone();
        let none = |expr: Expr<'g>, angle: bool| Typed { expr, dimension: Dimension::NONE, angle, condition: false };
        if matches!(function, "min" | "max" | "clamp" | "atan2" | "hypot" | "smoothstep") {
            for other in &args[1..] {
                self.same(&args[0], other, formula, &place, &format!("use in `{function}`"))?;
            }
        }
        let known =
            args.iter().map(|a| &a.0.dimension).find(|d| d.is_known()).cloned().unwrap_or(first.dimension.clone());
        Ok(match function {
            "min" => Typed { expr: x[1..].iter().fold(x[0], |a, b| a.min(*b)), dimension: known, ..first },
            "max" => Typed { expr: x[1..].iter().fold(x[0], |a, b| a.max(*b)), dimension: known, ..first },
            "clamp" => Typed { expr: x[0].max(x[1]).min(x[2]), dimension: known, ..first },
            "hypot" => Typed { expr: (x[0] * x[0] + x[1] * x[1]).sqrt(), dimension: known, ..first },
            "atan2" => none(x[0].atan2(x[1]), true),
            "smoothstep" => none(smoothstep(x[0], x[1], x[2]), false),
            "step" => none(Expr::select(x[0], Expr::Const(1.0), Expr::Const(0.0)), false),
            "abs" => Typed { expr: x[0].abs(), ..first },
            "sign" => none(x[0].sign(), false),
            "sqrt" => Typed {
                expr: x[0].sqrt(),
                dimension: first.dimension.power(Ratio::new(1, 2)),
                angle: false,
                condition: false,
            },
            _ => {
                for arg in &args {
                    self.pure(arg, formula, &format!("the argument of `{function}`"))?;
                }
                match (function, row) {
                    ("ln", _) => none(x[0].ln(), false),
                    ("cot", _) => none(x[0].cos() / x[0].sin(), false),
                    (_, Some(row)) => {
                        let zero = Expr::Const(0.0);
                        let operand = |i: usize| x.get(i).copied().unwrap_or(zero);
                        let angle = matches!(row.op, Op::Asin | Op::Acos | Op::Atan);
                        none(headland_expr::ops::apply(row.op, operand(0), operand(1), operand(2)), angle)
                    }
                    _ => return Err(self.report(place, format!("unknown function `{function}`"))),
                }
            }
        })
    }

    fn conditional(
        &mut self,
        args: &[(Typed<'g>, std::ops::Range<usize>)],
        formula: &Formula,
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        let (condition, a, b) = (&args[0].0, &args[1].0, &args[2].0);
        if !condition.condition {
            return Err(self.report(place, "the first argument of `if` must be a comparison such as `t >= 3`"));
        }
        self.no_conditions(&args[1..], formula)?;
        self.same(&args[1], &args[2], formula, &place, "choose between")?;
        let dimension = if a.dimension.is_known() { a.dimension.clone() } else { b.dimension.clone() };
        let expr = Expr::select(condition.expr, a.expr, b.expr);
        Ok(Typed { expr, dimension, angle: a.angle || b.angle, condition: false })
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

    /// Demands a dimension.
    pub fn demand(
        &mut self,
        typed: &Typed<'g>,
        wanted: &Dimension,
        angle: bool,
        formula: &Formula,
        what: &str,
    ) -> Result<(), Reported> {
        match self.unifier.unify(&typed.dimension, wanted) {
            Ok(()) => Ok(()),
            Err((found, wanted)) => {
                let message = format!(
                    "{what} is {} [{}], but `{}` is {} [{}]",
                    wanted.kind(angle),
                    wanted.unit(angle),
                    formula.text,
                    found.kind(typed.angle),
                    found.unit(typed.angle)
                );
                Err(self.report(formula.place.clone(), message))
            }
        }
    }

    fn no_conditions(
        &mut self,
        args: &[(Typed<'g>, std::ops::Range<usize>)],
        formula: &Formula,
    ) -> Result<(), Reported> {
        match args.iter().find(|(a, _)| a.condition) {
            None => Ok(()),
            Some((_, span)) => {
                Err(self.report(formula.place.part(span), "a comparison is not a number; use it in `if(.., .., ..)`"))
            }
        }
    }

    /// Demands equal dimensions; the message names both sides.
    fn same(
        &mut self,
        a: &(Typed<'g>, std::ops::Range<usize>),
        b: &(Typed<'g>, std::ops::Range<usize>),
        formula: &Formula,
        place: &Place,
        verb: &str,
    ) -> Result<(), Reported> {
        let Err((da, db)) = self.unifier.unify(&a.0.dimension, &b.0.dimension) else { return Ok(()) };
        let text = |span: &std::ops::Range<usize>| match formula.text.get(span.clone()) {
            Some(text) if !text.is_empty() => format!("`{text}`"),
            _ => "its argument".into(),
        };
        let describe = |d: &Dimension, angle: bool| format!("{} [{}]", d.kind(angle), d.unit(angle));
        let message = format!(
            "cannot {verb} {} and {}: {} is {}, {} is {}",
            text(&a.1),
            text(&b.1),
            text(&a.1),
            describe(&da, a.0.angle),
            text(&b.1),
            describe(&db, b.0.angle)
        );
        Err(self.report(place.clone(), message))
    }

    fn pure(&mut self, a: &(Typed<'g>, std::ops::Range<usize>), formula: &Formula, what: &str) -> Result<(), Reported> {
        let Err((found, _)) = self.unifier.unify(&a.0.dimension, &Dimension::NONE) else { return Ok(()) };
        let text = formula.text.get(a.1.clone()).unwrap_or("");
        let message = format!(
            "{what} must be a pure number or an angle, but `{text}` is {} [{}]",
            found.kind(a.0.angle),
            found.unit(a.0.angle)
        );
        Err(self.report(formula.place.part(&a.1), message))
    }
}

/// The dimension of a rate.
pub fn per_time(d: &Dimension, primes: u8) -> Dimension {
    (0..primes).fold(d.clone(), |d, _| &d - &Dimension::time())
}

/// A condition that holds where the other does not.
fn not<'g>(condition: Expr<'g>) -> Expr<'g> {
    Expr::select(condition, Expr::Const(-1.0), Expr::Const(1.0))
}

/// 0 below `x0`, 1 above `x1`, `6 s⁵ − 15 s⁴ + 10 s³` between: C².
fn smoothstep<'g>(x: Expr<'g>, x0: Expr<'g>, x1: Expr<'g>) -> Expr<'g> {
    let c = Expr::Const;
    let s = ((x - x0) / (x1 - x0)).max(c(0.0)).min(c(1.0));
    s.powi(3) * (c(10.0) + s * (c(6.0) * s - c(15.0)))
}
