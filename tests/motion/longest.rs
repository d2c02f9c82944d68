//! Moves that are far longer than any axis, as a machine without soft endstops may get, with the greatest acceleration.

use super::speeds::speeds;
use crate::line::plan;
use corehbot::motion::LOOKAHEAD_MOVES;
use corehbot::settings::{Settings, ranges};

/// The possible gain of speed squared in a move of 11 m or more exceeds the look-ahead's comparisons.
#[test]
fn the_longest_moves_with_the_greatest_acceleration_stop_where_the_path_turns_back() {
    let mut s = Settings::prototype();
    for axis in [&mut s.axes.x, &mut s.axes.y] {
        (axis.max_speed, axis.length) = (ranges::SPEED.most, ranges::AXIS_LENGTH.most);
        axis.max_acceleration = ranges::ACCELERATION.most;
    }
    s.motor_max_speed = ranges::SPEED.most;
    (s.motor_max_acceleration, s.travel_acceleration) = (ranges::ACCELERATION.most, ranges::ACCELERATION.most);
    s.check().unwrap();
    let there_and_back = |i: usize| if i.is_multiple_of(2) { 0.0 } else { 15_000.0 };
    let targets: Vec<_> = (1..LOOKAHEAD_MOVES).map(|i| ([there_and_back(i), 0.0, 0.0, 0.0], 3000.0)).collect();
    let moves = plan(&targets, &s);
    assert_eq!(moves.len(), targets.len());
    for (i, m) in moves.iter().enumerate() {
        let [entry, peak, exit] = speeds(m, 15_000.0);
        assert!((peak - 3000.0).abs() < 0.1 && entry < 0.1 && exit < 0.1, "move {i}: {entry}, {peak}, {exit}");
    }
}
