//! A motor of the belt fails in mid-print, and the others take the nozzle off the print.

use crate::belt::printer::Lines;
use corehbot::connectors::Heater;
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_machine_file as machine_file;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::tmc2209::{self, Tmc2209};
use corehbot_sim::world::{Desk, HeatPeriod, Host, Outcome, Sink, run_at};
use std::cell::{Cell, RefCell};

const START: [f64; 3] = [195.0, 208.8, 10.0];

/// A fault of a driver.
type Harm = fn(&mut Tmc2209);

/// Its motor supply goes: no torque, no answers, at once.
const NO_SUPPLY: Harm = Tmc2209::power_off;
/// It was reset: other microsteps, and its field elsewhere.
const RESET: Harm = Tmc2209::reset;
/// A coil is shorted: it has switched itself off.
const SHORT: Harm = |chip| chip.set(tmc2209::DRV_STATUS, 1 << 2);
/// Its UART is dead; it drives on until it is switched off.
const DEAF: Harm = |chip| chip.is_silent = true;
/// Its charge pump fails: no torque.
const NO_PUMP: Harm = |chip| chip.set(tmc2209::GSTAT, 4);

/// An event this many ms after motion begins, or after the previous event.
#[derive(Clone, Copy)]
enum Event {
    Harm(Motor, Harm),
    All(Harm),
    Say(&'static str),
}

/// The input of a story, its accidents, and its result. Times are in ms.
struct Story {
    outcome: Outcome,
    heard: Vec<String>,
    /// When each event came.
    events: Vec<f64>,
    /// The motors with power, and from when on.
    switched: Vec<(f64, MotorSet)>,
    /// Motion time in s when the first motor lost its power after the first event.
    off_motion_s: f64,
    /// When the heaters had their last duty.
    last_duty: f64,
    /// By how much z was raised after the last layer, in mm.
    raised_mm: f64,
    plant: Box<BeltPlant>,
}

impl Story {
    fn has(&self, part: &str) -> bool {
        self.heard.iter().any(|line| line.contains(part))
    }

    /// Ms from an event to when this motor had no power.
    fn off_after(&self, event: usize, motor: Motor) -> f64 {
        let at = self.events[event];
        self.switched
            .iter()
            .find(|(when, on)| *when >= at && !on.has(motor))
            .map_or(f64::INFINITY, |(when, _)| when - at)
    }

    /// Ms from an event to when no motor had power.
    fn cut_after(&self, event: usize) -> f64 {
        let at = self.events[event];
        self.switched
            .iter()
            .find(|(when, on)| *when >= at && on.is_empty())
            .map_or(f64::INFINITY, |(when, _)| when - at)
    }
}

/// Sends lines, fires events at their times, and records which motors have power.
struct Accident<'d> {
    lines: Lines,
    drivers: &'d Drivers,
    waiting: Vec<(f64, Event)>,
    /// When the next one counts from.
    since: Option<f64>,
    now: f64,
    seen: &'d Seen,
}

#[derive(Default)]
struct Seen {
    now: Cell<f64>,
    motion: Cell<Option<f64>>,
    motion_s: Cell<f64>,
    off_motion_s: Cell<Option<f64>>,
    events: RefCell<Vec<f64>>,
    switched: RefCell<Vec<(f64, MotorSet)>>,
    last_duty: Cell<f64>,
    z_steps: Cell<i32>,
}

impl Host for Accident<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.lines.send(out);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let since = self.since.or(self.seen.motion.get());
        let (Some(since), Some((wait, event))) = (since, self.waiting.first().copied()) else { return };
        if self.now < since + wait {
            return;
        }
        self.waiting.remove(0);
        self.since = Some(self.now);
        self.seen.events.borrow_mut().push(self.now);
        match event {
            Event::Harm(motor, harm) => harm(&mut self.drivers.chip(motor)),
            Event::All(harm) => Motor::ALL.into_iter().for_each(|motor| harm(&mut self.drivers.chip(motor))),
            Event::Say(line) => out.extend(line.bytes().chain([b'\n'])),
        }
    }

    fn clock(&mut self, tick: u64) {
        self.now = tick as f64 / f64::from(TICKS_PER_MS);
        self.seen.now.set(self.now);
        let on = self.drivers.enabled();
        let mut switched = self.seen.switched.borrow_mut();
        if switched.last().is_none_or(|(_, last)| *last != on) {
            if self.since.is_some() && self.seen.off_motion_s.get().is_none() {
                self.seen.off_motion_s.set(Some(self.seen.motion_s.get()));
            }
            switched.push((self.drivers.switched() as f64 / f64::from(TICKS_PER_MS), on));
        }
    }

    fn hear(&mut self, line: &str) {
        self.lines.hear(line);
    }

    fn is_done(&self) -> bool {
        self.lines.is_done()
    }
}

