//! The needs of eleven printers that owners have published, in configurations of our own, and what holds of each.
//!
//! The table in docs/reference/machines.md (What other printers need) sums up these verdicts.

use super::{read, verdict};
use corehbot_boards::entries;
use corehbot_machine_file::klipper::Kind::{self, Approximated, Decide, NotNeeded, NotYet, Taken};
use corehbot_machine_file::klipper::{Report, translate};
use std::fmt::Write as _;

/// A printer.
struct Printer {
    name: &'static str,
    /// The key of its board.
    board: &'static str,
    kinematics: &'static str,
    /// Each motor's section and its socket.
    motors: &'static [(&'static str, &'static str)],
    /// The rest of its configuration.
    rest: &'static str,
    /// What becomes of the keys that matter: section, key, verdict, words in it.
    needs: &'static [(&'static str, &'static str, Kind, &'static str)],
    /// Whether it is a machine, and how much is left to decide.
    is_machine: bool,
    decisions: usize,
}

/// Axes, switches and limits that no printer here is about.
const REST: &str = "
[printer]
max_velocity: 300
max_accel: 3000
max_z_velocity: 15
max_z_accel: 350
[stepper_x]
position_max: 350
[stepper_y]
position_max: 350
position_endstop: 0
[stepper_z]
position_max: 330
[extruder]
rotation_distance: 4.6
";

/// The configuration of a printer, with the pins of its sockets. Later keys count, so `rest` says what is different.
fn config_of(printer: &Printer) -> String {
    let board = entries().find(|entry| entry.board.connectors.key == printer.board).unwrap().board;
    let mut text = format!("[printer]\nkinematics: {}\n", printer.kinematics);
    for (section, socket) in printer.motors {
        let at = board.connectors.sockets.iter().position(|name| name.as_str() == *socket).unwrap();
        let slot = &board.sockets[at];
        let uart = slot.uart.unwrap();
        let [step, dir, enable, uart] = [slot.step, slot.dir, slot.enable, uart].map(|pin| (pin.port, pin.number()));
        writeln!(
            text,
            "[{section}]\nstep_pin: P{:?}{}\ndir_pin: P{:?}{}\nenable_pin: !P{:?}{}\nmicrosteps: 16\n\
             rotation_distance: 40\n[tmc2209 {section}]\nuart_pin: P{:?}{}\nrun_current: 0.8",
            step.0, step.1, dir.0, dir.1, enable.0, enable.1, uart.0, uart.1
        )
        .unwrap();
    }
    text += REST;
    // The toolhead boards have the extruder.
    if printer.motors.iter().any(|(section, _)| *section == "extruder") {
        let fan = board.fans[0].pin;
        let (heater, sensor) = if printer.board == "spider" { ("PB15", "PC0") } else { ("PA2", "PF4") };
        writeln!(
            text,
            "heater_pin: {heater}\nsensor_pin: {sensor}\nsensor_type: ATC Semitec 104GT-2\ncontrol: watermark\n\
             min_temp: 0\nmax_temp: 270\n[heater_fan hotend]\npin: P{:?}{}",
            fan.port,
            fan.number()
        )
        .unwrap();
    }
    text + printer.rest
}

/// The verdict on a key: its own words, or those on its section.
fn said<'r>(report: &'r Report, section: &str, key: &str) -> (Kind, &'r str) {
    let (kind, words) = verdict(report, section, key);
    let of_section =
        report.sections.iter().find(|known| known.name == section).and_then(|known| known.verdict.as_ref());
    (kind, of_section.filter(|_| words.is_empty()).map_or(words, |verdict| verdict.text.as_str()))
}

const PRINTERS: &[Printer] = &[
    Printer {
        name: "Voron 2.4 of 350 mm: four motors lift a gantry; a pin beside the bed homes Z; steps are not interpolated",
        board: "octopus",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "M0"),
            ("stepper_y", "M1"),
            ("stepper_z", "M2"),
            ("stepper_z1", "M3"),
            ("stepper_z2", "M4"),
            ("stepper_z3", "M5"),
            ("extruder", "M6"),
        ],
        rest: "
