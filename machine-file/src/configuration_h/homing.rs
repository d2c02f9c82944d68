//! Homing, the probe, and the place where Z is homed.

use super::expression::Names;
use super::look::{AXES, Look};
use crate::translation::Kind;

/// Speeds of homing, the way back, and where a switch sits.
pub(super) fn homing(look: &mut Look<'_, '_, '_>) {
    let of = |look: &Look<'_, '_, '_>, name: &str, axis: usize| look.defines.list(name).get(axis).copied().flatten();
    for (axis, name) in AXES.into_iter().enumerate() {
        let key = |leaf: &str| format!("homing.{name}.{leaf}");
        let fast = of(look, "HOMING_FEEDRATE_MM_M", axis).map(|speed| speed / 60.0).or_else(|| {
            let old = if axis == 2 { "HOMING_FEEDRATE_Z" } else { "HOMING_FEEDRATE_XY" };
            look.defines.of(old).map(|speed| speed / 60.0)
        });
        let source = ["HOMING_FEEDRATE_MM_M", if axis == 2 { "HOMING_FEEDRATE_Z" } else { "HOMING_FEEDRATE_XY" }];
        let source = source.into_iter().find_map(|name| look.entry(name));
        if let (Some(entry), Some(fast)) = (source, fast) {
            look.work.take_number(entry, &key("fast"), fast);
            if let (Some(entry), Some(divisor)) =
                (look.entry("HOMING_BUMP_DIVISOR"), of(look, "HOMING_BUMP_DIVISOR", axis).filter(|by| *by > 0.0))
            {
                look.work.take_number(entry, &key("slow"), fast / divisor);
            }
        }
        if let (Some(entry), Some(bump)) = (look.entry("HOMING_BUMP_MM"), of(look, "HOMING_BUMP_MM", axis)) {
            if bump > 0.0 {
                look.work.take_number(entry, &key("back_off"), bump);
            } else {
                look.work.say(entry, Kind::Approximated, format!("{name} meets its switch twice"));
            }
        }
        let manual = format!("MANUAL_{}_HOME_POS", name.to_ascii_uppercase());
        look.take(&manual, &key("position"), 1.0);
    }
}

/// Kinds of probes.
const PROBES: [(&str, &str); 4] = [
    ("BLTOUCH", "bltouch"),
    ("FIX_MOUNTED_PROBE", "switch"),
    ("Z_PROBE_SERVO_NR", "switch"),
    ("NOZZLE_AS_PROBE", "nozzle"),
];

/// The probe, and the place where Z is homed by it.
pub(super) fn probe(look: &mut Look<'_, '_, '_>) {
    for (name, kind) in PROBES {
        // A number of a servo is no switch.
        let is_on = look.defines.has(name) || (name == "Z_PROBE_SERVO_NR" && look.defines.find(name).is_some());
        if let Some(entry) = look.entry(name).filter(|_| is_on) {
            if look.work.lines.get("probe.kind").is_none() {
                look.work.take(entry, "probe.kind", kind);
                let keys = [("endstops.probe".to_owned(), "".into())];
                look.work.fill_in(&keys, "the input of the probe");
            }
            if name == "Z_PROBE_SERVO_NR" {
                look.work.say(entry, Kind::NotYet, "no servo but a BLTouch's");
            }
        }
    }
    let has_probe = look.work.lines.get("probe.kind").is_some();
    for name in ["USE_PROBE_FOR_Z_HOMING", "Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN"] {
        if let Some(entry) = look.entry(name).filter(|_| has_probe && look.defines.has(name)) {
            look.work.take(entry, "probe.z_home", true);
        }
    }
    let by_probe = look.work.lines.get("probe.z_home").is_some();
    place(look, by_probe);
    hop(look, by_probe);
    order(look);
}

