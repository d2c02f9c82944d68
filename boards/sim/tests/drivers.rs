//! Motor drivers that are well, and that are not: what the firmware does, and that no motor runs on trust.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::{Motor, MotorSet};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::tmc2209::{self, Corruption, IOIN, chopconf, gconf};
use corehbot_sim::world::{Host, Outcome, Sink, run_on};
use proptest::prelude::*;
use std::collections::VecDeque;

/// What the host and the user do, one after the other.
enum Act<'d> {
    /// A line to the printer; the next act waits for its `ok`.
    Say(String),
    /// Something happens to the drivers.
    Do(Box<dyn FnOnce(&Drivers) + 'd>),
}

fn say<'d>(line: &str) -> Act<'d> {
    Act::Say(line.to_owned())
}

fn act<'d>(change: impl FnOnce(&Drivers) + 'd) -> Act<'d> {
    Act::Do(Box::new(change))
}

struct Script<'d> {
    drivers: &'d Drivers,
    acts: VecDeque<Act<'d>>,
    is_awaiting: bool,
    heard: Vec<String>,
    /// A line that is sent without waiting once the chips have said so much.
    interjection: Option<(u32, &'static str)>,
    interjected: u64,
}

impl Host for Script<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        while !self.is_awaiting {
            match self.acts.pop_front() {
                None => return,
                Some(Act::Do(change)) => change(self.drivers),
                Some(Act::Say(line)) => {
                    out.extend(line.bytes().chain([b'\n']));
                    self.is_awaiting = true;
                }
            }
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let replies = |motor: &Motor| self.drivers.chip(*motor).replies();
        if let Some((_, line)) = self.interjection.take_if(|(at, _)| Motor::ALL.iter().map(replies).sum::<u32>() >= *at)
        {
            out.extend(line.bytes().chain([b'\n']));
            self.interjected = self.drivers.seen();
        }
    }

    fn hear(&mut self, line: &str) {
        self.is_awaiting &= !line.starts_with("ok");
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.acts.is_empty() && !self.is_awaiting
    }
}

/// Something that happens to the drivers at a step.
type Strike<'d> = (u64, Box<dyn FnMut(&Drivers) + 'd>);

/// Sees every step, and whether the motors were fit for it.
#[derive(Default)]
struct Steps<'d> {
    drivers: Option<&'d Drivers>,
    strike: Option<Strike<'d>>,
    struck: u64,
    count: u64,
    tick: u64,
    /// Steps of motors without power, or whose driver makes other microsteps, before anything struck.
    unfit: u64,
}

impl Sink for Steps<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        (self.count, self.tick) = (self.count + 1, tick);
        let Some(drivers) = self.drivers else { return };
        if let Some((_, strike)) = self.strike.as_mut().filter(|(at, _)| *at == self.count) {
            strike(drivers);
            self.struck = tick;
        }
        if self.struck == 0 {
            self.unfit += u64::from(!steps.without(drivers.enabled()).is_empty() || !drivers.astray(16).is_empty());
        }
    }
}

impl Steps<'_> {
    /// Milliseconds from the strike to the last step.
    fn aftermath_ms(&self) -> u64 {
        (self.tick - self.struck) / u64::from(TICKS_PER_MS)
    }
}

struct Told<'d> {
    heard: Vec<String>,
    outcome: Outcome,
    steps: Steps<'d>,
    interjected: u64,
}

impl Told<'_> {
    fn has(&self, part: &str) -> bool {
        self.heard.iter().any(|line| line.contains(part))
    }

    fn errors(&self) -> Vec<&String> {
        self.heard.iter().filter(|line| line.starts_with("Error:")).collect()
    }
}

fn play<'d>(drivers: &'d Drivers, acts: Vec<Act<'d>>, strike: Option<Strike<'d>>) -> Told<'d> {
    play_with(drivers, acts, strike, None)
}

