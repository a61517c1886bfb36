//! The coefficients of PAC2002 and how they come out of a `.tir` file.

use super::{Pac2002, Ranges, Side};
use crate::tir::{Measure, Note, Tir, TirError};

macro_rules! coefficients {
    ($( $section:ident = $default:literal { $($key:ident)* } )*) => {
        /// All coefficients by their names in the file, lower case; [`Pac2002::coefficient`] reads them.
        #[derive(Clone, PartialEq, Debug)]
        pub struct Coefficients { $($(pub(super) $key: f64,)*)* }

        impl Default for Coefficients {
            fn default() -> Self {
                Self { $($($key: $default,)*)* }
            }
        }

        /// Section, value where it is not given, keys.
        const SECTIONS: &[(&str, f64, &[&str])] = &[$((stringify!($section), $default, &[$(stringify!($key)),*])),*];

        impl Coefficients {
            /// Place of the coefficient with that name, lower case.
            pub(super) fn slot(&mut self, name: &str) -> Option<&mut f64> {
                match name {
                    $($(stringify!($key) => Some(&mut self.$key),)*)*
                    _ => None,
                }
            }
        }
    };
}

coefficients! {
    SCALING_COEFFICIENTS = 1.0 {
        lfzo lcx lmux lex lkx lhx lvx lgax lcy lmuy ley lky lhy lvy lgay lkg ltr lres lgaz lxal lyka lvyka ls
        lsgkp lsgal lmx lvmx lmy lcz
    }
    LONGITUDINAL_COEFFICIENTS = 0.0 {
        pcx1 pdx1 pdx2 pdx3 pex1 pex2 pex3 pex4 pkx1 pkx2 pkx3 phx1 phx2 pvx1 pvx2 ppx1 ppx2 ppx3 ppx4
        rbx1 rbx2 rcx1 rex1 rex2 rhx1 ptx1 ptx2 ptx3
    }
    OVERTURNING_COEFFICIENTS = 0.0 { qsx1 qsx2 qsx3 qsx4 qsx5 qsx6 qsx7 qsx8 qsx9 qsx10 qsx11 qpx1 }
    LATERAL_COEFFICIENTS = 0.0 {
        pcy1 pdy1 pdy2 pdy3 pey1 pey2 pey3 pey4 pky1 pky2 pky3 phy1 phy2 phy3 pvy1 pvy2 pvy3 pvy4 ppy1 ppy2 ppy3 ppy4
        rby1 rby2 rby3 rcy1 rey1 rey2 rhy1 rhy2 rvy1 rvy2 rvy3 rvy4 rvy5 rvy6 pty1 pty2
    }
    ROLLING_COEFFICIENTS = 0.0 { qsy1 qsy2 qsy3 qsy4 qsy5 qsy6 qsy7 qsy8 }
    ALIGNING_COEFFICIENTS = 0.0 {
        qbz1 qbz2 qbz3 qbz4 qbz5 qbz9 qbz10 qcz1 qdz1 qdz2 qdz3 qdz4 qdz6 qdz7 qdz8 qdz9 qez1 qez2 qez3 qez4 qez5
        qhz1 qhz2 qhz3 qhz4 qpz1 qpz2 ssz1 ssz2 ssz3 ssz4
    }
}

/// Keys that are read below, with their section, measure and value where they are not given (NaN: something else is done).
const OTHERS: &[(&str, &str, Measure, f64)] = &[
    ("DIMENSION", "UNLOADED_RADIUS", Measure::Length, f64::NAN),
    ("VERTICAL", "FNOMIN", Measure::Force, f64::NAN),
    ("VERTICAL", "VERTICAL_STIFFNESS", Measure::Stiffness, f64::NAN),
    ("VERTICAL", "VERTICAL_DAMPING", Measure::Damping, 0.0),
    ("VERTICAL", "BREFF", Measure::Number, 0.0),
    ("VERTICAL", "DREFF", Measure::Number, 0.0),
    ("VERTICAL", "FREFF", Measure::Number, 0.0),
    ("VERTICAL", "QFZ1", Measure::Number, f64::NAN),
    ("VERTICAL", "QFZ2", Measure::Number, f64::NAN),
    ("MODEL", "LONGVL", Measure::Speed, 16.7),
    ("MODEL", "USE_MODE", Measure::Number, 4.0),
    ("TIRE_CONDITIONS", "IP", Measure::Pressure, f64::NAN),
    ("TIRE_CONDITIONS", "IP_NOM", Measure::Pressure, f64::NAN),
    ("LONG_SLIP_RANGE", "KPUMIN", Measure::Number, -1.0),
    ("LONG_SLIP_RANGE", "KPUMAX", Measure::Number, 1.0),
    ("SLIP_ANGLE_RANGE", "ALPMIN", Measure::Angle, -1.5),
    ("SLIP_ANGLE_RANGE", "ALPMAX", Measure::Angle, 1.5),
    ("INCLINATION_ANGLE_RANGE", "CAMMIN", Measure::Angle, -0.26),
    ("INCLINATION_ANGLE_RANGE", "CAMMAX", Measure::Angle, 0.26),
    ("VERTICAL_FORCE_RANGE", "FZMIN", Measure::Force, 0.0),
    ("VERTICAL_FORCE_RANGE", "FZMAX", Measure::Force, f64::INFINITY),
];

