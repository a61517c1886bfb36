//! A scene as SVG.

use super::scene::{Anchor, Color, Point, Scene, Shape, Stroke, Text};
use std::fmt::{self, Display, Write};

/// Fonts to look for, first the one the text was measured with; it is wider than the others.
const FONTS: &str = "'DejaVu Sans', Verdana, 'Segoe UI', 'Noto Sans', Arial, sans-serif";

/// The whole file.
pub fn render(scene: &Scene) -> String {
    let mut out = String::new();
    write_scene(&mut out, scene).expect("a string takes all that is written to it");
    out
}

fn write_scene(out: &mut String, scene: &Scene) -> fmt::Result {
    let (w, h) = (Number(scene.width), Number(scene.height));
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"{FONTS}\" role=\"img\">"
    )?;
    writeln!(out, "<title>{}</title>", Escaped(&scene.title))?;
    for shape in &scene.shapes {
        write_shape(out, shape)?;
    }
    writeln!(out, "</svg>")
}

fn write_shape(out: &mut String, shape: &Shape) -> fmt::Result {
    match shape {
        Shape::Box {
            rect: r,
            fill,
            stroke,
        } => {
            let [x, y, w, h] = [r.x, r.y, r.w, r.h].map(Number);
            write!(
                out,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\""
            )?;
            write_paint(out, *fill, stroke.as_ref())?;
            writeln!(out, "/>")
        }
        Shape::Lines { runs, stroke } => {
            out.push_str("<path d=\"");
            runs.iter().try_for_each(|run| write_run(out, run))?;
            out.push('"');
            write_paint(out, None, Some(stroke))?;
            writeln!(out, "/>")
        }
        Shape::Dots {
            centres,
            radius,
            color,
        } => {
            writeln!(out, "<g fill=\"{}\">", Hex(*color))?;
            for p in centres {
                writeln!(
                    out,
                    "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                    Number(p[0]),
                    Number(p[1]),
                    Number(*radius)
                )?;
            }
            writeln!(out, "</g>")
        }
        Shape::Text(text) => write_text(out, text),
    }
}

/// `M x y x y …`, which is a polyline, broken into lines that an editor can show.
fn write_run(out: &mut String, run: &[Point]) -> fmt::Result {
    for (i, p) in run.iter().enumerate() {
        out.push_str(match i {
            0 => "M",
            _ if i % 16 == 0 => "\n",
            _ => " ",
        });
        write!(out, "{},{}", Number(p[0]), Number(p[1]))?;
    }
    Ok(())
}

fn write_text(out: &mut String, text: &Text) -> fmt::Result {
    let (x, y) = (Number(text.at[0]), Number(text.at[1]));
    write!(
        out,
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"",
        Number(text.size)
    )?;
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => write!(out, " text-anchor=\"middle\"")?,
        Anchor::End => write!(out, " text-anchor=\"end\"")?,
    }
    if text.upwards {
        write!(out, " transform=\"rotate(-90 {x} {y})\"")?;
    }
    writeln!(
        out,
        " fill=\"{}\">{}</text>",
        Hex(text.color),
        Escaped(&text.text)
    )
}

fn write_paint(out: &mut String, fill: Option<Color>, stroke: Option<&Stroke>) -> fmt::Result {
    match fill {
        Some(color) => write!(out, " fill=\"{}\"", Hex(color))?,
        None => write!(out, " fill=\"none\"")?,
    }
    if let Some(s) = stroke {
        write!(
            out,
            " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
            Hex(s.color),
            Number(s.width)
        )?;
        if !s.dash.is_empty() {
            let lengths: Vec<String> = s.dash.iter().map(|&d| Number(d).to_string()).collect();
            write!(out, " stroke-dasharray=\"{}\"", lengths.join(" "))?;
        }
    }
    Ok(())
}

/// A number to a hundredth of a pixel, as short as it goes.
struct Number(f64);

impl Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let hundredths = (self.0 * 100.0).round() / 100.0 + 0.0; // + 0: no negative zero
        write!(f, "{hundredths}")
    }
}

struct Hex(Color);

impl Display for Hex {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Color(r, g, b) = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// Text that XML takes as it is.
pub struct Escaped<'a>(pub &'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                c if c.is_control() => f.write_char(' ')?,
                '\u{fffe}' | '\u{ffff}' => f.write_char('\u{fffd}')?, // XML has no way to write them
                c => f.write_char(c)?,
            }
        }
        Ok(())
    }
}
