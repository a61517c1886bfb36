//! Grids from text: heights by rows, or points `x, y, z`.

use std::collections::BTreeMap;
use std::io::Read;

use super::{Grid, GridError};

/// What a file of numbers separated by commas holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// One line a row of heights: the first line at the least y, the first column at the least x.
    Heights {
        /// Place of the first height, m.
        origin: [f64; 2],
        /// Distances of columns and rows, m.
        spacing: [f64; 2],
    },
    /// One line a point `x, y, z`, m, in any order; a first line of words is passed over.
    Points,
}

/// Places that differ by less than this part of the spacing are one.
const SAME: f64 = 1e-6;

/// A grid from a file; lines that begin with `#` are comments.
///
/// # Errors
/// [`GridError`] names row and column, or the line.
pub fn read_csv(name: &str, source: impl Read, layout: Layout) -> Result<Grid, GridError> {
    let mut reader = ::csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(::csv::Trim::All)
        .from_reader(source);
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| GridError::Read { name: name.into(), reason: e.to_string() })?;
        lines.push(record);
    }
    match layout {
        Layout::Heights { origin, spacing } => {
            let rows = lines.iter().enumerate().map(|(row, record)| numbers(name, row, record));
            Grid::new(name, origin, spacing, &rows.collect::<Result<Vec<_>, _>>()?)
        }
        Layout::Points => points(name, &lines),
    }
}

fn numbers(name: &str, row: usize, record: &::csv::StringRecord) -> Result<Vec<f64>, GridError> {
    let hole = |column: usize, found: &str| GridError::Hole {
        name: name.into(),
        row: row + 1,
        column: column + 1,
        found: found.into(),
    };
    record.iter().enumerate().map(|(column, text)| text.parse().map_err(|_| hole(column, text))).collect()
}

fn points(name: &str, lines: &[::csv::StringRecord]) -> Result<Grid, GridError> {
    let read = |reason: String| GridError::Read { name: name.into(), reason };
    let mut all = Vec::new();
    for (i, record) in lines.iter().enumerate() {
        let line = record.position().map_or(i as u64 + 1, ::csv::Position::line);
        let parsed: Option<Vec<f64>> =
            record.iter().map(|text| text.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        match parsed.as_deref() {
            Some(&[x, y, z]) => all.push(([x, y, z], line)),
            None if i == 0 => {}
            _ => {
                let text = record.iter().collect::<Vec<_>>().join(", ");
                return Err(read(format!("line {line} should be three numbers x, y, z, but is `{text}`")));
            }
        }
    }
    let axis = |k: usize, letter| even(name, letter, all.iter().map(|(p, _)| p[k]).collect());
    let (x, y) = (axis(0, 'x')?, axis(1, 'y')?);
    let mut found = BTreeMap::new();
    for ([px, py, z], line) in all {
        if found.insert((y.index(py), x.index(px)), z).is_some() {
            return Err(GridError::Twice { name: name.into(), x: px, y: py, line });
        }
    }
    // a point that is missing becomes a hole with row and column
    let rows: Vec<Vec<f64>> = (0..y.count)
        .map(|row| (0..x.count).map(|column| *found.get(&(row, column)).unwrap_or(&f64::NAN)).collect())
        .collect();
    Grid::new(name, [x.start, y.start], [x.step, y.step], &rows)
}

/// Evenly spaced places.
struct Even {
    start: f64,
    step: f64,
    count: usize,
}

impl Even {
    fn index(&self, place: f64) -> usize {
        ((place - self.start) / self.step).round() as usize
    }
}

fn even(name: &str, axis: char, mut places: Vec<f64>) -> Result<Even, GridError> {
    places.sort_by(f64::total_cmp);
    let (Some(&start), Some(&end)) = (places.first(), places.last()) else {
        return Err(GridError::TooSmall { name: name.into(), rows: 0, columns: 0 });
    };
    let same = SAME * (end - start) / places.len() as f64;
    places.dedup_by(|b, a| *b - *a <= same);
    let count = places.len();
    if count < 2 {
        return Err(GridError::TooSmall { name: name.into(), rows: count, columns: count });
    }
    let expected = places[1] - places[0];
    for pair in places.windows(2) {
        let found = pair[1] - pair[0];
        if (found - expected).abs() > 1e-3 * expected {
            return Err(GridError::Uneven { name: name.into(), axis, from: pair[0], found, expected });
        }
    }
    Ok(Even { start, step: (end - start) / (count - 1) as f64, count })
}
