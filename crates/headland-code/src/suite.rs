//! What every back end must pass, and the random graphs it is tested and timed with.
//!
//! ```
//! mod tape {
//!     headland_code::evaluator_tests!(headland_code::TapeFunction);
//! }
//! ```

use std::sync::{Arc, LazyLock};

use headland_expr::ops::{OPS, apply};
use headland_expr::{Expr, Field, Graph, NodeId, Op, Scalar, Spline, Wave};

use crate::function::{Evaluator, Function};

/// One `#[test]` for each function of [`suite`](crate::suite); put it into a module of its own for each back end.
#[macro_export]
macro_rules! evaluator_tests {
    ($Function:ty) => {
        $crate::evaluator_tests!(@each $Function:
            every_operator_agrees, random_graphs_agree, many_points_agree, integer_powers_agree,
            outputs_may_be_anything, nothing_is_a_function, inputs_may_be_missing, dropped_outputs_cost_nothing,
            known_inputs_fold_away, deep_chains_work, many_live_values_work, threads_share_it);
        $crate::evaluator_tests!(@panics $Function: wrong_length_panics, ragged_points_panic, unknown_input_panics);
    };
    (@each $Function:ty: $($name:ident),*) => { $(
        #[test]
        fn $name() {
            $crate::suite::$name::<$Function>();
        }
    )* };
    (@panics $Function:ty: $($name:ident),*) => { $(
        #[test]
        #[should_panic]
        fn $name() {
            $crate::suite::$name::<$Function>();
        }
    )* };
}

/// A reproducible random sequence (SplitMix64).
///
/// # References
/// Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    /// A number in `[low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
    /// A point with coordinates in `[0.5, 1.5)`, around which a [`RandomGraph`] is tame.
    pub fn point(&mut self, inputs: usize) -> Vec<f64> {
        (0..inputs).map(|_| self.uniform(0.5, 1.5)).collect()
    }
}

/// Which operators a random graph has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mix {
    /// Sums, differences, products; a few quotients.
    Arithmetic,
    /// Those with derivatives everywhere: arithmetic, powers, roots, exponentials, trigonometry, a table.
    Smooth,
    /// Every operator of the table, powers and a table.
    All,
}

/// A random graph whose values stay of order one near its centre.
#[derive(Debug)]
pub struct RandomGraph {
    /// The graph; some of its nodes are dead.
    pub graph: Graph,
    /// Every node that was made and that no other uses.
    pub outputs: Vec<NodeId>,
    /// The inputs at which every value is finite and neither large nor small.
    pub centre: Vec<f64>,
}

