//! Configurations that are made at random: every section that becomes a part of a machine, on an Octopus.

use std::fmt::Write as _;

/// A source of random numbers (Marsaglia's xorshift), the same on every machine.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Whether something comes that comes `part` times of four.
    fn comes(&mut self, part: u64) -> bool {
        self.next() % 4 < part
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.next() as usize % of.len()]
    }

    /// A number between two, in hundredths.
    fn between(&mut self, least: f64, most: f64) -> f64 {
        let steps = ((most - least) * 100.0).round() as u64 + 1;
        ((least * 100.0).round() + (self.next() % steps) as f64) / 100.0
    }
}

/// The configuration of a seed.
pub(super) struct Made {
    dice: Dice,
    text: String,
}

/// Sockets: step, direction, enable, UART.
const SOCKETS: [[&str; 4]; 5] = [
    ["PF13", "PF12", "PF14", "PC4"],
    ["PG0", "PG1", "PF15", "PD11"],
    ["PF11", "PG3", "PG5", "PC6"],
    ["PG4", "PC1", "PA0", "PC7"],
    ["PF9", "PF10", "PG2", "PF2"],
];

impl Made {
    pub fn new(seed: u64) -> Self {
        Self { dice: Dice(0x9E37_79B9_7F4A_7C15 ^ (seed + 1).wrapping_mul(0xD134_2543_DE82_EF95)), text: String::new() }
    }

    fn section(&mut self, name: &str) {
        writeln!(self.text, "[{name}]").unwrap();
    }

    fn must(&mut self, key: &str, value: impl std::fmt::Display) {
        writeln!(self.text, "{key}: {value}").unwrap();
    }

    /// A key that is there three times of four.
    fn number(&mut self, key: &str, least: f64, most: f64) {
        let value = self.dice.between(least, most);
        if self.dice.comes(3) {
            self.must(key, value);
        }
    }

    fn word(&mut self, key: &str, of: &[&str]) {
        let value = self.dice.one(of);
        if self.dice.comes(3) {
            self.must(key, value);
        }
    }

    pub fn text(mut self) -> String {
        self.printer();
        let has_probe = self.dice.comes(2);
        for (number, name) in ["stepper_x", "stepper_y", "stepper_z", "stepper_z1"].into_iter().enumerate() {
            self.stepper(name, number, has_probe);
        }
        self.extruder();
        self.heater("heater_bed", "PA1", "PF3");
        self.fans();
        if has_probe {
            self.probe();
        }
        self.levelling(has_probe);
        self.others();
        self.text
    }

    fn printer(&mut self) {
        self.section("printer");
        let kinematics = self.dice.one(&["cartesian", "corexy"]);
        self.must("kinematics", kinematics);
        let (speed, acceleration) = (self.dice.between(100.0, 400.0), self.dice.between(500.0, 9000.0));
        self.must("max_velocity", speed);
        self.must("max_accel", acceleration);
        self.number("max_z_velocity", 5.0, 30.0);
        self.number("max_z_accel", 50.0, 400.0);
        self.number("square_corner_velocity", 1.0, 12.0);
        self.number("minimum_cruise_ratio", 0.0, 0.9);
    }

    fn stepper(&mut self, name: &str, number: usize, has_probe: bool) {
        let [step, dir, enable, uart] = SOCKETS[number];
        self.section(name);
        self.must("step_pin", step);
        let sign = self.dice.one(&["", "!"]);
        self.must("dir_pin", format!("{sign}{dir}"));
        self.must("enable_pin", format!("!{enable}"));
        // Motors of an axis, and of a group, have one resolution.
        self.must("rotation_distance", if number < 2 { 40 } else { 8 });
        self.must("microsteps", if number < 2 { 16 } else { 32 });
        if number < 3 {
            let axis = number;
            let least = self.dice.one(&[-60.0, -5.5, 0.0, 3.0]);
            let has_least = self.dice.comes(2);
            if has_least {
                self.must("position_min", least);
            }
            let most = self.dice.between(180.0, 400.0);
            self.must("position_max", most);
            let at_top = self.dice.comes(2);
            let from = if has_least { least } else { 0.0 };
            if axis == 2 && has_probe {
                self.must("endstop_pin", "probe:z_virtual_endstop");
            } else {
                let sign = self.dice.one(&["", "^", "!", "^!"]);
                self.must("endstop_pin", format!("{sign}{}", ["PG6", "PG9", "PG10"][axis]));
                self.must("position_endstop", if at_top { most } else { from });
            }
            self.number("homing_speed", 2.0, 60.0);
            self.number("second_homing_speed", 1.0, 10.0);
            self.number("homing_retract_dist", 1.0, 10.0);
        }
        self.driver(name, uart, if number < 2 { 0.8 } else { 0.65 });
    }

