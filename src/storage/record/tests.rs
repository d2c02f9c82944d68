//! Tests of record.

extern crate std;

use super::*;
use crate::connectors::{ConnectorName, Output, Sensor};
use crate::kinematics::Mechanism;
use crate::settings::rows::{Field, Key, Text24, Value, Visitor};
use crate::settings::{
    Advance, Alignment, Axes, AxisEnd, AxisSettings, Bed, Belt, Cartesian, Control, CornerRule, DriverGroups,
    DriverSettings, Endstop, EndstopPlug, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Heaters,
    HomedAxis, Homing, MachineName, MotorPlug, Pause, Pid, Shaper, ShaperKind, Shapers, ThermalSettings, Thermistor,
    Wiring,
};
use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};
use proptest::prelude::*;
use std::vec::Vec;

#[test]
fn users_read_what_was_found() {
    assert_eq!(std::format!("{}", Receipt { bytes: 241, crc: 0xABC }), "(241 bytes; crc 00000ABC)");
    let format = std::format!("{}", Rejected::Format(3));
    assert_eq!(format, std::format!("format V3, this firmware has V{FORMAT}"));
    let words = [Rejected::Blank, Rejected::Damaged, Rejected::Mechanism].map(|why| std::format!("{why}"));
    assert_eq!(words, ["empty", "damaged", "for a machine with another mechanism"]);
}

/// A whole record around any payload.
fn forge(format: u16, payload: &[u8]) -> Vec<u8> {
    let header = Header { format, length: payload.len() as u16, sequence: 7 }.to_bytes();
    let crc = crc32(header.into_iter().chain(payload.iter().copied()));
    [&header, &crc.to_le_bytes()[..], payload].concat()
}

fn payload(settings: &Settings) -> Vec<u8> {
    let record = encode(settings, &Unknown::NONE, 7).unwrap();
    record.bytes[HEADER..record.receipt.bytes].to_vec()
}

#[test]
fn the_checksum_is_that_of_zip() {
    assert_eq!(crc32(b"123456789".iter().copied()), 0xCBF4_3926);
    assert_eq!(crc32([0; 32].into_iter()), 0x190A_55AD);
}

#[test]
fn a_record_reads_back() {
    let settings = Settings::prototype();
    let record = encode(&settings, &Unknown::NONE, 41).unwrap();
    assert_eq!(length(&record.bytes[..HEADER]), Ok(record.receipt.bytes));
    let decoded = Decoded { settings, unknown: Unknown::NONE, sequence: 41, receipt: record.receipt };
    assert_eq!(decode(&record.bytes), Ok(decoded));
}

/// A record of the settings of `spelled_out`, of release 0.1.0.
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/storage/record/format1.bin");

#[test]
fn a_record_of_the_first_release_reads_back() {
    let decoded = decode(&std::fs::read(FILE).unwrap()).unwrap();
    assert_eq!((decoded.settings, decoded.sequence, decoded.unknown), (spelled_out(), 1, Unknown::NONE));
}

/// If an id or the shape of a value has changed, stored settings would be lost: that must not be. The values are
/// spelled out, so that new defaults do not matter. A later setting has an element more.
#[test]
fn ids_and_values_are_written_as_in_the_first_release() {
    let file = std::fs::read(FILE).unwrap();
    let record = encode(&spelled_out(), &Unknown::NONE, 1).unwrap();
    let bytes = &record.bytes[..record.receipt.bytes];
    let (released, mut written) = (elements(&file[HEADER..]), elements(&bytes[HEADER..]));
    let are_the_same = released.len() == written.len();
    written.retain(|(id, _)| released.iter().any(|(other, _)| other == id));
    assert_eq!(released, written);
    if are_the_same {
        assert_eq!(file, bytes);
    }
}

#[test]
fn records_of_other_formats_are_refused_by_their_number() {
    let settings = payload(&spelled_out());
    for format in [0, 2, 15, 99] {
        assert_eq!(decode(&forge(format, &settings)), Err(Rejected::Format(format)));
    }
}

