//! [`Scene`]: what a scene file says, as plain data with the place of everything. Built by [`crate::read`] or by a program.

use indexmap::IndexMap;

use crate::format::{self, Shape};
use crate::place::{Diagnostic, ModelError, Place, Source};
use crate::units::parse_quantity;

/// A value and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// What it is.
    pub data: Data,
    /// Where it was written; for a text, the place between the quotes.
    pub place: Place,
}

/// What a scene file can hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// A number in SI units, or in the units that its place needs.
    Number(f64),
    /// A quantity (`"4 m"`), an expression, a unit or a word.
    Text(String),
    /// True or false.
    Flag(bool),
    /// Several values.
    Array(Vec<Value>),
    /// Named values.
    Table(Vec<Entry>),
}

impl Data {
    /// What it is, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Data::Number(_) => "a number",
            Data::Text(_) => "a text",
            Data::Flag(_) => "true or false",
            Data::Array(_) => "an array",
            Data::Table(_) => "a table",
        }
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        Self { data: Data::Number(x), place: Place::Program }
    }
}
impl From<&str> for Value {
    fn from(x: &str) -> Self {
        Self { data: Data::Text(x.into()), place: Place::Program }
    }
}
impl<T: Into<Value> + Clone> From<&[T]> for Value {
    fn from(x: &[T]) -> Self {
        Self { data: Data::Array(x.iter().cloned().map(Into::into).collect()), place: Place::Program }
    }
}

impl<T: Into<Value>, const N: usize> From<[T; N]> for Value {
    fn from(x: [T; N]) -> Self {
        Self { data: Data::Array(x.into_iter().map(Into::into).collect()), place: Place::Program }
    }
}
impl From<bool> for Value {
    fn from(x: bool) -> Self {
        Self { data: Data::Flag(x), place: Place::Program }
    }
}

/// A named value.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name, with index and primes as written.
    pub key: String,
    /// Where the name was written.
    pub key_place: Place,
    /// Its value.
    pub value: Value,
}

/// One `[[section]]` of the file: an element of the mechanical model, a guard, a plot.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Element {
    /// Its keys.
    pub fields: Vec<Entry>,
    /// Where it begins.
    pub place: Place,
}

impl Element {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.fields.iter().find(|e| e.key == key).map(|e| &e.value)
    }
}

/// What a scene file says; sections and keys are those of [`format::SECTIONS`].
///
/// ```
/// use headland_model::Scene;
///
/// let mut scene = Scene::new("falling stone");
/// scene.entry("parameters", "m", "2 kg").entry("parameters", "g", "9.81 m/s^2");
/// scene.entry("coordinates", "z", "m").entry("initial", "z", 0.0).entry("initial", "z'", 0.0);
/// scene.element("inertia", &[("name", "stone"), ("value", "m"), ("geometric", "z")]);
/// scene.element("force", &[("name", "weight"), ("value", "-m*g"), ("geometric", "z")]);
/// let model = scene.build().unwrap();
/// assert_eq!(model.coordinates.len(), 1);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The text it was read from.
    pub source: Source,
    /// Single keys of the top level (`title`, `description`).
    pub top: Vec<Entry>,
    /// `[section]` tables.
    pub tables: IndexMap<String, Vec<Entry>>,
    /// `[[section]]` arrays.
    pub elements: IndexMap<String, Vec<Element>>,
}

impl Scene {
    /// An empty scene with a title.
    pub fn new(title: &str) -> Self {
        let mut scene = Self { source: Source { name: title.into(), text: "".into() }, ..Self::default() };
        scene.top.push(Entry { key: "title".into(), key_place: Place::Program, value: title.into() });
        scene
    }

    /// Adds `key = value` to a section.
    pub fn entry(&mut self, section: &str, key: &str, value: impl Into<Value>) -> &mut Self {
        let entry = Entry { key: key.into(), key_place: Place::Program, value: value.into() };
        self.tables.entry(section.into()).or_default().push(entry);
        self
    }

