//! [`Contact`]: what may touch, slip or leave, and [`Model::in_modes`]: the model in which each contact does one of these.
//!
//! ```text
//! rolling    gap = 0, slip = 0                     forces: multipliers, within the cone of friction
//! sliding    gap = 0                               force: N n − (μ(|s|)/|s| + ν) N s,  N the multiplier of the gap
//! free       —                                     no force
//! ```
//! The modes are alternatives of one scene: coordinates, velocities and inertia are the same, rows and forces differ.

use headland_expr::{Expr, NodeId};

use crate::model::{Derived, Model, VectorNodes};
use crate::place::Place;

/// What a contact does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mode {
    /// Apart.
    Free,
    /// Touching, with slip.
    Sliding,
    /// Touching without slip.
    Rolling,
}

impl Mode {
    /// Its name.
    pub fn name(self) -> &'static str {
        ["free", "sliding", "rolling"][self as usize]
    }
}

/// A hard contact. Vectors stand along the axes of the surface.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Name with index.
    pub name: String,
    /// Where it was written.
    pub place: Place,
    /// What the model at hand lets it do.
    pub mode: Mode,
    /// What it does at the start; `None`: by gap and slip.
    pub start: Option<Mode>,
    /// Row of the kinematics that keeps the gap closed, in modes with contact.
    pub gap_row: Option<usize>,
    /// Rows that keep the slip at zero, in rolling, each with its axis of the surface.
    pub slip_rows: Vec<(usize, usize)>,
    /// The gap, by q and t; its first and second rates.
    pub gap: [NodeId; 3],
    /// From the surface to the body.
    pub normal: VectorNodes,
    /// Slip velocity: with its component along the normal, the rate of the gap.
    pub slip: VectorNodes,
    /// Rate of the slip velocity.
    pub slip_rate: VectorNodes,
    /// Friction; without it the contact never slips.
    pub friction: Option<Friction>,
    /// Normal speed after an impact by that before.
    pub restitution: NodeId,
    /// The contact's force as inputs, derived quantities.
    pub force: VectorNodes,
    /// Its normal component as input, a derived quantity.
    pub normal_force: NodeId,
}

/// Friction of a hard contact.
#[derive(Clone, Debug)]
pub struct Friction {
    /// Up to which part of the normal force it rolls.
    pub limit: NodeId,
    /// Coefficient where it starts to slip.
    pub kinetic: NodeId,
    /// The force of friction while sliding, by the normal force [`Self::normal_force`] as an input.
    pub force: VectorNodes,
    /// Position of the force among [`Model::loads`]; it is nothing unless the contact slides.
    pub load: usize,
    /// Input: the normal force while sliding.
    pub normal_force: NodeId,
    /// Inputs: the direction in which it slides, and what is added to the slip so that it has a direction where it begins.
    pub direction: VectorNodes,
    /// See [`Self::direction`].
    pub shift: VectorNodes,
    /// True where friction grows with the slip from nothing: then it never sticks.
    pub viscous: bool,
}

impl Model {
    /// The model in which each contact is in the given mode; call it on the model as it was built.
    pub fn in_modes(&self, modes: &[Mode]) -> Model {
        let mut model = self.clone();
        let mut dropped = vec![false; self.kinematics.len()];
        for (contact, &mode) in model.contacts.iter_mut().zip(modes) {
            contact.mode = mode;
            if mode != Mode::Rolling {
                contact.slip_rows.drain(..).for_each(|(row, _)| dropped[row] = true);
            }
            if mode == Mode::Free {
                contact.gap_row.take().into_iter().for_each(|row| dropped[row] = true);
            }
        }
        model.drop_rows(&dropped);
        let zero = model.graph.id(Expr::Const(0.0));
        for contact in &model.contacts {
            if let Some(friction) = &contact.friction {
                model.loads[friction.load].force =
                    if contact.mode == Mode::Sliding { friction.force } else { [zero; 3] };
            }
        }
        model
    }

    /// The model with which a run begins: contacts whose start the scene leaves open are free until looked at.
    pub fn at_start(&self) -> Model {
        self.in_modes(&self.contacts.iter().map(|c| c.start.unwrap_or(Mode::Free)).collect::<Vec<_>>())
    }

    /// Leaves out rows of the kinematics; what refers to rows goes on to mean the same ones.
    fn drop_rows(&mut self, dropped: &[bool]) {
        let mut next = 0;
        let renumbered: Vec<Option<usize>> = dropped
            .iter()
            .map(|gone| {
                next += usize::from(!gone);
                (!gone).then(|| next - 1)
            })
            .collect();
        let mut position = 0;
        self.kinematics.retain(|_| {
            position += 1;
            !dropped[position - 1]
        });
        for contact in &mut self.contacts {
            contact.gap_row = contact.gap_row.and_then(|row| renumbered[row]);
            for (row, _) in &mut contact.slip_rows {
                *row = renumbered[*row].unwrap_or(*row);
            }
        }
        for derived in &mut self.derived {
            match &mut derived.what {
                Derived::Multiplier(row) => *row = renumbered[*row].unwrap_or(usize::MAX),
                Derived::Reaction(reaction) => {
                    let kept = reaction.constraints.iter().filter_map(|(row, a)| Some((renumbered[*row]?, *a)));
                    reaction.constraints = kept.collect();
                }
                _ => {}
            }
        }
    }

    /// Modes in which the contacts are in this model.
    pub fn modes(&self) -> Vec<Mode> {
        self.contacts.iter().map(|c| c.mode).collect()
    }
}
