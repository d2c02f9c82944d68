//! The settings of the first release, by name and number.

use crate::connectors::{ConnectorName, Output, Sensor};
use crate::kinematics::Mechanism;
use crate::settings::{
    Advance, Alignment, Axes, AxisEnd, AxisSettings, Bed, Belt, Cartesian, Control, CornerRule, DriverGroups,
    DriverSettings, Endstop, EndstopPlug, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Heaters,
    HomedAxis, Homing, MachineName, MotorPlug, Pause, Pid, Settings, Shaper, ShaperKind, Shapers, ThermalSettings,
    Thermistor, Wiring,
};
use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};

/// The settings of the first release by name and number. Later ones are at their defaults.
#[allow(clippy::needless_update, reason = "a later setting needs nothing here")]
pub fn spelled_out() -> Settings {
    let axis = |i: i32| AxisSettings {
        steps_per_mm: StepsPerMm::from_num(100),
        max_speed: MmPerSec::from_num(200 + i),
        max_acceleration: MmPerSec2::from_num(3000 + i),
        length: Mm::from_num(400 + i),
    };
    let homing = Homing { fast: MmPerSec::ONE, slow: MmPerSec::lit("0.5"), back_off: Mm::lit("2.5"), offset: Mm::ZERO };
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
        interpolate: true,
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
        z_jerk: MmPerSec::from_num(3000),
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
        drivers: DriverGroups { belt: drivers(0), z: drivers(1), e: drivers(2), own: Default::default() },
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
        bed: Bed {
            width: Mm::from_num(380),
            depth: Mm::lit("401.5"),
            left: Mm::lit("-3.5"),
            front: Mm::from_num(7),
            z_offset: Mm::ZERO,
        },
        probe_plug: EndstopPlug { connector: ConnectorName::lit("PROBE"), is_normally_open: true },
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
    let mut motors = Settings::prototype().wiring.motors;
    for (plug, name) in motors.iter_mut().zip(["P0", "P1", "P2", "P3", "P4", "", "12345678"]) {
        *plug = MotorPlug { connector: ConnectorName::lit(name), is_reversed: name == "P3" };
    }
    let [x, y, z] = ["S0", "S1", "S2"]
        .map(|name| EndstopPlug { connector: ConnectorName::lit(name), is_normally_open: name == "S1" });
    Wiring { motors, endstops: Cartesian { x, y, z } }
}

#[allow(clippy::needless_update, reason = "a later setting needs nothing here")]
pub fn heat() -> ThermalSettings {
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
            ptc: Ratio::ZERO,
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
            bed: heater(2, Output::Bed, Sensor::Bed, Thermistor::Beta { ohms: 90_000, beta: 3900, cubic: 0 }),
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
