//! `[[surface]]` of triangles: from a file, made from sizes, or through the points of a table.
//!
//! Parry is behind the feature `mesh`; without it, and in a scene without a mesh, nothing of it is called.

use super::surfaces::Ground;
use crate::build::{Builder, Made};
use crate::place::Diagnostic;
use crate::scene::Element as SceneElement;

/// How far triangles may be from the smooth surface that they stand for.
#[derive(Clone, Debug)]
pub(super) struct FacetErrors {
    pub(super) triangles: usize,
    /// m
    pub(super) depth: f64,
    /// rad
    pub(super) normal: f64,
}

impl<'g> Builder<'_, 'g> {
    /// Triangles have no curvature: nothing rolls on them, and nothing hits them hard.
    pub(super) fn must_be_smooth(&mut self, ground: &Ground<'g>, what: &str, element: &SceneElement) -> Made<()> {
        let Some(FacetErrors { triangles, .. }) = ground.facets() else { return Ok(()) };
        let message = format!(
            "{what} needs a smooth surface, and this one has {triangles} triangles, whose normals jump; give a `[[contact]]` \
             with `stiffness`, or a surface by its sizes, by `profile` or by `height`"
        );
        Err(self.low.report(element.place.clone(), message))
    }

    /// Tells how far the triangles may be from what they stand for.
    pub(super) fn tell_facets(&mut self, name: &str, ground: &Ground<'g>, element: &SceneElement) {
        let Some(FacetErrors { triangles, depth, normal }) = ground.facets() else { return };
        let message = format!(
            "`{name}` touches {triangles} triangles; against a smooth surface through their corners the depth is wrong by up \
             to {depth:.1e} m and the normal by {:.1e} deg",
            normal.to_degrees()
        );
        self.parts.warnings.push(Diagnostic { place: element.place.clone(), message });
    }

    #[cfg(not(feature = "mesh"))]
    pub(super) fn triangles(
        &mut self,
        _: &str,
        element: &SceneElement,
        _: &crate::symbols::Binding,
    ) -> Made<Ground<'g>> {
        let place = element.get("shape").map_or(&element.place, |v| &v.place).clone();
        Err(self.low.report(place, "this program was built without meshes; build it with the feature `mesh`"))
    }
}

#[cfg(feature = "mesh")]
mod with_parry {
    use std::io::BufReader;
    use std::path::Path;
    use std::sync::Arc;

    use headland_expr::Field;
    use headland_surface::mesh::{MeshError, Soup, icosphere, raw_heights, read_obj, read_stl};
    use headland_surface::{Mesh, MeshOptions, Shape, Side};

    use super::{Builder, Ground, Made, SceneElement};
    use crate::dimension::Dimension;
    use crate::scene::{Data, Value};
    use crate::symbols::{Binding, Symbol};

    /// Most parts into which an edge of the icosahedron is divided: 20 times its square are the triangles.
    const MOST: f64 = 1000.0;

    fn is_set(element: &SceneElement, key: &str) -> bool {
        matches!(element.get(key).map(|v| &v.data), Some(Data::Flag(true)))
    }

    impl<'g> Builder<'_, 'g> {
        /// From `file`, from `radius` and `density`, or from `table`.
        pub(in crate::assembly) fn triangles(
            &mut self,
            name: &str,
            element: &SceneElement,
            binding: &Binding,
        ) -> Made<Ground<'g>> {
            let of = ["file", "radius", "table"].map(|key| element.get(key).cloned());
            let mut sphere = None;
            let (soup, value) = match of {
                [Some(file), None, None] => (self.triangles_of_file(name, &file)?, file),
                [None, None, Some(table)] => (self.triangles_of_table(&table)?, table),
                [None, Some(radius), None] => {
                    let (number, soup) = self.triangles_of_sphere(element, binding)?;
                    sphere = Some(number);
                    (soup, radius)
                }
                _ => {
                    let message = "a mesh is given by one of `file`, `radius` with `density`, and `table`";
                    return Err(self.low.report(element.place.clone(), message));
                }
            };
            if sphere.is_none() {
                self.without(element, &["density"], "it belongs to a sphere made of triangles, with `radius`")?;
            }
            let side = if is_set(element, "inside") { Side::Inside } else { Side::Outside };
            let open = is_set(element, "open") || element.get("table").is_some();
            let options = MeshOptions { side, open, smooth: is_set(element, "smooth") };
            let mesh = Mesh::new(name, &soup, options).map_err(|error| {
                let help = if matches!(error, MeshError::Open { .. }) { " (`open = true` allows it)" } else { "" };
                self.low.report(value.place.clone(), format!("{error}{help}"))
            })?;
            let errors = match sphere {
                Some(radius) => mesh.error_against(&Shape::Sphere { radius, side }),
                None => mesh.error(),
            };
            let errors = super::FacetErrors { triangles: mesh.len(), depth: errors.depth, normal: errors.normal };
            let field: Arc<dyn Field> = Arc::new(mesh);
            Ok(Ground::of_facets(field, errors))
        }

        fn triangles_of_file(&mut self, name: &str, value: &Value) -> Made<Soup> {
            let Data::Text(file) = &value.data else {
                let message = format!("`file` is {}; a name such as `\"bowl.stl\"` was expected", value.data.kind());
                return Err(self.low.report(value.place.clone(), message));
            };
            let folder = Path::new(&*self.scene.source.name).parent().unwrap_or(Path::new(""));
            let path = folder.join(file);
            let source = std::fs::File::open(&path).map_err(|error| {
                let message =
                    format!("cannot read `{}` (names count from the scene's folder): {error}", path.display());
                self.low.report(value.place.clone(), message)
            })?;
            let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
            let source = BufReader::new(source);
            let soup = match ending.as_str() {
                "obj" => read_obj(name, source),
                "stl" => read_stl(name, source),
                _ => {
                    let message = format!("`{file}` is neither a Wavefront OBJ file, `.obj`, nor an STL file, `.stl`");
                    return Err(self.low.report(value.place.clone(), message));
                }
            };
            soup.map_err(|error| self.low.report(value.place.clone(), format!("{}: {error}", path.display())))
        }

        /// Two triangles to a cell of a table of two variables.
        fn triangles_of_table(&mut self, value: &Value) -> Made<Soup> {
            let found = match &value.data {
                Data::Text(table) => self.low.symbols.by_name.get(table.as_str()),
                _ => None,
            };
            let Some(Symbol::Field(grid, _)) = found else {
                let message = "`table` names a table of two variables, under [tables]";
                return Err(self.low.report(value.place.clone(), message));
            };
            let (origin, spacing, heights) = grid.points();
            Ok(raw_heights(origin, spacing, &heights))
        }

        fn triangles_of_sphere(&mut self, element: &SceneElement, binding: &Binding) -> Made<(f64, Soup)> {
            let radius = self.length(element, "radius", binding)?;
            let radius = self.evaluate(radius).unwrap_or(f64::NAN);
            let Some(value) = element.get("density") else {
                return Err(self.lacks(element, "`density`: parts of an edge of the icosahedron that it is made of"));
            };
            let density = self.expression(value, "`density`", binding, &Dimension::NONE, false)?;
            match self.evaluate(density) {
                Some(n) if (1.0..=MOST).contains(&n) && n.fract() == 0.0 => Ok((radius, icosphere(radius, n as usize))),
                found => {
                    let found = found.map_or("no number".to_string(), |n| n.to_string());
                    let message = format!("`density` is {found}; a whole number from 1 to {MOST} was expected");
                    Err(self.low.report(value.place.clone(), message))
                }
            }
        }
    }
}
