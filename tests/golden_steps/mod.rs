//! The recorded steps of some paths: the same on every computer and in every version, except for an intended change of
//! the law of motion. Then the test prints the new record. `tests/motion` checks by models that steps are right; this
//! test finds, within a second, that they differ. Two tests read everything that a Console and a planner see. So they
//! also change with the reports, with the content of a move, and with the amount made at a time.

mod console;
mod planner;

use crate::dice::Dice;
use crate::line::{Step, generate, generate_on, generate_shaped, plan};
use corehbot::kinematics::Mechanism;
use corehbot::motion::taps;
use corehbot::settings::{Advance, CornerRule, Settings, Shaper, ShaperKind, Shapers, sum};
use corehbot::units::{Hertz, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm};
use std::f64::consts::TAU;

/// A place in mm (x, y, z, filament), and the speed of the move to it in mm/s.
type Path = Vec<([f64; 4], f64)>;

/// The number of events, the tick of the last, and a sum of all.
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
        to(100.7, 100.3, 0.0, 1.0, 7.0),
        to(100.7, 100.3, 0.0, 90.3, 1.5),
        to(99.0, 40.0, 0.0, 91.0, 11.0),
        to(99.0, 40.0, 70.3, 91.0, 2.3),
        to(10.3, 40.0, 159.0, 91.0, 3.0),
        to(10.3, 290.2, 159.0, 93.0, 7.0),
        // Two coordinates by the same.
        to(10.5, 30.0, 159.0, 93.0, 70.0),
        to(210.5, 230.0, 159.0, 93.7, 9.0),
        to(210.5, 230.0, 100.0, 93.7, 4.0),
        to(210.5, 292.5, 162.5, 94.1, 3.0),
    ]
}

/// Filament alone, on and back, between moves with and without it, and a hop of z.
fn retracts() -> Path {
    vec![
        to(0.0, 0.0, 0.0, 3.0, 25.0),
        to(0.0, 0.0, 0.0, 3.7, 40.0),
        to(4.0, 0.0, 0.0, 3.9, 60.0),
        to(4.0, 0.0, 0.0, 3.0, 30.0),
        to(4.0, 0.0, 0.0, 2.0, 45.0),
        to(4.0, 0.0, 0.6, 2.0, 6.0),
        to(30.0, 20.0, 0.6, 2.0, 180.0),
        to(30.0, 20.0, 0.0, 2.0, 6.0),
        to(30.0, 20.0, 0.0, 3.9, 35.0),
        to(20.0, 20.0, 0.0, 4.3, 50.0),
        to(10.0, 20.0, 0.0, 5.2, 50.0),
        to(10.0, 20.0, 0.0, 5.2, 50.0),
        to(0.0, 20.0, 0.0, 5.1, 50.0),
    ]
}

