//! [`Pac2002`]: the Magic Formula in its form PAC2002, read from a `.tir` file.
//!
//! ```text
//! y = D sin(C atan(B x − E (B x − atan(B x)))) + S_V,   x = slip + S_H
//! ```
//! with factors that depend on load, camber and pressure; [`pure`] has the forces of one slip alone, [`combined`] what slip
//! along one axis takes from the force along the other, [`moments`] the rest, [`coefficients`] the way out of the file. Turn
//! slip is not in it (all `ζ = 1`).
//!
//! Where the formula leaves what was fitted it is kept reasonable, and says so here: friction and stiffness by load fall to a
//! hundredth of their nominal value, not through zero; without load all forces are zero with finite derivatives, since
//! nothing is divided by the load.
//!
//! # References
//! Pacejka, *Tire and Vehicle Dynamics*, 2002, sec. 4.3; MSC Software, *Adams/Tire*, "Using the PAC2002 tire model".

pub mod coefficients;
pub mod combined;
pub mod moments;
pub mod pure;

use headland_expr::{Scalar, Spline};

use crate::guard::num;
use crate::law::{Forces, Slip, SlipLaw};
use crate::tir::{Note, Tir, TirError};
use crate::vertical::{Stiffness, Vertical};
use coefficients::Coefficients;

/// The side of the vehicle for which a tyre was measured.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// Ranges of the measurements, each from least to greatest; the formula itself does not stop at them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ranges {
    /// Of `κ`.
    pub kappa: [f64; 2],
    /// Of `α`, rad.
    pub alpha: [f64; 2],
    /// Of `γ`, rad.
    pub camber: [f64; 2],
    /// Of the load, N.
    pub load: [f64; 2],
}

/// A tyre by the Magic Formula PAC2002.
///
/// ```
/// use headland_tyre::{Pac2002, Slip, SlipLaw};
/// let file = "[UNITS]\nLENGTH='meter'\nFORCE='newton'\nANGLE='radians'\nMASS='kg'\nTIME='second'\n\
///     [DIMENSION]\nUNLOADED_RADIUS=0.5\n[VERTICAL]\nFNOMIN=30000\n\
///     [LATERAL_COEFFICIENTS]\nPCY1=1.6\nPDY1=0.8\nPKY1=-10\nPKY2=3\n";
/// let tyre = Pac2002::parse(file).unwrap();
/// let side = tyre.forces(30e3, 1.0, &Slip::forward(0.0, 0.05)).fy;
/// assert!(side < 0.0 && side > -0.8 * 30e3);
/// println!("{}", tyre.notes()[0]); // no section [SCALING_COEFFICIENTS]; assumed: all of its coefficients are 1
/// ```
#[derive(Clone, PartialEq, Debug)]
pub struct Pac2002 {
    c: Coefficients,
    radius: f64,
    load: f64,
    /// Over the nominal pressure.
    pressure: f64,
    /// Speed of measurement.
    speed: f64,
    stiffness: Option<f64>,
    damping: f64,
    /// BREFF, DREFF, FREFF.
    effective: [f64; 3],
    /// QFZ1, QFZ2.
    progression: Option<(f64, f64)>,
    curve: Option<Spline>,
    ranges: Ranges,
    side: Side,
    longitudinal: bool,
    lateral: bool,
    combined: bool,
    notes: Vec<Note>,
}

/// What depends on the load alone.
#[derive(Clone, Copy)]
pub(crate) struct Load<S> {
    /// `F_z ≥ 0`.
    fz: S,
    /// `F_z / F_z0'`.
    q: S,
    /// `(F_z − F_z0') / F_z0'`.
    dfz: S,
}

/// `sin` or `cos` of `C atan(B x − E (B x − atan B x))`, the argument of both: `E ≤ 1` is seen to here.
fn magic<S: Scalar>(b_x: S, c: S, e: S) -> S {
    let e = e.min(num(1.0));
    c * (b_x - e * (b_x - b_x.atan())).atan()
}