    /// Adds an element to a `[[section]]`.
    pub fn element(&mut self, section: &str, fields: &[(&str, &str)]) -> &mut Self {
        let fields = fields
            .iter()
            .map(|(key, value)| Entry { key: (*key).into(), key_place: Place::Program, value: (*value).into() })
            .collect();
        self.elements.entry(section.into()).or_default().push(Element { fields, place: Place::Program });
        self
    }

    /// Adds an element by its name, to be filled with [`Adding::with`].
    ///
    /// ```
    /// use headland_model::Scene;
    ///
    /// let mut scene = Scene::new("pendulum");
    /// scene.entry("world", "gravity", ["0", "-9.81 m/s^2", "0"]);
    /// scene.add("body", "bob").with("mass", "1 kg").with("center", ["1 m", "0", "0"]);
    /// scene.add("joint", "phi").with("kind", "revolute").with("to", "bob");
    /// scene.entry("initial", "phi", "30 deg");
    /// assert_eq!(scene.build().unwrap().coordinates[0].name, "phi");
    /// ```
    pub fn add(&mut self, section: &str, name: &str) -> Adding<'_> {
        let field = Entry { key: "name".into(), key_place: Place::Program, value: name.into() };
        let elements = self.elements.entry(section.into()).or_default();
        let position = elements.len();
        elements.push(Element { fields: vec![field], place: Place::Program });
        Adding { element: &mut elements[position] }
    }

    /// The entries of a section.
    pub fn section(&self, name: &str) -> &[Entry] {
        self.tables.get(name).map_or(&[], Vec::as_slice)
    }

    /// The elements of a section.
    pub fn section_elements(&self, name: &str) -> &[Element] {
        self.elements.get(name).map_or(&[], Vec::as_slice)
    }

    /// A key of a section.
    pub fn get(&self, section: &str, key: &str) -> Option<&Value> {
        self.section(section).iter().find(|e| e.key == key).map(|e| &e.value)
    }

    /// Changes a value from outside: `set("l", "[4, 6, 6]")`, `set("gamma", "0.1*sin(t)")`, `set("run.until", "20 s")`.
    ///
    /// A name is looked for in `parameters`, `prescribed`, `definitions`, `initial`, `indices`; `section.name` names any
    /// entry, `element.key` the key of a named element, `l[2]` a member of an array. A bare number takes the unit that
    /// the value had.
    ///
    /// # Errors
    /// If the name is not there (with a suggestion) or the value cannot be read.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), ModelError> {
        let place = Place::Setting(format!("--set {name}={text}").into());
        let source = self.source.clone();
        let open = text.trim().starts_with('[');
        if open != text.trim().ends_with(']') && (open || !text.contains('[')) {
            let message = "an array is written `[1, 2, 3]`; a bracket is missing".into();
            return Err(ModelError { source, diagnostics: vec![Diagnostic { place, message }] });
        }
        let value = self.read_value(name, text.trim(), &place);
        match self.find(name.trim()) {
            Found::Value(slot) => {
                *slot = with_unit_of(value, slot);
                Ok(())
            }
            Found::Missing(section, key) => {
                let entry = Entry { key, key_place: place, value };
                self.tables.entry(section).or_default().push(entry);
                Ok(())
            }
            Found::Nothing(message) => Err(ModelError { source, diagnostics: vec![Diagnostic { place, message }] }),
        }
    }

    /// The value of a setting; where the key takes a text, it is one whatever it looks like.
    fn read_value(&self, name: &str, text: &str, place: &Place) -> Value {
        let key = name.split_once('.').and_then(|(section, key)| {
            let format = format::SECTIONS.iter().find(|s| s.name == section)?;
            format.keys.iter().find(|k| k.name == key)
        });
        match key {
            Some(key) if key.kind == format::Kind::Text => {
                Value { data: Data::Text(text.trim_matches('"').into()), place: place.clone() }
            }
            _ => read_setting(text, place, 0),
        }
    }

    fn find(&mut self, name: &str) -> Found<'_> {
        const SEARCHED: [&str; 5] = ["parameters", "prescribed", "definitions", "initial", "indices"];
        if let Some((section, key)) = name.split_once('.') {
            if let Some(format) = format::SECTIONS.iter().find(|s| s.name == section && s.shape != Shape::Elements) {
                let known = format.keys.is_empty() || format.keys.iter().any(|k| k.name == key);
                let there = self.section(section).iter().any(|e| e.key == key);
                if there {
                    let slot = self.tables.get_mut(section).and_then(|t| t.iter_mut().find(|e| e.key == key));
                    return slot.map_or(Found::Nothing(String::new()), |e| Found::Value(&mut e.value));
                }
                let base = key.split(['[', '.', '\'']).next().unwrap_or(key);
                if known && (!format.keys.is_empty() || section == "initial" && self.is_body_or_joint(base)) {
                    return Found::Missing(section.into(), key.into());
                }
                let keys: Vec<&str> = self.section(section).iter().map(|e| e.key.as_str()).collect();
                let hint =
                    headland_expr::parse::suggestion(key, keys.into_iter().chain(format.keys.iter().map(|k| k.name)));
                return Found::Nothing(format!("section `{section}` has no `{key}`{hint}"));
            }
            let is_named =
                |e: &Element| matches!(e.get("name"), Some(Value { data: Data::Text(n), .. }) if n == section);
            let place = self.elements.values().enumerate().find_map(|(i, elements)| {
                let j = elements.iter().position(is_named)?;
                let k = elements[j].fields.iter().position(|e| e.key == key)?;
                Some((i, j, k))
            });
            if let Some((i, j, k)) = place {
                return Found::Value(&mut self.elements[i][j].fields[k].value);
            }
        }
        let (base, member) = match name.split_once('[') {
            Some((base, rest)) => (base, rest.trim_end_matches(']').trim().parse::<usize>().ok()),
            None => (name, None),
        };
        let mut at = None;
        for section in SEARCHED {
            for (i, entry) in self.section(section).iter().enumerate() {
                let array = match (&entry.value.data, member) {
                    (Data::Array(values), Some(k)) => entry.key == base && k >= 1 && k <= values.len(),
                    _ => false,
                };
                if entry.key == name || array {
                    at = Some((section, i, (entry.key != name).then_some(member).flatten()));
                    break;
                }
            }
            if at.is_some() {
                break;
            }
        }
        // a member of a family that has only a rule so far
        let family = |e: &Entry| e.key.split_once('[').is_some_and(|(b, _)| b == base);
        if let (None, Some(_)) = (at, member)
            && let Some(section) = SEARCHED.iter().find(|s| self.section(s).iter().any(family))
        {
            return Found::Missing((*section).into(), name.into());
        }
        let base = name.split(['[', '.', '\'']).next().unwrap_or(name);
        if at.is_none() && self.is_body_or_joint(base) {
            return Found::Missing("initial".into(), name.into());
        }
        let Some((section, i, member)) = at else {
            let names: Vec<&str> = SEARCHED.iter().flat_map(|s| self.section(s)).map(|e| e.key.as_str()).collect();
            let hint = headland_expr::parse::suggestion(name, names);
            return Found::Nothing(format!("the scene has nothing named `{name}` that can be set{hint}"));
        };
        let value = &mut self.tables[section][i].value;
        if let (Some(k), Data::Array(_)) = (member, &value.data) {
            let Data::Array(values) = &mut value.data else { unreachable!("just matched") };
            return Found::Value(&mut values[k - 1]);
        }
        Found::Value(value)
    }

    /// Whether a body or joint has the name, without index: its coordinates have starts that a file may leave out.
    fn is_body_or_joint(&self, base: &str) -> bool {
        let named = |e: &Element| matches!(e.get("name"), Some(Value { data: Data::Text(n), .. }) if n.split('[').next() == Some(base));
        ["body", "joint"].iter().any(|s| self.section_elements(s).iter().any(named))
    }
}