/// Straight lines in pieces, and straight back; ends between two steps, and pieces of just a millimetre.
fn straight() -> Path {
    vec![
        to(1.0, 0.0, 0.0, 0.0, 90.0),
        to(3.0, 0.0, 0.0, 0.0, 90.0),
        to(3.031_25, 0.0, 0.0, 0.1, 30.0),
        to(7.031_25, 0.0, 0.0, 0.1, 150.0),
        to(7.031_25, 1.0, 0.0, 0.1, 150.0),
        to(2.031_25, 1.0, 0.0, 0.3, 70.0),
        to(8.0, 1.0, 0.0, 0.3, 200.0),
        to(8.0, 1.031_25, 0.0, 0.3, 200.0),
        to(8.0, 6.031_25, 0.0, 0.3, 200.0),
        to(8.75, 7.031_25, 0.0, 0.3, 120.0),
        to(9.5, 8.031_25, 0.0, 0.3, 220.0),
        to(10.25, 9.031_25, 0.0, 0.3, 60.0),
        to(9.5, 8.031_25, 0.0, 0.3, 60.0),
        to(9.5, 8.031_25, 1.031_25, 0.3, 6.0),
        to(9.0, 8.031_25, 1.031_25, 0.3, 100.0),
        to(8.0, 8.031_25, 0.5, 0.3, 9.0),
        // As many steps of z as of filament.
        to(8.0, 8.031_25, 1.5, 2.3, 5.0),
        to(8.0, 8.031_25, 1.1, 1.5, 4.0),
        to(8.2, 8.031_25, 0.7, 0.7, 4.0),
        // Diagonals.
        to(12.0, 12.0, 0.7, 0.7, 130.0),
        to(16.0, 16.0, 0.7, 0.9, 130.0),
        to(16.5, 16.0, 1.25, 0.9, 8.0),
        to(16.5, 16.5, 1.75, 0.9, 8.0),
        to(16.5, 15.7, 1.5, 0.9, 8.0),
        // A chord of just a millimetre, which turns by 5 degrees at both ends.
        to(26.5, 17.443_31, 1.5, 0.9, 290.0),
        to(46.423_894, 15.7, 1.5, 0.9, 290.0),
        to(47.423_894, 15.7, 1.5, 0.9, 290.0),
        to(67.347_788, 17.443_115, 1.5, 0.9, 290.0),
    ]
}

/// Bends in short chords with straight pieces after them, and bends there and back. Where the path is flat,
/// one of the pieces rises by less than counts as a turn.
fn bends() -> Path {
    let degrees = [
        0, 40, 0, 0, 0, 0, 40, 0, 8, 16, 24, 24, 24, 30, 36, 36, 36, 36, 44, 20, 60, 60, 25, 25, 60, 25, 0, 0, 0, 1, 2,
        3, 3, 3, 3, 90, 90, 90, 91, 90,
    ];
    let mut place = [0.0; 4];
    let mut path = Path::new();
    for (length, speed, slope) in [(2.0, 90.0, 0.0), (0.04, 90.0, 0.0), (0.02, 60.0, 0.4), (0.3, 200.0, 0.1)] {
        for (i, degrees) in degrees.into_iter().enumerate() {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let slope = if i == 16 { 3e-7 } else { slope * sin };
            let [x, y, z, e] = place;
            place = [x + length * cos, y + length * sin, z + slope * length, e + 0.03 * length];
            path.push((place, speed));
        }
    }
    path
}

/// A circle in chords so fine that a slow shaper has more of them behind it than are remembered.
fn fine_circle() -> Path {
    let at = |i: u32| {
        let (sin, cos) = (f64::from(i) / 800.0 * TAU).sin_cos();
        ([2.0 * cos, 2.0 * sin, 0.0, 0.002 * f64::from(i)], 110.0)
    };
    (0..=800).map(at).collect()
}

/// From end to end of the bed plane, as fast as it goes; in one move and in pieces.
fn far() -> Path {
    let mut path: Path = (0..=60).map(|i| to(5.0 * f64::from(i), 0.0, 0.0, 0.0, 300.0)).collect();
    path.extend([to(20.0, 200.0, 0.0, 0.0, 300.0), to(150.0, 10.0, 0.0, 4.0, 200.0), to(0.0, 0.0, 0.0, 4.0, 300.0)]);
    path
}

/// The prototype with shapers and pressure advance. The taps stand closer away from the middle if belts have these
/// lengths in mm.
fn shaped(kinds: [ShaperKind; 2], spans: [u16; 2]) -> Settings {
    let mut settings = Settings::prototype();
    let axes = [&mut settings.shapers.x, &mut settings.shapers.y];
    for (axis, shaper) in axes.into_iter().enumerate() {
        *shaper = Shaper::new(kinds[axis], Hertz::from_num([57, 41][axis]), Ratio::from_num(0.08));
        (shaper.span, shaper.motor_frequency) = (Mm::from_num(spans[axis]), Hertz::from_num(spans[axis] / 4));
    }
    // A window that is longer than any shaper.
    settings.advance = Advance { time: Seconds::from_num(0.045), window: Some(Seconds::from_num(0.04)) };
    settings
}

