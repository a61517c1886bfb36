//! Dimensions that must agree; the messages name both sides.

use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::{Lowering, Reported, Typed};
use crate::place::Place;
use crate::symbols::Formula;

impl<'g> Lowering<'g> {
    /// Demands a dimension.
    pub fn demand(
        &mut self,
        typed: &Typed<'g>,
        wanted: &Dimension,
        angle: bool,
        formula: &Formula,
        what: &str,
    ) -> Result<(), Reported> {
        match self.unifier.unify(&typed.dimension, wanted) {
            Ok(()) => Ok(()),
            Err(conflict) => {
                let (found, wanted) = *conflict;
                let message = format!(
                    "{what} is {} [{}], but `{}` is {} [{}]",
                    wanted.kind(angle),
                    wanted.unit(angle),
                    formula.text,
                    found.kind(typed.angle),
                    found.unit(typed.angle)
                );
                Err(self.report(formula.place.clone(), message))
            }
        }
    }

    pub(crate) fn no_conditions(
        &mut self,
        args: &[(Typed<'g>, std::ops::Range<usize>)],
        formula: &Formula,
    ) -> Result<(), Reported> {
        match args.iter().find(|(a, _)| a.condition) {
            None => Ok(()),
            Some((_, span)) => {
                Err(self.report(formula.place.part(span), "a comparison is not a number; use it in `if(.., .., ..)`"))
            }
        }
    }

    /// Demands equal dimensions; the message names both sides.
    pub(crate) fn same(
        &mut self,
        a: &(Typed<'g>, std::ops::Range<usize>),
        b: &(Typed<'g>, std::ops::Range<usize>),
        formula: &Formula,
        place: &Place,
        verb: &str,
    ) -> Result<(), Reported> {
        let Err(conflict) = self.unifier.unify(&a.0.dimension, &b.0.dimension) else { return Ok(()) };
        let (da, db) = *conflict;
        let text = |span: &std::ops::Range<usize>| match formula.text.get(span.clone()) {
            Some(text) if !text.is_empty() => format!("`{text}`"),
            _ => "its argument".into(),
        };
        let describe = |d: &Dimension, angle: bool| format!("{} [{}]", d.kind(angle), d.unit(angle));
        let message = format!(
            "cannot {verb} {} and {}: {} is {}, {} is {}",
            text(&a.1),
            text(&b.1),
            text(&a.1),
            describe(&da, a.0.angle),
            text(&b.1),
            describe(&db, b.0.angle)
        );
        Err(self.report(place.clone(), message))
    }

    pub(crate) fn pure(
        &mut self,
        a: &(Typed<'g>, std::ops::Range<usize>),
        formula: &Formula,
        what: &str,
    ) -> Result<(), Reported> {
        let Err(conflict) = self.unifier.unify(&a.0.dimension, &Dimension::NONE) else { return Ok(()) };
        let found = conflict.0;
        // Of the time alone, as in sin(t): it counts seconds.
        let others = Kinds::TIME.not();
        if found.is_power_of_time() && !self.dependence.any(a.0.expr, others) {
            return Ok(());
        }
        let text = formula.text.get(a.1.clone()).unwrap_or("");
        let message = format!(
            "{what} must be a pure number or an angle, but `{text}` is {} [{}]",
            found.kind(a.0.angle),
            found.unit(a.0.angle)
        );
        Err(self.report(formula.place.part(&a.1), message))
    }
}
