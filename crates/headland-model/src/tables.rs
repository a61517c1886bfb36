//! Tables of two variables: `ground = { x = [..], y = [..], z = [[..], ..] }` or `{ file = "ground.csv" }`.

use std::path::Path;
use std::sync::Arc;

use headland_expr::parse::suggestion;
use headland_surface::grid::{Grid, Layout, read_csv};

use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::scene::{Data, Entry, Value};
use crate::symbols::Symbol;
use crate::units::parse_unit;

/// Keys of a table of two variables.
const KEYS: [&str; 7] = ["x", "y", "z", "x_unit", "y_unit", "z_unit", "file"];
/// Distances of points that differ by less than this part are equal.
const EVEN: f64 = 1e-6;

/// Whether a table is one of two variables.
pub(crate) fn is_of_two(fields: &[Entry]) -> bool {
    fields.iter().any(|field| matches!(field.key.as_str(), "z" | "z_unit" | "file"))
}

impl Builder<'_, '_> {
    /// Declares a table of two variables, a smooth [`Grid`] through its points.
    pub(crate) fn table_of_two(&mut self, entry: &Entry, fields: &[Entry]) -> Made<()> {
        let unknown = fields.iter().find(|field| !KEYS.contains(&field.key.as_str()));
        if let Some(field) = unknown {
            let hint = suggestion(&field.key, KEYS);
            let message = format!(
                "a table of two variables has x, y and z or a file, and x_unit, y_unit, z_unit, not `{}`{hint}",
                field.key
            );
            return Err(self.low.report(field.key_place.clone(), message));
        }
        let get = |key: &str| fields.iter().find(|field| field.key == key);
        let points = ["x", "y", "z"].map(get);
        let grid = match (get("file"), points) {
            (Some(file), [None, None, None]) => self.grid_of_file(&entry.key, &file.value)?,
            (Some(_), [x, y, z]) => {
                let place = x.or(y).or(z).map_or(&entry.key_place, |field| &field.key_place);
                let message = format!("the table `{}` has points in its file already", entry.key);
                return Err(self.low.report(place.clone(), message));
            }
            (None, [Some(x), Some(y), Some(z)]) => self.grid_of_points(entry, [&x.value, &y.value, &z.value])?,
            _ => {
                let message = "a table of two variables is written `{ x = [..], y = [..], z = [[..], ..] }`, a row of z \
                               for each y, or `{ file = \"ground.csv\" }` with lines `x, y, z`";
                return Err(self.low.report(entry.value.place.clone(), message));
            }
        };
        let (mut factors, mut dimensions) = ([1.0; 3], [const { Dimension::NONE }; 3]);
        for (i, key) in ["x_unit", "y_unit", "z_unit"].into_iter().enumerate() {
            let Some(field) = get(key) else {
                dimensions[i] = self.low.unifier.unknown();
                continue;
            };
            let Data::Text(text) = &field.value.data else {
                let message = format!("`{key}` is {}; a unit was expected", field.value.data.kind());
                return Err(self.low.report(field.value.place.clone(), message));
            };
            let unit = parse_unit(text).map_err(|message| self.low.report(field.value.place.clone(), message))?;
            (factors[i], dimensions[i]) = (unit.to_si(1.0), unit.dimension);
        }
        let field = Arc::new(grid.scaled(factors));
        self.low.symbols.by_name.insert(entry.key.as_str().into(), Symbol::Field(field, dimensions));
        Ok(())
    }

    /// From lines `x, y, z`; the file's name counts from the folder of the scene.
    fn grid_of_file(&mut self, name: &str, value: &Value) -> Made<Grid> {
        let Data::Text(file) = &value.data else {
            let message =
                format!("the file of a table is {}; a name such as `\"ground.csv\"` was expected", value.data.kind());
            return Err(self.low.report(value.place.clone(), message));
        };
        let folder = Path::new(&*self.scene.source.name).parent().unwrap_or(Path::new(""));
        let path = folder.join(file);
        let source = std::fs::File::open(&path).map_err(|error| {
            let message = format!("cannot read `{}` (names count from the scene's folder): {error}", path.display());
            self.low.report(value.place.clone(), message)
        })?;
        let grid = read_csv(name, source, Layout::Points);
        grid.map_err(|error| self.low.report(value.place.clone(), format!("{}: {error}", path.display())))
    }

    /// From arrays that stand in the scene.
    fn grid_of_points(&mut self, entry: &Entry, [x, y, z]: [&Value; 3]) -> Made<Grid> {
        let (x0, dx, columns) = self.even(x, "x")?;
        let (y0, dy, rows) = self.even(y, "y")?;
        let Data::Array(lines) = &z.data else {
            return Err(self
                .low
                .report(z.place.clone(), "the heights of a table are rows of numbers, `z = [[..], ..]`"));
        };
        if lines.len() != rows {
            let message = format!("z has {} row(s), but y has {rows} point(s): a row of z for each y", lines.len());
            return Err(self.low.report(z.place.clone(), message));
        }
        let mut heights = Vec::with_capacity(rows);
        for (row, line) in lines.iter().enumerate() {
            let numbers = self.numbers(line, "a row of z")?;
            if numbers.len() != columns {
                let found = numbers.len();
                let message = format!("row {} of z has {found} number(s), but x has {columns} point(s)", row + 1);
                return Err(self.low.report(line.place.clone(), message));
            }
            heights.push(numbers);
        }
        let grid = Grid::new(&entry.key, [x0, y0], [dx, dy], &heights);
        grid.map_err(|error| self.low.report(entry.value.place.clone(), error.to_string()))
    }

    fn numbers(&mut self, value: &Value, what: &str) -> Made<Vec<f64>> {
        let Data::Array(values) = &value.data else {
            let message = format!("{what} is {}; an array of numbers was expected", value.data.kind());
            return Err(self.low.report(value.place.clone(), message));
        };
        let number = |value: &Value| match value.data {
            Data::Number(x) => Ok(x),
            _ => Err(value.place.clone()),
        };
        let numbers: Result<Vec<f64>, _> = values.iter().map(number).collect();
        numbers.map_err(|place| self.low.report(place, "the points of a table are numbers"))
    }

    /// First point, distance and number of points along an axis.
    fn even(&mut self, value: &Value, axis: &str) -> Made<(f64, f64, usize)> {
        let points = self.numbers(value, axis)?;
        let (Data::Array(values), [first, second, ..]) = (&value.data, &points[..]) else {
            let message =
                format!("{axis} has {} point(s); a smooth table needs at least 6 along each axis", points.len());
            return Err(self.low.report(value.place.clone(), message));
        };
        let step = second - first;
        for (k, x) in points.iter().enumerate().skip(1) {
            let wanted = first + k as f64 * step;
            if step <= 0.0 || (x - wanted).abs() > EVEN * step * k as f64 {
                let expected = if step > 0.0 { format!(", and {wanted} was expected") } else { String::new() };
                let message =
                    format!("the points of {axis} must grow by even steps, but point {} is {x}{expected}", k + 1);
                return Err(self.low.report(values[k].place.clone(), message));
            }
        }
        let last = points[points.len() - 1];
        Ok((*first, (last - first) / (points.len() - 1) as f64, points.len()))
    }
}
