//! `headland run`: files, columns, times, settings, plots and exit codes.

mod common;

use common::{Folder, model, stone};
use serde_json::Value;

/// Header and rows of a table.
fn csv(text: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut lines = text.lines();
    let split = |l: &str| l.split(',').map(String::from).collect::<Vec<_>>();
    (lines.next().map(split).unwrap_or_default(), lines.map(split).collect())
}

fn numbers(rows: &[Vec<String>]) -> Vec<Vec<f64>> {
    rows.iter().map(|r| r.iter().map(|x| x.parse().unwrap_or_else(|e| panic!("{x}: {e}"))).collect()).collect()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}:\n{text}"))
}

const KEYS: &[&str] = &[
    "status",
    "title",
    "method",
    "why",
    "tolerance",
    "t_end",
    "coordinates",
    "degrees_of_freedom",
    "steps",
    "rejected",
    "rhs",
    "rhs_outputs",
    "jacobians",
    "factorizations",
    "events",
    "repartitions",
    "restarts",
    "derive_s",
    "compile_s",
    "run_s",
    "operations",
    "evaluator",
    "algorithm",
    "energy_balance",
    "constraint_position",
    "constraint_velocity",
    "log",
    "versions",
];

#[test]
fn files_are_written_and_stderr_is_quiet() {
    let folder = Folder::new();
    for name in
        ["chaplygin_sleigh", "double_pendulum", "paper_train", "paper_train_cartesian", "road_train", "snakeboard"]
    {
        let path = model(&format!("{name}.toml"));
        let shown = folder.good(&["run", &path, "--until", "2", "--points", "20"]);
        for word in ["model ", "method ", "done ", "energy ", "files "] {
            assert!(shown.lines().any(|l| l.starts_with(word)), "{name}: no {word}in\n{shown}");
        }
        assert_eq!(folder.files(&format!("out/{name}")), ["summary.json", "trajectory.csv"]);
        let (header, rows) = csv(&folder.read(&format!("out/{name}/trajectory.csv")));
        assert_eq!(header[0], "t [s]");
        assert!(header.iter().all(|h| h.ends_with(']') && h.contains(" [")), "{header:?}");
        assert_eq!(rows.len(), 21, "{name}");
        assert!(rows.iter().all(|r| r.len() == header.len()), "{name}");
        let summary = json(&folder.read(&format!("out/{name}/summary.json")));
        for key in KEYS {
            assert!(summary.get(key).is_some(), "{name}: no `{key}` in {summary:#}");
        }
        assert_eq!((&summary["status"], &summary["t_end"]), (&Value::from("done"), &Value::from(2.0)));
        assert!(summary["versions"]["headland"].is_string());
        assert!(summary["energy_balance"].as_f64().is_some_and(|b| b < 1e-6), "{name}");
    }
    let (header, _) = csv(&folder.read("out/paper_train/trajectory.csv"));
    assert_eq!(header[..5].join("|"), "t [s]|x_A1 [m]|y_A1 [m]|v [m/s]|theta[1] [rad]");
}

#[test]
fn numbers_have_seventeen_digits() {
    let folder = Folder::new();
    folder.good(&["run", &model("double_pendulum.toml"), "--until", "1", "--out", "here"]);
    let (_, rows) = csv(&folder.read("here/trajectory.csv"));
    for cell in rows.iter().flatten() {
        let (mantissa, exponent) = cell.split_once('e').unwrap_or_else(|| panic!("{cell}"));
        assert_eq!(mantissa.trim_start_matches('-').len(), 18, "{cell}"); // a point among 17 digits
        let x: f64 = cell.parse().unwrap_or(f64::NAN);
        assert_eq!(format!("{x:.16e}"), *cell);
        assert!(exponent.parse::<i32>().is_ok());
    }
}

#[test]
fn rows_are_exactly_the_times_asked_for() {
    let folder = Folder::new();
    folder.good(&["run", &model("paper_train.toml"), "--at", "0.75,5,0,15,0.1"]);
    let (_, rows) = csv(&folder.read("out/paper_train/trajectory.csv"));
    let t: Vec<f64> = numbers(&rows).iter().map(|r| r[0]).collect();
    assert_eq!(t, [0.0, 0.1, 0.75, 5.0, 15.0]);
    // without --until the run ends with them
    folder.good(&["run", &model("paper_train.toml"), "--at", "0.3"]);
    assert_eq!(json(&folder.read("out/paper_train/summary.json"))["t_end"], 0.3);
    folder.good(&["run", &model("paper_train.toml"), "--at", "0.3", "--until", "1"]);
    assert_eq!(json(&folder.read("out/paper_train/summary.json"))["t_end"], 1.0);
    let (_, rows) = csv(&folder.read("out/paper_train/trajectory.csv"));
    assert_eq!(rows.len(), 1);
}

