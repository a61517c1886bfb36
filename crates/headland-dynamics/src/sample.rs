//! States at which derivations are compared and structures examined: the start, and points spread about it.

use headland_expr::NodeId;
use headland_model::{Element, Model, Place, RowForm};

/// The inputs of the graph at the model's start: parameters, time and initial coordinates; velocities zero.
pub fn start_inputs(model: &Model) -> Vec<f64> {
    let mut inputs = model.inputs();
    inputs[model.input_index(model.time)] = model.run.from;
    for c in &model.coordinates {
        inputs[model.input_index(c.q)] = c.guess.unwrap_or(0.0);
    }
    let coordinates: Vec<_> = model.coordinates.iter().filter_map(|c| Some((c.q, c.initial?))).collect();
    let quasi: Vec<_> = model.quasi_velocities.iter().filter_map(|u| Some((u.u, u.initial?))).collect();
    for given in [coordinates, quasi] {
        let values = model.graph.eval(&given.iter().map(|(_, initial)| *initial).collect::<Vec<_>>(), &inputs);
        for ((input, _), value) in given.iter().zip(values) {
            inputs[model.input_index(*input)] = value;
        }
    }
    inputs
}

/// The first definition, value or structure of an element, or constraint, that is not finite at the given inputs, with its
/// place; then the given further rates of structures, one an element.
pub fn first_not_finite(model: &Model, structure_rates: &[NodeId], inputs: &[f64]) -> Option<String> {
    let at = |place: &Place| model.source.locate(place);
    if let Some(hazard) = model.hazard(inputs) {
        return Some(format!("{} ({})", hazard.message, at(&hazard.place)));
    }
    let definitions = model.definitions.iter().map(|d| (format!("`{}` ({})", d.name, at(&d.place)), d.node));
    let of = |what: &str, e: &Element| format!("the {what} of `{}` ({})", e.name, at(&e.place));
    let values = model.elements.iter().map(|e| (of("value", e), e.value));
    let structures = model.elements.iter().map(|e| (of("structure", e), e.structure));
    let rates = model.elements.iter().zip(structure_rates).map(|(e, r)| (of("structure's rate", e), *r));
    let rows = model.kinematics.iter().flat_map(|r| {
        let (RowForm::Rate(_, node) | RowForm::Zero(node)) = r.form;
        let name = format!("the constraint `{}` ({})", r.name, at(&r.place));
        r.position.into_iter().chain([node]).map(move |n| (name.clone(), n))
    });
    let all: Vec<(String, NodeId)> = definitions.chain(values).chain(structures).chain(rows).chain(rates).collect();
    let found = model.graph.eval(&all.iter().map(|(_, n)| *n).collect::<Vec<_>>(), inputs);
    let first = found.iter().position(|x| !x.is_finite())?;
    Some(format!("{} is {}", all[first].0, found[first]))
}

/// Numbers in (−1, 1), evenly spread: multiples of irrational numbers. The same on every machine.
pub struct Spread(u32);

impl Spread {
    /// The `k`-th sequence.
    pub fn new(k: u32) -> Self {
        Self(k.wrapping_mul(7919))
    }

    /// The next number.
    pub fn next_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        let x = f64::from(self.0) * 0.618_033_988_749_894_9 + f64::from(self.0 % 17) * 0.324_717_957_244_746;
        2.0 * (x - x.floor()) - 1.0
    }
}

/// The `k`-th state about the start: coordinates moved by up to half a unit, velocities by up to one.
pub fn spread_inputs(model: &Model, k: u32) -> Vec<f64> {
    let mut inputs = start_inputs(model);
    let mut spread = Spread::new(k + 1);
    inputs[model.input_index(model.time)] += spread.next_number().abs() * (model.run.until - model.run.from);
    for c in &model.coordinates {
        inputs[model.input_index(c.q)] += 0.5 * spread.next_number() * c.scale;
        inputs[model.input_index(c.rate)] += spread.next_number() * c.scale;
        inputs[model.input_index(c.acceleration)] += spread.next_number() * c.scale;
    }
    for u in &model.quasi_velocities {
        inputs[model.input_index(u.u)] += spread.next_number() * u.scale;
        inputs[model.input_index(u.acceleration)] += spread.next_number() * u.scale;
    }
    inputs
}
