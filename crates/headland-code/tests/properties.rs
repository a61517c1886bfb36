//! Properties over random graphs: bits, folding, derivatives.

use headland_code::suite::{Mix, Random, RandomGraph, check, check_many, same_bits};
use headland_code::{Evaluator, Function, Jacobian, TapeFunction};
use headland_expr::{Dual, Graph, NodeId, Scalar};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn mixes() -> impl Strategy<Value = Mix> {
    prop_oneof![Just(Mix::All), Just(Mix::Smooth), Just(Mix::Arithmetic)]
}

/// `J` by duals, a column at a time, dense and column by column.
fn jacobian_by_duals(g: &RandomGraph, x: &[f64]) -> Vec<f64> {
    let mut dense = Vec::new();
    for j in 0..x.len() {
        let seed = |(i, &x): (usize, &f64)| Dual::new(x, if i == j { 1.0 } else { 0.0 });
        let x: Vec<Dual<f64>> = x.iter().enumerate().map(seed).collect();
        dense.extend(g.graph.eval(&g.outputs, &x).iter().map(|y| y.dot));
    }
    dense
}

/// The same cases every time.
fn fixed() -> ProptestConfig {
    ProptestConfig { cases: 200, rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(fixed())]

    #[test]
    fn tape_and_lanes_have_the_bits_of_the_graph(
        size in 1..1500usize, seed: u64, mix in mixes(), inputs in 1..12usize, points in 1..20usize,
    ) {
        let g = RandomGraph::new(seed, mix, inputs, size);
        let f = TapeFunction::compile(&g.graph, &g.outputs);
        let mut random = Random(seed);
        let points: Vec<Vec<f64>> = (0..points).map(|_| g.near(&mut random)).collect();
        check(&f, &g.graph, &g.outputs, &points);
        check_many::<TapeFunction>(&mut f.evaluator(), &g.graph, &g.outputs, &points);
    }

    #[test]
    fn jacobian_agrees_with_duals(size in 1..60usize, seed: u64, mix in mixes(), inputs in 1..6usize) {
        let g = RandomGraph::new(seed, mix, inputs, size);
        let x = g.near(&mut Random(seed));
        let expected = jacobian_by_duals(&g, &x);
        let wrt: Vec<NodeId> = (0..inputs).map(|i| g.graph.input_id(i)).collect();
        let jacobian = Jacobian::<TapeFunction>::new(&g.graph, &g.outputs, &wrt);
        let mut evaluator = jacobian.function().evaluator();
        let dense = jacobian.dense(evaluator.eval(&x));
        prop_assert_eq!(dense.len(), expected.len());
        let largest = expected.iter().fold(1.0, |a: f64, b| a.max(b.abs()));
        for (k, (d, e)) in dense.iter().zip(&expected).enumerate() {
            // A dual number multiplies by zero what the expression leaves out: 0 · ∞ says nothing.
            prop_assert!(e.is_nan() || (d - e).abs() <= 1e-12 * largest || d == e, "entry {}: {:e} and not {:e}", k, d, e);
        }
    }

    #[test]
    fn keeping_then_binding_is_binding_then_keeping(size in 10..300usize, seed: u64) {
        let g = RandomGraph::new(seed, Mix::All, 4, size);
        let f = TapeFunction::compile(&g.graph, &g.outputs);
        let x = g.near(&mut Random(seed));
        let (known, keep) = ([(1, x[1])], [g.outputs.len() - 1]);
        let a = f.keep_outputs(&keep).bind(&known).evaluator().eval(&x)[0];
        let b = f.bind(&known).keep_outputs(&keep).evaluator().eval(&x)[0];
        prop_assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0) || same_bits(a, b), "{} {}", a, b);
    }
}

#[test]
fn jacobian_columns_follow_the_inputs_asked_for() {
    let graph = Graph::new();
    let [x, y, z] = ["x", "y", "z"].map(|name| graph.input(name));
    let outputs = [x * y, z.sin(), y.powi(3)].map(|e| graph.id(e));
    let wrt = [z, y].map(|e| graph.id(e));
    let jacobian = Jacobian::<TapeFunction>::new(&graph, &outputs, &wrt);
    assert_eq!((jacobian.rows(), jacobian.columns()), (3, 2));
    assert_eq!(jacobian.col_ptr(), [0, 1, 3]);
    assert_eq!(jacobian.row_index(), [1, 0, 2]);
    let values = [0.0f64.cos(), 2.0, 3.0 * 25.0];
    assert_eq!(jacobian.function().evaluator().eval(&[2.0, 5.0, 0.0]), values);
    assert_eq!(jacobian.dense(&values), [0.0, 1.0, 0.0, 2.0, 0.0, 75.0]);
    let bound = jacobian.bind(&[(0, 2.0)]);
    assert_eq!(bound.function().evaluator().eval(&[f64::NAN, 5.0, 0.0]), values);
    assert_eq!(Jacobian::<TapeFunction>::new(&graph, &outputs, &[]).columns(), 0);
    assert_eq!(Jacobian::<TapeFunction>::new(&graph, &[], &wrt).col_ptr(), [0, 0, 0]);
}

#[test]
#[should_panic(expected = "with respect to inputs")]
fn jacobian_is_with_respect_to_inputs() {
    let graph = Graph::new();
    let sum = graph.input("x") + graph.input("y");
    let sum = graph.id(sum);
    Jacobian::<TapeFunction>::new(&graph, &[sum], &[sum]);
}

/// Powers share their squares, sine and cosine are one, dying operands give their slots away.
#[test]
fn tape_is_short_and_narrow() {
    let graph = Graph::new();
    let x = graph.input("x");
    let powers = [2, 3, 4, 7, -4].map(|n| graph.id(x.powi(n)));
    // x², x⁴, x³, x³x⁴, 1 / x⁴
    assert_eq!(TapeFunction::compile(&graph, &powers).instructions(), 5);
    let (sin, cos) = x.sin_cos();
    let rotation = TapeFunction::compile(&graph, &[graph.id(sin), graph.id(cos)]);
    assert_eq!((rotation.instructions(), rotation.operations()), (1, 2));

    let y = graph.input("y");
    let chain = (0..1000).fold(x, |e, _| (e * y + x).sin());
    assert_eq!(TapeFunction::compile(&graph, &[graph.id(chain)]).slots(), 4); // x, y, the output, one temporary
}
