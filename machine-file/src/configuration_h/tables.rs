//! Remarks on defines that nothing here uses.

use crate::pattern::matches;
use crate::translation::Kind::{self, Decide, NotNeeded, NotYet};

/// What to say of a probe that is none of ours.
const NO_PROBE: &str = "no such probe yet: see [probe] in docs/reference/settings.md";

/// The remarks, by patterns of names; the first that fits counts.
const REMARKS: &[(&str, Kind, &str)] = &[
    ("CONFIGURATION_*", NotNeeded, "the version of the file"),
    ("STRING_*", NotNeeded, "a text of Marlin"),
    ("SHOW_*", NotNeeded, "of a display"),
    ("CUSTOM_*", NotNeeded, "of Marlin's build"),
    ("MACHINE_UUID", NotNeeded, "of Marlin's build"),
    ("SERIAL_PORT*", NotNeeded, "every host line of the board is open"),
    ("BAUD_RATE_GCODE", NotNeeded, "baud sets it"),
    ("*LCD*", NotNeeded, "of a display"),
    ("*DISPLAY*", NotNeeded, "of a display"),
    ("*_MENU*", NotNeeded, "of a display"),
    ("*ENCODER*", NotNeeded, "of a display"),
    ("*PREHEAT*", NotNeeded, "presets of a display"),
    ("SPEAKER", NotNeeded, "of a display"),
    ("SD*", NotNeeded, "files are on the host"),
    ("EEPROM_*", NotNeeded, "M500 keeps settings"),
    ("EMERGENCY_PARSER", NotNeeded, "M112, M410 and M524 act at once"),
    ("PRINTJOB_*", NotNeeded, "times are the host's"),
    ("PRINTCOUNTER", NotNeeded, "times are the host's"),
    ("NOZZLE_PARK_Z_FEEDRATE", NotNeeded, "Z has its own limit"),
    ("NOZZLE_PARK_*", NotNeeded, "NOZZLE_PARK_FEATURE is off: [pause] has the place"),
    ("PAUSE_PARK_*", NotNeeded, "[pause] has the place and its times"),
    ("FILAMENT_CHANGE_*", NotYet, "M600 U and L say the lengths"),
    ("FILAMENT_UNLOAD_*", NotYet, "M600 U and L say the lengths"),
    ("ADVANCED_OK", NotNeeded, "it is off"),
    ("BLOCK_BUFFER_SIZE", NotNeeded, "the look-ahead has a size of its own"),
    ("*BUFSIZE", NotNeeded, "the firmware has buffers of its own"),
    ("*_BUFFER_SIZE", NotNeeded, "the firmware has buffers of its own"),
    ("ARC_*", NotNeeded, "arcs are built in (arc_tolerance)"),
    ("*_ARC_SEGMENT*", NotNeeded, "arc_tolerance says the length of chords"),
    ("THERMAL_PROTECTION*", NotNeeded, "guards follow the heater's model and cannot be switched off"),
    ("*_PROTECTION_*", NotNeeded, "guards follow the heater's model and cannot be switched off"),
    ("WATCH_*", NotNeeded, "guards follow the heater's model and cannot be switched off"),
    ("HEATER_*_MINTEMP", NotNeeded, "guards notice an open and a shorted sensor"),
    ("*_MINTEMP", NotNeeded, "guards notice an open and a shorted sensor"),
    ("TEMP_SENSOR_[1-7]", NotYet, "one hotend so far"),
    ("TEMP_SENSOR_*", NotYet, "hotend, bed, chamber, board and probe have a sensor"),
    ("TEMP_*", NotNeeded, "M109 and M190 have a window of their own"),
    ("DUMMY_*", NotNeeded, "no such sensor"),
    ("PID_*", NotNeeded, "of Marlin's control"),
    ("MIN_SOFTWARE_ENDSTOP_*", NotNeeded, "soft_endstops is for all axes"),
    ("MAX_SOFTWARE_ENDSTOP_*", NotNeeded, "soft_endstops is for all axes"),
    ("USE_*_PLUG", NotNeeded, "the end of each axis says it"),
    ("ENDSTOPPULLUP*", NotNeeded, "the board pulls its inputs as their circuits need"),
    ("*_ENABLE_ON", NotNeeded, "drivers are enabled by a low level"),
    ("DISABLE_*", NotNeeded, "motors hold until M84"),
    ("DEFAULT_STEPPER_*", NotNeeded, "motors hold until M84; heaters have thermal.idle_min"),
    ("DEFAULT_K?_LIST", NotNeeded, "PID_PARAMS_PER_HOTEND is off"),
    ("HOMING_BACKOFF_*", NotYet, "an axis stays at its switch once it is homed"),
    ("VALIDATE_HOMING_ENDSTOPS", NotNeeded, "an axis that does not meet its switch ends the job"),
    ("MINIMUM_PLANNER_SPEED", NotNeeded, "the look-ahead has a law of its own"),
    ("E0_AUTO_FAN_PIN", NotYet, "give its output the role hotend in [fans.fan1] and so on"),
    ("*CONTROLLER_FAN*", NotYet, "give its output the role controller in [fans.fan2] and so on"),
    ("HOME_AFTER_DEACTIVATE", NotNeeded, "an axis without power has to be homed again"),
    ("INVERT_E[1-7]_DIR", NotYet, "a second extruder: it stays off"),
    ("E[1-7]_*", NotYet, "a second extruder: it stays off"),
    ("NUM_Z_STEPPER*", Kind::Taken, "the motors of z"),
    ("QUICK_HOME", NotYet, "X and Y are homed one after the other"),
    ("CODEPENDENT_XY_HOMING", NotYet, "X and Y are homed one after the other"),
    ("HOTEND_IDLE_*", NotNeeded, "thermal.idle_min is for all heaters"),
    ("PROBING_MARGIN*", NotYet, "G29 measures all that the probe reaches, or the area of its words"),
    ("MIN_PROBE_EDGE*", NotYet, "G29 measures all that the probe reaches, or the area of its words"),
    ("MESH_INSET", NotYet, "G29 measures all that the probe reaches, or the area of its words"),
    ("PROBING_FANS_OFF", NotYet, "fans run on while the probe touches"),
    ("PROBE_MANUALLY", NotYet, "a mesh is measured by a probe"),
    ("AUTO_BED_LEVELING_*", NotNeeded, "G29 measures a mesh"),
    ("MESH_BED_LEVELING", NotNeeded, "G29 measures a mesh"),
    ("RESTORE_LEVELING_AFTER_G28", NotNeeded, "G28 keeps the mesh"),
    ("TOUCH_MI_PROBE", Decide, NO_PROBE),
    ("SOLENOID_PROBE", Decide, NO_PROBE),
    ("MAG_MOUNTED_PROBE", Decide, NO_PROBE),
    ("RACK_AND_PINION_PROBE", Decide, NO_PROBE),
    ("Z_PROBE_SLED", Decide, NO_PROBE),
    ("Z_PROBE_ALLEN_KEY", Decide, NO_PROBE),
    ("SENSORLESS_PROBING", Decide, NO_PROBE),
    ("BIQU_MICROPROBE_*", Decide, NO_PROBE),
    ("BABYSTEP*", NotNeeded, "built in (M290)"),
    ("FWRETRACT*", NotNeeded, "built in (G10, G11)"),
    ("RETRACT_*", NotYet, "M207 in the start G-code sets it"),
    ("DEFAULT_NOMINAL_FILAMENT_DIA", NotNeeded, "the slicer knows it"),
    ("S_CURVE_ACCELERATION", NotNeeded, "input shapers round the moves (shaper.x)"),
    ("HOST_*", NotNeeded, "built in"),
    ("AUTO_REPORT_*", NotNeeded, "built in (M155, M154)"),
    ("EXTENDED_CAPABILITIES_REPORT", NotNeeded, "built in (M115)"),
    ("*_SLAVE_ADDRESS", NotYet, "every driver has a line of its own"),
    ("*_RSENSE", NotYet, "currents are computed for 0.11 Ohm"),
    ("*_STALL_SENSITIVITY", NotYet, "no axis homes by StallGuard"),
    ("SENSORLESS_HOMING", Decide, "homing by StallGuard is not there yet: plug in switches"),
    ("FIL_RUNOUT_*", NotYet, "write the input of the sensor into endstops.filament, `!` if it closes with filament"),
    ("FILAMENT_RUNOUT*", NotYet, "M119 reports a filament sensor, and nothing stops at the end of the filament"),
    ("SWITCHING_*", NotYet, "one extruder so far"),
    ("DUAL_X_CARRIAGE", NotYet, "a second carriage"),
    ("BACKLASH_*", NotYet, "backlash is not compensated"),
    ("SKEW_*", NotYet, "skew is not compensated"),
    ("POWER_LOSS_RECOVERY", NotYet, "a print does not go on after a power cut"),
    ("NEOPIXEL*", NotYet, "no lights"),
    ("*LED*", NotYet, "no lights"),
];

/// What to say of a define.
pub(super) fn remark(name: &str) -> Option<(Kind, &'static str)> {
    REMARKS.iter().find(|(pattern, ..)| matches(pattern, name)).map(|(_, kind, text)| (*kind, *text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::sample;

    #[test]
    fn no_remark_hides_a_later_one() {
        for (pattern, _, text) in REMARKS {
            let found = REMARKS.iter().find(|(known, ..)| matches(known, &sample(pattern)));
            assert_eq!(found.map(|(known, _, text)| (*known, *text)), Some((*pattern, *text)), "{pattern}");
        }
    }
}
