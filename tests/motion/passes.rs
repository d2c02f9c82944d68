//! Work on many moves is done a few at a time, with the same result as if it were done at once.

use super::timing::wander;
use crate::line::{plan, target};
use corehbot::motion::{LOOKAHEAD_MOVES, Move, MoveMemory, Planner};
use corehbot::settings::Settings;
use corehbot::units::Mm;

/// As many as the window holds.
fn targets() -> Vec<([f64; 4], f64)> {
    wander(LOOKAHEAD_MOVES - 1, 0x0DD5_EED5)
}

fn twice_as_fast() -> Vec<([f64; 4], f64)> {
    targets().into_iter().map(|(position, speed)| (position, speed * 2.0)).collect()
}

/// A planner with these.
fn full<'m>(memory: &'m mut MoveMemory, settings: &Settings) -> Planner<'m> {
    let mut planner = Planner::new(memory, settings, [Mm::ZERO; 4]);
    for (position, speed) in targets() {
        planner.push(&target(position, speed), settings);
    }
    planner
}

/// All moves that leave without being made to.
fn leaving(planner: &mut Planner<'_>) -> Vec<Move> {
    std::iter::from_fn(|| planner.pop()).collect()
}

#[test]
fn a_changed_feed_is_planned_a_few_moves_at_a_time() {
    let settings = Settings::prototype();
    let mut memory = MoveMemory::new();
    let mut planner = full(&mut memory, &settings);
    let waiting = planner.waiting();
    assert!(planner.has_ready() && planner.len() > 120);
    planner.override_feed(200);
    let mut parts = 0;
    while !planner.replan() {
        parts += 1;
        let is_planned = planner.is_planned();
        assert_eq!(planner.has_ready(), is_planned, "part {parts}");
        // No move leaves before its time.
        assert!(is_planned || planner.pop().is_none());
    }
    assert!(parts >= planner.len() / 10, "{parts} parts");
    let nominal = planner.waiting() as f64 / waiting as f64;
    assert!((0.49..0.9).contains(&nominal), "{nominal} times as long at twice the feed");
    planner.release_all();
    assert!(leaving(&mut planner) == plan(&twice_as_fast(), &settings));
    assert_eq!(planner.waiting(), 0);
}

/// A second change starts at the begin again, independent of the progress of the first one.
#[test]
fn the_last_of_two_changes_counts() {
    let settings = Settings::prototype();
    let mut memory = MoveMemory::new();
    let mut planner = full(&mut memory, &settings);
    planner.override_feed(300);
    for _ in 0..5 {
        assert!(!planner.replan());
    }
    planner.override_feed(100);
    while !planner.replan() {}
    planner.release_all();
    assert!(leaving(&mut planner) == plan(&targets(), &settings));
}

/// A move that is added finds those before it planned and settled, by any caller.
#[test]
fn what_is_added_after_a_change_is_planned_like_the_rest() {
    let settings = Settings::prototype();
    let all = targets();
    let (first, second) = all.split_at(100);
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    for (position, speed) in first {
        planner.push(&target(*position, *speed), &settings);
    }
    planner.override_feed(200);
    for (position, speed) in second {
        planner.push(&target(*position, *speed), &settings);
    }
    planner.release_all();
    assert!(leaving(&mut planner) == plan(&twice_as_fast(), &settings));
}

/// Moves that are made to leave keep the speeds that they have then, whether they leave before more are added or after,
/// or more are made to leave.
#[test]
fn moves_that_must_leave_keep_the_speeds_of_that_moment() {
    let settings = Settings::prototype();
    let line = |i: usize| target([0.3 * i as f64, 0.0, 0.0, 0.0], 300.0);
    let [late, early, again] = [(0, false), (7, false), (0, true)].map(|(leave_early, is_again)| {
        let mut memory = MoveMemory::new();
        let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
        for i in 1..=100 {
            planner.push(&line(i), &settings);
        }
        leaving(&mut planner);
        planner.release_all();
        let mut early: Vec<Move> = (0..leave_early).map_while(|_| planner.pop()).collect();
        assert_eq!(early.len(), leave_early);
        for i in 101..=120 {
            planner.push(&line(i), &settings);
        }
        if is_again {
            planner.release_all();
        }
        early.extend(leaving(&mut planner));
        let made = planner.planned().0 as usize - planner.len();
        assert_eq!(early.last().map(|m| m.end), Some(planner.steps(line(made).position)));
        early
    });
    assert!(late.len() > 30, "{} moves", late.len());
    assert!(late == early && again.starts_with(&late));
}

#[test]
fn final_moves_are_found_a_few_at_a_time() {
    let settings = Settings::prototype();
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    for i in 1..=100 {
        planner.push(&target([0.5 * f64::from(i), 0.0, 0.0, 0.0], 50.0), &settings);
    }
    let (mut parts, mut times) = (1, vec![planner.final_time()]);
    while let Some((_, false)) = times.last() {
        times.push(planner.final_time());
        parts += 1;
    }
    assert!(parts > 5, "{parts} parts");
    assert!(times.is_sorted());
    // Asked again, nothing has changed.
    let (all, _) = times[times.len() - 1];
    assert_eq!(planner.final_time(), (all, true));
    // The moves that leave are the final ones: 10 ms each.
    let left = leaving(&mut planner).len();
    assert!(left > 90);
    assert_eq!(all, left as u64 * 100_000);
}
