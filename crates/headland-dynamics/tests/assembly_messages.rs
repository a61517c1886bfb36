//! Messages.
mod machine;
use machine::state::read;
use headland_dynamics::{derive, DeriveOptions, initial::initial_velocities};
#[test]
fn show() {
    let a = "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1]\n";
    let b = "[[body]]\nname = \"b\"\nmass = 1\ninertia = [1, 1, 1]\n";
    let hinge = "[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\n";
    let cases: Vec<(&str, String)> = vec![
        ("triangle", "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 3]".into()),
        ("triangle full", "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1.9, 0, 0.5, 0]".into()),
        ("negative mass", "[[body]]\nname = \"a\"\nmass = -1\ninertia = [1, 1, 1]".into()),
        ("negative principal", "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1, 2, 0, 0]".into()),
        ("nan mass", "[parameters]\nm = \"0/0\"\n[[body]]\nname = \"a\"\nmass = \"m\"\ninertia = [1, 1, 1]".into()),
        ("nan at", format!("{a}[parameters]\nm = \"0[m]/0\"\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\nat = [\"m\", 0, 0]")),
        ("nan gravity", format!("{a}[parameters]\ng = \"0[m/s^2]/0\"\n[world]\ngravity = [0, 0, \"g\"]")),
        ("inf axis", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\naxis = [\"1/0\", 0, 0]")),
        ("zero axis", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\naxis = [0, 0, 0]")),
        ("itself", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"a\"")),
        ("unknown frame", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nfrom = \"wrld\"\nto = \"a\"")),
        ("unknown kind", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolut\"\nto = \"a\"")),
        ("unknown shape", "[[body]]\nname = \"a\"\nmass = 1\nshape = \"spere\"\nsize = 1".into()),
        ("size", "[[body]]\nname = \"a\"\nmass = 1\nshape = \"box\"\nsize = [1, 2]".into()),
        ("negative size", "[[body]]\nname = \"a\"\nmass = 1\nshape = \"sphere\"\nsize = -1".into()),
        ("circle", format!("{a}[[frame]]\nname = \"f\"\non = \"g\"\n[[frame]]\nname = \"g\"\non = \"f\"")),
        ("own frame", format!("{a}[[frame]]\nname = \"f\"\non = \"f\"")),
        ("no assembly", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"b\"\nat = [1, 0, 0]\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nfrom = \"b\"\nat = [1, 0, 0]\nto_at = [5, 0, 0]\nto = \"world\"")),
        ("rigid", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"b\"\nat = [1, 0, 0]\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nfrom = \"b\"\nat = [1, 0, 0]\nto_at = [1, 1, 0]\nto = \"world\"")),
        ("wheel itself", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\non = \"a\"\nradius = 1")),
        ("conflict", format!("{a}{hinge}[[constraint]]\nname = \"k\"\nequation = \"h' = 1\"\n[[constraint]]\nname = \"l\"\nequation = \"h' = 2\"")),
        ("redundant user", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[[constraint]]\nname = \"k\"\nequation = \"h' = i'\"\n[[constraint]]\nname = \"l\"\nequation = \"2*h' = 2*i'\"")),
        ("too many", format!("{a}{b}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[[constraint]]\nname = \"k\"\nequation = \"h' = i'\"\n[initial]\n\"h'\" = 1\n\"i'\" = 2")),
        ("initial unknown", format!("{a}{hinge}[initial]\n\"g\" = 1")),
        ("initial cut", format!("{a}{hinge}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"a\"\ncut = true\n[initial]\ni = 1")),
        ("prescribed all", format!("{a}{hinge}[prescribed]\nh = \"sin(t)\"")),
        ("prescribed quaternion", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\n[prescribed]\n\"h.qw\" = \"1\"")),
        ("prescribed wx", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\n[prescribed]\n\"h.wx\" = \"1\"")),
        ("prescribed unknown", format!("{a}{hinge}[prescribed]\nhh = \"sin(t)\"")),
        ("prescribed part", format!("{a}[[joint]]\nname = \"h\"\nkind = \"cylindrical\"\nto = \"a\"\n[prescribed]\n\"h.angl\" = \"sin(t)\"")),
        ("prescribed q", format!("{a}{hinge}{b}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[prescribed]\nh = \"i\"")),
        ("prescribed free", format!("{a}[prescribed]\n\"a.x\" = \"sin(t)*1[m]\"")),
        ("collide body joint", format!("{a}[[joint]]\nname = \"a\"\nkind = \"revolute\"\nto = \"a\"")),
        ("collide bodies", format!("{a}{a}")),
        ("collide coordinate", format!("{a}{hinge}[coordinates]\nh = \"rad\"")),
        ("collide parameter", format!("{a}{hinge}[parameters]\na = 1")),
        ("collide definition", format!("{a}{hinge}[definitions]\n\"h\" = \"2\"")),
        ("collide part", format!("{a}[[joint]]\nname = \"h\"\nkind = \"cylindrical\"\nto = \"a\"\n[definitions]\n\"h.angle\" = \"2\"")),
        ("world body", "[[body]]\nname = \"world\"\nmass = 1".into()),
        ("t body", "[[body]]\nname = \"t\"\nmass = 1".into()),
        ("dot name", "[[body]]\nname = \"a.b\"\nmass = 1".into()),
        ("space name", "[[body]]\nname = \"a b\"\nmass = 1".into()),
        ("family index", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"c[4]\"".into()),
        ("family k+1", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h[k]\"\nkind = \"revolute\"\nfrom = \"c[k]\"\nto = \"c[k+1]\"".into()),
        ("family no index", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"c\"".into()),
        ("two indices", "[indices]\nk = 3\nj = 2\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h[k]\"\nkind = \"revolute\"\nfrom = \"c[j]\"\nto = \"c[k]\"".into()),
        ("name no index", "[indices]\nk = 3\n[[body]]\nname = \"c[k]\"\nmass = 1\ninertia = [1, 1, 1]\n[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"c[k]\"".into()),
        ("planar axis", format!("{a}[[joint]]\nname = \"h\"\nkind = \"planar\"\nto = \"a\"\naxis = \"x\"")),
        ("universal axis", format!("{a}[[joint]]\nname = \"h\"\nkind = \"universal\"\nto = \"a\"\naxis = \"x\"")),
        ("revolute lead", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\nlead = 1")),
        ("revolute rpy", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\norientation = \"rpy\"")),
        ("screw lead", format!("{a}[[joint]]\nname = \"h\"\nkind = \"screw\"\nto = \"a\"")),
        ("screw zero lead", format!("{a}[[joint]]\nname = \"h\"\nkind = \"screw\"\nto = \"a\"\nlead = 0")),
        ("lead of q", format!("{a}[[joint]]\nname = \"h\"\nkind = \"screw\"\nto = \"a\"\nlead = \"t*1[m/s]\"")),
        ("screw loop", format!("{a}{hinge}[[joint]]\nname = \"i\"\nkind = \"screw\"\nto = \"a\"\nlead = 1")),
        ("at of q", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\nat = [\"t*1[m/s]\", 0, 0]")),
        ("massless", "[[body]]\nname = \"a\"".into()),
        ("massless tip", format!("{a}{hinge}[[body]]\nname = \"b\"\n[[joint]]\nname = \"i\"\nkind = \"revolute\"\nfrom = \"a\"\nto = \"b\"")),
        ("point mass", "[[body]]\nname = \"a\"\nmass = 1".into()),
        ("weld only", format!("{a}[[joint]]\nname = \"h\"\nkind = \"weld\"\nto = \"a\"")),
        ("cut only joint", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\ncut = true")),
        ("all cut weld", format!("{a}[[joint]]\nname = \"h\"\nkind = \"weld\"\nto = \"a\"\ncut = true")),
        ("cut text", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"\nto = \"a\"\ncut = \"yes\"")),
        ("free joint loop", format!("{a}{hinge}[[joint]]\nname = \"i\"\nkind = \"free\"\nto = \"a\"")),
        ("no to", format!("{a}[[joint]]\nname = \"h\"\nkind = \"revolute\"")),
        ("radius negative", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = -1")),
        ("radius q", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = \"t*1[m/s]\"")),
        ("radius and semi", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = 1\nsemi_axes = [1, 1, 1]")),
        ("semi zero", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nsemi_axes = [1, 0, 1]")),
        ("disc flat", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = 1\naxis = \"z\"")),
        ("tube ball", format!("{a}[[rolling]]\nname = \"c\"\nbody = \"a\"\nradius = 1\ntube = 0.1")),
        ("spring nothing", format!("{a}[[spring]]\nname = \"s\"\nto = \"a\"")),
        ("spring same point", format!("{a}[[spring]]\nname = \"s\"\nto = \"a\"\nstiffness = 1\nfree_length = 1")),
        ("spring damper same point", format!("{a}[[spring]]\nname = \"s\"\nto = \"a\"\ndamping = 1")),
        ("reaction typo", format!("{a}{hinge}[outputs]\ncolumns = [\"h.fw\"]")),
        ("reaction free", format!("{a}[outputs]\ncolumns = [\"a.fx\"]")),
        ("frame quantity", format!("{a}[outputs]\ncolumns = [\"a.q\"]")),
        ("reaction in force", format!("{a}{hinge}[[force]]\nname = \"f\"\nvalue = \"h.fx\"\ngeometric = \"h\"")),
        ("reaction in definition used in force", format!("{a}{hinge}[definitions]\nd = \"h.fx\"\n[[force]]\nname = \"f\"\nvalue = \"d*1[m]\"\ngeometric = \"h\"")),
        ("reaction in prescribed", format!("{a}{hinge}{b}[[joint]]\nname = \"i\"\nkind = \"revolute\"\nto = \"b\"\n[prescribed]\ni = \"h.fx/1[N]\"")),
        ("accel in force", format!("{a}{hinge}[[force]]\nname = \"f\"\nvalue = \"a.epsilon_z*1[N*m*s^2]\"\ngeometric = \"h\"")),
        ("independent", format!("{a}{hinge}[run]\nindependent = [\"g'\"]")),
        ("gimbal start", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\norientation = \"rpy\"\n[initial]\n\"h.pitch\" = \"90 deg\"")),
        ("orientation word", format!("{a}[[joint]]\nname = \"h\"\nkind = \"spherical\"\nto = \"a\"\norientation = \"euler\"")),
        ("zero quaternion", format!("{a}[initial]\n\"a.qw\" = 0")),
        ("force nothing", format!("{a}[[force]]\nname = \"f\"\non = \"a\"")),
        ("force on and position", format!("{a}[[force]]\nname = \"f\"\non = \"a\"\nforce = [1, 0, 0]\nposition = [0, 0, 0]")),
        ("force axes", format!("{a}[[force]]\nname = \"f\"\non = \"a\"\nforce = [1, 0, 0]\naxes = \"body\"")),
        ("force vector length", format!("{a}[[force]]\nname = \"f\"\non = \"a\"\nforce = [1, 0]")),
        ("gravity unit", format!("{a}[world]\ngravity = [0, 0, \"9.81 m\"]")),
        ("inertia mass of t", format!("[[body]]\nname = \"a\"\nmass = \"t*1[kg/s]\"\ninertia = [1, 1, 1]")),
        ("tensor no spin", "[coordinates]\nx = \"rad\"\n[[inertia]]\nname = \"i\"\ntensor = [1, 1, 1]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("tensor wrong", "[coordinates]\nx = \"rad\"\n[[inertia]]\nname = \"i\"\ntensor = [1, 1, 5]\nspin = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("mass wrong", "[coordinates]\nx = \"m\"\n[[inertia]]\nname = \"i\"\nmass = -1\nvelocity = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("value and mass", "[coordinates]\nx = \"m\"\n[[inertia]]\nname = \"i\"\nmass = 1\nvalue = 1\nvelocity = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
        ("position and velocity", "[coordinates]\nx = \"m\"\n[[inertia]]\nname = \"i\"\nmass = 1\nposition = [0, 0, \"x\"]\nvelocity = [0, 0, \"x'\"]\n[initial]\nx = 0\n\"x'\" = 0".into()),
    ];
    for (name, text) in cases {
        let text = text.clone();
        let result = std::panic::catch_unwind(|| {
            let scene = match headland_model::Scene::parse("s.toml", &text) { Ok(s) => s, Err(e) => return format!("PARSE {e}") };
            let model = match scene.build() { Ok(m) => m, Err(e) => return format!("BUILD {e}") };
            let w: Vec<String> = model.warnings.iter().map(|w| w.message.clone()).collect();
            match derive(&model, &DeriveOptions::default()) {
                Err(e) => format!("DERIVE {e} @ {:?} W {w:?}", e.place(&model).map(|p| model.source.locate(&p))),
                Ok(eq) => match initial_velocities(&model, &eq.kinematics) { Ok(u) => format!("OK u {u:?} W {w:?}"), Err(e) => format!("START {e} W {w:?}") },
            }
        });
        println!("--- {name}: {}", result.unwrap_or_else(|_| "PANIC".into()));
    }
    let _ = read;
}