/// The elements of a payload: their ids, and all of their bytes. Written a second time, as a check.
fn elements(payload: &[u8]) -> Vec<(u16, &[u8])> {
    let (mut elements, mut rest) = (Vec::new(), payload);
    while !rest.is_empty() {
        let (id, head) = if rest[0] < 128 {
            (u16::from(rest[0]), 1)
        } else {
            (u16::from(rest[0] & 127) | u16::from(rest[1]) << 7, 2)
        };
        let length = head + 1 + usize::from(rest[head]);
        elements.push((id, &rest[..length]));
        rest = &rest[length..];
    }
    elements
}

#[test]
fn a_setting_that_a_record_does_not_have_is_at_its_default() {
    let whole = payload(&spelled_out());
    let elements = elements(&whole);
    assert!(elements.len() > 95, "{}", elements.len());
    let default = Settings::prototype();
    for (left_out, _) in &elements {
        let kept: Vec<u8> =
            elements.iter().filter(|(id, _)| id != left_out).flat_map(|(_, bytes)| bytes.iter().copied()).collect();
        let (settings, unknown) = read(&kept).unwrap();
        assert_eq!(unknown, Unknown::NONE);
        // Only that one, of all parts that have it.
        for ((key, value), (_, spelled)) in values(&settings).into_iter().zip(values(&spelled_out())) {
            // The rule for corners has two keys; the other one has a value then.
            let is_left_out = key.row.id == *left_out || [key.row.id, *left_out] == [19, 99];
            let expected = if is_left_out { values_of(&default, key) } else { spelled };
            assert_eq!(value, expected, "{key} without {left_out}");
        }
    }
}

/// Every key with its value.
fn values(settings: &Settings) -> Vec<(Key, Value)> {
    struct All(Vec<(Key, Value)>);
    impl Visitor for All {
        fn visit(&mut self, key: Key, field: &mut dyn Field) {
            self.0.push((key, field.get()));
        }
    }
    let mut all = All(Vec::new());
    settings.clone().visit(&mut all);
    all.0
}

fn values_of(settings: &Settings, key: Key) -> Value {
    // Without its element the rule is the default one, and so its other key has no value.
    values(settings).into_iter().find(|(other, _)| *other == key).unwrap().1
}

#[test]
fn what_later_firmware_has_stored_is_kept_and_known_by_its_ids() {
    let mut later = payload(&spelled_out());
    let (first, second) = ([0xFF, 0x03, 2, 7, 8], [0x80, 0x04, 0]);
    later.splice(0..0, first);
    later.extend(second);
    let decoded = decode(&forge(FORMAT, &later)).unwrap();
    assert_eq!(decoded.settings, spelled_out());
    assert_eq!(decoded.unknown.ids().collect::<Vec<_>>(), [511, 512]);
    // They are in the next record too, behind all others.
    let again = encode(&Settings::prototype(), &decoded.unknown, 8).unwrap();
    let again = &again.bytes[..again.receipt.bytes];
    assert!(again.ends_with(&[&first[..], &second].concat()));
    assert_eq!(decode(again).unwrap().unknown, decoded.unknown);
    // Elements without room are lost, and the rest is kept.
    let mut long = payload(&Settings::prototype());
    long.extend([0xFF, 0x03, 62]);
    long.extend([1; 62]);
    long.extend(second);
    assert_eq!(decode(&forge(FORMAT, &long)).unwrap().unknown.ids().collect::<Vec<_>>(), [512]);
}

#[test]
fn a_machine_with_more_or_fewer_parts_reads_those_that_it_has() {
    let whole = payload(&spelled_out());
    let mut other: Vec<u8> = Vec::new();
    for (id, bytes) in elements(&whole) {
        match id {
            // One motor more than there is, and one fan less.
            96 => {
                other.extend([96, bytes[1] + 3]);
                other.extend(&bytes[2..]);
                other.extend(b"\x02M9");
            }
            93 => {
                // Each takes two bytes.
                other.extend([93, bytes[1] - 2]);
                other.extend(&bytes[2..bytes.len() - 2]);
            }
            _ => other.extend(bytes),
        }
    }
    let (settings, _) = read(&other).unwrap();
    let mut expected = spelled_out();
    expected.thermal.fans[5].kick_ms = Settings::prototype().thermal.fans[5].kick_ms;
    assert_eq!(settings, expected);
}