fn play_with<'d>(
    drivers: &'d Drivers,
    acts: Vec<Act<'d>>,
    strike: Option<Strike<'d>>,
    interjection: Option<(u32, &'static str)>,
) -> Told<'d> {
    let (acts, heard) = (acts.into(), Vec::new());
    let mut host = Script { drivers, acts, is_awaiting: false, heard, interjection, interjected: 0 };
    let mut steps = Steps { drivers: Some(drivers), strike, ..Steps::default() };
    let start = Some([Mm::ZERO; 3]);
    let outcome = run_on(&Settings::prototype(), start, NoStorage, drivers, &mut [&mut host], &mut steps).unwrap();
    assert_eq!(steps.unfit, 0);
    assert_eq!(drivers.betrayed(), MotorSet::NONE);
    Told { heard: host.heard.into_iter().skip(2).collect(), outcome, steps, interjected: host.interjected }
}

fn lines<'d>(lines: &[&str]) -> Vec<Act<'d>> {
    lines.iter().map(|line| say(line)).collect()
}

fn each(drivers: &Drivers, change: impl Fn(&mut tmc2209::Tmc2209)) {
    Motor::ALL.into_iter().for_each(|motor| change(&mut drivers.chip(motor)));
}

const LONG_MOVE: [&str; 2] = ["G1 X300 Y300 Z10 E20 F6000", "M400"];

#[test]
fn a_healthy_machine_is_configured_before_its_first_step() {
    let drivers = Drivers::new();
    let told = play(&drivers, lines(&["G1 X50 Y20 Z1 E3 F6000", "M400"]), None);
    assert_eq!(told.heard, ["ok", "ok"]);
    assert!(told.steps.count > 1000 && !told.outcome.halted);
    assert_eq!(drivers.enabled(), MotorSet::ALL);
    for motor in Motor::ALL {
        let chip = drivers.chip(motor);
        assert_eq!(chip.microsteps(), 16);
        assert!((chip.run_current_ma() - 800.0).abs() < 16.0, "{}", chip.run_current_ma());
        assert_ne!(chip.register(gconf::ADDRESS) & gconf::EN_SPREADCYCLE, 0);
        assert_eq!(chip.register(tmc2209::GSTAT), 0);
    }
    let hold = |motor| drivers.chip(motor).register(tmc2209::IHOLD_IRUN) & 0x1F;
    assert_eq!((hold(Motor::M1), hold(Motor::Z1)), (12, 25));
}

#[test]
fn power_comes_within_a_second_the_first_time_and_soon_after() {
    let drivers = Drivers::new();
    play(&drivers, lines(&["M17"]), None);
    let first = drivers.switched() / u64::from(TICKS_PER_MS);
    assert!((600..1000).contains(&first), "{first} ms");
    let drivers = Drivers::new();
    play(&drivers, lines(&["M17", "M84", "G4 S1", "M17"]), None);
    let again = drivers.switched() / u64::from(TICKS_PER_MS) - first - 1000;
    assert!((130..250).contains(&again), "{again} ms");
}

#[test]
fn without_motor_supply_nothing_moves_and_nothing_is_lost() {
    let drivers = Drivers::new();
    let acts = vec![
        act(|d| each(d, tmc2209::Tmc2209::power_off)),
        say("G1 X10 E5 F6000"),
        say("M114"),
        say("G91"),
        say("G1 X10"),
        say("G2 X10 I5"),
        say("G28"),
        say("M17"),
        act(|d| each(d, tmc2209::Tmc2209::power_on)),
        say("G1 X10 E1"),
        say("M400"),
        say("M114 R"),
    ];
    let told = play(&drivers, acts, None);
    assert_eq!(told.errors().len(), 5, "{:?}", told.heard);
    let error = "Error:driver of motor 1 does not answer: is the motor supply on, its jumper set to UART?; \
                 no motor was given power";
    assert!(told.errors().iter().all(|line| *line == error), "{:?}", told.heard);
    assert_eq!(told.heard.iter().filter(|line| *line == "ok").count(), 10);
    let positions: Vec<_> = told.heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert!(positions[0].starts_with("X:0.00 Y:0.00 Z:0.00 E:0.00 "), "{positions:?}");
    assert!(positions[1].starts_with("X:10.00 Y:0.00 Z:0.00 E:1.00 "), "{positions:?}");
    assert!(!told.outcome.halted);
    assert_eq!(told.outcome.moves, 1);
}

