//! [`Expr`]: a number or a node of a graph, and the simplifications made while it is built.
//!
//! Rules: constants fold; 0, 1 and −1 vanish; signs move outward (`a + (−b) = a − b`, `(−a) b = −(a b)`); operands of
//! commutative operators are sorted; `b − a` reuses `a − b`; `x x = x²`, `(√x)² = x`, `q (p/q) = p`, `sin² + cos² = 1`. Nothing that
//! would need to know a variable's sign is done, except that `√x` is taken to be real.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::field::{FIELD_BEYOND, Field, field_exponents, field_value};
use crate::graph::{Graph, Node, NodeId};
use crate::ops::{Op, apply};
use crate::scalar::Scalar;
use crate::spline::Spline;

/// An expression: a number, or a node of a [`Graph`]. Constants need no arena.
#[derive(Clone, Copy)]
pub enum Expr<'g> {
    /// A number.
    Const(f64),
    /// A node.
    Node(&'g Graph, NodeId),
}

impl std::fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Expr::Const(x) => write!(f, "{x}"),
            Expr::Node(graph, id) => write!(f, "{}", crate::print::text(graph, *id)),
        }
    }
}

impl PartialEq for Expr<'_> {
    /// The same number or the same node: equal because hash-consed, not by algebra.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Expr::Const(a), Expr::Const(b)) => a == b,
            (Expr::Node(_, a), Expr::Node(_, b)) => a == b,
            _ => false,
        }
    }
}

impl<'g> Expr<'g> {
    /// The number, if it is one.
    pub fn value(self) -> Option<f64> {
        match self {
            Expr::Const(x) => Some(x),
            Expr::Node(..) => None,
        }
    }

    /// True for the number `x`.
    pub fn is(self, x: f64) -> bool {
        self.value() == Some(x)
    }

    fn node(self) -> Option<(&'g Graph, Node)> {
        match self {
            Expr::Const(_) => None,
            Expr::Node(graph, id) => Some((graph, graph.node(id))),
        }
    }

    /// Operands of `self` if it is an `op`.
    fn match_op(self, op: Op) -> Option<[Expr<'g>; 2]> {
        let (graph, node) = self.node()?;
        (node.op == op).then(|| {
            let get = |k: usize| if k < op.arity() { graph.expr(NodeId(node.args[k])) } else { Expr::Const(0.0) };
            [get(0), get(1)]
        })
    }

    fn negated(self) -> Option<Expr<'g>> {
        match self {
            Expr::Const(x) if x < 0.0 => Some(Expr::Const(-x)),
            Expr::Const(_) => None,
            _ => self.match_op(Op::Neg).map(|[a, _]| a),
        }
    }

    /// `(base, n)` of `baseⁿ`; `n = 1` for anything else.
    fn as_power(self) -> (Expr<'g>, i32) {
        match self.node() {
            Some((graph, node)) if node.op == Op::Powi => (graph.expr(NodeId(node.args[0])), node.exponent()),
            _ => (self, 1),
        }
    }

    /// True for `sin² x` and `cos² x`, in either order.
    fn completes_to_one(self, other: Self) -> bool {
        let pair = |s: Self, c: Self| match (s.is_square_of(Op::Sin), c.is_square_of(Op::Cos)) {
            (Some(x), Some(y)) => x == y,
            _ => false,
        };
        pair(self, other) || pair(other, self)
    }

    fn is_square_of(self, op: Op) -> Option<Expr<'g>> {
        match self.as_power() {
            (base, 2) => base.match_op(op).map(|[a, _]| a),
            _ => None,
        }
    }
}

/// The graph of the first operand that has one.
fn graph_of<'g>(operands: &[Expr<'g>]) -> &'g Graph {
    operands
        .iter()
        .find_map(|e| match e {
            Expr::Node(graph, _) => Some(*graph),
            Expr::Const(_) => None,
        })
        .expect("constants fold before a node is made")
}

