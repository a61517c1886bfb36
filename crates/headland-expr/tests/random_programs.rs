//! Identities over random programs with fixed seeds.

mod common;

use common::{Program, Random, close};
use headland_expr::{Dual, Expr, Graph, Interval, NodeId};

const INPUTS: usize = 3;

fn point(random: &mut Random) -> [f64; INPUTS] {
    std::array::from_fn(|_| random.between(-2.0, 2.0))
}

fn build<'g>(graph: &'g Graph, program: &Program) -> Vec<Expr<'g>> {
    let inputs: Vec<Expr<'g>> = (0..INPUTS).map(|i| graph.input(&format!("x[{i}]"))).collect();
    program.run(&inputs)
}

fn ids(graph: &Graph, exprs: &[Expr<'_>]) -> Vec<NodeId> {
    exprs.iter().map(|e| graph.id(*e)).collect()
}

/// How far the results move when the inputs move by a few units in the last place: what rounding may do to them.
fn sensitive(program: &Program, x: &[f64; INPUTS], y: &[f64]) -> Vec<bool> {
    let mut sensitive = vec![false; y.len()];
    for i in 0..INPUTS {
        for sign in [-1.0, 1.0] {
            let mut moved = *x;
            moved[i] += sign * 1e-13;
            for (flag, (a, b)) in sensitive.iter_mut().zip(program.run(&moved).iter().zip(y)) {
                *flag |= !close(*a, *b, 1e-11);
            }
        }
    }
    sensitive
}

#[test]
fn simplification_keeps_values() {
    let (mut compared, mut skipped) = (0, 0);
    for seed in 0..400 {
        let mut random = Random(seed);
        let program = Program::new(&mut random, INPUTS, 25);
        let graph = Graph::new();
        let roots = ids(&graph, &build(&graph, &program));
        for _ in 0..5 {
            let x = point(&mut random);
            let direct = program.run(&x);
            let simplified = graph.eval(&roots, &x);
            let unsure = sensitive(&program, &x, &direct);
            // A difference that cancels to nothing or a value at a jump is rounding's, and so is all that follows.
            for k in 0..direct.len() {
                if unsure[k] || !direct[k].is_finite() || !simplified[k].is_finite() {
                    skipped += 1;
                    break;
                }
                if !close(direct[k], simplified[k], 1e-11) {
                    assert!(near_jump(&program, &x, k), "seed {seed}, result {k}: {} {}", direct[k], simplified[k]);
                    break;
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000, "{compared} compared, {skipped} ended early");
}

/// Whether an earlier result is so near to zero, compared with its operands, that its sign may be rounding's.
fn near_jump(program: &Program, x: &[f64; INPUTS], k: usize) -> bool {
    program.run(x)[..k].iter().any(|y| y.abs() < 1e-13)
}

#[test]
fn intervals_hold_all_samples() {
    let mut narrow = 0;
    for seed in 0..600 {
        let mut random = Random(1000 + seed);
        let program = Program::new(&mut random, INPUTS, 12);
        let graph = Graph::new();
        let roots = ids(&graph, &build(&graph, &program));
        let centre = point(&mut random);
        let width = [1e-6, 1e-2, 0.3, 2.0][random.below(4)];
        let box_: Vec<Interval> = centre.iter().map(|&x| Interval::new(x, x + width)).collect();
        let (bounds, direct) = (graph.eval(&roots, &box_), program.run(&box_));
        for sample in 0..30 {
            // Corners of the box among the samples.
            let part = |random: &mut Random| {
                if sample < 8 { random.below(2) as f64 } else { random.between(0.0, 1.0) }
            };
            let x: Vec<f64> = centre.iter().map(|x| (x + width * part(&mut random)).min(x + width)).collect();
            for (y, bound) in [(graph.eval(&roots, &x), &bounds), (program.run(&x), &direct)] {
                if y.iter().any(|y| !y.is_finite()) {
                    continue; // bounds are of what is defined
                }
                for (k, (y, bound)) in y.iter().zip(bound).enumerate() {
                    assert!(bound.contains(*y), "seed {seed}, result {k}: {y} not in {bound:?}");
                    narrow += usize::from(bound.width() < 1.0);
                }
            }
        }
    }
    assert!(narrow > 10_000);
}

#[test]
fn forward_reverse_dual_and_differences_agree() {
    let (mut compared, mut against_differences) = (0, 0);
    for seed in 0..300 {
        let mut random = Random(2000 + seed);
        let program = Program::new(&mut random, INPUTS, 15);
        let graph = Graph::new();
        let root = graph.id(*build(&graph, &program).last().unwrap());
        let inputs: Vec<NodeId> = (0..INPUTS).map(|i| graph.input_id(i)).collect();
        let gradient = ids(&graph, &graph.gradient(root, &inputs));
        let jacobian = graph.jacobian(&[root], &inputs);
        let x = point(&mut random);
        let reverse = graph.eval(&gradient, &x);
        for i in 0..INPUTS {
            let entry = jacobian.iter().find(|(_, column, _)| *column == i);
            let forward = entry.map_or(0.0, |(_, _, e)| graph.eval(&[graph.id(*e)], &x)[0]);
            let dual: Vec<Dual<f64>> = (0..INPUTS).map(|j| Dual::new(x[j], f64::from(u8::from(i == j)))).collect();
            let dual = graph.eval(&[root], &dual)[0];
            if !(forward.is_finite() && reverse[i].is_finite() && dual.dot.is_finite()) {
                continue;
            }
            compared += 1;
            assert!(close(forward, reverse[i], 1e-7), "seed {seed}: forward {forward}, reverse {}", reverse[i]);
            assert!(close(forward, dual.dot, 1e-7), "seed {seed}: forward {forward}, dual {}", dual.dot);
            let value = |h: f64| {
                let mut moved = x;
                moved[i] += h;
                graph.eval(&[root], &moved)[0]
            };
            let slope = |h: f64| (value(h) - value(-h)) / (2.0 * h);
            let (fine, coarse) = (slope(1e-6), slope(2e-6));
            if close(fine, coarse, 1e-8) && fine.abs() < 1e3 {
                against_differences += 1;
                assert!(close(forward, fine, 1e-5), "seed {seed}: exact {forward}, difference {fine}");
            }
        }
    }
    assert!(compared > 300 && against_differences > 200, "{compared}, {against_differences}");
}

#[test]
fn the_same_program_gives_the_same_ids() {
    for seed in 0..50 {
        let make = || {
            let mut random = Random(3000 + seed);
            let program = Program::new(&mut random, INPUTS, 60);
            let graph = Graph::new();
            let exprs = build(&graph, &program);
            let roots = ids(&graph, &exprs);
            let text: Vec<String> = exprs.iter().map(|e| format!("{e:?}")).collect();
            (roots, graph.len(), text)
        };
        assert_eq!(make(), make());
    }
}

#[test]
fn rebuilt_graphs_keep_values() {
    for seed in 0..100 {
        let mut random = Random(4000 + seed);
        let program = Program::new(&mut random, INPUTS, 20);
        let graph = Graph::new();
        let roots = ids(&graph, &build(&graph, &program));
        let target = Graph::new();
        let inputs: Vec<Expr<'_>> = (0..INPUTS).map(|i| target.input(&format!("x[{i}]"))).collect();
        let copy = ids(&target, &graph.rebuild(&roots, &target, |i| inputs[i]));
        let x = point(&mut random);
        let (a, b) = (graph.eval(&roots, &x), target.eval(&copy, &x));
        for (a, b) in a.iter().zip(&b).take_while(|(a, b)| a.is_finite() && b.is_finite()) {
            assert!(close(*a, *b, 1e-10), "seed {seed}: {a} {b}");
        }
    }
}
