//! C99: expressions in the graph's order of evaluation, and complete functions.
//!
//! Compiled without contraction (`-ffp-contract=off`), a generated function differs from
//! [`Graph::eval`](crate::Graph::eval) only where the C library's functions differ from those Rust was linked with: on
//! one system usually nowhere, else by units in the last place.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::listing::Plan;
use super::names::Names;
use super::{ATOM, ListingOptions, PREFIX, PRODUCT, Style, Task, UNLIMITED, Writer};
use crate::field::FIELD_BEYOND;
use crate::graph::{Graph, NodeId};
use crate::ops::{Form, Op};

/// Helper functions that generated code calls; put once before it.
pub const C_PRELUDE: &str = r"#include <math.h>

static inline double headland_sign(double a) { return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : a; }
static inline double headland_min(double a, double b) { return a != a || a < b ? a : b; }
static inline double headland_max(double a, double b) { return a != a || a > b ? a : b; }
static inline double headland_select(double c, double a, double b) { return c >= 0.0 ? a : b; }

/* By repeated squaring; n > 0. */
static inline double headland_powi(double base, unsigned n)
{
    double product = 1.0;
    while (n > 0u) {
        if (n & 1u) product *= base;
        n >>= 1;
        if (n > 0u) base *= base;
    }
    return product;
}

/* A derivative of a cubic spline with n knots, continued linearly. */
static inline double headland_spline(const double *knot, const double (*row)[4], int n, double at, int order)
{
    int lo = 0, hi = n;
    double d, c0, c1, c2, c3;
    while (lo < hi) {
        const int mid = lo + (hi - lo) / 2;
        if (knot[mid] <= at) lo = mid + 1; else hi = mid;
    }
    d = at - knot[lo > 0 ? lo - 1 : 0];
    c0 = row[lo > 0 ? lo - 1 : 0][0];
    c1 = row[lo > 0 ? lo - 1 : 0][1];
    c2 = lo > 0 ? row[lo - 1][2] : 0.0;
    c3 = lo > 0 ? row[lo - 1][3] : 0.0;
    switch (order) {
    case 0: return c0 + d * (c1 + d * (c2 + d * c3));
    case 1: return c1 + d * (2.0 * c2 + d * 3.0 * c3);
    case 2: return 2.0 * c2 + d * 6.0 * c3;
    case 3: return 6.0 * c3 + 0.0 * d;
    default: return 0.0 * d;
    }
}
";

/// Largest exponent whose multiplications are written out.
const WRITTEN_OUT: u32 = 4;

