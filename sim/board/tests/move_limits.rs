//! What keeps a move from being faster: each limit by a program in which it rules, against arithmetic of its own.

use corehbot::motion::LOOKAHEAD_MOVES;
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::surface::{Heights, Mesh, UNITS_PER_MM};
use corehbot::units::{Mm, Seconds, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::host::FileHost;
use corehbot_sim::moves::{Limit, MadeMove};
use corehbot_sim::slicer;
use corehbot_sim::world::{Desk, Host, Sink, run_at};
use std::fmt::Write as _;

/// Keeps the moves.
#[derive(Default)]
struct Kept(Vec<MadeMove>);

impl Sink for Kept {
    fn event(&mut self, _: u64, _: MotorSet, _: MotorSet) {}

    fn wants_moves(&self) -> bool {
        true
    }

    fn moved(&mut self, made: &MadeMove) {
        self.0.push(*made);
    }
}

/// A host that takes its time between two lines.
struct Slow {
    host: FileHost,
    gap: u64,
    now: u64,
    due: u64,
}

impl Host for Slow {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.now >= self.due {
            self.host.send(out);
            self.due = self.now + self.gap;
        }
    }

    fn clock(&mut self, tick: u64) {
        self.now = tick;
        self.host.clock(tick);
    }

    fn sent(&self) -> Option<(u32, u16, &str)> {
        self.host.sent()
    }

    fn hear(&mut self, line: &str) {
        self.host.hear(line);
    }

    fn is_done(&self) -> bool {
        self.host.is_done()
    }
}

/// The moves of a program, sent with a gap of so many ms.
fn sent(settings: &Settings, mesh: Option<Mesh>, gcode: &str, gap_ms: u64) -> Vec<MadeMove> {
    let (mut kept, mut desk) = (Kept::default(), Desk::new(1));
    desk.mesh = mesh;
    let gap = gap_ms * u64::from(TICKS_PER_MS);
    let mut host = Slow { host: FileHost::new(gcode), gap, now: 0, due: 0 };
    let start = Some([100, 100, 50].map(Mm::from_num));
    run_at(&mut desk, settings, start, NoStorage, &Drivers::new(), &mut [&mut host], &mut kept).unwrap();
    assert_eq!(host.host.failure(), None);
    kept.0
}

fn moves(gcode: &str) -> Vec<MadeMove> {
    sent(&Settings::prototype(), None, gcode, 0)
}

#[track_caller]
fn assert_near(found: f64, expected: f64, part: f64) {
    assert!((found / expected - 1.0).abs() <= part, "{found} instead of {expected}");
}

/// The only move of a program, its limit and its top speed.
#[track_caller]
fn assert_rules(gcode: &str, limit: Limit, top: f64) {
    let moves = moves(gcode);
    assert_eq!(moves.len(), 1, "{moves:?}");
    let made = moves.first().unwrap();
    assert_eq!(made.limit, limit, "{made:?}");
    assert_near(made.speeds[1], top, 2e-3);
}

#[test]
fn the_commanded_speed() {
    assert_rules("G1 X150 F3000", Limit::Feed, 50.0);
    assert_rules("M220 S50\nG1 X150 F6000", Limit::Feed, 50.0);
}

#[test]
fn an_axis_by_its_speed_and_by_its_acceleration() {
    assert_rules("G1 X250 F60000", Limit::Axis, 300.0);
    assert_rules("M203 X120\nG1 X250 F60000", Limit::Axis, 120.0);
    // Z bears 200 mm/s2: over 0.3 mm it comes to sqrt(200 * 0.3) mm/s.
    assert_rules("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0\nG1 Z50.3 F1200", Limit::Axis, 60f64.sqrt());
}

#[test]
fn a_motor_on_a_diagonal() {
    // One belt motor goes sqrt 2 times as far as the tool, and may run at 450 mm/s.
    assert_rules("G1 X250 Y250 F60000", Limit::Motor, 450.0 / 2f64.sqrt());
}

#[test]
fn the_extruder() {
    // 10 mm of filament over 10 mm, at 80 mm/s at most.
    assert_rules("M83\nSET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0\nG1 X110 E10 F9000", Limit::Extruder, 80.0);
}

/// Steps of a stair, 2 mm each.
fn stair(ratio: f64) -> Vec<MadeMove> {
    let mut gcode = format!("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO={ratio}\nG91\nF12000\n");
    for _ in 0..20 {
        gcode += "G1 X2 F12000\nG1 Y2\n";
    }
    moves(&gcode)[5..35].to_vec()
}

/// Speed in the corners of the stair: an arc that leaves a corner of 90 degrees by 0.013 mm, at 5000 mm/s2.
fn corner_speed() -> f64 {
    let s = 0.5f64.sqrt();
    (5000.0 * 0.013 * s / (1.0 - s)).sqrt()
}

#[test]
fn a_corner() {
    for made in stair(0.0) {
        assert_eq!(made.limit, Limit::Corner, "{made:?}");
        assert_near(made.speeds[0], corner_speed(), 5e-3);
        assert_near(made.speeds[1], (corner_speed().powi(2) + 5000.0 * 2.0).sqrt(), 5e-3);
    }
}

#[test]
fn the_cruise_ratio() {
    for made in stair(0.5) {
        assert_eq!(made.limit, Limit::CruiseRatio, "{made:?}");
        assert_near(made.speeds[1], (corner_speed().powi(2) + 5000.0 * 0.5 * 2.0).sqrt(), 5e-3);
    }
}

