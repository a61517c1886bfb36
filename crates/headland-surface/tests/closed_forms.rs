//! Closed forms against their own definitions: the normal is the distance's gradient, `H` the normal's, over every scalar.

use headland_expr::{Dual, Graph, Scalar};
use headland_spatial::Vector;
use headland_surface::{Shape, ShapeError, Side};
use proptest::prelude::*;

/// The shapes of the tests, over any scalar.
fn shapes<S: Scalar>() -> Vec<Shape<S>> {
    let k = S::constant;
    let mut all = vec![Shape::Plane];
    for side in [Side::Inside, Side::Outside] {
        all.push(Shape::Sphere { radius: k(1.3), side });
        all.push(Shape::Cylinder { radius: k(0.7), side });
        all.push(Shape::Cone { half_angle: k(0.4), side });
        all.push(Shape::Cone { half_angle: k(1.3), side });
        all.push(Shape::Torus { radius: k(1.1), tube: k(0.4), side });
    }
    all
}

fn vector() -> impl Strategy<Value = Vector<f64>> {
    prop::array::uniform3(-2.0..2.0f64).prop_map(Vector)
}

/// Away from where two feet are equally near: the axis and the torus's middle circle.
fn clear(c: Vector<f64>) -> bool {
    let rho = c[0].hypot(c[1]);
    rho > 0.05 && (rho - 1.1).hypot(c[2]) > 0.05
}

fn near(a: f64, b: f64, tolerance: f64) -> Result<(), TestCaseError> {
    prop_assert!((a - b).abs() <= tolerance, "{a} is not {b}");
    Ok(())
}

fn near3(a: Vector<f64>, b: Vector<f64>, tolerance: f64) -> Result<(), TestCaseError> {
    (0..3).try_for_each(|i| near(a[i], b[i], tolerance))
}

proptest! {
    #[test]
    fn normal_is_the_gradient_and_turns_by_h(c in vector(), v in vector()) {
        prop_assume!(clear(c));
        let moving = Vector([0, 1, 2].map(|i| Dual::new(c[i], v[i])));
        for (shape, dual) in shapes::<f64>().into_iter().zip(shapes::<Dual<f64>>()) {
            let n = shape.normal(c);
            near(n.norm(), 1.0, 1e-14)?;
            let d = dual.distance(moving);
            near(d.value, shape.distance(c), 1e-15)?;
            near(d.dot, n.dot(v), 1e-13)?;
            let turning = dual.normal(moving);
            near3(turning.map(|x| x.dot), shape.normal_rate(c, v), 1e-10)?;
            near3(shape.normal_rate(c, n), Vector::zero(), 1e-12)?;
        }
    }

    #[test]
    fn h_is_symmetric_and_the_difference_of_normals(c in vector(), v in vector(), w in vector()) {
        prop_assume!(clear(c));
        let h = 1e-5;
        for shape in shapes::<f64>() {
            near(shape.normal_rate(c, v).dot(w), shape.normal_rate(c, w).dot(v), 1e-10)?;
            // a cone's curvature jumps between flank and apex
            let jumps = matches!(shape, Shape::Cone { half_angle, .. }
                if (c[0].hypot(c[1]) * half_angle.sin() + c[2] * half_angle.cos()).abs() < 10.0 * h);
            if !jumps {
                let (a, b) = (shape.normal(c + v * h), shape.normal(c - v * h));
                near3((a - b) * (0.5 / h), shape.normal_rate(c, v), 2e-5)?;
            }
        }
    }

    /// The foot is on the surface and has the same normal; no point of the surface is nearer.
    #[test]
    fn foot_is_the_nearest_point(c in vector(), a in -3.1..3.1f64, b in -3.1..3.1f64, s in -2.0..2.0f64) {
        prop_assume!(clear(c));
        for shape in shapes::<f64>() {
            let (d, n) = (shape.distance(c), shape.normal(c));
            let foot = c - n * d;
            near(shape.distance(foot), 0.0, 1e-14)?;
            let any = match shape {
                Shape::Plane => Vector([a, b, 0.0]),
                Shape::Sphere { radius, .. } => Vector([a.cos() * b.sin(), a.sin() * b.sin(), b.cos()]) * radius,
                Shape::Cylinder { radius, .. } => Vector([radius * a.cos(), radius * a.sin(), s]),
                Shape::Cone { half_angle, .. } => {
                    Vector([half_angle.sin() * a.cos(), half_angle.sin() * a.sin(), half_angle.cos()]) * s.abs()
                }
                Shape::Torus { radius, tube, .. } => {
                    let rho = radius + tube * b.cos();
                    Vector([rho * a.cos(), rho * a.sin(), tube * b.sin()])
                }
            };
            near(shape.distance(any), 0.0, 1e-14)?;
            prop_assert!((any - c).norm() >= d.abs() - 1e-14);
        }
    }

    #[test]
    fn expressions_say_the_same(c in vector(), v in vector()) {
        prop_assume!(clear(c));
        for (i, shape) in shapes::<f64>().into_iter().enumerate() {
            let graph = Graph::new();
            let x = Vector(["x", "y", "z"].map(|name| graph.input(name)));
            // Expr's constants need no graph
            let symbolic = &shapes()[i];
            let (d, n) = (graph.id(symbolic.distance(x)), symbolic.normal(x));
            let rate = symbolic.normal_rate(x, v.map(Scalar::constant));
            let mut roots = vec![d];
            roots.extend([n[0], n[1], n[2], rate[0], rate[1], rate[2]].map(|e| graph.id(e)));
            let vars = [0, 1, 2].map(|k| graph.id(x[k]));
            roots.extend(graph.gradient(d, &vars).into_iter().map(|e| graph.id(e)));
            let found = graph.eval(&roots, &c.0);
            near(found[0], shape.distance(c), 1e-14)?;
            let n = shape.normal(c);
            near3(Vector([found[1], found[2], found[3]]), n, 1e-14)?;
            near3(Vector([found[4], found[5], found[6]]), shape.normal_rate(c, v), 1e-11)?;
            near3(Vector([found[7], found[8], found[9]]), n, 1e-13)?;
        }
    }

    /// A ball of the room's radius at the foot is nowhere through the surface, a larger one is.
    #[test]
    fn room_is_what_a_ball_has(c in vector()) {
        prop_assume!(clear(c));
        for shape in shapes::<f64>() {
            let n = shape.normal(c);
            let foot = c - n * shape.distance(c);
            let room = shape.room(c.0);
            let small = 0.99 * room.min(50.0);
            near(shape.distance(foot + n * small), small, 1e-12)?;
            if room < 50.0 && room > 1e-3 {
                prop_assert!(shape.distance(foot + n * (1.01 * room)) < 1.01 * room - 1e-6);
            }
        }
    }
}

