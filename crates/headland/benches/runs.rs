//! Whole runs of the article's train over 15 s: start, integration, outputs; derivation and compilation are outside.

mod train;

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use headland::solve::Method;
use headland::{Model, RunOptions, Scene, Silent, run};
use train::{MINIMAL, Train};

fn options(model: &Model, method: Method, tolerance: f64) -> RunOptions {
    let mut options = RunOptions::of(model);
    (options.method, options.tolerance) = (method.name().into(), tolerance);
    options
}

/// Times the integration as the run itself does: the derivation is made once for so many repeats.
fn time(c: &mut Criterion, group: &str, name: &str, model: &Model, options: &RunOptions) {
    let report = run(model, options, &mut Silent).expect("runs").report;
    eprintln!(
        "{group}/{name}: {} steps, {} rejected, {} right-hand sides, {} for outputs and balance, {} Jacobians",
        report.steps, report.rejected, report.rhs, report.rhs_outputs, report.jacobians
    );
    let mut group = c.benchmark_group(group);
    group.sample_size(20).warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(2));
    group.bench_function(name, |b| {
        b.iter_custom(|iterations| {
            let mut options = options.clone();
            options.repeat = iterations as usize;
            let report = run(model, &options, &mut Silent).expect("runs").report;
            // the median of the repeats, for so many
            Duration::from_secs_f64(report.run_s_median.unwrap_or(report.run_s)) * iterations as u32
        });
    });
    group.finish();
}

fn three_bogies(c: &mut Criterion) {
    let model = Scene::parse("paper_train.toml", MINIMAL).and_then(|s| s.build()).expect("the scene is right");
    for method in Method::ALL.into_iter().filter(|m| m.is_built()) {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let group = format!("run_{}_{tolerance:e}", method.name());
            let mut options = options(&model, method, tolerance);
            time(c, &group, "outputs_balance", &model, &options);
            options.balance = false;
            time(c, &group, "outputs", &model, &options);
            options.points = 1;
            time(c, &group, "bare", &model, &options);
        }
    }
}

fn many_bogies(c: &mut Criterion) {
    for n in [8, 64, 256] {
        let model = Train::new(n).scene(MINIMAL).build().expect("the scene is right");
        let mut options = options(&model, Method::Dop853, 1e-9);
        let group = format!("run_n{n}_dop853_1e-9");
        time(c, &group, "outputs_balance", &model, &options);
        (options.balance, options.points) = (false, 1);
        time(c, &group, "bare", &model, &options);
    }
}

criterion_group!(benches, three_bogies, many_bogies);
criterion_main!(benches);
