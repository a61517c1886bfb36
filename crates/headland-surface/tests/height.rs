//! Distance from heights: against differences, closed forms and searches by brute force.

mod common;

use std::sync::Arc;

use common::{check, eval, exact, points, same};
use headland_expr::{Dual, Field, Scalar};
use headland_surface::{Ellipsoid, Function, Height, HeightError, Revolution, Shape, Side};

/// `a sin(k x) cos(l y)`.
fn waves(a: f64, k: f64, l: f64) -> Height {
    let f = move |x: f64, y: f64| {
        let ((sx, cx), (sy, cy)) = ((k * x).sin_cos(), (l * y).sin_cos());
        [
            a * sx * cy,
            a * k * cx * cy,
            -a * l * sx * sy,
            -a * k * k * sx * cy,
            -a * k * l * cx * sy,
            -a * l * l * sx * cy,
            -a * k.powi(3) * cx * cy,
            a * k * k * l * sx * sy,
            -a * k * l * l * cx * cy,
            a * l.powi(3) * sx * sy,
        ]
    };
    let most = [a * (k + l), a * (k + l).powi(2), a * (k + l).powi(3)];
    Height::new(Arc::new(Function::new("waves", Box::new(f), most).unwrap()))
}

/// `x²/(2 p) + y²/(2 q)`; its slope is bounded within the tests' reach.
fn bowl(p: f64, q: f64) -> Height {
    let f =
        move |x: f64, y: f64| [0.5 * (x * x / p + y * y / q), x / p, y / q, 1.0 / p, 0.0, 1.0 / q, 0.0, 0.0, 0.0, 0.0];
    Height::new(Arc::new(Function::new("bowl", Box::new(f), [100.0, 1.0 / p.min(q), 0.0]).unwrap()))
}

#[test]
fn height_has_its_derivatives() {
    let ground = waves(0.1, 2.0, 1.5);
    for c in points(100, [5.0, 5.0, 0.5]).map(|[x, y, z]| [x, y, z + 0.4]) {
        check(&ground, c, 2e-3, 1e-7);
    }
    let bowl = bowl(1.5, 3.0);
    for c in points(100, [1.0, 1.0, 0.3]) {
        check(&bowl, c, 2e-3, 1e-7);
    }
}

