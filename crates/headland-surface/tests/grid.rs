//! Smooth ground through points: exact where theory says so, order 6, no jumps, bounds that hold, files told apart.

mod common;

use std::sync::Arc;

use common::{check, points};
use headland_expr::{Field, field_part};
use headland_surface::{Bounds, Grid, GridError, Ground, Height, Layout, read_csv};

fn sampled(columns: usize, rows: usize, origin: [f64; 2], spacing: [f64; 2], f: impl Fn(f64, f64) -> f64) -> Grid {
    let at = |k: usize, i: usize| origin[k] + spacing[k] * i as f64;
    let heights: Vec<Vec<f64>> = (0..rows).map(|j| (0..columns).map(|i| f(at(0, i), at(1, j))).collect()).collect();
    Grid::new("g", origin, spacing, &heights).unwrap()
}

fn eval(grid: &Grid, x: f64, y: f64) -> [f64; 20] {
    let mut out = [0.0; 20];
    grid.eval([x, y, 0.0], 3, &mut out);
    out
}

#[test]
fn polynomials_of_degree_five_are_exact_up_to_the_edges() {
    let p = |x: f64| [1.0 - x + 0.5 * x.powi(5), -1.0 + 2.5 * x.powi(4), 10.0 * x.powi(3), 30.0 * x * x];
    let q = |y: f64| [0.3 + y * y - 0.2 * y.powi(5), 2.0 * y - y.powi(4), 2.0 - 4.0 * y.powi(3), -12.0 * y * y];
    for (columns, rows) in [(6, 6), (7, 11), (30, 8)] {
        let spacing = [2.0 / (columns - 1) as f64, 3.0 / (rows - 1) as f64];
        let grid = sampled(columns, rows, [-1.0, -1.5], spacing, |x, y| p(x)[0] * q(y)[0]);
        for [x, y, _] in points(50, [1.0, 1.5, 0.0]).chain([[-1.0, -1.5, 0.0], [1.0, 1.5, 0.0], [1.0, -1.5, 0.0]]) {
            let found = eval(&grid, x, y);
            for i in 0..=3 {
                for j in 0..=3 - i {
                    let exact = p(x)[i] * q(y)[j];
                    let tolerance = 1e-14 / spacing[0].powi(i as i32) / spacing[1].powi(j as i32) * 100.0;
                    let a = found[field_part(i, j, 0)];
                    assert!((a - exact).abs() < tolerance, "{columns} {rows} {i}{j} at {x} {y}: {a} {exact}");
                }
            }
        }
        assert_eq!(eval(&grid, 0.2, 0.1)[field_part(0, 0, 1)], 0.0);
    }
}

#[test]
fn error_is_of_order_six_and_of_three_in_the_third_derivatives() {
    let f = |x: f64, y: f64| (1.3 * x).sin() * (0.7 * y + 0.3).cos();
    let errors = |n: usize, reach: f64| {
        let grid = sampled(n, n, [-2.0, -2.0], [4.0 / (n - 1) as f64; 2], f);
        let mut most = [0.0f64; 2];
        for i in 0..3600 {
            let (x, y) = (reach * (f64::from(i % 60) / 29.5 - 1.0), reach * (f64::from(i / 60) / 29.5 - 1.0));
            let all = eval(&grid, x, y);
            let third = -1.3f64.powi(3) * (1.3 * x).cos() * (0.7 * y + 0.3).cos();
            most[0] = most[0].max((all[0] - f(x, y)).abs());
            most[1] = most[1].max((all[field_part(3, 0, 0)] - third).abs());
        }
        most
    };
    let order = |reach| {
        let (coarse, fine) = (errors(41, reach), errors(81, reach));
        [0, 1].map(|k| (coarse[k] / fine[k]).log2())
    };
    let (inside, all) = (order(0.7), order(2.0));
    assert!((inside[0] - 6.0).abs() < 0.3 && (inside[1] - 3.0).abs() < 0.3, "{inside:?}");
    // up to the edges no worse
    assert!(all[0] > 5.7 && all[1] > 2.7, "{all:?}");
}

