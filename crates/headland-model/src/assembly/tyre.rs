//! `[[tyre]]`: a wheel that gives, on the plane `z = 0` of a frame.
//!
//! The wheel is a disc, axis a, whose centre stands h above the plane, normal n; everything in the plane's axes:
//!
//! ```text
//! |m| = √(1 − a_z²)      d = R |m| − h, deflection      x = a × n/|m|,  y = n × x
//! p = −(h/|m|) x × a     from the centre to the point of contact, in the wheel's plane and on the ground
//! F_z(d, d′)             acts along −d′:  work of the spring is what it stores, also where the wheel leans
//! F_x x + F_y y          acts at p, along c′ + w × p
//! M_x x + M_y y + M_z n  acts along w
//! ```
//! Velocities are those relative to the ground, so that what carries the ground has the reactions. Slip is given by the motion,
//! or by its states of relaxation, which are coordinates of the first order.

use headland_expr::{Expr, Scalar};
use headland_spatial::Vector;
use headland_surface::Shape;
use headland_tyre::guard::smooth_step;
use headland_tyre::{ContactAxes, Forces, Motion, Relaxation, RollingResistance, Slip, Stiffness, Vertical};

use super::closures::Relative;
use super::number;
use super::rolling::{Form, unit};
use super::surfaces::Ground;
use super::tyre_law::{Law, Least};
use crate::build::{Builder, Made, bound_name};
use crate::dimension::Dimension;
use crate::lower::{Reported, Typed};
use crate::model::{Hazard, KinematicRow, Load, RowForm, Switch};
use crate::scene::{Data, Element as SceneElement};
use crate::symbols::{Binding, Members, Symbol};

/// Parts of the names of the states of relaxation.
const STATES: [&str; 2] = ["kappa", "tan_alpha"];

/// How a wheel stands on the ground and moves over it.
struct Stand<'g> {
    axes: ContactAxes<Expr<'g>>,
    deflection: Expr<'g>,
    deflection_rate: Expr<'g>,
    /// From the centre to the point of contact.
    place: Vector<Expr<'g>>,
    /// Of the wheel's point that is there.
    velocity: Vector<Expr<'g>>,
    spin: Vector<Expr<'g>>,
    motion: Motion<Expr<'g>>,
}

