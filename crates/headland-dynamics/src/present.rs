//! Derived equations as text, LaTeX and C, with the scene's own names and shared subexpressions named.

use std::fmt::Write;

use headland_expr::print::{ListingOptions, Style, c_file, latex_name, listing};
use headland_expr::{NodeId, Op};
use headland_model::{ElementKind, Model, Quantity};

use crate::derive::Equations;
use crate::solve::packed;

/// The form in which equations are written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// Text that the scene format reads back.
    Text,
    /// LaTeX.
    Latex,
    /// A C99 function.
    C,
}

/// Writes the equations: definitions, kinematics (2), structural matrices, `M u′ = F` (9).
pub fn equations_text(model: &Model, equations: &Equations, form: Form) -> String {
    match form {
        Form::Text => list(model, equations, Style::Text),
        Form::Latex => list(model, equations, Style::Latex),
        Form::C => c_text(model, equations),
    }
}

/// Names of the entries of M, F and of the structural matrix.
struct Named {
    rates: Vec<(String, NodeId)>,
    structure: Vec<(String, NodeId)>,
    mass: Vec<(String, NodeId)>,
    force: Vec<(String, NodeId)>,
}

fn name_entries(model: &Model, equations: &Equations) -> Named {
    let n = equations.kinematics.quasi.len();
    let rates = model.coordinates.iter().zip(&equations.kinematics.rates);
    let rates = rates.filter(|(c, rate)| c.rate != **rate).map(|(c, rate)| (format!("{}'", c.name), *rate)).collect();
    let entry = |base: &str, i: usize, j: usize| match n {
        1 => base.to_string(),
        _ if j == usize::MAX => format!("{base}[{}]", i + 1),
        _ => format!("{base}_{}[{}]", i + 1, j + 1),
    };
    let mut structure = Vec::new();
    for (e, row) in model.elements.iter().zip(&equations.structure_matrix) {
        for (k, node) in row.iter().enumerate() {
            // cos(psi) is better read as it is than as W_x
            let worth_a_name = model.graph.node(*node).op.arity() > 1;
            if let Some(base) = plain(&e.name).filter(|_| worth_a_name).map(|name| format!("W_{name}")) {
                let name = if n == 1 { base } else { format!("{}_{}", base.replace(['[', ']'], ""), k + 1) };
                structure.push((name, *node));
            }
        }
    }
    let lower = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
    Named {
        rates,
        structure,
        mass: lower.map(|(i, j)| (entry("M", i, j), equations.mass[packed(i, j)])).collect(),
        force: (0..n).map(|i| (entry("F", i, usize::MAX), equations.force[i])).collect(),
    }
}

/// The name if it is a name of the format, with or without an index.
fn plain(name: &str) -> Option<&str> {
    let base = name.split('[').next().unwrap_or(name);
    let good = |c: char| c.is_alphanumeric() || c == '_';
    (base.chars().all(good) && base.starts_with(|c: char| c.is_alphabetic())).then_some(name)
}

