//! The Magic Formula against reference points, its limits and its symmetries.

mod common;

use approx::assert_relative_eq;
use common::{files, reference};
use headland_expr::{Dual, Scalar};
use headland_tyre::pac2002::Side;
use headland_tyre::{Forces, Motion, Pac2002, Slip, SlipLaw};
use proptest::prelude::*;

fn tyres() -> Vec<(String, Pac2002)> {
    files().into_iter().map(|(name, text)| (name, Pac2002::parse(&text).unwrap())).collect()
}

fn slip(kappa: f64, alpha: f64, camber: f64) -> Slip<f64> {
    Slip { camber, ..Slip::forward(kappa, alpha.tan()) }
}

/// All coefficients that make a tyre unlike its mirror image, and the lateral force of camber.
fn symmetric(mut tyre: Pac2002) -> Pac2002 {
    let odd = "PHX1 PHX2 PVX1 PVX2 PEX4 PHY1 PHY2 PVY1 PVY2 PEY3 RHX1 RHY1 RHY2 RVY1 RVY2 RBY3 QHZ1 QHZ2 QDZ3 QDZ6 QDZ7 \
        QEZ4 QBZ4 SSZ1 QSX1";
    for key in odd.split_whitespace() {
        assert!(tyre.set_coefficient(key, 0.0), "{key}");
    }
    tyre
}

#[test]
fn reference_points_are_met() {
    let points = reference("tyre_pac2002_points.json");
    let mut count = 0;
    for (name, tyre) in tyres() {
        let of_tyre = &points["points"][&name];
        let nominal = of_tyre["Fz0"].as_f64().unwrap();
        assert_relative_eq!(tyre.nominal_load(), nominal, max_relative = 1e-9);
        for row in of_tyre["rows [force, Fz/Fz0, slip, N]"].as_array().unwrap() {
            let [load, s, force] = [1, 2, 3].map(|i| row[i].as_f64().unwrap());
            // the table's Fz0 is rounded to ten digits: the tyre's own is meant
            let load = load * tyre.nominal_load();
            let found = match row[0].as_str().unwrap() {
                "Fx" => tyre.forces(load, 1.0, &slip(s, 0.0, 0.0)).fx,
                _ => tyre.forces(load, 1.0, &slip(0.0, s, 0.0)).fy,
            };
            assert_relative_eq!(found, force, max_relative = 1e-9);
            count += 1;
        }
    }
    assert_eq!(count, 96);
}