/// An element that is being filled.
#[derive(Debug)]
pub struct Adding<'s> {
    element: &'s mut Element,
}

impl Adding<'_> {
    /// Adds `key = value`.
    #[allow(clippy::must_use_candidate)]
    pub fn with(self, key: &str, value: impl Into<Value>) -> Self {
        self.element.fields.push(Entry { key: key.into(), key_place: Place::Program, value: value.into() });
        self
    }
}

enum Found<'s> {
    Value(&'s mut Value),
    Missing(String, String),
    Nothing(String),
}

/// A value as written on a command line; what is nested deeper than any section wants stays a text.
fn read_setting(text: &str, place: &Place, depth: usize) -> Value {
    let array = text.strip_prefix('[').and_then(|t| t.strip_suffix(']')).filter(|_| depth < 4);
    let data = if let Some(inner) = array {
        let items = split_top_level(inner);
        Data::Array(items.into_iter().map(|item| read_setting(item, place, depth + 1)).collect())
    } else if let Some(x) = text.parse::<f64>().ok().filter(|x| x.is_finite()) {
        Data::Number(x)
    } else if text == "true" || text == "false" {
        Data::Flag(text == "true")
    } else {
        Data::Text(text.trim_matches('"').to_string())
    };
    Value { data, place: place.clone() }
}

