//! [`Revolute`]: a revolute joint about an axis that parent and body share, the joint that is worth specialising.
//!
//! Rotating a vector takes four products in place of nine, rotating what the elimination has left (row and column of
//! the axis are zero) 26 in place of 144.

use headland_expr::Scalar;
use headland_spatial::{Axis, Rotation, Symmetric, Twist, Vector, Wrench};

use super::articulated::{Articulated, Pivot};
use super::products::{Bias, Products};

/// Revolute about axis `I`, with `J`, `K` the two that follow.
pub(super) struct Revolute<S, const I: usize> {
    pub sin: S,
    pub cos: S,
    pub position: Vector<S>,
}

impl<S: Scalar, const I: usize> Revolute<S, I> {
    const J: usize = (I + 1) % 3;
    const K: usize = (I + 2) % 3;
    pub const AXIS: Axis = Axis::ALL[I];

    /// The block `J, K` of a symmetric matrix, rotated in place; an isotropic one stays as it is.
    #[inline]
    fn turn_block(&self, t: &mut Symmetric<S>) {
        let (j, k) = (Self::J, Self::K);
        let (a, b, d) = (t.get(j, j), t.get(k, k), t.get(j, k));
        let (cd, sd) = (self.cos * d, self.sin * d);
        let g = self.sin * (a - b) + cd;
        let x = self.sin * (g + cd);
        *t.get_mut(j, j) = a - x;
        *t.get_mut(k, k) = b + x;
        *t.get_mut(j, k) = self.cos * g - self.sin * sd;
    }
}

impl<S: Scalar, const I: usize> Products<S> for Revolute<S, I> {
    #[inline]
    fn out(&self, v: Vector<S>) -> Vector<S> {
        let (j, k) = (Self::J, Self::K);
        let mut w = v;
        w[j] = self.cos * v[j] - self.sin * v[k];
        w[k] = self.sin * v[j] + self.cos * v[k];
        w
    }

    #[inline]
    fn back(&self, v: Vector<S>) -> Vector<S> {
        let (j, k) = (Self::J, Self::K);
        let mut w = v;
        w[j] = self.cos * v[j] + self.sin * v[k];
        w[k] = self.cos * v[k] - self.sin * v[j];
        w
    }

    #[inline]
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S> {
        let mut t = *t;
        self.turn_block(&mut t);
        let (j, k) = (t.get(I, Self::J), t.get(I, Self::K));
        *t.get_mut(I, Self::J) = self.cos * j - self.sin * k;
        *t.get_mut(I, Self::K) = self.sin * j + self.cos * k;
        t
    }

    #[inline]
    fn position(&self) -> Vector<S> {
        self.position
    }

    #[inline]
    fn motion(&self, u: &[S]) -> Twist<S> {
        Twist::new(Vector::along(Self::AXIS, u[0]), Vector::zero())
    }

    #[inline]
    fn add_motion(&self, v: Twist<S>, u: &[S]) -> Twist<S> {
        let mut v = v;
        v.angular[I] = v.angular[I] + u[0];
        v
    }

    #[inline]
    fn bias(&self, v: Twist<S>, u: &[S]) -> Twist<S> {
        let (j, k) = (Self::J, Self::K);
        let mut c = Twist::zero();
        c.angular[j] = v.angular[k] * u[0];
        c.angular[k] = -(v.angular[j] * u[0]);
        c.linear[j] = v.linear[k] * u[0];
        c.linear[k] = -(v.linear[j] * u[0]);
        c
    }

    #[inline]
    fn project(&self, f: Wrench<S>, tau: &mut [S]) {
        tau[0] = f.torque[I];
    }

