//! The bed: its mesh, the screws or belts that level it, and the place where Z is homed.

use super::probe::offset;
use super::work::{Work, is_true};
use crate::short::short;
use crate::translation::Kind;

/// Screws that a machine may have (`kinematics::SCREWS`).
const SCREWS: usize = 4;

/// Pairs of numbers, one on each line.
fn places(text: &str) -> Vec<[f64; 2]> {
    let numbers = |line: &str| {
        let (x, y) = line.split_once(',')?;
        Some([x.trim().parse().ok()?, y.trim().parse().ok()?])
    };
    text.lines().filter_map(numbers).collect()
}

/// A place in Klipper's files.
#[derive(Clone, Copy)]
enum Of {
    /// Of the nozzle while the probe touches: the probe is elsewhere by its offset, and our places are the probe's.
    Nozzle,
    /// Of a part of the machine.
    Part,
}

/// Translates the place where Z is homed, the mesh, and the screws.
pub(super) fn bed(work: &mut Work<'_>) {
    home(work);
    mesh(work);
    // Klipper's reference of each key says what its places are: `points` are the nozzle's, and so is
    // `home_xy_position`; `z_positions`, `gantry_corners` and the area of a mesh are not (docs/Config_Reference.md).
    for section in ["z_tilt", "z_tilt_ng"] {
        screws(work, section, "z_positions", Of::Part, |places| places);
        screws(work, section, "points", Of::Nozzle, |places| places);
    }
    // Belts at the corners of the gantry, in the order of its motors: from the front left, clockwise from above.
    let corners = |places: Vec<[f64; 2]>| match places[..] {
        [[left, front], [right, back]] => vec![[left, front], [left, back], [right, back], [right, front]],
        _ => places,
    };
    screws(work, "quad_gantry_level", "gantry_corners", Of::Part, corners);
    screws(work, "quad_gantry_level", "points", Of::Nozzle, |places| places);
}

/// The place where Z is homed, and what goes before homing.
fn home(work: &mut Work<'_>) {
    if let Some((entry, text)) = work.value("safe_z_home", "home_xy_position") {
        let by_probe = work.lines.get("probe.z_home").is_some();
        match places(text)[..] {
            [place] if by_probe => place_of_probe(work, entry, place, ["probe.home.x", "probe.home.y"]),
            [place] => place_of_nozzle(work, entry, place),
            _ => work.say(entry, Kind::Decide, "no place: correct it"),
        }
    }
    if work.lines.get("probe.z_home").is_none()
        && let Some((entry, speed)) = work.number("safe_z_home", "speed")
    {
        work.take_number(entry, "safe_z_home.speed", speed);
    }
    if let Some((entry, text)) = work.value("safe_z_home", "move_to_previous") {
        work.take(entry, "safe_z_home.move_to_previous", is_true(text));
    }
    if let Some((entry, _)) = work.value("homing_override", "gcode") {
        let axes = work.value("homing_override", "axes").map_or("xyz", |(_, axes)| axes);
        let text = format!(
            "G-code of yours homes {}: here G28 homes in homing.order, and Z at probe.home or [safe_z_home]; look what \
             your lines do before and after, and write it around G28",
            short(axes)
        );
        work.say(entry, Kind::Decide, text);
    }
    for axis in ["x", "y", "z"] {
        if let Some((entry, place)) = work.number("homing_override", &format!("set_position_{axis}")) {
            let text = format!("before homing Klipper takes {axis} for {place}, so that it may move: G28 R raises Z");
            work.say(entry, Kind::Decide, text);
        }
    }
}

/// Takes the place of the nozzle at which a switch homes Z; one that it does not reach is for the owner to decide.
fn place_of_nozzle(work: &mut Work<'_>, entry: usize, nozzle: [f64; 2]) {
    for (axis, at) in ["x", "y"].into_iter().zip(nozzle) {
        work.take_number(entry, &format!("safe_z_home.{axis}"), at);
        if let Some((least, length)) = reach(work, axis) {
            hold(work, entry, axis, ("the nozzle", at, least, least + length));
        }
    }
}

/// Where an axis begins, and its length, as far as they are known.
fn reach(work: &Work<'_>, axis: &str) -> Option<(f64, f64)> {
    let number = |leaf: &str| work.lines.number(&format!("axes.{axis}.{leaf}"));
    let length = number("length").filter(|length| *length > 0.0)?;
    Some((number("min").unwrap_or(0.0), length))
}

/// Says if something at this place of an axis is outside of its reach.
fn hold(work: &mut Work<'_>, entry: usize, axis: &str, (what, at, least, most): (&str, f64, f64, f64)) {
    if at < least - SLACK || at > most + SLACK {
        let text = format!("{what} would be at {axis} {at}, and reaches from {least} to {most}: choose another");
        work.say(entry, Kind::Decide, text);
    }
}

