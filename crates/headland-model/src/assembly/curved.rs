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

use headland_expr::{Expr, Scalar};
use headland_spatial::Vector;
use headland_surface::{Shape, Side};

use super::closures::Relative;
use super::number;
use super::rolling::unit;
use super::surfaces::Ground;
use super::touching::ONE_POINT;
use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::model::Guard;
use crate::scene::Data;
use crate::scene::Element as SceneElement;
use crate::symbols::Binding;

impl<'g> Builder<'_, 'g> {
    /// The curved ground of an element; `None` for a plane, and for a surface by its height.
    pub(super) fn curved_ground(
        &mut self,
        element: &SceneElement,
        ground: usize,
        binding: &Binding,
    ) -> Made<Option<Ground<'g>>> {
        let ground = self.ground_shape(element, ground, binding)?;
        Ok((!ground.is_plane()).then_some(ground))
    }

    /// The shape of the ground: that of its surface, or that which the element itself gives.
    pub(super) fn ground_shape(
        &mut self,
        element: &SceneElement,
        ground: usize,
        binding: &Binding,
    ) -> Made<Ground<'g>> {
        match self.shape_of(ground)? {
            Ground::Shape(Shape::Plane) => self.inline_shape(element, binding).map(Ground::Shape),
            ground => Ok(ground),
        }
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
        if let (Some(radius), Some(value)) = (radius, element.get("surface_radius")) {
            self.size(radius, "surface_radius", &value.place.clone(), false)?;
        }
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

    /// The rows of a ball on curved ground, and its contact force.
    pub(super) fn roll_on(
        &mut self,
        name: &str,
        relative: &Relative<'g>,
        ball: Expr<'g>,
        ground: &Ground<'g>,
        element: &SceneElement,
    ) {
        let touch = Touch::new(relative, ball, ground);
        self.watch_room(name, relative, ball, ground, false);
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
        let mut along: Vec<_> = (0..3).map(|i| (first + i, graph.id(-touch.normal[i]))).collect();
        along.extend(held.map(|row| (row, graph.id(number(-1.0)))));
        self.name_sum(format!("{name}.normal"), along, false);
    }
}

/// The part of the ball's radius within which a ball that is not yet on the surface counts as on it.
const NEAR: f64 = 1e-6;

impl<'g> Builder<'_, 'g> {
    /// A ball must be more curved than the hollow that it touches; where a field tells the distance, that is a matter of the
    /// place.
    ///
    /// ```text
    /// 1 + r κ > 0,    κ = k/(1 − d k)        k: least curvature of the parallel surface through the centre, of H
    /// ```
    pub(super) fn watch_room(
        &mut self,
        name: &str,
        relative: &Relative<'g>,
        ball: Expr<'g>,
        ground: &Ground<'g>,
        may_leave: bool,
    ) {
        if ground.field().is_none() || ground.facets().is_some() || ball.is(0.0) {
            return;
        }
        let c = Vector([0, 1, 2].map(|i| relative.distance(i)[0]));
        let columns = [0, 1, 2].map(|k| ground.normal_rate(c, unit(k)));
        let trace = columns[0][0] + columns[1][1] + columns[2][2];
        let square = columns[0].squared_norm() + columns[1].squared_norm() + columns[2].squared_norm();
        let spread = number(0.5) * square - number(0.25) * trace * trace;
        let least = number(0.5) * trace - spread.max(number(0.0)).sqrt();
        let distance = ground.distance(c);
        let room = number(1.0) + ball * least / (number(1.0) - distance * least);
        let away = distance - ball * number(1.0 + NEAR);
        let room = if may_leave { Expr::select(away, number(1.0), room) } else { room };
        self.parts.guards.push(Guard {
            name: format!("{name}.clearance"),
            quantity: self.low.graph.id(room),
            unit: String::new(),
            warn_below: None,
            stop_below: Some(ONE_POINT),
            message: format!(
                "the ball of `{name}` is hardly more curved there than the ground, or less (this is 1 - radius of the \
                 ball/radius of the ground): it would touch in more than one place"
            ),
        });
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
    /// Angular velocity of the ball.
    pub(super) spin: Vector<Expr<'g>>,
}

impl<'g> Touch<'g> {
    pub(super) fn new(relative: &Relative<'g>, ball: Expr<'g>, ground: &Ground<'g>) -> Self {
        let centre = [0, 1, 2].map(|i| relative.distance(i));
        let [c, c_rate, c_second] = [0, 1, 2].map(|order| Vector(centre.map(|row| row[order])));
        let (n, n_rate) = (ground.normal(c), ground.normal_rate(c, c_rate));
        let gap = [ground.distance(c) - ball, n.dot(c_rate), n_rate.dot(c_rate) + n.dot(c_second)];
        let (p, p_rate) = (n * -ball, n_rate * -ball);
        let [w, w_rate] = relative.turns();
        let slip = c_rate + w.cross(p);
        let slip_rate = c_second + w_rate.cross(p) + w.cross(p_rate);
        Self { normal: n, gap, slip: [slip, slip_rate], spin: w }
    }

    /// A component of the slip velocity and its rate.
    pub(super) fn slip_row(&self, i: usize) -> [Expr<'g>; 2] {
        [self.slip[0][i], self.slip[1][i]]
    }
}