    #[inline]
    fn eliminate(
        &self,
        i: &mut Articulated<S>,
        p: &mut Wrench<S>,
        bias: Bias<'_, S>,
        tau: &[S],
        pivots: &mut [Pivot<S>],
    ) {
        // `Articulated::eliminate`, but row and column of the axis, which nothing reads, are left as they are
        let (j, k) = (Self::J, Self::K);
        let Articulated { angular: t, coupling: h, linear: m } = i;
        let (pivot, own) = (t.get(I, I), h[I]);
        let inverse = S::constant(1.0) / pivot;
        let (u_j, u_k) = (t.get(I, j), t.get(I, k));
        let (g_j, g_k) = (u_j * inverse, u_k * inverse);
        let g = [own[0] * inverse, own[1] * inverse, own[2] * inverse];
        let rest = (tau[0] - p.torque[I]) * inverse;
        let mut column = [S::constant(1.0), S::constant(1.0), S::constant(1.0), g[0], g[1], g[2]];
        (column[j], column[k]) = (g_j, g_k);
        pivots[0] = Pivot { column, rest, pivot };

        *t.get_mut(j, j) = t.get(j, j) - u_j * g_j;
        *t.get_mut(k, k) = t.get(k, k) - u_k * g_k;
        *t.get_mut(j, k) = t.get(j, k) - u_j * g_k;
        for n in 0..3 {
            h[j][n] = h[j][n] - u_j * g[n];
            h[k][n] = h[k][n] - u_k * g[n];
        }
        *m = Symmetric::from_fn(|r, c| m.get(r, c) - own[r] * g[c]);

        let c = self.bias(bias.twist, bias.u);
        let (a, b, x, y) = (c.angular[j], c.angular[k], c.linear[j], c.linear[k]);
        p.torque[I] = tau[0];
        p.torque[j] = p.torque[j] + (u_j * rest + t.get(j, j) * a + t.get(j, k) * b + h[j][j] * x + h[j][k] * y);
        p.torque[k] = p.torque[k] + (u_k * rest + t.get(k, j) * a + t.get(k, k) * b + h[k][j] * x + h[k][k] * y);
        for n in 0..3 {
            let moved = h[j][n] * a + h[k][n] * b + m.get(n, j) * x + m.get(n, k) * y;
            p.force[n] = p.force[n] + (own[n] * rest + moved);
        }
    }

    #[inline]
    fn solve(&self, a: Twist<S>, pivots: &[Pivot<S>], acceleration: &mut [S]) -> Twist<S> {
        let (j, k) = (Self::J, Self::K);
        let Pivot { column: g, rest, .. } = pivots[0];
        let (w, v) = (a.angular, a.linear);
        let along = (g[3] * v[0] + g[4] * v[1]) + g[5] * v[2];
        let s = rest - (w[I] + (g[j] * w[j] + g[k] * w[k]) + along);
        acceleration[0] = s;
        let mut a = a;
        a.angular[I] = w[I] + s;
        a
    }

    #[inline]
    fn reduced_out(&self, i: &Articulated<S>) -> Articulated<S> {
        let (j, k) = (Self::J, Self::K);
        let (sin, cos, p) = (self.sin, self.cos, self.position);
        let mut angular = i.angular; // row and column I are zero and not read
        self.turn_block(&mut angular);
        let linear = self.tensor_out(&i.linear);
        // coupling: columns, then rows
        let (row_j, row_k) = (self.out(Vector(i.coupling[j])), self.out(Vector(i.coupling[k])));
        let h_j = Vector(std::array::from_fn(|n| cos * row_j[n] - sin * row_k[n]));
        let h_k = Vector(std::array::from_fn(|n| sin * row_j[n] + cos * row_k[n]));
        // then the shift, as in `Articulated::shifted` with a zero row
        let moved: [Vector<S>; 3] =
            std::array::from_fn(|n| p.cross(Vector([linear.get(n, 0), linear.get(n, 1), linear.get(n, 2)])));
        let mut coupling = [[S::constant(0.0); 3]; 3];
        for n in 0..3 {
            coupling[I][n] = moved[n][I];
            coupling[j][n] = h_j[n] + moved[n][j];
            coupling[k][n] = h_k[n] + moved[n][k];
        }
        let (before_j, before_k) = (p.cross(h_j), p.cross(h_k));
        let [after_x, after_y, after_z] = coupling;
        let after = [p.cross(Vector(after_x)), p.cross(Vector(after_y)), p.cross(Vector(after_z))];
        let mut t = Symmetric::zero();
        *t.get_mut(I, I) = after[I][I];
        *t.get_mut(I, j) = after[j][I];
        *t.get_mut(I, k) = after[k][I];
        *t.get_mut(j, j) = angular.get(j, j) + before_j[j] + after[j][j];
        *t.get_mut(k, k) = angular.get(k, k) + before_k[k] + after[k][k];
        *t.get_mut(j, k) = angular.get(j, k) + before_j[k] + after[k][j];
        Articulated { angular: t, coupling, linear }
    }
}

