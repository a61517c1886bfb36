//! Aligning, overturning and rolling-resistance moments.

use std::f64::consts::PI;

use headland_expr::Scalar;

use super::combined::cos_atan;
use super::pure::Pure;
use super::{Load, Pac2002, magic};
use crate::guard::{num, power};
use crate::law::Slip;

impl Pac2002 {
    /// Aligning moment `M_z`, N·m.
    ///
    /// ```text
    /// M_z = −t F_y' + M_zr + s F_x        F_y' = F_y − S_Vyκ
    /// t = D_t cos(C_t atan(B_t a_t − E_t (B_t a_t − atan B_t a_t))) cos α      M_zr = D_r cos(atan(B_r a_r)) cos α
    /// α_t = α + S_Ht,  α_r = α + S_Hy + S_Vy/K_y;   a = atan √(tan² α + (K_x/K_y)² κ²) sgn α of each
    /// B_t = (q_Bz1 + q_Bz2 df_z + q_Bz3 df_z²)(1 + q_Bz4 γ_z + q_Bz5 |γ_z|) λ_Ky/λ_μy       C_t = q_Cz1
    /// D_t = F_z (q_Dz1 + q_Dz2 df_z)(1 − q_pz1 dp)(1 + q_Dz3 γ_z + q_Dz4 γ_z²) R_0/F_z0' λ_t
    /// E_t = (q_Ez1 + q_Ez2 df_z + q_Ez3 df_z²)(1 + (q_Ez4 + q_Ez5 γ_z) (2/π) atan(B_t C_t a_t)) ≤ 1
    /// S_Ht = q_Hz1 + q_Hz2 df_z + (q_Hz3 + q_Hz4 df_z) γ_z
    /// B_r = q_Bz9 λ_Ky/λ_μy + q_Bz10 B_y C_y
    /// D_r = F_z ((q_Dz6 + q_Dz7 df_z) λ_r + (q_Dz8 + q_Dz9 df_z)(1 + q_pz2 dp) γ_z) R_0 λ_μy
    /// s = (s_sz1 + s_sz2 F_y/F_z0' + (s_sz3 + s_sz4 df_z) γ) R_0 λ_s
    /// ```
    /// Trail and residual moment change sign with the direction of rolling. The sign in `a` makes the moment jump where
    /// `α_t = 0` with `κ ≠ 0`, as the formula does; it is small there unless `q_Ez4` is large.
    pub(crate) fn aligning<S: Scalar>(
        &self,
        at: &Load<S>,
        friction: S,
        slip: &Slip<S>,
        alpha: S,
        x: &Pure<S>,
        y: &Pure<S>,
        [fx, fy, swing]: [S; 3],
    ) -> S {
        let (c, dfz, dp) = (&self.c, at.dfz, self.dpi());
        let gamma = slip.camber * num(c.lgaz);
        let along = x.stiffness / y.stiffness * slip.kappa;
        let along = if self.combined && self.longitudinal { along } else { num(0.0) };
        let cosine = cos_atan(slip.tan_alpha) * slip.direction;

        let shift_t = line(c.qhz1, c.qhz2, dfz) + line(c.qhz3, c.qhz4, dfz) * gamma;
        let a_t = equivalent(alpha + shift_t, along);
        let ratio = num::<S>(c.lky / c.lmuy) / friction;
        let b = (num::<S>(c.qbz1) + dfz * line(c.qbz2, c.qbz3, dfz))
            * (num::<S>(1.0) + num::<S>(c.qbz4) * gamma + num::<S>(c.qbz5) * gamma.abs())
            * ratio;
        let lean = num::<S>(1.0) + gamma * line(c.qdz3, c.qdz4, gamma);
        let size = (1.0 - c.qpz1 * dp) * self.radius * c.ltr;
        let d = at.q * line(c.qdz1, c.qdz2, dfz) * lean * num(size);
        let turn = num::<S>(2.0 / PI) * (b * num(c.qcz1) * a_t).atan();
        let e =
            (num::<S>(c.qez1) + dfz * line(c.qez2, c.qez3, dfz)) * (num::<S>(1.0) + line(c.qez4, c.qez5, gamma) * turn);
        let trail = d * magic(b * a_t, num(c.qcz1), e).cos() * cosine;

        let a_r = equivalent(alpha + y.shift + y.lift / y.stiffness, along);
        let b_r = num::<S>(c.qbz9) * ratio + num::<S>(c.qbz10) * y.slope;
        let d_r = line(c.qdz6, c.qdz7, dfz) * num(c.lres) + line(c.qdz8, c.qdz9, dfz) * num(1.0 + c.qpz2 * dp) * gamma;
        let residual = at.fz * d_r * num(self.radius * c.lmuy) * friction * cos_atan(b_r * a_r) * cosine;

        let arm = (line(c.ssz1, c.ssz2, fy / num(self.nominal_load())) + line(c.ssz3, c.ssz4, dfz) * slip.camber)
            * num(self.radius * c.ls);
        let arm = if self.combined { arm } else { num(0.0) };
        residual - trail * (fy - swing) + arm * fx
    }

