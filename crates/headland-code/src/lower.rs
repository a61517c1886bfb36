//! [`lower`]: from a program's nodes to the steps of a tape, values still unlimited.
//!
//! Integer powers become multiplications in the order of `<f64 as Scalar>::powi`; sine and cosine of one argument
//! become one step, and so do all parts of a field at one point. Nothing is reassociated and nothing is contracted to a fused multiply-add.

use std::sync::Arc;

use headland_expr::field::field_order;
use headland_expr::graph::Node;
use headland_expr::{FIELD_PARTS, Field, Op, Spline};
use rustc_hash::FxHashMap;

use crate::program::Program;

/// What the interpreter dispatches on.
///
/// The arithmetic that the mechanics consists of has its own code; everything else goes through the operator table
/// (`Other`), so no operator is spelled out twice.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(crate) enum Code {
    /// `dst = a + b`
    Add,
    /// `dst = a − b`
    Sub,
    /// `dst = a b`
    Mul,
    /// `dst = a / b`
    Div,
    /// `dst = −a`
    Neg,
    /// `dst = op(a, b)`, by the operator table
    Other,
    /// `dst = sin a`, `b = cos a`: `b` is written
    SinCos,
    /// `dst = a` where a condition is `≥ 0`, else `b`; the condition is the `a` of a second row of operands
    Select,
    /// `dst` = table `b` at `a`
    Spline,
    /// `dst` and what follows = parts of a field at `(a, b, c)`; `c` and the field are the operands of a second row
    Field,
    /// `dst = a`
    Copy,
}

/// No value.
pub(crate) const NONE: u32 = u32::MAX;

/// One step; what it writes and reads are values, each written once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) code: Code,
    pub(crate) op: Op,
    /// The first value written, and how many are.
    pub(crate) dst: u32,
    pub(crate) count: u8,
    pub(crate) src: [u32; 3],
    /// Index of a table or a field.
    pub(crate) table: u32,
}

impl Step {
    pub(crate) fn dst(&self) -> impl Iterator<Item = u32> + use<> {
        self.dst..self.dst + u32::from(self.count)
    }
}

/// A function as straight-line code over values `0 .. values`.
#[derive(Default)]
pub(crate) struct Lowered {
    pub(crate) values: u32,
    /// `(value, input)`.
    pub(crate) loads: Vec<(u32, u32)>,
    /// `(value, number)`.
    pub(crate) constants: Vec<(u32, f64)>,
    pub(crate) steps: Vec<Step>,
    pub(crate) tables: Vec<(Arc<Spline>, u8)>,
    /// Fields, each with the order up to which it is evaluated.
    pub(crate) fields: Vec<(Arc<dyn Field>, usize)>,
    /// The value of each output.
    pub(crate) outputs: Vec<u32>,
}

/// The steps of a program, in its order.
pub(crate) fn lower(program: &Program) -> Lowered {
    let (both, fields) = (sine_and_cosine(program), fields_at_points(program));
    let mut lowering = Lowering { both, fields, ..Lowering::default() };
    let mut value = Vec::with_capacity(program.nodes.len());
    for node in &program.nodes {
        let operand = |k: usize| {
            if k < node.op.arity() { value[node.args[k] as usize] } else { NONE }
        };
        let src = [operand(0), operand(1), operand(2)];
        value.push(match node.op {
            Op::Const => lowering.constant(program.numbers[node.args[0] as usize]),
            Op::Input => lowering.load(node.args[0]),
            Op::Powi => lowering.power(src[0], node.exponent()),
            Op::Spline => lowering.spline(src[0], &program.splines[node.args[1] as usize], node.args[2] as u8),
            Op::Field => lowering.field(node, &program.fields[usize::from(node.field)], src),
            Op::Sin if lowering.both.contains_key(&node.args[0]) => lowering.sin_cos(node.args[0], src[0])[0],
            Op::Cos if lowering.both.contains_key(&node.args[0]) => lowering.sin_cos(node.args[0], src[0])[1],
            op => lowering.step(code(op), op, src),
        });
    }
    lowering.out.outputs = program.outputs.iter().map(|&i| value[i as usize]).collect();
    lowering.out
}

fn code(op: Op) -> Code {
    match op {
        Op::Add => Code::Add,
        Op::Sub => Code::Sub,
        Op::Mul => Code::Mul,
        Op::Div => Code::Div,
        Op::Neg => Code::Neg,
        Op::Select => Code::Select,
        _ => Code::Other,
    }
}

/// Nodes of which both the sine and the cosine are needed.
fn sine_and_cosine(program: &Program) -> FxHashMap<u32, Option<[u32; 2]>> {
    let mut seen: FxHashMap<u32, Op> = FxHashMap::default();
    let mut both = FxHashMap::default();
    for node in program.nodes.iter().filter(|node| matches!(node.op, Op::Sin | Op::Cos)) {
        if seen.insert(node.args[0], node.op).is_some_and(|other| other != node.op) {
            both.insert(node.args[0], None);
        }
    }
    both
}

