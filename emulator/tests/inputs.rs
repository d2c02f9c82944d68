//! The image reads the true levels of its inputs.

use crate::common::{Bench, MS, firmware, plain_firmware, print_on};
use corehbot_emulator::board::CHIP_CELSIUS;
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::{End, Injection};
use corehbot_emulator::wiring::{ALL, Pin, ROOM};
use corehbot_machine_file as machine_file;

/// The reference in mV.
const REFERENCE: u32 = 3300;

/// A reading of 12 bits in units of the answer. The model's full scale is 4095 of them, where the chip's is 4096.
const STEP: i64 = 16;

fn talk(firmware: &Firmware, gcode: &str, thermistors: &[(u8, u32)], stuck: Option<(Pin, bool)>) -> Seen {
    let seen = print_on(firmware, gcode, &Bench { thermistors, stuck, ..Bench::default() });
    assert_eq!((seen.end, seen.resets.len()), (End::Done, 0));
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    seen
}

/// Everything that M122 said of a sensor, in 1/65,536 of the reference.
fn shares(seen: &Seen, sensor: &str) -> Vec<Option<i64>> {
    let begin = format!("echo:sensor {sensor} ");
    let said = seen.line.said.iter().filter_map(|line| line.strip_prefix(&begin));
    said.map(|value| value.strip_suffix("/65536").map(|value| value.parse().unwrap())).collect()
}

#[test]
fn every_thermistor_is_read_on_its_own_pin() {
    // TB, TH0 to TH3: IN9, IN14, IN15, IN4, IN5.
    let inputs =
        [("bed", 9, 3152), ("hotend0", 14, 1650), ("hotend1", 15, 220), ("hotend2", 4, 0), ("hotend3", 5, 3300)];
    let seen = talk(&firmware(), "M122\nM122\n", &inputs.map(|(_, channel, millivolts)| (channel, millivolts)), None);
    for (sensor, _, millivolts) in inputs {
        let wanted = i64::from(millivolts) * 65_536 / i64::from(REFERENCE);
        let read = shares(&seen, sensor);
        println!("{sensor}: {millivolts} mV is {wanted}, read {read:?}");
        assert_eq!(read.len(), 2);
        assert!(
            read.iter().all(|share| (wanted - 2 * STEP..=wanted).contains(&share.unwrap())),
            "{sensor}: {wanted}, {read:?}"
        );
    }
    // Open and shorted ones are beyond all that a thermistor does: 4085 of 4095 at -25 C, 85 at 350 C.
    assert!(shares(&seen, "hotend3")[0] > Some(4085 * STEP) && shares(&seen, "hotend2")[0] < Some(20 * STEP));
}

/// Without temperatures no heater may run, and a converter does not restart by itself: the watchdog is not fed any
/// more.
#[test]
fn a_converter_that_has_stopped_ends_in_a_reset_and_is_told() {
    /// ADC3_CR2 (RM0390 rev 6, section 2.2.2 and 13.13.3).
    const CR2: u64 = 0x4001_2208;
    // M122 asks the drivers first, which takes less than a second.
    let stop = Injection::Poke { after: 2000 * MS, address: CR2, value: 0 };
    let bench = Bench { injection: Some(stop), ..Bench::default() };
    let seen = print_on(&firmware(), "M122\nG4 P3000\nM122\n", &bench);
    assert_eq!((seen.end, seen.resets.len()), (End::Reset, 1), "{:?}", seen.line.said);
    assert!(matches!(shares(&seen, "bed")[..], [Some(_)]), "{:?}", seen.line.said);
    // The watchdog's 500 counts of 1 kHz after the last control period that had readings.
    let after = seen.resets[0].at.0 - seen.injected.expect("a fault");
    assert!((480 * MS..560 * MS).contains(&after), "{} ms", after / MS);
    assert!(seen.safety.dangers.is_empty() && !seen.safety.is_hot());
    let told = seen.line.said.iter().find(|line| line.contains("the last reset came after")).expect("the cause");
    println!("{told}");
}

