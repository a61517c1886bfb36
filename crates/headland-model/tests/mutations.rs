//! Scenes that are wrong in random ways: reading and building never panic, and what is wrong is told with its place.

use std::fmt::Write;

use headland_model::{Model, ModelError, Place, Scene};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const SCENES: [&str; 9] = [
    include_str!("../../../models/chaplygin_sleigh.toml"),
    include_str!("../../../models/double_pendulum.toml"),
    include_str!("../../../models/paper_train.toml"),
    include_str!("../../../models/paper_train_cartesian.toml"),
    include_str!("../../../models/paper_train_figures.toml"),
    include_str!("../../../models/pendulum_prescribed_pivot.toml"),
    include_str!("../../../models/road_train.toml"),
    include_str!("../../../models/snakeboard.toml"),
    include_str!("../../../models/tractor.toml"),
];

const NAMES: &[&str] = &[
    "theta",
    "v",
    "t",
    "pi",
    "x",
    "k",
    "len",
    "sum",
    "sqrt",
    "if",
    "mu",
    "x'",
    "x''",
    "x'''",
    "theta[k]",
    "theta[0]",
    "theta[9]",
    "theta[k-1]",
    "l[k+1]",
    "t'",
    "m'",
    "v'",
    "and",
    "or",
    "not",
    "E",
    "e",
    "_",
    "ψ",
    "name",
    "inertia",
    "until",
    "true",
    "nan",
    "inf",
];
const NUMBERS: &[&str] = &[
    "0",
    "-1",
    "1",
    "2.5",
    "1e-300",
    "1e308",
    "1e400",
    "99999999999999999999",
    "1e",
    "0x10",
    "1_000",
    ".5",
    "5.",
    "-0",
    "1/0",
    "0/0",
    "nan",
    "inf",
    "-inf",
    "1979-05-27",
    "1.2.3",
    "1e-9999999999",
    "2^0.5",
    "1e9",
];
const UNITS: &[&str] = &[
    "m",
    "kg",
    "rad",
    "deg",
    "m/s^2",
    "kg*m^2",
    "N*s/m",
    "km/h",
    "%",
    "°",
    "m^999999999999",
    "m^-128",
    "m^0.5",
    "m//s",
    "parsec",
    "m*",
    "1",
    "",
    "s^-1",
    "m^(1/3)",
    "kg m",
    "µm",
    "m^m",
    "((m))",
    "m^2147483648",
    "kN/mm",
];
const OPERATORS: &[&str] = &[
    "+", "-", "*", "/", "^", "<", ">=", "==", "!=", "=", ",", "'", "(", ")", "[", "]", "{", "}", "\"", "\"\"\"", "#",
    "[[", "]]", "\\", "\n", "\r", "\t", "\u{0}", "..", ";", "&&", "**", "^-", "^^", "\\u00e9", "\\n",
];
const LETTERS: &[&str] = &[
    "é",
    "θ",
    "𝜓",
    "\u{301}",
    "\u{200d}",
    "\u{feff}",
    "你好",
    "👩‍👩‍👧",
    "\u{202e}",
    "\u{7f}",
    "ß",
    "İ",
    "\u{2028}",
    "−",
    "·",
    "²",
];
const LINES: &[&str] = &[
    "[initial]",
    "[[inertia]]",
    "[parameters]",
    "[run]",
    "[new]",
    "name = \"m\"",
    "value = \"m\"",
    "x = 0",
    "\"x'\" = 1",
    "[[force]]\nname = \"f\"\nvalue = \"1\"\ngeometric = \"x\"",
    "[indices]\nj = 3",
    "[tables]\nmu = { x = [0, 1], y = [1] }",
    "[outputs]\ncolumns = [\"x [furlong]\"]",
    "[scale]\nx = -1",
    "[run]\nmethod = \"euler\"",
    "columns = 5",
    "[[plot]]",
    "[tables]\nmu = { x = [0, 1, 1], y = [1, 2, 3] }",
    "stop_below = \"t\"",
    "independent = [\"y'\", \"y'\"]",
];

fn config(cases: u32, seed: u64) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(seed), ..ProptestConfig::default() }
}

