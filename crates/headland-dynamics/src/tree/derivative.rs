//! Exact Jacobians: [`rnea_jacobian`] and [`aba_jacobian`] by recursion, see [`LaneJacobian`](super::LaneJacobian) for dual numbers.
//!
//! The recursion works with all quantities at the world's origin in the world's axes, where those of bodies joined simply add.
//! `M⁻¹` being at hand, the Jacobian of accelerations is that of forces:
//!
//! ```text
//! ∂u̇/∂q = −M⁻¹ ∂τ/∂q      ∂u̇/∂u = −M⁻¹ ∂τ/∂u      ∂u̇/∂τ = M⁻¹        (τ = M u̇ + h at the solution u̇)
//! ```
//! Symbolic Jacobians need nothing of this: `Graph::jacobian` of the symbolic accelerations, or these functions over
//! expressions.
//!
//! # References
//! Singh, Russo & Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra*, 2022.
//! Its `2 B x` is written out: it depends on the angular part of `x` alone, by `N` and the momentum `P`.

use headland_expr::Scalar;
use headland_spatial::{OriginInertia, Quaternion, Symmetric, Twist, Vector, Wrench};

use super::bodies::Tree;
use super::crba::{column, crba};
use super::frames::{Frames, frames};
use super::joint::Joint;
use super::rnea::rnea;
use super::workspace::{Loads, Workspace};
use crate::solve::{packed, solve_ldl};

/// Partial derivatives of the accelerations, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobians<S> {
    /// `∂u̇/∂q`, `nu × nq`. A change of a quaternion's length changes nothing.
    pub by_q: Vec<S>,
    /// `∂u̇/∂u`, `nu × nu`.
    pub by_u: Vec<S>,
    /// `∂u̇/∂τ = M⁻¹`, `nu × nu`.
    pub by_tau: Vec<S>,
}

impl<S: Scalar> Jacobians<S> {
    /// Room for a tree's.
    pub fn new(tree: &Tree<S>) -> Self {
        let (nq, nu, zero) = (tree.nq(), tree.nu(), S::constant(0.0));
        Self { by_q: vec![zero; nu * nq], by_u: vec![zero; nu * nu], by_tau: vec![zero; nu * nu] }
    }
}

/// A freedom in the world: its motion, and how others see it change.
#[derive(Clone, Copy, Debug)]
struct Freedom<S> {
    /// 1 for the turns of a joint that slides first.
    level: u8,
    /// S.
    motion: Twist<S>,
    /// `Ψ′ = V_p × S`, p: what carries the freedom.
    first: Twist<S>,
    /// `Ψ″ = A_p × S + V_p × Ψ′`.
    second: Twist<S>,
    /// `Ψ′ + S′`.
    rate: Twist<S>,
}

/// Of a body and all that hangs from it.
#[derive(Clone, Copy, Debug)]
struct Composite<S> {
    inertia: OriginInertia<S>,
    /// `N = [ω]× (2 J − tr J) − 2 v hᵀ + 2 (h · v)`.
    n: [[S; 3]; 3],
    /// Linear momentum P.
    momentum: Vector<S>,
}

/// Scratch of the recursion.
#[derive(Clone, Debug)]
pub struct JacobianWorkspace<S> {
    work: Workspace<S>,
    frames: Frames<S>,
    freedoms: Vec<Freedom<S>>,
    composites: Vec<Composite<S>>,
    /// `∂τ/∂θ`, θ: small motions along the freedoms.
    by_motion: Vec<S>,
    mass: Vec<S>,
    forces: Vec<S>,
}

impl<S: Scalar> JacobianWorkspace<S> {
    /// For this tree, or another of the same size.
    pub fn new(tree: &Tree<S>) -> Self {
        let (nu, zero) = (tree.nu(), S::constant(0.0));
        let nothing = OriginInertia { mass: zero, moment: Vector::zero(), tensor: Symmetric::zero() };
        let composite = Composite { inertia: nothing, n: [[zero; 3]; 3], momentum: Vector::zero() };
        let still = Twist::zero();
        let freedom = Freedom { level: 0, motion: still, first: still, second: still, rate: still };
        Self {
            work: Workspace::new(tree),
            frames: Frames::new(tree),
            freedoms: vec![freedom; nu],
            composites: vec![composite; tree.len()],
            by_motion: vec![zero; nu * nu],
            mass: vec![zero; nu * (nu + 1) / 2],
            forces: vec![zero; nu],
        }
    }
}

