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

use super::closures::{Relative, Row};
use super::number;
use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::model::{KinematicRow, RowForm};
use crate::scene::Data;
use crate::scene::Element as SceneElement;
use crate::symbols::Binding;

/// The form of what rolls.
pub(super) enum Form<S> {
    /// Centre circle of a rim and radius of its section; axis in the body.
    Disc { axis: Vector<S>, radius: S, tube: S },
    /// Squares of the semi-axes, along the body's axes.
    Ellipsoid([S; 3]),
    /// Radius.
    Ball(S),
}

impl<S: Scalar> Form<S> {
    /// The same in other numbers.
    pub(super) fn map<T>(&self, f: impl Fn(S) -> T) -> Form<T> {
        match self {
            Form::Ball(radius) => Form::Ball(f(*radius)),
            Form::Disc { axis, radius, tube } => Form::Disc { axis: axis.map(&f), radius: f(*radius), tube: f(*tube) },
            Form::Ellipsoid(squares) => Form::Ellipsoid(squares.map(f)),
        }
    }

    /// The radius of a ball or disc.
    pub(super) fn reach(&self) -> Option<S> {
        match self {
            Form::Ball(radius) => Some(*radius),
            Form::Disc { radius, tube, .. } => Some(*radius + *tube),
            Form::Ellipsoid(_) => None,
        }
    }

    /// Directions of a disc on ground with the normal n: its heading, along which the wheel's plane and the ground meet, and
    /// across it.
    pub(super) fn heading_on(&self, turning: &Rotation<S>, n: Vector<S>) -> Option<[Vector<S>; 2]> {
        let Form::Disc { axis, .. } = self else { return None };
        let heading = turning.apply(*axis).cross(n).unit();
        Some([heading, n.cross(heading)])
    }

    /// The place, from the centre, where the outward normal is −n; in the ground's axes, which `turning` goes to.
    pub(super) fn touching(&self, turning: &Rotation<S>, n: Vector<S>) -> Vector<S> {
        match self {
            Form::Ball(radius) => n * -*radius,
            Form::Disc { axis, radius, tube } => {
                let a = turning.apply(*axis);
                let m = n - a * n.dot(a);
                m * (-*radius / m.norm()) - n * *tube
            }
            Form::Ellipsoid(squares) => {
                let normal = turning.apply_inverse(n);
                let scaled = Vector([0, 1, 2].map(|i| squares[i] * normal[i]));
                turning.apply(scaled * (S::constant(-1.0) / normal.dot(scaled).sqrt()))
            }
        }
    }

    /// `B v`: minus the change of that place where n changes with v, a tangent.
    pub(super) fn flattened(&self, turning: &Rotation<S>, n: Vector<S>, v: Vector<S>) -> Vector<S> {
        match self {
            Form::Ball(radius) => v * *radius,
            Form::Disc { axis, radius, tube } => {
                let g = turning.apply(*axis).cross(n);
                g * (*radius * g.dot(v) / g.norm().powi(3)) + v * *tube
            }
            Form::Ellipsoid(squares) => {
                let (n, v) = (turning.apply_inverse(n), turning.apply_inverse(v));
                let scaled = |v: Vector<S>| Vector([0, 1, 2].map(|i| squares[i] * v[i]));
                let height = n.dot(scaled(n)).sqrt();
                let along = n.dot(scaled(v)) / height.powi(3);
                turning.apply(scaled(v) * (S::constant(1.0) / height) - scaled(n) * along)
            }
        }
    }
}