fn list(model: &Model, equations: &Equations, style: Style) -> String {
    let graph = &model.graph;
    let entries = name_entries(model, equations);
    let is_operation = |id: NodeId| !matches!(graph.node(id).op, Op::Input | Op::Const);
    let mut named: Vec<(NodeId, String)> = Vec::new();
    let mut aliases: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, id: NodeId, alias: bool| match named.iter().find(|(n, _)| *n == id) {
        Some((_, first)) if alias && first != name => aliases.push((name.to_string(), first.clone())),
        Some(_) => {}
        None if is_operation(id) => named.push((id, name.to_string())),
        None if alias && graph.node(id).op == Op::Input => {
            let input = graph.input_name(graph.node(id).args[0] as usize);
            if input != name {
                aliases.push((name.to_string(), input));
            }
        }
        None => {}
    };
    for Quantity { name, node, .. } in &model.definitions {
        add(name, *node, true);
    }
    for (name, node) in entries.structure.iter().chain(&entries.mass).chain(&entries.force) {
        add(name, *node, false);
    }

    let mut roots = entries.rates.clone();
    roots.extend(entries.structure.iter().filter(|(_, id)| is_operation(*id)).cloned());
    roots.extend(entries.mass);
    roots.extend(entries.force);
    if let Some(accelerations) = &equations.accelerations {
        let quasi = &equations.kinematics.quasi;
        roots.extend(quasi.iter().zip(accelerations).map(|(u, a)| (format!("{}'", u.name), *a)));
    }
    let mut seen = std::collections::HashSet::new();
    roots.retain(|(name, _)| seen.insert(name.clone()));
    let lines = listing(graph, style, &roots, &named, &ListingOptions::of(style)).lines;
    let comment = if style == Style::Latex { "%" } else { "#" };
    let mut text = header(model, equations, comment);
    let show = |n: &str| if style == Style::Latex { latex_name(n) } else { n.to_string() };
    let defined: Vec<&str> = lines.iter().map(|(name, _)| name.as_str()).collect();
    for (name, other) in aliases.iter().filter(|(_, other)| !defined.contains(&show(other).as_str())) {
        let _ = writeln!(text, "{}", line(&show(name), &show(other), style));
    }
    for (name, expression) in &lines {
        let _ = writeln!(text, "{}", line(name, expression, style));
        for (alias, _) in aliases.iter().filter(|(_, other)| show(other) == *name) {
            let _ = writeln!(text, "{}", line(&show(alias), name, style));
        }
    }
    if equations.accelerations.is_none() {
        let how = "M u' = F is solved by numbers at every evaluation";
        let _ = writeln!(text, "{comment} {how}: {} quasi-velocities", equations.kinematics.quasi.len());
    }
    if style == Style::Latex {
        text.push_str("\\end{align*}\n");
    }
    text
}

fn line(name: &str, expression: &str, style: Style) -> String {
    match style {
        Style::Latex => format!("{name} &= {expression} \\\\"),
        _ => format!("{name} = {expression}"),
    }
}

fn header(model: &Model, equations: &Equations, comment: &str) -> String {
    let mut text = String::new();
    let quasi: Vec<&str> = equations.kinematics.quasi.iter().map(|u| u.name.as_str()).collect();
    let _ = writeln!(text, "{comment} {}", model.title);
    let _ = writeln!(text, "{comment} {}", equations.freedom(model));
    let _ = writeln!(
        text,
        "{comment} quasi-velocities u: {}; rates q' = G u + g (2), then M u' = F (9), algorithm {} ({})",
        quasi.join(", "),
        equations.algorithm,
        equations.why
    );
    let inertia = model.count(ElementKind::Inertia);
    let _ = writeln!(text, "{comment} {inertia} inertia elements; W_x is the structural matrix of the element x");
    if comment == "%" {
        text.push_str("\\begin{align*}\n");
    }
    text
}

fn c_text(model: &Model, equations: &Equations) -> String {
    let graph = &model.graph;
    let mut roots = equations.kinematics.rates.clone();
    let mut rows: Vec<String> = model.coordinates.iter().map(|c| format!("{}'", c.name)).collect();
    let entries = name_entries(model, equations);
    match &equations.accelerations {
        Some(accelerations) => {
            roots.extend(accelerations);
            rows.extend(equations.kinematics.quasi.iter().map(|u| format!("{}'", u.name)));
        }
        None => {
            for (name, node) in entries.mass.iter().chain(&entries.force) {
                rows.push(name.clone());
                roots.push(*node);
            }
        }
    }
    let definitions: Vec<(NodeId, String)> = model.definitions.iter().map(|d| (d.node, d.name.clone())).collect();
    let mut text = String::new();
    let _ = writeln!(text, "/* {}", model.title.replace("*/", ""));
    let _ = writeln!(text, " * {}", equations.freedom(model));
    let needed = graph.needed(&roots);
    for i in 0..graph.input_count() {
        if needed.get(graph.input_id(i).index()).copied().unwrap_or(false) {
            let name = graph.input_name(i);
            let value = model
                .parameters
                .iter()
                .find(|p| p.input == i)
                .map_or(String::new(), |p| format!(" = {:e} {}", p.value, p.unit));
            let _ = writeln!(text, " * x[{i}]: {name}{value}");
        }
    }
    for (k, name) in rows.iter().enumerate() {
        let _ = writeln!(text, " * y[{k}]: {name}");
    }
    text.push_str(" */\n");
    text + &c_file(graph, "headland_rhs", &roots, &definitions)
}
