//! [`Height`]: distance from ground that is given by its height over x and y.

mod formula;
mod nearest;

use std::fmt;
use std::sync::Arc;

use headland_expr::{FIELD_PARTS, Field, field_part};
use nalgebra::{Matrix3, Vector3};

use crate::implicit::{self, Level};

pub use formula::Formula;

/// What is known of ground over a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// No lower and no higher than these, m.
    pub height: [f64; 2],
    /// No second derivative in any direction is outside of these, 1/m.
    pub bend: [f64; 2],
}

/// A height `z = f(x, y)`, a field that does not depend on its third variable, with bounds over rectangles.
///
/// The bounds make the search for a nearest point safe: they must hold, and may be wide. Narrow ones make it fast.
pub trait Ground: Field {
    /// Bounds over `x[0] .. x[1]`, `y[0] .. y[1]`, m.
    fn bounds(&self, x: [f64; 2], y: [f64; 2]) -> Bounds;
}

/// Height and derivatives `f, f_x, f_y, f_xx, f_xy, f_yy, f_xxx, f_xxy, f_xyy, f_yyy`.
pub type HeightFunction = Box<dyn Fn(f64, f64) -> [f64; 10] + Send + Sync>;

/// Ground given by a function with bounded derivatives.
pub struct Function {
    name: String,
    function: HeightFunction,
    most: [f64; 3],
}

impl Function {
    /// From a function, and its largest first, second (1/m) and third (1/m²) derivative in any direction, at any place.
    ///
    /// # Errors
    /// [`HeightError::Bound`] for a bound that is negative or not finite.
    pub fn new(name: &str, function: HeightFunction, most: [f64; 3]) -> Result<Self, HeightError> {
        for (value, bound) in most.into_iter().zip(["first", "second", "third"]) {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(HeightError::Bound { name: name.into(), bound, value });
            }
        }
        Ok(Self { name: name.into(), function, most })
    }
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Function").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Field for Function {
    fn name(&self) -> &str {
        &self.name
    }

    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        out[..FIELD_PARTS[order]].fill(0.0);
        let all = (self.function)(point[0], point[1]);
        let mut next = all.iter();
        for total in 0..=order {
            for (j, &x) in (0..=total).zip(&mut next) {
                out[field_part(total - j, j, 0)] = x;
            }
        }
    }
}

impl Ground for Function {
    fn bounds(&self, x: [f64; 2], y: [f64; 2]) -> Bounds {
        let [f, fx, fy, fxx, fxy, fyy, ..] = (self.function)(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]));
        let reach = 0.5 * (x[1] - x[0]).hypot(y[1] - y[0]);
        let [slope, bend, third] = self.most;
        let (mean, spread) = (0.5 * (fxx + fyy), (0.5 * (fxx - fyy)).hypot(fxy));
        let bend = [(mean - spread - third * reach).max(-bend), (mean + spread + third * reach).min(bend)];
        let steepest = fx.hypot(fy) + 0.5 * reach * bend[0].abs().max(bend[1].abs());
        let change = reach * slope.min(steepest);
        Bounds { height: [f - change, f + change], bend }
    }
}

/// Why a height makes no ground, or a point has no single foot on it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightError {
    /// A bound that cannot be one.
    #[error("the bound of the {bound} derivative of `{name}` is {value}; it must be finite and not negative")]
    Bound {
        /// Name of the ground.
        name: String,
        /// Which bound.
        bound: &'static str,
        /// The bound given.
        value: f64,
    },
    /// No height where it is needed, or a point without coordinates.
    #[error("`{name}` has no height at x = {x} m, y = {y} m, or the point asked is not finite")]
    NoHeight {
        /// Name of the ground.
        name: String,
        /// Place, m.
        x: f64,
        /// Place, m.
        y: f64,
    },
    /// Many points are equally near, or the bounds are too wide to tell.
    #[error(
        "no nearest point of `{name}` was singled out at {point:?} m in {boxes} rectangles: \
         many points of it are equally near, or its bounds are too wide"
    )]
    Undecided {
        /// Name of the ground.
        name: String,
        /// The point asked, m.
        point: [f64; 3],
        /// Rectangles looked at.
        boxes: usize,
    },
}

/// Distance from ground, positive above it.
///
/// The nearest point is found by Newton's method. Where the ground might be near a second time (its bend against the
/// height above it says so) all rectangles that can hold a nearer point are searched, nearest first, by the ground's
/// bounds: the answer is the global one from any height. The field is NaN where [`Height::foot`] has an error.
#[derive(Clone, Debug)]
pub struct Height {
    ground: Arc<dyn Ground>,
}

impl Height {
    /// Over a ground.
    pub fn new(ground: Arc<dyn Ground>) -> Self {
        Self { ground }
    }

    /// The ground.
    pub fn ground(&self) -> &Arc<dyn Ground> {
        &self.ground
    }

    /// The nearest point of the ground.
    ///
    /// # Errors
    /// [`HeightError::NoHeight`], [`HeightError::Undecided`].
    pub fn foot(&self, c: [f64; 3]) -> Result<[f64; 3], HeightError> {
        nearest::foot(&*self.ground, c)
    }
}

impl Field for Height {
    fn name(&self) -> &str {
        self.ground.name()
    }

    fn eval(&self, c: [f64; 3], order: usize, out: &mut [f64]) {
        let Ok(foot) = self.foot(c) else {
            out[..FIELD_PARTS[order]].fill(f64::NAN);
            return;
        };
        let mut f = [0.0; 20];
        self.ground.eval(foot, order.max(1), &mut f);
        let part = |v: &[usize]| if v.contains(&2) { 0.0 } else { -f[implicit::part(v)] };
        let level = Level {
            gradient: Vector3::new(part(&[0]), part(&[1]), 1.0),
            hessian: Matrix3::from_fn(|i, j| part(&[i, j])),
            third: [0, 1, 2].map(|k| Matrix3::from_fn(|i, j| part(&[i, j, k]))),
        };
        implicit::write(c, foot, &level, order, out);
    }
}
