//! Where functions of time vary quickly: leaves of a bisection, gathered into windows.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::tape::Tape;
use super::{BUDGET, Kind, Kinds, Span, Window};
use crate::dual::Dual;
use crate::graph::{Graph, NodeId};
use crate::ops::Op;

/// A leaf is done when no function's range over it is more than this part of its range over all time.
const RESOLVED: f64 = 0.05;
/// Part of a function's range that it may go through in one step.
const STEP: f64 = 0.5;
/// Steps shorter than the span by this factor need no window.
const COARSE: f64 = 32.0;
/// Ratio of steps from one level of windows to the next.
const LEVEL: f64 = 8.0;
/// A window of no more steps than this is not subdivided.
const CHEAP: f64 = 64.0;
/// Fewest evaluations that make a search worth while.
const FEWEST: usize = 64;
/// Most windows of one level.
const MANY: usize = 16;

/// Windows of the functions of time that something else uses.
pub(super) fn find(
    graph: &Graph,
    kinds: &Kinds,
    values: &[f64],
    roots: &[NodeId],
    span: Span,
    breakpoints: &[f64],
) -> Vec<Window> {
    let outputs = maximal(graph, kinds, roots);
    if outputs.is_empty() {
        return Vec::new();
    }
    let operations = kinds.kind.iter().filter(|kind| **kind == Kind::Time).count();
    if FEWEST * operations > BUDGET {
        return Vec::new(); // too large for a search to say anything in time
    }
    let tape = Tape::new(graph, kinds, values, &outputs);
    let mut search = Search::new(&tape, span);
    let mut pieces = pieces(span, breakpoints);
    if pieces.len() * 2 * tape.cost() > BUDGET {
        pieces = vec![(span.t0, span.t1)];
    }
    for (a, b) in pieces {
        search.add(a, b);
    }
    search.refine();
    let mut windows = regions(&search.leaves(), span.length() / COARSE, span);
    windows.iter_mut().for_each(|window| snap(window, span, breakpoints));
    windows
}

/// Lets a window begin and end at a breakpoint that is near, so that no step must be an instant long.
fn snap(window: &mut Window, span: Span, breakpoints: &[f64]) {
    let near = 0.04 * span.instant();
    for &t in breakpoints.iter().chain([&span.t0, &span.t1]) {
        if t <= window.start + near && t >= window.start - window.longest_step {
            window.start = t;
        }
        if (t - window.end).abs() <= near {
            window.end = t;
        }
    }
}

/// Time nodes that a root or a node depending on states uses, `t` itself left out.
fn maximal(graph: &Graph, kinds: &Kinds, roots: &[NodeId]) -> Vec<NodeId> {
    let mut used = vec![false; kinds.kind.len()];
    for root in roots {
        used[root.index()] = true;
    }
    for id in kinds.nodes().filter(|&id| kinds.of(id) == Kind::State) {
        // Of a condition only the switching counts, and that is a breakpoint.
        let node = graph.node(id);
        for operand in node.operands().skip(usize::from(node.op == Op::Select)) {
            used[operand.index()] = true;
        }
    }
    let is_function = |id: &NodeId| used[id.index()] && kinds.of(*id) == Kind::Time && graph.node(*id).op.arity() > 0;
    kinds.nodes().filter(is_function).collect()
}

/// Spans between breakpoints, an instant left out at each.
fn pieces(span: Span, breakpoints: &[f64]) -> Vec<(f64, f64)> {
    let margin = 0.01 * span.instant();
    let mut list = Vec::new();
    let mut start = span.t0;
    for &t in breakpoints.iter().chain([&span.t1]) {
        if t - start > 4.0 * margin {
            list.push((start + margin, t - margin));
        }
        start = t;
    }
    list
}

/// A span with the ranges that the functions have there.
struct Leaf {
    start: f64,
    end: f64,
    /// Range over the leaf and bound of the slope, a function each.
    rates: Vec<(f64, f64)>,
    /// The largest share of a range over all time.
    share: f64,
}

