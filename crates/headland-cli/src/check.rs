//! `headland check`: what a scene is, or everything that is wrong with it.

use std::fmt::Write;

use headland::dynamics::kinematics::velocity_name;
use headland::model::ElementKind;
use headland::{DeriveOptions, Method, derive};

use crate::load::{derive_failure, load};
use crate::{Failure, SceneArgs, print};

pub(crate) fn check(args: &SceneArgs) -> Result<(), Failure> {
    let model = load(args, &[])?.at_start();
    let equations = derive(&model, &DeriveOptions { compare: true, ..DeriveOptions::default() })
        .map_err(|e| derive_failure(&model, &e))?;
    let start = headland::dynamics::initial_velocities(&model, &equations.kinematics)
        .map_err(|e| derive_failure(&model, &e))?;
    if model.run.method != "auto" {
        Method::parse(&model.run.method)?;
    }
    let mut text = String::new();
    let count = |kind| model.count(kind);
    let _ = writeln!(text, "model      {}", model.title);
    let _ = writeln!(text, "freedom    {}", equations.freedom(&model));
    let quasi = equations.kinematics.quasi.iter().zip(&start);
    let quasi: Vec<String> = quasi.map(|(u, value)| format!("{} = {value} {}", u.name, u.unit)).collect();
    let _ = writeln!(text, "start      {}", shorten(&quasi));
    let dependent: Vec<String> = equations.kinematics.dependent.iter().map(|v| velocity_name(&model, *v)).collect();
    if !dependent.is_empty() {
        let _ = writeln!(text, "dependent  {} (eliminated by the constraints)", shorten(&dependent));
    }
    let _ = writeln!(
        text,
        "elements   {} inertia, {} elastic, {} dissipative, {} force",
        count(ElementKind::Inertia),
        count(ElementKind::Elastic),
        count(ElementKind::Dissipative),
        count(ElementKind::Force)
    );
    let how = match equations.difference {
        Some(d) => format!("; both agree at random states to {d:.1e}"),
        None => String::new(),
    };
    let _ = writeln!(text, "derived    by `{}`: {}{how}", equations.algorithm, equations.why);
    let _ = writeln!(text, "outputs    {}", shorten(&model.outputs.iter().map(|o| o.name.clone()).collect::<Vec<_>>()));
    for warning in &model.warnings {
        let _ = writeln!(text, "warning    {}", model.source.show(warning));
    }
    let _ = writeln!(text, "ok");
    print(&text)
}

/// A list, its middle left out if it is long.
fn shorten(names: &[String]) -> String {
    match names.len() {
        0..=12 => names.join(", "),
        n => format!("{}, … ({} more), {}", names[..8].join(", "), n - 10, names[n - 2..].join(", ")),
    }
}
