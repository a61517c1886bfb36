//! The laws of a `[[tyre]]` as its keys or its file give them.

use std::path::Path;

use headland_expr::Expr;
use headland_expr::parse::suggestion;
use headland_tyre::{Brush, Forces, Linear, Pac2002, Slip, SlipLaw, Stiffness, TMeasy, Tir, Vertical};

use super::number;
use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::place::{Diagnostic, Place};
use crate::scene::{Data, Element as SceneElement};
use crate::symbols::Binding;

/// Forces along the ground.
pub(super) enum Law<'g> {
    None,
    Linear(Linear<Expr<'g>>),
    Brush(Brush<Expr<'g>>),
    TMeasy(Box<TMeasy<Expr<'g>>>),
    Pac2002(Box<Pac2002>, bool),
}

/// How small a number may be.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Least {
    /// Above zero, and it must be there.
    Needed,
    /// Above zero.
    Positive,
    /// At least zero.
    Zero,
    Any,
}

/// Keys that belong to some laws only.
const KEYS: [(&str, &[&str]); 10] = [
    ("file", &["pac2002"]),
    ("mirrored", &["pac2002"]),
    ("longitudinal", &["linear", "brush"]),
    ("cornering", &["linear", "brush"]),
    ("camber", &["linear", "brush"]),
    ("trail", &["linear"]),
    ("half_length", &["brush"]),
    ("contact_length", &["tmeasy"]),
    ("load", &["linear", "brush", "tmeasy"]),
    ("friction", &["brush", "tmeasy", "pac2002"]),
];
const LAWS: [&str; 5] = ["linear", "brush", "tmeasy", "pac2002", "none"];

impl<'g> Law<'g> {
    pub(super) fn forces(&self, load: Expr<'g>, friction: Expr<'g>, slip: &Slip<Expr<'g>>) -> Forces<Expr<'g>> {
        match self {
            Law::None => Forces::zero(),
            Law::Linear(law) => law.forces(load, friction, slip),
            Law::Brush(law) => law.forces(load, friction, slip),
            Law::TMeasy(law) => law.forces(load, friction, slip),
            Law::Pac2002(law, true) => law.mirrored_forces(load, friction, slip),
            Law::Pac2002(law, false) => law.forces(load, friction, slip),
        }
    }

    pub(super) fn stiffness(&self, load: Expr<'g>) -> [Expr<'g>; 2] {
        match self {
            Law::None => [number(0.0); 2],
            Law::Linear(law) => law.stiffness(load),
            Law::Brush(law) => law.stiffness(load),
            Law::TMeasy(law) => law.stiffness(load),
            Law::Pac2002(law, _) => law.stiffness(load),
        }
    }

    /// Nominal load, where the law has one.
    pub(super) fn nominal_load(&self) -> Option<Expr<'g>> {
        match self {
            Law::None => None,
            Law::Linear(law) => law.load,
            Law::Brush(law) => Some(law.load),
            Law::TMeasy(law) => Some(law.load),
            Law::Pac2002(law, _) => Some(number(law.nominal_load())),
        }
    }

    pub(super) fn file(&self) -> Option<&Pac2002> {
        match self {
            Law::Pac2002(law, _) => Some(law),
            _ => None,
        }
    }
}

impl<'g> Builder<'_, 'g> {
    /// The slip law of a tyre.
    pub(super) fn tyre_law(&mut self, element: &SceneElement, binding: &Binding) -> Made<Law<'g>> {
        let word = if element.get("law").is_some() { self.text_field(element, "law")? } else { "none".into() };
        if !LAWS.contains(&word.as_str()) {
            let place = element.get("law").map_or(&element.place, |v| &v.place).clone();
            let hint = suggestion(&word, LAWS);
            let message = format!("unknown law \"{word}\"{hint}; known: {}", LAWS.join(", "));
            return Err(self.low.report(place, message));
        }
        for (key, of) in KEYS.into_iter().filter(|(_, of)| !of.contains(&word.as_str())) {
            let why = format!("the law is \"{word}\"; it belongs to {}", of.join(", "));
            self.without(element, &[key], &why)?;
        }
        let (newton, metre) = (Dimension::of(1, 1, -2), Dimension::of(0, 1, 0));
        let mut given = |key: &str, d: &Dimension, least| self.tyre_number(element, key, binding, d, least);
        let law = match word.as_str() {
            "linear" => Law::Linear(Linear {
                longitudinal: given("longitudinal", &newton, Least::Needed)?,
                cornering: given("cornering", &newton, Least::Needed)?,
                camber: given("camber", &newton, Least::Any)?,
                trail: given("trail", &metre, Least::Any)?,
                load: if element.get("load").is_some() { Some(given("load", &newton, Least::Needed)?) } else { None },
            }),
            "brush" => Law::Brush(Brush {
                longitudinal: given("longitudinal", &newton, Least::Needed)?,
                cornering: given("cornering", &newton, Least::Needed)?,
                half_length: given("half_length", &metre, Least::Needed)?,
                load: given("load", &newton, Least::Needed)?,
                camber: given("camber", &newton, Least::Any)?,
                friction: number(1.0), // given where the forces are asked for
                proportional: true,
            }),
            "tmeasy" => Law::TMeasy(Box::new(TMeasy::truck(
                given("load", &newton, Least::Needed)?,
                given("contact_length", &metre, Least::Needed)?,
                given("radius", &metre, Least::Needed)?,
            ))),
            "pac2002" => self.tyre_file(element)?,
            _ => Law::None,
        };
        if matches!(law, Law::Brush(_)) && element.get("friction").is_none() {
            return Err(self.low.report(element.place.clone(), "a tyre by the law \"brush\" needs `friction`"));
        }
        Ok(law)
    }

    /// The load by deflection: the keys' or the file's.
    pub(super) fn tyre_vertical(
        &mut self,
        element: &SceneElement,
        law: &Law<'g>,
        binding: &Binding,
    ) -> Made<Vertical<Expr<'g>>> {
        let file = law.file().and_then(Pac2002::vertical);
        let by_length = |n: i64| Dimension::of(1, 1 - n, -2);
        let damping = self.tyre_number(element, "damping", binding, &Dimension::of(1, 0, -1), Least::Zero)?;
        if let (Some(vertical), None) = (&file, element.get("stiffness")) {
            self.without(element, &["progression"], "the load follows the file; it belongs to `stiffness`")?;
            let damping = if element.get("damping").is_some() { damping } else { vertical.damping };
            return Ok(Vertical { damping, ..vertical.clone() });
        }
        let stiffness = self.tyre_number(element, "stiffness", binding, &by_length(1), Least::Needed)?;
        let progression = self.tyre_number(element, "progression", binding, &by_length(2), Least::Zero)?;
        let spring = if progression.is(0.0) {
            Stiffness::Linear { stiffness }
        } else {
            Stiffness::Quadratic { stiffness, progression }
        };
        Ok(Vertical { spring, damping, onset: number(1e-3) })
    }

    /// Reads the `.tir` file; what was assumed becomes a warning.
    fn tyre_file(&mut self, element: &SceneElement) -> Made<Law<'g>> {
        let Some(value) = element.get("file") else {
            let message = "a tyre by the law \"pac2002\" needs `file`, a .tir file";
            return Err(self.low.report(element.place.clone(), message));
        };
        let file = self.text_field(element, "file")?;
        let folder = Path::new(&*self.scene.source.name).parent().unwrap_or(Path::new(""));
        let path = folder.join(file);
        let bytes = std::fs::read(&path).map_err(|error| {
            let message = format!("cannot read `{}` (names count from the scene's folder): {error}", path.display());
            self.low.report(value.place.clone(), message)
        })?;
        let read = Tir::from_bytes(&bytes).and_then(|tir| Pac2002::from_tir(&tir));
        let law = read.map_err(|error| self.low.report(value.place.clone(), format!("{}: {error}", path.display())))?;
        if !law.notes().is_empty() {
            let notes: Vec<String> = law.notes().iter().map(ToString::to_string).collect();
            let message = format!("{}: {}", path.display(), notes.join("; "));
            let warning = Diagnostic { place: value.place.clone(), message };
            if !self.parts.warnings.contains(&warning) {
                self.parts.warnings.push(warning); // once for a family
            }
        }
        let mirrored = matches!(element.get("mirrored").map(|v| &v.data), Some(Data::Flag(true)));
        Ok(Law::Pac2002(Box::new(law), mirrored))
    }

    /// A number of a tyre, made of parameters; zero where it is not given and need not be.
    pub(super) fn tyre_number(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        dimension: &Dimension,
        least: Least,
    ) -> Made<Expr<'g>> {
        let Some(e) = self.scalar_field(element, key, binding, dimension)? else {
            if least != Least::Needed {
                return Ok(number(0.0));
            }
            return Err(self.low.report(element.place.clone(), format!("this tyre needs `{key}`")));
        };
        let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
        self.tyre_bound(e, key, &place, least)
    }

    /// Refuses what is not a number made of parameters, or too small.
    pub(super) fn tyre_bound(&mut self, e: Expr<'g>, key: &str, place: &Place, least: Least) -> Made<Expr<'g>> {
        let message = match (self.evaluate(e), least) {
            (None, _) => format!("`{key}` must be made of numbers and parameters"),
            (Some(x), Least::Needed | Least::Positive) if x <= 0.0 => format!("`{key}` is {x}; it must be above 0"),
            (Some(x), Least::Zero) if x < 0.0 => format!("`{key}` is {x}; it must be at least 0"),
            _ => return Ok(e),
        };
        Err(self.low.report(place.clone(), message))
    }
}
