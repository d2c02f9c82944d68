//! The pins of the image show the same steps as the host simulator.

use crate::common::{Bench, MS, firmware, from_home, heated_bench, print, print_on, root};
use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot_emulator::compare::{difference, scheduled, timing};
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::heat_pins::Climate;
use corehbot_emulator::run::Seen;
use corehbot_emulator::steps::StepEvent;
use corehbot_emulator::watch::End;
use std::path::{Path, PathBuf};

/// Edges are no later than this: the bound for 100,000 events a second.
const LATE_NS: i64 = 5000;

fn check_file(path: &Path) {
    check_gcode(&path.file_name().unwrap().display().to_string(), &std::fs::read_to_string(path).unwrap());
}

fn check_gcode(name: &str, gcode: &str) -> Seen {
    check_on(&firmware(), &Bench::default(), name, gcode)
}

/// Prints on a board, and checks all that the pins show.
pub fn check_on(firmware: &Firmware, bench: &Bench<'_>, name: &str, gcode: &str) -> Seen {
    let seen = print_on(firmware, gcode, bench);
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{name}");
    assert!(seen.resets.is_empty() && seen.line.resends == 0, "{name}");
    seen.check_baud(250_000).unwrap();
    let pins = &seen.recorder.events;
    let host = scheduled(gcode, &bench.settings).unwrap();
    if let Some(difference) = difference(pins, &host) {
        panic!("{name}: {difference}");
    }
    let timing = timing(pins, &host);
    println!(
        "{name}: {} events, late {} to {} ns (50 %: {}, 90 %: {}, 99 %: {}, 99.9 %: {}), image {}",
        pins.len(),
        timing.late.quantile(0.0),
        timing.late.max(),
        timing.late.quantile(0.5),
        timing.late.quantile(0.9),
        timing.late.quantile(0.99),
        timing.late.quantile(0.999),
        firmware.sha256
    );
    assert_eq!(timing.inexact, 0, "{name}: scheduled ticks");
    assert_eq!(timing.stretched, 0, "{name}");
    assert!(timing.late.quantile(0.0) >= 0 && timing.late.max() <= LATE_NS, "{name}: lateness");
    assert_eq!((seen.recorder.split_pairs, seen.recorder.unpowered), (0, 0), "{name}");
    assert_eq!(seen.slow_accesses, 0, "{name}: the step interrupt waits for a bus");
    // TMC2209 datasheet rev 1.09, section 13.1: 100 ns high and low, 20 ns from dir to step.
    let pulse = seen.recorder.pulse;
    assert!(pulse.high >= 100 && pulse.low >= 100 && pulse.set_up >= 20, "{name}: {pulse:?}");
    assert!(seen.safety.dangers.is_empty(), "{name}: {:?}", seen.safety.dangers);
    assert!(seen.gaps.found.is_empty(), "{name}: {:?}", seen.gaps.found);
    assert_eq!(seen.laps.out_of_step, 0, "{name}: the firmware's time");
    for line in seen.drivers.iter() {
        assert_eq!(line.chip.microsteps(), 16, "{name}");
        assert_eq!((line.collisions, line.floating), (0, 0), "{name}: firmware and driver on one wire");
    }
    seen
}

/// Once, a motion that had met its endstop was computed to its end and discarded, event by event, by contexts that hold
/// off the Console. For Z that took half a second, and the watchdog reset the chip.
#[test]
fn homing_steps_as_on_the_host() {
    check_file(&example("home"));
}

fn example(name: &str) -> PathBuf {
    root().join("examples").join(name).with_extension("gcode")
}

/// Prints examples one after the other.
fn check_in_a_row(names: &[&str]) {
    let gcode: Vec<_> = names.iter().map(|name| from_home(&example(name))).collect();
    check_gcode(&names.join(", "), &gcode.join("\nG21\nG90\nM82\nG92 E0\n"));
}

#[test]
fn curves_and_fine_moves_step_as_on_the_host() {
    check_in_a_row(&["circle", "axes", "reversals", "retractions", "tiny"]);
}

#[test]
fn the_other_examples_step_as_on_the_host() {
    check_in_a_row(&["diagonal", "dwell", "overrides", "relative", "z-hops", "inches"]);
}

/// The belt runs round: motors of a pair step each for itself then, and the pins take other words and the usual ones
/// again.
#[test]
fn a_belt_runs_round_as_on_the_host() {
    let seen = check_gcode("circulation", &from_home(&example("circulation")));
    let alone =
        seen.recorder.events.iter().filter(|event| event.steps.has(prototype::M11) && !event.steps.has(prototype::M4));
    assert!(alone.count() > 1000, "pairs are parted while the belt runs round");
    let position = seen.line.said.iter().rfind(|line| line.starts_with("X:")).unwrap();
    assert!(position.starts_with("X:40.00 Y:40.00 Z:2.00 E:0.00 C:0.00 "), "{position}");
}

/// A file is printed so far. `cargo xtask equal` prints the whole of it.
const LINES: usize = 300;