impl Sink for &Seen {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.motion_s.set(tick as f64 / f64::from(TICKS_PER_MS) / 1e3);
        if self.motion.get().is_none() {
            self.motion.set(Some(self.now.get()));
        }
        if steps.has(prototype::Z1) {
            self.z_steps.set(self.z_steps.get() + if forward.has(prototype::Z1) { 1 } else { -1 });
        }
    }

    fn heat(&mut self, period: &HeatPeriod) {
        if period.heaters.iter().flatten().any(|heater| heater.duty > 0) {
            self.last_duty.set(period.now as f64 / f64::from(TICKS_PER_MS));
        }
    }
}

/// Perimeters at 100 mm/s around the middle.
fn perimeters() -> Vec<String> {
    let mut lines = vec!["M204 P3000 T3000".to_owned()];
    for layer in 0..40 {
        let e = f64::from(layer) * 4.0;
        for (n, [x, y]) in [(1.0, [215.0, 190.0]), (2.0, [215.0, 230.0]), (3.0, [175.0, 230.0]), (4.0, [175.0, 190.0])]
        {
            lines.push(format!("G1 X{x} Y{y} E{} F6000", e + n));
        }
    }
    lines
}

/// Runs lines and events on a machine with these settings, with the tool at a known place or somewhere.
fn story_of(settings: &Settings, start: Option<[f64; 3]>, lines: &[String], events: &[(f64, Event)]) -> Story {
    let (drivers, seen) = (Drivers::new(), Seen::default());
    let mut host = Accident {
        lines: Lines::new(lines.iter().map(String::as_str)),
        drivers: &drivers,
        waiting: events.to_vec(),
        since: None,
        now: 0.0,
        seen: &seen,
    };
    let mut desk = Desk::new(1);
    let start = start.map(|start| start.map(Mm::from_num));
    let setup = BeltSetup { seed: Some(3), ..BeltSetup::default() };
    desk.belt = Some(Box::new(BeltPlant::new(settings, start, start.is_some(), setup, 0).unwrap()));
    let mut sink = &seen;
    let outcome = run_at(&mut desk, settings, start, NoStorage, &drivers, &mut [&mut host], &mut sink).unwrap();
    // The end is later than the last look.
    host.clock((seen.now.get() * f64::from(TICKS_PER_MS)) as u64);
    let mut plant = desk.belt.unwrap();
    plant.ring_out();
    Story {
        outcome,
        heard: host.lines.heard.into_iter().filter(|line| line != "ok" && !line.contains("busy")).collect(),
        events: seen.events.take(),
        switched: seen.switched.take(),
        off_motion_s: seen.off_motion_s.get().unwrap_or_default(),
        last_duty: seen.last_duty.get(),
        raised_mm: f64::from(seen.z_steps.get()) / settings.axes.z.steps_per_mm.to_num::<f64>(),
        plant,
    }
}

fn story(events: &[(f64, Event)]) -> Story {
    story_of(&Settings::prototype(), Some(START), &perimeters(), events)
}

