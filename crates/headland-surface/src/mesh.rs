//! [`Mesh`]: triangles as a surface, through the crate parry; feature `mesh`.
//!
//! A mesh is not smooth: against the surface it stands for, its depth is wrong by the square of the triangles' size and its
//! normal, which jumps, by the first power. Both errors are told ([`Mesh::error`]). It serves compliant contact; nothing can
//! roll on it by constraint.

mod check;
mod make;
mod parry;
mod read;
mod recess;
mod scene;

use std::fmt;

use headland_expr::{FIELD_PARTS, Field};

use check::{Checked, dot, doubled_area, minus, squared, unit};
use parry::Triangles;

use crate::contact::{Contact, ContactError};
use crate::shape::{Shape, Side};

pub use check::MeshError;
pub use make::{Soup, icosphere, raw_heights, uv_sphere};
pub use read::{read_obj, read_stl};
pub use recess::recess_query;
pub use scene::{HANDFUL, Scene};

/// How triangles are taken.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct MeshOptions {
    /// Free side of a closed mesh. Which way its triangles turn does not matter, if all turn the same way.
    pub side: Side,
    /// Allow a mesh that is not closed: free is the side from which its triangles run counterclockwise, and a point nearest
    /// to its border has no contact.
    pub open: bool,
    /// Normals interpolated between the vertices, whose own are the angle-weighted means of their triangles. They jump less,
    /// and are no longer the gradient of the distance.
    pub smooth: bool,
}

/// A surface of triangles.
pub struct Mesh {
    name: String,
    checked: Checked,
    triangles: Triangles,
    /// 1, or −1 where the free side is inside.
    sign: f64,
    /// Unit normals of the triangles towards the free side.
    faces: Vec<[f64; 3]>,
    /// The same of the vertices, if asked for.
    smooth: Option<Vec<[f64; 3]>>,
}

/// How far a mesh may be from the smooth surface that it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshErrors {
    /// Largest error of depth, m.
    pub depth: f64,
    /// Largest error of the normal, rad.
    pub normal: f64,
    /// Longest edge, m.
    pub edge: f64,
}

impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mesh").field("name", &self.name).field("triangles", &self.faces.len()).finish_non_exhaustive()
    }
}

impl Mesh {
    /// From vertices, m, and triangles of three of them, counted from 0; vertices in the same place are one.
    ///
    /// # Errors
    /// [`MeshError`] names the triangle.
    pub fn new(name: &str, soup: &Soup, options: MeshOptions) -> Result<Self, MeshError> {
        let mut checked = check::check(name, &soup.vertices, &soup.triangles, options.open)?;
        let closed = checked.neighbours.iter().flatten().all(Option::is_some);
        if closed && volume(&checked) < 0.0 {
            turn_over(&mut checked);
        }
        let triangles = Triangles::new(&checked.vertices, &checked.triangles)
            .map_err(|reason| MeshError::Read { name: name.into(), reason })?;
        let sign = if closed { options.side.sign() } else { 1.0 };
        let faces: Vec<_> =
            (0..checked.triangles.len()).map(|i| unit(doubled_area(corners(&checked, i))).map(|x| sign * x)).collect();
        let smooth = options.smooth.then(|| vertex_normals(&checked, &faces));
        Ok(Self { name: name.into(), checked, triangles, sign, faces, smooth })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many triangles it has.
    pub fn len(&self) -> usize {
        self.faces.len()
    }

    /// Never: a mesh has triangles.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// The box that holds it, m, `[from, to]` along x, y and z.
    pub fn extent(&self) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|i| {
            let along = self.checked.vertices.iter().map(|p| p[i]);
            [along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max)]
        })
    }

    /// Nearest point, distance and normal; no curvatures.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`] where the nearest point is on the border of an open mesh.
    pub fn query(&self, point: [f64; 3]) -> Result<Contact, ContactError> {
        let Some(found) = self.triangles.nearest(point) else {
            return Err(ContactError::NotFinite { point });
        };
        if self.on_border(found.triangle, found.weights) {
            return Err(ContactError::NoFoot { point });
        }
        let away = minus(point, found.point);
        let size = squared(away).sqrt();
        let distance = if found.behind { -self.sign * size } else { self.sign * size };
        let corners = self.checked.triangles[found.triangle];
        let normal = match &self.smooth {
            Some(normals) => unit(weighted(corners.map(|v| normals[v as usize]), found.weights)),
            // too near to tell a direction
            None if size <= 1e-9 * self.reach(found.triangle) => self.faces[found.triangle],
            None => away.map(|x| x / distance),
        };
        Ok(Contact { distance, foot: found.point, normal, curvatures: None })
    }

    /// On an edge that has one triangle only.
    fn on_border(&self, triangle: usize, weights: [f64; 3]) -> bool {
        let neighbours = &self.checked.neighbours[triangle];
        // the edge after corner k is where the corner before k weighs nothing
        (0..3).any(|k| neighbours[k].is_none() && weights[(k + 2) % 3] <= 1e-12)
    }

    fn reach(&self, triangle: usize) -> f64 {
        let at = corners(&self.checked, triangle);
        squared(minus(at[1], at[0])).max(squared(minus(at[2], at[0]))).sqrt()
    }

    /// Estimate from the mesh alone, as if it stood for a smooth surface through its vertices.
    ///
    /// ```text
    /// κ = θ / s        θ: angle between neighbouring triangles, s: between their middles
    /// depth ≤ κ ρ²/2        normal ≤ κ ρ        ρ: larger of their circumscribed circles' radii
    /// ```
    /// A true edge, such as a cube's, counts as error: a smooth surface has none.
    pub fn error(&self) -> MeshErrors {
        let mut worst = MeshErrors { depth: 0.0, normal: 0.0, edge: 0.0 };
        for (i, neighbours) in self.checked.neighbours.iter().enumerate() {
            let at = corners(&self.checked, i);
            for k in 0..3 {
                worst.edge = worst.edge.max(squared(minus(at[(k + 1) % 3], at[k])).sqrt());
            }
            for &j in neighbours.iter().flatten().filter(|&&j| j > i) {
                let other = corners(&self.checked, j);
                // by the chord, which keeps small angles
                let angle = 2.0 * (0.5 * squared(minus(self.faces[i], self.faces[j])).sqrt()).min(1.0).asin();
                let between = squared(minus(middle(at), middle(other))).sqrt();
                let circle = circumradius(at).max(circumradius(other));
                let bend = angle / between;
                worst.depth = worst.depth.max(0.5 * bend * circle * circle);
                worst.normal = worst.normal.max(bend * circle);
            }
        }
        worst
    }

    /// Measured against the shape that the mesh was made from, at corners, middles of edges and middles of triangles.
    pub fn error_against(&self, shape: &Shape<f64>) -> MeshErrors {
        let mut worst = MeshErrors { edge: self.error().edge, depth: 0.0, normal: 0.0 };
        for i in 0..self.len() {
            let at = corners(&self.checked, i);
            let edges = [0, 1, 2].map(|k| weighted([at[k], at[(k + 1) % 3], at[0]], [0.5, 0.5, 0.0]));
            for p in at.into_iter().chain(edges).chain([middle(at)]) {
                let p = headland_spatial::Vector(p);
                let normal = shape.normal(p).0;
                worst.depth = worst.depth.max(shape.distance(p).abs());
                let chord = squared(minus(normal, self.faces[i])).sqrt();
                worst.normal = worst.normal.max(2.0 * (0.5 * chord).min(1.0).asin());
            }
        }
        worst
    }
}

