//! The Whipple bicycle in straight running: eigenvalues, and its canonical matrices M, C1, K0, K2 out of A.
//!
//! ```text
//! M q″ + v C1 q′ + (g K0 + v² K2) q = 0,   q = (lean, steer)
//! ```

use headland::dynamics::linearise::Linearised;

use super::{model, reference};
use crate::linear::LinearCase;

const SOURCE: &str = "Meijaard, Papadopoulos, Ruina, Schwab 2007 (bicycle.json, 25 digits)";
/// Lean to the right as in the benchmark, steer to the left and so with the other sign.
const NAMES: [&str; 2] = ["place.roll", "steer"];
const GRAVITY: f64 = 9.81;

macro_rules! at_speed {
    ($name:literal, $v:literal) => {
        LinearCase {
            name: $name,
            scene: model!("bicycle"),
            set: &[("v", $v), ("roll_rate", "0")],
            allowed: 1e-11,
            compare: |linear| compare(linear, $v),
            bite: ("c", "0.0808"),
            source: SOURCE,
        }
    };
}

pub(crate) const CASES: &[LinearCase] = &[
    at_speed!("bicycle_at_rest", "0"),
    at_speed!("bicycle_1", "1"),
    at_speed!("bicycle_2", "2"),
    at_speed!("bicycle_3", "3"),
    at_speed!("bicycle_4", "4"),
    at_speed!("bicycle_5", "5"),
    at_speed!("bicycle_6", "6"),
    at_speed!("bicycle_7", "7"),
    at_speed!("bicycle_8", "8"),
    at_speed!("bicycle_9", "9"),
    at_speed!("bicycle_10", "10"),
];

fn compare(linear: &Linearised, speed: &str) -> Vec<(String, f64, f64)> {
    let mut all = eigenvalues(linear, speed);
    all.extend(matrices(linear, speed.parse().unwrap_or(f64::NAN)));
    all
}

/// The four of lean and steer; the fifth, of the speed, is zero.
fn eigenvalues(linear: &Linearised, speed: &str) -> Vec<(String, f64, f64)> {
    let file = reference!("bicycle");
    let mut all = Vec::new();
    let Ok(mut modes) = linear.modes() else { return all };
    let mut expected: Vec<(f64, f64)> = (0..4)
        .map(|k| {
            let part = |i: usize| file.number(&format!("/eigenvalues_25_digits/{speed}/{k}/{i}"));
            (part(0), part(1))
        })
        .collect();
    expected.push((0.0, 0.0));
    for (re, im) in expected {
        let nearest = |m: &headland::dynamics::Mode| (m.re - re).hypot(m.im - im);
        let found = (0..modes.len()).min_by(|&i, &k| nearest(&modes[i]).total_cmp(&nearest(&modes[k])));
        let (value_re, value_im) = match found {
            Some(i) => {
                let mode = modes.remove(i);
                (mode.re, mode.im)
            }
            None => (f64::NAN, f64::NAN),
        };
        all.push((format!("Re λ ({re:.3})"), value_re, re));
        all.push((format!("Im λ ({im:.3})"), value_im, im));
    }
    if !modes.is_empty() {
        all.push(("eigenvalues too many".into(), modes.len() as f64, 0.0));
    }
    all
}

/// `M` as it is in the equations; `v C1` and `g K0 + v² K2` from A.
fn matrices(linear: &Linearised, v: f64) -> Vec<(String, f64, f64)> {
    let file = reference!("bicycle");
    let canonical = |name: &str, i: usize, k: usize| {
        let sign = if i == k { 1.0 } else { -1.0 };
        sign * file.number(&format!("/matrices_25_digits/{name}/{i}/{k}"))
    };
    let find = |name: &str| linear.states.iter().position(|s| s.name == name);
    let mut all = Vec::new();
    let places: Option<Vec<(usize, usize)>> = NAMES.iter().map(|n| Some((find(n)?, find(&format!("{n}'"))?))).collect();
    let Some(places) = places else { return vec![("states place.roll, steer and their rates".into(), f64::NAN, 0.0)] };
    let m = |i: usize, k: usize| {
        let first = linear.displacements;
        linear.mass[(places[i].1 - first, places[k].1 - first)]
    };
    for i in 0..2 {
        for k in 0..2 {
            let name = |what: &str| format!("{what}[{},{}]", i + 1, k + 1);
            // M A: rows of the two, whatever else moves
            let force = |column: usize| -(0..2).map(|j| m(i, j) * linear.a[(places[j].1, column)]).sum::<f64>();
            all.push((name("M"), m(i, k), canonical("M", i, k)));
            all.push((name("v C1"), force(places[k].1), v * canonical("C1", i, k)));
            let stiffness = GRAVITY * canonical("K0", i, k) + v * v * canonical("K2", i, k);
            all.push((name("g K0 + v² K2"), force(places[k].0), stiffness));
        }
    }
    all
}
