//! `headland linearize`: A, B and eigenvalues about the scene's start.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use headland::dynamics::linearise::{LinearState, LineariseError, Linearised, Mode, linearise, pattern, start_of};
use headland::{DeriveOptions, Model, derive, linear_summary};
use serde_json::Value;

use crate::load::{derive_failure, load};
use crate::{Failure, SceneArgs, print};

#[derive(Args)]
pub(crate) struct LinearizeArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// A parameter that serves as input: a torque, a force; several by more of these
    #[arg(long = "input", value_name = "NAME")]
    inputs: Vec<String>,
    /// Folder for linear.json [default: out/MODEL]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Print linear.json instead of tables
    #[arg(long)]
    json: bool,
}

pub(crate) fn linearize(args: &LinearizeArgs) -> Result<(), Failure> {
    let model = load(&args.scene, &[])?;
    let failure = |e: LineariseError| match e {
        LineariseError::Derive(error) => derive_failure(&model, &error),
        LineariseError::UnknownInput { .. } | LineariseError::InputMovesConstraints { .. } => {
            Failure::Input(format!("`--input`: {e}"))
        }
        LineariseError::NoEigenvalues => Failure::Run(e.to_string()),
        other => Failure::Input(other.to_string()),
    };
    let equations = derive(&model, &DeriveOptions::default()).map_err(|e| derive_failure(&model, &e))?;
    let y = start_of(&model, &equations).map_err(|e| derive_failure(&model, &e))?;
    let linear = linearise(&model, &equations, model.run.from, &y, &args.inputs).map_err(failure)?;
    let modes = linear.modes().map_err(failure)?;
    let summary = linear_summary(&model.title, &linear, &modes);
    let file = write(args, &summary)?;
    if args.json {
        return print(&format!("{summary:#}\n"));
    }
    print(&show(&model, &linear, &modes, &file))
}

fn write(args: &LinearizeArgs, summary: &Value) -> Result<PathBuf, Failure> {
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(args.scene.model.file_stem().unwrap_or_default()),
    };
    std::fs::create_dir_all(&folder)
        .map_err(|e| Failure::Input(format!("cannot make the folder `{}`: {e}", folder.display())))?;
    let file = folder.join("linear.json");
    std::fs::write(&file, format!("{summary:#}\n"))
        .map_err(|e| Failure::Run(format!("cannot write `{}`: {e}", file.display())))?;
    Ok(file)
}

fn show(model: &Model, linear: &Linearised, modes: &[Mode], file: &Path) -> String {
    let mut text = String::new();
    let kept = linear.kept();
    let states: Vec<&LinearState> = kept.iter().map(|&i| &linear.states[i]).collect();
    let names: Vec<String> = states.iter().map(|s| s.name.clone()).collect();
    let _ = writeln!(text, "model   {}", model.title);
    let about: Vec<String> = states.iter().map(|s| format!("{} = {} {}", s.name, number(s.value), s.unit)).collect();
    let what = if linear.at_rest { "an equilibrium" } else { "a steady motion" };
    let _ = writeln!(text, "about   {what}: {}", about.join(", "));
    let cyclic: Vec<&str> = linear.states.iter().filter(|s| s.cyclic).map(|s| s.name.as_str()).collect();
    if !cyclic.is_empty() {
        let _ = writeln!(text, "cyclic  {} (nothing depends on them; left out)", cyclic.join(", "));
    }
    let a = linear.reduced_a();
    let there = pattern(&a);
    let _ = write!(text, "\n{}", matrix("A", &names, &names, |i, j| if there[(i, j)] { a[(i, j)] } else { 0.0 }));
    if !linear.inputs.is_empty() {
        let b = linear.reduced_b();
        let inputs: Vec<String> = linear.inputs.iter().map(|s| s.name.clone()).collect();
        let _ = write!(text, "\n{}", matrix("B", &names, &inputs, |i, j| b[(i, j)]));
    }
    let _ = write!(text, "\n{}", eigenvalues(modes, &names));
    let _ = writeln!(text, "\nfiles   {}", file.display());
    text
}

/// A matrix with names, aligned.
fn matrix(title: &str, rows: &[String], columns: &[String], value: impl Fn(usize, usize) -> f64) -> String {
    let mut cells = vec![std::iter::once(title.to_string()).chain(columns.iter().cloned()).collect::<Vec<_>>()];
    for (i, row) in rows.iter().enumerate() {
        let values = (0..columns.len()).map(|j| number(value(i, j)));
        cells.push(std::iter::once(format!("({row})'")).chain(values).collect());
    }
    align(&cells)
}

fn eigenvalues(modes: &[Mode], names: &[String]) -> String {
    let head = ["eigenvalue [1/s]", "frequency [Hz]", "damping", "halves [s]", "doubles [s]", "of"];
    let mut cells = vec![head.map(String::from).to_vec()];
    for mode in modes.iter().filter(|m| m.im >= 0.0) {
        let value =
            if mode.im > 0.0 { format!("{} ± {}i", number(mode.re), number(mode.im)) } else { number(mode.re) };
        let shown = |x: Option<f64>| x.map_or("–".to_string(), number);
        let life = mode.half_life();
        let frequency = if mode.im > 0.0 { number(mode.frequency()) } else { "–".into() };
        let damping = if mode.im > 0.0 { shown(mode.damping()) } else { "–".into() };
        let of: Vec<&str> = mode.states.iter().map(|&i| names[i].as_str()).collect();
        cells.push(vec![
            value,
            frequency,
            damping,
            shown(life.filter(|t| *t > 0.0)),
            shown(life.filter(|t| *t < 0.0).map(|t| -t)),
            of.join(" "),
        ]);
    }
    align(&cells)
}

/// Columns flush right, the first one left.
fn align(cells: &[Vec<String>]) -> String {
    let columns = cells.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| cells.iter().filter_map(|row| row.get(c)).map(|s| s.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in cells {
        for (c, cell) in row.iter().enumerate() {
            let wide = widths[c];
            let _ = if c == 0 { write!(text, "{cell:<wide$}") } else { write!(text, "  {cell:>wide$}") };
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}

/// Seven significant digits.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if (1e-3..1e7).contains(&a) => format!("{x:.*}", (6 - a.log10().floor() as i32).max(0) as usize),
        _ => format!("{x:.6e}"),
    }
}
