//! Wheels on tyres: standing on a slope, lifted and dropped, backwards, energy, limits; what is wrong with one is told.

mod common;

use common::{done, read};
use headland_sim::Run;

const LINEAR: &str = "law = \"linear\"\nlongitudinal = \"60 kN\"\ncornering = \"40 kN\"\nload = \"5 kN\"\n";
const BRUSH: &str = "law = \"brush\"\nlongitudinal = \"60 kN\"\ncornering = \"40 kN\"\nfriction = 0.8\n\
    half_length = \"0.1 m\"\nload = \"5 kN\"\n";
const TMEASY: &str = "law = \"tmeasy\"\ncontact_length = \"0.2 m\"\nload = \"5 kN\"\n";
const RELAXES: &str = "relaxation = [\"0.3 m\", \"0.5 m\"]\n";

/// A wheel of 0.6 m and 500 kg that moves freely, or does not turn.
fn wheel(joint: &str, tyre: &str, rest: &str) -> String {
    format!(
        "[[body]]\nname = \"wheel\"\nmass = \"500 kg\"\ninertia = [40, 70, 40]\n{joint}\
         [[tyre]]\nname = \"tyre\"\nbody = \"wheel\"\nradius = \"0.6 m\"\nstiffness = \"400 kN/m\"\n{tyre}{rest}"
    )
}

fn level(g: &str) -> String {
    format!("[world]\ngravity = {g}\n")
}

/// Joints along x, y and z; the wheel turns with the last if asked to.
fn slides(turns: bool) -> String {
    let mut text = String::new();
    let mut from = "world".to_string();
    for axis in ["x", "y", "z"] {
        let last = axis == "z" && !turns;
        let to = if last { "wheel".to_string() } else { format!("b{axis}") };
        if !last {
            text += &format!("[[body]]\nname = \"{to}\"\nmass = 1\n");
        }
        text += &format!(
            "[[joint]]\nname = \"p{axis}\"\nkind = \"prismatic\"\naxis = \"{axis}\"\nfrom = \"{from}\"\nto = \"{to}\"\n"
        );
        from = to;
    }
    if turns {
        text += "[[joint]]\nname = \"turn\"\nkind = \"revolute\"\naxis = \"y\"\nfrom = \"bz\"\nto = \"wheel\"\n";
    }
    text
}

fn go(text: &str, until: f64, tolerance: f64) -> Run {
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    done(&model, |o| (o.until, o.tolerance) = (until, tolerance))
}

fn last(run: &Run) -> &[f64] {
    run.trajectory.rows.last().expect("there is an output")
}

/// Relaxation holds a braked wheel like a spring: along and across it stays where it is.
#[test]
fn stands_on_a_slope() {
    for law in [LINEAR, BRUSH, TMEASY] {
        let tyre = format!("damping = \"3 kN*s/m\"\n{law}{RELAXES}");
        let rest = "[initial]\npx = 0\npy = 0\npz = \"0.59 m\"\n\"px'\" = 0\n\"py'\" = 0\n\"pz'\" = 0\n\
            [outputs]\ncolumns = [\"px\", \"py\", \"pz\", \"tyre.fx\", \"tyre.fy\", \"tyre.fz\"]\n[run]\npoints = 60\n";
        let text = wheel(&slides(false), &tyre, &(level("[1.2, -0.9, -9.7]") + rest));
        let run = go(&text, 600.0, 1e-8);
        let early = run.trajectory.t.iter().position(|t| *t >= 9.99).expect("10 s");
        let (a, b) = (&run.trajectory.rows[early], last(&run));
        let moved = (b[0] - a[0]).hypot(b[1] - a[1]);
        assert!(moved < 1e-6, "{law}: {moved:e}");
        // 502 kg of wheel and slides
        for (found, expected) in b[3..].iter().zip([-1.2 * 502.0, 0.9 * 501.0, 9.7 * 500.0]) {
            assert!((found - expected).abs() < 0.01 * expected.abs(), "{law}: {b:?}");
        }
        assert!(b[0] > 0.0 && b[1] < 0.0 && b[0].hypot(b[1]) < 0.05, "{b:?}");
    }
}

