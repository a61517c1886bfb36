//! Triangles made from sizes: spheres, and raw heights.

use std::collections::HashMap;
use std::f64::consts::PI;

/// Vertices, m, and triangles of three of them, counted from 0: not yet checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Places, m.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of the triangles.
    pub triangles: Vec<[usize; 3]>,
}

/// A sphere about the origin from an icosahedron whose edges are divided into `density` parts: `20 density²` nearly equal
/// triangles, all vertices on the sphere.
pub fn icosphere(radius: f64, density: usize) -> Soup {
    let g = 0.5 * (1.0 + 5.0f64.sqrt());
    let corners: Vec<[f64; 3]> = [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)]
        .into_iter()
        .flat_map(|(a, b)| [[a, b, 0.0], [0.0, a, b], [b, 0.0, a]])
        .collect();
    let mut all = Soup::default();
    let mut known = HashMap::new();
    for (i, j, k) in faces_of_icosahedron(&corners) {
        let n = density.max(1);
        let mut at = |a: usize, b: usize| {
            // weights by vertex number, so that triangles on both sides of an edge find the same point
            let mut key = [(i, n - a - b), (j, a), (k, b)];
            key.sort_unstable();
            let key: Vec<(usize, usize)> = key.into_iter().filter(|(_, w)| *w > 0).collect();
            *known.entry(key.clone()).or_insert_with(|| {
                let sum = [0, 1, 2].map(|x| key.iter().map(|&(v, w)| corners[v][x] * w as f64).sum::<f64>());
                let size = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                all.vertices.push(sum.map(|x| radius * x / size));
                all.vertices.len() - 1
            })
        };
        let mut triangles = Vec::with_capacity(n * n);
        for a in 0..n {
            for b in 0..n - a {
                triangles.push([at(a, b), at(a + 1, b), at(a, b + 1)]);
                if a + b + 1 < n {
                    triangles.push([at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)]);
                }
            }
        }
        all.triangles.extend(triangles);
    }
    all
}

/// Triples of corners an edge apart, counterclockwise seen from outside.
fn faces_of_icosahedron(corners: &[[f64; 3]]) -> Vec<(usize, usize, usize)> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let near =
        |i: usize, j: usize| (2.0 * (dot(corners[i], corners[i]) - dot(corners[i], corners[j])) - 4.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            for k in j + 1..corners.len() {
                if near(i, j) && near(j, k) && near(i, k) {
                    let normal = super::check::doubled_area([corners[i], corners[j], corners[k]]);
                    faces.push(if dot(normal, corners[i]) > 0.0 { (i, j, k) } else { (i, k, j) });
                }
            }
        }
    }
    faces
}

/// A sphere about the origin by `rings` of equal angle from pole to pole and `segments` around; all vertices on the sphere.
/// At least 2 rings and 3 segments are made.
pub fn uv_sphere(radius: f64, rings: usize, segments: usize) -> Soup {
    let (rings, segments) = (rings.max(2), segments.max(3));
    let mut all = Soup::default();
    all.vertices.push([0.0, 0.0, radius]);
    for i in 1..rings {
        let (sin, cos) = (PI * i as f64 / rings as f64).sin_cos();
        for j in 0..segments {
            let (y, x) = (2.0 * PI * j as f64 / segments as f64).sin_cos();
            all.vertices.push([radius * sin * x, radius * sin * y, radius * cos]);
        }
    }
    all.vertices.push([0.0, 0.0, -radius]);
    let last = all.vertices.len() - 1;
    let at = |ring: usize, j: usize| 1 + (ring - 1) * segments + j % segments;
    for j in 0..segments {
        all.triangles.push([0, at(1, j), at(1, j + 1)]);
        for ring in 1..rings - 1 {
            let (a, b, c, d) = (at(ring, j), at(ring + 1, j), at(ring + 1, j + 1), at(ring, j + 1));
            all.triangles.extend([[a, b, c], [a, c, d]]);
        }
        all.triangles.push([last, at(rings - 1, j + 1), at(rings - 1, j)]);
    }
    all
}

/// Raw heights as they are, two triangles to a cell, counterclockwise from above: an open mesh. Row `j` is at `y₀ + j Δy`,
/// column `i` at `x₀ + i Δx`; a row that is shorter than the first ends the mesh there.
pub fn raw_heights(origin: [f64; 2], spacing: [f64; 2], heights: &[Vec<f64>]) -> Soup {
    let columns = heights.iter().map(Vec::len).min().unwrap_or(0);
    let mut all = Soup::default();
    for (j, row) in heights.iter().enumerate() {
        for (i, &z) in row.iter().take(columns).enumerate() {
            all.vertices.push([origin[0] + spacing[0] * i as f64, origin[1] + spacing[1] * j as f64, z]);
        }
    }
    for j in 0..heights.len().saturating_sub(1) {
        for i in 0..columns.saturating_sub(1) {
            let at = |i: usize, j: usize| j * columns + i;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            all.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    all
}