/// A revolute joint mounted with a rotation: transforms are dense, all the rest is [`Revolute`]'s.
pub(super) struct Mounted<S, const I: usize> {
    pub joint: Revolute<S, I>,
    /// `R_PB`.
    pub rotation: Rotation<S>,
}

impl<S: Scalar, const I: usize> Products<S> for Mounted<S, I> {
    #[inline]
    fn out(&self, v: Vector<S>) -> Vector<S> {
        self.rotation.apply(v)
    }

    #[inline]
    fn back(&self, v: Vector<S>) -> Vector<S> {
        self.rotation.apply_inverse(v)
    }

    #[inline]
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S> {
        self.rotation.apply_to_tensor(t)
    }

    #[inline]
    fn position(&self) -> Vector<S> {
        self.joint.position
    }

    #[inline]
    fn motion(&self, u: &[S]) -> Twist<S> {
        self.joint.motion(u)
    }

    #[inline]
    fn add_motion(&self, v: Twist<S>, u: &[S]) -> Twist<S> {
        self.joint.add_motion(v, u)
    }

    #[inline]
    fn bias(&self, v: Twist<S>, u: &[S]) -> Twist<S> {
        self.joint.bias(v, u)
    }

    #[inline]
    fn project(&self, f: Wrench<S>, tau: &mut [S]) {
        self.joint.project(f, tau);
    }

    #[inline]
    fn eliminate(
        &self,
        i: &mut Articulated<S>,
        p: &mut Wrench<S>,
        bias: Bias<'_, S>,
        tau: &[S],
        pivots: &mut [Pivot<S>],
    ) {
        self.joint.eliminate(i, p, bias, tau, pivots);
    }

    #[inline]
    fn solve(&self, a: Twist<S>, pivots: &[Pivot<S>], acceleration: &mut [S]) -> Twist<S> {
        self.joint.solve(a, pivots, acceleration)
    }

    /// Dense, but for the zero row and column of the axis.
    #[inline]
    fn reduced_out(&self, i: &Articulated<S>) -> Articulated<S> {
        let (j, k) = ((I + 1) % 3, (I + 2) % 3);
        let r = &self.rotation.0;
        let (a, b, d) = (i.angular.get(j, j), i.angular.get(k, k), i.angular.get(j, k));
        let rows = r.map(|row| [a * row[j] + d * row[k], d * row[j] + b * row[k]]); // block times Rᵀ
        let angular = Symmetric::from_fn(|m, n| r[m][j] * rows[n][0] + r[m][k] * rows[n][1]);
        let (h_j, h_k) = (self.out(Vector(i.coupling[j])), self.out(Vector(i.coupling[k])));
        let coupling = std::array::from_fn(|m| std::array::from_fn(|n| r[m][j] * h_j[n] + r[m][k] * h_k[n]));
        Articulated { angular, coupling, linear: self.tensor_out(&i.linear) }.shifted(self.joint.position)
    }
}

/// `R` times the rotation about an axis with the given sine and cosine.
#[inline]
pub(super) fn turned<S: Scalar>(r: &Rotation<S>, axis: Axis, (sin, cos): (S, S)) -> Rotation<S> {
    let (_, j, k) = axis.cycle();
    Rotation(r.0.map(|mut row| {
        (row[j], row[k]) = (cos * row[j] + sin * row[k], cos * row[k] - sin * row[j]);
        row
    }))
}
