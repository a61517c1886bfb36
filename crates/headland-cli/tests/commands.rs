//! `headland derive`, `check`, `schema`, and what wrong input gets.

mod common;

use common::{Folder, model, stone};

const MODELS: [&str; 7] = [
    "chaplygin_sleigh.toml",
    "double_pendulum.toml",
    "paper_train.toml",
    "paper_train_cartesian.toml",
    "pendulum_prescribed_pivot.toml",
    "road_train.toml",
    "snakeboard.toml",
];

#[test]
fn derive_in_three_forms() {
    let folder = Folder::new();
    for name in MODELS {
        let path = model(name);
        let text = folder.good(&["derive", &path]);
        assert!(text.starts_with("# ") && text.lines().any(|l| l.starts_with('M')), "{name}:\n{text}");
        assert_eq!(text, folder.good(&["derive", &path, "--form", "text"]));
        let latex = folder.good(&["derive", &path, "--form", "latex"]);
        assert!(latex.contains("\\begin{align*}") && latex.ends_with("\\end{align*}\n"), "{name}:\n{latex}");
        let c = folder.good(&["derive", &path, "--form", "c"]);
        assert!(c.starts_with("/*") && c.contains("headland_rhs") && c.contains("#include <math.h>"), "{name}:\n{c}");
    }
    for algorithm in ["direct", "combine"] {
        let text = folder.good(&["derive", &model("paper_train_cartesian.toml"), "--algorithm", algorithm]);
        assert!(text.contains(&format!("algorithm {algorithm}")), "{text}");
    }
    folder.wrong(&["derive", &model("paper_train.toml"), "--algorithm", "combine"], &["does not apply", "m[1]"]);
    folder.wrong(&["derive", &model("paper_train.toml"), "--form", "pascal"], &["pascal", "latex"]);
}

#[test]
fn check_tells_what_a_scene_is() {
    let folder = Folder::new();
    for (name, freedom) in MODELS.iter().zip([2, 2, 1, 1, 1, 1, 1]) {
        let text = folder.good(&["check", &model(name)]);
        assert!(
            text.contains(&format!("freedom    {freedom} degree{} of freedom", if freedom == 1 { "" } else { "s" })),
            "{name}:\n{text}"
        );
        assert!(text.ends_with("ok\n") && !text.contains("warning"), "{name}:\n{text}");
    }
    let text = folder.good(&["check", &model("paper_train_cartesian.toml")]);
    assert!(text.contains("6 coordinates - 4 velocity constraints - 1 prescribed"), "{text}");
    assert!(text.contains("both agree at random states to"), "{text}");
}

