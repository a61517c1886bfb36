//! [`TMeasy`]: Rill's tyre, a curve of five numbers an axis.

use headland_expr::Scalar;

use crate::guard::{clamp, num};
use crate::law::{Forces, Slip, SlipLaw};

/// Characteristics along one axis at one load.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Curve<S> {
    /// Slope at zero slip `dF₀`, N.
    pub slope: S,
    /// Slip of the greatest force `s_M`.
    pub peak_slip: S,
    /// The greatest force `F_M`, N.
    pub peak: S,
    /// Slip from which on the tyre slides, `s_S > s_M`.
    pub slide_slip: S,
    /// The force of sliding `F_S`, N.
    pub slide: S,
}

/// Pneumatic trail at one load.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Trail<S> {
    /// Trail at zero slip over the contact length, `(n/L)₀`.
    pub share: S,
    /// Lateral slip at which it first vanishes, `s_y⁰`.
    pub zero_slip: S,
    /// Lateral slip from which on it stays zero, `s_y^E > s_y⁰`.
    pub end_slip: S,
}

/// All characteristics at one load.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Characteristics<S> {
    /// Longitudinal.
    pub x: Curve<S>,
    /// Lateral.
    pub y: Curve<S>,
    /// Aligning.
    pub trail: Trail<S>,
}

/// The TMeasy tyre, given at its nominal load and at twice that.
///
/// ```text
/// s_x, s_y      theoretical slip; camber: s_y + ⅓ s_γ,  s_γ = ½ L sin γ / R (the lateral slip of a leaning wheel's arc)
/// ŝ = s_M/(s_Mx + s_My) + (F_M/dF₀)/(F_Mx/dF₀x + F_My/dF₀y)           of each axis; s_N = s/ŝ,  s = |s_N| = |(s_Nx, s_Ny)|
/// (cos φ, sin φ) = s_N / s        dF₀ = |(dF₀x ŝ_x cos φ, dF₀y ŝ_y sin φ)|, F_M, F_S likewise, s_M, s_S with 1/ŝ
/// F = s dF₀ / (1 + u (u + dF₀ s_M/F_M − 2)),  u = s/s_M                                s ≤ s_M
/// F = F_M − (F_M − F_S) u² (3 − 2u),          u = (s − s_M)/(s_S − s_M)                s_M < s ≤ s_S
/// F = F_S                                                                              s > s_S
/// F_x = F cos φ,  F_y = −F sin φ,  M_z = −n d F_y
/// n/L = (n/L)₀ ((1 − w)(1 − u) + w (1 − (3 − 2u) u²)),  u = s_y/s_y⁰,  w = s_y⁰/s_y^E     s_y ≤ s_y⁰
/// n/L = −(n/L)₀ (1 − w) (s_y − s_y⁰)/s_y⁰ ((s_y^E − s_y)/(s_y^E − s_y⁰))²               s_y⁰ < s_y ≤ s_y^E, then 0
/// ```
/// Forces and slopes follow the load by a parabola through zero and the two given loads, slips by a straight line, up to 3.5
/// nominal loads; from there on the curves stay. The contact length grows with the root of the load.
///
/// # References
/// Rill, *Road Vehicle Dynamics*, 2012, ch. 3.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TMeasy<S> {
    /// Nominal load `F_zN`, N.
    pub load: S,
    /// At the nominal load.
    pub nominal: Characteristics<S>,
    /// At twice the nominal load.
    pub double: Characteristics<S>,
    /// Contact length `L` at the nominal load, m.
    pub contact_length: S,
    /// Radius `R`, m, for camber.
    pub radius: S,
}

impl<S: Scalar> Curve<S> {
    /// Curve of truck tyres at a load `p`, forces over `p`; see [`TMeasy::truck`].
    fn shares(of: [f64; 5], load: S) -> Self {
        let [slope, peak, slide, peak_slip, slide_slip] = of.map(num::<S>);
        Self { slope: slope * load, peak: peak * load, slide: slide * load, peak_slip, slide_slip }
    }

