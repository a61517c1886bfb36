//! Chains of a million operations, and doublings that would be endless if they were written out.

use headland_expr::print::{ListingOptions, Style, c_function, expression, listing, text};
use headland_expr::timeline::timeline;
use headland_expr::{Expr, Graph, Scalar};

const DEEP: usize = 1_000_000;

/// `DEEP` operations on a small stack: nothing may recurse.
#[test]
fn a_million_operations_deep() {
    let work = || {
        let graph = Graph::new();
        let (x, t) = (graph.input("x"), graph.input("t"));
        let mut e = x;
        for k in 0..DEEP / 2 {
            e = if k % 3 == 0 { e.sin() + t } else { (e * t).cos() };
        }
        let root = graph.id(e);
        let y = graph.eval(&[root], &[0.3, 0.7])[0];
        assert!(y.is_finite());
        assert!(text(&graph, root).len() < 400);
        let dot = graph.tangent(&[root], |i| (i == 0).then_some(Expr::Const(1.0)));
        assert!(dot[0].value().is_none());
        let gradient = graph.gradient(root, &[graph.input_id(1)]);
        assert!(gradient[0].value().is_none());
        let other = Graph::new();
        let (u, v) = (other.input("u"), other.input("v"));
        let copy = graph.rebuild(&[root], &other, |i| [u, v][i])[0];
        assert_eq!(other.eval(&[other.id(copy)], &[0.3, 0.7])[0], y);
        let fixed = graph.substitute(&[root], |i| (i == 1).then_some(Expr::Const(0.7)))[0];
        assert!((graph.eval(&[graph.id(fixed)], &[0.3, 0.7])[0] - y).abs() < 1e-9);
        let roots = [("y".to_string(), root)];
        for style in [Style::Text, Style::Latex, Style::C] {
            let lines = listing(&graph, style, &roots, &[], &ListingOptions::of(style)).lines;
            assert!(lines.len() > 1000 && lines.iter().all(|(_, e)| e.len() < 10_000));
        }
        assert!(c_function(&graph, "f", &[root], &[]).len() > DEEP);
        assert!(timeline(&graph, &[root], 1, &[0.3, 0.0], |_| false, 0.0, 1.0).breakpoints.is_empty());
    };
    std::thread::Builder::new().stack_size(512 * 1024).spawn(work).unwrap().join().unwrap();
}

/// One expression, nested as deeply as it comes.
#[test]
fn one_long_expression() {
    let graph = Graph::new();
    let (x, y) = (graph.input("x"), graph.input("y"));
    let (mut nested, mut sum, mut quotient) = (x, x, x);
    for k in 0..5_000 {
        nested = nested.sin();
        sum = sum + y * Expr::Const(f64::from(k));
        quotient = (quotient + y) / x;
    }
    for style in [Style::Text, Style::Latex, Style::C] {
        for e in [nested, sum, quotient] {
            assert!(expression(&graph, style, graph.id(e)).len() > 15_000);
        }
    }
}

#[test]
fn shared_operations_are_written_once() {
    let graph = Graph::new();
    let (x, y) = (graph.input("x"), graph.input("y"));
    let mut e = x;
    for _ in 0..2000 {
        e = e * (e + y).sin() - e;
        e = -(e.powi(2) + e);
    }
    let roots = [("out".to_string(), graph.id(e))];
    for style in [Style::Text, Style::Latex, Style::C] {
        let lines = listing(&graph, style, &roots, &[], &ListingOptions::of(style)).lines;
        assert!(lines.iter().map(|(_, e)| e.len()).sum::<usize>() < 1_000_000);
    }
}