/// A single failed motor: off within 100 ms, the tool parked by the others to `near` mm, nothing with power at the end.
/// Others may skip as long as `relaxing_ms` after it is off.
fn assert_parked(story: &Story, motor: Motor, words: &str, near: f64, relaxing_ms: f64) {
    let what = || format!("{motor:?} {words}: {:?} {:?} {}", story.heard, story.switched, story.plant.figures());
    let off = story.off_after(0, motor);
    assert!(off <= 100.0, "off after {off} ms: {}", what());
    assert!(story.outcome.halted && story.has(words) && story.has("Send M999"), "{}", what());
    // Its motor alone lost its power, then all.
    let others = prototype::ALL.without(MotorSet::of(motor));
    let last: Vec<MotorSet> = story.switched.iter().rev().take(2).map(|(_, on)| *on).collect();
    assert_eq!(last, [MotorSet::NONE, others], "{}", what());
    assert!(story.has("tool parked, z raised by 10 mm"), "{}", what());
    assert!((story.raised_mm - 10.0).abs() < 0.01, "raised by {} mm: {}", story.raised_mm, what());
    // The park place is 5 mm from the switches, which are at 0.
    let [x, y] = story.plant.tool_mm();
    let off_mm = (x - 5.0).hypot(y - 5.0);
    assert!(off_mm < near, "tool at {x:.3} {y:.3}: {}", what());
    // Once the failed motor is off, the others hold.
    let figures = story.plant.figures();
    let later: Vec<_> =
        figures.skips.iter().filter(|skip| skip.time_s > story.off_motion_s + relaxing_ms / 1e3).collect();
    assert!(later.iter().all(|skip| skip.motor == prototype::NAMES[motor.index()]), "{later:?} {}", what());
    let all = story.cut_after(0) / 1e3;
    println!(
        "{motor:?} {words}: off after {off:.0} ms, all off after {all:.1} s, tool {off_mm:.3} mm beside its place"
    );
}

const BELT: [Motor; 4] = [prototype::M1, prototype::M4, prototype::M8, prototype::M11];

#[test]
fn a_motor_that_fails_in_mid_print_is_off_within_100_ms_and_the_others_park_the_tool() {
    let cases: [(Harm, &str, f64); 4] = [
        (NO_SUPPLY, "does not answer", 500.0),
        (SHORT, "reports a short circuit", 1210.0),
        (DEAF, "does not answer", 903.0),
        (NO_PUMP, "reports a low supply voltage", 1501.0),
    ];
    for (number, (harm, words, at)) in cases.into_iter().enumerate() {
        for (place, motor) in BELT.into_iter().enumerate() {
            // Another moment for each, over all of the 64 ms between two looks.
            let at = at + f64::from(place as u32) * 21.0 + number as f64 * 3.0;
            assert_parked(&story(&[(at, Event::Harm(motor, harm))]), motor, words, 1.0, 0.0);
        }
    }
}

/// It goes twice as far as the others until it is off, so these skip in the meantime by an uncounted distance. At 100
/// mm/s the belt is pulled by 8 mm in 80 ms, and the tool takes half.
#[test]
fn a_driver_that_was_reset_pulls_the_tool_aside_until_it_is_off_and_not_afterwards() {
    for (place, motor) in BELT.into_iter().enumerate() {
        let at = 730.0 + f64::from(place as u32) * 21.0;
        assert_parked(
            &story(&[(at, Event::Harm(motor, RESET))]),
            motor,
            "was reset and lost its configuration",
            4.0,
            20.0,
        );
    }
}

#[test]
fn the_heaters_are_off_from_the_first_moment_on() {
    let mut settings = Settings::prototype();
    settings.thermal.heater_mut(Heater::Bed).is_fitted = true;
    // The self-test comes first.
    let heat = ["M140 S60", "G4 S60"].map(str::to_owned);
    let story = story_of(
        &settings,
        Some(START),
        &[&heat[..], &perimeters()].concat(),
        &[(700.0, Event::Harm(prototype::M8, NO_SUPPLY))],
    );
    assert_parked(&story, prototype::M8, "does not answer", 1.0, 0.0);
    let (noticed, last) = (story.events[0] + story.off_after(0, prototype::M8), story.last_duty);
    // A control period is 20 ms.
    assert!(last > story.events[0] - 100.0 && last <= noticed + 20.0, "{last} {noticed}");
}

/// As it was without a limp: all power is cut at once, z stays where it is, and the tool is not parked.
fn assert_cut(story: &Story, event: usize, within_ms: f64, what: &str) {
    let cut = story.cut_after(event);
    let told = || format!("{what}: {:?} {:?}", story.heard, story.switched);
    assert!(cut <= within_ms, "cut after {cut} ms, {}", told());
    assert!(story.outcome.halted && story.has("Send M999") && !story.has("tool parked"), "{}", told());
    println!("{what}: all off after {cut:.0} ms");
}

#[test]
fn a_dip_of_the_whole_supply_cuts_everything_at_once() {
    for (harm, what) in [(RESET, "all are reset"), (NO_SUPPLY, "all lose their supply")] {
        for at in [500.0, 531.0, 562.0] {
            let story = story(&[(at, Event::All(harm))]);
            assert_cut(&story, 0, 100.0, what);
            assert_eq!(story.raised_mm, 0.0);
        }
    }
}

