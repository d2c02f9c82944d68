//! The bed: its mesh, the screws or belts that level it, and the place where Z is homed.

use super::work::Work;
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

/// Translates the place where Z is homed, the mesh, and the screws.
pub(super) fn bed(work: &mut Work<'_>) {
    if let Some((entry, text)) = work.value("safe_z_home", "home_xy_position") {
        match places(text)[..] {
            [[x, y]] => {
                work.take_number(entry, "probe.home.x", x);
                work.take_number(entry, "probe.home.y", y);
            }
            _ => work.say(entry, Kind::Decide, "no place: correct it"),
        }
    }
    mesh(work);
    for section in ["z_tilt", "z_tilt_ng"] {
        screws(work, section, "z_positions", ["x", "y"], |places| places);
        screws(work, section, "points", ["point_x", "point_y"], |places| places);
    }
    // Belts at the corners of the gantry, in the order of its motors: from the front left, clockwise from above.
    let corners = |places: Vec<[f64; 2]>| match places[..] {
        [[left, front], [right, back]] => vec![[left, front], [left, back], [right, back], [right, front]],
        _ => places,
    };
    screws(work, "quad_gantry_level", "gantry_corners", ["x", "y"], corners);
    screws(work, "quad_gantry_level", "points", ["point_x", "point_y"], |places| places);
}

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
    if let Some((entry, fade)) = work.number("bed_mesh", "fade_end") {
        work.take_number(entry, "mesh.fade", fade);
    }
    for key in ["mesh_min", "mesh_max"] {
        if let Some((entry, _)) = work.value("bed_mesh", key) {
            work.say(entry, Kind::Approximated, "G29 measures all that the probe reaches, or the area of its words");
        }
    }
}

/// Takes the places of a key for the screws, in the order of the motors.
fn screws(
    work: &mut Work<'_>,
    section: &str,
    key: &str,
    axes: [&str; 2],
    order: impl Fn(Vec<[f64; 2]>) -> Vec<[f64; 2]>,
) {
    let Some((entry, text)) = work.value(section, key) else { return };
    let places = order(places(text));
    if places.is_empty() {
        return work.say(entry, Kind::Decide, "no places: correct them");
    }
    if places.len() > SCREWS {
        work.say(entry, Kind::Approximated, format!("the first {SCREWS} of {} places", places.len()));
    }
    for (number, place) in places.into_iter().take(SCREWS).enumerate() {
        for (axis, at) in axes.into_iter().zip(place) {
            work.take_number(entry, &format!("screws.{}.{axis}", number + 1), at);
        }
    }
}