impl RandomGraph {
    /// A graph of about that many operations, from at least one input; the same for the same arguments.
    pub fn new(seed: u64, mix: Mix, inputs: usize, operations: usize) -> Self {
        let graph = Graph::new();
        let centre: Vec<f64> = (0..inputs).map(|i| 0.7 + 0.6 * i as f64 / inputs as f64).collect();
        let outputs = {
            let mut made: Vec<(Expr<'_>, f64)> =
                centre.iter().enumerate().map(|(i, &x)| (graph.input(&format!("x{i}")), x)).collect();
            let mut unused: Vec<usize> = (0..inputs).collect();
            let mut random = Random(seed);
            let mut tries = 0;
            while made.len() < inputs + operations && tries < 100 * (operations + 1) {
                tries += 1;
                let operands = [0, 1, 2].map(|k| pick(&mut random, made.len(), if k == 0 { &unused } else { &[] }));
                let value = operands.map(|i| made[i].1);
                let mut expr = operands.map(|i| made[i].0);
                let mut number = value;
                if random.below(8) == 0 {
                    number[1] = random.uniform(-2.0, 2.0);
                    expr[1] = Expr::Const(number[1]);
                }
                let before = graph.len();
                let (e, v) = operation(&mut random, mix, expr, number);
                if graph.len() > before && e.value().is_none() && (0.01..100.0).contains(&v.abs()) {
                    unused.retain(|i| *i != operands[0]);
                    unused.push(made.len());
                    made.push((e, v));
                    if unused.len() > 60 {
                        unused.remove(0);
                    }
                }
            }
            let ids: Vec<NodeId> = made[inputs..].iter().map(|(e, _)| graph.id(*e)).collect();
            roots(&graph, &ids)
        };
        Self { graph, outputs, centre }
    }

    /// A point within 5 % of the centre.
    pub fn near(&self, random: &mut Random) -> Vec<f64> {
        self.centre.iter().map(|x| x * random.uniform(0.95, 1.05)).collect()
    }
}

/// Mostly something unused, else something recent, at times anything.
fn pick(random: &mut Random, made: usize, unused: &[usize]) -> usize {
    match random.below(8) {
        0 => random.below(made),
        1..6 if !unused.is_empty() => unused[random.below(unused.len())],
        _ => made - 1 - random.below(made.min(60)),
    }
}

/// A random operation as an expression and its value.
fn operation<'g>(random: &mut Random, mix: Mix, e: [Expr<'g>; 3], x: [f64; 3]) -> (Expr<'g>, f64) {
    const ARITHMETIC: [Op; 10] =
        [Op::Add, Op::Add, Op::Add, Op::Sub, Op::Sub, Op::Mul, Op::Mul, Op::Mul, Op::Mul, Op::Div];
    const CORNERS: [Op; 5] = [Op::Abs, Op::Sign, Op::Min, Op::Max, Op::Select];
    let op = if mix == Mix::Arithmetic || random.below(2) == 0 {
        ARITHMETIC[random.below(ARITHMETIC.len())]
    } else {
        match random.below(OPS.len() + 4) {
            0 => {
                let n = random.below(11) as i32 - 4;
                return (e[0].powi(n), Scalar::powi(x[0], n));
            }
            1 => {
                let table = Spline::new("table", &[-2.0, 0.0, 0.5, 1.5, 3.0], &[0.3, -0.2, 0.7, 1.1, 0.4]);
                let (table, order) = (table.expect("a valid table"), random.below(2) as u8);
                return (e[0].spline(&table, order), table.eval(x[0], order));
            }
            2 => {
                let ((sin, cos), (s, c)) = (e[0].sin_cos(), x[0].sin_cos());
                return (sin * e[1] + cos, s * x[1] + c);
            }
            3 => {
                // Two parts at one point, a derivative left for a Jacobian.
                let (field, parts) = (wave(), [random.below(10), random.below(10)]);
                let expr = parts.map(|part| Expr::field(e, &field, part));
                let number = parts.map(|part| f64::field(x, &field, part));
                return (expr[0] + expr[1], number[0] + number[1]);
            }
            row => OPS[row - 4].op,
        }
    };
    if mix != Mix::All && CORNERS.contains(&op) {
        return (e[0] + e[1], x[0] + x[1]);
    }
    (apply(op, e[0], e[1], e[2]), apply(op, x[0], x[1], x[2]))
}

/// A field, the same one always.
fn wave() -> Arc<dyn Field> {
    static WAVE: LazyLock<Arc<dyn Field>> =
        LazyLock::new(|| Arc::new(Wave { name: "wave".into(), rate: [0.7, -1.1, 0.4], phase: [0.1, 1.3, -0.6] }));
    WAVE.clone()
}

/// Those that no other needs.
fn roots(graph: &Graph, ids: &[NodeId]) -> Vec<NodeId> {
    let mut used = vec![false; graph.len()];
    for &id in ids {
        // Simplification may have put nodes between, so follow the operands down to what is known.
        let mut below: Vec<NodeId> = graph.node(id).operands().collect();
        while let Some(operand) = below.pop() {
            if !std::mem::replace(&mut used[operand.index()], true) {
                below.extend(graph.node(operand).operands());
            }
        }
    }
    let mut roots: Vec<NodeId> = ids.iter().copied().filter(|id| !used[id.index()]).collect();
    roots.dedup();
    roots
}