/// Everything that must hold of what is reported about a text.
fn examine(text: &str, error: &ModelError) {
    assert!(!error.diagnostics.is_empty(), "an error without a reason in:\n{text}");
    assert!(!error.to_string().trim().is_empty());
    let lines: Vec<&str> = text.split('\n').collect();
    for d in &error.diagnostics {
        assert!(!d.message.trim().is_empty(), "an empty message at {:?} in:\n{text}", d.place);
        let Place::File(range) = &d.place else { continue };
        assert!(
            range.start <= range.end && range.end <= text.len(),
            "{range:?} of {}: {}\n{text}",
            text.len(),
            d.message
        );
        let (line, column) = error.source.position(range.start);
        let found = lines.get(line - 1);
        assert!(
            found.is_some_and(|l| column <= l.chars().count() + 1),
            "line {line}, column {column} do not exist: {}\n{text}",
            d.message
        );
    }
}

fn build(text: &str) -> Result<Model, ModelError> {
    let result = Scene::parse("scene.toml", text).and_then(|s| s.build());
    if let Err(error) = &result {
        examine(text, error);
    }
    result
}

/// Spans of the text whose characters all are of one kind.
fn spans(text: &str, is: impl Fn(char) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut spans: Vec<std::ops::Range<usize>> = Vec::new();
    for (i, c) in text.char_indices().filter(|(_, c)| is(*c)) {
        match spans.last_mut() {
            Some(last) if last.end == i => last.end = i + c.len_utf8(),
            _ => spans.push(i..i + c.len_utf8()),
        }
    }
    spans
}

/// The quotients behind a number: `4 m` has the unit `m`.
fn units(text: &str) -> Vec<std::ops::Range<usize>> {
    let quoted = spans(text, |c| c != '"' && c != '\n');
    let starts = quoted.into_iter().filter(|r| text[r.clone()].starts_with(|c: char| c.is_ascii_digit()));
    starts.filter_map(|r| text[r.clone()].find(' ').map(|i| r.start + i + 1..r.end)).collect()
}

