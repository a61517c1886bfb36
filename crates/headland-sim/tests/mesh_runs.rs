//! A ball that presses into a recess of triangles, against the exact recess.
#![cfg(feature = "mesh")]

mod common;

use common::{done, read, set};

const MESH: &str = include_str!("../../../models/ball_in_recess_mesh.toml");

/// The depth is wrong by the square of the triangles' size, and so is the motion, whose normal is right on the mean.
#[test]
fn a_recess_of_triangles_converges_to_the_recess() {
    let run = |text: &str, density: &str| {
        let mut scene = read(text);
        set(&mut scene, &[("density", density)]);
        let model = scene.build().unwrap_or_else(|e| panic!("{e}"));
        let told = model.warnings.iter().any(|w| w.message.contains("the depth is wrong by up to"));
        assert_eq!(told, text == MESH, "{:?}", model.warnings);
        done(&model, |o| (o.until, o.tolerance) = (1.0, 1e-7))
    };
    let exact =
        run(&MESH.replace("shape = \"mesh\"", "shape = \"sphere\"").replace("density = \"density\"\n", ""), "1");
    let errors = ["8", "16", "32", "64"].map(|density| {
        let mesh = run(MESH, density);
        let rows = mesh.trajectory.rows.iter().zip(&exact.trajectory.rows);
        rows.map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()).fold(0.0, f64::max)
    });
    println!("{errors:?}");
    let order = (errors[0] / errors[3]).log2() / 3.0;
    assert!((1.5..2.6).contains(&order) && errors[3] < 3e-3, "order {order}: {errors:?}");
}
