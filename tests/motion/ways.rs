//! Lengths: of the path, and of a move's three phases; a phase with time has a length.

use crate::line::{plan, target};
use corehbot::motion::{MoveMemory, Planner};
use corehbot::settings::Settings;
use corehbot::units::Mm;

#[test]
fn moves_and_their_path_are_counted() {
    let (mut memory, settings) = (MoveMemory::new(), Settings::prototype());
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    for (i, (place, um)) in [([3.3, 4.4, 0.0, 0.0], 5_500), ([3.3, 4.4, 1.75, 0.0], 7_250)].into_iter().enumerate() {
        planner.push(&target(place, 100.0), &settings);
        let (moves, path_um) = planner.planned();
        assert_eq!((moves, planner.path()), (i as u32 + 1, um / 1000));
        // The length of a move has 24 bits.
        assert!(path_um.abs_diff(um) <= 1, "{path_um} um");
    }
}

/// Reproducer: the rounding of a move that is all ramps left a cruise with time but no length, so its speed was 0. A
/// brake (M410) that began with it took the tool for standing.
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