    /// Overturning moment `M_x`, N·m.
    ///
    /// ```text
    /// M_x = R_0 F_z λ_Mx (q_sx1 λ_VMx − q_sx2 (1 + q_px1 dp) γ + q_sx3 F_y/F_z0'
    ///       + q_sx4 cos(q_sx5 atan((q_sx6 F_z/F_z0')²)) sin(q_sx7 γ + q_sx8 atan(q_sx9 F_y/F_z0'))
    ///       + q_sx10 atan(q_sx11 F_z/F_z0') γ)
    /// ```
    pub(crate) fn overturning<S: Scalar>(&self, at: &Load<S>, fy: S, camber: S) -> S {
        let (c, dp) = (&self.c, self.dpi());
        let side = fy / num(self.nominal_load());
        let lean = num::<S>(c.qsx10) * (num::<S>(c.qsx11) * at.q).atan() - num(c.qsx2 * (1.0 + c.qpx1 * dp));
        let mut sum = num::<S>(c.qsx1 * c.lvmx) + lean * camber + num::<S>(c.qsx3) * side;
        if c.qsx4 != 0.0 {
            let load = num::<S>(c.qsx6) * at.q;
            let swing = num::<S>(c.qsx7) * camber + num::<S>(c.qsx8) * (num::<S>(c.qsx9) * side).atan();
            sum = sum + num::<S>(c.qsx4) * (num::<S>(c.qsx5) * (load * load).atan()).cos() * swing.sin();
        }
        at.fz * sum * num(self.radius * c.lmx)
    }

    /// Rolling-resistance moment `M_y`, N·m, against the direction `d` of rolling.
    ///
    /// ```text
    /// M_y = −d R_0 F_z λ_My (q_sy1 + q_sy2 F_x/F_z0' + q_sy3 |V_x/V_0| + q_sy4 (V_x/V_0)⁴ + (q_sy5 + q_sy6 F_z/F_z0') γ²)
    ///       (F_z/F_z0')^q_sy7 (p/p_0)^q_sy8
    /// M_y = −d R_0 λ_My (S_Vx + K_x S_Hx)     where q_sy1 = q_sy2 = 0
    /// ```
    pub(crate) fn rolling<S: Scalar>(&self, at: &Load<S>, x: &Pure<S>, fx: S, slip: &Slip<S>) -> S {
        let c = &self.c;
        let size = slip.direction * num(-self.radius * c.lmy) * at.fz;
        if c.qsy1 == 0.0 && c.qsy2 == 0.0 {
            return size * (x.lift + x.stiffness * x.shift);
        }
        let v = slip.speed / num(self.speed);
        let camber = slip.camber * slip.camber * line(c.qsy5, c.qsy6, at.q);
        let traction = num::<S>(c.qsy2 / self.nominal_load()) * fx;
        let f = num::<S>(c.qsy1) + traction + num::<S>(c.qsy3) * v.abs() + num::<S>(c.qsy4) * v.powi(4) + camber;
        let by_pressure = num::<S>(self.pressure.max(1e-6).powf(c.qsy8));
        let by_load = if c.qsy7 == 0.0 { num(1.0) } else { power(at.q, num(c.qsy7)) };
        size * f * by_load * by_pressure
    }
}

fn line<S: Scalar>(a: f64, b: f64, x: S) -> S {
    num::<S>(a) + num::<S>(b) * x
}

/// `atan √(tan² α + x²) sgn α`; without `x` it is `α`, also at zero, where the root has no derivative.
fn equivalent<S: Scalar>(alpha: S, x: S) -> S {
    let tan = alpha.tan();
    let square = tan * tan + x * x;
    let bent = square.max(num(1e-30)).sqrt().atan() * alpha.sign();
    S::select(x.abs() - num(1e-15), bent, alpha)
}
