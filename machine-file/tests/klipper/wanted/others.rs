//! A RatRig hybrid, a RatRig with a BLTouch, an Annex K3 and a Mercury One.1.

use super::Printer;
use corehbot_machine_file::klipper::Kind::{Decide, NotNeeded, Taken};

pub(super) const OTHERS: &[Printer] = &[
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
position_max: 250
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
            ("stepper_z", "endstop_pin", Taken, "probe.z_home = true"),
            ("extruder", "step_pin", Decide, "EBBCan is another board"),
            (
                "probe",
                "pin",
                Decide,
                "EBBCan is another board, and a machine has one so far: write its input into endstops.probe",
            ),
        ],
        is_machine: false,
        decisions: 4,
    },
];
