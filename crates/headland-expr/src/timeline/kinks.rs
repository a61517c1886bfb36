//! Where conditions switch: all zeros of their arguments, by interval bisection and Newton's method.
//!
//! References: Moore, Kearfott, Cloud, *Introduction to Interval Analysis*, 2009, ch. 8.

use rustc_hash::FxHashSet;

use super::tape::Tape;
use super::{BUDGET, Kind, Kinds, Span, Window};
use crate::graph::{Graph, NodeId};
use crate::ops::Op;

/// Breakpoints, and windows that stand for those too many to find.
pub(super) fn find(graph: &Graph, kinds: &Kinds, values: &[f64], span: Span) -> (Vec<f64>, Vec<Window>) {
    let searches = arguments(graph, kinds, values);
    let mut found = Vec::new();
    let mut windows = Vec::new();
    let mut left = BUDGET;
    let count = searches.len();
    for (i, Argument { tape, targets, cut }) in searches.into_iter().enumerate() {
        // What one search does not use, the later ones may.
        let mut search = Search { tape: &tape, targets: &targets, span, budget: left / (count - i), found: Vec::new() };
        let before = search.budget;
        if let Some(window) = search.run() {
            windows.push(window);
        }
        left -= before - search.budget;
        search.join_touches();
        search.found.retain(|&t| cut.as_ref().is_none_or(|x| x.first_at(t).value <= 0.0));
        found.append(&mut search.found);
    }
    (sorted(found, span), windows)
}

/// Growing, one of each group that rounding has spread.
fn sorted(mut times: Vec<f64>, span: Span) -> Vec<f64> {
    let same = 8.0 * f64::EPSILON * span.t0.abs().max(span.t1.abs());
    times.sort_unstable_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier <= same);
    times
}

/// A function of time whose passage through a target is a breakpoint.
struct Argument<'a> {
    tape: Tape<'a>,
    targets: Vec<f64>,
    /// For `atan2(y, x)`: `x`, where that is a function of time; its cut is where `x < 0`.
    cut: Option<Tape<'a>>,
}

fn arguments<'a>(graph: &'a Graph, kinds: &Kinds, values: &[f64]) -> Vec<Argument<'a>> {
    let mut list = Vec::new();
    let mut seen = FxHashSet::default();
    let tape = |outputs: &[NodeId]| Tape::new(graph, kinds, values, outputs);
    let zero = |tape| Argument { tape, targets: vec![0.0], cut: None };
    for id in kinds.nodes() {
        let node = graph.node(id);
        let (a, b) = (NodeId(node.args[0]), NodeId(node.args[1]));
        match node.op {
            Op::Abs | Op::Sign | Op::Select if kinds.of(a) == Kind::Time && seen.insert((a, None)) => {
                list.push(zero(tape(&[a])));
            }
            Op::Min | Op::Max if kinds.of(id) == Kind::Time && seen.insert((a, Some(b.0))) => {
                list.push(zero(tape(&[a, b]).into_difference()));
            }
            Op::Atan2 if kinds.of(a) == Kind::Time => match kinds.of(b) {
                Kind::Fixed if values[b.index()] > 0.0 => {}
                Kind::Time => list.push(Argument { cut: Some(tape(&[b])), ..zero(tape(&[a])) }),
                _ => list.push(zero(tape(&[a]))),
            },
            Op::Spline if kinds.of(a) == Kind::Time && seen.insert((a, Some(u32::MAX - node.args[1]))) => {
                let targets = graph.spline(node.args[1]).knots().to_vec();
                list.push(Argument { targets, ..zero(tape(&[a])) });
            }
            _ => {}
        }
    }
    list
}

/// One function and the values it is to be caught at.
struct Search<'a> {
    tape: &'a Tape<'a>,
    targets: &'a [f64],
    span: Span,
    budget: usize,
    found: Vec<f64>,
}