/// The formula once more, term by term as it is printed, with divisions by the load and by `sin(2 atan x)`: a second
/// derivation of all five outputs at combined slip and camber.
fn printed(tyre: &Pac2002, fz: f64, kappa: f64, alpha: f64, camber: f64, speed: f64, pressure: f64) -> Forces<f64> {
    let dp = pressure - 1.0;
    let c = |key: &str| tyre.coefficient(key).unwrap();
    let r0 = tyre.radius();
    let fz0 = tyre.nominal_load();
    let dfz = (fz - fz0) / fz0;
    let mf = |b: f64, c: f64, e: f64, x: f64| c * (b * x - e.min(1.0) * (b * x - (b * x).atan())).atan();
    let sgn = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };

    let kappa_x = kappa + (c("PHX1") + c("PHX2") * dfz) * c("LHX");
    let gx = camber * c("LGAX");
    let mux = (c("PDX1") + c("PDX2") * dfz) * (1.0 - c("PDX3") * gx.powi(2)) * c("LMUX");
    let mux = mux * (1.0 + c("PPX3") * dp + c("PPX4") * dp.powi(2));
    let (cx, dx) = (c("PCX1") * c("LCX"), mux * fz);
    let ex = (c("PEX1") + c("PEX2") * dfz + c("PEX3") * dfz.powi(2)) * (1.0 - c("PEX4") * sgn(kappa_x)) * c("LEX");
    let kx = fz * (c("PKX1") + c("PKX2") * dfz) * (c("PKX3") * dfz).exp() * c("LKX");
    let kx = kx * (1.0 + c("PPX1") * dp + c("PPX2") * dp.powi(2));
    let svx = fz * (c("PVX1") + c("PVX2") * dfz) * c("LVX") * c("LMUX");
    let fx0 = dx * mf(kx / (cx * dx), cx, ex, kappa_x).sin() + svx;

    let gy = camber * c("LGAY");
    let shy = (c("PHY1") + c("PHY2") * dfz) * c("LHY") + c("PHY3") * gy * c("LKG");
    let alpha_y = alpha + shy;
    let muy = (c("PDY1") + c("PDY2") * dfz) * (1.0 - c("PDY3") * gy.powi(2)) * c("LMUY");
    let muy = muy * (1.0 + c("PPY3") * dp + c("PPY4") * dp.powi(2));
    let (cy, dy) = (c("PCY1") * c("LCY"), muy * fz);
    let ey = (c("PEY1") + c("PEY2") * dfz) * (1.0 - (c("PEY3") + c("PEY4") * gy) * sgn(alpha_y)) * c("LEY");
    let most = c("PKY2") * fz0 * (1.0 + c("PPY2") * dp);
    let ky0 = c("PKY1") * (1.0 + c("PPY1") * dp) * fz0 * (2.0 * (fz / most).atan()).sin() * c("LKY");
    let ky = ky0 * (1.0 - c("PKY3") * gy.abs());
    let by = ky / (cy * dy);
    let svy = (c("PVY1") + c("PVY2") * dfz) * c("LVY") + (c("PVY3") + c("PVY4") * dfz) * gy * c("LKG");
    let svy = fz * svy * c("LMUY");
    let fy0 = dy * mf(by, cy, ey, alpha_y).sin() + svy;

    let bxa = c("RBX1") * (c("RBX2") * kappa).atan().cos() * c("LXAL");
    let exa = c("REX1") + c("REX2") * dfz;
    let shxa = c("RHX1");
    let gxa = mf(bxa, c("RCX1"), exa, alpha + shxa).cos() / mf(bxa, c("RCX1"), exa, shxa).cos();
    let byk = c("RBY1") * (c("RBY2") * (alpha - c("RBY3"))).atan().cos() * c("LYKA");
    let eyk = c("REY1") + c("REY2") * dfz;
    let shyk = c("RHY1") + c("RHY2") * dfz;
    let gyk = mf(byk, c("RCY1"), eyk, kappa + shyk).cos() / mf(byk, c("RCY1"), eyk, shyk).cos();
    let dvyk = muy * fz * (c("RVY1") + c("RVY2") * dfz + c("RVY3") * camber) * (c("RVY4") * alpha).atan().cos();
    let svyk = dvyk * (c("RVY5") * (c("RVY6") * kappa).atan()).sin() * c("LVYKA");
    let (fx, fy) = (fx0 * gxa, fy0 * gyk + svyk);

    let gz = camber * c("LGAZ");
    let alpha_t = alpha + c("QHZ1") + c("QHZ2") * dfz + (c("QHZ3") + c("QHZ4") * dfz) * gz;
    let alpha_r = alpha + shy + svy / ky;
    let eq = |a: f64| (a.tan().powi(2) + (kx / ky * kappa).powi(2)).sqrt().atan() * sgn(a);
    let bt = (c("QBZ1") + c("QBZ2") * dfz + c("QBZ3") * dfz.powi(2))
        * (1.0 + c("QBZ4") * gz + c("QBZ5") * gz.abs())
        * c("LKY")
        / c("LMUY");
    let ct = c("QCZ1");
    let dt = fz * (c("QDZ1") + c("QDZ2") * dfz) * (1.0 + c("QDZ3") * gz + c("QDZ4") * gz.powi(2)) * r0 / fz0;
    let et = (c("QEZ1") + c("QEZ2") * dfz + c("QEZ3") * dfz.powi(2))
        * (1.0 + (c("QEZ4") + c("QEZ5") * gz) * (2.0 / std::f64::consts::PI) * (bt * ct * eq(alpha_t)).atan());
    let dt = dt * (1.0 - c("QPZ1") * dp);
    let t = dt * c("LTR") * mf(bt, ct, et, eq(alpha_t)).cos() * alpha.cos();
    let br = c("QBZ9") * c("LKY") / c("LMUY") + c("QBZ10") * by * cy;
    let dr = fz
        * ((c("QDZ6") + c("QDZ7") * dfz) * c("LRES") + (c("QDZ8") + c("QDZ9") * dfz) * (1.0 + c("QPZ2") * dp) * gz)
        * r0
        * c("LMUY");
    let mzr = dr * (br * eq(alpha_r)).atan().cos() * alpha.cos();
    let s = (c("SSZ1") + c("SSZ2") * fy / fz0 + (c("SSZ3") + c("SSZ4") * dfz) * camber) * r0 * c("LS");
    let mz = -t * (fy - svyk) + mzr + s * fx;

    let swing = c("QSX7") * camber + c("QSX8") * (c("QSX9") * fy / fz0).atan();
    let mx = c("QSX1") * c("LVMX") - c("QSX2") * (1.0 + c("QPX1") * dp) * camber
        + c("QSX3") * fy / fz0
        + c("QSX4") * (c("QSX5") * (c("QSX6") * fz / fz0).powi(2).atan()).cos() * swing.sin()
        + c("QSX10") * (c("QSX11") * fz / fz0).atan() * camber;
    let my = if c("QSY1") == 0.0 && c("QSY2") == 0.0 {
        -r0 * (svx + kx * (kappa_x - kappa))
    } else {
        let v = speed / 16.7;
        let f = c("QSY1") + c("QSY2") * fx / fz0 + c("QSY3") * v.abs() + c("QSY4") * v.powi(4);
        let f = f + c("QSY5") * camber.powi(2) + c("QSY6") * camber.powi(2) * fz / fz0;
        -r0 * fz * f * (fz / fz0).powf(c("QSY7")) * pressure.powf(c("QSY8"))
    };
    Forces { fx, fy, mx: r0 * fz * mx * c("LMX"), my: my * c("LMY"), mz }
}

