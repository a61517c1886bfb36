//! `[[surface]]`: what bodies roll on or touch, each in a frame of its own.
//!
//! In closed form or by a field of signed distance: [`Ground`] answers both alike.

use std::sync::Arc;

use headland_expr::{Expr, Field, Frozen, Graph, NodeId, Scalar, field_part};
use headland_spatial::Vector;
use headland_surface::{Ellipsoid, Formula, Height, Profile, Revolution, Shape, ShapeError, Side};

use super::facets::FacetErrors;
use super::number;
use crate::build::{Builder, Made};
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::scene::{Data, Element as SceneElement};
use crate::symbols::{Binding, Symbol};

/// Shapes and the keys that each has.
const SHAPES: [(&str, &[&str]); 9] = [
    ("plane", &[]),
    ("sphere", &["radius", "inside"]),
    ("cylinder", &["radius", "inside"]),
    ("cone", &["half_angle", "inside"]),
    ("torus", &["radius", "tube", "inside"]),
    ("ellipsoid", &["semi_axes", "inside"]),
    ("revolution", &["profile", "range", "inside"]),
    ("height", &["height"]),
    ("mesh", &["file", "table", "radius", "density", "inside", "open", "smooth"]),
];

/// A surface, in the axes of its frame.
#[derive(Clone)]
pub(super) enum Ground<'g> {
    /// In closed form.
    Shape(Shape<Expr<'g>>),
    /// By a field of signed distance.
    Field(Arc<dyn Field>, Kind<'g>),
}

/// What is known beside the distance.
#[derive(Clone)]
pub(super) enum Kind<'g> {
    /// A height of two inputs of the graph.
    Height(HeightOf<'g>),
    /// Smooth, with the radius of the largest ball that fits everywhere, m.
    Smooth(f64),
    /// Triangles.
    Facets(FacetErrors),
}

/// A height and the two inputs, x and y, that it is made of.
#[derive(Clone, Copy)]
pub(super) struct HeightOf<'g> {
    height: Expr<'g>,
    at: [NodeId; 2],
}

impl<'g> HeightOf<'g> {
    /// The height at another place.
    pub(super) fn with(&self, graph: &'g Graph, [x, y]: [Expr<'g>; 2]) -> Expr<'g> {
        let [a, b] = self.at.map(|id| graph.node(id).args[0] as usize);
        let by = |i: usize| if i == a { Some(x) } else { (i == b).then_some(y) };
        graph.substitute(&[graph.id(self.height)], by)[0]
    }
}

impl<'g> Ground<'g> {
    /// The plane z = 0.
    pub(super) const PLANE: Self = Ground::Shape(Shape::Plane);

    pub(super) fn is_plane(&self) -> bool {
        matches!(self, Ground::Shape(Shape::Plane))
    }

    /// The field of distance, where it is no closed form.
    pub(super) fn field(&self) -> Option<&Arc<dyn Field>> {
        match self {
            Ground::Shape(_) => None,
            Ground::Field(field, _) => Some(field),
        }
    }

    /// Of triangles, with their errors.
    #[cfg_attr(not(feature = "mesh"), expect(dead_code, reason = "only parry makes triangles"))]
    pub(super) fn of_facets(field: Arc<dyn Field>, errors: FacetErrors) -> Self {
        Ground::Field(field, Kind::Facets(errors))
    }

    /// What triangles may be wrong by; none for what is smooth.
    pub(super) fn facets(&self) -> Option<&FacetErrors> {
        match self {
            Ground::Field(_, Kind::Facets(errors)) => Some(errors),
            _ => None,
        }
    }

