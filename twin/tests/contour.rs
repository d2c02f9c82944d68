//! Corners and errors of a line that is made of steps: none is lost, and a line beside it is not taken for it.

use corehbot_twin::contour::error::{ContourError, Window};
use corehbot_twin::contour::pace::Places;
use corehbot_twin::contour::path::PathBuilder;
use corehbot_twin::dynamics::plant::Detail;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::Run;
use corehbot_twin::run::report::Report;
use corehbot_twin::run::watch::Watch;
use corehbot_twin::steps::{Begins, Column, Planned, StepTrace, TICKS_PER_SECOND};

const STEP_MM: f64 = 0.0125;
const CENTRE: Place = Place::flat(235.0, 235.0);

/// Columns of a CoreH-bot.
const ROWS: [[i8; 2]; 4] = [[-1, 1], [-1, -1], [1, -1], [1, 1]];

/// Places of a line in steps of motors: where it goes through, from (0, 0) on, and when a place so far along it is
/// passed.
struct Steps<'a> {
    through: &'a [[f64; 2]],
    /// Speed in mm/s so far along a line of this length.
    speed: &'a dyn Fn(f64, f64) -> f64,
}

impl Steps<'_> {
    /// Each instant: its tick, the motors' steps, and which are forward.
    fn each(&self, mut instant: impl FnMut(u64, u8, u8)) {
        const FINE_MM: f64 = 0.002;
        let mut counts = [0_i64; 4];
        let (mut from, mut seconds) = ([0.0, 0.0], 0.0);
        for to in self.through {
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let looks = (length / FINE_MM).ceil() as u32;
            for look in 1..=looks {
                let way = length * f64::from(look) / f64::from(looks);
                seconds += length / f64::from(looks) / (self.speed)(way, length);
                let at = [0, 1].map(|i| (from[i] + (to[i] - from[i]) * way / length) / STEP_MM);
                let (mut steps, mut forward) = (0, 0);
                for (motor, (count, row)) in counts.iter_mut().zip(ROWS).enumerate() {
                    let away = f64::from(row[0]) * at[0] + f64::from(row[1]) * at[1] - *count as f64;
                    if away.abs() > 0.5 {
                        *count += away.signum() as i64;
                        steps |= 1 << motor;
                        forward |= u8::from(away > 0.0) << motor;
                    }
                }
                if steps != 0 {
                    instant((seconds * TICKS_PER_SECOND) as u64, steps, forward);
                }
            }
            from = *to;
        }
    }

    fn trace(&self) -> StepTrace {
        let columns = ROWS.map(|[x, y]| Column { name: String::new(), row: [x, y, 0], axis_step: 1.0 }).to_vec();
        let mut trace = StepTrace::new(columns, STEP_MM);
        self.each(|tick, steps, forward| trace.add(tick, steps, forward));
        trace
    }

    /// The line as the twin sees it.
    fn contour(&self) -> ContourError {
        let mut path = PathBuilder::new([0.0, 0.0], STEP_MM);
        let mut places = Places::default();
        let mut counts = [0_i64; 4];
        self.each(|tick, steps, forward| {
            for (motor, count) in counts.iter_mut().enumerate() {
                *count += i64::from(steps >> motor & 1) * (2 * i64::from(forward >> motor & 1) - 1);
            }
            let along = |i: usize| counts.iter().zip(ROWS).map(|(n, row)| *n as f64 * f64::from(row[i])).sum::<f64>();
            let at = [0, 1].map(|i| along(i) * STEP_MM / 4.0);
            path.add(at, tick);
            places.add(at, tick);
        });
        ContourError::new(path.finish(), &places.finish(), Window::of_hz(60.0))
    }
}

/// Numbers from 0 up to 1 (xorshift of 64 bits by Marsaglia, 2003).
fn random(seed: &mut u64) -> f64 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}

fn played(steps: &Steps, meant: Option<&StepTrace>) -> Watch {
    let trace = steps.trace();
    let detail = Detail { idlers: false, rotors: true };
    let run = Run::new(Machine::CoreHBot, &Params::default(), CENTRE, detail, &trace).unwrap();
    let run = if let Some(meant) = meant { run.against(meant).unwrap() } else { run };
    run.play(|_| true).unwrap()
}

