//! Meshes: exact where flat, of the orders that theory says where curved, and refused where they are no surface.
#![cfg(feature = "mesh")]

mod common;

use std::sync::Arc;

use common::points;
use headland_spatial::Vector;
use headland_surface::mesh::{
    HANDFUL, Scene, Soup, icosphere, raw_heights, read_obj, read_stl, recess_query, uv_sphere,
};
use headland_surface::{ContactError, Grid, Height, Mesh, MeshError, MeshOptions, Shape, Side, Surface};

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn directions(count: usize) -> impl Iterator<Item = [f64; 3]> {
    points(3 * count, [1.0; 3])
        .filter(|c| (0.1..1.0).contains(&length(*c)))
        .map(|c| c.map(|x| x / length(c)))
        .take(count)
}

fn options(side: Side) -> MeshOptions {
    MeshOptions { side, ..MeshOptions::default() }
}

/// A cube of edge 2 about the origin, counterclockwise seen from outside.
fn cube() -> Soup {
    let vertices = (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { 1.0 } else { -1.0 })).collect();
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = squares.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Soup { vertices, triangles }
}

#[test]
fn distance_from_a_cube_is_exact_at_faces_edges_and_corners() {
    let exact = |c: [f64; 3]| {
        let out = c.map(|x| (x.abs() - 1.0).max(0.0));
        let deepest = c.iter().map(|x| x.abs() - 1.0).fold(f64::NEG_INFINITY, f64::max);
        if deepest > 0.0 { length(out) } else { deepest }
    };
    let mut inside_out = cube();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 2));
    for soup in [cube(), inside_out] {
        for (side, sign) in [(Side::Outside, 1.0), (Side::Inside, -1.0)] {
            let mesh = Mesh::new("cube", &soup, options(side)).unwrap();
            assert_eq!(mesh.extent(), [[-1.0, 1.0]; 3]);
            let more = [[2.0, 2.0, 2.0], [-1.5, 0.0, 1.5], [1.0, 0.2, 0.3], [3.0, 1.0, 1.0]];
            for c in points(300, [2.0; 3]).chain(more) {
                let contact = mesh.query(c).unwrap();
                assert!((contact.distance - sign * exact(c)).abs() < 1e-14, "{c:?} {contact:?}");
                assert!((length(contact.normal) - 1.0).abs() < 1e-12);
                let back = [0, 1, 2].map(|i| contact.foot[i] + contact.distance * contact.normal[i]);
                assert!(length(minus(back, c)) < 1e-14);
            }
        }
    }
}

/// Depth and normal of the ball's centre against the exact recess.
fn worst(mesh: &Mesh, exact: &Shape<f64>, at: f64) -> [f64; 2] {
    let mut worst = [0.0f64; 2];
    for e in directions(1500) {
        let c = e.map(|x| at * x);
        let found = mesh.query(c).unwrap();
        worst[0] = worst[0].max((found.distance - exact.distance(Vector(c))).abs());
        worst[1] = worst[1].max(length(minus(found.normal, exact.normal(Vector(c)).0)));
    }
    worst
}

#[test]
fn depth_is_of_order_two_and_normal_of_order_one() {
    for side in [Side::Inside, Side::Outside] {
        let exact = Shape::Sphere { radius: 1.0, side };
        let at = if side == Side::Inside { 0.701 } else { 1.299 };
        for make in [(|n| icosphere(1.0, n)) as fn(usize) -> Soup, |n| uv_sphere(1.0, 3 * n, 6 * n)] {
            let errors = [6, 12, 24].map(|n| worst(&Mesh::new("m", &make(n), options(side)).unwrap(), &exact, at));
            for k in 0..2 {
                let orders = [(errors[0][0] / errors[1][0]).log2(), (errors[1][0] / errors[2][0]).log2()];
                assert!((orders[k] - 2.0).abs() < 0.15, "depth {orders:?}");
                let orders = [(errors[0][1] / errors[1][1]).log2(), (errors[1][1] / errors[2][1]).log2()];
                assert!((orders[k] - 1.0).abs() < 0.15, "normal {orders:?}");
            }
        }
    }
}

