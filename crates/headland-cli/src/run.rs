//! `headland run`: derive, integrate, write, show.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use headland::{Model, Run, RunError, RunOptions, Status, summary};

use crate::files::{write_csv, write_plots, write_summary};
use crate::load::{derive_failure, load};
use crate::progress::Progress;
use crate::table::table;
use crate::{Failure, SceneArgs, print};

#[derive(Args)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// End of the run: 20, "20 s", "2 min"
    #[arg(long, allow_hyphen_values = true)]
    until: Option<String>,
    /// Relative tolerance; a state's absolute one is this times its scale
    #[arg(long, allow_hyphen_values = true)]
    tol: Option<String>,
    /// auto, dop853, cvode-bdf, cvode-adams, ida, ida-index1
    #[arg(long)]
    method: Option<String>,
    /// Output at exactly these times, in s: --at 0.75,5,10
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    at: Option<Vec<f64>>,
    /// Output intervals
    #[arg(long)]
    points: Option<String>,
    /// Folder for trajectory.csv, summary.json and plots [default: out/MODEL]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Draw the scene's plots as SVG and PNG
    #[arg(long)]
    plot: bool,
    /// Integrate so many times and report the least and the median time
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Do not keep the account of work and energy
    #[arg(long)]
    no_balance: bool,
    /// Print the summary as JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let settings = [("run.until", &args.until), ("run.tolerance", &args.tol), ("run.points", &args.points)];
    let settings: Vec<(String, String)> =
        settings.iter().filter_map(|(name, value)| value.as_ref().map(|v| (name.to_string(), v.clone()))).collect();
    let model = load(&args.scene, &settings)?;
    let options = options(args, &model)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(args.scene.model.file_stem().unwrap_or_default()),
    };
    std::fs::create_dir_all(&folder)
        .map_err(|e| Failure::Input(format!("cannot make the folder `{}`: {e}", folder.display())))?;

    let mut progress = Progress::new(options.from, options.until, args.json);
    let result = headland::run(&model, &options, &mut progress);
    progress.finish();
    if result.is_err() {
        let _ = std::fs::remove_dir(&folder); // only if it is empty: nothing was computed
    }
    let result = result.map_err(|e| match e {
        RunError::Derive(error) => derive_failure(&model, &error),
        other => other.into(),
    })?;

    // Whatever was computed is on disk before anything is said about how it ended.
    write_csv(&folder.join("trajectory.csv"), &result.trajectory)?;
    write_summary(&folder.join("summary.json"), &result.report)?;
    let mut files = vec![folder.join("trajectory.csv"), folder.join("summary.json")];
    if args.plot {
        files.extend(write_plots(&folder, &model, &result.trajectory)?);
    }
    let told = if args.json {
        print(&format!("{:#}\n", summary(&result.report)))
    } else {
        print(&show(&model, &result, &files, args.at.is_some()))
    };
    match result.report.status {
        Status::Failed(reason) => Err(Failure::Run(reason)),
        _ => told,
    }
}

fn options(args: &RunArgs, model: &Model) -> Result<RunOptions, Failure> {
    let mut options = RunOptions::of(model);
    if let Some(method) = &args.method {
        options.method.clone_from(method);
    }
    options.at.clone_from(&args.at);
    if let (Some(at), None) = (&args.at, &args.until) {
        if let Some(t) = at.iter().find(|t| !t.is_finite()) {
            return Err(Failure::Input(format!("`--at`: {t} is not a time")));
        }
        options.until = at.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    }
    options.repeat = args.repeat as usize;
    options.balance = !args.no_balance;
    Ok(options)
}

/// The table and what was counted.
fn show(model: &Model, result: &Run, files: &[PathBuf], all_rows: bool) -> String {
    let r = &result.report;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "model   {}: {} coordinates, {} degree(s) of freedom",
        model.title, r.coordinates, r.degrees_of_freedom
    );
    let _ = writeln!(text, "method  {} ({}), tolerance {:e}", r.method, r.why, r.tolerance);
    text.push_str(&table(&result.trajectory, all_rows));
    let ended = match &r.status {
        Status::Done => format!("done    t = {} s", r.t_end),
        Status::Stopped(reason) => format!("stopped {reason}"),
        Status::Failed(_) => format!("failed  at t = {} s", r.t_end),
    };
    let rest = if r.rejected > 0 { format!(" ({} rejected)", r.rejected) } else { String::new() };
    let _ = writeln!(
        text,
        "{ended} in {}: {}{rest}, {} evaluations of {} operations; derived in {}, compiled in {}",
        seconds(r.run_s),
        many(r.steps as usize, "step"),
        r.rhs,
        r.operations,
        seconds(r.derive_s),
        seconds(r.compile_s)
    );
    if let Some(median) = r.run_s_median {
        let _ = writeln!(text, "repeats least {}, median {}", seconds(r.run_s), seconds(median));
    }
    if let Some(defect) = r.energy_balance {
        let _ = writeln!(text, "energy  work and energy balance to {defect:.1e}");
    }
    if let Some(residual) = r.constraint_velocity {
        let _ = writeln!(text, "constraints are kept to {residual:.1e}");
    }
    if r.mode_changes > 0 {
        let _ = writeln!(
            text,
            "contacts changed between rolling, sliding and free {}",
            many(r.mode_changes as usize, "time")
        );
    }
    if r.repartitions > 0 {
        let _ = writeln!(text, "independent rates changed {}", many(r.repartitions as usize, "time"));
    }
    let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    let _ = writeln!(text, "files   {}", names.join(", "));
    text
}

/// `1 step`, `2 steps`.
fn many(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// A time a person can read.
fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-3 => format!("{:.0} us", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}
