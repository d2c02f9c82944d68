//! The image heats: the plant's heaters hang on its pins, and the plant's sensors on its converter.

use crate::common::{Bench, MS, bench_of, firmware, heated, heated_bench, print_on, self_test_subject};
use corehbot::connectors::{ConnectorName, Heater, Output};
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::{Settings, Supply};
use corehbot::units::{Seconds, TICKS_PER_MS};
use corehbot_emulator::compare::{Timing, difference, scheduled, timing};
use corehbot_emulator::heat_pins::{Climate, Mishap, Sample};
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;
use corehbot_rig::plant::{HeaterFault, PlantFaults, SensorFault};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Desk, Sink, World};

/// The fault to inject.
type Breakage = fn(&mut PlantFaults);

/// Says `gcode` to a heated machine; hotend and bed have had the temperatures `start` for long.
fn talk(gcode: &str, start: Option<[f64; 2]>, mishap: Option<Mishap>) -> Seen {
    let bench = Bench { climate: Climate { start, mishap, ..Climate::default() }, ..heated_bench() };
    let seen = print_on(&firmware(), gcode, &bench);
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    assert!(seen.resets.is_empty(), "{:?}", seen.resets);
    seen
}

/// The number after `letter` in a report.
fn number(report: &str, letter: &str) -> f64 {
    let (_, rest) = report.split_once(letter).unwrap();
    rest.split(' ').next().unwrap().parse().unwrap()
}

/// From `at` until the pin of an output was low, and stayed so, in ns.
fn low_after(seen: &Seen, output: Output, at: u64) -> u64 {
    let last = seen.heat.edges.iter().rfind(|edge| edge.output == output).expect("a heater that was on");
    assert!(!last.is_high, "{output:?} is on at the end");
    last.at.saturating_sub(at)
}

#[test]
fn hotend_and_bed_are_heated_held_and_told_of() {
    let gcode = "M140 S60\nM109 S60\nM190 S60\nM105\nM106 S255\nM140 S0\nM104 S0\nG4 P500\n";
    let seen = talk(gcode, Some([57.0, 59.0]), None);
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
    let told = seen.line.said.iter().find(|line| line.starts_with("ok T:")).expect("an answer to M105");
    println!("{told}");
    for letter in ["T:", "B:"] {
        assert!((number(told, letter) - 60.0).abs() < 1.0, "{told}");
    }
    // Before the end both were switched off.
    let before = |ms: u64| seen.heat.samples.iter().rfind(|sample| sample.at < seen.virtual_ns - ms * MS).unwrap();
    let Sample { celsius: [hotend, bed], fans, .. } = before(700);
    println!("truly {hotend:.2} and {bed:.2} C");
    assert!((hotend - 60.0).abs() < 1.0 && (bed - 60.0).abs() < 1.0);
    assert!(fans[0] == 0.0 && fans[1] > 0.99 && fans[2] > 0.99, "{fans:?}");
    assert!(seen.heat.samples.last().unwrap().fans[0] > 0.99);
    for output in [Output::He0, Output::Bed] {
        let off = low_after(&seen, output, 0);
        assert!(seen.virtual_ns - off > 450 * MS, "{output:?}");
    }
    // No other output ever moved, and the supply was on from the start to the end.
    assert!(seen.heat.edges.iter().all(|edge| matches!(edge.output, Output::He0 | Output::Bed)));
    assert!(matches!(seen.heat.supply[..], [(at, true)] if at < 100 * MS), "{:?}", seen.heat.supply);
}

