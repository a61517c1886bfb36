//! Kinematics, constraints and elements of a scene, with their structures and dimensions checked.

use headland_expr::Expr;
use headland_expr::parse::{Program, suggestion};

use crate::build::{Builder, Made, bound_name};
use crate::depend::Kinds;
use crate::dimension::{Dimension, Ratio};
use crate::lower::{Typed, per_time};
use crate::model::{Element, ElementKind, KinematicRow, RowForm, StructureForm};
use crate::place::{Diagnostic, Place};
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Entry, Value};
use crate::symbols::{Binding, Formula, Symbol, member_name, parse_key};

impl<'g> Builder<'_, 'g> {
    pub(crate) fn kinematics(&mut self) {
        for entry in self.scene.section("kinematics") {
            let _ = self.kinematic_row(entry);
        }
        let mut given = vec![0; self.low.coordinates.len()];
        for row in &self.parts.kinematics {
            if let RowForm::Rate(i, _) = row.form {
                given[i] += 1;
                if given[i] > 1 {
                    let message = format!("the rate of `{}` is given twice", self.low.coordinates[i].name);
                    self.low.diagnostics.push(Diagnostic { place: row.place.clone(), message });
                }
            }
        }
    }

    pub(crate) fn kinematic_row(&mut self, entry: &Entry) -> Made<()> {
        let place = entry.key_place.clone();
        let mut key = match parse_key(&entry.key) {
            Ok(key) if key.primes == 1 => key,
            Ok(_) => {
                let message = format!("a row of the kinematics gives a rate: `{}'`", entry.key.trim_end_matches('\''));
                return Err(self.low.report(place, message));
            }
            Err(message) => return Err(self.low.report(place, message)),
        };
        let family = match self.low.symbols.by_name.get(key.name.as_str()) {
            Some(Symbol::Coordinate(members)) => members.clone(),
            other => {
                let found = other.map_or("undefined", Symbol::kind);
                let coordinates = self.low.symbols.by_name.iter().filter(|(_, s)| matches!(s, Symbol::Coordinate(..)));
                let hint = suggestion(&key.name, coordinates.map(|(n, _)| &**n));
                return Err(self.low.report(place, format!("`{}` is {found}, not a coordinate{hint}", key.name)));
            }
        };
        if let Some(index) = &mut key.index {
            let _ = self.low.symbols.fold_lengths(index);
        }
        let members = self.low.symbols.members(key.index.as_ref()).map_err(|m| self.low.report(place.clone(), m))?;
        let formula = self.formula_of(&entry.value)?;
        for (member, binding) in members {
            let Some(i) = family.get(member) else {
                let message =
                    format!("`{}` is not a member of the coordinate `{}`", member_name(&key.name, member), key.name);
                return Err(self.low.report(place, message));
            };
            let typed = self.low.lower(&formula, &binding)?;
            let (dimension, angle) = self.low.coordinate_types[i].clone();
            let name = format!("{}'", self.low.coordinates[i].name);
            self.low.demand(&typed, &per_time(&dimension, 1), angle, &formula, &format!("the rate `{name}`"))?;
            self.no_accelerations(&typed, &formula.place, &format!("the rate `{name}`"))?;
            let node = self.low.graph.id(typed.expr);
            self.parts.kinematics.push(KinematicRow::new(name, &formula.place, RowForm::Rate(i, node)));
        }
        Ok(())
    }

    pub(crate) fn no_accelerations(&mut self, typed: &Typed<'g>, place: &Place, what: &str) -> Made<()> {
        match self.depends(typed.expr, Kinds::ACCELERATION) {
            None => Ok(()),
            Some(input) => {
                let message = format!(
                    "{what} depends on the acceleration `{input}`; coordinates, velocities and time are allowed"
                );
                Err(self.low.report(place.clone(), message))
            }
        }
    }

    /// The members of an element: one for each value of the index that its texts use.
    pub(crate) fn members_of(&mut self, formulas: &[&Formula], place: &Place) -> Made<Vec<Binding>> {
        let programs: Vec<&Program> = formulas.iter().map(|f| &f.program).collect();
        self.bindings(&programs, place)
    }

    /// One binding for each value of the index that the programs use.
    pub(crate) fn bindings(&mut self, programs: &[&Program], place: &Place) -> Made<Vec<Binding>> {
        match self.low.symbols.free_index(programs) {
            Ok(None) => Ok(vec![None]),
            Ok(Some(index)) => match self.low.symbols.by_name.get(&*index) {
                Some(Symbol::Index(n)) => Ok((1..=*n).map(|k| Some((index.clone(), k))).collect()),
                _ => Ok(Vec::new()),
            },
            Err(message) => Err(self.low.report(place.clone(), message)),
        }
    }

    pub(crate) fn constraints(&mut self) {
        for element in self.scene.section_elements("constraint") {
            let _ = self.constraint(element);
        }
    }

    pub(crate) fn constraint(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        let Some(Value { data: Data::Text(text), place }) = element.get("equation") else {
            return Err(self.low.report(element.place.clone(), "a constraint needs `equation = \"left = right\"`"));
        };
        let equals: Vec<usize> = text
            .match_indices('=')
            .map(|(i, _)| i)
            .filter(|&i| !text[..i].ends_with(['<', '>', '=']) && !text[i + 1..].starts_with('='))
            .collect();
        let &[at] = equals.as_slice() else {
            return Err(self.low.report(
                place.clone(),
                format!("an equation has one `=`: `x'*sin(theta) = y'*cos(theta)`; found `{text}`"),
            ));
        };
        let side = |from: usize, to: usize| {
            let (start, end) =
                (text[from..to].len() - text[from..to].trim_start().len(), text[from..to].trim_end().len());
            from + start.min(end)..from + end
        };
        let (left, right) = (side(0, at), side(at + 1, text.len()));
        let left = self.low.formula(&text[left.clone()], &place.part(&left))?;
        let right = self.low.formula(&text[right.clone()], &place.part(&right))?;
        for binding in self.members_of(&[&left, &right], place)? {
            let (a, b) = (self.low.lower(&left, &binding)?, self.low.lower(&right, &binding)?);
            self.low.demand(&b, &a.dimension, a.angle, &right, "the left side")?;
            let zero = Typed { expr: a.expr - b.expr, ..a };
            let name = bound_name(&name, &binding);
            self.no_accelerations(&zero, place, &format!("the constraint `{name}`"))?;
            let mut row = self.constraint_row(&name, zero.expr, place)?;
            let velocity = per_time(&zero.dimension, u8::from(row.position.is_some()));
            row.force = Some((format!("{name}.force"), &Dimension::of(1, 2, -3) - &velocity));
            row.dimension = velocity;
            self.parts.kinematics.push(row);
        }
        Ok(())
    }

    /// A constraint on velocities as it is; one on positions by its rate.
    fn constraint_row(&mut self, name: &str, zero: Expr<'g>, place: &Place) -> Made<KinematicRow> {
        let graph = self.low.graph;
        if self.depends(zero, Kinds::RATE.or(Kinds::QUASI).or(Kinds::JOINT)).is_some() {
            return Ok(KinematicRow::new(name, place, RowForm::Zero(graph.id(zero))));
        }
        if self.depends(zero, Kinds::COORDINATE).is_none() {
            let message = format!("the constraint `{name}` contains neither a coordinate nor a rate: it binds nothing");
            return Err(self.low.report(place.clone(), message));
        }
        let rate = self.low.time_derivative(zero, 1).map_err(|m| self.low.report(place.clone(), m))?;
        let row = KinematicRow::new(name, place, RowForm::Zero(graph.id(rate)));
        Ok(KinematicRow { position: Some(graph.id(zero)), may_be_redundant: true, ..row })
    }

    pub(crate) fn text_field(&mut self, element: &SceneElement, key: &str) -> Made<String> {
        match element.get(key) {
            Some(Value { data: Data::Text(text), .. }) => Ok(text.clone()),
            Some(other) => Err(self
                .low
                .report(other.place.clone(), format!("`{key}` must be a text, found {}", other.data.kind()))),
            None => Err(self.low.report(element.place.clone(), format!("this element lacks `{key}`"))),
        }
    }

    pub(crate) fn elements(&mut self, section: &str, kind: ElementKind, power: &Dimension) {
        for element in self.scene.section_elements(section) {
            let before = self.parts.elements.len();
            let _ = self.element(section, element, kind, power);
            let (old, new) = self.parts.elements.split_at(before);
            let twice = new.iter().find(|n| old.iter().any(|o| o.kind == kind && o.name == n.name));
            if let Some(name) = twice.map(|e| e.name.clone()) {
                self.low.report(element.place.clone(), format!("two elements of [[{section}]] are named `{name}`"));
            }
        }
    }

    pub(crate) fn element(
        &mut self,
        section: &str,
        element: &SceneElement,
        kind: ElementKind,
        power: &Dimension,
    ) -> Made<()> {
        let has = |keys: [&str; 2]| keys.iter().any(|k| element.get(k).is_some());
        match kind {
            ElementKind::Inertia if has(["mass", "tensor"]) => return self.vector_inertia(element),
            ElementKind::Force if has(["force", "torque"]) => return self.vector_force(element),
            _ => {}
        }
        let name = self.text_field(element, "name")?;
        let structures: Vec<(StructureForm, &Value)> = [
            (StructureForm::Geometric, "geometric"),
            (StructureForm::Implicit, "implicit"),
            (StructureForm::Explicit, "explicit"),
        ]
        .iter()
        .filter_map(|(form, key)| element.get(key).map(|v| (*form, v)))
        .collect();
        let &[(form, structure)] = structures.as_slice() else {
            let message = format!(
                "`{name}` of [[{section}]] needs one structure, `geometric`{}; found {}",
                if kind == ElementKind::Elastic { "" } else { ", `implicit` or `explicit`" },
                structures.len()
            );
            return Err(self.low.report(element.place.clone(), message));
        };
        let Some(value) = element.get("value") else {
            return Err(self.low.report(element.place.clone(), format!("`{name}` of [[{section}]] lacks `value`")));
        };
        let (value, structure) = (self.formula_of(value)?, self.formula_of(structure)?);
        for binding in self.members_of(&[&value, &structure], &element.place)? {
            let name = bound_name(&name, &binding);
            let v = self.low.lower(&value, &binding)?;
            let s = self.low.lower(&structure, &binding)?;
            self.check_structure(&name, kind, form, &v, &s, &value, &structure)?;
            self.check_power(&name, section, kind, form, &v, &s, power, &value)?;
            let graph = self.low.graph;
            self.parts.elements.push(Element {
                unit: self.low.unifier.resolve(&v.dimension).unit(false),
                name,
                kind,
                value: graph.id(v.expr),
                form,
                structure: graph.id(s.expr),
                rate: None,
                place: element.place.clone(),
            });
        }
        Ok(())
    }

    /// What value and structure may depend on.
    pub(crate) fn check_structure(
        &mut self,
        name: &str,
        kind: ElementKind,
        form: StructureForm,
        value: &Typed<'g>,
        structure: &Typed<'g>,
        value_formula: &Formula,
        formula: &Formula,
    ) -> Made<()> {
        self.no_accelerations(structure, &formula.place, &format!("the structure of `{name}`"))?;
        self.no_accelerations(value, &value_formula.place, &format!("the value of `{name}`"))?;
        let (wrong, advice) = match form {
            StructureForm::Geometric => (
                self.depends(structure.expr, Kinds::RATE.or(Kinds::QUASI).or(Kinds::JOINT)),
                "a geometric structure d(q, t) has no velocities; give `implicit` (by q') or `explicit` (by u)",
            ),
            StructureForm::Implicit => (
                self.depends(structure.expr, Kinds::QUASI),
                "an implicit structure d'(q, q', t) has no quasi-velocities; give `explicit`",
            ),
            StructureForm::Explicit => (
                self.depends(structure.expr, Kinds::RATE),
                "an explicit structure d'(q, u, t) has no rates of coordinates; give `implicit`",
            ),
        };
        if let Some(input) = wrong {
            return Err(self
                .low
                .report(formula.place.clone(), format!("the structure of `{name}` depends on `{input}`: {advice}")));
        }
        if matches!(kind, ElementKind::Inertia | ElementKind::Elastic) {
            let wrong = self.depends(value.expr, Kinds::PARAMETER.not());
            if let Some(input) = wrong {
                let message =
                    format!("the value of `{name}` depends on `{input}`; it must be constant (made of parameters)");
                return Err(self.low.report(value_formula.place.clone(), message));
            }
        }
        Ok(())
    }

    /// Every element gives a power of one and the same dimension: value times what its structure makes of it.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn check_power(
        &mut self,
        name: &str,
        section: &str,
        kind: ElementKind,
        form: StructureForm,
        value: &Typed<'g>,
        structure: &Typed<'g>,
        power: &Dimension,
        formula: &Formula,
    ) -> Made<()> {
        let s = &Dimension::time();
        let rate =
            if form == StructureForm::Geometric { &structure.dimension - s } else { structure.dimension.clone() };
        let square = rate.power(Ratio::new(2, 1));
        let factor = match kind {
            ElementKind::Inertia => &square - s,
            ElementKind::Elastic => &square + s,
            ElementKind::Dissipative => square,
            ElementKind::Force => rate,
        };
        let wanted = power - &factor;
        match self.low.unifier.unify(&value.dimension, &wanted) {
            Ok(()) => Ok(()),
            Err(conflict) => {
                let (found, wanted) = *conflict;
                let message = format!(
                    "the value of `{name}` of [[{section}]] should be {} [{}] for its structure, but `{}` is {} [{}]",
                    wanted.kind(false),
                    wanted.unit(false),
                    formula.text,
                    found.kind(value.angle),
                    found.unit(value.angle)
                );
                Err(self.low.report(formula.place.clone(), message))
            }
        }
    }
}
