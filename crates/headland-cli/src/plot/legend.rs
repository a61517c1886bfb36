//! The names of the curves.

use super::{
    Figure,
    draw::{Style, style},
    font::Font,
    layout::TICK_SIZE,
    scene::{Anchor, Color, Point, Rect, Shape, Stroke, Text},
};

const ROW: f64 = 20.0;
const PADDING: f64 = 8.0;
const SAMPLE: f64 = 28.0; // length of the piece of curve
const GAP: f64 = 8.0; // between it and the name
const LONGEST_NAME: f64 = 260.0;
const MOST_ROWS: usize = 24;
const INSET: f64 = 10.0; // from the frame
const CLEARANCE: f64 = 7.0; // from the curves

/// A box with a row for each curve.
pub struct Legend {
    rows: Vec<(String, Option<Style>)>,
    /// Width of the box.
    pub width: f64,
    height: f64,
}

impl Legend {
    /// The legend of a figure, at most `room` high; none for a single curve.
    pub fn new(figure: &Figure, font: &Font, room: f64) -> Option<Self> {
        let count = figure.series.len();
        if count < 2 {
            return None;
        }
        let most = (((room - 2.0 * PADDING) / ROW) as usize).clamp(2, MOST_ROWS);
        let named = if count > most { most - 1 } else { count };
        let mut rows: Vec<_> = (figure.series.iter().take(named).enumerate())
            .map(|(i, series)| {
                (
                    font.fit(series.name, TICK_SIZE, LONGEST_NAME),
                    Some(style(figure, i)),
                )
            })
            .collect();
        if named < count {
            rows.push((format!("… and {} more", count - named), None));
        }
        let longest = rows
            .iter()
            .map(|(name, _)| font.width(name, TICK_SIZE))
            .fold(0.0, f64::max);
        let width = (2.0 * PADDING + SAMPLE + GAP + longest).ceil();
        let height = 2.0 * PADDING + ROW * rows.len() as f64;
        Some(Self {
            rows,
            width,
            height,
        })
    }

    /// A corner of the plot area that no curve enters, if there is one and the box is small beside the area.
    pub fn free_corner(&self, area: Rect, curves: &[Vec<Vec<Point>>]) -> Option<Point> {
        if self.width > 0.5 * area.w || self.height > 0.6 * area.h {
            return None;
        }
        let right = area.x + area.w - INSET - self.width;
        let low = area.y + area.h - INSET - self.height;
        let (left, high) = (area.x + INSET, area.y + INSET);
        [[right, high], [left, high], [right, low], [left, low]]
            .into_iter()
            .find(|&[x, y]| {
                let kept_free = Rect {
                    x: x - CLEARANCE,
                    y: y - CLEARANCE,
                    w: self.width + 2.0 * CLEARANCE,
                    h: self.height + 2.0 * CLEARANCE,
                };
                !curves.iter().flatten().any(|run| enters(run, kept_free))
            })
    }

    /// To the right of the plot area, from its upper edge.
    pub fn beside(area: Rect) -> Point {
        [area.x + area.w + INSET, area.y]
    }

    /// Width of the strip a legend beside the plot area needs.
    pub fn strip(&self) -> f64 {
        INSET + self.width
    }

    /// The legend with its upper left corner at a point.
    pub fn draw(&self, [x, y]: Point, shapes: &mut Vec<Shape>) {
        let outline = Stroke {
            color: Color(0xcc, 0xcc, 0xcc),
            width: 1.0,
            dash: &[],
        };
        let rect = Rect {
            x,
            y,
            w: self.width,
            h: self.height,
        };
        shapes.push(Shape::Box {
            rect,
            fill: Some(Color(255, 255, 255)),
            stroke: Some(outline),
        });
        for (i, (name, style)) in self.rows.iter().enumerate() {
            let middle = y + PADDING + (i as f64 + 0.5) * ROW;
            let start = x + PADDING;
            match style {
                Some(Style {
                    stroke,
                    dot: Some(radius),
                }) => {
                    let centre = [start + 0.5 * SAMPLE, middle];
                    shapes.push(Shape::Dots {
                        centres: vec![centre],
                        radius: *radius,
                        color: stroke.color,
                    });
                }
                Some(Style { stroke, dot: None }) => {
                    let run = vec![[start, middle], [start + SAMPLE, middle]];
                    shapes.push(Shape::Lines {
                        runs: vec![run],
                        stroke: *stroke,
                    });
                }
                None => {}
            }
            shapes.push(Shape::Text(Text {
                at: [start + SAMPLE + GAP, middle + 0.36 * TICK_SIZE],
                size: TICK_SIZE,
                anchor: Anchor::Start,
                upwards: false,
                color: Color(0x22, 0x22, 0x22),
                text: name.clone(),
            }));
        }
    }
}

/// Whether a polyline, or a single point, has a part in a rectangle.
pub fn enters(run: &[Point], rect: Rect) -> bool {
    match run {
        [] => false,
        [p] => crosses(*p, *p, rect),
        _ => run.windows(2).any(|pair| crosses(pair[0], pair[1], rect)),
    }
}

/// Whether the line from `a` to `b` has a part in a rectangle: clips it to each of the two bands.
fn crosses(a: Point, b: Point, rect: Rect) -> bool {
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    for (a, b, low, size) in [(a[0], b[0], rect.x, rect.w), (a[1], b[1], rect.y, rect.h)] {
        let d = b - a;
        if d == 0.0 {
            if a < low || a > low + size {
                return false;
            }
            continue;
        }
        let (enter, leave) = ((low - a) / d, (low + size - a) / d);
        start = start.max(enter.min(leave));
        end = end.min(enter.max(leave));
    }
    start <= end
}
