use super::*;
use proptest::prelude::*;

const FILE: &str = "$ a tyre ! of nobody
[MDI_HEADER]
FILE_TYPE = 'tir'
[UNITS]
LENGTH = 'mm'   ! millimetres
FORCE  = 'kilonewton'
ANGLE  = 'degrees'
MASS   = 'kg'
TIME   = 'second'
[dimension]
unloaded_radius = 469.9 $ mm
[VERTICAL]
FNOMIN = 35D0
VERTICAL_STIFFNESS = 1,0
NAME = 'a $ in quotes'
[DEFLECTION_LOAD_CURVE]
{pen fz}
0 0
10 2.5
nonsense here
FNOMIN = 36
";

#[test]
fn sections_values_tables_and_units_are_read() {
    let tir = Tir::parse(FILE).unwrap();
    assert!(tir.has_section("DIMENSION"));
    assert_eq!(tir.number("UNLOADED_RADIUS", Measure::Length).unwrap(), Some(469.9 * 1e-3));
    assert_eq!(tir.number("FNOMIN", Measure::Force).unwrap(), Some(36e3));
    assert_eq!(tir.number("VERTICAL_STIFFNESS", Measure::Stiffness).unwrap(), Some(1e6));
    assert_eq!(tir.number("PCX1", Measure::Number).unwrap(), None);
    assert_eq!(tir.entries["NAME"].text, "a $ in quotes");
    assert_eq!(tir.tables["DEFLECTION_LOAD_CURVE"].rows, vec![vec![0.0, 0.0], vec![10.0, 2.5]]);
    assert!((tir.units.factor(Measure::Angle) - 1f64.to_radians()).abs() < 1e-18);
    let notes: Vec<String> = tir.notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        [
            "line 20: `nonsense here` cannot be read and was left out",
            "line 21: FNOMIN is given again (first on line 13); the last one counts"
        ]
    );
}

#[test]
fn wrong_units_and_numbers_are_messages() {
    let error = Tir::parse("[UNITS]\nLENGTH = 'newton'").unwrap_err().to_string();
    assert!(error.starts_with("line 2: `newton` is no unit for LENGTH; known are meter, "), "{error}");
    assert_eq!(Tir::parse("hello"), Err(TirError::NoSections));
    let tir = Tir::parse("[VERTICAL]\nFNOMIN = lots\nBREFF = 1e999\nDREFF = nan").unwrap();
    let error = tir.number("FNOMIN", Measure::Force).unwrap_err().to_string();
    assert_eq!(error, "line 2: FNOMIN = lots is not a finite number");
    assert!(tir.number("BREFF", Measure::Number).is_err());
    assert!(tir.number("DREFF", Measure::Number).is_err());
    assert_eq!(tir.notes[0].to_string(), "no section [UNITS]; assumed: meter, newton, radian, kg, second, pascal");
    let partial = Tir::parse("[UNITS]\nLENGTH='meter'\nFORCE='newton'\nANGLE='radians'\nMASS='kg'").unwrap();
    assert_eq!(partial.notes[0].to_string(), "[UNITS] lacks TIME; assumed: SI units for these");
}

/// Independent: pounds, inches and psi by their definitions.
#[test]
fn customary_units_agree_with_their_definitions() {
    let text = "[UNITS]\nLENGTH='inch'\nFORCE='pound_force'\nANGLE='deg'\nMASS='slug'\nTIME='ms'\nPRESSURE='psi'\n[A]";
    let units = Tir::parse(text).unwrap().units;
    let close = |measure, value: f64| assert!((units.factor(measure) / value - 1.0).abs() < 1e-9, "{measure:?}");
    close(Measure::Force, 4.448_221_615_260_5);
    close(Measure::Pressure, 6_894.757_293_168);
    close(Measure::Mass, 14.593_902_937);
    close(Measure::Stiffness, 175.126_835_246);
    close(Measure::Speed, 25.4);
    close(Measure::Damping, 0.175_126_835_246);
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = Tir::from_bytes(&bytes);
    }

    #[test]
    fn no_text_in_its_alphabet_panics(text in r"([\[\]{}='$!A-Z_0-9.eE+\- ,\n]|\[UNITS\]\n|LENGTH=|\[SHAPE\]\n){0,200}") {
        if let Ok(tir) = Tir::parse(&text) {
            for key in tir.entries.keys() {
                let _ = tir.number(key, Measure::Damping);
            }
            for note in &tir.notes {
                prop_assert!(!note.to_string().is_empty());
            }
        }
    }
}