    fn driver(&mut self, name: &str, uart: &str, current: f64) {
        self.section(&format!("tmc2209 {name}"));
        self.must("uart_pin", uart);
        self.must("run_current", current);
        self.word("interpolate", if name.ends_with(['x', 'y']) { &["False"] } else { &["True"] });
        self.number("stealthchop_threshold", 1.0, 200.0);
        self.word("driver_SGTHRS", &["10", "60", "200"]);
        let hold = self.dice.comes(2);
        if hold {
            let part = self.dice.one(&[2.0, 4.0]);
            self.must("hold_current", current / part);
        }
    }

    fn extruder(&mut self) {
        let [step, dir, enable, uart] = SOCKETS[4];
        self.section("extruder");
        self.must("step_pin", step);
        self.must("dir_pin", dir);
        self.must("enable_pin", format!("!{enable}"));
        self.number("rotation_distance", 20.0, 24.0);
        if !self.text.ends_with("rotation_distance: 22\n") {
            self.must("rotation_distance", 22.5);
        }
        self.word("gear_ratio", &["50:10", "80:20, 2:1", "7.5:1"]);
        self.word("full_steps_per_rotation", &["400"]);
        self.must("microsteps", 16);
        self.must("nozzle_diameter", "0.4");
        self.must("filament_diameter", "1.75");
        self.number("min_extrude_temp", 0.0, 200.0);
        self.number("pressure_advance", 0.0, 0.3);
        self.number("pressure_advance_smooth_time", 0.01, 0.2);
        self.number("max_extrude_only_distance", 20.0, 500.0);
        self.number("max_extrude_only_velocity", 20.0, 120.0);
        self.number("max_extrude_only_accel", 500.0, 5000.0);
        self.number("instantaneous_corner_velocity", 1.0, 5.0);
        self.of_heater("PA2", "PF4");
        self.driver("extruder", uart, 0.5);
    }

    fn heater(&mut self, name: &str, output: &str, sensor: &str) {
        self.section(name);
        self.of_heater(output, sensor);
    }

    fn of_heater(&mut self, output: &str, sensor: &str) {
        self.must("heater_pin", output);
        self.must("sensor_pin", sensor);
        const TYPES: [&str; 8] = [
            "ATC Semitec 104GT-2",
            "ATC Semitec 104NT-4-R025H42G",
            "Generic 3950",
            "SliceEngineering 450",
            "PT1000",
            "EPCOS 100K B57560G104F",
            "Honeywell 100K 135-104LAG-J01",
            "own",
        ];
        let kind = self.dice.one(&TYPES);
        self.must("sensor_type", kind);
        let control = self.dice.one(&["pid", "watermark"]);
        self.must("control", control);
        if control == "pid" {
            for (key, most) in [("pid_Kp", 60.0), ("pid_Ki", 3.0), ("pid_Kd", 900.0)] {
                let value = self.dice.between(0.5, most);
                self.must(key, value);
            }
        }
        self.must("min_temp", 0);
        let most = self.dice.between(60.0, 140.0);
        self.must("max_temp", most);
        self.number("max_power", 0.2, 1.0);
    }

    fn fans(&mut self) {
        for (name, pin, parts) in [
            ("fan", "PA8", &["max_power", "kick_start_time", "off_below"][..]),
            ("heater_fan hotend", "PE5", &["max_power", "fan_speed", "heater_temp", "kick_start_time"]),
            ("heater_fan bed", "PD12", &["fan_speed", "heater_temp", "of_bed"]),
            ("controller_fan board", "PD13", &["fan_speed", "idle_timeout"]),
            ("fan_generic lid", "PD14", &["max_power", "off_below"]),
        ] {
            if !self.dice.comes(3) {
                continue;
            }
            self.section(name);
            self.must("pin", pin);
            for part in parts {
                match *part {
                    "heater_temp" => self.number(part, 35.0, 60.0),
                    "idle_timeout" => self.word(part, &["15", "45", "120"]),
                    "of_bed" => self.must("heater", "heater_bed"),
                    "off_below" => self.number(part, 0.0, 0.3),
                    "kick_start_time" => self.number(part, 0.0, 2.0),
                    _ => self.number(part, 0.3, 1.0),
                }
            }
        }
    }

