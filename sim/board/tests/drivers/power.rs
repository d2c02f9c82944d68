//! Power: no motor gets it before its driver has shown its configuration.

use super::script::{Steps, act, each, lines, play, say, script};
use corehbot::motors::{MotorSet, prototype};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::tmc2209;
use corehbot_sim::tmc2209::{Corruption, IOIN, chopconf, gconf};
use corehbot_sim::world::{Host, Sink, run_on};

#[test]
fn a_healthy_machine_is_configured_before_its_first_step() {
    let drivers = Drivers::new();
    let told = play(&drivers, lines(&["G1 X50 Y20 Z1 E3 F6000", "M400"]), None);
    assert_eq!(told.heard, ["ok", "ok"]);
    assert!(told.steps.count > 1000 && !told.outcome.halted);
    assert_eq!(drivers.enabled(), prototype::ALL);
    for motor in prototype::ALL.iter() {
        let chip = drivers.chip(motor);
        assert_eq!(chip.microsteps(), 16);
        assert!((chip.run_current_ma() - 800.0).abs() < 16.0, "{}", chip.run_current_ma());
        assert_ne!(chip.register(gconf::ADDRESS) & gconf::EN_SPREADCYCLE, 0);
        assert_eq!(chip.register(tmc2209::GSTAT), 0);
    }
    let hold = |motor| drivers.chip(motor).register(tmc2209::IHOLD_IRUN) & 0x1F;
    assert_eq!((hold(prototype::M1), hold(prototype::Z1)), (12, 25));
}

#[test]
fn power_comes_within_a_second_and_a_half_the_first_time_and_soon_after() {
    let drivers = Drivers::new();
    play(&drivers, lines(&["M17"]), None);
    let first = drivers.switched() / u64::from(TICKS_PER_MS);
    assert!((900..1300).contains(&first), "{first} ms");
    let drivers = Drivers::new();
    play(&drivers, lines(&["M17", "M84", "G4 S1", "M17"]), None);
    let again = drivers.switched() / u64::from(TICKS_PER_MS) - first - 1000;
    assert!((430..600).contains(&again), "{again} ms");
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
    let error = "Error:driver of motor m1 does not answer: is the motor supply on, its jumper set to UART?; no motor \
        got power";
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
        act(|d| d.chip(prototype::M8).power_off()),
        say("M17"),
        say("M17 Z"),
        act(|d| assert_eq!(d.enabled(), prototype::Z)),
        say("M17 X"),
        act(|d| assert_eq!(d.enabled(), prototype::Z)),
        act(|d| d.chip(prototype::M8).power_on()),
        say("M17 X"),
        act(|d| assert_eq!(d.enabled(), prototype::Z.with(prototype::BELT))),
    ];
    let told = play(&drivers, acts, None);
    let errors = told.errors();
    assert_eq!(errors.len(), 2, "{:?}", told.heard);
    assert!(errors[0].starts_with("Error:driver of motor m8 does not answer"));
}

