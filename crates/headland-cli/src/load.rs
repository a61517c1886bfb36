//! A scene file with settings, as a model.

use headland::model::Diagnostic;
use headland::{DeriveError, Model, Scene};

use crate::{Failure, SceneArgs};

/// A derivation that failed, shown at its place in the scene.
pub(crate) fn derive_failure(model: &Model, error: &DeriveError) -> Failure {
    let message = error.to_string();
    Failure::Input(match error.place(model) {
        Some(place) => model.source.show(&Diagnostic { place, message }),
        None => message,
    })
}

/// Reads the file, applies `--set`, checks.
pub(crate) fn load(args: &SceneArgs, settings: &[(String, String)]) -> Result<Model, Failure> {
    let name = args.model.display().to_string();
    let text =
        std::fs::read_to_string(&args.model).map_err(|e| Failure::Input(format!("cannot read `{name}`: {e}")))?;
    let mut scene = Scene::parse(&name, &text)?;
    for set in &args.sets {
        let Some((name, value)) = set.split_once('=') else {
            return Err(Failure::Input(format!("`--set {set}`: expected NAME=VALUE")));
        };
        scene.set(name, value)?;
    }
    for (name, value) in settings {
        scene.set(name, value)?;
    }
    Ok(scene.build()?)
}
