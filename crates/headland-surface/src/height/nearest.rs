//! The nearest point of ground: Newton's method, and a search by bounds where that is not known to be enough.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use headland_expr::field_part;

use super::{Ground, HeightError};

/// Rectangles looked at before the search gives up.
const MOST_BOXES: usize = 20_000;

/// The nearest point of `ground` to `c`.
///
/// ```text
/// g(x, y) = ½ |(x, y, f) − c|²        ∇∇g = I + ∇f ∇fᵀ + (f − c_z) ∇∇f
/// ```
/// With all second derivatives of `f` below `K`, two minima of `g` within the height `h` above ground cannot be: on the
/// line between them `f ≥ c_z − h − K h²/2`, so `g` is convex there if `K h (1 + K h/2) < 1`. Below ground with the signs
/// turned.
pub(super) fn foot(ground: &dyn Ground, c: [f64; 3]) -> Result<[f64; 3], HeightError> {
    let no_height = |x, y| HeightError::NoHeight { name: ground.name().into(), x, y };
    let mut f = [0.0];
    ground.eval([c[0], c[1], 0.0], 0, &mut f);
    let h = (c[2] - f[0]).abs();
    if !h.is_finite() || c.iter().any(|x| !x.is_finite()) {
        return Err(no_height(c[0], c[1]));
    }
    if h == 0.0 {
        return Ok(c);
    }
    let first = descend(ground, c, [c[0], c[1]]);
    let around = Rectangle { x: [c[0] - h, c[0] + h], y: [c[1] - h, c[1] + h] };
    let [least, most] = ground.bounds(around.x, around.y).bend;
    let steep = h * if c[2] > f[0] { most } else { -least };
    match first {
        Some(foot) if steep * (1.0 + 0.5 * steep) < 1.0 => Ok(foot.point),
        _ => search(ground, c, around, first),
    }
}

/// A point of the ground.
#[derive(Clone, Copy)]
struct Foot {
    point: [f64; 3],
    distance: f64,
}

/// Down to a minimum of the distance from a start, or `None` where that fails.
fn descend(ground: &dyn Ground, c: [f64; 3], start: [f64; 2]) -> Option<Foot> {
    let mut here = start;
    let mut f = [0.0; 10];
    let value_at = |[x, y]: [f64; 2]| {
        let mut f = [0.0];
        ground.eval([x, y, 0.0], 0, &mut f);
        (x - c[0]).powi(2) + (y - c[1]).powi(2) + (f[0] - c[2]).powi(2)
    };
    // what a place is known to
    let rounding = f64::EPSILON * c.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    let mut last_step = f64::INFINITY;
    for _ in 0..100 {
        ground.eval([here[0], here[1], 0.0], 2, &mut f);
        let part = |i, j| f[field_part(i, j, 0)];
        let (up, fx, fy) = (f[0] - c[2], part(1, 0), part(0, 1));
        let (gx, gy) = (here[0] - c[0] + up * fx, here[1] - c[1] + up * fy);
        let mut h = [1.0 + fx * fx + up * part(2, 0), fx * fy + up * part(1, 1), 1.0 + fy * fy + up * part(0, 2)];
        if !(h[0] > 0.0 && h[0] * h[2] - h[1] * h[1] > 1e-12 * h[0] * h[2]) {
            h = [1.0 + fx * fx, fx * fy, 1.0 + fy * fy]; // without the bend it is always positive
        }
        let determinant = h[0] * h[2] - h[1] * h[1];
        let step = [(h[1] * gy - h[2] * gx) / determinant, (h[1] * gx - h[0] * gy) / determinant];
        let length = step[0].hypot(step[1]);
        let value = (here[0] - c[0]).powi(2) + (here[1] - c[1]).powi(2) + up * up;
        let distance = value.sqrt();
        if !length.is_finite() {
            return None;
        }
        let small = length < 1e-7 * distance + 100.0 * rounding;
        if length <= 1e-16 * distance + 0.1 * rounding || (small && length >= 0.5 * last_step) {
            return Some(Foot { point: [here[0], here[1], f[0]], distance });
        }
        let mut next = [here[0] + step[0], here[1] + step[1]];
        if !small {
            let halved =
                (0..30).map(|k| 0.5f64.powi(k)).map(|share| [here[0] + share * step[0], here[1] + share * step[1]]);
            next = halved.into_iter().find(|&p| value_at(p) < value)?;
        }
        (here, last_step) = (next, if small { length } else { f64::INFINITY });
    }
    None
}

#[derive(Clone, Copy)]
struct Rectangle {
    x: [f64; 2],
    y: [f64; 2],
}

