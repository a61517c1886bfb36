//! Line plots of results, to SVG and PNG: drawn by [`plotters`], painted by [`resvg`] with the embedded DejaVu Sans.
//!
//! Ours are only the ranges, the digits of the labels and the thinning of long curves.

use plotters::coord::{ranged1d::BoldPoints, types::RangedCoordf64};
use plotters::{
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};
use resvg::{tiny_skia, usvg};
use std::{error::Error, fs, io, ops::Range, path::Path, path::PathBuf};

/// One curve: samples `(x, y)` in display units.
///
/// A sample that is not finite is a gap. One sample alone is drawn as a dot.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Abscissas, as many as [`Self::y`].
    pub x: &'a [f64],
    /// Ordinates, as many as [`Self::x`].
    pub y: &'a [f64],
}

/// A figure with one set of axes: 900 × 600 px, as PNG 1800 × 1200. The same figure gives the same bytes every time.
#[derive(Clone, Debug)]
pub struct Figure<'a> {
    /// Line above the axes; may be empty.
    pub title: &'a str,
    /// Name and unit of the abscissa; may be empty.
    pub x_label: &'a str,
    /// Name and unit of the ordinate; may be empty.
    pub y_label: &'a str,
    /// The same scale in x and y: a path seen from above.
    pub equal_axes: bool,
    /// The curves, first at the back; a legend names the first ten when there are several.
    pub series: Vec<Series<'a>>,
}

