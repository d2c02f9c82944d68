//! Moves along one axis: all motors that they need step in the same instants, after any earlier moves. Corners do not
//! depend on the place of the steps: they are the corners of the commanded path.

use super::speeds::speeds;
use crate::dice::Dice;
use crate::line::{Step, generate_on, generate_shaped, plan};
use corehbot::motion::Move;
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Ratio, StepsPerMm};

type Path = Vec<([f64; 4], f64)>;

fn at(x: f64, y: f64, speed: f64) -> ([f64; 4], f64) {
    ([x, y, 0.0, 0.0], speed)
}

/// The events between two ticks in which belt motors step, and the number of them that lack some.
fn lone(steps: &[Step], from: f64, to: f64) -> (usize, usize) {
    let is_within = |s: &&Step| (s.tick as f64) > from && (s.tick as f64) < to && s.steps.0 & 0x0F != 0;
    let events: Vec<&Step> = steps.iter().filter(is_within).collect();
    (events.len(), events.iter().filter(|s| s.steps.0 & 0x0F != 0x0F).count())
}

/// Begin and end of each move in ticks, and whether it goes a millimetre along x or y, filament and z aside.
fn axis_moves(path: &Path, moves: &[Move]) -> Vec<(f64, f64, bool)> {
    assert_eq!(path.len(), moves.len(), "every target is a move");
    let mut time = 0u64;
    let mut from = [0.0; 4];
    let each = path.iter().zip(moves).map(|((to, _), m)| {
        let begin = time as f64 / 65536.0;
        time += m.time().0;
        let d: [f64; 2] = std::array::from_fn(|i| to[i] - from[i]);
        from = *to;
        let is_one = (d[0] == 0.0) != (d[1] == 0.0);
        (begin, time as f64 / 65536.0, is_one && d[0].abs().max(d[1].abs()) >= 1.0)
    });
    each.collect()
}

/// Paths of long and short moves, along axes and across, to thousandths and to places between them; some that come to
/// rest on half steps.
fn wild(count: usize, dice: &mut Dice) -> Path {
    let mut place = [150.0, 150.0, 1.0, 0.0];
    let mut path = vec![(place, 200.0)];
    while path.len() < count {
        let grid = [0.001, 0.01, 1.0 / 160.0, 1.0 / 320.0, 1e-7][(dice.roll() * 5.0) as usize];
        let length = if dice.roll() < 0.5 { 0.01 + 0.8 * dice.roll() } else { 1.01 + 12.0 * dice.roll() };
        let mut go = |axis: usize, length: f64| {
            let to: f64 = place[axis] + length * if dice.roll() < 0.5 { -1.0 } else { 1.0 };
            place[axis] = ((to / grid).round() * grid).clamp(10.0, 380.0);
        };
        match path.len() % 7 {
            0 | 3 | 5 => go(0, length),
            1 | 4 => go(1, length),
            _ => {
                go(0, length);
                go(1, length * 0.7);
            }
        }
        place[3] += 0.04 * length;
        if place != path[path.len() - 1].0 {
            path.push((place, 10.0 * 30f64.powf(dice.roll())));
        }
    }
    path
}

fn settings(resolution: f64) -> Settings {
    let mut s = Settings::prototype();
    s.axes.x.steps_per_mm = StepsPerMm::from_num(resolution);
    s.axes.y.steps_per_mm = StepsPerMm::from_num(resolution);
    s
}

#[test]
fn every_event_of_a_long_axis_move_has_all_four_belt_motors() {
    let mut dice = Dice(0x0005_EED0_FA11_64ED);
    for resolution in [80.0, 80.0, 100.7, 160.0, 25.0] {
        for _ in 0..4 {
            let s = settings(resolution);
            let path = wild(300, &mut dice);
            let moves = plan(&path, &s);
            let steps = generate_on(&moves, &s);
            let mut count = 0;
            for (number, (begin, end, _)) in axis_moves(&path, &moves).into_iter().enumerate().filter(|(_, m)| m.2) {
                let (events, lone) = lone(&steps, begin + 0.5, end - 0.5);
                assert_eq!(lone, 0, "of {events} events of move {number}, {:?} at {resolution}/mm", path[number]);
                count += events;
            }
            assert!(count > 10_000, "{count} events");
        }
    }
}

/// Behind the slowest tap of a shaper, after the earlier motion has passed.
#[test]
fn a_shaped_axis_move_steps_all_four_when_the_corner_has_passed() {
    let mut s = Settings::prototype();
    let shaper = |kind| Shaper::new(kind, Hertz::from_num(50), Ratio::from_num(0.1));
    (s.shapers.x, s.shapers.y) = (shaper(ShaperKind::Mzv), shaper(ShaperKind::Zvd));
    let path = wild(300, &mut Dice(0xBEEF_5EED));
    let moves = plan(&path, &s);
    let steps = generate_shaped(&moves, &s);
    let mut count = 0;
    for (number, (begin, end, _)) in axis_moves(&path, &moves).into_iter().enumerate().filter(|(_, m)| m.2) {
        // The first taps come 5 ms after the begin, the last 25.
        let (events, lone) = lone(&steps, begin + 250_000.0, end);
        assert_eq!(lone, 0, "of {events} events of move {number}, {:?}", path[number]);
        count += events;
    }
    assert!(count > 5000, "{count} events");
}

