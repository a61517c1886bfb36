//! Closed loops against bodies in their own coordinates with multipliers; where a loop is cut does not matter.
#![allow(non_snake_case)]

mod machine;

use headland_dynamics::{DeriveError, DeriveOptions, derive};
use machine::loops::{bricard, four_bar, parallelogram, random_loop, rssr, slider_crank};
use machine::oracle::check;
use machine::state::{Derived, read};
use machine::{Kind, Machine, PLAIN, Push, Random, Spring};

/// Springs between points and the world, a load in the body's axes and one in the world's.
fn load(m: &mut Machine, r: &mut Random) {
    let n = m.parts.len();
    m.springs.push(Spring {
        name: "spring".into(),
        from: (n > 1).then_some(0),
        to: n - 1,
        at: r.vector(),
        to_at: r.vector(),
        stiffness: 20.0,
        damping: 3.0,
        free_length: 0.3,
    });
    for (name, own_axes) in [("own", true), ("world axes", false)] {
        let (at, force, torque) = (r.vector(), r.vector() * 5.0, r.vector());
        m.pushes.push(Push { name: name.into(), on: r.below(n), at, force, torque, own_axes });
    }
}

fn check_states(m: &Machine, r: &mut Random, states: usize) -> (f64, f64) {
    let d = Derived::new(m, &PLAIN);
    let mut worst = (0.0_f64, 0.0_f64);
    for _ in 0..states {
        let mut x = d.state(r, 0.2);
        let moment = d.moment(&mut x);
        let g = d.model.graph.eval(&d.equations.g.concat(), &x).iter().fold(0.0_f64, |a, g| a.max(g.abs()));
        assert!(g < 30.0, "{}: growth {g}", m.title);
        let (a, f) = check(m, &moment, 1e-10);
        worst = (worst.0.max(a), worst.1.max(f));
    }
    worst
}

#[test]
fn linkages_agree_with_multipliers() {
    type Make = fn(&mut Random) -> Machine;
    let makes: [(Make, usize); 5] = [(four_bar, 1), (slider_crank, 1), (rssr, 2), (parallelogram, 1), (bricard, 1)];
    for (make, freedom) in makes {
        let mut worst = (0.0_f64, 0.0_f64);
        for seed in 0..4 {
            let mut r = Random(40 + seed);
            let mut m = make(&mut r);
            m.forces = seed % 2 == 0;
            load(&mut m, &mut r);
            let d = Derived::new(&m, &PLAIN);
            assert_eq!(d.equations.kinematics.quasi.len(), freedom, "{}", m.title);
            let (a, f) = check_states(&m, &mut r, 4);
            worst = (worst.0.max(a), worst.1.max(f));
        }
        println!("{worst:?}");
    }
}

/// Every joint of a linkage in turn closes it; motion and forces are the same.
#[test]
fn where_a_loop_is_cut_does_not_matter() {
    for make in [four_bar, slider_crank, rssr, bricard] {
        let mut r = Random(7);
        let mut m = make(&mut r);
        m.forces = true;
        load(&mut m, &mut r);
        for k in 0..m.links.len() {
            let mut other = m.clone();
            other.links[k].cut = true;
            other.links[k].spring = None;
            check_states(&other, &mut r, 2);
        }
    }
}

/// Springs on joints' coordinates and driven joints within loops; what the drive needs is told.
#[test]
fn springs_and_drives_in_loops() {
    for seed in 0..2 {
        let mut r = Random(90 + seed);
        for (make, spring, drive) in [
            (four_bar as fn(&mut Random) -> Machine, 0, None),
            (rssr, 0, None),
            (rssr, 3, Some(0)),
            (slider_crank, 0, None),
        ] {
            let mut m = make(&mut r);
            m.forces = true;
            load(&mut m, &mut r);
            m.links[spring].spring = drive.is_none().then_some(12.0);
            if let Some(k) = drive {
                m.links[k].drive = Some((0.05, 1.5));
            }
            check_states(&m, &mut r, 3);
        }
    }
}

#[test]
fn every_kind_closes_a_loop() {
    let kinds = [
        Kind::Weld,
        Kind::Revolute,
        Kind::Prismatic,
        Kind::Cylindrical,
        Kind::Universal,
        Kind::Planar,
        Kind::Spherical,
        Kind::Free,
    ];
    for kind in kinds {
        let (mut checked, mut worst) = (0, (0.0_f64, 0.0_f64));
        for seed in 0..7 {
            let mut r = Random(500 + seed);
            let mut m = random_loop(&mut r, kind);
            m.forces = true;
            load(&mut m, &mut r);
            let model = read(&m.text(&PLAIN)).build().unwrap_or_else(|e| panic!("{e}"));
            match derive(&model, &DeriveOptions { compare: false, ..DeriveOptions::default() }) {
                Ok(_) => {}
                Err(DeriveError::NoFreedom { .. }) => continue,
                Err(error) => panic!("{kind:?} {seed}: {error}"),
            }
            let (a, f) = check_states(&m, &mut r, 1);
            worst = (worst.0.max(a), worst.1.max(f));
            checked += 1;
        }
        println!("{kind:?}: {checked} machines, {worst:?}");
        assert!(checked >= 3, "{kind:?}: {checked}");
    }
}
