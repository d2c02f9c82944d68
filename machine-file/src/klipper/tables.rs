//! Tables: keys of Klipper that are one number, and remarks on all others.

use crate::pattern::matches;
use crate::translation::Kind;

/// A key that is a number, and the key of ours that it becomes.
pub(super) struct NumberRow {
    pub section: &'static str,
    pub key: &'static str,
    pub to: &'static str,
    pub times: f64,
}

const fn row(section: &'static str, key: &'static str, to: &'static str) -> NumberRow {
    NumberRow { section, key, to, times: 1.0 }
}

/// Keys that are one number. `defaults` says what counts without one.
pub(super) const NUMBERS: &[NumberRow] = &[
    row("printer", "square_corner_velocity", "corner.square_corner"),
    row("printer", "minimum_cruise_ratio", "minimum_cruise_ratio"),
    row("extruder", "min_extrude_temp", "thermal.min_extrude"),
    row("extruder", "pressure_advance", "advance.time"),
    row("extruder", "pressure_advance_smooth_time", "advance.window"),
    row("extruder", "max_extrude_only_distance", "axes.e.length"),
    row("extruder", "max_extrude_only_velocity", "axes.e.max_speed"),
    row("extruder", "max_extrude_only_accel", "axes.e.max_acceleration"),
    row("extruder", "max_extrude_only_accel", "retract_acceleration"),
    row("extruder", "instantaneous_corner_velocity", "extruder_jerk"),
    row("safe_z_home", "z_hop", "safe_z_home.z_hop"),
    row("safe_z_home", "z_hop_speed", "safe_z_home.z_hop_speed"),
    NumberRow { times: 1.0 / 60.0, ..row("idle_timeout", "timeout", "thermal.idle_min") },
];

/// What to say of keys, or of whole sections.
pub(super) struct Remark {
    /// A pattern of section names.
    pub section: &'static str,
    /// A pattern of keys; empty for the section itself, and so for all its keys.
    pub key: &'static str,
    pub kind: Kind,
    pub text: &'static str,
}

const fn not_yet(section: &'static str, key: &'static str, text: &'static str) -> Remark {
    Remark { section, key, kind: Kind::NotYet, text }
}

const fn needless(section: &'static str, key: &'static str, text: &'static str) -> Remark {
    Remark { section, key, kind: Kind::NotNeeded, text }
}

