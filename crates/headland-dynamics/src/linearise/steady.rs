//! Whether a state is an equilibrium or in steady motion, and which displacements are cyclic.

use nalgebra::DMatrix;

use super::LineariseError;
use super::derivatives::{Derivatives, Point};

/// Displacement from the equilibrium, in units of the states, that is forgiven.
const RESIDUE: f64 = 1e-7;
/// Change of an entry of A along the motion that is forgiven, as part of its row's and the matrix's size.
const CHANGE: f64 = 1e-6;
/// An entry of A that counts as none, as part of its row.
const NONE_OF_ROW: f64 = 1e-12;
/// An entry of A that counts as none, as part of the whole matrix.
const NONE_OF_ALL: f64 = 1e-14;

/// Refuses a state whose velocities change.
pub(super) fn check_rates(derivatives: &Derivatives<'_>, point: &Point, after: f64) -> Result<(), LineariseError> {
    let nq = derivatives.sizes().0;
    let ns = derivatives.displacements();
    let quasi = &derivatives.equations.kinematics.quasi;
    let mut wrong: Vec<(f64, usize)> = Vec::new();
    for k in 0..quasi.len() {
        let rate = point.rates[nq + k].abs();
        let allowed = RESIDUE * (quasi[k].scale + point.a.row(ns + k).iter().map(|a| a.abs()).sum::<f64>());
        if rate > allowed || rate.is_nan() {
            wrong.push((rate / allowed, k));
        }
    }
    wrong.sort_by(|a, b| b.0.total_cmp(&a.0));
    if wrong.is_empty() {
        return Ok(());
    }
    let turning = wrong.iter().any(|(_, k)| is_turn(derivatives, quasi[*k].velocity));
    let list = wrong
        .iter()
        .take(4)
        .map(|(_, k)| format!("({})′ = {:.3e} {}", quasi[*k].name, point.rates[nq + k], per_second(&quasi[*k].unit)));
    let more = if wrong.len() > 4 { format!(" and {} more", wrong.len() - 4) } else { String::new() };
    let list = format!("{}{more}", list.collect::<Vec<_>>().join(", "));
    Err(LineariseError::NotSteady { list, after, turning })
}

/// `m/s^2` for `m/s`.
fn per_second(unit: &str) -> String {
    match unit.strip_suffix("/s") {
        Some(rest) => format!("{rest}/s^2"),
        None => format!("{unit}/s"),
    }
}

/// Whether a velocity is a ball's.
fn is_turn(derivatives: &Derivatives<'_>, velocity: usize) -> bool {
    let model = derivatives.model;
    velocity >= model.coordinates.len() && model.quasi_velocities[velocity - model.coordinates.len()].of_joint
}

/// Which entries of A are there at all, rounding left out.
pub fn pattern(a: &DMatrix<f64>) -> DMatrix<bool> {
    let all = a.amax() * NONE_OF_ALL;
    let rows: Vec<f64> = (0..a.nrows()).map(|i| (a.row(i).amax() * NONE_OF_ROW).max(all)).collect();
    DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)].abs() > rows[i])
}

/// The displacements on which nothing depends but others such.
pub(super) fn cyclic(a: &DMatrix<f64>, displacements: usize) -> Vec<bool> {
    let there = pattern(a);
    let mut cyclic = vec![true; displacements];
    let mut open: Vec<usize> = (displacements..a.nrows()).collect();
    while let Some(row) = open.pop() {
        for j in 0..displacements {
            if cyclic[j] && there[(row, j)] {
                cyclic[j] = false;
                open.push(j);
            }
        }
    }
    cyclic
}

/// Refuses a motion along which u′ does not stay zero, or A constant.
pub(super) fn check_constant(
    derivatives: &Derivatives<'_>,
    here: &Point,
    t: f64,
    y: &[f64],
    cyclic: &[bool],
) -> Result<(), LineariseError> {
    let (nq, _) = derivatives.sizes();
    let moves = here.rates[..nq].iter().any(|x| *x != 0.0);
    let later = if moves {
        along_the_motion(derivatives, here, t, y)?
    } else if derivatives.depends_on_time() {
        derivatives.telling_times(t).into_iter().map(|later| (later - t, y.to_vec())).collect()
    } else {
        return Ok(());
    };
    for (after, y) in later {
        let point = derivatives.at(t + after, &y)?;
        check_rates(derivatives, &point, after)?;
        check_same(derivatives, here, &point, cyclic, y.len() - nq, after)?;
    }
    Ok(())
}

