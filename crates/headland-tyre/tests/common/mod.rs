//! Tyres of the reference data, as `.tir` text.
#![allow(dead_code)] // each test program uses its part

use std::fmt::Write;

use serde_json::Value;

/// A file of `validation/reference`.
pub fn reference(name: &str) -> Value {
    let path = format!("{}/../../validation/reference/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(&path).expect("the reference file is there")).expect("it is JSON")
}

/// The tyres' names with their files as text.
pub fn files() -> Vec<(String, String)> {
    let data = reference("tyres_soils.json");
    let tyres = data["pac2002"].as_object().expect("an object");
    tyres.iter().map(|(name, tyre)| (name.clone(), text(&tyre["coefficients"]))).collect()
}

fn text(sections: &Value) -> String {
    let mut text = "[UNITS]\nLENGTH='meter'\nFORCE='newton'\nANGLE='radians'\nMASS='kg'\nTIME='second'\n\
        [MODEL]\nPROPERTY_FILE_FORMAT='PAC2002'\nUSE_MODE=4\nLONGVL=16.7\n"
        .to_string();
    for (section, keys) in sections.as_object().expect("an object") {
        writeln!(text, "[{section}]").unwrap();
        for (key, value) in keys.as_object().expect("an object") {
            writeln!(text, "{key:20} = {} $ as in the file", value.as_str().expect("text")).unwrap();
        }
    }
    text
}
