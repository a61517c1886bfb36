//! [`Surface`]: one question to every kind of surface, answered by numbers.

use std::sync::Arc;

use headland_expr::Field;
use headland_spatial::Vector;

#[cfg(feature = "mesh")]
use crate::mesh::Mesh;
use crate::shape::Shape;

/// A surface of any kind, in the axes of its frame.
#[derive(Clone, Debug)]
pub enum Surface {
    /// In closed form.
    Shape(Shape<f64>),
    /// By a field of signed distance: ellipsoid, surface of revolution, ground, or one's own.
    Field(Arc<dyn Field>),
    /// Triangles.
    #[cfg(feature = "mesh")]
    Mesh(Arc<Mesh>),
}

/// Where a surface is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Signed distance, m: positive on the free side.
    pub distance: f64,
    /// Nearest point of the surface, m.
    pub foot: [f64; 3],
    /// Unit normal there, towards the free side.
    pub normal: [f64; 3],
    /// Principal curvatures there, 1/m, the smaller first: negative where the surface is hollow seen from the free side, `−1/R`
    /// in a spherical recess. Triangles have none.
    pub curvatures: Option<[f64; 2]>,
}

/// Why a surface has no contact with a point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A point without coordinates.
    #[error("the point asked is {point:?} m; it must be finite")]
    NotFinite {
        /// The point, m.
        point: [f64; 3],
    },
    /// In the centre of a recess, on an axis: many points of the surface are equally near.
    #[error("at {point:?} m several points of the surface are equally near, {distance} m away; it has no normal there")]
    Ambiguous {
        /// The point, m.
        point: [f64; 3],
        /// Signed distance, m.
        distance: f64,
    },
    /// Beyond an edge, or no nearest point was found.
    #[error("the surface has no nearest point at {point:?} m: it may end there, or many points are equally near")]
    NoFoot {
        /// The point, m.
        point: [f64; 3],
    },
}

impl From<Shape<f64>> for Surface {
    fn from(shape: Shape<f64>) -> Self {
        Surface::Shape(shape)
    }
}

impl Surface {
    /// Nearest point, distance, normal and curvatures.
    ///
    /// # Errors
    /// [`ContactError`]: never a number that is none.
    pub fn query(&self, point: [f64; 3]) -> Result<Contact, ContactError> {
        if point.iter().any(|x| !x.is_finite()) {
            return Err(ContactError::NotFinite { point });
        }
        match self {
            Surface::Shape(shape) => {
                let c = Vector(point);
                let columns =
                    [0, 1, 2].map(|i| shape.normal_rate(c, Vector([0, 1, 2].map(|j| f64::from(u8::from(i == j))))));
                let h = |i: usize, j: usize| columns[j][i];
                contact(point, shape.distance(c), shape.normal(c).0, h)
            }
            Surface::Field(field) => {
                let mut all = [0.0; 10];
                field.eval(point, 2, &mut all);
                let h = |i: usize, j: usize| all[[[4, 5, 6], [5, 7, 8], [6, 8, 9]][i][j]];
                contact(point, all[0], [all[1], all[2], all[3]], h)
            }
            #[cfg(feature = "mesh")]
            Surface::Mesh(mesh) => mesh.query(point),
        }
    }

    /// The box that holds all of it, m, `[from, to]` along x, y and z; `None` where it has no end or is not known.
    pub fn extent(&self) -> Option<[[f64; 2]; 3]> {
        match *self {
            Surface::Shape(Shape::Sphere { radius, .. }) => Some([[-radius, radius]; 3]),
            Surface::Shape(Shape::Torus { radius, tube, .. }) => {
                let reach = radius + tube;
                Some([[-reach, reach], [-reach, reach], [-tube, tube]])
            }
            #[cfg(feature = "mesh")]
            Surface::Mesh(ref mesh) => Some(mesh.extent()),
            _ => None,
        }
    }
}

/// From distance, normal and the normal's gradient `h` at a point.
fn contact(
    point: [f64; 3],
    distance: f64,
    normal: [f64; 3],
    h: impl Fn(usize, usize) -> f64,
) -> Result<Contact, ContactError> {
    if !distance.is_finite() {
        return Err(ContactError::NoFoot { point });
    }
    if normal.iter().any(|x| !x.is_finite()) {
        return Err(ContactError::Ambiguous { point, distance });
    }
    let foot = [0, 1, 2].map(|i| point[i] - distance * normal[i]);
    let n = Vector(normal);
    // any direction across the normal, from the axis that is most across it
    let least = (0..3).min_by(|&i, &j| n[i].abs().total_cmp(&n[j].abs())).unwrap_or(0);
    let u = n.cross(Vector([0, 1, 2].map(|i| f64::from(u8::from(i == least))))).unit();
    let v = n.cross(u);
    let of = |a: Vector<f64>, b: Vector<f64>| {
        (0..3).map(|i| (0..3).map(|j| a[i] * h(i, j) * b[j]).sum::<f64>()).sum::<f64>()
    };
    let (mean, half, both) = (0.5 * (of(u, u) + of(v, v)), 0.5 * (of(u, u) - of(v, v)), of(u, v));
    let spread = half.hypot(both);
    // back from the parallel surface through the point
    let curvatures = [mean - spread, mean + spread].map(|k| k / (1.0 - distance * k));
    let curvatures = curvatures.iter().all(|k| k.is_finite()).then_some(curvatures);
    let curvatures = curvatures.map(|[a, b]| [a.min(b), a.max(b)]);
    Ok(Contact { distance, foot, normal, curvatures })
}
