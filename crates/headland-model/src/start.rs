//! Initial values and scales of a scene's states.

use headland_expr::parse::suggestion;

use crate::build::{Builder, Made};
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::{Typed, per_time};
use crate::place::Place;
use crate::scene::Entry;
use crate::symbols::{Binding, Formula, Symbol, parse_key};

impl<'g> Builder<'_, 'g> {
    pub(crate) fn initial(&mut self) {
        let mut failed = false;
        for entry in self.scene.section("initial") {
            failed |= self.initial_value(entry).is_err();
        }
        if failed {
            return; // its own message says enough
        }
        self.no_zero_quaternions();
        let zero = self.low.graph.id(headland_expr::Expr::Const(0.0));
        for c in self.low.coordinates.iter_mut().filter(|c| c.first_order && c.guess.is_some()) {
            c.initial.get_or_insert(zero); // nothing else says where it is: it is not searched for
        }
        let missing: Vec<String> = self
            .low
            .coordinates
            .iter()
            .filter(|c| c.initial.is_none() && c.guess.is_none())
            .map(|c| c.name.clone())
            .chain(
                self.low.quasi_velocities.iter().filter(|u| u.initial.is_none() && !u.of_joint).map(|u| u.name.clone()),
            )
            .collect();
        if !missing.is_empty() {
            let place = match self.scene.section("initial").first() {
                Some(entry) => entry.key_place.clone(),
                None => self.scene.section("coordinates").first().map_or(Place::Program, |e| e.key_place.clone()),
            };
            let shown: Vec<String> = missing.iter().take(8).map(|n| format!("`{n}`")).collect();
            let more = if missing.len() > 8 { format!(" and {} more", missing.len() - 8) } else { String::new() };
            let message = format!("too few initial values: [initial] lacks {}{more}", shown.join(", "));
            self.low.report(place, message);
        }
    }

    /// Four zeros are no orientation.
    fn no_zero_quaternions(&mut self) {
        for i in 0..self.low.coordinates.len().saturating_sub(3) {
            let four = &self.low.coordinates[i..i + 4];
            if !four[0].name.ends_with(".qw") || four[0].guess.is_none() {
                continue;
            }
            let (name, graph) = (four[0].name.trim_end_matches(".qw").to_string(), self.low.graph);
            let given = [0, 1, 2, 3].map(|k| (four[k].initial, four[k].guess));
            let values = given.map(|(initial, guess)| initial.map_or(guess, |node| self.evaluate(graph.expr(node))));
            if values.iter().all(|x| *x == Some(0.0)) {
                let key = format!("{name}.qw");
                let entry = self.scene.section("initial").iter().find(|e| e.key == key);
                let place = entry.map_or(Place::Program, |e| e.key_place.clone());
                let message = format!("the quaternion of `{name}` is zero at the start; that is no orientation");
                self.low.report(place, message);
            }
        }
    }

    pub(crate) fn initial_value(&mut self, entry: &Entry) -> Made<()> {
        let place = entry.key_place.clone();
        let (kind, primes, members) = self.state_key(entry)?;
        let formula = self.formula_of(&entry.value)?;
        for (i, binding) in members {
            if kind && primes > 0 && self.low.coordinates[i].first_order {
                let message =
                    format!("`{}` is the rate of a state of the first order: it follows from the state", entry.key);
                return Err(self.low.report(place, message));
            }
            let typed = self.low.lower(&formula, &binding)?;
            let (dimension, angle) =
                if kind { self.low.coordinate_types[i].clone() } else { self.low.quasi_types[i].clone() };
            let what = format!("the initial value of `{}`", entry.key);
            self.low.demand(&typed, &per_time(&dimension, primes), angle, &formula, &what)?;
            self.known_at_start(&typed, kind && primes == 0, &formula, &what)?;
            let node = self.low.graph.id(typed.expr);
            let slot = match (kind, primes) {
                (true, 0) => &mut self.low.coordinates[i].initial,
                (true, _) => &mut self.low.coordinates[i].initial_rate,
                (false, _) => &mut self.low.quasi_velocities[i].initial,
            };
            if slot.is_some() && binding.is_some() {
                continue; // a fixed member goes before the family
            }
            if slot.is_some() && !entry.key.contains('[') {
                return Err(self.low.report(place, format!("`{}` has two initial values", entry.key)));
            }
            *slot = Some(node);
        }
        Ok(())
    }

    /// An initial value is made of parameters and the starting time; one of a velocity also of the coordinates.
    fn known_at_start(&mut self, typed: &Typed<'g>, is_coordinate: bool, formula: &Formula, what: &str) -> Made<()> {
        let known = Kinds::PARAMETER.or(Kinds::TIME);
        let known = if is_coordinate { known } else { known.or(Kinds::COORDINATE) };
        let message = match (self.depends(typed.expr, known.not()), typed.expr.value()) {
            (Some(name), _) => {
                format!("{what} is made of what is known at the start, but `{}` depends on `{name}`", formula.text)
            }
            (None, Some(x)) if !x.is_finite() => format!("{what} is {x}"),
            _ => return Ok(()),
        };
        Err(self.low.report(formula.place.clone(), message))
    }

    /// The states that a key of `[initial]` or `[scale]` names: coordinate or quasi-velocity, primes, positions of the members.
    #[allow(clippy::type_complexity)]
    pub(crate) fn state_key(&mut self, entry: &Entry) -> Made<(bool, u8, Vec<(usize, Binding)>)> {
        let place = entry.key_place.clone();
        let mut key = parse_key(&entry.key).map_err(|m| self.low.report(place.clone(), m))?;
        if let Some(index) = &mut key.index {
            let _ = self.low.symbols.fold_lengths(index);
        }
        let found = match self.low.symbols.by_name.get(key.name.as_str()) {
            Some(Symbol::Coordinate(members)) if key.primes <= 1 => Some((true, members.clone())),
            Some(Symbol::QuasiVelocity(members)) if key.primes == 0 => Some((false, members.clone())),
            _ => None,
        };
        if self.low.declared.contains_key(&key.name) || self.parts.prescribed.iter().any(|p| p.name == key.name) {
            let message = format!("`{}` is prescribed: its values follow from its function of time", entry.key);
            return Err(self.low.report(place, message));
        }
        let members = self.low.symbols.members(key.index.as_ref()).map_err(|m| self.low.report(place.clone(), m))?;
        if found.is_none() && members.is_empty() {
            return Ok((true, key.primes, Vec::new())); // of a family of joints that has no member
        }
        let Some((kind, family)) = found else {
            let states = self
                .low
                .symbols
                .by_name
                .iter()
                .filter(|(_, s)| matches!(s, Symbol::Coordinate(..) | Symbol::QuasiVelocity(..)));
            let hint = suggestion(&key.name, states.map(|(n, _)| &**n));
            let message = format!("`{}` is not a coordinate, its rate or a quasi-velocity{hint}", entry.key);
            return Err(self.low.report(place, message));
        };
        let found: Option<Vec<(usize, Binding)>> =
            members.into_iter().map(|(m, binding)| family.get(m).map(|i| (i, binding))).collect();
        match found {
            Some(found) => Ok((kind, key.primes, found)),
            None => {
                let count = family.iter().count();
                let message = format!("`{}` does not exist: `{}` has {count} member(s)", entry.key, key.name);
                Err(self.low.report(place, message))
            }
        }
    }

    pub(crate) fn scales(&mut self) {
        for entry in self.scene.section("scale") {
            let _ = self.scale(entry);
        }
    }

    pub(crate) fn scale(&mut self, entry: &Entry) -> Made<()> {
        let (kind, _, members) = self.state_key(entry)?;
        let formula = self.formula_of(&entry.value)?;
        for (i, binding) in members {
            let (dimension, angle) =
                if kind { self.low.coordinate_types[i].clone() } else { self.low.quasi_types[i].clone() };
            let x = self.number(&formula, &binding, &dimension, angle, &format!("the scale of `{}`", entry.key))?;
            if x <= 0.0 {
                return Err(self
                    .low
                    .report(formula.place, format!("the scale of `{}` must be positive, found {x}", entry.key)));
            }
            let slot = if kind { &mut self.low.coordinates[i].scale } else { &mut self.low.quasi_velocities[i].scale };
            *slot = x;
        }
        Ok(())
    }

    /// A number made of parameters, of a given dimension.
    pub(crate) fn number(
        &mut self,
        formula: &Formula,
        binding: &Binding,
        d: &Dimension,
        angle: bool,
        what: &str,
    ) -> Made<f64> {
        let typed = self.low.lower(formula, binding)?;
        self.low.demand(&typed, d, angle, formula, what)?;
        match self.evaluate(typed.expr) {
            Some(x) => Ok(x),
            None => {
                let message = format!("{what} must be a finite number made of parameters, but is `{}`", formula.text);
                Err(self.low.report(formula.place.clone(), message))
            }
        }
    }
}
