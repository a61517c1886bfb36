//! Closed forms, limits, bounds and symmetries of the simple laws; relaxation at standstill, at creep and backwards.

use approx::assert_relative_eq;
use headland_expr::{Dual, Scalar};
use headland_spatial::Vector;
use headland_tyre::tmeasy::{Curve, Trail};
use headland_tyre::{Brush, ContactAxes, Forces, Linear, Motion, Relaxation, Slip, SlipLaw, TMeasy, relax_towards};
use proptest::prelude::*;

const LOAD: f64 = 2e4;

fn linear<S: Scalar>() -> Linear<S> {
    Linear {
        longitudinal: S::constant(2e5),
        cornering: S::constant(1.2e5),
        camber: S::constant(1e4),
        trail: S::constant(0.05),
        load: Some(S::constant(LOAD)),
    }
}

fn brush<S: Scalar>() -> Brush<S> {
    Brush {
        longitudinal: S::constant(2e5),
        cornering: S::constant(1.2e5),
        camber: S::constant(1e4),
        friction: S::constant(0.8),
        half_length: S::constant(0.12),
        load: S::constant(LOAD),
        proportional: true,
    }
}

fn tmeasy<S: Scalar>() -> TMeasy<S> {
    TMeasy::truck(S::constant(LOAD), S::constant(0.24), S::constant(0.5))
}

fn list(f: &Forces<f64>) -> [f64; 5] {
    [f.fx, f.fy, f.mx, f.my, f.mz]
}

/// A row of bristles, laid down at the leading edge, which adhere while friction holds them and slide then: the integral
/// that the closed form of the brush model is.
fn bristles(law: &Brush<f64>, load: f64, slip: &Slip<f64>) -> [f64; 3] {
    let n = 200_000;
    let share = load / law.load;
    let a = law.half_length * share.sqrt();
    let [sx, sy] = slip.theoretical();
    // C = 2 c a²
    let c = [law.longitudinal, law.cornering].map(|c| c * share / (2.0 * a * a));
    let h = 2.0 * a / f64::from(n);
    let (mut fx, mut fy, mut mz) = (0.0, 0.0, 0.0);
    for i in 0..n {
        let x = a - (f64::from(i) + 0.5) * h;
        let pull = [c[0] * (a - x) * sx, -c[1] * (a - x) * sy];
        let size = pull[0].hypot(pull[1]);
        let bound = law.friction * 0.75 * load / a.powi(3) * (a * a - x * x);
        let factor = if size > bound { bound / size } else { 1.0 };
        fx += factor * pull[0] * h;
        fy += factor * pull[1] * h;
        mz += factor * pull[1] * x * h;
    }
    [fx, fy, mz]
}

#[test]
fn brush_is_the_integral_over_its_bristles() {
    let law = brush();
    for load in [5e3, LOAD, 3e4] {
        for (kappa, tan_alpha) in [(0.0, 0.05), (0.03, 0.0), (0.05, -0.08), (-0.1, 0.1), (0.4, 0.3), (0.0, 0.39)] {
            let slip = Slip::forward(kappa, tan_alpha);
            let f = law.forces(load, 1.0, &slip);
            let expected = bristles(&law, load, &slip);
            for (found, expected) in [f.fx, f.fy, f.mz].into_iter().zip(expected) {
                assert_relative_eq!(found, expected, max_relative = 1e-7, epsilon = 1e-4);
            }
        }
    }
}

/// Fiala's polynomial for pure side slip, as he wrote it.
#[test]
fn brush_is_fialas_polynomial() {
    let law = brush();
    let (c, grip) = (1.2e5, 0.8 * LOAD);
    for t in [0.01f64, 0.05, 0.2, 0.3999] {
        let expected = c * t - (c * t).powi(2) / (3.0 * grip) + (c * t).powi(3) / (27.0 * grip * grip);
        assert_relative_eq!(law.forces(LOAD, 1.0, &Slip::forward(0.0, t)).fy, -expected, max_relative = 1e-13);
    }
    let f = law.forces(LOAD, 1.0, &Slip::forward(0.0, 0.41));
    assert_relative_eq!(f.fy, -grip, max_relative = 1e-15);
    assert_eq!(f.mz, 0.0);
}