impl Rectangle {
    fn middle(&self) -> [f64; 2] {
        [0.5 * (self.x[0] + self.x[1]), 0.5 * (self.y[0] + self.y[1])]
    }

    fn quarters(&self) -> [Rectangle; 4] {
        let [mx, my] = self.middle();
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        [([x0, mx], [y0, my]), ([mx, x1], [y0, my]), ([x0, mx], [my, y1]), ([mx, x1], [my, y1])]
            .map(|(x, y)| Rectangle { x, y })
    }

    /// The smallest rectangle that holds a point too.
    fn with(&self, p: [f64; 3]) -> Rectangle {
        Rectangle { x: [self.x[0].min(p[0]), self.x[1].max(p[0])], y: [self.y[0].min(p[1]), self.y[1].max(p[1])] }
    }

    fn holds(&self, p: [f64; 3]) -> bool {
        (self.x[0]..=self.x[1]).contains(&p[0]) && (self.y[0]..=self.y[1]).contains(&p[1])
    }

    /// The least distance that ground over it can have from `c`, and whether `g` is convex over it.
    ///
    /// Of two lower bounds the better: by the ranges of x, y and f, and by the Taylor polynomial of `g` about the middle,
    /// whose second derivatives are at least `λ = 1 + min (f − c_z) ∇∇f`.
    fn look(&self, ground: &dyn Ground, c: [f64; 3]) -> (f64, bool) {
        let bounds = ground.bounds(self.x, self.y);
        let [low, high] = bounds.height;
        let beside = |[a, b]: [f64; 2], x: f64| (a - x).max(x - b).max(0.0);
        let by_range = beside(self.x, c[0]).hypot(beside(self.y, c[1])).hypot(beside([low, high], c[2]));
        let corners = [low, high].into_iter().flat_map(|z| bounds.bend.map(|bend| 1.0 + (z - c[2]) * bend));
        // not a number: nothing is known
        let lambda = corners.fold(f64::INFINITY, |a, b| {
            if b < a {
                b
            } else if b.is_nan() {
                f64::NEG_INFINITY
            } else {
                a
            }
        });
        let [x, y] = self.middle();
        let mut f = [0.0; 4];
        ground.eval([x, y, 0.0], 1, &mut f);
        let (up, rx, ry) = (f[0] - c[2], self.x[1] - x, self.y[1] - y);
        let g = 0.5 * ((x - c[0]).powi(2) + (y - c[1]).powi(2) + up * up);
        let fall = (x - c[0] + up * f[1]).abs() * rx + (y - c[1] + up * f[2]).abs() * ry;
        let by_taylor = g - fall + 0.5 * lambda.min(0.0) * (rx * rx + ry * ry);
        (by_range.max((2.0 * by_taylor).max(0.0).sqrt()), lambda > 0.0)
    }
}

/// A rectangle still to be looked at; nearer ones come first, of equally near ones the older.
struct Open {
    least: f64,
    age: usize,
    convex: bool,
    rectangle: Rectangle,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.least.total_cmp(&self.least).then(other.age.cmp(&self.age))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

/// Branch and bound from a first guess on.
fn search(ground: &dyn Ground, c: [f64; 3], around: Rectangle, first: Option<Foot>) -> Result<[f64; 3], HeightError> {
    let mut best = first;
    let mut boxes = 1;
    let (least, convex) = around.look(ground, c);
    let mut open = BinaryHeap::from([Open { least, age: 0, convex, rectangle: around }]);
    // a nearer point by less than rounding is the same answer
    let nearer = |least: f64, best: Option<Foot>| best.is_none_or(|foot| least < foot.distance * (1.0 - 1e-14));
    while let Some(Open { least, convex, rectangle, .. }) = open.pop() {
        if !nearer(least, best) {
            break;
        }
        if convex {
            // a minimum here and the best one cannot both be, if all between is convex too
            if best.is_some_and(|foot| rectangle.with(foot.point).look(ground, c).1) {
                continue;
            }
            if let Some(foot) = descend(ground, c, rectangle.middle()) {
                best = Some(best.filter(|best| best.distance <= foot.distance).unwrap_or(foot));
                if rectangle.holds(foot.point) {
                    continue;
                }
            }
        }
        for quarter in rectangle.quarters() {
            boxes += 1;
            let (least, convex) = quarter.look(ground, c);
            if nearer(least, best) {
                open.push(Open { least, age: boxes, convex, rectangle: quarter });
            }
        }
        if boxes > MOST_BOXES {
            break;
        }
    }
    let undecided = HeightError::Undecided { name: ground.name().into(), point: c, boxes };
    best.filter(|_| boxes <= MOST_BOXES).map(|foot| foot.point).ok_or(undecided)
}