/// Position of the stone at the end of one second.
fn fallen(folder: &Folder, args: &[&str]) -> f64 {
    let all: Vec<&str> = ["run", "stone.toml", "--at", "1"].into_iter().chain(args.iter().copied()).collect();
    folder.good(&all);
    numbers(&csv(&folder.read("out/stone/trajectory.csv")).1)[0][1]
}

#[test]
fn settings() {
    let folder = Folder::new();
    folder.write("stone.toml", &stone(""));
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-7, "{a} for {b}");
    close(fallen(&folder, &[]), 10.0 - 4.905);
    close(fallen(&folder, &["--set", "x0=12"]), 12.0 - 4.905);
    close(fallen(&folder, &["--set", "x0=50 cm"]), 0.5 - 4.905);
    close(fallen(&folder, &["--set", "x=7"]), 7.0 - 4.905);
    close(fallen(&folder, &["--set", "x'=3"]), 13.0 - 4.905);
    close(fallen(&folder, &["--set", "g=2*4.905[m/s^2]"]), 10.0 - 4.905);
    close(fallen(&folder, &["--set", "weight.value=-m*g + loads[2]"]), 11.0 - 4.905 - 0.5);
    close(fallen(&folder, &["--set", "weight.value=-m*g + loads[2]", "--set", "loads[2]=6"]), 10.0 - 4.905 + 1.5);
    close(fallen(&folder, &["--set", "weight.value=-m*g + loads[2]", "--set", "loads=[0, 10]"]), 10.0 - 4.905 + 2.5);
    close(fallen(&folder, &["--set", "run.tolerance=1e-10", "--tol", "1e-9", "--method", "dop853"]), 10.0 - 4.905);
    assert_eq!(json(&folder.read("out/stone/summary.json"))["tolerance"], 1e-9);
    folder.good(&["run", "stone.toml", "--until", "0.02 min", "--points", "4"]);
    let (_, rows) = csv(&folder.read("out/stone/trajectory.csv"));
    assert_eq!(rows.len(), 5);
    assert_eq!(numbers(&rows)[4][0], 1.2);
    folder.good(&["run", "stone.toml", "--set", "run.until=3 s", "--set", "run.points=6"]);
    assert_eq!(csv(&folder.read("out/stone/trajectory.csv")).1.len(), 7);
}

#[test]
fn json_is_all_there_is_on_stdout() {
    let folder = Folder::new();
    folder.write("stone.toml", &stone(""));
    let printed = json(&folder.good(&["run", "stone.toml", "--json"]));
    let written = json(&folder.read("out/stone/summary.json"));
    assert_eq!(printed, written);
    let called = folder.call(&["run", "stone.toml", "--json", "--plot", "--repeat", "3"]);
    assert_eq!((called.code, called.stderr.as_str()), (0, ""));
    assert!(json(&called.stdout)["run_s_median"].is_number());
    // a run that fails still says so in JSON
    folder.write("stone.toml", &stone("[[guard]]\nname = \"height\"\nquantity = \"x\"\nstop_below = \"8 m\"\n"));
    let called = folder.call(&["run", "stone.toml", "--json"]);
    assert_eq!(called.code, 1);
    assert!(called.stderr.contains("failed: height"), "{}", called.stderr);
    let summary = json(&called.stdout);
    assert_eq!(summary["status"], "failed");
    assert!(summary["reason"].as_str().is_some_and(|r| r.contains("height")));
    let (_, rows) = csv(&folder.read("out/stone/trajectory.csv"));
    assert!(rows.len() > 100, "rows until it failed are kept");
}

#[test]
fn without_the_balance() {
    let folder = Folder::new();
    folder.write("stone.toml", &stone(""));
    assert!(json(&folder.good(&["run", "stone.toml", "--json", "--no-balance"]))["energy_balance"].is_null());
}

#[test]
fn a_failed_run_exits_with_one() {
    let folder = Folder::new();
    let air = "[[force]]\nname = \"air\"\nvalue = \"-0.1[N]*depth\"\ngeometric = \"x\"\n[definitions]\ndepth = \"sqrt(x/1[m])\"\n";
    folder.write("root.toml", &stone(air));
    let called = folder.call(&["run", "root.toml", "--until", "3"]);
    assert_eq!(called.code, 1);
    assert!(called.stderr.starts_with("failed: ") && called.stderr.contains("`depth`"), "{}", called.stderr);
    assert!(called.stderr.contains("NaN"), "{}", called.stderr);
    assert!(called.stdout.contains("failed ") && called.stdout.contains("trajectory.csv"), "{}", called.stdout);
    let (_, rows) = csv(&folder.read("out/root/trajectory.csv"));
    assert!(rows.len() > 100 && numbers(&rows).iter().flatten().all(|x| x.is_finite()));
    assert_eq!(json(&folder.read("out/root/summary.json"))["status"], "failed");
}

