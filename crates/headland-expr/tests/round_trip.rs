//! What is printed as text parses back to an expression of the same value.

mod common;

use common::{Program, Random, close};
use headland_expr::ops::{OPS, apply};
use headland_expr::parse::{Comparison, Item, parse};
use headland_expr::print::{Style, expression};
use headland_expr::{Expr, Graph, Scalar};

const NAMES: [&str; 3] = ["theta[1]", "v_A[2]'", "x_B"];

/// Builds what a text says; tables are those of the program.
fn read<'g>(text: &str, program: &Program, inputs: &[Expr<'g>]) -> Expr<'g> {
    let parsed = parse(text).unwrap_or_else(|e| panic!("{text}: {e}"));
    let mut stack: Vec<Expr<'g>> = Vec::new();
    for (item, span) in parsed.items.iter().zip(&parsed.spans) {
        match item {
            Item::Number(x, _) => stack.push(Expr::Const(*x)),
            Item::Name { .. } => {
                let name = &text[span.clone()];
                stack.push(inputs[NAMES.iter().position(|n| *n == name).expect(name)]);
            }
            Item::Operator(op) => {
                let operands = stack.split_off(stack.len() - op.arity());
                let get = |k: usize| operands.get(k).copied().unwrap_or(Expr::Const(0.0));
                let is_power = *op == headland_expr::Op::Pow;
                stack.push(if is_power { get(0).pow(get(1)) } else { apply(*op, get(0), get(1), get(2)) });
            }
            Item::Compare(Comparison::GreaterEqual) => {
                let (b, a) = (stack.pop().unwrap(), stack.pop().unwrap());
                stack.push(a - b);
            }
            Item::Call { function, args } => {
                let operands = stack.split_off(stack.len() - args);
                let get = |k: usize| operands.get(k).copied().unwrap_or(Expr::Const(0.0));
                stack.push(match function.as_str() {
                    "if" => Expr::select(get(0), get(1), get(2)),
                    "table" => get(0).spline(program.table(), 0),
                    "wave" => Expr::field([get(0), get(1), get(2)], program.field(), 0),
                    name => {
                        let row = OPS.iter().find(|row| row.name == name).expect(name);
                        apply(row.op, get(0), get(1), get(2))
                    }
                });
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    assert_eq!(stack.len(), 1, "{text}");
    stack[0]
}

#[test]
fn text_parses_back() {
    let mut compared = 0;
    for seed in 0..400 {
        let mut random = Random(6000 + seed);
        let program = Program::new(&mut random, NAMES.len(), 12);
        let graph = Graph::new();
        let inputs: Vec<Expr<'_>> = NAMES.iter().map(|name| graph.input(name)).collect();
        for e in program.run(&inputs) {
            let id = graph.id(e);
            let text = expression(&graph, Style::Text, id);
            // The grammar has no derivatives of tables and fields, and no infinities.
            if text.contains("table'") || text.contains("wave'") || text.contains("inf") || text.contains("NaN") {
                continue;
            }
            let again = graph.id(read(&text, &program, &inputs));
            let x: [f64; 3] = std::array::from_fn(|_| random.between(-2.0, 2.0));
            let (a, b) = (graph.eval(&[id], &x)[0], graph.eval(&[again], &x)[0]);
            if a.is_finite() && b.is_finite() {
                compared += 1;
                assert!(close(a, b, 1e-9), "seed {seed}: {a} became {b} in {text}");
            }
        }
    }
    assert!(compared > 2000, "{compared}");
}