fn close(found: &Forces<f64>, other: &Forces<f64>, scale: f64, tolerance: f64) {
    let list = |f: &Forces<f64>| [f.fx, f.fy, f.mx, f.my, f.mz];
    for (a, b) in list(found).into_iter().zip(list(other)) {
        assert!((a - b).abs() <= tolerance * scale, "{found:?}\n{other:?}");
    }
}

proptest! {
    #[test]
    fn agrees_with_the_formula_as_printed(
        kappa in -0.9..0.9, alpha in -0.5..0.5, camber in -0.15..0.15, share in 0.1..1.8, speed in 1.0..30.0, pressure in 0.6..1.3,
    ) {
        for (_, mut tyre) in tyres() {
            // where the file has zeros, terms would go unchecked
            let more = "QSX1 QSX2 QSX3 QSX4 QSX5 QSX6 QSX7 QSX8 QSX9 QSX10 QSX11 QPX1 QSY3 QSY4 QSY5 QSY6 QSY7 QSY8 QBZ10 \
                QPZ1 QPZ2 PPX1 PPX2 PPX3 PPX4 PPY1 PPY2 PPY3 PPY4";
            for (i, key) in more.split_whitespace().enumerate() {
                tyre.set_coefficient(key, 0.05 + 0.01 * i as f64);
            }
            tyre.set_pressure_ratio(pressure);
            for key in ["LHX", "LVX", "LHY", "LVY", "LKG", "LTR", "LRES", "LS", "LXAL", "LYKA", "LVYKA", "LMX", "LVMX", "LMUY"] {
                tyre.set_coefficient(key, 0.9);
            }
            let load = share * tyre.nominal_load();
            let slip = Slip { speed, ..slip(kappa, alpha, camber) };
            let found = tyre.forces(load, 1.0, &slip);
            close(&found, &printed(&tyre, load, kappa, alpha, camber, speed, pressure), load, 1e-12);
        }
    }

    #[test]
    fn a_symmetric_tyre_is_its_mirror_image(
        kappa in -0.9..0.9, alpha in -0.5..0.5, camber in -0.15..0.15, share in 0.1..1.8,
    ) {
        for (_, tyre) in tyres() {
            let tyre = symmetric(tyre);
            let load = share * tyre.nominal_load();
            let here = tyre.forces(load, 1.0, &slip(kappa, alpha, camber));
            let there = tyre.forces(load, 1.0, &slip(kappa, -alpha, -camber)).mirrored();
            // QBZ4, QDZ3, QEZ4 and QEZ5 are odd in camber: QEZ5 stays, with the sign of the slip it is even
            close(&here, &there, load, 1e-12);
            close(&here, &tyre.mirrored_forces(load, 1.0, &slip(kappa, alpha, camber)), load, 1e-12);
        }
    }

    /// Every tyre on the left and its mirror image on the right make a vehicle that drives straight.
    #[test]
    fn any_pair_of_a_tyre_and_its_mirror_image_is_symmetric(kappa in -0.5..0.5, alpha in -0.3..0.3, camber in -0.1..0.1) {
        for (_, tyre) in tyres() {
            let left = tyre.forces(2e4, 1.0, &slip(kappa, alpha, camber));
            let right = tyre.mirrored_forces(2e4, 1.0, &slip(kappa, -alpha, -camber));
            prop_assert_eq!([left.fy, left.mx, left.mz, left.fx], [-right.fy, -right.mx, -right.mz, right.fx]);
        }
    }

    #[test]
    fn slip_takes_power_and_friction_bounds_force(
        kappa in -3.0..3.0f64, alpha in -1.4..1.4f64, share in 0.0..2.5f64, forward in -30.0..30.0f64,
    ) {
        for (_, tyre) in tyres() {
            let tyre = symmetric(tyre);
            let load = share * tyre.nominal_load();
            let speed = f64::abs(forward);
            let motion = Motion { forward, slip_x: -kappa * speed, slip_y: alpha.tan() * speed, spin: 0.0, camber: 0.0, turn: 0.0 };
            let f = tyre.forces(load, 1.0, &motion.with_slip(kappa, alpha.tan(), 0.1));
            prop_assert!(f.fx * motion.slip_x + f.fy * motion.slip_y <= 0.0, "{f:?}");
            let mu = |d1: &str, d2: &str| {
                let [d1, d2] = [d1, d2].map(|key| tyre.coefficient(key).unwrap());
                (d1 * f64::max(1.0 + d2 / d1 * (share - 1.0), 0.01)).abs()
            };
            prop_assert!(f.fx.abs() <= mu("PDX1", "PDX2") * load * (1.0 + 1e-12));
            prop_assert!(f.fy.abs() <= mu("PDY1", "PDY2") * load * (1.0 + 1e-12));
        }
    }

    #[test]
    fn everything_is_finite_with_finite_derivatives(
        kappa in prop_oneof![Just(0.0), Just(-1.0), -5.0..5.0], tan_alpha in prop_oneof![Just(0.0), -20.0..20.0],
        camber in prop_oneof![Just(0.0), -1.0..1.0], load in prop_oneof![Just(0.0), -1e4..2e5],
        speed in prop_oneof![Just(0.0), -30.0..30.0], direction in 0usize..6,
    ) {
        for (_, tyre) in tyres() {
            let seed = |i: usize, x: f64| Dual::new(x, if i == direction { 1.0 } else { 0.0 });
            let motion = Motion { forward: seed(3, speed), slip_x: seed(9, 0.0), slip_y: seed(9, 0.0), spin: seed(9, 0.0),
                camber: seed(2, camber), turn: seed(9, 0.0) };
            let slip = motion.with_slip(seed(0, kappa), seed(1, tan_alpha), Dual::constant(0.1));
            let f = tyre.forces(seed(4, load), seed(5, 1.0), &slip);
            for x in [f.fx, f.fy, f.mx, f.my, f.mz] {
                prop_assert!(x.value.is_finite() && x.dot.is_finite(), "{f:?}");
            }
            if load <= 0.0 {
                prop_assert_eq!([f.fx.value, f.fy.value, f.mx.value, f.my.value, f.mz.value].map(f64::abs), [0.0; 5]);
            }
            for x in tyre.relaxation_lengths(seed(4, load), seed(2, camber)) {
                prop_assert!(x.value > 0.0 && x.value.is_finite() && x.dot.is_finite());
            }
        }
    }
}

