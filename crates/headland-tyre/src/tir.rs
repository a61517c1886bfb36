//! [`Tir`]: the text of a tyre property file (`.tir`, TeimOrbit), read without knowing a model.
//!
//! ```text
//! $ a comment            ! another one
//! [SECTION]
//! KEY = 1.5  $ a comment          numbers; also 1,5e3 and 1.5D3, as Fortran writes
//! NAME = 'text'
//! {pen fz}                        columns of a table
//!  0.0  0.0
//! ```
//! Names are read in any case. What cannot be read is a [`Note`], so that nothing of a file goes unseen; only what would
//! change numbers silently (a wrong unit, a number that is none) is an error. The format has no standard beyond the files
//! themselves; the reader follows those that the MSC and TNO programs write.

mod units;

use std::collections::BTreeMap;
use std::fmt;

pub use units::{Measure, Units};

/// A value with its line.
#[derive(Clone, PartialEq, Debug)]
pub struct Entry {
    /// Line, counted from 1.
    pub line: usize,
    /// Section in which it stands, upper case.
    pub section: String,
    /// As written, without quotes and comment.
    pub text: String,
}

/// A table of numbers.
#[derive(Clone, PartialEq, Debug)]
pub struct Table {
    /// Line of its first row.
    pub line: usize,
    /// Its rows, all of one length.
    pub rows: Vec<Vec<f64>>,
}

/// A tyre property file.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Tir {
    /// Names of the sections in order, upper case.
    pub sections: Vec<(String, usize)>,
    /// Values by key, upper case. Keys of `[UNITS]` are not among them.
    pub entries: BTreeMap<String, Entry>,
    /// Tables by section.
    pub tables: BTreeMap<String, Table>,
    /// Units of the file.
    pub units: Units,
    /// What was found or left out; models add theirs.
    pub notes: Vec<Note>,
}

/// Something that a user should know about a file that was read.
#[derive(Clone, PartialEq, Debug)]
pub enum Note {
    /// A section that a model reads is not there.
    MissingSection {
        /// Name of the section.
        section: String,
        /// What was taken instead.
        assumed: String,
    },
    /// Keys that a model reads are not there.
    MissingKeys {
        /// Section in which they should stand.
        section: String,
        /// The keys.
        keys: Vec<String>,
        /// What was taken instead.
        assumed: String,
    },
    /// A key that no one reads.
    UnknownKey {
        /// Its line.
        line: usize,
        /// The key.
        key: String,
        /// A key that may be meant.
        similar: Option<String>,
    },
    /// A key that stands in another section than usual; it was read.
    Elsewhere {
        /// Its line.
        line: usize,
        /// The key.
        key: String,
        /// Section in which it stands.
        section: String,
        /// Usual section.
        usual: String,
    },
    /// A key given twice; the last one counts.
    Duplicate {
        /// Line of the one that counts.
        line: usize,
        /// The key.
        key: String,
        /// Line of the one before.
        before: usize,
    },
    /// A line that is neither section, value, table nor comment; it was left out.
    Unreadable {
        /// Its line.
        line: usize,
        /// Its start.
        text: String,
    },
    /// Something that does not fit, with what was done about it.
    Adjusted {
        /// What and why.
        what: String,
    },
}

/// Why a file cannot be used.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TirError {
    /// No section at all.
    #[error("this is no .tir file: it has no section such as [UNITS] or [DIMENSION]")]
    NoSections,
    /// A unit that is none of its kind.
    #[error("line {line}: `{found}` is no unit for {kind}; known are {known}")]
    Unit {
        /// Its line.
        line: usize,
        /// LENGTH, FORCE, ..
        kind: &'static str,
        /// What is written.
        found: String,
        /// What could be written.
        known: String,
    },
    /// A value that should be a number.
    #[error("line {line}: {key} = {found} is not a finite number")]
    NotANumber {
        /// Its line.
        line: usize,
        /// The key.
        key: String,
        /// What is written.
        found: String,
    },
    /// A key without which nothing can be computed.
    #[error("[{section}] {key} is missing: {why}")]
    Missing {
        /// Section in which it should stand.
        section: String,
        /// The key.
        key: String,
        /// What it is needed for.
        why: String,
    },
    /// A number outside of what makes sense.
    #[error("line {line}: {key} = {found} must be {wanted}")]
    Range {
        /// Its line; 0 for an assumed value.
        line: usize,
        /// The key.
        key: String,
        /// Its value in SI units.
        found: f64,
        /// What is allowed.
        wanted: &'static str,
    },
    /// A file for another model.
    #[error("line {line}: PROPERTY_FILE_FORMAT is '{found}'; this reader knows {known}")]
    Format {
        /// Its line.
        line: usize,
        /// What is written.
        found: String,
        /// What could be written.
        known: &'static str,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MissingSection { section, assumed } => write!(f, "no section [{section}]; assumed: {assumed}"),
            Self::MissingKeys { section, keys, assumed } => {
                write!(f, "[{section}] lacks {}; assumed: {assumed}", keys.join(", "))
            }
            Self::UnknownKey { line, key, similar: Some(similar) } => {
                write!(f, "line {line}: {key} is not known and was left out; is {similar} meant?")
            }
            Self::UnknownKey { line, key, similar: None } => {
                write!(f, "line {line}: {key} is not known and was left out")
            }
            Self::Elsewhere { line, key, section, usual } => {
                write!(f, "line {line}: {key} stands in [{section}], not in [{usual}]; it was read")
            }
            Self::Duplicate { line, key, before } => {
                write!(f, "line {line}: {key} is given again (first on line {before}); the last one counts")
            }
            Self::Unreadable { line, text } => write!(f, "line {line}: `{text}` cannot be read and was left out"),
            Self::Adjusted { what } => write!(f, "{what}"),
        }
    }
}

