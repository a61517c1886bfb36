//! Generated C, compiled by the system's compiler, against evaluation of the graph.

mod common;

use std::fmt::Write;
use std::process::Command;

use common::{Program, Random};
use headland_expr::print::{C_PRELUDE, c_function, c_tables};
use headland_expr::{Expr, Graph, NodeId};

const INPUTS: usize = 3;
const PROGRAMS: u64 = 60;
const POINTS: usize = 5;

/// The programs' field, written for C.
const FIELD: &str = r"
double headland_field_wave(double x, double y, double z, int part)
{
    static const int times[20][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {1, 1, 0}, {1, 0, 1},
        {0, 2, 0}, {0, 1, 1}, {0, 0, 2}, {3, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {1, 1, 1}, {1, 0, 2}, {0, 3, 0},
        {0, 2, 1}, {0, 1, 2}, {0, 0, 3}};
    const double at[3] = {x, y, z}, rate[3] = {0.7, -1.1, 0.4}, phase[3] = {0.1, 1.3, -0.6};
    double f[3];
    for (int i = 0; i < 3; i++) {
        const double a = rate[i], angle = a * at[i] + phase[i];
        switch (times[part][i]) {
        case 0: f[i] = sin(angle); break;
        case 1: f[i] = a * cos(angle); break;
        case 2: f[i] = -(a * a) * sin(angle); break;
        default: f[i] = -(a * a * a) * cos(angle);
        }
    }
    return f[0] * f[1] * f[2];
}
";

/// Arithmetic agrees to the last bit; library functions may differ by a unit in the last place on other systems than
/// the one Rust was built for, which what follows magnifies, hence the tolerance where bits differ at all.
const TOLERANCE: f64 = 1e-9;

#[test]
fn compiled_functions_agree_with_the_graph() {
    if Command::new("cc").arg("--version").output().is_err() {
        eprintln!("skipped: there is no C compiler `cc`");
        return;
    }
    let mut source = C_PRELUDE.to_string();
    let mut main = String::from("#include <stdio.h>\nint main(void)\n{\n    double y[64];\n");
    let mut expected = Vec::new();
    for seed in 0..PROGRAMS {
        let mut random = Random(5000 + seed);
        let program = Program::new(&mut random, INPUTS, 40);
        let graph = Graph::new();
        let inputs: Vec<Expr<'_>> = ["theta[1]", "theta[1]'", "double"].iter().map(|name| graph.input(name)).collect();
        let results = program.run(&inputs);
        let roots: Vec<NodeId> = results.iter().map(|e| graph.id(*e)).collect();
        let named: Vec<(NodeId, String)> =
            roots.iter().step_by(5).enumerate().map(|(k, id)| (*id, format!("v_C[{k}]'"))).collect();
        // Table names are the graph's own: renamed, since here many graphs share a file.
        let rename = |text: String| text.replace("headland_table_", &format!("table_{seed}_"));
        source += &rename(c_tables(&graph, &roots));
        source += &rename(c_function(&graph, &format!("f{seed}"), &roots, &named));
        for _ in 0..POINTS {
            let x: [f64; INPUTS] = std::array::from_fn(|_| random.between(-2.0, 2.0));
            expected.extend(graph.eval(&roots, &x));
            let arguments = x.map(|x| format!("{x:?}")).join(", ");
            let _ = write!(main, "    {{ const double x[] = {{{arguments}}}; f{seed}(x, y); }}\n    ");
            let _ = writeln!(main, "for (int i = 0; i < {}; i++) printf(\"%.17g\\n\", y[i]);", roots.len());
        }
    }
    source += FIELD;
    source += &main;
    source += "    return 0;\n}\n";

    let folder = std::env::temp_dir().join(format!("headland-c-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (file, binary) = (folder.join("f.c"), folder.join("f"));
    std::fs::write(&file, source).unwrap();
    let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-ffp-contract=off"];
    let built = Command::new("cc").args(flags).arg(&file).arg("-o").arg(&binary).arg("-lm").output().unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let output = Command::new(&binary).output().unwrap();
    let found: Vec<f64> = String::from_utf8(output.stdout).unwrap().lines().map(number).collect();
    std::fs::remove_dir_all(&folder).unwrap();

    assert_eq!(found.len(), expected.len());
    let mut different = 0;
    for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
        if a != b && !(a.is_nan() && b.is_nan()) {
            different += 1;
            assert!(common::close(*a, *b, TOLERANCE), "value {i}: C {a:?}, graph {b:?}");
        }
    }
    println!("{different} of {} values differ in their bits", found.len());
    assert!(different * 20 < found.len(), "{different} of {} values differ", found.len());
}

/// C writes `-nan` too.
fn number(line: &str) -> f64 {
    if line.contains("nan") { f64::NAN } else { line.parse().unwrap() }
}