/// Takes a place of the nozzle as the probe's; one that the nozzle or the probe does not reach is for the owner to
/// decide.
fn place_of_probe(work: &mut Work<'_>, entry: usize, nozzle: [f64; 2], paths: [&str; 2]) {
    let offset = offset(work);
    for (((axis, path), at), offset) in ["x", "y"].into_iter().zip(paths).zip(nozzle).zip(offset) {
        let probe = at + offset;
        work.take_number(entry, path, probe);
        if offset != 0.0 {
            work.say(entry, Kind::Taken, format!("the probe's, {offset} from the nozzle's {at}"));
        }
        let Some((least, length)) = reach(work, axis) else { continue };
        let number = |leaf: &str| work.lines.number(leaf);
        let (from, size) = if axis == "x" { ("bed.left", "bed.width") } else { ("bed.front", "bed.depth") };
        let (begin, size) = (number(from).unwrap_or(least), number(size).unwrap_or(length));
        for held in [("the nozzle", at, least, least + length), ("the probe", probe, begin, begin + size)] {
            hold(work, entry, axis, held);
        }
    }
}

/// Rounding of places, in mm: points of screws are whole here.
const SLACK: f64 = 0.5;

fn mesh(work: &mut Work<'_>) {
    if let Some((entry, text)) = work.value("bed_mesh", "probe_count") {
        let counts: Option<Vec<f64>> = text.split(',').map(|count| count.trim().parse().ok()).collect();
        match counts.as_deref() {
            Some([columns, rows]) => {
                work.take_number(entry, "mesh.columns", *columns);
                work.take_number(entry, "mesh.rows", *rows);
            }
            Some([both]) => {
                work.take_number(entry, "mesh.columns", *both);
                work.take_number(entry, "mesh.rows", *both);
            }
            _ => work.say(entry, Kind::Decide, "no number of points: correct it"),
        }
    }
    round_mesh(work);
    if let Some((entry, fade)) = work.number("bed_mesh", "fade_end") {
        work.take_number(entry, "mesh.fade", fade);
    }
    if let Some((entry, _)) = work.number("bed_mesh", "fade_start") {
        work.say(entry, Kind::Approximated, "the mesh fades from z = 0 on");
    }
    if let Some((entry, _)) = work.value("bed_mesh", "zero_reference_position") {
        work.say(entry, Kind::NotYet, "a mesh is 0 where Z is homed (probe.home)");
    }
    for key in ["mesh_min", "mesh_max"] {
        if let Some((entry, _)) = work.value("bed_mesh", key) {
            work.say(entry, Kind::Approximated, "G29 measures all that the probe reaches, or the area of its words");
        }
    }
}

/// A round mesh has as many points across (`bed_mesh.py`, round_probe_count and its default); ours is a rectangle.
fn round_mesh(work: &mut Work<'_>) {
    const ROUND: f64 = 5.0;
    let is_round = work.number("bed_mesh", "mesh_radius").is_some();
    match work.number("bed_mesh", "round_probe_count") {
        Some((entry, count)) => {
            for path in ["mesh.columns", "mesh.rows"] {
                work.take_number(entry, path, count);
            }
            work.say(entry, Kind::Approximated, "a mesh is a rectangle: all that the probe reaches");
        }
        None if is_round => ["mesh.columns", "mesh.rows"].iter().for_each(|path| work.set_default(path, ROUND)),
        None => {}
    }
}

/// Takes the places of a key for the screws, in the order of the motors.
fn screws(work: &mut Work<'_>, section: &str, key: &str, of: Of, order: impl Fn(Vec<[f64; 2]>) -> Vec<[f64; 2]>) {
    let Some((entry, text)) = work.value(section, key) else { return };
    let places = order(places(text));
    if places.is_empty() {
        return work.say(entry, Kind::Decide, "no places: correct them");
    }
    if places.len() > SCREWS {
        work.say(entry, Kind::Approximated, format!("the first {SCREWS} of {} places", places.len()));
    }
    let leaves = match of {
        Of::Nozzle => ["point_x", "point_y"],
        Of::Part => ["x", "y"],
    };
    for (number, place) in places.into_iter().take(SCREWS).enumerate() {
        let paths = leaves.map(|leaf| format!("screws.{}.{leaf}", number + 1));
        match (of, paths.each_ref().map(String::as_str)) {
            (Of::Nozzle, paths) => place_of_probe(work, entry, place, paths),
            (Of::Part, paths) => paths.into_iter().zip(place).for_each(|(path, at)| work.take_number(entry, path, at)),
        }
    }
}