#[test]
fn one_bad_driver_keeps_the_power_from_all_but_only_where_it_is_needed() {
    let drivers = Drivers::new();
    let acts = vec![
        act(|d| d.chip(Motor::M8).power_off()),
        say("M17"),
        say("M17 Z"),
        act(|d| assert_eq!(d.enabled(), MotorSet::Z)),
        say("M17 X"),
        act(|d| assert_eq!(d.enabled(), MotorSet::Z)),
        act(|d| d.chip(Motor::M8).power_on()),
        say("M17 X"),
        act(|d| assert_eq!(d.enabled(), MotorSet::Z.with(MotorSet::BELT))),
    ];
    let told = play(&drivers, acts, None);
    let errors = told.errors();
    assert_eq!(errors.len(), 2, "{:?}", told.heard);
    assert!(errors[0].starts_with("Error:driver of motor 8 does not answer"));
}

#[test]
fn every_kind_of_bad_driver_is_named() {
    type Break = fn(&mut tmc2209::Tmc2209);
    let cases: [(Break, &str); 6] = [
        (|chip| chip.is_silent = true, "does not answer"),
        (|chip| (0..9999).for_each(|n| chip.corrupt_reply(n, Corruption::Flip { byte: 7, mask: 1 })), "unreadably"),
        (|chip| chip.is_write_protected = true, "does not take its configuration"),
        (|chip| chip.is_deaf = true, "other microsteps"),
        (|chip| chip.answer_wrongly(chopconf::ADDRESS, 0x1500_0053), "other microsteps"),
        (|chip| chip.answer_wrongly(IOIN, 0x2000_0000), "is no TMC2209: its version is 0x20"),
    ];
    for (harm, words) in cases {
        let drivers = Drivers::new();
        let told = play(&drivers, vec![act(|d| harm(&mut d.chip(Motor::Z2))), say("G1 Z5")], None);
        assert_eq!(told.errors().len(), 1, "{:?}", told.heard);
        assert!(told.has("Error:driver of motor Z2") && told.has(words), "{words}: {:?}", told.heard);
        assert_eq!((told.steps.count, drivers.enabled()), (0, MotorSet::NONE));
    }
}

#[test]
fn a_driver_that_loses_its_registers_in_mid_move_stops_the_machine() {
    for motor in Motor::ALL {
        let drivers = Drivers::new();
        let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(move |d| d.chip(motor).reset()))));
        assert!(told.outcome.halted, "{:?}", told.heard);
        assert!(told.has("Error:Printer halted. kill() called! (driver of motor"), "{:?}", told.heard);
        assert!(told.has("was reset and lost its configuration"), "{:?}", told.heard);
        assert_eq!(drivers.enabled(), MotorSet::NONE);
        assert!(told.steps.aftermath_ms() <= 200, "{motor:?}: {} ms", told.steps.aftermath_ms());
    }
}

#[test]
fn a_dip_of_the_whole_supply_is_seen_by_the_next_poll() {
    let drivers = Drivers::new();
    let strike = |d: &Drivers| each(d, tmc2209::Tmc2209::reset);
    let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(strike))));
    assert!(told.outcome.halted && told.steps.aftermath_ms() <= 50, "{} ms", told.steps.aftermath_ms());
}

#[test]
fn every_failure_in_mid_move_is_named() {
    type Break = fn(&mut tmc2209::Tmc2209);
    let cases: [(Break, &str); 7] = [
        (tmc2209::Tmc2209::power_off, "does not answer"),
        (|chip| chip.set(tmc2209::DRV_STATUS, 1 << 2), "short circuit"),
        (|chip| chip.set(tmc2209::DRV_STATUS, 3), "too hot"),
        (|chip| chip.set(tmc2209::GSTAT, 2), "had switched itself off"),
        (|chip| chip.set(tmc2209::GSTAT, 4), "too low a supply"),
        (|chip| chip.set(chopconf::ADDRESS, 0x1303_0053), "other microsteps"),
        (|chip| chip.set(chopconf::ADDRESS, 0x1403_0050), "holds another CHOPCONF"),
    ];
    for (harm, words) in cases {
        let drivers = Drivers::new();
        let strike = move |d: &Drivers| harm(&mut d.chip(Motor::M11));
        let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(strike))));
        assert!(told.outcome.halted && told.has("kill() called! (driver of motor 11") && told.has(words), "{words}");
        assert_eq!(drivers.enabled(), MotorSet::NONE);
        assert!(told.steps.aftermath_ms() <= 250, "{words}: {} ms", told.steps.aftermath_ms());
    }
}