/// The hotend alone: a bed takes six times as long.
#[test]
fn the_first_heating_after_flashing_tests_the_heaters_once() {
    let mut settings = heated();
    settings.thermal.heaters.bed.is_fitted = false;
    let (firmware, gcode) = (firmware(), "M104 S45\nG4 S8\nM105\n");
    let bench = Bench { is_untested: true, ..bench_of(settings) };
    let seen = print_on(&firmware, gcode, &bench);
    assert!(seen.line.said.iter().any(|line| line.starts_with("echo:Self-test passed")), "{:?}", seen.line.said);
    let mut eeprom = Eeprom::blank();
    eeprom.cells().copy_from_slice(&seen.eeprom.cells);
    assert_eq!(eeprom.self_test(), Some(self_test_subject(&firmware, &settings)), "it is noted");
    // The pulse for 3 C, and nothing until it is judged.
    let edges: Vec<_> = seen.heat.edges.iter().map(|edge| edge.at / MS).collect();
    let first = edges[0];
    let judged = edges.iter().find(|at| **at > first + 1500).expect("it heats afterwards") - first;
    println!("heated after {judged} ms");
    assert!((5000..8000).contains(&judged));
}

/// The pulses of the hotend end with the control periods, whatever their length, and no pulse is longer than one.
#[test]
fn no_pulse_lasts_longer_than_a_control_period() {
    let seen = talk("M104 S60\nG4 P1500\nM104 S0\nG4 P100\n", Some([52.0, 25.0]), None);
    let edges: Vec<_> = seen.heat.edges.iter().filter(|edge| edge.output == Output::He0).collect();
    let pulses = edges.chunks(2).map(|pair| match pair {
        [up, down] if up.is_high && !down.is_high => down.at - up.at,
        _ => panic!("{pair:?}"),
    });
    let (least, most) = pulses.fold((u64::MAX, 0), |(least, most), long| (least.min(long), most.max(long)));
    println!("{} pulses of {least} to {most} ns", edges.len() / 2);
    assert!(edges.len() > 130 && most <= 20 * MS && most > 19 * MS && least < 15 * MS);
}

/// The simulator's hotend: true temperatures every 20 ms from the first power on.
fn simulated(settings: &Settings, lines: &str, count: usize) -> Vec<f64> {
    struct Deaf;
    impl Sink for Deaf {
        fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
    }
    let (drivers, mut desk, mut sink) = (Drivers::new(), Desk::new(1), Deaf);
    let mut world = World::new(&mut desk, settings, None, NoStorage, &drivers, &mut sink);
    world.wires()[0].put(lines.as_bytes().to_vec());
    let (mut celsius, mut due) = (Vec::new(), None);
    while celsius.len() < count {
        world.poll();
        world.advance();
        let now = world.now() / u64::from(TICKS_PER_MS);
        if due.is_none() && world.heat().duties()[Output::He0 as usize] > 0 {
            due = Some(now);
        }
        if let Some(at) = due.filter(|at| now >= *at) {
            celsius.push(world.heat().plant().unwrap().hotend_celsius());
            due = Some(at + 20);
        }
        assert!(now < 60_000, "it never heats");
    }
    celsius
}

/// The same plant, the same control, another board: two thermal contexts without knowledge of each other. So one may be
/// ahead by a control period of 20 ms and by the heat of that period. And the simulator's temperatures are samples at
/// whole milliseconds.
#[test]
fn simulator_and_image_heat_alike() {
    let gcode = "M104 S45\nG4 S4\n";
    let hotend = heated().thermal.heaters.hotend;
    let within = (0.02 + 0.001) * hotend.power.to_num::<f64>() / hotend.model.capacity.to_num::<f64>();
    let seen = talk(gcode, None, None);
    let begun = seen.heat.edges.first().expect("a heater that is on").at;
    let pins: Vec<f64> = seen.heat.samples.iter().filter(|s| s.at >= begun).map(|sample| sample.celsius[0]).collect();
    let host = simulated(&heated(), gcode, pins.len());
    let apart = pins.iter().zip(&host).map(|(pins, host)| (pins - host).abs()).fold(0.0, f64::max);
    let hottest = pins.iter().copied().fold(0.0, f64::max);
    println!("{} samples, up to {hottest:.2} C, at most {apart:.3} C apart", pins.len());
    assert!(pins.len() > 190 && hottest > 39.0);
    assert!(apart < within, "{apart} C, {within} C are a period's");
}