/// Equal to the last bit; one NaN is as good as another.
pub fn same_bits(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Checks `f` against [`Graph::eval`] at the given points, one by one.
///
/// # Panics
/// If a bit differs.
pub fn check<F: Function>(f: &F, graph: &Graph, outputs: &[NodeId], points: &[Vec<f64>]) {
    let mut evaluator = f.evaluator();
    for x in points {
        let expected = graph.eval(outputs, x);
        let y = evaluator.eval(x);
        assert_eq!(y.len(), expected.len());
        for (k, (&y, &e)) in y.iter().zip(&expected).enumerate() {
            assert!(same_bits(y, e), "output {k} at {x:?}: {y:e} and not {e:e}");
        }
    }
}

/// Checks `eval_many` of `f` against [`Graph::eval`].
///
/// # Panics
/// If a bit differs.
pub fn check_many<F: Function>(evaluator: &mut F::Evaluator, graph: &Graph, outputs: &[NodeId], points: &[Vec<f64>]) {
    let inputs = graph.input_count();
    let columns: Vec<Vec<f64>> = (0..inputs).map(|i| points.iter().map(|x| x[i]).collect()).collect();
    let x: Vec<&[f64]> = columns.iter().map(|column| column.as_slice()).collect();
    let y = evaluator.eval_many(&x);
    assert_eq!(y.len(), outputs.len());
    assert!(y.iter().all(|row| row.len() == points.len()));
    for (p, x) in points.iter().enumerate() {
        for (k, e) in graph.eval(outputs, x).into_iter().enumerate() {
            assert!(same_bits(y[k][p], e), "output {k}, point {p} of {}: {:e} and not {e:e}", points.len(), y[k][p]);
        }
    }
}

/// Every row of the operator table, at its samples and at zeros, infinities and NaN.
pub fn every_operator_agrees<F: Function>() {
    const SPECIAL: [f64; 8] = [0.0, -0.0, 1.0, -2.5, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-310];
    for row in OPS {
        let graph = Graph::new();
        let [a, b, c] = ["a", "b", "c"].map(|name| graph.input(name));
        let outputs = [graph.id(apply(row.op, a, b, c)), graph.id(apply(row.op, b, c, a))];
        let mut points: Vec<Vec<f64>> = row.samples.iter().map(|x| x.to_vec()).collect();
        for i in 0..512 {
            points.push(vec![SPECIAL[i % 8], SPECIAL[i / 8 % 8], SPECIAL[i / 64]]);
        }
        let f = F::compile(&graph, &outputs);
        check(&f, &graph, &outputs, &points);
        check_many::<F>(&mut f.evaluator(), &graph, &outputs, &points);
    }
}

/// Random graphs of every size and mix.
pub fn random_graphs_agree<F: Function>() {
    for (seed, size) in [1, 2, 3, 5, 8, 13, 30, 100, 300, 700, 3000].into_iter().cycle().take(66).enumerate() {
        let mix = [Mix::All, Mix::Smooth, Mix::Arithmetic][seed % 3];
        let g = RandomGraph::new(seed as u64, mix, 1 + seed % 7, size);
        let f = F::compile(&g.graph, &g.outputs);
        let mut random = Random(seed as u64);
        let points: Vec<Vec<f64>> =
            (0..5).map(|i| if i < 3 { g.near(&mut random) } else { random.point(g.centre.len()) }).collect();
        check(&f, &g.graph, &g.outputs, &points);
    }
}

/// Any number of points, and one evaluator for all of them.
pub fn many_points_agree<F: Function>() {
    let g = RandomGraph::new(7, Mix::All, 5, 200);
    let f = F::compile(&g.graph, &g.outputs);
    let mut evaluator = f.evaluator();
    let mut random = Random(1);
    for points in (0..30).chain([100, 3, 1, 0, 17]) {
        let points: Vec<Vec<f64>> = (0..points).map(|_| g.near(&mut random)).collect();
        check_many::<F>(&mut evaluator, &g.graph, &g.outputs, &points);
    }
}

/// Integer powers multiply in one order, alone and with factors in common.
pub fn integer_powers_agree<F: Function>() {
    let graph = Graph::new();
    let x = graph.input("x");
    let outputs: Vec<NodeId> =
        (-40..=40).chain([-1024, -255, 1000, i32::MAX, i32::MIN]).map(|n| graph.id(x.powi(n))).collect();
    let points: Vec<Vec<f64>> = [0.0, -0.0, 0.3, 0.999, -1.1, 7.3, f64::INFINITY, f64::NAN].map(|x| vec![x]).to_vec();
    let f = F::compile(&graph, &outputs);
    check(&f, &graph, &outputs, &points);
    check_many::<F>(&mut f.evaluator(), &graph, &outputs, &points);
    for output in outputs {
        check(&F::compile(&graph, &[output]), &graph, &[output], &points);
    }
}

/// An input, a constant, the same twice, the operand of another.
pub fn outputs_may_be_anything<F: Function>() {
    let graph = Graph::new();
    let (x, y) = (graph.input("x"), graph.input("y"));
    let (sum, c) = (x + y, Expr::Const(2.5));
    let (sin, cos) = sum.sin_cos();
    let outputs: Vec<NodeId> =
        [x, c, sum, sum, sum * c, x, c, sin, cos, sin, y, sum.powi(3), sum.powi(2), Expr::Const(0.0)]
            .map(|e| graph.id(e))
            .to_vec();
    let f = F::compile(&graph, &outputs);
    assert_eq!((f.inputs(), f.outputs(), f.operations()), (2, outputs.len(), graph.operations(&outputs)));
    let points: Vec<Vec<f64>> = (0..13).map(|i| vec![f64::from(i), 0.5 - f64::from(i)]).collect();
    check(&f, &graph, &outputs, &points);
    check_many::<F>(&mut f.evaluator(), &graph, &outputs, &points);
    for &output in &outputs {
        check(&F::compile(&graph, &[output]), &graph, &[output], &points);
    }
}

/// No outputs; no inputs; neither.
pub fn nothing_is_a_function<F: Function>() {
    let empty = F::compile(&Graph::new(), &[]);
    assert_eq!((empty.inputs(), empty.outputs(), empty.operations()), (0, 0, 0));
    assert!(empty.evaluator().eval(&[]).is_empty());
    assert!(empty.evaluator().eval_many(&[]).is_empty());

    let graph = Graph::new();
    let number = graph.id(Expr::Const(4.0));
    let constant = F::compile(&graph, &[number]);
    assert_eq!(constant.evaluator().eval(&[]), [4.0]);
    assert_eq!(constant.evaluator().eval_many(&[]), [vec![4.0]]);

    graph.input("x");
    let deaf = F::compile(&graph, &[]);
    assert_eq!((deaf.inputs(), deaf.outputs()), (1, 0));
    assert!(deaf.evaluator().eval(&[1.0]).is_empty());
    assert!(deaf.evaluator().eval_many(&[&[1.0; 9]]).is_empty());
    assert_eq!(constant.keep_outputs(&[]).outputs(), 0);
}

/// Inputs that nothing needs count, and are ignored.
pub fn inputs_may_be_missing<F: Function>() {
    let graph = Graph::new();
    let x: Vec<Expr<'_>> = (0..10).map(|i| graph.input(&format!("x{i}"))).collect();
    let outputs = [graph.id(x[7] * x[2])];
    let f = F::compile(&graph, &outputs);
    let mut point = [f64::NAN; 10];
    (point[7], point[2]) = (3.0, 4.0);
    assert_eq!(f.inputs(), 10);
    assert_eq!(f.evaluator().eval(&point), [12.0]);
}

/// `keep_outputs` drops what only the others needed and changes no bit.
pub fn dropped_outputs_cost_nothing<F: Function>() {
    for seed in 0..10 {
        let g = RandomGraph::new(seed, Mix::All, 4, 400);
        let f = F::compile(&g.graph, &g.outputs);
        assert_eq!(f.operations(), g.graph.operations(&g.outputs));
        let n = g.outputs.len();
        for keep in [vec![0], vec![n - 1], vec![n / 2, 0, n / 2], vec![], (0..n).rev().collect()] {
            let ids: Vec<NodeId> = keep.iter().map(|&k| g.outputs[k]).collect();
            let kept = f.keep_outputs(&keep);
            assert_eq!((kept.inputs(), kept.outputs()), (4, keep.len()));
            assert_eq!(kept.operations(), g.graph.operations(&ids));
            check(&kept, &g.graph, &ids, &[g.near(&mut Random(seed))]);
        }
    }
}

/// `bind` leaves the numbering alone, folds, and changes values by rounding only.
pub fn known_inputs_fold_away<F: Function>() {
    for seed in 0..10 {
        let g = RandomGraph::new(seed, Mix::Smooth, 5, 40);
        let f = F::compile(&g.graph, &g.outputs);
        let x = g.near(&mut Random(seed));
        let expected = g.graph.eval(&g.outputs, &x);
        let bound = f.bind(&[(3, x[3]), (0, x[0])]);
        let all = f.bind(&(0..5).map(|i| (i, x[i])).collect::<Vec<_>>());
        assert_eq!((bound.inputs(), bound.outputs()), (5, f.outputs()));
        assert!(bound.operations() <= f.operations());
        assert_eq!(all.operations(), 0);
        let mut partly = x.clone();
        (partly[0], partly[3]) = (f64::NAN, f64::NAN);
        for (f, x) in [(bound, partly), (all, vec![f64::NAN; 5])] {
            for (y, e) in f.evaluator().eval(&x).iter().zip(&expected) {
                assert!((y - e).abs() <= 1e-9 * e.abs().max(1.0) || same_bits(*y, *e), "seed {seed}: {y} and not {e}");
            }
        }
    }
}

/// A million operations in a row: nothing recurses.
pub fn deep_chains_work<F: Function>() {
    let graph = Graph::new();
    let [x, a, b] = ["x", "a", "b"].map(|name| graph.input(name));
    let y = (0..500_000).fold(x, |y, _| y * a + b);
    let outputs = [graph.id(y)];
    let f = F::compile(&graph, &outputs);
    assert_eq!(f.operations(), 1_000_000);
    check(&f, &graph, &outputs, &[vec![1.0, 0.999, 0.3]]);
    assert_eq!(f.keep_outputs(&[0]).bind(&[(1, 0.5)]).operations(), 1_000_000);
}

/// More values alive at once than 16 bits can number.
pub fn many_live_values_work<F: Function>() {
    let graph = Graph::new();
    let (x, y) = (graph.input("x"), graph.input("y"));
    let values: Vec<Expr<'_>> = (0..70_000)
        .scan(x, |v, i| {
            *v = *v * y + Expr::Const(f64::from(i));
            Some(*v)
        })
        .collect();
    let sum = values.iter().rev().fold(x, |sum, v| sum * *v + y);
    let outputs = [graph.id(sum), graph.id(values[0])];
    check(&F::compile(&graph, &outputs), &graph, &outputs, &[vec![0.3, 1e-6]]);
    let all: Vec<NodeId> = values.iter().map(|v| graph.id(*v)).collect();
    check(&F::compile(&graph, &all), &graph, &all, &[vec![0.3, 0.9]]);
}

/// One function, several threads.
pub fn threads_share_it<F: Function>() {
    fn is_shared<T: Send + Sync + Clone>(_: &T) {}
    fn is_sent<T: Send>(_: &T) {}
    let g = RandomGraph::new(3, Mix::All, 3, 300);
    let f = F::compile(&g.graph, &g.outputs);
    is_shared(&f);
    is_sent(&f.evaluator());
    let points: Vec<Vec<f64>> = (0..4).map(|seed| g.near(&mut Random(seed))).collect();
    let expected: Vec<Vec<f64>> = points.iter().map(|x| g.graph.eval(&g.outputs, x)).collect();
    std::thread::scope(|scope| {
        for (x, expected) in points.iter().zip(&expected) {
            let f = &f;
            scope.spawn(move || {
                let mut evaluator = f.evaluator();
                for _ in 0..20 {
                    assert!(evaluator.eval(x).iter().zip(expected).all(|(&y, &e)| same_bits(y, e)));
                }
            });
        }
    });
}

fn product<F: Function>() -> F {
    let graph = Graph::new();
    let e = graph.input("x") * graph.input("y");
    F::compile(&graph, &[graph.id(e)])
}

/// Panics: one coordinate is missing.
pub fn wrong_length_panics<F: Function>() {
    product::<F>().evaluator().eval(&[1.0]);
}

/// Panics: the inputs have different numbers of points.
pub fn ragged_points_panic<F: Function>() {
    product::<F>().evaluator().eval_many(&[&[1.0, 2.0], &[1.0]]);
}

/// Panics: there is no such input.
pub fn unknown_input_panics<F: Function>() {
    product::<F>().bind(&[(2, 1.0)]);
}
