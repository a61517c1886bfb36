//! Small motions of a ball at the bottom of a recess, at rest and spinning.
//!
//! ```text
//! ω² − s G ω − g/((1 + k) a) = 0,   G = k r ν/((1 + k) a),   a = R − r,   s = ±1: two whirls
//! ```
//! (Routh, Advanced Part, 1905; `ball_in_recess.json`.)

use headland::dynamics::linearise::Linearised;

use super::model;
use crate::linear::LinearCase;

const SOURCE: &str = "closed form (ball_in_recess.json, small_oscillation)";
const RECESS: f64 = 0.5;
const BALL: f64 = 0.05;
const GRAVITY: f64 = 9.81;

macro_rules! spinning {
    ($name:literal, $spin:literal, $factor:literal) => {
        LinearCase {
            name: $name,
            scene: model!("ball_in_recess"),
            set: &[("polar", "0"), ("azimuth_speed", "0"), ("spin", $spin), ("inertia_factor", $factor)],
            allowed: 1e-10,
            compare: |linear| compare(linear, $spin, $factor),
            bite: ("R", "0.505"),
            source: SOURCE,
        }
    };
}

pub(crate) const CASES: &[LinearCase] = &[
    spinning!("ball_swings", "0", "0.4"),
    spinning!("ball_whirls", "50", "0.4"),
    spinning!("ball_whirls_fast", "-1000", "0.4"),
    spinning!("hollow_ball_whirls", "30", "0.6666666666666666"),
];

/// The two frequencies, and that nothing grows or fades; what is neutral has an eigenvalue of zero.
fn compare(linear: &Linearised, spin: &str, factor: &str) -> Vec<(String, f64, f64)> {
    let number = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let (spin, k) = (number(spin), number(factor));
    let a = RECESS - BALL;
    let (stiff, whirl) = (GRAVITY / ((1.0 + k) * a), k * BALL * spin.abs() / ((1.0 + k) * a));
    let root = (whirl * whirl / 4.0 + stiff).sqrt();
    let fast = root + whirl / 2.0;
    let slow = stiff / fast;
    let Ok(mut modes) = linear.modes() else { return vec![("modes".into(), f64::NAN, 0.0)] };
    if modes.len() < 4 {
        return vec![("eigenvalues too few".into(), f64::NAN, 0.0)];
    }
    let mut expected = vec![0.0; modes.len() - 4];
    expected.extend([fast, slow, -slow, -fast]);
    expected.sort_by(|a, b| b.total_cmp(a));
    modes.sort_by(|a, b| b.im.total_cmp(&a.im));
    let mut all = Vec::new();
    for (mode, reference) in modes.iter().zip(expected) {
        all.push((format!("Im λ ({reference:.3})"), mode.im, reference));
        all.push((format!("Re λ ({reference:.3})"), mode.re, 0.0));
    }
    all
}
