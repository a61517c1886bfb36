//! Numerical stability: long chains, extreme ratios of masses, nearly singular mass matrices, long runs.

mod common;

use common::{done, read};

/// A chain of `n` links stretched out level, hinges in turn about y and z, at rest; masses from `mass`.
fn chain(n: usize, mass: impl Fn(usize) -> f64) -> String {
    let mut s = String::from("[world]\ngravity = [0, 0, -9.81]\n");
    for k in 1..=n {
        let m = mass(k);
        s += &format!("[[body]]\nname = \"b{k}\"\nmass = {m:e}\ncenter = [0.5, 0, 0]\n");
        s += &format!("inertia = [{:e}, {:e}, {:e}]\n", 0.01 * m, 0.09 * m, 0.09 * m);
        s += &format!(
            "[[joint]]\nname = \"q{k}\"\nkind = \"revolute\"\naxis = \"{}\"\nto = \"b{k}\"\n",
            ["y", "z"][(k - 1) % 2]
        );
        if k > 1 {
            s += &format!("from = \"b{}\"\nat = [1, 0, 0]\n", k - 1);
        }
    }
    s += "[initial]\n";
    (1..=n).for_each(|k| s += &format!("q{k} = {}\n", 0.02 * (k as f64).sin()));
    s + "[outputs]\ncolumns = [\"system.kinetic_energy\", \"system.potential_energy\"]\n"
}

/// Change of the total energy over the run, relative to the largest kinetic energy.
fn drift(text: &str, until: f64, tolerance: f64) -> f64 {
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| {
        o.tolerance = tolerance;
        o.until = until;
        o.points = 50;
    });
    let rows = &run.trajectory.rows;
    let start = rows[0][0] + rows[0][1];
    let largest = rows.iter().map(|r| r[0]).fold(0.0, f64::max);
    rows.iter().map(|r| (r[0] + r[1] - start).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn long_chains_keep_their_energy() {
    for n in [10, 100, 300] {
        let drift = drift(&chain(n, |_| 1.0), if n > 100 { 0.5 } else { 1.0 }, 1e-10);
        assert!(drift < 1e-9, "{n} links: {drift:e}");
    }
}

/// A millionth of its neighbours' mass, or a million times as much, at the end and in the middle.
#[test]
fn extreme_ratios_of_masses_keep_the_energy() {
    for ratio in [1e-6, 1e6] {
        for odd in [3, 6] {
            let drift = drift(&chain(6, |k| if k == odd { ratio } else { 1.0 }), 2.0, 1e-11);
            assert!(drift < 1e-8, "link {odd} of {ratio:e} kg: {drift:e}");
        }
    }
}

/// A needle without noticeable inertia about its own axis, driven about it, on an arm that turns: closed form.
#[test]
fn a_nearly_singular_mass_matrix_is_solved() {
    let text = "[[body]]\nname = \"arm\"\nmass = 1\ncenter = [0.5, 0, 0]\ninertia = [0.1, 0.2, 0.25]\n\
                [[body]]\nname = \"needle\"\nmass = 1e-3\ninertia = [1e-12, 1e-6, 1e-6]\n\
                [[joint]]\nname = \"a\"\nkind = \"revolute\"\nto = \"arm\"\n\
                [[joint]]\nname = \"s\"\nkind = \"revolute\"\naxis = \"x\"\nfrom = \"arm\"\nat = [1, 0, 0]\nto = \"needle\"\n\
                [[force]]\nname = \"twist\"\nvalue = \"2e-12[N*m]\"\ngeometric = \"s\"\n\
                [initial]\n\"a'\" = 3\n[outputs]\ncolumns = [\"a\", \"s\"]\n";
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| {
        o.tolerance = 1e-10;
        o.until = 2.0;
    });
    let last = run.trajectory.rows.last().expect("rows");
    assert!((last[0] - 6.0).abs() < 1e-9 && (last[1] - 4.0).abs() < 1e-9, "{last:?}");
}

/// A thousand seconds of turning about the middle axis: some hundred flips, momentum and energy kept.
#[test]
fn a_free_body_keeps_energy_and_momentum_for_long() {
    let text = "[[body]]\nname = \"b\"\nmass = 1\ninertia = [1, 2, 3]\n\
                [initial]\n\"b.wx\" = 0.001\n\"b.wy\" = 5\n\"b.wz\" = 0.001\n\
                [outputs]\ncolumns = [\"system.kinetic_energy\", \"system.lx\", \"system.ly\", \"system.lz\"]\n";
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| {
        o.tolerance = 1e-12;
        o.until = 1000.0;
        o.points = 20;
        o.balance = false;
    });
    let start = [25.000_002, 0.001, 10.0, 0.003];
    for (row, t) in run.trajectory.rows.iter().zip(&run.trajectory.t) {
        let worst = row.iter().zip(start).map(|(a, b)| (a - b).abs() / b.max(1.0)).fold(0.0, f64::max);
        assert!(worst < 1e-9, "t = {t}: {row:?}");
    }
}