[stepper_x]
endstop_pin: PG6
position_endstop: 350
[stepper_y]
endstop_pin: PG9
position_endstop: 350
[stepper_z]
endstop_pin: PG10
position_endstop: -0.5
position_min: -5
[tmc2209 stepper_x]
interpolate: false
[tmc2209 stepper_y]
interpolate: false
[tmc2209 stepper_z]
interpolate: false
[probe]
pin: PG15
[quad_gantry_level]
points: 50,25
[safe_z_home]
home_xy_position: 206,350
",
        needs: &[
            ("tmc2209 stepper_x", "interpolate", Taken, "drivers.belt.interpolate = false"),
            ("tmc2209 stepper_z", "interpolate", Taken, "drivers.z.interpolate = false"),
            ("stepper_z", "position_min", Taken, "axes.z.min = -5"),
            ("stepper_z", "position_endstop", Taken, "homing.z.position = -0.5"),
            ("stepper_z3", "step_pin", Taken, "motors.z3 = \"M5\""),
            ("probe", "pin", Taken, "endstops.probe = \"E3DET\"; probe.kind = \"switch\""),
            ("quad_gantry_level", "points", Taken, "screws.1.point_x = 50"),
            ("safe_z_home", "home_xy_position", Taken, "probe.home.x = 206; probe.home.y = 350"),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "Voron 2.4: the same on a Spider, with its heaters",
        board: "spider",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "X-MOT"),
            ("stepper_y", "Y-MOT"),
            ("stepper_z", "Z-MOT"),
            ("stepper_z1", "E0-MOT"),
            ("stepper_z2", "E1-MOT"),
            ("stepper_z3", "E2-MOT"),
            ("extruder", "E3-MOT"),
        ],
        rest: "
[stepper_x]
endstop_pin: PA1
position_endstop: 350
[stepper_y]
endstop_pin: PA2
position_endstop: 350
[stepper_z]
endstop_pin: PA0
position_endstop: -0.5
[heater_bed]
heater_pin: PB4
sensor_type: Generic 3950
sensor_pin: PC3
control: watermark
min_temp: 0
max_temp: 110
",
        needs: &[
            ("stepper_x", "endstop_pin", Taken, "endstops.x = \"X-MAX\""),
            ("extruder", "heater_pin", Taken, "heaters.hotend.output = \"he0\""),
            ("heater_bed", "heater_pin", Taken, "heaters.bed.output = \"bed\""),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "Voron Trident: three screws level the bed",
        board: "octopus",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "M0"),
            ("stepper_y", "M1"),
            ("stepper_z", "M2"),
            ("stepper_z1", "M3"),
            ("stepper_z2", "M4"),
            ("extruder", "M6"),
        ],
        rest: "
[stepper_x]
endstop_pin: PG6
position_endstop: 350
[stepper_y]
endstop_pin: PG9
position_endstop: 350
[stepper_z]
endstop_pin: PG10
position_endstop: 0
[z_tilt]
z_positions: -50,18
",
        needs: &[
            ("stepper_z2", "step_pin", Taken, "motors.z2 = \"M4\""),
            ("z_tilt", "z_positions", Taken, "screws.1.x = -50; screws.1.y = 18"),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "VzBot 330 with four belt motors: strong drivers, a sensor in the chamber, a filament sensor",
        board: "octopus-pro",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "M3"),
            ("stepper_x1", "M2"),
            ("stepper_y", "M4"),
            ("stepper_y1", "M5"),
            ("stepper_z", "M0"),
            ("extruder", "M1"),
        ],
        rest: "
