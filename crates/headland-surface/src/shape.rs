//! [`Shape`]: surfaces whose distance is known in closed form, over any scalar.
//!
//! ```text
//! d(c)   signed distance: positive on the free side
//! n(c)   its gradient, the unit normal towards the free side
//! H(c)   gradient of the normal; H v is how fast the normal turns where c moves with v;  H n = 0
//! ```

use headland_expr::Scalar;
use headland_spatial::Vector;

/// Which side of a closed surface is free.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Side {
    /// A recess: what touches is inside.
    Inside,
    /// What touches is outside.
    #[default]
    Outside,
}

/// A surface in the axes of its frame.
#[derive(Clone, Copy, Debug)]
pub enum Shape<S> {
    /// `z = 0`, free above.
    Plane,
    /// A sphere about the origin.
    Sphere {
        /// Radius, m.
        radius: S,
        /// Free side.
        side: Side,
    },
    /// A cylinder about z, without ends.
    Cylinder {
        /// Radius, m.
        radius: S,
        /// Free side.
        side: Side,
    },
}

impl<S: Scalar> Shape<S> {
    /// Signed distance of a point, m.
    pub fn distance(&self, c: Vector<S>) -> S {
        match self {
            Shape::Plane => c[2],
            Shape::Sphere { radius, side } => side.sign::<S>() * (c.norm() - *radius),
            Shape::Cylinder { radius, side } => side.sign::<S>() * (across(c).norm() - *radius),
        }
    }

    /// Unit normal at the surface's point nearest to `c`, towards the free side.
    pub fn normal(&self, c: Vector<S>) -> Vector<S> {
        match self {
            Shape::Plane => Vector::constant([0.0, 0.0, 1.0]),
            Shape::Sphere { side, .. } => unit(c) * side.sign(),
            Shape::Cylinder { side, .. } => unit(across(c)) * side.sign(),
        }
    }

    /// `H v`: rate of the normal where `c` moves with `v`.
    pub fn normal_rate(&self, c: Vector<S>, v: Vector<S>) -> Vector<S> {
        match self {
            Shape::Plane => Vector::constant([0.0; 3]),
            Shape::Sphere { side, .. } => unit_rate(c, v) * side.sign(),
            Shape::Cylinder { side, .. } => unit_rate(across(c), across(v)) * side.sign(),
        }
    }
}

impl Side {
    /// −1 inside, 1 outside.
    pub fn sign<S: Scalar>(self) -> S {
        S::constant(if self == Side::Inside { -1.0 } else { 1.0 })
    }
}

/// The part across z.
fn across<S: Scalar>(v: Vector<S>) -> Vector<S> {
    Vector([v[0], v[1], S::constant(0.0)])
}

fn unit<S: Scalar>(c: Vector<S>) -> Vector<S> {
    c * (S::constant(1.0) / c.norm())
}

fn unit_rate<S: Scalar>(c: Vector<S>, v: Vector<S>) -> Vector<S> {
    let e = unit(c);
    (v - e * e.dot(v)) * (S::constant(1.0) / c.norm())
}
