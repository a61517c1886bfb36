//! [`Articulated`]: the inertia that a body shows when what hangs from it may move.

use headland_expr::Scalar;
use headland_spatial::{OriginInertia, Symmetric, Twist, Vector, Wrench};

/// A symmetric 6 × 6 matrix from accelerations to wrenches at a frame's origin, in the frame's axes.
///
/// ```text
/// [τ]   [ A   H ] [α]
/// [f] = [ Hᵀ  M ] [a]
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Articulated<S> {
    /// A.
    pub angular: Symmetric<S>,
    /// H, by rows.
    pub coupling: [[S; 3]; 3],
    /// M.
    pub linear: Symmetric<S>,
}

/// What the elimination of one freedom leaves for the way back: `s = rest − column · a`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pivot<S> {
    /// `U / D`, angular part first; the entry of the freedom itself is 1 and not read.
    pub column: [S; 6],
    /// `(τ − Sᵀ p) / D`.
    pub rest: S,
    /// `D = Sᵀ I S`.
    pub pivot: S,
}

impl<S: Scalar> Pivot<S> {
    pub fn zero() -> Self {
        let zero = S::constant(0.0);
        Self { column: [zero; 6], rest: zero, pivot: zero }
    }
}

impl<S: Scalar> Articulated<S> {
    pub fn zero() -> Self {
        Self { angular: Symmetric::zero(), coupling: [[S::constant(0.0); 3]; 3], linear: Symmetric::zero() }
    }

    /// Of a single rigid body.
    #[inline]
    pub fn rigid(i: &OriginInertia<S>) -> Self {
        let [x, y, z] = i.moment.0;
        let zero = S::constant(0.0);
        Self {
            angular: i.tensor,
            coupling: [[zero, -z, y], [z, zero, -x], [-y, x, zero]],
            linear: Symmetric::diagonal(i.mass, i.mass, i.mass),
        }
    }

    /// With a rigid body added, whose many zeros are not.
    #[inline]
    pub fn and_rigid(mut self, i: &OriginInertia<S>) -> Self {
        let [x, y, z] = i.moment.0;
        self.angular = self.angular + i.tensor;
        let h = &mut self.coupling;
        (h[0][1], h[1][0]) = (h[0][1] - z, h[1][0] + z);
        (h[2][0], h[0][2]) = (h[2][0] - y, h[0][2] + y);
        (h[1][2], h[2][1]) = (h[1][2] - x, h[2][1] + x);
        for k in 0..3 {
            self.linear.0[k] = self.linear.0[k] + i.mass;
        }
        self
    }

    #[inline]
    pub fn add(&mut self, b: &Self) {
        self.angular = self.angular + b.angular;
        self.linear = self.linear + b.linear;
        for i in 0..3 {
            for j in 0..3 {
                self.coupling[i][j] = self.coupling[i][j] + b.coupling[i][j];
            }
        }
    }

    /// The wrench that gives the acceleration `a`.
    #[inline]
    pub fn apply(&self, a: Twist<S>) -> Wrench<S> {
        let h = &self.coupling;
        let torque = self.angular * a.angular + Vector(h.map(|row| Vector(row).dot(a.linear)));
        let w = a.angular;
        let along: [S; 3] = std::array::from_fn(|j| h[0][j] * w[0] + h[1][j] * w[1] + h[2][j] * w[2]);
        Wrench::new(torque, self.linear * a.linear + Vector(along))
    }

    /// Column of the freedom `K` (0-2 turn, 3-5 slide).
    #[inline]
    fn column<const K: usize>(&self) -> [S; 6] {
        let (a, h, m) = (&self.angular, &self.coupling, &self.linear);
        match K {
            0..3 => [a.get(K, 0), a.get(K, 1), a.get(K, 2), h[K][0], h[K][1], h[K][2]],
            _ => [h[0][K - 3], h[1][K - 3], h[2][K - 3], m.get(K - 3, 0), m.get(K - 3, 1), m.get(K - 3, 2)],
        }
    }