#[test]
fn the_look_ahead() {
    // Moves of 0.05 mm by turns of two speeds, so that they are not joined: 144 of them are 7.2 mm.
    let mut gcode = "M204 T200\nSET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0\nG91\n".to_owned();
    for i in 0..2000 {
        writeln!(gcode, "G1 X0.05 F{}", 12_000 + i % 2).unwrap();
    }
    let moves = moves(&gcode);
    let top = moves.iter().map(|made| made.speeds[1]).fold(0.0, f64::max);
    // It must be able to stop within the look-ahead at any time.
    let most = (2.0 * 200.0 * 0.05 * LOOKAHEAD_MOVES as f64).sqrt();
    assert!((0.9 * most..=most).contains(&top), "{top} {most}");
    let of = |limit| moves.iter().filter(|made| made.limit == limit).count();
    assert!(of(Limit::LookAhead) > 1500, "{} {}", of(Limit::LookAhead), of(Limit::Corner));
    assert_eq!(of(Limit::Feed) + of(Limit::Axis) + of(Limit::SlowHost), 0);
}

#[test]
fn the_firmware_s_own_speed() {
    let homed = moves("G28\nG1 X50 F3000");
    let (last, own) = homed.split_last().unwrap();
    assert!(own.len() >= 6, "{own:?}");
    assert!(own.iter().any(|made| made.limit == Limit::Firmware), "{own:?}");
    assert!(own.iter().all(|made| made.limit != Limit::Feed), "no line commands their speed: {own:?}");
    assert_eq!(last.limit, Limit::Feed);
}

#[test]
fn moves_that_lay_nothing_say_why() {
    let moves = moves("M83\nG1 E-1 F600\nG1 X120 E-1 F3000\nG1 X150\nG1 E2 F600");
    let kinds: Vec<_> = moves.iter().map(|made| made.source.kind).collect();
    assert_eq!(kinds, [slicer::RETRACT, slicer::WIPE, slicer::TRAVEL, slicer::PRIME]);
}

#[test]
fn the_mesh() {
    let filled = Heights::filled(5, 5, |column, _| Some(if column % 2 == 0 { 0 } else { UNITS_PER_MM as i16 / 4 }));
    let corners = [[90, 90], [190, 190]].map(|corner| corner.map(Mm::from_num));
    let mesh = Mesh::new(filled.unwrap(), corners[0], corners[1], Mm::ZERO).unwrap();
    let gcode = "G1 X180 Y101 F15000";
    let flat = moves(gcode);
    let on_mesh = sent(&Settings::prototype(), Some(mesh), gcode, 0);
    let made = on_mesh.last().unwrap();
    assert_eq!(made.limit, Limit::Mesh, "{made:?}");
    assert!(made.speeds[1] < 0.9 * flat[0].speeds[1], "{made:?}");
    assert_eq!(flat[0].limit, Limit::Feed);
    assert_near(flat[0].speeds[1], 250.0, 2e-3);
}

#[test]
fn a_slow_host() {
    let mut gcode = "G91\n".to_owned();
    for _ in 0..200 {
        gcode += "G1 X1 F6000\n";
    }
    // 25 moves of a millimetre a second, instead of 100.
    let slow = sent(&Settings::prototype(), None, &gcode, 40);
    let of = |moves: &[MadeMove], limit| moves.iter().filter(|made| made.limit == limit).count();
    assert!(of(&slow, Limit::SlowHost) > 150, "{} of {}", of(&slow, Limit::SlowHost), slow.len());
    let fast = sent(&Settings::prototype(), None, &gcode, 0);
    assert_eq!((of(&fast, Limit::SlowHost), fast.len()), (0, 200));
    assert!(of(&fast, Limit::Feed) > 190);
}

#[test]
fn pressure_advance_takes_from_the_extruder() {
    let mut s = Settings::prototype();
    s.advance.time = Seconds::from_num(0.08);
    let lines = "M83\nSET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0\nG1 X140 E20 F9000\n";
    let with = sent(&s, None, lines, 0);
    assert_eq!(with[0].limit, Limit::Extruder, "{:?}", with[0]);
    let without = moves(lines);
    assert_eq!(without[0].limit, Limit::Feed);
    assert!(with[0].speeds[1] < without[0].speeds[1]);
}

#[test]
fn moves_end_where_the_file_leads_whatever_they_are_made_of() {
    let gcode = "G91\nG1 X5 F6000\nG90\nG92 X0 Y0\nG1 X10 Y10\nG2 X20 Y10 I5 J0\nM221 S50\nM83\nG1 X10 E2\nG4 P5\nG20\n\
                 G1 X1 F100\n";
    let moves = moves(gcode);
    let end = moves.last().unwrap();
    let at = [0, 1, 2].map(|i| end.from[i] + end.way[i]);
    // G92 at 105, 100; then 25.4 along x, and y of 10.
    for (at, to) in at.into_iter().zip([130.4, 110.0, 50.0]) {
        assert!((at - to).abs() < 0.01, "{at} {to}");
    }
    let e: f64 = moves.iter().map(|made| made.way[3]).sum();
    assert!((e - 1.0).abs() < 0.003, "{e}");
    let joined = moves.windows(2).all(|pair| {
        let [a, b] = pair else { return true };
        a.end() <= b.begin && (0..3).all(|i| (a.from[i] + a.way[i] - b.from[i]).abs() < 1e-6)
    });
    assert!(joined && moves.iter().skip(1).all(|made| !made.is_apart), "{moves:?}");
    let lines: Vec<_> = moves.iter().map(|made| made.source.line).collect();
    assert!(lines.is_sorted() && [2, 5, 6, 9, 12].iter().all(|line| lines.contains(line)), "{lines:?}");
}
