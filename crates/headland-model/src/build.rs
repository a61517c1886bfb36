//! A [`Scene`] into a [`Model`]: names are declared, then every formula is made; everything wrong is reported in one go.

use headland_expr::parse::{Program, suggestion};
use headland_expr::{Expr, Graph, NodeId};

use crate::assembly::Assembly;
use crate::contact::Contact;
use crate::depend::Kinds;
use crate::lower::{Lowering, Reported, Typed};
use crate::model::{
    Body, Coordinate, DerivedQuantity, Element, ElementKind, Event, Guard, Hazard, KinematicRow, LinearSolver, Load,
    Model, Parameter, Plot, Quantity, QuasiVelocity, RunSettings, Switch,
};
use crate::place::{Diagnostic, ModelError, Place};
use crate::scene::{Data, Scene, Value};
use crate::symbols::{Binding, DefinitionKind, Formula, Symbol, member_name, parse_key};
use crate::tree::JointTree;
use crate::units::{parse_quantity, parse_unit};

impl Scene {
    /// Checks the scene and makes the model.
    ///
    /// # Errors
    /// Everything that is wrong, with places.
    pub fn build(&self) -> Result<Model, ModelError> {
        let graph = Graph::new();
        let mut parts = Parts::default();
        let mut diagnostics = {
            let mut builder =
                Builder { scene: self, low: Lowering::new(&graph), parts: &mut parts, assembly: Assembly::default() };
            builder.declare();
            if builder.low.diagnostics.is_empty() {
                builder.make();
            }
            builder.finish_units();
            std::mem::take(&mut builder.low.diagnostics)
        };
        if diagnostics.is_empty() {
            return Ok(parts.into_model(self, graph));
        }
        diagnostics.sort_by_key(|d| match &d.place {
            Place::File(range) => (0, range.start),
            _ => (1, 0),
        });
        diagnostics.dedup();
        Err(ModelError { source: self.source.clone(), diagnostics })
    }
}

/// What is put together.
#[derive(Default)]
pub(crate) struct Parts {
    pub(crate) time: Option<NodeId>,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) coordinates: Vec<Coordinate>,
    pub(crate) prescribed: Vec<Quantity>,
    pub(crate) quasi_velocities: Vec<QuasiVelocity>,
    pub(crate) kinematics: Vec<KinematicRow>,
    pub(crate) elements: Vec<Element>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) loads: Vec<Load>,
    pub(crate) derived: Vec<DerivedQuantity>,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) switches: Vec<Switch>,
    pub(crate) tree: Option<JointTree>,
    pub(crate) definitions: Vec<Quantity>,
    pub(crate) outputs: Vec<Quantity>,
    pub(crate) guards: Vec<Guard>,
    pub(crate) hazards: Vec<Hazard>,
    pub(crate) events: Vec<Event>,
    pub(crate) plots: Vec<Plot>,
    pub(crate) run: Option<RunSettings>,
    pub(crate) warnings: Vec<Diagnostic>,
}

impl Parts {
    pub(crate) fn into_model(self, scene: &Scene, graph: Graph) -> Model {
        let title = match scene.top.iter().find(|e| e.key == "title").map(|e| &e.value.data) {
            Some(Data::Text(text)) => text.clone(),
            _ => scene.source.name.clone(),
        };
        let time = self.time.unwrap_or_else(|| graph.input_id(0));
        let run = self.run.unwrap_or_default();
        Model {
            title,
            source: scene.source.clone(),
            graph,
            time,
            parameters: self.parameters,
            coordinates: self.coordinates,
            prescribed: self.prescribed,
            quasi_velocities: self.quasi_velocities,
            kinematics: self.kinematics,
            elements: self.elements,
            bodies: self.bodies,
            loads: self.loads,
            derived: self.derived,
            contacts: self.contacts,
            switches: self.switches,
            tree: self.tree,
            definitions: self.definitions,
            outputs: self.outputs,
            guards: self.guards,
            hazards: self.hazards,
            events: self.events,
            plots: self.plots,
            run,
            warnings: self.warnings,
        }
    }
}

impl Default for RunSettings {
    fn default() -> Self {
        Self {
            from: 0.0,
            until: 10.0,
            tolerance: 1e-8,
            points: 300,
            method: "auto".into(),
            max_step: f64::INFINITY,
            linear_solver: LinearSolver::Ldl,
            independent: None,
        }
    }
}

pub(crate) struct Builder<'s, 'g> {
    pub(crate) scene: &'s Scene,
    pub(crate) low: Lowering<'g>,
    pub(crate) parts: &'s mut Parts,
    pub(crate) assembly: Assembly<'s, 'g>,
}

pub(crate) type Made<T> = Result<T, Reported>;