#[test]
fn tmeasy_has_the_five_numbers_of_its_curve() {
    let curve = Curve { slope: 3e5, peak_slip: 0.12, peak: 1.6e4, slide_slip: 0.6, slide: 1.1e4 };
    let dot = |s: f64| {
        let c = |x: f64| Dual::new(x, 0.0);
        let curve = Curve { slope: c(3e5), peak_slip: c(0.12), peak: c(1.6e4), slide_slip: c(0.6), slide: c(1.1e4) };
        curve.force(Dual::new(s, 1.0)).dot
    };
    assert_eq!(curve.force(0.0), 0.0);
    assert_relative_eq!(dot(0.0), 3e5, max_relative = 1e-12);
    assert_relative_eq!(curve.force(0.12), 1.6e4, max_relative = 1e-12);
    assert_relative_eq!(curve.force(0.6), 1.1e4, max_relative = 1e-12);
    assert_eq!(curve.force(5.0), 1.1e4);
    for s in [0.12 - 1e-9, 0.12 + 1e-9, 0.6 - 1e-9, 0.6 + 1e-9] {
        assert!(dot(s).abs() < 1e-1, "{s}: {}", dot(s));
    }
}

#[test]
fn tmeasy_along_an_axis_is_that_axis_and_follows_the_load() {
    let law = tmeasy::<f64>();
    for (load, c) in [(LOAD, &law.nominal), (2.0 * LOAD, &law.double)] {
        let at = law.at(load, 1.0);
        assert_relative_eq!(at.x.peak, c.x.peak, max_relative = 1e-14);
        assert_relative_eq!(at.y.slope, c.y.slope, max_relative = 1e-14);
        assert_relative_eq!(at.y.slide_slip, c.y.slide_slip, max_relative = 1e-14);
        for s in [0.01, 0.05, 0.1, 0.3, 0.9] {
            // theoretical slip κ/(1+κ) = s
            let f = law.forces(load, 1.0, &Slip::forward(s / (1.0 - s), 0.0));
            assert_relative_eq!(f.fx, c.x.force(s), max_relative = 1e-9);
            assert!(f.fy.abs() < 1e-9);
            let f = law.forces(load, 1.0, &Slip::forward(0.0, s));
            assert_relative_eq!(f.fy, -c.y.force(s), max_relative = 1e-9);
        }
    }
    assert_relative_eq!(law.stiffness(LOAD)[0], 17.7764 * LOAD, max_relative = 1e-14);
}

/// A leaning wheel's tread runs over an arc: bristles under it give a third of the force of the slip at the arc's end.
#[test]
fn tmeasys_camber_is_the_arc_of_a_leaning_wheel() {
    let (length, radius, gamma) = (0.24f64, 0.5, 0.03f64);
    let n = 10_000;
    let h = length / f64::from(n);
    let (mut arc, mut side) = (0.0, 0.0);
    for i in 0..n {
        let x = 0.5 * length - (f64::from(i) + 0.5) * h;
        // deflection of a bristle laid down at L/2: slope of the path −γ x/R, and of a unit lateral slip
        arc += gamma.sin() / (2.0 * radius) * (0.25 * length * length - x * x) * h;
        side += (0.5 * length - x) * h;
    }
    let law = tmeasy::<f64>();
    let lean = law.forces(LOAD, 1.0, &Slip { camber: gamma, ..Slip::forward(0.0, 0.0) });
    let equal = law.forces(LOAD, 1.0, &Slip::forward(0.0, arc / side));
    assert_relative_eq!(lean.fy, equal.fy, max_relative = 1e-6);
    assert!(lean.fy < 0.0, "leaning to the right pushes to the right");
}

#[test]
fn tmeasys_trail_is_smooth_and_vanishes_where_it_should() {
    let trail = Trail { share: 0.18, zero_slip: 0.36, end_slip: 1.03 };
    assert_eq!(trail.of(0.0), 0.18);
    assert!(trail.of(0.36).abs() < 1e-15);
    assert_eq!(trail.of(1.03), 0.0);
    assert_eq!(trail.of(7.0), 0.0);
    let e = 1e-6;
    let slope = |s: f64| (trail.of(s + e) - trail.of(s - e)) / (2.0 * e);
    assert_relative_eq!(slope(0.36 - 2.0 * e), slope(0.36 + 2.0 * e), epsilon = 1e-4);
    assert!(slope(1.03).abs() < 1e-4);
    assert!(trail.of(0.6) < 0.0);
}

/// The three laws at one slip.
fn all<S: Scalar + 'static>() -> [Box<dyn SlipLaw<S>>; 3] {
    [Box::new(linear()), Box::new(brush()), Box::new(tmeasy())]
}

