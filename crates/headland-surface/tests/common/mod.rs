//! What every field of distance must fulfil.
#![allow(dead_code)] // each test takes a part

use headland_expr::{Dual, FIELD_PARTS, Field, Scalar, field_part};
use headland_spatial::Vector;
use headland_surface::Shape;

/// Value and all derivatives.
pub fn eval(field: &dyn Field, c: [f64; 3]) -> [f64; 20] {
    let mut out = [f64::NAN; 20];
    field.eval(c, 3, &mut out);
    out
}

/// Each derivative is the central difference of the ones an order lower, lower orders are parts of higher ones, and the
/// distance is one: `|n| = 1`, `H n = 0`, `T n = −H H`.
pub fn check(field: &dyn Field, c: [f64; 3], step: f64, tolerance: f64) {
    let all = eval(field, c);
    assert!(all.iter().all(|x| x.is_finite()), "{c:?}: {all:?}");
    for order in 0..3 {
        let mut less = [0.0; 20];
        field.eval(c, order, &mut less);
        assert_eq!(less[..FIELD_PARTS[order]], all[..FIELD_PARTS[order]]);
    }
    for (v, powers) in [[1, 0, 0], [0, 1, 0], [0, 0, 1]].into_iter().enumerate() {
        let at = |k: f64| {
            let mut moved = c;
            moved[v] += k * step;
            eval(field, moved)
        };
        // error of order 4 in the step
        let (a, b, p, q) = (at(-1.0), at(1.0), at(-2.0), at(2.0));
        each(2, |i, j, k| {
            let lower = field_part(i, j, k);
            let difference = (8.0 * (b[lower] - a[lower]) - (q[lower] - p[lower])) / (12.0 * step);
            let exact = all[field_part(i + powers[0], j + powers[1], k + powers[2])];
            let size = exact.abs().max(1.0);
            assert!((difference - exact).abs() < tolerance * size, "{c:?} {i}{j}{k} along {v}: {difference} {exact}");
        });
    }
    let n = [all[1], all[2], all[3]];
    let h = |i: usize, j: usize| all[variables(&[i, j])];
    let size: f64 = (0..3).map(|i| n[i] * n[i]).sum();
    assert!((size - 1.0).abs() < 1e-13, "|n|² = {size}");
    let scale = all[4..10].iter().fold(1.0, |a: f64, x| a.max(x.abs()));
    for i in 0..3 {
        let hn: f64 = (0..3).map(|j| h(i, j) * n[j]).sum();
        assert!(hn.abs() < 1e-11 * scale, "H n = {hn}");
        for j in 0..3 {
            let tn: f64 = (0..3).map(|k| all[variables(&[i, j, k])] * n[k] + h(i, k) * h(k, j)).sum();
            assert!(tn.abs() < 1e-9 * scale * scale, "T n + H H = {tn}");
        }
    }
}

/// Calls for all powers of a total up to `order`.
pub fn each(order: usize, mut f: impl FnMut(usize, usize, usize)) {
    for i in 0..=order {
        for j in 0..=order - i {
            for k in 0..=order - i - j {
                f(i, j, k);
            }
        }
    }
}

/// Place of a derivative along variables.
pub fn variables(v: &[usize]) -> usize {
    let times = |w| v.iter().filter(|&&x| x == w).count();
    field_part(times(0), times(1), times(2))
}

/// A shape's distance with all derivatives, by dual numbers in dual numbers in dual numbers.
pub fn exact(shape: impl Fn() -> Shape<Dual<Dual<Dual<f64>>>>, c: [f64; 3]) -> [f64; 20] {
    let mut out = [0.0; 20];
    for i in 0..3 {
        for j in i..3 {
            for k in j..3 {
                let x = [0, 1, 2].map(|v| {
                    let seed = |w| f64::from(u8::from(v == w));
                    let one = Dual::new(c[v], seed(i));
                    let two = Dual::new(one, Dual::constant(seed(j)));
                    Dual::new(two, Dual::constant(seed(k)))
                });
                let d = shape().distance(Vector(x));
                out[0] = d.value.value.value;
                out[variables(&[i])] = d.value.value.dot;
                out[variables(&[j])] = d.value.dot.value;
                out[variables(&[k])] = d.dot.value.value;
                out[variables(&[i, j])] = d.value.dot.dot;
                out[variables(&[j, k])] = d.dot.dot.value;
                out[variables(&[i, j, k])] = d.dot.dot.dot;
            }
        }
    }
    out
}

/// All of two evaluations agree, each relative to its size where that is above one.
pub fn same(a: &[f64], b: &[f64], tolerance: f64) {
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        assert!((x - y).abs() <= tolerance * x.abs().max(1.0), "part {i}: {x} is not {y}\n{a:?}\n{b:?}");
    }
}

/// Points in a box, the same ones each time.
pub fn points(count: usize, reach: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    // additive recurrence of the plastic number's kind: evenly spread
    let g = 1.220_744_084_605_759_5_f64;
    (1..=count)
        .map(move |i| [0, 1, 2].map(|v| reach[v] * (2.0 * (0.5 + i as f64 / g.powi(v as i32 + 1)).fract() - 1.0)))
}