#[test]
fn a_second_fault_ends_the_limp_by_cutting_everything() {
    for (second, harm) in [(prototype::M11, NO_SUPPLY), (prototype::M4, SHORT)] {
        for wait in [20.0, 150.0, 700.0, 3000.0] {
            let first = Event::Harm(prototype::M1, NO_SUPPLY);
            // The limp begins within 100 ms of the first.
            let story = story(&[(500.0, first), (100.0 + wait, Event::Harm(second, harm))]);
            assert!(story.off_after(0, prototype::M1) <= 100.0);
            assert_cut(&story, 1, 100.0, "a second driver");
            // The first one is the reason.
            assert!(story.has("(driver of motor m1 "), "{:?}", story.heard);
        }
    }
    let story =
        story(&[(500.0, Event::Harm(prototype::M1, NO_SUPPLY)), (900.0, Event::Harm(prototype::Z2, NO_SUPPLY))]);
    assert_cut(&story, 1, 207.0, "a Z driver");
}

#[test]
fn m112_and_m410_end_the_limp_by_cutting_everything() {
    for line in ["M112", "M410"] {
        for wait in [400.0, 3000.0] {
            let story = story(&[(500.0, Event::Harm(prototype::M8, NO_SUPPLY)), (wait, Event::Say(line))]);
            assert_cut(&story, 1, 2.0, line);
        }
    }
}

#[test]
fn whoever_does_not_know_where_the_tool_is_or_moves_it_otherwise_cuts_everything() {
    let lines = |first: &[&str]| -> Vec<String> {
        let first = first.iter().map(|line| (*line).to_owned());
        first.chain(["G4 P1".to_owned()]).chain(perimeters()).collect()
    };
    let harm = |at| [(at, Event::Harm(prototype::M4, NO_SUPPLY))];
    let prototype = Settings::prototype();
    for (what, start, first, at) in [
        ("in homing", None, &["G28"][..], 2000.0),
        ("z is not homed", None, &["G28 X Y"], 16_000.0),
        ("the belt runs round", Some(START), &["G1 C200 F3000"], 1000.0),
        ("the motors are aligned", Some(START), &["M915"], 25_000.0),
    ] {
        let story = story_of(&prototype, start, &lines(first), &harm(at));
        assert_cut(&story, 0, 100.0, what);
    }
    // A Z screw and the extruder work without an opposing motor.
    for motor in [prototype::Z1, prototype::E0] {
        assert_cut(
            &story(&[(500.0, Event::Harm(motor, NO_SUPPLY))]),
            0,
            207.0,
            prototype::NAMES[motor.index()].as_str(),
        );
    }
}

#[test]
fn without_a_lift_everything_is_cut_at_once() {
    let mut settings = Settings::prototype();
    settings.belt.limp_lift = Mm::ZERO;
    for (motor, harm) in [(prototype::M1, NO_SUPPLY), (prototype::M11, RESET)] {
        let story = story_of(&settings, Some(START), &perimeters(), &[(500.0, Event::Harm(motor, harm))]);
        assert_cut(&story, 0, 100.0, "no lift");
        assert_eq!(story.raised_mm, 0.0);
    }
}

/// There is less room above than it would take.
#[test]
fn z_is_not_raised_beyond_its_top() {
    let mut settings = Settings::prototype();
    settings.axes.z.length = Mm::from_num(14);
    let story = story_of(&settings, Some(START), &perimeters(), &[(500.0, Event::Harm(prototype::M1, NO_SUPPLY))]);
    assert!(story.has("tool parked, z raised by 4 mm") && (story.raised_mm - 4.0).abs() < 0.01, "{:?}", story.heard);
}

#[test]
fn a_corexy_has_no_motor_to_spare() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/machines/corexy.toml");
    let settings = machine_file::load(&std::fs::read_to_string(path).unwrap()).unwrap();
    let motor = settings.mechanism.belt_motors();
    let motor = BELT.into_iter().find(|one| motor.has(*one)).unwrap();
    let story =
        story_of(&settings, Some([100.0, 100.0, 10.0]), &perimeters(), &[(500.0, Event::Harm(motor, NO_SUPPLY))]);
    assert_cut(&story, 0, 207.0, "CoreXY");
}
