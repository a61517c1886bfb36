//! Fields of the assembly's elements: vectors, poses, references to frames, inertias.

use headland_expr::Expr;
use headland_expr::parse::{Program, parse, suggestion};
use headland_spatial::{Axis, Inertia, Pose, Rotation, Symmetric, Vector};

use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::place::Place;
use crate::scene::Element as SceneElement;
use crate::scene::{Data, Value};
use crate::symbols::{Binding, Members, Symbol, parse_key};

impl<'g> Builder<'_, 'g> {
    /// The members of an element: one for each value of the index that any of its texts uses.
    pub(super) fn bindings_of(&mut self, element: &SceneElement) -> Made<Vec<Binding>> {
        let mut programs: Vec<Program> = Vec::new();
        let mut values: Vec<&Value> = element.fields.iter().map(|f| &f.value).collect();
        while let Some(value) = values.pop() {
            match &value.data {
                Data::Array(items) => values.extend(items),
                Data::Text(text) => {
                    if let Ok(mut program) = parse(text) {
                        let _ = self.low.symbols.fold_lengths(&mut program);
                        programs.push(program);
                    }
                }
                _ => {}
            }
        }
        let programs: Vec<&Program> = programs.iter().collect();
        self.bindings(&programs, &element.place)
    }

    /// Registers a member of a family of frames or joints; gives its full name.
    pub(super) fn declare_member(
        &mut self,
        element: &SceneElement,
        name: &str,
        binding: &Binding,
        new: &str,
        position: usize,
    ) -> Made<String> {
        let place = element.get("name").map_or(element.place.clone(), |v| v.place.clone());
        let full = bound_name(name, binding);
        let (base, member) = self.split_name(&full, &place)?;
        if base == "system" {
            let message = format!("`system` stands for all bodies together and cannot name {new}");
            return Err(self.low.report(place, message));
        }
        match self.low.symbols.by_name.get_mut(base.as_str()) {
            Some(Symbol::Frame(_)) if new == "a joint" => self.free_name(&base, &place, new)?,
            Some(Symbol::Joint(_)) if new != "a joint" => self.free_name(&base, &place, new)?,
            Some(Symbol::Frame(members) | Symbol::Joint(members)) => {
                if !members.insert(member, position) {
                    return Err(self.low.report(place, format!("`{full}` is there twice")));
                }
            }
            _ => {
                self.free_name(&base, &place, new)?;
                let members = Members::family([(member, position)]);
                let symbol = if new == "a joint" { Symbol::Joint(members) } else { Symbol::Frame(members) };
                self.low.symbols.by_name.insert(base.as_str().into(), symbol);
            }
        }
        Ok(full)
    }

    /// `bogie[2]` as `bogie` and 2.
    pub(super) fn split_name(&mut self, full: &str, place: &Place) -> Made<(String, i64)> {
        let key = match parse_key(full) {
            Ok(key) if key.primes == 0 && !key.name.contains('.') => key,
            Ok(_) => return Err(self.low.report(place.clone(), format!("`{full}` is not a name"))),
            Err(message) => return Err(self.low.report(place.clone(), message)),
        };
        let member = match &key.index {
            None => 0,
            Some(index) => self.low.symbols.index_value(index, &[]).map_err(|m| self.low.report(place.clone(), m))?,
        };
        Ok((key.name, member))
    }

    /// Keys that mean nothing beside others: told rather than passed over.
    pub(super) fn without(&mut self, element: &SceneElement, keys: &[&str], why: &str) -> Made<()> {
        match keys.iter().find_map(|key| Some((key, element.get(key)?.place.clone()))) {
            Some((key, place)) => Err(self.low.report(place, format!("`{key}` means nothing here: {why}"))),
            None => Ok(()),
        }
    }

    /// A length that is made of parameters and positive, or at least not negative.
    pub(super) fn size(&mut self, length: Expr<'g>, key: &str, place: &Place, zero: bool) -> Made<Expr<'g>> {
        let message = match self.evaluate(length) {
            Some(x) if x > 0.0 || (zero && x == 0.0) => return Ok(length),
            Some(x) => format!("`{key}` is {x} m; it must be {}", if zero { "at least 0" } else { "above 0" }),
            None => format!("`{key}` must be made of numbers and parameters"),
        };
        Err(self.low.report(place.clone(), message))
    }

    /// The frame that a field names, or the default.
    pub(super) fn frame_field(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        default: Option<usize>,
    ) -> Made<usize> {
        let (text, place) = match (element.get(key), default) {
            (Some(Value { data: Data::Text(text), place }), _) => (text.clone(), place.clone()),
            (Some(other), _) => {
                let message = format!("`{key}` names a body or frame; found {}", other.data.kind());
                return Err(self.low.report(other.place.clone(), message));
            }
            (None, Some(default)) => return Ok(default),
            (None, None) => {
                return Err(self
                    .low
                    .report(element.place.clone(), format!("this element lacks `{key}`, a body or frame")));
            }
        };
        let mut key = parse_key(&text).map_err(|m| self.low.report(place.clone(), m))?;
        let bindings: Vec<_> = binding.iter().cloned().collect();
        let member = match &mut key.index {
            None => 0,
            Some(index) => {
                let _ = self.low.symbols.fold_lengths(index);
                self.low.symbols.index_value(index, &bindings).map_err(|m| self.low.report(place.clone(), m))?
            }
        };
        match self.low.symbols.by_name.get(key.name.as_str()) {
            Some(Symbol::Frame(members)) => match members.get(member) {
                Some(frame) => Ok(frame),
                None if key.index.is_none() => {
                    let count = members.iter().count();
                    let message = format!("`{0}` is a family of {count}; one of them is `{0}[k]`", key.name);
                    Err(self.low.report(place, message))
                }
                None => {
                    let full = match key.index {
                        Some(_) => format!("{}[{member}]", key.name),
                        None => key.name.clone(),
                    };
                    let message =
                        format!("`{full}` does not exist: `{}` has {} member(s)", key.name, members.iter().count());
                    Err(self.low.report(place, message))
                }
            },
            other => {
                let found = other.map_or("undefined", Symbol::kind);
                let frames = self.low.symbols.by_name.iter().filter(|(_, s)| matches!(s, Symbol::Frame(_)));
                let hint = suggestion(&key.name, frames.map(|(n, _)| &**n));
                Err(self.low.report(place, format!("`{}` is {found}, not a body or frame{hint}", key.name)))
            }
        }
    }

    /// An expression of a field with its dimension checked.
    pub(super) fn expression(
        &mut self,
        value: &Value,
        what: &str,
        binding: &Binding,
        dimension: &Dimension,
        angle: bool,
    ) -> Made<Expr<'g>> {
        let formula = self.formula_of(value)?;
        let typed = self.low.lower(&formula, binding)?;
        self.low.demand(&typed, dimension, angle, &formula, what)?;
        Ok(typed.expr)
    }

    /// A field's expression, if it is there.
    pub(super) fn scalar_field(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        dimension: &Dimension,
    ) -> Made<Option<Expr<'g>>> {
        match element.get(key) {
            Some(value) => self.expression(value, &format!("`{key}`"), binding, dimension, false).map(Some),
            None => Ok(None),
        }
    }

    /// Three components.
    pub(super) fn vector_value(
        &mut self,
        value: &Value,
        what: &str,
        binding: &Binding,
        dimension: &Dimension,
        angle: bool,
    ) -> Made<Vector<Expr<'g>>> {
        let items = self.array(value, what, &[3])?;
        let mut components = [Expr::Const(0.0); 3];
        for (c, item) in components.iter_mut().zip(&items) {
            *c = self.expression(item, &format!("a component of `{what}`"), binding, dimension, angle)?;
        }
        Ok(Vector(components))
    }

    pub(super) fn array(&mut self, value: &Value, what: &str, lengths: &[usize]) -> Made<Vec<Value>> {
        match &value.data {
            Data::Array(items) if lengths.contains(&items.len()) => Ok(items.clone()),
            other => {
                let found = match other {
                    Data::Array(items) => format!("{} of them", items.len()),
                    other => other.kind().to_string(),
                };
                let wanted: Vec<String> = lengths.iter().map(usize::to_string).collect();
                let message =
                    format!("`{what}` is a list of {} numbers or expressions; found {found}", wanted.join(" or "));
                Err(self.low.report(value.place.clone(), message))
            }
        }
    }

    /// A field's vector, or zero.
    pub(super) fn vector_field(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        dimension: &Dimension,
        angle: bool,
    ) -> Made<Vector<Expr<'g>>> {
        match element.get(key) {
            Some(value) => self.vector_value(value, key, binding, dimension, angle),
            None => Ok(Vector::constant([0.0; 3])),
        }
    }

    /// A pose by a position and roll, pitch, yaw.
    pub(super) fn pose_field(
        &mut self,
        element: &SceneElement,
        at: &str,
        rpy: &str,
        binding: &Binding,
    ) -> Made<Pose<Expr<'g>>> {
        let position = self.vector_field(element, at, binding, &Dimension::of(0, 1, 0), false)?;
        let [roll, pitch, yaw] = self.vector_field(element, rpy, binding, &Dimension::NONE, true)?.0;
        for (key, parts) in [(at, position.0), (rpy, [roll, pitch, yaw])] {
            for e in parts {
                if let Some(name) = self.depends(e, crate::depend::Kinds::PARAMETER.not()) {
                    let place = element.get(key).map_or(element.place.clone(), |v| v.place.clone());
                    let message = format!("`{key}` depends on `{name}`; a place on a body is made of parameters");
                    return Err(self.low.report(place, message));
                }
            }
        }
        Ok(Pose::new(Rotation::from_roll_pitch_yaw(roll, pitch, yaw), position))
    }

    /// A direction, as numbers of length one.
    pub(super) fn direction(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        default: [f64; 3],
    ) -> Made<[f64; 3]> {
        let Some(value) = element.get(key).cloned() else { return Ok(default) };
        if let Data::Text(text) = &value.data {
            let found = ["x", "y", "z", "-x", "-y", "-z"].iter().position(|n| n == text);
            if let Some(k) = found {
                let mut axis = [0.0; 3];
                axis[k % 3] = if k < 3 { 1.0 } else { -1.0 };
                return Ok(axis);
            }
            let message = format!("`{key}` is \"x\", \"y\", \"z\", \"-x\", .. or three numbers; found `{text}`");
            return Err(self.low.report(value.place, message));
        }
        let free = self.low.unifier.unknown();
        let components = self.vector_value(&value, key, binding, &free, false)?;
        let mut axis = [0.0; 3];
        for (x, e) in axis.iter_mut().zip(components.0) {
            match self.evaluate(e) {
                Some(number) => *x = number,
                None => {
                    return Err(self
                        .low
                        .report(value.place, format!("`{key}` must be made of numbers and parameters")));
                }
            }
        }
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length.is_nan() || length <= 0.0 {
            return Err(self.low.report(value.place, format!("`{key}` has no direction: its length is {length}")));
        }
        Ok(axis.map(|x| x / length))
    }

    /// Mass, mass centre and tensor about it, by entries or by a shape.
    #[allow(clippy::type_complexity)]
    pub(super) fn inertia_fields(
        &mut self,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<(Expr<'g>, Vector<Expr<'g>>, Symmetric<Expr<'g>>)> {
        let mass = self.scalar_field(element, "mass", binding, &Dimension::of(1, 0, 0))?.unwrap_or(Expr::Const(0.0));
        let centre = self.vector_field(element, "center", binding, &Dimension::of(0, 1, 0), false)?;
        let tensor = match (element.get("inertia").cloned(), element.get("shape")) {
            (Some(_), Some(shape)) => {
                let place = shape.place.clone();
                return Err(self.low.report(place, "give `inertia` or `shape`, not both"));
            }
            (Some(value), None) => self.tensor_value(&value, binding)?,
            (None, Some(_)) => self.shape(element, mass, binding)?,
            (None, None) => Symmetric::zero(),
        };
        for e in [mass].into_iter().chain(centre.0).chain(tensor.0) {
            if let Some(name) = self.depends(e, crate::depend::Kinds::PARAMETER.not()) {
                let message = format!("mass, centre and inertia are made of parameters, not of `{name}`");
                return Err(self.low.report(element.place.clone(), message));
            }
        }
        self.check_inertia(element, binding, mass, tensor)?;
        Ok((mass, centre, tensor))
    }

    /// Three principal moments or six entries.
    pub(super) fn tensor_value(&mut self, value: &Value, binding: &Binding) -> Made<Symmetric<Expr<'g>>> {
        let items = self.array(value, "inertia", &[3, 6])?;
        let mut entries = [Expr::Const(0.0); 6];
        for (e, item) in entries.iter_mut().zip(&items) {
            *e = self.expression(item, "an entry of `inertia`", binding, &Dimension::of(1, 2, 0), false)?;
        }
        Ok(Symmetric(entries))
    }

    fn check_inertia(
        &mut self,
        element: &SceneElement,
        binding: &Binding,
        mass: Expr<'g>,
        tensor: Symmetric<Expr<'g>>,
    ) -> Made<()> {
        let numbers: Option<Vec<f64>> = [mass].into_iter().chain(tensor.0).map(|e| self.evaluate(e)).collect();
        let [of_mass, of_inertia] = ["mass", "inertia"].map(|key| element.get(key));
        let negative = self.evaluate(mass).is_some_and(|m| m < 0.0);
        let place = if negative { of_mass.or(of_inertia) } else { of_inertia.or(of_mass) };
        let place = place.map_or(element.place.clone(), |v| v.place.clone());
        let name = element.get("name").map(|v| v.data.clone());
        let name = if let Some(Data::Text(name)) = name { bound_name(&name, binding) } else { String::new() };
        let Some(n) = numbers else {
            return Err(self.low.report(place, format!("mass or inertia of `{name}` is not a finite number")));
        };
        let tensor = Symmetric::new(n[1], n[2], n[3], n[4], n[5], n[6]);
        if n[0] == 0.0 {
            return if tensor.0 == [0.0; 6] || tensor.0.iter().all(|x| *x >= 0.0) {
                Ok(()) // a rotor's or a massless part's
            } else {
                Err(self.low.report(place, format!("the inertia of `{name}` has a negative entry and no mass")))
            };
        }
        match Inertia::new(n[0], Vector::zero(), tensor).check() {
            Ok(()) => Ok(()),
            Err(error) => Err(self.low.report(place, format!("the body `{name}` cannot exist: {error}"))),
        }
    }

    fn shape(&mut self, element: &SceneElement, mass: Expr<'g>, binding: &Binding) -> Made<Symmetric<Expr<'g>>> {
        let Some(Value { data: Data::Text(shape), place }) = element.get("shape").cloned() else {
            return Err(Reported);
        };
        let axis = match self.direction(element, "axis", binding, [0.0, 0.0, 1.0])? {
            [x, 0.0, 0.0] if x.abs() == 1.0 => Axis::X,
            [0.0, y, 0.0] if y.abs() == 1.0 => Axis::Y,
            [0.0, 0.0, z] if z.abs() == 1.0 => Axis::Z,
            _ => return Err(self.low.report(element.place.clone(), "the axis of a shape is \"x\", \"y\" or \"z\"")),
        };
        let shapes: [(&str, usize); 8] = [
            ("box", 3),
            ("cylinder", 2),
            ("sphere", 1),
            ("spherical shell", 1),
            ("rod", 1),
            ("disc", 1),
            ("ring", 1),
            ("ellipsoid", 3),
        ];
        let Some((_, count)) = shapes.iter().find(|(n, _)| *n == shape) else {
            let hint = suggestion(&shape, shapes.iter().map(|(n, _)| *n));
            let known: Vec<&str> = shapes.iter().map(|(n, _)| *n).collect();
            return Err(self.low.report(place, format!("unknown shape `{shape}`{hint}; known: {}", known.join(", "))));
        };
        let size = match element.get("size").cloned() {
            Some(value) => {
                let items = match &value.data {
                    Data::Array(_) => self.array(&value, "size", &[*count])?,
                    _ if *count == 1 => vec![value],
                    _ => self.array(&value, "size", &[*count])?,
                };
                let length = Dimension::of(0, 1, 0);
                let mut sizes = Vec::new();
                for item in &items {
                    let size = self.expression(item, "`size`", binding, &length, false)?;
                    sizes.push(self.size(size, "size", &item.place, false)?);
                }
                sizes
            }
            None => {
                return Err(self
                    .low
                    .report(element.place.clone(), format!("a {shape} needs `size`: {count} length(s)")));
            }
        };
        let inertia = match shape.as_str() {
            "box" => Inertia::solid_box(mass, size[0], size[1], size[2]),
            "cylinder" => Inertia::solid_cylinder(mass, size[0], size[1], axis),
            "sphere" => Inertia::solid_sphere(mass, size[0]),
            "spherical shell" => Inertia::spherical_shell(mass, size[0]),
            "rod" => Inertia::rod(mass, size[0], axis),
            "disc" => Inertia::disc(mass, size[0], axis),
            "ring" => Inertia::ring(mass, size[0], axis),
            _ => Inertia::solid_ellipsoid(mass, size[0], size[1], size[2]),
        };
        Ok(inertia.tensor)
    }
}
