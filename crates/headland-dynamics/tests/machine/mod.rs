//! Machines of bodies and joints as plain data: written as a scene, and as numbers for the oracle of `oracle.rs`.
#![allow(non_snake_case, dead_code)]

pub mod loops;
pub mod oracle;
pub mod state;
#[path = "../trees/mod.rs"]
pub mod trees;

use std::fmt::Write;

use headland_expr::Scalar;
use headland_spatial::{Axis, Pose, Quaternion, Rotation, Symmetric, Vector};
pub use trees::Random;

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Part {
    pub name: String,
    pub mass: f64,
    pub centre: Vector<f64>,
    /// About the centre.
    pub tensor: Symmetric<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    Weld,
    Revolute,
    Prismatic,
    Screw,
    Cylindrical,
    Universal,
    Planar,
    Spherical,
    Free,
}

impl Kind {
    pub const ALL: [Kind; 9] = [
        Kind::Weld,
        Kind::Revolute,
        Kind::Prismatic,
        Kind::Screw,
        Kind::Cylindrical,
        Kind::Universal,
        Kind::Planar,
        Kind::Spherical,
        Kind::Free,
    ];

    pub fn word(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    fn has_axis(self) -> bool {
        matches!(self, Kind::Revolute | Kind::Prismatic | Kind::Screw | Kind::Cylindrical)
    }
}

/// A joint; `None` is the world.
#[derive(Clone, Debug)]
pub struct Link {
    pub name: String,
    pub kind: Kind,
    pub from: Option<usize>,
    pub to: Option<usize>,
    /// `X_from,A`
    pub at: Pose<f64>,
    /// `X_to,B`
    pub to_at: Pose<f64>,
    pub axis: Vector<f64>,
    /// Advance a turn.
    pub lead: f64,
    pub rpy: bool,
    pub cut: bool,
    /// All coordinates are `a sin(b t + k)`, k their number.
    pub drive: Option<(f64, f64)>,
    /// Stiffness on the only coordinate.
    pub spring: Option<f64>,
    /// Frames on frames between the bodies and the joint's ends.
    pub frames: Option<[Pose<f64>; 2]>,
    /// False for a body's own freedom, of which the scene says nothing.
    pub written: bool,
}

/// What rolls.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Ball(f64),
    Disc { axis: Vector<f64>, radius: f64, tube: f64 },
    Ellipsoid([f64; 3]),
}

#[derive(Clone, Debug)]
pub struct Contact {
    pub name: String,
    pub body: usize,
    pub centre: Pose<f64>,
    pub on: Option<usize>,
    /// Plane on `on`; a `[[frame]]` of its own.
    pub plane: Pose<f64>,
    pub shape: Shape,
}

/// A knife edge.
#[derive(Clone, Debug)]
pub struct Edge {
    pub name: String,
    pub body: usize,
    pub at: Pose<f64>,
    pub side: Vector<f64>,
}

/// A spring and damper between two points.
#[derive(Clone, Debug)]
pub struct Spring {
    pub name: String,
    pub from: Option<usize>,
    pub to: usize,
    pub at: Vector<f64>,
    pub to_at: Vector<f64>,
    pub stiffness: f64,
    pub damping: f64,
    pub free_length: f64,
}

/// A constant force at a point with a torque.
#[derive(Clone, Debug)]
pub struct Push {
    pub name: String,
    pub on: usize,
    pub at: Vector<f64>,
    pub force: Vector<f64>,
    pub torque: Vector<f64>,
    pub own_axes: bool,
}

#[derive(Clone, Debug, Default)]
pub struct Machine {
    pub title: String,
    pub parts: Vec<Part>,
    pub links: Vec<Link>,
    pub contacts: Vec<Contact>,
    pub edges: Vec<Edge>,
    pub springs: Vec<Spring>,
    pub pushes: Vec<Push>,
    pub gravity: [f64; 3],
    /// Whether outputs ask for the forces of joints and contacts.
    pub forces: bool,
}

/// Random physical body: four points of mass.
pub fn part(r: &mut Random, name: &str) -> Part {
    let inertia = r.inertia();
    Part { name: name.into(), mass: inertia.mass, centre: inertia.centre, tensor: inertia.tensor }
}

