//! Forces of longitudinal or lateral slip alone.

use headland_expr::Scalar;

use super::{Load, Pac2002, by_load, magic};
use crate::guard::num;

/// A force with the factors that other parts of the formula use.
#[derive(Clone, Copy, Debug)]
pub struct Pure<S> {
    /// The force, N.
    pub force: S,
    /// Slip stiffness over the load, `K/F_z`, with the sign of the file.
    pub stiffness: S,
    /// Friction `μ`, with the sign of the file.
    pub friction: S,
    /// `B C`.
    pub slope: S,
    /// `S_H`.
    pub shift: S,
    /// `S_V / F_z`.
    pub lift: S,
}

impl Pac2002 {
    /// Longitudinal force without lateral slip.
    ///
    /// ```text
    /// F_x0 = D_x sin(C_x atan(B_x κ_x − E_x (B_x κ_x − atan B_x κ_x))) + S_Vx     κ_x = κ + S_Hx,  γ_x = γ λ_γx
    /// C_x = p_Cx1 λ_Cx        D_x = μ_x F_z
    /// μ_x = (p_Dx1 + p_Dx2 df_z)(1 + p_px3 dp + p_px4 dp²)(1 − p_Dx3 γ_x²) λ_μx
    /// E_x = (p_Ex1 + p_Ex2 df_z + p_Ex3 df_z²)(1 − p_Ex4 sgn κ_x) λ_Ex ≤ 1
    /// K_x = F_z (p_Kx1 + p_Kx2 df_z) exp(p_Kx3 df_z)(1 + p_px1 dp + p_px2 dp²) λ_Kx     B_x = K_x / (C_x D_x)
    /// S_Hx = (p_Hx1 + p_Hx2 df_z) λ_Hx        S_Vx = F_z (p_Vx1 + p_Vx2 df_z) λ_Vx λ_μx
    /// ```
    /// `friction` multiplies `λ_μx`.
    pub(crate) fn pure_x<S: Scalar>(&self, at: &Load<S>, friction: S, kappa: S, camber: S) -> Pure<S> {
        let (c, dfz, dp) = (&self.c, at.dfz, self.dpi());
        let lift = num::<S>(c.lvx * c.lmux) * friction * (num::<S>(c.pvx1) + num::<S>(c.pvx2) * dfz);
        let shift = num::<S>(c.lhx) * (num::<S>(c.phx1) + num::<S>(c.phx2) * dfz);
        let gamma = camber * num(c.lgax);
        let lean = (num::<S>(1.0) - num::<S>(c.pdx3) * gamma * gamma).max(num(0.01));
        let pressure = (1.0 + dp * (c.ppx3 + dp * c.ppx4)) * c.lmux;
        let mu = by_load(c.pdx1, c.pdx2, dfz) * num(pressure) * lean * friction;
        let stiffness = by_load(c.pkx1, c.pkx2, dfz)
            * (num::<S>(c.pkx3) * dfz).exp()
            * num((1.0 + dp * (c.ppx1 + dp * c.ppx2)) * c.lkx);
        let kappa_x = kappa + shift;
        let e = (num::<S>(c.pex1) + dfz * (num::<S>(c.pex2) + num::<S>(c.pex3) * dfz))
            * (num::<S>(1.0) - num::<S>(c.pex4) * kappa_x.sign())
            * num(c.lex);
        let shape = num::<S>(c.pcx1 * c.lcx);
        self.pure(self.longitudinal, at, [kappa_x, shape, e, mu, stiffness], [shift, lift])
    }