impl Search<'_> {
    /// Finds all passages from the left; a window if the budget ends before.
    fn run(&mut self) -> Option<Window> {
        let Span { t0, t1 } = self.span;
        let mut stack = vec![(t0, t1)];
        let mut unresolved: Option<(f64, f64)> = None;
        while let Some((a, b)) = stack.pop() {
            if self.budget < self.tape.cost() {
                return Some(self.give_up(a));
            }
            self.budget -= self.tape.cost();
            let (range, smooth) = self.tape.over(a, b);
            let (value, slope) = (range[0].value, range[0].dot);
            let first = self.targets.partition_point(|&x| x < value.lo);
            let end = self.targets.partition_point(|&x| x <= value.hi);
            if first >= end || value.lo == value.hi {
                continue; // passes none, or rests
            }
            if smooth && (slope.lo > 0.0 || slope.hi < 0.0) && slope.lo.is_finite() && slope.hi.is_finite() {
                self.monotone(a, b, first, end);
            } else if b - a > self.span.instant() {
                let middle = 0.5 * (a + b);
                stack.extend([(middle, b), (a, middle)]);
            } else {
                match &mut unresolved {
                    Some((_, end)) if a - *end <= 16.0 * self.span.instant() => *end = b,
                    _ => {
                        self.instant(unresolved.replace((a, b)));
                    }
                }
            }
        }
        self.instant(unresolved);
        None
    }

    /// Where a function touches a target, rounding lets it pass many times: one of them is kept.
    fn join_touches(&mut self) {
        let near = 16.0 * self.span.instant();
        let mut kept: Vec<f64> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        self.found.sort_unstable_by(f64::total_cmp);
        for &t in &self.found {
            let same = t - last <= near && {
                let middle = 0.5 * (last + t);
                let rounding = self.tape.over(middle, middle).0[0].value;
                self.targets.iter().any(|&target| rounding.contains(target))
            };
            if !same {
                kept.push(t);
            }
            last = t;
        }
        self.found = kept;
    }

    /// A monotone piece passes each target between its ends once.
    fn monotone(&mut self, a: f64, b: f64, first: usize, end: usize) {
        let (fa, fb) = (self.tape.first_at(a).value, self.tape.first_at(b).value);
        self.budget = self.budget.saturating_sub(self.tape.cost());
        for k in first..end {
            let target = self.targets[k];
            if (fa - target) * (fb - target) <= 0.0 {
                self.root(a, b, fa - target, target);
            }
        }
    }

    /// The passage of `target` in `[a, b]`, to the last digit: Newton's method kept inside of a bracket.
    fn root(&mut self, mut a: f64, mut b: f64, fa: f64, target: f64) {
        if fa == 0.0 {
            return self.found.push(a);
        }
        let mut t = 0.5 * (a + b);
        let mut steps = 0;
        while t > a && t < b {
            self.budget = self.budget.saturating_sub(self.tape.cost() / 4 + 1);
            let f = self.tape.first_at(t);
            let value = f.value - target;
            if value == 0.0 {
                return self.found.push(t);
            }
            if (value > 0.0) == (fa > 0.0) {
                a = t
            } else {
                b = t
            }
            steps += 1;
            // A little beyond the root, so that both ends of the bracket close in.
            let change = -value / f.dot;
            let beyond = t + change + (1e-3 * change.abs()).max(2.0 * f64::EPSILON * t.abs()).copysign(change);
            t = if beyond > a && beyond < b && steps < 12 { beyond } else { 0.5 * (a + b) };
        }
        self.found.push(b);
    }

    /// An instant that could not be decided: a passage, a touch, or a pole's.
    fn instant(&mut self, unresolved: Option<(f64, f64)>) {
        let Some((a, b)) = unresolved else { return };
        let (fa, fb) = (self.tape.first_at(a), self.tape.first_at(b));
        for &target in self.targets {
            if (fa.value - target) * (fb.value - target) <= 0.0 {
                return self.bisect(a, b, |f| f.0 - target);
            }
        }
        if fa.dot * fb.dot < 0.0 { self.bisect(a, b, |f| f.1) } else { self.found.push(0.5 * (a + b)) }
    }

    fn bisect(&mut self, mut a: f64, mut b: f64, g: impl Fn((f64, f64)) -> f64) {
        let at = |t: f64| {
            let f = self.tape.first_at(t);
            g((f.value, f.dot))
        };
        let ga = at(a);
        if ga == 0.0 {
            b = a;
        }
        loop {
            let t = 0.5 * (a + b);
            if t <= a || t >= b {
                break;
            }
            if (at(t) > 0.0) == (ga > 0.0) { a = t } else { b = t }
        }
        self.found.push(b);
    }

    /// Too many: a window from `a` on with the mean distance of those found.
    fn give_up(&self, a: f64) -> Window {
        let Span { t0, t1 } = self.span;
        let step = if self.found.is_empty() { self.span.length() * 1e-3 } else { (a - t0) / self.found.len() as f64 };
        Window { start: a, end: t1, longest_step: step.max(self.span.instant()), stop: false }
    }
}