    /// Between the nominal load and its double, `q = F_z/F_zN`.
    fn at(a: &Self, b: &Self, q: S) -> Self {
        let force = |a: S, b: S| {
            let half = num::<S>(0.5) * b;
            q * (num::<S>(2.0) * a - half - (a - half) * q)
        };
        let slip = |a: S, b: S| a + (b - a) * (q - num(1.0));
        Self {
            slope: force(a.slope, b.slope),
            peak: force(a.peak, b.peak),
            slide: force(a.slide, b.slide),
            peak_slip: slip(a.peak_slip, b.peak_slip),
            slide_slip: slip(a.slide_slip, b.slide_slip),
        }
    }

    /// `F(s)`, `s ≥ 0`.
    pub fn force(&self, s: S) -> S {
        let one = num::<S>(1.0);
        let u = (s / self.peak_slip).min(one);
        // F_M may vanish with the load, its ratio to dF₀ does not: guard both alike
        let tiny = num::<S>(1e-12);
        let steep = (self.slope + tiny) * self.peak_slip / (self.peak + tiny);
        let rising = u * self.peak_slip * self.slope / (one + u * (u + steep - num(2.0)));
        let v = clamp((s - self.peak_slip) / (self.slide_slip - self.peak_slip), num(0.0), one);
        let falling = self.peak - (self.peak - self.slide) * v * v * (num::<S>(3.0) - num::<S>(2.0) * v);
        S::select(self.peak_slip - s, rising, falling)
    }
}

impl<S: Scalar> Trail<S> {
    fn at(a: &Self, b: &Self, q: S) -> Self {
        let line = |a: S, b: S| a + (b - a) * (q - num(1.0));
        Self {
            share: line(a.share, b.share),
            zero_slip: line(a.zero_slip, b.zero_slip),
            end_slip: line(a.end_slip, b.end_slip),
        }
    }

    /// `n/L` by the size of the lateral slip.
    pub fn of(&self, s: S) -> S {
        let (one, two, three) = (num::<S>(1.0), num::<S>(2.0), num::<S>(3.0));
        let w = self.zero_slip / self.end_slip;
        let u = (s / self.zero_slip).min(one);
        let before = (one - w) * (one - u) + w * (one - (three - two * u) * u * u);
        let beyond = clamp(s, self.zero_slip, self.end_slip);
        let v = (self.end_slip - beyond) / (self.end_slip - self.zero_slip);
        let after = (w - one) * (beyond - self.zero_slip) / self.zero_slip * v * v;
        self.share * S::select(self.zero_slip - s, before, after)
    }
}

impl<S: Scalar> TMeasy<S> {
    /// A truck tyre of aspect ratio 0.8 by its nominal load, which is half the load of its load index times
    /// `(p/p_index)^0.8`, p the pressure; slips and shares are those recommended for trucks.
    ///
    /// # References
    /// `GuessTruck80Par` of Project Chrono (Gericke, 2017, BSD-3), after Rill.
    pub fn truck(load: S, contact_length: S, radius: S) -> Self {
        let two = num::<S>(2.0) * load;
        let trail = |[share, zero_slip, end_slip]: [f64; 3]| Trail {
            share: num(share),
            zero_slip: num(zero_slip),
            end_slip: num(end_slip),
        };
        Self {
            load,
            nominal: Characteristics {
                x: Curve::shares([17.7764, 0.89965, 0.46183, 0.10811, 0.66667], load),
                y: Curve::shares([7.4013, 0.75876, 0.68276, 0.33167, 1.0296], load),
                trail: trail([0.178, 0.36484, 1.0296]),
            },
            double: Characteristics {
                x: Curve::shares([14.5301, 0.77751, 0.42349, 0.12389, 0.66667], two),
                y: Curve::shares([6.8505, 0.72628, 0.65319, 0.33216, 1.0296], two),
                trail: trail([0.19, 0.36538, 1.0296]),
            },
            contact_length,
            radius,
        }
    }