/// The node `op(operands)`, made without simplification; commutative operands sorted.
fn make<'g>(op: Op, operands: &[Expr<'g>]) -> Expr<'g> {
    let graph = graph_of(operands);
    let mut args = [0; 3];
    for (arg, operand) in args.iter_mut().zip(operands) {
        *arg = graph.id(*operand).0;
    }
    if op.info().is_some_and(|row| row.commutes) && args[0] > args[1] {
        args.swap(0, 1);
    }
    Expr::Node(graph, graph.arena().borrow_mut().insert(Node::new(op, args)))
}

/// A function of one operand, folded if it is a number and the result is finite.
fn unary<'g>(op: Op, a: Expr<'g>) -> Expr<'g> {
    match a {
        Expr::Const(x) => Expr::Const(apply(op, x, 0.0, 0.0)),
        _ => make(op, &[a]),
    }
}

fn odd<'g>(op: Op, a: Expr<'g>) -> Expr<'g> {
    match (a, a.negated()) {
        (Expr::Node(..), Some(inner)) => -unary(op, inner),
        _ => unary(op, a),
    }
}

fn even<'g>(op: Op, a: Expr<'g>) -> Expr<'g> {
    match (a, a.negated()) {
        (Expr::Node(..), Some(inner)) => unary(op, inner),
        _ => unary(op, a),
    }
}

impl<'g> Add for Expr<'g> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let a = self;
        match (a, b) {
            (Expr::Const(x), Expr::Const(y)) => return Expr::Const(x + y),
            (Expr::Const(0.0), _) => return b,
            (_, Expr::Const(0.0)) => return a,
            _ => {}
        }
        if let (Expr::Node(..), Some(b)) = (b, b.negated()) {
            return a - b;
        }
        if let (Expr::Node(..), Some(a)) = (a, a.negated()) {
            return b - a;
        }
        if a == b {
            return Expr::Const(2.0) * a;
        }
        if a.completes_to_one(b) {
            return Expr::Const(1.0);
        }
        // f sin² + f cos² = f
        if let (Some([f, p]), Some([g, q])) = (a.match_op(Op::Mul), b.match_op(Op::Mul)) {
            for (f, p, g, q) in [(f, p, g, q), (p, f, g, q), (f, p, q, g), (p, f, q, g)] {
                if f == g && p.completes_to_one(q) {
                    return f;
                }
            }
        }
        // c + (d + x) = (c + d) + x for numbers c, d
        for (c, sum) in [(a, b), (b, a)] {
            if let (Some(c), Some([first, rest])) = (c.value(), sum.match_op(Op::Add)) {
                if let Some(d) = first.value() {
                    return Expr::Const(c + d) + rest;
                }
                if let Some(d) = rest.value() {
                    return Expr::Const(c + d) + first;
                }
            }
        }
        make(Op::Add, &[a, b])
    }
}

impl<'g> Sub for Expr<'g> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        let a = self;
        match (a, b) {
            (Expr::Const(x), Expr::Const(y)) => return Expr::Const(x - y),
            (_, Expr::Const(0.0)) => return a,
            (Expr::Const(0.0), _) => return -b,
            (_, Expr::Const(y)) => return a + Expr::Const(-y),
            _ => {}
        }
        if a == b {
            return Expr::Const(0.0);
        }
        if let Some(b) = b.negated() {
            return a + b;
        }
        if let (Expr::Node(..), Some(a)) = (a, a.negated()) {
            return -(a + b);
        }
        let graph = graph_of(&[a, b]);
        let mirrored = Node::new(Op::Sub, [graph.id(b).0, graph.id(a).0, 0]);
        let known = graph.arena().borrow().find(mirrored);
        match known {
            Some(id) => make(Op::Neg, &[Expr::Node(graph, id)]),
            None => make(Op::Sub, &[a, b]),
        }
    }
}

