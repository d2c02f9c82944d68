//! The steps of some paths, kept: the same on every computer and in every version, but for a change of the law of motion that is
//! meant. Then the test says what is to be kept instead. That steps are right is what `tests/motion` holds to models; this finds,
//! within a second, that they are others. Two tests look at all that a Console and a planner see, so they also change with what is
//! reported, with what a move holds, and with how much is made at a time.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../stepper/clock.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod clock;
mod console;
#[path = "../motion/dice.rs"]
mod dice;
#[path = "../motion/line.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod line;
mod planner;

use corehbot::kinematics::Mechanism;
use corehbot::settings::{Settings, Shaper, ShaperKind, sum};
use corehbot::units::{Hertz, Mm, MmPerSec2, Ratio, Seconds};
use dice::Dice;
use line::{Step, generate, generate_on, generate_shaped, plan};
use std::f64::consts::TAU;

/// A place in mm (x, y, z, filament), and the speed on the way there in mm/s.
type Path = Vec<([f64; 4], f64)>;

/// How many events, the tick of the last, and a sum of all.
type Kept = (usize, u64, u32);

fn kept(steps: &[Step]) -> Kept {
    let add =
        |all: u32, step: &Step| sum(&(all, step.tick as u32, (step.tick >> 32) as u32, step.steps.0, step.forward.0));
    (steps.len(), steps.last().map_or(0, |step| step.tick), steps.iter().fold(0, add))
}

fn check(name: &str, steps: &[Step], expected: Kept) {
    let (count, last, all) = kept(steps);
    assert_eq!((count, last, all), expected, "{name}: the steps are others: ({count}, {last}, {all:#010X})");
}

/// A target of a path.
const fn to(x: f64, y: f64, z: f64, e: f64, speed: f64) -> ([f64; 4], f64) {
    ([x, y, z, e], speed)
}

/// Corners of every kind, fast and slow, with filament.
fn corners() -> Path {
    let mut place = [0.0; 4];
    let turn = |(i, degrees): (usize, f64)| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let length = [8.0, 0.9, 3.0, 0.05][i % 4];
        place = [place[0] + length * cos, place[1] + length * sin, 0.0, place[3] + 0.04 * length];
        (place, [150.0, 20.0, 300.0, 3.0][i % 4])
    };
    [10.0, 12.0, 100.0, 190.0, 185.0, 280.0, 275.0, 5.0, 50.0, 48.0, 300.0, 120.0]
        .into_iter()
        .enumerate()
        .map(turn)
        .collect()
}

/// A circle in fine chords, rounded as slicers do, and back to its begin.
fn circle() -> Path {
    let rounded = |mm: f64| (mm * 1e3).round() / 1e3;
    let at = |i: u32| {
        let (sin, cos) = (f64::from(i) / 90.0 * TAU).sin_cos();
        ([rounded(10.0 + 3.0 * cos), rounded(10.0 + 3.0 * sin), 0.2, 0.01 * f64::from(i)], 80.0)
    };
    (0..=90).map(at).collect()
}

/// Moves in all directions, some of a step and less, at 0.5 to 250 mm/s.
fn wild(seed: u64, count: usize) -> Path {
    let mut dice = Dice(seed);
    let mut place = [0.0; 4];
    let moves = (0..count).map(|_| {
        let length = 10f64.powf(-2.5 + 3.2 * dice.roll());
        for (axis, share) in [1.0, 1.0, 0.05, 0.05].into_iter().enumerate() {
            place[axis] += length * share * (2.0 * dice.roll() - 1.0);
        }
        (place, 0.5 * 500f64.powf(dice.roll()))
    });
    moves.collect()
}

/// Each axis alone, there and back; belt motors of both pairs, and one.
fn axes() -> Path {
    vec![
        to(5.0, 0.0, 0.0, 0.0, 120.0),
        to(5.0, 4.0, 0.0, 0.0, 120.0),
        to(1.0, 0.0, 0.0, 0.0, 60.0),
        to(1.0, 0.0, 1.0, 0.0, 8.0),
        to(1.0, 0.0, 1.0, 2.0, 40.0),
        to(1.003, 0.0, 1.0, 1.0, 25.0),
        to(0.0, 1.003, 0.5, 1.5, 30.0),
    ]
}

/// Moves too short to be made, which add up to some that are, in between others.
fn tiny() -> Path {
    let at = |i: u32| {
        let far = f64::from(i) * if i.is_multiple_of(7) { 1e-2 } else { 1e-4 };
        ([9.0 + far, 7.0 + 0.3 * far, 0.0, 0.9 + 0.1 * far], 30.0)
    };
    (0..40).map(at).collect()
}