/// Distance and normal for compliant contact. Second derivatives, which only tell how a normal force turns, are those of a
/// triangle: none.
impl Field for Mesh {
    fn name(&self) -> &str {
        &self.name
    }

    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        let out = &mut out[..FIELD_PARTS[order]];
        let Ok(contact) = self.query(point) else {
            out.fill(f64::NAN);
            return;
        };
        let parts = [contact.distance, contact.normal[0], contact.normal[1], contact.normal[2]];
        for (k, out) in out.iter_mut().enumerate() {
            *out = parts.get(k).copied().unwrap_or(0.0);
        }
    }
}

fn corners(checked: &Checked, triangle: usize) -> [[f64; 3]; 3] {
    checked.triangles[triangle].map(|v| checked.vertices[v as usize])
}

fn weighted(values: [[f64; 3]; 3], weights: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| weights[k] * values[k][i]).sum())
}

fn middle(at: [[f64; 3]; 3]) -> [f64; 3] {
    weighted(at, [1.0 / 3.0; 3])
}

fn circumradius(at: [[f64; 3]; 3]) -> f64 {
    let product: f64 = (0..3).map(|i| squared(minus(at[(i + 1) % 3], at[i]))).product();
    product.sqrt() / (2.0 * squared(doubled_area(at)).sqrt())
}

/// Six times the volume, positive where the triangles run counterclockwise seen from outside.
fn volume(checked: &Checked) -> f64 {
    let origin = checked.vertices[0];
    let part = |i| {
        let at = corners(checked, i);
        dot(doubled_area(at), minus(at[0], origin))
    };
    (0..checked.triangles.len()).map(part).sum()
}

fn turn_over(checked: &mut Checked) {
    for (corners, neighbours) in checked.triangles.iter_mut().zip(&mut checked.neighbours) {
        corners.swap(1, 2);
        // edges 0-1, 1-2, 2-0 become 0-2, 2-1, 1-0
        neighbours.swap(0, 2);
    }
}

/// Means of the triangles' normals, weighted by their angle at the vertex.
fn vertex_normals(checked: &Checked, faces: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; checked.vertices.len()];
    for (i, vertices) in checked.triangles.iter().enumerate() {
        let at = corners(checked, i);
        for k in 0..3 {
            let (a, b) = (unit(minus(at[(k + 1) % 3], at[k])), unit(minus(at[(k + 2) % 3], at[k])));
            let angle = dot(a, b).clamp(-1.0, 1.0).acos();
            let sum = &mut sums[vertices[k] as usize];
            *sum = [0, 1, 2].map(|j| sum[j] + angle * faces[i][j]);
        }
    }
    sums.into_iter().map(unit).collect()
}