#[test]
fn straight_below_the_apex_all_is_finite() {
    let below = Vector([Dual::new(0.0, 1.0), Dual::new(0.0, 0.0), Dual::new(-2.0, 0.0)]);
    let cone = Shape::Cone { half_angle: Dual::constant(0.5), side: Side::Outside };
    assert_eq!((cone.distance(below).value, cone.distance(below).dot), (2.0, 0.0));
    assert_eq!(cone.normal(below).map(|x| x.value).0, [0.0, 0.0, -1.0]);
    assert_eq!(cone.normal(below).map(|x| x.dot).0, [0.5, 0.0, 0.0]);
}

#[test]
fn sizes_that_make_no_surface_are_refused() {
    let side = Side::Inside;
    for shape in shapes::<f64>() {
        assert_eq!(shape.check(), Ok(()));
    }
    let message = |shape: Shape<f64>| shape.check().unwrap_err().to_string();
    assert_eq!(
        message(Shape::Sphere { radius: -1.0, side }),
        "the sphere's radius is -1 m; it must be positive and finite"
    );
    assert!(message(Shape::Cylinder { radius: f64::NAN, side }).contains("cylinder's radius is NaN"));
    assert!(message(Shape::Torus { radius: 1.0, tube: 0.0, side }).contains("tube radius is 0 m"));
    assert!(message(Shape::Torus { radius: 1.0, tube: 1.0, side }).contains("closes its hole"));
    for degrees in [0.0f64, 90.0, -3.0, 120.0, f64::NAN] {
        assert!(message(Shape::Cone { half_angle: degrees.to_radians(), side }).contains("half-angle"));
    }
}

#[test]
fn balls_that_do_not_fit_are_refused() {
    let recess = Shape::Sphere { radius: 1.0, side: Side::Inside };
    assert_eq!(recess.fits(0.999), Ok(()));
    assert_eq!(recess.fits(1.0), Err(ShapeError::TooLarge { shape: "sphere", ball: 1.0, room: 1.0 }));
    assert_eq!(recess.fits(-0.1), Err(ShapeError::Ball { value: -0.1 }));
    assert!(recess.fits(f64::NAN).is_err());
    let tube = Shape::Torus { radius: 1.0, tube: 0.2, side: Side::Inside };
    assert!(tube.fits(0.2).unwrap_err().to_string().contains("inside the tube of the torus of radius 0.2 m"));
    assert!(Shape::Torus { radius: 1.0, tube: 0.2, side: Side::Outside }.fits(5.0).is_ok());
    assert!(Shape::Cone { half_angle: 0.3, side: Side::Inside }.fits(5.0).is_ok());
}
