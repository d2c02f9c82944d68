//! Shaped motion: every step against an independent model of shapers and pressure advance, in floating point.

use super::model::{Trapezoid, trapezoids};
use super::timing::{groups, steps_of, wander};
use crate::line::{self, generate_shaped, plan};
use corehbot::motion::Move;
use corehbot::settings::{HomedAxis, Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, Ratio, Seconds};
use std::f64::consts::{PI, SQRT_2};

/// The impulses of a shaper, in s.
fn impulses(shaper: &Shaper) -> Vec<(f64, f64)> {
    let (z, f): (f64, f64) = (shaper.damping.to_num(), shaper.frequency.to_num());
    let root = (1.0 - z * z).sqrt();
    let period = 1.0 / (f * root);
    let k = |share: f64| (-share * z * PI / root).exp();
    let raw: Vec<(f64, f64)> = match shaper.kind {
        ShaperKind::None => vec![(0.0, 1.0)],
        ShaperKind::Zv => vec![(0.0, 1.0), (0.5, k(1.0))],
        ShaperKind::Zvd => vec![(0.0, 1.0), (0.5, 2.0 * k(1.0)), (1.0, k(2.0))],
        ShaperKind::Mzv => {
            vec![(0.0, 1.0 - 1.0 / SQRT_2), (0.375, (SQRT_2 - 1.0) * k(0.75)), (0.75, (1.0 - 1.0 / SQRT_2) * k(1.5))]
        }
        // At 60 Hz and a damping of 0.05, from the literature; the times are in ms.
        ShaperKind::Ei => vec![(0.0, 0.30688), (8.3788, 0.46746), (16.6875, 0.22566)],
        ShaperKind::TwoHumpEi => vec![(0.0, 0.20430), (8.4408, 0.35523), (16.7289, 0.30830), (24.9013, 0.13217)],
    };
    let unit = if matches!(shaper.kind, ShaperKind::Ei | ShaperKind::TwoHumpEi) { 1e-3 } else { period };
    let sum: f64 = raw.iter().map(|(_, weight)| weight).sum();
    raw.into_iter().map(|(time, weight)| (time * unit, weight / sum)).collect()
}

fn mean(impulses: &[(f64, f64)]) -> f64 {
    impulses.iter().map(|(time, weight)| time * weight).sum()
}

/// The whole motion.
struct Motion {
    moves: Vec<Trapezoid>,
    begins: Vec<f64>,
    /// Pressure commanded at the begin of each move, in steps times s.
    pressure: Vec<f64>,
    advance: f64,
}

impl Motion {
    /// x, y, z, e and pressure at a time in s.
    fn at(&self, t: f64) -> [f64; 5] {
        let i = self.begins.partition_point(|begin| *begin <= t).saturating_sub(1);
        let m = &self.moves[i];
        let [x, y, z, e] = m.at(t - self.begins[i]);
        let moved = if self.pressure[i + 1] > self.pressure[i] { (e - m.from[3]) * self.advance } else { 0.0 };
        [x, y, z, e, self.pressure[i] + moved]
    }
}

/// The period of an axis at a position in steps, as a part of the period in its middle. Belts on both sides, and the
/// motors behind them, are springs in a row.
fn period(shaper: &Shaper, length: f64, at: f64) -> f64 {
    let (span, motor): (f64, f64) = (shaper.span.to_num(), shaper.motor_frequency.to_num());
    if span == 0.0 {
        return 1.0;
    }
    let whole: f64 = shaper.frequency.to_num();
    let soft = |f: f64| if f > 0.0 { 1.0 / (f * f) } else { 0.0 };
    let belt = 1.0 / (soft(whole) - soft(motor)).sqrt();
    let there = belt / (1.0 - (2.0 * (at / 80.0 - length / 2.0) / span).powi(2)).sqrt();
    ((soft(there) + soft(motor)) / soft(whole)).sqrt()
}