#[test]
fn the_error_told_is_the_error_found() {
    let exact = Shape::Sphere { radius: 1.0, side: Side::Inside };
    for n in [5, 10, 20] {
        let mesh = Mesh::new("m", &icosphere(1.0, n), options(Side::Inside)).unwrap();
        assert_eq!(mesh.len(), 20 * n * n);
        let (estimate, measured, found) = (mesh.error(), mesh.error_against(&exact), worst(&mesh, &exact, 0.7));
        for (k, (a, b)) in
            [(estimate.depth, measured.depth), (estimate.normal, measured.normal)].into_iter().enumerate()
        {
            assert!((0.95..1.6).contains(&(a / b)), "estimate {a}, measured {b}");
            assert!((0.6..1.01).contains(&(found[k] / b)), "found {}, measured {b}", found[k]);
        }
        assert_eq!(estimate.edge, measured.edge);
    }
    let flat = Mesh::new("f", &raw_heights([0.0; 2], [1.0; 2], &[vec![0.0; 3], vec![0.0; 3]]), open()).unwrap();
    assert_eq!((flat.error().depth, flat.error().normal), (0.0, 0.0));
}

#[test]
fn smooth_normals_are_nearer() {
    let exact = Shape::Sphere { radius: 1.0, side: Side::Inside };
    let soup = icosphere(1.0, 12);
    let plain = Mesh::new("m", &soup, options(Side::Inside)).unwrap();
    let smooth = Mesh::new("m", &soup, MeshOptions { smooth: true, ..options(Side::Inside) }).unwrap();
    // near the surface the foot is right, and with it the normal
    let [a, b] = [worst(&plain, &exact, 0.98), worst(&smooth, &exact, 0.98)];
    assert_eq!(a[0], b[0]);
    assert!(b[1] < 0.1 * a[1], "{a:?} {b:?}");
    // farther away the foot jumps with the triangles, and the normal by distance over radius of it
    let [a, b] = [worst(&plain, &exact, 0.7), worst(&smooth, &exact, 0.7)];
    assert!(b[1] < 0.45 * a[1], "{a:?} {b:?}");
}

#[test]
fn parry_s_recess_is_the_closed_form() {
    for radius in [1.0, 0.37] {
        let exact = Surface::from(Shape::Sphere { radius, side: Side::Inside });
        for (i, e) in directions(1000).enumerate() {
            let c = e.map(|x| x * radius * (i as f64 + 0.5) / 1000.0);
            let (a, b) = (recess_query(radius, c).unwrap(), exact.query(c).unwrap());
            assert!((a.distance - b.distance).abs() <= 2.3e-16, "{} {}", a.distance, b.distance);
            for k in 0..3 {
                assert!((a.normal[k] - b.normal[k]).abs() <= 2.3e-16 && (a.foot[k] - b.foot[k]).abs() <= 2.3e-16);
            }
            for (p, q) in a.curvatures.unwrap().iter().zip(b.curvatures.unwrap()) {
                assert!((p - q).abs() < 1e-12 * q.abs(), "{p} {q}");
            }
        }
        let centre = recess_query(radius, [0.0; 3]).unwrap_err();
        assert_eq!(centre, ContactError::Ambiguous { point: [0.0; 3], distance: radius });
        assert_eq!(exact.query([0.0; 3]), Err(centre));
    }
    assert!(matches!(recess_query(1.0, [f64::NAN; 3]), Err(ContactError::NotFinite { .. })));
}

fn open() -> MeshOptions {
    MeshOptions { open: true, ..MeshOptions::default() }
}

