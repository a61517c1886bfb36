//! Impacts while other contacts touch: all of them answer at once, and each may let go.
//!
//! With the contacts taken away, `A_ij = J_i M⁻¹ J_jᵀ` the answer of contact i to an impulse at j, s the slip with the rate of
//! the gap as its normal part (Moreau 1988, with Newton's restitution):
//!
//! ```text
//! s_i⁺ = s_i + Σ_j A_ij p_j
//! n·s_i⁺ + e_i min(n·s_i, 0) ≥ 0,   n·p_i ≥ 0,   one of them zero;      p_i in the cone of friction, against the slip
//! ```
//! Solved contact by contact until nothing changes (projected Gauss-Seidel).

use headland_solve::SolveError;

use crate::contact::{ContactState, answers, dot, length, look, multiply, unit};
use crate::modes::{CLOSED, LOWEST_BOUNCE, TOLD};
use crate::report::{Observer, Status};
use crate::system::solve_factored;
use crate::time_loop::TimeLoop;
use crate::work::Work;
use headland_model::Mode;

/// Passes over the contacts.
const PASSES: usize = 20_000;

/// Change of an impulse, relative to the largest, that is none any more.
const SETTLED: f64 = 1e-15;

/// A contact as the others see it: its state, whether friction has a limit, and its normal speed after the impact at least.
struct Party {
    state: ContactState,
    slips: bool,
    rebound: f64,
    /// It neither lifts nor lets go.
    held: bool,
}

impl Party {
    fn new(state: &ContactState, slips: bool) -> Self {
        let rebound = -state.restitution * state.gap[1].min(0.0);
        let rebound = if rebound <= lowest(state) { 0.0 } else { rebound };
        Self { state: state.clone(), slips, rebound, held: false }
    }
}

impl TimeLoop<'_> {
    /// The contact that hits, those that hold, and those that are closed without holding.
    pub(crate) fn touching_together(&mut self, t: f64, k: usize) -> Vec<usize> {
        let system = self.work.system.clone();
        let states = look(&system, &mut self.work.problem, t, &self.y);
        let closed = |i: usize| system.modes[i] != Mode::Free || states[i].gap[0] <= CLOSED && states[i].gap[1] <= 0.0;
        (0..states.len()).filter(|&i| i == k || closed(i)).collect()
    }

    /// Contact `k` hits while others touch.
    pub(crate) fn hit_together(
        &mut self,
        t: f64,
        k: usize,
        parties: &[usize],
        observer: &mut dyn Observer,
    ) -> Result<(), SolveError> {
        let (scene, mut modes) = (self.contacts.scene, self.work.system.modes.clone());
        parties.iter().for_each(|&i| modes[i] = Mode::Free);
        let inputs = self.work.model_inputs(self.model, t, &self.y);
        let Some(form) = self.form(&modes, &inputs, t) else { return Ok(()) };
        let mut work = Work::new(form.system.clone(), self.method);
        let before = work.state_from(form.model, &inputs);
        self.contacts.aim(&mut work.problem);
        let states = look(&form.system, &mut work.problem, t, &before);
        let mut all: Vec<Party> =
            parties.iter().map(|&i| Party::new(&states[i], scene.contacts[i].friction.is_some())).collect();
        let (mass, columns) = answers(&form.system, &mut work.problem, t, &before);
        let columns: Vec<&Vec<[f64; 3]>> = parties.iter().map(|&i| &columns[i]).collect();
        let (y, after) = loop {
            let Some(impulses) = solve(&all, &mass, &columns) else {
                let names: Vec<&str> = parties.iter().map(|&i| scene.contacts[i].name.as_str()).collect();
                self.ending.status = Status::Failed(format!(
                    "the impact at t = {t} s of contacts that touch at once has no solution that could be found: {}",
                    names.join(", ")
                ));
                return Ok(());
            };
            let mut y = before.clone();
            let change = change_of(&mass, &columns, &impulses);
            y[form.system.nq..].iter_mut().zip(&change).for_each(|(u, d)| *u += d);
            let after = look(&form.system, &mut work.problem, t, &y);
            // one that would hardly lift stays, and the others have to know
            let stay = |party: &Party, i: usize| !party.held && after[i].gap[1] <= lowest(&after[i]);
            let held: Vec<bool> = all.iter().zip(parties).map(|(party, &i)| stay(party, i)).collect();
            let lifting = |i: usize| after[i].gap[1].abs() > 1e-12 * -states[k].gap[1];
            if !held.iter().zip(parties).any(|(held, &i)| *held && lifting(i)) {
                break (y, after);
            }
            for (party, held) in all.iter_mut().zip(held).filter(|(_, held)| *held) {
                (party.held, party.rebound) = (held, 0.0);
            }
        };
        let lost = work.kinetic(t, &before) - work.kinetic(t, &y);
        if let Some(balance) = &mut self.balance {
            balance.add_work(-lost);
        }
        self.contacts.impacts[k] += 1;
        if self.contacts.impacts[k] <= TOLD {
            let (name, speed, others) = (&scene.contacts[k].name, -states[k].gap[1], parties.len() - 1);
            let message =
                format!("`{name}` hits at {speed:.6} m/s while {others} other(s) touch, {lost:.6} J are lost");
            self.tell(t, &message, observer);
        }
        let mut soon: Option<f64> = None;
        for &i in parties {
            let (state, pull) = (&after[i], -after[i].gap[2]);
            if state.gap[1] > lowest(state).max(1e-12 * -states[k].gap[1]) {
                let turns = t + state.gap[1] / pull;
                soon = if pull > 0.0 { Some(soon.map_or(turns, |s| s.min(turns))) } else { soon };
                continue;
            }
            self.contacts.impacts[i] = 0;
            modes[i] = self.touching(i, state, 1e-9 * -states[k].gap[1]);
        }
        let inputs = work.model_inputs(form.model, t, &y);
        self.settle(t, modes, inputs, observer)?;
        self.contacts.soon = soon;
        Ok(())
    }
}