/// Steps and their lateness are the same as on a machine that does not heat.
#[test]
fn heat_delays_no_step() {
    let moves = "G92 X0 Y0 Z0 E0\nG1 X30 Y10 F9000\nG2 X50 Y30 I20 J0 E2 F6000\nG1 X10 Y5 E4\nM400\n";
    let hot = format!("M104 S200\nM140 S60\nM106 S128\n{moves}");
    let of = |seen: &Seen, gcode: &str, settings: &Settings| -> Timing {
        assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
        let host = scheduled(gcode, settings).unwrap();
        let pins = &seen.recorder.events;
        if let Some(difference) = difference(pins, &host) {
            panic!("{difference}");
        }
        timing(pins, &host)
    };
    let cold = print_on(&firmware(), moves, &Bench::default());
    let late_cold = of(&cold, moves, &Settings::prototype());
    let seen = talk(&hot, Some([200.0, 58.0]), None);
    // The simulator's hotend is cold: with cold extrusion allowed, its steps are those of a hot one.
    let late_hot = of(&seen, &format!("M302 P1\n{moves}"), &heated());
    let steps = |seen: &Seen| seen.recorder.events.iter().map(|event| (event.steps, event.forward)).collect::<Vec<_>>();
    assert_eq!(steps(&seen), steps(&cold));
    println!(
        "{} events; late with heat at most {}, 99 % {} ns; without {}, {} ns",
        late_hot.late.0.len(),
        late_hot.late.max(),
        late_hot.late.quantile(0.99),
        late_cold.late.max(),
        late_cold.late.quantile(0.99),
    );
    assert_eq!((late_hot.inexact, late_hot.stretched, late_cold.inexact), (0, 0, 0));
    assert!(late_hot.late.max() <= late_cold.late.max() + 500, "{} ns", late_hot.late.max());
    assert!(seen.heat.edges.len() > 50);
}

/// Breaks something half a second after the start, in a machine that prints `gcode`; returns the record, and the time
/// of the break.
fn broken(gcode: &str, start: [f64; 2], what: Breakage) -> (Seen, u64) {
    let seen = talk(gcode, Some(start), Some(Mishap { after: 500 * MS, what }));
    let at = seen.heat.broken.expect("it broke");
    (seen, at)
}

fn has_said(seen: &Seen, words: &str) -> bool {
    seen.line.said.iter().any(|line| line.contains(words))
}

/// F01 to F03 at the pin. The supply goes off as well: nothing would show a switch that sticks.
#[test]
fn f01_f02_a_broken_sensor_is_off_at_the_pin_within_half_a_second() {
    let faults: [(Breakage, Heater, &str); 3] = [
        (|faults| faults.hotend_sensor = SensorFault::Open, Heater::Hotend, "hotend: sensor open"),
        (|faults| faults.hotend_sensor = SensorFault::ShortToGround, Heater::Hotend, "hotend: sensor shorted"),
        (|faults| faults.bed_sensor = SensorFault::Open, Heater::Bed, "bed: sensor open"),
    ];
    for (what, heater, words) in faults {
        let (seen, at) = broken("M104 S100\nM140 S60\nG4 S1\n", [60.0, 40.0], what);
        let off = [Output::He0, Output::Bed].map(|output| low_after(&seen, output, at));
        println!("{heater:?}: {words}: {} and {} ms", off[0] / MS, off[1] / MS);
        assert!(off.iter().all(|off| *off <= 500 * MS), "{off:?}");
        assert!(has_said(&seen, words), "{:?}", seen.line.said);
        let [(_, true), (cut, false)] = seen.heat.supply[..] else { panic!("{:?}", seen.heat.supply) };
        assert!(cut - at <= 500 * MS, "{} ms", (cut - at) / MS);
    }
}

