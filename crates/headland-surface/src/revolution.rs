//! [`Revolution`]: distance from a surface of revolution about z, given by its profile.

use std::fmt;

use headland_expr::{FIELD_PARTS, Field};
use nalgebra::Matrix3;

use crate::implicit::{part, write_second};
use crate::shape::Side;

/// A function of one variable with its first three derivatives.
pub type Profile = Box<dyn Fn(f64) -> [f64; 4] + Send + Sync>;

/// A surface of revolution about z with a smooth profile over a range.
///
/// The nearest point is sought in the plane through the axis: among [`SAMPLES`] pieces of the range, by Newton's method in
/// each piece that holds a minimum of the distance. A profile must not bend more than once within a piece. Where the
/// nearest point is an end of the range there is an edge, and on the axis a point whose foot is not there has a circle of
/// feet: the field is NaN, [`Revolution::foot`] says which.
pub struct Revolution {
    name: String,
    profile: Profile,
    range: [f64; 2],
    kind: Kind,
    sign: f64,
}

/// What the profile gives.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kind {
    /// `r(z)`.
    Radius,
    /// `z(r)`.
    Height,
}

/// Pieces of the range in which a nearest point is sought.
pub const SAMPLES: usize = 96;

/// Why a surface of revolution cannot be, or has no single smooth foot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RevolutionError {
    /// The range is empty, endless, or has negative radii.
    #[error(
        "the profile of `{name}` has the range {from} .. {to} m; it must grow, be finite, and radii not be negative"
    )]
    Range {
        /// Name of the surface.
        name: String,
        /// Start, m.
        from: f64,
        /// End, m.
        to: f64,
    },
    /// The profile has no value, or no positive radius, somewhere.
    #[error("the profile of `{name}` is {value} m at {at} m; it must be finite, and a radius positive")]
    Value {
        /// Name of the surface.
        name: String,
        /// Place, m.
        at: f64,
        /// Value there, m.
        value: f64,
    },
    /// A profile over the radius must be level on the axis, else it is a spike.
    #[error("the profile of `{name}` has the slope {slope} on the axis; it must be level there")]
    Spike {
        /// Name of the surface.
        name: String,
        /// Slope.
        slope: f64,
    },
    /// Nearest is an edge.
    #[error("the nearest point of `{name}` is the end of its profile at {at} m; lengthen the range")]
    Edge {
        /// Name of the surface.
        name: String,
        /// Place of the end, m.
        at: f64,
    },
    /// A point without coordinates.
    #[error("the point asked of `{name}` is not finite")]
    Point {
        /// Name of the surface.
        name: String,
    },
}

impl Revolution {
    /// Radius `r(z)` over a range of z.
    ///
    /// # Errors
    /// [`RevolutionError`] for a range or a profile that makes no surface.
    pub fn of_radius(name: &str, profile: Profile, z: [f64; 2], side: Side) -> Result<Self, RevolutionError> {
        let made = Self { name: name.into(), profile, range: z, kind: Kind::Radius, sign: side.sign() };
        made.check().map(|()| made)
    }

    /// Height `z(r)` over a range of radii, free above; from `r = 0` on it must be even: `z′(0) = z‴(0) = 0`.
    ///
    /// # Errors
    /// [`RevolutionError`] for a range or a profile that makes no surface.
    pub fn of_height(name: &str, profile: Profile, r: [f64; 2]) -> Result<Self, RevolutionError> {
        let made = Self { name: name.into(), profile, range: r, kind: Kind::Height, sign: 1.0 };
        made.check().map(|()| made)
    }

    fn check(&self) -> Result<(), RevolutionError> {
        let [from, to] = self.range;
        let name = || self.name.clone();
        let radii_from = if self.kind == Kind::Height { from } else { 0.0 };
        if !(from < to && from.is_finite() && to.is_finite() && radii_from >= 0.0) {
            return Err(RevolutionError::Range { name: name(), from, to });
        }
        for i in 0..=SAMPLES {
            let at = self.sample(i);
            let all = (self.profile)(at);
            let positive = self.kind == Kind::Height || all[0] > 0.0;
            if !(positive && all.iter().all(|x| x.is_finite())) {
                let value = all.into_iter().find(|x| !x.is_finite()).unwrap_or(all[0]);
                return Err(RevolutionError::Value { name: name(), at, value });
            }
        }
        let slope = (self.profile)(from)[1];
        if self.crosses_axis() && slope.abs() > 1e-9 {
            return Err(RevolutionError::Spike { name: name(), slope });
        }
        Ok(())
    }

    fn sample(&self, i: usize) -> f64 {
        let [from, to] = self.range;
        from + (to - from) * i as f64 / SAMPLES as f64
    }

