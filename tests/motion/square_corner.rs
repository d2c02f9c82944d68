//! Square-corner velocity: slow axes start and stop at a corner with what their own acceleration explains, as in
//! Klipper.
//!
//! The oracle is Klipper's law (klippy/toolhead.py, `Move.calc_junction`), written from its source. Each move has the
//! deviation `w^2 (sqrt 2 - 1) / max_accel` and its own acceleration, which an axis may have limited. The speed through
//! the corner is the least that the circles of both moves allow. Circles that would leave the moves' middles limit it
//! too. Klipper limits z alone (`max_z_accel`), so for y and the extruder the limited acceleration comes from the same
//! division, acceleration of the axis over its share.

use super::speeds::speeds;
use crate::line::plan;
use corehbot::settings::{CornerRule, Settings};
use corehbot::units::{MmPerSec, MmPerSec2};

const DOCUMENT: &str = include_str!("../../docs/explanation/kinematics.md");

/// The machine of the table: its accelerations are in the document.
const COMMANDED: f64 = 3000.0;
const OF_Z: f64 = 200.0;

/// A move of Klipper: direction and length, and the acceleration that it may have.
struct KlipperMove {
    way: [f64; 3],
    accel: f64,
}

/// Klipper's speed at the corner of two moves that are long enough for any speed.
fn klipper(square_corner: f64, max_accel: f64, before: &KlipperMove, after: &KlipperMove) -> f64 {
    let junction_deviation = square_corner.powi(2) * (2f64.sqrt() - 1.0) / max_accel;
    let length = |m: &KlipperMove| m.way.iter().map(|v| v * v).sum::<f64>().sqrt();
    let cosine = before.way.iter().zip(after.way).map(|(p, q)| p * q).sum::<f64>() / (length(before) * length(after));
    let sin_theta_d2 = (0.5 * (1.0 + cosine)).sqrt();
    let tan_theta_d2 = sin_theta_d2 / (0.5 * (1.0 - cosine)).sqrt();
    let r_jd = sin_theta_d2 / (1.0 - sin_theta_d2);
    let squares = [before, after].map(|m| {
        let centripetal = 0.5 * length(m) * m.accel * tan_theta_d2;
        (r_jd * junction_deviation * m.accel).min(centripetal)
    });
    squares[0].min(squares[1]).sqrt()
}

/// The prototype with these square-corner velocity and accelerations.
fn machine(square_corner: f64, commanded: f64) -> Settings {
    let mut s = Settings::prototype();
    s.corner = CornerRule::SquareCorner(MmPerSec::from_num(square_corner));
    (s.print_acceleration, s.travel_acceleration) = (MmPerSec2::from_num(commanded), MmPerSec2::from_num(commanded));
    s.axes.z.max_acceleration = MmPerSec2::from_num(OF_Z);
    s
}

/// The speed between two moves, each with its filament.
fn at_corner(moves: [[f64; 4]; 2], s: &Settings) -> f64 {
    let [first, second] = moves;
    let end: [f64; 4] = std::array::from_fn(|i| first[i] + second[i]);
    let planned = plan(&[(first, 300.0), (end, 300.0)], s);
    assert_eq!(planned.len(), 2);
    let after = &planned[1];
    let length = second[..3].iter().map(|v| v * v).sum::<f64>().sqrt();
    speeds(after, length)[0]
}

#[track_caller]
fn assert_near(found: f64, expected: f64, part: f64) {
    assert!((found / expected - 1.0).abs() < part, "{found} instead of {expected}");
}

/// The rows of the document: w, our first speed of z, Klipper's.
fn rows() -> Vec<[f64; 3]> {
    let (_, table) = DOCUMENT.split_once("| square-corner velocity |").unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
        <[f64; 3]>::try_from(numbers).unwrap()
    };
    rows.map(row).collect()
}

#[test]
fn z_starts_behind_a_corner_as_slowly_as_klippers_and_as_the_document_says() {
    let rows = rows();
    assert_eq!(rows.iter().map(|[w, ..]| *w).collect::<Vec<_>>(), [1.0, 5.0, 8.0, 20.0]);
    for [w, told, of_klipper] in rows {
        let s = machine(w, COMMANDED);
        let level = KlipperMove { way: [30.0, 0.0, 0.0], accel: COMMANDED };
        let up = KlipperMove { way: [0.0, 0.0, 10.0], accel: OF_Z };
        let expected = klipper(w, COMMANDED, &level, &up);
        assert_near(of_klipper, expected, 0.003);
        for (along, filament) in [([30.0, 0.0], 0.0), ([0.0, 30.0], 0.0), ([21.0, -21.0], 0.0), ([30.0, 0.0], 0.1)] {
            let level = [along[0], along[1], 0.0, filament];
            let up = [0.0, 0.0, 10.0, filament];
            let found = [at_corner([level, up], &s), at_corner([up, level], &s)];
            found.into_iter().for_each(|found| assert_near(found, expected, 0.02));
            assert_near(told, found[0], 0.003);
        }
    }
}