impl PartialEq for Leaf {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Leaf {}
impl PartialOrd for Leaf {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Leaf {
    /// By share; earlier ones first among equals.
    fn cmp(&self, other: &Self) -> Ordering {
        self.share.total_cmp(&other.share).then(other.start.total_cmp(&self.start))
    }
}

struct Search<'a> {
    tape: &'a Tape<'a>,
    span: Span,
    budget: usize,
    /// Smallest and largest value sampled, a function each.
    sampled: Vec<(f64, f64)>,
    /// Widest finite range met so far, a function each: it stands for one whose samples are all equal.
    widest: Vec<f64>,
    open: BinaryHeap<Leaf>,
    done: Vec<Leaf>,
}

impl<'a> Search<'a> {
    fn new(tape: &'a Tape<'a>, span: Span) -> Self {
        let mut search = Self {
            tape,
            span,
            budget: BUDGET,
            sampled: vec![(f64::INFINITY, f64::NEG_INFINITY); tape.at(span.t0).len()],
            widest: vec![0.0; tape.at(span.t0).len()],
            open: BinaryHeap::new(),
            done: Vec::new(),
        };
        for k in 0..=32 {
            search.sample(span.t0 + span.length() * f64::from(k) / 32.0);
        }
        search
    }

    fn sample(&mut self, t: f64) -> Vec<Dual<f64>> {
        let values = self.tape.at(t);
        for (extent, y) in self.sampled.iter_mut().zip(&values) {
            if y.value.is_finite() {
                *extent = (extent.0.min(y.value), extent.1.max(y.value));
            }
        }
        values
    }

    /// Range of function `k` over all time as far as known; never so small that rounding looks like variation.
    fn total(&self, k: usize) -> f64 {
        let (lo, hi) = self.sampled[k];
        let total = if lo > hi { 0.0 } else { (hi - lo).max(1e-9 * lo.abs().max(hi.abs())) };
        if total > 0.0 { total } else { self.widest[k] }
    }

    fn share(&self, rates: &[(f64, f64)]) -> f64 {
        let share = |(k, &(range, _)): (usize, &(f64, f64))| {
            if range == 0.0 { 0.0 } else { range / self.total(k) }
        };
        rates.iter().enumerate().map(share).fold(0.0, f64::max)
    }

    /// A new leaf with its ranges: the narrower of natural and mean-value form.
    fn add(&mut self, start: f64, end: f64) {
        self.budget = self.budget.saturating_sub(self.tape.cost() + self.tape.cost() / 4);
        self.sample(0.5 * (start + end));
        let width = end - start;
        let (ranges, smooth) = self.tape.over(start, end);
        let rate = |y: &Dual<crate::Interval>| {
            let natural = y.value.width();
            let slope = if smooth { y.dot.magnitude() } else { f64::INFINITY };
            let range = natural.min(slope * width);
            (range, slope.min(range / width))
        };
        let rates: Vec<_> = ranges.iter().map(rate).collect();
        for (widest, (range, _)) in self.widest.iter_mut().zip(&rates) {
            if range.is_finite() {
                *widest = widest.max(*range);
            }
        }
        let share = self.share(&rates);
        self.open.push(Leaf { start, end, rates, share });
    }

    /// Splits the leaf with the largest share until all are resolved or the budget is spent.
    fn refine(&mut self) {
        while let Some(mut leaf) = self.open.pop() {
            leaf.share = self.share(&leaf.rates);
            if leaf.share <= RESOLVED || leaf.end - leaf.start <= self.span.instant() {
                self.done.push(leaf);
            } else if self.open.peek().is_some_and(|next| leaf.share < next.share) {
                self.open.push(leaf); // its share has shrunk since
            } else if self.budget < 4 * self.tape.cost() {
                self.open.push(leaf);
                break;
            } else {
                let middle = 0.5 * (leaf.start + leaf.end);
                self.add(leaf.start, middle);
                self.add(middle, leaf.end);
            }
        }
        for leaf in std::mem::take(&mut self.open) {
            let leaf = if leaf.share > RESOLVED { self.guess(leaf) } else { leaf };
            self.done.push(leaf);
        }
    }