/// Reproducer: short moves left y between half steps, and two pairs of motors stepped in turns for 40 mm.
#[test]
fn a_short_move_before_makes_no_difference() {
    let path = vec![at(10.0, 20.0, 100.0), at(10.5, 20.507, 100.0), at(50.5, 20.507, 100.0)];
    let s = Settings::prototype();
    let steps = generate_on(&plan(&path, &s), &s);
    let last = &steps[steps.len() - 3000..];
    assert!(last.iter().all(|step| step.steps.0 & 0x0F == 0x0F));
}

/// A place is missed by half a step at most, at the end of every move, and met exactly after an axis move.
#[test]
fn no_end_is_missed_by_more_than_half_a_step() {
    let s = Settings::prototype();
    for seed in 1..200u64 {
        let path = wild(40, &mut Dice(seed << 32 | 0x9E37_79B9));
        let steps = generate_on(&plan(&path, &s), &s);
        let mut counts = [0i64; 2];
        for step in &steps {
            for (count, motor) in counts.iter_mut().zip([3, 2]) {
                if step.steps.0 >> motor & 1 == 1 {
                    *count += if step.forward.0 >> motor & 1 == 1 { 1 } else { -1 };
                }
            }
        }
        let [u, v] = counts.map(|count| count as f64);
        let (to, _) = path[path.len() - 1];
        let (dx, dy) = ((u + v) / 2.0 - 80.0 * to[0], (u - v) / 2.0 - 80.0 * to[1]);
        assert!(dx.abs() <= 0.5 + 1e-6 && dy.abs() <= 0.5 + 1e-6, "seed {seed}: {dx} {dy} steps");
    }
}

/// Reproducers: ends on whole steps bent lines that were straight, by up to 60 degrees where one piece was 0.01 mm
/// long.
#[test]
fn a_straight_line_in_pieces_is_run_at_one_speed() {
    let s = Settings::prototype();
    let feed = 150.0;
    let issue = vec![at(40.007, 50.002, feed), at(40.013, 50.01, feed), at(70.013, 90.01, feed)];
    let mut dice = Dice(0x57AA_1647);
    let mut lines = vec![([10.007, 10.002], issue)];
    for _ in 0..200 {
        // Lines of slope 4/3, on which thousandths lie exactly.
        let mut place =
            [20.0 + (dice.roll() * 1000.0).round() / 1000.0, 20.0 + (dice.roll() * 1000.0).round() / 1000.0];
        let begin = place;
        let mut path = Vec::new();
        while place[0] < 200.0 {
            let parts = (1.0 + 3.0 * 4000f64.powf(dice.roll())).round();
            place = [place[0] + 0.003 * parts, place[1] + 0.004 * parts];
            path.push(at(place[0], place[1], feed));
        }
        lines.push((begin, path));
    }
    for (begin, line) in lines {
        // A retraction, during which the tool stands.
        let mut path = vec![at(begin[0], begin[1], feed), at(begin[0], begin[1], feed)];
        path.extend(line);
        path.iter_mut().skip(1).for_each(|(to, _)| to[3] = -1.0);
        let moves = plan(&path, &s);
        assert_eq!(moves.len(), path.len());
        let length: Vec<f64> =
            path[1..].windows(2).map(|w| (w[1].0[0] - w[0].0[0]).hypot(w[1].0[1] - w[0].0[1])).collect();
        let whole: f64 = length.iter().sum();
        let mut gone = 0.0;
        for (m, length) in moves[2..].iter().zip(&length) {
            // The speed that the acceleration of a travel allows between standstill at both ends.
            let a: f64 = s.travel_acceleration.to_num();
            let limit = |way: f64| (2.0 * a * way).sqrt().min(feed);
            let end = gone + length;
            let slowest = limit(gone).min(limit(whole - end));
            let [entry, peak, exit] = speeds(m, *length);
            assert!((entry - limit(gone).min(limit(whole - gone))).abs() < 0.02 * feed, "{entry} mm/s after {gone} mm");
            assert!((exit - limit(end).min(limit(whole - end))).abs() < 0.02 * feed, "{exit} mm/s after {end} mm");
            assert!(peak >= slowest * 0.98);
            gone = end;
        }
    }
}

/// Moves too short to be planned are no bend either, and a following move along an axis stays along it.
#[test]
fn a_move_too_short_to_be_one_bends_nothing() {
    let s = Settings::prototype();
    let feed = 100.0;
    let path = vec![
        at(10.0, 10.0, feed),
        at(40.0, 10.0, feed),
        at(40.0, 10.000_3, feed),
        at(80.0, 10.000_3, feed),
        at(80.000_2, 10.000_3, feed),
        at(120.000_2, 10.000_3, feed),
    ];
    let moves = plan(&path, &s);
    assert_eq!(moves.len(), 4);
    for m in &moves[2..] {
        let [entry, ..] = speeds(m, 40.0);
        assert!((entry - feed).abs() < 0.01, "{entry} mm/s");
    }
    let steps = generate_on(&moves, &s);
    let last = &steps[steps.len() - 5000..];
    assert!(last.iter().all(|step| step.steps.0 & 0x0F == 0x0F));
}

/// But their remainders do not add up.
#[test]
fn moves_too_short_to_be_one_do_not_add_up() {
    let s = Settings::prototype();
    let path: Path = (1..=10_000).map(|i| at(f64::from(i) * 0.000_3, f64::from(i) * 0.000_1, 10.0)).collect();
    let end = plan(&path, &s).last().unwrap().end;
    for (end, wanted) in end.iter().zip([3.0, 1.0]) {
        assert!((end.to_num::<f64>() / 80.0 - wanted).abs() < 0.000_6, "{end} steps instead of {wanted} mm");
    }
}
