//! Ellipsoid and surface of revolution: against differences, against closed forms, against each other.

mod common;

use common::{check, eval, exact, points, same};
use headland_expr::{Dual, Scalar};
use headland_surface::{Ellipsoid, Revolution, RevolutionError, Shape, ShapeError, Side};

#[test]
fn ellipsoid_has_its_derivatives() {
    for side in [Side::Inside, Side::Outside] {
        let e = Ellipsoid::new("e", [1.0, 1.4, 0.8], side).unwrap();
        let outside = points(60, [2.5, 2.5, 2.5]).filter(|c| (c[0] / 1.0).hypot(c[1] / 1.4).hypot(c[2] / 0.8) > 0.9);
        for c in outside {
            check(&e, c, 2e-3, 3e-8);
        }
    }
    // deep inside, where it bends hard beside the flat piece of doubled feet
    let e = Ellipsoid::new("e", [1.0, 1.4, 0.8], Side::Inside).unwrap();
    for c in points(30, [0.5, 0.5, 0.4]).filter(|c| c[2].abs() > 0.25) {
        check(&e, c, 5e-4, 1e-6);
    }
}

#[test]
fn ellipsoid_of_equal_axes_is_a_sphere() {
    for side in [Side::Inside, Side::Outside] {
        let e = Ellipsoid::new("e", [1.3; 3], side).unwrap();
        let sphere = || Shape::Sphere { radius: Dual::constant(1.3), side };
        for c in points(100, [2.0, 2.0, 2.0]).filter(|c| c[0].hypot(c[1]).hypot(c[2]) > 0.2) {
            same(&eval(&e, c), &exact(sphere, c), 2e-13);
        }
    }
}

/// No point of the ellipsoid is nearer than the foot, from anywhere, on planes of symmetry too.
#[test]
fn ellipsoid_foot_is_the_nearest() {
    let axes = [3.0, 0.5, 1.0];
    let e = Ellipsoid::new("e", axes, Side::Outside).unwrap();
    let mut all: Vec<[f64; 3]> = points(200, [4.0, 1.0, 2.0]).collect();
    all.extend(points(100, [3.0, 0.0, 1.2]));
    all.extend(points(100, [3.0, 1e-9, 1.2]));
    all.extend([[0.0; 3], [0.0, 0.0, 5.0], [2.9, 0.0, 0.0], [1e6, 1e6, 1e6], [1e-300, 1e-300, 1e-300]]);
    for c in all {
        let (p, _) = e.foot(c).unwrap();
        let on: f64 = (0..3).map(|i| (p[i] / axes[i]).powi(2)).sum();
        assert!((on - 1.0).abs() < 1e-12, "{c:?} {p:?} {on}");
        let distance = |p: [f64; 3]| (0..3).map(|i| (p[i] - c[i]).powi(2)).sum::<f64>().sqrt();
        let mut d = [0.0];
        headland_expr::Field::eval(&e, c, 0, &mut d);
        assert!((d[0].abs() - distance(p)).abs() < 1e-12 * distance(p).max(1.0));
        for i in 0..40 {
            for j in 0..=20 {
                let (a, b) = (f64::from(i) * 0.157_08, f64::from(j) * 0.157_08);
                let q = [axes[0] * a.cos() * b.sin(), axes[1] * a.sin() * b.sin(), axes[2] * b.cos()];
                assert!(distance(q) >= distance(p) * (1.0 - 1e-12), "{c:?}: {q:?} nearer than {p:?}");
            }
        }
    }
}

#[test]
fn ellipsoid_tells_where_it_has_no_normal() {
    let e = Ellipsoid::new("e", [1.0, 2.0, 0.5], Side::Inside).unwrap();
    let middle = eval(&e, [0.0; 3]);
    assert_eq!(middle[0], 0.5);
    assert!(middle[1..].iter().all(|x| x.is_nan()));
    assert!(eval(&e, [f64::NAN, 0.0, 0.0]).iter().all(|x| x.is_nan()));
    assert!(eval(&e, [0.0, 0.0, 0.3])[1..4] == [0.0, 0.0, -1.0]);
    assert_eq!(e.fits(0.12), Ok(()));
    assert!(matches!(e.fits(0.125), Err(ShapeError::TooLarge { .. })));
    let flat = Ellipsoid::new("e", [1.0, 0.0, 0.5], Side::Inside).unwrap_err();
    assert_eq!(flat.to_string(), "the ellipsoid's semi-axis along y is 0 m; it must be positive and finite");
}

/// `z = ½ r²/p + b r⁴`.
fn bowl(p: f64, b: f64) -> Revolution {
    let profile = move |r: f64| {
        [0.5 * r * r / p + b * r.powi(4), r / p + 4.0 * b * r.powi(3), 1.0 / p + 12.0 * b * r * r, 24.0 * b * r]
    };
    Revolution::of_height("bowl", Box::new(profile), [0.0, 4.0]).unwrap()
}

/// `r = √(a² − z²)`, a sphere's middle.
fn ball(a: f64, side: Side) -> Revolution {
    let profile = move |z: f64| {
        let r = (a * a - z * z).sqrt();
        [r, -z / r, -a * a / r.powi(3), -3.0 * a * a * z / r.powi(5)]
    };
    Revolution::of_radius("ball", Box::new(profile), [-0.95 * a, 0.95 * a], side).unwrap()
}