#[test]
fn open_meshes_are_refused_or_end() {
    let mut bowl = icosphere(1.0, 4);
    bowl.triangles.retain(|t| t.iter().all(|&v| bowl.vertices[v][2] < 0.3));
    // counterclockwise seen from inside, where it is free
    bowl.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let refused = Mesh::new("bowl", &bowl, MeshOptions::default()).unwrap_err();
    assert!(matches!(refused, MeshError::Open { edges, .. } if edges > 5), "{refused}");
    let mesh = Arc::new(Mesh::new("bowl", &bowl, open()).unwrap());
    let inside = Surface::Mesh(mesh.clone()).query([0.1, 0.2, -0.6]).unwrap();
    assert!((inside.distance - 0.3).abs() < 0.1 && inside.normal[2] > 0.5 && inside.curvatures.is_none());
    assert!(mesh.query([0.1, 0.2, -1.6]).unwrap().distance < -0.5);
    assert!(matches!(mesh.query([2.0, 0.0, 1.0]), Err(ContactError::NoFoot { .. })));
    assert!(matches!(mesh.query([f64::NAN; 3]), Err(ContactError::NotFinite { .. })));
}

#[test]
fn raw_heights_are_as_they_are() {
    let heights: Vec<Vec<f64>> =
        (0..9).map(|j| (0..9).map(|i| 0.1 * f64::from(i) + 0.2 * f64::from(j)).collect()).collect();
    let mesh = Mesh::new("slope", &raw_heights([-4.0, -4.0], [1.0, 1.0], &heights), open()).unwrap();
    let w = 1.05f64.sqrt();
    for c in points(100, [2.0, 2.0, 1.0]) {
        let plane = (c[2] - 1.2 - 0.1 * c[0] - 0.2 * c[1]) / w;
        assert!((mesh.query(c).unwrap().distance - plane).abs() < 1e-14);
    }
}

/// Raw heights against the smooth ground that they were taken from.
#[test]
fn raw_heights_come_nearer_with_their_density() {
    let f = |x: f64, y: f64| 0.1 * (2.0 * x).sin() * (1.5 * y).cos();
    let errors = |n: usize| {
        let h = 4.0 / n as f64;
        let at = |i: usize| -2.0 + h * i as f64;
        let heights: Vec<Vec<f64>> = (0..=n).map(|j| (0..=n).map(|i| f(at(i), at(j))).collect()).collect();
        let mesh = Mesh::new("raw", &raw_heights([-2.0; 2], [h; 2], &heights), open()).unwrap();
        let grid = Grid::new("smooth", [-2.0; 2], [h; 2], &heights).unwrap();
        let ground = Surface::Field(Arc::new(Height::new(Arc::new(grid))));
        let mut worst = [0.0f64; 2];
        for c in points(2000, [1.2, 1.2, 0.1]).map(|[x, y, z]| [x, y, z + 0.4]) {
            let (a, b) = (mesh.query(c).unwrap(), ground.query(c).unwrap());
            worst[0] = worst[0].max((a.distance - b.distance).abs());
            worst[1] = worst[1].max(length(minus(a.normal, b.normal)));
        }
        worst
    };
    let (coarse, fine) = (errors(40), errors(80));
    let orders = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
    assert!((orders[0] - 2.0).abs() < 0.2 && (orders[1] - 1.0).abs() < 0.2, "{orders:?}");
}

