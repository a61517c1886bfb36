//! Inertias of homogeneous bodies of simple form, mass centre at the origin, axes along the frame's.
//!
//! Masses in kg, lengths in m. A body with an axis of symmetry takes it as an argument.
//!
//! # References
//! Closed forms by integration; each is held against quadrature in `tests/shapes.rs`.

use headland_expr::Scalar;

use crate::inertia::Inertia;
use crate::symmetric::Symmetric;
use crate::vector::{Axis, Vector};

impl<S: Scalar> Inertia<S> {
    fn of_moments(mass: S, xx: S, yy: S, zz: S) -> Self {
        Self::new(mass, Vector::zero(), Symmetric::diagonal(xx, yy, zz))
    }

    /// `along` about `axis`, `across` about any axis normal to it.
    fn of_revolution(mass: S, axis: Axis, along: S, across: S) -> Self {
        let mut moments = [across; 3];
        moments[axis.index()] = along;
        Self::of_moments(mass, moments[0], moments[1], moments[2])
    }

    /// Solid box with the given edges: `m (y² + z²)/12`, …
    pub fn solid_box(mass: S, x: S, y: S, z: S) -> Self {
        let k = mass * S::constant(1.0 / 12.0);
        Self::of_moments(mass, k * (y * y + z * z), k * (x * x + z * z), k * (x * x + y * y))
    }

    /// Solid cylinder: `m r²/2` and `m (3 r² + l²)/12`.
    pub fn solid_cylinder(mass: S, radius: S, length: S, axis: Axis) -> Self {
        let (rr, ll) = (radius * radius, length * length);
        let across = mass * (rr * S::constant(0.25) + ll * S::constant(1.0 / 12.0));
        Self::of_revolution(mass, axis, mass * rr * S::constant(0.5), across)
    }

    /// Solid cylinder with a coaxial hole: `m (R² + r²)/2` and `m (3 (R² + r²) + l²)/12`.
    pub fn tube(mass: S, outer_radius: S, inner_radius: S, length: S, axis: Axis) -> Self {
        let (rr, ll) = (outer_radius * outer_radius + inner_radius * inner_radius, length * length);
        let across = mass * (rr * S::constant(0.25) + ll * S::constant(1.0 / 12.0));
        Self::of_revolution(mass, axis, mass * rr * S::constant(0.5), across)
    }

    /// Cylinder wall without lids: `m r²` and `m (6 r² + l²)/12`.
    pub fn cylindrical_shell(mass: S, radius: S, length: S, axis: Axis) -> Self {
        let (rr, ll) = (radius * radius, length * length);
        let across = mass * (rr * S::constant(0.5) + ll * S::constant(1.0 / 12.0));
        Self::of_revolution(mass, axis, mass * rr, across)
    }

    /// Solid sphere: `2 m r²/5`.
    pub fn solid_sphere(mass: S, radius: S) -> Self {
        let i = mass * radius * radius * S::constant(0.4);
        Self::of_moments(mass, i, i, i)
    }

    /// Sphere without inside: `2 m r²/3`.
    pub fn spherical_shell(mass: S, radius: S) -> Self {
        let i = mass * radius * radius * S::constant(2.0 / 3.0);
        Self::of_moments(mass, i, i, i)
    }

    /// Solid ellipsoid with the given semi-axes: `m (b² + c²)/5`, …
    pub fn solid_ellipsoid(mass: S, a: S, b: S, c: S) -> Self {
        let k = mass * S::constant(0.2);
        Self::of_moments(mass, k * (b * b + c * c), k * (a * a + c * c), k * (a * a + b * b))
    }

    /// Thin rod: `m l²/12` across, nothing about its own axis.
    pub fn rod(mass: S, length: S, axis: Axis) -> Self {
        Self::of_revolution(mass, axis, S::constant(0.0), mass * length * length * S::constant(1.0 / 12.0))
    }

    /// Thin disc: `m r²/2` about its axis, `m r²/4` about a diameter.
    pub fn disc(mass: S, radius: S, axis: Axis) -> Self {
        let i = mass * radius * radius;
        Self::of_revolution(mass, axis, i * S::constant(0.5), i * S::constant(0.25))
    }

    /// Thin ring (hoop): `m r²` about its axis, `m r²/2` about a diameter.
    pub fn ring(mass: S, radius: S, axis: Axis) -> Self {
        let i = mass * radius * radius;
        Self::of_revolution(mass, axis, i, i * S::constant(0.5))
    }

    /// Solid torus, centre line of radius R, section of radius r: `m (R² + 3 r²/4)` and `m (R²/2 + 5 r²/8)`.
    pub fn solid_torus(mass: S, centre_radius: S, section_radius: S, axis: Axis) -> Self {
        let (RR, rr) = (centre_radius * centre_radius, section_radius * section_radius);
        let along = mass * (RR + rr * S::constant(0.75));
        Self::of_revolution(mass, axis, along, mass * (RR * S::constant(0.5) + rr * S::constant(0.625)))
    }

    /// Solid cone, mass centre at the origin, that is `h/4` above the base: `3 m r²/10` and `3 m (4 r² + h²)/80`.
    pub fn solid_cone(mass: S, radius: S, height: S, axis: Axis) -> Self {
        let (rr, hh) = (radius * radius, height * height);
        let across = mass * (rr * S::constant(0.15) + hh * S::constant(0.0375));
        Self::of_revolution(mass, axis, mass * rr * S::constant(0.3), across)
    }
}