/// Why a figure could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A curve has not as many abscissas as ordinates.
    #[error("curve `{series}` has {x} abscissas but {y} ordinates; they must be as many")]
    LengthMismatch {
        /// Name of the curve.
        series: String,
        /// Number of abscissas.
        x: usize,
        /// Number of ordinates.
        y: usize,
    },
    /// The libraries that draw could not do it.
    #[error("the figure could not be drawn: {0}")]
    Draw(#[source] Box<dyn Error + Send + Sync>),
    /// The file could not be written.
    #[error("cannot write the figure to `{}`: {source}", path.display())]
    Write {
        /// The file asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Units of the drawing per pixel: plotters has whole coordinates only.
const PX: i32 = 10;
const WIDTH: i32 = 900 * PX;
const HEIGHT: i32 = 600 * PX;
/// Colours that differ for all kinds of colour vision (Okabe and Ito, *Color universal design*, 2008), without yellow,
/// which is too light for a line on white.
const COLORS: [u32; 7] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0];

type Point = (f64, f64);
type Drawn<T> = Result<T, Box<dyn Error + Send + Sync>>;

impl Figure<'_> {
    /// Writes the figure as SVG, with text that can be searched and edited.
    pub fn write_svg(&self, path: &Path) -> Result<(), PlotError> {
        write(path, self.to_svg()?.as_bytes())
    }

    /// Writes the figure as PNG, two pixels for each of the SVG.
    pub fn write_png(&self, path: &Path) -> Result<(), PlotError> {
        write(path, &to_png(&self.to_svg()?).map_err(PlotError::Draw)?)
    }

    fn to_svg(&self) -> Result<String, PlotError> {
        match self.series.iter().find(|s| s.x.len() != s.y.len()) {
            None => self.draw().map_err(PlotError::Draw),
            Some(s) => Err(PlotError::LengthMismatch { series: s.name.to_owned(), x: s.x.len(), y: s.y.len() }),
        }
    }

    fn draw(&self) -> Drawn<String> {
        let named = if self.series.len() > 1 { 10 } else { 0 };
        let names: Vec<String> = self.series.iter().take(named).map(|s| clean(s.name, 28)).collect();
        let longest = names.iter().map(|name| name.chars().count()).max();
        let legend = longest.map_or(0, |n| 44 * PX + text_width(n));

        let (top, right, bottom) = (48 * PX, 40 * PX + legend, 62 * PX);
        let [_, y] = self.ranges([WIDTH - 80 * PX - right, HEIGHT - top - bottom]);
        let left = 56 * PX + text_width(Axis::new(&y, 10).letters.max(5));
        let width = WIDTH - left - right;
        let [x, y] = self.ranges([width, HEIGHT - top - bottom]);
        let most = width / (text_width(Axis::new(&x, 11).letters) + 16 * PX);
        let x = Axis::new(&x, most.clamp(2, 11) as usize);
        let y = Axis::new(&y, 10);

        let mut svg = String::new();
        let root = SVGBackend::with_string(&mut svg, (WIDTH as u32, HEIGHT as u32)).into_drawing_area();
        root.fill(&WHITE)?;
        let font = |px| TextStyle::from(("sans-serif", 12.4 * px).into_font()); // 1.24 PX
        let title = font(17.0).pos(Pos::new(HPos::Center, VPos::Top));
        root.draw(&Text::new(clean(self.title, 76), (WIDTH / 2, 15 * PX), title))?;
        let mut chart = ChartBuilder::on(&root)
            .margin(12 * PX)
            .margin_top(top)
            .margin_right(right)
            .x_label_area_size(bottom - 12 * PX)
            .y_label_area_size(left - 12 * PX)
            .build_cartesian_2d(x.range.clone(), y.range.clone())?;
        let grey = |level| RGBColor(level, level, level).stroke_width(PX as u32);
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(grey(0xe0))
            .axis_style(grey(0x50))
            .set_all_tick_mark_size(5 * PX)
            .x_labels(x.most)
            .y_labels(y.most)
            .x_label_formatter(&|tick| x.label(*tick))
            .y_label_formatter(&|tick| y.label(*tick))
            .label_style(font(13.0))
            .axis_desc_style(font(14.5))
            .x_desc(clean(self.x_label, 70))
            .y_desc(clean(self.y_label, 50))
            .draw()?;

        let area = chart.plotting_area().clone();
        for (i, series) in self.series.iter().enumerate() {
            let [_, r, g, b] = COLORS[i % COLORS.len()].to_be_bytes();
            let line = RGBColor(r, g, b).stroke_width(2 * PX as u32);
            let function = series.is_function();
            let cell = |p: &Point| {
                let (across, down) = area.map_coordinate(p);
                (2 * across / PX, if function { 0 } else { 2 * down / PX })
            };
            let points: Vec<Point> = series.points().map(|p| (p.0 / x.unit, p.1 / y.unit)).collect();
            let runs = points.split(|p| p.0.is_nan()).filter(|run| !run.is_empty());
            chart.draw_series(runs.map(|run| match run {
                [p] => Circle::new(*p, 3 * PX, line.filled()).into_dyn(),
                _ => PathElement::new(thinned(run, cell), line).into_dyn(),
            }))?;
            if let Some(name) = names.get(i) {
                let (x, y) = (WIDTH - legend, top + (10 + 22 * i as i32) * PX);
                let text = font(13.0).pos(Pos::new(HPos::Left, VPos::Center));
                root.draw(&PathElement::new([(x, y), (x + 26 * PX, y)], line))?;
                root.draw(&Text::new(&name[..], (x + 34 * PX, y), text))?;
            }
        }
        root.present()?;
        drop((chart, area, root));
        let size = |k| format!(r#"width="{}" height="{}""#, WIDTH / k, HEIGHT / k);
        Ok(svg.replacen(&size(1), &(size(PX) + r#" stroke-linejoin="round""#), 1)) // the view box keeps its size
    }

    /// What axes so long must span to show all the data; 0 to 1 where there are none.
    fn ranges(&self, sides: [i32; 2]) -> [Range<f64>; 2] {
        let none = f64::INFINITY..f64::NEG_INFINITY;
        let wider = |r: Range<f64>, v| r.start.min(v)..r.end.max(v); // without NaN
        let [x, y] = self
            .series
            .iter()
            .flat_map(Series::points)
            .fold([none.clone(), none], |[x, y], p| [wider(x, p.0), wider(y, p.1)]);
        if x.start > x.end {
            return [0.0..1.0, 0.0..1.0];
        }
        let [width, height] = sides.map(f64::from);
        let scale = 1.1 * ((x.end - x.start) / width).max((y.end - y.start) / height);
        // time fills its axis from end to end, all else has a margin
        let tight = self.series.iter().all(Series::is_function);
        let margins = [if tight { 0.0 } else { 0.05 }, 0.05];
        [(x, margins[0], width), (y, margins[1], height)].map(|(r, margin, side)| {
            let (span, size) = (r.end - r.start, r.start.abs().max(r.end.abs()));
            let seen = |span: f64| span > (1e-12 * size).max(1e-290); // more than rounding
            let reach = match seen(span) {
                _ if self.equal_axes && seen(scale * side) => 0.5 * (scale * side - span),
                true => margin * span,
                false if size > 1e-290 => 0.1 * size,
                false => 1.0,
            };
            r.start - reach..r.end + reach
        })
    }
}

impl Series<'_> {
    /// The samples, those that cannot be drawn as NaN.
    fn points(&self) -> impl Iterator<Item = Point> {
        let drawable = |(x, y): Point| x.abs() < 1e300 && y.abs() < 1e300;
        let points = self.x.iter().copied().zip(self.y.iter().copied());
        points.map(move |p| if drawable(p) { p } else { (f64::NAN, f64::NAN) })
    }

    /// Whether x never decreases, as time does.
    fn is_function(&self) -> bool {
        self.points().map(|p| p.0).filter(|x| !x.is_nan()).is_sorted()
    }
}

/// The first, lowest, highest and last of all successive points in one cell: what can be told from all of them.
fn thinned(points: &[Point], cell: impl Fn(&Point) -> (i32, i32)) -> Vec<Point> {
    let mut kept = Vec::new();
    for part in points.chunk_by(|a, b| cell(a) == cell(b)) {
        let by_y = |a: &usize, b: &usize| part[*a].1.total_cmp(&part[*b].1);
        let low = (0..part.len()).min_by(by_y).unwrap_or(0);
        let high = (0..part.len()).max_by(by_y).unwrap_or(0);
        let picks = [0, low, high, part.len() - 1];
        let indices = (0..part.len()).filter(|i| picks.contains(i));
        kept.extend(indices.map(|i| part[i]));
    }
    kept
}

/// One axis and how its ticks are labelled: with the digits that their step has.
struct Axis {
    range: Range<f64>, // in units, 1 to 10 long: the ticks of plotters fail near the machine epsilon
    unit: f64,
    most: usize,    // ticks
    decimals: i32,  // of the step between ticks, negative from ten on
    powers: bool,   // labels with a power of ten
    letters: usize, // of the longest label, at most
}

impl Axis {
    fn new(range: &Range<f64>, most: usize) -> Self {
        let decade = |value: f64| (value.log10() + 1e-9).floor() as i32;
        let unit = 10_f64.powi(decade(range.end - range.start));
        let largest = decade(range.start.abs().max(range.end.abs()));
        let range = range.start / unit..range.end / unit;
        let ticks = RangedCoordf64::from(range.clone()).key_points(BoldPoints(most));
        let step = ticks.get(1).map_or(1.0, |second| second - ticks[0]);
        let decimals = -decade(step * unit * 1.000001);
        let fixed = largest.max(0) + decimals.max(0) + 2 + i32::from(decimals > 0);
        let scientific = largest + decimals + 6;
        let powers = scientific + 1 < fixed;
        Self { range, unit, most, decimals, powers, letters: if powers { scientific } else { fixed } as usize }
    }

    fn label(&self, tick: f64) -> String {
        let value = tick * self.unit;
        let digits = (value.abs().log10() + 1e-9).floor() + f64::from(self.decimals);
        let value = if digits < 0.0 { 0.0 } else { value }; // not -0
        match self.powers {
            true if value == 0.0 => "0".to_owned(),
            true => format!("{value:.*e}", digits as usize),
            false => format!("{value:.*}", self.decimals.max(0) as usize),
        }
    }
}

/// Width of so many digits in the size of labels.
fn text_width(digits: usize) -> i32 {
    (0.637 * 13.0 * f64::from(PX) * digits as f64) as i32
}

/// A text without what XML does not allow, its end cut if it has more than `most` letters.
fn clean(text: &str, most: usize) -> String {
    let mut text = text.replace(char::is_control, " ");
    if let Some((at, _)) = text.char_indices().nth(most) {
        text.replace_range(at.., "…");
    }
    text
}

fn to_png(svg: &str) -> Drawn<Vec<u8>> {
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = [WIDTH, HEIGHT].map(|units| (2 * units / PX) as u32);
    let mut picture = tiny_skia::Pixmap::new(size[0], size[1]).ok_or("no memory")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(2.0, 2.0), &mut picture.as_mut());
    Ok(picture.encode_png()?)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), PlotError> {
    fs::write(path, bytes).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A figure's SVG and ranges.
    fn drawn(equal_axes: bool, x: &[f64], ys: &[&[f64]]) -> (String, [Range<f64>; 2]) {
        let name = "a <b>";
        let figure = Figure {
            title: "\u{0}&",
            x_label: "t [s]",
            y_label: "",
            equal_axes,
            series: ys.iter().map(|&y| Series { name, x, y }).collect(),
        };
        let [svg, again] = [(); 2].map(|()| figure.to_svg().unwrap());
        assert_eq!(svg, again);
        assert!(svg.starts_with(r#"<svg width="900" height="600" stroke"#));
        assert_eq!(to_png(&svg).unwrap(), to_png(&svg).unwrap());
        (svg, figure.ranges([800, 400]))
    }

    #[test]
    fn labels_have_the_digits_of_the_step() {
        for (low, high, value, label) in [
            (17.97, 18.02, 17.99, "17.99"),
            (172.0, 186.0, 176.0, "176"),
            (18.0, 18.0 + 1e-9, 18.0 + 2e-10, "18.0000000002"),
            (-3e-9, 3e-9, -1e-9, "-1e-9"),
            (-2.0, 2.0, -1e-17, "0.0"),
            (0.0, 4e-29, 2.5e-29, "2.5e-29"),
            (0.0, 4e7, 1e7, "1.0e7"),
        ] {
            let axis = Axis::new(&(low..high), 10);
            assert_eq!(axis.label(value / axis.unit), label);
            assert!(label.len() <= axis.letters);
        }
    }

    #[test]
    fn all_is_drawn_with_one_scale_and_at_most_ten_names() {
        let (time, nan) = ([0.0, 1.0, 2.0, 3.0], f64::NAN);
        let (gap, none) = ([1.0, nan, 2.0, 3.0], [nan, f64::INFINITY, 1e301, -1e301]);
        for equal in [false, true] {
            for y in [[5.0; 4], [0.0; 4], [1e-300; 4], [-1e299, 1e299, 0.0, 0.0], none] {
                drawn(equal, &time, &[&y]);
            }
            assert!(drawn(equal, &time, &[&gap]).0.contains("<circle"));
            assert!(drawn(equal, &[4.0], &[&[1e9]]).0.contains("<circle"));
            drawn(equal, &[], &[]);
        }
        let [x, y] = drawn(true, &[1e5, 1e5 + 20.0], &[&[7.0, 7.0]]).1;
        assert!((x.end - x.start - 22.0).abs() < 1e-9 && (y.end - y.start - 11.0).abs() < 1e-9);
        for (curves, names) in [(1, 0), (2, 2), (13, 10)] {
            let (svg, _) = drawn(false, &time, &vec![&time[..]; curves]);
            assert_eq!(svg.matches("a &lt;b&gt;").count(), names);
        }
    }

    #[test]
    fn a_million_points_keep_what_can_be_seen() {
        let angles = (0..1_000_000).map(|i| f64::from(i) * 1e-5);
        let mut points: Vec<Point> = angles.map(|t| (t, 99.0 * t.sin())).collect();
        let row = |p: &Point| ((100.0 * p.0) as i32, p.1 as i32);
        assert!(thinned(&points, row).len() < 8_000);
        points[123_456].1 = 1e3;
        let kept = thinned(&points, |p| (row(p).0, 0));
        assert!(kept.len() <= 4_000 && kept.contains(&points[123_456]));
        assert_eq!([kept[0], kept[kept.len() - 1]], [points[0], points[999_999]]);
    }
}
