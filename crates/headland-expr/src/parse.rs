//! The parser of scene expressions: text to a flat program in postfix order, with the place of every item.
//!
//! ```text
//! or         = and { "or" and }              and     = not { "and" not }          not = "not" not | comparison
//! comparison = sum [ ("<" | "<=" | ">" | ">=") sum ]
//! sum        = product { ("+" | "-") product }       product = unary { ("*" | "/") unary }
//! unary      = ("-" | "+") unary | power             power   = atom [ "^" unary ]
//! atom       = number [ "[" unit "]" ] | name [ "[" or "]" ] { "'" } | name "(" or { "," or } ")" | "(" or ")"
//! ```
//! `^` binds tighter than unary minus and to the right: `-x^2 = -(x^2)`, `2^3^2 = 2^9`. A flat program needs no
//! recursion to be read; nesting of parentheses is bounded by [`DEPTH`].

use std::ops::Range;

use crate::ops::Op;

/// Deepest nesting of parentheses, signs and powers that is accepted.
pub const DEPTH: usize = 200;

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
}

/// One step of a program in postfix order.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Pushes a number; its unit is written in square brackets: `3[s]`.
    Number(f64, Option<String>),
    /// Pushes what a name stands for: `theta[k]'` has an index and one prime.
    Name {
        /// The name without index and primes; `body[2].x` has the name `body.x`.
        name: String,
        /// Its index, an integer expression.
        index: Option<Program>,
        /// How often it is differentiated in time.
        primes: u8,
    },
    /// Replaces the last one or two by the result of an operator.
    Operator(Op),
    /// Replaces the last two by the result of a comparison.
    Compare(Comparison),
    /// Replaces two conditions by their conjunction.
    And,
    /// Replaces two conditions by their disjunction.
    Or,
    /// Negates a condition.
    Not,
    /// Replaces the last `args` by the result of a function.
    Call {
        /// Name of the function.
        function: String,
        /// Number of arguments.
        args: usize,
    },
    /// Pushes `Σ_k body`, over all members of the index `k`: `sum(k, m[k])`.
    Sum {
        /// The index.
        index: String,
        /// What is summed.
        body: Program,
    },
}

/// An expression in postfix order.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Program {
    /// The steps.
    pub items: Vec<Item>,
    /// The place of each step: bytes of the text.
    pub spans: Vec<Range<usize>>,
}

impl Program {
    /// The program that pushes one number.
    pub fn number(x: f64) -> Self {
        Self { items: vec![Item::Number(x, None)], spans: std::iter::once(0..0).collect() }
    }

    fn push(&mut self, item: Item, span: Range<usize>) {
        self.items.push(item);
        self.spans.push(span);
    }
}

/// What is wrong with an expression, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct ParseError {
    /// What is wrong and what would be right.
    pub message: String,
    /// Bytes of the text.
    pub span: Range<usize>,
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    /// `.x` behind a name or its index
    Member(String),
    Symbol(&'static str),
    End,
}

const SYMBOLS: &[&str] = &["<=", ">=", "+", "-", "*", "/", "^", "(", ")", "[", "]", ",", "'", "<", ">"];

/// Reads an expression.
///
/// # Errors
/// The first thing that cannot be read, with its place.
pub fn parse(text: &str) -> Result<Program, ParseError> {
    let mut parser = Parser { text, at: 0, token: Token::End, span: 0..0, previous_end: 0, depth: 0 };
    parser.advance()?;
    if parser.token == Token::End {
        return Err(ParseError { message: "empty expression".into(), span: 0..text.len() });
    }
    let mut program = Program::default();
    parser.or(&mut program)?;
    match parser.token {
        Token::End => Ok(program),
        _ => Err(parser.unexpected("an operator or the end")),
    }
}

struct Parser<'t> {
    text: &'t str,
    /// Where the next token is looked for.
    at: usize,
    token: Token,
    span: Range<usize>,
    previous_end: usize,
    depth: usize,
}

