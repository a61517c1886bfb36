//! The table of reference problems.

mod balls;
mod bicycle;
mod loops;
mod nonholonomic;
mod oscillators;
mod pendulums;
mod rolling;
mod tops;
mod trains;
mod whirl;

use crate::case::Case;
use crate::linear::LinearCase;

/// All problems whose method is built.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    [
        trains::CASES,
        nonholonomic::CASES,
        rolling::CASES,
        balls::CASES,
        pendulums::CASES,
        tops::CASES,
        loops::CASES,
        oscillators::CASES,
    ]
    .into_iter()
    .flatten()
    .filter(|case| case.is_built())
}

/// All problems of linearisation.
pub fn linear_cases() -> impl Iterator<Item = &'static LinearCase> {
    bicycle::CASES.iter().chain(whirl::CASES)
}

/// A scene of `models/`, compiled in.
macro_rules! model {
    ($name:literal) => {
        (concat!($name, ".toml"), include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/", $name, ".toml")))
    };
}
/// A scene of `validation/scenes/`, compiled in.
macro_rules! scene {
    ($name:literal) => {
        (concat!($name, ".toml"), include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name, ".toml")))
    };
}
/// A file of `validation/reference/`, compiled in.
macro_rules! reference {
    ($name:literal) => {
        crate::reference::Reference::new(include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/reference/",
            $name,
            ".json"
        )))
    };
}
pub(crate) use {model, reference, scene};