/// The settings of the first release by name and number. Later ones are at their defaults.
#[allow(clippy::needless_update, reason = "a later setting needs nothing here")]
fn spelled_out() -> Settings {
    let axis = |i: i32| AxisSettings {
        steps_per_mm: StepsPerMm::from_num(100),
        max_speed: MmPerSec::from_num(200 + i),
        max_acceleration: MmPerSec2::from_num(3000 + i),
        length: Mm::from_num(400 + i),
    };
    let homing = Homing { fast: MmPerSec::ONE, slow: MmPerSec::lit("0.5"), back_off: Mm::lit("2.5") };
    let shaper = |kind, hertz| Shaper {
        kind,
        frequency: Hertz::from_num(hertz),
        damping: Ratio::lit("0.05"),
        span: Mm::from_num(800),
        motor_frequency: Hertz::from_num(300),
    };
    let drivers = |i: u16| DriverSettings {
        current_ma: 900 + i,
        hold_percent: 60,
        microsteps: 32,
        stealth: true,
        hybrid_threshold: MmPerSec::from_num(120),
        stall_threshold: 70,
    };
    Settings {
        axes: Axes { x: axis(0), y: axis(1), z: axis(2), e: axis(3) },
        motor_max_speed: MmPerSec::from_num(451),
        motor_max_acceleration: MmPerSec2::from_num(7501),
        print_acceleration: MmPerSec2::from_num(3001),
        retract_acceleration: MmPerSec2::from_num(3002),
        travel_acceleration: MmPerSec2::from_num(5001),
        corner: CornerRule::SquareCorner(MmPerSec::from_num(9)),
        extruder_jerk: MmPerSec::from_num(6),
        min_feed: MmPerSec::ONE,
        min_travel: MmPerSec::ZERO,
        shapers: Shapers { x: shaper(ShaperKind::Mzv, 61), y: shaper(ShaperKind::TwoHumpEi, 42) },
        advance: Advance { time: Seconds::lit("0.06"), window: Some(Seconds::lit("0.03")) },
        homing: Cartesian { x: homing, y: homing, z: homing },
        soft_endstops: true,
        arc_tolerance: Mm::lit("0.005"),
        keepalive_s: 2,
        patience_ms: 700,
        lookahead_time: Seconds::const_from_int(3),
        advanced_ok: true,
        drivers: DriverGroups { belt: drivers(0), z: drivers(1), e: drivers(2) },
        minimum_cruise_ratio: Ratio::lit("0.4"),
        mechanism: Mechanism::corehbot(),
        // The first release stored none.
        motor_names: Settings::prototype().motor_names,
        require_homing: true,
        thermal: heat(),
        wiring: wiring(),
        endstops: endstops(),
        homing_order: [HomedAxis::Z, HomedAxis::X, HomedAxis::Y],
        baud: 115_200,
        bed: Bed { width: Mm::from_num(380), depth: Mm::lit("401.5"), left: Mm::lit("-3.5"), front: Mm::from_num(7) },
        probe: EndstopPlug { connector: ConnectorName::lit("PROBE"), is_normally_open: true },
        belt: Belt {
            is_closed: true,
            settling_ms: 300,
            max_speed: MmPerSec::from_num(90),
            max_acceleration: MmPerSec2::from_num(900),
            homing_advance: Mm::lit("2.5"),
            alignment: Alignment::Required,
            preload: Mm::lit("-0.025"),
            phases: [517, 1023],
            limp_lift: Mm::lit("12.5"),
            ..Settings::prototype().belt
        },
        name: MachineName::new("Spelled out 2.4").unwrap(),
        pause: Pause {
            retract: Mm::lit("1.5"),
            retract_speed: MmPerSec::from_num(40),
            unretract_speed: MmPerSec::from_num(25),
            lift: Mm::from_num(15),
            park: false,
            x: Mm::from_num(-3),
            y: Mm::from_num(410),
            travel_speed: MmPerSec::from_num(150),
            heat_off_min: 20,
            ..Settings::prototype().pause
        },
        ..Settings::prototype()
    }
}

fn endstops() -> Cartesian<Endstop> {
    let x = Endstop { end: AxisEnd::Min, position: Mm::lit("-2.5") };
    let y = Endstop { end: AxisEnd::Max, position: Mm::from_num(405) };
    Cartesian { x, y, z: Endstop { end: AxisEnd::Min, position: Mm::lit("0.25") } }
}

