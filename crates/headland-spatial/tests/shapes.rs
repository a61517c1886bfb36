//! The closed forms against numeric integration; what `check` refuses and how it says so.

#![allow(non_snake_case)]

use std::f64::consts::TAU;

use headland_spatial::{Axis, Inertia, InertiaError, Symmetric, Vector};

/// Gauss-Legendre points and weights on (0, 1), exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046910077030668004, 0.11846344252809454),
    (0.23076534494715845, 0.23931433524968324),
    (0.5, 0.28444444444444444),
    (0.7692346550528415, 0.23931433524968324),
    (0.953089922969332, 0.11846344252809454),
];

/// The body of mass 3 spread over points by `place(a, b, angle) = (point, relative density of volume)`; a, b in (0, 1).
fn integrate(place: impl Fn(f64, f64, f64) -> ([f64; 3], f64)) -> Inertia<f64> {
    let points: Vec<([f64; 3], f64)> = (0..24)
        .flat_map(|k| GAUSS.iter().flat_map(move |a| GAUSS.iter().map(move |b| (a, b, TAU * f64::from(k) / 24.0))))
        .map(|(a, b, angle)| {
            let (p, density) = place(a.0, b.0, angle);
            (p, density * a.1 * b.1)
        })
        .collect();
    let total: f64 = points.iter().map(|p| p.1).sum();
    points.into_iter().map(|(p, m)| Inertia::point(3.0 * m / total, Vector(p))).reduce(|a, b| a + b).unwrap()
}

#[track_caller]
fn agree(shape: Inertia<f64>, numeric: Inertia<f64>) {
    shape.check().unwrap();
    assert!((shape.mass - numeric.mass).abs() < 1e-12);
    assert!(numeric.centre.norm() < 1e-12, "{:?}", numeric.centre);
    for (a, b) in shape.tensor.0.iter().zip(numeric.tensor.0) {
        assert!((a - b).abs() < 1e-10 * shape.tensor.trace(), "{:?}\n{:?}", shape.tensor, numeric.tensor);
    }
}

fn ring(r: f64, angle: f64, z: f64) -> [f64; 3] {
    [r * angle.cos(), r * angle.sin(), z]
}

#[test]
fn bodies_of_revolution() {
    let (m, r, l, z) = (3.0, 0.7, 1.3, Axis::Z);
    agree(Inertia::solid_cylinder(m, r, l, z), integrate(|a, b, t| (ring(r * a, t, l * (b - 0.5)), a)));
    agree(Inertia::cylindrical_shell(m, r, l, z), integrate(|_, b, t| (ring(r, t, l * (b - 0.5)), 1.0)));
    let hole = 0.4;
    let radius = |a: f64| hole + (r - hole) * a;
    agree(Inertia::tube(m, r, hole, l, z), integrate(|a, b, t| (ring(radius(a), t, l * (b - 0.5)), radius(a))));
    agree(Inertia::disc(m, r, z), integrate(|a, _, t| (ring(r * a, t, 0.0), a)));
    agree(Inertia::ring(m, r, z), integrate(|_, _, t| (ring(r, t, 0.0), 1.0)));
    agree(Inertia::rod(m, l, z), integrate(|_, b, _| ([0.0, 0.0, l * (b - 0.5)], 1.0)));
    // slices of a sphere at height c r, c = 2 b − 1
    let slice = |b: f64| (1.0 - (2.0 * b - 1.0).powi(2)).sqrt();
    let sphere = |a: f64, b: f64, t: f64| (ring(r * a * slice(b), t, r * a * (2.0 * b - 1.0)), a * a);
    agree(Inertia::solid_sphere(m, r), integrate(sphere));
    agree(Inertia::spherical_shell(m, r), integrate(|_, b, t| sphere(1.0, b, t)));
    let ellipsoid = |a: f64, b: f64, t: f64| {
        let ([x, y, z], d) = sphere(a, b, t);
        ([x, 1.5 * y, 0.5 * z], d)
    };
    agree(Inertia::solid_ellipsoid(m, r, 1.5 * r, 0.5 * r), integrate(ellipsoid));
    let cone = |a: f64, b: f64, t: f64| (ring(r * a * b, t, l * (0.75 - b)), a * b * b);
    agree(Inertia::solid_cone(m, r, l, z), integrate(cone));
}

