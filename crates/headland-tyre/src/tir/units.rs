//! The `[UNITS]` block of a `.tir` file.

use std::collections::BTreeMap;

use super::TirError;

/// What a key of a `.tir` file measures.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Measure {
    /// A pure number.
    Number,
    /// m.
    Length,
    /// N.
    Force,
    /// rad.
    Angle,
    /// kg.
    Mass,
    /// Pa.
    Pressure,
    /// m/s.
    Speed,
    /// N/m.
    Stiffness,
    /// N·s/m.
    Damping,
    /// kg·m².
    Inertia,
}

/// How many SI units one unit of the file is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Units {
    length: f64,
    force: f64,
    angle: f64,
    mass: f64,
    time: f64,
    pressure: f64,
}

/// SI: what is assumed without a block.
impl Default for Units {
    fn default() -> Self {
        Self { length: 1.0, force: 1.0, angle: 1.0, mass: 1.0, time: 1.0, pressure: 1.0 }
    }
}

const POUND: f64 = 0.453_592_37;
const GRAVITY: f64 = 9.806_65;

const LENGTHS: &[(&str, f64)] = &[
    ("METER", 1.0),
    ("METRE", 1.0),
    ("M", 1.0),
    ("MILLIMETER", 1e-3),
    ("MM", 1e-3),
    ("CENTIMETER", 1e-2),
    ("CM", 1e-2),
    ("KILOMETER", 1e3),
    ("KM", 1e3),
    ("INCH", 0.0254),
    ("FOOT", 0.3048),
    ("MILE", 1609.344),
];
const FORCES: &[(&str, f64)] = &[
    ("NEWTON", 1.0),
    ("N", 1.0),
    ("KILONEWTON", 1e3),
    ("KN", 1e3),
    ("KILOGRAM_FORCE", GRAVITY),
    ("KGF", GRAVITY),
    ("POUND_FORCE", POUND * GRAVITY),
    ("LBF", POUND * GRAVITY),
    ("KPOUND_FORCE", 1e3 * POUND * GRAVITY),
    ("DYNE", 1e-5),
    ("OUNCE_FORCE", POUND * GRAVITY / 16.0),
];
const ANGLES: &[(&str, f64)] = &[
    ("RADIAN", 1.0),
    ("RADIANS", 1.0),
    ("RAD", 1.0),
    ("DEGREE", std::f64::consts::PI / 180.0),
    ("DEGREES", std::f64::consts::PI / 180.0),
    ("DEG", std::f64::consts::PI / 180.0),
];
const MASSES: &[(&str, f64)] = &[
    ("KG", 1.0),
    ("KILOGRAM", 1.0),
    ("GRAM", 1e-3),
    ("TONNE", 1e3),
    ("POUND_MASS", POUND),
    ("LBM", POUND),
    ("SLUG", POUND * GRAVITY / 0.3048),
    ("OUNCE_MASS", POUND / 16.0),
];
const TIMES: &[(&str, f64)] = &[
    ("SECOND", 1.0),
    ("SEC", 1.0),
    ("S", 1.0),
    ("MILLISECOND", 1e-3),
    ("MS", 1e-3),
    ("MINUTE", 60.0),
    ("HOUR", 3600.0),
];
const PRESSURES: &[(&str, f64)] = &[
    ("PASCAL", 1.0),
    ("PA", 1.0),
    ("KILOPASCAL", 1e3),
    ("KPA", 1e3),
    ("MEGAPASCAL", 1e6),
    ("MPA", 1e6),
    ("BAR", 1e5),
    ("PSI", POUND * GRAVITY / (0.0254 * 0.0254)),
];

impl Units {
    /// By the keys of the block, upper case, without quotes, with the line of each. Returns as well the kinds of which the
    /// block says nothing.
    ///
    /// # Errors
    /// [`TirError::Unit`] for a unit that is none of its kind.
    pub(super) fn read(block: &BTreeMap<String, (usize, String)>) -> Result<(Self, Vec<&'static str>), TirError> {
        let mut missing = Vec::new();
        let mut factor = |kind: &'static str, names: &'static [(&'static str, f64)]| {
            let Some((line, text)) = block.get(kind) else {
                missing.push(kind);
                return Ok(1.0);
            };
            let name = text.to_ascii_uppercase();
            names.iter().find(|(n, _)| *n == name).map(|(_, f)| *f).ok_or_else(|| TirError::Unit {
                line: *line,
                kind,
                found: text.clone(),
                known: names.iter().map(|(n, _)| n.to_ascii_lowercase()).collect::<Vec<_>>().join(", "),
            })
        };
        let units = Self {
            length: factor("LENGTH", LENGTHS)?,
            force: factor("FORCE", FORCES)?,
            angle: factor("ANGLE", ANGLES)?,
            mass: factor("MASS", MASSES)?,
            time: factor("TIME", TIMES)?,
            // older files have no pressure at all
            pressure: factor("PRESSURE", PRESSURES)?,
        };
        missing.retain(|kind| *kind != "PRESSURE");
        Ok((units, missing))
    }

    /// How many SI units one unit of the file is.
    pub fn factor(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Number => 1.0,
            Measure::Length => self.length,
            Measure::Force => self.force,
            Measure::Angle => self.angle,
            Measure::Mass => self.mass,
            Measure::Pressure => self.pressure,
            Measure::Speed => self.length / self.time,
            Measure::Stiffness => self.force / self.length,
            Measure::Damping => self.force * self.time / self.length,
            Measure::Inertia => self.mass * self.length * self.length,
        }
    }
}