impl<'g> Mul for Expr<'g> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let a = self;
        match (a, b) {
            (Expr::Const(x), Expr::Const(y)) => return Expr::Const(x * y),
            (Expr::Const(0.0), _) | (_, Expr::Const(0.0)) => return Expr::Const(0.0),
            (Expr::Const(1.0), _) => return b,
            (_, Expr::Const(1.0)) => return a,
            (Expr::Const(-1.0), _) => return -b,
            (_, Expr::Const(-1.0)) => return -a,
            _ => {}
        }
        if let Some(inner) = a.negated() {
            return -(inner * b);
        }
        if let Some(inner) = b.negated() {
            return -(a * inner);
        }
        // q (p / q) = p, and a (c / q) = (c a) / q for a number c
        for (x, quotient) in [(a, b), (b, a)] {
            if let Some([p, q]) = quotient.match_op(Op::Div) {
                if q == x {
                    return p;
                }
                if let Expr::Const(_) = p {
                    return p * x / q;
                }
            }
            // q (a (p / q)) = a p
            if let Some([first, second]) = quotient.match_op(Op::Mul) {
                for (factor, inner) in [(first, second), (second, first)] {
                    if let Some([p, q]) = inner.match_op(Op::Div)
                        && q == x
                    {
                        return factor * p;
                    }
                }
            }
        }
        let ((base_a, n), (base_b, m)) = (a.as_power(), b.as_power());
        if base_a == base_b && !matches!(a, Expr::Const(_)) && n > 0 && m > 0 {
            return base_a.powi(n + m);
        }
        // c (d x) = (c d) x for numbers c, d
        for (c, product) in [(a, b), (b, a)] {
            if let (Some(c), Some([first, rest])) = (c.value(), product.match_op(Op::Mul)) {
                if let Some(d) = first.value() {
                    return Expr::Const(c * d) * rest;
                }
                if let Some(d) = rest.value() {
                    return Expr::Const(c * d) * first;
                }
            }
        }
        make(Op::Mul, &[a, b])
    }
}

impl<'g> Div for Expr<'g> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let a = self;
        match (a, b) {
            (Expr::Const(x), Expr::Const(y)) => return Expr::Const(x / y),
            (Expr::Const(0.0), _) => return Expr::Const(0.0),
            (_, Expr::Const(1.0)) => return a,
            (_, Expr::Const(-1.0)) => return -a,
            _ => {}
        }
        if a == b {
            return Expr::Const(1.0);
        }
        if let Some(inner) = a.negated() {
            return -(inner / b);
        }
        if let Some(inner) = b.negated() {
            return -(a / inner);
        }
        if let Some([first, rest]) = a.match_op(Op::Mul) {
            if first == b {
                return rest;
            }
            if rest == b {
                return first;
            }
        }
        let ((base_a, n), (base_b, m)) = (a.as_power(), b.as_power());
        if base_a == base_b && n >= m && m > 0 && !matches!(a, Expr::Const(_)) {
            return base_a.powi(n - m);
        }
        make(Op::Div, &[a, b])
    }
}

impl<'g> Neg for Expr<'g> {
    type Output = Self;
    fn neg(self) -> Self {
        if let Expr::Const(x) = self {
            return Expr::Const(-x);
        }
        if let Some(inner) = self.negated() {
            return inner;
        }
        make(Op::Neg, &[self])
    }
}