#[test]
fn triangles_that_are_no_surface_are_refused() {
    let made = |change: &dyn Fn(&mut Soup)| {
        let mut soup = cube();
        change(&mut soup);
        Mesh::new("cube", &soup, MeshOptions::default()).unwrap_err()
    };
    assert!(matches!(made(&|s| s.triangles.clear()), MeshError::Empty { .. }));
    assert!(matches!(made(&|s| s.vertices[3][1] = f64::INFINITY), MeshError::Vertex { vertex: 3, .. }));
    assert!(matches!(
        made(&|s| s.triangles[5][2] = 8),
        MeshError::NoVertex { triangle: 5, vertex: 8, vertices: 8, .. }
    ));
    assert!(matches!(made(&|s| s.triangles[7][1] = s.triangles[7][0]), MeshError::Degenerate { triangle: 7, .. }));
    let needle = made(&|s| {
        s.vertices.extend([[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]);
        s.triangles.push([8, 9, 10]);
    });
    assert!(needle.to_string().starts_with("triangle 12 of the mesh `cube` has no area, its corners are"), "{needle}");
    let turned = made(&|s| s.triangles[4].swap(0, 1));
    // one of its neighbours, whichever edge is found first
    assert!(matches!(turned, MeshError::Orientation { first, second, .. } if first == 4 || second == 4), "{turned}");
    let open = made(&|s| {
        s.triangles.pop();
    });
    assert_eq!(
        open.to_string(),
        "the mesh `cube` is open: 3 edge(s) have one triangle only, the first of triangle 2; close it, or allow it to be \
         open, and the free side is where its triangles run counterclockwise"
    );
    let branching = made(&|s| {
        s.vertices.push([0.0, 0.0, 3.0]);
        s.triangles.push([4, 5, 8]);
    });
    assert!(matches!(branching, MeshError::Branching { .. }), "{branching}");
}

#[test]
fn meshes_are_read_from_files() {
    let mut obj = String::from("# a cube\nmtllib none.mtl\no cube\n");
    for v in cube().vertices {
        obj += &format!("v {} {} {}\n", v[0], v[1], v[2]);
    }
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        obj += &format!("f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1);
    }
    let soup = cube();
    let mut stl = String::from("solid cube\n");
    for t in &soup.triangles {
        stl += "facet normal 0 0 0\nouter loop\n";
        for &v in t {
            let p = soup.vertices[v];
            stl += &format!("vertex {} {} {}\n", p[0], p[1], p[2]);
        }
        stl += "endloop\nendfacet\n";
    }
    stl += "endsolid cube\n";
    let read = [read_obj("cube", obj.as_bytes()).unwrap(), read_stl("cube", std::io::Cursor::new(&stl)).unwrap()];
    for soup in read {
        let mesh = Mesh::new("cube", &soup, MeshOptions::default()).unwrap();
        assert_eq!((mesh.len(), mesh.query([0.1, 0.2, 3.0]).unwrap().distance), (12, 2.0));
    }
    assert!(matches!(read_obj("m", "v 1 2\n".as_bytes()), Err(MeshError::Read { .. })));
    assert!(matches!(read_obj("m", "v 1 2 3\nf 1 2 7\n".as_bytes()), Err(MeshError::Read { .. })));
    assert!(matches!(read_stl("m", std::io::Cursor::new("nonsense")), Err(MeshError::Read { .. })));
    assert!(matches!(Mesh::new("m", &read_obj("m", "".as_bytes()).unwrap(), open()), Err(MeshError::Empty { .. })));
}

/// The tree finds what looking at each box finds.
#[test]
fn candidates_are_all_boxes_in_reach() {
    for count in [3, HANDFUL, HANDFUL + 1, 60] {
        let boxes: Vec<Option<[[f64; 2]; 3]>> = points(count, [5.0; 3])
            .enumerate()
            .map(|(i, c)| (i % 7 != 3).then(|| c.map(|x| [x - 0.5, x + 0.7])))
            .collect();
        let scene = Scene::new(&boxes);
        for c in points(100, [6.0; 3]) {
            let reach = 0.4;
            let meets = |b: &[[f64; 2]; 3]| (0..3).all(|k| b[k][0] <= c[k] + reach && c[k] - reach <= b[k][1]);
            let all: Vec<usize> = (0..count).filter(|&i| boxes[i].as_ref().is_none_or(meets)).collect();
            assert_eq!(scene.candidates(c, reach), all);
        }
    }
}
