//! Properties of any path: limits are kept, every prefix can stop, positions are exact.

use super::corners::machine;
use super::speeds::speeds;
use crate::belt_equations::{BeltSteps, residual};
use crate::dice::Dice;
use crate::line::{Step, generate, plan, target};
use corehbot::motion::{MIN_STEP_INTERVAL, Move, MoveMemory, Planner, WHOLE};
use corehbot::motors::{MOTORS, Motor, prototype};
use corehbot::settings::{CornerRule, Settings};
use corehbot::units::{Mm, Steps};
use proptest::prelude::*;

type Path = Vec<([f64; 4], f64)>;

/// Paths as slicers, people and accidents write them: long, tiny and zero moves, single axes, reversals.
fn paths() -> impl Strategy<Value = Path> {
    let axis = |most: f64| prop_oneof![3 => Just(f64::NAN), 4 => 0.0..most, 1 => Just(most), 1 => Just(0.0)];
    let fine = prop_oneof![Just(f64::NAN), -0.2..0.2f64];
    let far = (axis(390.0), axis(417.6), axis(3.0), -2.0..4.0f64).prop_map(|(x, y, z, e)| ([x, y, z, e], true));
    let near = (fine.clone(), fine.clone(), Just(f64::NAN), fine).prop_map(|(x, y, z, e)| ([x, y, z, e], false));
    let steps = proptest::collection::vec((prop_oneof![1 => far, 3 => near], 0.5..400.0f64), 1..60);
    steps.prop_map(|steps| {
        let mut at = [0.0f64; 4];
        let mut path = Path::new();
        for ((words, absolute), speed) in steps {
            for (i, (at, word)) in at.iter_mut().zip(words).enumerate() {
                if !word.is_nan() {
                    *at = if absolute && i < 3 { word } else { *at + word };
                }
            }
            path.push((at, speed));
        }
        path
    })
}

fn counts(steps: &[Step]) -> [i64; MOTORS] {
    let mut counts = [0; MOTORS];
    for s in steps {
        for (motor, count) in Motor::ALL.into_iter().zip(&mut counts) {
            if s.steps.has(motor) {
                *count += if s.forward.has(motor) { 1 } else { -1 };
            }
        }
    }
    counts
}

