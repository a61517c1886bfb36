//! Fields in compiled functions: one evaluation a point, the bits of the graph, derivatives.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use headland_code::suite::{Random, check, check_many};
use headland_code::{Evaluator, Function, Jacobian, Lanes8, TapeFunction};
use headland_expr::{Expr, FIELD_PARTS, Field, Graph, NodeId, Scalar, Wave, field_part};

fn wave() -> Wave {
    Wave { name: "wave".into(), rate: [0.7, -1.1, 0.4], phase: [0.1, 1.3, -0.6] }
}

/// A wave that counts how often it is asked, and notes the highest order.
#[derive(Debug)]
struct Counted {
    wave: Wave,
    times: AtomicUsize,
    highest: AtomicUsize,
}

impl Counted {
    fn new() -> Arc<Self> {
        Arc::new(Self { wave: wave(), times: AtomicUsize::new(0), highest: AtomicUsize::new(0) })
    }
    /// Evaluations since the last question, and the highest order among them.
    fn taken(&self) -> (usize, usize) {
        (self.times.swap(0, Relaxed), self.highest.swap(0, Relaxed))
    }
}

impl Field for Counted {
    fn name(&self) -> &str {
        self.wave.name()
    }
    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        assert_eq!(out.len(), FIELD_PARTS[order]);
        self.times.fetch_add(1, Relaxed);
        self.highest.fetch_max(order, Relaxed);
        self.wave.eval(point, order, out);
    }
}

