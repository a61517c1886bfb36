//! Definitions made in the order of need: a walk with an explicit stack, so that a train of thousands of members is no
//! deeper than one of three, and cycles are named.

use crate::lower::{Lowering, Made, Reported, Typed};
use crate::place::Place;
use crate::symbols::{Formula, Rule, Symbol, member_name};
use headland_expr::parse::{Item, Program};
use std::sync::Arc;

/// A definition's member: symbol position and member.
pub(crate) type Instance = (usize, i64);

pub(crate) enum State<'g> {
    /// Its dependencies are being made.
    Open,
    Done(Typed<'g>),
    Failed,
}

impl<'g> Lowering<'g> {
    /// Makes a member of a definition, by name.
    pub fn definition(&mut self, symbol: usize, member: i64) -> Result<Typed<'g>, Reported> {
        self.make_instances(vec![(symbol, member)])?;
        match self.instances.get(&(symbol, member)) {
            Some(State::Done(typed)) => Ok(typed.clone()),
            _ => Err(Reported),
        }
    }

    pub(crate) fn rule(&self, (symbol, member): Instance) -> Option<&Rule> {
        match self.symbols.by_name.get_index(symbol) {
            Some((_, Symbol::Definition(rules, _))) => rules.get(&member),
            _ => None,
        }
    }

    pub(crate) fn instance_name(&self, (symbol, member): Instance) -> String {
        let name = self.symbols.by_name.get_index(symbol).map_or("?", |(name, _)| name);
        member_name(name, member)
    }

    pub(crate) fn require(&mut self, formula: &Formula, bindings: &[(Arc<str>, i64)]) -> Result<(), Reported> {
        let needed = self.dependencies(&formula.program, bindings);
        self.make_instances(needed)
    }

    /// Makes definitions and what they need, depth first with an explicit stack.
    pub(crate) fn make_instances(&mut self, wanted: Vec<Instance>) -> Result<(), Reported> {
        let mut ok = true;
        let mut stack: Vec<Instance> = wanted.into_iter().rev().collect();
        while let Some(&top) = stack.last() {
            match self.instances.get(&top) {
                Some(State::Done(_)) => {
                    stack.pop();
                }
                Some(State::Failed) => {
                    ok = false;
                    stack.pop();
                }
                Some(State::Open) => {
                    stack.pop();
                    let made = self.make_instance(top);
                    ok &= made.is_ok();
                    self.instances.insert(top, made.map_or(State::Failed, State::Done));
                }
                None => {
                    let Some(rule) = self.rule(top) else {
                        stack.pop();
                        continue;
                    };
                    let (program, bindings) =
                        (rule.formula.program.clone(), rule.binding.iter().cloned().collect::<Vec<_>>());
                    self.instances.insert(top, State::Open);
                    let needed = self.dependencies(&program, &bindings);
                    if let Some(cycle) = needed.iter().find(|d| matches!(self.instances.get(d), Some(State::Open))) {
                        self.report_cycle(*cycle, &stack);
                        ok = false;
                        for open in &stack {
                            if matches!(self.instances.get(open), Some(State::Open)) {
                                self.instances.insert(*open, State::Failed);
                            }
                        }
                    } else {
                        stack.extend(needed.into_iter().rev());
                    }
                }
            }
        }
        if ok { Ok(()) } else { Err(Reported) }
    }

    pub(crate) fn make_instance(&mut self, instance: Instance) -> Result<Typed<'g>, Reported> {
        let Some(rule) = self.rule(instance).cloned() else { return Err(Reported) };
        let bindings: Vec<(Arc<str>, i64)> = rule.binding.iter().cloned().collect();
        let mut typed = self.run(&rule.formula.program, &rule.formula, &bindings)?;
        if typed.condition {
            return Err(self.report(rule.formula.place, "a comparison stands only inside `if(.., .., ..)`"));
        }
        let name = self.symbols.by_name.get_index(instance.0).map_or("", |(name, _)| name);
        if let Some((dimension, angle)) = self.declared.get(name).cloned() {
            let what = format!("`{}`", self.instance_name(instance));
            self.demand(&typed, &dimension, angle, &rule.formula, &what)?;
            typed = Typed { dimension, angle, ..typed };
        }
        let id = self.graph.id(typed.expr);
        let name = self.instance_name(instance);
        self.made.push(Made {
            name,
            id,
            dimension: typed.dimension.clone(),
            angle: typed.angle,
            place: rule.formula.place,
        });
        Ok(typed)
    }

    pub(crate) fn report_cycle(&mut self, first: Instance, stack: &[Instance]) {
        let mut path: Vec<String> = stack
            .iter()
            .skip_while(|i| **i != first)
            .filter(|i| matches!(self.instances.get(i), Some(State::Open)))
            .map(|i| format!("`{}`", self.instance_name(*i)))
            .collect();
        if path.len() > 6 {
            path.splice(3..path.len() - 2, ["…".to_string()]);
        }
        path.push(format!("`{}`", self.instance_name(first)));
        let place = self.rule(first).map_or(Place::Program, |r| r.formula.place.clone());
        self.report(place, format!("cyclic definition: {}", path.join(" needs ")));
    }

    /// The definitions that a program uses directly.
    pub(crate) fn dependencies(&self, program: &Program, bindings: &[(Arc<str>, i64)]) -> Vec<Instance> {
        let mut found = Vec::new();
        let mut work = vec![(program, bindings.to_vec())];
        while let Some((program, bindings)) = work.pop() {
            for item in &program.items {
                match item {
                    Item::Name { name, index, .. } => {
                        let Some((symbol, _, Symbol::Definition(rules, _))) =
                            self.symbols.by_name.get_full(name.as_str())
                        else {
                            continue;
                        };
                        let member = match index {
                            None => 0,
                            Some(index) => match self.symbols.index_value(index, &bindings) {
                                Ok(member) => member,
                                Err(_) => continue, // reported when the name is used
                            },
                        };
                        if rules.contains_key(&member) {
                            found.push((symbol, member));
                        }
                    }
                    Item::Sum { index, body } => {
                        if let Some((key, Symbol::Index(n))) = self.symbols.by_name.get_key_value(index.as_str()) {
                            for k in (1..=*n).rev() {
                                let mut inner = bindings.clone();
                                inner.push((key.clone(), k));
                                work.push((body, inner));
                            }
                        }
                    }
                    _ => {}
                }
            }
        }
        found
    }
}
