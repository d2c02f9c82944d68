//! Curves of all kinds, as polylines from coarse to fine. Within 4 ms the tool's velocity varies by no more than 1.3
//! times the change by acceleration, plus the largest jump that junction deviation allows at one corner (`share`).
//!
//! The reference knows nothing of chords or of the planner's law: it looks at the velocities alone.

use super::velocity::{Velocity, course, size, worst};
use crate::dice::Dice;
use crate::line::{plan, stream};
use corehbot::motion::Move;
use corehbot::settings::{CornerRule, Settings};
use corehbot::units::{Mm, MmPerSec2, Steps};
use std::f64::consts::{PI, TAU};

/// Seconds.
const BEND_TIME: f64 = 0.004;

/// The factor by which the acceleration may be exceeded: the tool may brake in a curve.
const MOST: f64 = 1.3;

type Points = Vec<[f64; 2]>;

/// The difference of two velocities, as a share of the allowed one. The jump of a corner that turns by t under junction
/// deviation d is `2 v sin(t/2)`, with `v^2 = a d s / (1 - s)` and `s = cos(t/2)`. That is `sqrt(4 a d s (1 + s))`, at
/// most `sqrt(8 a d)`.
fn share(p: Velocity, q: Velocity, a: f64, d: f64) -> f64 {
    size(std::array::from_fn(|i| q[i] - p[i])) / (MOST * a * BEND_TIME + (8.0 * a * d).sqrt())
}

/// A path that is drawn chord by chord.
pub struct Pen<'a> {
    dice: &'a mut Dice,
    at: [f64; 2],
    heading: f64,
    /// Length of a chord: of this and up to that.
    chords: [f64; 2],
    points: Points,
}

impl<'a> Pen<'a> {
    fn new(dice: &'a mut Dice, chords: [f64; 2]) -> Self {
        let heading = if dice.roll() < 0.3 { 0.0 } else { TAU * dice.roll() };
        Self { dice, at: [195.0, 208.0], heading, chords, points: vec![[195.0, 208.0]] }
    }

    fn chord(&mut self) -> f64 {
        let [least, most] = self.chords;
        least * (most / least).powf(self.dice.roll())
    }

    fn point(&mut self, at: [f64; 2]) {
        self.at = at;
        self.points.push(at);
    }

    fn ahead(&mut self, way: f64) {
        let (sin, cos) = self.heading.sin_cos();
        self.point([self.at[0] + way * cos, self.at[1] + way * sin]);
    }

    /// In one chord.
    fn line(&mut self, length: f64) {
        self.ahead(length);
    }

    /// In many.
    fn fine_line(&mut self, length: f64) {
        let mut way = 0.0;
        while way < length && self.points.len() < MOST_POINTS {
            let chord = self.chord();
            self.ahead(chord);
            way += chord;
        }
    }

    /// Chords with ends on an arc that turns by `turn`.
    fn arc(&mut self, radius: f64, turn: f64) {
        let mut done = 0.0;
        while done < turn.abs() && self.points.len() < MOST_POINTS {
            let step = (2.0 * (self.chord() / (2.0 * radius)).min(0.9).asin()).min(turn.abs() - done).max(1e-9);
            self.heading += 0.5 * step * turn.signum();
            self.ahead(2.0 * radius * (0.5 * step).sin());
            self.heading += 0.5 * step * turn.signum();
            done += step;
        }
    }

    fn sine(&mut self, amplitude: f64, period: f64, periods: f64) {
        let ([x, y], (sin, cos)) = (self.at, self.heading.sin_cos());
        let mut way = 0.0;
        while way < period * periods && self.points.len() < MOST_POINTS {
            let slope = amplitude * TAU / period * (TAU * way / period).cos();
            way += self.chord() / slope.hypot(1.0);
            let aside = amplitude * (TAU * way / period).sin();
            self.point([x + way * cos - aside * sin, y + way * sin + aside * cos]);
        }
    }
}

/// A path has no more points than this, or it would take too long.
const MOST_POINTS: usize = 1500;

/// Rounded as text is.
fn rounded(v: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (v * scale).round() / scale
}

/// Between two values, alike on a logarithmic scale.
fn log(dice: &mut Dice, least: f64, most: f64) -> f64 {
    least * (most / least).powf(dice.roll())
}

fn signed(dice: &mut Dice, v: f64) -> f64 {
    if dice.roll() < 0.5 { v } else { -v }
}