    /// Lateral force without longitudinal slip.
    ///
    /// ```text
    /// F_y0 = D_y sin(C_y atan(B_y α_y − E_y (B_y α_y − atan B_y α_y))) + S_Vy     α_y = α + S_Hy,  γ_y = γ λ_γy
    /// C_y = p_Cy1 λ_Cy        D_y = μ_y F_z
    /// μ_y = (p_Dy1 + p_Dy2 df_z)(1 + p_py3 dp + p_py4 dp²)(1 − p_Dy3 γ_y²) λ_μy
    /// E_y = (p_Ey1 + p_Ey2 df_z)(1 − (p_Ey3 + p_Ey4 γ_y) sgn α_y) λ_Ey ≤ 1
    /// K_y = p_Ky1 (1 + p_py1 dp) F_z0' sin(2 atan(F_z/(p_Ky2 (1 + p_py2 dp) F_z0'))) (1 − p_Ky3 |γ_y|) λ_Ky
    /// B_y = K_y / (C_y D_y)
    /// S_Hy = (p_Hy1 + p_Hy2 df_z) λ_Hy + p_Hy3 γ_y λ_Kγ
    /// S_Vy = F_z ((p_Vy1 + p_Vy2 df_z) λ_Vy + (p_Vy3 + p_Vy4 df_z) γ_y λ_Kγ) λ_μy
    /// ```
    /// With `sin(2 atan x) = 2x/(1 + x²)`, `K_y/F_z` has no pole without load. `friction` multiplies `λ_μy`.
    pub(crate) fn pure_y<S: Scalar>(&self, at: &Load<S>, friction: S, alpha: S, camber: S) -> Pure<S> {
        let (c, dfz, dp) = (&self.c, at.dfz, self.dpi());
        let gamma = camber * num(c.lgay);
        let lift_camber = num::<S>(c.lkg) * (num::<S>(c.pvy3) + num::<S>(c.pvy4) * dfz) * gamma;
        let lift = num::<S>(c.lvy) * (num::<S>(c.pvy1) + num::<S>(c.pvy2) * dfz) + lift_camber;
        let lift = num::<S>(c.lmuy) * friction * lift;
        let shift = num::<S>(c.lhy) * (num::<S>(c.phy1) + num::<S>(c.phy2) * dfz) + num::<S>(c.phy3 * c.lkg) * gamma;
        let lean = (num::<S>(1.0) - num::<S>(c.pdy3) * gamma * gamma).max(num(0.01));
        let pressure = (1.0 + dp * (c.ppy3 + dp * c.ppy4)) * c.lmuy;
        let mu = by_load(c.pdy1, c.pdy2, dfz) * num(pressure) * lean * friction;
        let p2 = num::<S>(c.pky2 * (1.0 + c.ppy2 * dp));
        let factor = 2.0 * c.pky1 * (1.0 + c.ppy1 * dp) * c.lky;
        let camber_factor = (num::<S>(1.0) - num::<S>(c.pky3) * gamma.abs()).max(num(0.01));
        let stiffness = num::<S>(factor) * p2 / (p2 * p2 + at.q * at.q).max(num(1e-12)) * camber_factor;
        let alpha_y = alpha + shift;
        let e = (num::<S>(c.pey1) + num::<S>(c.pey2) * dfz)
            * (num::<S>(1.0) - (num::<S>(c.pey3) + num::<S>(c.pey4) * gamma) * alpha_y.sign())
            * num(c.ley);
        let shape = num::<S>(c.pcy1 * c.lcy);
        self.pure(self.lateral, at, [alpha_y, shape, e, mu, stiffness], [shift, lift])
    }

    /// `D sin(C atan(..)) + S_V` of a direction that the file has, else zero.
    fn pure<S: Scalar>(&self, there: bool, at: &Load<S>, of: [S; 5], of_shift: [S; 2]) -> Pure<S> {
        let ([slip, shape, e, friction, stiffness], [shift, lift]) = (of, of_shift);
        if !there {
            let (zero, one) = (num(0.0), num(1.0));
            return Pure { force: zero, stiffness: one, friction: one, slope: zero, shift: zero, lift: zero };
        }
        let slope = stiffness / friction;
        let force = at.fz * (friction * magic(slope / shape * slip, shape, e).sin() + lift);
        Pure { force, stiffness, friction, slope, shift, lift }
    }
}