#[test]
fn schema_is_json() {
    let folder = Folder::new();
    let schema: serde_json::Value = serde_json::from_str(&folder.good(&["schema"])).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    for section in ["parameters", "coordinates", "kinematics", "inertia", "force", "run", "plot", "event", "guard"] {
        let description = &schema["properties"][section]["description"];
        assert!(description.as_str().is_some_and(|d| !d.is_empty()), "{section}");
    }
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn help_and_version() {
    let folder = Folder::new();
    assert!(folder.good(&["--version"]).contains(env!("CARGO_PKG_VERSION")));
    let help = folder.good(&["--help"]);
    for command in ["run", "derive", "linearize", "check", "schema"] {
        assert!(help.contains(command), "{help}");
    }
    assert!(folder.good(&["run", "--help"]).contains("--tol"));
}

#[test]
fn wrong_command_lines() {
    let folder = Folder::new();
    folder.write("stone.toml", &stone(""));
    folder.wrong(&[], &["Usage"]);
    folder.wrong(&["fly"], &["fly"]);
    folder.wrong(&["run"], &["MODEL"]);
    folder.wrong(&["run", "stone.toml", "--fast"], &["--fast"]);
    folder.wrong(&["run", "nowhere.toml"], &["cannot read `nowhere.toml`"]);
    folder.wrong(&["check", "."], &["cannot read `.`"]);
    folder.wrong(&["run", "stone.toml", "--set", "x0"], &["NAME=VALUE"]);
    folder.wrong(&["run", "stone.toml", "--set", "x00=1"], &["nothing named `x00`", "did you mean `x0`"]);
    folder.wrong(&["run", "stone.toml", "--set", "x0=1 kg"], &["a length [m]"]);
    folder.wrong(&["run", "stone.toml", "--set", "x0=1 parsec"], &["parsec"]);
    folder.wrong(&["run", "stone.toml", "--set", "x0=("], &["x0=("]);
    folder.wrong(&["run", "stone.toml", "--set", "x0=nan"], &["x0=nan"]);
    folder.wrong(&["run", "stone.toml", "--set", "loads[3]=1"], &["loads[3]"]);
    folder.wrong(&["run", "stone.toml", "--set", "run.speed=1"], &["`run` has no `speed`"]);
    folder.wrong(&["run", "stone.toml", "--method", "euler"], &["euler", "dop853"]);
    folder.wrong(&["run", "stone.toml", "--tol", "0"], &[""]);
    folder.wrong(&["run", "stone.toml", "--tol", "-1e-8"], &[""]);
    folder.wrong(&["run", "stone.toml", "--tol", "tight"], &["tight"]);
    folder.wrong(&["run", "stone.toml", "--tol", "1e-30"], &[""]);
    folder.wrong(&["run", "stone.toml", "--until", "0"], &["0 s"]);
    folder.wrong(&["run", "stone.toml", "--until", "-3"], &[""]);
    folder.wrong(&["run", "stone.toml", "--until", "4 kg"], &["4 kg"]);
    folder.wrong(&["run", "stone.toml", "--until", "soon"], &["soon"]);
    folder.wrong(&["run", "stone.toml", "--until", "inf"], &["inf"]);
    folder.wrong(&["run", "stone.toml", "--points", "0"], &["points"]);
    folder.wrong(&["run", "stone.toml", "--points", "-3"], &[""]);
    folder.wrong(&["run", "stone.toml", "--points", "2.5"], &["points"]);
    folder.wrong(&["run", "stone.toml", "--points", "many"], &["many"]);
    folder.wrong(&["run", "stone.toml", "--points", "1e18"], &["points"]);
    folder.wrong(&["run", "stone.toml", "--at", "nan"], &["NaN"]);
    folder.wrong(&["run", "stone.toml", "--at", "-1"], &["-1"]);
    folder.wrong(&["run", "stone.toml", "--at", "1,two"], &["two"]);
    folder.wrong(&["run", "stone.toml", "--at", "1,5", "--until", "3"], &["5 s", "3 s"]);
    folder.wrong(&["run", "stone.toml", "--set", "run.max_step=0"], &["max_step"]);
    folder.wrong(&["run", "stone.toml", "--set", "run.max_step=-1"], &["max_step"]);
    folder.wrong(&["run", "stone.toml", "--repeat", "-1"], &["-1"]);
    folder.write("file", "");
    folder.wrong(&["run", "stone.toml", "--out", "file/below"], &["cannot make the folder"]);
}

#[test]
fn wrong_scenes() {
    let folder = Folder::new();
    let wrong = |text: &str, messages: &[&str]| {
        folder.write("wrong.toml", text);
        for command in ["check", "run", "derive"] {
            folder.wrong(&[command, "wrong.toml"], messages);
        }
        let out = folder.0.join("out/wrong");
        assert!(!out.exists() || folder.files("out/wrong").is_empty(), "nothing is written for a wrong scene");
    };
    wrong("", &[""]);
    wrong("title = ", &["wrong.toml:1:", "not TOML"]);
    wrong("[[[", &["wrong.toml:1:"]);
    wrong(&stone("").replace("value = \"-m*g\"", "value = \"-m*h\""), &["wrong.toml:15:", "undefined name `h`"]);
    wrong(&stone("").replace("x = \"x0\"\n", ""), &["[initial] lacks `x`"]);
    wrong(&stone("").replace("[run]", "[runs]"), &["unknown section `runs`", "did you mean `run`"]);
    wrong(&stone("").replace("until", "untill"), &["has no key `untill`", "did you mean `until`"]);
    wrong(&stone("").replace("\"m\"\ngeometric", "\"m*0\"\ngeometric"), &["mass matrix is singular", "x'"]);
    wrong(&stone("[[constraint]]\nname = \"hold\"\nequation = \"x' = 0\"\n"), &["no degree of freedom"]);
    let sleigh = std::fs::read_to_string(model("chaplygin_sleigh.toml")).unwrap_or_default();
    let scalar = sleigh
        .replace("geometric = \"x + b*cos(theta)\"", "explicit = \"v\"")
        .replace("geometric = \"y + b*sin(theta)\"", "explicit = \"b*w\"");
    assert_ne!(sleigh, scalar);
    wrong(&scalar, &["scalar inertia element", "b w^2", "wrong.toml:"]);
    // equations do not need a start, a run does
    folder.write("slow.toml", &stone("").replace("\"x'\" = 0\n", ""));
    for command in ["check", "run"] {
        folder.wrong(&[command, "slow.toml"], &["too few initial values", "`x'`"]);
    }
    folder.good(&["derive", "slow.toml"]);
    let three = stone("[[force]]\nname = \"f\"\nvalue = \"q\"\ngeometric = \"x\"\n")
        .replace("-m*g", "-m*g*")
        .replace("until = \"1 s\"", "until = \"1 m\"");
    wrong(&three, &["undefined name `q`", "-m*g*", "until"]);
}

#[test]
fn not_utf8_is_told() {
    let folder = Folder::new();
    std::fs::write(folder.0.join("bytes.toml"), [0xff, 0xfe, 0x00, 0x41]).unwrap_or_else(|e| panic!("{e}"));
    folder.wrong(&["check", "bytes.toml"], &["bytes.toml"]);
}

#[test]
fn linearize_gives_matrices_and_eigenvalues() {
    let folder = Folder::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/bicycle.toml");
    let text = folder.good(&["linearize", scene, "--set", "roll_rate=0", "--set", "v=5", "--input", "steer_torque"]);
    for part in
        ["about   a steady motion", "cyclic  place.x, place.y, place.yaw, rear, front", "(steer')'", "-14.07839"]
    {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    assert!(text.contains("-0.7753419 ± 4.464868i"), "{text}");
    let json = folder.good(&["linearise", scene, "--set", "roll_rate=0", "--json", "--out", "here"]);
    let printed: serde_json::Value = serde_json::from_str(&json).unwrap_or_else(|e| panic!("{e}"));
    let file = |name: &str| -> serde_json::Value {
        serde_json::from_str(&folder.read(name)).unwrap_or_else(|e| panic!("{e}"))
    };
    assert_eq!(printed, file("here/linear.json"));
    assert_eq!(printed["states"][0]["name"], "place.roll");
    assert_eq!(printed["modes"].as_array().map(Vec::len), Some(5));
    assert_eq!(file("out/bicycle/linear.json")["inputs"][0]["name"], "steer_torque");
    folder
        .wrong(&["linearize", scene, "--input", "torque"], &["--input", "`torque` is not a parameter", "steer_torque"]);
    folder.wrong(&["linearize", scene, "--input", "rR"], &["`rR` cannot be an input"]);
    folder.wrong(
        &["linearize", scene, "--set", "roll_rate=0", "--set", "steer_torque=1"],
        &["neither an equilibrium", "(steer')′", "--set"],
    );
}
