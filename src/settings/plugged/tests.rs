//! Tests of plugged.

extern crate std;

use super::*;
use crate::accelerometer::SensorKind;
use crate::connectors::samples::{BENCH, OTHER, PRINTER};
use crate::kinematics::Mechanism;
use crate::motors::{Motor, prototype};
use crate::settings::{Tachometer, Wiring};
use std::format;
use std::string::{String, ToString};

const INPUTS: &str = "BLTOUCH, E0DET, E1DET, E2DET, E3DET, PROBE, X-STOP, Y-STOP, Z-STOP, Z2-STOP";

fn error(settings: &Settings, board: &'static BoardConnectors) -> String {
    settings.check_connectors(board).unwrap_err().to_string()
}

fn plugged(motor: Motor, name: &str) -> Settings {
    let mut s = Settings::prototype();
    s.wiring.motors[motor.index()].connector = ConnectorName::lit(name);
    s
}

#[test]
fn the_prototype_has_plugs_of_its_own() {
    let s = Settings::prototype();
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    assert_eq!(s.check_connectors(&BoardConnectors::ANY), Ok(()));
    let names = Motor::ALL.map(|motor| s.wiring.of(motor).connector.to_string());
    assert_eq!(names[..prototype::COUNT], ["M0", "M1", "M4", "M3", "M2", "M5", "M6"]);
    assert!(names[prototype::COUNT..].iter().all(|name| name.is_empty()));
    assert_eq!(s.wiring.endstops.z.connector.as_str(), "Z-STOP");
    assert!(s.wiring.motors.iter().all(|plug| !plug.is_reversed) && !s.wiring.endstops.x.is_normally_open);
}

#[test]
fn a_machine_that_names_no_connectors_is_plugged_in_as_usual_on_its_board() {
    let mut s = Settings::prototype();
    assert!(s.check_connectors(&OTHER).is_err());
    s.name_connectors(&OTHER);
    assert_eq!(s.check_connectors(&OTHER), Ok(()));
    assert_eq!(s.wiring.of(prototype::M1).connector.as_str(), "X-MOT");
    let mut named = plugged(prototype::M1, "M7");
    named.name_connectors(&OTHER);
    assert_eq!(named.wiring.of(prototype::M1).connector.as_str(), "M7", "what is named stays");
}

#[test]
fn a_board_has_no_other_connectors_than_its_own() {
    let has = "it has M0, M1, M2, M3, M4, M5, M6, M7";
    assert_eq!(
        error(&plugged(prototype::M1, "M8"), &PRINTER),
        format!("motor m1: the sample has no connector M8; {has}")
    );
    assert_eq!(plugged(prototype::M1, "M8").check_connectors(&BoardConnectors::ANY), Ok(()), "the simulator has any");
    let mut s = Settings::prototype();
    s.wiring.endstops.y.connector = ConnectorName::lit("J27");
    let has = format!("it has {INPUTS}");
    assert_eq!(error(&s, &PRINTER), format!("endstop of y: the sample has no connector J27; {has}"));
    s.thermal.heaters.hotend.is_fitted = true;
    s.wiring = Wiring::usual(&PRINTER);
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    s.thermal.heaters.hotend.output = Output::He2;
    assert_eq!(error(&s, &PRINTER), "heater hotend: the sample has no output he2; it has bed, he0, he1");
    s.thermal.heaters.hotend.output = Output::He1;
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    s.wiring = Wiring::usual(&BENCH);
    assert_eq!(error(&s, &BENCH), "heater hotend: the rig has no output he1; it has none");
}

#[test]
fn a_board_without_that_sensor_is_refused() {
    const NO_SENSORS: BoardConnectors = BoardConnectors { sensors: &[Sensor::Bed], ..PRINTER };
    let mut s = Settings::prototype();
    s.thermal.heaters.hotend.is_fitted = true;
    assert_eq!(error(&s, &NO_SENSORS), "heater hotend: the sample has no sensor hotend0; it has bed");
}

#[test]
fn nothing_is_plugged_in_twice() {
    assert_eq!(error(&plugged(prototype::E0, "M4"), &PRINTER), "motor m8 and motor e0 have the same connector, M4");
    assert_eq!(
        error(&plugged(prototype::E0, "M4"), &BoardConnectors::ANY),
        "motor m8 and motor e0 have the same connector, M4"
    );
    let mut s = Settings::prototype();
    s.wiring.endstops.z.connector = s.wiring.endstops.x.connector;
    assert_eq!(error(&s, &PRINTER), "endstop of x and endstop of z have the same connector, X-STOP");
}