/// F10 at the pins: the switch of an unheated hotend conducts. Only the power supply ends that. The guard waits five
/// lags after the last power before it checks; a machine with short lags saves the test ten seconds.
#[test]
fn f10_a_stuck_switch_costs_the_supply_and_all_fans_run() {
    let (seen, hotend) = stuck(heated());
    assert!(hotend < 60.0);
    assert!(seen.heat.edges.is_empty() && has_said(&seen, "gets warmer while switched off"), "{:?}", seen.line.said);
    let fans = seen.heat.samples.last().unwrap().fans;
    assert!(fans.iter().all(|fan| *fan > 0.99), "{fans:?}");
}

/// The machine file names a pin of EXP1 that is high for on. PS-ON is not driven then.
#[test]
fn another_pin_switches_the_supply_if_the_machine_says_so() {
    let mut settings = heated();
    settings.supply = Supply { switch: ConnectorName::lit("PE7"), is_on_high: true };
    let (seen, _) = stuck(settings);
    let [pin, own] = [7, 11].map(|bit| seen.driven[usize::from(b'E' - b'A')] >> bit & 1);
    assert_eq!((pin, own), (1, 0));
}

/// No output is driven if the machine has no switch, and the supply stays on.
#[test]
fn no_pin_switches_the_supply_of_a_machine_without_a_switch() {
    let mut settings = heated();
    settings.supply.switch = ConnectorName::lit("none");
    let seen = print_on(&firmware(), "G4 S1\n", &bench_of(settings));
    assert_eq!(seen.driven[usize::from(b'E' - b'A')] & (1 << 11 | 0b11111 << 7), 0, "no pin of these");
}

/// The switch of an unheated hotend conducts until the supply goes off; and the hotend's temperature then.
fn stuck(mut settings: Settings) -> (Seen, f64) {
    let model = &mut settings.thermal.heaters.hotend.model;
    (model.heater_lag, model.sensor_lag) = (Seconds::lit("0.1"), Seconds::lit("0.1"));
    let mishap = Mishap { after: 1000 * MS, what: |faults| faults.hotend_heater = HeaterFault::STUCK_ON };
    let climate = Climate { start: None, mishap: Some(mishap), ..Climate::default() };
    let seen = print_on(&firmware(), "G4 S6\n", &Bench { climate, ..bench_of(settings) });
    assert!(seen.resets.is_empty() && seen.safety.dangers.is_empty());
    let at = seen.heat.broken.expect("it broke");
    let [(_, true), (off, false)] = seen.heat.supply[..] else { panic!("{:?}", seen.heat.supply) };
    let [hotend, _] = seen.heat.celsius_at(off).unwrap();
    println!("supply off after {} ms at {hotend:.1} C", (off - at) / MS);
    assert!(off - at < 5000 * MS);
    (seen, hotend)
}

/// F15 through the converter of the internal reference, which is not the thermistors'.
#[test]
fn f15_a_bad_reference_is_off() {
    let (seen, at) = broken("M104 S100\nG4 S1\n", [60.0, 25.0], |faults| faults.vdda_volts = 2.8);
    let off = low_after(&seen, Output::He0, at);
    println!("off after {} ms", off / MS);
    assert!(off < 500 * MS && has_said(&seen, "reference voltage"), "{:?}", seen.line.said);
}

/// F17: the chip reads each thermistor by a sequence of its own, and the reference by another converter. So the
/// thermistors alone are off by one place, and their readings jump.
#[test]
fn f17_channels_that_slip_are_off() {
    let (seen, at) = broken("M104 S100\nG4 S1\n", [60.0, 25.0], |faults| faults.channels_slipped = true);
    let off = low_after(&seen, Output::He0, at);
    println!("off after {} ms: {:?}", off / MS, seen.line.said.iter().find(|line| line.starts_with("Error:")));
    assert!(off < 500 * MS, "{:?}", seen.line.said);
}
