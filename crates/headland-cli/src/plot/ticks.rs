//! Where an axis is labelled, and with what.
//!
//! Ticks are the multiples of a step of 1, 2 or 5 times a power of ten. They are kept as whole numbers of that power,
//! so the labels are exact decimals: no digit of a label is rounding.
//!
//! ```text
//! value = n · 10^e        label = (n − n₀) · 10^(e − p)        note: "×10^p + n₀·10^e"
//! ```

use super::range::Range;

/// Labels with more digits are written relative to a round number, which the note gives.
const MOST_DIGITS: usize = 7;

/// The ticks of one axis.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Ticks {
    /// Where they are, in the units of the data, increasing.
    pub values: Vec<f64>,
    /// What stands there.
    pub labels: Vec<String>,
    /// What all labels have in common: a power of ten, an offset, or nothing.
    pub note: String,
}

/// Distance between two ticks: `mantissa · 10^exponent`, mantissa 1, 2 or 5.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Step {
    /// 1, 2 or 5.
    pub mantissa: i128,
    /// The power of ten.
    pub exponent: i32,
}

impl Step {
    /// The steps of at least about a thousandth of a range, smallest first.
    pub fn candidates(range: Range) -> impl Iterator<Item = Self> {
        let decade = range.span().log10().floor() as i32;
        (decade - 3..=decade + 1).flat_map(|exponent| {
            [1, 2, 5]
                .into_iter()
                .map(move |mantissa| Self { mantissa, exponent })
        })
    }

    /// The step in the units of the data.
    pub fn value(self) -> f64 {
        decimal(self.mantissa, self.exponent)
    }
}

/// The finest ticks that have at least `spacing` pixels each and for which `fit` has room.
///
/// At least two ticks, room or not.
pub fn finest(
    range: Range,
    pixels: f64,
    spacing: f64,
    fit: impl Fn(&Ticks, f64) -> bool,
) -> (Step, Ticks) {
    let mut best = None;
    for step in Step::candidates(range) {
        let each = step.value() / range.span() * pixels;
        if each < spacing {
            continue;
        }
        let ticks = ticks(range, step);
        if ticks.values.len() < 2 && best.is_some() {
            break;
        }
        let fits = fit(&ticks, each);
        best = Some((step, ticks));
        if fits {
            break;
        }
    }
    best.unwrap_or_else(|| {
        let coarse = Step::candidates(range)
            .last()
            .expect("there are candidates");
        (coarse, ticks(range, coarse))
    })
}

/// All multiples of a step in a range, with their labels.
pub fn ticks(range: Range, step: Step) -> Ticks {
    let slack = 4e-3; // of a step: a tick less than half a pixel beyond an end is still shown
    let first = (range.low / step.value() - slack).ceil() as i128;
    let last = (range.high / step.value() + slack).floor() as i128;
    let numbers: Vec<i128> = (first..=last)
        .take(2000)
        .map(|k| k * step.mantissa)
        .collect();
    let values = numbers.iter().map(|&n| decimal(n, step.exponent)).collect();
    let (labels, note) = labels(&numbers, step.exponent);
    Ticks {
        values,
        labels,
        note,
    }
}

/// The labels of `n · 10^exponent` and what they have in common.
fn labels(numbers: &[i128], exponent: i32) -> (Vec<String>, String) {
    let offset = offset(numbers);
    let numbers: Vec<i128> = numbers.iter().map(|n| n - offset).collect();
    let power = common_power(&numbers, exponent);
    let labels = numbers
        .iter()
        .map(|&n| fixed(n, exponent - power))
        .collect();
    let mut note = String::new();
    if power != 0 {
        note = format!("×10{}", superscript(power));
    }
    if offset != 0 {
        let space = if note.is_empty() { "" } else { " " };
        let sign = if offset < 0 { '−' } else { '+' };
        note += &format!("{space}{sign} {}", shortest(offset.abs(), exponent));
    }
    (labels, note)
}

/// The roundest number from which all of `numbers` differ by at most four digits; zero where labels are short.
fn offset(numbers: &[i128]) -> i128 {
    let (Some(&first), Some(&last)) = (numbers.first(), numbers.last()) else {
        return 0;
    };
    let digits = count_digits(first.abs().max(last.abs()));
    if digits <= MOST_DIGITS {
        return 0;
    }
    let middle = i128::midpoint(first, last);
    let round = |unit: i128| (middle + unit / 2).div_euclid(unit) * unit;
    (3..=digits as u32)
        .rev()
        .map(|k| round(10_i128.pow(k)))
        .find(|o| (first - o).abs().max((last - o).abs()) < 10_000)
        .unwrap_or(0)
}

/// A power of ten, a multiple of three, that keeps labels of very large or small numbers short; else zero.
fn common_power(numbers: &[i128], exponent: i32) -> i32 {
    let largest = numbers.iter().map(|n| n.abs()).max().unwrap_or(0);
    if largest == 0 {
        return 0;
    }
    let magnitude = count_digits(largest) as i32 - 1 + exponent;
    if !(-3..6).contains(&magnitude) || (exponent < -6 && magnitude < 0) {
        magnitude.div_euclid(3) * 3
    } else {
        0
    }
}

/// `n · 10^exponent` with as many decimals as the exponent asks for.
fn fixed(n: i128, exponent: i32) -> String {
    let sign = if n < 0 { "−" } else { "" };
    let digits = n.unsigned_abs().to_string();
    if exponent >= 0 {
        let zeros = if n == 0 { 0 } else { exponent as usize };
        return format!("{sign}{digits}{}", "0".repeat(zeros));
    }
    let decimals = exponent.unsigned_abs() as usize;
    let digits = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    format!("{sign}{whole}.{fraction}")
}

/// `n · 10^exponent`, `n > 0`, without zeros that say nothing.
fn shortest(mut n: i128, mut exponent: i32) -> String {
    while n % 10 == 0 {
        n /= 10;
        exponent += 1;
    }
    let power = common_power(&[n], exponent);
    let number = fixed(n, exponent - power);
    if power == 0 {
        number
    } else {
        format!("{number}×10{}", superscript(power))
    }
}

/// The double nearest to `n · 10^exponent`.
fn decimal(n: i128, exponent: i32) -> f64 {
    format!("{n}e{exponent}")
        .parse()
        .expect("this is how a number is written")
}

fn count_digits(n: i128) -> usize {
    n.unsigned_abs().checked_ilog10().unwrap_or(0) as usize + 1
}

fn superscript(power: i32) -> String {
    let raise = |c| match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        _ => '⁹',
    };
    power.to_string().chars().map(raise).collect()
}