[stepper_x]
endstop_pin: !PG6
position_endstop: -19
position_min: -19
[stepper_y]
endstop_pin: !PG9
[stepper_z]
endstop_pin: !PG10
position_endstop: 0
[tmc5160 stepper_x]
run_current: 1.75
[temperature_sensor chamber]
sensor_type: Generic 3950
sensor_pin: PF5
[filament_switch_sensor runout]
switch_pin: PG12
",
        needs: &[
            ("stepper_x", "position_min", Taken, "axes.x.min = -19"),
            ("tmc5160 stepper_x", "run_current", NotYet, "another driver than a TMC2209"),
            ("temperature_sensor chamber", "sensor_pin", Taken, "sensors.chamber.sensor = \"hotend1\""),
            ("filament_switch_sensor runout", "switch_pin", Approximated, "endstops.filament = \"E0DET\""),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "VzBot with a toolhead on a CAN bus",
        board: "octopus-pro",
        kinematics: "corexy",
        motors: &[("stepper_x", "M0"), ("stepper_y", "M1"), ("stepper_z", "M2")],
        rest: "
[mcu EBBCan]
canbus_uuid: 0e0d81e4210c
[extruder]
step_pin: EBBCan:PD0
microsteps: 16
heater_pin: EBBCan:PB13
sensor_pin: EBBCan:PA3
sensor_type: PT1000
control: watermark
max_temp: 300
[tmc2209 extruder]
uart_pin: EBBCan:PA15
run_current: 0.6
[stepper_x]
endstop_pin: EBBCan:PB6
position_endstop: 0
[stepper_y]
endstop_pin: PG9
[stepper_z]
endstop_pin: PG10
position_endstop: 0
",
        needs: &[
            ("mcu EBBCan", "canbus_uuid", NotYet, "another board"),
            ("stepper_x", "endstop_pin", Decide, "EBBCan is another board"),
            ("extruder", "step_pin", Decide, "EBBCan is another board"),
            ("extruder", "heater_pin", Decide, "EBBCan is another board"),
            ("extruder", "sensor_pin", Decide, "EBBCan is another board"),
        ],
        is_machine: false,
        decisions: 4,
    },
    Printer {
        name: "VzBot with a scanner on its own line, and a bed that three screws level",
        board: "octopus-pro",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "M0"),
            ("stepper_y", "M1"),
            ("stepper_z", "M2"),
            ("stepper_z1", "M3"),
            ("stepper_z2", "M4"),
            ("extruder", "M6"),
        ],
        rest: "
[stepper_x]
endstop_pin: PG6
position_endstop: 350
[stepper_y]
endstop_pin: PG9
[stepper_z]
endstop_pin: probe:z_virtual_endstop
homing_retract_dist: 0
[beacon]
serial: /dev/serial/by-id/usb-Beacon
[z_tilt]
z_positions: -50,18
",
        needs: &[
            ("beacon", "serial", NotYet, "a scanner"),
            ("stepper_z", "endstop_pin", Decide, "there is no probe at an input"),
            ("stepper_z", "homing_retract_dist", Approximated, "meets its switch twice"),
            ("z_tilt", "z_positions", Taken, "screws.1.x = -50; screws.1.y = 18"),
        ],
        is_machine: false,
        decisions: 1,
    },
    Printer {
        name: "VzBot with a fan at 50 kHz",
        board: "octopus-pro",
        kinematics: "corexy",
        motors: &[("stepper_x", "M0"), ("stepper_y", "M1"), ("stepper_z", "M2"), ("extruder", "M6")],
        rest: "
[stepper_x]
endstop_pin: PG6
position_endstop: 350
[stepper_y]
endstop_pin: PG9
[stepper_z]
endstop_pin: PG10
position_endstop: 0
[fan]
pin: PD12
cycle_time: 0.00002
hardware_pwm: true
",
        needs: &[("fan", "pin", Taken, "fans.fan2"), ("fan", "cycle_time", Taken, "fans.fan2.frequency = 50000")],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "RatRig V-Core 4 hybrid: eight motors, and a switch of X at -59.8",
        board: "octopus-pro",
        kinematics: "hybrid_corexy",
        motors: &[
            ("stepper_x", "M0"),
            ("stepper_x1", "M4"),
            ("stepper_y", "M1"),
            ("stepper_y1", "M3"),
            ("stepper_z", "M5"),
            ("stepper_z1", "M6"),
            ("stepper_z2", "M7"),
            ("extruder", "M2"),
        ],
        rest: "
[stepper_x]
endstop_pin: PG6
position_min: -59.8
position_endstop: -59.8
position_max: 400
homing_positive_dir: false
[stepper_y]
endstop_pin: PG9
[stepper_z]
endstop_pin: PG10
position_endstop: 0
",
        needs: &[
            ("stepper_z2", "step_pin", Taken, "motors.z2 = \"M7\""),
            ("stepper_x", "position_min", Taken, "axes.x.min = -59.8"),
            ("stepper_x", "position_max", Taken, "axes.x.length = 459.8"),
            ("stepper_x", "position_endstop", Taken, "homing.x.position = -59.8"),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "RatRig V-Core 3: a BLTouch homes Z",
        board: "octopus",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "M0"),
            ("stepper_y", "M1"),
            ("stepper_z", "M2"),
            ("stepper_z1", "M3"),
            ("stepper_z2", "M4"),
            ("extruder", "M6"),
        ],
        rest: "
