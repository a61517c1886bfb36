//! What must not matter: where a machine stands, units, the order of the file, whether a body is one or its structures.
#![allow(non_snake_case)]

mod machine;

use headland_dynamics::{DeriveOptions, derive};
use headland_expr::NodeId;
use headland_spatial::Pose;
use machine::loops::{bricard, four_bar, parallelogram, rssr, slider_crank};
use machine::oracle::distance;
use machine::state::{Derived, Moment, read};
use machine::{Contact, Kind, Machine, PLAIN, Random, Shape, Spring, Style, link, part};

/// Largest relative difference of the accelerations of all bodies, the second machine's turned back.
fn difference(a: &Moment, b: &Moment, x: &Pose<f64>) -> f64 {
    let all = |m: &Moment, turn: &dyn Fn(headland_spatial::Vector<f64>) -> headland_spatial::Vector<f64>| {
        m.bodies.iter().flat_map(|b| b.w_rate.0.into_iter().chain(turn(b.a).0)).collect::<Vec<f64>>()
    };
    distance(&all(a, &|v| v), &all(b, &|v| x.rotation.apply_inverse(v)))
}

fn ball_on_plane(r: &mut Random) -> Machine {
    let mut m = Machine::new("ball");
    m.gravity = (r.vector() * 9.0).0;
    m.parts.push(part(r, "ball"));
    let mut l = link("free", Kind::Free, None, Some(0));
    (l.at, l.to_at) = (r.pose(), r.pose());
    m.links.push(l);
    let (centre, plane, shape) = (r.pose(), r.pose(), Shape::Ellipsoid([0.3, 0.4, 0.5]));
    m.contacts.push(Contact { name: "contact".into(), body: 0, centre, on: None, plane, shape });
    m
}

fn machines(r: &mut Random) -> Vec<Machine> {
    let mut all = vec![four_bar(r), slider_crank(r), rssr(r), parallelogram(r), bricard(r), ball_on_plane(r)];
    for n in [3, 6, 8] {
        let mut m = Machine::tree(r, n);
        m.links.iter_mut().for_each(|l| l.written = true);
        m.links.iter_mut().filter(|l| l.kind == Kind::Free).for_each(|l| l.name = format!("free_{}", l.name));
        all.push(m);
    }
    for m in &mut all {
        let (at, to_at) = (r.vector(), r.vector());
        let (name, to) = ("spring".to_string(), m.parts.len() - 1);
        let values = (30.0, 2.0, 0.2);
        let (stiffness, damping, free_length) = values;
        m.springs.push(Spring { name, from: None, to, at, to_at, stiffness, damping, free_length });
    }
    all
}

#[test]
fn place_units_and_order_do_not_matter() {
    let mut worst = [0.0_f64; 3];
    for seed in 0..2 {
        let mut r = Random(2000 + seed);
        for m in machines(&mut r) {
            let first = Derived::new(&m, &PLAIN);
            let whole = r.pose();
            let small = Style { small_units: true, shuffle: None };
            let shuffled = Style { small_units: true, shuffle: Some(seed + 5) };
            let in_a_loop = m.links.len() > m.parts.len(); // another order cuts it elsewhere
            let mut others = vec![(m.moved(&whole), PLAIN, whole), (m.clone(), small, Pose::identity())];
            if !in_a_loop {
                others.push((m.moved(&whole), shuffled, whole));
            }
            let options = DeriveOptions { compare: false, ..DeriveOptions::default() };
            let states: Vec<Vec<f64>> = (0..2).map(|_| first.state(&mut r, 0.2)).collect();
            for (k, (other, style, x)) in others.iter().enumerate() {
                let second = Derived::with(other, style, &options);
                for state in &states {
                    let a = first.moment(&mut state.clone());
                    let b = second.moment(&mut second.put(&first.values(state)));
                    let found = difference(&a, &b, x);
                    assert!(found < 1e-9, "{}, {k}: {found:e}", m.title);
                    worst[k] = worst[k].max(found);
                }
            }
        }
    }
    println!("moved, other units, moved in other units and order: {worst:?}");
}

/// Components of a text for each entry, for structures written out by hand.
type Text3 = [String; 3];

