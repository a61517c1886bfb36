//! Rolling on fixed, tilted and moving planes, knife edges, against Newton and Euler with unknown contact forces.
#![allow(non_snake_case)]

mod machine;

use headland_spatial::{Pose, Rotation, Vector};
use machine::oracle::check;
use machine::state::{Derived, read};
use machine::{Contact, Edge, Kind, Link, Machine, PLAIN, Random, Shape, Spring, link, part};

fn shapes(r: &mut Random) -> [Shape; 4] {
    let axis = r.vector().unit();
    [
        Shape::Ball(0.4),
        Shape::Disc { axis, radius: 0.5, tube: 0.0 },
        Shape::Disc { axis, radius: 0.5, tube: 0.1 },
        Shape::Ellipsoid([0.3, 0.5, 0.4]),
    ]
}

/// A body on a plane that stands, is tilted, moves as given, or moves freely.
fn roller(r: &mut Random, shape: Shape, ground: usize) -> Machine {
    let mut m = Machine::new(&format!("{shape:?} on {ground}"));
    m.gravity = (r.vector() * 9.0).0;
    m.forces = true;
    m.parts.push(part(r, "wheel"));
    m.links.push(Link { written: false, ..link("wheel", Kind::Free, None, Some(0)) });
    let mut on = None;
    if ground >= 2 {
        m.parts.push(part(r, "ground"));
        on = Some(1);
        let kind = [Kind::Revolute, Kind::Cylindrical, Kind::Planar][r.below(3)];
        let mut l = link("table", kind, None, on);
        (l.at, l.to_at) = (r.pose(), r.pose());
        if kind != Kind::Planar {
            l.axis = r.vector().unit();
        }
        l.drive = (ground == 2).then_some((0.3, 1.2));
        m.links.push(l);
    }
    // the shape stands so that a disc does not lie flat at the start
    let normal = match shape {
        Shape::Disc { axis, .. } => axis.cross(r.vector()).unit(),
        _ => Vector([0.0, 0.0, 1.0]),
    };
    let plane = if ground == 0 { Pose::identity() } else { r.pose() };
    let centre = match shape {
        // axes of an ellipsoid and of a disc are those of `rpy`
        Shape::Ball(_) => Pose::at(r.vector() * 0.3),
        _ => Pose::new(turn_to(normal), r.vector() * 0.3),
    };
    m.contacts.push(Contact { name: "contact".into(), body: 0, centre, on, plane, shape });
    m
}

/// A rotation whose inverse takes z to the given direction.
fn turn_to(n: Vector<f64>) -> Rotation<f64> {
    machine::loops::frame(Vector::zero(), n).rotation.transpose()
}

#[test]
fn what_rolls_agrees_with_newton_and_euler() {
    let mut worst = (0.0_f64, 0.0_f64);
    for seed in 0..3 {
        for ground in 0..4 {
            let mut r = Random(800 + 10 * seed + ground as u64);
            for shape in shapes(&mut r) {
                let m = roller(&mut r, shape, ground);
                let d = Derived::new(&m, &PLAIN);
                for _ in 0..2 {
                    let mut x = d.state(&mut r, 0.3);
                    let moment = d.moment(&mut x);
                    let (a, f) = check(&m, &moment, 1e-10);
                    worst = (worst.0.max(a), worst.1.max(f));
                }
            }
        }
    }
    println!("{worst:?}");
}

/// Two wheels on an axle with a body, a knife edge, springs: a vehicle on a tilted plane.
#[test]
fn vehicles_agree_with_newton_and_euler() {
    for seed in 0..6 {
        let mut r = Random(60 + seed);
        let mut m = Machine::new("cart");
        m.gravity = [1.0, 2.0, -9.0];
        m.forces = true;
        let plane = Pose::new(Rotation::from_roll_pitch_yaw(0.1, -0.2, 0.3), Vector([0.1, 0.2, 0.3]));
        m.parts = vec![part(&mut r, "frame"), part(&mut r, "left"), part(&mut r, "right")];
        m.links.push(Link { written: false, ..link("frame", Kind::Free, None, Some(0)) });
        for (k, side) in [(1, 0.6), (2, -0.6)] {
            let name = ["", "left axle", "right axle"][k].replace(' ', "_");
            let mut l = link(&name, Kind::Revolute, Some(0), Some(k));
            l.axis = Vector([0.0, 1.0, 0.0]);
            l.at = Pose::at(Vector([0.0, side, 0.0]));
            l.spring = (seed % 2 == 0).then_some(3.0);
            m.links.push(l);
            let shape =
                Shape::Disc { axis: Vector([0.0, 1.0, 0.0]), radius: 0.4, tube: if seed < 3 { 0.0 } else { 0.05 } };
            m.contacts.push(Contact {
                name: format!("c{k}"),
                body: k,
                centre: Pose::identity(),
                on: None,
                plane,
                shape,
            });
        }
        if seed >= 3 {
            // rests on a slider without friction in front: a knife edge beside the wheels' own is redundant
            m.springs.push(Spring {
                name: "nose".into(),
                from: None,
                to: 0,
                at: Vector([1.0, 0.0, -1.0]),
                to_at: Vector([0.8, 0.0, 0.0]),
                stiffness: 40.0,
                damping: 2.0,
                free_length: 0.5,
            });
        }
        let d = Derived::new(&m, &PLAIN);
        for _ in 0..3 {
            let mut x = d.state(&mut r, 0.2);
            let moment = d.moment(&mut x);
            check(&m, &moment, 1e-10);
        }
    }
}