/// The prototype with these steps a mm of x and y, of z, and of filament.
fn of_resolution(steps_per_mm: [u16; 3]) -> Settings {
    let mut settings = Settings::prototype();
    let [xy, z, e] = steps_per_mm.map(StepsPerMm::from_num);
    let axes = &mut settings.axes;
    (axes.x.steps_per_mm, axes.y.steps_per_mm, axes.z.steps_per_mm, axes.e.steps_per_mm) = (xy, xy, z, e);
    settings
}

/// A machine on which one belt motor moves x and y, and the other one y alone.
const ONE_SHARED: Mechanism =
    Mechanism::of(&[[0; 4], [0; 4], [1, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0; 4], [0, 0, 0, 1]]);

/// The same of x and z.
const LIFTING: Mechanism =
    Mechanism::of(&[[0; 4], [0; 4], [1, 0, 1, 0], [0, 0, 1, 0], [0, 1, 0, 0], [0; 4], [0, 0, 0, 1]]);

/// A CoreXY with pulleys of different sizes.
const UNEQUAL: Mechanism =
    Mechanism::of(&[[0; 4], [0; 4], [5, -5, 0, 0], [4, 4, 0, 0], [0, 0, 1, 0], [0; 4], [0, 0, 0, 1]]);

#[test]
fn corners_and_speeds() {
    let settings = Settings::prototype();
    check("corners", &generate(&plan(&corners(), &settings)), (5_868, 6_850_298, 0x80F4_C29D));
    check("circle", &generate(&plan(&circle(), &settings)), (5_230, 4_730_621, 0x109B_6F0F));
    // Long moves have so many steps that these are coarse ones.
    let coarse = of_resolution([10, 50, 40]);
    let mut slow = coarse;
    (slow.print_acceleration, slow.travel_acceleration) = (MmPerSec2::from_num(1), MmPerSec2::from_num(1.5));
    check("long", &generate_on(&plan(&long(), &slow), &slow), (40_677, 4_548_260_785, 0xC9BD_121F));
    check("long and fast", &generate_on(&plan(&long(), &coarse), &coarse), (40_664, 3_803_253_347, 0xF5C5_3144));
    check("axes", &generate(&plan(&axes(), &settings)), (4_120, 5_758_940, 0xDC2E_7B94));
    check("retracts", &generate(&plan(&retracts(), &settings)), (11_162, 14_381_082, 0xA5AF_778A));
    check("bends", &generate(&plan(&bends(), &settings)), (13_602, 15_498_790, 0xCA68_F0E1));
    check("straight", &generate(&plan(&straight(), &settings)), (15_971, 19_195_845, 0x3B80_0C7E));
}

#[test]
fn wild_moves() {
    let settings = Settings::prototype();
    check("wild", &generate(&plan(&wild(0x5EED_0001, 120), &settings)), (12_416, 226_957_455, 0xF617_1099));
    let mut elsewhere = Settings { mechanism: UNEQUAL, ..settings };
    elsewhere.travel_acceleration = elsewhere.travel_acceleration / 8;
    check(
        "unequal",
        &generate_on(&plan(&wild(0x5EED_0002, 60), &elsewhere), &elsewhere),
        (18_904, 70_763_181, 0x3909_8BFC),
    );
}

#[test]
fn steps_so_dense_that_pulses_must_keep_their_distance() {
    let fine = of_resolution([1700, 800, 400]);
    let path: Path = [circle(), tiny()].concat();
    check("fine steps", &generate_on(&plan(&path, &fine), &fine), (119_343, 8_180_150, 0x570C_C0AF));
}