[stepper_x]
endstop_pin: PG6
position_endstop: 0
[stepper_y]
endstop_pin: PG9
position_endstop: 350
[stepper_z]
endstop_pin: probe:z_virtual_endstop
position_min: -5
[bltouch]
sensor_pin: ^PB7
control_pin: PB6
[safe_z_home]
home_xy_position: 150,150
",
        needs: &[
            ("bltouch", "sensor_pin", Taken, "endstops.probe = \"BLTOUCH\"; probe.kind = \"bltouch\""),
            ("bltouch", "control_pin", NotNeeded, "the header BLTOUCH"),
            ("stepper_z", "endstop_pin", Taken, "probe.z_home = true"),
            ("safe_z_home", "home_xy_position", Taken, "probe.home.x = 150"),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "Annex K3: a switch on Z-MAX, seven of eight motors",
        board: "spider",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "X-MOT"),
            ("stepper_x1", "Y-MOT"),
            ("stepper_y", "Z-MOT"),
            ("stepper_y1", "E0-MOT"),
            ("stepper_z", "E1-MOT"),
            ("stepper_z1", "E2-MOT"),
            ("extruder", "E4-MOT"),
        ],
        rest: "
[stepper_x]
endstop_pin: PB14
position_endstop: 0
[stepper_y]
endstop_pin: PB13
[stepper_z]
endstop_pin: PA3
position_endstop: 0
[tmc2209 stepper_z]
hold_current: 0.8
[tmc2209 stepper_z1]
hold_current: 0.6
",
        needs: &[
            ("stepper_y1", "step_pin", Taken, "motors.y1 = \"E0-MOT\""),
            ("stepper_z", "endstop_pin", Taken, "endstops.z = \"Z-MAX\""),
            ("tmc2209 stepper_z", "hold_current", Taken, "drivers.z.hold_percent = 100"),
            ("tmc2209 stepper_z1", "hold_current", Taken, "drivers.z1.hold_percent = 75"),
        ],
        is_machine: true,
        decisions: 0,
    },
    Printer {
        name: "Mercury One.1: a toolhead board that has the probe, too",
        board: "octopus",
        kinematics: "corexy",
        motors: &[
            ("stepper_x", "M0"),
            ("stepper_y", "M1"),
            ("stepper_z", "M5"),
            ("stepper_z1", "M4"),
            ("stepper_z2", "M6"),
        ],
        rest: "
[mcu EBBCan]
canbus_uuid: 0e0d81e4210c
[extruder]
step_pin: EBBCan:PD0
microsteps: 16
[stepper_x]
endstop_pin: EBBCan:PB6
position_endstop: 250
[stepper_y]
endstop_pin: PG9
[stepper_z]
endstop_pin: probe:z_virtual_endstop
[probe]
pin: EBBCan:PB8
",
        needs: &[
            ("stepper_z2", "step_pin", Taken, "motors.z2 = \"M6\""),
            ("stepper_x", "endstop_pin", Decide, "EBBCan is another board"),
            ("stepper_z", "endstop_pin", Decide, "there is no probe at an input"),
            ("extruder", "step_pin", Decide, "EBBCan is another board"),
            ("probe", "pin", NotYet, "EBBCan is another board"),
        ],
        is_machine: false,
        decisions: 4,
    },
];

#[test]
fn each_printers_needs_are_taken_or_told() {
    assert_eq!(PRINTERS.len(), 11);
    let mut wrong = Vec::new();
    for printer in PRINTERS {
        let config = read(&config_of(printer)).unwrap();
        let board = entries().find(|entry| entry.board.connectors.key == printer.board).unwrap().board.connectors;
        let done = translate(&config, Some(board)).unwrap();
        for (section, key, kind, words) in printer.needs {
            let (found, text) = said(&done.report, section, key);
            if found != *kind || !text.contains(words) {
                wrong.push(format!("{}: [{section}] {key}: {found:?}: {text}", printer.name));
            }
        }
        let decisions = done.report.counts().iter().find(|(kind, _)| *kind == Decide).map(|(_, count)| *count);
        if (decisions, done.machine.is_some()) != (Some(printer.decisions), printer.is_machine) {
            wrong.push(format!(
                "{}: {decisions:?} {:?} {}",
                printer.name,
                done.problems,
                done.report.to_string().split("to decide\n").last().unwrap()
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
