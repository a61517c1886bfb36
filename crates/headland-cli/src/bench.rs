//! `headland bench`: time against error, for methods and tolerances side by side in one process.
//!
//! A subject is a reference problem, judged by its reference values, or a scene file, judged by its own run at a much
//! tighter tolerance. The time is that of the integration alone, the least of several runs.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use headland::{Method, Model, Run, RunOptions, Silent, Status};
use serde_json::json;

use crate::load::load;
use crate::plot::{Figure, Series};
use crate::{Failure, SceneArgs, print, tell};

/// Tolerance and method of the run that judges a scene file.
const JUDGE: (&str, f64) = ("dop853", 1e-13);

#[derive(Args)]
pub(crate) struct BenchArgs {
    /// Names of reference problems, or parts of names (`ball`), or one scene file
    #[arg(required = true)]
    subjects: Vec<String>,
    /// Set a parameter of the scene file
    #[arg(long = "set", value_name = "NAME=VALUE")]
    sets: Vec<String>,
    /// Methods
    #[arg(long, value_delimiter = ',', default_value = "dop853,cvode-adams,cvode-bdf")]
    methods: Vec<String>,
    /// Tolerances
    #[arg(long, value_delimiter = ',', default_value = "1e-4,1e-6,1e-8,1e-10,1e-12")]
    tols: Vec<f64>,
    /// Runs of each row; the least time counts
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Do not keep the account of work and energy
    #[arg(long)]
    no_balance: bool,
    /// Folder for the plots [default: out/bench]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Draw error over time as SVG and PNG
    #[arg(long)]
    plot: bool,
    /// As JSON
    #[arg(long)]
    json: bool,
}

/// The error of a run; `None` where it has no value at a reference's time.
type Judge = Box<dyn Fn(&Run) -> Option<f64>>;

/// What is run, and how it is judged.
struct Subject {
    name: String,
    model: Model,
    options: RunOptions,
    judge: Judge,
    judged_by: String,
}

/// One run.
struct Row {
    method: &'static str,
    tolerance: f64,
    outcome: Result<Numbers, String>,
}

struct Numbers {
    seconds: f64,
    error: f64,
    steps: u64,
    rhs: u64,
    jacobians: u64,
    balance: Option<f64>,
}

pub(crate) fn bench(args: &BenchArgs) -> Result<(), Failure> {
    let methods: Vec<Method> = args.methods.iter().map(|m| Method::parse(m)).collect::<Result<_, _>>()?;
    if let Some(tol) = args.tols.iter().find(|t| !(t.is_finite() && **t > 0.0)) {
        return Err(Failure::Input(format!("`--tols`: {tol} is not a tolerance")));
    }
    let subjects = subjects(args)?;
    let mut all = Vec::new();
    for subject in &subjects {
        let mut rows = Vec::new();
        for method in methods.iter().filter(|m| m.is_built()) {
            for &tolerance in &args.tols {
                if !args.json {
                    tell(&format!("{}: {} at {tolerance:e}", subject.name, method.name()));
                }
                rows.push(Row {
                    method: method.name(),
                    tolerance,
                    outcome: measure(subject, *method, tolerance, args),
                });
            }
        }
        if !args.json {
            print(&table(subject, &rows))?;
        }
        if args.plot {
            draw(subject, &rows, args)?;
        }
        all.push(as_json(subject, &rows));
    }
    if args.json {
        print(&format!("{:#}\n", serde_json::Value::Array(all)))?;
    }
    Ok(())
}

fn subjects(args: &BenchArgs) -> Result<Vec<Subject>, Failure> {
    if let [one] = args.subjects.as_slice()
        && (one.ends_with(".toml") || Path::new(one).is_file())
    {
        return Ok(vec![of_scene(one, args)?]);
    }
    if !args.sets.is_empty() {
        return Err(Failure::Input("`--set` goes with a scene file; reference problems are as they are".into()));
    }
    #[cfg(feature = "validate")]
    return of_cases(&args.subjects);
    #[cfg(not(feature = "validate"))]
    Err(Failure::Input("built without reference problems (feature `validate`): name a scene file".into()))
}

/// A scene, judged by itself.
fn of_scene(path: &str, args: &BenchArgs) -> Result<Subject, Failure> {
    let model = load(&SceneArgs { model: path.into(), sets: args.sets.clone() }, &[])?;
    let options = RunOptions::of(&model);
    let mut tight = RunOptions { tolerance: JUDGE.1, method: JUDGE.0.into(), balance: false, ..options.clone() };
    tight.at = Some(vec![options.until]);
    let judge = headland::run(&model, &tight, &mut Silent)?;
    if let Status::Failed(reason) = &judge.report.status {
        return Err(Failure::Run(format!("the run that should judge the others: {reason}")));
    }
    let reference = judge.trajectory.rows.last().cloned().unwrap_or_default();
    let error = move |run: &Run| {
        let values = run.trajectory.rows.last()?.iter().zip(&reference);
        Some(values.map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max))
    };
    let judged_by = format!("all columns at the end, by the scene's own run with {} at {:e}", JUDGE.0, JUDGE.1);
    let options = RunOptions { at: Some(vec![options.until]), ..options };
    Ok(Subject { name: model.title.clone(), model, options, judge: Box::new(error), judged_by })
}