/// Sides of 2048 steps: the blocks of the search ended next to each corner, and hid it.
#[test]
fn a_square_of_25_6_mm_has_four_corners() {
    let side = 25.6;
    let through = [[side, 0.0], [side, side], [0.0, side], [0.0, 0.0], [side, 0.0]];
    let watch = played(&Steps { through: &through, speed: &|_, _| 100.0 }, None);
    let report = Report::new(Machine::CoreHBot, "rotors", &Params::default(), &watch, (1.0, 1), 1.0);
    assert_eq!((report.corners_total, report.corners_unmatched), (4, 0), "{report}");
    for [x, y] in &through[..4] {
        let is_it = |c: &&corehbot_twin::run::report::CornerFigures| {
            (c.x_mm - CENTRE.x - x).abs() < 1e-9 && (c.y_mm - CENTRE.y - y).abs() < 1e-9
        };
        let corner = report.corners.iter().find(is_it).unwrap();
        assert!((corner.turn_deg - 90.0).abs() < 1e-9 && corner.rounding_mm > 0.0, "{corner:?}");
        assert!(corner.bisector_mm.is_some_and(|mm| mm.abs() < 0.3), "{corner:?}");
    }
}

/// Of 30 random lines, each of the 900 corners is found once where it is, and there are no others.
#[test]
fn random_lines_lose_no_corner() {
    let seed = &mut 0x25_6000;
    for line in 0..30 {
        let (mut at, mut heading) = ([0.0, 0.0], 0.0_f64);
        let mut through = Vec::new();
        let mut turns = Vec::new();
        for _ in 0..31 {
            let length = 0.3 * 100.0_f64.powf(random(seed));
            at = [at[0] + length * heading.cos(), at[1] + length * heading.sin()];
            through.push(at);
            // From 30 to 170 degrees, to either side.
            let turn = (30.0 + 140.0 * random(seed)).to_radians();
            turns.push(if random(seed) < 0.5 { turn } else { -turn });
            heading += turns.last().unwrap();
        }
        let found = Steps { through: &through, speed: &|_, _| 100.0 }.contour();
        assert_eq!((found.corners.len(), found.without_lines), (30, 0), "line {line}");
        for ((corner, at), turn) in found.corners.iter().zip(&through).zip(&turns) {
            let off = (corner.at[0] - at[0]).hypot(corner.at[1] - at[1]);
            // A line is within a step of its places, and these within half a step of what was meant. So a corner may be
            // off by 1.5 steps of both of its lines, and the shortest line turned by 3 steps.
            let most = 1.5 * STEP_MM / (turn.abs() / 2.0).sin();
            let is_right = off < most && (corner.turn_rad - turn).abs() < 3.0 * STEP_MM / 0.3 * 2.0;
            assert!(is_right, "line {line}: {corner:?} {at:?} {turn}");
        }
    }
}

/// Stairs of 0.05 mm have no lines of their own: told, not lost. A zigzag whose lines lie that close turns right back
/// at each end.
#[test]
fn corners_between_lines_as_short_as_steps_are_counted() {
    let stairs: Vec<[f64; 2]> =
        (0..40).map(|i| [0.05 * f64::from((i + 2) / 2), 0.05 * f64::from((i + 1) / 2)]).collect();
    let found = Steps { through: &stairs, speed: &|_, _| 20.0 }.contour();
    assert!(found.corners.is_empty() && found.without_lines >= 36, "{} {}", found.corners.len(), found.without_lines);
    let found = Steps { through: &serpentine(10, 2.0, 0.05), speed: &|_, _| 20.0 }.contour();
    assert_eq!((found.corners.len(), found.without_lines), (9, 0));
    assert!(found.corners.iter().all(|corner| (corner.turn_rad.abs() - std::f64::consts::PI).abs() < 0.1));
    // To the left at one end and to the right at the other.
    assert!(found.corners.windows(2).all(|pair| pair[0].turn_rad * pair[1].turn_rad < 0.0));
}

/// Lines of a length next to each other, and ways from one to the next.
fn serpentine(lines: usize, length: f64, pitch: f64) -> Vec<[f64; 2]> {
    let line = |i: usize| {
        let (end, y) = (if i.is_multiple_of(2) { length } else { 0.0 }, pitch * i as f64);
        [[end, y], [end, y + pitch]]
    };
    (0..lines).flat_map(line).take(2 * lines - 1).collect()
}

