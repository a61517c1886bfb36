//! Hard contacts as numbers: what is known of each at a state, the limits of its mode, and impacts.

use headland_code::{Evaluator, Function};
use headland_dynamics::solve::{packed, solve_ldl};
use headland_expr::{Expr, Graph, NodeId, Scalar};
use headland_model::{Contact, Mode, Model};

use crate::system::{Limit, Problem, System, Watch, solve_factored};

/// Part of the normal force by which friction may be over its limit: rounding, where a ball rolls exactly at the limit.
const ROUNDING: f64 = 1e-12;

/// Numbers of one contact, in the order of [`ContactState`].
const NODES: usize = 19;

/// Inputs of a contact with friction: the direction in which it slides, and a shift of the slip where it begins.
pub(crate) const SLIDE: usize = 6;

/// The model's nodes of a contact, in the order of [`ContactState`].
pub(crate) fn nodes_of(contact: &Contact) -> Vec<NodeId> {
    let (limit, kinetic) = match &contact.friction {
        Some(f) => (f.limit, f.kinetic),
        None => (contact.restitution, contact.restitution), // never read
    };
    let vectors = [contact.gap, contact.normal, contact.slip, contact.slip_rate, contact.force];
    let scalars = [contact.normal_force, limit, kinetic, contact.restitution];
    vectors.into_iter().flatten().chain(scalars).collect()
}

/// Event functions of the contacts by their modes; `nodes` are those of [`nodes_of`], one contact after the other.
pub(crate) fn limits(model: &Model, graph: &Graph, nodes: &[NodeId], slides_from: usize) -> Vec<(Watch, NodeId)> {
    let mut all = Vec::new();
    let mut direction_at = slides_from;
    for (k, contact) in model.contacts.iter().enumerate() {
        let at = |i: usize| graph.expr(nodes[NODES * k + i]);
        let mut watch = |limit, e: Expr<'_>| all.push((Watch::Contact(k, limit), graph.id(e)));
        let direction = direction_at;
        direction_at += if contact.friction.is_some() { SLIDE } else { 0 };
        if contact.mode == Mode::Free {
            watch(Limit::Gap, at(0));
            all.push((Watch::Nearest, graph.id(at(1)))); // a gap that closes and opens again within a step is seen there
            continue;
        }
        let normal = at(15);
        watch(Limit::Normal, normal);
        let Some(friction) = &contact.friction else { continue };
        let dot = |a: usize, b: usize| (0..3).fold(Expr::Const(0.0), |sum, i| sum + at(a + i) * at(b + i));
        match contact.mode {
            Mode::Rolling => {
                let across = dot(12, 12) - normal.powi(2);
                watch(Limit::Cone, at(16).powi(2) * normal.powi(2) * Expr::Const(1.0 + ROUNDING) - across);
            }
            _ if !friction.viscous => {
                let input = |i: usize| graph.expr(graph.input_id(direction + i));
                let off = (0..3).fold(Expr::Const(0.0), |sum, i| sum + at(3 + i) * input(3 + i));
                let along = |sum, i: usize| sum + (at(6 + i) + input(3 + i) - off * at(3 + i)) * input(i);
                watch(Limit::Slip, (0..3).fold(Expr::Const(0.0), along));
            }
            _ => {}
        }
    }
    all
}

/// What is known of a contact at a state; vectors along the axes of the surface.
#[derive(Clone, Debug)]
pub(crate) struct ContactState {
    /// The gap with its first and second rates.
    pub(crate) gap: [f64; 3],
    pub(crate) normal: [f64; 3],
    /// Slip velocity, its normal component the rate of the gap.
    pub(crate) slip: [f64; 3],
    pub(crate) slip_rate: [f64; 3],
    pub(crate) force: [f64; 3],
    pub(crate) normal_force: f64,
    /// Coefficients of friction: until it slips, and when it slips.
    pub(crate) limit: f64,
    pub(crate) kinetic: f64,
    pub(crate) restitution: f64,
}

impl ContactState {
    fn read(x: &[f64]) -> Self {
        let three = |i: usize| [x[i], x[i + 1], x[i + 2]];
        Self {
            gap: three(0),
            normal: three(3),
            slip: three(6),
            slip_rate: three(9),
            force: three(12),
            normal_force: x[15],
            limit: x[16],
            kinetic: x[17],
            restitution: x[18],
        }
    }

