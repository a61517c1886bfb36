//! [`Shape`]: surfaces whose distance is known in closed form, over any scalar.
//!
//! ```text
//! d(c)   signed distance: positive on the free side
//! n(c)   its gradient, the unit normal towards the free side
//! H(c)   gradient of the normal; H v is how fast the normal turns where c moves with v;  H n = 0
//! ```
//! Where two points of a surface are equally near, in the centre of a sphere or on a cylinder's axis, there is a distance but
//! no normal: it is NaN there. A branch is a [`Scalar::select`] whose arguments are guarded, so that derivatives of an
//! expression stay finite on both sides of it.

mod check;

pub use check::ShapeError;

use headland_expr::Scalar;
use headland_spatial::{Axis, Vector};

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
    /// A cone that opens upwards from its apex in the origin, axis z. Beside and below the apex the nearest point is the
    /// apex itself.
    Cone {
        /// Angle between axis and generator, rad, between 0 and π/2.
        half_angle: S,
        /// Free side: outside of the solid cone, or inside of the funnel.
        side: Side,
    },
    /// A ring about z, its middle circle in `z = 0`.
    Torus {
        /// Radius of the middle circle, m.
        radius: S,
        /// Radius of the tube, m, less than `radius`.
        tube: S,
        /// Free side: outside of the ring, or inside of the tube.
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
            Shape::Cone { half_angle, side } => {
                let (sin, cos) = half_angle.sin_cos();
                let cone = Cone::at(c, sin, cos);
                let flank = cone.from_axis.norm() * cos - c[2] * sin;
                side.sign::<S>() * S::select(cone.on_flank, flank, cone.from_apex.norm())
            }
            Shape::Torus { radius, tube, side } => side.sign::<S>() * (from_circle(c, *radius).norm() - *tube),
        }
    }

    /// Unit normal at the surface's point nearest to `c`, towards the free side.
    pub fn normal(&self, c: Vector<S>) -> Vector<S> {
        match self {
            Shape::Plane => Vector::constant([0.0, 0.0, 1.0]),
            Shape::Sphere { side, .. } => unit(c) * side.sign(),
            Shape::Cylinder { side, .. } => unit(across(c)) * side.sign(),
            Shape::Cone { half_angle, side } => {
                let (sin, cos) = half_angle.sin_cos();
                let cone = Cone::at(c, sin, cos);
                let flank = unit(cone.from_axis) * cos - Vector::along(Axis::Z, sin);
                pick(cone.on_flank, flank, unit(cone.from_apex)) * side.sign()
            }
            Shape::Torus { radius, side, .. } => unit(from_circle(c, *radius)) * side.sign(),
        }
    }

    /// `H v`: rate of the normal where `c` moves with `v`.
    pub fn normal_rate(&self, c: Vector<S>, v: Vector<S>) -> Vector<S> {
        match self {
            Shape::Plane => Vector::constant([0.0; 3]),
            Shape::Sphere { side, .. } => unit_rate(c, v) * side.sign(),
            Shape::Cylinder { side, .. } => unit_rate(across(c), across(v)) * side.sign(),
            Shape::Cone { half_angle, side } => {
                let (sin, cos) = half_angle.sin_cos();
                let cone = Cone::at(c, sin, cos);
                let flank = unit_rate(cone.from_axis, across(v)) * cos;
                pick(cone.on_flank, flank, unit_rate(cone.from_apex, v)) * side.sign()
            }
            Shape::Torus { radius, side, .. } => {
                let rate = v - unit_rate(across(c), across(v)) * *radius;
                unit_rate(from_circle(c, *radius), rate) * side.sign()
            }
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

/// From the nearest point of the circle of a radius about z.
fn from_circle<S: Scalar>(c: Vector<S>, radius: S) -> Vector<S> {
    c - unit(across(c)) * radius
}

/// What a cone's two regions need, each put to a harmless place where the other one holds.
struct Cone<S> {
    /// Not negative where the nearest point is on the flank.
    on_flank: S,
    from_axis: Vector<S>,
    from_apex: Vector<S>,
}

impl<S: Scalar> Cone<S> {
    /// The apex is nearest where `ρ sin + z cos < 0`; squared, so that no root is taken on the axis.
    fn at(c: Vector<S>, sin: S, cos: S) -> Self {
        let radial = across(c).squared_norm() * sin * sin;
        let on_flank = radial + c[2] * c[2].abs() * cos * cos;
        let aside = Vector::constant([1.0, 0.0, 0.0]);
        Self { on_flank, from_axis: pick(on_flank, across(c), aside), from_apex: pick(on_flank, aside, c) }
    }
}

/// `a` where `cond ≥ 0`, else `b`.
fn pick<S: Scalar>(cond: S, a: Vector<S>, b: Vector<S>) -> Vector<S> {
    Vector([0, 1, 2].map(|i| S::select(cond, a[i], b[i])))
}

fn unit<S: Scalar>(c: Vector<S>) -> Vector<S> {
    c * (S::constant(1.0) / c.norm())
}

fn unit_rate<S: Scalar>(c: Vector<S>, v: Vector<S>) -> Vector<S> {
    let e = unit(c);
    (v - e * e.dot(v)) * (S::constant(1.0) / c.norm())
}