/// Speed of a line that speeds up and slows down by `a`.
fn ramps(a: f64) -> impl Fn(f64, f64) -> f64 {
    move |way, length| (2.0 * a * (way.min(length - way)).max(0.001)).sqrt().min(150.0)
}

/// Lines of 2 mm, 0.05 to 0.4 mm apart, at several accelerations. They are played against the same line, and against
/// one that takes three times as long. The error is the tool's distance from the line at the same time, not half of the
/// distance between lines.
#[test]
fn a_dense_zigzag_is_matched_by_time() {
    for pitch in [0.05, 0.1, 0.4] {
        let through = serpentine(30, 2.0, pitch);
        let slow = Steps { through: &through, speed: &ramps(700.0) }.trace();
        let mut before = 0.0;
        for a in [200.0, 1000.0, 7000.0] {
            let speed = ramps(a);
            let steps = Steps { through: &through, speed: &speed };
            let own = played(&steps, None).contour;
            for meant in [&steps.trace(), &slow] {
                let against = played(&steps, Some(meant)).contour;
                let [own, against] = [&own, &against].map(|c| (1000.0 * c.rms_mm(), 1000.0 * c.greatest_mm));
                assert!((against.0 - own.0).abs() < 0.1 * own.0 + 0.5, "pitch {pitch}, {a} mm/s2: {own:?} {against:?}");
            }
            // The error grows with the acceleration.
            assert!(own.rms_mm() > before, "pitch {pitch}, {a} mm/s2");
            before = own.rms_mm();
        }
    }
}

/// A circle of chords on a machine that gives way by next to nothing. The tool is off the planned line by its steps
/// alone, and the line has no share of its own. A line through the steps is off by up to a step.
#[test]
fn a_planned_line_has_no_steps_in_it() {
    let place = |i: u32| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 90.0 + 0.3).sin_cos();
        [8.0 * cos - 8.0 * 0.3_f64.cos(), 8.0 * sin - 8.0 * 0.3_f64.sin()]
    };
    let through: Vec<[f64; 2]> = (1..=90).map(place).collect();
    let speed = 30.0;
    let steps = Steps { through: &through, speed: &|_, _| speed };
    let mut trace = steps.trace();
    let stiff = Params { belt_ea_n: Params::default().belt_ea_n.times(400.0), ..Params::default() };
    let play = |trace: &StepTrace| {
        let detail = Detail { idlers: false, rotors: false };
        Run::new(Machine::CoreHBot, &stiff, CENTRE, detail, trace).unwrap().play(|_| true).unwrap()
    };
    let cut = play(&trace);
    let (mut from, mut way) = ([0.0, 0.0], 0.0);
    for to in &through {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let tick = |way: f64| (way / speed * TICKS_PER_SECOND) as u64;
        let ticks = [tick(way), tick(way + length)];
        let way_mm = [to[0] - from[0], to[1] - from[1]];
        trace.plan.push(Planned { ticks, way_mm, begins: Begins::AtTheEnd, is_touch: false, line_type: 0 });
        (from, way) = (*to, way + length);
    }
    let planned = play(&trace);
    assert_eq!((planned.line_share_mm, cut.line_share_mm), (0.0, STEP_MM));
    // Each motor is within half a step of its own place, so the tool is within half a step of its own.
    let (tool, commanded) = (1000.0 * planned.contour.greatest_mm, 1000.0 * planned.commanded.greatest_mm);
    assert!(commanded < 500.0 * STEP_MM + 0.1, "{commanded}");
    assert!(tool < commanded + 1.0 && tool > 0.3 * commanded, "{tool} {commanded}");
    assert!(cut.contour.greatest_mm > 1.5 * planned.contour.greatest_mm, "{} {tool}", cut.contour.greatest_mm);
    for (vertex, at) in planned.contour.vertices.iter().zip(std::iter::once([0.0; 2]).chain(through)) {
        let off = [CENTRE.x + at[0] - vertex.at[0], CENTRE.y + at[1] - vertex.at[1]];
        assert!(off[0].hypot(off[1]) < 1e-9, "{vertex:?} {at:?}");
    }
}
