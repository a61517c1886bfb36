//! The border to parry: nothing else of this crate sees its types.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::{PointQuery, PointQueryWithLocation};
use parry3d_f64::shape::{Ball, TriMesh, TriMeshFlags};

fn to(p: [f64; 3]) -> Vector {
    Vector::new(p[0], p[1], p[2])
}

fn from(v: Vector) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// Triangles with a tree over them.
pub(super) struct Triangles(TriMesh);

/// The nearest point of triangles.
pub(super) struct Nearest {
    pub point: [f64; 3],
    pub triangle: usize,
    /// Of the triangle's corners.
    pub weights: [f64; 3],
    /// Behind the triangles, by the angle-weighted normals of edges and corners.
    ///
    /// # References
    /// Bærentzen, Aanæs, *Signed Distance Computation Using the Angle Weighted Pseudonormal*, IEEE TVCG 11 (2005).
    pub behind: bool,
}

impl Triangles {
    /// Of vertices and triangles already checked.
    pub fn new(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self, String> {
        let vertices = vertices.iter().map(|&p| to(p)).collect();
        TriMesh::with_flags(vertices, triangles.to_vec(), TriMeshFlags::ORIENTED).map(Self).map_err(|e| e.to_string())
    }

    /// Nearest point; `None` for a point that is not finite.
    pub fn nearest(&self, point: [f64; 3]) -> Option<Nearest> {
        let (found, (triangle, location)) = self.0.project_local_point_and_get_location(to(point), false);
        let weights = location.barycentric_coordinates()?;
        let point = from(found.point);
        point.iter().all(|x| x.is_finite()).then_some(Nearest {
            point,
            triangle: triangle as usize,
            weights,
            behind: found.is_inside,
        })
    }
}

/// Nearest point of a sphere about the origin from anywhere but its centre, and how far it is: negative inside, m.
pub(super) fn project_on_ball(radius: f64, point: [f64; 3]) -> ([f64; 3], f64) {
    let (ball, point) = (Ball::new(radius), to(point));
    (from(ball.project_local_point(point, false).point), ball.distance_to_local_point(point, false))
}

/// A tree of boxes.
pub(super) struct Tree(Bvh);

impl Tree {
    pub fn new(boxes: &[[[f64; 2]; 3]]) -> Self {
        let boxes: Vec<Aabb> = boxes.iter().map(|b| aabb(*b)).collect();
        Self(Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes))
    }

    /// Numbers of the boxes that meet a box.
    pub fn meet(&self, region: [[f64; 2]; 3]) -> Vec<usize> {
        self.0.intersect_aabb(&aabb(region)).map(|i| i as usize).collect()
    }
}

fn aabb(region: [[f64; 2]; 3]) -> Aabb {
    Aabb::new(to(region.map(|r| r[0])), to(region.map(|r| r[1])))
}
