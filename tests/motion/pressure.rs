//! Pressure advance within the extruder's limits: the extruder's motion for released moves, in floating point.
//!
//! The extruder moves at `v + (q(t + h/2) - q(t - h/2)) / h`, with v as the filament's speed and q as the pressure of
//! the moves. Both are straight lines between ends of phases, so the greatest values stand at these ends, and half a
//! window before and behind them.

use crate::dice::Dice;
use crate::line::{target, window};
use corehbot::motion::{Move, MoveMemory, Planner, WHOLE, advance_window};
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, MmPerSec, MmPerSec2, Ratio, Seconds};

/// The filament in a phase: its begin and end, its speed there, and the pressure for a speed, in s.
struct Piece {
    time: [f64; 2],
    speed: [f64; 2],
    k: f64,
}

/// The filament of moves that follow each other without a pause.
fn pieces(moves: &[Move], steps_per_mm: f64) -> Vec<Piece> {
    let part = |fraction: u32| f64::from(fraction) / f64::from(WHOLE);
    let (mut now, mut at, mut pieces) = (0.0, 0.0, Vec::new());
    for m in moves {
        let way = (m.end[3].to_num::<f64>() - at) / steps_per_mm;
        at = m.end[3].to_num();
        let k = if way == 0.0 { 0.0 } else { m.advance.to_num::<f64>() / steps_per_mm / way };
        let phases = [
            (part(m.accelerated), m.accelerate.0, part(m.entry_share), !m.brakes_first),
            (part(m.cruised) - part(m.accelerated), m.cruise.0, 1.0, true),
            (1.0 - part(m.cruised), m.decelerate.0, part(m.exit_share), false),
        ];
        for (fraction, time, slow_share, rises) in phases.into_iter().filter(|(_, time, ..)| *time > 0) {
            let time = time as f64 / 65536.0 / 1e7;
            let mean = fraction * way / time;
            let [slow, fast] = [slow_share * mean, (2.0 - slow_share) * mean];
            let speed = if rises { [slow, fast] } else { [fast, slow] };
            pieces.push(Piece { time: [now, now + time], speed, k });
            now += time;
        }
    }
    pieces
}

/// The speed of the filament, and its pressure.
fn at(pieces: &[Piece], time: f64) -> [f64; 2] {
    let found = pieces.partition_point(|piece| piece.time[1] <= time);
    let Some(piece) = pieces.get(found).filter(|piece| piece.time[0] <= time) else { return [0.0; 2] };
    let [from, to] = piece.time;
    let speed = piece.speed[0] + (time - from) / (to - from) * (piece.speed[1] - piece.speed[0]);
    [speed, piece.k * speed]
}

/// Just before and just after a time, in s.
const BESIDE: f64 = 2e-8;

/// The extruder's greatest speed, acceleration and jump of speed.
#[derive(Debug, Default)]
struct Asked {
    speed: f64,
    acceleration: f64,
    jump: f64,
}

fn asked(moves: &[Move], steps_per_mm: f64, window: f64) -> Asked {
    let pieces = pieces(moves, steps_per_mm);
    let half = window / 2.0;
    let mut times: Vec<f64> = pieces.iter().flat_map(|piece| piece.time).collect();
    times = times.iter().flat_map(|time| [time - half, *time, time + half]).collect();
    times.sort_by(f64::total_cmp);
    // Ends that fall together are one; their times are known to far less than that.
    times.dedup_by(|a, b| (*a - *b).abs() < 2.0 * BESIDE);
    let speed = |time: f64| {
        let q = |time: f64| at(&pieces, time)[1];
        at(&pieces, time)[0] + (q(time + half) - q(time - half)) / window
    };
    let mut most = Asked::default();
    for pair in times.windows(2) {
        let (from, to) = (pair[0] + BESIDE, pair[1] - BESIDE);
        let (begin, end) = (speed(from), speed(to));
        most.speed = most.speed.max(begin.abs()).max(end.abs());
        if to - from > 10.0 * BESIDE {
            most.acceleration = most.acceleration.max((end - begin).abs() / (to - from));
        }
        most.jump = most.jump.max((speed(pair[1] + BESIDE) - end).abs());
    }
    most
}