/// A motor of the belt without the other of its pair or without its neighbour, a screw on a slow step pin, and the
/// extruder. No motor steps without power, and in the end all of them have it.
#[test]
fn one_motor_alone_steps_as_on_the_host() {
    let buzzes = ["m1", "m4 FREE=m8", "z2", "e0"].map(|motor| format!("STEPPER_BUZZ STEPPER={motor}\n"));
    let seen = check_gcode("one motor alone", &format!("{}M17\n", buzzes.concat()));
    // Five times to and fro, at 80, 80, 800 and 400 steps/mm.
    assert_eq!(seen.recorder.events.len(), 10 * (80 + 80 + 800 + 400));
}

/// A typical print. The sliced file is not part of the project; without it an example is printed.
#[test]
fn a_print_steps_as_on_the_host() {
    let sliced = root().join("../shared/gcode/prusaslicer292_cubehelix_small.gcode");
    let path = if sliced.is_file() { sliced } else { example("first-print") };
    println!("the begin of {}", path.display());
    let gcode: String = from_home(&path).split_inclusive('\n').take(LINES).collect();
    check_gcode(&path.file_name().unwrap().display().to_string(), &gcode);
}

/// As slicers have it: heat, home, print, and leave all off.
pub const HEATED_PRINT: &str = "M140 S60\nM104 S200\nG28\nG90\nM83\nM190 S60\nM109 S200\nG92 E0\nG0 X20 Y10 Z0.2 F9000\nM106 S255\n\
    G1 X35 Y10 E1 F3600\nG2 X45 Y20 I0 J10 E1\nG1 X20 Y15 E1\nG1 E-1 F2400\nM107\nM104 S0\nM140 S0\nG28 X Y\nM84\n";

/// The last `count` events: how many ticks before the end, and which motors step which way.
fn tail(events: &[StepEvent], count: usize) -> Vec<(u32, MotorSet, MotorSet)> {
    let tick = |event: &StepEvent| event.schedule.unwrap().tick();
    let end = tick(events.last().unwrap());
    let last = &events[events.len() - count..];
    last.iter().map(|event| (end.wrapping_sub(tick(event)), event.steps, event.forward)).collect()
}

/// The second print finds heaters that have been used, motors without power and a machine that was homed. From the end
/// of its first homing on, which begins elsewhere, it steps as the first one did.
#[test]
fn a_print_that_heats_steps_the_same_twice_as_on_the_host() {
    let climate = Climate { start: Some([198.0, 58.0]), mishap: None, ..Climate::default() };
    let bench = Bench { climate, ..heated_bench() };
    let seen = check_on(&firmware(), &bench, "a heated print twice", &HEATED_PRINT.repeat(2));
    let length = |gcode: &str| scheduled(gcode, &bench.settings).unwrap().len();
    let (once, homing) = (length(HEATED_PRINT), length("G28\n"));
    let count = once - homing;
    assert!(count > 1000, "{count} events after the homing");
    let twice = &seen.recorder.events;
    assert!(tail(twice, count) == tail(&twice[..once], count), "the second print steps otherwise");
    let faults: Vec<_> =
        seen.line.said.iter().filter(|line| line.starts_with("Error") || line.contains("halted")).collect();
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!(seen.heat.supply.len(), 1, "{:?}", seen.heat.supply);
}

/// All drivers are monitored meanwhile: neither disturbs the other.
#[test]
fn a_hundred_thousand_events_a_second_are_in_time_while_drivers_are_watched() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rush.gcode");
    let rush = std::fs::read_to_string(&path).unwrap();
    // Homing ends two motions at the endstop: there the step interrupt holds ticks off for many bits, and an exchange
    // is repeated.
    let gcode = format!("G28 X\n{rush}M122\n");
    let host = scheduled(&gcode, &Settings::prototype()).unwrap();
    // 10 ms of motion time.
    let most = host.windows(1000).map(|w| w[999].tick - w[0].tick).min();
    println!("1000 events in {most:?} ticks");
    assert!(most.is_some_and(|ticks| ticks < 100_000));
    let seen = check_gcode("rush", &gcode);
    for line in seen.drivers.iter() {
        println!("{:?} datagrams and replies, edges {} ns off", line.datagrams, line.jitter);
        assert!(line.datagrams[0] > 50, "{:?}", line.datagrams);
    }
    let failed = |line: &String| line.split_once(" failed exchanges")?.0.rsplit(' ').next()?.parse::<u32>().ok();
    let failed: Vec<u32> = seen.line.said.iter().filter_map(failed).collect();
    println!("failed exchanges: {failed:?}");
    assert_eq!(failed.len(), prototype::COUNT, "{:?}", seen.line.said);
    assert!(failed.iter().sum::<u32>() <= 2, "{failed:?}");
}

#[test]
fn two_runs_are_the_same_to_the_nanosecond() {
    let gcode = "G92 X0 Y0 Z0\nG1 X60 Y60 F12000\nG2 X60 Y60 I10 J0\n";
    let (a, b) = (print(&firmware(), gcode, None), print(&firmware(), gcode, None));
    assert_eq!(a.recorder.events, b.recorder.events);
    assert_eq!((a.virtual_ns, a.instructions), (b.virtual_ns, b.instructions));
    assert!(a.virtual_ns > 1000 * MS);
}