fn script<'d>(drivers: &'d Drivers, lines: &[&str]) -> Script<'d> {
    let acts = lines.iter().map(|line| say(line)).collect();
    Script { drivers, acts, is_awaiting: false, heard: Vec::new(), interjection: None, interjected: 0 }
}

/// Counts the steps of motors without power.
struct Powered<'d> {
    drivers: &'d Drivers,
    without: u64,
}

impl Sink for Powered<'_> {
    fn event(&mut self, _tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.without += u64::from(!steps.without(self.drivers.enabled()).is_empty());
    }
}

/// Power that goes while other microsteps are on their way to the drivers has to come back before a step.
#[test]
fn a_move_that_waits_for_new_microsteps_does_not_run_without_power() {
    let mut eeprom = Eeprom::blank();
    let mut other = Settings::prototype();
    (other.drivers.belt.microsteps, other.drivers.z.microsteps, other.drivers.e.microsteps) = (32, 32, 32);
    let drivers = Drivers::new();
    let mut host = script(&drivers, &["M500"]);
    run_on(&other, None, &mut eeprom, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
    // M122 takes a third of a second without any motion.
    for reports in 0..4 {
        let drivers = Drivers::new();
        let lines =
            [&["M502", "M84 S1", "G1 X1 F6000", "M400"][..], &["M122"].repeat(reports), &["M501", "G1 X2", "M400"]];
        let mut host = script(&drivers, &lines.concat());
        let mut steps = Powered { drivers: &drivers, without: 0 };
        let start = Some([Mm::ZERO; 3]);
        run_on(&Settings::prototype(), start, &mut eeprom, &drivers, &mut [&mut host], &mut steps).unwrap();
        assert_eq!(steps.without, 0, "{reports} reports: {:?}", host.heard);
    }
}

/// On such a wire each look takes longer than the time between two.
#[test]
fn a_driver_that_is_asked_twice_each_time_leaves_others_their_turn() {
    let drivers = Drivers::new();
    let harm = |chip: &mut tmc2209::Tmc2209| {
        let begin = chip.replies();
        (0..4000).for_each(|n| chip.corrupt_reply(begin + 4 * n, Corruption::Cut(0)));
    };
    let acts = vec![say("M17"), act(|d| each(d, harm)), say("M906 X700"), say("M569 S1"), say("M122")];
    let told = play(&drivers, acts, None);
    assert!(told.errors().is_empty() && !told.outcome.halted, "{:?}", told.heard);
    let busy = told.heard.iter().filter(|line| line.contains("busy")).count();
    assert!(busy <= 3, "{busy} times 2 s");
}

#[test]
fn a_hot_driver_is_told_once_and_works_on() {
    let drivers = Drivers::new();
    let strike = |d: &Drivers| d.chip(Motor::E0).set(tmc2209::DRV_STATUS, 1);
    let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(strike))));
    assert!(!told.outcome.halted);
    assert_eq!(told.heard.iter().filter(|line| line.contains("driver of motor E is hot")).count(), 1);
}

/// Whichever one reply is damaged, power comes, and then the motion is undisturbed.
#[test]
fn one_damaged_reply_never_matters() {
    let damages = [Corruption::Flip { byte: 3, mask: 0x80 }, Corruption::Cut(0), Corruption::Cut(5), Corruption::Zero];
    for damage in damages {
        for number in 0..25 {
            let drivers = Drivers::new();
            drivers.chip(Motor::M4).corrupt_reply(number, damage);
            let told = play(&drivers, lines(&["G1 X30 F3000", "M400", "G4 S3"]), None);
            assert_eq!(told.heard.iter().filter(|l| *l != "ok" && !l.contains("busy")).count(), 0, "{:?}", told.heard);
            assert_eq!(drivers.enabled(), MotorSet::ALL, "{damage:?} of reply {number}");
        }
    }
}

