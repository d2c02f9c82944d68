//! The longest record: its values take the most bytes, and it fits.

extern crate std;

use super::spelled_out::heat;
use super::{content_of_payload, record_of};
use crate::connectors::{ConnectorName, Heater};
use crate::settings::rows::{Field, Key, Legal, Text24, Value, Visitor};
use crate::settings::{
    Advance, Alignment, AxisEnd, AxisSettings, Bed, Belt, Cartesian, CornerRule, DriverSettings, EXTRA_SENSORS,
    Endstop, EndstopPlug, ExtraSensor, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Heaters, Homing,
    MotorPlug, OwnDriver, Pause, Pid, SensorSource, Settings, Shaper, ShaperKind, ThermalSettings, Thermistor,
};
use crate::storage::payload::{LONGEST_PAYLOAD, MOST_UNKNOWN, Unknown, write};
use crate::storage::record::{HEADER, LONGEST, ROOM};
use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};

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
    s.axis_min = Cartesian { x: Mm::MIN, y: Mm::MIN, z: Mm::MIN };
    let homing = Homing { fast: MmPerSec::MAX, slow: MmPerSec::MAX, back_off: Mm::MIN, offset: Mm::MIN };
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
        interpolate: true,
        hybrid_threshold: MmPerSec::MAX,
        stall_threshold: u8::MAX,
    };
    (s.drivers.belt, s.drivers.z, s.drivers.e) = (drivers, drivers, drivers);
    s.drivers.own.fill(OwnDriver { current_ma: u16::MAX, hold_percent: u8::MAX, stall_threshold: u8::MAX });
    s.wiring.motors.fill(MotorPlug { connector: ConnectorName::lit("12345678"), is_reversed: true });
    let endstop = EndstopPlug { connector: ConnectorName::lit("12345678"), is_normally_open: true };
    (s.wiring.endstops.x, s.wiring.endstops.y, s.wiring.endstops.z) = (endstop, endstop, endstop);
    let endstop = Endstop { end: AxisEnd::Max, position: Mm::MIN };
    (s.endstops.x, s.endstops.y, s.endstops.z, s.baud) = (endstop, endstop, endstop, u32::MAX);
    s.bed = Bed { width: Mm::MIN, depth: Mm::MIN, left: Mm::MIN, front: Mm::MIN, z_offset: Mm::MIN };
    s.filament = EndstopPlug { connector: ConnectorName::lit("12345678"), is_normally_open: true };
    s.probe_plug = EndstopPlug { connector: ConnectorName::lit("12345678"), is_normally_open: true };
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
    for speed in [&mut s.motor_max_speed, &mut s.z_jerk, &mut s.extruder_jerk, &mut s.min_feed, &mut s.min_travel] {
        *speed = MmPerSec::MAX;
    }
    (s.arc_tolerance, s.lookahead_time, s.minimum_cruise_ratio) = (Mm::MIN, Seconds::MAX, Ratio::MAX);
    (s.keepalive_s, s.patience_ms) = (u8::MAX, u16::MAX);
    s.thermal = hottest();
    // All names as long as they may be, and each number as great as it may be.
    let name = Value::Text(Text24::try_from("1234").unwrap());
    assert!(s.motor_names.iter_mut().all(|motor| motor.set(&name)));
    s.visit(&mut Clamp);
    let longest = record_of(&s, &Unknown::NONE, u32::MAX).1.bytes - HEADER;
    // Reckoned are the keys of both rules for corners, of which one has a value: six bytes.
    let legal = rows_longest_legal();
    assert_eq!(legal + 6 + MOST_UNKNOWN, LONGEST_PAYLOAD);
    assert!(longest <= legal, "{longest}");
}

#[test]
fn the_document_says_how_many_bytes_are_free() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/explanation/flow.md");
    let free = std::format!("**{} bytes are free**", ROOM - LONGEST_PAYLOAD);
    assert!(std::fs::read_to_string(path).unwrap().contains(&free), "{free}");
}

/// A record has a sign only for types that have one. So the greatest value of a type without a sign, and negative
/// values of all others, are what it is.
#[test]
fn the_least_the_greatest_and_negative_numbers_read_back() {
    let ways: [fn(&Legal) -> i64; 4] = [|legal| legal.least, |legal| legal.most, |legal| legal.least.min(-1), |_| -1];
    let mut negative = [0; 4];
    for (way, negative) in ways.into_iter().zip(&mut negative) {
        let mut settings = Settings::prototype();
        let mut put = Put { way, negative: 0 };
        settings.visit(&mut put);
        *negative = put.negative;
        let mut bytes = [0; LONGEST];
        let length = write(&settings, &Unknown::NONE, &mut bytes).unwrap();
        assert_eq!(content_of_payload(&bytes[..length]), Ok((settings, Unknown::NONE)));
    }
    // Places of the screws and of their points, of the bed, the probe, the endstops, the axes and the pause.
    let [least, most, ..] = negative;
    assert!(least >= 35 && most == 0, "{negative:?}");
}

/// Puts one number into each field that takes it.
struct Put {
    way: fn(&Legal) -> i64,
    negative: usize,
}

impl Visitor for Put {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        if let Value::Number(_) = field.get() {
            let legal = key.row.legal(key.part.into());
            let number = (self.way)(&legal);
            if (legal.is_signed || number >= 0) && field.set(&Value::Number(number)) {
                self.negative += usize::from(number < 0);
            }
        }
    }
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
            let text = |first| Value::Text([first].into_iter().chain(['M'; 23]).take(legal.most as usize).collect());
            let longest = match field.get() {
                Value::Text(_) => text('M'),
                _ => Value::Number(if -legal.least > legal.most { legal.least } else { legal.most }),
            };
            // A plug is longest with its mark.
            assert!(field.set(&longest) || field.set(&text('!')), "{key}");
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
        thermistor: Thermistor::Beta { ohms: u32::MAX, beta: u16::MAX, cubic: 0 },
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
            ptc: Ratio::MAX,
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
    let sensor = ExtraSensor {
        is_fitted: true,
        sensor: SensorSource::Mcu,
        thermistor: Thermistor::Beta { ohms: u32::MAX, beta: u16::MAX, cubic: 0 },
        guards: Some(Heater::Chamber),
        most: Celsius::MIN,
    };
    ThermalSettings {
        heaters: Heaters { hotend: heater, bed: heater, chamber: heater },
        sensors: [sensor; EXTRA_SENSORS],
        fans: heat().fans.map(|_| fan),
        min_extrude: Celsius::MIN,
        hotend_fan_above: Celsius::MIN,
        fan_run_on_s: u16::MAX,
        idle_min: u8::MAX,
        filament: WattsPerKelvin::MAX,
    }
}