/// Sensors without a heater on TH1 and TH2: by voltage, open and shorted. None of them stops the machine, whose heaters
/// are others.
#[test]
fn a_sensor_without_a_heater_is_reported_and_stops_nothing() {
    let sensor = |place, input| format!("[sensors.{place}]\nis_fitted = true\nsensor = \"{input}\"\n");
    let file = sensor("chamber", "hotend1") + &sensor("board", "hotend2");
    let mut machine = machine_file::load(&file).unwrap();
    let mut firmware = plain_firmware();
    firmware.put_machine(&mut machine).unwrap();
    // 100 kOhm under 4.7 kOhm at 25 C; its table has 1770 Ohm at 150 C.
    let warm = REFERENCE * 1770 / (1770 + 4700);
    for (chamber, board, words) in [
        (ROOM, warm, [" C:25.", " M:150."]),
        (REFERENCE, 0, [" C:open", " M:short"]),
        (0, REFERENCE, [" C:short", " M:open"]),
    ] {
        let seen = talk(&firmware, "M105\nG4 P700\nM105\nM122\n", &[(15, chamber), (4, board)], None);
        let temperatures: Vec<_> = seen.line.said.iter().filter(|line| line.starts_with("ok T")).collect();
        assert_eq!(temperatures.len(), 2);
        assert!(words.iter().all(|word| temperatures[1].contains(word)), "{temperatures:?}");
        assert!(seen.line.said.iter().any(|line| line == "echo:fault: none"), "{:?}", seen.line.said);
    }
}

/// The processor's own sensor: by the converter's injected channel and the factory's words.
#[test]
fn the_processors_own_temperature_is_reported() {
    let mut machine = machine_file::load("[sensors.board]\nis_fitted = true\nsensor = \"mcu\"\n").unwrap();
    let mut firmware = plain_firmware();
    firmware.put_machine(&mut machine).unwrap();
    let seen = talk(&firmware, "G4 P100\nM105\nM122\n", &[], None);
    let told = seen.line.said.iter().find_map(|line| line.split_once(" M:")?.1.split_once(' '));
    let (celsius, rest) = told.expect("a temperature of the board");
    // A step of the sensor is 0.3 K, and the model's voltage is a whole number of mV.
    assert!((celsius.parse::<f64>().unwrap() - f64::from(CHIP_CELSIUS)).abs() < 0.8, "{celsius}");
    assert!(rest.starts_with("/0.00"), "{rest}");
    assert!(seen.line.said.iter().any(|line| line.starts_with("echo:board ") && line.ends_with(" C")));
}

/// A machine without a probe has no line of it.
#[test]
fn a_machine_without_a_probe_reports_none() {
    let seen = talk(&firmware(), "M119\n", &[], Some((Pin::new('B', 7), true)));
    assert!(seen.line.said.iter().all(|line| !line.starts_with("z_probe")), "{:?}", seen.line.said);
}

/// Filament that presses the switch of its sensor is Marlin's TRIGGERED, whether the switch opens or closes then.
#[test]
fn filament_in_its_sensor_is_reported() {
    let pin = Pin::new('G', 12);
    for (plug, level, words) in [
        ("", None, None),
        ("E0DET", None, Some("filament: TRIGGERED")),
        ("E0DET", Some((pin, false)), Some("filament: open")),
        ("!E0DET", None, Some("filament: open")),
        ("!E0DET", Some((pin, false)), Some("filament: TRIGGERED")),
    ] {
        let mut machine = machine_file::load(&format!("[endstops]\nfilament = \"{plug}\"")).unwrap();
        let mut firmware = plain_firmware();
        firmware.put_machine(&mut machine).unwrap();
        let seen = talk(&firmware, "G4 P100\nM119\n", &[], level);
        let told = seen.line.said.iter().find(|line| line.starts_with("filament"));
        assert_eq!(told.map(String::as_str), words, "{plug} {level:?}");
    }
}

/// The contact of a probe closes and opens at each connector that may have one and has no resistor of the board: by the
/// resistor of the chip the image reads both. A pin with the wrong one, or without, would read one level for ever.
///
/// Reproducer: PROBE was pulled up, and its optocoupler only ever pulls up.
#[test]
fn a_probe_is_read_at_every_connector_by_its_circuit() {
    for board in ALL.into_iter().filter(|board| !board.bare_inputs.is_empty()) {
        for &(name, pin, circuit) in board.bare_inputs {
            for (mark, opens) in [("", true), ("!", false)] {
                let file = format!("board = \"{}\"\n[endstops]\nprobe = \"{mark}{name}\"", board.name);
                let mut machine = machine_file::load(&file).unwrap();
                let mut firmware = plain_firmware();
                firmware.set_board(board.name).unwrap();
                firmware.put_machine(&mut machine).unwrap();
                for is_closed in [true, false] {
                    let stuck = circuit.level(is_closed).map(|level| (pin, level));
                    let bench = Bench { wiring: board, stuck, ..Bench::default() };
                    let seen = print_on(&firmware, "M119\n", &bench);
                    let told = seen.line.said.iter().find(|line| line.starts_with("z_probe"));
                    let wanted = if opens == is_closed { "z_probe: open" } else { "z_probe: TRIGGERED" };
                    let at = format!("{} {mark}{name}, closed: {is_closed}", board.name);
                    assert_eq!(told.map(String::as_str), Some(wanted), "{at}");
                }
            }
        }
    }
}