/// One random change; `a` says where, `b` and `c` with what.
fn mutate(text: &str, kind: u8, a: u32, b: u32, c: u32) -> String {
    let pick = |list: &[&str], n: u32| list[n as usize % list.len()].to_string();
    let replace = |spans: Vec<std::ops::Range<usize>>, with: String| match spans.get(a as usize % spans.len().max(1)) {
        Some(span) => format!("{}{with}{}", &text[..span.start], &text[span.end..]),
        None => text.to_string(),
    };
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let n = lines.len().max(1);
    let (i, j) = (a as usize % n, b as usize % n);
    let boundary = |x: u32| {
        let mut at = x as usize % (text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let at = boundary(a);
    let insert = |new: &str| format!("{}{new}{}", &text[..at], &text[at..]);
    match kind {
        0 if !lines.is_empty() => {
            lines.remove(i);
        }
        1 if !lines.is_empty() => lines.insert(j, lines[i].clone()),
        2 if !lines.is_empty() => lines.swap(i, j),
        3 => lines.insert(i.min(lines.len()), pick(LINES, b)),
        4 => return replace(spans(text, |c| c.is_alphanumeric() || c == '_'), pick(NAMES, b)),
        5 => {
            // a name of the scene in the place of another
            let words = spans(text, |c| c.is_alphanumeric() || c == '_');
            let other =
                words.get(b as usize % words.len().max(1)).map_or(String::new(), |r| text[r.clone()].to_string());
            return replace(words, other);
        }
        6 => return replace(spans(text, |c| c.is_ascii_digit() || c == '.'), pick(NUMBERS, b)),
        7 => return replace(units(text), pick(UNITS, b)),
        8 => return replace(spans(text, |c| "+-*/^<>=,'".contains(c)), pick(OPERATORS, b)),
        9 => {
            return replace(
                spans(text, |c| "()[]{}\"".contains(c)),
                if c.is_multiple_of(2) { String::new() } else { pick(OPERATORS, b) },
            );
        }
        10 => return insert(&pick(OPERATORS, b)),
        11 => return insert(&pick(LETTERS, b)),
        12 => return insert(&char::from_u32(b % 0x11_0000).unwrap_or('\u{fffd}').to_string()),
        13 => return text[..at].to_string(),
        14 => return text[at..].to_string(),
        15 => {
            let to = boundary(b).max(at);
            return format!(
                "{}{}",
                &text[..at],
                &text[to.min(at + 60.min(to - at))..].trim_start_matches(|c: char| !c.is_ascii())
            );
        }
        16 => {
            // some bytes changed, read as lossily as an editor would
            let mut bytes = text.as_bytes().to_vec();
            let len = bytes.len().max(1);
            for k in 0..=c as usize % 4 {
                if let Some(byte) = bytes.get_mut((at + k * 97) % len) {
                    *byte = (b >> (8 * k)) as u8;
                }
            }
            return String::from_utf8_lossy(&bytes).into_owned();
        }
        _ => return insert(&pick(NUMBERS, b)),
    }
    lines.join("\n")
}

proptest! {
    #![proptest_config(config(1500, 1))]

    #[test]
    fn changed_scenes_never_panic(
        scene in 0..SCENES.len(),
        changes in prop::collection::vec((0u8..18, any::<u32>(), any::<u32>(), any::<u32>()), 1..4),
    ) {
        let text = changes.iter().fold(SCENES[scene].to_string(), |text, (kind, a, b, c)| mutate(&text, *kind, *a, *b, *c));
        let _ = build(&text);
    }
}

/// A scene with one expression in every kind of place; `@` stands for it.
const PLACES: [(&str, &str); 8] = [
    ("definition", "[definitions]\nd = \"@\"\n"),
    ("kinematics", "[quasi_velocities]\nw = \"1\"\n[kinematics]\n\"y'\" = \"@\"\n"),
    ("constraint", "[[constraint]]\nname = \"c\"\nequation = \"@\"\n"),
    ("force", "[[force]]\nname = \"f\"\nvalue = \"@\"\ngeometric = \"@\"\n"),
    ("prescribed", "[prescribed]\nz = \"@\"\n"),
    ("column", "[outputs]\ncolumns = [\"@\"]\n"),
    (
        "event",
        "[[event]]\nname = \"e\"\nquantity = \"@\"\n[[guard]]\nname = \"g\"\nquantity = \"@\"\nstop_below = \"@\"\n",
    ),
    ("run", "[run]\nuntil = \"@\"\ntolerance = \"@\"\n[scale]\nx = \"@\"\n"),
];

fn with_expression(place: usize, expression: &str) -> String {
    let quoted = expression.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n").replace('\r', "\\r");
    let quoted: String = quoted
        .chars()
        .flat_map(|c| if c.is_control() { format!("\\u{:04X}", c as u32).chars().collect() } else { vec![c] })
        .collect();
    let mut text = String::from(
        "[indices]\nk = 3\n[parameters]\nm = 1\nl = [1, 2, 3]\n[tables]\nmu = { x = [0, 1, 2], y = [0, 1, 0] }\n\
         [coordinates]\nx = \"1\"\ny = \"1\"\nz = \"1\"\n[initial]\nx = 0\ny = 0\nz = 0\nw = 0\n\
         [[inertia]]\nname = \"m\"\nvalue = \"m\"\ngeometric = \"x\"\n",
    );
    match PLACES[place].0 {
        "kinematics" => {}
        "prescribed" => text = text.replace("z = 0\n", "").replace("w = 0\n", ""),
        _ => text = text.replace("w = 0\n", ""),
    }
    text.push_str(&PLACES[place].1.replace('@', &quoted));
    text
}

const PIECES: &[&str] = &[
    "x",
    "y'",
    "t",
    "m",
    "l[k]",
    "l[2]",
    "mu",
    "w",
    "len",
    "(",
    ")",
    "[",
    "]",
    ",",
    "+",
    "-",
    "*",
    "/",
    "^",
    "^",
    "'",
    "1",
    "2.5e3",
    "1e400",
    "0",
    "sin(",
    "sqrt(",
    "if(",
    "sum(k, ",
    "min(",
    "atan2(",
    "hypot(",
    "smoothstep(",
    "<",
    ">=",
    "==",
    " and ",
    " or ",
    "not ",
    "pi",
    "k",
    "k+1",
    " m/s",
    "=",
    ".",
    "é",
    "\"",
    "\\",
    "\n",
    "\u{0}",
    "x''",
    "len(l)",
    "clamp(",
    "abs(",
    "ln(",
    "mu(x)",
    "step(",
    "cot(",
    "{",
    "}",
    " ",
    "#",
    "--",
    "_",
    "9999999999999999999999",
    "°",
    "%",
];

proptest! {
    #![proptest_config(config(2500, 2))]

    #[test]
    fn random_expressions_never_panic(
        place in 0..PLACES.len(),
        pieces in prop::collection::vec(0..PIECES.len(), 0..12),
    ) {
        let expression: String = pieces.iter().map(|i| PIECES[*i]).collect();
        let _ = build(&with_expression(place, &expression));
    }

    #[test]
    fn random_texts_never_panic(text in "\\PC{0,60}", place in 0..PLACES.len()) {
        let _ = build(&text);
        let _ = build(&with_expression(place, &text));
    }

    #[test]
    fn random_settings_never_panic(
        scene in 0..SCENES.len(),
        sets in prop::collection::vec((0..SETTABLE.len(), 0..PIECES.len(), 0..SET_TO.len(), 0u8..8), 1..4),
    ) {
        let Ok(mut read) = Scene::parse("scene.toml", SCENES[scene]) else { panic!("a scene of models/") };
        for (name, piece, value, how) in sets {
            let name = if how == 0 { PIECES[piece].to_string() } else { SETTABLE[name].to_string() };
            let value = if how == 1 { PIECES[piece].to_string() } else { SET_TO[value].to_string() };
            if let Err(error) = read.set(&name, &value) {
                examine(SCENES[scene], &error);
            }
        }
        if let Err(error) = read.build() {
            examine(SCENES[scene], &error);
        }
    }
}

const SETTABLE: &[&str] = &[
    "m",
    "l",
    "l[1]",
    "l[0]",
    "l[99]",
    "l[",
    "l[k]",
    "l[-1]",
    "gamma",
    "theta[k]",
    "v",
    "x",
    "phi_1'",
    "run.until",
    "run.points",
    "run.method",
    "run.tolerance",
    "run.independent",
    "run.linear_solver",
    "run.max_step",
    "run.from",
    "run.nothing",
    "m, x.value",
    "J.geometric",
    "k",
    "F_B",
    "weight.value",
    "outputs.columns",
    ".",
    "",
    "run.",
    ".x",
    "psi",
    "cos psi[k].stop_below",
    "title",
    "parameters.m",
    "parameters.new",
    "tables.mu",
    "inertia.value",
    "θ",
    "m.unit",
    " m ",
    "definitions.psi[k+1]",
];
const SET_TO: &[&str] = &[
    "4",
    "-1",
    "0",
    "1e308",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "4 m",
    "4 parsec",
    "[1, 2]",
    "[]",
    "[",
    "]",
    "[[1], [2]]",
    "[1, x]",
    "true",
    "\"4 m\"",
    "\"",
    "0.1*sin(t)",
    "sin(",
    "[1, min(2, 3), 4 m]",
    "",
    " ",
    "é",
    "cvode-bdf",
    "[\"x'\"]",
    "theta[k]",
    "1e-320",
    "[nan, inf, 1]",
    "crout",
    "[,,]",
    "-",
    "4 kg*m^2",
];

/// What must be told about a change of the train.
const MISTAKES: &[(&str, &str, &str)] = &[
    ("psi[1]\" = \"gamma", "psi[1]\" = \"gama", "undefined name `gama`"),
    ("value = \"J[k]\"", "value = \"J[k] + 1 m\"", "J[k] + 1 m"),
    ("until = \"15 s\"", "until = \"15 kg\"", "until"),
    ("explicit = \"v_B[k]\"", "explicit = \"v_B[k]*\"", "v_B[k]*"),
    ("v = \"v0\"", "w = \"v0\"", "`w` is not a coordinate"),
    ("\"x_A1'\" = \"v*cos(theta[1] + psi[1])\"", "\"x_A1'\" = \"v*cos(v)\"", "v*cos(v)"),
    ("\"F_A1\", \"power\"]", "\"F_A1\", \"powers\"]", "undefined name `powers`"),
    ("quantity = \"cos(psi[k])\"", "quantity = \"cos(psi[j])\"", "j"),
];

#[test]
fn independent_mistakes_are_all_told() {
    let train = SCENES[2];
    let told = |changes: &[&(&str, &str, &str)]| {
        let text = changes.iter().fold(train.to_string(), |text, (from, to, _)| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        let error = build(&text).err().unwrap_or_else(|| panic!("no error for {changes:?}"));
        for (_, _, message) in changes {
            assert!(error.to_string().contains(message), "`{message}` is not in:\n{error}");
        }
    };
    let n = MISTAKES.len();
    for i in 0..n {
        told(&[&MISTAKES[i]]);
        told(&[&MISTAKES[i], &MISTAKES[(i + 1) % n], &MISTAKES[(i + 4) % n]]);
    }
}

/// The order of the messages is that of the file.
#[test]
fn messages_come_in_the_order_of_the_file() {
    let text = SCENES[2]
        .replacen("\"gamma\"", "\"gama\"", 1)
        .replacen("J[k]\"", "J[k] + 1 m\"", 2)
        .replacen("15 s", "15 kg", 1);
    let error = build(&text).err().unwrap_or_else(|| panic!("no error"));
    let starts: Vec<usize> =
        error.diagnostics.iter().map(|d| if let Place::File(r) = &d.place { r.start } else { usize::MAX }).collect();
    assert!(starts.len() >= 3 && starts.is_sorted(), "{starts:?}\n{error}");
}

/// The place of a name points at the name, behind letters of several bytes too.
#[test]
fn places_count_characters() {
    let text = with_expression(0, "1 + cos(gramma)").replace("d = ", "\"δ\" = ");
    let error = build(&text).err().unwrap_or_else(|| panic!("no error"));
    let Place::File(range) = &error.diagnostics[0].place else { panic!("{error}") };
    assert_eq!(&text[range.clone()], "gramma");
    let (line, column) = error.source.position(range.start);
    let shown = text.lines().nth(line - 1).map(|l| l.chars().skip(column - 1).take(6).collect::<String>());
    assert_eq!(shown.as_deref(), Some("gramma"));
}

#[test]
fn long_and_deep_input_is_read_or_refused() {
    let deep = 100_000;
    for place in 0..PLACES.len() {
        for expression in [
            "(".repeat(deep),
            "x".to_string() + &")".repeat(deep),
            "x".to_string() + &"^x".repeat(deep),
            "sin(".repeat(deep),
            "not ".repeat(deep) + "x",
            "x[".repeat(deep),
            "if(".repeat(deep),
            "sum(k, ".repeat(300),
            "x".to_string() + &"'".repeat(deep),
            "x".repeat(deep),
            "9".repeat(deep),
            "=".repeat(deep),
        ] {
            let begin: String = expression.chars().take(20).collect();
            assert!(build(&with_expression(place, &expression)).is_err(), "{begin}.. as {}", PLACES[place].0);
        }
    }
    assert!(build(&with_expression(0, &("-".repeat(deep) + "x"))).is_ok(), "signs are read without recursion");
    let sum = "x".to_string() + &" + x*m".repeat(20_000);
    assert!(build(&with_expression(0, &sum)).is_ok());
    let chain = (0..20_000).fold(String::from("[definitions]\nd0 = \"x\"\n"), |mut text, i| {
        let _ = writeln!(text, "d{} = \"d{i}*m + 1\"", i + 1);
        text
    });
    assert!(build(&(with_expression(0, "x").replace("[definitions]\nd = \"x\"\n", "") + &chain)).is_ok());
    for text in ["[".repeat(deep), "a = ".to_string() + &"[".repeat(deep), "a.".repeat(deep), "{".repeat(deep)] {
        assert!(build(&text).is_err());
    }
    let _ = build(&format!("x = {}1{}", "[".repeat(deep), "]".repeat(deep)));
    let _ = build(&format!("x = {}1{}", "{a = ".repeat(deep), "}".repeat(deep)));
}

#[test]
fn deep_settings_are_read_or_refused() {
    for depth in [100, 10_000, 50_000] {
        let mut scene = Scene::parse("scene.toml", SCENES[2]).unwrap_or_else(|e| panic!("{e}"));
        let value = format!("{}1{}", "[".repeat(depth), "]".repeat(depth));
        let result = scene.set("l", &value).and_then(|()| scene.build().map(|_| ()));
        assert!(result.is_err(), "arrays of arrays {depth} deep");
    }
}

#[test]
fn infinite_and_missing_numbers_are_refused() {
    for value in ["nan", "inf", "-inf", "1e400", "-1e400", "1e400 kg", "1e308 t", "NaN", "infinity"] {
        let mut scene = Scene::parse("scene.toml", SCENES[0]).unwrap_or_else(|e| panic!("{e}"));
        let result = scene.set("m", value).and_then(|()| scene.build().map(|_| ()));
        assert!(result.is_err(), "m = {value} was accepted");
        let mut scene = Scene::parse("scene.toml", SCENES[0]).unwrap_or_else(|e| panic!("{e}"));
        let result = scene.set("run.until", value).and_then(|()| scene.build().map(|_| ()));
        assert!(result.is_err(), "run.until = {value} was accepted");
    }
}