fn wiring() -> Wiring {
    let mut motors = ["P0", "P1", "P2", "P3", "P4", "", "12345678"]
        .map(|name| MotorPlug { connector: ConnectorName::lit(name), is_reversed: false });
    motors[3].is_reversed = true;
    let [x, y, z] = ["S0", "S1", "S2"]
        .map(|name| EndstopPlug { connector: ConnectorName::lit(name), is_normally_open: name == "S1" });
    Wiring { motors, endstops: Cartesian { x, y, z } }
}

#[allow(clippy::needless_update, reason = "a later setting needs nothing here")]
fn heat() -> ThermalSettings {
    let heater = |n: u16, output, sensor, thermistor| HeaterSettings {
        is_fitted: n == 1,
        output,
        sensor,
        thermistor,
        most: Celsius::from_num(100 + n),
        power: Watts::from_num(50 + n),
        max_duty: Ratio::lit("0.75"),
        period_ms: 100 * n,
        control: if n == 1 { Control::Pid } else { Control::Model },
        model: HeaterModel {
            capacity: JoulesPerKelvin::from_num(10 + n),
            loss: WattsPerKelvin::lit("0.25"),
            fan_loss: WattsPerKelvin::lit("0.125"),
            heater_lag: Seconds::from_num(n),
            sensor_lag: Seconds::from_num(2 * n),
        },
        pid: Pid { p: Ratio::from_num(20 + n), i: Ratio::lit("1.5"), d: Ratio::from_num(100) },
        guards: Guards {
            heating: Ratio::lit("0.5"),
            lost: Celsius::from_num(9),
            lost_s: 7,
            off_rise: Celsius::from_num(6),
            overshoot: Celsius::from_num(18),
        },
    };
    let fan = |role| FanSettings { role, kick_ms: 120, least: Ratio::lit("0.25"), most: Ratio::lit("0.5") };
    let commanded = fan(FanRole::Commanded);
    ThermalSettings {
        heaters: Heaters {
            hotend: heater(1, Output::He1, Sensor::Hotend1, Thermistor::PT1000),
            bed: heater(2, Output::Bed, Sensor::Bed, Thermistor::Beta { ohms: 90_000, beta: 3900 }),
            chamber: heater(3, Output::He3, Sensor::Hotend2, Thermistor::Sheet(3)),
        },
        fans: [commanded, fan(FanRole::Hotend), fan(FanRole::Controller), commanded, commanded, commanded],
        min_extrude: Celsius::from_num(160),
        hotend_fan_above: Celsius::from_num(45),
        fan_run_on_s: 90,
        idle_min: 20,
        filament: WattsPerKelvin::lit("0.0078125"),
        ..ThermalSettings::prototype()
    }
}