#[test]
fn edges_agree_with_newton_and_euler() {
    for seed in 0..6 {
        let mut r = Random(30 + seed);
        let mut m = Machine::new("skates");
        m.gravity = r.vector().0;
        m.forces = true;
        m.parts = vec![part(&mut r, "front"), part(&mut r, "rear")];
        m.links.push(Link {
            rpy: true,
            ..link("base", if seed % 2 == 0 { Kind::Planar } else { Kind::Free }, None, Some(0))
        });
        let mut l = link("hitch", Kind::Revolute, Some(0), Some(1));
        (l.at, l.to_at) = (Pose::at(Vector([-0.5, 0.1, 0.0])), Pose::at(Vector([0.6, 0.0, 0.1])));
        m.links.push(l);
        for (body, name) in [(0, "bow"), (1, "stern")] {
            let at =
                Pose::new(Rotation::from_roll_pitch_yaw(0.0, 0.0, r.number()), Vector([r.number(), r.number(), 0.0]));
            m.edges.push(Edge { name: name.into(), body, at, side: Vector([0.0, 1.0, 0.0]) });
        }
        let d = Derived::new(&m, &PLAIN);
        for _ in 0..3 {
            let mut x = d.state(&mut r, 0.5);
            let moment = d.moment(&mut x);
            check(&m, &moment, 1e-10);
        }
    }
}

/// A body that rolls on itself, a form that is none.
#[test]
fn what_cannot_roll_is_told() {
    let start = "[[body]]\nname = \"a\"\nmass = 1\ninertia = [1, 1, 1]\n[[frame]]\nname = \"f\"\non = \"a\"\n";
    for (rolling, expected) in [
        ("body = \"a\"\non = \"f\"\nradius = 1", "rolls on the body that it belongs to"),
        ("body = \"a\"", "needs `radius`"),
        ("body = \"a\"\naxis = \"y\"", "needs `radius`"),
        ("body = \"a\"\nradius = 1\nheight = 2", "`height` means nothing here: it belongs to `surface = \"height\"`"),
        ("body = \"a\"\nradius = 1\nsurface = \"height\"", "needs `height`: z by `c.s` and `c.t`"),
        ("body = \"a\"\nradius = 1\nsurface = \"height\"\nheight = \"c.s + a.x\"", "`height` depends on `a.x`"),
        ("body = \"a\"\nradius = 1\nsurface = \"height\"\nheight = \"c.s*sin(t/1[s])\"", "`height` depends on `t`"),
        ("body = \"a\"\nradius = 1\nsurface_radius = 2", "`surface_radius` means nothing here"),
        ("body = \"a\"\nradius = 1\noutside = true", "`outside` means nothing here"),
        ("body = \"a\"\nradius = 1\naxis = \"y\"\ntube = 1", "`radius` goes to the middle of the rim's section"),
        ("body = \"a\"\nradius = 1\naxis = \"y\"\ntube = -0.1", "`tube` is -0.1 m; it must be at least 0"),
        ("body = \"a\"\nradius = 1\naxis = \"z\"", "lies flat at the start"),
        ("body = \"a\"\nradius = 1\naxis = \"z\"\nsurface = \"height\"\nheight = \"0*c.s\"", "lies flat at the start"),
        ("body = \"a\"\nradius = 1\naxis = \"y\"\nsurface = \"sphere\"", "needs `surface_radius`"),
        (
            "body = \"a\"\nradius = 1\naxis = \"y\"\nsurface = \"sphere\"\nsurface_radius = 0.5",
            "does not fit into a sphere of 0.5 m",
        ),
        (
            "body = \"a\"\nradius = 1\naxis = \"y\"\nsurface = \"sphere\"\nsurface_radius = -2",
            "`surface_radius` is -2 m",
        ),
        ("body = \"a\"\nradius = 1\naxis = \"y\"\nsurface = \"bowl\"", "`surface` is \"plane\""),
        (
            "body = \"a\"\non = \"ramp\"\nradius = 1\nsurface = \"sphere\"\nsurface_radius = 3\n[[surface]]\nname = \"ramp\"\nshape = \"plane\"",
            "`surface` means nothing here: the ground is the surface `ramp`",
        ),
        ("body = \"a\"\non = \"road\"\nradius = 1", "`road` is undefined, not a body or frame"),
    ] {
        let text = format!("{start}[[rolling]]\nname = \"c\"\n{rolling}\n");
        let Err(error) = read(&text).build() else { panic!("{text}") };
        assert!(error.to_string().contains(expected), "{error}");
    }
}
