//! The VzBots: four belt motors, toolheads and sensors on lines of their own.

use super::Printer;
use corehbot_machine_file::klipper::Kind::{Approximated, Decide, NotYet, Taken};

pub(super) const VZBOTS: &[Printer] = &[
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
            ("stepper_z", "endstop_pin", Decide, "there is no probe with a contact"),
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
];