#[test]
fn a_driver_that_was_reset_while_it_had_no_power_is_told_everything_again() {
    let drivers = Drivers::new();
    let acts = vec![say("G1 X5 F6000"), say("M84"), act(|d| d.chip(Motor::M4).reset()), say("G1 X9"), say("M400")];
    let told = play(&drivers, acts, None);
    assert!(told.errors().is_empty() && !told.outcome.halted, "{:?}", told.heard);
    assert_eq!(drivers.chip(Motor::M4).microsteps(), 16);
}

#[test]
fn an_emergency_stop_is_heard_while_drivers_are_talked_to() {
    let drivers = Drivers::new();
    let told = play_with(&drivers, lines(&["M17"]), None, Some((9, "M112")));
    assert!(told.outcome.halted && drivers.enabled().is_empty());
    let ticks = drivers.switched() - told.interjected;
    assert!(ticks <= u64::from(TICKS_PER_MS), "{ticks} ticks");
    let drivers = Drivers::new();
    let told = play_with(&drivers, lines(&["M17", "G1 X1", "M400"]), None, Some((9, "M410")));
    assert!(!told.outcome.halted, "{:?}", told.heard);
    assert_eq!(told.outcome.counts[3], 80);
}

#[test]
fn microsteps_are_those_of_the_settings() {
    let mut settings = Settings::prototype();
    settings.drivers.belt.microsteps = 64;
    let drivers = Drivers::new();
    let acts = lines(&["M17"]).into();
    let mut host =
        Script { drivers: &drivers, acts, is_awaiting: false, heard: Vec::new(), interjection: None, interjected: 0 };
    run_on(&settings, None, NoStorage, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
    let microsteps = |motor| drivers.chip(motor).microsteps();
    assert_eq!((microsteps(Motor::M11), microsteps(Motor::Z1)), (64, 16));
}

#[test]
fn changes_reach_drivers_under_way_and_change_no_step() {
    let quiet = play(&Drivers::new(), lines(&LONG_MOVE), None).outcome;
    let drivers = Drivers::new();
    let told = play(&drivers, lines(&[LONG_MOVE[0], "M906 X1200 Z400", "M914 Y50", "M400"]), None);
    assert_eq!((told.outcome.ticks, told.outcome.counts), (quiet.ticks, quiet.counts));
    for motor in [Motor::M1, Motor::M4, Motor::M8, Motor::M11] {
        assert!((drivers.chip(motor).run_current_ma() - 1200.0).abs() < 28.0);
        assert_eq!(drivers.chip(motor).register(tmc2209::SGTHRS), 50);
        assert_eq!(drivers.chip(motor).register(tmc2209::TCOOLTHRS), 0xF_FFFF);
    }
    assert!((drivers.chip(Motor::Z2).run_current_ma() - 400.0).abs() < 16.0);
    assert!((drivers.chip(Motor::E0).run_current_ma() - 800.0).abs() < 16.0);
}

#[test]
fn a_reset_is_not_hidden_by_a_change_that_is_under_way() {
    let drivers = Drivers::new();
    let strike = |d: &Drivers| d.chip(Motor::M8).reset();
    let acts = lines(&["M17", LONG_MOVE[0], "M906 X900", "M400"]);
    let told = play(&drivers, acts, Some((1, Box::new(strike))));
    assert!(told.outcome.halted && told.has("driver of motor 8 was reset"), "{:?}", told.heard);
}

#[test]
fn stealth_is_a_bit_of_gconf() {
    let drivers = Drivers::new();
    let is_spread = |motor| drivers.chip(motor).register(gconf::ADDRESS) & gconf::EN_SPREADCYCLE != 0;
    let told = play(&drivers, lines(&["M17", "M569 S1 X", "M913 X100", "M569", "M913", "M122"]), None);
    assert_eq!((is_spread(Motor::M1), is_spread(Motor::M11), is_spread(Motor::Z1)), (false, false, true));
    let modes: Vec<_> = told.heard.iter().filter(|line| line.contains("driver mode")).collect();
    let [stealth, spread] = ["stealthChop", "spreadCycle"];
    let expected = [("X", stealth), ("Y", stealth), ("Z", spread), ("E", spread)];
    assert_eq!(modes, expected.map(|(axis, mode)| format!("{axis} driver mode: {mode}")).iter().collect::<Vec<_>>());
    assert!(
        told.has("Y stealthChop max speed: 100") && told.has("Driver 8: configured, motor on, 795 mA, stealthChop")
    );
}

#[test]
fn the_report_tells_of_each_driver() {
    let drivers = Drivers::new();
    let break_some = |d: &Drivers| {
        d.chip(Motor::M8).is_silent = true;
        d.chip(Motor::E0).set(tmc2209::DRV_STATUS, 1 << 8 | 1 << 6);
        d.chip(Motor::E0).set(tmc2209::SG_RESULT, 123);
    };
    let told = play(&drivers, vec![act(break_some), say("M122"), say("M17 Z"), say("M17 E"), say("M122")], None);
    let report: Vec<_> = told.heard.iter().map(String::as_str).collect();
    assert!(report.contains(&"Driver 1: not configured yet, motor off"), "{report:#?}");
    assert!(report.contains(&"Driver 8: does not answer: is the motor supply on, its jumper set to UART?"));
    assert!(report.contains(&"Driver Z1: configured, motor on, 795 mA, spreadCycle, 16 microsteps, 4.00 mm a turn"));
    assert!(report.contains(&"Driver E: configured, motor on, 795 mA, spreadCycle, 16 microsteps, 8.00 mm a turn"));
    let health = "  above 120 C, coil open?, stall result 123, 12 writes, 0 failed exchanges";
    assert!(report.contains(&health), "{report:#?}");
}

#[test]
fn values_are_reported_refused_and_kept() {
    let drivers = Drivers::new();
    let told = play(
        &drivers,
        lines(&["M906", "M906 X900 Y800", "M906 X1800", "M906 E99", "M906 Y850 E500", "M906", "M914 X70", "M914"]),
        None,
    );
    let heard: Vec<_> = told.heard.iter().map(String::as_str).filter(|line| *line != "ok").collect();
    assert_eq!(
        heard,
        [
            "X driver current: 800",
            "Y driver current: 800",
            "Z driver current: 800",
            "E driver current: 800",
            "echo:M906 ignored: X and Y move one belt and need the same value",
            "echo:M906 ignored: 100 to 1700 mA",
            "echo:M906 ignored: 100 to 1700 mA",
            "X driver current: 850",
            "Y driver current: 850",
            "Z driver current: 800",
            "E driver current: 500",
            "X homing sensitivity: 70",
            "Y homing sensitivity: 70",
            "Z homing sensitivity: 0",
            "E homing sensitivity: 0",
        ]
    );
}

#[test]
fn values_are_stored_and_come_back() {
    let mut eeprom = Eeprom::blank();
    let mut talk = |acts: &[&str]| {
        let drivers = Drivers::new();
        let acts = lines(acts).into();
        let (heard, interjection) = (Vec::new(), None);
        let mut host = Script { drivers: &drivers, acts, is_awaiting: false, heard, interjection, interjected: 0 };
        let mut steps = Steps::default();
        run_on(&Settings::prototype(), None, &mut eeprom, &drivers, &mut [&mut host], &mut steps).unwrap();
        let current = drivers.chip(Motor::M8).run_current_ma();
        (host.heard, current)
    };
    talk(&["M906 X950 Z333", "M569 S1 E", "M913 E40.5", "M914 Z12", "M500"]);
    let (heard, current) = talk(&["M17", "M503"]);
    for line in ["M569 S0 X Y", "M569 S1 E", "M906 X950 Y950 Z333 E800", "M913 X0 Y0 Z0 E40.5", "M914 X0 Y0 Z12 E0"] {
        assert!(heard.contains(&format!("echo:  {line}")), "{heard:?}");
    }
    assert!((current - 950.0).abs() < 16.0);
    let (_, current) = talk(&["M17", "M502", "M569 S0"]);
    assert!((current - 800.0).abs() < 16.0, "the defaults reach motors that have power: {current}");
    let (_, current) = talk(&["M17", "M502", "M501", "M569 S0"]);
    assert!((current - 950.0).abs() < 16.0);
}

#[test]
fn drivers_without_a_wire_run_as_before() {
    let drivers = Drivers::with_lines(MotorSet::NONE);
    let told = play(&drivers, lines(&["M17", "G1 X5 F6000", "M400", "M906 X900", "M569 S1", "M122", "M503"]), None);
    assert_eq!(told.heard.iter().filter(|line| *line == "echo:drivers are set by their jumpers").count(), 2);
    assert_eq!(told.heard.iter().filter(|line| line.ends_with("no UART, set by its jumpers")).count(), 7);
    assert!(!told.has("M906 X"));
    assert_eq!(told.outcome.counts[3], 400);
    assert_eq!(drivers.chip(Motor::M1).replies(), 0);
    // Some have a wire, some have none.
    let drivers = Drivers::with_lines(MotorSet::BELT);
    let told = play(&drivers, lines(&["G1 X5 F6000", "M400", "M122"]), None);
    assert_eq!(drivers.enabled(), MotorSet::ALL);
    assert!(told.has("Driver 1: configured") && told.has("Driver Z1: no UART"));
}

fn damage() -> impl Strategy<Value = Corruption> {
    prop_oneof![
        (0usize..8, 1u8..=255).prop_map(|(byte, mask)| Corruption::Flip { byte, mask }),
        (0usize..8).prop_map(Corruption::Cut),
        Just(Corruption::Zero),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Whatever replies are damaged, and whenever drivers are reset: no motor gets power when its driver has said
    /// that it lost its configuration; and two seconds later all motors have power and the right microsteps, or none
    /// has power and the host knows why.
    #[test]
    fn no_motor_runs_on_trust(
        damages in proptest::collection::vec((0usize..7, 0u32..40, damage()), 0..12),
        resets in proptest::collection::vec((0usize..7, 1u32..75), 0..3),
        silent in proptest::option::weighted(0.1, 0usize..7),
    ) {
        let drivers = Drivers::new();
        for (motor, number, damage) in damages {
            drivers.chip(Motor::ALL[motor]).corrupt_reply(number, damage);
        }
        if let Some(motor) = silent {
            drivers.chip(Motor::ALL[motor]).is_silent = true;
        }
        let mut host = Resets { script: Script {
            drivers: &drivers, acts: lines(&["M17", "G4 S2"]).into(), is_awaiting: false, heard: Vec::new(),
            interjection: None, interjected: 0,
        }, resets };
        let start = Some([Mm::ZERO; 3]);
        let outcome =
            run_on(&Settings::prototype(), start, NoStorage, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
        let heard = &host.script.heard;
        prop_assert_eq!(drivers.betrayed(), MotorSet::NONE);
        let has_error = heard.iter().any(|line| line.starts_with("Error:"));
        if drivers.enabled().is_empty() {
            prop_assert!(has_error, "{:?}", heard);
        } else {
            prop_assert_eq!((drivers.enabled(), drivers.astray(16)), (MotorSet::ALL, MotorSet::NONE), "{:?}", heard);
            prop_assert!(!has_error && !outcome.halted);
        }
    }
}

/// A host on whose machine drivers are reset when all of them together have said so much.
struct Resets<'d> {
    script: Script<'d>,
    resets: Vec<(usize, u32)>,
}

impl Host for Resets<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.script.send(out);
    }

    fn interject(&mut self, _out: &mut Vec<u8>) {
        let drivers = self.script.drivers;
        let said: u32 = Motor::ALL.iter().map(|motor| drivers.chip(*motor).replies()).sum();
        self.resets.retain(|(motor, at)| {
            if said >= *at {
                drivers.chip(Motor::ALL[*motor]).reset();
            }
            said < *at
        });
    }

    fn hear(&mut self, line: &str) {
        self.script.hear(line);
    }

    fn is_done(&self) -> bool {
        self.script.is_done()
    }
}
