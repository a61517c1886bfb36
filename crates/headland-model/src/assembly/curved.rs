//! Balls that roll without slipping in or on a sphere or a cylinder.
//!
//! With c the ball's centre in the axes of the ground's frame, e the unit vector from the sphere's centre, or the
//! cylinder's axis z, towards c, and the normal n that points to the ball, `n = −e` inside and `n = e` outside:
//!
//! ```text
//! gap = ±(|s| − R) − r = 0,   gap′ = n·c′,   gap″ = n′·c′ + n·c″          s: c, or its part across the axis
//! c′ + w × p = 0,             p = −r n,      p′ = −r n′
//! ```
//! The gap's rate is the normal component of the second equation: one of the four rows follows from the others.

use headland_expr::{Expr, Scalar};
use headland_spatial::Vector;

use super::closures::Relative;
use super::number;
use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::scene::Data;
use crate::scene::Element as SceneElement;
use crate::symbols::Binding;

/// A sphere or cylinder on which a ball rolls.
pub(super) struct Ground<'g> {
    /// Which components of c count.
    across: [f64; 3],
    radius: Expr<'g>,
    /// −1 inside, 1 outside.
    side: f64,
}

impl<'g> Builder<'_, 'g> {
    /// The curved ground of an element; `None` for a plane.
    pub(super) fn curved_ground(&mut self, element: &SceneElement, binding: &Binding) -> Made<Option<Ground<'g>>> {
        let across = match element.get("surface").map(|v| (&v.data, v.place.clone())) {
            None => return Ok(None),
            Some((Data::Text(word), _)) if word == "plane" || word == "height" => return Ok(None),
            Some((Data::Text(word), _)) if word == "sphere" => [1.0, 1.0, 1.0],
            Some((Data::Text(word), _)) if word == "cylinder" => [1.0, 1.0, 0.0],
            Some((_, place)) => {
                return Err(self
                    .low
                    .report(place, "`surface` is \"plane\" (default), \"sphere\", \"cylinder\" or \"height\""));
            }
        };
        if ["axis", "semi_axes", "tube"].iter().any(|k| element.get(k).is_some()) {
            let message = "on a sphere or cylinder only a ball rolls: `radius` without `axis`, `tube` or `semi_axes`";
            return Err(self.low.report(element.place.clone(), message));
        }
        let Some(radius) = self.scalar_field(element, "surface_radius", binding, &Dimension::of(0, 1, 0))? else {
            return Err(self.low.report(element.place.clone(), "a sphere or cylinder needs `surface_radius`"));
        };
        let outside = matches!(element.get("outside").map(|v| &v.data), Some(Data::Flag(true)));
        Ok(Some(Ground { across, radius, side: if outside { 1.0 } else { -1.0 } }))
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
        let centre = [0, 1, 2].map(|i| relative.distance(i));
        let [c, c_rate, c_second] = [0, 1, 2].map(|order| Vector(centre.map(|row| row[order])));
        let across = |v: Vector<Expr<'g>>| Vector([0, 1, 2].map(|i| v[i] * number(ground.across[i])));
        let (s, s_rate) = (across(c), across(c_rate));
        let distance = s.squared_norm().sqrt();
        let e = s * (number(1.0) / distance);
        let e_rate = (s_rate - e * e.dot(s_rate)) * (number(1.0) / distance);
        let (n, n_rate) = (e * number(ground.side), e_rate * number(ground.side));
        let gap = number(ground.side) * (distance - ground.radius) - ball;
        let (p, p_rate) = (n * -ball, n_rate * -ball);
        let turning = relative.turning();
        let (w, w_rate) = (turning.apply(relative.spin()), turning.apply(relative.spin_rate()));
        let slip = c_rate + w.cross(p);
        let slip_rate = c_second + w_rate.cross(p) + w.cross(p_rate);
        let first = self.parts.kinematics.len();
        for i in 0..3 {
            self.bind_velocity(&format!("{name}.{}", ["x", "y", "z"][i]), [slip[i], slip_rate[i]], "", element);
        }
        let held = self.hold(
            &format!("{name}.gap"),
            [gap, n.dot(c_rate), n_rate.dot(c_rate) + n.dot(c_second)],
            &element.place,
        );
        let graph = self.low.graph;
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let mut constraints = vec![(first + i, graph.id(number(-1.0)))];
            constraints.extend(held.map(|row| (row, graph.id(-n[i]))));
            self.name_sum(format!("{name}.f{axis}"), constraints, false);
        }
    }
}