/// What a field's step is told by: its point and the field.
type FieldAt = ([u32; 3], u16);

/// The highest order at which each field is needed at each point.
fn fields_at_points(program: &Program) -> FxHashMap<FieldAt, (usize, Option<u32>)> {
    let mut found: FxHashMap<FieldAt, (usize, Option<u32>)> = FxHashMap::default();
    for node in program.nodes.iter().filter(|node| node.op == Op::Field) {
        if let Some(order) = field_order(usize::from(node.part)) {
            let (highest, _) = found.entry((node.args, node.field)).or_default();
            *highest = order.max(*highest);
        }
    }
    found
}

#[derive(Default)]
struct Lowering {
    out: Lowered,
    /// Values of sine and cosine once computed.
    both: FxHashMap<u32, Option<[u32; 2]>>,
    /// Order up to which a field is evaluated at a point, and the first of its values once computed.
    fields: FxHashMap<FieldAt, (usize, Option<u32>)>,
    numbers: FxHashMap<u64, u32>,
    /// Products that powers have in common.
    products: FxHashMap<[u32; 2], u32>,
}

impl Lowering {
    fn value(&mut self) -> u32 {
        self.values(1)
    }

    /// The first of so many new values.
    fn values(&mut self, count: u8) -> u32 {
        self.out.values += u32::from(count);
        self.out.values - u32::from(count)
    }

    fn step(&mut self, code: Code, op: Op, src: [u32; 3]) -> u32 {
        let dst = self.value();
        self.out.steps.push(Step { code, op, dst, count: 1, src, table: 0 });
        dst
    }

    fn constant(&mut self, x: f64) -> u32 {
        if let Some(&value) = self.numbers.get(&x.to_bits()) {
            return value;
        }
        let value = self.value();
        self.numbers.insert(x.to_bits(), value);
        self.out.constants.push((value, x));
        value
    }

    fn load(&mut self, input: u32) -> u32 {
        let value = self.value();
        self.out.loads.push((value, input));
        value
    }

    fn spline(&mut self, x: u32, table: &Arc<Spline>, order: u8) -> u32 {
        let known = self.out.tables.iter().position(|(t, o)| Arc::ptr_eq(t, table) && *o == order);
        let index = known.unwrap_or_else(|| {
            self.out.tables.push((table.clone(), order));
            self.out.tables.len() - 1
        });
        let dst = self.step(Code::Spline, Op::Spline, [x, NONE, NONE]);
        if let Some(step) = self.out.steps.last_mut() {
            step.table = index as u32;
        }
        dst
    }

    fn sin_cos(&mut self, node: u32, x: u32) -> [u32; 2] {
        if let Some(&Some(values)) = self.both.get(&node) {
            return values;
        }
        let dst = self.values(2);
        self.out.steps.push(Step { code: Code::SinCos, op: Op::Sin, dst, count: 2, src: [x, NONE, NONE], table: 0 });
        self.both.insert(node, Some([dst, dst + 1]));
        [dst, dst + 1]
    }

    /// One part; the first that is met at a point computes all that are needed there.
    fn field(&mut self, node: &Node, field: &Arc<dyn Field>, src: [u32; 3]) -> u32 {
        let (part, at) = (usize::from(node.part), (node.args, node.field));
        if field_order(part).is_none() {
            return self.constant(f64::NAN);
        }
        let (order, first) = self.fields[&at];
        let first = first.unwrap_or_else(|| {
            let known = self.out.fields.iter().position(|(f, o)| Arc::ptr_eq(f, field) && *o == order);
            let index = known.unwrap_or_else(|| {
                self.out.fields.push((field.clone(), order));
                self.out.fields.len() - 1
            });
            let count = FIELD_PARTS[order] as u8;
            let dst = self.values(count);
            self.out.steps.push(Step { code: Code::Field, op: Op::Field, dst, count, src, table: index as u32 });
            self.fields.insert(at, (order, Some(dst)));
            dst
        });
        first + part as u32
    }

    fn product(&mut self, a: u32, b: u32) -> u32 {
        if let Some(&value) = self.products.get(&[a, b]) {
            return value;
        }
        let value = self.step(Code::Mul, Op::Mul, [a, b, NONE]);
        self.products.insert([a, b], value);
        value
    }

    /// `xⁿ` by repeated squaring, factor by factor as `<f64 as Scalar>::powi`; its leading `1 · x` is `x`.
    fn power(&mut self, x: u32, n: i32) -> u32 {
        let mut base = x;
        let mut left = n.unsigned_abs();
        let mut product = None;
        while left > 0 {
            if left & 1 == 1 {
                product = Some(product.map_or(base, |p| self.product(p, base)));
            }
            left >>= 1;
            if left > 0 {
                base = self.product(base, base);
            }
        }
        let one = if n <= 0 { self.constant(1.0) } else { NONE };
        match product {
            None => one,
            Some(p) if n < 0 => self.step(Code::Div, Op::Div, [one, p, NONE]),
            Some(p) => p,
        }
    }
}