#[test]
fn every_kind_of_bad_driver_is_named() {
    type Break = fn(&mut tmc2209::Tmc2209);
    let cases: [(Break, &str); 6] = [
        (|chip| chip.is_silent = true, "does not answer"),
        (
            |chip| (0..9999).for_each(|n| chip.corrupt_reply(n, Corruption::Flip { byte: 7, mask: 1 })),
            "the answer is damaged",
        ),
        (|chip| chip.is_write_protected = true, "did not accept its configuration"),
        (|chip| chip.is_deaf = true, "different microsteps"),
        (|chip| chip.answer_wrongly(chopconf::ADDRESS, 0x1500_0053), "different microsteps"),
        (|chip| chip.answer_wrongly(IOIN, 0x2000_0000), "is not a TMC2209: its version is 0x20"),
    ];
    for (harm, words) in cases {
        let drivers = Drivers::new();
        let told = play(&drivers, vec![act(|d| harm(&mut d.chip(prototype::Z2))), say("G1 Z5")], None);
        assert_eq!(told.errors().len(), 1, "{:?}", told.heard);
        assert!(told.has("Error:driver of motor z2") && told.has(words), "{words}: {:?}", told.heard);
        assert_eq!((told.steps.count, drivers.enabled()), (0, MotorSet::NONE));
    }
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

/// Power that goes while new microsteps are sent to the drivers has to come back before a step.
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

#[test]
fn drivers_without_a_wire_run_as_before() {
    let drivers = Drivers::with_lines(MotorSet::NONE);
    let told = play(&drivers, lines(&["M17", "G1 X5 F6000", "M400", "M906 X900", "M569 S1", "M122", "M503"]), None);
    assert_eq!(told.heard.iter().filter(|line| *line == "echo:drivers are set by their jumpers").count(), 2);
    assert_eq!(told.heard.iter().filter(|line| line.ends_with("no UART, set by its jumpers")).count(), 7);
    assert!(!told.has("M906 X"));
    assert_eq!(told.outcome.counts[3], 400);
    assert_eq!(drivers.chip(prototype::M1).replies(), 0);
    // Some drivers have a wire, some do not.
    let drivers = Drivers::with_lines(prototype::BELT);
    let told = play(&drivers, lines(&["G1 X5 F6000", "M400", "M122"]), None);
    assert_eq!(drivers.enabled(), prototype::ALL);
    assert!(told.has("Driver m1: configured") && told.has("Driver z1: no UART"));
}

/// Rotors that get power snap to their nearest rest, one after another: all of a belt's motors except the first find a
/// belt that gives way.
#[test]
fn motors_of_one_belt_get_power_one_after_another_and_lose_it_together() {
    /// The motors that were switched on, and when.
    struct Watch<'d> {
        drivers: &'d Drivers,
        lines: Vec<&'static str>,
        is_awaiting: bool,
        seen: Vec<(u64, MotorSet)>,
    }
    impl Host for Watch<'_> {
        fn send(&mut self, out: &mut Vec<u8>) {
            if !self.is_awaiting && !self.lines.is_empty() {
                out.extend(self.lines.remove(0).bytes().chain([b'\n']));
                self.is_awaiting = true;
            }
        }
        fn clock(&mut self, tick: u64) {
            if self.seen.last().is_none_or(|(_, on)| *on != self.drivers.enabled()) {
                self.seen.push((tick / u64::from(TICKS_PER_MS), self.drivers.enabled()));
            }
        }
        fn hear(&mut self, line: &str) {
            self.is_awaiting &= !line.starts_with("ok");
        }
        fn is_done(&self) -> bool {
            self.lines.is_empty() && !self.is_awaiting
        }
    }
    let drivers = Drivers::new();
    let lines = vec!["M17 X", "M84 Y", "M17", "M84 E", "G4 P1"];
    let mut watch = Watch { drivers: &drivers, lines, is_awaiting: false, seen: Vec::new() };
    run_on(&Settings::prototype(), None, NoStorage, &drivers, &mut [&mut watch], &mut Steps::default()).unwrap();
    let on = |motors: u8| MotorSet(motors);
    let sets: Vec<_> = watch.seen.iter().map(|(_, on)| *on).collect();
    let one_by_one = [on(0b1), on(0b11), on(0b111), prototype::BELT];
    let all = [on(0b1), on(0b11), on(0b111), prototype::BELT].map(|belt| belt.with(prototype::Z).with(prototype::E));
    let wanted: Vec<_> = [MotorSet::NONE]
        .into_iter()
        .chain(one_by_one)
        .chain([MotorSet::NONE])
        .chain(all)
        .chain([prototype::ALL.without(prototype::E)])
        .collect();
    assert_eq!(sets, wanted);
    for belt in [&watch.seen[1..5], &watch.seen[6..10]] {
        for pair in belt.windows(2) {
            let apart = pair[1].0 - pair[0].0;
            assert!((100..200).contains(&apart), "{apart} ms");
        }
    }
}
