//! Names as scenes write them (`theta[1]'`, `v_C[2]`, `x_A1`) in LaTeX and as identifiers of C.

use rustc_hash::FxHashSet;

use super::Style;
use crate::ops::OPS;

/// Greek letters with a LaTeX command.
const GREEK: &[&str] = &[
    "alpha",
    "beta",
    "gamma",
    "delta",
    "epsilon",
    "zeta",
    "eta",
    "theta",
    "iota",
    "kappa",
    "lambda",
    "mu",
    "nu",
    "xi",
    "pi",
    "rho",
    "sigma",
    "tau",
    "upsilon",
    "phi",
    "chi",
    "psi",
    "omega",
    "varphi",
    "varepsilon",
    "vartheta",
    "Gamma",
    "Delta",
    "Theta",
    "Lambda",
    "Xi",
    "Pi",
    "Sigma",
    "Upsilon",
    "Phi",
    "Psi",
    "Omega",
];

/// Words that cannot name a variable of a generated function.
const RESERVED: &[&str] = &[
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern", "float",
    "for", "goto", "if", "inline", "int", "long", "register", "restrict", "return", "short", "signed", "sizeof",
    "static", "struct", "switch", "typedef", "union", "unsigned", "void", "volatile", "while", "x", "y", "NAN",
    "INFINITY", "HUGE_VAL", "asm", "main",
];

/// A name taken apart: `base _ subscript [index] '`.
struct Parts<'a> {
    base: &'a str,
    subscripts: Vec<&'a str>,
    primes: usize,
}

fn parts(name: &str) -> Parts<'_> {
    let primes = name.chars().rev().take_while(|&c| c == '\'').count();
    let name = &name[..name.len() - primes];
    let mut pieces = name.split(['_', '[', ']', '.', ',', ' ']).filter(|s| !s.is_empty());
    let base = pieces.next().unwrap_or("");
    Parts { base, subscripts: pieces.collect(), primes }
}

/// `psi1` is `psi` with subscript `1`.
fn split_digits(s: &str) -> (&str, &str) {
    let letters = s.trim_end_matches(|c: char| c.is_ascii_digit());
    if letters.is_empty() { (s, "") } else { (letters, &s[letters.len()..]) }
}

fn escape(s: &str) -> String {
    let mut text = String::new();
    for c in s.chars() {
        match c {
            '%' | '&' | '#' | '$' | '{' | '}' | '_' => text.extend(['\\', c]),
            '~' | '^' | '\\' => text.push_str("\\ "),
            '\'' => text.push_str("\\prime "),
            _ => text.push(c),
        }
    }
    text
}

/// Letters of a subscript: Greek, short as it stands, or a word.
fn subscript(s: &str) -> String {
    let (letters, digits) = split_digits(s);
    if GREEK.contains(&letters) {
        let space = if digits.is_empty() { "" } else { " " };
        return format!("\\{letters}{space}{digits}");
    }
    match letters.chars().count() {
        0..=2 => escape(s),
        _ => format!("\\mathrm{{{}}}", escape(s)),
    }
}

/// A name in LaTeX: `theta[1]'` gives `\dot{\theta}_{1}`, `v_C[2]` gives `v_{C,2}`, `speed` gives `\mathit{speed}`.
pub fn latex_name(name: &str) -> String {
    let Parts { base, subscripts, primes } = parts(name);
    let (letters, digits) = split_digits(base);
    let symbol = if GREEK.contains(&letters) {
        format!("\\{letters}")
    } else if letters.chars().count() == 1 {
        escape(letters)
    } else {
        format!("\\mathit{{{}}}", escape(letters))
    };
    let symbol = match primes {
        0 => symbol,
        1 => format!("\\dot{{{symbol}}}"),
        2 => format!("\\ddot{{{symbol}}}"),
        3 => format!("\\dddot{{{symbol}}}"),
        n => format!("{{{symbol}^{{({n})}}}}"),
    };
    let mut below: Vec<String> = subscripts.into_iter().map(subscript).collect();
    if !digits.is_empty() {
        below.insert(0, digits.into());
    }
    if below.is_empty() { symbol } else { format!("{symbol}_{{{}}}", below.join(",")) }
}

/// A name as an identifier of C: `theta[1]'` gives `theta_1_dot`, a reserved word a trailing underscore.
///
/// Different names may give the same identifier; a listing numbers the later one.
pub fn c_name(name: &str) -> String {
    let stem = name.trim_end_matches('\'');
    let mut text = String::new();
    for c in stem.chars() {
        let c = if c.is_ascii_alphanumeric() { c } else { '_' };
        if !(c == '_' && text.ends_with('_')) {
            text.push(c);
        }
    }
    let mut text = text.trim_matches('_').to_string();
    match name.len() - stem.len() {
        0 => {}
        1 => text.push_str("_dot"),
        n => text.extend(["_", &"d".repeat(n), "ot"]),
    }
    if text.is_empty() || text.starts_with(|c: char| c.is_ascii_digit()) {
        text.insert_str(0, "n_");
    }
    let is_function = OPS.iter().any(|row| row.c == text) || text.starts_with("headland_");
    if is_function || RESERVED.contains(&text.as_str()) {
        text.push('_');
    }
    text
}

/// A name in the given style; C identifiers not yet made unique.
pub(super) fn styled(style: Style, name: &str) -> String {
    match style {
        Style::Text => name.to_string(),
        Style::Latex => latex_name(name),
        Style::C => c_name(name),
    }
}

/// Gives each name once; in C, a number tells equal ones apart.
#[derive(Default)]
pub(super) struct Names {
    taken: FxHashSet<String>,
}

impl Names {
    pub(super) fn take(&mut self, style: Style, name: &str) -> String {
        let wanted = styled(style, name);
        let mut unique = wanted.clone();
        let mut n = 1;
        while !self.taken.insert(unique.clone()) && style == Style::C {
            n += 1;
            unique = format!("{wanted}_{n}");
        }
        unique
    }

    /// Names `p_1, p_2, …` (C: `w1, w2, …`) for temporaries, of a letter with which no name taken so far begins.
    pub(super) fn temporaries(&self, style: Style) -> impl Fn(usize) -> String + use<> {
        let letters: &[&str] = if style == Style::C { &["w", "h", "tmp"] } else { &["x", "w", "h", "c", "k", "tmp"] };
        let free = |p: &&&str| {
            !self.taken.iter().any(|name| {
                let rest = name.strip_prefix(**p);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(|c: char| c == '_' || c.is_ascii_digit()))
            })
        };
        let letter = (*letters.iter().find(free).unwrap_or(&"headland_tmp")).to_string();
        move |n| match style {
            Style::Text => format!("{letter}_{n}"),
            Style::Latex => latex_name(&format!("{letter}_{n}")),
            Style::C => format!("{letter}{n}"),
        }
    }
}
