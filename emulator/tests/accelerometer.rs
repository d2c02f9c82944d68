//! The accelerometer on the image: its registers, its samples, and a sensor that is not there.

use crate::common::{Bench, bench_of, firmware, print_on};
use crate::steps::check_on;
use corehbot::accelerometer::SensorKind;
use corehbot::settings::Settings;
use corehbot_emulator::compare::scheduled;
use corehbot_emulator::run::Seen;
use corehbot_emulator::sensor::Sensor;
use corehbot_emulator::watch::End;

fn machine(kind: Option<SensorKind>) -> Settings {
    let mut settings = Settings::prototype();
    settings.accelerometer.kind = kind;
    settings
}

fn sensor(kind: SensorKind, change: impl FnOnce(&mut Sensor)) -> Sensor {
    let mut sensor = Sensor::new(kind);
    change(&mut sensor);
    sensor
}

fn talk_with(sensor: Sensor, kind: SensorKind, gcode: &str) -> Seen {
    let bench = Bench { sensor: Some(sensor), ..bench_of(machine(Some(kind))) };
    let seen = print_on(&firmware(), gcode, &bench);
    assert_eq!((seen.end, &seen.line.failure, seen.resets.len()), (End::Done, &None, 0), "{:?}", seen.line.said);
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    seen
}

fn has(seen: &Seen, text: &str) -> bool {
    seen.line.said.iter().any(|line| line.contains(text))
}

/// The registers of R1, each read back, in their order; then the sensor is stopped.
#[test]
fn either_sensor_is_set_up_as_its_data_sheet_has_it() {
    let adxl = vec![[0x2D, 0], [0x31, 0x0B], [0x38, 0], [0x2C, 0x0F], [0x38, 0x90], [0x2D, 8], [0x2D, 0]];
    let lis = vec![[0x20, 0], [0x21, 6], [0x25, 0x34], [0x2E, 0], [0x2E, 0xC0], [0x20, 0x94], [0x20, 0]];
    for (kind, rate, written) in [(SensorKind::Adxl345, 3200.0, adxl), (SensorKind::Lis2dw12, 1600.0, lis)] {
        let seen = talk_with(Sensor::new(kind), kind, "M955\n");
        let sensor = seen.sensor.as_ref().unwrap();
        assert_eq!(sensor.written, written, "{kind:?}");
        let told = seen.line.said.iter().find_map(|line| line.strip_prefix("Accelerometer 0: ")).expect("an answer");
        let (name, rest) = told.split_once(", rate ").unwrap();
        let told: f64 = rest.split(',').next().unwrap().parse().unwrap();
        assert!(name == kind.name() && (told / (rate * sensor.clock) - 1.0).abs() < 0.005, "{told}");
        // A second and some ms of samples: none was lost, and what was not fetched came behind the last look.
        let [made, fetched, lost] = sensor.samples;
        assert!(made > rate as u64 && made - fetched < 20 && lost == 0, "{:?}", sensor.samples);
    }
}

#[test]
fn a_sensor_that_is_not_there_or_another_is_named() {
    for id in [0x00, 0xFF, 0x72, 0xF2, 0x79] {
        let sensor = sensor(SensorKind::Adxl345, |sensor| sensor.identity = id);
        let seen = talk_with(sensor, SensorKind::Adxl345, "M955\n");
        assert!(has(&seen, &format!("no ADXL345: its identity reads {id:#04x}")), "{:?}", seen.line.said);
        assert_eq!(seen.sensor.unwrap().written.len(), 1, "stopped, and nothing else");
    }
    let late = sensor(SensorKind::Adxl345, |sensor| sensor.deaf_readings = 3);
    assert!(has(&talk_with(late, SensorKind::Adxl345, "M955\n"), "Accelerometer 0: ADXL345"));
    let dead = sensor(SensorKind::Adxl345, |sensor| sensor.dead = Some(0x2C));
    assert!(has(&talk_with(dead, SensorKind::Adxl345, "M955\n"), "a register does not keep its value"));
    let seen = print_on(&firmware(), "M955\n", &bench_of(machine(Some(SensorKind::Lis2dw12))));
    assert!(has(&seen, "no LIS2DW12: its identity reads"), "{:?}", seen.line.said);
}

/// No pin of the connector is driven before a sensor was asked for.
#[test]
fn a_machine_without_a_sensor_leaves_the_pins_alone() {
    let seen = print_on(&firmware(), "M955\nG4 P100\n", &bench_of(machine(None)));
    assert!(has(&seen, "no accelerometer configured"), "{:?}", seen.line.said);
    assert_eq!((seen.driven[0] >> 15 & 1, seen.driven[1] >> 3 & 7), (0, 0));
}

/// From the first pulse over every turn to rest, and back to where the tool was: at the frequencies of long ways and,
/// on a diagonal, at those of short ones. The sensor is heard all the time. Both take 10 s, because a frequency grows
/// by 2 Hz a second at most.
#[test]
fn whole_sweeps_step_as_on_the_host() {
    const BEFORE: &str = "G28 X Y\nG0 X60 Y60 F12000\n";
    const SWEEPS: &str = "TEST_RESONANCES AXIS=X FREQ_START=5 FREQ_END=20 HZ_PER_SEC=2\n\
                          TEST_RESONANCES AXIS=B FREQ_START=130 FREQ_END=135 HZ_PER_SEC=2\n";
    let bench =
        Bench { sensor: Some(Sensor::new(SensorKind::Adxl345)), ..bench_of(machine(Some(SensorKind::Adxl345))) };
    let seen = check_on(&firmware(), &bench, "two sweeps", &format!("{BEFORE}{SWEEPS}M114\n"));
    let before = scheduled(BEFORE, &bench.settings).unwrap().len();
    let swept = seen.recorder.events.len() - before;
    assert!(swept > 50_000, "{swept} events");
    for axis in ["X", "B"] {
        assert!(has(&seen, &format!("resonance {axis}: ")), "{:?}", seen.line.said);
    }
    assert!(has(&seen, "X:60.00 Y:60.00 "), "{:?}", seen.line.said);
    let [made, fetched, lost] = seen.sensor.as_ref().unwrap().samples;
    // A second of noise before each sweep.
    assert!(made > 12 * 3200 && fetched > 12 * 3200 && lost == 0, "{made} {fetched} {lost}");
}