fn split_top_level(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (i, c) in text.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(text[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    if !text[start..].trim().is_empty() {
        parts.push(text[start..].trim());
    }
    parts
}

/// The unit text of a quantity such as `"4 m"`.
fn unit_of(value: &Value) -> Option<&str> {
    match &value.data {
        Data::Text(text) if matches!(parse_quantity(text), Some(Ok((_, Some(_))))) => {
            let text = text.trim();
            let start = text.find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E' || c == '%' || c == '°')?;
            Some(&text[start..])
        }
        Data::Array(values) => {
            let first = unit_of(values.first()?)?;
            values.iter().all(|v| unit_of(v) == Some(first)).then_some(first)
        }
        _ => None,
    }
}

/// `new`, with the unit of `old` given to numbers that have none.
fn with_unit_of(mut new: Value, old: &Value) -> Value {
    let Some(unit) = unit_of(old) else { return new };
    match &mut new.data {
        Data::Number(x) => new.data = Data::Text(format!("{x:e} {unit}")),
        Data::Array(values) => {
            let old = old.clone();
            for value in values {
                *value = with_unit_of(value.clone(), &old);
            }
        }
        _ => {}
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_keep_units() {
        let mut scene = Scene::new("test");
        scene.entry("parameters", "v", "65 km/h").entry("parameters", "n", 3.0);
        scene.set("v", "4").unwrap();
        assert_eq!(scene.get("parameters", "v").unwrap().data, Data::Text("4e0 km/h".into()));
        scene.set("v", "4 m/s").unwrap();
        assert_eq!(scene.get("parameters", "v").unwrap().data, Data::Text("4 m/s".into()));
        let wrong = scene.set("w", "4").unwrap_err().to_string();
        assert!(wrong.contains("nothing named `w`"), "{wrong}");
    }

    #[test]
    fn arrays_and_members() {
        let mut scene = Scene::new("test");
        scene.entry("parameters", "l", &["4 m", "6 m"][..]);
        scene.set("l[2]", "7").unwrap();
        scene.set("run.until", "3").unwrap();
        let Data::Array(l) = &scene.get("parameters", "l").unwrap().data else { panic!() };
        assert_eq!(l[1].data, Data::Text("7e0 m".into()));
        scene.set("l", "[1, 2, min(3, 4)]").unwrap();
        let Data::Array(l) = &scene.get("parameters", "l").unwrap().data else { panic!() };
        assert_eq!((l.len(), &l[0].data), (3, &Data::Text("1e0 m".into())));
    }
}
