//! Circles of chords, as slicers write them: the tool follows them at one speed.

use super::speeds::speeds;
use crate::line::plan;
use corehbot::settings::Settings;
use std::f64::consts::TAU;

/// Rounded as text is.
fn rounded(v: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (v * scale).round() / scale
}

/// Two turns and a half of a circle in chords of `chord` mm round the middle of the bed.
fn circle(radius: f64, chord: f64, decimals: i32, feed: f64) -> Vec<([f64; 4], f64)> {
    let chords = (TAU * radius / chord).round();
    let point = |i: usize| {
        let angle = i as f64 * TAU / chords + 0.1;
        let at = [195.0 + radius * angle.cos(), 208.0 + radius * angle.sin()].map(|v| rounded(v, decimals));
        ([at[0], at[1], 5.0, rounded(0.033 * chord * i as f64, 5)], feed)
    };
    (0..=(2.5 * chords) as usize).map(point).collect()
}

/// The least and the greatest speed in the second turn.
fn second_turn(radius: f64, targets: &[([f64; 4], f64)], s: &Settings) -> (f64, f64) {
    let moves = plan(targets, s);
    let mut from = moves[0].end;
    let (mut way, mut least, mut most) = (0.0, f64::MAX, 0f64);
    for m in &moves[1..] {
        let d: [f64; 2] = std::array::from_fn(|i| (m.end[i] - from[i]).to_num::<f64>() / 80.0);
        let length = d[0].hypot(d[1]);
        from = m.end;
        way += length;
        let turns = way / (TAU * radius);
        if (0.75..1.75).contains(&turns) {
            let speeds = speeds(m, length);
            least = speeds.into_iter().fold(least, f64::min);
            most = speeds.into_iter().fold(most, f64::max);
        }
    }
    (least, most)
}

/// Radius, feed and chord of circles that 3 m/s2 allow, at up to 220 mm/s.
fn allowed() -> impl Iterator<Item = (f64, f64, f64)> {
    [1.0, 2.0, 3.7, 5.0, 10.0, 20.0, 50.0].into_iter().flat_map(|radius: f64| {
        let limit = (3000.0 * radius).sqrt();
        let feeds = [0.3, 0.5, 0.7, 0.8, 0.9, 0.95].map(|part| (limit * part).min(220.0));
        feeds.into_iter().flat_map(move |feed| [0.1, 0.2].map(|chord| (radius, feed, chord)))
    })
}

#[test]
fn circles_of_rounded_chords_are_run_at_one_speed() {
    let s = Settings::prototype();
    for (radius, feed, chord) in allowed() {
        for decimals in [3, 5] {
            let (least, most) = second_turn(radius, &circle(radius, chord, decimals, feed), &s);
            let ripple = 100.0 * (most - least) / feed;
            assert!(ripple <= 0.5, "radius {radius}, {feed} mm/s, chords of {chord}, {decimals} decimals: {ripple} %");
            assert!((most / feed - 1.0).abs() < 1e-4, "radius {radius}, {feed} mm/s: {most} mm/s");
        }
    }
}

#[test]
fn no_circle_is_run_much_faster_than_its_acceleration_allows() {
    let s = Settings::prototype();
    for radius in [1.0, 2.0, 5.0, 10.0, 20.0] {
        let limit = (3000.0f64 * radius).sqrt();
        for chord in [0.05, 0.1, 0.2] {
            for decimals in [3, 4, 5] {
                let (_, most) = second_turn(radius, &circle(radius, chord, decimals, 300.0), &s);
                // Rounded chords have angles that are too small, too.
                assert!(most < 1.15 * limit, "radius {radius}, chords of {chord}: {most} mm/s, {limit} allowed");
            }
        }
    }
}
