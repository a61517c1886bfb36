//! Aligned tables for people; programs read trajectory.csv.

use std::fmt::Write;

use headland::Trajectory;

const WIDTH: usize = 118;
const ROWS: usize = 16;

/// The trajectory as a table of at most so many rows and columns.
pub(crate) fn table(trajectory: &Trajectory, all_rows: bool) -> String {
    let titles: Vec<String> = std::iter::once("t [s]".to_string()).chain(titles(trajectory)).collect();
    let n = trajectory.rows.len();
    let rows: Vec<usize> = match n {
        0 => Vec::new(),
        n if n <= ROWS || all_rows => (0..n).collect(),
        n => {
            let intervals = round_intervals(&trajectory.t);
            (0..=intervals).map(|i| i * (n - 1) / intervals).collect()
        }
    };
    let cell = |row: usize, column: usize| match column {
        0 => short(trajectory.t[row]),
        c => number(trajectory.rows[row][c - 1]),
    };
    let mut columns: Vec<Vec<String>> = Vec::new();
    let mut width = 0;
    for (c, title) in titles.iter().enumerate() {
        let cells: Vec<String> = std::iter::once(title.clone()).chain(rows.iter().map(|&r| cell(r, c))).collect();
        let wide = cells.iter().map(|s| s.chars().count()).max().unwrap_or(0) + 2;
        if c > 1 && width + wide > WIDTH {
            break;
        }
        width += wide;
        columns.push(cells.into_iter().map(|s| format!("{s:>wide$}")).collect());
    }
    let mut text = String::new();
    for r in 0..=rows.len() {
        for column in &columns {
            text.push_str(&column[r]);
        }
        text.push('\n');
    }
    if columns.len() < titles.len() {
        let hidden = &titles[columns.len()..];
        let named = hidden.iter().take(10).cloned().collect::<Vec<_>>().join(", ");
        let more = if hidden.len() > 10 { ", …" } else { "" };
        let _ = writeln!(text, "  … {} more columns in trajectory.csv: {named}{more}", hidden.len());
    }
    text
}

/// How many intervals to show so that their times are round; as many as possible if none are.
fn round_intervals(t: &[f64]) -> usize {
    let n = t.len() - 1;
    let step = |c: usize| short(t[n / c] - t[0]).len();
    let even = (8..ROWS).rev().filter(|c| n.is_multiple_of(*c));
    even.min_by_key(|c| (step(*c).max(3), ROWS - c)).unwrap_or(ROWS - 1)
}

/// `name [unit]` of the outputs.
pub(crate) fn titles(trajectory: &Trajectory) -> Vec<String> {
    trajectory.names.iter().zip(&trajectory.units).map(|(n, u)| format!("{n} [{u}]")).collect()
}

/// Seven significant digits.
fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    match x.abs() {
        a if (1e-3..1e7).contains(&a) => format!("{x:.*}", (6 - a.log10().floor() as i32).max(0) as usize),
        _ => format!("{x:.6e}"),
    }
}

/// As few digits as tell the number, at most nine.
fn short(x: f64) -> String {
    let rounded: f64 = format!("{x:.9}").parse().unwrap_or(x);
    format!("{rounded}")
}
