//! What the names in an expression stand for: symbols and their members, parts of a frame's motion, what the equations can
//! tell, and rates.

use std::sync::Arc;

use headland_expr::parse::{Item, Program, suggestion};
use headland_expr::{Expr, NodeId};
use rustc_hash::FxHashMap;

use crate::assembly::{QUANTITIES, quantity};
use crate::definitions::State;
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::{Lowering, Reported, Typed, per_time};
use crate::model::DerivedQuantity;
use crate::place::Place;
use crate::symbols::{Rule, Symbol, member_name};

impl<'g> Lowering<'g> {
    /// What a name stands for at its place in an expression.
    pub(crate) fn name(
        &mut self,
        name: &str,
        index: Option<&Program>,
        primes: u8,
        bindings: &[(Arc<str>, i64)],
        place: Place,
    ) -> Result<Typed<'g>, Reported> {
        if index.is_none() && primes == 0 {
            if let Some((_, k)) = bindings.iter().rev().find(|(n, _)| **n == *name) {
                return Ok(Typed::number(*k as f64, Dimension::NONE));
            }
            if name == "pi" || name == "π" {
                return Ok(Typed { angle: true, ..Typed::number(std::f64::consts::PI, Dimension::NONE) });
            }
        }
        if let Some(found) = self.derived_quantity(name, index, primes, bindings, &place) {
            return found;
        }
        if let Some(found) = self.frame_quantity(name, index, primes, bindings, &place) {
            return found;
        }
        let Some((symbol, _, kind)) = self.symbols.by_name.get_full(name) else {
            if name.split_once('.').is_some_and(|(of, _)| self.unmade.iter().any(|n| n == of)) {
                return Err(Reported);
            }
            let names = self.symbols.by_name.keys().map(|k| &**k).chain(["pi"]);
            let hint = suggestion(name, names);
            return Err(self.report(place, format!("undefined name `{name}`{hint}")));
        };
        let member = match index.map(|i| self.symbols.index_value(i, bindings)) {
            None => 0,
            Some(Ok(member)) => member,
            Some(Err(message)) => return Err(self.report(place, message)),
        };
        let count = match kind {
            Symbol::Parameter(values, true) => values.len() as i64,
            Symbol::Parameter(_, false) => 0,
            Symbol::Coordinate(m) | Symbol::QuasiVelocity(m) | Symbol::Frame(m) | Symbol::Joint(m) => m.last(),
            Symbol::Definition(rules, _) if rules.contains_key(&0) => 0,
            Symbol::Definition(rules, _) => rules.len() as i64,
            _ => 0,
        };
        let family = count > 0 || matches!(kind, Symbol::Parameter(_, true));
        if index.is_none() && family {
            return Err(self
                .report(place, format!("`{name}` has {count} members; which one? Write `{name}[1]` or `{name}[k]`")));
        }
        if index.is_some() && !family {
            return Err(self.report(place, format!("`{name}` is {} without members; it takes no index", kind.kind())));
        }
        let missing = match kind {
            Symbol::Definition(rules, _) => !rules.contains_key(&member),
            Symbol::Coordinate(m) | Symbol::QuasiVelocity(m) => m.get(member).is_none(),
            _ => index.is_some() && !(1..=count).contains(&member),
        };
        if missing {
            let last = |rules: &FxHashMap<i64, Rule>| rules.keys().copied().max().unwrap_or(0);
            let count = if let Symbol::Definition(rules, _) = kind { last(rules) } else { count };
            return Err(self.report(place, format!("`{name}[{member}]` does not exist; members run from 1 to {count}")));
        }
        let wrong_prime = |kind: &Symbol| format!("`{name}` is {}: it has no rate", kind.kind());
        match kind {
            Symbol::Time if primes == 0 => Ok(Typed {
                expr: self.graph.expr(self.time),
                dimension: Dimension::time(),
                angle: false,
                condition: false,
            }),
            Symbol::Parameter(values, array) if primes == 0 => {
                if *array
                    && let Some(Item::Name { name: variable, index: None, .. }) = index.and_then(|i| i.items.first())
                    && index.is_some_and(|i| i.items.len() == 1)
                    && let Some((variable, Symbol::Index(n))) = self.symbols.by_name.get_key_value(variable.as_str())
                {
                    let (variable, n) = (variable.clone(), *n);
                    let longest = self.indexed.entry(name.to_string()).or_insert((variable.clone(), n));
                    if longest.1 < n {
                        *longest = (variable, n);
                    }
                }
                let (id, dimension, angle) = values[member.max(1) as usize - 1].clone();
                Ok(Typed { expr: self.graph.expr(id), dimension, angle, condition: false })
            }
            Symbol::Index(n) if primes == 0 => {
                let message = format!(
                    "the index `{name}` (1 to {n}) has no value here; a name with `[{name}]` on the left gives it one"
                );
                Err(self.report(place, message))
            }
            Symbol::Coordinate(members) => {
                let i = members.get(member).unwrap_or_default();
                let c = &self.coordinates[i];
                let id = [c.q, c.rate, c.acceleration][primes as usize];
                let (dimension, angle) = &self.coordinate_types[i];
                Ok(Typed {
                    expr: self.graph.expr(id),
                    dimension: per_time(dimension, primes),
                    angle: *angle,
                    condition: false,
                })
            }
            Symbol::QuasiVelocity(members) if primes < 2 => {
                let i = members.get(member).unwrap_or_default();
                let u = &self.quasi_velocities[i];
                let id = [u.u, u.acceleration][primes as usize];
                let (dimension, angle) = &self.quasi_types[i];
                Ok(Typed {
                    expr: self.graph.expr(id),
                    dimension: per_time(dimension, primes),
                    angle: *angle,
                    condition: false,
                })
            }
            Symbol::Definition(..) => {
                self.used.insert(name.into());
                let Some(State::Done(typed)) = self.instances.get(&(symbol, member)) else { return Err(Reported) };
                let typed = typed.clone();
                if primes == 0 {
                    return Ok(typed);
                }
                let expr = self.time_derivative(typed.expr, primes).map_err(|message| {
                    self.report(
                        place,
                        format!("`{}{}`: {message}", member_name(name, member), "'".repeat(primes as usize)),
                    )
                })?;
                Ok(Typed { expr, dimension: per_time(&typed.dimension, primes), ..typed })
            }
            Symbol::Table(..) => {
                Err(self.report(place, format!("`{name}` is a table; it is used as a function: `{name}(x)`")))
            }
            Symbol::Field(..) => {
                Err(self.report(place, format!("`{name}` is a table; it is used as a function: `{name}(x, y)`")))
            }
            kind => {
                let message = wrong_prime(kind);
                Err(self.report(place, message))
            }
        }
    }

    /// `contact.fz`, `hitch[2].tx`, `F_A1.power`: an input for what the equations can tell.
    fn derived_quantity(
        &mut self,
        name: &str,
        index: Option<&Program>,
        primes: u8,
        bindings: &[(Arc<str>, i64)],
        place: &Place,
    ) -> Option<Result<Typed<'g>, Reported>> {
        let (_, part) = name.split_once('.')?;
        let member = index.map_or(Ok(0), |i| self.symbols.index_value(i, bindings)).ok()?;
        let full = member_name(name, member);
        if let Some(total) = self.totals.get(&full).cloned() {
            return Some(match self.time_derivative(total.expr, primes) {
                Ok(expr) => Ok(Typed { expr, dimension: per_time(&total.dimension, primes), ..total }),
                Err(message) => Err(self.report(place.clone(), format!("`{full}`: {message}"))),
            });
        }
        let Some((what, dimension)) = self.derived_names.get(&full).cloned() else {
            let known = ["fx", "fy", "fz", "tx", "ty", "tz", "force", "power", "kinetic_energy", "potential_energy"];
            if !(known.contains(&part) || part.ends_with("residual")) || self.symbols.by_name.contains_key(name) {
                return None;
            }
            if self.unmade.iter().any(|n| Some(n.as_str()) == name.split('.').next()) {
                return Some(Err(Reported));
            }
            let names = self.derived_names.keys().chain(self.totals.keys());
            let hint = suggestion(&full, names.map(String::as_str));
            let message = if self.derived_names.is_empty() {
                format!(
                    "`{full}` follows from the equations of motion; it can stand in outputs, guards and events only"
                )
            } else {
                format!("undefined name `{full}`{hint}")
            };
            return Some(Err(self.report(place.clone(), message)));
        };
        if primes > 0 {
            return Some(Err(self.report(place.clone(), format!("`{full}` has no rate that is known"))));
        }
        let input = match self.derived.iter().find(|d| d.name == full) {
            Some(known) => known.input,
            None => {
                let input = self.dependence.input(self.graph, &full, Kinds::ACCELERATION);
                self.derived.push(DerivedQuantity { name: full, input, what });
                input
            }
        };
        Some(Ok(Typed { expr: self.graph.expr(input), ..Typed::number(0.0, dimension) }))
    }

    /// `bogie[2].x`: a part of the motion of a frame; `None` if the name is not of that kind.
    fn frame_quantity(
        &mut self,
        name: &str,
        index: Option<&Program>,
        primes: u8,
        bindings: &[(Arc<str>, i64)],
        place: &Place,
    ) -> Option<Result<Typed<'g>, Reported>> {
        let (owner, part) = name.split_once('.')?;
        let Some(Symbol::Frame(members)) = self.symbols.by_name.get(owner) else { return None };
        let member = match index.map(|i| self.symbols.index_value(i, bindings)) {
            None => 0,
            Some(Ok(member)) => member,
            Some(Err(message)) => return Some(Err(self.report(place.clone(), message))),
        };
        // a coordinate of the same name means the same and is shorter
        match self.symbols.by_name.get(name) {
            Some(Symbol::Coordinate(m) | Symbol::QuasiVelocity(m)) if m.get(member).is_some() => return None,
            _ => {}
        }
        let full = member_name(owner, member);
        let Some(frame) = members.get(member) else {
            let message = match (members.is_family(), index.is_some()) {
                (true, false) => {
                    format!("`{owner}` has {} members; which one? Write `{owner}[1].{part}`", members.last())
                }
                (false, true) => format!("`{owner}` has no members; it takes no index"),
                _ => format!("`{full}` does not exist; members run to {}", members.last()),
            };
            return Some(Err(self.report(place.clone(), message)));
        };
        let Some(motion) = self.frames.get(frame).copied().flatten() else {
            let message = format!("`{full}.{part}` moves; only what is constant can stand here");
            return Some(Err(self.report(place.clone(), message)));
        };
        let Some(mut typed) = quantity(&motion, part) else {
            let hint = suggestion(part, QUANTITIES.iter().map(|(n, _)| *n));
            let message =
                format!("`{full}` has no `{part}`{hint}; known: x, vx, ax, wx, omega_x, exx, roll, pitch, yaw, qw, ..");
            return Some(Err(self.report(place.clone(), message)));
        };
        if primes > 0 {
            // the rate of a position is at hand
            let (short, primes_left) = match (part, primes) {
                ("x" | "y" | "z", 1) => (quantity(&motion, &format!("v{part}")), 0),
                ("x" | "y" | "z", _) | ("vx" | "vy" | "vz", 1) => {
                    (quantity(&motion, &format!("a{}", part.trim_start_matches('v'))), 0)
                }
                _ => (None, primes),
            };
            typed = match short {
                Some(short) => short,
                None => match self.time_derivative(typed.expr, primes_left) {
                    Ok(expr) => Typed { expr, dimension: per_time(&typed.dimension, primes), ..typed },
                    Err(message) => {
                        return Some(Err(self.report(place.clone(), format!("`{full}.{part}`: {message}"))));
                    }
                },
            };
        }
        Some(Ok(typed))
    }

    /// Total derivative in time by the rates q′, q″, u′.
    pub(crate) fn time_derivative(&mut self, e: Expr<'g>, primes: u8) -> Result<Expr<'g>, String> {
        let mut e = e;
        for order in 0..primes {
            let id = self.graph.id(e);
            if let Some(known) = self.derivatives.get(&(id, 1)) {
                e = *known;
                continue;
            }
            let mut rate: FxHashMap<usize, NodeId> = FxHashMap::default();
            let input = |id: NodeId| self.graph.node(id).args[0] as usize;
            for c in &self.coordinates {
                rate.insert(input(c.q), c.rate);
                rate.insert(input(c.rate), c.acceleration);
            }
            for u in &self.quasi_velocities {
                rate.insert(input(u.u), u.acceleration);
            }
            if self.dependence.any(e, Kinds::ACCELERATION) {
                let what = if order == 0 { "it" } else { "its rate" };
                return Err(format!("{what} contains accelerations, whose rates are not known"));
            }
            let time = input(self.time);
            let derivative = self.graph.tangent(&[id], |i| {
                if i == time { Some(Expr::Const(1.0)) } else { rate.get(&i).map(|r| self.graph.expr(*r)) }
            })[0];
            self.derivatives.insert((id, 1), derivative);
            e = derivative;
        }
        Ok(e)
    }
}