#[test]
fn a_stop_event_exits_with_zero() {
    let folder = Folder::new();
    folder.write("stone.toml", &stone("[[event]]\nname = \"ground\"\nquantity = \"x\"\nstop = true\n"));
    let called = folder.call(&["run", "stone.toml", "--until", "10"]);
    assert_eq!(called.code, 0, "{}", called.stderr);
    assert!(called.stdout.contains("stopped event `ground`"), "{}", called.stdout);
    assert!(called.stderr.contains("event `ground`"), "{}", called.stderr);
    let summary = json(&folder.read("out/stone/summary.json"));
    assert_eq!((&summary["status"], &summary["events"]), (&Value::from("stopped"), &Value::from(1)));
    assert!(summary["t_end"].as_f64().is_some_and(|t| (t - (20.0_f64 / 9.81).sqrt()).abs() < 1e-8));
}

#[test]
fn plots_are_drawn() {
    let folder = Folder::new();
    let shown = folder.good(&["run", &model("chaplygin_sleigh.toml"), "--plot", "--points", "50"]);
    let files = folder.files("out/chaplygin_sleigh");
    let (svg, png): (Vec<_>, Vec<_>) =
        files.iter().filter(|f| !f.ends_with(".csv") && !f.ends_with(".json")).partition(|f| f.ends_with(".svg"));
    assert!(!svg.is_empty() && svg.len() == png.len(), "{files:?}");
    for name in svg {
        let text = folder.read(&format!("out/chaplygin_sleigh/{name}"));
        assert!(text.contains("<svg") && text.trim_end().ends_with("</svg>") && !text.contains("NaN"), "{name}");
        assert!(shown.contains(name.as_str()), "{name} is not in\n{shown}");
    }
    for name in png {
        let bytes = std::fs::read(folder.0.join("out/chaplygin_sleigh").join(name)).unwrap_or_default();
        assert_eq!(bytes.get(..8), Some(&b"\x89PNG\r\n\x1a\n"[..]), "{name}");
        assert!(bytes.len() > 2000, "{name}: {} bytes", bytes.len());
    }
    // without [[plot]]: one for each unit
    folder.write("stone.toml", &stone(""));
    folder.good(&["run", "stone.toml", "--plot"]);
    assert_eq!(folder.files("out/stone").iter().filter(|f| f.ends_with(".svg")).count(), 2);
}

/// Rests, single points, what is not a number, equal titles, odd titles: plots of all of it.
#[test]
fn odd_plots_are_drawn() {
    let folder = Folder::new();
    let plots = "[outputs]\ncolumns = [\"x\", \"0*x\", \"sqrt(x/1[m] - 9)\", \"1e300*x\", \"1/(x/1[m] - 10)\"]\n\
        [[plot]]\ntitle = \"same <&> \\\"title\\\"\"\ny = [\"x\"]\n[[plot]]\ntitle = \"same <&> \\\"title\\\"\"\ny = [\"0*x\"]\n\
        [[plot]]\ntitle = \"Höhe/../../über\"\ny = [\"sqrt(x/1[m] - 9)\"]\n[[plot]]\ntitle = \"!!!\"\nx = \"x\"\ny = [\"1e300*x\"]\nequal_axes = true\n\
        [[plot]]\ntitle = \"pole\"\ny = [\"1/(x/1[m] - 10)\"]\n";
    folder.write("stone.toml", &stone(plots));
    for args in [&["--points", "30"][..], &["--at", "0.5"], &["--at", "0,1"]] {
        let all: Vec<&str> =
            ["run", "stone.toml", "--plot", "--out", "plots"].into_iter().chain(args.iter().copied()).collect();
        let called = folder.call(&all);
        assert_eq!(called.code, 0, "{}", called.stderr);
        assert!(called.stderr.lines().all(|l| l.contains("is not finite")), "{}", called.stderr);
        let files = folder.files("plots");
        assert_eq!(files.iter().filter(|f| f.ends_with(".svg")).count(), 5, "{files:?}");
        assert_eq!(files.iter().filter(|f| f.ends_with(".png")).count(), 5, "{files:?}");
    }
}

#[test]
fn headers_with_commas_are_quoted() {
    let folder = Folder::new();
    folder.write("stone.toml", &stone("[outputs]\ncolumns = [\"min(x, x0) [cm]\", \"x\"]\n"));
    folder.good(&["run", "stone.toml"]);
    let text = folder.read("out/stone/trajectory.csv");
    assert_eq!(text.lines().next(), Some("t [s],\"min(x, x0) [cm]\",x [m]"));
    assert!(
        text.lines().nth(1).is_some_and(|l| l.contains(",1.0000000000000000e3,1.0000000000000000e1")),
        "{text:.200}"
    );
}

#[test]
fn the_same_run_writes_the_same_bytes() {
    let folder = Folder::new();
    let run = |out: &str| {
        let called = folder.call(&["run", &model("paper_train_cartesian.toml"), "--out", out]);
        assert_eq!(called.code, 0, "{}", called.stderr);
        folder.read(&format!("{out}/trajectory.csv"))
    };
    assert_eq!(run("a"), run("b"));
}