/// The functions of every motor group: taps of each axis, and the window of the advance.
struct Follow {
    x: Vec<(f64, f64)>,
    y: Vec<(f64, f64)>,
    delay: f64,
    window: f64,
    settings: Settings,
}

impl Follow {
    fn new(s: &Settings) -> Self {
        let (x, y) = (impulses(&s.shapers.x), impulses(&s.shapers.y));
        let window = line::window(s).unwrap_or_default().to_num();
        let delay = mean(&x).max(mean(&y)).max(window / 2.0);
        Self { x, y, delay, window, settings: *s }
    }

    fn at(&self, motion: &Motion, t: f64) -> [f64; 4] {
        let s = &self.settings;
        let axes = [(&s.shapers.x, HomedAxis::X), (&s.shapers.y, HomedAxis::Y)];
        let shaped = |impulses: &[(f64, f64)], axis: usize| {
            let (shaper, axis_of) = axes[axis];
            let reach = s.reach(axis_of);
            let (from, length): (f64, f64) = (reach.least.to_num(), (reach.most - reach.least).to_num());
            let mean = mean(impulses);
            // An impulse is as far from the mean as the period is long where the copy is.
            let copy = |time: f64| {
                let late = |at: f64| self.delay + (time - mean) * period(shaper, length, at - 80.0 * from);
                // The period depends on the place only if the belts are elastic; then it takes some rounds to find.
                let rounds = if shaper.span == Mm::ZERO { 1 } else { 5 };
                (0..rounds).fold(t - self.delay, |when, _| t - late(motion.at(when)[axis]))
            };
            impulses.iter().map(|(time, weight)| weight * motion.at(copy(*time))[axis]).sum::<f64>()
        };
        let late = motion.at(t - self.delay);
        let half = self.window / 2.0;
        let pressure = |t: f64| motion.at(t)[4];
        let push = if self.window > 0.0 {
            (pressure(t - self.delay + half) - pressure(t - self.delay - half)) / self.window
        } else {
            0.0
        };
        [shaped(&self.x, 0), shaped(&self.y, 1), late[2], late[3] + push]
    }
}

/// Where the axes x, y, z and e are at a time in s, given the moves that targets became.
pub fn positions(targets: &[([f64; 4], f64)], moves: &[Move], s: &Settings) -> impl Fn(f64) -> [f64; 4] {
    let model = trapezoids(targets, s);
    assert_eq!(moves.len(), model.len());
    let mut begins = vec![0.0];
    begins.extend(moves.iter().scan(0u64, |t, m| {
        *t += m.time().0;
        Some(*t as f64 / 65536.0 / 1e7)
    }));
    begins.pop();
    let advance: f64 = s.advance.time.to_num();
    let mut pressure = vec![0.0];
    for t in &model {
        let moves_tool = (0..3).any(|i| t.from[i] != t.to[i]);
        let way = t.to[3] - t.from[3];
        pressure.push(pressure[pressure.len() - 1] + if moves_tool && way > 0.0 { way * advance } else { 0.0 });
    }
    let (motion, follow) = (Motion { moves: model, begins, pressure, advance }, Follow::new(s));
    move |t| follow.at(&motion, t)
}

/// The number of steps, and the largest error, in ticks.
fn errors(targets: &[([f64; 4], f64)], s: &Settings) -> (usize, f64) {
    let moves = plan(targets, s);
    let positions = positions(targets, &moves, s);
    let steps = generate_shaped(&moves, s);
    let (mut count, mut worst) = (0, 0f64);
    for (g, group) in groups().iter().enumerate() {
        let row = group.row.map(f64::from);
        let value = |t: f64| -> f64 { positions(t).iter().zip(row).map(|(p, r)| p * r).sum() };
        let mut at = 0i64;
        for (tick, way) in steps_of(&steps, g) {
            let edge = at as f64 + 0.5 * f64::from(way);
            at += i64::from(way);
            let t = tick as f64 / 1e7;
            let speed = (value(t + 5e-7) - value(t - 5e-7)).abs() / 10.0;
            // Single precision leaves a position error of 2^-24 of the length of a span, a ten-thousandth of a step.
            let off = ((value(t) - edge).abs() - 2e-4).max(0.0) / speed.max(1e-6);
            // Where a move starts next to the end of the one before, the coordinate jumps across the edge.
            let leaps = (value(t - 1e-7) - edge) * (value(t + 1e-7) - edge) <= 0.0;
            let off = if leaps { off.min(1.0) } else { off };
            worst = worst.max(off);
            count += 1;
        }
        assert_eq!(at as f64, (value(1e9) + 0.5).floor(), "group {g} ends where it was sent");
    }
    (count, worst)
}

