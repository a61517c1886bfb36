//! A progress bar on stderr for runs that take longer than a second, and messages on the way.

use std::time::{Duration, Instant};

use headland::Observer;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Shows how far a run has come, with the time left.
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    begun: Instant,
    looked: Instant,
    from: f64,
    until: f64,
    quiet: bool,
}

impl Progress {
    pub(crate) fn new(from: f64, until: f64, quiet: bool) -> Self {
        let now = Instant::now();
        Self { bar: None, begun: now, looked: now, from, until, quiet }
    }

    pub(crate) fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Progress {
    fn step(&mut self, t: f64, h: f64) {
        // The clock is looked at seldom: a step may take a microsecond.
        if self.quiet || self.looked.elapsed() < Duration::from_millis(100) {
            return;
        }
        self.looked = Instant::now();
        if self.bar.is_none() && self.begun.elapsed() > Duration::from_secs(1) {
            let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}  {eta} left") {
                bar.set_style(style);
            }
            self.bar = Some(bar);
        }
        if let Some(bar) = &self.bar {
            bar.set_position((1000.0 * (t - self.from) / (self.until - self.from)) as u64);
            bar.set_message(format!("t = {t:.3} s, h = {h:.1e} s"));
        }
    }

    fn message(&mut self, t: f64, message: &str) {
        let text = format!("t = {t:.6} s: {message}");
        match &self.bar {
            Some(bar) => bar.println(text),
            None => crate::tell(&text),
        }
    }
}
