//! `[[contact]]` with `stiffness`: a ball that presses into a surface. All of it are forces, of one model without modes.
//!
//! With the depth `δ = −gap`, the normal n and the slip velocity s of the ball's point that is deepest:
//!
//! ```text
//! spring        k δⁿ n,  energy k δⁿ⁺¹/(n + 1)                       the part that stores energy
//! loss          (N − k δⁿ) n − (μ(|s|)/√(s² + v²) + ν) N s,         N = k δⁿ max(0, 1 + c δ′)
//! resistance    torques by N and the ball's angular velocity relative to the surface
//! ```
//! All act along the velocity relative to the surface, so that its carrier feels the reaction.

use headland_contact::{Coefficient, Coulomb, Normal, Regularization, Resistance, speed};
use headland_expr::{Expr, Scalar};
use headland_spatial::Vector;

use super::curved::Touch;
use super::number;
use crate::build::{Builder, Made};
use crate::dimension::{Dimension, Ratio};
use crate::model::{Hazard, Load, Switch};
use crate::place::Place;
use crate::scene::Element as SceneElement;
use crate::symbols::Binding;

/// Keys that only a contact with `stiffness` has.
pub(super) const KEYS: [&str; 6] =
    ["exponent", "damping", "slip_speed", "stribeck_speed", "rolling_resistance", "spinning_resistance"];

/// Speed over which friction is rounded off, m/s, where the scene gives none.
const SLIP_SPEED: f64 = 1e-3;

