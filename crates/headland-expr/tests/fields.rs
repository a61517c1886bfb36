//! Fields in graphs: identity, folding, derivatives and where they end, printing.

use std::sync::Arc;

use headland_expr::field::{field_derived, field_slopes};
use headland_expr::print::{Style, c_file, expression};
use headland_expr::timeline::timeline;
use headland_expr::{Dual, Expr, FIELD_BEYOND, FIELD_PARTS, Field, Graph, Interval, NodeId, Scalar, Wave, field_part};

fn wave(name: &str) -> Arc<dyn Field> {
    Arc::new(Wave { name: name.into(), rate: [0.7, -1.1, 0.4], phase: [0.1, 1.3, -0.6] })
}

/// `x² y` over the plane.
#[derive(Debug)]
struct Hill;

impl Field for Hill {
    fn name(&self) -> &str {
        "hill"
    }
    fn eval(&self, [x, y, _]: [f64; 3], order: usize, out: &mut [f64]) {
        let mut parts = [0.0; FIELD_PARTS[3]];
        parts[field_part(0, 0, 0)] = x * x * y;
        parts[field_part(1, 0, 0)] = 2.0 * x * y;
        parts[field_part(0, 1, 0)] = x * x;
        parts[field_part(2, 0, 0)] = 2.0 * y;
        parts[field_part(1, 1, 0)] = 2.0 * x;
        parts[field_part(2, 1, 0)] = 2.0;
        out.copy_from_slice(&parts[..FIELD_PARTS[order]]);
    }
    fn variables(&self) -> usize {
        2
    }
}

/// Parts of the wave against differences of the part before: the closed form of the tests is right.
#[test]
fn wave_has_the_derivatives_it_says() {
    let (field, point, h) = (wave("wave"), [0.3, -0.8, 1.1], 1e-5);
    for part in 0..FIELD_PARTS[2] {
        for axis in 0..3 {
            let at = |h: f64| {
                let mut moved = point;
                moved[axis] += h;
                f64::field(moved, &field, part)
            };
            let difference = (at(h) - at(-h)) / (2.0 * h);
            let exact = f64::field(point, &field, field_derived(part, axis));
            assert!((exact - difference).abs() < 1e-9, "part {part}, axis {axis}: {exact} {difference}");
            assert_eq!(field_slopes(&*field, point, part), {
                let slope = |axis: usize| f64::field(point, &field, field_derived(part, axis));
                (f64::field(point, &field, part), [slope(0), slope(1), slope(2)])
            });
        }
    }
}

#[test]
fn equal_fields_are_one_by_identity() {
    let graph = Graph::new();
    let (x, field) = (graph.input("x"), wave("wave"));
    let one = Expr::field([x, x, x], &field, 0);
    assert!(one == Expr::field([x, x, x], &field.clone(), 0));
    assert!(one != Expr::field([x, x, x], &wave("wave"), 0), "another field, though it gives the same numbers");
    assert!(one != Expr::field([x, x, x], &field, 1));
    // A copy of the graph keeps the identity.
    let copy = graph.clone();
    let there = copy.expr(copy.input_id(0));
    let before = copy.len();
    assert_eq!(copy.id(Expr::field([there; 3], &field, 0)), graph.id(one));
    assert_eq!(copy.len(), before);
}

#[test]
fn numbers_fold_and_missing_variables_vanish() {
    let graph = Graph::new();
    let (x, y, z) = (graph.input("x"), graph.input("y"), graph.input("z"));
    let (wave, hill): (_, Arc<dyn Field>) = (wave("wave"), Arc::new(Hill));
    let n = |x: f64| Expr::Const(x);
    assert_eq!(Expr::field([n(0.3), n(0.2), n(0.1)], &wave, 7).value(), Some(f64::field([0.3, 0.2, 0.1], &wave, 7)));
    let flat = Expr::field([x, y, z], &hill, 0);
    assert!(flat == Expr::field([x, y, n(5.0)], &hill, 0));
    assert!(Expr::field([x, y, z], &hill, field_part(0, 0, 1)).is(0.0));
    assert!(Expr::field([x, y, z], &hill, field_part(1, 0, 1)).is(0.0));
    let flat = graph.id(flat);
    let wrt: Vec<NodeId> = (0..3).map(|i| graph.input_id(i)).collect();
    let gradient: Vec<NodeId> = graph.gradient(flat, &wrt).into_iter().map(|e| graph.id(e)).collect();
    assert_eq!(graph.eval(&gradient, &[3.0, 5.0, 7.0]), [30.0, 9.0, 0.0]);
    assert_eq!(graph.depends(&[flat], |i| i == 2), [false]);
    assert_eq!(graph.depends(&[flat], |i| i == 1), [true]);
    let known = graph.substitute(&[flat], |i| Some(n([3.0, 5.0, 7.0][i])));
    assert_eq!(known[0].value(), Some(45.0));
    let target = Graph::new();
    let w = target.input("w");
    let copied = graph.rebuild(&[flat], &target, |i| if i == 0 { w } else { n(5.0) });
    assert_eq!(target.eval(&[target.id(copied[0])], &[2.0]), [20.0]);
}