/// Value, gradient and second derivatives of a field at a point that depends on the inputs.
fn query<'g>(graph: &'g Graph, field: &Arc<dyn Field>) -> (Vec<NodeId>, [Expr<'g>; 3]) {
    let [a, b, c] = ["a", "b", "c"].map(|name| graph.input(name));
    let point = [a * b.cos(), a * b.sin(), c];
    let nodes = (0..FIELD_PARTS[2]).map(|part| graph.id(Expr::field(point, field, part) * c)).collect();
    (nodes, [a, b, c])
}

#[test]
fn a_field_is_evaluated_once_a_point() {
    let counted = Counted::new();
    let field: Arc<dyn Field> = counted.clone();
    let graph = Graph::new();
    let (nodes, _) = query(&graph, &field);
    let f = TapeFunction::compile(&graph, &nodes);
    f.evaluator().eval(&[0.4, 0.2, -0.7]);
    assert_eq!(counted.taken(), (1, 2));

    let rows: Vec<Vec<f64>> = (0..3).map(|i| (0..21).map(|k| 0.1 * f64::from(k + i)).collect()).collect();
    f.evaluator().eval_many(&[&rows[0], &rows[1], &rows[2]]); // two groups of eight, one of four, one point
    assert_eq!(counted.taken(), (21, 2));

    // Only what is needed: the value alone, without any derivative.
    f.keep_outputs(&[0]).evaluator().eval(&[0.4, 0.2, -0.7]);
    assert_eq!(counted.taken(), (1, 0));

    let wrt: Vec<NodeId> = (0..3).map(|i| graph.input_id(i)).collect();
    Jacobian::<TapeFunction>::new(&graph, &nodes, &wrt).function().evaluator().eval(&[0.4, 0.2, -0.7]);
    assert_eq!(counted.taken(), (1, 3));

    // Two points, two evaluations; the same point twice is one.
    let (a, c) = (graph.input("d"), graph.input("e"));
    let at = |x, part| Expr::field([x, c, c], &field, part).sin();
    let sum = graph.id(at(a, 0) + at(a, 3) + at(a * c, 0));
    TapeFunction::compile(&graph, &[sum]).evaluator().eval(&[0.0, 0.0, 0.0, 0.3, 0.4]);
    assert_eq!(counted.taken(), (2, 1));
}

#[test]
fn parts_have_the_bits_of_the_graph() {
    let graph = Graph::new();
    let field: Arc<dyn Field> = Arc::new(wave());
    let (mut nodes, [a, _, c]) = query(&graph, &field);
    // Parts that are outputs themselves, one of them twice; a field of a field; a part that nothing else has.
    let point = [a, c, Expr::field([c, a, a], &field, 1)];
    nodes.extend([0, 4, 4, 9].map(|part| graph.id(Expr::field(point, &field, part))));
    nodes.push(graph.id(Expr::field([a, a, a], &field, field_part(1, 1, 1))));
    let mut random = Random(7);
    let points: Vec<Vec<f64>> = (0..29).map(|_| (0..3).map(|_| random.uniform(-2.0, 2.0)).collect()).collect();
    let f = TapeFunction::compile(&graph, &nodes);
    check(&f, &graph, &nodes, &points);
    check_many::<TapeFunction>(&mut f.evaluator(), &graph, &nodes, &points);

    // With an input known the field stays, with all known it folds.
    let known = f.bind(&[(1, points[0][1]), (2, points[0][2])]);
    assert_eq!(known.evaluator().eval(&points[0]), f.evaluator().eval(&points[0]));
    let folded = f.bind(&[(0, points[0][0]), (1, points[0][1]), (2, points[0][2])]);
    assert_eq!((folded.operations(), folded.instructions()), (0, 0));
    assert_eq!(folded.evaluator().eval(&[0.0; 3]), f.evaluator().eval(&points[0]));
}

#[test]
fn many_fields_need_long_rows() {
    let graph = Graph::new();
    let x = graph.input("x");
    let field: Arc<dyn Field> = Arc::new(wave());
    let parts = |k: i32| Expr::field([x, x * Expr::Const(1e-3 * f64::from(k)), x], &field, field_part(0, 1, 2));
    let nodes: Vec<NodeId> = (0..4000).map(|k| graph.id(parts(k))).collect();
    let f = TapeFunction::compile(&graph, &nodes);
    assert!(f.slots() > 1 << 16, "{}", f.slots());
    check(&f, &graph, &nodes, &[vec![0.3]]);
}

#[test]
fn jacobian_agrees_with_differences() {
    let graph = Graph::new();
    let field: Arc<dyn Field> = Arc::new(wave());
    let (nodes, _) = query(&graph, &field);
    let wrt: Vec<NodeId> = (0..3).map(|i| graph.input_id(i)).collect();
    let jacobian = Jacobian::<TapeFunction>::new(&graph, &nodes, &wrt);
    let (x, h) = ([0.8, 0.4, -0.7], 1e-5);
    let dense = jacobian.dense(jacobian.function().evaluator().eval(&x));
    let mut f = TapeFunction::compile(&graph, &nodes).evaluator();
    for j in 0..3 {
        let mut at = |h: f64| {
            let mut moved = x;
            moved[j] += h;
            f.eval(&moved).to_vec()
        };
        let (hi, lo) = (at(h), at(-h));
        for i in 0..nodes.len() {
            let difference = (hi[i] - lo[i]) / (2.0 * h);
            let exact = dense[i + nodes.len() * j];
            assert!((exact - difference).abs() < 1e-9, "{i} {j}: {exact} {difference}");
        }
    }
}

#[test]
fn lanes_ask_for_each_point_by_itself() {
    let field: Arc<dyn Field> = Arc::new(wave());
    let x: [[f64; 8]; 3] = std::array::from_fn(|i| std::array::from_fn(|k| 0.2 * (i * 8 + k) as f64));
    let point = x.map(|row| <Lanes8 as headland_code::Lanes>::load(&row));
    for part in 0..FIELD_PARTS[3] {
        let mut row = [0.0; 8];
        headland_code::Lanes::store(Lanes8::field(point, &field, part), &mut row);
        for (k, y) in row.into_iter().enumerate() {
            assert_eq!(y, f64::field([x[0][k], x[1][k], x[2][k]], &field, part));
        }
    }
}