impl Pac2002 {
    /// Reads the text of a `.tir` file.
    ///
    /// # Errors
    /// [`TirError`], see [`Pac2002::from_tir`].
    pub fn parse(text: &str) -> Result<Self, TirError> {
        Self::from_tir(&Tir::parse(text)?)
    }

    /// What was found, left out or assumed.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// A coefficient or scaling factor by its name in the file.
    pub fn coefficient(&self, key: &str) -> Option<f64> {
        self.c.clone().slot(&key.to_ascii_lowercase()).copied()
    }

    /// Sets a coefficient or scaling factor by its name in the file; false where there is none of that name.
    pub fn set_coefficient(&mut self, key: &str, value: f64) -> bool {
        self.c.slot(&key.to_ascii_lowercase()).map(|slot| *slot = value).is_some()
    }

    /// Radius without load `R_0`, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Nominal load, scaled, `F_z0' = λ_Fz0 F_z0`, N.
    pub fn nominal_load(&self) -> f64 {
        self.c.lfzo * self.load
    }

    /// Ranges of the measurements.
    pub fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// The side for which it was measured: on the other one use [`mirrored`](Self::mirrored_forces) forces.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Sets the inflation pressure over the nominal one.
    pub fn set_pressure_ratio(&mut self, ratio: f64) {
        self.pressure = ratio;
    }

    /// Forces of the same tyre on the other side of the vehicle.
    pub fn mirrored_forces<S: Scalar>(&self, load: S, friction: S, slip: &Slip<S>) -> Forces<S> {
        let mirror = Slip { tan_alpha: -slip.tan_alpha, camber: -slip.camber, ..*slip };
        self.forces(load, friction, &mirror).mirrored()
    }

    /// The vertical law of the file: its load curve, else `QFZ1`, `QFZ2`, else its linear stiffness; `None` without any.
    ///
    /// ```text
    /// F_z = λ_Cz C_z ρ      or  λ_Cz F_z0 (q_Fz1 ρ/R_0 + q_Fz2 (ρ/R_0)²)
    /// ```
    pub fn vertical<S: Scalar>(&self) -> Option<Vertical<S>> {
        let spring = match (&self.curve, self.progression, self.stiffness) {
            (Some(curve), ..) => Stiffness::Table(curve.clone()),
            (_, Some((q1, q2)), _) if q1 > 0.0 => {
                let scale = self.c.lcz * self.load / self.radius;
                Stiffness::Quadratic { stiffness: num(scale * q1), progression: num(scale * q2 / self.radius) }
            }
            (.., Some(k)) => Stiffness::Linear { stiffness: num(k * self.c.lcz) },
            _ => return None,
        };
        Some(Vertical { spring, damping: num(self.damping), onset: num(1e-3) })
    }

    /// Effective radius of rolling `R_e` in m at a deflection `ρ ≥ 0` in m; without stiffness in the file, `R_0 − ρ/3`.
    ///
    /// ```text
    /// R_e = R_0 − ρ_0 (D_reff atan(B_reff ρ/ρ_0) + F_reff ρ/ρ_0)     ρ_0 = F_z0' / (λ_Cz C_z)
    /// ```
    pub fn effective_radius<S: Scalar>(&self, deflection: S) -> S {
        let radius = num::<S>(self.radius);
        let Some(k) = self.stiffness else { return radius - deflection * num(1.0 / 3.0) };
        let [b, d, f] = self.effective.map(num::<S>);
        let nominal = num::<S>(self.nominal_load() / (self.c.lcz * k));
        let part = deflection / nominal;
        radius - nominal * (d * (b * part).atan() + f * part)
    }

