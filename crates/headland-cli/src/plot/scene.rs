//! The display list: everything a figure shows, in drawing order, before it is SVG or pixels.
//!
//! Lengths are CSS pixels (1/96 inch), y downwards.

/// A point `[x, y]` in pixels.
pub type Point = [f64; 2];

/// An opaque colour, sRGB.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Color(pub u8, pub u8, pub u8);

/// How a line is drawn.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Its width.
    pub width: f64,
    /// Lengths of dashes and of the gaps between them, in turn; none is a solid line.
    pub dash: &'static [f64],
}

/// Which point of a text its position is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// An axis-parallel rectangle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub w: f64,
    /// Height.
    pub h: f64,
}

/// One line of text on its baseline.
#[derive(Clone, PartialEq, Debug)]
pub struct Text {
    /// Where [`Self::anchor`] lies on the baseline.
    pub at: Point,
    /// The size of the font.
    pub size: f64,
    /// What [`Self::at`] marks.
    pub anchor: Anchor,
    /// Reads upwards instead of to the right.
    pub upwards: bool,
    /// Its colour.
    pub color: Color,
    /// The characters.
    pub text: String,
}

/// One entry of the display list.
#[derive(Clone, PartialEq, Debug)]
pub enum Shape {
    /// A rectangle, filled and perhaps outlined.
    Box {
        /// Where.
        rect: Rect,
        /// The inside.
        fill: Option<Color>,
        /// The outline.
        stroke: Option<Stroke>,
    },
    /// Polylines of one style; each has at least two points.
    Lines {
        /// The polylines.
        runs: Vec<Vec<Point>>,
        /// Their style.
        stroke: Stroke,
    },
    /// Filled circles of one size.
    Dots {
        /// Their centres.
        centres: Vec<Point>,
        /// Their radius.
        radius: f64,
        /// Their colour.
        color: Color,
    },
    /// A line of text.
    Text(Text),
}

/// A whole figure.
#[derive(Clone, PartialEq, Debug)]
pub struct Scene {
    /// Its name, for those who cannot see it.
    pub title: String,
    /// Width of the sheet, a whole number.
    pub width: f64,
    /// Height of the sheet, a whole number.
    pub height: f64,
    /// What is on it, back to front.
    pub shapes: Vec<Shape>,
}