    /// Whether the surface crosses its axis.
    fn crosses_axis(&self) -> bool {
        self.kind == Kind::Height && self.range[0] == 0.0
    }

    /// The profile, continued across the axis as its own mirror and exactly level there.
    fn graph(&self, s: f64) -> [f64; 4] {
        let [y, y1, y2, y3] = (self.profile)(if self.crosses_axis() { s.abs() } else { s });
        let side = if self.crosses_axis() && s <= 0.0 { if s < 0.0 { -1.0 } else { 0.0 } } else { 1.0 };
        [y, side * y1, y2, side * y3]
    }

    /// Argument of the profile at the nearest point of the plane through the axis: `at` along the argument, `up` along the
    /// value, m.
    ///
    /// # Errors
    /// [`RevolutionError::Edge`] where it is an end of the range.
    fn nearest(&self, at: f64, up: f64) -> Result<f64, RevolutionError> {
        let squared = |s: f64| (s - at).powi(2) + ((self.profile)(s)[0] - up).powi(2);
        let samples: [f64; SAMPLES + 1] = std::array::from_fn(|i| squared(self.sample(i)));
        let on_axis = |i: usize| i == 0 && self.crosses_axis();
        let mut best = (f64::INFINITY, self.range[0]);
        for i in 0..=SAMPLES {
            let before =
                if on_axis(i) { samples[1] } else { *samples.get(i.wrapping_sub(1)).unwrap_or(&f64::INFINITY) };
            let after = *samples.get(i + 1).unwrap_or(&f64::INFINITY);
            if samples[i] <= before && samples[i] <= after {
                let low = if on_axis(i) { -self.sample(1) } else { self.sample(i.saturating_sub(1)) };
                let s = self.refine(at, up, [low, self.sample((i + 1).min(SAMPLES))]);
                let here = squared(s.max(self.range[0]));
                if here < best.0 {
                    best = (here, s.max(self.range[0]));
                }
            }
        }
        let [from, to] = self.range;
        let edge = best.1 == to || (best.1 == from && !on_axis(0));
        if edge || !best.0.is_finite() {
            return Err(RevolutionError::Edge { name: self.name.clone(), at: best.1 });
        }
        Ok(best.1)
    }

    /// Root of the derivative of the squared distance between two places, by Newton's method kept between them by halving.
    fn refine(&self, at: f64, up: f64, [mut low, mut high]: [f64; 2]) -> f64 {
        let slopes = |s: f64| {
            let [y, y1, y2, _] = self.graph(s);
            ((s - at) + (y - up) * y1, 1.0 + y1 * y1 + (y - up) * y2)
        };
        if slopes(low).0 >= 0.0 {
            return low;
        }
        if slopes(high).0 <= 0.0 {
            return high;
        }
        let mut s = at.clamp(low, high);
        for _ in 0..200 {
            let (first, second) = slopes(s);
            if first > 0.0 {
                high = s;
            } else {
                low = s;
            }
            let newton = s - first / second;
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let step = (next - s).abs();
            s = next;
            if step <= 2e-16 * (s.abs() + at.abs()) || first == 0.0 {
                break;
            }
        }
        s
    }

    /// Arguments of the plane's distance: along the profile's argument and along its value.
    fn in_plane(&self, c: [f64; 3]) -> (f64, f64) {
        let rho = c[0].hypot(c[1]);
        if self.kind == Kind::Radius { (c[2], rho) } else { (rho, c[2]) }
    }

    /// A nearest point; on the axis, one of the circle.
    ///
    /// # Errors
    /// [`RevolutionError::Edge`], [`RevolutionError::Point`].
    pub fn foot(&self, c: [f64; 3]) -> Result<[f64; 3], RevolutionError> {
        if c.iter().any(|x| !x.is_finite()) {
            return Err(RevolutionError::Point { name: self.name.clone() });
        }
        let (at, up) = self.in_plane(c);
        let s = self.nearest(at, up)?;
        let value = (self.profile)(s)[0];
        let (rho, z) = if self.kind == Kind::Radius { (value, s) } else { (s, value) };
        let far = c[0].hypot(c[1]);
        let [x, y] = if far > 0.0 { [c[0] / far, c[1] / far] } else { [1.0, 0.0] };
        Ok([rho * x, rho * y, z])
    }

