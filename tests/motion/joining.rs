//! Straight lines in fine chords: chords that may be joined to one move, and chords that may not.
//!
//! The reference knows the commanded points and the moves that were released, and nothing of how they were joined.

use super::properties::check_chain;
use crate::dice::Dice;
use crate::line::{plan, stream, target};
use corehbot::motion::{Move, MoveMemory, Planner};
use corehbot::settings::Settings;
use corehbot::units::{Mm, MmPerSec2, Ratio};
use std::f64::consts::TAU;

type Path = Vec<([f64; 4], f64)>;

fn rounded(v: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (v * scale).round() / scale
}

fn seconds(moves: &[Move]) -> f64 {
    moves.iter().map(|m| m.time().0 as f64 / 65536.0 / 1e7).sum()
}

fn pitch(s: &Settings) -> [f64; 4] {
    s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array()
}

/// A line from the origin in chords, with filament, in text with `decimals` decimals.
fn line([x, y, z]: [f64; 3], chords: u32, decimals: i32, feed: f64) -> Path {
    let length = (x * x + y * y + z * z).sqrt();
    let point = |i: u32| {
        let part = f64::from(i) / f64::from(chords);
        let [x, y, z] = [x, y, z].map(|v| rounded(10.0 + v * part, decimals) - 10.0);
        ([x, y, z, rounded(0.033 * length * part, 5)], feed)
    };
    (1..=chords).map(point).collect()
}

/// Checks moves against the commanded points. Each ends exactly at one of them, and all feeds and kinds within one move
/// are the same. Every point between lies on the line within the tolerance, its filament within half a step. Returns
/// the number of these points.
fn left_out(path: &Path, moves: &[Move], s: &Settings) -> usize {
    let pitch = pitch(s);
    let (mut from, mut next, mut count) = ([0.0; 4], 0, 0);
    for (number, m) in moves.iter().enumerate() {
        let end: [f64; 4] = std::array::from_fn(|i| m.end[i].to_num::<f64>() / pitch[i]);
        let is_end = |p: &[f64; 4]| (0..4).all(|i| (p[i] - end[i]).abs() < 2e-8);
        let last = (next..path.len()).find(|i| is_end(&path[*i].0));
        assert!(last.is_some(), "move {number} ends at {end:?}, where nothing was commanded after point {next}");
        let Some(last) = last else { break };
        let (first, _) = path[next];
        // The first chord decides along which axis the line is longest; with 45 degrees it may be either.
        let most = (0..3).map(|i| (first[i] - from[i]).abs()).fold(0.0, f64::max);
        let mains = (0..3).filter(|i| (first[*i] - from[*i]).abs() > 0.999 * most);
        let mut before = from;
        for (point, feed) in &path[next..=last] {
            assert_eq!(*feed, path[last].1, "move {number} has two feeds");
            let filament = |p: f64, q: f64| if (q - p).abs() < 1e-9 { 0.0 } else { (q - p).signum() };
            assert_eq!(filament(before[3], point[3]), filament(from[3], first[3]), "move {number} is of two kinds");
            before = *point;
        }
        for (point, _) in &path[next..last] {
            count += 1;
            let is_rounded = (0..3).all(|i| {
                let way = (point[i] - from[i]) * 1000.0;
                (way - way.round()).abs() < 1e-5
            });
            let tolerance = if is_rounded { 0.001 } else { 0.000_1 };
            // As a share of the tolerance.
            let off = |main: usize| {
                let part = (point[main] - from[main]) / (end[main] - from[main]);
                assert!((0.0..1.0).contains(&part), "move {number} goes back");
                let off = |i: usize| (point[i] - from[i] - part * (end[i] - from[i])).abs();
                let most = |i| if i < 3 { tolerance } else { 0.5 / pitch[3] };
                (0..4).map(|i| off(i) / (most(i) * 1.001 + 1e-7)).fold(0.0, f64::max)
            };
            let off = mains.clone().map(off).fold(f64::INFINITY, f64::min);
            assert!(off <= 1.0, "move {number}: {off} times as far from the line as it may be");
        }
        (from, next) = (end, last + 1);
    }
    assert_eq!(next, path.len(), "the last point is an end");
    count
}