fn hills(x: f64, y: f64) -> f64 {
    0.2 * (2.0 * x).sin() * (1.5 * y).cos() + 0.05 * x
}

#[test]
fn nothing_jumps_at_knots_and_edges() {
    let grid = sampled(25, 21, [-3.0, -2.5], [0.25, 0.25], hills);
    let e = 1e-9;
    // from far outside through a corner, along an edge, through knots
    for (x, y) in
        [(-3.0, -2.5), (-3.0, 0.1), (3.0, 2.5), (-3.5, 0.3), (3.75, 0.3), (0.5, -2.5), (0.25, 0.5), (-4.0, -3.5)]
    {
        let (a, b) = (eval(&grid, x - e, y - e), eval(&grid, x + e, y + e));
        for (p, q) in a.iter().zip(&b) {
            assert!((p - q).abs() < 1e-6, "{x} {y}: {a:?} {b:?}");
        }
    }
    // beyond three spacings it runs straight
    let far = eval(&grid, -8.0, 0.3);
    assert!(far[field_part(2, 0, 0)].abs() < 1e-9 && far[field_part(3, 0, 0)].abs() < 1e-9);
    let further = eval(&grid, -18.0, 0.3);
    assert!((further[0] - far[0] + 10.0 * far[1]).abs() < 1e-9);
}

#[test]
fn distance_from_a_grid_has_its_derivatives() {
    let ground = Height::new(Arc::new(sampled(40, 40, [-3.9, -3.9], [0.2, 0.2], hills)));
    for c in points(60, [2.5, 2.5, 0.4]).map(|[x, y, z]| [x, y, z + 0.5]) {
        check(&ground, c, 1e-4, 1e-4); // across knots the fourth derivative only bends
    }
}

#[test]
fn bounds_hold_everywhere() {
    let grid = sampled(25, 21, [-3.0, -2.5], [0.25, 0.25], |x, y| hills(x, y) + 0.3 * (5.0 * x * y).sin());
    for (i, [x, y, size]) in points(400, [5.0, 5.0, 2.0]).enumerate() {
        let size = if i % 2 == 0 { size.abs() } else { 0.05 * size.abs() };
        let bounds = grid.bounds([x - size, x + size], [y - size, y + size]);
        for [u, v, _] in points(60, [size, size, 0.0]) {
            let all = eval(&grid, x + u, y + v);
            let part = |i, j| all[field_part(i, j, 0)];
            let tiny = 1e-10;
            assert!((bounds.height[0] - tiny..=bounds.height[1] + tiny).contains(&all[0]), "{x} {y} {size}");
            let mean = 0.5 * (part(2, 0) + part(0, 2));
            let spread = (0.5 * (part(2, 0) - part(0, 2))).hypot(part(1, 1));
            assert!(bounds.bend[0] - tiny <= mean - spread && mean + spread <= bounds.bend[1] + tiny, "{x} {y} {size}");
        }
    }
    // and they are not idle
    let grid = sampled(101, 101, [-5.0, -5.0], [0.1, 0.1], |x, y| x.sin() * y.cos());
    let Bounds { height, bend } = grid.bounds([-0.2, 0.2], [-0.2, 0.2]);
    assert!(height[1] < 0.9 && height[0] > -0.9 && bend[1] < 1.5 && bend[0] > -1.5, "{height:?} {bend:?}");
}

#[test]
fn nearest_point_of_a_grid_is_global() {
    let grid = sampled(41, 41, [-4.0, -4.0], [0.2, 0.2], |x, y| 0.4 * (3.0 * x).sin() * (2.0 * y).cos());
    let ground = Height::new(Arc::new(grid.clone()));
    for c in points(40, [2.0, 2.0, 3.0]) {
        let foot = ground.foot(c).unwrap();
        let to = |p: [f64; 3]| (0..3).map(|i| (p[i] - c[i]).powi(2)).sum::<f64>().sqrt();
        let d = to(foot);
        for i in 0..10_000 {
            let (x, y) = (c[0] + d * (f64::from(i % 100) / 50.0 - 1.0), c[1] + d * (f64::from(i / 100) / 50.0 - 1.0));
            assert!(to([x, y, eval(&grid, x, y)[0]]) > d - 1e-12);
        }
    }
}

