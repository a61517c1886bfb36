//! What slip along one axis takes from the force along the other.

use headland_expr::Scalar;

use super::{Load, Pac2002, magic};
use crate::guard::num;

impl Pac2002 {
    /// Weight of the longitudinal force, 1 without lateral slip.
    ///
    /// ```text
    /// G_xα = cos(C atan(B α_s − E (B α_s − atan B α_s))) / cos(the same with S_Hxα)     α_s = α + S_Hxα
    /// B = r_Bx1 cos(atan(r_Bx2 κ)) λ_xα     C = r_Cx1     E = r_Ex1 + r_Ex2 df_z ≤ 1     S_Hxα = r_Hx1
    /// ```
    pub(crate) fn weight_x<S: Scalar>(&self, at: &Load<S>, kappa: S, alpha: S) -> S {
        let c = &self.c;
        let b = num::<S>(c.rbx1 * c.lxal) * cos_atan(num::<S>(c.rbx2) * kappa);
        let e = num::<S>(c.rex1) + num::<S>(c.rex2) * at.dfz;
        weight(b, num(c.rcx1), e, alpha, num(c.rhx1))
    }

    /// Weight of the lateral force, 1 without longitudinal slip.
    ///
    /// ```text
    /// G_yκ as G_xα with κ_s = κ + S_Hyκ,  S_Hyκ = r_Hy1 + r_Hy2 df_z
    /// B = r_By1 cos(atan(r_By2 (α − r_By3))) λ_yκ     C = r_Cy1     E = r_Ey1 + r_Ey2 df_z ≤ 1
    /// ```
    pub(crate) fn weight_y<S: Scalar>(&self, at: &Load<S>, kappa: S, alpha: S) -> S {
        let c = &self.c;
        let b = num::<S>(c.rby1 * c.lyka) * cos_atan(num::<S>(c.rby2) * (alpha - num(c.rby3)));
        let e = num::<S>(c.rey1) + num::<S>(c.rey2) * at.dfz;
        weight(b, num(c.rcy1), e, kappa, num::<S>(c.rhy1) + num::<S>(c.rhy2) * at.dfz)
    }

    /// Lateral force that longitudinal slip induces, N.
    ///
    /// ```text
    /// S_Vyκ = μ_y F_z (r_Vy1 + r_Vy2 df_z + r_Vy3 γ) cos(atan(r_Vy4 α)) sin(r_Vy5 atan(r_Vy6 κ)) λ_Vyκ
    /// ```
    pub(crate) fn kappa_induced<S: Scalar>(&self, at: &Load<S>, mu: S, kappa: S, alpha: S, camber: S) -> S {
        let c = &self.c;
        let share = num::<S>(c.rvy1) + num::<S>(c.rvy2) * at.dfz + num::<S>(c.rvy3) * camber;
        let size = mu * at.fz * share * cos_atan(num::<S>(c.rvy4) * alpha);
        size * (num::<S>(c.rvy5) * (num::<S>(c.rvy6) * kappa).atan()).sin() * num(c.lvyka)
    }
}

fn weight<S: Scalar>(b: S, c: S, e: S, slip: S, shift: S) -> S {
    magic(b * (slip + shift), c, e).cos() / magic(b * shift, c, e).cos()
}

/// `cos(atan x) = 1/√(1 + x²)`.
pub(crate) fn cos_atan<S: Scalar>(x: S) -> S {
    num::<S>(1.0) / (num::<S>(1.0) + x * x).sqrt()
}
