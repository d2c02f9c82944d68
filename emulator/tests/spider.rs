//! The Spider heats and prints. Its heaters are on two timers of 16 bits: E0 on TIM12, E1 and the bed on TIM3.

use crate::common::{Bench, MS, bench_of, firmware, heated, print_on};
use crate::steps::{HEATED_PRINT, check_on};
use corehbot::connectors::Output;
use corehbot::settings::{FanRole, Settings};
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::heat_pins::{Climate, Edge, Sample};
use corehbot_emulator::run::Seen;
use corehbot_emulator::trap::{Place, Trap};
use corehbot_emulator::watch::{End, Injection, With};
use corehbot_emulator::wiring::{SPIDER, SPIDER_V1};
use corehbot_machine_file as machine_file;

/// The image on a Spider.
fn image() -> Firmware {
    let mut firmware = firmware();
    firmware.set_board(SPIDER.name).unwrap();
    firmware
}

/// A Spider with a hotend on that output and a bed, which have long been so hot.
fn bench(hotend: Output, start: [f64; 2]) -> Bench<'static> {
    let mut settings: Settings = machine_file::load("board = \"spider\"\n").unwrap();
    settings.thermal = heated().thermal;
    settings.thermal.heaters.hotend.output = hotend;
    let climate = Climate { start: Some(start), mishap: None, ..Climate::default() };
    Bench { wiring: &SPIDER, drivers: DriverLines::new(&SPIDER), climate, ..bench_of(settings) }
}

/// FAN0, FAN1 and FAN2 at a third of full speed, half and full, and at rest. Those of V2.2 on the debug port's pins are
/// only switched.
#[test]
fn fans_blow_on_either_version() {
    for (wiring, third) in [(&SPIDER, [1.0, 1.0, 0.33]), (&SPIDER_V1, [0.33; 3])] {
        let mut firmware = firmware();
        firmware.set_board(wiring.name).unwrap();
        let mut settings: Settings = machine_file::load(&format!("board = \"{}\"\n", wiring.name)).unwrap();
        settings.thermal = heated().thermal;
        for fan in &mut settings.thermal.fans {
            fan.role = FanRole::Commanded;
        }
        let bench = Bench { wiring, drivers: DriverLines::new(wiring), ..bench_of(settings) };
        let gcode: String = ["0", "84", "255", "0"]
            .into_iter()
            .map(|speed| (0..3).map(|fan| format!("M106 P{fan} S{speed}\n")).collect::<String>() + "G4 P1320\n")
            .collect();
        let seen = print_on(&firmware, &gcode, &bench);
        assert_eq!((seen.end, &seen.line.failure, &seen.gaps.found), (End::Done, &None, &vec![]));
        // In the middle of each of the four. The samples are 20 ms apart, so they run through all phases of 98 Hz in
        // half a second.
        let end = seen.virtual_ns;
        let mean = |turn: u64| {
            let at = |sample: &&Sample| {
                (end - 1320 * MS * (4 - turn) + 120 * MS..end - 1320 * MS * (3 - turn) - 60 * MS).contains(&sample.at)
            };
            let samples: Vec<_> = seen.heat.samples.iter().filter(at).collect();
            [0, 1, 2].map(|fan| samples.iter().map(|sample| sample.fans[fan]).sum::<f64>() / samples.len() as f64)
        };
        let means = [0, 1, 2, 3].map(mean);
        println!("{}: {means:?}", wiring.name);
        for (wanted, measured) in [[0.0; 3], third, [1.0; 3], [0.0; 3]].iter().zip(means) {
            for (wanted, measured) in wanted.iter().zip(measured) {
                assert!((wanted - measured).abs() < 0.15, "{}: {means:?}", wiring.name);
            }
        }
    }
}

/// The edges of one pin.
fn edges(seen: &Seen, output: Output) -> Vec<Edge> {
    seen.heat.edges.iter().copied().filter(|edge| edge.output == output).collect()
}

#[test]
fn a_print_that_heats_steps_as_on_the_host() {
    let bench = bench(Output::He0, [198.0, 58.0]);
    let seen = check_on(&image(), &bench, "a heated print on the Spider", HEATED_PRINT);
    let faults: Vec<_> =
        seen.line.said.iter().filter(|line| line.starts_with("Error") || line.contains("halted")).collect();
    assert!(faults.is_empty(), "{faults:?}");
    // Both were on, and both are off at the end; nothing else ever moved.
    for output in [Output::He0, Output::Bed] {
        let edges = edges(&seen, output);
        assert!(edges.len() > 100 && edges.last().is_some_and(|edge| !edge.is_high), "{output:?}");
    }
    assert!(seen.heat.edges.iter().all(|edge| matches!(edge.output, Output::He0 | Output::Bed)));
}