/// 250 mm at 300 mm/s and 1000 mm/s2: 1.13 s. The 128 moves that are seen at least would be 6.4 mm.
#[test]
fn a_straight_line_is_as_fast_in_fine_chords_as_in_one() {
    let mut s = Settings::prototype();
    (s.print_acceleration, s.travel_acceleration) = (MmPerSec2::from_num(1000), MmPerSec2::from_num(1000));
    for way in [[250.0, 0.0, 0.0], [216.506, 125.0, 0.0], [0.0, 250.0, 0.0], [-176.77, -176.77, 0.0]] {
        let whole = seconds(&plan(&line(way, 1, 5, 300.0), &s));
        let path = line(way, 5000, 5, 300.0);
        let moves = stream(&path, &s);
        assert!(left_out(&path, &moves, &s) > 4800, "{way:?}: {} moves", moves.len());
        println!("{way:?}: {:.3} s, {whole:.3} in one, {} moves", seconds(&moves), moves.len());
        assert!((whole - 1.133).abs() < 2e-3 && seconds(&moves) < whole + 2e-3, "{way:?}: {} s", seconds(&moves));
        check_chain(&moves, &s).unwrap();
    }
}

/// The line is 200 mm at 300 mm/s and 3000 mm/s2: 0.77 s, with points that are up to half a thousandth off along each
/// axis.
#[test]
fn rounded_coordinates_are_no_corners() {
    let s = Settings::prototype();
    for degrees in [0.0f64, 1.3, 6.0, 17.0, 25.8, 30.0, 41.0, 45.0, 63.2, 88.9] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        for chord in [0.02, 0.05, 0.1, 0.3] {
            let way = [200.0 * cos, 200.0 * sin, 0.0];
            let path = line(way, (200.0 / chord) as u32, 3, 300.0);
            let moves = stream(&path, &s);
            let time = seconds(&moves);
            println!("{degrees} degrees, {chord} mm: {time:.3} s, {} of {} moves", moves.len(), path.len());
            assert!(time < 0.774, "{degrees} degrees, {chord} mm: {time:.3} s");
            left_out(&path, &moves, &s);
            check_chain(&moves, &s).unwrap();
        }
    }
}

/// A polygon's corners stay where they were commanded, however many it has; coordinates rounded to thousandths allow
/// their rounding error.
#[test]
fn a_polygon_of_a_thousand_sides_stays_one() {
    let s = Settings::prototype();
    for radius in [15.0, 20.0, 50.0, 100.0, 150.0] {
        let polygon = |decimals: i32| -> Path {
            let point = |i: u32| {
                let (sin, cos) = (TAU * f64::from(i) / 1000.0).sin_cos();
                ([rounded(radius * (1.0 - cos), decimals), rounded(radius * sin, decimals), 0.0, 0.0], 300.0)
            };
            (1..=1000).map(point).collect()
        };
        for decimals in [5, 9] {
            assert_eq!(stream(&polygon(decimals), &s).len(), 1000, "radius {radius}, {decimals} decimals");
        }
        let (path, moves) = (polygon(3), stream(&polygon(3), &s));
        println!("radius {radius}: {} moves of three decimals", moves.len());
        // At the coarsest, no chord has more than the tolerance for its height.
        let most_chord = 2.0 * (2.0 * radius * 0.0022_f64).sqrt();
        assert!(moves.len() as f64 > TAU * radius / most_chord - 1.0, "radius {radius}: {} moves", moves.len());
        left_out(&path, &moves, &s);
        check_chain(&moves, &s).unwrap();
        assert!(seconds(&moves) < seconds(&plan(&path, &s)) * 1.0001, "radius {radius}");
    }
}

/// Paths of all kinds, chord by chord.
struct Pen {
    dice: Dice,
    at: [f64; 4],
    heading: f64,
    feed: f64,
    decimals: i32,
    flow: f64,
    path: Path,
}

impl Pen {
    fn roll(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.dice.roll()
    }

