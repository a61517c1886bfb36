//! Names of a scene: indices, tables, parameters, coordinates, quasi-velocities and definitions are declared.

use headland_expr::parse::suggestion;
use headland_expr::{Expr, Spline};
use indexmap::IndexMap;
use rustc_hash::FxHashMap;
use std::sync::Arc;

use crate::build::{Builder, Made};
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::model::Parameter;
use crate::place::Place;
use crate::scene::{Data, Entry, Value};
use crate::symbols::{DefinitionKind, Members, Rule, Symbol, member_name, parse_key};
use crate::tables::is_of_two;
use crate::units::{parse_quantity, parse_unit};

/// Rules by name and member; true for a fixed member, which goes before a family's rule.
type Families = IndexMap<String, FxHashMap<i64, (bool, Rule)>>;

impl<'g> Builder<'_, 'g> {
    pub(crate) fn declare(&mut self) {
        self.parts.time = Some(self.low.time);
        self.parameter_lengths();
        self.indices();
        if !self.low.diagnostics.is_empty() {
            return; // everything with an index would be wrong in consequence
        }
        self.tables();
        self.parameters();
        self.coordinates();
        self.quasi_velocities();
        self.declare_assembly();
        self.definitions("prescribed", DefinitionKind::Prescribed);
        self.definitions("definitions", DefinitionKind::Definition);
    }

    /// A name that is free, or a report.
    pub(crate) fn free_name(&mut self, name: &str, place: &Place, new: &str) -> Made<()> {
        const RESERVED: [&str; 7] = ["t", "pi", "π", "and", "or", "not", "sum"];
        if RESERVED.contains(&name) {
            return Err(self
                .low
                .report(place.clone(), format!("`{name}` has a meaning of its own and cannot name {new}")));
        }
        match self.low.symbols.by_name.get(name) {
            Some(old) => {
                let old = old.kind();
                Err(self.low.report(place.clone(), format!("`{name}` is {old} already and cannot be {new} too")))
            }
            None => Ok(()),
        }
    }

    pub(crate) fn parameter_lengths(&mut self) {
        for entry in self.scene.section("parameters") {
            match &entry.value.data {
                Data::Array(values) => {
                    self.low.symbols.lengths.insert(entry.key.clone(), values.len() as i64);
                }
                Data::Number(x) => {
                    self.low.symbols.integers.insert(entry.key.clone(), *x);
                }
                Data::Text(text) => {
                    if let Some(Ok((x, None))) = parse_quantity(text) {
                        self.low.symbols.integers.insert(entry.key.clone(), x);
                    }
                }
                _ => {}
            }
        }
    }

    pub(crate) fn indices(&mut self) {
        for entry in self.scene.section("indices") {
            let _ = self.index(entry);
        }
    }

    pub(crate) fn index(&mut self, entry: &Entry) -> Made<()> {
        self.free_name(&entry.key, &entry.key_place, "an index")?;
        let formula = self.formula_of(&entry.value)?;
        let n = match self.low.symbols.index_value(&formula.program, &[]) {
            Ok(n) if (0..=1_000_000).contains(&n) => n,
            Ok(n) => {
                let message = format!("the index `{}` has {n} members; 0 to 1000000 are possible", entry.key);
                return Err(self.low.report(entry.value.place.clone(), message));
            }
            Err(message) => {
                let message = format!("the index `{}`: {message}", entry.key);
                return Err(self.low.report(entry.value.place.clone(), message));
            }
        };
        self.low.symbols.by_name.insert(entry.key.as_str().into(), Symbol::Index(n));
        Ok(())
    }

    pub(crate) fn tables(&mut self) {
        for entry in self.scene.section("tables") {
            let _ = self.table(entry);
        }
    }

    pub(crate) fn table(&mut self, entry: &Entry) -> Made<()> {
        self.free_name(&entry.key, &entry.key_place, "a table")?;
        let Data::Table(fields) = &entry.value.data else {
            let message = "a table is written `{ x = [..], y = [..], x_unit = \"m\", y_unit = \"N\" }`";
            return Err(self.low.report(entry.value.place.clone(), message));
        };
        if is_of_two(fields) {
            return self.table_of_two(entry, fields);
        }
        let mut points: [Vec<f64>; 2] = Default::default();
        let mut units = [None, None];
        for field in fields {
            match (field.key.as_str(), &field.value.data) {
                ("x" | "y", Data::Array(values)) => {
                    let slot = &mut points[usize::from(field.key == "y")];
                    for value in values {
                        match value.data {
                            Data::Number(x) => slot.push(x),
                            _ => return Err(self.low.report(value.place.clone(), "the points of a table are numbers")),
                        }
                    }
                }
                ("x_unit" | "y_unit", Data::Text(text)) => match parse_unit(text) {
                    Ok(unit) => units[usize::from(field.key == "y_unit")] = Some(unit),
                    Err(message) => return Err(self.low.report(field.value.place.clone(), message)),
                },
                (key, _) => {
                    let hint = suggestion(key, ["x", "y", "x_unit", "y_unit"]);
                    return Err(self.low.report(
                        field.key_place.clone(),
                        format!("a table has x, y, x_unit and y_unit, not `{key}`{hint}"),
                    ));
                }
            }
        }
        let mut dimensions = [const { Dimension::NONE }; 2];
        for i in 0..2 {
            match &units[i] {
                Some(unit) => {
                    points[i].iter_mut().for_each(|x| *x = unit.to_si(*x));
                    dimensions[i] = unit.dimension.clone();
                }
                None => dimensions[i] = self.low.unifier.unknown(),
            }
        }
        match Spline::new(&entry.key, &points[0], &points[1]) {
            Ok(spline) => {
                let [x, y] = dimensions;
                self.low.symbols.by_name.insert(entry.key.as_str().into(), Symbol::Table(Arc::new(spline), x, y));
                Ok(())
            }
            Err(error) => Err(self.low.report(entry.value.place.clone(), error.to_string())),
        }
    }

    pub(crate) fn parameters(&mut self) {
        // A family of parameters ("l[k]" = ..) and a parameter given by an expression are definitions.
        let mut rules: Vec<&Entry> = Vec::new();
        for entry in self.scene.section("parameters") {
            let literal = match &entry.value.data {
                Data::Number(_) | Data::Array(_) => true,
                Data::Text(text) => parse_quantity(text).is_some(),
                _ => {
                    let message = format!(
                        "the parameter `{}` is {}; a number, a quantity, an expression or an array was expected",
                        entry.key,
                        entry.value.data.kind()
                    );
                    self.low.report(entry.value.place.clone(), message);
                    continue;
                }
            };
            if literal && !entry.key.contains('[') {
                let _ = self.literal_parameter(entry);
            } else {
                rules.push(entry);
            }
        }
        self.rules(rules, DefinitionKind::Parameter);
    }

    pub(crate) fn literal_parameter(&mut self, entry: &Entry) -> Made<()> {
        self.free_name(&entry.key, &entry.key_place, "a parameter")?;
        if let Err(message) = parse_key(&entry.key) {
            return Err(self.low.report(entry.key_place.clone(), message));
        }
        let (values, array): (&[Value], bool) = match &entry.value.data {
            Data::Array(values) => (values, true),
            _ => (std::slice::from_ref(&entry.value), false),
        };
        let free = self.low.unifier.unknown(); // one dimension for all members without a unit
        let mut members = Vec::new();
        for (i, value) in values.iter().enumerate() {
            let name = member_name(&entry.key, if array { i as i64 + 1 } else { 0 });
            let (x, dimension, angle) = self.literal(value, &free)?;
            let id = self.low.dependence.input(self.low.graph, &name, Kinds::PARAMETER);
            let index = self.low.graph.input_count() - 1;
            self.parts.parameters.push(Parameter { name, input: index, value: x, unit: String::new() });
            members.push((id, dimension, angle));
        }
        self.low.symbols.by_name.insert(entry.key.as_str().into(), Symbol::Parameter(members, array));
        Ok(())
    }

    /// A number or a quantity; members of arrays may be constant expressions such as `2*pi`.
    pub(crate) fn literal(&mut self, value: &Value, free: &Dimension) -> Made<(f64, Dimension, bool)> {
        match &value.data {
            Data::Number(x) => Ok((*x, free.clone(), false)),
            Data::Text(text) => match parse_quantity(text) {
                Some(Ok((x, Some(unit)))) => Ok((x, unit.dimension, unit.angle)),
                Some(Ok((x, None))) => Ok((x, free.clone(), false)),
                Some(Err(message)) => Err(self.low.report(value.place.clone(), message)),
                None => {
                    let formula = self.low.formula(text, &value.place)?;
                    let typed = self.low.lower(&formula, &None)?;
                    let dimension = if typed.dimension.is_known() { typed.dimension } else { free.clone() };
                    match self.evaluate(typed.expr) {
                        Some(x) => Ok((x, dimension, typed.angle)),
                        None => Err(self.low.report(
                            value.place.clone(),
                            format!("`{text}` is not a finite number made of parameters"),
                        )),
                    }
                }
            },
            other => {
                let message = format!("found {} where a number or a quantity was expected", other.kind());
                Err(self.low.report(value.place.clone(), message))
            }
        }
    }

    /// Value of an expression of parameters.
    pub(crate) fn evaluate(&mut self, e: Expr<'g>) -> Option<f64> {
        let x = match e {
            Expr::Const(x) => x,
            Expr::Node(graph, id) => {
                if self.low.dependence.any(e, Kinds::PARAMETER.not()) {
                    return None;
                }
                let mut inputs = vec![f64::NAN; graph.input_count()];
                for p in &self.parts.parameters {
                    inputs[p.input] = p.value;
                }
                graph.eval(&[id], &inputs)[0]
            }
        };
        x.is_finite().then_some(x)
    }

    /// `name = unit` of a section: the members and their type.
    pub(crate) fn declared(&mut self, entry: &Entry, new: &str) -> Made<(String, i64, Dimension, bool)> {
        let key = match parse_key(&entry.key) {
            Ok(key) if key.primes == 0 => key,
            Ok(_) => {
                let message = format!("`{}` has a prime; {new} is declared without", entry.key);
                return Err(self.low.report(entry.key_place.clone(), message));
            }
            Err(message) => return Err(self.low.report(entry.key_place.clone(), message)),
        };
        self.free_name(&key.name, &entry.key_place, new)?;
        let mut index = key.index;
        if let Some(index) = &mut index
            && let Err(message) = self.low.symbols.fold_lengths(index)
        {
            return Err(self.low.report(entry.key_place.clone(), message));
        }
        let members = match self.low.symbols.members(index.as_ref()) {
            Ok(members) => members,
            Err(message) => return Err(self.low.report(entry.key_place.clone(), message)),
        };
        // 0: a single one; a family without members, of an index with none, counts -1
        let count = match (&index, members.len()) {
            (None, _) => 0,
            (Some(_), 0) => -1,
            (Some(_), n) => n as i64,
        };
        if index.is_some() && members.iter().enumerate().any(|(i, (m, _))| *m != i as i64 + 1) {
            let message = format!("members of {new} count from 1: write `{}[k]`", key.name);
            return Err(self.low.report(entry.key_place.clone(), message));
        }
        let Data::Text(text) = &entry.value.data else {
            let message = format!(
                "the unit of `{}` was expected, such as \"m\" or \"rad\"; found {}",
                entry.key,
                entry.value.data.kind()
            );
            return Err(self.low.report(entry.value.place.clone(), message));
        };
        match parse_unit(text) {
            Ok(unit) => Ok((key.name, count, unit.dimension, unit.angle)),
            Err(message) => Err(self.low.report(entry.value.place.clone(), message)),
        }
    }

    pub(crate) fn coordinates(&mut self) {
        for entry in self.scene.section("coordinates") {
            let Ok((name, count, dimension, angle)) = self.declared(entry, "a coordinate") else { continue };
            if self.scene.section("prescribed").iter().any(|p| p.key.split('[').next() == Some(&name)) {
                self.low.declared.insert(name, (dimension, angle)); // a given function of time: made there
                continue;
            }
            let mut members = Members::default();
            for member in if count == 0 { 0..=0 } else { 1..=count } {
                let name = member_name(&name, member);
                let position = self.low.add_coordinate(name, &dimension, angle, &entry.key_place);
                members.insert(member, position);
            }
            self.low.symbols.by_name.insert(name.as_str().into(), Symbol::Coordinate(members));
        }
    }

    pub(crate) fn quasi_velocities(&mut self) {
        for entry in self.scene.section("quasi_velocities") {
            let Ok((name, count, dimension, angle)) = self.declared(entry, "a quasi-velocity") else { continue };
            let mut members = Members::default();
            for member in if count == 0 { 0..=0 } else { 1..=count } {
                let name = member_name(&name, member);
                let position = self.low.add_quasi_velocity(name, &dimension, angle, &entry.key_place);
                members.insert(member, position);
            }
            self.low.symbols.by_name.insert(name.as_str().into(), Symbol::QuasiVelocity(members));
        }
    }

    pub(crate) fn definitions(&mut self, section: &str, kind: DefinitionKind) {
        let entries: Vec<&Entry> = self.scene.section(section).iter().collect();
        self.rules(entries, kind);
    }

    /// Entries `name = expression`, `name[k+1] = expression`; a fixed member goes before a family's rule.
    pub(crate) fn rules(&mut self, entries: Vec<&Entry>, kind: DefinitionKind) {
        let mut families = Families::new();
        for entry in entries {
            let _ = self.rule(entry, kind, &mut families);
        }
        for (name, rules) in families {
            let rules = rules.into_iter().map(|(member, (_, rule))| (member, rule)).collect();
            self.low.symbols.by_name.insert(name.as_str().into(), Symbol::Definition(rules, kind));
        }
    }

    pub(crate) fn rule(&mut self, entry: &Entry, kind: DefinitionKind, families: &mut Families) -> Made<()> {
        let place = entry.key_place.clone();
        let mut key = match parse_key(&entry.key) {
            Ok(key) if key.primes == 0 => key,
            Ok(_) => {
                return Err(self
                    .low
                    .report(place, format!("`{}` has a prime; a rate is given in [kinematics]", entry.key)));
            }
            Err(message) => return Err(self.low.report(place, message)),
        };
        if !families.contains_key(&key.name) {
            let empty = match kind {
                DefinitionKind::Parameter => "a parameter",
                DefinitionKind::Prescribed => "a prescribed coordinate",
                DefinitionKind::Definition => "a definition",
            };
            let is_driven = |s: &Symbol| kind == DefinitionKind::Prescribed && matches!(s, Symbol::Joint(_));
            let joint = self.low.symbols.by_name.get(key.name.as_str()).is_some_and(is_driven);
            if !(joint && self.low.declared.contains_key(&key.name)) {
                self.free_name(&key.name, &place, empty)?; // a driven joint's name stands for its only coordinate
            }
            families.insert(key.name.clone(), FxHashMap::default());
        }
        let formula = self.formula_of(&entry.value)?;
        if let Some(index) = &mut key.index
            && let Err(message) = self.low.symbols.fold_lengths(index)
        {
            return Err(self.low.report(place, message));
        }
        let members = match self.low.symbols.members(key.index.as_ref()) {
            Ok(members) => members,
            Err(message) => return Err(self.low.report(place, message)),
        };
        let single = key.index.is_none();
        let Some(family) = families.get_mut(&key.name) else { return Err(Reported) };
        for (member, binding) in members {
            let fixed = binding.is_none();
            match family.get(&member) {
                Some((true, _)) if !fixed => continue,
                Some((old_fixed, _)) if *old_fixed == fixed => {
                    let name = member_name(&key.name, member);
                    return Err(self.low.report(place, format!("`{name}` is defined twice")));
                }
                _ => {}
            }
            if family.keys().any(|m| (*m == 0) != single) {
                return Err(self
                    .low
                    .report(place, format!("`{}` is defined both with and without an index", key.name)));
            }
            family.insert(member, (fixed, Rule { formula: formula.clone(), binding }));
        }
        Ok(())
    }
}