#[test]
fn the_longest_values_fit() {
    let mut s = Settings::prototype();
    let axis = AxisSettings {
        steps_per_mm: StepsPerMm::MAX,
        max_speed: MmPerSec::MAX,
        max_acceleration: MmPerSec2::MAX,
        length: Mm::MIN,
    };
    (s.axes.x, s.axes.y, s.axes.z, s.axes.e) = (axis, axis, axis, axis);
    let homing = Homing { fast: MmPerSec::MAX, slow: MmPerSec::MAX, back_off: Mm::MIN };
    (s.homing.x, s.homing.y, s.homing.z) = (homing, homing, homing);
    s.corner = CornerRule::JunctionDeviation(Mm::MIN);
    let shaper = Shaper {
        span: Mm::MIN,
        motor_frequency: Hertz::MAX,
        ..Shaper::new(ShaperKind::TwoHumpEi, Hertz::MAX, Ratio::MAX)
    };
    (s.shapers.x, s.shapers.y) = (shaper, shaper);
    s.advance = Advance { time: Seconds::MAX, window: Some(Seconds::MAX) };
    let drivers = DriverSettings {
        current_ma: u16::MAX,
        hold_percent: u8::MAX,
        microsteps: u16::MAX,
        stealth: true,
        hybrid_threshold: MmPerSec::MAX,
        stall_threshold: u8::MAX,
    };
    (s.drivers.belt, s.drivers.z, s.drivers.e) = (drivers, drivers, drivers);
    s.wiring.motors.fill(MotorPlug { connector: ConnectorName::lit("12345678"), is_reversed: true });
    let endstop = EndstopPlug { connector: ConnectorName::lit("12345678"), is_normally_open: true };
    (s.wiring.endstops.x, s.wiring.endstops.y, s.wiring.endstops.z) = (endstop, endstop, endstop);
    let endstop = Endstop { end: AxisEnd::Max, position: Mm::MIN };
    (s.endstops.x, s.endstops.y, s.endstops.z, s.baud) = (endstop, endstop, endstop, u32::MAX);
    s.bed = Bed { width: Mm::MIN, depth: Mm::MIN, left: Mm::MIN, front: Mm::MIN };
    s.probe = EndstopPlug { connector: ConnectorName::lit("12345678"), is_normally_open: true };
    s.belt = Belt {
        is_closed: true,
        settling_ms: u16::MAX,
        max_speed: MmPerSec::MAX,
        max_acceleration: MmPerSec2::MAX,
        homing_advance: Mm::MIN,
        alignment: Alignment::Automatic,
        preload: Mm::MIN,
        phases: [u16::MAX; 2],
        limp_lift: Mm::MIN,
    };
    s.pause = Pause {
        retract: Mm::MIN,
        retract_speed: MmPerSec::MAX,
        unretract_speed: MmPerSec::MAX,
        lift: Mm::MIN,
        park: true,
        x: Mm::MIN,
        y: Mm::MIN,
        travel_speed: MmPerSec::MAX,
        heat_off_min: u8::MAX,
    };
    for acceleration in [
        &mut s.motor_max_acceleration,
        &mut s.print_acceleration,
        &mut s.retract_acceleration,
        &mut s.travel_acceleration,
    ] {
        *acceleration = MmPerSec2::MAX;
    }
    for speed in [&mut s.motor_max_speed, &mut s.extruder_jerk, &mut s.min_feed, &mut s.min_travel] {
        *speed = MmPerSec::MAX;
    }
    (s.arc_tolerance, s.lookahead_time, s.minimum_cruise_ratio) = (Mm::MIN, Seconds::MAX, Ratio::MAX);
    (s.keepalive_s, s.patience_ms) = (u8::MAX, u16::MAX);
    s.thermal = hottest();
    // All names as long as they may be, and each number as great as it may be.
    let name = Value::Text(Text24::try_from("1234").unwrap());
    assert!(s.motor_names.iter_mut().all(|motor| motor.set(&name)));
    s.visit(&mut Clamp);
    let longest = encode(&s, &Unknown::NONE, u32::MAX).unwrap().receipt.bytes - HEADER;
    assert!(longest <= LONGEST - HEADER, "{longest}");
    let legal = rows_longest_legal();
    assert!((legal..=legal * 5 / 4).contains(&LONGEST_PAYLOAD), "{legal}, reckoned with {LONGEST_PAYLOAD}");
}

/// Makes numbers legal.
struct Clamp;

impl Visitor for Clamp {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        if let Value::Number(number) = field.get() {
            let legal = key.row.legal(key.part.into());
            assert!(field.set(&Value::Number(number.clamp(legal.least, legal.most))), "{key}");
        }
    }
}

/// Bytes of a payload in which every value is the longest that is legal.
fn rows_longest_legal() -> usize {
    struct Greatest;
    impl Visitor for Greatest {
        fn visit(&mut self, key: Key, field: &mut dyn Field) {
            let legal = key.row.legal(key.part.into());
            let longest = match field.get() {
                Value::Text(_) => Value::Text(std::iter::repeat_n('M', legal.most as usize).collect()),
                _ => Value::Number(if -legal.least > legal.most { legal.least } else { legal.most }),
            };
            // A number of a field that packs several may be no legal one: then it is as long as another one.
            let _ = field.set(&longest);
        }
    }
    let mut s = Settings::prototype();
    s.visit(&mut Greatest);
    let mut bytes = [0; 2 * LONGEST];
    write(&s, &Unknown::NONE, &mut bytes).unwrap()
}

