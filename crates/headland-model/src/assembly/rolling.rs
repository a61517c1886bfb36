//! Rolling without slipping on a plane (balls on spheres and cylinders: `curved.rs`), and edges that do not slip sideways.
//!
//! A wheel, disc, ball or ellipsoid touches the plane `z = 0` of a frame, normal n, at p from its centre c. The point of
//! the body that is there at the moment stands still:
//!
//! ```text
//! c′ + w × p = 0,     n·(c + p) = 0,     rate of the first: c″ + w′ × p + w × p′
//! disc, axis a:       p = −r m/|m| − ρ n,     m = n − (n·a) a          (ρ: radius of the rim's section)
//! ellipsoid, axes A:  p = −A² n/√(n·A² n)     in axes of the body
//! ```
//! p moves in both bodies, so p′ is the rate of the *place* of contact, not `w × p`: taking the latter is the classical
//! mistake. The normal component of the first equation is the rate of the second.

use headland_expr::{Expr, Scalar};
use headland_spatial::{Rotation, Vector};

use super::closures::Relative;
use super::number;
use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::model::{KinematicRow, RowForm};
use crate::scene::Element as SceneElement;
use crate::symbols::Binding;

/// The form of what rolls.
enum Form<'g> {
    /// Centre circle of a rim and radius of its section; axis in the body.
    Disc { axis: Vector<Expr<'g>>, radius: Expr<'g>, tube: Expr<'g> },
    /// Squares of the semi-axes, along the body's axes.
    Ellipsoid([Expr<'g>; 3]),
    /// Radius.
    Ball(Expr<'g>),
}

/// Place of contact from the centre, its rate, and the height of the centre above the plane that belongs to it.
struct Contact<'g> {
    p: Vector<Expr<'g>>,
    p_rate: Vector<Expr<'g>>,
    height: Expr<'g>,
}

impl<'g> Builder<'_, 'g> {
    pub(super) fn rolling(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let body = self.frame_field(element, "body", &binding, None)?;
            let ground = self.frame_field(element, "on", &binding, Some(0))?;
            if self.carrier_of(body) == self.carrier_of(ground) {
                let message = format!("`{full}` rolls on the body that it belongs to");
                return Err(self.low.report(element.place.clone(), message));
            }
            let centre = self.pose_field(element, "center", "rpy", &binding)?;
            let form = self.rolling_form(element, &binding)?;
            let (Some(a), Some(b)) = (self.motion(ground), self.motion(body)) else { return Err(Reported) };
            let relative = Relative::new(&a, &b.fixed(&centre));
            if let (Some(curved), Form::Ball(radius)) = (self.curved_ground(element, ground, &binding)?, &form) {
                self.roll_on(&full, &relative, *radius, &curved, element);
                continue;
            }
            if let Form::Ball(radius) = &form
                && self.roll_on_height(&full, &relative, *radius, element, &binding)?
            {
                continue;
            }
            let contact = relative.contact(&form);
            let rows = relative.slip(&contact);
            for i in 0..2 {
                let axis = ["x", "y"][i];
                self.bind_velocity(&format!("{full}.{axis}"), rows[i], &format!("{full}.f{axis}"), element);
            }
            let [height, ..] = relative.distance(2);
            self.hold(&format!("{full}.z"), [height - contact.height, rows[2][0], rows[2][1]], &element.place);
            self.name_force(format!("{full}.fz"), Dimension::of(1, 1, -2));
        }
        Ok(())
    }

    fn rolling_form(&mut self, element: &SceneElement, binding: &Binding) -> Made<Form<'g>> {
        let length = Dimension::of(0, 1, 0);
        let place = |key: &str| element.get(key).map_or(element.place.clone(), |v| v.place.clone());
        if element.get("semi_axes").is_some() {
            self.without(element, &["radius", "axis", "tube"], "`semi_axes` make an ellipsoid")?;
            let axes = self.vector_field(element, "semi_axes", binding, &length, false)?;
            for axis in axes.0 {
                self.size(axis, "semi_axes", &place("semi_axes"), false)?;
            }
            return Ok(Form::Ellipsoid(axes.0.map(|a| a * a)));
        }
        let Some(radius) = self.scalar_field(element, "radius", binding, &length)? else {
            let message = "what rolls needs `radius` (a ball), `radius` and `axis` (a wheel or disc) or `semi_axes`";
            return Err(self.low.report(element.place.clone(), message));
        };
        self.size(radius, "radius", &place("radius"), false)?;
        if element.get("axis").is_none() {
            self.without(element, &["tube"], "a ball has none; a rim has an `axis`")?;
            return Ok(Form::Ball(radius));
        }
        let axis = Vector::constant(self.direction(element, "axis", binding, [0.0, 1.0, 0.0])?);
        let tube = self.scalar_field(element, "tube", binding, &length)?.unwrap_or(number(0.0));
        self.size(tube, "tube", &place("tube"), true)?;
        Ok(Form::Disc { axis, radius, tube })
    }

    /// A velocity that must be zero, with its rate.
    pub(super) fn bind_velocity(
        &mut self,
        name: &str,
        [velocity, rate]: [Expr<'g>; 2],
        force: &str,
        element: &SceneElement,
    ) {
        if velocity.is(0.0) {
            return;
        }
        let graph = self.low.graph;
        let row = KinematicRow::new(name, &element.place, RowForm::Zero(graph.id(velocity)));
        let row = KinematicRow { rate: Some(graph.id(rate)), may_be_redundant: true, ..row };
        self.parts.kinematics.push(row);
        if !force.is_empty() {
            self.name_force(force.into(), Dimension::of(1, 1, -2));
        }
    }

    /// A point of a body that has no velocity along a direction of the body.
    pub(super) fn skate(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let frame = self.frame_field(element, "on", &binding, None)?;
            let pose = self.pose_field(element, "at", "rpy", &binding)?;
            let side = Vector::constant(self.direction(element, "side", &binding, [0.0, 1.0, 0.0])?);
            let Some(motion) = self.motion(frame) else { return Err(Reported) };
            let m = motion.fixed(&pose);
            let rate = (m.acceleration - m.spin.cross(m.velocity)).dot(side);
            self.bind_velocity(&full, [m.velocity.dot(side), rate], &format!("{full}.force"), element);
        }
        Ok(())
    }
}

