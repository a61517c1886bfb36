//! Machines with closed loops. Bodies lie anywhere in a machine that is assembled when all coordinates are zero.

use headland_spatial::{Pose, Rotation, Vector};

use super::{Kind, Link, Machine, Random, link, part};

/// Bodies at random poses; joints by their frames in the world at the start.
pub struct Assembled {
    pub machine: Machine,
    pub poses: Vec<Pose<f64>>,
}

impl Assembled {
    pub fn new(r: &mut Random, title: &str, bodies: usize) -> Self {
        let mut machine = Machine::new(title);
        machine.gravity = (r.vector() * 9.0).0;
        machine.parts = (0..bodies).map(|b| part(r, &format!("b{b}"))).collect();
        let poses = (0..bodies).map(|_| r.pose()).collect();
        Self { machine, poses }
    }

    /// A joint whose frames fall together at the given place.
    pub fn join(&mut self, kind: Kind, from: Option<usize>, to: Option<usize>, place: &Pose<f64>) -> &mut Link {
        let on = |body: Option<usize>| body.map_or(*place, |b| self.poses[b].inverse() * *place);
        let name = format!("j{}", self.machine.links.len());
        let l = Link { at: on(from), to_at: on(to), ..link(&name, kind, from, to) };
        self.machine.links.push(l);
        let last = self.machine.links.len() - 1;
        &mut self.machine.links[last]
    }
}

/// The frame at a point with z along the axis.
pub fn frame(p: Vector<f64>, z: Vector<f64>) -> Pose<f64> {
    let z = z.unit();
    let k = (0..3).min_by(|&i, &j| z[i].abs().total_cmp(&z[j].abs())).unwrap_or(0);
    let x = z.cross(Vector(std::array::from_fn(|i| f64::from(u8::from(i == k))))).unit();
    let y = z.cross(x);
    Pose::new(Rotation(std::array::from_fn(|i| [x[i], y[i], z[i]])), p)
}

/// A closed chain of revolutes (or others) through the given places; body i lies between places i and i + 1.
fn ring(r: &mut Random, title: &str, places: &[(Kind, Pose<f64>)]) -> Machine {
    let n = places.len() - 1;
    let whole = r.pose();
    let mut a = Assembled::new(r, title, n);
    for (i, (kind, place)) in places.iter().enumerate() {
        let before = i.checked_sub(1);
        let after = (i < n).then_some(i);
        let (from, to) = if r.below(3) == 0 { (after, before) } else { (before, after) };
        let place = whole * *place;
        a.join(*kind, from, to, &place);
    }
    a.machine
}

fn flat(x: f64, y: f64) -> Pose<f64> {
    Pose::at(Vector([x, y, 0.0]))
}

/// Planar, of random proportions, anywhere in space.
pub fn four_bar(r: &mut Random) -> Machine {
    let (a, b) = (0.3 * r.number(), 0.3 * r.number());
    let places = [flat(0.0, 0.0), flat(0.4 + a * 0.3, 0.8), flat(1.6, 1.2 + b), flat(2.0, 0.0)];
    ring(r, "four-bar", &places.map(|p| (Kind::Revolute, p)))
}

/// The crank's slider runs along a random direction of the plane.
pub fn slider_crank(r: &mut Random) -> Machine {
    let angle = 0.4 * r.number();
    let along = frame(Vector([2.0, 0.3, 0.0]), Vector([angle.cos(), angle.sin(), 0.0]));
    let places = [(0.0, 0.0), (0.4, 0.6), (2.0, 0.3)].map(|(x, y)| (Kind::Revolute, flat(x, y)));
    ring(r, "slider crank", &[&places[..], &[(Kind::Prismatic, along)]].concat())
}

/// Two revolutes and two balls; the coupler can turn about itself.
pub fn rssr(r: &mut Random) -> Machine {
    let axis = (Vector([0.2, 0.1, 1.0]) + r.vector() * 0.3, Vector([1.0, 0.3, 0.2]) + r.vector() * 0.3);
    let ends = [Vector([0.5, 0.3, 0.4]), Vector([1.5, 1.0, 0.9])].map(|v| v + r.vector() * 0.1);
    let places = [
        (Kind::Revolute, frame(Vector::zero(), axis.0)),
        (Kind::Spherical, Pose::at(ends[0])),
        (Kind::Spherical, Pose::at(ends[1])),
        (Kind::Revolute, frame(Vector([2.0, 0.1, -0.2]), axis.1)),
    ];
    ring(r, "RSSR", &places)
}

/// Three parallel cranks on one coupler: redundant also in the plane.
pub fn parallelogram(r: &mut Random) -> Machine {
    let whole = r.pose();
    let mut a = Assembled::new(r, "parallelogram", 4);
    let tip = (0.5 + 0.2 * r.number(), 0.9);
    for (crank, x) in [0.0, 1.0, 2.3].into_iter().enumerate() {
        a.join(Kind::Revolute, None, Some(crank), &(whole * flat(x, 0.0)));
        a.join(Kind::Revolute, Some(crank), Some(3), &(whole * flat(x + tip.0, tip.1)));
    }
    a.machine
}

/// Bricard's trihedral linkage along six edges of a cube: six revolutes, one freedom.
pub fn bricard(r: &mut Random) -> Machine {
    let v = Vector;
    let corners = [
        v([0.0, 0.0, 0.0]),
        v([1.0, 0.0, 0.0]),
        v([1.0, -1.0, 0.0]),
        v([1.0, -1.0, 1.0]),
        v([0.0, -1.0, 1.0]),
        v([0.0, 0.0, 1.0]),
    ];
    let places: Vec<(Kind, Pose<f64>)> = (0..6)
        .map(|i| {
            let (before, at, after) = (corners[(i + 5) % 6], corners[i], corners[(i + 1) % 6]);
            (Kind::Revolute, frame(at, (at - before).cross(after - at)))
        })
        .collect();
    ring(r, "Bricard", &places)
}

/// A random chain with one joint more, of any kind but a screw, where it happens to fit.
pub fn random_loop(r: &mut Random, closing: Kind) -> Machine {
    let n = 3 + r.below(3);
    let mut a = Assembled::new(r, &format!("{closing:?} closes"), n);
    let kinds =
        [Kind::Revolute, Kind::Spherical, Kind::Universal, Kind::Cylindrical, Kind::Screw, Kind::Planar, Kind::Free];
    for b in 0..n {
        let parent = b.checked_sub(1).filter(|_| r.below(6) > 0);
        let kind = kinds[r.below(7)];
        let (from, to) = if r.below(3) == 0 { (Some(b), parent) } else { (parent, Some(b)) };
        let place = r.pose();
        let (axis, lead, rpy) = (r.vector().unit(), 0.5 + r.number(), r.below(2) == 0);
        let l = a.join(kind, from, to, &place);
        l.rpy = rpy;
        l.lead = lead;
        if matches!(kind, Kind::Revolute | Kind::Cylindrical | Kind::Screw) {
            l.axis = axis;
        }
    }
    // freedom enough that something is left
    let place = r.pose();
    a.join(Kind::Spherical, Some(n - 1), Some(0), &place);
    a.machine.links.pop();
    let (axis, other) = (r.vector().unit(), if r.below(2) == 0 { None } else { Some(0) });
    let l = a.join(closing, Some(n - 1), other, &place);
    l.cut = true;
    if matches!(closing, Kind::Revolute | Kind::Prismatic | Kind::Cylindrical) {
        l.axis = axis;
    }
    a.machine
}