    /// The curves at a load, forces times `friction`, slips of peak and slide as well, so that slopes at zero stay.
    pub fn at(&self, load: S, friction: S) -> Characteristics<S> {
        let q = clamp(load / self.load, num(0.0), num(3.5));
        let (a, b) = (&self.nominal, &self.double);
        let scaled = |c: Curve<S>| Curve {
            slope: c.slope,
            peak: friction * c.peak,
            slide: friction * c.slide,
            peak_slip: friction * c.peak_slip,
            slide_slip: friction * c.slide_slip,
        };
        Characteristics {
            x: scaled(Curve::at(&a.x, &b.x, q)),
            y: scaled(Curve::at(&a.y, &b.y, q)),
            trail: Trail::at(&a.trail, &b.trail, q),
        }
    }

    fn contact_length(&self, load: S) -> S {
        self.contact_length * (load / self.load).max(num(1e-12)).sqrt()
    }
}

/// Scales `ŝ` that make the two slips comparable.
fn slip_scales<S: Scalar>(c: &Characteristics<S>) -> [S; 2] {
    let tiny = num::<S>(1e-12);
    let reach = |c: &Curve<S>| (c.peak + tiny) / (c.slope + tiny);
    let (slips, reaches) = (c.x.peak_slip + c.y.peak_slip, reach(&c.x) + reach(&c.y));
    [c.x.peak_slip / slips + reach(&c.x) / reaches, c.y.peak_slip / slips + reach(&c.y) / reaches]
}

/// The curve in a direction of the normalised slip, given by `[cos² φ, sin² φ]`.
fn combined<S: Scalar>(c: &Characteristics<S>, scale: [S; 2], direction: [S; 2]) -> Curve<S> {
    let mix = |x: S, y: S| (x * x * direction[0] + y * y * direction[1]).max(num(1e-40)).sqrt();
    Curve {
        slope: mix(c.x.slope * scale[0], c.y.slope * scale[1]),
        peak: mix(c.x.peak, c.y.peak),
        slide: mix(c.x.slide, c.y.slide),
        peak_slip: mix(c.x.peak_slip / scale[0], c.y.peak_slip / scale[1]),
        slide_slip: mix(c.x.slide_slip / scale[0], c.y.slide_slip / scale[1]),
    }
}

impl<S: Scalar> SlipLaw<S> for TMeasy<S> {
    fn forces(&self, load: S, friction: S, slip: &Slip<S>) -> Forces<S> {
        let c = self.at(load, friction);
        let scale = slip_scales(&c);
        let [sx, sy] = slip.theoretical();
        let patch = self.contact_length(load);
        let arc = num::<S>(0.5) * patch * slip.camber.sin() / self.radius;
        let sn = [sx / scale[0], (sy + num::<S>(1.0 / 3.0) * arc) / scale[1]];
        // a little under the root: at zero slip there is no direction, x and y are mixed evenly there
        let little = num::<S>(1e-24);
        let squares = [sn[0] * sn[0], sn[1] * sn[1]];
        let square = squares[0] + squares[1] + little;
        let size = square.sqrt();
        let direction = squares.map(|s| (s + num::<S>(0.5) * little) / square);
        let per_slip = combined(&c, scale, direction).force(size) / size;
        let (fx, fy) = (per_slip * sn[0], -per_slip * sn[1]);
        let trail = patch * c.trail.of(sy.abs());
        Forces { fx, fy, mz: -trail * slip.direction * fy, ..Forces::zero() }
    }

    fn stiffness(&self, load: S) -> [S; 2] {
        let c = self.at(load, num(1.0));
        [c.x.slope, c.y.slope]
    }
}