impl Parser<'_> {
    fn error<T>(&self, message: impl Into<String>, span: Range<usize>) -> Result<T, ParseError> {
        Err(ParseError { message: message.into(), span })
    }

    fn unexpected(&self, expected: &str) -> ParseError {
        let found = match &self.token {
            Token::End => "the end of the expression".to_string(),
            _ => format!("`{}`", &self.text[self.span.clone()]),
        };
        ParseError { message: format!("found {found} where {expected} was expected"), span: self.span.clone() }
    }

    /// Reads the next token.
    fn advance(&mut self) -> Result<(), ParseError> {
        self.previous_end = self.span.end;
        let rest = &self.text[self.at..];
        let trimmed = rest.trim_start();
        let start = self.at + (rest.len() - trimmed.len());
        let Some(first) = trimmed.chars().next() else {
            self.token = Token::End;
            self.span = self.text.len()..self.text.len();
            self.at = self.text.len();
            return Ok(());
        };
        let length;
        let letter = |c: char| c.is_alphabetic() || c == '_';
        let word = |text: &str| text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
        if first == '.' && trimmed[1..].starts_with(letter) {
            length = 1 + word(&trimmed[1..]);
            self.token = Token::Member(trimmed[1..length].to_string());
        } else if first.is_ascii_digit() || first == '.' {
            length = number_length(trimmed);
            let digits = &trimmed[..length];
            match digits.parse::<f64>() {
                Ok(x) if x.is_finite() => self.token = Token::Number(x),
                Ok(_) => return self.error(format!("`{digits}` is too large for a number"), start..start + length),
                Err(_) => return self.error(format!("`{digits}` is not a number"), start..start + length.max(1)),
            }
        } else if letter(first) {
            length = word(trimmed);
            self.token = Token::Name(trimmed[..length].to_string());
        } else if let Some(symbol) = SYMBOLS.iter().find(|s| trimmed.starts_with(**s)) {
            length = symbol.len();
            self.token = Token::Symbol(symbol);
        } else {
            length = first.len_utf8();
            let hint = match first {
                '=' => "; comparisons are <, <=, > and >=",
                '&' | '|' | '!' => "; write `and`, `or`, `not`",
                _ => "",
            };
            return self.error(format!("`{first}` has no meaning in an expression{hint}"), start..start + length);
        }
        self.span = start..start + length;
        self.at = start + length;
        Ok(())
    }

    fn is(&self, symbol: &str) -> bool {
        matches!(&self.token, Token::Symbol(s) if *s == symbol)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(&self.token, Token::Name(s) if s == word)
    }

    fn expect(&mut self, symbol: &'static str) -> Result<(), ParseError> {
        if self.is(symbol) { self.advance() } else { Err(self.unexpected(&format!("`{symbol}`"))) }
    }

    fn or(&mut self, out: &mut Program) -> Result<(), ParseError> {
        self.depth += 1;
        if self.depth > DEPTH {
            return self.error(format!("nested deeper than {DEPTH} levels"), self.span.clone());
        }
        let start = self.span.start;
        self.and(out)?;
        while self.is_word("or") {
            self.advance()?;
            self.and(out)?;
            out.push(Item::Or, start..self.previous_end);
        }
        self.depth -= 1;
        Ok(())
    }

    fn and(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        self.not(out)?;
        while self.is_word("and") {
            self.advance()?;
            self.not(out)?;
            out.push(Item::And, start..self.previous_end);
        }
        Ok(())
    }

    fn not(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        let mut count = 0;
        while self.is_word("not") {
            self.advance()?;
            count += 1;
        }
        self.comparison(out)?;
        for _ in 0..count {
            out.push(Item::Not, start..self.previous_end);
        }
        Ok(())
    }

    fn comparison(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        self.sum(out)?;
        let comparison = match self.token {
            Token::Symbol("<") => Comparison::Less,
            Token::Symbol("<=") => Comparison::LessEqual,
            Token::Symbol(">") => Comparison::Greater,
            Token::Symbol(">=") => Comparison::GreaterEqual,
            _ => return Ok(()),
        };
        self.advance()?;
        self.sum(out)?;
        out.push(Item::Compare(comparison), start..self.previous_end);
        Ok(())
    }

    fn sum(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        self.product(out)?;
        loop {
            let op = match self.token {
                Token::Symbol("+") => Op::Add,
                Token::Symbol("-") => Op::Sub,
                _ => return Ok(()),
            };
            self.advance()?;
            self.product(out)?;
            out.push(Item::Operator(op), start..self.previous_end);
        }
    }

    fn product(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        self.unary(out)?;
        loop {
            let op = match self.token {
                Token::Symbol("*") => Op::Mul,
                Token::Symbol("/") => Op::Div,
                _ => return Ok(()),
            };
            self.advance()?;
            if op == Op::Mul && self.is("*") {
                return self.error("a power is written `^`", self.span.clone());
            }
            self.unary(out)?;
            out.push(Item::Operator(op), start..self.previous_end);
        }
    }

    fn unary(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        let mut negative = false;
        while self.is("-") || self.is("+") {
            negative ^= self.is("-");
            self.advance()?;
        }
        self.power(out)?;
        if negative {
            out.push(Item::Operator(Op::Neg), start..self.previous_end);
        }
        Ok(())
    }

    fn power(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        self.atom(out)?;
        if self.is("^") {
            self.advance()?;
            self.depth += 1;
            if self.depth > DEPTH {
                return self.error(format!("nested deeper than {DEPTH} levels"), self.span.clone());
            }
            self.unary(out)?;
            self.depth -= 1;
            out.push(Item::Operator(Op::Pow), start..self.previous_end);
        }
        Ok(())
    }

    fn atom(&mut self, out: &mut Program) -> Result<(), ParseError> {
        let start = self.span.start;
        match std::mem::replace(&mut self.token, Token::End) {
            Token::Number(x) => {
                self.advance()?;
                let unit = if self.is("[") { Some(self.unit()?) } else { None };
                if let Token::Name(name) = &self.token
                    && !["and", "or"].contains(&name.as_str())
                {
                    let message = format!(
                        "an operator is missing before `{name}`; a number's unit stands in square brackets: `{x}[{name}]`"
                    );
                    return self.error(message, self.span.clone());
                }
                out.push(Item::Number(x, unit), start..self.previous_end);
                Ok(())
            }
            Token::Name(name) => {
                self.advance()?;
                if self.is("(") { self.call(name, start, out) } else { self.name(name, start, out) }
            }
            Token::Symbol("(") => {
                self.advance()?;
                self.or(out)?;
                self.expect(")")
            }
            token => {
                self.token = token;
                Err(self.unexpected("a number, a name or `(`"))
            }
        }
    }

    /// The text between `[` and `]` behind a number.
    fn unit(&mut self) -> Result<String, ParseError> {
        let open = self.span.start;
        let Some(length) = self.text[open..].find(']') else {
            return self.error("`[` without `]`", open..self.text.len());
        };
        let unit = self.text[open + 1..open + length].trim().to_string();
        self.at = open + length + 1;
        self.span = open..self.at;
        self.advance()?;
        Ok(unit)
    }

    fn name(&mut self, mut name: String, start: usize, out: &mut Program) -> Result<(), ParseError> {
        let index = if self.is("[") {
            self.advance()?;
            let mut index = Program::default();
            self.or(&mut index)?;
            self.expect("]")?;
            Some(index)
        } else {
            None
        };
        while let Token::Member(member) = &self.token {
            name.push('.');
            name.push_str(member);
            self.advance()?;
        }
        let mut primes = 0;
        while self.is("'") {
            primes += 1;
            if primes > 2 {
                return self.error("at most two primes are understood", start..self.span.end);
            }
            self.advance()?;
        }
        out.push(Item::Name { name, index, primes }, start..self.previous_end);
        Ok(())
    }

    fn call(&mut self, function: String, start: usize, out: &mut Program) -> Result<(), ParseError> {
        self.advance()?;
        if function == "sum" {
            let Token::Name(index) = self.token.clone() else {
                return Err(self.unexpected("the name of an index, as in `sum(k, m[k])`,"));
            };
            self.advance()?;
            self.expect(",")?;
            let mut body = Program::default();
            self.or(&mut body)?;
            self.expect(")")?;
            out.push(Item::Sum { index, body }, start..self.previous_end);
            return Ok(());
        }
        let mut args = 0;
        if !self.is(")") {
            loop {
                self.or(out)?;
                args += 1;
                if !self.is(",") {
                    break;
                }
                self.advance()?;
            }
        }
        self.expect(")")?;
        out.push(Item::Call { function, args }, start..self.previous_end);
        Ok(())
    }
}