/// The remarks; the first that fits counts.
pub(super) const REMARKS: &[Remark] = &[
    // Boards and hosts.
    needless("mcu", "", "the host's way to the board: this firmware needs none"),
    not_yet("mcu *", "", "another board: a machine has one so far"),
    needless("board_pins*", "", "other names of pins, which were looked up"),
    needless("virtual_sdcard", "", "files are on the host"),
    needless("display_status", "", "built in (M73)"),
    needless("pause_resume", "", "built in ([pause], M25, M600)"),
    not_yet("exclude_object", "", "objects are followed (M486), and leaving one out is refused"),
    needless("respond", "", "built in (M118)"),
    needless("gcode_arcs", "", "arcs are built in (arc_tolerance)"),
    not_yet("force_move", "", "STEPPER_BUZZ moves a motor alone, nothing else does"),
    not_yet("save_variables", "", "no macros"),
    needless("fluidd*", "", "of a web interface"),
    needless("mainsail*", "", "of a web interface"),
    needless("stepper_?*", "homing_retract_speed", "the way back has the first speed"),
    // Motors.
    not_yet("stepper_[xyz][0-9]*", "endstop_pin", "one switch homes an axis: a second one levels nothing"),
    needless("stepper_[xyz][0-9]*", "position_*", "the axis has it from its first motor"),
    needless("stepper_[xyz][0-9]*", "homing_*", "the axis has it from its first motor"),
    not_yet("stepper_*", "step_pulse_duration", "pulses are as long as a TMC2209 needs"),
    not_yet("extruder_stepper *", "", "a second motor of the extruder: it stays off"),
    not_yet("extruder[0-9]*", "", "a second extruder: it stays off"),
    not_yet("manual_stepper *", "", "a motor outside of the mechanism: it stays off"),
    not_yet("dual_carriage", "", "a second carriage"),
    not_yet("tmc2209 *", "diag_pin", "no axis homes by StallGuard so far"),
    not_yet("tmc2209 *", "uart_address", "every driver has a line of its own"),
    not_yet("tmc2209 *", "tx_pin", "every driver has one line of its own"),
    not_yet("tmc2209 *", "select_pins", "every driver has a line of its own"),
    not_yet("tmc2209 *", "driver_*", "a register that the firmware sets itself"),
    not_yet("tmc2130 *", "", "another driver than a TMC2209"),
    not_yet("tmc2208 *", "", "another driver than a TMC2209"),
    not_yet("tmc2225 *", "", "another driver than a TMC2209"),
    not_yet("tmc2240 *", "", "another driver than a TMC2209"),
    not_yet("tmc2660 *", "", "another driver than a TMC2209"),
    not_yet("tmc5160 *", "", "another driver than a TMC2209"),
    not_yet("endstop_phase*", "", "homing by the driver's phase"),
    // Heat.
    needless("extruder", "nozzle_diameter", "the slicer knows it"),
    needless("extruder", "filament_diameter", "the slicer knows it; volumes (M200) say it themselves"),
    not_yet("extruder", "max_extrude_cross_section", "nothing refuses thick lines"),
    needless("*", "min_temp", "guards notice an open and a shorted sensor"),
    needless("*", "smooth_time", "the temperature is filtered by the firmware"),
    needless("*", "pwm_cycle_time", "the board has a modulation of its own; a relay has period_ms"),
    needless("*", "pid_k[pid]", "another control is chosen"),
    not_yet("*", "max_delta", "no setting for it"),
    needless("verify_heater *", "", "guards follow the heater's model: heaters.*.guards, which cannot be switched off"),
    needless("thermistor *", "", "a sensor that no heater uses"),
    not_yet("adc_temperature *", "", "a sensor by a table of yours"),
    not_yet("heater_generic *", "", "another heater than hotend, bed and chamber: it stays off"),
    not_yet(
        "temperature_sensor *",
        "",
        "M105 reports thermistors at inputs of the board and its processor, three at most",
    ),
    not_yet("temperature_fan *", "", "a fan that follows a sensor: it stays off"),
    needless("*fan*", "hardware_pwm", "a timer modulates, where the output has one"),
    not_yet("*fan*", "tachometer_*", "no fan of the board, or no input of it"),
    not_yet("*fan*", "enable_pin", "a fan has one line"),
    not_yet("*fan*", "shutdown_speed", "a stop switches fans as their roles say"),
    not_yet("controller_fan *", "idle_speed", "it runs on at full speed"),
    not_yet("idle_timeout", "gcode", "heaters go off, without G-code of yours"),
    // Levelling and homing.
    needless("bltouch", "control_pin", "the header BLTOUCH has the servo's line beside the input"),
    not_yet("probe*", "*", "no setting for it: see [probe] in docs/reference/settings.md"),
    not_yet("bltouch", "*", "no setting for it: see [probe] in docs/reference/settings.md"),
    not_yet("smart_effector", "*", "no setting for it: see [probe] in docs/reference/settings.md"),
    not_yet("beacon*", "", "a scanner on its own USB line"),
    not_yet("cartographer*", "", "a scanner on its own USB line"),
    needless("quad_gantry_level", "*", "words of G34, and [probe]"),
    needless("z_tilt*", "*", "words of G34, and [probe]"),
    not_yet("bed_tilt", "", "a slanted bed is not compensated"),
    not_yet("bed_screws", "", "G35 probes the corners of the bed and says how far to turn its screws"),
    not_yet("screws_tilt_adjust", "", "G35 probes the corners of the bed and says how far to turn its screws"),
    not_yet("bed_mesh *", "", "a mesh that was saved: G29 measures it again"),
    not_yet("bed_mesh", "fade_target", "a mesh fades to its mean"),
    not_yet("bed_mesh", "relative_reference_index", "a mesh is 0 where Z is homed (probe.home)"),
    not_yet("bed_mesh", "*_radius", "a round bed"),
    needless("bed_mesh", "*", "words of G29, and [probe]"),
    not_yet("axis_twist_compensation", "", "a twisted axis is not compensated"),
    not_yet("skew_correction", "", "skew is not compensated"),
    needless("safe_z_home", "speed", "the probe goes to its place by probe.travel"),
    needless("homing_override", "axes", "see its G-code"),
    not_yet("homing_override", "", "G28 homes by homing.order, without G-code of yours"),
    // Sensors and displays.
    not_yet("filament_switch_sensor *", "", "M119 reports one, and nothing stops at the end of the filament"),
    not_yet("filament_motion_sensor *", "", "nothing notices a jam"),
    not_yet("adxl345*", "", "write it into [accelerometer], if it hangs on the board itself"),
    not_yet("lis2dw*", "", "write it into [accelerometer], if it hangs on the board itself"),
    needless("resonance_tester", "", "words of TEST_RESONANCES, which shakes the tool where it stands"),
    not_yet("display*", "", "no display"),
    not_yet("neopixel *", "", "no lights"),
    not_yet("led *", "", "no lights"),
    not_yet("dotstar *", "", "no lights"),
    not_yet("output_pin *", "", "the pin stays as it is after a reset"),
    not_yet("static_digital_output *", "", "the pin stays as it is after a reset"),
    not_yet("servo *", "", "no servo"),
    not_yet("gcode_button *", "", "no buttons"),
    // G-code of the owner.
    not_yet("delayed_gcode *", "", "nothing is carried out after a time"),
    not_yet("menu *", "", "no display"),
    not_yet("firmware_retraction", "", "G10 and G11 are built in: M207 in the start G-code sets the lengths"),
];

/// What to say of a key without any remark.
pub(super) const NO_SETTING: &str = "no setting for it";

/// The remark on a key, or on a section as a whole.
pub(super) fn remark(section: &str, key: Option<&str>) -> Option<&'static Remark> {
    REMARKS.iter().find(|remark| {
        let is_key = match key {
            Some(key) => !remark.key.is_empty() && matches(remark.key, key),
            None => remark.key.is_empty(),
        };
        is_key && matches(remark.section, section)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::sample;

    #[test]
    fn no_remark_hides_a_later_one() {
        for Remark { section, key, text, .. } in REMARKS {
            let (name, of_key) = (sample(section), sample(key));
            let found = remark(&name, (!key.is_empty()).then_some(of_key.as_str())).unwrap();
            assert_eq!((found.section, found.key, found.text), (*section, *key, *text), "{name} {of_key}");
        }
    }

    #[test]
    fn a_number_has_a_row_for_each_key_of_ours_once() {
        for (place, row) in NUMBERS.iter().enumerate() {
            let again = NUMBERS[..place].iter().find(|other| other.to == row.to);
            assert!(again.is_none(), "{} {}", row.section, row.to);
            assert!(crate::keys::find(row.to).is_some(), "{}", row.to);
        }
    }
}