#[test]
fn a_probe_with_a_kind_has_an_input_and_a_bltouch_a_servo() {
    let probe = |kind, name, board| {
        let mut s = Settings::prototype();
        s.wiring = Wiring::usual(board);
        (s.probe.kind, s.probe_plug.connector) = (kind, ConnectorName::lit(name));
        s
    };
    for kind in [ProbeKind::Switch, ProbeKind::BlTouch, ProbeKind::Nozzle] {
        assert_eq!(probe(kind, "BLTOUCH", &PRINTER).check_connectors(&PRINTER), Ok(()));
        let told = error(&probe(kind, "", &PRINTER), &PRINTER);
        assert!(told.starts_with("probe: it has no connector; the sample has BLTOUCH, "), "{told}");
    }
    assert_eq!(probe(ProbeKind::Switch, "X-MAX", &OTHER).check_connectors(&OTHER), Ok(()));
    let told = error(&probe(ProbeKind::BlTouch, "X-MAX", &OTHER), &OTHER);
    assert_eq!(told, "probe: the other has no servo line for a bltouch");
}

#[test]
fn an_accelerometer_needs_a_connector_of_its_own() {
    let mut s = Settings::prototype();
    s.accelerometer.kind = Some(SensorKind::Lis2dw12);
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    s.wiring = Wiring::usual(&OTHER);
    assert_eq!(error(&s, &OTHER), "accelerometer: the other has no connector for one");
    s.accelerometer.kind = None;
    assert_eq!(s.check_connectors(&OTHER), Ok(()));
}

#[test]
fn a_probe_is_plugged_in_at_any_input_or_not_at_all() {
    let probe = |name| {
        let mut s = Settings::prototype();
        s.probe_plug.connector = ConnectorName::lit(name);
        s
    };
    for name in ["", "PROBE", "BLTOUCH", "E3DET"] {
        assert_eq!(probe(name).check_connectors(&PRINTER), Ok(()), "{name}");
    }
    let error_of = |name, board| error(&probe(name), board);
    assert_eq!(error_of("Z-MAX", &PRINTER), format!("probe: the sample has no connector Z-MAX; it has {INPUTS}"));
    for board in [&PRINTER, &BoardConnectors::ANY] {
        assert_eq!(error_of("Z-STOP", board), "endstop of z and probe have the same connector, Z-STOP");
    }
}

#[test]
fn a_filament_sensor_is_plugged_in_at_an_input_of_its_own() {
    let mut s = Settings::prototype();
    s.filament.connector = ConnectorName::lit("E0DET");
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    s.probe_plug.connector = ConnectorName::lit("E0DET");
    assert_eq!(error(&s, &PRINTER), "probe and filament sensor have the same connector, E0DET");
    s.filament.connector = ConnectorName::lit("FIL");
    assert_eq!(error(&s, &PRINTER), format!("filament sensor: the sample has no connector FIL; it has {INPUTS}"));
}

#[test]
fn a_tachometer_has_an_input_of_its_own() {
    let mut s = Settings::prototype();
    s.fans[2].tachometer = Tachometer::at("E0DET").unwrap();
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    s.fans[4].tachometer = Tachometer::at("E0DET").unwrap();
    for board in [&PRINTER, &BoardConnectors::ANY] {
        assert_eq!(error(&s, board), "tachometer of fan2 and tachometer of fan4 have the same connector, E0DET");
    }
    s.fans[4].tachometer = Tachometer::at("X-STOP").unwrap();
    assert_eq!(error(&s, &PRINTER), "endstop of x and tachometer of fan4 have the same connector, X-STOP");
    s.fans[4].tachometer = Tachometer::at("X-MIN").unwrap();
    assert_eq!(error(&s, &PRINTER), format!("tachometer of fan4: the sample has no connector X-MIN; it has {INPUTS}"));
    assert_eq!(Tachometer::at("FAN"), None);
}