impl Tir {
    /// Reads the bytes of a file; comments may be in any encoding.
    ///
    /// # Errors
    /// [`TirError`]: no section at all, or a unit that is none.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TirError> {
        Self::parse(&String::from_utf8_lossy(bytes))
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`TirError`]: no section at all, or a unit that is none.
    pub fn parse(text: &str) -> Result<Self, TirError> {
        let mut tir = Self::default();
        let mut units = BTreeMap::new();
        let mut section = String::new();
        for (number, raw) in text.lines().enumerate().map(|(i, l)| (i + 1, l)) {
            let line = without_comment(raw).trim();
            if line.is_empty() || line.starts_with('{') {
                continue;
            }
            if let Some(name) = line.strip_prefix('[').and_then(|l| l.split(']').next()) {
                section = name.trim().to_ascii_uppercase();
                tir.sections.push((section.clone(), number));
            } else if let Some((key, value)) = line.split_once('=') {
                let key = key.trim().to_ascii_uppercase();
                let text = value.trim().trim_matches(['\'', '"']).trim().to_string();
                if section == "UNITS" {
                    units.insert(key, (number, text));
                } else {
                    tir.insert(key, Entry { line: number, section: section.clone(), text });
                }
            } else if !tir.table_row(&section, number, line) {
                tir.notes.push(Note::Unreadable { line: number, text: line.chars().take(40).collect() });
            }
        }
        if tir.sections.is_empty() {
            return Err(TirError::NoSections);
        }
        tir.read_units(&units)?;
        Ok(tir)
    }

    /// The number of a key in SI units, or `None` where it is not given.
    ///
    /// # Errors
    /// [`TirError::NotANumber`].
    pub fn number(&self, key: &str, measure: Measure) -> Result<Option<f64>, TirError> {
        let Some(entry) = self.entries.get(key) else { return Ok(None) };
        let value = parse_number(&entry.text).map(|x| x * self.units.factor(measure)).filter(|x| x.is_finite());
        value.map(Some).ok_or_else(|| TirError::NotANumber {
            line: entry.line,
            key: key.to_string(),
            found: entry.text.clone(),
        })
    }

    /// True where a section is there.
    pub fn has_section(&self, name: &str) -> bool {
        self.sections.iter().any(|(section, _)| section == name)
    }

    /// Line of a key, 0 where it is not given.
    pub fn line(&self, key: &str) -> usize {
        self.entries.get(key).map_or(0, |entry| entry.line)
    }

    fn insert(&mut self, key: String, entry: Entry) {
        let line = entry.line;
        if let Some(old) = self.entries.insert(key.clone(), entry) {
            self.notes.push(Note::Duplicate { line, key, before: old.line });
        }
    }

    /// Takes a row of numbers; false where it is none.
    fn table_row(&mut self, section: &str, line: usize, text: &str) -> bool {
        let words = text.split_whitespace();
        let Some(row) = words.map(parse_number).collect::<Option<Vec<f64>>>() else { return false };
        let table = self.tables.entry(section.to_string()).or_insert_with(|| Table { line, rows: Vec::new() });
        let fits = table.rows.first().is_none_or(|first| first.len() == row.len());
        if fits {
            table.rows.push(row);
        }
        fits
    }

    fn read_units(&mut self, block: &BTreeMap<String, (usize, String)>) -> Result<(), TirError> {
        let (units, missing) = Units::read(block)?;
        self.units = units;
        if !self.has_section("UNITS") {
            let assumed = "meter, newton, radian, kg, second, pascal".to_string();
            self.notes.push(Note::MissingSection { section: "UNITS".to_string(), assumed });
        } else if !missing.is_empty() {
            let keys = missing.iter().map(ToString::to_string).collect();
            let assumed = "SI units for these".to_string();
            self.notes.push(Note::MissingKeys { section: "UNITS".to_string(), keys, assumed });
        }
        Ok(())
    }
}

/// A line up to its comment, `$` or `!`; not within quotes.
fn without_comment(line: &str) -> &str {
    let mut quoted = false;
    let end = line.find(|c| {
        quoted ^= c == '\'';
        !quoted && (c == '$' || c == '!')
    });
    &line[..end.unwrap_or(line.len())]
}

/// A finite number, as C or Fortran writes it.
fn parse_number(text: &str) -> Option<f64> {
    let plain = text.replace(['D', 'd'], "e").replace(',', ".");
    // "inf" and "nan" are numbers to Rust, not to a tyre
    let number = plain.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    number.then(|| plain.parse::<f64>().ok()).flatten().filter(|x| x.is_finite())
}

#[cfg(test)]
mod tests;