#[test]
fn revolution_has_its_derivatives() {
    let vase = |z: f64| {
        let (s, c) = (2.0 * z).sin_cos();
        [1.0 + 0.2 * s, 0.4 * c, -0.8 * s, -1.6 * c]
    };
    for side in [Side::Inside, Side::Outside] {
        let vase = Revolution::of_radius("vase", Box::new(vase), [-4.0, 4.0], side).unwrap();
        for c in points(60, [1.6, 1.6, 2.0]).filter(|c| (0.6..1.6).contains(&c[0].hypot(c[1]))) {
            check(&vase, c, 2e-3, 1e-6);
        }
    }
    let bowl = bowl(1.5, 0.02);
    for c in points(80, [1.0, 1.0, 0.5]) {
        check(&bowl, c, 2e-3, 1e-7);
    }
    // on the axis and beside it
    for c in [[0.0, 0.0, 0.4], [1e-12, 0.0, 0.4], [1e-7, -2e-7, 0.4], [3e-5, 0.0, -0.3], [0.0, 0.0, -2.0]] {
        check(&bowl, c, 2e-3, 1e-7);
    }
}

#[test]
fn revolution_of_a_circle_is_a_sphere_or_a_torus() {
    for side in [Side::Inside, Side::Outside] {
        let ball = ball(1.2, side);
        let sphere = || Shape::Sphere { radius: Dual::constant(1.2), side };
        for c in points(80, [1.5, 1.5, 1.0]).filter(|c| c[0].hypot(c[1]) > 0.6 && c[2].abs() < 1.8 * c[0].hypot(c[1])) {
            same(&eval(&ball, c), &exact(sphere, c), 1e-11);
        }
    }
    let groove = |r: f64| {
        let (x, a): (f64, f64) = (r - 1.0, 0.4);
        let y = (a * a - x * x).sqrt();
        [y, -x / y, -a * a / y.powi(3), -3.0 * a * a * x / y.powi(5)]
    };
    let groove = Revolution::of_height("ring", Box::new(groove), [0.62, 1.38]).unwrap();
    let ring = || Shape::Torus { radius: Dual::constant(1.0), tube: Dual::constant(0.4), side: Side::Outside };
    for c in points(200, [1.4, 1.4, 0.9]).filter(|c| c[2] > 0.15 && (c[0].hypot(c[1]) - 1.0).abs() < c[2]) {
        same(&eval(&groove, c), &exact(ring, c), 1e-11);
    }
}

/// Two derivations of the third derivatives that share nothing.
#[test]
fn revolution_of_an_ellipse_is_the_ellipsoid() {
    let (a, b) = (1.5, 0.7);
    let cap = move |r: f64| {
        let w = (1.0 - r * r / (a * a)).sqrt();
        [b * w, -b * r / (a * a * w), -b / (a * a * w.powi(3)), -3.0 * b * r / (a.powi(4) * w.powi(5))]
    };
    let cap = Revolution::of_height("cap", Box::new(cap), [0.0, 1.4]).unwrap();
    let ellipsoid = Ellipsoid::new("e", [a, a, b], Side::Outside).unwrap();
    for c in points(100, [1.0, 1.0, 1.0]).filter(|c| c[2] > 0.45) {
        same(&eval(&cap, c), &eval(&ellipsoid, c), 1e-10);
    }
}

#[test]
fn revolution_finds_the_nearest_of_many() {
    let waves = |r: f64| {
        let (s, c) = (3.0 * r).sin_cos();
        [0.5 * c, -1.5 * s, -4.5 * c, 13.5 * s]
    };
    let waves = Revolution::of_height("waves", Box::new(waves), [0.0, 12.0]).unwrap();
    for c in points(200, [5.0, 5.0, 6.0]) {
        let Ok(foot) = waves.foot(c) else { panic!("{c:?}") };
        let distance = |r: f64, z: f64| (r - c[0].hypot(c[1])).hypot(z - c[2]);
        let d = distance(foot[0].hypot(foot[1]), foot[2]);
        let best = (0..12_000).map(|i| f64::from(i) / 1000.0).map(|r| distance(r, 0.5 * (3.0 * r).cos()));
        assert!(best.fold(f64::INFINITY, f64::min) > d - 1e-12);
    }
}

#[test]
fn revolution_tells_what_is_wrong() {
    let line = |range| Revolution::of_radius("tube", Box::new(|_| [1.0, 0.0, 0.0, 0.0]), range, Side::Outside);
    assert!(matches!(line([1.0, 1.0]), Err(RevolutionError::Range { .. })));
    assert!(matches!(line([0.0, f64::INFINITY]), Err(RevolutionError::Range { .. })));
    let tube = line([0.0, 1.0]).unwrap();
    assert_eq!(tube.foot([2.0, 0.0, 1.5]), Err(RevolutionError::Edge { name: "tube".into(), at: 1.0 }));
    assert!(matches!(tube.foot([f64::NAN, 0.0, 0.5]), Err(RevolutionError::Point { .. })));
    assert!(eval(&tube, [2.0, 0.0, 1.5]).iter().all(|x| x.is_nan()));
    let axis = eval(&tube, [0.0, 0.0, 0.5]);
    assert!(axis[0] == -1.0 && axis[1].is_nan());
    let cone = Revolution::of_height("spike", Box::new(|r| [-r, -1.0, 0.0, 0.0]), [0.0, 1.0]).unwrap_err();
    assert_eq!(cone.to_string(), "the profile of `spike` has the slope -1 on the axis; it must be level there");
    let closed = Revolution::of_radius("ball", Box::new(|z| [1.0 - z, -1.0, 0.0, 0.0]), [0.0, 1.0], Side::Inside);
    assert!(matches!(closed, Err(RevolutionError::Value { at: 1.0, .. })));
}
