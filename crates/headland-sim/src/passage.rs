//! Places where the constraints lose rank, and how a run steps over them.
//!
//! Where all bars of a linkage lie in a line, a pivot of the elimination goes through zero. The motion is smooth there, but
//! at a distance d from it rounding is multiplied by 1/d², whatever the tolerance, and the motion could branch. A pivot
//! that will vanish within the next step is seen beforehand, and the step is made so that the place falls into the widest
//! gap between the times at which the method evaluates.

use headland_solve::SolveError;

use crate::stepper::Stepper;
use crate::work::Work;

/// Gaps between the abscissae of Dormand and Prince's method of order 8, by their middle: wide ones first.
const GAPS: [f64; 3] = [0.467, 0.754, 0.184];

/// Growth of the partition, the largest scaled entry of G, up to which a vanishing pivot means the constraints' rank.
const MODERATE: f64 = 10.0;

/// Pivots of the elimination at the end of the last step and what they say of the next.
#[derive(Default)]
pub(crate) struct Passage {
    pivots: Vec<f64>,
    /// Time at which a pivot is expected to vanish, with its position.
    ahead: Option<(f64, usize)>,
}

impl Passage {
    /// Looks at the step just taken. Gives the position of a pivot that went through zero in it.
    ///
    /// # Errors
    /// If the dense output cannot be evaluated.
    pub(crate) fn look(&mut self, work: &mut Work, integrator: &mut Stepper) -> Result<Option<usize>, SolveError> {
        self.ahead = None;
        let (t0, t1) = (integrator.t_previous(), integrator.t());
        let y = integrator.y().to_vec();
        let last = work.pivots(t1, &y).to_vec();
        if work.growth(t1, &y) > MODERATE {
            self.forget();
            return Ok(None); // the choice of independent rates fails there, not the constraints
        }
        let before = std::mem::replace(&mut self.pivots, last.clone());
        // shrinking fast enough to vanish soon, or of another sign: only then is the dense output asked
        let soon = |(a, b): (&f64, &f64)| a.signum() != b.signum() || b.abs() < 0.75 * a.abs();
        if t1 <= t0 || before.len() != last.len() || !before.iter().zip(&last).any(soon) {
            return Ok(None);
        }
        let mut at = |fraction: f64| -> Result<Vec<f64>, SolveError> {
            let t = t0 + fraction * (t1 - t0);
            let mut y = vec![0.0; y.len()];
            integrator.interpolate(&mut work.problem, t, &mut y)?;
            Ok(work.pivots(t, &y).to_vec())
        };
        let (first, middle) = (at(0.0)?, at(0.5)?);
        // a pole changes the sign, too: is the pivot like a straight line there, or its reciprocal?
        let bend = |a: f64, m: f64, b: f64| (m - 0.5 * (a + b)).abs() / (a.abs() + b.abs());
        let vanished = |k: &usize| {
            let (a, m, b) = (first[*k], middle[*k], last[*k]);
            a.signum() != b.signum() && bend(a, m, b) <= bend(1.0 / a, 1.0 / m, 1.0 / b)
        };
        let poles = (0..last.len()).filter(|k| first[*k].signum() != last[*k].signum() && !vanished(k)).count();
        let zeros: Vec<usize> = (0..last.len()).filter(vanished).collect();
        self.ahead = (0..last.len())
            .filter_map(|k| Some((t1 + (t1 - t0) * next_zero(first[k], middle[k], last[k])?, k)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(zeros.first().copied().filter(|_| zeros.len() > poles))
    }

    /// Forgets what was seen: another choice of independent rates has other pivots.
    pub(crate) fn forget(&mut self) {
        *self = Self::default();
    }

    /// The next step, if one is wanted other than the proposed one.
    pub(crate) fn step(&self, t: f64, proposed: f64) -> Option<f64> {
        let distance = self.ahead?.0 - t;
        if distance <= 0.0 || distance > 1.6 * proposed {
            return None;
        }
        // as long as the method can go, the place in a gap; or a shorter step, and over it with the next
        let fits = GAPS.iter().map(|gap| distance / gap).find(|h| *h <= proposed);
        Some(fits.unwrap_or(0.5 * distance))
    }
}

/// Where a parabola through values at 0, 1/2 and 1 vanishes after 1: steps beyond the last, below 2.
fn next_zero(first: f64, middle: f64, last: f64) -> Option<f64> {
    // p(x) = last + b x + a x², x = 0 at the last value, −1 at the first
    let a = 2.0 * (first + last - 2.0 * middle);
    let b = last - first + a;
    let discriminant = b * b - 4.0 * a * last;
    if discriminant.is_nan() || discriminant < 0.0 || last == 0.0 {
        return None;
    }
    let q = -0.5 * (b + b.signum() * discriminant.sqrt());
    [q / a, last / q].into_iter().filter(|x| *x > 0.0 && *x < 2.0).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_ahead_are_found() {
        for (zero, slope) in [(0.3, 1.0), (1.2, -4.0), (0.9, 1e-6)] {
            let p = |x: f64| slope * (x - zero) * (1.0 + 0.05 * x); // x = 0 at the end of the step
            let found = next_zero(p(-1.0), p(-0.5), p(0.0)).unwrap();
            assert!((found - zero).abs() < 1e-12, "{found} for {zero}");
        }
        assert_eq!(next_zero(1.0, 1.0, 1.0), None);
        assert_eq!(next_zero(1.0, 2.0, 3.0), None);
    }

    #[test]
    fn the_place_falls_into_a_gap() {
        let passage = Passage { pivots: Vec::new(), ahead: Some((1.0, 0)) };
        assert_eq!(passage.step(0.0, 0.1), None);
        assert_eq!(passage.step(0.0, 1.0), Some(0.5));
        assert_eq!(passage.step(0.0, 3.0), Some(1.0 / 0.467));
        assert_eq!(passage.step(0.0, 1.5), Some(1.0 / 0.754));
    }
}
