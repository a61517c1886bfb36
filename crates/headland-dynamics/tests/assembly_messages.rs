//! What is wrong with a machine is told, each by its own message; nothing panics.

use std::fmt::Write;

use headland_dynamics::initial::initial_velocities;
use headland_dynamics::{DeriveOptions, derive};
use headland_model::Scene;

/// What reading, building, deriving or starting says; nothing if all goes well.
fn told(text: &str) -> Option<String> {
    let model = match Scene::parse("s.toml", text).and_then(|s| s.build()) {
        Ok(model) => model,
        Err(error) => return Some(error.to_string()),
    };
    let started = derive(&model, &DeriveOptions::default()).and_then(|e| initial_velocities(&model, &e.kinematics));
    let error = started.err()?;
    let place = error.place(&model).map(|p| model.source.locate(&p)).unwrap_or_default();
    Some(format!("{place} {error}"))
}

#[test]
fn what_is_wrong_is_told() {
    let a = "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1]\n";
    let b = "[[body]]\nname = \"b\"\nmass = 1\ninertia = [1, 1, 1]\n";
    let hinge = "[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\n";
    let cases: Vec<(&str, String)> = vec![
        ("break the triangle inequality: 3 about z exceeds", "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 3]".into()),
        ("break the triangle inequality", "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1.9, 0, 0.5, 0]".into()),
        ("s.toml:3:8: the body `a` cannot exist: mass -1 kg is negative", "[[body]]\nname = \"a\"\nmass = -1\ninertia = [1, 1, 1]".into()),
        ("not positive semidefinite", "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1, 2, 0, 0]".into()),
        ("s.toml:2:6: `0/0` is NaN", "[parameters]\nm = \"0/0\"\n[[body]]\nname = \"a\"\nmass = \"m\"\ninertia = [1, 1, 1]".into()),
        ("`0[m]/0` is NaN", format!("{a}[parameters]\nm = \"0[m]/0\"\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\nat = [\"m\", 0, 0]")),
        ("`0[m/s^2]/0` is NaN", format!("{a}[parameters]\ng = \"0[m/s^2]/0\"\n[world]\ngravity = [0, 0, \"g\"]")),
        ("`1/0` is inf", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\naxis = [\"1/0\", 0, 0]")),
        ("`axis` has no direction", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\naxis = [0, 0, 0]")),
        ("binds `a` to itself", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"a\"")),
        ("did you mean `world`?", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nfrom = \"wrld\"\nto = \"a\"")),
        ("did you mean `revolute`?", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolut\"\nto = \"a\"")),
        ("did you mean `sphere`?", "[[body]]\nname = \"a\"\nmass = 1\nshape = \"spere\"\nsize = 1".into()),
        ("`size` is a list of 3", "[[body]]\nname = \"a\"\nmass = 1\nshape = \"box\"\nsize = [1, 2]".into()),
        ("`size` is -1 m; it must be above 0", "[[body]]\nname = \"a\"\nmass = 1\nshape = \"sphere\"\nsize = -1".into()),
        ("fixed to itself by way of others", format!("{a}[[frame]]\nname = \"f\"\non = \"g\"\n[[frame]]\nname = \"g\"\non = \"f\"")),
        ("fixed to itself", format!("{a}[[frame]]\nname = \"f\"\non = \"f\"")),
        ("the start cannot be assembled", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"b\"\nat = [1, 0, 0]\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nfrom = \"b\"\nat = [1, 0, 0]\nto_at = [5, 0, 0]\nto = \"world\"")),
        ("no degree of freedom is left", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"b\"\nat = [1, 0, 0]\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nfrom = \"b\"\nat = [1, 0, 0]\nto_at = [1, 1, 0]\nto = \"world\"")),
        ("rolls on the body that it belongs to", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\non = \"a\"\nradius = 1")),
        ("`l` is contradictory", format!("{a}{hinge}[[constraint]]\nname = \"k\"\nequation = \"h' = 1\"\n[[constraint]]\nname = \"l\"\nequation = \"h' = 2\"")),
        ("`l` is redundant", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[[constraint]]\nname = \"k\"\nequation = \"h' = i'\"\n[[constraint]]\nname = \"l\"\nequation = \"2*h' = 2*i'\"")),
        ("the initial rates contradict", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[[constraint]]\nname = \"k\"\nequation = \"h' = i'\"\n[initial]\n\"h'\" = 1\n\"i'\" = 2")),
        ("`g` is not a coordinate", format!("{a}{hinge}[initial]\n\"g\" = 1")),
        ("`i` is not a coordinate", format!("{a}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"a\"\ncut = true\n[initial]\ni = 1")),
        ("`h.qw` cannot be prescribed", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\n[prescribed]\n\"h.qw\" = \"1\"")),
        ("`h.wx` is a quasi-velocity already", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\n[prescribed]\n\"h.wx\" = \"1\"")),
        ("`h.angl` is no coordinate of a joint; did you mean `h.angle`?", format!("{a}[[joint]]\nname = \"h\"\nkind = \"cylindrical\"\nto = \"a\"\n[prescribed]\n\"h.angl\" = \"sin(t)\"")),
        ("`hig` is prescribed, but it is no coordinate of [coordinates] or of a joint, and nothing uses it; did you mean `hip`?", format!("{a}[[joint]]\nname = \"hip\"\nkind = \"revolute\"\nto = \"a\"\n[prescribed]\nhig = \"sin(t)\"")),
        ("s.toml:12:1: `speed` is prescribed", format!("{a}{hinge}[coordinates]\nx = \"m\"\n[prescribed]\nspeed = \"2[m/s]\"\n[[constraint]]\nname = \"k\"\nequation = \"x' = 1[m/s]\"")),
        ("must be a function of t alone", format!("{a}{hinge}{b}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[prescribed]\nh = \"i\"")),
        ("`a` is a body or frame already and cannot be a joint too", format!("{a}[[joint]]\nname = \"a\"\nkind = \"revolute\"\nto = \"a\"")),
        ("`a` is there twice", format!("{a}{a}")),
        ("`h` is a coordinate already", format!("{a}{hinge}[coordinates]\nh = \"rad\"")),
        ("`a` is a parameter already and cannot be a body too", format!("{a}{hinge}[parameters]\na = 1")),
        ("`h` is a coordinate already and cannot be a definition too", format!("{a}{hinge}[definitions]\n\"h\" = \"2\"")),
        ("`h.angle` is a coordinate already", format!("{a}[[joint]]\nname = \"h\"\nkind = \"cylindrical\"\nto = \"a\"\n[definitions]\n\"h.angle\" = \"2\"")),
        ("`world` is", "[[body]]\nname = \"world\"\nmass = 1".into()),
        ("`t` has a meaning of its own", "[[body]]\nname = \"t\"\nmass = 1".into()),
        ("`a.b` is not a name", "[[body]]\nname = \"a.b\"\nmass = 1".into()),
        ("`a b` is not a name", "[[body]]\nname = \"a b\"\nmass = 1".into()),
        ("`c[4]` does not exist: `c` has 3 member(s)", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"c[4]\"".into()),
        ("`c[4]` does not exist", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h[k]\"\nkind = \"revolute\"\nfrom = \"c[k]\"\nto = \"c[k+1]\"".into()),
        ("`c` is a family of 3; one of them is `c[k]`", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"c\"".into()),
        ("uses two indices", "[indices]\nk = 3\nj = 2\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h[k]\"\nkind = \"revolute\"\nfrom = \"c[j]\"\nto = \"c[k]\"".into()),
        ("`axis` says nothing to a joint of kind", format!("{a}[[joint]]\nname = \"h\"\nkind = \"planar\"\nto = \"a\"\naxis = \"x\"")),
        ("`axis` says nothing to a joint of kind", format!("{a}[[joint]]\nname = \"h\"\nkind = \"universal\"\nto = \"a\"\naxis = \"x\"")),
        ("`lead` says nothing to a joint of kind", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\nlead = 1")),
        ("`orientation` says nothing to a joint of kind", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\norientation = \"rpy\"")),
        ("needs `lead`", format!("{a}[[joint]]\nname = \"h\"\nkind = \"screw\"\nto = \"a\"")),
        ("`lead` of `h` must be made of numbers and parameters", format!("{a}[[joint]]\nname = \"h\"\nkind = \"screw\"\nto = \"a\"\nlead = \"t*1[m/s]\"")),
        ("the screw `i` closes a loop", format!("{a}{hinge}[[joint]]\nname = \"i\"\nkind = \"screw\"\nto = \"a\"\nlead = 1")),
        ("a place on a body is made of parameters", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\nat = [\"t*1[m/s]\", 0, 0]")),
        ("the mass matrix is singular", "[[body]]\nname = \"a\"".into()),
        ("`i'`", format!("{a}{hinge}[[body]]\nname = \"b\"\n[[joint]]\nname = \"i\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"b\"")),
        ("`a.wx`", "[[body]]\nname = \"a\"\nmass = 1".into()),
        ("nothing in the scene can move: no coordinate is left beside welds", format!("{a}[[joint]]\nname = \"h\"\nkind = \"weld\"\nto = \"a\"")),
        ("no degree of freedom is left", format!("{a}[[joint]]\nname = \"h\"\nkind = \"weld\"\nto = \"a\"\ncut = true")),
        ("true or false was expected", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\ncut = \"yes\"")),
        ("lacks `to`", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"")),
        ("`radius` is -1 m; it must be above 0", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = -1")),
        ("`radius` must be made of numbers and parameters", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = \"t*1[m/s]\"")),
        ("`radius` means nothing here", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = 1\nsemi_axes = [1, 1, 1]")),
        ("`semi_axes` is 0 m", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nsemi_axes = [1, 0, 1]")),
        ("the wheel or disc of `c` lies flat at the start", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = 1\naxis = \"z\"")),
        ("`tube` means nothing here", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = 1\ntube = 0.1")),
        ("s.toml:5:1 the ends of the spring `s` are in the same place", format!("{a}[[spring]]\nname = \"s\"\nto = \"a\"\nstiffness = 1\nfree_length = 1")),
        ("the ends of the spring `s` are in the same place", format!("{a}[[spring]]\nname = \"s\"\nto = \"a\"\ndamping = 1")),
        ("neither `stiffness` nor `damping`", format!("{a}[[spring]]\nname = \"s\"\nto = \"a\"")),
        ("undefined name `h.fw`", format!("{a}{hinge}[outputs]\ncolumns = [\"h.fw\"]")),
        ("undefined name `a.fx`", format!("{a}[outputs]\ncolumns = [\"a.fx\"]")),
        ("`a` has no `q`", format!("{a}[outputs]\ncolumns = [\"a.q\"]")),
        ("follows from the equations of motion", format!("{a}{hinge}[[force]]\nname = \"f\"\nvalue = \"h.fx\"\ngeometric = \"h\"")),
        ("follows from the equations of motion", format!("{a}{hinge}[definitions]\nd = \"h.fx\"\n[[force]]\nname = \"f\"\nvalue = \"d*1[m]\"\ngeometric = \"h\"")),
        ("follows from the equations of motion", format!("{a}{hinge}{b}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[prescribed]\ni = \"h.fx/1[N]\"")),
        ("depends on the acceleration", format!("{a}{hinge}[[force]]\nname = \"f\"\nvalue = \"a.epsilon_z*1[N*m*s^2]\"\ngeometric = \"h\"")),
        ("`g` is not a coordinate", format!("{a}{hinge}[run]\nindependent = [\"g'\"]")),
        ("s.toml:5:1 gimbal lock: the pitch of `h` is 90 deg", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\norientation = \"rpy\"\n[initial]\n\"h.pitch\" = \"90 deg\"")),
        ("`orientation` is", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\norientation = \"euler\"")),
        ("the quaternion of `a` is zero at the start", format!("{a}[initial]\n\"a.qw\" = 0")),
        ("needs one structure", format!("{a}[[force]]\nname = \"f\"\non = \"a\"")),
        ("`position` means nothing here", format!("{a}[[force]]\nname = \"f\"\non = \"a\"\nforce = [1, 0, 0]\nposition = [0, 0, 0]")),
        ("`axes` is", format!("{a}[[force]]\nname = \"f\"\non = \"a\"\nforce = [1, 0, 0]\naxes = \"body\"")),
        ("`force` is a list of 3", format!("{a}[[force]]\nname = \"f\"\non = \"a\"\nforce = [1, 0]")),
        ("is an acceleration [m/s^2]", format!("{a}[world]\ngravity = [0, 0, \"9.81 m\"]")),
        ("made of parameters, not of `t`", "[[body]]\nname = \"a\"\nmass = \"t*1[kg/s]\"\ninertia = [1, 1, 1]".into()),
        ("needs `spin`", "[coordinates]\nx = \"rad\"\n[[inertia]]\nname = \"i\"\ntensor = [1, 1, 1]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("not positive", "[coordinates]\nx = \"m\"\n[[inertia]]\nname = \"i\"\nmass = -1\nvelocity = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("`value` means nothing here", "[coordinates]\nx = \"m\"\n[[inertia]]\nname = \"i\"\nmass = 1\nvalue = 1\nvelocity = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("needs one structure of its point", "[coordinates]\nx = \"m\"\n[[inertia]]\nname = \"i\"\nmass = 1\nposition = [0, 0, \"x\"]\nvelocity = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
    ];
    let mut wrong = String::new();
    for (expected, text) in cases {
        let message = told(&text).unwrap_or_else(|| "nothing".into());
        if !message.contains(expected) {
            let _ = writeln!(wrong, "--- expected: {expected}\n{message}");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// A joint that shares a name with a family of bodies would be taken for one of them.
#[test]
fn a_joint_is_no_member_of_a_family_of_bodies() {
    let text = "[[body]]\nname = \"c[1]\"\nmass = 1\ninertia = [1, 1, 1]\n\
                [[joint]]\nname = \"c[2]\"\nkind = \"revolute\"\nto = \"c[1]\"\n";
    let message = told(text).unwrap_or_default();
    assert!(message.contains("`c` is a body or frame already and cannot be a joint too"), "{message}");
}

/// A loop that cannot be closed names where its joint was written.
#[test]
fn where_a_loop_is_open_is_told() {
    let text = "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1]\n\
                [[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\n\
                [[joint]]\nname = \"far\"\nkind = \"spherical\"\nto = \"a\"\nat = [5, 0, 0]\nto_at = [1, 0, 0]\n";
    let message = told(text).unwrap_or_default();
    assert!(message.starts_with("s.toml:9:1") && message.contains("`far.x` by 4"), "{message}");
}

/// Nothing that is refused stands in the scenes of this repository.
#[test]
fn the_scenes_at_hand_are_accepted() {
    let mut count = 0;
    for folder in ["../../models", "../../validation/scenes"] {
        let files = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{folder}: {e}"));
        for path in files.filter_map(|f| Some(f.ok()?.path())).filter(|p| p.extension().is_some_and(|e| e == "toml")) {
            let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{e}"));
            if text.contains("shape = \"mesh\"") {
                continue; // for programs with the feature `mesh`
            }
            let built = Scene::parse(&path.to_string_lossy(), &text).and_then(|s| s.build());
            assert!(built.is_ok(), "{}", built.err().map_or(String::new(), |e| e.to_string()));
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

/// A rod on a hinge: at rest it carries the weight, in motion also the centripetal force.
#[test]
fn a_pendulum_pulls_at_its_hinge() {
    let text = "[world]\ngravity = [0, -9.81, 0]\n\
                [[body]]\nname = \"rod\"\nmass = 2\ncenter = [0, -0.5, 0]\ninertia = [0.2, 0.01, 0.2]\n\
                [[joint]]\nname = \"hinge\"\nkind = \"revolute\"\nto = \"rod\"\n\
                [outputs]\ncolumns = [\"hinge.fx\", \"hinge.fy\", \"hinge.fz\", \"hinge.tz\"]\n";
    let model = Scene::parse("s.toml", text).and_then(|s| s.build()).unwrap_or_else(|e| panic!("{e}"));
    let equations = derive(&model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let columns: Vec<_> = model.outputs.iter().map(|o| o.node).collect();
    let nodes = equations.by_state(&model, &columns);
    for w in [0.0, 3.0] {
        let mut x = model.inputs();
        x[model.input_index(model.coordinates[0].rate)] = w;
        let found = model.graph.eval(&nodes, &x);
        let expected = [0.0, 2.0 * (9.81 + 0.5 * w * w), 0.0, 0.0];
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{found:?} for {expected:?}");
        }
    }
}

/// Constraints in conflict are named together, and only those; what can be fulfilled beside them is not.
#[test]
fn conflicting_constraints_are_named_in_sets() {
    let point = |name: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass = 1\n[[joint]]\nname = \"of_{name}\"\nkind = \"planar\"\nto = \"{name}\"\n"
        )
    };
    let constraint =
        |name: &str, equation: &str| format!("[[constraint]]\nname = \"{name}\"\nequation = \"{equation}\"\n");
    let scene = point("a").replace("mass = 1", "mass = 1\ninertia = [1, 1, 1]")
        + &point("b").replace("mass = 1", "mass = 1\ninertia = [1, 1, 1]")
        + &constraint("rod", "hypot(of_a.x, of_a.y) = 2[m]")
        + &constraint("wire", "of_a.y = -3[m]")
        + &constraint("turn", "of_a.angle = 0.5")
        + &constraint("low", "of_b.x - 2*of_b.y = 1[m]")
        + &constraint("high", "2*of_b.x - 4*of_b.y = 5[m]")
        + &constraint("free", "of_b.angle = 0.2");
    let start = "[initial]\n\"of_a.x\" = 1\n\"of_a.y\" = -1\n";
    let message = told(&(scene + start)).unwrap_or_default();
    // the least squares lie in the middle of 2 m and 3 m; and of 1 m and 5/2 m, rows of equal length
    assert!(message.contains("`rod` by 0.500 with `wire` by 0.500"), "{message}");
    assert!(message.contains("`low` by 0.750 with `high` by 1.500"), "{message}");
    assert!(!message.contains("turn") && !message.contains("free") && message.contains("; "), "{message}");
}