/// Heat settings with numbers that take the most bytes.
fn hottest() -> ThermalSettings {
    let heater = HeaterSettings {
        thermistor: Thermistor::Beta { ohms: u32::MAX, beta: u16::MAX },
        most: Celsius::MIN,
        power: Watts::MAX,
        max_duty: Ratio::MAX,
        period_ms: u16::MAX,
        model: HeaterModel {
            capacity: JoulesPerKelvin::MAX,
            loss: WattsPerKelvin::MAX,
            fan_loss: WattsPerKelvin::MAX,
            heater_lag: Seconds::MAX,
            sensor_lag: Seconds::MAX,
        },
        pid: Pid { p: Ratio::MAX, i: Ratio::MAX, d: Ratio::MAX },
        guards: Guards {
            heating: Ratio::MAX,
            lost: Celsius::MIN,
            lost_s: u8::MAX,
            off_rise: Celsius::MIN,
            overshoot: Celsius::MIN,
        },
        ..heat().heaters.bed
    };
    let fan = FanSettings { role: FanRole::Controller, kick_ms: u16::MAX, least: Ratio::MAX, most: Ratio::MAX };
    ThermalSettings {
        heaters: Heaters { hotend: heater, bed: heater, chamber: heater },
        fans: heat().fans.map(|_| fan),
        min_extrude: Celsius::MIN,
        hotend_fan_above: Celsius::MIN,
        fan_run_on_s: u16::MAX,
        idle_min: u8::MAX,
        filament: WattsPerKelvin::MAX,
    }
}

#[test]
fn a_damaged_format_is_no_other_format() {
    let mut record = forge(FORMAT, &payload(&Settings::prototype()));
    assert!(decode(&record).is_ok());
    record[4] ^= 2;
    assert_eq!(decode(&record), Err(Rejected::Damaged));
}

#[test]
fn values_that_are_illegal_today_are_rejected() {
    let mut s = Settings::prototype();
    s.axes.x.steps_per_mm = StepsPerMm::from_num(160);
    let record = forge(FORMAT, &payload(&s));
    assert_eq!(decode(&record), Err(Rejected::Illegal(SettingsError::ResolutionsDiffer("x and y"))));
    let mut s = Settings::prototype();
    s.drivers.z.microsteps = 32;
    assert!(decode(&forge(FORMAT, &payload(&s))).is_ok());
    (s.mechanism.rows[1], s.axes.z.steps_per_mm) = ([-1, -1, 1, 0], s.axes.x.steps_per_mm);
    let record = decode(&forge(FORMAT, &payload(&s)));
    assert!(matches!(record, Err(Rejected::Illegal(SettingsError::MicrostepsDiffer { .. }))), "{record:?}");
}

#[test]
fn a_payload_that_is_cut_or_has_a_value_of_another_type_is_rejected() {
    let whole = payload(&Settings::prototype());
    let damaged = |bytes: &[u8]| assert_eq!(decode(&forge(FORMAT, bytes)), Err(Rejected::Damaged), "{bytes:?}");
    damaged(&whole[..whole.len() - 1]);
    damaged(&[whole.clone(), [0xFF].to_vec()].concat());
    // A switch that is 2, an unknown choice, an illegal name, a speed of 64 bits.
    for element in [&[11, 1, 4][..], &[58, 1, 40], &[1, 3, 2, b'a', b':'], &[2, 6, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 1]] {
        damaged(element);
    }
    // An empty one has no value.
    let empty = [&[2, 0][..], &whole].concat();
    assert!(decode(&forge(FORMAT, &empty)).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// The result for any content of a record with a right checksum: legal settings or none.
    #[test]
    fn any_payload_is_legal_or_rejected(
        format in FORMAT - 1..=FORMAT,
        bytes in proptest::collection::vec(any::<u8>(), 0..LONGEST - HEADER),
    ) {
        if let Ok(Decoded { settings, .. }) = decode(&forge(format, &bytes)) {
            prop_assert_eq!(settings.check(), Ok(()));
        }
    }

    /// The same with payloads that are nearly settings.
    #[test]
    fn a_changed_payload_is_legal_or_rejected(
        changes in proptest::collection::vec((any::<usize>(), any::<u8>()), 1..9),
    ) {
        let mut bytes = std::fs::read(FILE).unwrap().split_off(HEADER);
        for (at, value) in changes {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        if let Ok(Decoded { settings, .. }) = decode(&forge(FORMAT, &bytes)) {
            prop_assert_eq!(settings.check(), Ok(()));
        }
    }

    #[test]
    fn any_bytes_are_no_settings(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        let _ = length(&bytes);
        prop_assert!(decode(&bytes).is_err());
    }
}