    #[inline]
    fn entry_mut(&mut self, i: usize, j: usize) -> &mut S {
        match (i < 3, j < 3) {
            (true, true) => self.angular.get_mut(i, j),
            (true, false) => &mut self.coupling[i][j - 3],
            (false, true) => &mut self.coupling[j][i - 3],
            (false, false) => self.linear.get_mut(i - 3, j - 3),
        }
    }

    /// Lets the freedom `K` move under the force `tau`: Schur complement of the matrix, the bias wrench with it.
    ///
    /// ```text
    /// U = I e_K,  D = U_K,  I ← I − U Uᵀ/D,  p ← p + U (τ − p_K)/D
    /// ```
    #[inline]
    pub fn eliminate<const K: usize>(&mut self, p: &mut Wrench<S>, tau: S) -> Pivot<S> {
        let u = self.column::<K>();
        let pivot = u[K];
        let inverse = S::constant(1.0) / pivot;
        let mut column = u;
        for x in &mut column {
            *x = *x * inverse;
        }
        let rest = (tau - *component(p, K)) * inverse;
        for i in 0..6 {
            for j in i..6 {
                let entry = self.entry_mut(i, j);
                *entry = if i == K || j == K { S::constant(0.0) } else { *entry - u[i] * column[j] };
            }
            let f = component(p, i);
            *f = if i == K { tau } else { *f + u[i] * rest };
        }
        Pivot { column, rest, pivot }
    }

    /// [`eliminate`](Self::eliminate) with the freedom known at run time.
    pub fn eliminate_entry(&mut self, k: usize, p: &mut Wrench<S>, tau: S) -> Pivot<S> {
        match k {
            0 => self.eliminate::<0>(p, tau),
            1 => self.eliminate::<1>(p, tau),
            2 => self.eliminate::<2>(p, tau),
            3 => self.eliminate::<3>(p, tau),
            4 => self.eliminate::<4>(p, tau),
            _ => self.eliminate::<5>(p, tau),
        }
    }

    /// [`eliminate`](Self::eliminate) of the motion along any twist `s`.
    pub fn eliminate_screw(&mut self, s: Twist<S>, p: &mut Wrench<S>, tau: S) -> Pivot<S> {
        let wrench = self.apply(s);
        let u = flat(wrench.torque, wrench.force);
        let pivot = s.power(wrench);
        let inverse = S::constant(1.0) / pivot;
        let column = u.map(|x| x * inverse);
        let rest = (tau - s.power(*p)) * inverse;
        for i in 0..6 {
            for j in i..6 {
                let entry = self.entry_mut(i, j);
                *entry = *entry - u[i] * column[j];
            }
        }
        *p = *p + wrench * rest;
        Pivot { column, rest, pivot }
    }

    /// The same at a point from which the frame's origin is at `p`, axes parallel.
    ///
    /// ```text
    /// H′ = H + [p]× M      A′ = A + ([p]× Hᵀ)ᵀ + [p]× H′ᵀ
    /// ```
    #[inline]
    pub fn shifted(&self, p: Vector<S>) -> Self {
        let m = &self.linear;
        let moved: [Vector<S>; 3] = std::array::from_fn(|j| p.cross(Vector([m.get(0, j), m.get(1, j), m.get(2, j)])));
        let coupling: [[S; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| self.coupling[i][j] + moved[j][i]));
        let before = self.coupling.map(|row| p.cross(Vector(row)));
        let after = coupling.map(|row| p.cross(Vector(row)));
        let angular = Symmetric::from_fn(|i, j| self.angular.get(i, j) + before[i][j] + after[j][i]);
        Self { angular, coupling, linear: *m }
    }
}

#[inline]
fn component<S>(f: &mut Wrench<S>, i: usize) -> &mut S {
    if i < 3 { &mut f.torque.0[i] } else { &mut f.force.0[i - 3] }
}

#[inline]
pub(super) fn flat<S: Scalar>(a: Vector<S>, b: Vector<S>) -> [S; 6] {
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}