#[test]
fn stiffness_is_the_slope_at_zero_slip_and_derivatives_are_exact() {
    for (name, tyre) in tyres() {
        let tyre = symmetric(tyre);
        let load = 0.8 * tyre.nominal_load();
        let [along, across] = tyre.stiffness(load);
        let e = 1e-6;
        let slope = |f: &dyn Fn(f64) -> f64| (f(e) - f(-e)) / (2.0 * e);
        let fx = |k: f64| tyre.forces(load, 1.0, &Slip::forward(k, 0.0)).fx;
        let fy = |a: f64| -tyre.forces(load, 1.0, &Slip::forward(0.0, a)).fy;
        assert_relative_eq!(slope(&fx), along, max_relative = 1e-6);
        assert_relative_eq!(slope(&fy), across, max_relative = 1e-6);
        let dual = |x: f64, dot: f64| Dual::new(x, dot);
        let at = Slip { camber: dual(0.03, 0.0), ..Slip::forward(dual(0.07, 1.0), dual(-0.06, 0.5)) };
        let f = tyre.forces(dual(load, 100.0), dual(1.0, 0.0), &at);
        let moved = |h: f64| {
            let slip = Slip { camber: 0.03, ..Slip::forward(0.07 + h, -0.06 + 0.5 * h) };
            tyre.forces(load + 100.0 * h, 1.0, &slip)
        };
        let (a, b) = (moved(e), moved(-e));
        for (dot, difference) in [(f.fx.dot, a.fx - b.fx), (f.fy.dot, a.fy - b.fy), (f.mz.dot, a.mz - b.mz)] {
            assert_relative_eq!(dot, difference / (2.0 * e), max_relative = 1e-6, epsilon = 1e-2);
        }
        assert!(tyre.effective_radius(0.02) < tyre.radius(), "{name}");
    }
}