/// Length of the number at the start of `text`.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut i: usize| {
        while i < bytes.len() && bytes[i].is_ascii_digit() {
            i += 1;
        }
        i
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

/// The candidate nearest to a misspelt name, if one is near; ready to be put behind a message.
pub fn suggestion<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let best = candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&name.to_lowercase(), &c.to_lowercase()), c))
        .filter(|(distance, c)| {
            let length = name.chars().count().max(c.chars().count());
            *distance <= (length / 3).max(usize::from(length > 1))
        })
        .min();
    match best {
        Some((_, c)) => format!("; did you mean `{c}`?"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plain evaluation of a program, to check precedence against numbers.
    fn value(text: &str) -> f64 {
        let mut stack: Vec<f64> = Vec::new();
        for item in parse(text).unwrap().items {
            match item {
                Item::Number(x, _) => stack.push(x),
                Item::Operator(Op::Neg) => {
                    let a = stack.pop().unwrap();
                    stack.push(-a);
                }
                Item::Operator(op) => {
                    let (b, a) = (stack.pop().unwrap(), stack.pop().unwrap());
                    stack.push(crate::ops::apply(op, a, b, 0.0));
                }
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(stack.len(), 1);
        stack[0]
    }

    #[test]
    fn precedence() {
        assert_eq!(value("1 + 2*3 - 4/8"), 6.5);
        assert_eq!(value("-2^2"), -4.0);
        assert_eq!(value("2^3^2"), 512.0);
        assert_eq!(value("2^-1"), 0.5);
        assert_eq!(value("2*-3"), -6.0);
        assert_eq!(value("8/4/2"), 1.0);
        assert_eq!(value("1 - 2 - 3"), -4.0);
        assert_eq!(value("--+-2"), -2.0);
        assert_eq!(value("1.5e-3 + .5E1 + 2."), 7.0015);
        assert_eq!(value("(1 + 2)*(3)"), 9.0);
    }

    #[test]
    fn names_have_indices_and_primes() {
        let program = parse("theta[k+1]' + 3[m/s^2]").unwrap();
        assert_eq!(program.items.len(), 3);
        assert!(matches!(&program.items[0], Item::Name { name, index: Some(_), primes: 1 } if name == "theta"));
        assert_eq!(program.items[1], Item::Number(3.0, Some("m/s^2".into())));
        assert_eq!(&program.spans[0], &(0..11));
    }

    #[test]
    fn messages_say_what_and_where() {
        let wrong = |text: &str| parse(text).unwrap_err();
        assert_eq!(wrong("1 +").message, "found the end of the expression where a number, a name or `(` was expected");
        assert_eq!(wrong("(1").span, 2..2);
        assert!(wrong("3 s").message.contains("`3[s]`"));
        assert!(wrong("a == b").message.contains('='));
        assert!(wrong("2**3").message.contains('^'));
        assert!(wrong("a & b").message.contains("and"));
        assert!(wrong("").message.contains("empty"));
        assert!(wrong("1e999").message.contains("too large"));
        assert!(wrong(&"(".repeat(100_000)).message.contains("nested deeper"));
        assert!(wrong(&format!("1{}", "^1".repeat(100_000))).message.contains("nested deeper"));
    }

    #[test]
    fn long_sums_are_not_deep() {
        let text = vec!["1"; 100_000].join("+");
        assert_eq!(value(&text), 100_000.0);
        assert_eq!(value(&format!("{}1", "-".repeat(100_001))), -1.0);
    }

    #[test]
    fn suggestions() {
        assert_eq!(suggestion("thta", ["theta", "psi"]), "; did you mean `theta`?");
        assert_eq!(suggestion("completely", ["theta", "psi"]), "");
    }
}
