//! Peers: keys of Klipper and Marlin that people write into machine files, and what to write instead.

use crate::keys::{ALL, named};
use crate::pattern::matches;
use corehbot::motors::prototype;

/// A key of a peer, or a pattern of keys, and the answer to it.
struct Peer(&'static str, Answer);

/// What there is for a peer's key.
enum Answer {
    /// Our key, and how to fill it in.
    Use(&'static str, &'static str),
    /// Nothing so far, and what that means.
    NotYet(&'static str),
    /// What is missing elsewhere in the file.
    Missing(&'static str),
}

use Answer::{Missing, NotYet, Use};

/// The peers' keys, in small letters; the first that fits counts.
const PEERS: &[Peer] = &[
    // Motors and their drivers.
    Peer("gear_ratio", Use("rotation_distance", "divide the distance by the gears")),
    Peer("full_steps_per_rotation", Use("full_steps", "")),
    Peer("step_distance", Use("steps_per_mm", "1 / step_distance")),
    Peer("default_axis_steps_per_unit", Use("steps_per_mm", "")),
    Peer("kinematics", Use("mechanism", "a row for each motor; `corehbot config new --kinematics` writes them")),
    Peer("step_pin", Use("motors", "the socket of the board, such as \"M0\"")),
    Peer("dir_pin", Use("motors", "\"!M0\" turns a motor the other way round")),
    Peer("enable_pin", Use("motors", "the socket of the board has the pin")),
    Peer("uart_pin", Use("motors", "the socket of the board has the pin")),
    Peer("invert_*_dir", Use("motors", "\"!M0\" turns a motor the other way round")),
    Peer("run_current", Use("current_ma", "in mA")),
    Peer("[xyze]_current", Use("current_ma", "")),
    Peer("hold_current", Use("hold_percent", "100 x hold_current / run_current")),
    Peer("hold_multiplier", Use("hold_percent", "in percent")),
    Peer("stealthchop_threshold", Use("hybrid_threshold", "in mm/s, with stealth = true")),
    Peer("stealthchop*", Use("stealth", "")),
    Peer("driver_sgthrs", Use("stall_threshold", "")),
    Peer("sense_resistor", NotYet("currents are computed for 0.11 Ohm")),
    Peer("diag_pin", NotYet("no axis homes by StallGuard")),
    // Axes.
    Peer("position_max", Use("length", "position_max - position_min")),
    Peer("[xyz]_max_pos", Use("length", "the greatest position less the least one")),
    Peer("[xyz]_bed_size", Use("bed", "its width and depth")),
    Peer("position_min", Use("min", "")),
    Peer("max", Use("length", "of an axis: its greatest position less min")),
    Peer("[xyz]_min_pos", Use("min", "in [axes.x] and so on")),
    Peer("position_endstop", Use("position", "in [homing.x] and so on")),
    Peer("endstop_pin", Use("endstops", "the input of the board, such as \"X-STOP\"")),
    Peer("*_endstop_inverting", Use("endstops", "\"!X-STOP\" is a switch that closes when it is pressed")),
    Peer("homing_speed", Use("fast", "in [homing.x] and so on")),
    Peer("second_homing_speed", Use("slow", "in [homing.x] and so on")),
    Peer("homing_retract_dist", Use("back_off", "in [homing.x] and so on")),
    Peer("homing_positive_dir", Use("end", "\"max\", in [homing.x] and so on")),
    Peer("[xyz]_home_dir", Use("end", "\"min\" or \"max\", in [homing.x] and so on")),
    Peer("stepper_*", Use("axes", "with [motors], [endstops] and [homing]")),
    // Limits.
    Peer("max_velocity", Use("max_speed", "in [axes.x] and so on")),
    Peer("max_z_velocity", Use("max_speed", "in [axes.z]")),
    Peer("default_max_feedrate", Use("max_speed", "in [axes.x] and so on")),
    Peer("max_accel", Use("max_acceleration", "in [axes.x] and so on, and print_acceleration")),
    Peer("max_z_accel", Use("max_acceleration", "in [axes.z]")),
    Peer("default_max_acceleration", Use("max_acceleration", "in [axes.x] and so on")),
    Peer("default_acceleration", Use("print_acceleration", "")),
    Peer("default_travel_acceleration", Use("travel_acceleration", "")),
    Peer("max_accel_to_decel", Use("minimum_cruise_ratio", "1 - max_accel_to_decel / max_accel")),
    Peer("square_corner_velocity", Use("square_corner", "in [corner]")),
    Peer("junction_deviation_mm", Use("junction_deviation", "in [corner]")),
    Peer("default_zjerk", Use("z_jerk", "")),
    Peer("default_[xy]jerk", Use("square_corner", "in [corner]")),
    Peer("default_ejerk", Use("extruder_jerk", "")),
    Peer("instantaneous_corner_velocity", Use("extruder_jerk", "")),
    // Shapers and the extruder.
    Peer("shaper_freq_[xy]", Use("frequency", "in [shaper.x] and [shaper.y]")),
    Peer("shaper_type*", Use("kind", "in [shaper.x] and [shaper.y]")),
    Peer("damping_ratio_[xy]", Use("damping", "in [shaper.x] and [shaper.y]")),
    Peer("input_shaper", Use("shaper", "[shaper.x] and [shaper.y]")),
    Peer("pressure_advance", Use("time", "in [advance]")),
    Peer("pressure_advance_smooth_time", Use("window", "in [advance]")),
    Peer("advance_k", Use("time", "in [advance]")),
    Peer("max_extrude_only_distance", Use("length", "in [axes.e]")),
    Peer("max_extrude_only_velocity", Use("max_speed", "in [axes.e]")),
    Peer("max_extrude_only_accel", Use("max_acceleration", "in [axes.e]")),
    Peer("nozzle_diameter", NotYet("the slicer knows it")),
    Peer("filament_diameter", NotYet("the slicer knows it")),
    // Heat.
    Peer("heater_pin", Use("output", "the output of the board, such as \"he0\"")),
    Peer("sensor_pin", Use("sensor", "the input of the board, such as \"hotend0\"")),
    Peer("sensor_type", Use("thermistor", "")),
    Peer("temp_sensor_*", Use("thermistor", "")),
    Peer("pullup*", NotYet("sensors are computed with the 4.7 kOhm of the boards")),
    Peer("max_temp", Use("most", "")),
    Peer("heater_*_maxtemp", Use("most", "")),
    Peer("bed_maxtemp", Use("most", "")),
    Peer("min_temp", NotYet("guards notice an open and a shorted sensor")),
    Peer("max_power", Use("max_duty", "of a heater; of a fan it is most")),
    Peer("pid_kp", Use("p", "in [heaters.hotend.pid] and so on")),
    Peer("pid_ki", Use("i", "in [heaters.hotend.pid] and so on")),
    Peer("pid_kd", Use("d", "in [heaters.hotend.pid] and so on")),
    Peer("min_extrude_temp", Use("min_extrude", "in [thermal]")),
    Peer("extrude_mintemp", Use("min_extrude", "in [thermal]")),
    Peer("extruder", Use("axes.e", "with [motors] and [heaters.hotend]")),
    Peer("heater_bed", Use("heaters.bed", "")),
    Peer("verify_heater", Use("guards", "in [heaters.hotend] and so on")),
    Peer("kick_start_time", Use("kick_ms", "in ms")),
    Peer("off_below", Use("least", "the duty at the lowest speed")),
    Peer("cycle_time", Use("frequency", "of a fan, in Hz: 1 / cycle_time")),
    Peer("tachometer_pin", Use("tachometer", "the input of the board, such as \"E0DET\"")),
    Peer("tachometer_ppr", Use("pulses", "in [fans], for all of them")),
    Peer("fan", Use("fans", "[fans.fan0] and so on")),
    Peer("idle_timeout", Use("idle_min", "in [thermal], in minutes")),
    // What there is not.
    Peer("bltouch", Use("probe", "kind = \"bltouch\", with its input in endstops.probe")),
    Peer("bed_mesh", Use("mesh", "its points and its fade; G29 has the rest")),
    Peer("quad_gantry_level", Use("screws", "[screws.1] and so on: place and probed point of each belt (G34)")),
    Peer("z_tilt*", Use("screws", "[screws.1] and so on: place and probed point of each screw (G34)")),
    Peer("home_xy_position", Use("safe_z_home.x", "and y, of a switch of z; a probe that homes z has [probe.home]")),
    Peer(
        "filament_switch_sensor",
        Use("endstops.filament", "its input; M119 reports it, and nothing stops at the end of the filament"),
    ),
    Peer("gcode_macro", NotYet("no macros")),
    // A motor of ours that the machine does not have.
    Peer("[xyze][0123456789]", Missing("`names` in [motors] lists the motors of a machine, and this one is not there")),
];

/// The answer to a key that is unknown: a peer's, or one of ours in another table.
pub(crate) fn answer(key: &str) -> Option<String> {
    let small = key.to_lowercase();
    let peer = PEERS.iter().find(|Peer(known, _)| matches(known, &small)).map(|Peer(_, answer)| match answer {
        Use(ours, "") => format!("use `{ours}` instead"),
        Use(ours, how) => format!("use `{ours}` instead: {how}"),
        NotYet(meaning) => format!("not there yet: {meaning}"),
        Missing(what) => (*what).to_owned(),
    });
    peer.or_else(|| {
        let ends = |path: &String| path.rsplit_once('.').is_some_and(|(_, leaf)| leaf == key);
        let path = ALL.iter().filter_map(|known| named(&known.path, &prototype::NAMES)).find(ends)?;
        Some(format!("it is a key of other tables: {path}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems;

    #[test]
    fn every_answer_names_a_key_or_table_of_ours() {
        let paths: Vec<_> = ALL.iter().filter_map(|known| named(&known.path, &prototype::NAMES)).collect();
        for Peer(peer, answer) in PEERS {
            let Use(ours, _) = answer else { continue };
            let is_in = |path: &String| {
                path == ours
                    || path.starts_with(&format!("{ours}."))
                    || path.ends_with(&format!(".{ours}"))
                    || path.contains(&format!(".{ours}."))
            };
            assert!(paths.iter().any(is_in), "{peer}: {ours}");
        }
    }

    #[test]
    fn peers_keys_are_answered_and_ours_are_not_hidden() {
        let tops: Vec<_> = crate::keys::names_in("", &prototype::NAMES);
        for Peer(peer, _) in PEERS {
            assert!(!tops.iter().any(|ours| ours == peer), "{peer} is ours");
            assert!(!peer.chars().any(char::is_uppercase), "{peer}");
        }
        let said = |text: &str| problems(text).1.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        for (text, told) in [
            (
                "[axes.x]\ngear_ratio = 5",
                "2:1: error: unknown field `gear_ratio`: use `rotation_distance` instead: divide",
            ),
            ("[drivers.belt]\nrun_current = 0.8", "unknown field `run_current`: use `current_ma` instead: in mA"),
            ("[drivers.belt]\nsense_resistor = 0.1", "unknown field `sense_resistor`: not there yet: currents"),
            ("[stepper_x]\nstep_pin = 'PF13'", "1:2: error: unknown field `stepper_x`: use `axes` instead"),
            ("DEFAULT_AXIS_STEPS_PER_UNIT = 80", "use `steps_per_mm` instead"),
            ("rotation_distance = 40", "it is a key of other tables: axes.x.rotation_distance"),
            ("[axes.x]\nlenght = 5", "did you mean `length`?"),
        ] {
            assert!(said(text).contains(told), "{text}: {}", said(text));
        }
    }
}
