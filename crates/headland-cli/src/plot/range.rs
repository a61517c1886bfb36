//! What an axis spans.

use super::{
    Series,
    curve::{is_function, samples},
};

/// Share of the data's range that is left free beyond each of its ends.
const MARGIN: f64 = 0.05;
/// Ranges below this many units in the last place are rounding, drawn as a constant.
const NOISE: f64 = 64.0;
/// Lengths and values below this are zero, so that nothing divided by them overflows.
const SMALLEST: f64 = 1e-290;

/// An interval `[low, high]` with `low < high`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Range {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

impl Range {
    /// Its length.
    pub fn span(self) -> f64 {
        self.high - self.low
    }

    /// The interval of the same middle with another length.
    pub fn with_span(self, span: f64) -> Self {
        let middle = self.low + 0.5 * self.span();
        Self {
            low: middle - 0.5 * span,
            high: middle + 0.5 * span,
        }
    }

    /// Whether all in it is one value, up to rounding.
    fn is_constant(self) -> bool {
        let size = self.low.abs().max(self.high.abs());
        self.span() <= (NOISE * f64::EPSILON * size).max(SMALLEST)
    }

    /// Longer by `reach` at either end.
    fn widened(self, reach: f64) -> Self {
        Self {
            low: self.low - reach,
            high: self.high + reach,
        }
    }

    /// What is shown around a constant: a tenth of it to either side, or one of its units about zero.
    fn constant_reach(self) -> f64 {
        let size = self.low.abs().max(self.high.abs());
        if size > SMALLEST { 0.1 * size } else { 1.0 }
    }
}

/// What the two axes must span to show all the data: 0 to 1 where there are none.
///
/// Abscissas that never decrease, such as time, fill their axis from end to end; all else gets a margin.
pub fn ranges(series: &[Series], equal_axes: bool) -> [Range; 2] {
    let mut bounds = [Range {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    }; 2];
    for point in series.iter().flat_map(samples) {
        for (range, value) in bounds.iter_mut().zip(point) {
            range.low = range.low.min(value);
            range.high = range.high.max(value);
        }
    }
    let [x, y] = bounds;
    if x.low > x.high {
        return [Range {
            low: 0.0,
            high: 1.0,
        }; 2];
    }
    if equal_axes {
        let reach = match [x, y].map(Range::is_constant) {
            [true, true] => x.constant_reach().max(y.constant_reach()),
            _ => MARGIN * x.span().max(y.span()),
        };
        return [x.widened(reach), y.widened(reach)];
    }
    let tight = series.iter().all(is_function);
    [(x, if tight { 0.0 } else { MARGIN }), (y, MARGIN)].map(|(range, margin)| {
        let reach = if range.is_constant() {
            range.constant_reach()
        } else {
            margin * range.span()
        };
        range.widened(reach)
    })
}
