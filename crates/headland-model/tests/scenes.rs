//! Scene files: what is read, and what wrong input gets.

use headland_model::{ElementKind, Scene};

const TRAIN: &str = include_str!("../../../models/paper_train.toml");

fn model(text: &str) -> headland_model::Model {
    match Scene::parse("scene.toml", text).and_then(|s| s.build()) {
        Ok(model) => model,
        Err(error) => panic!("{error}"),
    }
}

fn errors(text: &str) -> String {
    match Scene::parse("scene.toml", text).and_then(|s| s.build()) {
        Ok(_) => panic!("no error in:\n{text}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn the_train_is_a_family() {
    let three = model(TRAIN);
    assert_eq!(three.coordinates.len(), 5);
    assert_eq!(three.quasi_velocities.len(), 1);
    assert_eq!(three.count(ElementKind::Inertia), 6);
    assert_eq!(three.count(ElementKind::Force), 4);
    let names: Vec<&str> = three.outputs.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(&names[..6], ["x_A1", "y_A1", "v", "theta[1]", "theta[2]", "theta[3]"]);
    let units: Vec<&str> = three.outputs.iter().map(|o| o.unit.as_str()).collect();
    assert_eq!(&units[..4], ["m", "m", "m/s", "rad"]);
    assert_eq!(units.last(), Some(&"W"));

    let mut scene = Scene::parse("scene.toml", TRAIN).unwrap();
    for name in ["l", "a", "b", "m", "J", "F_B", "theta0"] {
        scene.set(name, "[1, 2]").unwrap();
    }
    scene.set("gamma", "0.1*sin(2*pi*t/5)").unwrap();
    let two = scene.build().unwrap();
    assert_eq!(two.coordinates.len(), 4);
}

#[test]
fn same_scene_same_graph() {
    let (a, b) = (model(TRAIN), model(TRAIN));
    assert_eq!(a.graph.len(), b.graph.len());
    let all = |m: &headland_model::Model| {
        let nodes = m.outputs.iter().map(|o| o.node).chain(m.elements.iter().map(|e| e.structure));
        nodes.map(|n| (n, m.graph.node(n))).collect::<Vec<_>>()
    };
    assert_eq!(all(&a), all(&b));
}

#[test]
fn a_length_added_to_an_angle_names_both() {
    let text = TRAIN.replace("theta[k] - theta[k+1] - delta[k]", "theta[k] + l[k]");
    let message = errors(&text);
    assert!(message.contains("cannot add `theta[k]` and `l[k]`"), "{message}");
    assert!(message.contains("an angle [rad]") && message.contains("a length [m]"), "{message}");
    assert!(message.contains("scene.toml:41:15"), "{message}");
}

#[test]
fn wrong_names_units_cycles_and_missing_values_are_all_told() {
    let text = TRAIN
        .replace("\"psi[1]\" = \"gamma\"", "\"psi[1]\" = \"gama\"")
        .replace("kp = \"2000 N*s/m\"", "kp = \"2000 N*s\"")
        .replace("v = \"v0\"", "");
    let message = errors(&text);
    assert!(message.contains("undefined name `gama`; did you mean `gamma`?"), "{message}");
    assert!(message.contains("F0 + kp*(v_ref - v)") && message.contains("a force [N]"), "{message}");
    assert!(message.contains("too few initial values") && message.contains("`v`"), "{message}");

    let message = errors(&TRAIN.replace("\"gamma\"", "\"psi[3] - gamma\""));
    assert!(message.contains("cyclic definition: `psi[1]` needs `psi[3]` needs"), "{message}");

    let message = errors(&TRAIN.replace("\"4 m\"", "\"4 parsec\""));
    assert!(message.contains("unknown unit `parsec`"), "{message}");

    let message = errors(&TRAIN.replace("geometric = \"theta[k]\"", "implicit = \"theta[k]''\""));
    assert!(message.contains("depends on the acceleration `theta[1]''`"), "{message}");

    let message = errors(&TRAIN.replace("[kinematics]", "[kinematic]"));
    assert!(message.contains("unknown section `kinematic`; did you mean `kinematics`?"), "{message}");
}

#[test]
fn arrays_of_different_lengths_are_named() {
    let mut scene = Scene::parse("scene.toml", TRAIN).unwrap();
    scene.set("l", "[1, 2, 3, 4]").unwrap();
    let message = scene.build().unwrap_err().to_string();
    assert!(message.contains("`a[4]` does not exist; members run from 1 to 3"), "{message}");
}

#[test]
fn bare_literals_fit_their_place() {
    let text = TRAIN.replace("[parameters]", "[parameters]\nplain = 4");
    assert_eq!(model(&text).parameters[0].unit, "1");
    let text = text.replace("F0 + kp*(v_ref - v)", "F0 + kp*(v_ref - v) + plain*3*v");
    assert_eq!(model(&text).parameters[0].value, 4.0);
}

#[test]
fn the_only_coordinate_of_a_joint_can_be_driven() {
    let text = |driven: &str| {
        format!(
            r#"
            title = "Arm on a table that is turned"
            [[body]]
            name = "table"
            inertia = [0, 0, 1]
            [[joint]]
            name = "axle"
            kind = "revolute"
            to = "table"
            [[body]]
            name = "arm"
            mass = 1
            [[joint]]
            name = "slide"
            kind = "prismatic"
            from = "table"
            to = "arm"
            axis = "x"
            [prescribed]
            {driven}
            "#
        )
    };
    let counts = |driven: &str| {
        let model = model(&text(driven));
        (model.coordinates.len(), model.prescribed.len())
    };
    assert_eq!(counts("axle = \"2[rad/s]*t\""), (1, 1));
    assert_eq!(counts("axle = \"2[rad/s]*t\"\nslide = 1"), (0, 2)); // motion without freedom
}

#[test]
fn keys_that_say_nothing_to_a_joint_are_refused() {
    let text = |joint: &str| {
        format!("title = \"t\"\n[[body]]\nname = \"b\"\nmass = 1\n[[joint]]\nname = \"j\"\nto = \"b\"\n{joint}\n")
    };
    for (joint, key) in [
        ("kind = \"planar\"\naxis = \"y\"", "`axis`"),
        ("kind = \"revolute\"\nlead = 0.1", "`lead`"),
        ("kind = \"universal\"\norientation = \"rpy\"", "`orientation`"),
    ] {
        let message = errors(&text(joint));
        assert!(message.contains(key) && message.contains("says nothing"), "{message}");
    }
}

#[test]
fn a_family_of_joints_is_driven_as_a_whole() {
    let text = r#"
        title = "Two hinges, one driven"
        [indices]
        k = 2
        [[body]]
        name = "rod[k]"
        mass = 1
        shape = "box"
        size = [1, 0.1, 0.1]
        [[joint]]
        name = "hinge[k]"
        kind = "revolute"
        to = "rod[k]"
        [prescribed]
        "hinge[1]" = "1[rad/s]*t"
    "#;
    assert!(errors(text).contains("`hinge[2]` has no function of time"), "{}", errors(text));
}
