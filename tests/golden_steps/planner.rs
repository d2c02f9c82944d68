//! A planner that does all that it may, at moments that dice choose.

use super::dice::Dice;
use super::line::target;
use super::{Path, circle, corners, tiny, wild};
use corehbot::kinematics::{Grouping, Groupings};
use corehbot::motion::{MoveMemory, Planner};
use corehbot::settings::{Settings, sum};
use corehbot::units::{Mm, Steps};

/// How many moves leave it, and a sum of all that is seen of it.
pub fn planned(seed: u64, settings: &Settings) -> (usize, u32) {
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, settings, [Mm::ZERO; 4]);
    let groupings = Groupings::new(&settings.mechanism);
    let mut dice = Dice(seed);
    let (mut count, mut all) = (0, 0);
    let mut add = |what: String| all = sum(&(all, what));
    let path: Path = [corners(), tiny(), circle(), wild(seed, 80)].concat();
    for (position, speed) in path {
        while !planner.has_room() || dice.roll() < 0.2 {
            match (6.0 * dice.roll()) as u32 {
                0 => planner.override_feed(10 + (200.0 * dice.roll()) as u16),
                1 => planner.take_share(1 + (16.0 * dice.roll()) as u8),
                2 => planner.release_next(),
                3 => planner.release_all(),
                _ => planner.release_some(),
            }
            while !planner.replan() {}
            planner.prepare();
            let some = (12.0 * dice.roll()) as usize;
            let moves: Vec<_> = std::iter::from_fn(|| planner.pop()).take(some).collect();
            count += moves.len();
            add(format!("{moves:?}"));
        }
        let is_taken = planner.push(&target(position, speed), settings);
        planner.prepare();
        assert!(planner.is_whole(settings, &groupings.tool));
        let [x, y, z, e] = planner.end();
        add(format!(
            "{is_taken} {} {} {} {:?} {} {:?} {} {:?} {:?}",
            planner.room(),
            planner.has_ready(),
            planner.lacks_moves(),
            (planner.is_empty(), planner.len(), planner.waiting()),
            planner.path(),
            planner.planned(),
            planner.is_planned(),
            (planner.mm([x, y, z, e]), planner.filament_um(e), planner.filament_within(50_000, e, 20_000)),
            (planner.final_time(), planner.is_move(position.map(Mm::from_num)), planner.feed_percent()),
        ));
        if dice.roll() < 0.03 {
            planner.release_all();
            while planner.pop().is_some() {}
            // It came not quite as far, and goes on with another way to group motors and then as before.
            let short = [x.wrapping_sub(Steps::from_num(9)), y, z, Steps::ZERO];
            planner.fall_short(short);
            planner.stand_at(short);
            let other = groupings.of(Grouping::Circulation);
            planner.regroup(settings, other);
            assert!(!planner.is_whole(settings, &groupings.tool) && planner.is_whole(settings, other));
            planner.regroup(settings, &groupings.tool);
        }
    }
    (count, all)
}
