//! A planner that does all that it may, at moments that dice choose.

use super::{Path, bends, circle, corners, retracts, straight, tiny, wild};
use crate::dice::Dice;
use crate::line::target;
use corehbot::kinematics::{Grouping, Groupings};
use corehbot::motion::{MoveMemory, Planner, Target};
use corehbot::port::EndstopSet;
use corehbot::settings::{Settings, sum};
use corehbot::units::{Mm, Steps};

/// Parts of its work in which a planner has planned everything again.
const MOST_PARTS: usize = 1000;

/// The outputs of a planner.
#[derive(Default)]
struct Seen {
    moves: usize,
    sum: u32,
}

impl Seen {
    fn add(&mut self, what: String) {
        self.sum = sum(&(self.sum, what));
    }

    /// Takes up to `most` of the moves that leave.
    fn take(&mut self, planner: &mut Planner<'_>, most: usize) {
        let moves: Vec<_> = std::iter::from_fn(|| planner.pop()).take(most).collect();
        self.moves += moves.len();
        self.add(format!("{moves:?}"));
    }

    /// All that can be asked of it.
    fn look(&mut self, planner: &mut Planner<'_>, at: [Mm; 4]) {
        let end = planner.end();
        self.add(format!("{:?}", (planner.room(), planner.len(), planner.is_empty(), planner.has_room())));
        self.add(format!(
            "{:?}",
            (planner.has_ready(), planner.lacks_moves(), planner.is_planned(), planner.waiting())
        ));
        self.add(format!("{:?}", (planner.final_time(), planner.path(), planner.planned(), planner.feed_percent())));
        self.add(format!("{:?}", (end, planner.mm(end), planner.steps(at), planner.is_move(at))));
        self.add(format!("{:?}", (planner.filament_um(end[3]), planner.filament_within(50_000, end[3], 20_000))));
    }
}

/// The number of moves that leave it, and a sum of all its outputs. With `fills` no move leaves before it is full.
pub fn planned(seed: u64, fills: bool, settings: &Settings) -> (usize, u32) {
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, settings, [Mm::ZERO; 4]);
    let groupings = Groupings::new(&settings.mechanism);
    let (mut grouping, mut dice, mut seen, mut was_full) = (Grouping::Tool, Dice(seed), Seen::default(), false);
    let often = if fills { 0.0 } else { 0.2 };
    let path: Path = [corners(), tiny(), circle(), retracts(), straight(), bends(), wild(seed, 80)].concat();
    for (position, speed) in path {
        for _ in 0..MOST_PARTS {
            was_full |= !planner.has_room();
            if planner.has_room() && dice.roll() >= often {
                break;
            }
            match (6.0 * dice.roll()) as u32 {
                0 => planner.override_feed(10 + (200.0 * dice.roll()) as u16),
                1 => planner.take_share(1 + (16.0 * dice.roll()) as u8),
                2 => planner.release_next(),
                3 => planner.release_all(),
                _ => planner.release_some(),
            }
            // In the middle of planning again, and after it.
            seen.take(&mut planner, (12.0 * dice.roll()) as usize);
            if dice.roll() < 0.7 {
                assert!((0..MOST_PARTS).any(|_| planner.replan()));
            }
            planner.replan();
            // When some have left.
            seen.take(&mut planner, (3.0 * dice.roll()) as usize);
        }
        let at = position.map(Mm::from_num);
        // Some without overrides, and some up to an endstop.
        let watch = if dice.roll() < 0.04 { EndstopSet(1) } else { EndstopSet::NONE };
        let target = Target { has_overrides: dice.roll() < 0.9, watch, ..target(position, speed) };
        seen.look(&mut planner, at);
        let is_taken = planner.push(&target, settings);
        seen.add(format!("{is_taken}"));
        seen.look(&mut planner, at);
        assert!(planner.is_whole(settings, groupings.of(grouping)));
        if dice.roll() < often / 6.0 {
            // Waiting moves are made first, or dropped.
            if dice.roll() < 0.5 {
                planner.release_all();
                assert!((0..MOST_PARTS).any(|_| planner.replan()));
                seen.take(&mut planner, usize::MAX);
            }
            // It stopped a little short, and continues with motors in other groups, or as before.
            let [x, y, z, e] = planner.end();
            let short = [x.wrapping_sub(Steps::from_num(9)), y, z, e];
            planner.fall_short(short);
            planner.stand_at(short);
            let other = if grouping == Grouping::Tool { Grouping::Circulation } else { Grouping::Tool };
            planner.regroup(settings, groupings.of(other));
            assert!(!planner.is_whole(settings, groupings.of(grouping)));
            grouping = other;
        }
    }
    assert_eq!(was_full, fills);
    planner.release_all();
    assert!((0..MOST_PARTS).any(|_| planner.replan()));
    seen.take(&mut planner, usize::MAX);
    let mut finer = *settings;
    finer.axes.x.steps_per_mm = finer.axes.x.steps_per_mm * 2;
    planner.set_resolution(&finer);
    assert!(planner.is_whole(&finer, groupings.of(grouping)));
    seen.look(&mut planner, [Mm::ONE; 4]);
    (seen.moves, seen.sum)
}