/// A row of a contact, and the force that its multiplier is the size of: in the ground's axes, and along and across the
/// wheel and along the normal.
pub(super) struct RowForce<'g> {
    pub(super) row: usize,
    pub(super) ground: Vector<Expr<'g>>,
    pub(super) wheel: Vector<Expr<'g>>,
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
            self.no_idle_ground(element, ground)?;
            let centre = self.pose_field(element, "center", "rpy", &binding)?;
            let form = self.rolling_form(element, &binding)?;
            let (Some(a), Some(b)) = (self.motion(ground), self.motion(body)) else { return Err(Reported) };
            let relative = Relative::new(&a, &b.fixed(&centre));
            if let Some(curved) = self.curved_place(&full, &form, element, ground, &binding)? {
                self.roll_by_place(&full, &relative, &form, &curved, element)?;
                continue;
            }
            if let (Some(curved), Form::Ball(radius)) = (self.curved_ground(element, ground, &binding)?, &form) {
                self.must_be_smooth(&curved, "rolling without slipping", element)?;
                self.check_fit(*radius, &curved, element)?;
                self.roll_on(&full, &relative, *radius, &curved, element);
                continue;
            }
            self.roll_on_plane(&full, &relative, &form, body, element);
        }
        Ok(())
    }

    /// Rows of what rolls on a plane. Those of a body that hangs on the world, as a free one does, stand in the plane's axes:
    /// along them it has velocities that enter with ±1, pivots for ever. Wheels of a machine have rows along their heading
    /// and across, so that a row that follows from others is one of a meaning.
    fn roll_on_plane(
        &mut self,
        name: &str,
        relative: &Relative<'g>,
        form: &Form<Expr<'g>>,
        body: usize,
        element: &SceneElement,
    ) {
        let stands_alone = self.hangs_on_world(body);
        let (contact, heading) = (relative.contact(form), form.heading_on(&relative.turning(), unit(2)));
        let [h, e] = heading.unwrap_or([0, 1].map(unit));
        let mut forces = Vec::new();
        let rows = match form {
            Form::Disc { axis, radius, tube } if !stands_alone => relative.wheel_slip(*axis, *radius, *tube),
            _ => [0, 1].map(|i| relative.slip_at(contact.p, contact.p_rate)[i]),
        };
        let by_heading = heading.is_some() && !stands_alone;
        for (i, word) in [["x", "along"], ["y", "across"]].into_iter().enumerate() {
            let (ground, wheel) =
                if by_heading { ([h, e][i], unit(i)) } else { (unit(i), Vector([h[i], e[i], number(0.0)])) };
            let word = word[usize::from(by_heading)];
            let row = self.bind_velocity(&format!("{name}.{word}"), rows[i], "", element);
            forces.extend(row.map(|row| RowForce { row, ground, wheel }));
        }
        let [height, rate, second] = relative.distance_from_plane(&contact);
        if let Some(row) = self.hold(&format!("{name}.z"), [height, rate, second], &element.place) {
            forces.push(RowForce { row, ground: unit(2), wheel: unit(2) });
        }
        self.must_not_lie_flat(name, form, &relative.turning(), unit(2), element);
        self.name_contact_forces(name, heading.is_some(), forces);
    }

    /// A key that says nothing to the kind of ground was meant to.
    fn no_idle_ground(&mut self, element: &SceneElement, ground: usize) -> Made<()> {
        let frame = &self.assembly.frames[ground];
        if frame.is_surface {
            let why = format!("the ground is the surface `{}`, which has its own shape", frame.name);
            return self.without(element, &["surface", "surface_radius", "outside", "height"], &why);
        }
        let word = match element.get("surface").map(|v| &v.data) {
            Some(Data::Text(word)) => word.as_str(),
            _ => "plane",
        };
        if word != "height" {
            let why = "it belongs to `surface = \"height\"`";
            self.without(element, &["height"], why)?;
        }
        if matches!(word, "plane" | "height") {
            let why = "it belongs to `surface = \"sphere\"` or `\"cylinder\"`";
            self.without(element, &["surface_radius", "outside"], why)?;
        }
        Ok(())
    }

    fn rolling_form(&mut self, element: &SceneElement, binding: &Binding) -> Made<Form<Expr<'g>>> {
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
        if let (Some(r), Some(rho)) = (self.evaluate(radius), self.evaluate(tube))
            && rho >= r
        {
            let message = format!(
                "`tube` is {rho} m and `radius` {r} m: `radius` goes to the middle of the rim's section and is the larger one"
            );
            return Err(self.low.report(place("tube"), message));
        }
        Ok(Form::Disc { axis, radius, tube })
    }

    /// Names the contact force by its components in the ground's axes, along the normal and, of a wheel, along and across.
    pub(super) fn name_contact_forces(&mut self, name: &str, has_heading: bool, forces: Vec<RowForce<'g>>) {
        let graph = self.low.graph;
        for (k, component) in ["fx", "fy", "fz", "along", "across", "normal"].into_iter().enumerate() {
            if !has_heading && (k == 3 || k == 4) {
                continue;
            }
            let parts = forces.iter().map(|f| (f.row, if k < 3 { f.ground[k] } else { f.wheel[k - 3] }));
            let parts = parts.filter(|(_, e)| !e.is(0.0)).map(|(row, e)| (row, graph.id(-e))).collect();
            self.name_sum(format!("{name}.{component}"), parts, false);
        }
    }

    /// A velocity that must be zero, with its rate; gives its place among the rows.
    pub(super) fn bind_velocity(
        &mut self,
        name: &str,
        [velocity, rate]: [Expr<'g>; 2],
        force: &str,
        element: &SceneElement,
    ) -> Option<usize> {
        if velocity.is(0.0) {
            return None;
        }
        let graph = self.low.graph;
        let row = KinematicRow::new(name, &element.place, RowForm::Zero(graph.id(velocity)));
        let row = KinematicRow { rate: Some(graph.id(rate)), may_be_redundant: true, ..row };
        self.parts.kinematics.push(row);
        if !force.is_empty() {
            self.name_force(force.into(), Dimension::of(1, 1, -2));
        }
        Some(self.parts.kinematics.len() - 1)
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
    /// Height of a body over the plane, with its rates.
    fn distance_from_plane(&self, contact: &Contact<'g>) -> Row<'g> {
        let [height, ..] = self.distance(2);
        let [.., rate] = self.slip_at(contact.p, contact.p_rate);
        [height - contact.height, rate[0], rate[1]]
    }

    /// Slip velocities of a rim along its heading and across on the plane, with their rates.
    ///
    /// ```text
    /// c′·h − r w·a − ρ w·e,   c′·e + (r |m| + ρ) w·h          h = a × n/|m|,  e = n × h
    /// ```
    fn wheel_slip(&self, axis: Vector<Expr<'g>>, radius: Expr<'g>, tube: Expr<'g>) -> [[Expr<'g>; 2]; 2] {
        let turn = |v| self.turning().apply(v);
        let (a, w, w_rate) = (turn(axis), turn(self.spin()), turn(self.spin_rate()));
        let a_rate = w.cross(a);
        let size = (number(1.0) - a[2] * a[2]).sqrt();
        let size_rate = -(a[2] * a_rate[2]) / size;
        let level = |v: Vector<Expr<'g>>| Vector([v[1], -v[0], number(0.0)]);
        let h = level(a) * (number(1.0) / size);
        let h_rate = (level(a_rate) - h * size_rate) * (number(1.0) / size);
        let (e, e_rate) = (-level(h), -level(h_rate));
        let centre = [0, 1, 2].map(|i| self.distance(i));
        let [c_rate, c_second] = [1, 2].map(|order| Vector(centre.map(|row| row[order])));
        let roll = [self.spin(), self.spin_rate()].map(|v| axis.dot(v) * radius);
        let height = radius * size + tube;
        [
            [
                c_rate.dot(h) - roll[0] - tube * w.dot(e),
                c_second.dot(h) + c_rate.dot(h_rate) - roll[1] - tube * (w_rate.dot(e) + w.dot(e_rate)),
            ],
            [
                c_rate.dot(e) + height * w.dot(h),
                c_second.dot(e)
                    + c_rate.dot(e_rate)
                    + height * (w_rate.dot(h) + w.dot(h_rate))
                    + radius * size_rate * w.dot(h),
            ],
        ]
    }

    /// The slip velocity and its rate at a place from the centre, by components in the ground's axes.
    pub(super) fn slip_at(&self, p: Vector<Expr<'g>>, p_rate: Vector<Expr<'g>>) -> [[Expr<'g>; 2]; 3] {
        let [w, w_rate] = self.turns();
        let centre = [0, 1, 2].map(|i| self.distance(i));
        let velocity = Vector(centre.map(|[_, v, _]| v)) + w.cross(p);
        let rate = Vector(centre.map(|[_, _, a]| a)) + w_rate.cross(p) + w.cross(p_rate);
        [0, 1, 2].map(|i| [velocity[i], rate[i]])
    }

    fn contact(&self, form: &Form<Expr<'g>>) -> Contact<'g> {
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

/// The k-th unit vector.
pub(super) fn unit<'g>(k: usize) -> Vector<Expr<'g>> {
    Vector::constant([0, 1, 2].map(|i| f64::from(u8::from(i == k))))
}