/// Refuses a matrix that differs from that at the start in rows that are not cyclic.
fn check_same(
    derivatives: &Derivatives<'_>,
    here: &Point,
    later: &Point,
    cyclic: &[bool],
    nu: usize,
    after: f64,
) -> Result<(), LineariseError> {
    let ns = cyclic.len();
    let states = derivatives.states(&vec![0.0; derivatives.sizes().0 + nu], cyclic);
    let all = here.a.amax().max(later.a.amax());
    let mut changed: Vec<(f64, usize, usize)> = Vec::new();
    for i in (0..ns + nu).filter(|&i| i >= ns || !cyclic[i]) {
        let row = here.a.row(i).amax().max(later.a.row(i).amax());
        for j in 0..ns + nu {
            let change = (later.a[(i, j)] - here.a[(i, j)]).abs();
            let allowed = CHANGE * row.max(1e-3 * all);
            if change > allowed || change.is_nan() {
                changed.push((change / allowed, i, j));
            }
        }
    }
    changed.sort_by(|a, b| b.0.total_cmp(&a.0));
    if changed.is_empty() {
        return Ok(());
    }
    let list = changed.iter().take(3).map(|&(_, i, j)| {
        let (row, column) = (&states[i].name, &states[j].name);
        format!("∂({row})′/∂({column}) goes from {:.6} to {:.6}", here.a[(i, j)], later.a[(i, j)])
    });
    let turning = derivatives.model.quasi_velocities.iter().any(|u| u.of_joint);
    Err(LineariseError::Changing { list: list.collect::<Vec<_>>().join(", "), after, turning })
}

/// Steps of the classical Runge-Kutta method between two of the states.
const STEPS: usize = 32;

/// The state at a few times later: a part of a radian or of a unit on.
fn along_the_motion(
    derivatives: &Derivatives<'_>,
    here: &Point,
    t: f64,
    y: &[f64],
) -> Result<Vec<(f64, Vec<f64>)>, LineariseError> {
    let coordinates = derivatives.model.coordinates.iter().zip(&here.rates);
    let speed = coordinates.map(|(c, rate)| rate.abs() / c.scale).fold(0.0, f64::max);
    let (ns, n) = (derivatives.displacements(), here.a.nrows());
    let frequency = here.a.view((ns, 0), (n - ns, n)).iter().fold(0.0, |m: f64, a| m.max(a.abs())).sqrt();
    let longest = 0.5 / speed.max(0.2 * frequency).max(1e-3);
    let (mut states, mut now, mut before) = (Vec::new(), y.to_vec(), 0.0);
    for part in [0.11, 0.37, 1.0] {
        let after = part * longest;
        let h = (after - before) / STEPS as f64;
        for k in 0..STEPS {
            now = step(derivatives, t + before + h * k as f64, &now, h)?;
        }
        states.push((after, now.clone()));
        before = after;
    }
    Ok(states)
}

/// One step of the classical Runge-Kutta method.
fn step(derivatives: &Derivatives<'_>, t: f64, y: &[f64], h: f64) -> Result<Vec<f64>, LineariseError> {
    let moved = |k: &[f64], part: f64| -> Vec<f64> { y.iter().zip(k).map(|(y, k)| y + h * part * k).collect() };
    let k1 = derivatives.rates(t, y)?;
    let k2 = derivatives.rates(t + 0.5 * h, &moved(&k1, 0.5))?;
    let k3 = derivatives.rates(t + 0.5 * h, &moved(&k2, 0.5))?;
    let k4 = derivatives.rates(t + h, &moved(&k3, 1.0))?;
    Ok((0..y.len()).map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])).collect())
}