#[test]
fn shapers_of_every_kind() {
    let mut all = 0;
    for (x, y) in ShaperKind::all().zip(ShaperKind::all().skip(1).chain([ShaperKind::None])) {
        for (frequency, damping) in [(57.0, 0.0), (41.5, 0.1), (20.0, 0.3), (120.0, 0.5)] {
            let shaper =
                |kind, factor| Shaper::new(kind, Hertz::from_num(factor * frequency), Ratio::from_num(damping));
            let shapers = Shapers { x: shaper(x, 1.0), y: shaper(y, 0.8) };
            for window in [None, Some(Seconds::from_num(0.04)), Some(Seconds::from_num(0.3))] {
                all = sum(&(all, taps(&shapers, window)));
            }
        }
    }
    assert_eq!(all, 0x4FA5_574C, "the taps are others: {all:#010X}");
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
    let mut slow = shaped([ShaperKind::TwoHumpEi, ShaperKind::Zvd], [0, 840]);
    slow.shapers.x.frequency = Hertz::from_num(22);
    check("fine circle", &generate_shaped(&plan(&fine_circle(), &slow), &slow), (3_914, 16_512_973, 0xFF4A_E419));
    let elsewhere = Settings { mechanism: UNEQUAL, ..shaped([ShaperKind::Zv, ShaperKind::Zvd], [0; 2]) };
    check("unequal", &generate_shaped(&plan(&bends(), &elsewhere), &elsewhere), (62_200, 15_836_964, 0x11F6_656C));
    // So slow, and between belts so short, that taps may not come nearer to each other as fast as they would.
    let mut steep = shaped([ShaperKind::TwoHumpEi, ShaperKind::Mzv], [220, 300]);
    (steep.shapers.x.frequency, steep.shapers.x.motor_frequency) = (Hertz::from_num(3), Hertz::ZERO);
    check("far", &generate_shaped(&plan(&far(), &steep), &steep), (115_374, 44_741_959, 0x7168_BA27));
}

#[test]
fn a_console_that_does_all_that_it_may() {
    for (seed, expected) in [(0x5EED_0003, (199_700, 0x93E8_7FE7)), (0x5EED_0004, (200_507, 0x2E59_66D0))] {
        let (count, all) = console::run(seed);
        assert_eq!((count, all), expected, "{seed}: what is seen is another: ({count}, {all:#010X})");
    }
}

#[test]
fn a_planner_that_does_all_that_it_may() {
    let prototype = Settings::prototype();
    let mut square = shaped([ShaperKind::None; 2], [0; 2]);
    square.corner = CornerRule::SquareCorner(MmPerSec::from_num(6));
    square.minimum_cruise_ratio = Ratio::from_num(0.5);
    (square.min_feed, square.min_travel) = (MmPerSec::from_num(15), MmPerSec::from_num(30));
    let mut weak = Settings { mechanism: ONE_SHARED, ..prototype };
    (weak.motor_max_speed, weak.motor_max_acceleration) = (MmPerSec::from_num(200), MmPerSec2::from_num(900));
    weak.corner = CornerRule::JunctionDeviation(Mm::from_num(0.05));
    let mut lifting = Settings { mechanism: LIFTING, ..prototype };
    lifting.axes.z = lifting.axes.x;
    lifting.motor_max_acceleration = MmPerSec2::from_num(1200);
    for (seed, settings, expected) in [
        (0x5EED_0005, &prototype, (399, 0x223B_330C)),
        (0x5EED_0006, &prototype, (273, 0x8BFB_DEE8)),
        (0x5EED_0007, &prototype, (346, 0x4C8D_DA48)),
        (0x5EED_0008, &square, (372, 0x5DFC_3589)),
        (0x5EED_000B, &lifting, (363, 0x404B_37F7)),
        (0x5EED_0009, &weak, (341, 0x0474_7FE9)),
    ] {
        let (count, all) = planner::planned(seed, seed == 0x5EED_0005, settings);
        assert_eq!((count, all), expected, "{seed}: what is planned is another: ({count}, {all:#010X})");
    }
}
