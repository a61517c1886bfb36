//! [`Schedule`]: times at which a method must stop, and how long its steps may be.

use headland_expr::NodeId;
use headland_expr::timeline::{Timeline, timeline};
use headland_model::{Model, RowForm};

use crate::options::RunOptions;

/// Breakpoints and quick spells of the functions of time, and the output times that are asked for.
pub(crate) struct Schedule {
    /// Ascending; the last is the end of the run.
    stops: Vec<f64>,
    /// Stops at which functions of time, or their derivatives, may jump.
    breakpoints: Vec<f64>,
    timeline: Timeline,
    max_step: f64,
}

impl Schedule {
    /// Looks at the functions of time as the scene gives them: what elimination makes of them has poles that belong to
    /// the partition, not to the machine.
    pub(crate) fn new(model: &Model, options: &RunOptions) -> Self {
        let (from, until) = (options.from, options.until);
        let rows = model.kinematics.iter().map(|r| match r.form {
            RowForm::Rate(_, node) | RowForm::Zero(node) => node,
        });
        let elements = model.elements.iter().flat_map(|e| [e.value, e.structure]);
        let watched = model.events.iter().map(|e| e.quantity).chain(model.guards.iter().map(|g| g.quantity));
        let roots: Vec<NodeId> =
            rows.chain(elements).chain(watched).chain(model.prescribed.iter().map(|p| p.node)).collect();
        let inputs = model.inputs();
        let time = model.input_index(model.time);
        let mut varying = vec![true; inputs.len()];
        varying[time] = false;
        model.parameters.iter().for_each(|p| varying[p.input] = false);
        let timeline = timeline(&model.graph, &roots, time, &inputs, |i| varying[i], from, until);
        let inside = |t: &f64| *t > from && *t < until;
        // those at the ends too: there, functions of time are those of the run's side
        let breakpoints: Vec<f64> =
            timeline.breakpoints.iter().copied().filter(|t| (from..=until).contains(t)).collect();
        let short = timeline.windows.iter().filter(|w| w.stop);
        let mut stops: Vec<f64> = short.map(|w| w.start).chain(breakpoints.iter().copied()).collect();
        stops.extend(options.at.iter().flatten());
        stops.retain(inside);
        stops.push(until);
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        Self { stops, breakpoints, timeline, max_step: options.max_step }
    }

    /// The first stop behind `t`.
    pub(crate) fn next_stop(&self, t: f64) -> f64 {
        self.stops[self.stops.partition_point(|s| *s <= t).min(self.stops.len() - 1)]
    }

    /// The span between breakpoints that begins at or contains `t`.
    pub(crate) fn span(&self, t: f64) -> (f64, f64) {
        let i = self.breakpoints.partition_point(|b| *b <= t);
        let before = if i == 0 { f64::NEG_INFINITY } else { self.breakpoints[i - 1] };
        (before, self.breakpoints.get(i).copied().unwrap_or(f64::INFINITY))
    }

    pub(crate) fn is_breakpoint(&self, t: f64) -> bool {
        self.breakpoints.binary_search_by(|b| b.total_cmp(&t)).is_ok()
    }

    /// Longest step from `t` on.
    pub(crate) fn longest_step(&self, t: f64) -> f64 {
        let windows = self.timeline.windows.iter().filter(|w| w.start <= t && t < w.end);
        windows.map(|w| w.longest_step).fold(self.max_step, f64::min)
    }
}