fn turn(axis: usize, angle: &str, v: &Text3) -> Text3 {
    let (i, j, k) = (axis, (axis + 1) % 3, (axis + 2) % 3);
    let mut w = v.clone();
    w[i] = v[i].clone();
    w[j] = format!("(cos({angle})*({}) - sin({angle})*({}))", v[j], v[k]);
    w[k] = format!("(sin({angle})*({}) + cos({angle})*({}))", v[j], v[k]);
    w
}

fn turn_back(axis: usize, angle: &str, v: &Text3) -> Text3 {
    turn(axis, &format!("-{angle}"), v)
}

fn sum(a: &Text3, b: &Text3) -> Text3 {
    std::array::from_fn(|i| format!("({} + {})", a[i], b[i]))
}

fn metres(v: [f64; 3]) -> Text3 {
    v.map(|x| format!("({x:?})*1[m]"))
}

fn list(v: &Text3) -> String {
    format!("[\"{}\", \"{}\", \"{}\"]", v[0], v[1], v[2])
}

/// M and F of two scenes with the same quasi-velocities at the same places.
fn same(a: &str, b: &str, states: usize) -> f64 {
    let [a, b] = [a, b].map(|text| read(text).build().unwrap_or_else(|e| panic!("{e}\n{text}")));
    let [ea, eb] = [&a, &b].map(|m| derive(m, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{e}")));
    let n = ea.kinematics.quasi.len();
    assert_eq!((n, a.coordinates.len()), (eb.kinematics.quasi.len(), b.coordinates.len()));
    let (mut r, mut worst) = (Random(5), 0.0_f64);
    for _ in 0..states {
        let (q, u) = (r.numbers(a.coordinates.len()), r.numbers(n));
        let at = |m: &headland_model::Model, e: &headland_dynamics::Equations| {
            let mut x = m.inputs();
            m.coordinates.iter().zip(&q).for_each(|(c, q)| x[m.input_index(c.q)] = *q);
            e.kinematics.quasi.iter().zip(&u).for_each(|(k, u)| x[m.input_index(k.u)] = *u);
            let both = |nodes: &[NodeId]| m.graph.eval(nodes, &x);
            (both(&e.mass), both(&e.force))
        };
        let ((ma, fa), (mb, fb)) = (at(&a, &ea), at(&b, &eb));
        worst = worst.max(distance(&ma, &mb)).max(distance(&fa, &fb));
    }
    assert!(worst < 1e-12, "{}: {worst:e}", a.title);
    worst
}

/// A body on a universal joint, another hinged to it, with loads: as bodies and written out.
#[test]
fn positions_and_spins_are_bodies() {
    let (c1, c2, hinge, point) = ([0.3, -0.2, 0.5], [0.1, 0.4, -0.3], [0.2, 0.7, 0.1], [0.5, -0.1, 0.2]);
    let tensors = ["[2.1, 2.5, 1.9, 0.2, -0.1, 0.3]", "[1.4, 1.1, 1.6, -0.2, 0.1, 0.05]"];
    let bodies = format!(
        "title = \"bodies\"\n[world]\ngravity = [1, 2, -9]\n\
         [[body]]\nname = \"one\"\nmass = 3\ncenter = {c1:?}\ninertia = {0}\n\
         [[body]]\nname = \"two\"\nmass = 2\ncenter = {c2:?}\ninertia = {1}\n\
         [[joint]]\nname = \"u\"\nkind = \"universal\"\nto = \"one\"\n\
         [[joint]]\nname = \"h\"\nkind = \"revolute\"\nfrom = \"one\"\nto = \"two\"\nat = {hinge:?}\n\
         [[force]]\nname = \"push\"\non = \"two\"\nat = {point:?}\nforce = [3, -1, 2]\n\
         [[force]]\nname = \"twist\"\non = \"two\"\naxes = \"frame\"\ntorque = [0.5, 1.5, -0.7]\n",
        tensors[0], tensors[1]
    );
    let out = |v: &Text3| turn(0, "a", &turn(1, "b", v));
    let behind = |v: [f64; 3]| out(&sum(&metres(hinge), &turn(2, "c", &metres(v))));
    let w1 = ["a'*cos(b)".to_string(), "b'".to_string(), "a'*sin(b)".to_string()];
    let w2 = sum(&turn_back(2, "c", &w1), &["0*c'".to_string(), "0*c'".to_string(), "c'".to_string()]);
    let weight = |m: f64| list(&[m, 2.0 * m, -9.0 * m].map(|x| format!("{x:?}")));
    let places = [out(&metres(c1)), behind(c2), behind(point)].map(|p| list(&p));
    let elements = format!(
        "title = \"structures\"\n[coordinates]\na = \"rad\"\nb = \"rad\"\nc = \"rad\"\n\
         [[inertia]]\nname = \"one\"\nmass = 3\nposition = {0}\ntensor = {3}\nspin = {5}\n\
         [[inertia]]\nname = \"two\"\nmass = 2\nposition = {1}\n\
         [[inertia]]\nname = \"two turns\"\ntensor = {4}\nspin = {6}\n\
         [[force]]\nname = \"weight one\"\nforce = {7}\nposition = {0}\n\
         [[force]]\nname = \"weight two\"\nforce = {8}\nposition = {1}\n\
         [[force]]\nname = \"push\"\nforce = [3, -1, 2]\nposition = {2}\n\
         [[force]]\nname = \"twist\"\ntorque = [0.5, 1.5, -0.7]\nspin = {6}\n\
         [initial]\na = 0\nb = 0\nc = 0\n\"a'\" = 0\n\"b'\" = 0\n\"c'\" = 0\n",
        places[0],
        places[1],
        places[2],
        tensors[0],
        tensors[1],
        list(&w1),
        list(&w2),
        weight(3.0),
        weight(2.0)
    );
    println!("{:e}", same(&bodies, &elements, 20));
}

/// A free body, and the same by quasi-velocities of its own: velocity of the centre in the world, spin in body axes.
#[test]
fn velocities_and_spins_are_bodies() {
    let tensor = "[2.1, 2.5, 1.9, 0.2, -0.1, 0.3]";
    let body = format!(
        "title = \"body\"\n[world]\ngravity = [1, 2, -9]\n[[body]]\nname = \"b\"\nmass = 3\ninertia = {tensor}\n\
         [[force]]\nname = \"twist\"\non = \"b\"\naxes = \"frame\"\ntorque = [0.5, 1.5, -0.7]\n"
    );
    let elements = format!(
        "title = \"quasi\"\n[coordinates]\nx = \"m\"\ny = \"m\"\nz = \"m\"\nqw = \"1\"\nqx = \"1\"\nqy = \"1\"\nqz = \"1\"\n\
         [quasi_velocities]\nwx = \"rad/s\"\nwy = \"rad/s\"\nwz = \"rad/s\"\nvx = \"m/s\"\nvy = \"m/s\"\nvz = \"m/s\"\n\
         [kinematics]\n\"x'\" = \"vx\"\n\"y'\" = \"vy\"\n\"z'\" = \"vz\"\n\
         \"qw'\" = \"-(qx*wx + qy*wy + qz*wz)/2\"\n\"qx'\" = \"(qw*wx + qy*wz - qz*wy)/2\"\n\
         \"qy'\" = \"(qw*wy + qz*wx - qx*wz)/2\"\n\"qz'\" = \"(qw*wz + qx*wy - qy*wx)/2\"\n\
         [[inertia]]\nname = \"b\"\nmass = 3\nvelocity = [\"vx\", \"vy\", \"vz\"]\ntensor = {tensor}\n\
         spin = [\"wx\", \"wy\", \"wz\"]\n\
         [[force]]\nname = \"weight\"\nforce = [3, 6, -27]\nvelocity = [\"vx\", \"vy\", \"vz\"]\n\
         [[force]]\nname = \"twist\"\ntorque = [0.5, 1.5, -0.7]\nspin = [\"wx\", \"wy\", \"wz\"]\n\
         [initial]\nx = 0\ny = 0\nz = 0\nqw = 1\nqx = 0\nqy = 0\nqz = 0\n\
         vx = 0\nvy = 0\nvz = 0\nwx = 0\nwy = 0\nwz = 0\n"
    );
    println!("{:e}", same(&body, &elements, 20));
}