/// All moves that targets become, K changing with them.
fn plan(targets: &[([f64; 4], f64, f64)], s: &Settings) -> Vec<Move> {
    plan_with(targets, s, window(s))
}

/// The same by a planner that knows of that window.
fn plan_with(targets: &[([f64; 4], f64, f64)], s: &Settings, window: Option<Seconds>) -> Vec<Move> {
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, s, [Mm::ZERO; 4]);
    planner.set_advance_window(window);
    let (mut moves, mut settings) = (Vec::new(), *s);
    for (position, speed, k) in targets {
        if !planner.has_room() {
            planner.release_some();
            moves.extend(std::iter::from_fn(|| planner.pop()));
        }
        settings.advance.time = Seconds::from_num(*k);
        planner.push(&target(*position, *speed), &settings);
    }
    planner.release_all();
    moves.extend(std::iter::from_fn(|| planner.pop()));
    moves
}

/// The pair: a long advance, 150 mm/s, 5 m/s2.
#[test]
fn a_long_advance_stays_within_the_speed_of_the_extruder() {
    let mut s = Settings::prototype();
    s.print_acceleration = MmPerSec2::from_num(5000);
    for window in [None, Some(0.04)] {
        s.advance.time = Seconds::from_num(0.9);
        s.advance.window = window.map(Seconds::from_num);
        let ratio = 0.4 * 0.2 / (1.75f64.powi(2) * std::f64::consts::FRAC_PI_4);
        let targets: Vec<_> = (1..20u32)
            .map(|i| ([f64::from(i % 2) * 60.0, 0.0, 0.0, 60.0 * ratio * f64::from(i)], 150.0, 0.9))
            .collect();
        let length = advance_window(&s).to_num();
        // The same without the limits.
        let free = asked(&plan_with(&targets, &s, None), 400.0, length);
        assert!(free.speed > 110.0, "{window:?}: {free:?}");
        let asked = asked(&plan(&targets, &s), 400.0, length);
        println!("{window:?}: {asked:?}");
        assert!(asked.speed <= 80.0 && asked.acceleration <= 5000.0 && asked.jump <= 5.0, "{window:?}: {asked:?}");
        // Not needlessly slow: most of its speed is used.
        assert!(asked.speed > 55.0, "{window:?}: {asked:?}");
    }
}

/// A direct drive is not slowed down: moves change only where the extruder would be beyond its limits.
#[test]
fn an_advance_that_the_extruder_bears_changes_no_move() {
    let mut s = Settings::prototype();
    (s.print_acceleration, s.advance.time) = (MmPerSec2::from_num(5000), Seconds::from_num(0.05));
    let mut dice = Dice(0x1357_9BDF_2468_ACE1);
    let mut position = [0.0f64; 4];
    let targets: Vec<_> = (0..400)
        .map(|_| {
            let (x, y) = (300.0 * dice.roll(), 300.0 * dice.roll());
            position[3] += 0.0333 * (x - position[0]).hypot(y - position[1]);
            (position[0], position[1]) = (x, y);
            (position, 60.0 + 90.0 * dice.roll(), 0.05)
        })
        .collect();
    let with = plan(&targets, &s);
    s.advance.time = Seconds::ZERO;
    let without = plan(&targets, &s);
    let times = |moves: &[Move]| moves.iter().map(Move::time).collect::<Vec<_>>();
    assert_eq!(times(&with), times(&without));
}