proptest! {
    #[test]
    fn pure_slip_mirror_images_bounds_and_dissipation(
        kappa in -3.0..3.0, tan_alpha in -3.0..3.0, camber in -0.2..0.2, load in 0.0..6e4, forward in -30.0..30.0, mu in 0.1..1.3,
    ) {
        for (i, law) in all::<f64>().iter().enumerate() {
            let slip = Slip { camber, ..Slip::forward(kappa, tan_alpha) };
            let here = law.forces(load, mu, &slip);
            let mirror = Slip { camber: -camber, tan_alpha: -tan_alpha, ..slip };
            let there = law.forces(load, mu, &mirror).mirrored();
            for (a, b) in list(&here).into_iter().zip(list(&there)) {
                prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "law {i}: {here:?} {there:?}");
            }
            // the bound, and that slip takes power, hold without camber
            let speed = f64::abs(forward);
            let motion = Motion { forward, slip_x: -kappa * speed, slip_y: tan_alpha * speed, spin: 0.0, camber: 0.0, turn: 0.0 };
            let f = law.forces(load, mu, &motion.with_slip(kappa, tan_alpha, 0.1));
            prop_assert!(f.fx * motion.slip_x + f.fy * motion.slip_y <= 0.0);
            let size = f.fx.hypot(f.fy);
            if i == 1 {
                prop_assert!(size <= 0.8 * mu * load * (1.0 + 1e-12), "{size}");
            }
            if i == 2 {
                let c = tmeasy::<f64>().at(load, mu);
                prop_assert!(size <= c.x.peak.max(c.y.peak) * (1.0 + 1e-12), "{size}");
            }
            let straight = law.forces(load, mu, &Slip::forward(kappa, 0.0));
            prop_assert!(straight.fy.abs() < 1e-9 && straight.mz.abs() < 1e-9);
            prop_assert!(law.forces(load, mu, &Slip::forward(0.0, tan_alpha)).fx.abs() < 1e-9);
        }
    }

    #[test]
    fn finite_with_finite_derivatives(
        kappa in prop_oneof![Just(0.0), Just(-1.0), -5.0..5.0], tan_alpha in prop_oneof![Just(0.0), -20.0..20.0],
        load in prop_oneof![Just(0.0), 0.0..1e5], direction in 0usize..3,
    ) {
        for (i, law) in all::<Dual<f64>>().iter().enumerate() {
            let seed = |i: usize, x: f64| Dual::new(x, if i == direction { 1.0 } else { 0.0 });
            let slip = Slip::forward(seed(0, kappa), seed(1, tan_alpha));
            let f = law.forces(seed(2, load), Dual::constant(1.0), &slip);
            for x in [f.fx, f.fy, f.mx, f.my, f.mz] {
                prop_assert!(x.value.is_finite() && x.dot.is_finite(), "law {i}: {f:?}");
            }
            if load == 0.0 {
                prop_assert!(f.fx.value.abs() + f.fy.value.abs() + f.mz.value.abs() < 1e-9, "law {i}: {f:?}");
            }
        }
    }

    /// The contact frame and the slip do not depend on the axes in which the vectors are written.
    #[test]
    fn motion_is_that_of_the_rigid_wheel(
        v in prop::array::uniform3(-10.0..10.0), omega in prop::array::uniform3(-5.0..5.0), lean in -0.5..0.5, yaw in -3.0..3.0,
    ) {
        let axle = Vector([-f64::sin(yaw) * f64::cos(lean), f64::cos(yaw) * f64::cos(lean), f64::sin(lean)]);
        let normal = Vector([0.0, 0.0, 1.0]);
        let axes = ContactAxes::new(axle, normal);
        let (v, omega) = (Vector(v), Vector(omega));
        let motion = Motion::new(v, omega, axle, &axes, 0.5, 0.5);
        prop_assert!((axes.x.x() - f64::cos(yaw)).abs() < 1e-12 && (axes.x.y() - f64::sin(yaw)).abs() < 1e-12);
        prop_assert!((motion.camber - lean).abs() < 1e-12);
        // with the effective radius equal to the loaded one, slip is the velocity of the wheel's lowest material point
        let r = axes.lowest_point(axle, 0.5);
        let point = v + omega.cross(r);
        prop_assert!((point.dot(axes.x) - motion.slip_x).abs() < 1e-12);
        prop_assert!((point.dot(axes.y) - motion.slip_y).abs() < 1e-12);
        prop_assert!((omega.dot(normal) - motion.turn - motion.spin * lean.sin()).abs() < 1e-12);
    }
}

fn relaxation() -> Relaxation<f64> {
    Relaxation { length: [0.3, 0.5], low_speed: 1.0, damping: [0.0; 2], limit: [0.5, 0.5] }
}

fn motion(forward: f64, slip_x: f64, slip_y: f64) -> Motion<f64> {
    Motion { forward, slip_x, slip_y, spin: 0.0, camber: 0.0, turn: 0.0 }
}