impl<'s, 'g> Builder<'s, 'g> {
    pub(crate) fn make(&mut self) {
        self.build_assembly();
        self.check_definitions();
        self.kinematics();
        self.assembly_elements();
        self.constraints();
        let power = self.low.unifier.unknown();
        for (section, kind) in [
            ("inertia", ElementKind::Inertia),
            ("elastic", ElementKind::Elastic),
            ("dissipative", ElementKind::Dissipative),
            ("force", ElementKind::Force),
        ] {
            self.elements(section, kind, &power);
        }
        self.no_name_twice("force");
        self.states_of_first_order();
        self.publish_derived();
        self.publish_residuals();
        self.initial();
        self.scales();
        self.prescribed();
        self.outputs();
        self.guards();
        self.events();
        if self.low.diagnostics.is_empty() {
            self.plots(); // else a column may be missing in consequence
        }
        self.run_settings();
        self.offset_meshes();
        self.guess_places();
        self.array_lengths();
        self.unused_prescribed();
        self.warn();
        self.finish_reactions();
        self.parts.tree = self.joint_tree();
    }

    /// The parsed value of an entry.
    pub(crate) fn formula_of(&mut self, value: &Value) -> Made<Formula> {
        match &value.data {
            Data::Number(x) => {
                Ok(Formula { program: Program::number(*x), text: x.to_string().into(), place: value.place.clone() })
            }
            Data::Text(text) => {
                if let Some(Ok((x, Some(_)))) = parse_quantity(text) {
                    let unit = text.trim().trim_start_matches(|c: char| {
                        !c.is_alphabetic() && c != '%' && c != '°' || c == 'e' || c == 'E'
                    });
                    let mut program = Program::number(x);
                    // The value is in SI already; the unit carries the dimension.
                    if let Ok(u) = parse_unit(unit) {
                        let si = u.dimension.unit(u.angle);
                        program.items[0] = headland_expr::parse::Item::Number(x, Some(si));
                    }
                    return Ok(Formula { program, text: text.as_str().into(), place: value.place.clone() });
                }
                self.low.formula(text, &value.place)
            }
            other => {
                let message = format!("found {} where an expression was expected", other.kind());
                Err(self.low.report(value.place.clone(), message))
            }
        }
    }

    /// Makes every definition inside the range of its index, so that errors in unused ones are found too.
    pub(crate) fn check_definitions(&mut self) {
        let mut wanted: Vec<(usize, i64, DefinitionKind)> = Vec::new();
        for (i, (_, symbol)) in self.low.symbols.by_name.iter().enumerate() {
            if let Symbol::Definition(rules, kind) = symbol {
                let mut members: Vec<i64> = rules.keys().copied().collect();
                members.sort_unstable();
                // A recurrence may define one member beyond the index; it is made only if something uses it.
                let last = rules.values().filter_map(|r| r.binding.as_ref().map(|b| b.1)).max();
                wanted.extend(members.into_iter().filter(|m| last.is_none_or(|n| *m <= n)).map(|m| (i, m, *kind)));
            }
        }
        for (symbol, member, kind) in wanted {
            let Ok(typed) = self.low.definition(symbol, member) else { continue };
            let wrong = match kind {
                DefinitionKind::Definition => continue,
                DefinitionKind::Prescribed => self.depends(typed.expr, Kinds::TIME.or(Kinds::PARAMETER).not()),
                DefinitionKind::Parameter => self.depends(typed.expr, Kinds::PARAMETER.not()),
            };
            if let Some(input) = wrong {
                let (name, symbol) = match self.low.symbols.by_name.get_index(symbol) {
                    Some((name, symbol)) => (member_name(name, member), symbol),
                    None => continue,
                };
                let place = match symbol {
                    Symbol::Definition(rules, _) => {
                        rules.get(&member).map_or(Place::Program, |r| r.formula.place.clone())
                    }
                    _ => Place::Program,
                };
                let message = match kind {
                    DefinitionKind::Parameter => {
                        format!("the parameter `{name}` depends on `{input}`; a parameter is made of parameters only")
                    }
                    _ => format!(
                        "the prescribed coordinate `{name}` depends on `{input}`; it must be a function of t alone"
                    ),
                };
                self.low.report(place, message);
            }
        }
    }

    /// The name of an input of one of the kinds on which an expression depends.
    pub(crate) fn depends(&mut self, e: Expr<'g>, wrong: Kinds) -> Option<String> {
        self.low.dependence.name(e, wrong)
    }

    pub(crate) fn prescribed(&mut self) {
        for entry in self.scene.section("prescribed") {
            let Ok(key) = parse_key(&entry.key) else { continue };
            let Some(symbol) = self.low.symbols.by_name.get_index_of(key.name.as_str()) else { continue };
            if key.name.contains('.') && !self.low.declared.contains_key(&key.name) {
                let hint = suggestion(&key.name, self.low.coordinates.iter().map(|c| c.name.as_str()));
                let message = format!("`{}` is no coordinate of a joint{hint}", entry.key);
                self.low.report(entry.key_place.clone(), message);
                continue;
            }
            for (member, _) in self.low.symbols.members(key.index.as_ref()).unwrap_or_default() {
                if let Ok(typed) = self.low.definition(symbol, member) {
                    let name = member_name(&key.name, member);
                    if self.parts.prescribed.iter().all(|p| p.name != name) {
                        let quantity = self.quantity(name, typed, entry.value.place.clone());
                        self.parts.prescribed.push(quantity);
                    }
                }
            }
        }
    }