fn wild(dice: &mut Dice, s: &Settings) -> Vec<([f64; 4], f64, f64)> {
    let mut position = [150.0, 150.0, 0.0, 0.0];
    let chord = [0.05, 0.3, 2.0, 30.0][(4.0 * dice.roll()) as usize];
    let mut angle = 0.0f64;
    let most: f64 = s.advance.time.to_num();
    (0..150)
        .map(|_| {
            let kind = dice.roll();
            let k = if dice.roll() < 0.9 { most } else { most * dice.roll() };
            if kind < 0.08 {
                position[3] += if dice.roll() < 0.5 { 2.0 } else { -2.0 } * dice.roll();
                return (position, 10.0 + 70.0 * dice.roll(), k);
            }
            angle += [0.02, 0.3, 3.0][(3.0 * dice.roll()) as usize] * (dice.roll() - 0.5);
            let length = chord * (0.3 + dice.roll());
            position[0] += length * angle.cos();
            position[1] += length * angle.sin();
            if kind < 0.85 {
                position[3] += length * (0.01 + 0.09 * dice.roll());
            } else if kind < 0.9 {
                position[3] -= length * 0.02 * dice.roll();
            }
            (position, 20.0 + 280.0 * dice.roll(), k)
        })
        .collect()
}

#[test]
fn no_advance_asks_the_extruder_for_more_than_it_bears() {
    let mut dice = Dice(0x0F1E_2D3C_4B5A_6978);
    let mut worst = [0.0f64; 3];
    for round in 0..300 {
        let mut s = Settings::prototype();
        let pick = |dice: &mut Dice, least: f64, most: f64| least * (most / least).powf(dice.roll());
        s.print_acceleration = MmPerSec2::from_num(pick(&mut dice, 500.0, 20_000.0));
        let a = MmPerSec2::from_num(pick(&mut dice, 1000.0, 20_000.0));
        (s.axes.x.max_acceleration, s.axes.y.max_acceleration, s.motor_max_acceleration) = (a, a, a);
        s.axes.e.max_speed = MmPerSec::from_num(pick(&mut dice, 25.0, 120.0));
        s.axes.e.max_acceleration = MmPerSec2::from_num(pick(&mut dice, 1000.0, 20_000.0));
        s.extruder_jerk = MmPerSec::from_num(pick(&mut dice, 1.0, 10.0));
        s.retract_acceleration = MmPerSec2::from_num(pick(&mut dice, 1000.0, 20_000.0));
        s.advance.time = Seconds::from_num(pick(&mut dice, 0.01, 4.0));
        s.advance.window = (dice.roll() < 0.5).then(|| Seconds::from_num(pick(&mut dice, 0.005, 0.2)));
        let kinds: Vec<_> = ShaperKind::all().collect();
        let kind = kinds[(dice.roll() * kinds.len() as f64) as usize];
        s.shapers.x = Shaper::new(kind, Hertz::from_num(pick(&mut dice, 20.0, 150.0)), Ratio::from_num(0.1));
        let window = advance_window(&s).to_num::<f64>();
        let moves = plan(&wild(&mut dice, &s), &s);
        let asked = asked(&moves, 400.0, window);
        let (v, a, jerk): (f64, f64, f64) =
            (s.axes.e.max_speed.to_num(), s.axes.e.max_acceleration.to_num(), s.extruder_jerk.to_num());
        let parts = [asked.speed / v, asked.acceleration / a, asked.jump / jerk];
        for (worst, part) in worst.iter_mut().zip(parts) {
            *worst = worst.max(part);
        }
        // Where lines of different width meet within a window, the ramps of two are added to the acceleration of a
        // third. That one may be greater than the mean of the two; the remainder is single precision.
        let is_kept = parts[0] <= 1.0 && parts[1] <= 1.05 && parts[2] <= 1.01;
        assert!(is_kept, "{round}: {parts:.3?} of speed, acceleration and jerk, {s:?}");
    }
    println!("at most {worst:.3?} of speed, acceleration and jerk");
    // They are used, too.
    assert!(worst.iter().all(|part| *part > 0.9), "{worst:?}");
}