/// Without damper a dropped wheel comes back to where it fell from, by the closed form of a fall on a spring.
#[test]
fn a_dropped_wheel_bounces_and_comes_to_rest() {
    let joint = "[[joint]]\nname = \"z\"\nkind = \"prismatic\"\naxis = \"z\"\nto = \"wheel\"\n";
    let rest = "[initial]\nz = \"0.7 m\"\n\"z'\" = 0\n[outputs]\ncolumns = [\"z\", \"tyre.fz\", \"tyre.deflection\"]\n\
        [run]\npoints = 2000\n";
    let text = wheel(joint, "", &(level("[0, 0, -9.81]") + rest));
    let run = go(&text, 3.0, 1e-10);
    let (g, k, m) = (9.81_f64, 4e5_f64, 500.0_f64);
    let least = run.trajectory.rows.iter().map(|r| r[0]).fold(f64::INFINITY, f64::min);
    let deepest = m * g / k + ((m * g / k).powi(2) + 2.0 * 0.1 * m * g / k).sqrt();
    assert!((least - (0.6 - deepest)).abs() < 1e-4, "{least} {deepest}");
    let omega: f64 = (k / m).sqrt();
    let fall = (2.0 * 0.1 / g).sqrt();
    let (x, v) = (-m * g / k, g * fall);
    // on the spring from d = 0 with the speed of the fall, until d = 0 again
    let on = 2.0 * (std::f64::consts::PI - (v / omega).atan2(-x)) / omega;
    let period = 2.0 * fall + on;
    assert!(run.report.energy_balance.expect("a balance") < 1e-8);
    let model = read(&text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| (o.until, o.tolerance) = (4.0 * period, 1e-10));
    assert!((last(&run)[0] - 0.7).abs() < 1e-6, "{} after {period}", last(&run)[0]);
    assert!(run.trajectory.rows.iter().all(|r| r[1] >= 0.0 && (r[2] >= 0.0 || r[1] == 0.0)));

    let damped = wheel(joint, "damping = \"6 kN*s/m\"\n", &(level("[0, 0, -9.81]") + rest));
    let end = last(&go(&damped, 30.0, 1e-9)).to_vec();
    assert!((end[0] - (0.6 - m * g / k)).abs() < 1e-7, "{end:?}");
}

/// A driven wheel backwards is the mirror image of one forward, from standstill.
#[test]
fn starts_backwards() {
    let run = |sign: f64, law: &str| {
        let tyre = format!("damping = \"3 kN*s/m\"\n{law}{RELAXES}rolling = 0.02\n");
        let rest = format!(
            "[[force]]\nname = \"engine\"\nvalue = \"{sign}*900[N*m]*smoothstep(t, 0, 0.5)\"\nimplicit = \"turn'\"\n\
             [initial]\npx = 0\npy = 0\npz = \"0.5877375 m\"\nturn = 0\n\"px'\" = 0\n\"py'\" = 0\n\"pz'\" = 0\n\"turn'\" = 0\n\
             [outputs]\ncolumns = [\"px\", \"px'\", \"turn'\", \"tyre.fx\", \"tyre.kappa\", \"tyre.my\"]\n"
        );
        let text = wheel(&slides(true), &tyre, &(level("[0, 0, -9.81]") + &rest));
        last(&go(&text, 4.0, 1e-9)).to_vec()
    };
    for law in [LINEAR, BRUSH, TMEASY] {
        let (forward, backward) = (run(1.0, law), run(-1.0, law));
        assert!(forward[1] > 1.0 && forward[3] > 100.0 && forward[4] > 0.0 && forward[5] < 0.0, "{forward:?}");
        for (a, b) in forward.iter().zip(&backward) {
            assert!((a + b).abs() < 1e-6 * a.abs().max(1.0), "{law}: {forward:?} {backward:?}");
        }
    }
}