    fn probe(&mut self) {
        let kind = self.dice.one(&["bltouch", "probe"]);
        self.section(kind);
        if kind == "bltouch" {
            self.must("sensor_pin", "^PB7");
            self.must("control_pin", "PB6");
        } else {
            let pin = self.dice.one(&["~!PB7", "^PG15", "^!PG15"]);
            self.must("pin", pin);
        }
        self.number("x_offset", -45.0, 45.0);
        self.number("y_offset", -45.0, 45.0);
        let height = self.dice.between(0.2, 4.0);
        self.must("z_offset", height);
        self.number("speed", 1.0, 15.0);
        self.word("samples", &["1", "2", "5"]);
        self.number("sample_retract_dist", 1.0, 8.0);
        self.number("samples_tolerance", 0.01, 0.5);
        self.word("samples_tolerance_retries", &["0", "3", "5"]);
        self.word("samples_result", &["average", "median"]);
    }

    fn levelling(&mut self, has_probe: bool) {
        if self.dice.comes(3) {
            self.section("safe_z_home");
            let (x, y) = (self.dice.between(60.0, 120.0), self.dice.between(60.0, 120.0));
            self.must("home_xy_position", format!("{x}, {y}"));
            self.number("z_hop", 0.0, 20.0);
            self.number("z_hop_speed", 1.0, 20.0);
            self.number("speed", 20.0, 200.0);
            self.word("move_to_previous", &["True", "False"]);
        }
        if self.dice.comes(3) {
            self.section("bed_mesh");
            self.must("mesh_min", "10, 10");
            self.must("mesh_max", "150, 150");
            self.word("probe_count", &["5, 7", "4", "3,3", "9,5"]);
            self.number("fade_end", 1.0, 20.0);
            self.number("fade_start", 1.0, 2.0);
            self.number("horizontal_move_z", 3.0, 12.0);
        }
        if has_probe && self.dice.comes(3) {
            self.section("z_tilt");
            let (left, right) = (self.dice.between(-50.0, -5.0), self.dice.between(200.0, 420.0));
            self.must("z_positions", format!("{left}, 100\n  {right}, 110"));
            let (left, right) = (self.dice.between(60.0, 80.0), self.dice.between(90.0, 120.0));
            self.must("points", format!("{left}, 100\n  {right}, 90"));
            self.number("horizontal_move_z", 3.0, 12.0);
        }
    }

    fn others(&mut self) {
        if self.dice.comes(3) {
            self.section("input_shaper");
            self.number("shaper_freq_x", 20.0, 120.0);
            self.word("shaper_type_x", &["zv", "mzv", "ei", "2hump_ei"]);
            self.number("shaper_freq_y", 20.0, 120.0);
            self.word("shaper_type", &["zvd", "ei"]);
            self.number("damping_ratio_x", 0.02, 0.2);
            self.number("damping_ratio_y", 0.02, 0.2);
        }
        if self.dice.comes(3) {
            self.section("idle_timeout");
            self.word("timeout", &["600", "1800", "7200"]);
        }
        if self.dice.comes(3) {
            self.section("filament_switch_sensor spool");
            let pin = self.dice.one(&["PG12", "^!PG12", "^PG13"]);
            self.must("switch_pin", pin);
        }
        if self.dice.comes(3) {
            self.section("temperature_sensor chamber");
            self.must("sensor_type", "Generic 3950");
            self.must("sensor_pin", "PF6");
        }
        self.section("thermistor own");
        self.must("temperature1", 25);
        self.must("resistance1", 100_000);
        let by_beta = self.dice.comes(2);
        if by_beta {
            self.must("beta", 4036);
        } else {
            self.must("temperature2", 150);
            self.must("resistance2", 1700);
            self.must("temperature3", 250);
            self.must("resistance3", 235);
        }
    }
}