/// Moves of up to a minute, in one direction and in several.
fn long() -> Path {
    vec![
        to(300.0, 0.0, 0.0, 1.0, 8.0),
        to(300.0, 300.0, 0.0, 1.0, 6.0),
        to(100.0, 100.0, 0.0, 1.0, 7.0),
        to(100.0, 100.0, 0.0, 90.0, 1.5),
        to(99.0, 40.0, 0.0, 91.0, 11.0),
    ]
}

/// The prototype with shapers, whose taps stand closer away from the middle if belts have these lengths in mm, and pressure advance.
fn shaped(kinds: [ShaperKind; 2], spans: [u16; 2]) -> Settings {
    let mut settings = Settings::prototype();
    let axes = [&mut settings.shapers.x, &mut settings.shapers.y];
    for (axis, shaper) in axes.into_iter().enumerate() {
        *shaper = Shaper::new(kinds[axis], Hertz::from_num([57, 41][axis]), Ratio::from_num(0.08));
        (shaper.span, shaper.motor_frequency) = (Mm::from_num(spans[axis]), Hertz::from_num(spans[axis] / 4));
    }
    settings.advance.time = Seconds::from_num(0.045);
    settings
}

/// A CoreXY with pulleys of different sizes.
const UNEQUAL: [[i8; 4]; 7] = [[0; 4], [0; 4], [5, -5, 0, 0], [4, 4, 0, 0], [0, 0, 1, 0], [0; 4], [0, 0, 0, 1]];

#[test]
fn corners_and_speeds() {
    let settings = Settings::prototype();
    check("corners", &generate(&plan(&corners(), &settings)), (5_868, 6_850_298, 0x80F4_C29D));
    check("circle", &generate(&plan(&circle(), &settings)), (5_230, 4_730_621, 0x109B_6F0F));
    let mut slow = settings;
    (slow.print_acceleration, slow.travel_acceleration) = (MmPerSec2::from_num(1), MmPerSec2::from_num(1.5));
    check("long", &generate(&plan(&long(), &slow)), (125_841, 2_197_271_190, 0x8AD7_7C7D));
    check("axes", &generate(&plan(&axes(), &settings)), (4_120, 5_758_940, 0xDC2E_7B94));
}

#[test]
fn wild_moves() {
    let settings = Settings::prototype();
    check("wild", &generate(&plan(&wild(0x5EED_0001, 120), &settings)), (12_416, 226_820_609, 0x64C1_F4D8));
    let mut elsewhere = Settings { mechanism: Mechanism { rows: UNEQUAL }, ..settings };
    elsewhere.travel_acceleration /= 8;
    check(
        "unequal",
        &generate_on(&plan(&wild(0x5EED_0002, 60), &elsewhere), &elsewhere),
        (18_903, 70_715_099, 0x9554_13B9),
    );
}

#[test]
fn shapers_and_pressure_advance() {
    for (kinds, spans, expected) in [
        ([ShaperKind::Zv, ShaperKind::Mzv], [0, 0], (16_514, 17_530_783, 0xDD85_C785)),
        ([ShaperKind::Ei, ShaperKind::TwoHumpEi], [835, 862], (16_543, 17_530_783, 0xDAE7_AF57)),
    ] {
        let settings = shaped(kinds, spans);
        let path: Path = [corners(), circle(), axes()].concat();
        check(&format!("{kinds:?}"), &generate_shaped(&plan(&path, &settings), &settings), expected);
    }
}

#[test]
fn a_console_that_does_all_that_it_may() {
    for (seed, expected) in [(0x5EED_0003, (71_165, 0x1B94_A086)), (0x5EED_0004, (72_667, 0x42F4_DFC4))] {
        let (count, all) = console::run(seed);
        assert_eq!((count, all), expected, "{seed}: what is seen is another: ({count}, {all:#010X})");
    }
}

#[test]
fn a_planner_that_does_all_that_it_may() {
    let settings = Settings::prototype();
    for (seed, expected) in
        [(0x5EED_0005, (199, 0xE309_9380)), (0x5EED_0006, (199, 0x5696_FC3C)), (0x5EED_0007, (199, 0xAC67_031B))]
    {
        let (count, all) = planner::planned(seed, seed == 0x5EED_0005, &settings);
        assert_eq!((count, all), expected, "{seed}: what is planned is another: ({count}, {all:#010X})");
    }
}