fn settings(x: ShaperKind, y: ShaperKind, advance: f64) -> Settings {
    let mut s = Settings::prototype();
    let shaper = |kind| Shaper::new(kind, Hertz::from_num(60), Ratio::from_num(0.05));
    (s.shapers.x, s.shapers.y) = (shaper(x), shaper(y));
    s.advance.time = Seconds::from_num(advance);
    s
}

#[test]
fn every_shaped_step_is_within_a_tick_of_the_model() {
    use ShaperKind::{Ei, Mzv, None, TwoHumpEi, Zv, Zvd};
    for (x, y, advance) in
        [(None, None, 0.0), (Mzv, Mzv, 0.0), (Zv, Zvd, 0.0), (None, Mzv, 0.05), (None, None, 0.04), (Mzv, Zvd, 0.05)]
    {
        let (count, worst) = errors(&wander(400, 0x1234_5678_9ABC_DEF1), &settings(x, y, advance));
        println!("{x:?} {y:?} {advance}: {count} steps, worst {worst:.3} ticks");
        assert!(count > 50_000 && worst <= 1.0, "{x:?} {y:?} {advance}: {worst} ticks");
    }
    // These are known to five digits: times to half a tick, weights to 5e-6 of the length on which an impulse acts.
    for (x, y) in ShaperKind::all().map(|kind| (kind, None)).chain([(Ei, TwoHumpEi)]) {
        let most = if matches!((x, y), (Ei | TwoHumpEi, None)) { 2.0 } else { 1.0 };
        let (_, worst) = errors(&wander(100, 0x1234_5678_9ABC_DEF1), &settings(x, y, 0.0));
        println!("{x:?} {y:?}: worst {worst:.3} ticks");
        assert!(worst <= most, "{x:?} {y:?}: {worst} ticks");
    }
}

#[test]
fn taps_stand_closer_where_belts_are_stiffer() {
    // The frame of the paper: 834.6 and 862.2 mm of belt, motors that are soft at 289 and 167 Hz.
    for (kind, stiff) in [(ShaperKind::Zv, false), (ShaperKind::Mzv, true), (ShaperKind::Zvd, true)] {
        let mut s = settings(kind, kind, 0.0);
        (s.shapers.x.span, s.shapers.y.span) = (Mm::from_num(834.6), Mm::from_num(862.2));
        if !stiff {
            (s.shapers.x.motor_frequency, s.shapers.y.motor_frequency) = (Hertz::from_num(289), Hertz::from_num(167));
        }
        if kind == ShaperKind::Zvd {
            // The middle of an axis that begins below 0 is elsewhere.
            s.axis_min.x = Mm::from_num(-40);
        }
        let (count, worst) = errors(&wander(150, 0x1234_5678_9ABC_DEF1), &s);
        println!("{kind:?}: {count} steps, worst {worst:.3} ticks");
        // A tap moves evenly within a span, while the tool speeds up over up to 50 ms: that is some us of the 6 ms
        // between taps.
        assert!(count > 20_000 && worst <= 150.0, "{kind:?}: {worst} ticks");
        // It is another motion than with taps that stand alike everywhere.
        let moves = plan(&wander(150, 0x1234_5678_9ABC_DEF1), &s);
        assert_ne!(generate_shaped(&moves, &s), generate_shaped(&moves, &settings(kind, kind, 0.0)));
    }
}
