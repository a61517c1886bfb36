//! Identities of the algebra at random arguments, and one meaning over every scalar.
#![allow(non_snake_case)]

use headland_expr::{Dual, Graph, Scalar};
use headland_spatial::{Axis, Inertia, Pose, Quaternion, Rotation, Symmetric, Twist, Vector, Wrench};
use proptest::prelude::*;

fn near(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    for (x, y) in a.iter().zip(b) {
        assert!((x - y).abs() <= tolerance, "{a:?}\n{b:?}");
    }
}

fn flat(r: &Rotation<f64>) -> Vec<f64> {
    r.0.iter().flatten().copied().collect()
}

fn of_twist(v: Twist<f64>) -> [f64; 6] {
    let (a, b) = (v.angular, v.linear);
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

fn of_wrench(f: Wrench<f64>) -> [f64; 6] {
    of_twist(Twist::new(f.torque, f.force))
}

fn vector() -> impl Strategy<Value = Vector<f64>> {
    prop::array::uniform3(-2.0..2.0f64).prop_map(Vector)
}

fn quaternion() -> impl Strategy<Value = Quaternion<f64>> {
    prop::array::uniform4(-1.0..1.0f64).prop_map(Quaternion).prop_filter("not null", |q| q.norm() > 0.1)
}

fn pose() -> impl Strategy<Value = Pose<f64>> {
    (quaternion(), vector()).prop_map(|(q, p)| Pose::new(q.rotation(), p))
}

fn twist() -> impl Strategy<Value = Twist<f64>> {
    (vector(), vector()).prop_map(|(w, v)| Twist::new(w, v))
}

fn wrench() -> impl Strategy<Value = Wrench<f64>> {
    (vector(), vector()).prop_map(|(t, f)| Wrench::new(t, f))
}

/// Of a cloud of points, so that it is one that a body can have.
fn inertia() -> impl Strategy<Value = Inertia<f64>> {
    prop::collection::vec((0.1..2.0f64, vector()), 4..7).prop_map(|points| {
        points.into_iter().map(|(m, p)| Inertia::point(m, p)).reduce(|a, b| a + b).unwrap_or_else(Inertia::zero)
    })
}

proptest! {
    #[test]
    fn rotations_are_orthogonal_and_compose(p in quaternion(), q in quaternion(), v in vector()) {
        let (R, Q) = (p.rotation(), q.rotation());
        near(&flat(&(R * R.transpose())), &flat(&Rotation::identity()), 1e-14);
        near(&flat(&(p * q).rotation()), &flat(&(R * Q)), 1e-14);
        near(&R.apply_inverse(R * v).0, &v.0, 1e-14);
        near(&(R.axis(Axis::X).cross(R.axis(Axis::Y))).0, &R.axis(Axis::Z).0, 1e-14);
        near(&flat(&p.conjugate().rotation()), &flat(&R.inverse()), 1e-14);
        near(&flat(&R.quaternion().rotation()), &flat(&R), 1e-14);
        prop_assert!(R.quaternion().0[0] >= 0.0);
    }

    #[test]
    fn every_way_to_turn_is_one(a in vector(), angle in -7.0..7.0f64) {
        prop_assume!(a.norm() > 0.1);
        let a = a.unit();
        near(&flat(&Rotation::about_unit(a, angle)), &flat(&Quaternion::about_unit(a, angle).rotation()), 1e-14);
        for axis in Axis::ALL {
            let e = Vector::along(axis, 1.0);
            near(&flat(&Rotation::about(axis, angle)), &flat(&Rotation::about_unit(e, angle)), 1e-15);
        }
    }

    #[test]
    fn roll_pitch_yaw_come_back(roll in -3.1..3.1f64, pitch in -1.57..1.57f64, yaw in -3.1..3.1f64) {
        let R = Rotation::from_roll_pitch_yaw(roll, pitch, yaw);
        let (a, b, c) = R.roll_pitch_yaw();
        near(&[a, b, c], &[roll, pitch, yaw], 1e-11);
    }

    #[test]
    fn quaternion_rates_turn_the_matrix(q in quaternion(), w in vector()) {
        // Ṙ = R [ω]× with ω in the body's axes, by dual numbers
        let rate = q.rate_from_body(w);
        let dual = Quaternion(std::array::from_fn(|i| Dual::new(q.0[i], rate.0[i]))).rotation();
        for (i, axis) in Axis::ALL.into_iter().enumerate() {
            let column = dual.axis(axis);
            let expected = q.rotation() * w.cross(Vector::along(axis, 1.0));
            near(&column.map(|x| x.dot).0, &expected.0, 1e-13);
            near(&column.map(|x| x.value).0, &q.rotation().0.map(|row| row[i]), 1e-15);
        }
        near(&q.rate_from_world(q.rotation() * w).0, &rate.0, 1e-14);
        let half = Quaternion::new(0.0, w * 0.5);
        near(&(q * half).0, &rate.0, 1e-15);
    }

    #[test]
    fn frames_compose(x in pose(), y in pose(), p in vector(), v in twist(), f in wrench()) {
        near(&(x * y).point(p).0, &x.point(y.point(p)).0, 1e-13);
        near(&x.inverse().point(p).0, &x.point_inverse(p).0, 1e-13);
        near(&of_twist(v.into_frame(&x).out_of_frame(&x)), &of_twist(v), 1e-13);
        near(&of_twist(v.into_frame(&(x * y))), &of_twist(v.into_frame(&x).into_frame(&y)), 1e-13);
        near(&of_twist(v.into_frame(&x)), &of_twist(v.out_of_frame(&x.inverse())), 1e-13);
        near(&of_wrench(f.into_frame(&x).out_of_frame(&x)), &of_wrench(f), 1e-13);
        near(&of_wrench(f.into_frame(&(x * y))), &of_wrench(f.into_frame(&x).into_frame(&y)), 1e-13);
        prop_assert!((v.into_frame(&x).power(f.into_frame(&x)) - v.power(f)).abs() < 1e-12);
    }

    #[test]
    fn cross_products_are_dual_and_move_with_frames(x in pose(), v in twist(), m in twist(), f in wrench()) {
        // (V × m) · f = −m · (V ×* f)
        prop_assert!((v.cross(m).power(f) + m.power(v.cross_wrench(f))).abs() < 1e-12);
        near(&of_twist(v.cross(m).into_frame(&x)), &of_twist(v.into_frame(&x).cross(m.into_frame(&x))), 1e-12);
        near(
            &of_wrench(v.cross_wrench(f).into_frame(&x)),
            &of_wrench(v.into_frame(&x).cross_wrench(f.into_frame(&x))),
            1e-12,
        );
        near(&of_twist(v.cross(v)), &[0.0; 6], 0.0);
    }

    #[test]
    fn inertias_move_with_frames(x in pose(), i in inertia(), j in inertia(), v in twist(), a in twist()) {
        let (out, o) = (i.out_of_frame(&x), i.about_origin());
        near(&of_wrench(out.momentum(v)), &of_wrench(i.momentum(v.into_frame(&x)).out_of_frame(&x)), 1e-11);
        near(&of_wrench(o.momentum(v)), &of_wrench(i.momentum(v)), 1e-12);
        near(&of_wrench((i + j).momentum(v)), &of_wrench(i.momentum(v) + j.momentum(v)), 1e-11);
        near(&of_wrench((o + j.about_origin()).momentum(v)), &of_wrench((i + j).momentum(v)), 1e-11);
        near(&of_wrench(o.gyroscopic(v)), &of_wrench(v.cross_wrench(i.momentum(v))), 1e-11);
        near(&of_wrench(o.rate_of_momentum(v, a)), &of_wrench(i.momentum(a) + v.cross_wrench(i.momentum(v))), 1e-11);
        prop_assert!((i.kinetic_energy(v) - 0.5 * v.power(i.momentum(v))).abs() < 1e-11);
        near(&i.tensor_about(Vector::zero()).0, &o.tensor.0, 1e-15);
        near(&out.into_frame(&x).tensor.0, &i.tensor.0, 1e-12);
    }

    #[test]
    fn principal_axes_rebuild_the_tensor(i in inertia()) {
        i.check().unwrap();
        let p = i.principal();
        let [a, b, c] = p.moments;
        prop_assert!(a <= b && b <= c);
        near(&p.axes.apply_to_tensor(&Symmetric::diagonal(a, b, c)).0, &i.tensor.0, 1e-12 * c);
        prop_assert!((p.axes.axis(Axis::X).cross(p.axes.axis(Axis::Y)).dot(p.axes.axis(Axis::Z)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn expressions_and_duals_say_what_numbers_say(x in prop::array::uniform16(-1.0..1.0f64), dx in prop::array::uniform16(-1.0..1.0f64)) {
        let graph = Graph::new();
        let inputs: Vec<_> = (0..16).map(|i| graph.input(&format!("x{i}"))).collect();
        let roots: Vec<_> = sample(&inputs).into_iter().map(|e| graph.id(e)).collect();
        let direct = sample(&x);
        near(&graph.eval(&roots, &x), &direct, 1e-13);
        let duals: Vec<_> = x.iter().zip(&dx).map(|(x, d)| Dual::new(*x, *d)).collect();
        let (by_dual, by_graph) = (sample(&duals), graph.eval(&roots, &duals));
        for i in 0..direct.len() {
            prop_assert!((by_dual[i].value - direct[i]).abs() < 1e-13);
            prop_assert!((by_dual[i].dot - by_graph[i].dot).abs() < 1e-10 * (1.0 + by_dual[i].dot.abs()));
        }
    }
}

/// A bit of everything.
fn sample<S: Scalar>(x: &[S]) -> Vec<S> {
    let q = Quaternion([x[0] + S::constant(2.0), x[1], x[2], x[3]]);
    let X = Pose::new(Rotation::about(Axis::Y, x[4]) * q.rotation(), Vector([x[5], x[6], x[7]]));
    let V = Twist::new(Vector([x[8], x[9], x[10]]), Vector([x[11], x[12], x[13]])).into_frame(&X);
    let body = Inertia::solid_box(S::constant(2.0), S::constant(0.3), x[14], S::constant(0.5)).out_of_frame(&X);
    let F = V.cross_wrench(body.momentum(V)).out_of_frame(&X);
    let (roll, pitch, yaw) = X.rotation.roll_pitch_yaw();
    let turned = Rotation::about_unit(Vector([S::constant(0.6), S::constant(0.8), S::constant(0.0)]), x[15]);
    vec![F.torque[0], F.force[1], V.power(F), roll, pitch, yaw, turned.0[0][2], turned.0[2][2]]
}

#[test]
fn structural_zeros_cost_nothing() {
    let graph = Graph::new();
    let (a, b) = (graph.input("a"), graph.input("b"));
    let R = Rotation::about(Axis::Z, a) * Rotation::about(Axis::X, b);
    let roots: Vec<_> = R.0.iter().flatten().map(|e| graph.id(*e)).collect();
    assert_eq!(graph.operations(&roots), 4 + 4 + 2); // sines and cosines, products, signs
    let shifted =
        Twist::new(Vector::along(Axis::Z, a), Vector::zero()).into_frame(&Pose::at(Vector::along(Axis::X, b)));
    let roots: Vec<_> = shifted.linear.0.iter().map(|e| graph.id(*e)).collect();
    assert_eq!(graph.operations(&roots), 1);
}

#[test]
fn the_quaternion_of_every_half_turn_is_found() {
    for axis in Axis::ALL {
        let R = Rotation::about(axis, std::f64::consts::PI);
        near(&flat(&R.quaternion().rotation()), &flat(&R), 1e-15);
    }
    near(&flat(&Quaternion([3.0, 0.0, 0.0, 0.0]).rotation()), &flat(&Rotation::identity()), 0.0);
}
