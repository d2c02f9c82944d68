//! How a move's length is divided among its three phases: no phase has time but no length.

use super::line::plan;
use corehbot::settings::Settings;

/// Reproducer: what rounding left of a move that is all ramps was a cruise with time and no way, whose speed was 0; a brake
/// (M410) that began with it took the tool for standing.
#[test]
fn no_phase_has_time_and_no_way() {
    for way in [0.05, 0.1, 0.2, 0.5, 1.0] {
        let path: Vec<_> = (1..=100).map(|i| target_at(f64::from(i) * way, f64::from(i) * way * 0.3)).collect();
        for (i, m) in plan(&path, &Settings::prototype()).iter().enumerate() {
            assert!(m.cruise.0 == 0 || m.cruised > m.accelerated, "move {i} of {way} mm: {m:?}");
        }
    }
}

fn target_at(x: f64, y: f64) -> ([f64; 4], f64) {
    ([x, y, 0.0, 0.0], 300.0)
}
