//! Functions of scene expressions: operators by name, `if`, smooth steps, tables.

use crate::dimension::{Dimension, Ratio};
use crate::lower::{Lowering, Reported, Typed};
use crate::place::Place;
use crate::symbols::{Formula, Symbol};
use headland_expr::parse::suggestion;
use headland_expr::{Expr, Field, Op, Scalar};
use std::sync::Arc;

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

impl<'g> Lowering<'g> {
    pub(crate) fn call(
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
            self.demand(&args[0].0, &x, args[0].0.angle, formula, &format!("the argument of the table `{function}`"))?;
            return Ok(Typed { expr: args[0].0.expr.spline(&spline, 0), dimension: y, angle: false, condition: false });
        }
        if let Some(Symbol::Field(field, dimensions)) = self.symbols.by_name.get(function) {
            let field: Arc<dyn Field> = field.clone();
            let [x, y, z] = dimensions.clone();
            let [(at_x, _), (at_y, _)] = &args[..] else {
                return Err(self.report(place, format!("the table `{function}` takes 2 arguments, found {n}")));
            };
            self.no_conditions(&args, formula)?;
            self.demand(at_x, &x, at_x.angle, formula, &format!("the first argument of the table `{function}`"))?;
            self.demand(at_y, &y, at_y.angle, formula, &format!("the second argument of the table `{function}`"))?;
            let expr = Expr::field([at_x.expr, at_y.expr, Expr::Const(0.0)], &field, 0);
            return Ok(Typed { expr, dimension: z, angle: false, condition: false });
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
                let tables = self
                    .symbols
                    .by_name
                    .iter()
                    .filter(|(_, s)| matches!(s, Symbol::Table(..) | Symbol::Field(..)))
                    .map(|(n, _)| &**n);
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

    pub(crate) fn conditional(
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
}

/// A condition that holds where the other does not.
pub(crate) fn not<'g>(condition: Expr<'g>) -> Expr<'g> {
    Expr::select(condition, Expr::Const(-1.0), Expr::Const(1.0))
}

/// 0 below `x0`, 1 above `x1`, `6 s⁵ − 15 s⁴ + 10 s³` between: C².
fn smoothstep<'g>(x: Expr<'g>, x0: Expr<'g>, x1: Expr<'g>) -> Expr<'g> {
    let c = Expr::Const;
    let s = ((x - x0) / (x1 - x0)).max(c(0.0)).min(c(1.0));
    s.powi(3) * (c(10.0) + s * (c(6.0) * s - c(15.0)))
}