/// Keys that belong to the format but say nothing that these laws use.
const UNUSED: &[&str] = &[
    "ASPECT_RATIO",
    "BELT_DYNAMICS",
    "BOTTOMING_RADIUS",
    "BOTTOMING_STIFFNESS",
    "COMMENTS",
    "CONTACT_MODEL",
    "DYNAMIC_DAMPING",
    "DYNAMIC_STIFFNESS",
    "FILE_FORMAT",
    "FILE_TYPE",
    "FILE_VERSION",
    "FUNCTION_NAME",
    "IXX",
    "IYY",
    "LGYR",
    "LIP",
    "MASS",
    "MBELT",
    "PROPERTY_FILE_FORMAT",
    "PTX4",
    "PTY3",
    "QTZ1",
    "RIM_RADIUS",
    "RIM_WIDTH",
    "TIRE_VERSION",
    "TYRESIDE",
    "USER_SUB_ID",
    "VXLOW",
    "WIDTH",
];

/// Other spellings of a key.
const ALIASES: &[(&str, &str)] =
    &[("lfzo", "LFZ0"), ("lkg", "LKYG"), ("lkg", "LKC"), ("IP", "INFLPRES"), ("IP_NOM", "NOMPRES")];

impl Pac2002 {
    /// Takes the model out of a file; what was assumed is in the [notes](Pac2002::notes), those of the file first.
    ///
    /// Needed are `UNLOADED_RADIUS`, `FNOMIN` and, of each of the two directions of force that the file has at all, C, D and K.
    /// Without the section of a direction there is no force along it.
    ///
    /// # Errors
    /// [`TirError`]: the file is for another model, a needed number is missing or out of range, or a number is none.
    pub fn from_tir(tir: &Tir) -> Result<Self, TirError> {
        let mut reader = Reader { tir, notes: tir.notes.clone() };
        reader.format()?;
        let c = reader.coefficients()?;
        reader.missing_others();
        reader.unknown();
        reader.unused_tables();
        let radius = reader.needed("DIMENSION", "UNLOADED_RADIUS", "the radius of the tyre without load")?;
        let load = reader.needed("VERTICAL", "FNOMIN", "the load about which the formula is written")?;
        let pressure = reader.number("IP")?;
        let ip_nom = reader.number("IP_NOM")?;
        let pressure = match (pressure, ip_nom) {
            (Some(p), Some(p0)) if p0 > 0.0 && p >= 0.0 => p / p0,
            (Some(_), Some(found)) => return Err(reader.range("IP_NOM", found, "above zero, and IP not below")),
            _ => 1.0,
        };
        let use_mode = reader.use_mode()?;
        let mut tyre = Self {
            longitudinal: tir.has_section("LONGITUDINAL_COEFFICIENTS") && !matches!(use_mode, 0 | 2),
            lateral: tir.has_section("LATERAL_COEFFICIENTS") && !matches!(use_mode, 0 | 1),
            combined: use_mode >= 4,
            c,
            radius,
            load,
            pressure,
            speed: reader.positive("LONGVL")?,
            stiffness: reader.number("VERTICAL_STIFFNESS")?,
            damping: reader.or_default("VERTICAL_DAMPING")?,
            effective: [reader.or_default("BREFF")?, reader.or_default("DREFF")?, reader.or_default("FREFF")?],
            progression: reader.number("QFZ1")?.zip(reader.number("QFZ2")?),
            curve: reader.curve()?,
            ranges: reader.ranges()?,
            side: reader.side(),
            notes: Vec::new(),
        };
        tyre.check(&mut reader)?;
        tyre.notes = reader.notes;
        Ok(tyre)
    }