#[test]
fn relaxation_is_an_exponential_over_distance_forward_and_backward() {
    let law = relaxation();
    for forward in [8.0, -8.0] {
        let m = motion(forward, 0.4, -0.8);
        let steady = m.slip(1e-9);
        let mut state = [0.0; 2];
        let (h, n) = (1e-5, 10_000);
        for _ in 0..n {
            let k1 = law.rates(state, &m);
            let half = [0, 1].map(|i| state[i] + 0.5 * h * k1[i]);
            let k2 = law.rates(half, &m);
            state = [0, 1].map(|i| state[i] + h * k2[i]);
        }
        let way = 8.0 * h * f64::from(n);
        assert_relative_eq!(state[0], steady.kappa * (1.0 - (-way / 0.3).exp()), max_relative = 1e-7);
        assert_relative_eq!(state[1], steady.tan_alpha * (1.0 - (-way / 0.5).exp()), max_relative = 1e-7);
    }
    assert_relative_eq!(relax_towards(0.02, 0.05, -8.0, 0.5), 8.0 * 0.03 / 0.5, max_relative = 1e-14);
}

#[test]
fn sliding_without_rolling_stays_bounded() {
    let law = relaxation();
    for slip in [0.1, 30.0] {
        let m = motion(0.0, -slip, slip);
        let mut state = [0.0; 2];
        for _ in 0..200_000 {
            let rates = law.rates(state, &m);
            state = [0, 1].map(|i| state[i] + 1e-3 / slip * rates[i]);
        }
        for s in state {
            assert_relative_eq!(s, 1.0, max_relative = 1e-9); // 2 s_max, where b balances
        }
    }
}

/// A braked vehicle on a slope of 10°: a mass on the standing tyre, with the brush law.
#[test]
fn a_braked_mass_stands_on_a_slope() {
    let law = brush::<f64>();
    let mass = LOAD / 9.81;
    let mut relaxation = relaxation();
    relaxation.damping = relaxation.critical_damping(law.stiffness(LOAD), mass, 0.5);
    let pull = LOAD * 10f64.to_radians().sin();
    let rates = |y: [f64; 3]| {
        // the wheel does not turn: it slides as the vehicle moves
        let m = motion(y[1], y[1], 0.0);
        let slip = relaxation.slip([y[2], 0.0], &m, law.stiffness(LOAD), 0.1);
        let f = law.forces(LOAD, 1.0, &slip);
        [y[1], (f.fx - pull) / mass, relaxation.rates([y[2], 0.0], &m)[0]]
    };
    let mut y = [0.0; 3];
    let mut at_ten = 0.0;
    let h = 2e-3;
    for step in 0..300_000 {
        let add = |k: [f64; 3], h: f64| [0, 1, 2].map(|i| y[i] + h * k[i]);
        let k1 = rates(y);
        let k2 = rates(add(k1, 0.5 * h));
        let k3 = rates(add(k2, 0.5 * h));
        let k4 = rates(add(k3, h));
        y = [0, 1, 2].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        if step == 5_000 {
            at_ten = y[0];
        }
    }
    assert!(at_ten < -1e-3 && at_ten > -0.1, "it gives a little: {at_ten}");
    assert!((y[0] - at_ten).abs() < 1e-6, "moved by {}", y[0] - at_ten);
    assert!(y[1].abs() < 1e-12);
}

#[test]
fn linear_is_proportional_and_aligns() {
    let law = linear::<f64>();
    let slip = Slip { camber: 0.1, ..Slip::forward(0.02, 0.03) };
    let f = law.forces(0.5 * LOAD, 1.0, &slip);
    assert_eq!(f.fx, 0.5 * 2e5 * 0.02);
    assert_relative_eq!(f.fy, -0.5 * (1.2e5 * 0.03 + 1e4 * 0.1), max_relative = 1e-15);
    assert!(f.mz > 0.0);
    let constant = Linear { load: None, ..law };
    assert_eq!(constant.stiffness(0.0), [2e5, 1.2e5]);
    let back = law.forces(LOAD, 1.0, &Slip { direction: -1.0, ..slip });
    assert!(back.mz < 0.0, "backwards the force acts on the other side of the centre");
}

#[test]
fn backwards_is_the_mirror_image_of_forward() {
    let (brush, tmeasy) = (brush::<f64>(), tmeasy::<f64>());
    for kappa in [-0.3, -0.02, 0.05, 0.4] {
        for tan_alpha in [0.0, 0.1] {
            let slip = Slip::forward(kappa, tan_alpha);
            let back = Slip { kappa: -kappa, speed: -1.0, direction: -1.0, ..slip };
            for (a, b) in [
                (brush.forces(LOAD, 1.0, &slip), brush.forces(LOAD, 1.0, &back)),
                (tmeasy.forces(LOAD, 1.0, &slip), tmeasy.forces(LOAD, 1.0, &back)),
            ] {
                assert_eq!([a.fx, a.fy, a.mz], [-b.fx, b.fy, -b.mz], "{kappa} {tan_alpha}");
            }
        }
    }
}