/// A free wheel that rolls, sways and leans: all work is found again in the energy, with every law.
#[test]
fn free_rolling_keeps_the_energy_balance() {
    for law in ["", LINEAR, BRUSH, TMEASY] {
        for relaxes in ["", RELAXES] {
            if law.is_empty() && !relaxes.is_empty() {
                continue;
            }
            let tyre = format!("damping = \"3 kN*s/m\"\n{law}{relaxes}rolling = 0.015\n");
            let joint = "[[joint]]\nname = \"p\"\nkind = \"free\"\nto = \"wheel\"\n";
            let rest = "[initial]\n\"p.x\" = 0\n\"p.y\" = 0\n\"p.z\" = \"0.588 m\"\n\"p.x'\" = 5\n\"p.y'\" = 0.1\n\"p.z'\" = 0\n\
                \"p.wx\" = 0.01\n\"p.wy\" = 8.5\n\"p.wz\" = 0.02\n[outputs]\ncolumns = [\"p.x\", \"tyre.fz\", \"tyre.camber\"]\n";
            let run = go(&wheel(joint, &tyre, &(level("[0, 0, -9.81]") + rest)), 2.0, 1e-10);
            let balance = run.report.energy_balance.expect("a balance");
            assert!(balance < 1e-8, "{law}{relaxes}: {balance:e}");
            assert!(last(&run)[0] > 5.0 && last(&run)[2].abs() > 1e-3, "{:?}", last(&run));
        }
    }
}

/// The ground may move: a wheel on a table that is pulled away pushes it back by its own force.
#[test]
fn the_ground_has_the_reaction() {
    let text = format!(
        "[[body]]\nname = \"table\"\nmass = \"300 kg\"\n[[joint]]\nname = \"tx\"\nkind = \"prismatic\"\naxis = \"x\"\nto = \"table\"\n{}",
        wheel(
            &slides(true),
            &format!("on = \"table\"\ndamping = \"3 kN*s/m\"\n{BRUSH}"),
            &(level("[0, 0, -9.81]")
                + "[initial]\ntx = 0\n\"tx'\" = 2\npx = 0\npy = 0\npz = \"0.5877375 m\"\nturn = 0\n\"px'\" = 0\n\"py'\" = 0\n\
                   \"pz'\" = 0\n\"turn'\" = 0\n[outputs]\ncolumns = [\"system.px\", \"px'\", \"tyre.fx\"]\n")
        )
    );
    let run = go(&text, 1.0, 1e-10);
    for row in &run.trajectory.rows {
        assert!((row[0] - 600.0).abs() < 1e-6, "{row:?}");
    }
    // the impulse P after which it rolls: 2 m/s − P/300 = P/503 + P R²/70
    let rolls = 2.0 / (1.0 / 300.0 + 1.0 / 503.0 + 0.5877_f64.powi(2) / 70.0) / 503.0;
    assert!((last(&run)[1] - rolls).abs() < 1e-3, "{:?} {rolls}", last(&run));
    assert!(run.report.energy_balance.expect("a balance") < 1e-8);
}