/// The place where Z is homed: of the probe, if it homes Z (`home_z_safely` in
/// `Marlin/src/gcode/calibrate/G28.cpp`).
fn place(look: &mut Look<'_, '_, '_>, by_probe: bool) {
    let is_on = look.defines.has("Z_SAFE_HOMING");
    for axis in ["x", "y"] {
        let letter = axis.to_ascii_uppercase();
        let (name, centre) = (format!("Z_SAFE_HOMING_{letter}_POINT"), format!("{letter}_CENTER"));
        let path = format!("{}.{axis}", if by_probe { "probe.home" } else { "safe_z_home" });
        let value = look.defines.find(&name).map(|define| define.value.trim_matches(['(', ')', ' ']).to_owned());
        let is_centre = value.is_some_and(|value| value == centre);
        match look.entry(&name) {
            Some(entry) if !is_on => look.work.say(entry, Kind::NotNeeded, "Z_SAFE_HOMING is off"),
            Some(entry) if is_centre && by_probe => {
                look.work.take(entry, &path, "auto");
                look.work.say(entry, Kind::Taken, "the middle of the bed");
            }
            Some(_) => {
                let text = if is_centre { "the middle of the bed" } else { "" };
                if look.take(&name, &path, 1.0).is_some() {
                    look.say(&name, Kind::Taken, text);
                }
            }
            // Marlin's default is the middle (`_SAFE_POINT` in `Marlin/src/inc/Conditionals-5-post.h`), but of UBL a
            // point of its mesh; "auto" is the probe's.
            None if is_on
                && !by_probe
                && !look.defines.has("AUTO_BED_LEVELING_UBL")
                && look.defines.is_defined(&name) != Some(true) =>
            {
                if let Some(centre) = look.defines.number(&centre, 0) {
                    look.work.set_number(&path, centre.value, "Marlin's default: the middle of the bed");
                }
            }
            None => {}
        }
    }
    look.say("Z_SAFE_HOMING", Kind::Taken, "Z homes at its place");
}

/// How far Z rises. Marlin raises it before X and Y are homed, by the height where Z is not known
/// (`GcodeSuite::G28`, `do_z_clearance` in `Marlin/src/module/motion.cpp`). After Z is homed it goes to Z_AFTER_HOMING.
/// A hop here has one height for both.
fn hop(look: &mut Look<'_, '_, '_>, by_probe: bool) {
    const HOP: &str = "safe_z_home.z_hop";
    let after = look.defines.of("Z_AFTER_HOMING");
    for name in ["Z_HOMING_HEIGHT", "Z_CLEARANCE_FOR_HOMING", "Z_AFTER_HOMING"] {
        let Some((entry, height)) = look.number(name) else { continue };
        look.work.take_number(entry, HOP, height);
        if look.work.lines.number(HOP) != Some(height) {
            look.work.say(entry, Kind::Decide, "Z rises by one height before it is homed and after");
        } else if Some(height) != after || name == "Z_AFTER_HOMING" && !look.is_before_homing() {
            look.work.say(entry, Kind::Approximated, "Z rises so far before any axis is homed, and after Z is homed");
        }
    }
    if look.work.lines.get(HOP).is_none()
        && let Some(height) = look.defines.of("Z_CLEARANCE_BETWEEN_PROBES")
    {
        // `Marlin/src/inc/Conditionals-5-post.h`.
        look.work.set_number(HOP, height, "Marlin's default: Z_CLEARANCE_BETWEEN_PROBES");
    }
    if look.work.lines.number(HOP).is_some_and(|height| height > 0.0) {
        let of_probe = look.defines.of("Z_PROBE_FEEDRATE_FAST").map(|speed| speed / 60.0);
        let speed = of_probe.or_else(|| look.work.lines.number("homing.z.fast"));
        if let Some(speed) = speed.filter(|speed| *speed > 0.0) {
            look.work.set_number("safe_z_home.z_hop_speed", speed, "Marlin's: the speed of probing or homing");
        }
    }
    // `do_blocking_move_to` in `Marlin/src/module/motion.cpp` takes the probe's speed for any move that has none.
    if !by_probe
        && look.work.lines.get("safe_z_home.x").is_some()
        && let Some(speed) = look.defines.of("XY_PROBE_FEEDRATE")
    {
        look.work.set_number("safe_z_home.speed", speed / 60.0, "XY_PROBE_FEEDRATE");
    }
}

/// The order of axes.
fn order(look: &mut Look<'_, '_, '_>) {
    let (y_first, z_first) = (look.on("HOME_Y_BEFORE_X"), look.on("HOME_Z_FIRST"));
    let mut order = if y_first.is_some() { vec!["y", "x"] } else { vec!["x", "y"] };
    order.insert(if z_first.is_some() { 0 } else { 2 }, "z");
    let order: Vec<toml::Value> = order.into_iter().map(Into::into).collect();
    for entry in [y_first, z_first].into_iter().flatten() {
        look.work.take(entry, "homing.order", order.clone());
    }
}