/// Kinds of curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Arc,
    Arcs,
    Sine,
    Kinks,
    Sharp,
    Spiral,
}

pub const KINDS: [Kind; 6] = [Kind::Arc, Kind::Arcs, Kind::Sine, Kind::Kinks, Kind::Sharp, Kind::Spiral];

/// The parts of a path.
#[allow(dead_code, reason = "shown where a test fails")]
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    pub kind: Kind,
    pub chords: [f64; 2],
    pub jitter: f64,
    pub decimals: Option<i32>,
}

pub fn curve(kind: Kind, dice: &mut Dice) -> (Recipe, Points) {
    let chord = log(dice, 0.001, 1.0);
    let chords = if dice.roll() < 0.3 { [log(dice, 0.001, chord), chord] } else { [chord, chord] };
    let jitter = if dice.roll() < 0.3 { log(dice, 1e-4, 0.02) } else { 0.0 };
    let decimals = (dice.roll() < 0.8).then(|| 2 + (5.0 * dice.roll()) as i32);
    let mut pen = Pen::new(dice, chords);
    ends(&mut pen);
    match kind {
        Kind::Arc => {
            let (radius, turn) = (log(pen.dice, 0.02, 20.0), log(pen.dice, 0.03, 2.0 * TAU));
            pen.arc(radius, turn);
        }
        Kind::Arcs => {
            for _ in 0..(2.0 + 8.0 * pen.dice.roll()) as u32 {
                let (radius, turn) = (log(pen.dice, 0.02, 20.0), log(pen.dice, 0.03, PI));
                let turn = signed(pen.dice, turn);
                pen.arc(radius, turn);
                if pen.dice.roll() < 0.3 {
                    let length = log(pen.dice, 0.003, 1.0);
                    pen.fine_line(length);
                }
            }
        }
        Kind::Sine => {
            let period = log(pen.dice, 0.05, 20.0);
            let amplitude = period * log(pen.dice, 0.003, 1.0);
            let periods = 1.0 + 9.0 * pen.dice.roll();
            pen.sine(amplitude, period, periods);
        }
        Kind::Kinks => {
            let (turn, space) = (log(pen.dice, 0.003, 1.0), log(pen.dice, 0.001, 1.0));
            for _ in 0..(2.0 + 18.0 * pen.dice.roll()) as u32 {
                let angle = signed(pen.dice, turn) * pen.dice.roll();
                pen.heading += if pen.dice.roll() < 0.5 { angle.abs() } else { angle };
                let length = space * 2.0 * pen.dice.roll();
                if pen.dice.roll() < 0.5 { pen.line(length) } else { pen.fine_line(length) }
            }
        }
        Kind::Sharp => {
            for _ in 0..(1.0 + 5.0 * pen.dice.roll()) as u32 {
                let angle = log(pen.dice, 0.03, 3.0);
                pen.heading += signed(pen.dice, angle);
                let length = log(pen.dice, 0.003, 5.0);
                pen.fine_line(length);
            }
        }
        Kind::Spiral => {
            let (mut radius, shrink) = (log(pen.dice, 0.02, 20.0), log(pen.dice, 0.3, 3.0));
            while (0.01..30.0).contains(&radius) && pen.points.len() < MOST_POINTS / 2 {
                pen.arc(radius, 0.2);
                radius *= shrink.powf(0.2);
            }
        }
    }
    ends(&mut pen);
    let mut points = pen.points;
    for point in &mut points {
        for v in point.iter_mut() {
            *v += jitter * (dice.roll() - 0.5);
            *v = decimals.map_or(*v, |decimals| rounded(*v, decimals));
        }
    }
    points.dedup();
    (Recipe { kind, chords, jitter, decimals }, points)
}

/// The path before and after a curve: a long line, perhaps cut as the curve is.
fn ends(pen: &mut Pen) {
    if pen.dice.roll() < 0.7 {
        pen.line(30.0);
    }
    if pen.dice.roll() < 0.5 {
        pen.fine_line(2.0);
    }
}

/// Targets along points, with filament if it `prints`.
fn targets(points: &[[f64; 2]], feed: f64, prints: bool) -> Vec<([f64; 4], f64)> {
    let (mut at, mut filament) = ([0.0; 2], 0.0);
    let target = |p: &[f64; 2]| {
        filament += if prints { 0.03 * (p[0] - at[0]).hypot(p[1] - at[1]) } else { 0.0 };
        at = *p;
        ([p[0], p[1], 0.0, filament], feed)
    };
    points.iter().map(target).collect()
}

