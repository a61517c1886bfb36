//! Places in a scene file, and what is reported about them.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Where something was written.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum Place {
    /// Bytes of the scene file; for a string, those between its quotes.
    File(Range<usize>),
    /// A setting given from outside, e.g. `--set l=4`.
    Setting(Arc<str>),
    /// Built by a program.
    #[default]
    Program,
}

impl Place {
    /// The part of this place that a span of its text covers.
    pub fn part(&self, span: &Range<usize>) -> Place {
        match self {
            Place::File(range) => {
                let at = |i: usize| (range.start + i).min(range.end.max(range.start));
                Place::File(at(span.start)..at(span.end))
            }
            other => other.clone(),
        }
    }
}

/// One thing that is wrong with a scene (or worth a warning), and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Where.
    pub place: Place,
    /// What is wrong, what was found, what would be right.
    pub message: String,
}

/// The text of a scene, for line and column numbers.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Name of the file.
    pub name: String,
    /// Its text.
    pub text: Arc<str>,
}

impl Source {
    /// Line and column, counted from 1; columns count characters.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let mut end = offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }

    /// `file:line:column`, or the setting.
    pub fn locate(&self, place: &Place) -> String {
        match place {
            Place::File(range) => {
                let (line, column) = self.position(range.start);
                format!("{}:{line}:{column}", self.name)
            }
            Place::Setting(text) => format!("`{text}`"),
            Place::Program => self.name.clone(),
        }
    }

    /// `file:line:column: message`, the line and a mark under the place.
    pub fn show(&self, diagnostic: &Diagnostic) -> String {
        match &diagnostic.place {
            Place::File(range) => {
                let (line, column) = self.position(range.start);
                let text = self.text.lines().nth(line - 1).unwrap_or("");
                let width = self.text.get(range.clone()).map_or(1, |s| s.lines().next().unwrap_or("").chars().count());
                let gutter = line.to_string().len();
                let mark = " ".repeat(column - 1) + &"^".repeat(width.clamp(1, 120));
                format!(
                    "{}:{line}:{column}: {}\n{line} | {text}\n{:gutter$} | {mark}",
                    self.name, diagnostic.message, ""
                )
            }
            Place::Setting(text) => format!("`{text}`: {}", diagnostic.message),
            Place::Program => format!("{}: {}", self.name, diagnostic.message),
        }
    }
}

/// A scene that cannot be made into a model: everything that is wrong with it.
#[derive(Clone, Debug)]
pub struct ModelError {
    /// The text.
    pub source: Source,
    /// What is wrong, in the order of the file.
    pub diagnostics: Vec<Diagnostic>,
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, d) in self.diagnostics.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{}", self.source.show(d))?;
        }
        Ok(())
    }
}

impl std::error::Error for ModelError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_the_place() {
        let source = Source { name: "a.toml".into(), text: "x = 1\ny = \"l + theta\"\n".into() };
        let d = Diagnostic { place: Place::File(11..20), message: "no".into() };
        assert_eq!(source.show(&d), "a.toml:2:6: no\n2 | y = \"l + theta\"\n  |      ^^^^^^^^^");
        assert_eq!(source.position(1_000_000), (3, 1));
    }
}
