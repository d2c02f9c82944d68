//! The Vorons: gantries and beds that several motors of z lift.

use super::Printer;
use corehbot_machine_file::klipper::Kind::Taken;

pub(super) const VORONS: &[Printer] = &[
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
            ("safe_z_home", "home_xy_position", Taken, "safe_z_home.x = 206; safe_z_home.y = 350"),
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
position_min: -5
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
];