    /// Signed distance of a point, m.
    pub(super) fn distance(&self, c: Vector<Expr<'g>>) -> Expr<'g> {
        match self {
            Ground::Shape(shape) => shape.distance(c),
            Ground::Field(field, _) => Expr::field(c.0, field, 0),
        }
    }

    /// Unit normal at the point nearest to `c`, towards the free side: the gradient of the distance.
    pub(super) fn normal(&self, c: Vector<Expr<'g>>) -> Vector<Expr<'g>> {
        match self {
            Ground::Shape(shape) => shape.normal(c),
            Ground::Field(field, _) => Vector(
                [field_part(1, 0, 0), field_part(0, 1, 0), field_part(0, 0, 1)].map(|k| Expr::field(c.0, field, k)),
            ),
        }
    }

    /// Rate of the normal where `c` moves with `v`: the second derivatives of the distance times `v`.
    pub(super) fn normal_rate(&self, c: Vector<Expr<'g>>, v: Vector<Expr<'g>>) -> Vector<Expr<'g>> {
        match self {
            Ground::Shape(shape) => shape.normal_rate(c, v),
            Ground::Field(field, _) => Vector([0, 1, 2].map(|i| {
                let entry = |k: usize| {
                    let times = |axis: usize| usize::from(i == axis) + usize::from(k == axis);
                    Expr::field(c.0, field, field_part(times(0), times(1), times(2))) * v[k]
                };
                entry(0) + entry(1) + entry(2)
            })),
        }
    }
}

impl<'g> Builder<'_, 'g> {
    /// The surface that stands in a frame; the plane `z = 0` for a frame or body that is no surface.
    pub(super) fn shape_of(&mut self, frame: usize) -> Made<Ground<'g>> {
        if !self.assembly.frames[frame].is_surface {
            return Ok(Ground::PLANE);
        }
        let Some((element, binding)) = self.assembly.frames[frame].element.clone() else { return Ok(Ground::PLANE) };
        let name = self.assembly.frames[frame].name.clone();
        let word = self.text_field(element, "shape")?;
        let place = element.get("shape").map_or(&element.place, |v| &v.place).clone();
        let Some((_, keys)) = SHAPES.iter().find(|(shape, _)| *shape == word) else {
            let known: Vec<&str> = SHAPES.iter().map(|(shape, _)| *shape).collect();
            let message = format!("unknown shape \"{word}\"; known: {}", known.join(", "));
            return Err(self.low.report(place, message));
        };
        for (key, shape) in SHAPES.iter().flat_map(|(shape, keys)| keys.iter().map(move |key| (key, shape))) {
            if !keys.contains(key) {
                let why = match *key {
                    "inside" => format!("the shape is \"{word}\", which has its free side above"),
                    _ => format!("the shape is \"{word}\"; it belongs to \"{shape}\""),
                };
                self.without(element, &[key], &why)?;
            }
        }
        let is_inside = matches!(element.get("inside").map(|v| &v.data), Some(Data::Flag(true)));
        let side = if is_inside { Side::Inside } else { Side::Outside };
        let length = |b: &mut Self, key: &str| b.length(element, key, &binding);
        let shape = match word.as_str() {
            "sphere" => Shape::Sphere { radius: length(self, "radius")?, side },
            "cylinder" => Shape::Cylinder { radius: length(self, "radius")?, side },
            "cone" => Shape::Cone { half_angle: self.half_angle(element, &binding)?, side },
            "torus" => Shape::Torus { radius: length(self, "radius")?, tube: length(self, "tube")?, side },
            "ellipsoid" => return self.ellipsoid(&name, element, &binding, side),
            "revolution" => return self.revolution(&name, element, &binding, side),
            "height" => return self.height(&name, element, &binding),
            "mesh" => return self.triangles(&name, element, &binding),
            _ => Shape::Plane,
        };
        match self.in_numbers(&shape).check() {
            Ok(()) => Ok(Ground::Shape(shape)),
            Err(error) => Err(self.low.report(place, error.to_string())),
        }
    }

    /// A length above zero, made of numbers and parameters.
    pub(super) fn length(&mut self, element: &SceneElement, key: &str, binding: &Binding) -> Made<Expr<'g>> {
        let Some(length) = self.scalar_field(element, key, binding, &Dimension::of(0, 1, 0))? else {
            return Err(self.lacks(element, &format!("`{key}`")));
        };
        let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
        self.size(length, key, &place, false)
    }

    pub(super) fn lacks(&mut self, element: &SceneElement, what: &str) -> crate::lower::Reported {
        self.low.report(element.place.clone(), format!("this surface needs {what}"))
    }

    fn half_angle(&mut self, element: &SceneElement, binding: &Binding) -> Made<Expr<'g>> {
        let Some(value) = element.get("half_angle") else {
            return Err(self.lacks(element, "`half_angle`, between its axis and its side"));
        };
        let angle = self.expression(value, "`half_angle`", binding, &Dimension::NONE, true)?;
        match self.evaluate(angle) {
            Some(_) => Ok(angle),
            None => Err(self.low.report(value.place.clone(), "`half_angle` must be made of numbers and parameters")),
        }
    }

    /// Sizes as numbers.
    fn in_numbers(&mut self, shape: &Shape<Expr<'g>>) -> Shape<f64> {
        let mut x = |e: Expr<'g>| self.evaluate(e).unwrap_or(f64::NAN);
        match *shape {
            Shape::Plane => Shape::Plane,
            Shape::Sphere { radius, side } => Shape::Sphere { radius: x(radius), side },
            Shape::Cylinder { radius, side } => Shape::Cylinder { radius: x(radius), side },
            Shape::Cone { half_angle, side } => Shape::Cone { half_angle: x(half_angle), side },
            Shape::Torus { radius, tube, side } => Shape::Torus { radius: x(radius), tube: x(tube), side },
        }
    }

    fn ellipsoid(&mut self, name: &str, element: &SceneElement, binding: &Binding, side: Side) -> Made<Ground<'g>> {
        let Some(value) = element.get("semi_axes") else {
            return Err(self.lacks(element, "`semi_axes = [a, b, c]`, along x, y and z"));
        };
        let place = value.place.clone();
        let axes = self.vector_field(element, "semi_axes", binding, &Dimension::of(0, 1, 0), false)?.0;
        let mut numbers = [0.0; 3];
        for (x, e) in numbers.iter_mut().zip(axes) {
            self.size(e, "semi_axes", &place, false)?;
            *x = self.evaluate(e).unwrap_or(f64::NAN);
        }
        let made = Ellipsoid::new(name, numbers, side).map_err(|e| self.low.report(place, e.to_string()))?;
        let [least, most] =
            [numbers.into_iter().fold(f64::INFINITY, f64::min), numbers.into_iter().fold(0.0, f64::max)];
        let room = if side == Side::Inside { least * least / most } else { f64::INFINITY };
        Ok(Ground::Field(Arc::new(made), Kind::Smooth(room)))
    }

    /// A profile in `r`, its height, or in `z`, its radius.
    fn revolution(&mut self, name: &str, element: &SceneElement, binding: &Binding, side: Side) -> Made<Ground<'g>> {
        if element.get("profile").is_none() {
            return Err(self.lacks(element, "`profile`: its height by `r`, or its radius by `z`"));
        }
        let place = element.get("profile").map_or(&element.place, |v| &v.place).clone();
        let range = self.range(element, binding)?;
        let (profile, [r, z]) = self.expression_of(name, element, "profile", ["r", "z"], binding)?;
        let graph = self.low.graph;
        let uses = |id: NodeId| graph.depends(&[graph.id(profile)], |i| i == graph.node(id).args[0] as usize)[0];
        let (by_radius, by_z) = (uses(r), uses(z));
        if by_radius && by_z {
            let message = "`profile` is a height made of `r`, or a radius made of `z`, not of both";
            return Err(self.low.report(place, message));
        }
        if by_radius {
            self.without(element, &["inside"], "a profile by `r` has its free side above")?;
        }
        let (own, [profile, input, _]) = self.apart([profile, graph.expr(if by_radius { r } else { z }), number(0.0)]);
        let function = derivatives(&own, profile, input);
        let made = if by_radius {
            Revolution::of_height(name, function, range)
        } else {
            Revolution::of_radius(name, function, range, side)
        };
        let made = made.map_err(|e| self.low.report(place, e.to_string()))?;
        Ok(Ground::Field(Arc::new(made), Kind::Smooth(f64::INFINITY)))
    }

    fn range(&mut self, element: &SceneElement, binding: &Binding) -> Made<[f64; 2]> {
        let Some(value) = element.get("range") else {
            return Err(self.lacks(element, "`range = [from, to]` of its profile"));
        };
        let items = self.array(value, "range", &[2])?;
        let mut range = [0.0; 2];
        for (x, item) in range.iter_mut().zip(&items) {
            let e = self.expression(item, "an end of `range`", binding, &Dimension::of(0, 1, 0), false)?;
            let Some(number) = self.evaluate(e) else {
                return Err(self.low.report(item.place.clone(), "`range` must be made of numbers and parameters"));
            };
            *x = number;
        }
        Ok(range)
    }

    /// A height in `x` and `y`: in the equations of rolling as it is, elsewhere by its distance, with the parameters as they
    /// are now.
    fn height(&mut self, name: &str, element: &SceneElement, binding: &Binding) -> Made<Ground<'g>> {
        if element.get("height").is_none() {
            return Err(self.lacks(element, "`height`: its z by `x` and `y`"));
        }
        let (height, at) = self.expression_of(name, element, "height", ["x", "y"], binding)?;
        let graph = self.low.graph;
        let (own, [root, x, y]) = self.apart([height, graph.expr(at[0]), graph.expr(at[1])]);
        let distance = Height::new(Arc::new(Formula::new(name, &own, root, [x, y])));
        Ok(Ground::Field(Arc::new(distance), Kind::Height(HeightOf { height, at })))
    }

    /// An expression in which two names are lengths of the surface's own, whatever they are elsewhere.
    fn expression_of(
        &mut self,
        name: &str,
        element: &SceneElement,
        key: &str,
        own: [&str; 2],
        binding: &Binding,
    ) -> Made<(Expr<'g>, [NodeId; 2])> {
        let graph = self.low.graph;
        let length = Dimension::of(0, 1, 0);
        let at = own.map(|of| self.low.dependence.input(graph, &format!("{name}.{of}"), Kinds::PARAMETER));
        let before = [0, 1].map(|i| {
            let symbol = Symbol::Parameter(vec![(at[i], length.clone(), false)], false);
            self.low.symbols.by_name.insert(own[i].into(), symbol)
        });
        let made = self.scalar_field(element, key, binding, &length);
        for (of, symbol) in own.into_iter().zip(before) {
            match symbol {
                Some(symbol) => self.low.symbols.by_name.insert(of.into(), symbol),
                None => self.low.symbols.by_name.shift_remove(of),
            };
        }
        let made = made?.unwrap_or(number(0.0));
        if let Some(input) = self.depends(made, Kinds::PARAMETER.not()) {
            let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
            let message = format!(
                "`{key}` depends on `{input}`; it is made of `{}`, `{}` and parameters (a ground that moves stands on a \
                 body or frame: `on`)",
                own[0], own[1]
            );
            return Err(self.low.report(place, message));
        }
        Ok((made, at))
    }

    /// An expression and two inputs in a graph of their own, with parameters as numbers.
    fn apart(&mut self, [root, first, second]: [Expr<'g>; 3]) -> (Graph, [NodeId; 3]) {
        let (graph, own) = (self.low.graph, Graph::new());
        let inputs = [first, second].map(|e| (graph.node(graph.id(e)).args[0] as usize, e.value().is_none()));
        let ids = {
            let copies = [own.input("first"), own.input("second")];
            let by = |slot: usize| match inputs.iter().position(|&(i, is_input)| is_input && i == slot) {
                Some(k) => copies[k],
                None => {
                    let parameter = self.parts.parameters.iter().find(|p| p.input == slot);
                    Expr::constant(parameter.map_or(f64::NAN, |p| p.value))
                }
            };
            let made = graph.rebuild(&[graph.id(root)], &own, by)[0];
            [own.id(made), own.id(copies[0]), own.id(copies[1])]
        };
        (own, ids)
    }

    /// Refuses a ball that touches a recess in more than one place, or does not fit into it.
    pub(super) fn check_fit(&mut self, ball: Expr<'g>, ground: &Ground<'g>, element: &SceneElement) -> Made<()> {
        let Some(ball) = self.evaluate(ball).filter(|r| *r > 0.0) else { return Ok(()) };
        let fits = match ground {
            Ground::Shape(shape) => self.in_numbers(shape).fits(ball),
            Ground::Field(_, Kind::Smooth(room)) if ball >= *room => {
                Err(ShapeError::TooLarge { shape: "ellipsoid's sharpest bend", ball, room: *room })
            }
            _ => Ok(()),
        };
        let place = element.get("radius").map_or(&element.place, |v| &v.place).clone();
        fits.map_err(|error| self.low.report(place, error.to_string()))
    }
}

/// A function of one input of a graph with its first three derivatives.
fn derivatives(graph: &Graph, root: NodeId, input: NodeId) -> Profile {
    let slot = graph.node(input).args[0] as usize;
    let mut parts = vec![root];
    for order in 0..3 {
        let next = graph.tangent(&[parts[order]], |i| (i == slot).then_some(Expr::constant(1.0)))[0];
        parts.push(graph.id(next));
    }
    let frozen = Frozen::new(graph, &parts);
    Box::new(move |at| {
        let all = frozen.eval(4, &[at, at]);
        [all[0], all[1], all[2], all[3]]
    })
}
