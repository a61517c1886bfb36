//! One expression in text or LaTeX, with few parentheses: sums and products are gathered into lists, numbers go first
//! and functions last in a product, signs are drawn out. Regrouping makes the value equal up to rounding, not bit for bit.

use super::{ATOM, POWER, PREFIX, PRODUCT, SUM, Style, Task, Writer, names};
use crate::field::field_exponents;
use crate::graph::{Node, NodeId};
use crate::ops::{Form, Op, OpInfo};

/// Most terms of one sum, or factors of one product, that are gathered.
const GATHERED: usize = 256;

/// Functions whose integer powers LaTeX writes on the name.
const POWER_ON_NAME: &[&str] = &["\\sin", "\\cos", "\\tan", "\\sinh", "\\cosh", "\\tanh"];

/// A positive number in LaTeX, shortest digits that read back to it.
pub(super) fn latex_number(x: f64) -> String {
    if x.is_infinite() {
        return "\\infty".into();
    }
    if x.is_nan() {
        return "\\mathrm{NaN}".into();
    }
    if is_scientific(x) {
        let digits = format!("{x:e}");
        let (mantissa, exponent) = digits.split_once('e').expect("has an exponent");
        return if mantissa == "1" {
            format!("10^{{{exponent}}}")
        } else {
            format!("{mantissa}\\cdot 10^{{{exponent}}}")
        };
    }
    format!("{x}")
}

fn is_scientific(x: f64) -> bool {
    let x = x.abs();
    x.is_finite() && x != 0.0 && !(1e-2..1e6).contains(&x)
}

