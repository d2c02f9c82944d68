//! Defaults of Klipper for keys that a configuration leaves out, where ours differ or may come to differ.

use crate::pattern::matches;

/// A default of Klipper.
pub(super) struct Default {
    /// A pattern of sections; it counts if there is one of them, or always if it is empty.
    pub section: &'static str,
    pub key: &'static str,
    pub number: f64,
    /// The keys of ours that it becomes by itself, as it is times `times`.
    pub to: &'static [&'static str],
    pub times: f64,
}

const fn row(section: &'static str, key: &'static str, number: f64, to: &'static [&'static str]) -> Default {
    Default { section, key, number, to, times: 1.0 }
}

/// The defaults, from the lines of Klipper's code that read each key (commit 84104bbb of 2026-08-07): `toolhead.py`,
/// `stepper.py`, `kinematics/extruder.py`, `extras/heaters.py`, `extras/probe.py`, `extras/bed_mesh.py`,
/// `extras/controller_fan.py`, `extras/heater_fan.py`, `extras/idle_timeout.py`, `extras/input_shaper.py`.
/// tests/klipper/defaults.rs has each line.
pub(super) const DEFAULTS: &[Default] = &[
    row("printer", "square_corner_velocity", 5.0, &["corner.square_corner"]),
    row("printer", "minimum_cruise_ratio", 0.5, &["minimum_cruise_ratio"]),
    row("stepper_?", "homing_speed", 5.0, &[]),
    row("stepper_?", "homing_retract_dist", 5.0, &[]),
    row("extruder", "pressure_advance", 0.0, &["advance.time"]),
    row("extruder", "pressure_advance_smooth_time", 0.04, &["advance.window"]),
    row("extruder", "instantaneous_corner_velocity", 1.0, &["extruder_jerk"]),
    row("extruder", "max_extrude_only_distance", 50.0, &["axes.e.length"]),
    row("extruder", "min_extrude_temp", 170.0, &["thermal.min_extrude"]),
    row("heater_fan *", "heater_temp", 50.0, &["thermal.hotend_fan_above"]),
    row("controller_fan *", "idle_timeout", 30.0, &["thermal.fan_run_on_s"]),
    row(PROBE, "speed", 5.0, &["probe.slow", "probe.fast"]),
    row(PROBE, "samples", 1.0, &["probe.samples"]),
    row(PROBE, "sample_retract_dist", 2.0, &[]),
    row(PROBE, "samples_tolerance", 0.1, &["probe.tolerance"]),
    row(PROBE, "samples_tolerance_retries", 0.0, &["probe.retries"]),
    row("bed_mesh", "probe_count", 3.0, &["mesh.columns", "mesh.rows"]),
    row("bed_mesh", "fade_end", 0.0, &["mesh.fade"]),
    row("bed_mesh", "horizontal_move_z", 5.0, &[]),
    row("input_shaper", "damping_ratio_x", 0.1, &["shaper.x.damping"]),
    row("input_shaper", "damping_ratio_y", 0.1, &["shaper.y.damping"]),
    Default { times: 1.0 / 60.0, ..row("", "timeout", 600.0, &["thermal.idle_min"]) },
];

/// Any of the sections of probes.
pub(super) const PROBE: &str = "probe";

/// Klipper's default of a key.
pub(super) fn of(section: &str, key: &str) -> f64 {
    let row = DEFAULTS.iter().find(|row| row.key == key && (row.section == section || matches(row.section, section)));
    row.map_or(0.0, |row| row.number)
}
