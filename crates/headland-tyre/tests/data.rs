//! Numbers of the crate against the data files they come from, so that no digit is mistyped.

mod common;

use common::reference;
use headland_tyre::{KnownSoil, SlipLaw, TMeasy};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_str().unwrap().split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn soils_are_those_of_the_sources() {
    let data = reference("tyres_soils.json");
    let names = [
        ("dry_sand", "Wong_dry_sand"),
        ("sandy_loam", "Wong_sandy_loam"),
        ("clayey_soil", "Wong_clayey_soil"),
        ("lete_sand", "LETE_sand"),
        ("lunar", "lunar"),
    ];
    for (name, source) in names {
        let (soil, of) = (KnownSoil::named(name).unwrap(), &data["soils"][source]);
        let first = |long: &str, short: &str| number(if of[long].is_null() { &of[short] } else { &of[long] });
        assert_eq!(soil.exponent, number(&of["n"]), "{name}");
        assert_eq!(soil.cohesive_kn, first("kc_kN_m^(n+1)", "kc"), "{name}");
        assert_eq!(soil.frictional_kn, first("kphi_kN_m^(n+2)", "kphi"), "{name}");
        for (found, key) in [(soil.cohesion_kpa, "c_kPa"), (soil.friction_angle_deg, "phi_deg")] {
            assert_eq!(found, of.get(key).map(number), "{name} {key}");
        }
        if name != "dry_sand" {
            assert_eq!(soil.shear_m, of.get("K_shear_m").map(number), "{name}");
        }
    }
}

#[test]
fn the_truck_tyre_is_that_of_its_source() {
    let data = reference("tyres_soils.json");
    let of = &data["tmeasy"]["truck80_guess"];
    let p = 1e4;
    let tyre = TMeasy::truck(p, 0.2, 0.5);
    for (i, (c, load)) in [(tyre.nominal, p), (tyre.double, 2.0 * p)].into_iter().enumerate() {
        let at = |key: &str| number(&of[key][i]);
        assert_eq!(c.x.slope, load * at("dfx0/pn, /2pn"));
        assert_eq!([c.x.peak, c.x.slide], [load * at("fxm"), load * at("fxs")]);
        assert_eq!([c.x.peak_slip, c.x.slide_slip], [at("sxm"), at("sxs")]);
        assert_eq!([c.y.slope, c.y.peak, c.y.slide], [load * at("dfy0"), load * at("fym"), load * at("fys")]);
        assert_eq!([c.y.peak_slip, c.y.slide_slip], [at("sym"), at("sys")]);
        assert_eq!([c.trail.share, c.trail.zero_slip, c.trail.end_slip], [at("nL0"), at("sq0"), at("sqe")]);
    }
    assert!(tyre.stiffness(p)[0] > tyre.stiffness(p)[1]);
}
