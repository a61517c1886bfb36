//! Meshes from files: Wavefront OBJ and STL.

use std::io::{BufRead, Read, Seek};

use super::{MeshError, Soup};

/// Triangles of a Wavefront OBJ file: all its objects together, polygons cut into triangles, materials passed over.
///
/// # Errors
/// [`MeshError::Read`].
pub fn read_obj(name: &str, mut source: impl BufRead) -> Result<Soup, MeshError> {
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut source, &options, |_| Ok(Default::default()))
        .map_err(|e| MeshError::Read { name: name.into(), reason: e.to_string() })?;
    let mut all = Soup::default();
    for model in models {
        let first = all.vertices.len();
        all.vertices.extend(model.mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
        let corners = |t: &[u32]| [t[0], t[1], t[2]].map(|v| first + v as usize);
        all.triangles.extend(model.mesh.indices.chunks_exact(3).map(corners));
    }
    Ok(all)
}

/// Triangles of an STL file, text or binary. STL keeps single precision: seven digits.
///
/// # Errors
/// [`MeshError::Read`].
pub fn read_stl(name: &str, mut source: impl Read + Seek) -> Result<Soup, MeshError> {
    let mesh =
        stl_io::read_stl(&mut source).map_err(|e| MeshError::Read { name: name.into(), reason: e.to_string() })?;
    let vertices = mesh.vertices.iter().map(|p| [0, 1, 2].map(|i| f64::from(p[i]))).collect();
    Ok(Soup { vertices, triangles: mesh.faces.iter().map(|face| face.vertices).collect() })
}
