//! Outputs, guards, events, plots and run settings of a scene.

use headland_expr::parse::suggestion;

use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::model::{Direction, Event, Guard, LinearSolver, Plot, Quantity, RunSettings};
use crate::place::Place;
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Entry, Value};
use crate::units::parse_unit;

impl<'g> Builder<'_, 'g> {
    pub(crate) fn outputs(&mut self) {
        match self.scene.get("outputs", "columns").map(|v| (&v.data, &v.place)) {
            None => {
                let q = self.low.coordinates.iter().map(|c| (c.name.clone(), c.unit.clone(), c.q, c.place.clone()));
                let u = self.low.quasi_velocities.iter();
                let u = u.map(|u| (u.name.clone(), u.unit.clone(), u.u, u.place.clone()));
                let outputs =
                    q.chain(u).map(|(name, unit, node, place)| Quantity { name, unit, factor: 1.0, node, place });
                self.parts.outputs = outputs.collect();
                if self.low.quasi_velocities.is_empty() {
                    let rates = self.low.coordinates.iter();
                    self.parts.outputs.extend(rates.map(|c| Quantity {
                        name: format!("{}'", c.name),
                        unit: c.rate_unit.clone(),
                        factor: 1.0,
                        node: c.rate,
                        place: c.place.clone(),
                    }));
                }
            }
            Some((Data::Array(values), _)) => {
                for value in values {
                    let _ = self.column(value);
                }
            }
            Some((_, place)) => {
                self.low.report(place.clone(), "`columns` is a list of names: `columns = [\"x\", \"theta[k]\"]`");
            }
        }
    }

    pub(crate) fn column(&mut self, value: &Value) -> Made<()> {
        let Data::Text(text) = &value.data else {
            return Err(self
                .low
                .report(value.place.clone(), format!("a column is a text, found {}", value.data.kind())));
        };
        // "power [kW]": a unit behind a space
        let (expression, unit) =
            match text.trim_end().strip_suffix(']').and_then(|t| t.rfind(" [").map(|i| (i, &t[i + 2..]))) {
                Some((i, unit)) => match parse_unit(unit) {
                    Ok(u) => (&text[..i], Some((u, unit.to_string()))),
                    Err(message) => return Err(self.low.report(value.place.clone(), message)),
                },
                None => (text.as_str(), None),
            };
        let formula = self.low.formula(expression, &value.place)?;
        for binding in self.members_of(&[&formula], &value.place)? {
            let typed = self.low.lower(&formula, &binding)?;
            let name = bound_name(expression.trim(), &binding);
            let mut quantity = self.quantity(name, typed.clone(), value.place.clone());
            if let Some((unit, text)) = &unit {
                self.low.demand(
                    &typed,
                    &unit.dimension,
                    unit.angle,
                    &formula,
                    &format!("the column's unit `{text}`"),
                )?;
                quantity.factor = unit.from_si(1.0);
                quantity.unit.clone_from(text);
            }
            if self.parts.outputs.iter().any(|o| o.name == quantity.name) {
                return Err(self
                    .low
                    .report(value.place.clone(), format!("the column `{}` stands twice", quantity.name)));
            }
            self.parts.outputs.push(quantity);
        }
        Ok(())
    }

    pub(crate) fn guards(&mut self) {
        for element in self.scene.section_elements("guard") {
            let _ = self.guard(element);
        }
    }

    pub(crate) fn guard(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        let Some(quantity) = element.get("quantity") else { return Err(Reported) };
        let formula = self.formula_of(quantity)?;
        let message = match element.get("message") {
            Some(_) => self.text_field(element, "message")?,
            None => String::new(),
        };
        for binding in self.members_of(&[&formula], &element.place)? {
            let typed = self.low.lower(&formula, &binding)?;
            let mut limits = [None, None];
            for (slot, key) in limits.iter_mut().zip(["warn_below", "stop_below"]) {
                if let Some(value) = element.get(key) {
                    let limit = self.formula_of(value)?;
                    *slot = Some(self.number(&limit, &binding, &typed.dimension, typed.angle, key)?);
                }
            }
            if limits == [None, None] {
                let message = format!("the guard `{name}` has neither `warn_below` nor `stop_below`");
                return Err(self.low.report(element.place.clone(), message));
            }
            let [warn_below, stop_below] = limits;
            let unit = self.low.unifier.resolve(&typed.dimension).unit(typed.angle);
            let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
            let node = self.low.graph.id(typed.expr);
            let name = bound_name(&name, &binding);
            self.parts.guards.push(Guard {
                name,
                quantity: node,
                unit,
                warn_below,
                stop_below,
                message: message.clone(),
            });
        }
        Ok(())
    }

    pub(crate) fn events(&mut self) {
        for element in self.scene.section_elements("event") {
            let _ = self.event(element);
        }
    }

    pub(crate) fn event(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        let Some(quantity) = element.get("quantity") else { return Err(Reported) };
        let formula = self.formula_of(quantity)?;
        let direction = match element.get("direction").map(|v| &v.data) {
            None => Direction::Both,
            Some(Data::Text(word)) if word == "rising" => Direction::Rising,
            Some(Data::Text(word)) if word == "falling" => Direction::Falling,
            Some(Data::Text(word)) if word == "both" => Direction::Both,
            Some(_) => {
                let message = "`direction` is \"rising\", \"falling\" or \"both\"";
                return Err(self.low.report(element.place.clone(), message));
            }
        };
        let stop = matches!(element.get("stop").map(|v| &v.data), Some(Data::Flag(true)));
        for binding in self.members_of(&[&formula], &element.place)? {
            let typed = self.low.lower(&formula, &binding)?;
            let name = bound_name(&name, &binding);
            self.parts.events.push(Event { name, quantity: self.low.graph.id(typed.expr), direction, stop });
        }
        Ok(())
    }

    pub(crate) fn plots(&mut self) {
        for element in self.scene.section_elements("plot") {
            let _ = self.plot(element);
        }
    }

    pub(crate) fn plot(&mut self, element: &SceneElement) -> Made<()> {
        let title = self.text_field(element, "title")?;
        let x = match element.get("x") {
            None => None,
            Some(value) => match self.columns_named(value)?.as_slice() {
                [] => None,
                [column] => Some(*column),
                _ => return Err(self.low.report(value.place.clone(), "`x` must be a single column")),
            },
        };
        let mut y = Vec::new();
        if let Some(Value { data: Data::Array(values), .. }) = element.get("y") {
            for value in values {
                y.extend(self.columns_named(value)?);
            }
        } else if let Some(value) = element.get("y") {
            y.extend(self.columns_named(value)?);
        }
        let equal_axes = matches!(element.get("equal_axes").map(|v| &v.data), Some(Data::Flag(true)));
        self.parts.plots.push(Plot { title, x, y, equal_axes });
        Ok(())
    }

    /// Columns by name: `x`, or `v_C[k]` for all members; `t` is none.
    pub(crate) fn columns_named(&mut self, value: &Value) -> Made<Vec<usize>> {
        let Data::Text(text) = &value.data else {
            return Err(self
                .low
                .report(value.place.clone(), format!("a column is a text, found {}", value.data.kind())));
        };
        if text == "t" {
            return Ok(Vec::new());
        }
        let formula = self.low.formula(text, &value.place)?;
        let mut found = Vec::new();
        for binding in self.members_of(&[&formula], &value.place)? {
            let name = bound_name(text.trim(), &binding);
            match self.parts.outputs.iter().position(|o| o.name == name) {
                Some(i) => found.push(i),
                None => {
                    let hint = suggestion(&name, self.parts.outputs.iter().map(|o| o.name.as_str()));
                    return Err(self
                        .low
                        .report(value.place.clone(), format!("`{name}` is not a column of [outputs]{hint}")));
                }
            }
        }
        Ok(found)
    }

    pub(crate) fn run_settings(&mut self) {
        let mut run = RunSettings::default();
        for entry in self.scene.section("run") {
            let _ = self.run_setting(entry, &mut run);
        }
        if run.until <= run.from {
            let place = self.scene.get("run", "until").map_or(Place::Program, |v| v.place.clone());
            self.low.report(place, format!("the run ends at {} s but starts at {} s", run.until, run.from));
        }
        self.parts.run = Some(run);
    }

    pub(crate) fn run_setting(&mut self, entry: &Entry, run: &mut RunSettings) -> Made<()> {
        let time = Dimension::time();
        let place = entry.value.place.clone();
        let word = match &entry.value.data {
            Data::Text(text) => text.clone(),
            _ => String::new(),
        };
        match entry.key.as_str() {
            "method" => run.method = word,
            "linear_solver" => {
                run.linear_solver = match word.as_str() {
                    "ldl" => LinearSolver::Ldl,
                    "crout" => LinearSolver::Crout,
                    other => {
                        return Err(self
                            .low
                            .report(place, format!("`linear_solver` is \"ldl\" or \"crout\", found `{other}`")));
                    }
                }
            }
            "independent" => run.independent = Some(self.independent(&entry.value)?),
            key => {
                let formula = self.formula_of(&entry.value)?;
                let dimension = if ["from", "until", "max_step"].contains(&key) { time } else { Dimension::NONE };
                let x = self.number(&formula, &None, &dimension, false, &format!("`run.{key}`"))?;
                let positive = x > 0.0;
                match key {
                    "from" => run.from = x,
                    "until" => run.until = x,
                    "tolerance" if (2.3e-15..1.0).contains(&x) => run.tolerance = x,
                    "points" if (1.0..=1e8).contains(&x) && x == x.round() => run.points = x as usize,
                    "max_step" if positive => run.max_step = x,
                    _ => {
                        let range = match key {
                            "tolerance" => "from 2.3e-15 to below 1",
                            "points" => "a whole number from 1 to 1e8",
                            _ => "positive",
                        };
                        return Err(self
                            .low
                            .report(place, format!("`run.{key}` = {x} is out of range; it is {range}")));
                    }
                }
            }
        }
        Ok(())
    }

    pub(crate) fn independent(&mut self, value: &Value) -> Made<Vec<usize>> {
        let Data::Array(values) = &value.data else {
            return Err(self.low.report(value.place.clone(), "`independent` is a list of rates: `[\"x'\"]`"));
        };
        let mut chosen = Vec::new();
        for value in values {
            let Data::Text(text) = &value.data else { continue };
            let name = text.trim().trim_end_matches('\'');
            let rates = self.low.coordinates.iter().map(|c| (c.name.as_str(), true));
            let velocities = self.low.quasi_velocities.iter().map(|u| (u.name.as_str(), u.of_joint));
            let known: Vec<(&str, bool)> = rates.chain(velocities).collect();
            match known.iter().position(|(n, may)| *may && *n == name) {
                Some(i) => chosen.push(i),
                None => {
                    let hint = suggestion(name, known.iter().filter(|(_, may)| *may).map(|(n, _)| *n));
                    let message = format!("`{name}` is not a coordinate or a joint's velocity{hint}");
                    return Err(self.low.report(value.place.clone(), message));
                }
            }
        }
        Ok(chosen)
    }
}