#[test]
fn corners_of_the_bed_plane_keep_the_square_corner_velocity() {
    for w in [1.0, 5.0, 8.0, 20.0] {
        let s = machine(w, COMMANDED);
        assert_near(at_corner([[30.0, 0.0, 0.0, 0.0], [0.0, 30.0, 0.0, 0.0]], &s), w, 1e-4);
    }
}

/// Any corner in space of moves that only z limits is as slow as Klipper's, or slower by the law along the turn.
#[test]
fn no_slope_is_entered_faster_than_klipper_enters_it() {
    let s = machine(8.0, COMMANDED);
    for (rise, slope) in [(0.0, 2.0), (0.5, -0.3), (4.0, 0.1), (0.02, -0.02), (30.0, -20.0)] {
        let ways = [[20.0, 0.0, rise], [14.0, 14.0, slope]];
        let moves = ways.map(|way| {
            let length = way.iter().map(|v| v * v).sum::<f64>().sqrt();
            KlipperMove { way, accel: COMMANDED.min(OF_Z * length / f64::max(way[2].abs(), 1e-9)) }
        });
        let expected = klipper(8.0, COMMANDED, &moves[0], &moves[1]);
        let found = at_corner(ways.map(|[x, y, z]| [x, y, z, 0.0]), &s);
        assert!(found <= expected * 1.0001, "{rise} {slope}: {found}, {expected}");
    }
}

/// Klipper has no limit of y.
#[test]
fn a_heavy_bed_in_y_starts_with_what_its_own_acceleration_explains() {
    let mut s = machine(20.0, COMMANDED);
    s.axes.y.max_acceleration = MmPerSec2::from_num(300);
    let expected = 20.0 * (300.0f64 / COMMANDED).sqrt();
    let (x, y) = ([30.0, 0.0, 0.0, 0.0], [0.0, 30.0, 0.0, 0.0]);
    for moves in [[x, y], [y, x]] {
        assert_near(at_corner(moves, &s), expected, 0.002);
    }
    // Both moves bear more than y, and the turn is all y.
    let flat = [[30.0, 1.0, 0.0, 0.0], [30.0, -1.0, 0.0, 0.0]];
    let turn = 2.0 * (1.0f64 / 30.0).atan();
    let half = (turn / 2.0).cos();
    let exact = (400.0 * (2f64.sqrt() - 1.0) * 300.0 / COMMANDED * half / (1.0 - half)).sqrt();
    assert_near(at_corner(flat, &s), exact.min(300.0), 0.01);
}

/// A thick line asks the extruder for more than it bears, so the whole move is slow, and its corners are.
#[test]
fn an_extruder_that_accelerates_slowly_makes_slow_corners() {
    let mut s = machine(8.0, COMMANDED);
    s.axes.e.max_acceleration = MmPerSec2::from_num(50);
    s.extruder_jerk = MmPerSec::from_num(3000);
    // Half a millimetre of filament a mm: 100 mm/s2.
    let expected = 8.0 * (100.0 / COMMANDED).sqrt();
    let (thick, travel) = ([30.0, 0.0, 0.0, 15.0], [0.0, 30.0, 0.0, 0.0]);
    assert_near(at_corner([thick, [0.0, 30.0, 0.0, 15.0]], &s), expected, 0.002);
    for moves in [[thick, travel], [travel, thick]] {
        assert_near(at_corner(moves, &s), expected, 0.002);
    }
}

#[test]
fn jerks_of_z_and_of_the_extruder_cap_every_corner() {
    for rule in CornerRule::all() {
        let mut s = machine(20.0, COMMANDED);
        s.corner = rule;
        (s.z_jerk, s.extruder_jerk) = (MmPerSec::from_num(0.4), MmPerSec::from_num(4.5));
        assert_near(at_corner([[30.0, 0.0, 0.0, 0.0], [0.0, 0.0, 10.0, 0.0]], &s), 0.4, 0.002);
        // The speed of z turns round: it jumps by twice its own.
        let peak = [[30.0, 0.0, 3.0, 0.0], [30.0, 0.0, -3.0, 0.0]];
        let slope = 2.0 * 3.0 / 909f64.sqrt();
        assert_near(at_corner(peak, &s), 0.4 / slope, 0.005);
        s.extruder_jerk = MmPerSec::from_num(0.1);
        assert_near(at_corner([[30.0, 0.0, 0.0, 1.5], [30.0, 0.0, 0.0, 0.0]], &s), 2.0, 0.002);
        // No jump at all is a stop.
        s.z_jerk = MmPerSec::ZERO;
        assert!(at_corner(peak, &s) < 0.01);
    }
}

/// A helix of three decimals goes up by nothing, a thousandth, nothing: no jerk of z was commanded.
#[test]
fn rounded_heights_are_no_jumps_of_z() {
    let mut s = machine(5.0, COMMANDED);
    s.z_jerk = MmPerSec::from_num(0.4);
    let mut targets = Vec::new();
    for i in 1..=400 {
        let z = (f64::from(i) * 0.0004 * 1000.0).round() / 1000.0;
        targets.push(([f64::from(i) * 0.1, 0.0, z, 0.0], 100.0));
    }
    let moves = plan(&targets, &s);
    let fastest = moves.iter().map(|m| speeds(m, 0.1)[1]).fold(0.0, f64::max);
    assert!(fastest > 95.0, "{fastest}");
}