impl<'g> Builder<'_, 'g> {
    /// The forces of a ball that presses into a surface.
    pub(super) fn compliant_contact(
        &mut self,
        name: &str,
        touch: &Touch<'g>,
        ball: Expr<'g>,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<()> {
        self.without(element, &["restitution"], "with `stiffness` the force brakes an impact: give `damping`")?;
        self.without(element, &["start"], "with `stiffness` there are no modes; gap and slip say what it does")?;
        let place = &element.place;
        let law = self.normal_law(element, binding)?;
        let (depth, rate) = (-touch.gap[0], -touch.gap[1]);
        let (spring, normal) = (law.elastic(depth), law.force(depth, rate));
        let slip = touch.slip[0];
        let across = slip - touch.normal * touch.gap[1];
        self.publish(format!("{name}.slip"), speed(across), Dimension::of(0, 1, -1));
        let (by_slip, limit, slip_speed) = self.friction_law(across, element, binding)?;
        let friction = across * -(by_slip * normal);

        let stored = Some(law.energy(depth));
        self.add_load(format!("{name}.spring"), touch.normal * spring, slip, stored, place);
        self.add_load(name.into(), touch.normal * (normal - spring) + friction, slip, None, place);
        self.resist(name, touch, normal, ball, slip_speed, element, binding)?;

        let newton = Dimension::of(1, 1, -2);
        self.publish(format!("{name}.gap"), touch.gap[0], Dimension::of(0, 1, 0));
        self.publish(format!("{name}.normal"), normal, newton.clone());
        self.publish(format!("{name}.friction"), by_slip * normal * speed(across), newton.clone());
        self.publish(format!("{name}.used"), by_slip * speed(across) / limit, Dimension::NONE);
        let force = touch.normal * normal + friction;
        for (axis, component) in ["fx", "fy", "fz"].into_iter().zip(force.0) {
            self.publish(format!("{name}.{axis}"), component, newton.clone());
        }
        self.watch_touch(name, touch, law.damping, ball, place);
        Ok(())
    }

    /// `k`, `n` and `c`.
    fn normal_law(&mut self, element: &SceneElement, binding: &Binding) -> Made<Normal<Expr<'g>>> {
        let exponent = self.constant(element, "exponent", binding, &Dimension::NONE, false)?.unwrap_or(number(1.0));
        let n = self.evaluate(exponent).unwrap_or(1.0);
        if n < 1.0 {
            let place = element.get("exponent").map_or(&element.place, |v| &v.place).clone();
            let message = format!(
                "`exponent` is {n}; it must be at least 1: below, the contact would be infinitely stiff where it begins"
            );
            return Err(self.low.report(place, message));
        }
        let force = Dimension::of(1, 1, -2);
        // by a parameter that may change the stiffness has any dimension: in SI units
        let dimension = match exponent.value().and_then(Ratio::from_f64) {
            Some(n) => &force - &Dimension::of(0, 1, 0).power(n),
            None => self.low.unifier.unknown(),
        };
        let stiffness = self.constant(element, "stiffness", binding, &dimension, false)?.unwrap_or(number(1.0));
        let damping = self.constant(element, "damping", binding, &Dimension::of(0, -1, 1), true)?;
        Ok(Normal { stiffness, exponent, damping: damping.unwrap_or(number(0.0)) })
    }

    /// Friction by slip and normal force, s/m; the largest coefficient without slip, and the speed of rounding off.
    fn friction_law(
        &mut self,
        slip: Vector<Expr<'g>>,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<(Expr<'g>, Expr<'g>, Expr<'g>)> {
        let kinetic = self.coefficient(element, "friction", binding)?;
        let viscous = self.scalar_field(element, "viscous_friction", binding, &Dimension::of(0, -1, 1))?;
        if let Some(e) = viscous {
            self.not_negative(element, "viscous_friction", e)?;
        }
        if kinetic.is_none() && viscous.is_none() {
            let message = "a contact with `stiffness` needs `friction`; with `friction = 0` it slides freely. One that \
                           never slips is a constraint: leave out `stiffness`, or use [[rolling]]";
            return Err(self.low.report(element.place.clone(), message));
        }
        let still = self.coefficient(element, "static_friction", binding)?;
        let over = self.constant(element, "stribeck_speed", binding, &Dimension::of(0, 1, -1), false)?;
        if still.is_some() != over.is_some() {
            let message = "`static_friction` and `stribeck_speed` go together: friction falls from the one to `friction` \
                           over the other";
            let key = if still.is_some() { "static_friction" } else { "stribeck_speed" };
            let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
            return Err(self.low.report(place, message));
        }
        let speed = self.constant(element, "slip_speed", binding, &Dimension::of(0, 1, -1), false)?;
        let speed = speed.unwrap_or(number(SLIP_SPEED));
        let kinetic = kinetic.unwrap_or(number(0.0));
        let coefficient = Coefficient { kinetic, stribeck: still.zip(over) };
        let law = Coulomb { coefficient, speed, regularization: Regularization::Root };
        let by_slip = law.by_slip(slip) + viscous.unwrap_or(number(0.0));
        Ok((by_slip, still.unwrap_or(kinetic), speed))
    }

    /// Torques against rolling and spinning, rounded off over the angular velocity that `slip_speed` is at the ball's edge.
    #[allow(clippy::too_many_arguments)]
    fn resist(
        &mut self,
        name: &str,
        touch: &Touch<'g>,
        normal: Expr<'g>,
        ball: Expr<'g>,
        slip_speed: Expr<'g>,
        element: &SceneElement,
        binding: &Binding,
    ) -> Made<()> {
        let length = Dimension::of(0, 1, 0);
        let rolling = self.constant(element, "rolling_resistance", binding, &length, true)?;
        let spinning = self.constant(element, "spinning_resistance", binding, &length, true)?;
        if rolling.is_none() && spinning.is_none() {
            return Ok(());
        }
        if ball.is(0.0) {
            let message = "a point does not roll: resistance to rolling and spinning needs a ball's `radius`";
            return Err(self.low.report(element.place.clone(), message));
        }
        let zero = number(0.0);
        let law = Resistance {
            rolling: rolling.unwrap_or(zero),
            spinning: spinning.unwrap_or(zero),
            speed: slip_speed / ball,
        };
        let torques = law.torques(normal, touch.spin, touch.normal);
        let torque = torques.rolling + torques.spinning;
        self.publish(format!("{name}.torque"), speed(torque), Dimension::of(1, 2, -2));
        self.add_load(format!("{name}.resistance"), torque, touch.spin, None, &element.place);
        Ok(())
    }

    fn add_load(
        &mut self,
        name: String,
        force: Vector<Expr<'g>>,
        rate: Vector<Expr<'g>>,
        potential: Option<Expr<'g>>,
        place: &Place,
    ) {
        let graph = self.low.graph;
        let ids = |v: Vector<Expr<'g>>| v.0.map(|e| graph.id(e));
        let (force, rate, potential) = (ids(force), ids(rate), potential.map(|e| graph.id(e)));
        self.parts.loads.push(Load { name, force, rate, potential, place: place.clone() });
    }

    /// Where methods begin anew: where it touches or parts, and where the damper is cut off. Where the gap is smallest is
    /// watched too, so that a contact within one long step of flight is seen.
    fn watch_touch(&mut self, name: &str, touch: &Touch<'g>, damping: Expr<'g>, ball: Expr<'g>, place: &Place) {
        let graph = self.low.graph;
        let [gap, rate, _] = touch.gap;
        let mut switch = |quantity: Expr<'g>, restarts| {
            self.parts.switches.push(Switch { quantity: graph.id(quantity), restarts });
        };
        switch(gap, true);
        switch(Expr::select(gap, rate, number(-1.0)), false);
        if !damping.is(0.0) {
            switch(Expr::select(gap, number(1.0), number(1.0) - damping * rate), true);
        }
        if !ball.is(0.0) {
            let message = format!(
                "the ball of the contact `{name}` is deeper inside the surface than its radius; start it on the free side, \
                 or pressed in less"
            );
            let quantity = graph.id(gap + ball);
            self.parts.hazards.push(Hazard { quantity, limit: 0.0, message, place: place.clone() });
        }
    }

    /// A number made of parameters that is positive, or at least not negative.
    fn constant(
        &mut self,
        element: &SceneElement,
        key: &str,
        binding: &Binding,
        dimension: &Dimension,
        zero: bool,
    ) -> Made<Option<Expr<'g>>> {
        let Some(e) = self.scalar_field(element, key, binding, dimension)? else { return Ok(None) };
        let message = match self.evaluate(e) {
            Some(x) if x > 0.0 || (zero && x == 0.0) => return Ok(Some(e)),
            Some(x) => format!("`{key}` is {x}; it must be {}", if zero { "at least 0" } else { "above 0" }),
            None => format!("`{key}` must be made of numbers and parameters"),
        };
        let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
        Err(self.low.report(place, message))
    }
}