    /// The rates of a leaf that the budget left unresolved: its bounds may be far too wide, samples are not.
    fn guess(&mut self, mut leaf: Leaf) -> Leaf {
        let width = leaf.end - leaf.start;
        let mut slopes = vec![0.0; leaf.rates.len()];
        for part in [0.21, 0.5, 0.83] {
            for (slope, y) in slopes.iter_mut().zip(self.tape.at(leaf.start + part * width)) {
                *slope = f64::max(*slope, y.dot.abs());
            }
        }
        for (rate, slope) in leaf.rates.iter_mut().zip(slopes) {
            *rate = (slope * width, slope);
        }
        leaf
    }

    /// Spans in order with their longest steps; instants (jumps, poles) say nothing.
    fn leaves(mut self) -> Vec<Window> {
        let instant = self.span.instant();
        let mut done = std::mem::take(&mut self.done);
        done.retain(|leaf| leaf.end - leaf.start > instant || self.share(&leaf.rates) <= RESOLVED);
        done.sort_unstable_by(|a, b| a.start.total_cmp(&b.start));
        let longest = |leaf: &Leaf| {
            let step = |(k, &(_, slope)): (usize, &(f64, f64))| {
                if slope > 0.0 && slope.is_finite() { STEP * self.total(k) / slope } else { f64::INFINITY }
            };
            leaf.rates.iter().enumerate().map(step).fold(f64::INFINITY, f64::min).max(instant)
        };
        let window = |leaf: &Leaf| Window { start: leaf.start, end: leaf.end, longest_step: longest(leaf), stop: true };
        done.iter().map(window).collect()
    }
}

/// Windows where steps must be shorter than `limit`, and within long ones again for what is quicker still.
fn regions(leaves: &[Window], limit: f64, span: Span) -> Vec<Window> {
    let mut windows = Vec::new();
    let mut jobs = vec![(leaves.to_vec(), limit)];
    while let Some((leaves, limit)) = jobs.pop() {
        for mut region in quick(&leaves, limit) {
            let next = limit / LEVEL;
            let steps = (region.end - region.start) / region.longest_step;
            if region.longest_step < next && steps > CHEAP && next > span.instant() {
                region.longest_step = next;
                let inside = |l: &&Window| l.start >= region.start && l.end <= region.end;
                jobs.push((leaves.iter().filter(inside).copied().collect(), next));
            }
            windows.push(region);
        }
    }
    windows
}

/// Runs of leaves whose steps are shorter than `limit`, those close to each other joined, at most [`MANY`].
fn quick(leaves: &[Window], limit: f64) -> Vec<Window> {
    let mut runs: Vec<Window> = Vec::new();
    for leaf in leaves.iter().filter(|leaf| leaf.longest_step < limit) {
        match runs.last_mut() {
            Some(run) if leaf.start - run.end <= 2.0 * limit => {
                run.end = leaf.end;
                run.longest_step = run.longest_step.min(leaf.longest_step);
            }
            _ => runs.push(*leaf),
        }
    }
    while runs.len() > MANY {
        let gap = |i: &usize| runs[i + 1].start - runs[*i].end;
        let smallest = (0..runs.len() - 1).map(|i| gap(&i)).fold(f64::INFINITY, f64::min);
        let mut joined: Vec<Window> = Vec::new();
        for run in runs {
            match joined.last_mut() {
                Some(last) if run.start - last.end <= 1.5 * smallest => *last = both(*last, run),
                _ => joined.push(run),
            }
        }
        runs = joined;
    }
    runs
}

fn both(a: Window, b: Window) -> Window {
    Window {
        start: a.start.min(b.start),
        end: a.end.max(b.end),
        longest_step: a.longest_step.min(b.longest_step),
        stop: a.stop && b.stop,
    }
}

/// Windows by growing start; those that another one implies are dropped, wide ones do not stop.
pub(super) fn join(mut windows: Vec<Window>, span: Span) -> Vec<Window> {
    // The strictest first: it may imply later ones, never the other way round.
    windows.sort_by(|a, b| {
        a.longest_step.total_cmp(&b.longest_step).then((b.end - b.start).total_cmp(&(a.end - a.start)))
    });
    let near = span.instant();
    let mut list: Vec<Window> = Vec::new();
    for mut window in windows {
        window.stop &= window.end - window.start <= span.length() / 3.0;
        if !list.iter().any(|w| w.start <= window.start + near && w.end >= window.end - near) {
            list.push(window);
        }
    }
    list.sort_by(|a, b| a.start.total_cmp(&b.start));
    list
}
