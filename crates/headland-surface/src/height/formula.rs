//! [`Formula`]: ground given by an expression of x and y.

use headland_expr::{Expr, FIELD_PARTS, Field, Frozen, Graph, Interval, NodeId, Scalar, field_part};

use super::{Bounds, Ground};

/// How many derivatives there are up to each order.
const UP_TO: [usize; 4] = [1, 3, 6, 10];

/// Ground given by an expression; its bounds come from the derivatives over intervals.
///
/// ```
/// use headland_expr::{Field, Graph, Scalar};
/// use headland_surface::{Formula, Ground};
///
/// let graph = Graph::new();
/// let (x, y) = (graph.input("x"), graph.input("y"));
/// let hill = Formula::new("hill", &graph, graph.id(-(x * x + y * y)), [graph.id(x), graph.id(y)]);
/// let mut height = [0.0];
/// hill.eval([1.0, 2.0, 0.0], 0, &mut height);
/// assert_eq!(height, [-5.0]);
/// assert!(hill.bounds([0.0, 1.0], [0.0, 1.0]).height[0] <= -2.0);
/// ```
#[derive(Debug)]
pub struct Formula {
    name: String,
    parts: Frozen,
}

impl Formula {
    /// From a node of a graph whose only inputs are the two of `at`: x and y, m.
    pub fn new(name: &str, graph: &Graph, height: NodeId, at: [NodeId; 2]) -> Self {
        let slots = at.map(|id| graph.node(id).args[0] as usize);
        let by = |axis: usize, e: Expr<'_>| -> NodeId {
            let one = |i: usize| (i == slots[axis]).then_some(Expr::constant(1.0));
            graph.id(graph.tangent(&[graph.id(e)], one)[0])
        };
        let mut parts = vec![height];
        for order in 1..4 {
            // of each order: along x of all before, and along y of the last
            let before = parts[parts.len() - order..].to_vec();
            parts.extend(before.iter().map(|&id| by(0, graph.expr(id))));
            parts.push(by(1, graph.expr(before[order - 1])));
        }
        Self { name: name.into(), parts: Frozen::new(graph, &parts) }
    }
}

impl Field for Formula {
    fn name(&self) -> &str {
        &self.name
    }

    fn variables(&self) -> usize {
        2
    }

    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        out[..FIELD_PARTS[order]].fill(0.0);
        let all = self.parts.eval(UP_TO[order], &point[..2]);
        let mut next = all.iter();
        for total in 0..=order {
            for (j, &x) in (0..=total).zip(&mut next) {
                out[field_part(total - j, j, 0)] = x;
            }
        }
    }
}

impl Ground for Formula {
    /// Height by its own interval and by the mean value from the middle; bend by the eigenvalues of the second derivatives.
    fn bounds(&self, x: [f64; 2], y: [f64; 2]) -> Bounds {
        let boxed = [x, y].map(|[from, to]| Interval::new(from, to));
        let middle = [x, y].map(|[from, to]| Interval::constant(0.5 * (from + to)));
        let all = self.parts.eval(UP_TO[2], &boxed);
        let [f, fx, fy, fxx, fxy, fyy] = [0, 1, 2, 3, 4, 5].map(|i| all[i]);
        let centre = self.parts.eval(1, &middle)[0];
        let by_mean = centre + fx * (boxed[0] - middle[0]) + fy * (boxed[1] - middle[1]);
        let height = f.meet(by_mean);
        let half = Interval::constant(0.5);
        let (mean, difference) = ((fxx + fyy) * half, (fxx - fyy) * half);
        let spread = difference.magnitude().hypot(fxy.magnitude());
        // the entries themselves bound as well, where they hardly vary
        let by_rows = [fxx.lo.min(fyy.lo) - fxy.magnitude(), fxx.hi.max(fyy.hi) + fxy.magnitude()];
        let bend = [by_rows[0].max(mean.lo - spread), by_rows[1].min(mean.hi + spread)];
        Bounds { height: [height.lo, height.hi], bend }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `0.1 sin(2 x) cos(1.5 y) + x² y`, and every derivative by differences of the one before.
    #[test]
    fn bounds_hold_and_parts_are_derivatives() {
        let graph = Graph::new();
        let (x, y) = (graph.input("x"), graph.input("y"));
        let c = Expr::constant;
        let f = c(0.1) * (c(2.0) * x).sin() * (c(1.5) * y).cos() + x * x * y;
        let ground = Formula::new("waves", &graph, graph.id(f), [graph.id(x), graph.id(y)]);
        let at = |x: f64, y: f64| {
            let mut out = [0.0; 20];
            ground.eval([x, y, 0.0], 3, &mut out);
            out
        };
        let part = |out: &[f64; 20], i, j| out[field_part(i, j, 0)];
        let h = 1e-5;
        for k in 0..20 {
            let (px, py) = (f64::from(k) * 0.17 - 1.5, 1.3 - f64::from(k) * 0.11);
            let here = at(px, py);
            let (right, left) = (at(px + h, py), at(px - h, py));
            let (up, down) = (at(px, py + h), at(px, py - h));
            for (i, j) in [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)] {
                let along_x = (part(&right, i, j) - part(&left, i, j)) / (2.0 * h);
                let along_y = (part(&up, i, j) - part(&down, i, j)) / (2.0 * h);
                assert!((along_x - part(&here, i + 1, j)).abs() < 1e-9, "{i} {j} along x");
                assert!((along_y - part(&here, i, j + 1)).abs() < 1e-9, "{i} {j} along y");
            }
            let size = 0.05 * f64::from(k + 1);
            let bounds = ground.bounds([px, px + size], [py, py + size]);
            for m in 0..=10 {
                for n in 0..=10 {
                    let all = at(px + size * 0.1 * f64::from(m), py + size * 0.1 * f64::from(n));
                    let (a, b, c) = (part(&all, 2, 0), part(&all, 1, 1), part(&all, 0, 2));
                    let (mean, spread) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
                    assert!(bounds.height[0] <= all[0] && all[0] <= bounds.height[1]);
                    assert!(bounds.bend[0] <= mean - spread && mean + spread <= bounds.bend[1]);
                }
            }
            // and close upon what is there
            let small = ground.bounds([px, px + 1e-6], [py, py + 1e-6]);
            let (a, b, c) = (part(&here, 2, 0), part(&here, 1, 1), part(&here, 0, 2));
            let (mean, spread) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
            let exact = [here[0], here[0], mean - spread, mean + spread];
            let found = [small.height[0], small.height[1], small.bend[0], small.bend[1]];
            assert!(exact.iter().zip(found).all(|(x, y)| (x - y).abs() < 5e-5), "{exact:?} {found:?}");
        }
    }
}