    /// A name under `[prescribed]` that is no coordinate is a function of time; one that nothing uses is a mistyped name.
    fn unused_prescribed(&mut self) {
        for entry in self.scene.section("prescribed") {
            let Ok(key) = parse_key(&entry.key) else { continue };
            if key.name.contains('.') || self.low.declared.contains_key(&key.name) || self.low.used.contains(&key.name)
            {
                continue;
            }
            let symbols = self.low.symbols.by_name.iter();
            let coordinates = symbols.filter(|(_, s)| matches!(s, Symbol::Coordinate(..))).map(|(name, _)| &**name);
            let joints = self.low.coordinates.iter().map(|c| c.name.as_str());
            let hint = suggestion(&key.name, coordinates.chain(joints));
            let message = format!(
                "`{}` is prescribed, but it is no coordinate of [coordinates] or of a joint, and nothing uses it{hint}",
                entry.key
            );
            self.low.report(entry.key_place.clone(), message);
        }
    }

    pub(crate) fn quantity(&mut self, name: String, typed: Typed<'g>, place: Place) -> Quantity {
        let unit = self.low.unifier.resolve(&typed.dimension).unit(typed.angle);
        Quantity { name, unit, factor: 1.0, node: self.low.graph.id(typed.expr), place }
    }

    /// An array used as `m[k]` has as many members as `k`: one that is longer belongs to another machine.
    pub(crate) fn array_lengths(&mut self) {
        for entry in self.scene.section("parameters") {
            let Some((index, n)) = self.low.indexed.get(&entry.key).cloned() else { continue };
            let Some(length) = self.low.symbols.lengths.get(&entry.key).copied().filter(|l| *l > n) else { continue };
            if self.low.symbols.by_name.values().any(|s| matches!(s, Symbol::Index(n) if *n == length)) {
                continue; // as long as another index wants it: the last hitch of a train may go unused
            }
            let message =
                format!("`{}` has {length} members, but the index `{index}` has {n}; they must agree", entry.key);
            self.low.report(entry.value.place.clone(), message);
        }
    }

    pub(crate) fn warn(&mut self) {
        if self.low.coordinates.is_empty() && self.parts.prescribed.is_empty() {
            let message = if self.scene.section_elements("body").is_empty() {
                "the scene has no coordinates: `[coordinates]` with names and units, or `[[body]]`"
            } else {
                "nothing in the scene can move: no coordinate is left beside welds, and no motion is prescribed"
            };
            self.low.report(Place::Program, message);
        }
        let without = |s: &str| self.scene.section_elements(s).is_empty();
        if without("inertia") && without("body") && !self.low.coordinates.is_empty() {
            let place = self.scene.section("coordinates").first().map_or(Place::Program, |e| e.key_place.clone());
            self.low.report(place, "the scene has no inertia element: [[inertia]] with a value and a structure");
        }
    }

    /// Units are known when everything has been made.
    pub(crate) fn finish_units(&mut self) {
        let values = self.low.symbols.by_name.values().filter_map(|symbol| match symbol {
            Symbol::Parameter(values, _) => Some(values),
            _ => None,
        });
        // Parameters were made in the order of their symbols.
        for (parameter, (_, dimension, angle)) in self.parts.parameters.iter_mut().zip(values.flatten()) {
            parameter.unit = self.low.unifier.resolve(dimension).unit(*angle);
        }
        self.parts.definitions = std::mem::take(&mut self.low.made)
            .into_iter()
            .map(|made| {
                let unit = self.low.unifier.resolve(&made.dimension).unit(made.angle);
                Quantity { name: made.name, unit, factor: 1.0, node: made.id, place: made.place }
            })
            .collect();
        self.parts.coordinates = std::mem::take(&mut self.low.coordinates);
        self.parts.quasi_velocities = std::mem::take(&mut self.low.quasi_velocities);
    }
}

/// A name with its index variable replaced: `mass[k]` becomes `mass[2]`.
pub(crate) fn bound_name(name: &str, binding: &Binding) -> String {
    let Some((variable, k)) = binding else { return name.to_string() };
    let mut result = String::new();
    let mut rest = name;
    while let Some(open) = rest.find('[') {
        let Some(close) = rest[open..].find(']').map(|i| open + i) else { break };
        let inside = &rest[open + 1..close];
        result.push_str(&rest[..=open]);
        let value = headland_expr::parse::parse(inside)
            .ok()
            .and_then(|p| crate::symbols::Symbols::default().index_value(&p, &[(variable.clone(), *k)]).ok());
        match value {
            Some(i) => result.push_str(&i.to_string()),
            None => result.push_str(inside),
        }
        result.push(']');
        rest = &rest[close + 1..];
    }
    result.push_str(rest);
    if result == name { format!("{name}[{k}]") } else { result }
}