#[test]
fn the_vertical_law_and_the_effective_radius_are_those_of_the_file() {
    let (_, tyre) = tyres().into_iter().find(|(name, _)| name.starts_with("HMMWV")).unwrap();
    assert_eq!(tyre.vertical().unwrap().load(0.02, 0.0), 1e6 * 0.4419 * 0.02);
    // without load the wheel rolls on its free radius; at nominal deflection D atan(B) + F is lost of it
    assert_eq!(tyre.effective_radius(0.0), 0.4699);
    let nominal = tyre.nominal_load() / (0.4419e6);
    let lost = nominal * (0.5 * f64::atan(3.5) - 0.005);
    assert_relative_eq!(tyre.effective_radius(nominal), 0.4699 - lost, max_relative = 1e-14);
}

#[test]
fn files_of_the_wild_are_named_with_what_was_assumed() {
    let text = files()[0].1.clone();
    let complete = Pac2002::parse(&text).unwrap();
    let said =
        |text: &str| -> Vec<String> { Pac2002::parse(text).unwrap().notes().iter().map(ToString::to_string).collect() };
    assert_eq!(complete.notes().len(), 0, "{:?}", complete.notes());
    assert_eq!(complete.side(), Side::Left);
    let lacking = |section: &str| {
        let start = text.find(&format!("[{section}]")).unwrap();
        let end = text[start + 1..].find('[').map_or(text.len(), |e| start + 1 + e);
        format!("{}{}", &text[..start], &text[end..])
    };
    assert_eq!(
        said(&lacking("LONGITUDINAL_COEFFICIENTS")),
        ["no section [LONGITUDINAL_COEFFICIENTS]; assumed: no longitudinal force"]
    );
    assert_eq!(
        said(&lacking("SCALING_COEFFICIENTS"))[0],
        "no section [SCALING_COEFFICIENTS]; assumed: all of its coefficients are 1"
    );
    assert_eq!(said(&lacking("UNITS"))[0], "no section [UNITS]; assumed: meter, newton, radian, kg, second, pascal");
    let no_x = Pac2002::parse(&lacking("LONGITUDINAL_COEFFICIENTS")).unwrap();
    let f = no_x.forces(2e4, 1.0, &slip(0.1, 0.05, 0.0));
    assert_eq!(f.fx, 0.0);
    assert_eq!(f.fy, complete.forces(2e4, 1.0, &slip(0.0, 0.05, 0.0)).fy);

    assert_eq!(said(&text.replace("PDX3 ", "PDX9 "))[0], "[LONGITUDINAL_COEFFICIENTS] lacks PDX3; assumed: 0 for each");
    let unknown = said(&text.replace("PDX3 ", "PDX9 ")).pop().unwrap();
    assert!(unknown.contains("PDX9 is not known and was left out; is PDX"), "{unknown}");
    let error = |text: String| Pac2002::parse(&text).unwrap_err().to_string();
    assert_eq!(
        error(lacking("DIMENSION")),
        "[DIMENSION] UNLOADED_RADIUS is missing: the radius of the tyre without load"
    );
    assert!(
        error(text.replace("PCX1 ", "PCX9 "))
            .ends_with("PCX1 = 0 must be other than zero; without it the formula divides by zero")
    );
    assert!(
        error(text.replace("'PAC2002'", "'FTIRE'"))
            .contains("PROPERTY_FILE_FORMAT is 'FTIRE'; this reader knows PAC2002")
    );
    assert!(error(text.replace("1e+006", "-5")).contains("VERTICAL_STIFFNESS = -5 must be above zero"));

    let turn = said(&text.replace("USE_MODE=4", "USE_MODE=15"));
    assert_eq!(turn, ["line 9: turn slip is not computed; USE_MODE taken as 4"]);
    assert!(error(text.replace("USE_MODE=4", "USE_MODE=2.5")).contains("USE_MODE = 2.5 must be 0 to 4"));
    let right = Pac2002::parse(&text.replace("USE_MODE=4", "USE_MODE=-3\nTYRESIDE='LEFT'")).unwrap();
    assert_eq!(right.side(), Side::Right);
    let uncombined = right.forces(2e4, 1.0, &slip(0.05, 0.05, 0.0));
    assert_eq!(uncombined.fx, complete.forces(2e4, 1.0, &slip(0.05, 0.0, 0.0)).fx);
    assert_eq!(uncombined.fy, complete.forces(2e4, 1.0, &slip(0.0, 0.05, 0.0)).fy);

    let tables =
        format!("{text}[DEFLECTION_LOAD_CURVE]\n{{pen fz}}\n0 0\n0.05 15000\n0.1 40000\n[BOTTOMING_CURVE]\n0 0\n");
    let curved = Pac2002::parse(&tables).unwrap();
    assert!(curved.notes()[0].to_string().ends_with("the table in [BOTTOMING_CURVE] is not used"));
    assert_relative_eq!(curved.vertical().unwrap().load(0.05, 0.0), 15e3, max_relative = 1e-14);
    let descending = tables.replace("0.05 15000", "0.2 15000");
    assert!(
        said(&descending)
            .iter()
            .any(|n| n.contains("the load curve was left out: table `DEFLECTION_LOAD_CURVE`: abscissas must grow"))
    );

    // pressure: one quarter above the nominal one
    let mut soft = complete.clone();
    soft.set_pressure_ratio(1.25);
    assert!(soft.set_coefficient("ppy1", -0.5));
    let text_soft = text.replacen("800000 $", "1000000 $", 1).replace("PPY1                 = 0.0", "PPY1 = -0.5");
    let read = Pac2002::parse(&text_soft).unwrap();
    assert_eq!(read.forces(2e4, 1.0, &slip(0.0, 0.05, 0.0)), soft.forces(2e4, 1.0, &slip(0.0, 0.05, 0.0)));

    // the same tyre in millimetres and kilonewtons
    let other = text
        .replace("'meter'", "'mm'")
        .replace("'newton'", "'kilonewton'")
        .replace("0.4699", "469.9")
        .replace("0.548 ", "548 ")
        .replace(" 35000", " 35")
        .replace("1e+006", "1")
        .replace("16.7\n", "16700\n");
    let f = Pac2002::parse(&other).unwrap();
    assert_relative_eq!(f.radius(), complete.radius(), max_relative = 1e-15);
    assert_relative_eq!(f.nominal_load(), complete.nominal_load(), max_relative = 1e-15);
    let at = slip(0.02, 0.05, 0.01);
    close(&f.forces(2e4, 1.0, &at), &complete.forces(2e4, 1.0, &at), 2e4, 1e-14);
    assert_relative_eq!(
        f.vertical().unwrap().load(0.02, 0.0),
        complete.vertical().unwrap().load(0.02, 0.0),
        max_relative = 1e-14
    );
}

proptest! {
    #[test]
    fn damaged_files_never_panic(cut in 0usize..6000, length in 0usize..300, junk in "[\\[\\]=a-zA-Z0-9.$ \n-]{0,60}") {
        let text = &files()[0].1;
        let (cut, end) = (cut.min(text.len()), (cut + length).min(text.len()));
        if let Ok(tyre) = Pac2002::parse(&format!("{}{junk}{}", &text[..cut], &text[end..])) {
            let f = tyre.forces(2e4, 1.0, &slip(0.02, 0.05, 0.01));
            prop_assert!(f.fx.is_finite() && f.fy.is_finite() && f.mz.is_finite(), "{f:?}");
        }
    }
}
