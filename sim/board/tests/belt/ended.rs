//! M915 that is ended by M410, and on a machine of two belts.

use crate::belt::printer::{Events, Lines, Printed, plant_of, print_as};
use corehbot::motors::prototype;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_machine_file as machine_file;
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::tmc2209::gconf;
use corehbot_sim::world::{Desk, Host, run_at};
use corehbot_twin::params::Params;

const START: [f64; 3] = [60.0, 40.0, 10.0];

/// Sends lines in their turn, and M410 at an instant.
struct Stopping {
    lines: Lines,
    at: u64,
    now: u64,
    has_stopped: bool,
}

impl Host for Stopping {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.lines.send(out);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.now >= self.at && !self.has_stopped {
            self.has_stopped = true;
            out.extend(b"M410\n");
        }
    }

    fn clock(&mut self, tick: u64) {
        self.now = tick;
    }

    fn hear(&mut self, line: &str) {
        self.lines.hear(line);
    }

    fn is_done(&self) -> bool {
        self.has_stopped && self.lines.is_done()
    }
}

/// Sends these lines to a machine on the plant, and M410 at an instant in ticks.
fn stopped<const N: usize>(settings: &Settings, lines: [&str; N], at: u64) -> (Printed, Box<BeltPlant>) {
    let mut host = Stopping { lines: Lines::new(lines), at, now: 0, has_stopped: false };
    let mut desk = Desk::new(1);
    desk.belt = plant_of(Params::default(), START, 9, Accidents::default());
    let (drivers, mut events, start) = (Drivers::new(), Events::default(), Some(START.map(Mm::from_num)));
    let outcome = run_at(&mut desk, settings, start, NoStorage, &drivers, &mut [&mut host], &mut events).unwrap();
    (Printed { events: events.0, outcome, heard: host.lines.heard, drivers }, desk.belt.unwrap())
}

/// Checks the configuration in the drivers, not the settings.
fn assert_in_spread_cycle(drivers: &Drivers) {
    for motor in [prototype::M1, prototype::M4, prototype::M8, prototype::M11] {
        let gconf = drivers.chip(motor).register(gconf::ADDRESS);
        assert!(gconf & gconf::EN_SPREADCYCLE != 0, "{motor:?} {gconf:#x}");
    }
}

/// M410 may come at any time, in strokes, trims and waits. Drivers are as before, the firmware does not count motors as
/// aligned, and after homing the tool goes where it is sent.
#[test]
fn m410_ends_it_at_any_moment_and_the_machine_goes_on() {
    let settings = Settings::prototype();
    for tenths in [5, 31, 60, 87, 103, 131, 170, 222, 300, 360, 395, 430] {
        let lines = ["M915", "M569", "M122", "G28 X Y", "G1 X100 Y120 F6000", "M400", "M114"];
        let at = tenths * u64::from(TICKS_PER_SECOND) / 10;
        let (printed, mut plant) = stopped(&settings, lines, at);
        let Printed { heard, outcome, drivers, .. } = printed;
        let has = |text: &str| heard.iter().any(|line| line.contains(text));
        assert!(!outcome.halted && !has("belt motors aligned"), "{tenths}: {heard:?}");
        assert!(has("X driver mode: spreadCycle") && has("Belt: motors not aligned"), "{tenths}: {heard:?}");
        assert!(has("X:100.00 Y:120.00"), "{tenths}: {heard:?}");
        assert_in_spread_cycle(&drivers);
        plant.ring_out();
        let [x, y] = plant.tool_mm();
        assert!((x - 100.0).hypot(y - 120.0) < 0.06, "{tenths}: {x} {y}");
        assert!(plant.figures().skips.is_empty(), "{tenths}");
    }
}

/// A diagnosis that is ended may leave a motor turned, so the firmware drops what it held true before. A diagnosis that
/// finds nothing leaves all as it was.
#[test]
fn m410_ends_a_diagnosis_and_nobody_believes_in_what_was_before() {
    let mut settings = Settings::prototype();
    settings.require_homing = true;
    for (at_s, is_ended) in [(64_u64, true), (68, true), (72, true), (300, false)] {
        let lines = ["M915", "M915 D", "M122", "G1 X100 Y120 F6000", "M400", "M114", "G4 S250"];
        let at = at_s * u64::from(TICKS_PER_SECOND);
        let (Printed { heard, drivers, .. }, _) = stopped(&settings, lines, at);
        let has = |text: &str| heard.iter().any(|line| line.contains(text));
        assert!(has("belt motors aligned"), "{at_s}: {heard:?}");
        assert_eq!(has("no motor has skipped"), !is_ended, "{at_s}: {heard:?}");
        assert_eq!(has("Belt: motors not aligned"), is_ended, "{at_s}: {heard:?}");
        assert_eq!(has("X:100.00 Y:120.00"), !is_ended, "{at_s}: {heard:?}");
        assert_in_spread_cycle(&drivers);
    }
}

/// Each belt of an AWD CoreXY has a residual of its own.
#[test]
fn motors_of_two_belts_are_aligned_one_belt_after_the_other() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/machines/awd-corexy.toml");
    let settings = machine_file::read(path.as_ref()).unwrap().settings;
    for seed in [2, 5] {
        let setup = BeltSetup { seed: Some(seed), ..BeltSetup::default() };
        let start = Some(START.map(Mm::from_num));
        let mut plant = Some(Box::new(BeltPlant::new(&settings, start, true, setup, 0).unwrap()));
        let printed = print_as(&settings, &mut plant, Some(START), &["M915", "G1 X100 Y120 F6000", "M400"]);
        let told = printed.heard.iter().filter(|line| line.contains("belt motors aligned")).count();
        assert_eq!(told, 2, "{:?}", printed.heard);
        let mut plant = plant.unwrap();
        plant.ring_out();
        let residual = plant.figures().residual_mm.unwrap();
        assert!(residual.abs() <= 0.2 / 16.0, "{residual} {:?}", printed.heard);
        let [x, y] = plant.tool_mm();
        assert!((x - 100.0).hypot(y - 120.0) < 0.04, "{x} {y}");
    }
}
