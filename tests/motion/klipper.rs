//! Klipper's look-ahead, written down again from its documentation and its behaviour: how long a path takes there.
//!
//! It is a rival, not a law of this firmware: a path here should take no longer. The law, for moves of the lengths L at
//! the acceleration a, with the junction deviation `d = w^2 (sqrt 2 - 1) / a` of the square-corner velocity w:
//!
//! - **Corner** with the angle t between two moves: `v^2` is at most `a d s / (1 - s)` with `s = sin(t/2)`. An arc that
//!   touches both moves may begin no farther from the corner than half of either: `v^2` is at most `a L/2 tan(t/2)` for
//!   both of them. The extruder's speed may jump by its own square-corner velocity.
//! - **Forward**: a corner is no faster than the corner before it and the acceleration between both allow.
//! - **Backward**: nor faster than the move can brake for the next corner; the path ends at rest.
//! - **Smoothed**: the same passes again with the part `1 - r` of the acceleration, with r the minimum cruise ratio.
//!   That plan has hills: it rises over some moves, and falls over the next. The peak of a hill, the mean of both
//!   squares where they meet, bounds the speed between corners over all of that hill, in the plan that is followed.

use super::Targets;
use super::velocity::Knot;
use std::iter::once;

/// Limits of the machine: mm/s, mm/s2.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub acceleration: f64,
    pub square_corner: f64,
    pub cruise_ratio: f64,
    pub extruder_corner: f64,
}

/// A move: squares of speeds in mm2/s2.
struct Move {
    direction: [f64; 3],
    length: f64,
    extrusion: f64,
    feed_sq: f64,
    gain_sq: f64,
    smooth_gain_sq: f64,
    /// The most at its begin: by its corner, and by the moves before it.
    entry_sq: f64,
    smooth_entry_sq: f64,
}

fn moves(targets: &Targets, limits: &Limits) -> Vec<Move> {
    let mut from = [0.0; 4];
    let mut moves = Vec::new();
    for (to, feed) in targets {
        let [x, y, z, e]: [f64; 4] = std::array::from_fn(|i| to[i] - from[i]);
        from = *to;
        let length = (x * x + y * y + z * z).sqrt();
        assert!(length > 0.0, "the tool moves in every move");
        moves.push(Move {
            direction: [x, y, z].map(|v| v / length),
            length,
            extrusion: e / length,
            feed_sq: feed * feed,
            gain_sq: 2.0 * limits.acceleration * length,
            smooth_gain_sq: 2.0 * limits.acceleration * (1.0 - limits.cruise_ratio) * length,
            entry_sq: 0.0,
            smooth_entry_sq: 0.0,
        });
    }
    moves
}

/// The most at the corner between two moves, squared, by its shape.
fn corner_sq(p: &Move, q: &Move, limits: &Limits) -> f64 {
    let cosine = -(0..3).map(|i| p.direction[i] * q.direction[i]).sum::<f64>();
    let (sine_half, cosine_half) = ((0.5 * (1.0 - cosine)).max(0.0).sqrt(), (0.5 * (1.0 + cosine)).max(0.0).sqrt());
    let jump = (p.extrusion - q.extrusion).abs();
    let jerk_sq = if jump > 0.0 { (limits.extruder_corner / jump).powi(2) } else { f64::INFINITY };
    if sine_half >= 1.0 || cosine_half <= 0.0 {
        return jerk_sq;
    }
    let deviation = limits.square_corner.powi(2) * (2f64.sqrt() - 1.0) / limits.acceleration;
    let arc = limits.acceleration * deviation * sine_half / (1.0 - sine_half);
    let half = limits.acceleration * p.length.min(q.length) / 2.0 * sine_half / cosine_half;
    arc.min(half).min(jerk_sq)
}

/// The speeds of each move in mm/s: at its begin, between, and at its end.
pub fn speeds(targets: &Targets, limits: &Limits) -> Vec<[f64; 3]> {
    let mut moves = moves(targets, limits);
    for i in 1..moves.len() {
        let (before, rest) = moves.split_at_mut(i);
        let (Some(p), Some(q)) = (before.last(), rest.first_mut()) else { continue };
        let most = corner_sq(p, q, limits).min(p.feed_sq).min(q.feed_sq).min(p.entry_sq + p.gain_sq);
        q.entry_sq = most;
        q.smooth_entry_sq = most.min(p.smooth_entry_sq + p.smooth_gain_sq);
    }
    // From the end: entries from which the end can be braked for, and the bound between corners, for each move.
    let mut entries = vec![0.0; moves.len() + 1];
    let mut bounds = vec![None; moves.len()];
    let (mut smooth, mut peak_sq, mut since_bound) = (0.0, 0.0, 0);
    for (i, m) in moves.iter().enumerate().rev() {
        let reach = entries[i + 1] + m.gain_sq;
        let smooth_reach = smooth + m.smooth_gain_sq;
        let smooth_entry = m.smooth_entry_sq.min(smooth_reach);
        entries[i] = m.entry_sq.min(reach);
        since_bound += 1;
        if smooth_entry < smooth_reach {
            // The smoothed plan does not brake all along this move: it rises somewhere in it.
            if since_bound > 1 || smooth_entry + m.smooth_gain_sq > smooth {
                peak_sq = 0.5 * (smooth_entry + smooth_reach);
            }
            bounds[i] = Some((0.5 * (entries[i] + reach)).min(m.feed_sq).min(peak_sq));
            since_bound = 0;
        }
        smooth = smooth_entry;
    }
    let mut last: f64 = 0.0;
    let mut speeds = Vec::new();
    for (bound, ends) in bounds.into_iter().zip(entries.windows(2)) {
        // A move that only brakes there goes on as its hill does.
        last = bound.unwrap_or(last.min(ends[0]));
        speeds.push([ends[0].min(last).sqrt(), last.sqrt(), ends[1].min(last).sqrt()]);
    }
    speeds
}

/// How long the path takes, in s.
pub fn time(targets: &Targets, limits: &Limits) -> f64 {
    let lengths = moves(targets, limits).into_iter().map(|m| m.length);
    speeds(targets, limits).into_iter().zip(lengths).map(|(v, length)| time_of(v, length, limits.acceleration)).sum()
}

fn time_of([entry, peak, exit]: [f64; 3], length: f64, acceleration: f64) -> f64 {
    let ramps = once(entry).chain(once(exit)).map(|v| (peak - v, (peak * peak - v * v) / (2.0 * acceleration)));
    let (times, ways) = ramps.fold((0.0, 0.0), |(time, way), (gain, ramp)| (time + gain / acceleration, way + ramp));
    times + (length - ways) / peak
}

/// How the velocity goes.
pub fn course(targets: &Targets, limits: &Limits) -> Vec<Knot> {
    let mut course = vec![Knot { time: 0.0, velocity: [0.0; 3] }];
    let mut time = 0.0;
    for (m, v) in moves(targets, limits).iter().zip(speeds(targets, limits)) {
        let [entry, peak, exit] = v;
        let a = limits.acceleration;
        let ways = (2.0 * peak * peak - entry * entry - exit * exit) / (2.0 * a);
        let phases = [0.0, (peak - entry) / a, (m.length - ways) / peak, (peak - exit) / a];
        for (phase, speed) in phases.into_iter().zip([entry, peak, peak, exit]) {
            time += phase;
            course.push(Knot { time, velocity: m.direction.map(|d| d * speed) });
        }
    }
    course
}
