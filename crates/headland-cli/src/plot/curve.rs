//! From samples to what the pixels can show.
//!
//! ```text
//! samples → runs of finite samples → pixels → at most 4 points a half pixel (x increasing) → straight parts dropped
//! ```

use super::{Series, scene::Point};

/// Width of the columns of [`min_max`]: one pixel of the PNG.
const COLUMN: f64 = 0.5;
/// How far a dropped point may lie from the line that replaces it; far below what can be seen.
const TOLERANCE: f64 = 0.06;
/// Larger values are taken as gaps, so that no difference of two overflows.
const LARGEST: f64 = 1e300;

/// Whether a sample can be drawn.
pub fn usable(x: f64, y: f64) -> bool {
    x.abs() < LARGEST && y.abs() < LARGEST // false for NaN
}

/// The samples of a series that can be drawn.
pub fn samples<'a>(series: &Series<'a>) -> impl Iterator<Item = Point> + use<'a> {
    let (x, y) = (series.x, series.y);
    x.iter()
        .zip(y)
        .filter(|&(&x, &y)| usable(x, y))
        .map(|(&x, &y)| [x, y])
}

/// Whether x never decreases: a function of x, such as anything over time.
pub fn is_function(series: &Series) -> bool {
    samples(series).map(|[x, _]| x).is_sorted()
}

/// The curve in pixels, thinned: runs of at least one point, one run between two gaps.
pub fn in_pixels(series: &Series, to_pixels: impl Fn(Point) -> Point) -> Vec<Vec<Point>> {
    let function = is_function(series);
    let mut runs = Vec::new();
    let mut run: Vec<Point> = Vec::new();
    let mut close = |run: &mut Vec<Point>| {
        if !run.is_empty() {
            let thinned = if function {
                min_max(run)
            } else {
                std::mem::take(run)
            };
            runs.push(drop_straight(&thinned, TOLERANCE));
            run.clear();
        }
    };
    for (&x, &y) in series.x.iter().zip(series.y) {
        if usable(x, y) {
            run.push(to_pixels([x, y]));
        } else {
            close(&mut run);
        }
    }
    close(&mut run);
    runs
}

/// The first, lowest, highest and last point of every column of pixels, in the order they came.
///
/// For x that never decreases. What is left paints the same pixels as all points do.
pub fn min_max(points: &[Point]) -> Vec<Point> {
    let column = |p: &Point| (p[0] / COLUMN).floor();
    let mut kept = Vec::new();
    for part in points.chunk_by(|a, b| column(a) == column(b)) {
        let (mut low, mut high) = (0, 0);
        for (i, p) in part.iter().enumerate() {
            if p[1] < part[low][1] {
                low = i;
            }
            if p[1] > part[high][1] {
                high = i;
            }
        }
        let mut picks = [0, low, high, part.len() - 1];
        picks.sort_unstable();
        for (i, &pick) in picks.iter().enumerate() {
            if i == 0 || picks[i - 1] != pick {
                kept.push(part[pick]);
            }
        }
    }
    kept
}

/// The points where a polyline turns: the others are within `tolerance` of the lines between these.
///
/// From the last point kept, the next is put off while some ray from there passes all points since within the
/// tolerance, and while they move away. One pass, O(n).
/// # References
/// C. M. Williams, *An efficient algorithm for the piecewise linear approximation of planar curves*, Computer
/// Graphics and Image Processing 8, 1978.
pub fn drop_straight(points: &[Point], tolerance: f64) -> Vec<Point> {
    let Some((&first, rest)) = points.split_first() else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let mut anchor = first;
    let mut last = first; // the newest point the line from the anchor reaches
    let mut cone = Cone::open();
    for &p in rest {
        if !cone.admits(anchor, p, tolerance) {
            kept.push(last);
            anchor = last;
            cone = Cone::open();
            cone.admits(anchor, p, tolerance);
        }
        last = p;
    }
    if distance(last, anchor) > tolerance {
        kept.push(last);
    }
    kept
}

/// The rays from an anchor that pass all points so far: angles within `half` of `middle`.
struct Cone {
    middle: Point, // a unit vector, once there is one
    low: f64,      // angles from `middle`
    high: f64,
    reach: f64, // distance of the farthest point so far
}

impl Cone {
    fn open() -> Self {
        Self {
            middle: [0.0, 0.0],
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            reach: 0.0,
        }
    }

    /// Narrows the cone to a further point, unless that point needs a new line.
    fn admits(&mut self, anchor: Point, p: Point, tolerance: f64) -> bool {
        let [dx, dy] = [p[0] - anchor[0], p[1] - anchor[1]];
        let far = dx.hypot(dy);
        if far + tolerance < self.reach {
            return false; // it turned back
        }
        if far <= tolerance {
            return true; // still at the anchor
        }
        if self.reach <= tolerance {
            self.middle = [dx / far, dy / far];
        }
        let [mx, my] = self.middle;
        let angle = (mx * dy - my * dx).atan2(mx * dx + my * dy);
        if angle < self.low || angle > self.high {
            return false;
        }
        let half = (tolerance / far).asin();
        self.low = self.low.max(angle - half);
        self.high = self.high.min(angle + half);
        self.reach = self.reach.max(far);
        true
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
