//! The printed C function, compiled by the system's compiler, is the right-hand side that runs.

mod common;

use std::fmt::Write;
use std::process::Command;
use std::rc::Rc;

use common::{CARTESIAN, DOUBLE, PIVOT, ROAD, SLEIGH, SNAKEBOARD, TRAIN, build, chain, read};
use headland_dynamics::present::{Form, equations_text};
use headland_dynamics::sample::start_inputs;
use headland_dynamics::{DeriveOptions, derive};
use headland_sim::{Problem, System};
use headland_solve::OdeProblem;

#[test]
fn compiled_c_is_the_right_hand_side() {
    if Command::new("cc").arg("--version").output().is_err() {
        eprintln!("skipped: there is no C compiler `cc`");
        return;
    }
    let folder = std::env::temp_dir().join(format!("headland-rhs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{e}"));
    let scenes = [SLEIGH, DOUBLE, TRAIN, CARTESIAN, PIVOT, ROAD, SNAKEBOARD].map(read).into_iter().chain([chain(6)]);
    for (k, scene) in scenes.enumerate() {
        let model = build(&scene);
        let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        let system = Rc::new(System::new(&model, &equations));
        let n = system.len();
        let mut problem = Problem::new(system, false);
        let mut text = equations_text(&model, &equations, Form::C);
        let mut expected = Vec::new();
        let _ = write!(text, "\n#include <stdio.h>\nint main(void)\n{{\n    double y[{n}];\n");
        for p in 0..5 {
            let mut inputs = start_inputs(&model);
            let t = 0.3 + 1.3 * f64::from(p);
            inputs[model.input_index(model.time)] = t;
            let states = model.coordinates.iter().map(|c| c.q).chain(equations.kinematics.quasi.iter().map(|u| u.u));
            let mut y = Vec::new();
            for (i, node) in states.enumerate() {
                let slot = model.input_index(node);
                inputs[slot] += 0.2 * (1.3 * i as f64 + 0.7 * f64::from(p)).sin();
                y.push(inputs[slot]);
            }
            let mut dy = vec![0.0; n];
            problem.rhs(t, &y, &mut dy).unwrap_or_else(|_| panic!("no right-hand side"));
            expected.extend(dy);
            let values: Vec<String> = inputs.iter().map(|x| format!("{x:?}")).collect();
            let _ =
                writeln!(text, "    {{ static const double x[] = {{{}}}; headland_rhs(x, y); }}", values.join(", "));
            let _ = writeln!(text, "    for (int i = 0; i < {n}; i++) printf(\"%.17g\\n\", y[i]);");
        }
        text.push_str("    return 0;\n}\n");
        let (file, binary) = (folder.join(format!("f{k}.c")), folder.join(format!("f{k}")));
        std::fs::write(&file, text).unwrap_or_else(|e| panic!("{e}"));
        let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-ffp-contract=off"];
        let built = Command::new("cc").args(flags).arg(&file).arg("-o").arg(&binary).arg("-lm").output();
        let built = built.unwrap_or_else(|e| panic!("{e}"));
        assert!(built.status.success(), "{}: {}", model.title, String::from_utf8_lossy(&built.stderr));
        let output = Command::new(&binary).output().unwrap_or_else(|e| panic!("{e}"));
        let found: Vec<f64> =
            String::from_utf8_lossy(&output.stdout).lines().map(|l| l.parse().unwrap_or(f64::NAN)).collect();
        assert_eq!(found.len(), expected.len());
        for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() <= 1e-13 * b.abs().max(1.0), "{}, value {i}: C {a:?}, System {b:?}", model.title);
        }
    }
    let _ = std::fs::remove_dir_all(&folder);
}