impl<'g> Builder<'_, 'g> {
    /// Declares the states of relaxation.
    pub(super) fn declare_tyres(&mut self) {
        for element in self.scene.section_elements("tyre").iter().filter(|e| e.get("relaxation").is_some()) {
            let Ok(name) = self.text_field(element, "name") else { continue };
            for binding in self.bindings_of(element).unwrap_or_default() {
                for part in STATES {
                    let _ = self.declare_slip(element, &bound_name(&name, &binding), part);
                }
            }
        }
    }

    fn declare_slip(&mut self, element: &SceneElement, full: &str, part: &str) -> Made<()> {
        let (base, member) = self.split_name(full, &element.place)?;
        let family = format!("{base}.{part}");
        let position = self.low.add_coordinate(format!("{full}.{part}"), &Dimension::NONE, false, &element.place);
        self.low.coordinates[position].guess = Some(0.0);
        self.low.coordinates[position].first_order = true;
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

    pub(super) fn tyre(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            self.one_tyre(element, &bound_name(&name, &binding), &binding)?;
        }
        Ok(())
    }

    fn one_tyre(&mut self, element: &SceneElement, name: &str, binding: &Binding) -> Made<()> {
        let law = self.tyre_law(element, binding)?;
        let vertical = self.tyre_vertical(element, &law, binding)?;
        let stand = self.stand(element, name, &law, binding)?;
        let load = vertical.load(stand.deflection, stand.deflection_rate);
        let creep = self.tyre_speed(element, "creep", 0.1, binding)?;
        let slip = match self.relaxation(element, &law, load, &stand, binding)? {
            Some(relaxation) => self.relaxing_slip(element, name, &law, load, &stand, &relaxation, creep)?,
            None => stand.motion.slip(creep),
        };
        let friction = self.tyre_friction(element, name, binding)?;
        let rolling = self.tyre_number(element, "rolling", binding, &Dimension::NONE, Least::Zero)?;
        let mut forces = law.forces(load, friction, &slip);
        if law.nominal_load().is_none() {
            // stiffnesses that do not follow the load end where there is none
            let [fx, fy, mz] =
                [forces.fx, forces.fy, forces.mz].map(|f| Expr::select(-stand.deflection, number(0.0), f));
            forces = Forces { fx, fy, mz, ..forces };
        }
        if !rolling.is(0.0) {
            let radius = stand.place.norm();
            let law = RollingResistance { constant: rolling, linear: number(0.0), quartic: number(0.0), radius };
            forces.my = forces.my + law.moment(load, stand.motion.forward, slip.direction);
        }
        self.vertical_loads(element, name, &vertical.spring, load, &stand);
        self.watch_lift_off(&vertical, &stand);
        let Stand { axes, velocity, spin, .. } = stand;
        self.tyre_load(element, &format!("{name}.grip"), axes.x * forces.fx + axes.y * forces.fy, velocity, None);
        let moment = axes.x * forces.mx + axes.y * forces.my + axes.z * forces.mz;
        self.tyre_load(element, &format!("{name}.moment"), moment, spin, None);
        self.publish_tyre(name, load, &forces, &slip, &stand, element.get("relaxation").is_some());
        Ok(())
    }

    /// Where the wheel is over the ground.
    fn stand(&mut self, element: &SceneElement, name: &str, law: &Law<'g>, binding: &Binding) -> Made<Stand<'g>> {
        let body = self.frame_field(element, "body", binding, None)?;
        let ground = self.frame_field(element, "on", binding, Some(0))?;
        if self.carrier_of(body) == self.carrier_of(ground) {
            let message = format!("`{name}` stands on the body that it belongs to");
            return Err(self.low.report(element.place.clone(), message));
        }
        if !matches!(self.shape_of(ground)?, Ground::Shape(Shape::Plane)) {
            let place = element.get("on").map_or(&element.place, |v| &v.place).clone();
            return Err(self
                .low
                .report(place, "a tyre stands on planes so far: a frame, or a surface of shape \"plane\""));
        }
        let centre = self.pose_field(element, "center", "rpy", binding)?;
        let axis = Vector::constant(self.direction(element, "axis", binding, [0.0, 1.0, 0.0])?);
        let length = Dimension::of(0, 1, 0);
        let radius = match (element.get("radius"), law.file()) {
            (None, Some(file)) => number(file.radius()),
            _ => self.tyre_number(element, "radius", binding, &length, Least::Needed)?,
        };
        let (Some(a), Some(b)) = (self.motion(ground), self.motion(body)) else { return Err(Reported) };
        let relative = Relative::new(&a, &b.fixed(&centre));
        let turning = relative.turning();
        let form = Form::Disc { axis, radius, tube: number(0.0) };
        self.must_not_lie_flat(name, &form, &turning, unit(2), element);

        let axle = turning.apply(axis);
        let spin = turning.apply(relative.spin());
        let axle_rate = spin.cross(axle);
        let size = (number(1.0) - axle[2] * axle[2]).max(number(1e-12)).sqrt();
        let x = Vector([axle[1], -axle[0], number(0.0)]) * (number(1.0) / size);
        let axes = ContactAxes { x, y: Vector([-x[1], x[0], number(0.0)]), z: unit(2) };
        let centre = [0, 1, 2].map(|i| relative.distance(i));
        let [height, height_rate, _] = centre[2];
        let deflection = radius * size - height;
        let deflection_rate = -(radius * axle[2] * axle_rate[2] / size) - height_rate;
        self.not_below(element, name, height, radius);
        let loaded = (height / size).min(radius);
        let effective = match (element.get("effective_radius"), law.file()) {
            (None, Some(file)) => file.effective_radius(deflection.max(number(0.0))),
            (None, None) => loaded,
            _ => self.tyre_number(element, "effective_radius", binding, &length, Least::Needed)?,
        };
        let velocity = Vector(centre.map(|[_, v, _]| v));
        let motion = Motion::new(velocity, spin, axle, &axes, loaded, effective);
        let place = axes.lowest_point(axle, loaded);
        let velocity = velocity + spin.cross(place);
        Ok(Stand { axes, deflection, deflection_rate, place, velocity, spin, motion })
    }

    /// A start with the wheel's centre below the ground has no meaning.
    fn not_below(&mut self, element: &SceneElement, name: &str, height: Expr<'g>, radius: Expr<'g>) {
        let size = self.evaluate(radius).unwrap_or(f64::NAN);
        let message = format!(
            "the centre of the wheel of `{name}` is below the ground: its tyre would be pressed in by more than the radius of \
             {size} m; lift it"
        );
        let quantity = self.low.graph.id(height);
        self.parts.hazards.push(Hazard { quantity, limit: 0.0, message, place: element.place.clone() });
    }

    /// Where methods begin anew: where the wheel lifts off or touches down, and where the damper is cut off. Where it is
    /// nearest to the ground is watched too, so that a contact within one long step of flight is seen.
    fn watch_lift_off(&mut self, vertical: &Vertical<Expr<'g>>, stand: &Stand<'g>) {
        let graph = self.low.graph;
        let (gap, rate) = (-stand.deflection, -stand.deflection_rate);
        let mut switch = |quantity: Expr<'g>, restarts| {
            self.parts.switches.push(Switch { quantity: graph.id(quantity), restarts });
        };
        switch(gap, true);
        switch(Expr::select(gap, rate, number(-1.0)), false);
        if !vertical.damping.is(0.0) {
            let d = stand.deflection.max(number(0.0));
            let damper = vertical.damping * smooth_step(d / vertical.onset) * rate;
            switch(Expr::select(gap, number(1.0), vertical.spring.force(d) - damper), true);
        }
    }

    /// Spring and damper along the rate of the deflection. What the spring stores is potential energy, where it has a
    /// closed form.
    fn vertical_loads(
        &mut self,
        element: &SceneElement,
        name: &str,
        spring: &Stiffness<Expr<'g>>,
        load: Expr<'g>,
        stand: &Stand<'g>,
    ) {
        let zero = number(0.0);
        let d = stand.deflection.max(zero);
        let along = unit(2) * -stand.deflection_rate;
        let energy = match spring {
            Stiffness::Linear { stiffness } => Some(number(0.5) * *stiffness * d * d),
            Stiffness::Quadratic { stiffness, progression } => {
                Some((number(0.5) * *stiffness + number(1.0 / 3.0) * *progression * d) * d * d)
            }
            _ => None,
        };
        let rest = match energy {
            Some(energy) => {
                let force = spring.force(d);
                self.tyre_load(element, &format!("{name}.spring"), unit(2) * force, along, Some(energy));
                load - force
            }
            None => load,
        };
        self.tyre_load(element, &format!("{name}.damper"), unit(2) * rest, along, None);
    }

    fn tyre_load(
        &mut self,
        element: &SceneElement,
        name: &str,
        force: Vector<Expr<'g>>,
        rate: Vector<Expr<'g>>,
        potential: Option<Expr<'g>>,
    ) {
        if force.0.iter().all(|f| f.is(0.0)) {
            return;
        }
        let graph = self.low.graph;
        self.parts.loads.push(Load {
            name: name.into(),
            force: force.0.map(|e| graph.id(e)),
            rate: rate.0.map(|e| graph.id(e)),
            potential: potential.map(|e| graph.id(e)),
            place: element.place.clone(),
        });
    }

    /// Lengths and damping of relaxation, if the tyre relaxes.
    fn relaxation(
        &mut self,
        element: &SceneElement,
        law: &Law<'g>,
        load: Expr<'g>,
        stand: &Stand<'g>,
        binding: &Binding,
    ) -> Made<Option<Relaxation<Expr<'g>>>> {
        let Some(value) = element.get("relaxation").cloned() else {
            let why = "it belongs to tyres with `relaxation`";
            self.without(element, &["standstill_damping", "low_speed"], why)?;
            return Ok(None);
        };
        if matches!(law, Law::None) {
            return Err(self
                .low
                .report(value.place, "without a law of slip there is nothing that relaxes: give `law`"));
        }
        let of_file = matches!(&value.data, Data::Text(text) if text == "file");
        let length = match (of_file, law.file()) {
            (true, Some(file)) => file.relaxation_lengths(load, stand.motion.camber),
            (true, None) => {
                return Err(self.low.report(value.place, "`relaxation = \"file\"` belongs to `law = \"pac2002\"`"));
            }
            _ => self.tyre_pair(element, "relaxation", binding, &Dimension::of(0, 1, 0), Least::Positive)?,
        };
        let low_speed = self.tyre_speed(element, "low_speed", 2.0, binding)?;
        let limit = [0.45, 1.0].map(number);
        let mut made = Relaxation { length, low_speed, damping: [number(0.0); 2], limit };
        if element.get("standstill_damping").is_some() {
            made.damping =
                self.tyre_pair(element, "standstill_damping", binding, &Dimension::of(1, 0, -1), Least::Zero)?;
        } else if let Some(nominal) = law.nominal_load() {
            let mass = nominal * number(1.0 / 9.81);
            made.damping = made.critical_damping(law.stiffness(nominal), mass, number(0.5));
        }
        Ok(Some(made))
    }

    /// The slip by its states, whose rows are made here. A lifted tyre forgets.
    #[allow(clippy::too_many_arguments)]
    fn relaxing_slip(
        &mut self,
        element: &SceneElement,
        name: &str,
        law: &Law<'g>,
        load: Expr<'g>,
        stand: &Stand<'g>,
        relaxation: &Relaxation<Expr<'g>>,
        creep: Expr<'g>,
    ) -> Made<Slip<Expr<'g>>> {
        let graph = self.low.graph;
        let find = |part: &str| {
            let full = format!("{name}.{part}");
            self.low.coordinates.iter().position(|c| c.name == full).ok_or(Reported)
        };
        let places = [find(STATES[0])?, find(STATES[1])?];
        let state = places.map(|i| graph.expr(self.low.coordinates[i].q));
        let rates = relaxation.rates(state, &stand.motion);
        let speed = stand.motion.forward.abs() + relaxation.low_speed;
        for (k, i) in places.into_iter().enumerate() {
            let forgotten = -(speed * state[k]) / relaxation.length[k];
            let rate = Expr::select(-stand.deflection, forgotten, rates[k]);
            let row = format!("{name}.{}'", STATES[k]);
            if self.parts.kinematics.iter().any(|r| r.name == row) {
                return Err(self.low.report(element.place.clone(), format!("`{row}` is given under [kinematics] too")));
            }
            let form = RowForm::Rate(i, graph.id(rate));
            self.parts.kinematics.push(KinematicRow::new(row, &element.place, form));
        }
        Ok(relaxation.slip(state, &stand.motion, law.stiffness(load), creep))
    }

    /// A coefficient, which may change with place and time.
    fn tyre_friction(&mut self, element: &SceneElement, name: &str, binding: &Binding) -> Made<Expr<'g>> {
        let Some(e) = self.scalar_field(element, "friction", binding, &Dimension::NONE)? else {
            return Ok(number(1.0));
        };
        let place = element.get("friction").map_or(&element.place, |v| &v.place).clone();
        let typed = Typed { expr: e, ..Typed::number(0.0, Dimension::NONE) };
        self.no_accelerations(&typed, &place, &format!("`friction` of `{name}`"))?;
        match self.evaluate(e) {
            Some(_) => self.tyre_bound(e, "friction", &place, Least::Positive),
            None => Ok(e),
        }
    }

    fn tyre_speed(&mut self, element: &SceneElement, key: &str, default: f64, binding: &Binding) -> Made<Expr<'g>> {
        match element.get(key) {
            None => Ok(number(default)),
            Some(_) => self.tyre_number(element, key, binding, &Dimension::of(0, 1, -1), Least::Needed),
        }
    }

    /// One number for both directions, or two.
    fn tyre_pair(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        dimension: &Dimension,
        least: Least,
    ) -> Made<[Expr<'g>; 2]> {
        let Some(value) = element.get(key).cloned() else { return Err(Reported) };
        let items = match &value.data {
            Data::Array(_) => self.array(&value, key, &[2])?,
            _ => vec![value.clone(), value],
        };
        let mut pair = [number(0.0); 2];
        for (e, item) in pair.iter_mut().zip(&items) {
            let found = self.expression(item, &format!("`{key}`"), binding, dimension, false)?;
            *e = self.tyre_bound(found, key, &item.place, least)?;
        }
        Ok(pair)
    }

    fn publish_tyre(
        &mut self,
        name: &str,
        load: Expr<'g>,
        forces: &Forces<Expr<'g>>,
        slip: &Slip<Expr<'g>>,
        stand: &Stand<'g>,
        relaxes: bool,
    ) {
        let newton = Dimension::of(1, 1, -2);
        for (part, e) in [("fx", forces.fx), ("fy", forces.fy), ("fz", load)] {
            self.publish(format!("{name}.{part}"), e, newton.clone());
        }
        for (part, e) in [("mx", forces.mx), ("my", forces.my), ("mz", forces.mz)] {
            self.publish(format!("{name}.{part}"), e, Dimension::of(1, 2, -2));
        }
        self.publish(format!("{name}.deflection"), stand.deflection, Dimension::of(0, 1, 0));
        self.publish(format!("{name}.alpha"), slip.tan_alpha.atan(), Dimension::NONE);
        self.publish(format!("{name}.camber"), slip.camber, Dimension::NONE);
        if !relaxes {
            for (part, e) in STATES.into_iter().zip([slip.kappa, slip.tan_alpha]) {
                self.publish(format!("{name}.{part}"), e, Dimension::NONE);
            }
        }
    }
}