impl Writer<'_> {
    fn level_c(&self, id: NodeId, depth: u32) -> u8 {
        if self.name(id, depth).is_some() {
            return ATOM;
        }
        let node = self.graph.node(id);
        match node.op {
            Op::Const if self.graph.constant_value(id).is_some_and(f64::is_sign_negative) => PREFIX,
            Op::Powi if node.exponent() < 0 || node.exponent().unsigned_abs() <= WRITTEN_OUT => PRODUCT,
            op => match op.info().map(|row| row.form) {
                Some(Form::Infix(strength)) => strength,
                _ => ATOM,
            },
        }
    }

    pub(super) fn expand_c(&self, id: NodeId, level: u8, depth: u32, out: &mut Vec<Task>) {
        if let Some(name) = self.name(id, depth) {
            return out.push(Task::owned(name.to_string()));
        }
        let brackets = self.level_c(id, depth) < level;
        if brackets {
            out.push(Task::text("("));
        }
        self.body_c(id, depth, out);
        if brackets {
            out.push(Task::text(")"));
        }
    }

    fn body_c(&self, id: NodeId, depth: u32, out: &mut Vec<Task>) {
        let node = self.graph.node(id);
        let operands: Vec<NodeId> = node.operands().collect();
        let sub = |k: usize, level: u8| Task::Node { id: operands[k], level, unsigned: false, depth: depth + 1 };
        match (node.op, node.op.info()) {
            (Op::Const, _) => {
                let x = self.graph.constant_value(id).unwrap_or(f64::NAN);
                let sign = if x.is_sign_negative() && !x.is_nan() { "-" } else { "" };
                out.push(Task::owned(format!("{sign}{}", self.number(x))));
            }
            (Op::Input, _) => out.push(Task::owned(self.input_name(node.args[0] as usize))),
            (Op::Powi, _) => self.powi_c(operands[0], node.exponent(), depth, out),
            (Op::Spline, _) => {
                let (table, order) = (node.args[1], node.args[2]);
                let n = self.graph.spline(table).knots().len();
                let name = table_name(table);
                out.push(Task::owned(format!("headland_spline({name}_x, {name}_c, {n}, ")));
                out.extend([sub(0, 0), Task::owned(format!(", {order})"))]);
            }
            (Op::Field, _) if usize::from(node.part) == FIELD_BEYOND => out.push(Task::text("NAN")),
            (Op::Field, _) => {
                out.push(Task::owned(format!("{}(", self.field_name(node.field))));
                for k in 0..operands.len() {
                    out.extend([sub(k, 0), Task::text(", ")]);
                }
                out.push(Task::owned(format!("{})", node.part)));
            }
            (_, Some(row)) => match row.form {
                Form::Infix(s) if operands.len() == 1 => out.extend([Task::text(row.c), sub(0, s + 1)]),
                Form::Infix(s) if s == super::SUM => {
                    out.extend([sub(0, s), Task::owned(format!(" {} ", row.c)), sub(1, s + 1)]);
                }
                Form::Infix(s) => out.extend([sub(0, s), Task::text(row.c), sub(1, s + 1)]),
                _ => {
                    out.extend([Task::text(row.c), Task::text("(")]);
                    for k in 0..operands.len() {
                        out.extend([Task::text(if k > 0 { ", " } else { "" }), sub(k, 0)]);
                    }
                    out.push(Task::text(")"));
                }
            },
            (_, None) => unreachable!("operators without a row are above"),
        }
    }

    fn field_name(&self, index: u16) -> String {
        field_names(self.graph).swap_remove(usize::from(index))
    }

    /// The multiplications of `<f64 as Scalar>::powi`, in its order.
    fn powi_c(&self, base: NodeId, n: i32, depth: u32, out: &mut Vec<Task>) {
        let operand = |level: u8| Task::Node { id: base, level, unsigned: false, depth: depth + 1 };
        let m = n.unsigned_abs();
        if n < 0 {
            out.push(Task::text(if m == 1 || m > WRITTEN_OUT { "1.0/" } else { "1.0/(" }));
        }
        let star = || Task::text("*");
        match m {
            1 => out.push(operand(PREFIX)),
            2 => out.extend([operand(PREFIX), star(), operand(PREFIX)]),
            3 => {
                out.extend([
                    operand(PREFIX),
                    Task::text("*("),
                    operand(PREFIX),
                    star(),
                    operand(PREFIX),
                    Task::text(")"),
                ]);
            }
            4 => {
                let square = || [Task::text("("), operand(PREFIX), star(), operand(PREFIX), Task::text(")")];
                out.extend(square());
                out.push(star());
                out.extend(square());
            }
            _ => out.extend([Task::text("headland_powi("), operand(0), Task::owned(format!(", {m}u)"))]),
        }
        if n < 0 && m > 1 && m <= WRITTEN_OUT {
            out.push(Task::text(")"));
        }
    }
}

fn table_name(index: u32) -> String {
    format!("headland_table_{index}")
}

/// The names of all fields of a graph as functions of C.
fn field_names(graph: &Graph) -> Vec<String> {
    let mut names = Names::default();
    let fields = graph.arena().borrow().fields.clone();
    fields.iter().map(|field| format!("headland_field_{}", names.take(Style::C, field.name()))).collect()
}

/// What someone who writes the function of a field must know.
const FIELD_LAYOUT: &str = r"
/* Functions that come from elsewhere: value (part 0) or a derivative at (x, y, z).
   part  0: f
         1: f_x    2: f_y    3: f_z
         4: f_xx   5: f_xy   6: f_xz   7: f_yy   8: f_yz   9: f_zz
        10: f_xxx 11: f_xxy 12: f_xxz 13: f_xyy 14: f_xyz 15: f_xzz 16: f_yyy 17: f_yyz 18: f_yzz 19: f_zzz */