/// The greatest share of a path, and its time: planned point by point, and as a stream, in which points on a line are
/// left out.
pub fn points_share(points: &[[f64; 2]], feed: f64, prints: bool, s: &Settings) -> (f64, f64) {
    let targets = targets(points, feed, prints);
    let (single, joined) = (plan(&targets, s), stream(&targets, s));
    let ([share, time], [joined_share, joined_time]) =
        (moves_share(&single, prints, s), moves_share(&joined, prints, s));
    if joined_share > share { (joined_share, joined_time) } else { (share, time) }
}

fn moves_share(moves: &[Move], prints: bool, s: &Settings) -> [f64; 2] {
    let a = if prints { s.print_acceleration } else { s.travel_acceleration }.to_num::<f64>();
    let CornerRule::JunctionDeviation(d) = s.corner else { unreachable!("the prototype has one") };
    worst(&course([Steps::ZERO; 4], moves, s), BEND_TIME, |p, q| share(p, q, a, d.to_num())).into()
}

/// The prototype, with other accelerations and another deviation.
pub fn other(dice: &mut Dice) -> Settings {
    let mut s = Settings::prototype();
    let a = MmPerSec2::from_num(log(dice, 800.0, 20_000.0));
    (s.print_acceleration, s.travel_acceleration) = (a, a);
    (s.axes.x.max_acceleration, s.axes.y.max_acceleration) = (a, a);
    s.motor_max_acceleration = a * 2;
    s.corner = CornerRule::JunctionDeviation(Mm::from_num(log(dice, 0.005, 0.1)));
    s
}

#[test]
fn every_curve_keeps_to_the_acceleration() {
    for kind in KINDS {
        let mut dice = Dice(0x1234_5678_9ABC_DEF1);
        let (mut greatest, mut moves) = (0f64, 0);
        for i in 0..150 {
            let s = if i % 3 == 0 { other(&mut dice) } else { Settings::prototype() };
            let (recipe, points) = curve(kind, &mut dice);
            let (feed, prints) = (log(&mut dice, 20.0, 300.0), dice.roll() < 0.5);
            let (share, time) = points_share(&points, feed, prints, &s);
            assert!(share <= 1.0, "{i}: {share:.2} of what is allowed at {time} s, {feed:.0} mm/s: {recipe:?}");
            (greatest, moves) = (greatest.max(share), moves + points.len());
        }
        println!("{kind:?}: {greatest:.2} of what is allowed, {moves} moves");
        assert!(greatest > 0.7 && moves > 15_000, "the curves ask for nothing");
    }
}

/// Bends of a tenth of a millimetre between two straight lines, in nine and in 24 chords, and a wave in chords of 0.02
/// mm. The corners of each are harmless by themselves.
#[test]
fn small_bends_in_fine_chords_are_no_straight_lines() {
    let s = Settings::prototype();
    let bend = |radius: f64, turn: f64, chords: u32, decimals: i32| {
        let mut points = vec![[50.0, 100.0], [100.0, 100.0]];
        let at = |angle: f64| [100.0 + radius * angle.sin(), 100.0 + radius * (1.0 - angle.cos())];
        points.extend((1..=chords).map(|i| at(turn * f64::from(i) / f64::from(chords)).map(|v| rounded(v, decimals))));
        let [x, y] = at(turn);
        points.push([x + 50.0 * turn.cos(), y + 50.0 * turn.sin()]);
        points
    };
    let wave = (0..1000).map(|i| 0.02 * f64::from(i)).map(|x| [100.0 + x, 100.0 + 0.1 * (TAU * x).sin()]);
    let wave: Points = wave.map(|p| p.map(|v| rounded(v, 3))).collect();
    for (what, points, feed) in [
        ("30 degrees", bend(0.12, PI / 6.0, 9, 4), 300.0),
        ("90 degrees", bend(0.05, PI / 2.0, 24, 5), 300.0),
        ("wave", wave, 200.0),
    ] {
        let (share, time) = points_share(&points, feed, false, &s);
        println!("{what}: {share:.2} of what is allowed");
        assert!(share <= 1.0, "{what}: {share:.2} of what is allowed at {time} s");
    }
}
