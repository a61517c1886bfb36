//! Expressions of a scene into the graph, with dimensions checked and definitions made in the order of need.
//!
//! Nothing recurses over expressions: a program is run on a stack, and definitions are walked with an explicit one, so
//! that a train of thousands of members is no deeper than one of three.

use crate::assembly::Motion;
use crate::definitions::{Instance, State};
use crate::depend::{Dependence, Kinds};
use crate::dimension::{Dimension, Ratio, Unifier};
use crate::functions::not;
use crate::model::{Coordinate, Derived, DerivedQuantity, QuasiVelocity};
use crate::place::{Diagnostic, Place};
use crate::symbols::{Binding, Formula, Symbol, Symbols};
use crate::units::parse_unit;
use headland_expr::parse::{Comparison, Item, Program, parse, suggestion};
use headland_expr::{Expr, Graph, NodeId, Op, Scalar};
use rustc_hash::{FxHashMap, FxHashSet};
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
    /// Names of definitions and functions of time that an expression has used.
    pub used: FxHashSet<String>,
    /// Prescribed coordinates that were declared with a unit.
    pub declared: FxHashMap<String, (Dimension, bool)>,
    pub(crate) instances: FxHashMap<Instance, State<'g>>,
    pub(crate) derivatives: FxHashMap<(NodeId, u8), Expr<'g>>,
    /// Arrays used as `name[k]`, with the index and its number of members.
    pub indexed: BTreeMap<String, (Arc<str>, i64)>,
    /// Definitions made, in order.
    pub made: Vec<Made>,
    /// What the equations can tell, by name, with its dimension; known when outputs are made.
    pub(crate) derived_names: FxHashMap<String, (Derived, Dimension)>,
    /// Sums over all bodies and, when outputs are made, residuals of constraints, by name.
    pub(crate) totals: FxHashMap<String, Typed<'g>>,
    /// Names of elements in which something is wrong, so that what follows from them is not told again.
    pub(crate) unmade: Vec<String>,
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
            totals: FxHashMap::default(),
            unmade: Vec::new(),
            used: FxHashSet::default(),
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
            first_order: false,
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