#[test]
fn a_fourth_derivative_is_refused() {
    let graph = Graph::new();
    let (x, y) = (graph.input("x"), graph.input("y"));
    let field = wave("road");
    let mut e = graph.id(x * Expr::field([x, y, x * y], &field, 0));
    for order in 0..3 {
        assert!(graph.beyond_fields(&[e]).is_none(), "order {order}");
        assert!(graph.eval(&[e], &[0.3, 0.4])[0].is_finite());
        e = graph.id(graph.tangent(&[e], |i| (i == 0).then_some(Expr::Const(1.0)))[0]);
    }
    assert!(graph.beyond_fields(&[e]).is_none());
    let fourth = graph.id(graph.tangent(&[e], |i| (i == 0).then_some(Expr::Const(1.0)))[0]);
    assert_eq!(graph.beyond_fields(&[fourth]).expect("one").name(), "road");
    assert!(graph.eval(&[fourth], &[0.3, 0.4])[0].is_nan());
    // It stays what it is when it is derived or rebuilt.
    let fifth = graph.id(graph.tangent(&[fourth], |i| (i == 0).then_some(Expr::Const(1.0)))[0]);
    assert!(graph.beyond_fields(&[fifth]).is_some());
    let moved = graph.substitute(&[fourth], |i| (i == 0).then_some(y))[0];
    assert!(graph.beyond_fields(&[graph.id(moved)]).is_some());
    assert!(graph.eval(&[graph.id(moved)], &[0.3, 0.4])[0].is_nan());

    let third = field_part(1, 1, 1);
    let dual = Dual::field([Dual::new(0.3, 1.0), Dual::constant(0.2), Dual::constant(0.1)], &field, third);
    assert!(dual.value.is_finite() && dual.dot.is_nan());
    assert_eq!(Interval::field([Interval::constant(1.0); 3], &field, FIELD_BEYOND), Interval::WHOLE);
}

#[test]
fn printed_fields_are_declared_and_told_apart() {
    let graph = Graph::new();
    let (x, y) = (graph.input("x"), graph.input("y"));
    let (one, two, hill): (_, _, Arc<dyn Field>) = (wave("road 1"), wave("road 1"), Arc::new(Hill));
    let e = Expr::field([x, y, x], &one, 0) + Expr::field([x, y, x], &two, 5) * Expr::field([x, y, y], &hill, 1);
    let id = graph.id(e);
    let text = c_file(&graph, "f", &[id], &[]);
    assert!(text.contains("extern double headland_field_road_1(double x, double y, double z, int part);"), "{text}");
    assert!(text.contains("extern double headland_field_road_1_2(double"), "{text}");
    let sum = "headland_field_road_1(x_, y_, x_, 0) + headland_field_road_1_2(x_, y_, x_, 5)*headland_field_hill(x_, y_, 0.0, 1)";
    assert!(text.contains(sum), "{text}");
    let hill = graph.id(Expr::field([x, y, y], &hill, field_part(1, 1, 0)));
    assert_eq!(expression(&graph, Style::Text, hill), "hill'xy(x, y)");
    let latex = expression(&graph, Style::Latex, hill);
    assert_eq!(latex, r"\partial_{xy}\,\mathit{hill}\left(x, y\right)");
    // Without fields nothing is declared.
    assert!(!c_file(&graph, "f", &[graph.id(x * y)], &[]).contains("extern"));
}

/// A field of time is left to the error control, what stands beside it is not.
#[test]
fn timeline_takes_fields_for_smooth() {
    let graph = Graph::new();
    let (t, field) = (graph.input("t"), wave("road"));
    let n = |x: f64| Expr::Const(x);
    let late = Expr::select(t - n(3.0), t, n(1.0));
    let height = Expr::field([late, n(0.5), n(0.0)], &field, 0);
    let roots = [height, height.abs(), Expr::field([n(1.0), n(2.0), n(0.0)], &field, 0) * t].map(|e| graph.id(e));
    let found = timeline(&graph, &roots, 0, &[0.0], |_| false, 0.0, 10.0);
    assert_eq!(found.breakpoints, [3.0]);
    assert!(found.windows.is_empty(), "{:?}", found.windows);
}
