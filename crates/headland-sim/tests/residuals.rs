//! Residuals of single constraints as outputs.

mod common;

use common::{done, read};

const FOUR_BAR: &str = include_str!("scenes/four_bar.toml");
const DISC: &str = include_str!("scenes/disc.toml");

/// The scene with other columns.
fn with_columns(text: &str, columns: &str) -> String {
    let (before, after) = text.split_once("columns = [").unwrap_or_else(|| panic!("no columns"));
    let (_, after) = after.split_once(']').unwrap_or_else(|| panic!("no end of the columns"));
    // a bracket of an index ends the first piece too early: what is left of the line goes
    let after = after.split_once('\n').map_or("", |(_, rest)| rest);
    format!("{before}columns = [{columns}]\n{after}")
}

const TIP: &str = "\"tip[1].x.residual\", \"tip[1].y.residual\", \"tip[1].x.rate_residual\", \
                   \"tip[1].y.rate_residual\", \"tip[1].z.residual\", \"hypot(C.x - B[2].x, C.y - B[2].y)\", \
                   \"hypot(C.vx - B[2].vx, C.vy - B[2].vy)\", \"theta[1].x.residual\", \"beta[1].xz.rate_residual\"";

fn tip(method: &str, tolerance: f64) -> headland_sim::Run {
    let text = with_columns(FOUR_BAR, TIP) + "[[frame]]\nname = \"C\"\non = \"coupler[1]\"\nat = [\"L\", 0, 0]\n";
    let model = read(&text).build().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(model.outputs[0].unit, "m");
    assert_eq!(model.outputs[2].unit, "m/s");
    assert_eq!(model.outputs[8].unit, "1/s");
    done(&model, |o| {
        o.method = method.into();
        o.tolerance = tolerance;
        o.until = 1.0;
    })
}

/// The rows of a joint that closes a loop against the distance of its two ends and their relative speed: what drifts is
/// seen, in size and as the report has it. A joint on the tree drifts nowhere.
#[cfg(feature = "ida")]
#[test]
fn drift_off_a_loop_is_seen_row_by_row() {
    let run = tip("ida-index1", 1e-7);
    let mut largest = [0.0_f64; 2];
    for row in &run.trajectory.rows {
        let (place, speed) = (row[0].hypot(row[1]), row[2].hypot(row[3]));
        assert!((place - row[5]).abs() < 1e-15 + 1e-9 * row[5], "{row:?}");
        // the components are along turning axes, so that their rates see the drift in place as well
        assert!((speed - row[6]).abs() < 1e-14 + 20.0 * row[5], "{row:?}");
        assert!(row[4] == 0.0 && row[7] == 0.0 && row[8] == 0.0, "{row:?}");
        largest = [largest[0].max(row[0].abs().max(row[1].abs())), largest[1].max(row[2].abs().max(row[3].abs()))];
    }
    assert!(largest[0] > 1e-10, "index 1 must drift: {largest:?}");
    assert_eq!(run.report.constraint_position, Some(largest[0]));
    assert_eq!(run.report.constraint_velocity, Some(largest[1]));
}

#[test]
fn elimination_with_projection_leaves_rounding() {
    let run = tip("dop853", 1e-10);
    let worst = |columns: std::ops::Range<usize>| {
        run.trajectory.rows.iter().flat_map(|r| r[columns.clone()].to_vec()).fold(0.0_f64, |m, x| m.max(x.abs()))
    };
    assert!(worst(0..2) < 1e-9, "{:e}", worst(0..2)); // rows between steps are interpolated
    assert!(worst(2..5) < 1e-13, "{:e}", worst(2..5)); // rates are eliminated
}

#[test]
fn rolling_rows_have_residuals_too() {
    let columns = "\"contact.z.residual\", \"contact.x.rate_residual\", \"contact.y.rate_residual\"";
    let model = read(&with_columns(DISC, columns)).build().unwrap_or_else(|e| panic!("{e}"));
    let worst = |method: &str| {
        let run = done(&model, |o| {
            o.method = method.into();
            o.tolerance = 1e-7;
        });
        let rows = &run.trajectory.rows;
        [0, 1, 2].map(|i| rows.iter().fold(0.0_f64, |m, r| m.max(r[i].abs())))
    };
    let kept = worst("dop853");
    assert!(kept.iter().all(|x| *x < 1e-8), "{kept:?}");
    #[cfg(feature = "ida")]
    {
        let drifts = worst("ida-index1");
        assert!(drifts.iter().all(|x| *x > 1e-11), "{drifts:?}");
    }
}

#[test]
fn a_residual_can_stand_in_outputs_only() {
    let text = format!("{FOUR_BAR}\n[definitions]\nd = \"tip[1].x.residual\"\n");
    let message = read(&text).build().err().map(|e| e.to_string()).unwrap_or_default();
    assert!(message.contains("outputs, guards and events only"), "{message}");
    let text = with_columns(FOUR_BAR, "\"tip[1].q.residual\"");
    let message = read(&text).build().err().map(|e| e.to_string()).unwrap_or_default();
    assert!(message.contains("tip[1].") && message.contains("did you mean"), "{message}");
}
