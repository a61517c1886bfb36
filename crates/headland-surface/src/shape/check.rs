//! Sizes that make no surface, and balls that do not fit.

use std::f64::consts::FRAC_PI_2;

use super::{Shape, Side};

/// Why a surface cannot be, or not carry a ball.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length that must be positive.
    #[error("the {shape}'s {size} is {value} m; it must be positive and finite")]
    Size {
        /// Kind of surface.
        shape: &'static str,
        /// Which of its lengths.
        size: &'static str,
        /// The length, m.
        value: f64,
    },
    /// A cone that is a line, a plane or no cone.
    #[error("the cone's half-angle is {} deg; it must lie between 0 and 90 deg, both excluded", .value.to_degrees())]
    HalfAngle {
        /// The angle, rad.
        value: f64,
    },
    /// A torus without a hole.
    #[error("the torus's tube of radius {tube} m closes its hole; it must be less than the ring's radius {radius} m")]
    NoHole {
        /// Radius of the tube, m.
        tube: f64,
        /// Radius of the middle circle, m.
        radius: f64,
    },
    /// A ball that is no ball.
    #[error("the ball's radius is {value} m; it must be positive and finite")]
    Ball {
        /// Its radius, m.
        value: f64,
    },
    /// A ball that cannot roll inside.
    #[error("a ball of radius {ball} m does not fit inside the {shape} of radius {room} m; it must be smaller")]
    TooLarge {
        /// Kind of surface.
        shape: &'static str,
        /// Radius of the ball, m.
        ball: f64,
        /// Radius of the recess, m.
        room: f64,
    },
}

impl Shape<f64> {
    /// Kind of surface in a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Shape::Plane => "plane",
            Shape::Sphere { .. } => "sphere",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Cone { .. } => "cone",
            Shape::Torus { .. } => "torus",
        }
    }

    /// Whether its sizes make a surface.
    ///
    /// # Errors
    /// [`ShapeError`] names the size.
    pub fn check(&self) -> Result<(), ShapeError> {
        let positive = |size, value: f64| {
            let shape = self.kind();
            if value > 0.0 && value.is_finite() { Ok(()) } else { Err(ShapeError::Size { shape, size, value }) }
        };
        match *self {
            Shape::Plane => Ok(()),
            Shape::Sphere { radius, .. } | Shape::Cylinder { radius, .. } => positive("radius", radius),
            Shape::Cone { half_angle, .. } => {
                let good = half_angle > 0.0 && half_angle < FRAC_PI_2;
                if good { Ok(()) } else { Err(ShapeError::HalfAngle { value: half_angle }) }
            }
            Shape::Torus { radius, tube, .. } => {
                positive("radius", radius)?;
                positive("tube radius", tube)?;
                if tube < radius { Ok(()) } else { Err(ShapeError::NoHole { tube, radius }) }
            }
        }
    }

    /// Whether a ball of radius `ball`, m, can touch the surface anywhere without being at several places of it at once.
    ///
    /// Somewhere is enough: deep in a funnel, or above a ring's hole, a ball may still be too large; there its
    /// [`room`](Self::room) says so.
    ///
    /// # Errors
    /// [`ShapeError::TooLarge`] where a recess is not larger than the ball, [`ShapeError::Ball`] for a radius that is none.
    pub fn fits(&self, ball: f64) -> Result<(), ShapeError> {
        if !(ball > 0.0 && ball.is_finite()) {
            return Err(ShapeError::Ball { value: ball });
        }
        let room = match *self {
            Shape::Sphere { radius, side: Side::Inside } | Shape::Cylinder { radius, side: Side::Inside } => radius,
            Shape::Torus { tube, side: Side::Inside, .. } => tube,
            _ => f64::INFINITY,
        };
        let shape = if let Shape::Torus { .. } = self { "tube of the torus" } else { self.kind() };
        if ball < room { Ok(()) } else { Err(ShapeError::TooLarge { shape, ball, room }) }
    }

    /// Radius of the largest ball, m, that touches the surface at the point nearest to `c` and is nowhere through it;
    /// infinite where nothing hollow is opposite. A ball of just that radius touches elsewhere too.
    pub fn room(&self, c: [f64; 3]) -> f64 {
        let rho = c[0].hypot(c[1]);
        match *self {
            Shape::Sphere { radius, side: Side::Inside } | Shape::Cylinder { radius, side: Side::Inside } => radius,
            Shape::Cone { half_angle, side: Side::Inside } => {
                // along the generator to the foot, then along the normal to the axis
                let (sin, cos) = half_angle.sin_cos();
                (rho * sin + c[2] * cos).max(0.0) * half_angle.tan()
            }
            Shape::Torus { tube, side: Side::Inside, .. } => tube,
            Shape::Torus { radius, tube, side: Side::Outside } => {
                // the foot's normal meets the axis where it leans inwards
                let inwards = (radius - rho) / (radius - rho).hypot(c[2]);
                if inwards > 0.0 { radius / inwards - tube } else { f64::INFINITY }
            }
            _ => f64::INFINITY,
        }
    }
}
