//! DejaVu Sans: how wide a text is and what its letters look like.

use skrifa::{
    FontRef, GlyphId, MetadataProvider,
    charmap::Charmap,
    instance::{LocationRef, Size},
    metrics::GlyphMetrics,
    outline::{DrawSettings, OutlinePen},
};

/// Height of an `x`, in units of the font's size.
const X_HEIGHT: f64 = 0.547;

/// The font all figures are set in.
pub struct Font {
    face: FontRef<'static>,
    charmap: Charmap<'static>,
}

/// One letter of a line of text.
pub struct Glyph {
    id: GlyphId,
    /// Its origin, from the start of the baseline, y upwards.
    pub at: [f64; 2],
}

impl Font {
    /// The font that is in the program.
    pub fn embedded() -> Self {
        let face = FontRef::new(dejavu::sans::regular()).expect("the embedded font is sound");
        Self {
            charmap: face.charmap(),
            face,
        }
    }

    /// Width of a line of text.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        let metrics = self.metrics(size);
        text.chars()
            .filter(|&c| !is_mark(c))
            .map(|c| self.advance(&metrics, self.glyph(c)))
            .sum()
    }

    /// The text, its end replaced by `…` if it is wider than `most`.
    pub fn fit(&self, text: &str, size: f64, most: f64) -> String {
        if self.width(text, size) <= most {
            return text.to_owned();
        }
        let mut short = text.to_owned();
        while short.pop().is_some() {
            let candidate = format!("{}…", short.trim_end());
            if self.width(&candidate, size) <= most {
                return candidate;
            }
        }
        String::new()
    }

    /// The letters of a line of text, each at its place; marks such as the dot of `q̇` are centred over their letter.
    pub fn set(&self, text: &str, size: f64) -> Vec<Glyph> {
        let metrics = self.metrics(size);
        let mut glyphs: Vec<Glyph> = Vec::new();
        let mut pen = 0.0;
        let mut base = None;
        for c in text.chars() {
            let id = self.glyph(c);
            let bounds = metrics.bounds(id);
            if let (true, Some((at, under)), Some(mark)) = (is_mark(c), base, bounds) {
                let over: f64 = at + middle(under) - middle(mark);
                let rise = if mark.y_min > 0.0 {
                    (f64::from(under.y_max) - X_HEIGHT * size).max(0.0)
                } else {
                    0.0
                };
                glyphs.push(Glyph {
                    id,
                    at: [over, rise],
                });
                continue;
            }
            glyphs.push(Glyph { id, at: [pen, 0.0] });
            base = bounds.map(|b| (pen, b));
            pen += self.advance(&metrics, id);
        }
        glyphs
    }

    /// Draws the outline of a letter with its origin at zero, y upwards.
    pub fn draw(&self, glyph: &Glyph, size: f64, pen: &mut impl OutlinePen) {
        let settings = DrawSettings::unhinted(Size::new(size as f32), LocationRef::default());
        if let Some(outline) = self.face.outline_glyphs().get(glyph.id) {
            outline
                .draw(settings, pen)
                .expect("the outlines of the embedded font are sound");
        }
    }

    /// The letter of a character, or the empty box where the font has none.
    pub fn glyph(&self, c: char) -> GlyphId {
        self.charmap.map(c).unwrap_or(GlyphId::NOTDEF)
    }

    fn metrics(&self, size: f64) -> GlyphMetrics<'static> {
        self.face
            .glyph_metrics(Size::new(size as f32), LocationRef::default())
    }

    fn advance(&self, metrics: &GlyphMetrics, id: GlyphId) -> f64 {
        f64::from(metrics.advance_width(id).unwrap_or(0.0))
    }
}

fn middle(bounds: skrifa::metrics::BoundingBox) -> f64 {
    0.5 * f64::from(bounds.x_min + bounds.x_max)
}

/// Whether a character is drawn onto the one before it.
fn is_mark(c: char) -> bool {
    matches!(c, '\u{300}'..='\u{36f}' | '\u{20d0}'..='\u{20ff}')
}