fn tool_jump([x, y, z, _]: [f64; 4]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// The greatest jump of the tool's velocity in any corner: `2 v cos t` with `v^2 = a d s / (1 - s)` and s as the sine
/// of half the angle t between the moves is at most `sqrt(8 a d)`.
fn most_jump(s: &Settings) -> f64 {
    match s.corner {
        CornerRule::JunctionDeviation(d) => {
            let a = s.print_acceleration.max(s.travel_acceleration).to_num::<f64>();
            (8.0 * a * d.to_num::<f64>()).sqrt()
        }
        CornerRule::SquareCorner(w) => w.to_num::<f64>() * (8.0 * (2f64.sqrt() - 1.0)).sqrt(),
    }
}

/// Requirements on a chain of moves. It is continuous in speed except at corners, which jump within their limit. It
/// stays within the limits of axes and belt motors, and it is at rest at its end.
pub fn check_chain(moves: &[Move], s: &Settings) -> Result<(), TestCaseError> {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    let [motor_speed, motor_acceleration] =
        [s.motor_max_speed.to_num::<f64>(), s.motor_max_acceleration.to_num::<f64>()];
    let [ax, ay, az, ae] = s.axes.map(|a| a.max_speed.to_num::<f64>()).to_array();
    let most_speed = [ax, ay, az, ae, motor_speed, motor_speed];
    let [ax, ay, az, ae] = s.axes.map(|a| a.max_acceleration.to_num::<f64>()).to_array();
    let most_acceleration = [ax, ay, az, ae, motor_acceleration, motor_acceleration];
    let mut from = [Steps::ZERO; 4];
    let mut carried = 0.0;
    let mut velocity = [0.0; 4];
    for (i, m) in moves.iter().enumerate() {
        let d: [f64; 4] = std::array::from_fn(|i| m.end[i].wrapping_sub(from[i]).to_num::<f64>() / pitch[i]);
        let tool = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let length = if tool > 0.0 { tool } else { d[3].abs() };
        let [entry, peak, exit] = speeds(m, 1.0);
        let slack = 1e-3 + 1e-4 * peak * length;
        prop_assert!(
            (entry * length - carried).abs() <= slack,
            "move {i} enters with {} mm/s, the one before left with {carried}",
            entry * length
        );
        carried = exit * length;
        let jump: [f64; 4] = std::array::from_fn(|i| d[i] * entry - velocity[i]);
        velocity = d.map(|d| d * exit);
        prop_assert!(tool_jump(jump) <= most_jump(s) * 1.001 + 1e-3, "move {i} begins with a jump of {jump:?} mm/s");
        let jerk = s.extruder_jerk.to_num::<f64>();
        prop_assert!(jump[3].abs() <= jerk * 1.001 + 1e-3, "move {i} begins with a jump of {jump:?} mm/s");
        // The belt motors' coordinates stand behind the axes.
        let d = [d[0], d[1], d[2], d[3], d[0] + d[1], d[0] - d[1]];
        let a = if m.accelerate.0 > 0 { (peak - entry) / (m.accelerate.0 as f64 / 65536.0 / 1e7) } else { 0.0 };
        let b = if m.decelerate.0 > 0 { (peak - exit) / (m.decelerate.0 as f64 / 65536.0 / 1e7) } else { 0.0 };
        for axis in 0..6 {
            let v = peak * d[axis].abs();
            prop_assert!(v <= most_speed[axis] * 1.0001 + 1e-3, "move {i}, axis {axis}: {v} mm/s");
            // Ramps shorter than 10 ticks are all rounding.
            for (a, t, share) in [(a, m.accelerate, m.accelerated), (b, m.decelerate, WHOLE - m.cruised)] {
                let a = a * d[axis].abs();
                let short = t.0 < 10 << 16;
                // The ramp's length is a whole number of 2^-31 of the move: of 250 mm that a last 11 nm end, 92.
                let rounding = 1.0 + 1.0 / f64::from(share.max(1));
                let most = most_acceleration[axis] * 1.001 * rounding + 1.0;
                prop_assert!(short || a <= most, "move {i}, axis {axis}: {a} mm/s2");
            }
        }
        from = m.end;
    }
    prop_assert!(moves.last().is_none_or(|m| m.rests && m.exit_share == 0), "the last move does not rest");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn limits_are_never_exceeded(path in paths()) {
        let settings = Settings::prototype();
        check_chain(&plan(&path, &settings), &settings)?;
    }

    #[test]
    fn no_machine_is_asked_for_more_than_it_bears(path in paths(), seed in 1..u64::MAX) {
        let settings = machine(&mut Dice(seed));
        check_chain(&plan(&path, &settings), &settings)?;
    }

    /// After any released moves, the moves still in the window brake the machine to rest.
    #[test]
    fn any_prefix_of_released_moves_can_stop(path in paths(), cuts in proptest::collection::vec(0..4u8, 60)) {
        let settings = Settings::prototype();
        let mut memory = MoveMemory::new();
        let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
        let mut moves = Vec::new();
        for ((position, speed), cut) in path.iter().zip(&cuts) {
            planner.push(&target(*position, *speed), &settings);
            match cut {
                1 => planner.release_next(),
                2 => planner.release_some(),
                _ => {}
            }
            moves.extend(std::iter::from_fn(|| planner.pop()));
        }
        planner.release_all();
        moves.extend(std::iter::from_fn(|| planner.pop()));
        check_chain(&moves, &settings)?;
    }

    /// When final moves leave makes no difference to any move.
    #[test]
    fn final_moves_are_the_same_whenever_they_leave(
        path in paths(),
        cuts in proptest::collection::vec(any::<bool>(), 60),
    ) {
        let settings = Settings::prototype();
        let mut memory = MoveMemory::new();
        let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
        let mut moves = Vec::new();
        for ((position, speed), cut) in path.iter().zip(&cuts) {
            planner.push(&target(*position, *speed), &settings);
            if *cut {
                moves.extend(std::iter::from_fn(|| planner.pop()));
            }
        }
        planner.release_all();
        moves.extend(std::iter::from_fn(|| planner.pop()));
        prop_assert_eq!(moves, plan(&path, &settings));
    }

    /// Nor does it where the moves are so short that hardly one is final before its batch is frozen.
    #[test]
    fn moves_of_batches_are_the_same_whenever_they_leave(
        ways in proptest::collection::vec((-0.002..0.05, -0.01..0.01), 150..600),
        cuts in proptest::collection::vec(0..40_u8, 600),
        feed in 20.0..400.0,
        change in proptest::option::of((100..400_usize, 10..300_u16)),
    ) {
        let settings = Settings::prototype();
        let run = |cuts: &[u8]| {
            let mut memory = MoveMemory::new();
            let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
            let (mut moves, mut at) = (Vec::new(), [0.0; 4]);
            for (i, (dx, dy)) in ways.iter().enumerate() {
                // At times none, at times a few more than one are added.
                let most = cuts.get(i).map_or(0, |cut| usize::from(cut.saturating_sub(20)));
                moves.extend(std::iter::from_fn(|| planner.pop()).take(most));
                if !planner.has_room() {
                    planner.release_some();
                    moves.push(planner.pop().expect("a full window has a move that may leave"));
                }
                (at[0], at[1]) = (at[0] + dx, at[1] + dy);
                planner.push(&target(at, feed), &settings);
                if let Some((_, percent)) = change.filter(|change| change.0 == i) {
                    // Released moves keep their feed.
                    moves.extend(std::iter::from_fn(|| planner.pop()));
                    planner.override_feed(percent);
                    while !planner.replan() {}
                }
            }
            planner.release_all();
            moves.extend(std::iter::from_fn(|| planner.pop()));
            moves
        };
        prop_assert_eq!(run(&cuts), run(&[]));
    }

    #[test]
    fn pairs_step_together_and_the_belt_is_never_strained(path in paths()) {
        let steps = generate(&plan(&path, &Settings::prototype()));
        let mut last = [None::<u64>; MOTORS];
        for s in &steps {
            let has = |m| s.steps.has(m);
            prop_assert_eq!(has(prototype::M1), has(prototype::M8));
            prop_assert_eq!(has(prototype::M4), has(prototype::M11));
            prop_assert_eq!(has(prototype::Z1), has(prototype::Z2));
            for (motor, last) in Motor::ALL.into_iter().zip(&mut last) {
                if has(motor) {
                    prop_assert!(last.is_none_or(|l| s.tick >= l + MIN_STEP_INTERVAL), "{motor:?} at {}", s.tick);
                    *last = Some(s.tick);
                }
            }
            prop_assert!(!has(prototype::M1) || s.forward.has(prototype::M1) != s.forward.has(prototype::M8));
            prop_assert!(!has(prototype::M4) || s.forward.has(prototype::M4) != s.forward.has(prototype::M11));
        }
        prop_assert!(steps.windows(2).all(|w| w[0].tick <= w[1].tick));
        let [n1, n4, n8, n11, ..] = counts(&steps);
        prop_assert_eq!(residual(BeltSteps { n1, n4, n8, n11 }), 0);
    }

    #[test]
    fn the_end_is_met_to_the_step(path in paths()) {
        let settings = Settings::prototype();
        let moves = plan(&path, &settings);
        let steps = generate(&moves);
        let end = moves.last().map_or([Steps::ZERO; 4], |m| m.end);
        let nearest = |v: Steps| (v + Steps::from_num(0.5)).to_num::<i64>();
        let [n1, n4, n8, n11, z1, z2, e0, ..] = counts(&steps);
        prop_assert_eq!((n4, n1), (-n11, -n8));
        prop_assert_eq!((z1, z2, e0), (nearest(end[2]), nearest(end[2]), nearest(end[3])));
        // And the end is where the last target said, to within half a step of the belt and half a micrometre.
        let (target, _) = path[path.len() - 1];
        for (doubled, want) in [n11 + n8, n11 - n8].into_iter().zip(target) {
            prop_assert!((doubled as f64 / 2.0 - want * 80.0).abs() <= 0.5 + 0.05, "{doubled} half steps, {want} mm");
        }
    }
}

/// Two pieces of this path end in one tick at different parts of it. A group that went on alone took the axis past the
/// other's end, and they stepped a tick apart.
#[test]
fn pieces_that_end_in_one_tick_are_followed_together() {
    let path: Path = vec![
        ([0.0, 137.7071570468326, 0.0, 0.0], 1.0),
        ([210.4781379344381, 137.7071570468326, 0.0, 0.0], 274.07293020930285),
        ([210.4781379344381, 133.63341551429573, 0.0, 0.0], 276.4963066372195),
        ([1.0, 133.63341551429573, 0.0, 0.0], 255.59925796755945),
    ];
    for s in generate(&plan(&path, &Settings::prototype())) {
        assert_eq!(s.steps.0 & 0x0F, 0x0F, "at {}", s.tick);
    }
}