    fn log(&mut self, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.dice.roll())
    }

    fn go(&mut self, way: [f64; 4]) {
        self.at = std::array::from_fn(|i| self.at[i] + way[i]);
        let decimals = self.decimals;
        let [x, y, z, e] = self.at;
        let point = [rounded(x, decimals), rounded(y, decimals), rounded(z, decimals), rounded(e, 5)];
        let last = self.path.last().map_or([0.0; 4], |(p, _)| *p);
        // Half a micrometre is no move.
        if (0..3).map(|i| (point[i] - last[i]).powi(2)).sum::<f64>() > 1e-6 || (point[3] - last[3]).abs() > 1e-3 {
            self.path.push((point, self.feed));
        }
    }

    fn ahead(&mut self, chord: f64, turn: f64, climb: f64) {
        self.heading += turn;
        let (sin, cos) = self.heading.sin_cos();
        self.go([chord * cos, chord * sin, chord * climb, chord * self.flow]);
    }

    fn piece(&mut self, kind: u32) {
        let chord = self.log(0.005, 0.5);
        let count = (self.log(2.0, 120.0)) as u32;
        match kind {
            // A line; one that climbs, as in vase mode.
            0 | 1 => {
                let climb = if kind == 1 { self.log(1e-4, 0.02) } else { 0.0 };
                (0..count).for_each(|_| self.ahead(chord, 0.0, climb));
            }
            // Bends that are small by themselves, all to one side.
            2 => {
                let turn = self.log(1e-6, 0.05);
                (0..count).for_each(|_| self.ahead(chord, turn, 0.0));
            }
            // A zigzag, of any width.
            3 => {
                let turn = self.log(1e-5, 1.0);
                (0..count).for_each(|i| self.ahead(chord, if i % 2 == 0 { turn } else { -turn }, 0.0));
            }
            // A corner, and back on the same line.
            4 => self.heading += [0.5, 1.57, 3.0, std::f64::consts::PI][(self.dice.roll() * 4.0) as usize],
            // Filament alone, or the lift of a travel.
            5 => {
                let way = self.log(0.01, 2.0);
                if self.dice.roll() < 0.5 {
                    self.go([0.0, 0.0, 0.0, way - 1.0])
                } else {
                    self.go([0.0, 0.0, way, 0.0])
                }
                (0..count % 5).for_each(|_| self.go([0.0, 0.0, 0.004, 0.0]));
            }
            // Another feed, another flow, travel, or a wipe.
            6 => self.feed = self.dice.roll().mul_add(280.0, 20.0).round(),
            7 => self.flow = [0.0, 0.02, 0.033, -0.05][(self.dice.roll() * 4.0) as usize],
            // Chords of all lengths on one line, and noise.
            _ => {
                let noise = self.log(1e-5, 0.01);
                for _ in 0..count {
                    let (chord, turn) = (self.log(0.003, 1.0), self.roll(-noise, noise));
                    self.ahead(chord, turn, 0.0);
                    self.heading -= turn;
                }
            }
        }
    }
}

fn path(seed: u64) -> Path {
    let dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut pen = Pen { dice, at: [0.0; 4], heading: 0.0, feed: 150.0, decimals: 3, flow: 0.033, path: Path::new() };
    pen.decimals = [2, 3, 3, 4, 5, 9][(pen.dice.roll() * 6.0) as usize];
    pen.heading = if pen.dice.roll() < 0.3 { 0.0 } else { pen.roll(0.0, TAU) };
    while pen.path.len() < 300 {
        let kind = (pen.dice.roll() * 9.0) as u32;
        pen.piece(kind);
    }
    pen.path
}

#[test]
fn whatever_is_left_out_lies_on_the_line() {
    let (mut points, mut joined) = (0, 0);
    for seed in 1..=400 {
        let mut s = Settings::prototype();
        let a = MmPerSec2::from_num([300, 1000, 3000][seed as usize % 3]);
        (s.print_acceleration, s.travel_acceleration) = (a, a);
        let path = path(seed);
        let moves = stream(&path, &s);
        joined += left_out(&path, &moves, &s);
        points += path.len();
        if let Err(problem) = check_chain(&moves, &s) {
            panic!("seed {seed}: {problem}");
        }
    }
    println!("{joined} of {points} points left out");
    assert!(joined > points / 5, "{joined} of {points}");
}