";

/// The tables that the given nodes need, as static arrays; the fields, as functions that are defined elsewhere.
pub fn c_tables(graph: &Graph, roots: &[NodeId]) -> String {
    let needed = graph.needed(roots);
    let nodes = (0..needed.len()).filter(|&i| needed[i]).map(|i| graph.node(NodeId(i as u32)));
    let (mut tables, mut fields) = (BTreeSet::new(), BTreeSet::new());
    for node in nodes {
        match node.op {
            Op::Spline => drop(tables.insert(node.args[1])),
            Op::Field => drop(fields.insert(node.field)),
            _ => {}
        }
    }
    let mut text = String::new();
    if !fields.is_empty() {
        text.push_str(FIELD_LAYOUT);
        let names = field_names(graph);
        for field in fields {
            let name = &names[usize::from(field)];
            let _ = writeln!(text, "extern double {name}(double x, double y, double z, int part);");
        }
    }
    for index in tables {
        let (table, name) = (graph.spline(index), table_name(index));
        let n = table.knots().len();
        let knots: Vec<String> = table.knots().iter().map(|x| format!("{x:?}")).collect();
        let rows = table.coefficients().iter().map(|[a, b, c, d]| format!("    {{{a:?}, {b:?}, {c:?}, {d:?}}}"));
        let rows: Vec<String> = rows.collect();
        let _ = writeln!(text, "static const double {name}_x[{n}] = {{{}}};", knots.join(", "));
        let _ = writeln!(text, "static const double {name}_c[{n}][4] = {{\n{}\n}};", rows.join(",\n"));
    }
    text
}

/// The function `void NAME(const double *x, double *y)`: `y[k]` is root `k`, `x[i]` input `i` of the graph.
///
/// It needs [`C_PRELUDE`] and [`c_tables`] before it; nodes in `named` keep their names as variables.
pub fn c_function(graph: &Graph, name: &str, roots: &[NodeId], named: &[(NodeId, String)]) -> String {
    let plan = Plan::new(graph, Style::C, roots, named, &ListingOptions::of(Style::C));
    let writer = Writer { graph, style: Style::C, names: &plan.names, limits: UNLIMITED };
    let mut text = format!("void {name}(const double *x, double *y)\n{{\n");
    let mut inputs: Vec<(u32, &String)> = plan
        .names
        .iter()
        .map(|(id, name)| (graph.node(*id), name))
        .filter_map(|(node, name)| (node.op == Op::Input).then_some((node.args[0], name)))
        .collect();
    inputs.sort_unstable();
    if inputs.is_empty() {
        text.push_str("    (void)x;\n");
    }
    for (index, input) in inputs {
        let _ = writeln!(text, "    const double {input} = x[{index}];");
    }
    for id in &plan.steps {
        let _ = writeln!(text, "    const double {} = {};", plan.names[id], writer.write(*id));
    }
    for (k, id) in roots.iter().enumerate() {
        let _ = writeln!(text, "    y[{k}] = {};", plan.root(&writer, *id));
    }
    if roots.is_empty() {
        text.push_str("    (void)y;\n");
    }
    text + "}\n"
}

/// A complete file: helper functions, tables, declarations of fields and the function `name`.
///
/// ```
/// use headland_expr::{Graph, Scalar, print::c_file};
///
/// let graph = Graph::new();
/// let theta = graph.input("theta[1]");
/// let root = graph.id(theta.sin().powi(2));
/// let text = c_file(&graph, "height", &[root], &[]);
/// assert!(text.contains("const double theta_1 = x[0];"));
/// ```
pub fn c_file(graph: &Graph, name: &str, roots: &[NodeId], named: &[(NodeId, String)]) -> String {
    format!("{C_PRELUDE}\n{}\n{}", c_tables(graph, roots), c_function(graph, name, roots, named))
}