#[test]
fn fans_of_one_timer_have_one_frequency() {
    let with = |frequencies: [u16; FANS]| {
        let mut s = Settings::prototype();
        s.fans.iter_mut().zip(frequencies).for_each(|(fan, hz)| fan.frequency = hz);
        s
    };
    for (frequencies, have) in [
        ([0; FANS], [0; FANS]),
        ([25_000, 98, 0, 1000, 0, 0], [25_000, 98, 1000, 1000, 1000, 0]),
        ([0, 0, 200, 0, 200, 0], [0, 0, 200, 200, 200, 0]),
    ] {
        let s = with(frequencies);
        assert_eq!((s.check_connectors(&PRINTER), s.fan_frequencies(&PRINTER)), (Ok(()), have));
    }
    assert_eq!(error(&with([0, 0, 200, 0, 201, 0]), &PRINTER), "fan4: another fan on its timer has 200 Hz");
    let fixed = "fan5: the sample fixes its frequency";
    assert_eq!(error(&with([0, 0, 0, 0, 0, 98]), &PRINTER), fixed);
    const FEW: BoardConnectors = BoardConnectors { fans: &[Some(1)], ..PRINTER };
    assert_eq!(error(&with([0, 98, 0, 0, 0, 0]), &FEW), "fan1: the sample has no such fan");
    let mut s = with([98, 0, 0, 0, 0, 0]);
    assert_eq!(s.check_connectors(&FEW), Ok(()));
    s.fans[3].tachometer = Tachometer::at("E0DET").unwrap();
    assert_eq!(error(&s, &FEW), "fan3: the sample has no such fan");
}

#[test]
fn two_connectors_of_one_line_are_one() {
    for (z, probe) in [("PROBE", "BLTOUCH"), ("BLTOUCH", "PROBE")] {
        let mut s = Settings::prototype();
        s.wiring.endstops.z.connector = ConnectorName::lit(z);
        assert_eq!(s.check_connectors(&PRINTER), Ok(()), "a switch may be at either");
        s.probe_plug.connector = ConnectorName::lit(probe);
        assert_eq!(
            error(&s, &PRINTER),
            format!("endstop of z and probe cannot both be used: {z} and {probe} are one line to the processor")
        );
    }
}

#[test]
fn what_is_fitted_is_plugged_in_and_what_is_not_need_not_be() {
    let has = "the sample has M0, M1, M2, M3, M4, M5, M6, M7";
    assert_eq!(error(&plugged(prototype::Z2, ""), &PRINTER), format!("motor z2: it has no connector; {has}"));
    let mut s = plugged(prototype::Z2, "");
    s.mechanism = Mechanism { rows: s.mechanism.rows.map(|row| if row == [0, 0, 1, 0] { [0; 4] } else { row }) };
    s.mechanism.rows[prototype::Z1.index()] = [0, 0, 1, 0];
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    // A motor that is not fitted takes no socket from another.
    s.wiring.motors[prototype::Z2.index()].connector = ConnectorName::lit("M0");
    assert_eq!(s.check_connectors(&PRINTER), Ok(()));
    s.wiring.endstops.x.connector = ConnectorName::NONE;
    assert_eq!(error(&s, &PRINTER), format!("endstop of x: it has no connector; the sample has {INPUTS}"));
}

#[test]
fn a_bench_has_sockets_for_some() {
    let s = Settings { wiring: Wiring::usual(&BENCH), ..Settings::prototype() };
    assert_eq!(s.check_connectors(&BENCH), Ok(()));
    assert_eq!([prototype::M8, prototype::Z1].map(|motor| s.wiring.of(motor).connector.to_string()), ["A", ""]);
    assert_eq!(error(&s, &PRINTER), "motor m1: the sample has no connector X; it has M0, M1, M2, M3, M4, M5, M6, M7");
}

/// The prototype's "auto" is legal on every board; a named output must be there.
#[test]
fn the_supply_is_switched_by_an_output_of_the_board_or_by_none() {
    let with = |name| {
        let mut s = Settings::prototype();
        s.supply.switch = ConnectorName::lit(name);
        s
    };
    for name in ["auto", "none", "", "PE7"] {
        assert_eq!(with(name).check_connectors(&PRINTER), Ok(()), "{name}");
    }
    assert_eq!(error(&with("PE3"), &PRINTER), "power supply: the sample has no connector PE3; it has PE7, PS-ON");
    let mut other = with("PS-ON");
    other.name_connectors(&OTHER);
    assert_eq!(error(&other, &OTHER), "power supply: the other has no connector PS-ON; it has PC9");
    assert_eq!(with("PE3").check_connectors(&BoardConnectors::ANY), Ok(()));
}
