//! Scene files: TOML text to a [`Scene`], with everything that is wrong with its form.

use std::ops::Range;

use headland_expr::parse::suggestion;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::format::{Key, SECTIONS, Section, Shape};
use crate::place::{Diagnostic, ModelError, Place, Source};
use crate::scene::{Data, Element, Entry, Scene, Value};

impl Scene {
    /// Reads a scene from TOML text; `name` stands in messages.
    ///
    /// # Errors
    /// Everything that is wrong with the form of the file: TOML itself, unknown sections and keys, missing keys.
    pub fn parse(name: &str, text: &str) -> Result<Self, ModelError> {
        let source = Source { name: name.into(), text: text.into() };
        let mut reader = Reader { text, diagnostics: Vec::new() };
        let (table, errors) = DeTable::parse_recoverable(text);
        for error in &errors {
            let hint = if error.message().contains("unquoted key") {
                "; names with primes or brackets stand in quotes: \"x'\" = .., \"theta[k]\" = .."
            } else {
                ""
            };
            reader.report(error.span().unwrap_or(0..0), format!("not TOML: {}{hint}", error.message().trim()));
        }
        if !errors.is_empty() {
            return Err(ModelError { source, diagnostics: reader.diagnostics });
        }
        let mut scene = Scene { source: source.clone(), ..Scene::default() };
        for entry in reader.entries(table.get_ref()) {
            reader.section(entry, &mut scene);
        }
        if reader.diagnostics.is_empty() {
            return Ok(scene);
        }
        let mut diagnostics = reader.diagnostics;
        diagnostics.sort_by_key(|d| match &d.place {
            Place::File(range) => range.start,
            _ => 0,
        });
        diagnostics.dedup();
        Err(ModelError { source, diagnostics })
    }
}

struct Reader<'t> {
    text: &'t str,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn report(&mut self, span: Range<usize>, message: String) {
        self.diagnostics.push(Diagnostic { place: Place::File(span), message });
    }

    fn report_at(&mut self, place: &Place, message: String) {
        self.diagnostics.push(Diagnostic { place: place.clone(), message });
    }

    /// The entries of a table in the order of the file.
    fn entries(&mut self, table: &DeTable<'_>) -> Vec<Entry> {
        let mut entries: Vec<(usize, Entry)> = table
            .iter()
            .map(|(key, value)| {
                let span = key.span();
                let key_place = Place::File(self.inside_quotes(span.clone(), key.get_ref()));
                (span.start, Entry { key: key.get_ref().to_string(), key_place, value: self.value(value) })
            })
            .collect();
        entries.sort_by_key(|(start, _)| *start);
        entries.into_iter().map(|(_, e)| e).collect()
    }

    fn value(&mut self, value: &Spanned<DeValue<'_>>) -> Value {
        let span = value.span();
        let mut place = Place::File(span.clone());
        let data = match value.get_ref() {
            DeValue::String(text) => {
                place = Place::File(self.inside_quotes(span, text));
                Data::Text(text.to_string())
            }
            DeValue::Integer(x) => match i64::from_str_radix(x.as_str(), x.radix()) {
                Ok(i) => Data::Number(i as f64),
                Err(_) => {
                    self.report(span, format!("the integer `{x}` is too large"));
                    Data::Number(0.0)
                }
            },
            DeValue::Float(x) => match x.as_str().parse::<f64>() {
                Ok(x) if x.is_finite() => Data::Number(x),
                _ => {
                    self.report(span, format!("`{x}` is not a finite number"));
                    Data::Number(0.0)
                }
            },
            DeValue::Boolean(flag) => Data::Flag(*flag),
            DeValue::Array(values) => Data::Array(values.iter().map(|v| self.value(v)).collect()),
            DeValue::Table(table) => Data::Table(self.entries(table)),
            DeValue::Datetime(_) => {
                self.report(span, "a date has no meaning in a scene".into());
                Data::Flag(false)
            }
        };
        Value { data, place }
    }

    /// The bytes between the quotes, if the text stands there as it is.
    fn inside_quotes(&self, span: Range<usize>, text: &str) -> Range<usize> {
        let raw = self.text.get(span.clone()).unwrap_or("");
        match raw.find(text) {
            Some(start) if raw.len() >= start + text.len() => span.start + start..span.start + start + text.len(),
            _ => span,
        }
    }

    fn section(&mut self, entry: Entry, scene: &mut Scene) {
        let Some(section) = SECTIONS.iter().find(|s| s.name == entry.key) else {
            let hint = suggestion(&entry.key, SECTIONS.iter().map(|s| s.name));
            let known: Vec<&str> = SECTIONS.iter().map(|s| s.name).collect();
            let list = if hint.is_empty() { format!("; known: {}", known.join(", ")) } else { hint };
            return self.report_at(&entry.key_place, format!("unknown section `{}`{list}", entry.key));
        };
        match (section.shape, entry.value.data) {
            (Shape::Top, Data::Text(text)) => {
                let value = Value { data: Data::Text(text), place: entry.value.place };
                scene.top.push(Entry { key: entry.key, key_place: entry.key_place, value });
            }
            (Shape::Names, Data::Table(entries)) => {
                scene.tables.insert(entry.key, entries);
            }
            (Shape::Keys, Data::Table(entries)) => {
                self.check_keys(section, &entries, &entry.key_place);
                scene.tables.insert(entry.key, entries);
            }
            (Shape::Elements, Data::Array(values)) => {
                let mut elements = Vec::new();
                for value in values {
                    let place = value.place;
                    match value.data {
                        Data::Table(fields) => {
                            self.check_keys(section, &fields, &place);
                            elements.push(Element { fields, place });
                        }
                        other => {
                            self.report_at(&place, format!("found {} where an element was expected", other.kind()))
                        }
                    }
                }
                scene.elements.insert(entry.key, elements);
            }
            (shape, data) => {
                let expected = match shape {
                    Shape::Top => format!("a text: {} = \"..\"", section.name),
                    Shape::Names | Shape::Keys => format!("a section: [{}]", section.name),
                    Shape::Elements => format!("elements: [[{}]]", section.name),
                };
                self.report_at(
                    &entry.key_place,
                    format!("`{}` is {} but should be {expected}", section.name, data.kind()),
                );
            }
        }
    }

    fn check_keys(&mut self, section: &Section, entries: &[Entry], place: &Place) {
        for entry in entries {
            if !section.keys.iter().any(|k| k.name == entry.key) {
                let hint = suggestion(&entry.key, section.keys.iter().map(|k| k.name));
                let known: Vec<&str> = section.keys.iter().map(|k| k.name).collect();
                let message =
                    format!("`{}` has no key `{}`{hint}; known: {}", section.name, entry.key, known.join(", "));
                self.report_at(&entry.key_place, message);
            }
        }
        for entry in entries {
            let Some(key) = section.keys.iter().find(|k| k.name == entry.key) else { continue };
            if !key.kind.admits(&entry.value.data) {
                let message = format!(
                    "`{}` is {}, but {} was expected: {}",
                    key.name,
                    entry.value.data.kind(),
                    key.kind.name(),
                    key.doc
                );
                self.report_at(&entry.value.place, message);
            }
        }
        let missing: Vec<&Key> =
            section.keys.iter().filter(|k| k.required && entries.iter().all(|e| e.key != k.name)).collect();
        for key in missing {
            self.report_at(place, format!("this `{}` lacks `{}`: {}", section.name, key.name, key.doc));
        }
    }
}