impl<'g> Relative<'g> {
    /// The slip velocity and its rate, by components in the plane's axes.
    fn slip(&self, contact: &Contact<'g>) -> [[Expr<'g>; 2]; 3] {
        let (w, w_rate) = (self.turning().apply(self.spin()), self.turning().apply(self.spin_rate()));
        let centre = [0, 1, 2].map(|i| self.distance(i));
        let velocity = Vector(centre.map(|[_, v, _]| v)) + w.cross(contact.p);
        let rate = Vector(centre.map(|[_, _, a]| a)) + w_rate.cross(contact.p) + w.cross(contact.p_rate);
        [0, 1, 2].map(|i| [velocity[i], rate[i]])
    }

    fn contact(&self, form: &Form<'g>) -> Contact<'g> {
        let n = Vector::constant([0.0, 0.0, 1.0]);
        match form {
            Form::Ball(radius) => Contact { p: n * -*radius, p_rate: Vector::constant([0.0; 3]), height: *radius },
            Form::Disc { axis, radius, tube } => {
                let w = self.turning().apply(self.spin());
                let a = self.turning().apply(*axis);
                let a_rate = w.cross(a);
                let m = n - a * a[2];
                let m_rate = -(a * a_rate[2] + a_rate * a[2]);
                let size = (number(1.0) - a[2] * a[2]).sqrt();
                // |m|′ = −a_z a_z′/|m|
                let unit = m * (number(1.0) / size);
                let unit_rate = (m_rate + unit * (a[2] * a_rate[2] / size)) * (number(1.0) / size);
                let p = unit * -*radius - n * *tube;
                Contact { p, p_rate: unit_rate * -*radius, height: *radius * size + *tube }
            }
            Form::Ellipsoid(squares) => {
                let turning: Rotation<Expr<'g>> = self.turning();
                let normal = turning.apply_inverse(n);
                let normal_rate = normal.cross(self.spin()); // n stands still in the plane
                let scaled = Vector([0, 1, 2].map(|i| squares[i] * normal[i]));
                let scaled_rate = Vector([0, 1, 2].map(|i| squares[i] * normal_rate[i]));
                let height = normal.dot(scaled).sqrt();
                let p = scaled * (number(-1.0) / height);
                let height_rate = normal_rate.dot(scaled) / height;
                let p_rate = -(scaled_rate + p * height_rate) * (number(1.0) / height);
                let p_rate = turning.apply(p_rate + self.spin().cross(p));
                Contact { p: turning.apply(p), p_rate, height }
            }
        }
    }
}
