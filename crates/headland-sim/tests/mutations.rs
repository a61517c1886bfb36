//! Scenes changed at random that are still scenes: deriving and running them gives equations and rows, or says why not.

mod common;

use common::{CARTESIAN, DOUBLE, PIVOT, ROAD, SLEIGH, SNAKEBOARD, TRAIN};
use headland_model::Scene;
use headland_sim::{RunOptions, Silent, Status, run};

/// Numbers of a fixed seed (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

const NUMBERS: [&str; 12] = ["0", "1", "2", "3", "0.5", "1e-9", "1e9", "1e200", "1e-200", "90", "7.25", "100"];
const FUNCTIONS: [&str; 10] = ["sin", "cos", "tan", "sqrt", "abs", "exp", "log", "sign", "atan", "tanh"];

/// Spans of characters of one kind.
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

/// The lines that are not those of the scene.
fn changes(scene: &str, text: &str) -> String {
    let new = text.lines().filter(|l| !scene.lines().any(|s| s == *l)).map(|l| format!("+ {l}\n"));
    let old = scene.lines().filter(|l| !text.lines().any(|s| s == *l)).map(|l| format!("- {l}\n"));
    old.chain(new).collect()
}

fn mutate(text: &str, random: &mut Random) -> String {
    let replace =
        |span: &std::ops::Range<usize>, with: &str| format!("{}{with}{}", &text[..span.start], &text[span.end..]);
    let word = |c: char| c.is_alphanumeric() || c == '_';
    match random.below(6) {
        0 => {
            let numbers = spans(text, |c| c.is_ascii_digit() || c == '.');
            replace(&numbers[random.below(numbers.len())], NUMBERS[random.below(NUMBERS.len())])
        }
        1 => {
            let operators = spans(text, |c| "+-*/".contains(c));
            replace(&operators[random.below(operators.len())], ["+", "-", "*", "/"][random.below(4)])
        }
        2 => {
            let words = spans(text, word);
            let other = text[words[random.below(words.len())].clone()].to_string();
            replace(&words[random.below(words.len())], &other)
        }
        3 => {
            let calls: Vec<_> = spans(text, word).into_iter().filter(|s| text[s.end..].starts_with('(')).collect();
            let function = FUNCTIONS[random.below(FUNCTIONS.len())];
            calls.get(random.below(calls.len())).map_or(text.to_string(), |call| replace(call, function))
        }
        4 => {
            // a whole entry or element is left out
            let mut parts: Vec<&str> = text.split("\n\n").collect();
            parts.remove(random.below(parts.len()));
            parts.join("\n\n")
        }
        _ => {
            let mut lines: Vec<&str> = text.lines().collect();
            let i = random.below(lines.len());
            if random.below(2) == 0 {
                lines.remove(i);
            } else {
                let j = random.below(lines.len());
                lines.swap(i, j);
            }
            lines.join("\n")
        }
    }
}

#[test]
fn changed_scenes_run_or_say_why_not() {
    let (mut built, mut derived, mut finished) = (0, 0, 0);
    let mut random = Random(3);
    for case in 0..1500 {
        let scene = [SLEIGH, DOUBLE, TRAIN, CARTESIAN, PIVOT, ROAD, SNAKEBOARD][case % 7];
        let mut text = mutate(scene, &mut random);
        if case % 3 == 0 {
            text = mutate(&text, &mut random);
        }
        let Ok(model) = Scene::parse("scene.toml", &text).and_then(|s| s.build()) else { continue };
        built += 1;
        let mut options = RunOptions::of(&model);
        options.until = options.from + 0.2;
        options.points = 5;
        options.max_steps = 100;
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| run(&model, &options, &mut Silent)));
        let result = result.unwrap_or_else(|_| panic!("case {case} panicked:\n{}", changes(scene, &text)));
        match result {
            Err(error) => {
                assert!(!error.to_string().trim().is_empty());
                // Both derivations are compared in debug builds. Where numbers are extreme, rounding alone may part them.
                let changed = changes(scene, &text);
                let extreme = ["1e200", "1e-200"].iter().any(|x| changed.contains(x));
                assert!(extreme || !error.to_string().contains("report this as a defect"), "{error}\n{changed}");
            }
            Ok(run) => {
                derived += 1;
                finished += u32::from(run.report.status == Status::Done);
                if let Status::Failed(why) = &run.report.status {
                    assert!(why.len() > 20, "{why}");
                }
                assert!(run.trajectory.t.iter().all(|t| *t <= run.report.t_end), "{}", changes(scene, &text));
            }
        }
    }
    println!("{built} built, {derived} derived, {finished} finished");
    assert!(built > 300 && derived > 250 && finished > 150, "{built} built, {derived} derived, {finished} finished");
}
