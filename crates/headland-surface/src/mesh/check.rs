//! What makes triangles a surface.

use std::collections::HashMap;

/// Why triangles make no surface. Triangles and vertices count from 0, as in the lists that were given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No triangles at all.
    #[error("the mesh `{name}` has no triangles")]
    Empty {
        /// Name of the mesh.
        name: String,
    },
    /// A vertex without coordinates.
    #[error("vertex {vertex} of the mesh `{name}` is {at:?} m; it must be finite")]
    Vertex {
        /// Name of the mesh.
        name: String,
        /// The vertex.
        vertex: usize,
        /// Where, m.
        at: [f64; 3],
    },
    /// A triangle with a vertex that is not there.
    #[error("triangle {triangle} of the mesh `{name}` asks for vertex {vertex}, but there are {vertices}")]
    NoVertex {
        /// Name of the mesh.
        name: String,
        /// The triangle.
        triangle: usize,
        /// The vertex.
        vertex: usize,
        /// How many there are.
        vertices: usize,
    },
    /// A triangle without area.
    #[error("triangle {triangle} of the mesh `{name}` has no area, its corners are {corners:?} m; remove it")]
    Degenerate {
        /// Name of the mesh.
        name: String,
        /// The triangle.
        triangle: usize,
        /// Its corners, m.
        corners: [[f64; 3]; 3],
    },
    /// Two neighbours that turn opposite ways.
    #[error(
        "triangles {first} and {second} of the mesh `{name}` turn opposite ways round their common edge; \
         turn one of them, so that all run counterclockwise seen from one side"
    )]
    Orientation {
        /// Name of the mesh.
        name: String,
        /// A triangle.
        first: usize,
        /// Its neighbour.
        second: usize,
    },
    /// An edge of more than two triangles.
    #[error("triangles {triangles:?} of the mesh `{name}` share one edge; an edge can have two triangles at most")]
    Branching {
        /// Name of the mesh.
        name: String,
        /// The triangles.
        triangles: Vec<usize>,
    },
    /// A hole, where the surface must be closed.
    #[error(
        "the mesh `{name}` is open: {edges} edge(s) have one triangle only, the first of triangle {triangle}; close it, or \
         allow it to be open, and the free side is where its triangles run counterclockwise"
    )]
    Open {
        /// Name of the mesh.
        name: String,
        /// Edges with one triangle.
        edges: usize,
        /// The first triangle with such an edge.
        triangle: usize,
    },
    /// A file that cannot be read.
    #[error("the mesh `{name}` cannot be read: {reason}")]
    Read {
        /// Name of the mesh.
        name: String,
        /// Why.
        reason: String,
    },
}

/// Triangles of a surface that turn the same way, and where it ends.
pub(super) struct Checked {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the neighbour across the edge after each corner.
    pub neighbours: Vec<[Option<usize>; 3]>,
}

/// An edge of no neighbour is allowed only if `open`.
pub(super) fn check(
    name: &str,
    vertices: &[[f64; 3]],
    triangles: &[[usize; 3]],
    open: bool,
) -> Result<Checked, MeshError> {
    let name = || name.to_string();
    if triangles.is_empty() {
        return Err(MeshError::Empty { name: name() });
    }
    if let Some(vertex) = vertices.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(MeshError::Vertex { name: name(), vertex, at: vertices[vertex] });
    }
    let (vertices, renumbered) = merged(vertices);
    let mut all = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v >= renumbered.len()) {
            return Err(MeshError::NoVertex { name: name(), triangle, vertex, vertices: renumbered.len() });
        }
        let corners = corners.map(|v| renumbered[v]);
        let at = corners.map(|v| vertices[v as usize]);
        let longest = (0..3).map(|i| squared(minus(at[(i + 1) % 3], at[i]))).fold(0.0, f64::max);
        if squared(doubled_area(at)) <= 1e-24 * longest * longest {
            return Err(MeshError::Degenerate { name: name(), triangle, corners: at });
        }
        all.push(corners);
    }
    let neighbours = neighbours(&name, &all)?;
    if !open {
        let open_edges = |n: &[Option<usize>; 3]| n.iter().filter(|x| x.is_none()).count();
        let edges = neighbours.iter().map(open_edges).sum();
        if let Some(triangle) = neighbours.iter().position(|n| open_edges(n) > 0) {
            return Err(MeshError::Open { name: name(), edges, triangle });
        }
    }
    Ok(Checked { vertices, triangles: all, neighbours })
}

/// Vertices in the same place are one; formats such as STL repeat them for each triangle.
fn merged(vertices: &[[f64; 3]]) -> (Vec<[f64; 3]>, Vec<u32>) {
    let mut known = HashMap::new();
    let mut kept = Vec::new();
    let numbers = vertices.iter().map(|p| {
        // + 0.0: minus zero is zero
        *known.entry(p.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
            kept.push(*p);
            kept.len() as u32 - 1
        })
    });
    let numbers = numbers.collect();
    (kept, numbers)
}

fn neighbours(name: &impl Fn() -> String, triangles: &[[u32; 3]]) -> Result<Vec<[Option<usize>; 3]>, MeshError> {
    let mut sides: HashMap<[u32; 2], Vec<(usize, usize)>> = HashMap::new();
    let ends = |triangle: usize, k: usize| [triangles[triangle][k], triangles[triangle][(k + 1) % 3]];
    for triangle in 0..triangles.len() {
        for k in 0..3 {
            let [a, b] = ends(triangle, k);
            sides.entry([a.min(b), a.max(b)]).or_default().push((triangle, k));
        }
    }
    let mut all = vec![[None; 3]; triangles.len()];
    for triangle in 0..triangles.len() {
        for k in 0..3 {
            let [a, b] = ends(triangle, k);
            match sides[&[a.min(b), a.max(b)]][..] {
                [_] => {}
                [(first, i), (second, j)] if ends(first, i) == ends(second, j) => {
                    return Err(MeshError::Orientation { name: name(), first, second });
                }
                [(first, _), (second, _)] => all[triangle][k] = Some(if first == triangle { second } else { first }),
                ref more => {
                    let triangles = more.iter().map(|(triangle, _)| *triangle).collect();
                    return Err(MeshError::Branching { name: name(), triangles });
                }
            }
        }
    }
    Ok(all)
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn squared(a: [f64; 3]) -> f64 {
    dot(a, a)
}

pub(super) fn unit(a: [f64; 3]) -> [f64; 3] {
    let size = squared(a).sqrt();
    a.map(|x| x / size)
}

/// Normal of a triangle, counterclockwise seen from its tip; its length is twice the area.
pub(super) fn doubled_area(at: [[f64; 3]; 3]) -> [f64; 3] {
    let (u, v) = (minus(at[1], at[0]), minus(at[2], at[0]));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}
