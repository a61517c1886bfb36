//! A figure as a scene.

use super::{
    Figure,
    curve::{self, samples},
    font::Font,
    layout::{EDGE, LABEL_SIZE, Layout, TICK_GAP, TICK_SIZE, TITLE_SIZE, widest},
    legend::Legend,
    range::ranges,
    scene::{Anchor, Color, Point, Rect, Scene, Shape, Stroke, Text},
};
use std::collections::BTreeSet;

/// Colours that differ for all kinds of colour vision (Okabe and Ito, *Color universal design*, 2008), grey in place of
/// yellow, which is too light for a line on white.
const COLORS: [Color; 8] = [
    Color(0x00, 0x72, 0xb2),
    Color(0xd5, 0x5e, 0x00),
    Color(0x00, 0x9e, 0x73),
    Color(0xcc, 0x79, 0xa7),
    Color(0xe6, 0x9f, 0x00),
    Color(0x56, 0xb4, 0xe9),
    Color(0x1a, 0x1a, 0x1a),
    Color(0x8c, 0x8c, 0x8c),
];
/// A further round of the colours takes the next of these.
const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.5], &[8.0, 3.0, 2.0, 3.0]];

const WHITE: Color = Color(255, 255, 255);
const TEXT: Color = Color(0x22, 0x22, 0x22);
const FRAME: Stroke = Stroke {
    color: Color(0x55, 0x55, 0x55),
    width: 1.0,
    dash: &[],
};
const GRID: Stroke = Stroke {
    color: Color(0xe4, 0xe4, 0xe4),
    width: 1.0,
    dash: &[],
};
const ZERO: Stroke = Stroke {
    color: Color(0xb4, 0xb4, 0xb4),
    width: 1.0,
    dash: &[],
};
const LINE: f64 = 1.8; // width of a curve
const DOT: f64 = 4.0; // radius of a curve of one sample
const TICK: f64 = 4.0; // length of the mark of a tick

/// How a curve is drawn.
pub struct Style {
    /// Its line.
    pub stroke: Stroke,
    /// Radius of its dot, if it has but one sample.
    pub dot: Option<f64>,
}

/// The style of the i-th curve.
pub fn style(figure: &Figure, i: usize) -> Style {
    let color = COLORS[i % COLORS.len()];
    let dash = DASHES[i / COLORS.len() % DASHES.len()];
    let single = samples(&figure.series[i]).take(2).count() == 1;
    Style {
        stroke: Stroke {
            color,
            width: LINE,
            dash,
        },
        dot: single.then_some(DOT),
    }
}

/// All of a figure, back to front.
pub fn scene(figure: &Figure) -> Scene {
    let font = Font::embedded();
    let ranges = ranges(&figure.series, figure.equal_axes);
    let mut layout = Layout::new(figure, ranges, &font, 0.0);
    let mut curves = curves(figure, &layout);
    let legend = Legend::new(figure, &font, layout.area.h).map(|legend| {
        let at = legend.free_corner(layout.area, &curves).unwrap_or_else(|| {
            layout = Layout::new(figure, ranges, &font, legend.strip());
            curves = self::curves(figure, &layout);
            Legend::beside(layout.area)
        });
        (legend, at)
    });

    let mut shapes = Vec::new();
    let sheet = Rect {
        x: 0.0,
        y: 0.0,
        w: layout.width,
        h: layout.height,
    };
    shapes.push(Shape::Box {
        rect: sheet,
        fill: Some(WHITE),
        stroke: None,
    });
    draw_axes(&layout, &mut shapes);
    draw_labels(figure, &layout, &font, &mut shapes);
    if curves.iter().all(Vec::is_empty) {
        let middle = [
            layout.area.x + 0.5 * layout.area.w,
            layout.area.y + 0.46 * layout.area.h,
        ];
        shapes.push(text("no data", middle, LABEL_SIZE, Anchor::Middle));
    }
    for (i, runs) in curves.into_iter().enumerate() {
        draw_curve(&style(figure, i), runs, &mut shapes);
    }
    if let Some((legend, at)) = legend {
        legend.draw(at, &mut shapes);
    }
    let title = if figure.title.is_empty() {
        "plot"
    } else {
        figure.title
    };
    Scene {
        title: title.to_owned(),
        width: layout.width,
        height: layout.height,
        shapes,
    }
}

fn curves(figure: &Figure, layout: &Layout) -> Vec<Vec<Vec<Point>>> {
    figure
        .series
        .iter()
        .map(|series| curve::in_pixels(series, |p| layout.place(p)))
        .collect()
}

/// The runs of a curve as lines, those of one point as dots, one for each pixel.
fn draw_curve(style: &Style, runs: Vec<Vec<Point>>, shapes: &mut Vec<Shape>) {
    let (lines, single): (Vec<_>, Vec<_>) = runs.into_iter().partition(|run| run.len() > 1);
    let pixels: BTreeSet<_> = single
        .iter()
        .flatten()
        .map(|p| p.map(|v| (2.0 * v).round() as i64))
        .collect();
    if !lines.is_empty() {
        shapes.push(Shape::Lines {
            runs: lines,
            stroke: style.stroke,
        });
    }
    if !pixels.is_empty() {
        let centres = pixels
            .into_iter()
            .map(|p| p.map(|v| 0.5 * v as f64))
            .collect::<Vec<_>>();
        // a point among lines, between two gaps, is as wide as they are
        let alone = shapes
            .last()
            .is_none_or(|s| !matches!(s, Shape::Lines { stroke, .. } if *stroke == style.stroke));
        let radius = if alone && centres.len() == 1 {
            DOT
        } else {
            0.7 * LINE
        };
        shapes.push(Shape::Dots {
            centres,
            radius,
            color: style.stroke.color,
        });
    }
}