pub fn link(name: &str, kind: Kind, from: Option<usize>, to: Option<usize>) -> Link {
    Link {
        name: name.into(),
        kind,
        from,
        to,
        at: Pose::identity(),
        to_at: Pose::identity(),
        axis: Vector([0.0, 0.0, 1.0]),
        lead: 0.0,
        rpy: false,
        cut: false,
        drive: None,
        spring: None,
        frames: None,
        written: true,
    }
}

/// A link with random places, axis, lead, orientation; sometimes with frames in between.
pub fn random_link(r: &mut Random, name: &str, kind: Kind, from: Option<usize>, to: Option<usize>) -> Link {
    let axis = match r.below(3) {
        0 => Vector([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][r.below(3)]) * [1.0, -1.0][r.below(2)],
        _ => r.vector().unit(),
    };
    let place = |r: &mut Random| match r.below(4) {
        0 => Pose::identity(),
        1 => Pose::at(r.vector()),
        _ => r.pose(),
    };
    Link {
        at: place(r),
        to_at: place(r),
        axis: if kind.has_axis() { axis } else { Vector([0.0, 0.0, 1.0]) },
        lead: 0.5 + r.number(),
        rpy: r.below(3) == 0,
        frames: (r.below(4) == 0).then(|| [r.pose(), r.pose()]),
        ..link(name, kind, from, to)
    }
}

impl Machine {
    pub fn new(title: &str) -> Self {
        Self { title: title.into(), gravity: [0.0; 3], ..Self::default() }
    }

    /// `n` bodies with random joints of all kinds, each on an earlier one or on the world; some joints reversed.
    pub fn tree(r: &mut Random, n: usize) -> Self {
        let mut m = Self::new("tree");
        m.gravity = (r.vector() * 9.0).0;
        for b in 0..n {
            let body = part(r, &format!("b{b}"));
            m.parts.push(body);
            let parent = if b == 0 || r.below(8) == 0 { None } else { Some(r.below(b)) };
            if parent.is_none() && r.below(3) == 0 {
                let free = Link { written: false, ..link(&format!("b{b}"), Kind::Free, None, Some(b)) };
                m.links.push(free);
                continue;
            }
            let mut kind = Kind::ALL[r.below(9)];
            if kind == Kind::Weld && r.below(2) == 0 {
                kind = Kind::Revolute;
            }
            let (from, to) = if r.below(3) == 0 { (Some(b), parent) } else { (parent, Some(b)) };
            m.links.push(random_link(r, &format!("j{b}"), kind, from, to));
        }
        m
    }

    /// The same machine elsewhere, gravity turned with it.
    pub fn moved(&self, x: &Pose<f64>) -> Self {
        let mut m = self.clone();
        m.gravity = (x.rotation * Vector(m.gravity)).0;
        for l in &mut m.links {
            if l.from.is_none() {
                l.at = *x * l.at;
            }
            if l.to.is_none() {
                l.to_at = *x * l.to_at;
            }
        }
        m.contacts.iter_mut().filter(|c| c.on.is_none()).for_each(|c| c.plane = *x * c.plane);
        m.springs.iter_mut().filter(|s| s.from.is_none()).for_each(|s| s.at = x.point(s.at));
        for p in m.pushes.iter_mut().filter(|p| !p.own_axes) {
            (p.force, p.torque) = (x.rotation * p.force, x.rotation * p.torque);
        }
        m
    }

    pub fn name(&self, body: Option<usize>) -> &str {
        body.map_or("world", |b| &self.parts[b].name)
    }

    pub fn link(&self, name: &str) -> &Link {
        self.links.iter().find(|l| l.name == name).unwrap_or_else(|| panic!("no link {name}"))
    }
}

