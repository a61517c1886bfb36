//! The operators, one row each: value, partial derivatives, names in text, LaTeX and C, and sample arguments.
//!
//! Nothing else in the workspace lists operators one by one: evaluation over any [`Scalar`], derivatives of the graph,
//! dual numbers, printing, the parser's function names and the tests all read this table.

use crate::scalar::Scalar;

/// How an operator is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A constant, an input, a power, a spline or a field: the printers know it.
    Special,
    /// Between its operands, with the given strength (higher binds tighter).
    Infix(u8),
    /// A function of its operands.
    Call,
}

/// What the program knows about one operator.
#[derive(Clone, Copy, Debug)]
pub struct OpInfo {
    /// The operator.
    pub op: Op,
    /// Its name in text and in scene files.
    pub name: &'static str,
    /// How many operands are expressions.
    pub arity: usize,
    /// How it is written.
    pub form: Form,
    /// Its LaTeX name or symbol.
    pub latex: &'static str,
    /// Its name or symbol in C.
    pub c: &'static str,
    /// True where swapping the two operands changes nothing.
    pub commutes: bool,
    /// Arguments at which tests compare value and derivatives.
    pub samples: &'static [[f64; 3]],
}

macro_rules! operators {
    ($( $Op:ident { $name:literal, $arity:literal, $form:expr, latex $latex:literal, c $c:literal, commutes $commutes:literal,
        value |$a:pat_param, $b:pat_param, $e:pat_param| $value:expr,
        partials |$pa:pat_param, $pb:pat_param, $pe:pat_param, $py:pat_param| $partials:expr,
        samples $samples:expr } )*) => {
        /// An operator of the expression graph.
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        #[repr(u8)]
        pub enum Op {
            /// A number.
            Const,
            /// A variable, given from outside.
            Input,
            /// `xⁿ`, integer `n`.
            Powi,
            /// A derivative of a C² spline.
            Spline,
            /// A part of a field at a point.
            Field,
            $(#[doc = concat!("`", $name, "`.")] $Op,)*
        }

        /// One row an operator, those with immediate arguments left out.
        pub const OPS: &[OpInfo] = &[
            $(OpInfo { op: Op::$Op, name: $name, arity: $arity, form: $form, latex: $latex, c: $c,
                commutes: $commutes, samples: $samples }),*
        ];

        /// Value of the operator; operands beyond its arity are ignored.
        #[inline]
        pub fn apply<S: Scalar>(op: Op, a: S, b: S, c: S) -> S {
            match op {
                Op::Const | Op::Input | Op::Powi | Op::Spline | Op::Field => unreachable!("has immediate arguments"),
                $(Op::$Op => { let ($a, $b, $e) = (a, b, c); $value })*
            }
        }

        /// Partial derivatives of `y = op(a, b, c)` with respect to its operands; `None` is zero.
        pub fn partials<S: Scalar>(op: Op, a: S, b: S, c: S, y: S) -> [Option<S>; 3] {
            match op {
                Op::Const | Op::Input | Op::Powi | Op::Spline | Op::Field => unreachable!("has immediate arguments"),
                $(Op::$Op => { let ($pa, $pb, $pe, $py) = (a, b, c, y); $partials })*
            }
        }
    };
}

fn one<S: Scalar>() -> Option<S> {
    Some(S::constant(1.0))
}
fn num<S: Scalar>(x: f64) -> S {
    S::constant(x)
}

const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const PREFIX: u8 = 3;

operators! {
    Add { "+", 2, Form::Infix(SUM), latex "+", c "+", commutes true,
        value |a, b, _| a + b, partials |_, _, _, _| [one(), one(), None],
        samples &[[1.5, -0.25, 0.0]] }
    Sub { "-", 2, Form::Infix(SUM), latex "-", c "-", commutes false,
        value |a, b, _| a - b, partials |_, _, _, _| [one(), Some(num(-1.0)), None],
        samples &[[1.5, -0.25, 0.0]] }
    Mul { "*", 2, Form::Infix(PRODUCT), latex "\\,", c "*", commutes true,
        value |a, b, _| a * b, partials |a, b, _, _| [Some(b), Some(a), None],
        samples &[[1.5, -0.25, 0.0]] }
    Div { "/", 2, Form::Infix(PRODUCT), latex "/", c "/", commutes false,
        value |a, b, _| a / b, partials |_, b, _, y| [Some(num::<S>(1.0) / b), Some(-(y / b)), None],
        samples &[[1.5, -0.25, 0.0]] }
    Neg { "neg", 1, Form::Infix(PREFIX), latex "-", c "-", commutes false,
        value |a, _, _| -a, partials |_, _, _, _| [Some(num(-1.0)), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Pow { "pow", 2, Form::Special, latex "", c "pow", commutes false,
        value |a, b, _| a.pow(b), partials |a, b, _, y| [Some(b * a.pow(b - num(1.0))), Some(y * a.ln()), None],
        samples &[[1.7, 0.3, 0.0], [0.4, -2.5, 0.0]] }
    Sqrt { "sqrt", 1, Form::Call, latex "\\sqrt", c "sqrt", commutes false,
        value |a, _, _| a.sqrt(), partials |_, _, _, y| [Some(num::<S>(0.5) / y), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Exp { "exp", 1, Form::Call, latex "\\exp", c "exp", commutes false,
        value |a, _, _| a.exp(), partials |_, _, _, y| [Some(y), None, None],
        samples &[[-0.7, 0.0, 0.0]] }
    Ln { "log", 1, Form::Call, latex "\\ln", c "log", commutes false,
        value |a, _, _| a.ln(), partials |a, _, _, _| [Some(num::<S>(1.0) / a), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Sin { "sin", 1, Form::Call, latex "\\sin", c "sin", commutes false,
        value |a, _, _| a.sin(), partials |a, _, _, _| [Some(a.cos()), None, None],
        samples &[[0.7, 0.0, 0.0], [-2.5, 0.0, 0.0]] }
    Cos { "cos", 1, Form::Call, latex "\\cos", c "cos", commutes false,
        value |a, _, _| a.cos(), partials |a, _, _, _| [Some(-a.sin()), None, None],
        samples &[[0.7, 0.0, 0.0], [-2.5, 0.0, 0.0]] }
    Tan { "tan", 1, Form::Call, latex "\\tan", c "tan", commutes false,
        value |a, _, _| a.tan(), partials |_, _, _, y| [Some(num::<S>(1.0) + y * y), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Asin { "asin", 1, Form::Call, latex "\\arcsin", c "asin", commutes false,
        value |a, _, _| a.asin(), partials |a, _, _, _| [Some(num::<S>(1.0) / (num::<S>(1.0) - a * a).sqrt()), None, None],
        samples &[[0.3, 0.0, 0.0]] }
    Acos { "acos", 1, Form::Call, latex "\\arccos", c "acos", commutes false,
        value |a, _, _| a.acos(), partials |a, _, _, _| [Some(num::<S>(-1.0) / (num::<S>(1.0) - a * a).sqrt()), None, None],
        samples &[[0.3, 0.0, 0.0]] }
    Atan { "atan", 1, Form::Call, latex "\\arctan", c "atan", commutes false,
        value |a, _, _| a.atan(), partials |a, _, _, _| [Some(num::<S>(1.0) / (num::<S>(1.0) + a * a)), None, None],
        samples &[[1.3, 0.0, 0.0]] }
    Atan2 { "atan2", 2, Form::Call, latex "\\operatorname{atan2}", c "atan2", commutes false,
        value |a, b, _| a.atan2(b), partials |a, b, _, _| { let n = a * a + b * b; [Some(b / n), Some(-(a / n)), None] },
        samples &[[1.3, -0.4, 0.0], [-0.2, 0.9, 0.0]] }
    Sinh { "sinh", 1, Form::Call, latex "\\sinh", c "sinh", commutes false,
        value |a, _, _| a.sinh(), partials |a, _, _, _| [Some(a.cosh()), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Cosh { "cosh", 1, Form::Call, latex "\\cosh", c "cosh", commutes false,
        value |a, _, _| a.cosh(), partials |a, _, _, _| [Some(a.sinh()), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Tanh { "tanh", 1, Form::Call, latex "\\tanh", c "tanh", commutes false,
        value |a, _, _| a.tanh(), partials |_, _, _, y| [Some(num::<S>(1.0) - y * y), None, None],
        samples &[[0.7, 0.0, 0.0]] }
    Abs { "abs", 1, Form::Call, latex "\\operatorname{abs}", c "fabs", commutes false,
        value |a, _, _| a.abs(), partials |a, _, _, _| [Some(a.sign()), None, None],
        samples &[[0.7, 0.0, 0.0], [-0.7, 0.0, 0.0]] }
    Sign { "sign", 1, Form::Call, latex "\\operatorname{sign}", c "headland_sign", commutes false,
        value |a, _, _| a.sign(), partials |_, _, _, _| [None, None, None],
        samples &[[0.7, 0.0, 0.0], [-0.7, 0.0, 0.0]] }
    Min { "min", 2, Form::Call, latex "\\min", c "headland_min", commutes true,
        value |a, b, _| a.min(b),
        partials |a, b, _, _| [Some(S::select(b - a, num(1.0), num(0.0))), Some(S::select(b - a, num(0.0), num(1.0))), None],
        samples &[[0.7, 0.2, 0.0], [-0.7, 0.1, 0.0]] }
    Max { "max", 2, Form::Call, latex "\\max", c "headland_max", commutes true,
        value |a, b, _| a.max(b),
        partials |a, b, _, _| [Some(S::select(a - b, num(1.0), num(0.0))), Some(S::select(a - b, num(0.0), num(1.0))), None],
        samples &[[0.7, 0.2, 0.0], [-0.7, 0.1, 0.0]] }
    Select { "select", 3, Form::Call, latex "\\operatorname{select}", c "headland_select", commutes false,
        value |a, b, c| S::select(a, b, c),
        partials |a, _, _, _| [None, Some(S::select(a, num(1.0), num(0.0))), Some(S::select(a, num(0.0), num(1.0)))],
        samples &[[0.7, 0.2, 0.9], [-0.7, 0.1, 0.4]] }
}

impl Op {
    /// The operator's row; `None` for a constant, an input, an integer power, a spline and a field.
    pub fn info(self) -> Option<&'static OpInfo> {
        OPS.get((self as usize).checked_sub(Op::Add as usize)?)
    }

    /// How many operands are expressions.
    pub fn arity(self) -> usize {
        match self {
            Op::Const | Op::Input => 0,
            Op::Powi | Op::Spline => 1,
            Op::Field => 3,
            _ => self.info().map_or(0, |row| row.arity),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Central differences of the value, the independent check of every row's partials.
    #[test]
    fn partials_agree_with_differences() {
        for row in OPS {
            for x in row.samples {
                let value = |x: [f64; 3]| apply(row.op, x[0], x[1], x[2]);
                let exact = partials(row.op, x[0], x[1], x[2], value(*x));
                for i in 0..row.arity {
                    let h = 1e-6;
                    let (mut hi, mut lo) = (*x, *x);
                    hi[i] += h;
                    lo[i] -= h;
                    let difference = (value(hi) - value(lo)) / (2.0 * h);
                    assert_relative_eq!(exact[i].unwrap_or(0.0), difference, epsilon = 1e-8, max_relative = 1e-8);
                }
            }
        }
    }

    #[test]
    fn rows_stand_in_the_order_of_the_enum() {
        for row in OPS {
            assert_eq!(row.op.info().map(|r| r.name), Some(row.name));
            assert!(!row.samples.is_empty(), "{} has no samples", row.name);
        }
    }
}