impl<'g> Scalar for Expr<'g> {
    fn constant(x: f64) -> Self {
        Expr::Const(x)
    }
    fn powi(self, n: i32) -> Self {
        if let Expr::Const(x) = self {
            return Expr::Const(Scalar::powi(x, n));
        }
        if n == 0 {
            return Expr::Const(1.0);
        }
        if n == 1 {
            return self;
        }
        if let Some(inner) = self.negated() {
            return if n % 2 == 0 { inner.powi(n) } else { -inner.powi(n) };
        }
        if let Some([inner, _]) = self.match_op(Op::Sqrt)
            && n % 2 == 0
        {
            return inner.powi(n / 2);
        }
        if let (base, m) = self.as_power()
            && m != 1
            && let Some(total) = m.checked_mul(n)
        {
            return base.powi(total);
        }
        let graph = graph_of(&[self]);
        let node = Node::new(Op::Powi, [graph.id(self).0, n as u32, 0]);
        Expr::Node(graph, graph.arena().borrow_mut().insert(node))
    }
    fn pow(self, y: Self) -> Self {
        match (self, y) {
            (Expr::Const(x), Expr::Const(y)) => Expr::Const(x.powf(y)),
            (_, Expr::Const(y)) if y == y.trunc() && y.abs() <= 1024.0 => self.powi(y as i32),
            (_, Expr::Const(0.5)) => self.sqrt(),
            _ => make(Op::Pow, &[self, y]),
        }
    }
    fn sqrt(self) -> Self {
        match self.as_power() {
            (base, 2) => base.abs(),
            _ => unary(Op::Sqrt, self),
        }
    }
    fn exp(self) -> Self {
        unary(Op::Exp, self)
    }
    fn ln(self) -> Self {
        unary(Op::Ln, self)
    }
    fn sin(self) -> Self {
        odd(Op::Sin, self)
    }
    fn cos(self) -> Self {
        even(Op::Cos, self)
    }
    fn tan(self) -> Self {
        odd(Op::Tan, self)
    }
    fn asin(self) -> Self {
        odd(Op::Asin, self)
    }
    fn acos(self) -> Self {
        unary(Op::Acos, self)
    }
    fn atan(self) -> Self {
        odd(Op::Atan, self)
    }
    fn atan2(self, x: Self) -> Self {
        match (self, x) {
            (Expr::Const(y), Expr::Const(x)) => Expr::Const(y.atan2(x)),
            _ => make(Op::Atan2, &[self, x]),
        }
    }
    fn sinh(self) -> Self {
        odd(Op::Sinh, self)
    }
    fn cosh(self) -> Self {
        even(Op::Cosh, self)
    }
    fn tanh(self) -> Self {
        odd(Op::Tanh, self)
    }
    fn abs(self) -> Self {
        match self.match_op(Op::Abs) {
            Some(_) => self,
            None => even(Op::Abs, self),
        }
    }
    fn sign(self) -> Self {
        odd(Op::Sign, self)
    }
    fn min(self, other: Self) -> Self {
        match (self, other) {
            (Expr::Const(x), Expr::Const(y)) => Expr::Const(Scalar::min(x, y)),
            _ if self == other => self,
            _ => make(Op::Min, &[self, other]),
        }
    }
    fn max(self, other: Self) -> Self {
        match (self, other) {
            (Expr::Const(x), Expr::Const(y)) => Expr::Const(Scalar::max(x, y)),
            _ if self == other => self,
            _ => make(Op::Max, &[self, other]),
        }
    }
    fn select(cond: Self, a: Self, b: Self) -> Self {
        match cond {
            _ if a == b => a,
            Expr::Const(x) => {
                if x >= 0.0 {
                    a
                } else {
                    b
                }
            }
            _ => make(Op::Select, &[cond, a, b]),
        }
    }
    fn spline(self, table: &Spline, order: u8) -> Self {
        match self {
            Expr::Const(x) => Expr::Const(table.eval(x, order)),
            _ if order > 3 => Expr::Const(0.0),
            Expr::Node(graph, id) => {
                let index = graph.table(Arc::new(table.clone()));
                let node = Node::new(Op::Spline, [id.0, index, u32::from(order)]);
                Expr::Node(graph, graph.arena().borrow_mut().insert(node))
            }
        }
    }
    /// Variables that the field does not have become 0, so that points which differ in them alone are one.
    fn field(mut point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self {
        let known = field.variables().min(3);
        point[known..].fill(Expr::Const(0.0));
        if field_exponents(part).is_some_and(|times| times[known..].iter().any(|&n| n > 0)) {
            return Expr::Const(0.0);
        }
        if let [Expr::Const(x), Expr::Const(y), Expr::Const(z)] = point {
            return Expr::Const(field_value(&**field, [x, y, z], part));
        }
        let graph = graph_of(&point);
        let args = point.map(|e| graph.id(e).0);
        let field = graph.register_field(field);
        let node = Node { op: Op::Field, part: part.min(FIELD_BEYOND) as u8, field, args };
        Expr::Node(graph, graph.arena().borrow_mut().insert(node))
    }
}