/// The time at which moves leave, and the number of turns, do not change the joined lines.
#[test]
fn lines_are_the_same_whenever_moves_leave() {
    let s = Settings::prototype();
    for seed in 1..=60 {
        let path = path(seed);
        let whole = stream(&path, &s);
        let mut dice = Dice(seed | 1 << 40);
        let mut memory = MoveMemory::new();
        let mut planner = Planner::new(&mut memory, &s, [Mm::ZERO; 4]);
        let mut moves = Vec::new();
        for (position, speed) in &path {
            while !planner.has_room() {
                if !planner.has_ready() && !planner.close_line(&s) {
                    planner.release_some();
                }
                moves.extend(planner.pop());
            }
            planner.add(&target(*position, *speed), &s);
            if dice.roll() < 0.3 {
                moves.extend(std::iter::from_fn(|| planner.pop()));
            }
        }
        planner.close_line(&s);
        planner.release_all();
        moves.extend(std::iter::from_fn(|| planner.pop()));
        assert!(moves == whole, "seed {seed}");
    }
}

/// A line of one millimetre less a bit: without a cruise ratio it is the same move in chords and in one.
#[test]
fn a_line_in_chords_is_the_line() {
    let mut s = Settings::prototype();
    s.minimum_cruise_ratio = Ratio::ZERO;
    for way in [[0.9, 0.0, 0.0], [0.0, -0.9, 0.0], [0.5, 0.75, 0.0]] {
        assert_eq!(stream(&line(way, 20, 5, 300.0), &s), plan(&line(way, 1, 5, 300.0), &s), "{way:?}");
    }
}

/// Joining costs almost no time: chains of chords are as fast as before within 0.2 %, or faster.
#[test]
fn nothing_takes_longer() {
    let s = Settings::prototype();
    let (mut before, mut after) = (0.0, 0.0);
    for seed in 1..=150 {
        let path = path(seed);
        let (single, joined) = (seconds(&plan(&path, &s)), seconds(&stream(&path, &s)));
        assert!(joined < single * 1.002, "seed {seed}: {joined} s, {single} s move by move");
        (before, after) = (before + single, after + joined);
    }
    println!("{after:.2} s, {before:.2} s move by move");
    assert!(after < before);
}

/// A stream that ran dry in a line is reported if a chord comes that would have continued it, and only then.
#[test]
fn a_line_that_was_cut_is_remembered() {
    let s = Settings::prototype();
    let at = |x: f64, y: f64| target([x, y, 0.0, 0.0], 300.0);
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, &s, [Mm::ZERO; 4]);
    let cut = |planner: &mut Planner<'_>| {
        planner.stand_at(planner.steps([Mm::ZERO; 4]));
        planner.add(&at(0.05, 0.0), &s);
        assert_eq!((planner.len(), planner.is_empty()), (1, false));
        assert!(planner.cut_line(&s) && !planner.cut_line(&s));
        assert_eq!(planner.len(), 1);
    };
    cut(&mut planner);
    assert!(planner.was_cut_before(&at(0.1, 0.0)));
    assert!(!planner.was_cut_before(&at(0.1, 0.05)) && !planner.was_cut_before(&target([0.1, 0.0, 0.0, 0.01], 300.0)));
    // It is not continued, but followed.
    planner.add(&at(0.1, 0.0), &s);
    assert_eq!(planner.len(), 2);
    assert!(!planner.was_cut_before(&at(0.15, 0.0)), "that one is open");
    // A command that waits makes an end of it.
    cut(&mut planner);
    assert!(!planner.close_line(&s));
    assert!(!planner.was_cut_before(&at(0.1, 0.0)));
    // The path is counted once, also of a line that is dropped.
    let (_, before) = planner.planned();
    planner.stand_at(planner.steps([Mm::ZERO; 4]));
    planner.add(&at(0.05, 0.0), &s);
    planner.add(&at(0.1, 0.0), &s);
    planner.stand_at(planner.end());
    assert_eq!((planner.planned().1 - before, planner.len()), (100, 0));
}
