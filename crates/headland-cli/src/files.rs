//! What a run leaves on disk: trajectory.csv, summary.json, plots.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use headland::{Model, RunReport, Trajectory, summary};

use crate::Failure;
use crate::plot::{Figure, Series};
use crate::table::titles;

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|e| Failure::Run(format!("cannot write `{}`: {e}", path.display())))
}

/// A table with a header `name [unit]` and 17 significant digits.
pub(crate) fn write_csv(path: &Path, trajectory: &Trajectory) -> Result<(), Failure> {
    let mut text = String::with_capacity(32 * trajectory.t.len() * (1 + trajectory.names.len()));
    text.push_str("t [s]");
    for title in titles(trajectory) {
        let quoted = if title.contains([',', '"']) { format!("\"{}\"", title.replace('"', "\"\"")) } else { title };
        text.push(',');
        text.push_str(&quoted);
    }
    text.push('\n');
    for (t, row) in trajectory.t.iter().zip(&trajectory.rows) {
        let _ = write!(text, "{t:.16e}");
        for x in row {
            let _ = write!(text, ",{x:.16e}");
        }
        text.push('\n');
    }
    write(path, &text)
}

/// Writes the summary.
pub(crate) fn write_summary(path: &Path, report: &RunReport) -> Result<(), Failure> {
    write(path, &format!("{:#}\n", summary(report)))
}

/// Draws the scene's plots, or every unit's outputs over time; gives the files.
pub(crate) fn write_plots(folder: &Path, model: &Model, trajectory: &Trajectory) -> Result<Vec<PathBuf>, Failure> {
    let columns: Vec<Vec<f64>> = (0..trajectory.names.len()).map(|i| trajectory.column(i)).collect();
    let labels = titles(trajectory);
    let mut files = Vec::new();
    for plot in plots(model, trajectory) {
        let x_label = plot.x.map_or("t [s]".to_string(), |i| labels[i].clone());
        let unit = plot.y.first().map_or("", |i| trajectory.units[*i].as_str());
        let y_label = match plot.y.as_slice() {
            [i] => labels[*i].clone(),
            _ => format!("[{unit}]"),
        };
        let x = plot.x.map_or(trajectory.t.as_slice(), |i| columns[i].as_slice());
        let series = plot.y.iter().map(|&i| Series { name: &trajectory.names[i], x, y: &columns[i] }).collect();
        let figure =
            Figure { title: &plot.title, x_label: &x_label, y_label: &y_label, equal_axes: plot.equal_axes, series };
        let name = slug(&plot.title);
        let numbered = (2..).map(|n| folder.join(format!("{name}_{n}")));
        let mut stems = std::iter::once(folder.join(&name)).chain(numbered); // titles may be equal
        let Some(stem) = stems.find(|s| !files.contains(&s.with_extension("svg"))) else { continue };
        for (extension, drawn) in [
            ("svg", figure.write_svg(&stem.with_extension("svg"))),
            ("png", figure.write_png(&stem.with_extension("png"))),
        ] {
            drawn.map_err(|e| Failure::Run(e.to_string()))?;
            files.push(stem.with_extension(extension));
        }
    }
    Ok(files)
}

fn plots(model: &Model, trajectory: &Trajectory) -> Vec<headland::model::Plot> {
    if !model.plots.is_empty() {
        return model.plots.clone();
    }
    let mut units: Vec<&str> = trajectory.units.iter().map(String::as_str).collect();
    units.sort_unstable();
    units.dedup();
    units
        .into_iter()
        .map(|unit| {
            let y: Vec<usize> = (0..trajectory.units.len()).filter(|&i| trajectory.units[i] == unit).collect();
            headland::model::Plot { title: format!("outputs in {unit}"), x: None, y, equal_axes: false }
        })
        .collect()
}

/// A file name made of a title.
pub(crate) fn slug(title: &str) -> String {
    let mut slug = String::new();
    for c in title.chars().flat_map(char::to_lowercase) {
        if c.is_alphanumeric() {
            slug.push(c);
        } else if !slug.ends_with('_') && !slug.is_empty() {
            slug.push('_');
        }
    }
    let slug = slug.trim_end_matches('_').to_string();
    if slug.is_empty() { "plot".into() } else { slug }
}