    /// Relaxation lengths `[σ_κ, σ_α]` in m, at least a hundredth of the radius.
    ///
    /// ```text
    /// σ_κ = F_z (p_Tx1 + p_Tx2 df_z) exp(−p_Tx3 df_z) R_0/F_z0 λ_σκ
    /// σ_α = p_Ty1 sin(2 atan(F_z/(p_Ty2 F_z0'))) (1 − p_Ky3 |γ|) R_0 λ_Fz0 λ_σα
    /// ```
    /// Some programs write `exp(p_Tx3 df_z)`; with the coefficients in use that makes `σ_κ` grow without bound at high load.
    pub fn relaxation_lengths<S: Scalar>(&self, load: S, camber: S) -> [S; 2] {
        let Load { q, dfz, .. } = self.at(load);
        let c = &self.c;
        let kappa = q * num(c.lfzo) * (num::<S>(c.ptx1) + num::<S>(c.ptx2) * dfz) * (num::<S>(-c.ptx3) * dfz).exp();
        let p2 = num::<S>(c.pty2);
        let sine = num::<S>(2.0) * q * p2 / (p2 * p2 + q * q).max(num(1e-12));
        let alpha = num::<S>(c.pty1 * c.lfzo * c.lsgal) * sine * (num::<S>(1.0) - num::<S>(c.pky3) * camber.abs());
        [kappa * num(c.lsgkp), alpha].map(|x| (x * num(self.radius)).max(num(0.01 * self.radius)))
    }

    pub(crate) fn at<S: Scalar>(&self, load: S) -> Load<S> {
        let fz = load.max(num(0.0));
        let q = fz / num(self.nominal_load());
        Load { fz, q, dfz: q - num(1.0) }
    }

    /// Relative change of pressure `dp_i`.
    fn dpi(&self) -> f64 {
        self.pressure - 1.0
    }
}

/// `a + b df_z`, not below a hundredth of `a` (in its direction).
fn by_load<S: Scalar>(a: f64, b: f64, dfz: S) -> S {
    let ratio = if a == 0.0 { 0.0 } else { b / a };
    num::<S>(a) * (num::<S>(1.0) + num::<S>(ratio) * dfz).max(num(0.01))
}

impl<S: Scalar> SlipLaw<S> for Pac2002 {
    fn forces(&self, load: S, friction: S, slip: &Slip<S>) -> Forces<S> {
        let at = self.at(load);
        let friction = friction.max(num(1e-3));
        let x = self.pure_x(&at, friction, slip.kappa, slip.camber);
        let alpha = slip.tan_alpha.atan();
        let y = self.pure_y(&at, friction, alpha, slip.camber);
        let zero = num::<S>(0.0);
        let (mut fx, mut fy, mut swing) = (x.force, y.force, zero);
        if self.combined && self.longitudinal && self.lateral {
            fx = fx * self.weight_x(&at, slip.kappa, alpha);
            swing = self.kappa_induced(&at, y.friction, slip.kappa, alpha, slip.camber);
            fy = fy * self.weight_y(&at, slip.kappa, alpha) + swing;
        }
        if !self.longitudinal {
            fx = zero;
        }
        if !self.lateral {
            (fy, swing) = (zero, zero);
        }
        let mz = if self.lateral { self.aligning(&at, friction, slip, alpha, &x, &y, [fx, fy, swing]) } else { zero };
        let mx = if self.lateral { self.overturning(&at, fy, slip.camber) } else { zero };
        Forces { fx, fy, mx, my: self.rolling(&at, &x, fx, slip), mz }
    }

    fn stiffness(&self, load: S) -> [S; 2] {
        let (zero, one) = (num(0.0), num(1.0));
        let at = self.at(load);
        let x = self.pure_x(&at, one, zero, zero);
        let y = self.pure_y(&at, one, zero, zero);
        let size = |on: bool, k: S| if on { (k * at.fz).abs() } else { zero };
        [size(self.longitudinal, x.stiffness), size(self.lateral, y.stiffness)]
    }
}
