//! Balls that roll without slipping on a curved surface, inside or outside.
//!
//! With c the ball's centre in the axes of the surface, d its distance, n the normal that points to the ball and
//! H the gradient of n:
//!
//! ```text
//! gap = d(c) − r = 0,         gap′ = n·c′,   gap″ = n′·c′ + n·c″,   n′ = H c′
//! c′ + w × p = 0,             p = −r n,      p′ = −r n′
//! ```
//! The gap's rate is the normal component of the second equation: one of the four rows follows from the others.
//!
//! On a surface `z = f(s, t)` the place of contact has two coordinates of its own, which have no inertia:
//!
//! ```text
//! c = P(s, t) + r n(s, t),    P = (s, t, f),    n = (−f_s, −f_t, 1)/√(1 + f_s² + f_t²),    p = −r n
//! ```

use headland_expr::{Expr, NodeId, Scalar};
use headland_spatial::Vector;
use headland_surface::{Shape, Side};

use super::closures::Relative;
use super::number;
use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::scene::Data;
use crate::scene::Element as SceneElement;
use crate::symbols::{Binding, Members, Symbol};

/// Where a ball touches a surface given by its height: two coordinates of the contact, `name.s` and `name.t`.
const PLACES: [&str; 2] = ["s", "t"];

impl<'g> Builder<'_, 'g> {
    /// The curved ground of an element; `None` for a plane, and for a surface by its height.
    pub(super) fn curved_ground(
        &mut self,
        element: &SceneElement,
        ground: usize,
        binding: &Binding,
    ) -> Made<Option<Shape<Expr<'g>>>> {
        let shape = match self.shape_of(ground)? {
            Shape::Plane => self.inline_shape(element, binding)?,
            shape => shape,
        };
        if matches!(shape, Shape::Plane) {
            return Ok(None);
        }
        if ["axis", "semi_axes", "tube"].iter().any(|k| element.get(k).is_some()) {
            let message = "on a curved surface only a ball rolls: `radius` without `axis`, `tube` or `semi_axes`";
            return Err(self.low.report(element.place.clone(), message));
        }
        Ok(Some(shape))
    }

    /// The shape that an element itself gives to its ground.
    fn inline_shape(&mut self, element: &SceneElement, binding: &Binding) -> Made<Shape<Expr<'g>>> {
        let outside = matches!(element.get("outside").map(|v| &v.data), Some(Data::Flag(true)));
        let side = if outside { Side::Outside } else { Side::Inside };
        let (word, place) = match element.get("surface").map(|v| (&v.data, v.place.clone())) {
            None => return Ok(Shape::Plane),
            Some((Data::Text(word), _)) if word == "plane" || word == "height" => return Ok(Shape::Plane),
            Some((Data::Text(word), place)) => (word.as_str(), place),
            Some((_, place)) => ("", place),
        };
        let radius = self.scalar_field(element, "surface_radius", binding, &Dimension::of(0, 1, 0))?;
        match (word, radius) {
            ("sphere", Some(radius)) => Ok(Shape::Sphere { radius, side }),
            ("cylinder", Some(radius)) => Ok(Shape::Cylinder { radius, side }),
            ("sphere" | "cylinder", None) => {
                Err(self.low.report(element.place.clone(), "a sphere or cylinder needs `surface_radius`"))
            }
            _ => {
                let message = "`surface` is \"plane\" (default), \"sphere\", \"cylinder\" or \"height\"";
                Err(self.low.report(place, message))
            }
        }
    }

    /// Declares the coordinates of the places of contact on surfaces given by their height.
    pub(super) fn declare_places(&mut self) {
        for element in self.scene.section_elements("rolling") {
            if !is_height(element) {
                continue;
            }
            let Ok(name) = self.text_field(element, "name") else { continue };
            for binding in self.bindings_of(element).unwrap_or_default() {
                for part in PLACES {
                    let _ = self.declare_place(element, &bound_name(&name, &binding), part);
                }
            }
        }
    }

    fn declare_place(&mut self, element: &SceneElement, full: &str, part: &str) -> Made<()> {
        let (base, member) = self.split_name(full, &element.place)?;
        let family = format!("{base}.{part}");
        let position =
            self.low.add_coordinate(format!("{full}.{part}"), &Dimension::of(0, 1, 0), false, &element.place);
        self.low.coordinates[position].guess = Some(0.0);
        match self.low.symbols.by_name.get_mut(family.as_str()) {
            Some(Symbol::Coordinate(members)) => {
                members.insert(member, position);
            }
            _ => {
                let members = Members::family([(member, position)]);
                self.low.symbols.by_name.insert(family.as_str().into(), Symbol::Coordinate(members));
            }
        }
        Ok(())
    }

    /// The rows of a ball on a surface given by its height; false if the element has none.
    pub(super) fn roll_on_height(
        &mut self,
        name: &str,
        relative: &Relative<'g>,
        ball: Expr<'g>,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<bool> {
        if !is_height(element) {
            return Ok(false);
        }
        let Some(height) = self.scalar_field(element, "height", binding, &Dimension::of(0, 1, 0))? else {
            let message =
                format!("`surface = \"height\"` needs `height`: z by `{name}.s` and `{name}.t`, the place of contact");
            return Err(self.low.report(element.place.clone(), message));
        };
        let graph = self.low.graph;
        let found = |part: &str| self.low.coordinates.iter().find(|c| c.name == format!("{name}.{part}")).map(|c| c.q);
        let (Some(s), Some(t)) = (found("s"), found("t")) else { return Err(Reported) };
        let slope = |input: NodeId| {
            let slot = graph.node(input).args[0] as usize;
            graph.tangent(&[graph.id(height)], |i| (i == slot).then_some(number(1.0)))[0]
        };
        let (f_s, f_t) = (slope(s), slope(t));
        let length = (number(1.0) + f_s * f_s + f_t * f_t).sqrt();
        let n = Vector([-f_s / length, -f_t / length, number(1.0) / length]);
        let place = Vector([graph.expr(s), graph.expr(t), height]);
        let turning = relative.turning();
        let (c, c_rate) =
            (Vector([0, 1, 2].map(|i| relative.distance(i)[0])), Vector([0, 1, 2].map(|i| relative.distance(i)[1])));
        let gap = c - place - n * ball;
        let slip = c_rate + turning.apply(relative.spin()).cross(n * -ball);
        let rate =
            |b: &mut Self, e: Expr<'g>| b.low.time_derivative(e, 1).map_err(|m| b.low.report(element.place.clone(), m));
        let mut forces: [Vec<(usize, NodeId)>; 3] = Default::default();
        let against = graph.id(number(-1.0));
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let first = rate(self, gap[i])?;
            let second = rate(self, first)?;
            let row = self.hold(&format!("{name}.contact {axis}"), [gap[i], first, second], &element.place);
            forces[i].extend(row.map(|row| (row, against)));
        }
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let second = rate(self, slip[i])?;
            forces[i].push((self.parts.kinematics.len(), against));
            self.bind_velocity(&format!("{name}.{axis}"), [slip[i], second], "", element);
        }
        for (axis, constraints) in ["x", "y", "z"].into_iter().zip(forces) {
            self.name_sum(format!("{name}.f{axis}"), constraints, false);
        }
        Ok(true)
    }

    /// The rows of a ball on curved ground, and its contact force.
    pub(super) fn roll_on(
        &mut self,
        name: &str,
        relative: &Relative<'g>,
        ball: Expr<'g>,
        ground: &Shape<Expr<'g>>,
        element: &SceneElement,
    ) {
        let touch = Touch::new(relative, ball, ground);
        let first = self.parts.kinematics.len();
        for i in 0..3 {
            self.bind_velocity(&format!("{name}.{}", ["x", "y", "z"][i]), touch.slip_row(i), "", element);
        }
        let held = self.hold(&format!("{name}.gap"), touch.gap, &element.place);
        let graph = self.low.graph;
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let mut constraints = vec![(first + i, graph.id(number(-1.0)))];
            constraints.extend(held.map(|row| (row, graph.id(-touch.normal[i]))));
            self.name_sum(format!("{name}.f{axis}"), constraints, false);
        }
    }
}