    /// Refuses what would divide by zero, says what will be missed.
    fn check(&mut self, reader: &mut Reader) -> Result<(), TirError> {
        let c = &self.c;
        if let Some(k) = self.stiffness.filter(|k| *k <= 0.0) {
            return Err(reader.range("VERTICAL_STIFFNESS", k, "above zero"));
        }
        for (key, value) in [("LFZO", c.lfzo), ("LMUX", c.lmux), ("LMUY", c.lmuy)] {
            if value <= 0.0 {
                return Err(reader.range(key, value, "above zero"));
            }
        }
        let x = [("PCX1", c.pcx1 * c.lcx), ("PDX1", c.pdx1), ("PKX1", c.pkx1)];
        let y = [("PCY1", c.pcy1 * c.lcy), ("PDY1", c.pdy1), ("PKY1", c.pky1), ("PKY2", c.pky2)];
        let wanted = "other than zero; without it the formula divides by zero";
        for (key, value) in x.into_iter().filter(|_| self.longitudinal).chain(y.into_iter().filter(|_| self.lateral)) {
            if value == 0.0 {
                return Err(reader.range(key, value, wanted));
            }
        }
        let uncoupled = self.longitudinal && c.rbx1 * c.rcx1 == 0.0 || self.lateral && c.rby1 * c.rcy1 == 0.0;
        if self.combined && uncoupled {
            let what =
                "RBX1, RCX1 or RBY1, RCY1 are zero: that force does not fall with the slip across it".to_string();
            reader.notes.push(Note::Adjusted { what });
        }
        if self.stiffness.is_none() && self.progression.is_none() && self.curve.is_none() {
            let what = "no VERTICAL_STIFFNESS, QFZ1 or load curve: the scene must give the vertical law".to_string();
            reader.notes.push(Note::Adjusted { what });
        }
        Ok(())
    }
}

struct Reader<'a> {
    tir: &'a Tir,
    notes: Vec<Note>,
}