/// Speed from which a bounce is so low that rounding of positions hides it.
fn lowest(state: &ContactState) -> f64 {
    (2.0 * (-state.gap[2]).max(0.0) * LOWEST_BOUNCE).sqrt()
}

/// The change of the velocities by impulses at the contacts.
fn change_of(mass: &[f64], columns: &[&Vec<[f64; 3]>], impulses: &[[f64; 3]]) -> Vec<f64> {
    let nu = columns.first().map_or(0, |c| c.len());
    let push = |j: usize| columns.iter().zip(impulses).map(|(c, p)| dot(c[j], *p)).sum();
    let mut change: Vec<f64> = (0..nu).map(push).collect();
    solve_factored(mass, &mut change);
    change
}

fn solve(all: &[Party], mass: &[f64], columns: &[&Vec<[f64; 3]>]) -> Option<Vec<[f64; 3]>> {
    let count = all.len();
    let unit_vector = |m: usize| [0, 1, 2].map(|i| f64::from(u8::from(i == m)));
    // a[i][j]: columns of A_ij
    let mut a = vec![vec![[[0.0; 3]; 3]; count]; count];
    for j in 0..count {
        for m in 0..3 {
            let mut impulses = vec![[0.0; 3]; count];
            impulses[j] = unit_vector(m);
            let change = change_of(mass, columns, &impulses);
            for i in 0..count {
                for (c, u) in columns[i].iter().zip(&change) {
                    (0..3).for_each(|n| a[i][j][m][n] += c[n] * u);
                }
            }
        }
    }
    let mut p = vec![[0.0; 3]; count];
    for _ in 0..PASSES {
        let mut moved = 0.0_f64;
        for i in 0..count {
            let mut s = all[i].state.slip;
            for j in 0..count {
                let part = multiply(a[i][j], p[j]);
                (0..3).for_each(|n| s[n] += part[n]);
            }
            let next = answer(&all[i], &a[i][i], s, p[i]);
            moved = moved.max(length([0, 1, 2].map(|n| next[n] - p[i][n])));
            p[i] = next;
        }
        let largest = p.iter().fold(0.0_f64, |most, p| most.max(length(*p)));
        if !largest.is_finite() {
            return None;
        }
        if moved <= SETTLED * largest {
            return Some(p);
        }
    }
    None
}

/// The impulse of one contact that answers its slip, the others as they are.
fn answer(party: &Party, a: &[[f64; 3]; 3], s: [f64; 3], p: [f64; 3]) -> [f64; 3] {
    let n = party.state.normal;
    let stiff = dot(n, multiply(*a, n));
    if stiff <= 0.0 {
        return p;
    }
    let pressing = dot(n, p) - (dot(n, s) - party.rebound) / stiff;
    let pressing = if party.held { pressing } else { pressing.max(0.0) };
    // the slip after the normal part has moved
    let by = pressing - dot(n, p);
    let along = multiply(*a, n.map(|x| by * x));
    let slip = party.state.across([0, 1, 2].map(|i| s[i] + along[i]));
    let size = (0..3).fold(0.0_f64, |most, m| most.max(a[m][m]));
    let across = party.state.across(p);
    let mut push = [0, 1, 2].map(|i| across[i] - slip[i] / size);
    let most = if length(slip) > 0.0 && length(push) > party.state.limit * pressing {
        party.state.kinetic
    } else {
        party.state.limit
    };
    if pressing <= 0.0 {
        push = [0.0; 3];
    } else if party.slips && length(push) > most * pressing {
        push = unit(push).map(|x| x * most * pressing);
    }
    [0, 1, 2].map(|i| pressing * n[i] + push[i])
}