/// Coordinates of a link, by the ends of their names.
pub fn coordinates(l: &Link) -> Vec<String> {
    let turns: &[&str] = if l.rpy { &["roll", "pitch", "yaw"] } else { &["qw", "qx", "qy", "qz"] };
    let parts: Vec<&str> = match l.kind {
        Kind::Weld => vec![],
        Kind::Revolute | Kind::Prismatic | Kind::Screw => vec![""],
        Kind::Cylindrical => vec!["angle", "slide"],
        Kind::Universal => vec!["a", "b"],
        Kind::Planar => vec!["x", "y", "angle"],
        Kind::Spherical => turns.to_vec(),
        Kind::Free => ["x", "y", "z"].iter().chain(turns).copied().collect(),
    };
    let full = |p: &str| if p.is_empty() { l.name.clone() } else { format!("{}.{p}", l.name) };
    parts.into_iter().map(full).collect()
}

fn lift<S: Scalar>(x: Vector<f64>) -> Vector<S> {
    Vector(x.0.map(S::constant))
}

pub fn lift_pose<S: Scalar>(x: &Pose<f64>) -> Pose<S> {
    Pose::new(Rotation(x.rotation.0.map(|row| row.map(S::constant))), lift(x.position))
}

/// `X_AB` by the coordinates, in their order.
pub fn joint_pose<S: Scalar>(l: &Link, q: &[S]) -> Pose<S> {
    let zero = S::constant(0.0);
    let (turn, slide) = (
        |axis: Vector<f64>, angle: S| Pose::new(Rotation::about_unit(lift(axis), angle), Vector::zero()),
        |axis: Vector<f64>, way: S| Pose::at(lift(axis) * way),
    );
    let orientation = |q: &[S]| {
        let rotation = match l.rpy {
            true => {
                let about = |a, x| Rotation::about(a, x);
                about(Axis::Z, q[2]) * about(Axis::Y, q[1]) * about(Axis::X, q[0])
            }
            false => {
                let quaternion = Quaternion([q[0], q[1], q[2], q[3]]);
                Quaternion(quaternion.0.map(|x| x / quaternion.norm())).rotation()
            }
        };
        Pose::new(rotation, Vector::zero())
    };
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector);
    match l.kind {
        Kind::Weld => Pose::identity(),
        Kind::Revolute => turn(l.axis, q[0]),
        Kind::Prismatic => slide(l.axis, q[0]),
        Kind::Screw => turn(l.axis, q[0]) * slide(l.axis, q[0] * S::constant(l.lead / std::f64::consts::TAU)),
        Kind::Cylindrical => turn(l.axis, q[0]) * slide(l.axis, q[1]),
        Kind::Universal => turn(x, q[0]) * turn(y, q[1]),
        Kind::Planar => Pose::at(Vector([q[0], q[1], zero])) * turn(z, q[2]),
        Kind::Spherical => orientation(q),
        Kind::Free => Pose::at(Vector([q[0], q[1], q[2]])) * orientation(&q[3..]),
    }
}

/// The value of a driven coordinate.
pub fn driven<S: Scalar>(l: &Link, t: S) -> Vec<S> {
    let (a, b) = l.drive.unwrap_or_default();
    let of = |k: usize| S::constant(a) * (S::constant(b) * t + S::constant(k as f64)).sin();
    (0..coordinates(l).len()).map(of).collect()
}

/// How a scene is written.
#[derive(Clone, Debug)]
pub struct Style {
    /// Millimetres, grams and degrees.
    pub small_units: bool,
    /// Bodies and joints in another order.
    pub shuffle: Option<u64>,
}

pub const PLAIN: Style = Style { small_units: false, shuffle: None };

impl Style {
    fn number(&self, x: f64, small: f64, unit: &str) -> String {
        if self.small_units { format!("\"{:?} {unit}\"", x * small) } else { format!("{x:?}") }
    }
    fn length(&self, x: f64) -> String {
        self.number(x, 1e3, "mm")
    }
    fn list(&self, x: &[f64], small: f64, unit: &str) -> String {
        let items: Vec<String> = x.iter().map(|x| self.number(*x, small, unit)).collect();
        format!("[{}]", items.join(", "))
    }
    fn lengths(&self, v: Vector<f64>) -> String {
        self.list(&v.0, 1e3, "mm")
    }
    fn turns(&self, r: &Rotation<f64>) -> String {
        let (roll, pitch, yaw) = r.roll_pitch_yaw();
        self.list(&[roll, pitch, yaw], 180.0 / std::f64::consts::PI, "deg")
    }
    fn order(&self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        if let Some(seed) = self.shuffle {
            let mut r = Random(seed);
            (1..n).rev().for_each(|i| order.swap(i, r.below(i + 1)));
        }
        order
    }
}

