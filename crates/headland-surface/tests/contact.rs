//! One question to every kind of surface.

mod common;

use std::sync::Arc;

use common::points;
use headland_spatial::Vector;
use headland_surface::{ContactError, Ellipsoid, Function, Height, Shape, Side, Surface};

/// Curvatures of the closed forms are those of the textbooks.
#[test]
fn curvatures_are_those_of_the_surface() {
    for (side, sign) in [(Side::Inside, -1.0), (Side::Outside, 1.0)] {
        for c in points(100, [0.9; 3]).filter(|c| c[0].hypot(c[1]) > 0.2 && c[2].abs() > 0.1) {
            let rho = c[0].hypot(c[1]);
            let q = |shape: Shape<f64>| Surface::from(shape).query(c).unwrap();
            let expect = |shape: Shape<f64>, mut k: [f64; 2]| {
                let contact = q(shape);
                k.sort_by(f64::total_cmp);
                let found = contact.curvatures.unwrap();
                for i in 0..2 {
                    assert!((found[i] - k[i]).abs() < 1e-10 * k[i].abs().max(1.0), "{shape:?} {c:?}: {found:?} {k:?}");
                }
                assert!(shape.distance(Vector(contact.foot)).abs() < 1e-14);
            };
            expect(Shape::Plane, [0.0, 0.0]);
            expect(Shape::Sphere { radius: 1.2, side }, [sign / 1.2; 2]);
            expect(Shape::Cylinder { radius: 0.7, side }, [0.0, sign / 0.7]);
            let cone = Shape::Cone { half_angle: 0.5, side };
            let foot = q(cone).foot;
            if foot[2] > 1e-3 {
                expect(cone, [0.0, sign * 0.5f64.cos() / foot[0].hypot(foot[1])]);
            }
            let (major, tube) = (1.0, 0.3);
            let cos = (rho - major) / (rho - major).hypot(c[2]);
            expect(Shape::Torus { radius: major, tube, side }, [sign / tube, sign * cos / (major + tube * cos)]);
        }
    }
}

#[test]
fn fields_answer_the_same_question() {
    // z = x²/2 − y² at its saddle
    let saddle = |x: f64, y: f64| [0.5 * x * x - y * y, x, -2.0 * y, 1.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0];
    let saddle = Function::new("saddle", Box::new(saddle), [10.0, 2.0, 0.0]).unwrap();
    let ground = Surface::Field(Arc::new(Height::new(Arc::new(saddle))));
    let contact = ground.query([0.0, 0.0, 0.2]).unwrap();
    assert_eq!((contact.distance, contact.foot, contact.normal), (0.2, [0.0; 3], [0.0, 0.0, 1.0]));
    let [a, b] = contact.curvatures.unwrap();
    assert!((a + 1.0).abs() < 1e-14 && (b - 2.0).abs() < 1e-14, "{a} {b}");
    let egg = Surface::Field(Arc::new(Ellipsoid::new("egg", [1.0, 1.0, 2.0], Side::Outside).unwrap()));
    let [a, b] = egg.query([0.0, 0.0, 3.0]).unwrap().curvatures.unwrap();
    assert!((a - 2.0).abs() < 1e-12 && (b - 2.0).abs() < 1e-12);
    let [a, b] = egg.query([3.0, 0.0, 0.0]).unwrap().curvatures.unwrap();
    assert!((a - 0.25).abs() < 1e-12 && (b - 1.0).abs() < 1e-12);
}

#[test]
fn nothing_is_answered_by_nan() {
    let side = Side::Inside;
    let recess = Surface::from(Shape::Sphere { radius: 2.0, side });
    assert_eq!(recess.query([0.0; 3]), Err(ContactError::Ambiguous { point: [0.0; 3], distance: 2.0 }));
    assert!(matches!(recess.query([0.0, f64::NAN, 0.0]), Err(ContactError::NotFinite { .. })));
    let tube = Surface::from(Shape::Cylinder { radius: 2.0, side });
    assert!(matches!(tube.query([0.0, 0.0, 3.0]), Err(ContactError::Ambiguous { .. })));
    assert_eq!((recess.extent(), tube.extent()), (Some([[-2.0, 2.0]; 3]), None));
    let bowl = |x: f64, y: f64| [0.5 * (x * x + y * y), x, y, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    let bowl = Height::new(Arc::new(Function::new("bowl", Box::new(bowl), [10.0, 1.0, 0.0]).unwrap()));
    let above = [0.0, 0.0, 4.0];
    assert_eq!(Surface::Field(Arc::new(bowl)).query(above), Err(ContactError::NoFoot { point: above }));
}
