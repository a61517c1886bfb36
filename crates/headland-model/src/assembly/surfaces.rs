//! `[[surface]]`: shapes that bodies roll on or touch, each in a frame of its own.

use headland_expr::Expr;
use headland_surface::{Shape, Side};

use crate::build::{Builder, Made};
use crate::dimension::Dimension;
use crate::scene::{Data, Element as SceneElement};
use crate::symbols::Binding;

/// Sizes that shapes have, and which shape has which.
const SIZES: [(&str, &[&str]); 3] =
    [("radius", &["sphere", "cylinder", "torus"]), ("tube", &["torus"]), ("half_angle", &["cone"])];

impl<'g> Builder<'_, 'g> {
    /// The shape that stands in a frame; the plane `z = 0` for a frame or body that is no surface.
    pub(super) fn shape_of(&mut self, frame: usize) -> Made<Shape<Expr<'g>>> {
        if !self.assembly.frames[frame].is_surface {
            return Ok(Shape::Plane);
        }
        let Some((element, binding)) = self.assembly.frames[frame].element.clone() else { return Ok(Shape::Plane) };
        let word = self.text_field(element, "shape")?;
        let is_flag = |e: &SceneElement| matches!(e.get("inside").map(|v| &v.data), Some(Data::Flag(true)));
        let side = if is_flag(element) { Side::Inside } else { Side::Outside };
        for (key, of) in SIZES {
            if !of.contains(&word.as_str()) {
                self.without(element, &[key], &format!("the shape is \"{word}\""))?;
            }
        }
        match word.as_str() {
            "plane" => {
                self.without(element, &["inside"], "a plane has its free side along z")?;
                Ok(Shape::Plane)
            }
            "sphere" => Ok(Shape::Sphere { radius: self.length(element, "radius", &binding)?, side }),
            "cylinder" => Ok(Shape::Cylinder { radius: self.length(element, "radius", &binding)?, side }),
            _ => {
                let place = element.get("shape").map_or(&element.place, |v| &v.place).clone();
                let message = format!("unknown shape \"{word}\"; known: plane, sphere, cylinder, cone, torus");
                Err(self.low.report(place, message))
            }
        }
    }

    /// A length above zero, made of numbers and parameters.
    fn length(&mut self, element: &SceneElement, key: &str, binding: &Binding) -> Made<Expr<'g>> {
        let Some(length) = self.scalar_field(element, key, binding, &Dimension::of(0, 1, 0))? else {
            let message = format!("this surface needs `{key}`");
            return Err(self.low.report(element.place.clone(), message));
        };
        let place = element.get(key).map_or(&element.place, |v| &v.place).clone();
        self.size(length, key, &place, false)
    }

    /// Refuses a ball that touches a recess in more than one place, or does not fit into it.
    pub(super) fn check_fit(&mut self, ball: Expr<'g>, shape: &Shape<Expr<'g>>, element: &SceneElement) -> Made<()> {
        let (recess, what) = match shape {
            Shape::Sphere { radius, side: Side::Inside } => (*radius, "sphere"),
            Shape::Cylinder { radius, side: Side::Inside } => (*radius, "cylinder"),
            _ => return Ok(()),
        };
        if let (Some(r), Some(room)) = (self.evaluate(ball), self.evaluate(recess))
            && r >= room
        {
            let place = element.get("radius").map_or(&element.place, |v| &v.place).clone();
            let message =
                format!("a ball of radius {r} m does not fit into the {what} of radius {room} m: it must be smaller");
            return Err(self.low.report(place, message));
        }
        Ok(())
    }
}