/// Accelerations and their Jacobians; O(nu · depth) and the solution with M, O(nu³).
///
/// # Panics
/// If a length is wrong.
pub fn aba_jacobian<S: Scalar>(
    tree: &Tree<S>,
    q: &[S],
    u: &[S],
    tau: &[S],
    loads: &Loads<'_, S>,
    work: &mut JacobianWorkspace<S>,
    acceleration: &mut [S],
    jacobians: &mut Jacobians<S>,
) {
    let (nq, nu) = (tree.nq(), tree.nu());
    super::aba::aba(tree, q, u, tau, loads, &mut work.work, acceleration);
    rnea_jacobian(tree, q, u, acceleration, loads, work, &mut jacobians.by_q, &mut jacobians.by_u);
    for x in jacobians.by_q.iter_mut().chain(&mut jacobians.by_u) {
        *x = -*x;
    }
    jacobians.by_tau.fill(S::constant(0.0));
    for i in 0..nu {
        jacobians.by_tau[i * nu + i] = S::constant(1.0);
    }
    crba(tree, q, &mut work.work, &mut work.mass);
    solve_ldl(&mut work.mass, &mut work.forces); // for its factors
    for (rows, width) in [(&mut jacobians.by_q, nq), (&mut jacobians.by_u, nu), (&mut jacobians.by_tau, nu)] {
        solve_rows(&work.mass, nu, rows, width);
    }
}

/// `M X = B` for many columns at once, given the factors of [`solve_ldl`]; B row by row.
fn solve_rows<S: Scalar>(factors: &[S], n: usize, rows: &mut [S], width: usize) {
    let subtract = |to: &mut [S], from: &[S], k: S| {
        for (x, y) in to.iter_mut().zip(from) {
            *x = *x - k * *y;
        }
    };
    for i in 0..n {
        let (done, rest) = rows.split_at_mut(i * width);
        for (j, row) in done.chunks_exact(width.max(1)).enumerate() {
            subtract(&mut rest[..width], row, factors[packed(i, j)]);
        }
    }
    for i in 0..n {
        let inverse = S::constant(1.0) / factors[packed(i, i)];
        for x in &mut rows[i * width..(i + 1) * width] {
            *x = *x * inverse;
        }
    }
    for i in (0..n).rev() {
        let (before, rest) = rows.split_at_mut(i * width);
        for (j, row) in before.chunks_exact_mut(width.max(1)).enumerate() {
            subtract(row, &rest[..width], factors[packed(i, j)]);
        }
    }
}

/// `∂τ/∂q` (`nu × nq`) and `∂τ/∂u` (`nu × nu`), row by row, of [`rnea`](super::rnea()); O(nu · depth).
///
/// # Panics
/// If a length is wrong.
pub fn rnea_jacobian<S: Scalar>(
    tree: &Tree<S>,
    q: &[S],
    u: &[S],
    acceleration: &[S],
    loads: &Loads<'_, S>,
    work: &mut JacobianWorkspace<S>,
    by_q: &mut [S],
    by_u: &mut [S],
) {
    let (nq, nu) = (tree.nq(), tree.nu());
    assert!(by_q.len() == nu * nq && by_u.len() == nu * nu, "a length is wrong");
    rnea(tree, q, u, acceleration, loads, &mut work.work, &mut work.forces);
    frames(tree, q, u, &mut work.work, &mut work.frames);
    for b in 0..tree.len() {
        set_freedoms(tree, b, u, acceleration, work);
        set_composite(tree, b, work);
    }
    work.by_motion.fill(S::constant(0.0));
    by_u.fill(S::constant(0.0));
    for b in (0..tree.len()).rev() {
        for i in tree.u_range(b) {
            pair_upward(tree, b, i, work, by_u);
        }
        if let Some(parent) = tree.bodies()[b].parent {
            let own = work.composites[b];
            let all = &mut work.composites[parent];
            all.inertia = all.inertia + own.inertia;
            all.momentum = all.momentum + own.momentum;
            all.n = std::array::from_fn(|i| std::array::from_fn(|j| all.n[i][j] + own.n[i][j]));
        }
    }
    chain_to_coordinates(tree, q, &work.by_motion, by_q);
}

/// Motion of body `b`'s freedoms and of what carries them.
fn set_freedoms<S: Scalar>(tree: &Tree<S>, b: usize, u: &[S], acceleration: &[S], work: &mut JacobianWorkspace<S>) {
    let X_WB = work.frames.poses[b];
    let V = work.frames.twists[b].out_of_frame(&X_WB);
    let A = work.work.slots[b + 1].acceleration.out_of_frame(&X_WB);
    let (V_P, A_P) = match tree.bodies()[b].parent {
        None => (Twist::zero(), work.work.slots[0].acceleration),
        Some(p) => {
            let X_WP = &work.frames.poses[p];
            (work.frames.twists[p].out_of_frame(X_WP), work.work.slots[p + 1].acceleration.out_of_frame(X_WP))
        }
    };
    let (range, turns) = (tree.u_range(b), turns_after_slides(&tree.bodies()[b].joint));
    let motion: [Twist<S>; 6] = std::array::from_fn(|n| match range.len() > n {
        true => column(tree, &work.work, b, range.start + n).out_of_frame(&X_WB),
        false => Twist::zero(),
    });
    // what the slides carry: the body without its turns
    let (mut V_S, mut A_S) = (V, A);
    for n in turns.clone() {
        V_S = V_S - motion[n] * u[range.start + n];
        A_S = A_S - motion[n] * acceleration[range.start + n] - V.cross(motion[n] * u[range.start + n]);
    }
    for (n, i) in range.enumerate() {
        let turn = turns.contains(&n);
        let slide = !turns.is_empty() && !turn;
        let (V_p, A_p) = if turn { (V_S, A_S) } else { (V_P, A_P) };
        let first = V_p.cross(motion[n]);
        let second = A_p.cross(motion[n]) + V_p.cross(first);
        let own = if slide { V_P } else { V };
        let rate = first + own.cross(motion[n]);
        work.freedoms[i] = Freedom { level: u8::from(turn), motion: motion[n], first, second, rate };
    }
}

