//! The same scene gives the same bytes; the size of the equations grows with the machine, not faster.

mod common;

use common::{build, cartesian_train, derived, double_pendulum, prescribed_pivot, sleigh, train, turning_rails};
use headland_dynamics::present::{Form, equations_text};
use headland_expr::NodeId;
use headland_model::Scene;

fn scenes() -> Vec<Scene> {
    vec![double_pendulum(), sleigh("geometric"), prescribed_pivot(), turning_rails(), train(3), cartesian_train(3)]
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    for scene in scenes() {
        for form in [Form::Text, Form::Latex, Form::C] {
            let text = || {
                let model = build(&scene);
                let equations = derived(&model);
                equations_text(&model, &equations, form)
            };
            let first = text();
            assert!(first.lines().count() > 5, "{first}");
            assert_eq!(first, text());
            let model = build(&scene);
            let again = [derived(&model), derived(&model)].map(|e| equations_text(&model, &e, form));
            assert_eq!(again[0], again[1], "derived twice over one graph");
        }
    }
}

/// Structs in LaTeX are balanced; nothing is left of a name that LaTeX or C cannot read.
#[test]
fn latex_is_balanced() {
    for scene in scenes() {
        let model = build(&scene);
        let text = equations_text(&model, &derived(&model), Form::Latex);
        let count = |c: char| text.matches(c).count();
        assert_eq!(count('{'), count('}'), "{text}");
        assert_eq!(text.matches("\\left").count(), text.matches("\\right").count(), "{text}");
        assert_eq!(text.matches("\\begin{align*}").count(), 1, "{text}");
        assert_eq!(text.matches("\\end{align*}").count(), 1, "{text}");
        for line in text.lines().filter(|l| !l.starts_with(['%', '\\']) || l.contains("&=")) {
            assert!(line.contains("&=") && line.ends_with("\\\\"), "{line}");
        }
    }
}

/// Text is read back by the scene format: each line is a definition of the names before it.
#[test]
fn text_names_are_defined_before_they_are_used() {
    for scene in [double_pendulum(), sleigh("geometric"), turning_rails()] {
        let model = build(&scene);
        let text = equations_text(&model, &derived(&model), Form::Text);
        for line in text.lines().filter(|l| !l.starts_with('#')) {
            let Some((_, right)) = line.split_once(" = ") else { panic!("{line}") };
            // entries of M have two indices, which the format has not
            let right = (1..=9).fold(right.to_string(), |text, j| text.replace(&format!(",{j}]"), "]"));
            assert!(headland_expr::parse::parse(&right).is_ok(), "{line}");
        }
    }
}

fn operations(scene: &Scene) -> f64 {
    let model = build(scene);
    let equations = derived(&model);
    let accelerations = equations.accelerations.clone().unwrap_or_default();
    let roots: Vec<NodeId> = equations.kinematics.rates.iter().copied().chain(accelerations).collect();
    model.graph.operations(&roots) as f64
}

#[test]
fn the_size_grows_linearly() {
    let [a, b, c] = [8, 16, 32].map(|n| operations(&train(n)));
    let (first, second) = ((b - a) / 8.0, (c - b) / 16.0);
    assert!((second / first - 1.0).abs() < 0.1, "{a}, {b}, {c}: {first} then {second} operations a bogie");
    assert!(c < 200.0 * 32.0, "{c} operations for 32 bogies");
}

/// The wheels' heights are kept by the planar joint, so these rows cancel, but to rounding only.
#[test]
fn rows_that_cancel_to_rounding_bind_nothing() {
    let text = r#"
        title = "Cart on two wheels"
        [indices]
        k = 2
        [[body]]
        name = "cart"
        mass = 10
        shape = "box"
        size = [1, 1, 0.1]
        [[joint]]
        name = "base"
        kind = "planar"
        at = [0, 0, 0.2]
        to = "cart"
        [[body]]
        name = "wheel[k]"
        mass = 1
        shape = "disc"
        size = 0.2
        axis = "y"
        [[joint]]
        name = "spin[k]"
        kind = "revolute"
        axis = "y"
        from = "cart"
        at = [0, "(1.5 - k)*1[m]", 0]
        to = "wheel[k]"
        [[rolling]]
        name = "contact[k]"
        body = "wheel[k]"
        radius = 0.2
        axis = "y"
        [initial]
        "base.angle" = -0.4
        "spin[1]" = 27.6
        "spin[2]" = 13.1
    "#;
    let model = Scene::parse("cart.toml", text).and_then(|s| s.build()).unwrap();
    let equations = derived(&model);
    assert_eq!(equations.kinematics.quasi.len(), 2); // forward and about the vertical
    assert_eq!(equations.kinematics.redundant.len(), 3); // both heights, one of the sideways slips
}