fn plain(v: Vector<f64>) -> String {
    format!("[{:?}, {:?}, {:?}]", v[0], v[1], v[2])
}

impl Machine {
    /// The scene as text; outputs are what `state.rs` reads.
    pub fn text(&self, style: &Style) -> String {
        let mut s = format!("title = \"{}\"\n", self.title);
        let _ = writeln!(s, "[world]\ngravity = {}", style.list(&self.gravity, 1e3, "mm/s^2"));
        for i in style.order(self.parts.len()) {
            let p = &self.parts[i];
            let _ = writeln!(s, "[[body]]\nname = \"{}\"\nmass = {}", p.name, style.number(p.mass, 1e3, "g"));
            let _ = writeln!(s, "center = {}", style.lengths(p.centre));
            let _ = writeln!(s, "inertia = {}", style.list(&p.tensor.0, 1e9, "g*mm^2"));
        }
        for i in style.order(self.links.len()) {
            self.write_link(&mut s, &self.links[i], style);
        }
        for c in &self.contacts {
            self.write_contact(&mut s, c, style);
        }
        for e in &self.edges {
            let (at, rpy) = (style.lengths(e.at.position), style.turns(&e.at.rotation));
            let _ = writeln!(s, "[[skate]]\nname = \"{}\"\non = \"{}\"", e.name, self.parts[e.body].name);
            let _ = writeln!(s, "at = {at}\nrpy = {rpy}\nside = {}", plain(e.side));
        }
        for p in &self.springs {
            let (from, to) = (self.name(p.from), &self.parts[p.to].name);
            let _ = writeln!(s, "[[spring]]\nname = \"{}\"\nfrom = \"{from}\"\nto = \"{to}\"", p.name);
            let _ = writeln!(s, "at = {}\nto_at = {}", style.lengths(p.at), style.lengths(p.to_at));
            let _ = writeln!(s, "stiffness = {:?}\ndamping = {:?}", p.stiffness, p.damping);
            let _ = writeln!(s, "free_length = {}", style.length(p.free_length));
        }
        for p in &self.pushes {
            let _ = writeln!(s, "[[force]]\nname = \"{}\"\non = \"{}\"", p.name, self.parts[p.on].name);
            let _ =
                writeln!(s, "at = {}\naxes = \"{}\"", style.lengths(p.at), if p.own_axes { "frame" } else { "world" });
            let _ = writeln!(s, "force = {}\ntorque = {}", plain(p.force), plain(p.torque));
        }
        let driven: Vec<&Link> = self.links.iter().filter(|l| l.drive.is_some()).collect();
        if !driven.is_empty() {
            s.push_str("[prescribed]\n");
        }
        for l in driven {
            let (a, b) = l.drive.unwrap_or_default();
            for (k, name) in coordinates(l).iter().enumerate() {
                let _ = writeln!(s, "\"{name}\" = \"{a:?}*sin({b:?}*t + {k})\"");
            }
        }
        for l in self.links.iter().filter(|l| l.spring.is_some()) {
            let c = l.spring.unwrap_or_default();
            let _ = writeln!(s, "[[elastic]]\nname = \"c {0}\"\nvalue = {c:?}\ngeometric = \"{0}\"", l.name);
        }
        let columns: Vec<String> = self.columns().iter().map(|c| format!("\"{c}\"")).collect();
        let _ = writeln!(s, "[outputs]\ncolumns = [{}]", columns.join(", "));
        s
    }

