//! Line plots of results, to SVG and PNG, with no font or library of the system.
//!
//! A [`Figure`] is one set of axes with any number of curves. Both formats come from one display list:
//!
//! 1. [`curve`]: samples become runs of usable points, and later runs in pixels, thinned to what can be seen;
//! 2. [`range`] and [`ticks`]: what the axes span and where they are labelled;
//! 3. [`layout`]: the margins, the plot area and its two axes;
//! 4. [`legend`]: names of the curves, in a free corner or else to the right;
//! 5. [`draw`]: all of it as a [`scene`], which [`svg`] writes as text and [`raster`] paints.
//!
//! The text is measured and painted with DejaVu Sans, which is in the program ([`font`]). The same figure gives the
//! same bytes every time.

mod curve;
mod draw;
mod font;
mod layout;
mod legend;
mod range;
mod raster;
mod scene;
mod svg;
mod ticks;

#[cfg(test)]
mod tests;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

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

/// A figure with one set of axes.
///
/// 900 × 600 px, or with [`Self::equal_axes`] at most 900 × 900 px and cut to the shape of the data; the PNG has two
/// pixels for each of these, at 192 dpi.
///
/// ```ignore
/// let t = [0.0, 0.5, 1.0];
/// let speed = [17.97, 18.0, 18.02];
/// let figure = Figure {
///     title: "Speed of the vehicle",
///     x_label: "t [s]",
///     y_label: "v [m/s]",
///     equal_axes: false,
///     series: vec![Series { name: "v", x: &t, y: &speed }],
/// };
/// figure.write_svg("speed.svg".as_ref())?;
/// ```
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
    /// The curves, first at the back; a legend names them when there are several.
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
    /// The picture could not be compressed.
    #[error("the figure could not be encoded as PNG: {0}")]
    Encode(#[from] png::EncodingError),
    /// The file could not be written.
    #[error("cannot write the figure to `{}`: {source}", path.display())]
    Write {
        /// The file asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

impl Figure<'_> {
    /// Writes the figure as SVG, with text that can be searched and edited.
    ///
    /// # Errors
    /// [`PlotError::LengthMismatch`], or [`PlotError::Write`] if the file cannot be written.
    pub fn write_svg(&self, path: &Path) -> Result<(), PlotError> {
        write(path, self.to_svg()?.as_bytes())
    }

    /// Writes the figure as PNG: 8-bit RGB, 1800 × 1200 px for 900 × 600.
    ///
    /// # Errors
    /// [`PlotError::LengthMismatch`], [`PlotError::Encode`], or [`PlotError::Write`] if the file cannot be written.
    pub fn write_png(&self, path: &Path) -> Result<(), PlotError> {
        write(path, &self.to_png()?)
    }

    /// The bytes of [`Self::write_svg`], as a string.
    ///
    /// # Errors
    /// [`PlotError::LengthMismatch`].
    pub fn to_svg(&self) -> Result<String, PlotError> {
        self.check_lengths()?;
        Ok(svg::render(&draw::scene(self)))
    }

    /// The bytes of [`Self::write_png`].
    ///
    /// # Errors
    /// [`PlotError::LengthMismatch`] or [`PlotError::Encode`].
    pub fn to_png(&self) -> Result<Vec<u8>, PlotError> {
        self.check_lengths()?;
        Ok(raster::render(&draw::scene(self))?)
    }

    fn check_lengths(&self) -> Result<(), PlotError> {
        match self.series.iter().find(|s| s.x.len() != s.y.len()) {
            None => Ok(()),
            Some(s) => Err(PlotError::LengthMismatch {
                series: s.name.to_owned(),
                x: s.x.len(),
                y: s.y.len(),
            }),
        }
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), PlotError> {
    fs::write(path, bytes).map_err(|source| PlotError::Write {
        path: path.to_owned(),
        source,
    })
}