    /// Distance in the plane through the axis, with derivatives along radius and z.
    fn plane(&self, c: [f64; 3]) -> Option<Plane> {
        let (at, up) = self.in_plane(c);
        let s = self.nearest(at, up).ok()?;
        let [y, y1, y2, y3] = self.graph(s);
        let w = y1.hypot(1.0);
        let d = self.sign * ((up - y) / w - (at - s) * y1 / w);
        // curvature of the graph, positive where it is convex seen from above, and its rate along the arc
        let curvature = -self.sign * y2 / w.powi(3);
        let rate = -self.sign * (y3 / w.powi(4) - 3.0 * y1 * y2 * y2 / w.powi(6));
        let spread = 1.0 + d * curvature;
        let (k, turn) = (curvature / spread, rate / spread.powi(3));
        let (n, t) = ([-y1 / w * self.sign, self.sign / w], [1.0 / w, y1 / w]);
        let swap = |v: [f64; 2]| if self.kind == Kind::Radius { [v[1], v[0]] } else { v };
        Some(Plane { d, n: swap(n), t: swap(t), k, turn, on_axis_foot: self.kind == Kind::Height && s == 0.0 })
    }
}

/// `d`, `∇d = n`, `∇∇d = k t t`, and of the third derivatives `ttt = turn`, `ttn = −k²`, the others zero; the components are
/// along radius and z.
struct Plane {
    d: f64,
    n: [f64; 2],
    t: [f64; 2],
    k: f64,
    turn: f64,
    on_axis_foot: bool,
}

impl Plane {
    fn second(&self, i: usize, j: usize) -> f64 {
        self.k * self.t[i] * self.t[j]
    }

    fn third(&self, i: usize, j: usize, l: usize) -> f64 {
        let (t, n) = (&self.t, &self.n);
        let mixed = t[i] * t[j] * n[l] + t[i] * n[j] * t[l] + n[i] * t[j] * t[l];
        self.turn * t[i] * t[j] * t[l] - self.k * self.k * mixed
    }

    /// Second derivative around the axis, `d_ρ/ρ`, and its derivatives along radius and z.
    /// So near the axis, less than `small`, their limits are better.
    fn around(&self, rho: f64, small: f64) -> [f64; 3] {
        if rho > small {
            let hoop = self.n[0] / rho;
            [hoop, (self.second(0, 0) - hoop) / rho, self.second(0, 1) / rho]
        } else {
            [self.second(0, 0), self.third(0, 0, 0) / 3.0, self.third(0, 0, 1)]
        }
    }
}

impl fmt::Debug for Revolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Revolution").field("name", &self.name).field("range", &self.range).finish_non_exhaustive()
    }
}

impl Field for Revolution {
    fn name(&self) -> &str {
        &self.name
    }

    fn eval(&self, c: [f64; 3], order: usize, out: &mut [f64]) {
        out[..FIELD_PARTS[order]].fill(f64::NAN);
        if c.iter().any(|x| !x.is_finite()) {
            return;
        }
        let Some(plane) = self.plane(c) else { return };
        out[0] = plane.d;
        let rho = c[0].hypot(c[1]);
        if order == 0 || (rho == 0.0 && !plane.on_axis_foot) {
            return; // a circle of feet: a distance, no normal
        }
        // columns: along the radius, around the axis, along z
        let (x, y) = if rho > 0.0 { (c[0] / rho, c[1] / rho) } else { (1.0, 0.0) };
        let axes = Matrix3::new(x, -y, 0.0, y, x, 0.0, 0.0, 0.0, 1.0);
        let n = axes.column(0) * plane.n[0] + axes.column(2) * plane.n[1];
        out[1..4].copy_from_slice(n.as_slice());
        if order == 1 {
            return;
        }
        let [hoop, hoop_radius, hoop_z] = plane.around(rho, 1e-9 * self.range[1].abs());
        let (rr, rz, zz) = (plane.second(0, 0), plane.second(0, 1), plane.second(1, 1));
        let h = Matrix3::new(rr, 0.0, rz, 0.0, hoop, 0.0, rz, 0.0, zz);
        write_second(&(axes * h * axes.transpose()), out);
        if order == 2 {
            return;
        }
        let (rrr, rrz, rzz) = (plane.third(0, 0, 0), plane.third(0, 0, 1), plane.third(0, 1, 1));
        let local = [
            Matrix3::new(rrr, 0.0, rrz, 0.0, hoop_radius, 0.0, rrz, 0.0, rzz),
            Matrix3::new(0.0, hoop_radius, 0.0, hoop_radius, 0.0, hoop_z, 0.0, hoop_z, 0.0),
            Matrix3::new(rrz, 0.0, rzz, 0.0, hoop_z, 0.0, rzz, 0.0, plane.third(1, 1, 1)),
        ];
        let turned = local.map(|m| axes * m * axes.transpose());
        for i in 0..3 {
            for j in i..3 {
                for l in j..3 {
                    out[part(&[i, j, l])] = (0..3).map(|m| turned[m][(i, j)] * axes[(l, m)]).sum();
                }
            }
        }
    }
}