/// Pulses of each output end with the control periods, whatever their length, and no pulse is longer than one.
#[test]
fn no_pulse_lasts_longer_than_a_control_period() {
    let gcode = "M104 S60\nM140 S60\nG4 P1500\nM104 S0\nM140 S0\nG4 P100\n";
    for hotend in [Output::He0, Output::He1] {
        let seen = print_on(&image(), gcode, &bench(hotend, [52.0, 59.9]));
        assert_eq!((seen.end, seen.resets.len(), &seen.line.failure), (End::Done, 0, &None));
        assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
        assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
        for output in [hotend, Output::Bed] {
            let edges = edges(&seen, output);
            let pulses: Vec<_> = edges.chunks(2).map(|pair| pair[1].at - pair[0].at).collect();
            println!("{output:?}: {} pulses, {:?} to {:?} ns", pulses.len(), pulses.iter().min(), pulses.iter().max());
            assert!(edges.chunks(2).all(|pair| pair[0].is_high && !pair[1].is_high), "{output:?}");
            assert!(pulses.len() > 40 && pulses.iter().all(|pulse| *pulse <= 20 * MS), "{output:?}");
            // The bed is slower than the test.
            assert!(
                output == Output::Bed || pulses.iter().any(|pulse| *pulse < 15 * MS),
                "{output:?}: no other length"
            );
        }
    }
}

/// Hotend and bed at full power, until the Console falls into a trap just when their pins have gone high; returns the
/// time of that.
fn fall(hotend: Output, trap: Trap) -> (u64, Seen) {
    let mut firmware = image();
    firmware.lay_in(Place::Console, trap).unwrap();
    let injection = Injection::TrapWhileHot { after: 1500 * MS, with: With::Nothing };
    let bench = Bench { injection: Some(injection), after_reset: 60 * MS, ..bench(hotend, [100.0, 40.0]) };
    let seen = print_on(&firmware, "M104 S200\nM140 S100\nM17\nG4 S60\n", &bench);
    assert_eq!((seen.end, seen.resets.len()), (End::Reset, 1), "{:?}", seen.line.said);
    assert!(seen.safety.dangers.is_empty() && !seen.safety.is_hot() && seen.safety.powered.is_empty());
    (seen.fallen.expect("a fault"), seen)
}

/// The dead man alone: nothing is executed any more but a branch to itself, and no interrupt gets through. The watchdog
/// comes later.
#[test]
fn timers_end_the_pulses_of_a_processor_that_hangs() {
    for hotend in [Output::He0, Output::He1] {
        let (fallen, seen) = fall(hotend, Trap::MaskedHang);
        for output in [hotend, Output::Bed] {
            let edges = edges(&seen, output);
            let last = edges.last().unwrap();
            assert!(edges.iter().rfind(|edge| edge.at <= fallen).is_some_and(|edge| edge.is_high), "{output:?} was on");
            let off = last.at - fallen;
            println!("{output:?} low {off} ns after the hang");
            assert!(!last.is_high && off <= 20 * MS, "{output:?}: {off} ns");
            assert!(last.at + 300 * MS < seen.resets[0].at.0, "the reset came later");
        }
        assert!(seen.line.said.iter().any(|line| line.contains("the watchdog")), "{:?}", seen.line.said);
    }
}

#[test]
fn a_panic_and_a_processor_fault_are_off_at_once_and_told() {
    for (hotend, trap, told) in [
        (Output::He0, Trap::Panic, "a panic, called at 0"),
        (Output::He1, Trap::BadPointer, "a hard fault: CFSR 00000082"),
    ] {
        let (fallen, seen) = fall(hotend, trap);
        for output in [hotend, Output::Bed] {
            let off = edges(&seen, output).last().unwrap().at.saturating_sub(fallen);
            println!("{trap:?}: {output:?} low after {off} ns");
            assert!(off <= 20_000, "{output:?}: {off} ns");
        }
        assert!(seen.line.said.iter().any(|line| line.contains(told)), "{:?}", seen.line.said);
    }
}