    fn write_link(&self, s: &mut String, l: &Link, style: &Style) {
        if !l.written {
            return;
        }
        let mut ends = Vec::new();
        for (k, (body, pose)) in [(l.from, l.at), (l.to, l.to_at)].into_iter().enumerate() {
            let name = self.name(body).to_string();
            let Some([first, second]) = l.frames.filter(|_| body.is_some()) else {
                ends.push((name, pose));
                continue;
            };
            let frame = |i: usize| format!("f{i}_{k}_{}", l.name);
            for (i, (on, x)) in [(name, first), (frame(0), second)].into_iter().enumerate() {
                let _ = writeln!(s, "[[frame]]\nname = \"{}\"\non = \"{on}\"", frame(i));
                let _ = writeln!(s, "at = {}\nrpy = {}", style.lengths(x.position), style.turns(&x.rotation));
            }
            ends.push((frame(1), (first * second).inverse() * pose));
        }
        let _ = writeln!(s, "[[joint]]\nname = \"{}\"\nkind = \"{}\"", l.name, l.kind.word());
        let _ = writeln!(s, "from = \"{}\"\nto = \"{}\"", ends[0].0, ends[1].0);
        for ((at, rpy), (_, x)) in [("at", "rpy"), ("to_at", "to_rpy")].into_iter().zip(&ends) {
            let _ = writeln!(s, "{at} = {}\n{rpy} = {}", style.lengths(x.position), style.turns(&x.rotation));
        }
        if l.kind.has_axis() {
            let _ = writeln!(s, "axis = {}", plain(l.axis * 2.0));
        }
        if l.kind == Kind::Screw {
            let _ = writeln!(s, "lead = {}", style.length(l.lead));
        }
        if l.rpy && matches!(l.kind, Kind::Spherical | Kind::Free) {
            let _ = writeln!(s, "orientation = \"rpy\"");
        }
        if l.cut {
            let _ = writeln!(s, "cut = true");
        }
    }

    fn write_contact(&self, s: &mut String, c: &Contact, style: &Style) {
        let _ = writeln!(s, "[[frame]]\nname = \"plane_{}\"\non = \"{}\"", c.name, self.name(c.on));
        let _ = writeln!(s, "at = {}\nrpy = {}", style.lengths(c.plane.position), style.turns(&c.plane.rotation));
        let _ = writeln!(
            s,
            "[[rolling]]\nname = \"{0}\"\non = \"plane_{0}\"\nbody = \"{1}\"",
            c.name, self.parts[c.body].name
        );
        let _ = writeln!(s, "center = {}\nrpy = {}", style.lengths(c.centre.position), style.turns(&c.centre.rotation));
        let _ = match c.shape {
            Shape::Ball(radius) => writeln!(s, "radius = {}", style.length(radius)),
            Shape::Disc { axis, radius, tube } => {
                let (radius, tube) = (style.length(radius), style.length(tube));
                writeln!(s, "radius = {radius}\ntube = {tube}\naxis = {}", plain(axis * 3.0))
            }
            Shape::Ellipsoid(a) => writeln!(s, "semi_axes = {}", style.lengths(Vector(a))),
        };
    }

    /// Names of the outputs: 24 a body, then forces.
    pub fn columns(&self) -> Vec<String> {
        let mut names = Vec::new();
        for p in &self.parts {
            for part in MOTION {
                names.push(format!("{}.{part}", p.name));
            }
        }
        for l in self.links.iter().filter(|l| self.forces && l.written) {
            names.extend(["fx", "fy", "fz", "tx", "ty", "tz"].map(|c| format!("{}.{c}", l.name)));
        }
        for c in self.contacts.iter().filter(|_| self.forces) {
            names.extend(["fx", "fy", "fz"].map(|f| format!("{}.{f}", c.name)));
        }
        names.extend(self.edges.iter().filter(|_| self.forces).map(|e| format!("{}.force", e.name)));
        names
    }
}

/// What is read of a body.
pub const MOTION: [&str; 24] = [
    "x",
    "y",
    "z",
    "exx",
    "eyx",
    "ezx",
    "exy",
    "eyy",
    "ezy",
    "exz",
    "eyz",
    "ezz",
    "wx",
    "wy",
    "wz",
    "vx",
    "vy",
    "vz",
    "epsilon_x",
    "epsilon_y",
    "epsilon_z",
    "ax",
    "ay",
    "az",
];