    /// The part of a vector across the normal.
    pub(crate) fn across(&self, v: [f64; 3]) -> [f64; 3] {
        let along = dot(self.normal, v);
        [0, 1, 2].map(|i| v[i] - along * self.normal[i])
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The vector scaled to length one; zero stays.
pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let size = length(a);
    if size > 0.0 { a.map(|x| x / size) } else { a }
}

/// All contacts at a state.
pub(crate) fn look(system: &System, problem: &mut Problem, t: f64, y: &[f64]) -> Vec<ContactState> {
    let out = system.contact_function().evaluator().eval(problem.full_inputs(t, y)).to_vec();
    (0..system.modes.len()).map(|k| ContactState::read(&out[NODES * k..])).collect()
}

/// What an impact does to the independent velocities.
pub(crate) struct Impact {
    /// Their change.
    pub(crate) change: Vec<f64>,
    /// Normal speed after it.
    pub(crate) rebound: f64,
    /// Whether the slip ends.
    pub(crate) sticks: bool,
}

/// Newton's law along the normal and Coulomb's across it, for one contact; the others go on as they are.
///
/// ```text
/// A = J M⁻¹ Jᵀ,   J = ∂slip/∂u:      s⁺ = s + A p,   n·s⁺ = −e n·s,   p across: so that s⁺ = 0 across, if that is within
///                                    the cone of friction, else −μ (n·p) along the slip before
/// ```
/// Where the slip would turn round within the impact, it ends there.
pub(crate) fn impact(
    system: &System,
    problem: &mut Problem,
    k: usize,
    t: f64,
    y: &[f64],
    slips: bool,
    restitution: Option<f64>,
) -> Option<Impact> {
    let contact = look(system, problem, t, y)[k].clone();
    let (mass, mut columns) = answers(system, problem, t, y);
    let columns = columns.swap_remove(k);
    let answer = |p: [f64; 3]| -> Vec<f64> {
        let mut change: Vec<f64> = columns.iter().map(|c| dot(*c, p)).collect();
        solve_factored(&mass, &mut change);
        change
    };
    let moved = |change: &[f64]| {
        let mut v = [0.0; 3];
        columns.iter().zip(change).for_each(|(c, u)| (0..3).for_each(|i| v[i] += c[i] * u));
        v
    };
    let a = [0, 1, 2].map(|i| moved(&answer([0, 1, 2].map(|j| f64::from(u8::from(i == j))))));
    let n = contact.normal;
    let approach = dot(n, contact.slip);
    let restitution = restitution.unwrap_or(contact.restitution);
    let wanted = -(1.0 + restitution) * approach; // change of the normal speed
    let rebound = -restitution * approach;
    let across = contact.across(contact.slip);
    // everything across stops: s⁺ = rebound n
    let sticking = least_squares(a, [0, 1, 2].map(|i| rebound * n[i] - contact.slip[i]));
    let pressing = dot(n, sticking);
    let friction = length(contact.across(sticking));
    if !slips || (pressing >= 0.0 && friction <= contact.limit * pressing * (1.0 + ROUNDING)) {
        return Some(Impact { change: answer(sticking), rebound, sticks: true });
    }
    let direction = unit(across);
    let along = |share: f64| {
        let d = [0, 1, 2].map(|i| n[i] - share * contact.kinetic * direction[i]);
        let per_impulse = dot(n, multiply(a, d));
        (per_impulse > 0.0).then(|| d.map(|x| x * wanted / per_impulse))
    };
    let p = along(1.0)?;
    let left = dot(direction, contact.slip) + dot(direction, multiply(a, p));
    if left >= 0.0 || direction == [0.0; 3] {
        return Some(Impact { change: answer(p), rebound, sticks: false });
    }
    // the slip ends within the impact
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let p = along(middle)?;
        let left = dot(direction, contact.slip) + dot(direction, multiply(a, p));
        if left >= 0.0 { low = middle } else { high = middle }
    }
    Some(Impact { change: answer(along(low)?), rebound, sticks: false })
}

/// Factors of the mass matrix, and for each contact the columns `∂slip/∂u_j`; the slip is affine in u.
pub(crate) fn answers(system: &System, problem: &mut Problem, t: f64, y: &[f64]) -> (Vec<f64>, Vec<Vec<[f64; 3]>>) {
    let (nq, nu, count) = (system.nq, system.nu, system.modes.len());
    let mut evaluator = system.contact_function().evaluator();
    let mut mass = evaluator.eval(problem.full_inputs(t, y))[NODES * count..].to_vec();
    solve_ldl(&mut mass, &mut vec![0.0; nu]);
    let mut at_rest = y.to_vec();
    at_rest[nq..].fill(0.0);
    let mut slips_at = |y: &[f64]| -> Vec<[f64; 3]> {
        let out = evaluator.eval(problem.full_inputs(t, y));
        (0..count).map(|k| ContactState::read(&out[NODES * k..]).slip).collect()
    };
    let drift = slips_at(&at_rest);
    let mut columns = vec![vec![[0.0; 3]; nu]; count];
    for j in 0..nu {
        at_rest[nq + j] = 1.0;
        for (k, slip) in slips_at(&at_rest).into_iter().enumerate() {
            columns[k][j] = [0, 1, 2].map(|i| slip[i] - drift[k][i]);
        }
        at_rest[nq + j] = 0.0;
    }
    (mass, columns)
}

/// `A x`, A given by its columns (it is symmetric).
pub(crate) fn multiply(a: [[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|j| a[j][i] * x[j]).sum())
}

/// The shortest x with `A x = b` for a positive semidefinite A, in the directions that A moves at all.
fn least_squares(a: [[f64; 3]; 3], b: [f64; 3]) -> [f64; 3] {
    let size = (0..3).fold(0.0_f64, |m, i| m.max(a[i][i]));
    // a little is added where A moves nothing; the error of that is far below rounding of the rest
    let mut packed_a = [0.0; 6];
    for i in 0..3 {
        for j in 0..=i {
            packed_a[packed(i, j)] = a[j][i] + if i == j { 1e-14 * size } else { 0.0 };
        }
    }
    let mut factors = packed_a;
    let mut x = b;
    solve_ldl(&mut factors, &mut x);
    for _ in 0..3 {
        let ax = multiply(a, x);
        let mut rest = [0, 1, 2].map(|i| b[i] - ax[i]);
        solve_factored(&factors, &mut rest);
        x = [0, 1, 2].map(|i| x[i] + rest[i]);
    }
    x
}
