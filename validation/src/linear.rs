//! [`LinearCase`]: a scene linearised about its start, against matrices and eigenvalues known by other mathematics.

use std::time::Instant;

use headland::dynamics::linearise::{Linearised, linearise, start_of};
use headland::model::{Model, Scene};
use headland::{DeriveOptions, derive};

use crate::case::{CaseResult, Comparison, Moment};

/// A reference problem of linearisation.
#[derive(Clone, Copy, Debug)]
pub struct LinearCase {
    /// Its name.
    pub name: &'static str,
    /// File name and text of the scene.
    pub scene: (&'static str, &'static str),
    /// What is set in the scene.
    pub set: &'static [(&'static str, &'static str)],
    /// Allowed error, relative to `max(1, |reference|)`.
    pub allowed: f64,
    /// What to compare: name, value, reference.
    pub compare: fn(&Linearised) -> Vec<(String, f64, f64)>,
    /// A change of the scene by about one per cent that must make the case fail.
    pub bite: (&'static str, &'static str),
    /// Where the values come from.
    pub source: &'static str,
}

impl LinearCase {
    /// Linearises and compares.
    #[must_use]
    pub fn run(&self) -> CaseResult {
        self.run_with(&[])
    }

    /// As [`run`](Self::run), with more set in the scene.
    #[must_use]
    pub fn run_with(&self, more: &[(&str, &str)]) -> CaseResult {
        let clock = Instant::now();
        let outcome = self.linearise(more);
        let mut result = CaseResult {
            name: self.name,
            source: self.source,
            ratio: f64::INFINITY,
            compared: 0,
            worst: None,
            energy_balance: None,
            allowed_balance: 0.0,
            method: "linearise".into(),
            rhs: 0,
            seconds: clock.elapsed().as_secs_f64(),
            failure: None,
        };
        let linear = match outcome {
            Ok(linear) => linear,
            Err(message) => {
                result.failure = Some(message);
                return result;
            }
        };
        let compared = (self.compare)(&linear).into_iter().map(|(quantity, value, reference)| {
            Comparison::new(quantity, Moment::At(linear.t), value, reference, Ok(self.allowed))
        });
        let compared: Vec<Comparison> = compared.collect();
        result.compared = compared.len();
        result.worst = compared.into_iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()));
        result.ratio = result.worst.as_ref().map_or(f64::INFINITY, Comparison::ratio);
        result
    }

    fn linearise(&self, more: &[(&str, &str)]) -> Result<Linearised, String> {
        let mut scene = Scene::parse(self.scene.0, self.scene.1).map_err(|e| e.to_string())?;
        for (name, value) in self.set.iter().chain(more) {
            scene.set(name, value).map_err(|e| e.to_string())?;
        }
        let model: Model = scene.build().map_err(|e| e.to_string())?;
        let equations = derive(&model, &DeriveOptions::default()).map_err(|e| e.to_string())?;
        let y = start_of(&model, &equations).map_err(|e| e.to_string())?;
        linearise(&model, &equations, model.run.from, &y, &[]).map_err(|e| e.to_string())
    }
}