/// A file is read from the folder of the scene; what it leaves out is told.
#[test]
fn a_file_gives_the_law() {
    let folder = std::env::temp_dir().join(format!("headland-tyre-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = "[UNITS]\nLENGTH='meter'\nFORCE='newton'\nANGLE='radians'\nMASS='kg'\nTIME='second'\n\
        [DIMENSION]\nUNLOADED_RADIUS=0.6\n[VERTICAL]\nFNOMIN=5000\nVERTICAL_STIFFNESS=4e5\nVERTICAL_DAMPING=3e3\n\
        [LATERAL_COEFFICIENTS]\nPCY1=1.6\nPDY1=0.8\nPKY1=-10\nPKY2=3\n[LONGITUDINAL_COEFFICIENTS]\nPCX1=1.6\nPDX1=0.9\nPKX1=15\n";
    std::fs::write(folder.join("x.tir"), file).expect("a file");
    let scene = |mirrored: &str, vy: f64| {
        format!(
            "[[body]]\nname = \"wheel\"\nmass = \"500 kg\"\ninertia = [40, 70, 40]\n{}[[tyre]]\nname = \"tyre\"\nbody = \"wheel\"\n\
             law = \"pac2002\"\nfile = \"x.tir\"\n{mirrored}{}[initial]\npx = 0\npy = 0\npz = \"0.5877375 m\"\nturn = 0\n\
             \"px'\" = 5\n\"py'\" = {vy}\n\"pz'\" = 0\n\"turn'\" = 8.5\n[outputs]\ncolumns = [\"py'\", \"tyre.fy\"]\n",
            slides(true),
            level("[0, 0, -9.81]")
        )
    };
    let run = |text: &str| {
        let name = folder.join("scene.toml");
        let model = headland_model::Scene::parse(name.to_str().expect("a path"), text)
            .unwrap_or_else(|e| panic!("{e}"))
            .build()
            .unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(model.warnings.len(), 1, "{:?}", model.warnings);
        let run = done(&model, |o| (o.until, o.tolerance) = (0.5, 1e-10));
        assert!(run.report.energy_balance.expect("a balance") < 1e-8);
        run.trajectory.rows
    };
    let (plain, mirrored) = (run(&scene("", 0.2)), run(&scene("mirrored = true\n", -0.2)));
    assert!(plain[0][1] < -100.0, "{:?}", plain[0]);
    for (a, b) in plain.iter().zip(&mirrored) {
        assert!((a[0] + b[0]).abs() < 1e-8 && (a[1] + b[1]).abs() < 1e-5, "{a:?} {b:?}");
    }
    // with the file's own relaxation it begins without slip and ends the same way
    let relaxed = run(&scene("relaxation = \"file\"\n", 0.2));
    assert!(relaxed[0][1] == 0.0 && (relaxed[300][0] - plain[300][0]).abs() < 0.02, "{:?}", relaxed[300]);
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

/// `z' = v² − z` beside a particle of constant speed: closed form, and the matrix of its linearisation.
#[test]
fn states_of_the_first_order() {
    let text = "[coordinates]\nx = \"m\"\nz = \"m\"\n[kinematics]\n\"z'\" = \"x'^2/1[m/s] - z/1[s]\"\n\
        [[inertia]]\nname = \"m\"\nvalue = \"2 kg\"\ngeometric = \"x\"\n\
        [initial]\nx = 0\nz = 9\n\"x'\" = 3\n[outputs]\ncolumns = [\"z\", \"z'\", \"z''\"]\n";
    let moving = text.replace("z = 9", "z = 0");
    for row in go(&moving, 2.0, 1e-11).trajectory.rows.iter().zip(0..) {
        let t = f64::from(row.1) * 2.0 / 300.0;
        let e = (-t).exp();
        for (found, expected) in row.0.iter().zip([9.0 * (1.0 - e), 9.0 * e, -9.0 * e]) {
            assert!((found - expected).abs() < 1e-9, "{t}: {:?}", row.0);
        }
    }
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let equations = headland_dynamics::derive(&model, &Default::default()).unwrap_or_else(|e| panic!("{e}"));
    let linear =
        headland_dynamics::linearise(&model, &equations, 0.0, &[0.0, 9.0, 3.0], &[]).unwrap_or_else(|e| panic!("{e}"));
    assert!((linear.entry("z", "x'").expect("an entry") - 6.0).abs() < 1e-12);
    assert!((linear.entry("z", "z").expect("an entry") + 1.0).abs() < 1e-12);
    // a structure that depends on it makes it a coordinate of form (2) again
    let bound = format!("{text}[[elastic]]\nname = \"c\"\nvalue = \"1 N/m\"\ngeometric = \"z\"\n");
    let model = read(&bound).build().unwrap_or_else(|e| panic!("{e}"));
    let error = headland_dynamics::derive(&model, &Default::default()).expect_err("not linear").to_string();
    assert!(error.contains("`z'`") && error.contains("linear"), "{error}");
}

#[test]
fn what_is_wrong_with_a_tyre_is_told() {
    let rest = "[initial]\npx = 0\npy = 0\npz = \"0.59 m\"\n\"px'\" = 0\n\"py'\" = 0\n\"pz'\" = 0\n";
    let good = wheel(&slides(false), BRUSH, &(level("[0, 0, -9.81]") + rest));
    let cases = [
        ("\"400 kN/m\"", "\"0 kN/m\"", "`stiffness` is 0; it must be above 0"),
        ("\"400 kN/m\"", "\"-400 kN/m\"", "`stiffness` is -400000; it must be above 0"),
        ("stiffness = \"400 kN/m\"\n", "", "this tyre needs `stiffness`"),
        ("law = \"brush\"", "law = \"brush2\"", "unknown law \"brush2\"; did you mean `brush`?"),
        ("law = \"brush\"", "law = \"linear\"", "`half_length` means nothing here: the law is \"linear\""),
        (BRUSH, "law = \"pac2002\"\n", "needs `file`"),
        (BRUSH, "law = \"pac2002\"\nfile = \"none.tir\"\n", "cannot read `none.tir`"),
        ("friction = 0.8\n", "", "the law \"brush\" needs `friction`"),
        ("friction = 0.8\n", "friction = -1\n", "`friction` is -1; it must be above 0"),
        ("\"brush\"\n", "\"brush\"\nrelaxation = [0.3, 0]\n", "`relaxation` is 0; it must be above 0"),
        ("\"brush\"\n", "\"brush\"\nlow_speed = 3\n", "it belongs to tyres with `relaxation`"),
        ("\"brush\"\n", "\"brush\"\naxis = \"z\"\n", "lies flat at the start"),
        ("\"brush\"\n", "\"brush\"\nrelaxation = \"file\"\n", "belongs to `law = \"pac2002\"`"),
        (BRUSH, "relaxation = 0.3\n", "nothing that relaxes"),
    ];
    for (from, to, expected) in cases {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = match read(&text).build() {
            Ok(_) => panic!("{from} -> {to} is taken"),
            Err(e) => e.to_string(),
        };
        assert!(error.contains(expected), "{error}\nwanted: {expected}");
    }
    let below = good.replace("0.59 m", "-0.1 m");
    let model = read(&below).build().unwrap_or_else(|e| panic!("{e}"));
    let error = headland_sim::run(&model, &headland_sim::RunOptions::of(&model), &mut headland_sim::Silent);
    let error = error.map(|_| ()).expect_err("below the ground").to_string();
    assert!(error.contains("below the ground"), "{error}");
}

/// The article's train on tyres tends to the train without slip, at first order in one over the stiffness, over four decades.
#[test]
fn stiff_tyres_tend_to_no_slip() {
    let tyres = include_str!("../../../models/paper_train_tyres.toml");
    let path = |text: &str, epsilon: Option<&str>, tolerance: f64| {
        let mut scene = read(text);
        if let Some(epsilon) = epsilon {
            common::set(&mut scene, &[("epsilon", epsilon)]);
        }
        let model = common::build(&scene);
        let run = done(&model, |o| (o.tolerance, o.points) = (tolerance, 60));
        run.trajectory.rows.iter().map(|row| [row[0], row[1]]).collect::<Vec<_>>()
    };
    let limit = path(common::TRAIN, None, 1e-12);
    let size = limit.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    let decades = ["1", "0.1", "1e-2", "1e-3", "1e-4"];
    let errors = decades.map(|epsilon| {
        let found = path(tyres, Some(epsilon), 1e-10);
        let off = found.iter().zip(&limit).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
        (off / size).log10()
    });
    // least squares of log error by log epsilon = 0, -1, .. -4
    let mean = errors.iter().sum::<f64>() / 5.0;
    let order = errors.iter().zip(0..).map(|(e, k)| (2.0 - f64::from(k)) * (e - mean)).sum::<f64>() / 10.0;
    assert!((order - 1.0).abs() < 0.05, "{order}: {errors:?}");
    assert!(errors[4] < -4.5, "{errors:?}");
}

/// Four tyres carry the tractor's weight; it is where the lane change leaves it, with its energy accounted for.
#[test]
fn a_tractor_on_four_tyres() {
    let model = common::build(&read(include_str!("../../../models/tractor.toml")));
    let run = done(&model, |o| (o.until, o.points) = (10.0, 100));
    let column = |name: &str| model.outputs.iter().position(|o| o.name == name).expect(name);
    let loads = ["tyre_f[1].fz", "tyre_f[2].fz", "tyre_r[1].fz", "tyre_r[2].fz"].map(column);
    let weight = (4400.0 + 300.0 + 2.0 * 150.0 + 2.0 * 500.0) * 9.81e-3; // kN
    for row in [&run.trajectory.rows[15][..], last(&run)] {
        let sum: f64 = loads.iter().map(|k| row[*k]).sum();
        assert!((sum / weight - 1.0).abs() < 1e-3, "{sum} {weight}");
    }
    let (y, yaw) = (column("place.y"), column("place.yaw"));
    assert!(last(&run)[y] > 2.0 && last(&run)[yaw].abs() < 0.2, "{:?}", last(&run));
    assert!(run.report.energy_balance.expect("a balance") < 1e-7);
}