impl Reader<'_> {
    /// The key as the file spells it.
    fn spelled(&self, name: &str) -> String {
        let upper = name.to_ascii_uppercase();
        let other = ALIASES.iter().find(|(n, alias)| *n == name && self.tir.entries.contains_key(*alias));
        if self.tir.entries.contains_key(&upper) { upper } else { other.map_or(upper, |(_, a)| (*a).to_string()) }
    }

    fn number(&self, name: &str) -> Result<Option<f64>, TirError> {
        let measure = OTHERS.iter().find(|(_, key, ..)| *key == name).map_or(Measure::Number, |(.., m, _)| *m);
        self.tir.number(&self.spelled(name), measure)
    }

    fn or_default(&self, name: &str) -> Result<f64, TirError> {
        let default = OTHERS.iter().find(|(_, key, ..)| *key == name).map_or(0.0, |(.., d)| *d);
        Ok(self.number(name)?.unwrap_or(default))
    }

    fn positive(&self, name: &str) -> Result<f64, TirError> {
        let value = self.or_default(name)?;
        if value > 0.0 { Ok(value) } else { Err(self.range(name, value, "above zero")) }
    }

    fn needed(&self, section: &str, key: &str, why: &str) -> Result<f64, TirError> {
        let value = self.number(key)?.ok_or_else(|| TirError::Missing {
            section: section.to_string(),
            key: key.to_string(),
            why: why.to_string(),
        })?;
        if value > 0.0 { Ok(value) } else { Err(self.range(key, value, "above zero")) }
    }

    fn range(&self, key: &str, found: f64, wanted: &'static str) -> TirError {
        TirError::Range { line: self.tir.line(key), key: key.to_string(), found, wanted }
    }

    fn format(&self) -> Result<(), TirError> {
        let known = "PAC2002, MF_05, MF-TYRE";
        match self.tir.entries.get("PROPERTY_FILE_FORMAT") {
            Some(e) if !["PAC2002", "MF_05", "MF-TYRE"].contains(&e.text.to_ascii_uppercase().as_str()) => {
                Err(TirError::Format { line: e.line, found: e.text.clone(), known })
            }
            _ => Ok(()),
        }
    }

    fn coefficients(&mut self) -> Result<Coefficients, TirError> {
        let mut c = Coefficients::default();
        for (section, default, names) in SECTIONS {
            let mut missing = Vec::new();
            for name in *names {
                let key = self.spelled(name);
                let Some(value) = self.tir.number(&key, Measure::Number)? else {
                    missing.push(key);
                    continue;
                };
                *c.slot(name).expect("the table's own name") = value;
                let entry = &self.tir.entries[&key];
                if entry.section != *section {
                    let (line, found) = (entry.line, entry.section.clone());
                    self.notes.push(Note::Elsewhere { line, key, section: found, usual: (*section).to_string() });
                }
            }
            self.note_missing(section, missing, *default, names.len());
        }
        Ok(c)
    }

    fn note_missing(&mut self, section: &str, keys: Vec<String>, default: f64, all: usize) {
        let section_name = section.to_string();
        if keys.len() == all && !self.tir.has_section(section) {
            let assumed = match section {
                "LONGITUDINAL_COEFFICIENTS" => "no longitudinal force".to_string(),
                "LATERAL_COEFFICIENTS" => "no lateral force".to_string(),
                _ => format!("all of its coefficients are {default}"),
            };
            self.notes.push(Note::MissingSection { section: section_name, assumed });
        } else if !keys.is_empty() {
            let assumed = format!("{default} for each");
            self.notes.push(Note::MissingKeys { section: section_name, keys, assumed });
        }
    }

    /// Names keys of [`OTHERS`] that are not there, where a value was taken for them.
    fn missing_others(&mut self) {
        for (section, key, _, default) in OTHERS {
            if !default.is_nan() && !self.tir.entries.contains_key(&self.spelled(key)) {
                let (section, keys) = ((*section).to_string(), vec![(*key).to_string()]);
                self.notes.push(Note::MissingKeys { section, keys, assumed: default.to_string() });
            }
        }
    }

    fn unknown(&mut self) {
        let mut known: Vec<String> = OTHERS.iter().map(|(_, key, ..)| (*key).to_string()).collect();
        known.extend(SECTIONS.iter().flat_map(|(.., names)| names.iter().map(|n| n.to_ascii_uppercase())));
        let others = UNUSED.iter().chain(ALIASES.iter().map(|(_, alias)| alias)).map(|key| (*key).to_string());
        known.extend(others);
        for (key, entry) in &self.tir.entries {
            if !known.contains(key) {
                let near = known.iter().map(|k| (strsim::damerau_levenshtein(k, key), k)).min();
                let similar = near.filter(|(distance, _)| *distance == 1).map(|(_, k)| k.clone());
                self.notes.push(Note::UnknownKey { line: entry.line, key: key.clone(), similar });
            }
        }
    }

    /// Names tables that no one reads.
    fn unused_tables(&mut self) {
        for (section, table) in &self.tir.tables {
            if !["DEFLECTION_LOAD_CURVE", "SHAPE"].contains(&section.as_str()) {
                let what = format!("line {}: the table in [{section}] is not used", table.line);
                self.notes.push(Note::Adjusted { what });
            }
        }
    }

    /// 0 to 4: the tens say whether to use relaxation, which is the scene's affair, and a minus sign mirrors.
    fn use_mode(&mut self) -> Result<u32, TirError> {
        let value = self.or_default("USE_MODE")?;
        let mode = value.abs();
        if mode.fract() != 0.0 || mode > 99.0 {
            return Err(self.range("USE_MODE", value, "0 to 4, 10 to 14 or 20 to 25, or the negative of these"));
        }
        if mode % 10.0 > 4.0 {
            let what = format!("line {}: turn slip is not computed; USE_MODE taken as 4", self.tir.line("USE_MODE"));
            self.notes.push(Note::Adjusted { what });
        }
        Ok(mode as u32 % 10)
    }

    fn side(&self) -> Side {
        let minus = self.tir.entries.get("USE_MODE").is_some_and(|e| e.text.starts_with('-'));
        let right = self.tir.entries.get("TYRESIDE").is_some_and(|e| e.text.eq_ignore_ascii_case("RIGHT"));
        if right != minus { Side::Right } else { Side::Left }
    }

    fn ranges(&self) -> Result<Ranges, TirError> {
        let pair = |low: &str, high: &str| -> Result<[f64; 2], TirError> {
            let pair = [self.or_default(low)?, self.or_default(high)?];
            if pair[0] <= pair[1] { Ok(pair) } else { Err(self.range(low, pair[0], "not above the range's end")) }
        };
        Ok(Ranges {
            kappa: pair("KPUMIN", "KPUMAX")?,
            alpha: pair("ALPMIN", "ALPMAX")?,
            camber: pair("CAMMIN", "CAMMAX")?,
            load: pair("FZMIN", "FZMAX")?,
        })
    }

    fn curve(&mut self) -> Result<Option<headland_expr::Spline>, TirError> {
        let Some(table) = self.tir.tables.get("DEFLECTION_LOAD_CURVE") else { return Ok(None) };
        let units = &self.tir.units;
        let column = |i: usize, measure| -> Vec<f64> {
            table.rows.iter().filter_map(|row| row.get(i).map(|x| x * units.factor(measure))).collect()
        };
        let (x, y) = (column(0, Measure::Length), column(1, Measure::Force));
        match headland_expr::Spline::new("DEFLECTION_LOAD_CURVE", &x, &y) {
            Ok(spline) => Ok(Some(spline)),
            Err(error) => {
                let what = format!("line {}: the load curve was left out: {error}", table.line);
                self.notes.push(Note::Adjusted { what });
                Ok(None)
            }
        }
    }
}