/// How a ball and a surface meet, in the axes of the surface.
pub(super) struct Touch<'g> {
    /// From the surface to the ball.
    pub(super) normal: Vector<Expr<'g>>,
    /// Distance from the ball to the surface, with its rates.
    pub(super) gap: [Expr<'g>; 3],
    /// Velocity of the ball's point nearest to the surface, and its rate.
    pub(super) slip: [Vector<Expr<'g>>; 2],
}

impl<'g> Touch<'g> {
    pub(super) fn new(relative: &Relative<'g>, ball: Expr<'g>, ground: &Shape<Expr<'g>>) -> Self {
        let centre = [0, 1, 2].map(|i| relative.distance(i));
        let [c, c_rate, c_second] = [0, 1, 2].map(|order| Vector(centre.map(|row| row[order])));
        let (n, n_rate) = (ground.normal(c), ground.normal_rate(c, c_rate));
        let gap = [ground.distance(c) - ball, n.dot(c_rate), n_rate.dot(c_rate) + n.dot(c_second)];
        let (p, p_rate) = (n * -ball, n_rate * -ball);
        let turning = relative.turning();
        let (w, w_rate) = (turning.apply(relative.spin()), turning.apply(relative.spin_rate()));
        let slip = c_rate + w.cross(p);
        let slip_rate = c_second + w_rate.cross(p) + w.cross(p_rate);
        Self { normal: n, gap, slip: [slip, slip_rate] }
    }

    /// A component of the slip velocity and its rate.
    pub(super) fn slip_row(&self, i: usize) -> [Expr<'g>; 2] {
        [self.slip[0][i], self.slip[1][i]]
    }
}

fn is_height(element: &SceneElement) -> bool {
    matches!(element.get("surface"), Some(v) if v.data == Data::Text("height".into()))
}