/// The grid, the frame with its marks, and what stands at them.
fn draw_axes(layout: &Layout, shapes: &mut Vec<Shape>) {
    let Layout { area, x, y, .. } = layout;
    let (right, bottom) = (area.x + area.w, area.y + area.h);
    let mut grid = Vec::new();
    let mut zero = Vec::new();
    let mut marks = Vec::new();
    let mut labels = Vec::new();
    for (&value, label) in x.ticks.values.iter().zip(&x.ticks.labels) {
        let at = crisp(x.place(value));
        grid.push(vec![[at, area.y], [at, bottom]]);
        marks.push(vec![[at, bottom], [at, bottom + TICK]]);
        labels.push(text(
            label,
            [at, bottom + TICK_GAP + 0.76 * TICK_SIZE],
            TICK_SIZE,
            Anchor::Middle,
        ));
    }
    for (&value, label) in y.ticks.values.iter().zip(&y.ticks.labels) {
        let at = crisp(y.place(value));
        let line = vec![[area.x, at], [right, at]];
        if value == 0.0 {
            zero.push(line)
        } else {
            grid.push(line)
        }
        marks.push(vec![[area.x - TICK, at], [area.x, at]]);
        labels.push(text(
            label,
            [area.x - TICK_GAP, at + 0.36 * TICK_SIZE],
            TICK_SIZE,
            Anchor::End,
        ));
    }
    for (runs, stroke) in [(grid, GRID), (zero, ZERO), (marks, FRAME)] {
        if !runs.is_empty() {
            shapes.push(Shape::Lines { runs, stroke });
        }
    }
    shapes.push(Shape::Box {
        rect: *area,
        fill: None,
        stroke: Some(FRAME),
    });
    shapes.extend(labels);
}

/// The title, the labels of the axes and the notes of their ticks.
fn draw_labels(figure: &Figure, layout: &Layout, font: &Font, shapes: &mut Vec<Shape>) {
    let area = layout.area;
    let [middle_x, middle_y] = [area.x + 0.5 * area.w, area.y + 0.5 * area.h];
    let bottom = area.y + area.h;
    let (x_note, y_note) = (&layout.x.ticks.note, &layout.y.ticks.note);

    if !figure.title.is_empty() {
        let half = middle_x.min(layout.width - middle_x) - EDGE;
        let (title, size) = fitted(font, figure.title, TITLE_SIZE, 2.0 * half);
        shapes.push(text(
            &title,
            [middle_x, EDGE + 0.85 * TITLE_SIZE],
            size,
            Anchor::Middle,
        ));
    }
    if !y_note.is_empty() {
        shapes.push(text(
            y_note,
            [area.x, area.y - 7.0],
            TICK_SIZE,
            Anchor::Start,
        ));
    }
    let baseline = bottom + TICK_GAP + TICK_SIZE + 9.0 + 0.8 * LABEL_SIZE;
    let mut room = area.w;
    if !x_note.is_empty() {
        room -= 2.0 * (font.width(x_note, TICK_SIZE) + 16.0);
        shapes.push(text(
            x_note,
            [area.x + area.w, baseline],
            TICK_SIZE,
            Anchor::End,
        ));
    }
    if !figure.x_label.is_empty() {
        let (label, size) = fitted(font, figure.x_label, LABEL_SIZE, room);
        shapes.push(text(&label, [middle_x, baseline], size, Anchor::Middle));
    }
    if !figure.y_label.is_empty() {
        let (label, size) = fitted(font, figure.y_label, LABEL_SIZE, layout.height - 2.0 * EDGE);
        let half = 0.5 * font.width(&label, size);
        let centre = middle_y.clamp(EDGE + half, (layout.height - EDGE - half).max(EDGE + half));
        let at = [
            area.x - TICK_GAP - widest(font, &layout.y.ticks.labels) - 13.0,
            centre,
        ];
        shapes.push(Shape::Text(Text {
            upwards: true,
            ..line(&label, at, size, Anchor::Middle)
        }));
    }
}

/// A text and the size at which it fits, down to three quarters; then its end is cut.
fn fitted(font: &Font, text: &str, size: f64, room: f64) -> (String, f64) {
    let size = (size * room / font.width(text, size).max(1.0)).clamp(0.75 * size, size);
    (font.fit(text, size, room + 1e-6), size)
}

fn text(text: &str, at: Point, size: f64, anchor: Anchor) -> Shape {
    Shape::Text(line(text, at, size, anchor))
}

fn line(text: &str, at: Point, size: f64, anchor: Anchor) -> Text {
    Text {
        at,
        size,
        anchor,
        upwards: false,
        color: TEXT,
        text: text.to_owned(),
    }
}

/// The nearest place where a line one pixel wide fills whole pixels.
fn crisp(at: f64) -> f64 {
    at.floor() + 0.5
}