/// The freedoms of a joint that turn what its other freedoms slide.
fn turns_after_slides<S>(joint: &Joint<S>) -> std::ops::Range<usize> {
    match joint {
        Joint::Planar => 2..3,
        Joint::Free => 0..3,
        _ => 0..0,
    }
}

/// Inertia, `N` and momentum of body `b` alone, at the world's origin.
fn set_composite<S: Scalar>(tree: &Tree<S>, b: usize, work: &mut JacobianWorkspace<S>) {
    let X_WB = &work.frames.poses[b];
    let inertia = tree.bodies()[b].inertia.out_of_frame(X_WB).about_origin();
    let Twist { angular: w, linear: v } = work.frames.twists[b].out_of_frame(X_WB);
    let (two, h) = (S::constant(2.0), inertia.moment);
    let trace = inertia.tensor.trace();
    let doubled = two * h.dot(v);
    let mut n = [[S::constant(0.0); 3]; 3];
    for j in 0..3 {
        let mut column = Vector(std::array::from_fn(|i| two * inertia.tensor.get(i, j)));
        column[j] = column[j] - trace;
        let turned = w.cross(column);
        for i in 0..3 {
            n[i][j] = turned[i] - two * v[i] * h[j];
        }
        n[j][j] = n[j][j] + doubled;
    }
    work.composites[b] = Composite { inertia, n, momentum: v * inertia.mass + w.cross(h) };
}

/// Derivatives of force `i`, of body `b`, by the freedoms on the way to the root, and of their forces by `i`.
fn pair_upward<S: Scalar>(tree: &Tree<S>, b: usize, i: usize, work: &mut JacobianWorkspace<S>, by_u: &mut [S]) {
    let nu = tree.nu();
    let Composite { inertia, n, momentum } = work.composites[b];
    let force = work.work.slots[b + 1].wrench.out_of_frame(&work.frames.poses[b]);
    let two = S::constant(2.0);
    let gyroscopic = |x: Vector<S>| Wrench::new(Vector(n.map(|row| Vector(row).dot(x))), x.cross(momentum) * two);
    let Freedom { level, motion: s, first, second, rate, .. } = work.freedoms[i];
    let t1 = inertia.momentum(s);
    let t2 = gyroscopic(s.angular) + inertia.momentum(rate);
    let t3 = gyroscopic(first.angular) + inertia.momentum(second) + s.cross_wrench(force);
    let w = s.angular;
    let t4: Vector<S> = Vector(std::array::from_fn(|j| n[0][j] * w[0] + n[1][j] * w[1] + n[2][j] * w[2]))
        + momentum.cross(s.linear) * two;
    let mut at = Some(b);
    while let Some(a) = at {
        for j in tree.u_range(a) {
            let f = &work.freedoms[j];
            if a == b && f.level > level {
                continue; // done from its side
            }
            work.by_motion[i * nu + j] = t4.dot(f.first.angular) + f.second.power(t1);
            by_u[i * nu + j] = t4.dot(f.motion.angular) + f.rate.power(t1);
            if a != b || f.level < level {
                work.by_motion[j * nu + i] = f.motion.power(t3);
                by_u[j * nu + i] = f.motion.power(t2);
            }
        }
        at = tree.bodies()[a].parent;
    }
}

/// From derivatives by small motions along the freedoms to those by the coordinates.
fn chain_to_coordinates<S: Scalar>(tree: &Tree<S>, q: &[S], by_motion: &[S], by_q: &mut [S]) {
    let (nq, nu) = (tree.nq(), tree.nu());
    for (b, body) in tree.bodies().iter().enumerate() {
        let (at, of) = (tree.q_range(b), tree.u_range(b));
        let (slides, quaternion, turns) = match body.joint {
            Joint::Spherical => (0, Some(at.start), of.start),
            Joint::Free => (3, Some(at.start + 3), of.start),
            _ => (at.len(), None, of.start),
        };
        let first_slide = if quaternion.is_some() { of.start + 3 } else { of.start };
        for i in 0..nu {
            for k in 0..slides {
                by_q[i * nq + at.start + k] = by_motion[i * nu + first_slide + k];
            }
        }
        if let Some(start) = quaternion {
            let Q = Quaternion([q[start], q[start + 1], q[start + 2], q[start + 3]]);
            let k = S::constant(4.0) / Q.squared_norm();
            let rates = headland_spatial::Axis::ALL
                .map(|axis| Q.rate_from_body(Vector::along(axis, S::constant(1.0))).0.map(|x| x * k));
            for i in 0..nu {
                let d = &by_motion[i * nu + turns..i * nu + turns + 3];
                for c in 0..4 {
                    by_q[i * nq + start + c] = d[0] * rates[0][c] + d[1] * rates[1][c] + d[2] * rates[2][c];
                }
            }
        }
    }
}