#[test]
fn bad_grids_are_refused() {
    let flat = vec![vec![0.0; 8]; 7];
    let made = |heights: &[Vec<f64>]| Grid::new("moor", [0.0; 2], [1.0; 2], heights).unwrap_err();
    assert_eq!(
        made(&flat[..3]).to_string(),
        "the grid `moor` has 3 row(s) and 8 column(s); at least 6 of each are needed"
    );
    let mut ragged = flat.clone();
    ragged[4].pop();
    assert_eq!(made(&ragged), GridError::Ragged { name: "moor".into(), row: 5, found: 7, expected: 8 });
    let mut hole = flat.clone();
    hole[2][6] = f64::NAN;
    assert_eq!(made(&hole).to_string(), "the grid `moor` has no height in row 3, column 7 (`NaN`); fill the hole");
    assert!(matches!(made(&[]), GridError::TooSmall { rows: 0, columns: 0, .. }));
    let spacing = Grid::new("moor", [0.0; 2], [1.0, 0.0], &flat).unwrap_err();
    assert!(matches!(spacing, GridError::Frame { what: "spacing", .. }));
    assert!(eval(&Grid::new("moor", [0.0; 2], [1.0; 2], &flat).unwrap(), f64::INFINITY, 0.0)[0].is_nan());
}

#[test]
fn grids_are_read_from_text() {
    let f = |x: f64, y: f64| 0.1 * x * y - 0.3 * y;
    let mut rows = String::from("# heights of the moor\n");
    let mut triples = String::from("x, y, z\n");
    for j in 0..7 {
        let (y, line): (f64, Vec<String>) = (
            f64::from(j) * 0.5 - 1.0,
            (0..6).map(|i| f(f64::from(i) * 2.0, f64::from(j) * 0.5 - 1.0).to_string()).collect(),
        );
        rows += &(line.join(" , ") + "\n");
        // from right to left, to show that the order does not matter
        for i in (0..6).rev() {
            triples += &format!("{},{y},{}\n", f64::from(i) * 2.0, line[i as usize]);
        }
    }
    let heights = Layout::Heights { origin: [0.0, -1.0], spacing: [2.0, 0.5] };
    for grid in
        [read_csv("m", rows.as_bytes(), heights).unwrap(), read_csv("m", triples.as_bytes(), Layout::Points).unwrap()]
    {
        assert_eq!(grid.extent(), [[0.0, 10.0], [-1.0, 2.0]]);
        assert!((eval(&grid, 3.3, 0.7)[0] - f(3.3, 0.7)).abs() < 1e-13);
    }
    let read = |text: &str| read_csv("m", text.as_bytes(), Layout::Points).unwrap_err();
    let holed = triples.replacen("4,0,", "# 4,0,", 1);
    assert_eq!(read(&holed).to_string(), "the grid `m` has no height in row 3, column 3 (`NaN`); fill the hole");
    assert!(matches!(read(&(triples.clone() + "4,0,1\n")), GridError::Twice { line: 44, .. }));
    assert!(matches!(read(&(triples.clone() + "11,0,1\n")), GridError::Uneven { axis: 'x', .. }));
    assert_eq!(
        read(&(triples + "1,2\n")).to_string(),
        "the grid `m` cannot be read: line 44 should be three numbers x, y, z, but is `1, 2`"
    );
    let hole = read_csv("m", rows.replacen("0.3", "none", 1).as_bytes(), heights).unwrap_err();
    assert!(matches!(hole, GridError::Hole { row: 1, column: 1, .. }), "{hole}");
    assert!(matches!(read(""), GridError::TooSmall { .. }));
}
