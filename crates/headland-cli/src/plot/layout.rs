//! Where the axes are on the sheet.
//!
//! The margins depend on the labels, the labels on the ticks, the ticks on the room the margins leave: a few rounds
//! settle it.

use super::{
    Figure,
    font::Font,
    range::Range,
    scene::{Point, Rect},
    ticks::{self, Ticks},
};

/// Size of the labels of ticks and of the names in the legend.
pub const TICK_SIZE: f64 = 13.0;
/// Size of the labels of the axes.
pub const LABEL_SIZE: f64 = 14.5;
/// Size of the title.
pub const TITLE_SIZE: f64 = 17.0;
/// Between the frame and the labels of its ticks.
pub const TICK_GAP: f64 = 9.0;
/// The least between anything and the edge of the sheet.
pub const EDGE: f64 = 14.0;

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 600.0;
const EQUAL_HEIGHT: f64 = 900.0; // at most
const EQUAL_LEAST: [f64; 2] = [320.0, 220.0]; // width and height of the plot area
const EQUAL_SPACING: f64 = 50.0; // the least between ticks of either axis
const X_SPACING: f64 = 72.0; // the least between ticks
const Y_SPACING: f64 = 42.0;
const X_LABEL_GAP: f64 = 18.0; // the least between labels

/// One axis: data to pixels.
#[derive(Clone, PartialEq, Debug)]
pub struct Axis {
    /// What it spans.
    pub range: Range,
    /// Where its labels are.
    pub ticks: Ticks,
    /// The pixel of the low end.
    pub from: f64,
    /// The pixel of the high end.
    pub to: f64,
}

impl Axis {
    /// The pixel of a value.
    pub fn place(&self, value: f64) -> f64 {
        self.from + (value - self.range.low) / self.range.span() * (self.to - self.from)
    }
}

/// The sheet and what is where on it.
#[derive(Clone, PartialEq, Debug)]
pub struct Layout {
    /// Width of the sheet.
    pub width: f64,
    /// Height of the sheet.
    pub height: f64,
    /// Where the curves are.
    pub area: Rect,
    /// The abscissa.
    pub x: Axis,
    /// The ordinate.
    pub y: Axis,
}

impl Layout {
    /// Finds room for the axes of a figure, with `beside` pixels left free to their right.
    pub fn new(figure: &Figure, ranges: [Range; 2], font: &Font, beside: f64) -> Self {
        let mut margins = Margins {
            left: 80.0,
            right: 24.0 + beside,
            top: 50.0,
            bottom: 66.0,
        };
        let mut layout = margins.lay_out(figure, ranges, font);
        for _ in 0..4 {
            let needed = Margins::around(&layout, figure, font, beside);
            if needed == margins {
                break;
            }
            margins = needed;
            layout = margins.lay_out(figure, ranges, font);
        }
        layout
    }

    /// The pixels of a sample.
    pub fn place(&self, [x, y]: Point) -> Point {
        [self.x.place(x), self.y.place(y)]
    }
}

/// The widest of some labels.
pub fn widest(font: &Font, labels: &[String]) -> f64 {
    labels
        .iter()
        .map(|label| font.width(label, TICK_SIZE))
        .fold(0.0, f64::max)
}

#[derive(Clone, Copy, PartialEq)]
struct Margins {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Margins {
    /// What the labels of a layout need.
    fn around(layout: &Layout, figure: &Figure, font: &Font, beside: f64) -> Self {
        let row = |text: &str, height: f64| if text.is_empty() { 0.0 } else { height };
        let last_label = layout
            .x
            .ticks
            .values
            .last()
            .zip(layout.x.ticks.labels.last())
            .map_or(0.0, |(&x, label)| {
                layout.x.place(x) + 0.5 * font.width(label, TICK_SIZE)
                    - layout.area.x
                    - layout.area.w
            });
        let below =
            row(figure.x_label, LABEL_SIZE + 11.0).max(row(&layout.x.ticks.note, TICK_SIZE + 11.0));
        Self {
            left: EDGE
                + row(figure.y_label, LABEL_SIZE + 12.0)
                + widest(font, &layout.y.ticks.labels)
                + TICK_GAP,
            right: EDGE + beside + last_label.max(10.0),
            top: EDGE
                + row(figure.title, TITLE_SIZE + 13.0)
                + row(&layout.y.ticks.note, TICK_SIZE + 5.0),
            bottom: EDGE + TICK_GAP + TICK_SIZE + below,
        }
    }

    fn lay_out(self, figure: &Figure, [x, y]: [Range; 2], font: &Font) -> Layout {
        let room =
            |sheet: f64, before: f64, after: f64| (sheet - before.ceil() - 0.5 - after).floor();
        let width = room(WIDTH, self.left, self.right);
        if figure.equal_axes {
            let height = room(EQUAL_HEIGHT, self.top, self.bottom);
            let scale = (width / x.span()).min(height / y.span());
            let w = (x.span() * scale).round().max(EQUAL_LEAST[0]);
            let h = (y.span() * scale).round().max(EQUAL_LEAST[1]);
            let [x, y] = [x.with_span(w / scale), y.with_span(h / scale)];
            self.around_area(w, h, x, y, equal_ticks(x, y, scale, font))
        } else {
            let height = room(HEIGHT, self.top, self.bottom);
            let ticks = [
                x_ticks(x, width, X_SPACING, font).1,
                ticks::finest(y, height, Y_SPACING, |_, _| true).1,
            ];
            self.around_area(width, height, x, y, ticks)
        }
    }

    fn around_area(
        self,
        w: f64,
        h: f64,
        x: Range,
        y: Range,
        [x_ticks, y_ticks]: [Ticks; 2],
    ) -> Layout {
        // half a pixel off, so that lines one pixel wide fill whole pixels
        let area = Rect {
            x: self.left.ceil() + 0.5,
            y: self.top.ceil() + 0.5,
            w,
            h,
        };
        Layout {
            width: (area.x + w + self.right).ceil(),
            height: (area.y + h + self.bottom).ceil(),
            area,
            x: Axis {
                range: x,
                ticks: x_ticks,
                from: area.x,
                to: area.x + w,
            },
            y: Axis {
                range: y,
                ticks: y_ticks,
                from: area.y + h,
                to: area.y,
            },
        }
    }
}

fn x_ticks(range: Range, width: f64, spacing: f64, font: &Font) -> (ticks::Step, Ticks) {
    let fit = |ticks: &Ticks, each: f64| widest(font, &ticks.labels) + X_LABEL_GAP <= each;
    ticks::finest(range, width, spacing, fit)
}

/// Ticks of one step on both axes, so that the grid is made of squares.
fn equal_ticks(x: Range, y: Range, scale: f64, font: &Font) -> [Ticks; 2] {
    let (x_step, of_x) = x_ticks(x, x.span() * scale, EQUAL_SPACING, font);
    let of_y = ticks::ticks(y, x_step);
    if of_y.values.len() >= 2 {
        return [of_x, of_y];
    }
    let (_, of_y) = ticks::finest(y, y.span() * scale, EQUAL_SPACING, |_, _| true);
    [of_x, of_y]
}