#[cfg(feature = "validate")]
fn of_cases(names: &[String]) -> Result<Vec<Subject>, Failure> {
    let wanted = |name: &str| names.iter().any(|n| name.contains(n.as_str()));
    let mut found = Vec::new();
    for case in headland_validation::cases().filter(|c| wanted(c.name)) {
        let expected = (case.expected)();
        let (model, options) = case.prepare(&expected, &[])?;
        let judge = move |run: &Run| {
            let error = |e: &headland_validation::Expected| {
                let value = headland_validation::value_of(run, e)?;
                Some((value - e.value).abs() / e.value.abs().max(1.0))
            };
            expected.iter().map(error).try_fold(0.0, |worst: f64, e| Some(worst.max(e?)))
        };
        found.push(Subject {
            name: case.name.into(),
            model,
            options,
            judge: Box::new(judge),
            judged_by: format!("reference values: {}", case.source),
        });
    }
    if found.is_empty() {
        let known = headland_validation::cases().map(|c| c.name).collect::<Vec<_>>().join(", ");
        return Err(Failure::Input(format!("no reference problem is called {}; known: {known}", names.join(", "))));
    }
    Ok(found)
}

fn measure(subject: &Subject, method: Method, tolerance: f64, args: &BenchArgs) -> Result<Numbers, String> {
    let options = RunOptions {
        tolerance,
        method: method.name().into(),
        repeat: args.repeat as usize,
        balance: !args.no_balance,
        ..subject.options.clone()
    };
    let run = headland::run(&subject.model, &options, &mut Silent).map_err(|e| e.to_string())?;
    if let Status::Failed(reason) = &run.report.status {
        return Err(reason.clone());
    }
    let error = (subject.judge)(&run).ok_or("no value at the time of a reference value")?;
    let r = &run.report;
    Ok(Numbers {
        seconds: r.run_s,
        error,
        steps: r.steps,
        rhs: r.rhs,
        jacobians: r.jacobians,
        balance: r.energy_balance,
    })
}

fn table(subject: &Subject, rows: &[Row]) -> String {
    let mut text = format!("{}\njudged by {}\n", subject.name, subject.judged_by);
    let _ = writeln!(
        text,
        "{:<12} {:>8} {:>11} {:>9} {:>8} {:>9} {:>6} {:>9}",
        "method", "tol", "time [ms]", "error", "steps", "rhs", "jac", "balance"
    );
    for row in rows {
        let _ = write!(text, "{:<12} {:>8.0e} ", row.method, row.tolerance);
        let _ = match &row.outcome {
            Ok(n) => writeln!(
                text,
                "{:>11.4} {:>9.1e} {:>8} {:>9} {:>6} {:>9}",
                n.seconds * 1e3,
                n.error,
                n.steps,
                n.rhs,
                n.jacobians,
                n.balance.map_or("-".to_string(), |b| format!("{b:.1e}"))
            ),
            Err(reason) => writeln!(text, "failed: {reason}"),
        };
    }
    text.push('\n');
    text
}

fn as_json(subject: &Subject, rows: &[Row]) -> serde_json::Value {
    let row = |r: &Row| match &r.outcome {
        Ok(n) => json!({ "method": r.method, "tolerance": r.tolerance, "run_s": n.seconds, "error": n.error,
            "steps": n.steps, "rhs": n.rhs, "jacobians": n.jacobians, "energy_balance": n.balance }),
        Err(reason) => json!({ "method": r.method, "tolerance": r.tolerance, "failed": reason }),
    };
    json!({ "name": subject.name, "judged_by": subject.judged_by, "rows": rows.iter().map(row).collect::<Vec<_>>() })
}

/// Decimal logarithms of error over those of time, one curve a method.
fn draw(subject: &Subject, rows: &[Row], args: &BenchArgs) -> Result<(), Failure> {
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("out/bench"));
    std::fs::create_dir_all(&folder)
        .map_err(|e| Failure::Input(format!("cannot make the folder `{}`: {e}", folder.display())))?;
    let mut curves: Vec<(&str, Vec<f64>, Vec<f64>)> = Vec::new();
    for row in rows {
        let Ok(n) = &row.outcome else { continue };
        let (x, y) = (n.seconds.log10(), n.error.max(1e-17).log10());
        match curves.last_mut().filter(|(method, ..)| *method == row.method) {
            Some((_, xs, ys)) => {
                xs.push(x);
                ys.push(y);
            }
            None => curves.push((row.method, vec![x], vec![y])),
        }
    }
    let series = curves.iter().map(|(name, x, y)| Series { name, x, y }).collect();
    let figure =
        Figure { title: &subject.name, x_label: "lg(time [s])", y_label: "lg(error)", equal_axes: false, series };
    let stem = folder.join(crate::files::slug(&subject.name));
    let (svg, png) = (stem.with_extension("svg"), stem.with_extension("png"));
    figure.write_svg(&svg).and_then(|()| figure.write_png(&png)).map_err(|e| Failure::Run(e.to_string()))?;
    tell(&format!("drawn {}, {}", svg.display(), png.display()));
    Ok(())
}
