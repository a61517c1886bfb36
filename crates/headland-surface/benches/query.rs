//! Time of one question to each kind of surface: distance, normal and curvatures, and for fields all third derivatives.
//!
//! With triangles: `cargo bench -p headland-surface --features mesh`.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use headland_expr::Field;
use headland_surface::{Ellipsoid, Function, Grid, Height, Revolution, Shape, Side, Surface};

/// Places inside of a unit sphere and above ground.
fn places() -> Vec<[f64; 3]> {
    let at = |i: usize, g: f64| (0.5 + i as f64 * g).fract() - 0.5;
    (0..256).map(|i| [at(i, 0.819_172_5), at(i, 0.671_043_6), 0.6 + 0.2 * at(i, 0.549_700_5)]).collect()
}

fn query(c: &mut Criterion, name: &str, surface: &Surface) {
    let (places, mut i) = (places(), 0);
    c.bench_function(&format!("query/{name}"), |b| {
        b.iter(|| {
            i = (i + 1) % places.len();
            surface.query(black_box(places[i]))
        });
    });
}

fn field(c: &mut Criterion, name: &str, field: Arc<dyn Field>) {
    let (places, mut i) = (places(), 0);
    let mut out = [0.0; 20];
    c.bench_function(&format!("third/{name}"), |b| {
        b.iter(|| {
            i = (i + 1) % places.len();
            field.eval(black_box(places[i]), 3, &mut out);
            out[19]
        });
    });
    query(c, name, &Surface::Field(field));
}

fn shapes(c: &mut Criterion) {
    let side = Side::Inside;
    query(c, "plane", &Shape::Plane.into());
    query(c, "sphere", &Shape::Sphere { radius: 1.0, side }.into());
    query(c, "cylinder", &Shape::Cylinder { radius: 1.0, side }.into());
    query(c, "cone", &Shape::Cone { half_angle: 0.7, side }.into());
    query(c, "torus", &Shape::Torus { radius: 1.0, tube: 0.3, side: Side::Outside }.into());
}

/// `0.1 sin(2x) cos(2y)`.
fn waves(x: f64, y: f64) -> [f64; 10] {
    let ((s, c), (p, q)) = ((2.0 * x).sin_cos(), (2.0 * y).sin_cos());
    let first = [s * q, 2.0 * c * q, -2.0 * s * p, -4.0 * s * q, -4.0 * c * p, -4.0 * s * q];
    let third = [-8.0 * c * q, 8.0 * s * p, -8.0 * c * q, 8.0 * s * p];
    std::array::from_fn(|i| 0.1 * if i < 6 { first[i] } else { third[i - 6] })
}

fn fields(c: &mut Criterion) {
    let ellipsoid = Ellipsoid::new("ellipsoid", [1.2, 1.0, 1.4], Side::Inside).expect("sizes are right");
    field(c, "ellipsoid", Arc::new(ellipsoid));
    let bowl = |r: f64| [0.5 * r * r, r, 1.0, 0.0];
    let bowl = Revolution::of_height("bowl", Box::new(bowl), [0.0, 3.0]).expect("profile is right");
    field(c, "revolution", Arc::new(bowl));
    let ground = Function::new("waves", Box::new(waves), [0.2, 0.4, 1.6]).expect("bounds are right");
    field(c, "height", Arc::new(Height::new(Arc::new(ground))));
    let heights: Vec<Vec<f64>> = (0..101)
        .map(|j| (0..101).map(|i| waves(0.1 * f64::from(i) - 5.0, 0.1 * f64::from(j) - 5.0)[0]).collect())
        .collect();
    let grid = Grid::new("grid", [-5.0; 2], [0.1; 2], &heights).expect("heights are right");
    let near = Height::new(Arc::new(grid));
    field(c, "grid", Arc::new(near));
}

#[cfg(feature = "mesh")]
fn meshes(c: &mut Criterion) {
    use headland_surface::mesh::{icosphere, recess_query};
    use headland_surface::{Mesh, MeshOptions};
    let (all, mut i) = (places(), 0);
    c.bench_function("query/recess by parry", |b| {
        b.iter(|| {
            i = (i + 1) % all.len();
            recess_query(1.0, black_box(all[i]))
        });
    });
    for density in [8, 16, 32, 64] {
        let options = MeshOptions { side: Side::Inside, ..MeshOptions::default() };
        let mesh = Mesh::new("recess", &icosphere(1.0, density), options).expect("an icosphere is closed");
        query(c, &format!("mesh of {} triangles", mesh.len()), &Surface::Mesh(Arc::new(mesh)));
    }
}

#[cfg(not(feature = "mesh"))]
fn meshes(_: &mut Criterion) {}

criterion_group!(benches, shapes, fields, meshes);
criterion_main!(benches);
