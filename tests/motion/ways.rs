//! Ways: what becomes of a move's length.

use super::line::{plan, target};
use corehbot::motion::{MoveMemory, Planner};
use corehbot::settings::Settings;
use corehbot::units::{Mm, Steps, StepsPerMm};

/// Reproducer: what rounding left of a move that is all ramps was a cruise with time and no way, whose speed was 0; a brake
/// (M410) that began with it took the tool for standing.
#[test]
fn no_phase_has_time_and_no_way() {
    for way in [0.05, 0.1, 0.2, 0.5, 1.0] {
        let path: Vec<_> = (1..=100).map(|i| target_at(f64::from(i) * way, f64::from(i) * way * 0.3)).collect();
        for (i, m) in plan(&path, &Settings::prototype()).iter().enumerate() {
            assert!(m.cruise == 0 || m.cruised > m.accelerated, "move {i} of {way} mm: {m:?}");
        }
    }
}

fn target_at(x: f64, y: f64) -> ([f64; 4], f64) {
    ([x, y, 0.0, 0.0], 300.0)
}

#[test]
fn a_millimetre_either_way_ends_on_a_whole_step() {
    for resolution in [80.0, 81.3, 100.7] {
        let mut settings = Settings::prototype();
        settings.axes.x.steps_per_mm = StepsPerMm::from_num(resolution);
        settings.axes.y.steps_per_mm = StepsPerMm::from_num(resolution);
        for x in [1.0, -1.0] {
            let mut memory = MoveMemory::new();
            let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
            planner.push(&target([x, 0.0, 0.0, 0.0], 100.0), &settings);
            planner.release_all();
            let [end, ..] = planner.pop().unwrap().end;
            assert_eq!(end, Steps::from_num((x * resolution).round()), "{x} mm of {resolution} steps");
        }
    }
}
