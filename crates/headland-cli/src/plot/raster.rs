//! A scene as PNG, two pixels for one.

use super::{
    font::{Font, Glyph},
    scene::{Anchor, Color, Point, Rect, Scene, Shape, Stroke, Text},
};
use skrifa::outline::OutlinePen;
use tiny_skia::{FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// Pixels of the picture for one of the scene.
const SCALE: f32 = 2.0;

/// The whole file: 8-bit RGB, with the resolution that gives the scene its size in print.
pub fn render(scene: &Scene) -> Result<Vec<u8>, png::EncodingError> {
    encode(&paint(scene))
}

fn paint(scene: &Scene) -> Pixmap {
    let pixels = |length: f64| (length * f64::from(SCALE)).ceil() as u32;
    let mut canvas = Canvas {
        pixmap: Pixmap::new(pixels(scene.width), pixels(scene.height))
            .expect("a scene is neither empty nor huge"),
        font: Font::embedded(),
    };
    canvas.pixmap.fill(tiny_skia::Color::WHITE);
    scene.shapes.iter().for_each(|shape| canvas.shape(shape));
    canvas.pixmap
}

fn encode(pixmap: &Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let per_metre = (96.0 * f64::from(SCALE) / 0.0254).round() as u32;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    // everything lies on white, so alpha says nothing
    let rgb: Vec<u8> = pixmap
        .data()
        .chunks_exact(4)
        .flat_map(|rgba| [rgba[0], rgba[1], rgba[2]])
        .collect();
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

struct Canvas {
    pixmap: Pixmap,
    font: Font,
}

impl Canvas {
    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Box { rect, fill, stroke } => {
                let path = outline(*rect);
                if let Some(color) = fill {
                    self.fill(path.as_ref(), *color);
                }
                if let Some(stroke) = stroke {
                    self.stroke(path.as_ref(), stroke);
                }
            }
            Shape::Lines { runs, stroke } => {
                let mut path = PathBuilder::new();
                runs.iter().for_each(|run| add_run(&mut path, run));
                self.stroke(path.finish().as_ref(), stroke);
            }
            Shape::Dots {
                centres,
                radius,
                color,
            } => {
                let mut path = PathBuilder::new();
                for p in centres {
                    path.push_circle(p[0] as f32, p[1] as f32, *radius as f32);
                }
                self.fill(path.finish().as_ref(), *color);
            }
            Shape::Text(text) => self.text(text),
        }
    }

    fn text(&mut self, text: &Text) {
        let width = self.font.width(&text.text, text.size);
        let start = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        let mut pen = Pen {
            path: PathBuilder::new(),
            origin: [0.0; 2],
            at: text.at,
            upwards: text.upwards,
        };
        for glyph in self.font.set(&text.text, text.size) {
            let Glyph { at: [x, y], .. } = glyph;
            pen.origin = [start + x, y];
            self.font.draw(&glyph, text.size, &mut pen);
        }
        self.fill(pen.path.finish().as_ref(), text.color);
    }

    fn fill(&mut self, path: Option<&Path>, color: Color) {
        if let Some(path) = path {
            self.pixmap
                .fill_path(path, &solid(color), FillRule::Winding, scaled(), None);
        }
    }

    fn stroke(&mut self, path: Option<&Path>, stroke: &Stroke) {
        let style = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_join: LineJoin::Round,
            dash: StrokeDash::new(stroke.dash.iter().map(|&d| d as f32).collect(), 0.0),
            ..tiny_skia::Stroke::default()
        };
        if let Some(path) = path {
            self.pixmap
                .stroke_path(path, &solid(stroke.color), &style, scaled(), None);
        }
    }
}

/// Puts the outline of a letter into a path: from the letter's frame, y upwards, to the scene's.
struct Pen {
    path: PathBuilder,
    origin: Point, // of the letter, along and above the baseline
    at: Point,     // of the text, in the scene
    upwards: bool,
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        let [along, above] = [self.origin[0] + f64::from(x), self.origin[1] + f64::from(y)];
        let [dx, dy] = if self.upwards {
            [-above, -along]
        } else {
            [along, -above]
        };
        ((self.at[0] + dx) as f32, (self.at[1] + dy) as f32)
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let ((cx, cy), (x, y)) = (self.place(cx, cy), self.place(x, y));
        self.path.quad_to(cx, cy, x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let ((ax, ay), (bx, by), (x, y)) =
            (self.place(ax, ay), self.place(bx, by), self.place(x, y));
        self.path.cubic_to(ax, ay, bx, by, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

fn add_run(path: &mut PathBuilder, run: &[Point]) {
    for (i, p) in run.iter().enumerate() {
        let (x, y) = (p[0] as f32, p[1] as f32);
        if i == 0 {
            path.move_to(x, y)
        } else {
            path.line_to(x, y)
        }
    }
}

fn outline(rect: Rect) -> Option<Path> {
    tiny_skia::Rect::from_xywh(rect.x as f32, rect.y as f32, rect.w as f32, rect.h as f32)
        .map(PathBuilder::from_rect)
}

fn solid(color: Color) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    paint.set_color_rgba8(color.0, color.1, color.2, 255);
    paint
}

fn scaled() -> Transform {
    Transform::from_scale(SCALE, SCALE)
}