#[test]
fn torus_and_box() {
    let (R, r) = (0.9, 0.2);
    // the section's angle is integrated by rings of the same weight
    let numeric = (0..24)
        .map(|k| TAU * f64::from(k) / 24.0)
        .map(|s| (s, integrate(|a, _, t| (ring(R + r * a * s.cos(), t, r * a * s.sin()), a * (R + r * a * s.cos())))))
        .map(|(s, part)| {
            let mass = GAUSS.iter().map(|(a, w)| w * a * (R + r * a * s.cos())).sum::<f64>();
            let k = mass / part.mass;
            Inertia::new(mass, part.centre, part.tensor * k)
        })
        .reduce(|a, b| a + b)
        .unwrap();
    let k = 3.0 / numeric.mass;
    agree(Inertia::solid_torus(3.0, R, r, Axis::Z), Inertia::new(3.0, numeric.centre, numeric.tensor * k));

    let slab = integrate(|a, b, _| ([0.4 * (a - 0.5), 0.6 * (b - 0.5), 0.0], 1.0));
    let height = Inertia::new(0.0, Vector::zero(), Symmetric::diagonal(1.0, 1.0, 0.0) * (3.0 * 0.8 * 0.8 / 12.0));
    agree(Inertia::solid_box(3.0, 0.4, 0.6, 0.8), Inertia::new(3.0, slab.centre, slab.tensor + height.tensor));
}

#[test]
fn the_axis_is_where_it_is_asked_for() {
    for axis in Axis::ALL {
        let (i, j, k) = axis.cycle();
        let wheel = Inertia::<f64>::ring(2.0, 0.5, axis).tensor;
        assert_eq!((wheel.get(i, i), wheel.get(j, j), wheel.get(k, k)), (0.5, 0.25, 0.25));
    }
}

fn refused(xx: f64, yy: f64, zz: f64, xy: f64) -> InertiaError {
    Inertia::new(1.0, Vector::zero(), Symmetric::new(xx, yy, zz, xy, 0.0, 0.0)).check().unwrap_err()
}

#[test]
fn what_no_body_has_is_refused() {
    let text = refused(1.0, 1.0, 3.0, 0.0).to_string();
    assert!(text.contains("[1.0, 1.0, 3.0]") && text.contains("about z") && text.contains("2"), "{text}");
    let text = refused(1.0, 1.0, 1.0, 1.5).to_string();
    assert!(text.contains("positive semidefinite") && text.contains("0.7071"), "{text}");
    let text = refused(-1.0, 1.0, 1.0, 0.0).to_string();
    assert!(text.contains("about x"), "{text}");
    let text = refused(f64::NAN, 1.0, 1.0, 0.0).to_string();
    assert!(text.contains("entry xx"), "{text}");
    let body = Inertia::solid_sphere(1.0, 0.1);
    assert_eq!(Inertia { mass: -1.0, ..body }.check(), Err(InertiaError::NegativeMass { mass: -1.0 }));
    assert!(matches!(Inertia { mass: 0.0, ..body }.check(), Err(InertiaError::TensorWithoutMass { .. })));
    let far = body.with_centre(Vector([0.0, f64::INFINITY, 0.0])).check().unwrap_err().to_string();
    assert!(far.contains("y of the mass centre") && far.contains("inf"), "{far}");
    Inertia::<f64>::zero().check().unwrap();
    Inertia::rod(1.0, 2.0, Axis::Y).check().unwrap();
}
