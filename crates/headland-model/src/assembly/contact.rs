//! `[[contact]]`: a ball that may roll on a surface, slide on it, leave it and hit it.
//!
//! Its rows are those of rolling; which of them hold is a matter of the mode, [`crate::contact`]. With `stiffness` it is
//! compliant instead: forces, no rows.

use headland_expr::{Expr, NodeId, Scalar};
use headland_spatial::Vector;

use super::closures::Relative;
use super::curved::Touch;
use super::number;
use crate::build::{Builder, Made, bound_name};
use crate::contact::{Contact, Friction, Mode};
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::{Reported, Typed};
use crate::model::{Derived, DerivedQuantity, Load};
use crate::scene::{Data, Element as SceneElement};
use crate::symbols::Binding;

impl<'g> Builder<'_, 'g> {
    pub(super) fn contact(&mut self, element: &SceneElement) -> Made<()> {
        let name = self.text_field(element, "name")?;
        for binding in self.bindings_of(element)? {
            let full = bound_name(&name, &binding);
            let body = self.frame_field(element, "body", &binding, None)?;
            let ground = self.frame_field(element, "on", &binding, Some(0))?;
            if self.carrier_of(body) == self.carrier_of(ground) {
                let message = format!("`{full}` is a contact of a body with itself");
                return Err(self.low.report(element.place.clone(), message));
            }
            let centre = self.pose_field(element, "center", "rpy", &binding)?;
            let ball = self.scalar_field(element, "radius", &binding, &Dimension::of(0, 1, 0))?.unwrap_or(number(0.0));
            let place = element.get("radius").map_or(&element.place, |v| &v.place).clone();
            let ball = self.size(ball, "radius", &place, true)?;
            let shape = self.shape_of(ground)?;
            match element.get("stiffness") {
                Some(_) => self.tell_facets(&full, &shape, element),
                None => self.must_be_smooth(&shape, "hard contact", element)?,
            }
            self.check_fit(ball, &shape, element)?;
            let (Some(a), Some(b)) = (self.motion(ground), self.motion(body)) else { return Err(Reported) };
            let relative = Relative::new(&a, &b.fixed(&centre));
            let touch = Touch::new(&relative, ball, &shape);
            self.watch_room(&full, &relative, ball, &shape, true);
            if element.get("stiffness").is_some() {
                self.compliant_contact(&full, &touch, ball, element, &binding)?;
                continue;
            }
            self.without(element, &super::compliant::KEYS, "without `stiffness` the contact is hard")?;
            self.hard_contact(&full, &touch, shape.is_plane(), element, &binding)?;
        }
        Ok(())
    }

    fn hard_contact(
        &mut self,
        name: &str,
        touch: &Touch<'g>,
        plane: bool,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<()> {
        let graph = self.low.graph;
        let ids = |v: Vector<Expr<'g>>| v.0.map(|e| graph.id(e));
        let speed = Dimension::of(0, 1, -1);
        let slip = touch.slip[0];
        let tangential = slip - touch.normal * touch.gap[1];
        self.publish(format!("{name}.gap"), touch.gap[0], Dimension::of(0, 1, 0));
        // coefficients are made with a placeholder, for they are wanted with and without slip
        let placeholder = self.low.dependence.input(graph, &format!("{name}.slip"), Kinds::QUASI);
        self.publish(format!("{name}.slip"), graph.expr(placeholder), speed);
        let friction = self.friction(name, slip, touch.normal, placeholder, element, binding)?;
        self.publish(format!("{name}.slip"), tangential.norm(), Dimension::of(0, 1, -1));
        let restitution = self.coefficient(element, "restitution", binding)?.unwrap_or(number(0.0));
        if self.evaluate(restitution).is_some_and(|e| !(0.0..=1.0).contains(&e)) {
            let place = element.get("restitution").map_or(&element.place, |v| &v.place).clone();
            return Err(self.low.report(place, "`restitution` lies between 0 and 1"));
        }
        let start = self.start_mode(element, friction.is_some())?;

        let mut made = Vec::new();
        for i in 0..if plane { 2 } else { 3 } {
            let row = self.parts.kinematics.len();
            self.bind_velocity(&format!("{name}.{}", ["x", "y", "z"][i]), touch.slip_row(i), "", element);
            if self.parts.kinematics.len() > row {
                made.push((row, i));
            }
        }
        let slip_rows = made;
        let held = self.hold(&format!("{name}.gap"), touch.gap, &element.place);
        let mut input = |component: &str| {
            let full = format!("{name}.{component}");
            self.low.dependence.input(graph, &full, Kinds::ACCELERATION)
        };
        let force = ["fx", "fy", "fz"].map(&mut input);
        let normal_force = input("normal");
        let index = self.parts.contacts.len();
        let newton = Dimension::of(1, 1, -2);
        for (k, (component, node)) in
            ["fx", "fy", "fz", "normal"].into_iter().zip(force.into_iter().chain([normal_force])).enumerate()
        {
            let full = format!("{name}.{component}");
            let what = Derived::Contact(index, (k < 3).then_some(k));
            self.low.derived.push(DerivedQuantity { name: full.clone(), input: node, what });
            self.publish(full, graph.expr(node), newton.clone());
        }
        let (f, n) = (Vector(force.map(|f| graph.expr(f))), graph.expr(normal_force));
        let across = f - touch.normal * n;
        self.publish(format!("{name}.friction"), across.norm(), newton);
        if let Some(friction) = &friction {
            // in flight nothing is there and nothing is used
            let available = (graph.expr(friction.limit) * n).max(number(f64::MIN_POSITIVE));
            let used = across.norm() / available;
            self.publish(format!("{name}.used"), used, Dimension::NONE);
        }
        self.parts.contacts.push(Contact {
            name: name.into(),
            place: element.place.clone(),
            mode: Mode::Rolling,
            start,
            gap_row: held,
            slip_rows,
            gap: touch.gap.map(|e| graph.id(e)),
            normal: ids(touch.normal),
            slip: ids(slip),
            slip_rate: ids(touch.slip[1]),
            friction,
            restitution: graph.id(restitution),
            force,
            normal_force,
        });
        Ok(())
    }

    /// A name for outputs, guards and events, and for expressions of the same element.
    pub(super) fn publish(&mut self, name: String, expr: Expr<'g>, dimension: Dimension) {
        self.low.totals.insert(name, Typed { expr, ..Typed::number(0.0, dimension) });
    }

    /// A number without unit that is not negative.
    pub(super) fn coefficient(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
    ) -> Made<Option<Expr<'g>>> {
        let Some(e) = self.scalar_field(element, key, binding, &Dimension::NONE)? else { return Ok(None) };
        self.not_negative(element, key, e)?;
        Ok(Some(e))
    }

    pub(super) fn not_negative(&mut self, element: &SceneElement, key: &str, e: Expr<'g>) -> Made<()> {
        match self.evaluate(e) {
            Some(x) if x < 0.0 || x.is_nan() => {
                let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
                Err(self.low.report(place, format!("`{key}` is {x}; it must be at least 0")))
            }
            _ => Ok(()),
        }
    }

    /// ```text
    /// F = −(μ(|s|)/|s| + ν) N s,    s the slip and what is added to it where it begins
    /// ```
    fn friction(
        &mut self,
        name: &str,
        slip: Vector<Expr<'g>>,
        normal: Vector<Expr<'g>>,
        placeholder: NodeId,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<Option<Friction>> {
        let graph = self.low.graph;
        let coefficient = self.coefficient(element, "friction", binding)?;
        let viscous = self.scalar_field(element, "viscous_friction", binding, &Dimension::of(0, -1, 1))?;
        let limit = self.coefficient(element, "static_friction", binding)?;
        if coefficient.is_none() && viscous.is_none() {
            self.without(element, &["static_friction"], "without `friction` it never slips")?;
            return Ok(None);
        }
        if let Some(e) = viscous {
            self.not_negative(element, "viscous_friction", e)?;
        }
        let mut input = |part: String| self.low.dependence.input(graph, &format!("{name}.{part}"), Kinds::PARAMETER);
        let normal_force = input("sliding normal".into());
        let direction = ["x", "y", "z"].map(|i| input(format!("direction {i}")));
        let shift = ["x", "y", "z"].map(|i| input(format!("shift {i}")));
        let (d, n) = (Vector(direction.map(|e| graph.expr(e))), graph.expr(normal_force));
        let shift_vector = Vector(shift.map(|e| graph.expr(e)));
        // rounding along the normal is not small beside a slip that begins
        let s = slip + shift_vector;
        let s = s - normal * normal.dot(s);
        let mut by_slip = number(0.0);
        if let Some(mu) = coefficient {
            // beyond the end of a slide the force goes on smoothly: it has the sign of the way it slid
            by_slip = mu / s.norm() * Expr::select(s.dot(d), number(1.0), number(-1.0));
        }
        if let Some(nu) = viscous {
            by_slip = by_slip + nu;
        }
        let force = s * -(by_slip * n);
        let slot = graph.node(placeholder).args[0] as usize;
        let with = |e: Expr<'g>, v: Expr<'g>| graph.substitute(&[graph.id(e)], |i| (i == slot).then_some(v))[0];
        let force = Vector(force.0.map(|e| with(e, s.norm())));
        let kinetic = coefficient.map_or(number(0.0), |mu| with(mu, number(0.0)));
        let limit = with(limit.unwrap_or(kinetic), number(0.0));
        let load = self.parts.loads.len();
        let zero = graph.id(number(0.0));
        self.parts.loads.push(Load {
            name: name.into(),
            force: [zero; 3],
            rate: slip.0.map(|e| graph.id(e)),
            potential: None,
            place: element.place.clone(),
        });
        Ok(Some(Friction {
            limit: graph.id(limit),
            kinetic: graph.id(kinetic),
            force: force.0.map(|e| graph.id(e)),
            load,
            normal_force,
            direction,
            shift,
            viscous: coefficient.is_none(),
        }))
    }

    fn start_mode(&mut self, element: &SceneElement, slips: bool) -> Made<Option<Mode>> {
        let Some((data, place)) = element.get("start").map(|v| (v.data.clone(), v.place.clone())) else {
            return Ok(None);
        };
        let known = "`start` is \"auto\" (default), \"rolling\", \"sliding\" or \"free\"";
        match data {
            Data::Text(word) => match word.as_str() {
                "auto" => Ok(None),
                "rolling" => Ok(Some(Mode::Rolling)),
                "free" => Ok(Some(Mode::Free)),
                "sliding" if slips => Ok(Some(Mode::Sliding)),
                "sliding" => Err(self.low.report(place, "without `friction` it never slips: it cannot start sliding")),
                _ => Err(self.low.report(place, known)),
            },
            _ => Err(self.low.report(place, known)),
        }
    }
}