#[test]
fn level_and_sloping_ground_are_planes() {
    let f = |x: f64, y: f64| [0.3 * x - 0.2 * y, 0.3, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let slope = Height::new(Arc::new(Function::new("slope", Box::new(f), [0.4, 0.0, 0.0]).unwrap()));
    let w = (1.0f64 + 0.13).sqrt();
    for c in points(50, [10.0, 10.0, 10.0]) {
        let mut plane = [0.0; 20];
        plane[..4].copy_from_slice(&[(c[2] - 0.3 * c[0] + 0.2 * c[1]) / w, -0.3 / w, 0.2 / w, 1.0 / w]);
        same(&eval(&slope, c), &plane, 2e-14);
    }
}

/// A cap of a sphere, an ellipsoid, a surface of revolution: what other derivations say.
#[test]
fn height_agrees_with_other_forms() {
    let cap = |x: f64, y: f64| {
        let z = (4.0 - x * x - y * y).sqrt();
        let (z3, z5) = (z.powi(3), z.powi(5));
        let cubic = |a: f64, b: f64| (-3.0 * a * (4.0 - b * b) / z5, -b * (4.0 + 2.0 * a * a - b * b) / z5);
        let ((xxx, xxy), (yyy, xyy)) = (cubic(x, y), cubic(y, x));
        [z, -x / z, -y / z, -(4.0 - y * y) / z3, -x * y / z3, -(4.0 - x * x) / z3, xxx, xxy, xyy, yyy]
    };
    let cap = Height::new(Arc::new(Function::new("cap", Box::new(cap), [2.0, 1.0, 4.0]).unwrap()));
    let sphere = || Shape::Sphere { radius: Dual::constant(2.0), side: Side::Outside };
    let ellipsoid = Ellipsoid::new("e", [2.0; 3], Side::Outside).unwrap();
    for c in points(50, [0.7, 0.7, 0.2]).map(|[x, y, z]| [x, y, z + 2.1]) {
        same(&eval(&cap, c), &exact(sphere, c), 1e-12);
        same(&eval(&cap, c), &eval(&ellipsoid, c), 1e-12);
    }
    let profile = Box::new(|r: f64| [r * r / 3.0, r / 1.5, 1.0 / 1.5, 0.0]);
    let turned = Revolution::of_height("bowl", profile, [0.0, 20.0]).unwrap();
    let bowl = bowl(1.5, 1.5);
    for c in points(100, [2.0, 2.0, 1.0]).map(|[x, y, z]| [x, y, z + 0.3]) {
        same(&eval(&turned, c), &eval(&bowl, c), 1e-10);
    }
}

/// Above a wavy ground there are many minima of the distance; the answer is the least, near and far, above and below.
#[test]
fn the_nearest_point_is_global() {
    for (a, k, reach) in [(0.5, 3.0, 4.0), (1.0, 1.0, 30.0), (0.02, 20.0, 1.0)] {
        let ground = waves(a, k, 0.7 * k);
        for c in points(60, [2.0, 2.0, reach]) {
            let foot = match ground.foot(c) {
                Ok(foot) => foot,
                Err(e) => panic!("{e}"),
            };
            let f = |x: f64, y: f64| a * (k * x).sin() * (0.7 * k * y).cos();
            assert!((foot[2] - f(foot[0], foot[1])).abs() < 1e-14);
            let to = |p: [f64; 3]| (0..3).map(|i| (p[i] - c[i]).powi(2)).sum::<f64>().sqrt();
            let d = to(foot);
            for i in 0..160_000 {
                let (x, y) =
                    (c[0] + d * (f64::from(i % 400) / 200.0 - 1.0), c[1] + d * (f64::from(i / 400) / 200.0 - 1.0));
                assert!(to([x, y, f(x, y)]) > d - 1e-12, "{c:?}: {foot:?} at {d}, nearer at {x} {y}");
            }
            let signed = eval(&ground, c)[0];
            assert!((signed - d * (c[2] - f(c[0], c[1])).signum()).abs() < 1e-12 * d.max(1.0));
        }
    }
}

/// On the ground to rounding, and far from the origin.
#[test]
fn on_the_ground_it_answers_too() {
    let ground = waves(0.1, 2.0, 1.5);
    for [x, y, _] in points(100, [3.0, 3.0, 0.0]).chain(points(50, [3e4, 3e4, 0.0])) {
        let f = 0.1 * (2.0 * x).sin() * (1.5 * y).cos();
        let far = x.abs().max(1.0);
        for d in [0.0, 1e-300, 1e-17, 1e-15, 1e-12, 1e-6, -1e-14, -1e-3] {
            let at = eval(&ground, [x, y, f + d]);
            let slope = (0.2 * (2.0 * x).cos() * (1.5 * y).cos()).hypot(0.15 * (2.0 * x).sin() * (1.5 * y).sin());
            let n = 1.0 / (1.0 + slope * slope).sqrt();
            assert!((at[0] - d * n).abs() < 1e-15 * far + 0.4 * d * d, "{x} {y} {d}: {}", at[0]);
            assert!((at[3] - n).abs() < 1e-13 * far + d.abs(), "{x} {y} {d}: {} {n}", at[3]);
        }
    }
}

#[test]
fn from_very_far_it_still_answers() {
    let ground = waves(0.1, 2.0, 1.5);
    for z in [50.0, 200.0] {
        let foot = ground.foot([0.3, -0.2, z]).unwrap();
        assert!((foot[2] - 0.1).abs() < 2e-2, "{foot:?}");
    }
}

#[test]
fn height_tells_what_is_wrong() {
    let hollow = bowl(1.0, 1.0);
    // beyond the centre of curvature on the axis, a circle of feet is equally near
    let error = hollow.foot([0.0, 0.0, 3.0]).unwrap_err();
    assert!(matches!(error, HeightError::Undecided { .. }), "{error}");
    assert!(eval(&hollow, [0.0, 0.0, 3.0])[0].is_nan());
    assert!(matches!(hollow.foot([f64::NAN, 0.0, 1.0]), Err(HeightError::NoHeight { .. })));
    let root = |x: f64, _: f64| [x.sqrt(), 0.5 / x.sqrt(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let half = Height::new(Arc::new(Function::new("half", Box::new(root), [1.0; 3]).unwrap()));
    let message = half.foot([-1.0, 2.0, 0.0]).unwrap_err().to_string();
    assert_eq!(message, "`half` has no height at x = -1 m, y = 2 m, or the point asked is not finite");
    let wrong = Function::new("w", Box::new(|_, _| [0.0; 10]), [-1.0, 0.0, 0.0]).unwrap_err();
    assert_eq!(wrong.to_string(), "the bound of the first derivative of `w` is -1; it must be finite and not negative");
    let mut out = [0.0; 4];
    hollow.eval([0.0, 0.0, 0.5], 1, &mut out);
    assert_eq!(out, [0.5, 0.0, 0.0, 1.0]);
}