impl Writer<'_> {
    fn latex(&self) -> bool {
        self.style == Style::Latex
    }

    fn operand(node: Node, k: usize) -> NodeId {
        NodeId(node.args[k])
    }

    /// The node, unless it is written by name.
    fn open(&self, id: NodeId, depth: u32) -> Option<Node> {
        if self.name(id, depth).is_some() { None } else { Some(self.graph.node(id)) }
    }

    /// `(a, b)` of `−(a − b)`, which is written `b − a`.
    fn mirrored(&self, node: Node) -> Option<(NodeId, NodeId)> {
        let inner = self.open(Self::operand(node, 0), 1).filter(|n| node.op == Op::Neg && n.op == Op::Sub)?;
        let (a, b) = (Self::operand(inner, 0), Self::operand(inner, 1));
        (!self.negative(b, 1)).then_some((a, b))
    }

    /// Strength of what is written for a node, its sign left out.
    fn level(&self, id: NodeId, depth: u32) -> u8 {
        let Some(node) = self.open(id, depth) else {
            return ATOM;
        };
        match node.op {
            Op::Const if self.latex() && is_scientific(self.constant(id)) => PRODUCT,
            Op::Const | Op::Input => ATOM,
            Op::Neg if self.mirrored(node).is_some() => SUM,
            Op::Neg => PRODUCT,
            Op::Powi | Op::Pow => POWER,
            Op::Select if self.latex() => SUM,
            Op::Sqrt | Op::Abs => ATOM,
            op => match op.info().map(|row| row.form) {
                Some(Form::Infix(strength)) => strength,
                _ if self.latex() => PREFIX,
                _ => ATOM,
            },
        }
    }

    fn constant(&self, id: NodeId) -> f64 {
        self.graph.constant_value(id).unwrap_or(f64::NAN)
    }

    /// Whether what is written for a node of a product's strength or more begins with a minus sign.
    fn negative(&self, mut id: NodeId, mut depth: u32) -> bool {
        let mut flipped = false;
        for _ in 0..GATHERED {
            let Some(node) = self.open(id, depth) else {
                return flipped;
            };
            match node.op {
                Op::Const => return flipped ^ (self.constant(id) < 0.0),
                Op::Neg if self.mirrored(node).is_none() => flipped = !flipped,
                Op::Div => {}
                Op::Mul => {
                    let signs = self.factors(id, depth).into_iter().filter(|&f| self.negative_factor(f)).count();
                    return flipped ^ (signs % 2 == 1);
                }
                _ => return flipped,
            }
            id = Self::operand(node, 0);
            depth += 1;
            if self.level(id, depth) < PRODUCT {
                return flipped;
            }
        }
        flipped
    }

    /// Signs that a product draws out of its factors: of numbers and of quotients of numbers.
    fn negative_factor(&self, id: NodeId) -> bool {
        self.open(id, 1).is_some_and(|node| match node.op {
            Op::Const => self.constant(id) < 0.0,
            Op::Div => self.graph.constant_value(Self::operand(node, 0)).is_some_and(|x| x < 0.0),
            _ => false,
        })
    }

    /// Factors of a product: numbers first, functions last.
    fn factors(&self, id: NodeId, depth: u32) -> Vec<NodeId> {
        let mut factors = Vec::new();
        let mut stack = vec![(id, depth)];
        while let Some((id, depth)) = stack.pop() {
            match self.open(id, depth) {
                Some(node) if node.op == Op::Mul && factors.len() + stack.len() < GATHERED => {
                    stack.push((Self::operand(node, 1), 1));
                    stack.push((Self::operand(node, 0), 1));
                }
                _ => factors.push(id),
            }
        }
        factors.sort_by_key(|&f| self.place(f));
        factors
    }

    fn place(&self, id: NodeId) -> u8 {
        match self.open(id, 1) {
            Some(node) if node.op == Op::Const => 0,
            Some(node) if self.bare_call(node).is_some() || self.power_on_name(node).is_some() => 2,
            _ => 1,
        }
    }

    /// The row of an operator that LaTeX writes as a name with an argument behind.
    fn bare_call(&self, node: Node) -> Option<&'static OpInfo> {
        let row = node.op.info()?;
        (row.form == Form::Call && !matches!(node.op, Op::Sqrt | Op::Abs | Op::Select)).then_some(row)
    }

    /// `\sin^{n}`: the function's row and node.
    fn power_on_name(&self, node: Node) -> Option<(&'static OpInfo, Node)> {
        if node.op != Op::Powi || node.exponent() < 2 || !self.latex() {
            return None;
        }
        let base = self.open(Self::operand(node, 0), 1)?;
        self.bare_call(base).filter(|row| POWER_ON_NAME.contains(&row.latex)).map(|row| (row, base))
    }

    /// Terms of a sum with their signs (true: subtracted), a positive one first if there is one.
    fn terms(&self, id: NodeId, depth: u32) -> Vec<(NodeId, bool)> {
        let mut terms = Vec::new();
        let mut stack = vec![(id, depth, false)];
        while let Some((id, depth, subtracted)) = stack.pop() {
            let node = self.open(id, depth).filter(|_| !subtracted && terms.len() + stack.len() < GATHERED);
            match node {
                Some(node) if node.op == Op::Add => {
                    stack.push((Self::operand(node, 1), 1, false));
                    stack.push((Self::operand(node, 0), 1, false));
                }
                Some(node) if node.op == Op::Sub => {
                    stack.push((Self::operand(node, 1), 1, true));
                    stack.push((Self::operand(node, 0), 1, false));
                }
                Some(node) if self.mirrored(node).is_some() => {
                    let (a, b) = self.mirrored(node).expect("just seen");
                    terms.push((b, false));
                    terms.push((a, true));
                }
                _ => terms.push((id, subtracted)),
            }
        }
        for (id, subtracted) in &mut terms {
            *subtracted ^= self.level(*id, 1) >= PRODUCT && self.negative(*id, 1);
        }
        if let Some(first) = terms.iter().position(|(_, subtracted)| !subtracted) {
            terms[..=first].rotate_right(1);
        }
        terms
    }

    pub(super) fn expand_algebra(&self, id: NodeId, level: u8, unsigned: bool, depth: u32, out: &mut Vec<Task>) {
        if let Some(name) = self.name(id, depth) {
            return out.push(Task::owned(name.to_string()));
        }
        let own = self.level(id, depth);
        let negative = own >= PRODUCT && self.negative(id, depth);
        let signed = negative && !unsigned;
        let strength = if signed { own.min(PRODUCT) } else { own };
        let brackets = strength < level;
        if brackets {
            out.push(Task::text(if self.latex() { "\\left(" } else { "(" }));
        }
        if signed {
            out.push(Task::text("-"));
        }
        // A signless negation is its operand, which must then fit by itself.
        let inner_level = if brackets { 0 } else { level };
        self.body(id, inner_level, depth, out);
        if brackets {
            out.push(Task::text(if self.latex() { "\\right)" } else { ")" }));
        }
    }

    /// A node without its sign.
    fn body(&self, id: NodeId, level: u8, depth: u32, out: &mut Vec<Task>) {
        let node = self.graph.node(id);
        let sub = |id: NodeId, level: u8, unsigned: bool| Task::Node { id, level, unsigned, depth: depth + 1 };
        let (a, b) = (Self::operand(node, 0), Self::operand(node, 1));
        match node.op {
            Op::Const => out.push(Task::owned(self.number(self.constant(id)))),
            Op::Input => out.push(Task::owned(self.input_name(node.args[0] as usize))),
            Op::Add | Op::Sub => self.sum(id, depth, out),
            Op::Neg if self.mirrored(node).is_some() => self.sum(id, depth, out),
            Op::Neg => {
                let unsigned = self.level(a, 1) >= PRODUCT && self.negative(a, 1);
                out.push(sub(a, level.max(PRODUCT), unsigned));
            }
            Op::Mul => self.product(id, depth, out),
            Op::Div => {
                let unsigned = self.level(a, 1) >= PRODUCT && self.negative(a, 1);
                if self.latex() {
                    let parts = [Task::text("\\frac{"), sub(a, 0, unsigned), Task::text("}{"), sub(b, 0, false)];
                    out.extend(parts);
                    out.push(Task::text("}"));
                } else {
                    out.extend([sub(a, PRODUCT, unsigned), Task::text("/"), sub(b, PREFIX, false)]);
                }
            }
            Op::Powi | Op::Pow => self.power(node, depth, out),
            Op::Spline => {
                let table = self.graph.spline(node.args[1]);
                let name = names::styled(self.style, table.name());
                out.push(Task::owned(name + &"'".repeat(node.args[2] as usize)));
                self.arguments(&[a], depth, out);
            }
            Op::Field => self.field(node, depth, out),
            Op::Select => self.select(node, depth, out),
            Op::Sqrt if self.latex() => out.extend([Task::text("\\sqrt{"), sub(a, 0, false), Task::text("}")]),
            Op::Abs if self.latex() => out.extend([Task::text("\\left|"), sub(a, 0, false), Task::text("\\right|")]),
            op => {
                let row = op.info().expect("specials are above");
                out.push(Task::text(if self.latex() { row.latex } else { row.name }));
                let operands: Vec<NodeId> = node.operands().collect();
                if self.latex() && operands.len() == 1 {
                    self.bare_argument(a, depth, out)
                } else {
                    self.arguments(&operands, depth, out)
                }
            }
        }
    }

    fn sum(&self, id: NodeId, depth: u32, out: &mut Vec<Task>) {
        for (i, (term, subtracted)) in self.terms(id, depth).into_iter().enumerate() {
            out.push(Task::text(match (i, subtracted) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            }));
            let unsigned = self.level(term, 1) >= PRODUCT && self.negative(term, 1);
            out.push(Task::Node { id: term, level: PRODUCT, unsigned, depth: depth + 1 });
        }
    }

    fn product(&self, id: NodeId, depth: u32, out: &mut Vec<Task>) {
        for (i, factor) in self.factors(id, depth).into_iter().enumerate() {
            if i > 0 {
                let digits_meet = self.place(factor) == 0;
                out.push(Task::text(match (self.latex(), digits_meet) {
                    (true, true) => " \\cdot ",
                    (true, false) => "\\,",
                    (false, _) => "*",
                }));
            }
            let unsigned = self.negative_factor(factor);
            let level = if !unsigned && self.negative(factor, 1) { PREFIX } else { PRODUCT };
            out.push(Task::Node { id: factor, level, unsigned, depth: depth + 1 });
        }
    }

    fn power(&self, node: Node, depth: u32, out: &mut Vec<Task>) {
        let (a, b) = (Self::operand(node, 0), Self::operand(node, 1));
        if let Some((row, base)) = self.power_on_name(node) {
            out.push(Task::owned(format!("{}^{{{}}}", row.latex, node.exponent())));
            return self.bare_argument(Self::operand(base, 0), depth, out);
        }
        out.push(Task::Node { id: a, level: ATOM, unsigned: false, depth: depth + 1 });
        match (node.op, self.latex()) {
            (Op::Powi, true) => out.push(Task::owned(format!("^{{{}}}", node.exponent()))),
            (Op::Powi, false) if node.exponent() < 0 => out.push(Task::owned(format!("^({})", node.exponent()))),
            (Op::Powi, false) => out.push(Task::owned(format!("^{}", node.exponent()))),
            (_, true) => {
                let exponent = Task::Node { id: b, level: 0, unsigned: false, depth: depth + 1 };
                out.extend([Task::text("^{"), exponent, Task::text("}")]);
            }
            (_, false) => {
                out.extend([Task::text("^"), Task::Node { id: b, level: ATOM, unsigned: false, depth: depth + 1 }]);
            }
        }
    }

    /// An argument behind a function's name: a symbol bare, anything else in parentheses.
    fn bare_argument(&self, id: NodeId, depth: u32, out: &mut Vec<Task>) {
        let name = match self.open(id, 1) {
            None => self.name(id, 1).map(str::to_string),
            Some(node) if node.op == Op::Input => Some(self.input_name(node.args[0] as usize)),
            Some(_) => None,
        };
        match name {
            Some(name) if name.starts_with('\\') => out.push(Task::owned(name)),
            Some(name) => out.push(Task::owned(format!(" {name}"))),
            None => self.arguments(&[id], depth, out),
        }
    }

    fn arguments(&self, ids: &[NodeId], depth: u32, out: &mut Vec<Task>) {
        out.push(Task::text(if self.latex() { "\\left(" } else { "(" }));
        for (i, &id) in ids.iter().enumerate() {
            if i > 0 {
                out.push(Task::text(", "));
            }
            out.push(Task::Node { id, level: 0, unsigned: false, depth: depth + 1 });
        }
        out.push(Task::text(if self.latex() { "\\right)" } else { ")" }));
    }

    /// `f(x, y, z)`; its derivatives `f'xy(x, y, z)`, in LaTeX `∂_{xy} f(x, y, z)`.
    fn field(&self, node: Node, depth: u32, out: &mut Vec<Task>) {
        let field = self.graph.field(node.field);
        let name = names::styled(self.style, field.name());
        let along: String = match field_exponents(usize::from(node.part)) {
            Some(times) => ["x", "y", "z"].into_iter().zip(times).map(|(axis, n)| axis.repeat(n)).collect(),
            None => "?".into(),
        };
        out.push(Task::owned(match along.as_str() {
            "" => name,
            along if self.latex() => format!(r"\partial_{{{along}}}\,{name}"),
            along => format!("{name}'{along}"),
        }));
        let variables: Vec<NodeId> = node.operands().take(field.variables()).collect();
        self.arguments(&variables, depth, out);
    }

    fn select(&self, node: Node, depth: u32, out: &mut Vec<Task>) {
        let sub = |k: usize| Task::Node { id: Self::operand(node, k), level: 0, unsigned: false, depth: depth + 1 };
        if !self.latex() {
            return out.extend([
                Task::text("if("),
                sub(0),
                Task::text(" >= 0, "),
                sub(1),
                Task::text(", "),
                sub(2),
                Task::text(")"),
            ]);
        }
        out.extend([Task::text("\\begin{cases} "), sub(1), Task::text(" & \\text{if } ")]);
        match self.open(Self::operand(node, 0), 1) {
            Some(cond) if cond.op == Op::Sub => {
                let side =
                    |k: usize| Task::Node { id: Self::operand(cond, k), level: 0, unsigned: false, depth: depth + 2 };
                out.extend([side(0), Task::text(" \\ge "), side(1)]);
            }
            _ => out.extend([sub(0), Task::text(" \\ge 0")]),
        }
        out.extend([Task::text(" \\\\ "), sub(2), Task::text(" & \\text{otherwise} \\end{cases}")]);
    }
}
