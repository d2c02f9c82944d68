//! Freedom: where the tool can still go while a belt holds it. One belt of a CoreXY leaves a line, one of a CoreXYZ a
//! plane, and its motor shifts it (Carlyle, CoreXYZ, 2014). The tool is where all of them meet.

use corehbot_report::svg::{Anchor, COLOURS, Drawing};
use corehbot_twin::math::atan2;
use corehbot_twin::model::ways::Ways;
use corehbot_twin::params::Params;
use corehbot_twin::routing::Machine;

/// Size of a panel in pixels.
const PANEL: [f64; 2] = [190.0, 200.0];

/// Panels of a row.
const COLUMNS: usize = 4;

/// How far the motor has turned in the dashed place, as a part of the cube.
const TURNED: f64 = 0.4;

/// Nearer to each other than this, two places are one.
const SAME: f64 = 1e-9;

/// Letters of the motors in Carlyle's text, with the machine: the order of its rows.
const MACHINES: [(Machine, &[&str]); 2] = [(Machine::CoreXy, &["A", "B"]), (Machine::CoreXyz, &["D", "C", "B", "A"])];

/// The lines of a CoreXY, and the planes of a CoreXYZ.
#[must_use]
pub fn freedom() -> String {
    let size = [COLUMNS as f64 * PANEL[0], MACHINES.len() as f64 * PANEL[1] + 24.0];
    let mut drawing = Drawing::new(size, "where the tool can go while one belt holds it");
    for (row, (machine, letters)) in MACHINES.into_iter().enumerate() {
        let ways = Ways::new(machine, &Params::default());
        for (column, (letter, row_of)) in letters.iter().zip(&ways.rows).enumerate() {
            let corner = [column as f64 * PANEL[0], row as f64 * PANEL[1]];
            panel(&mut drawing, corner, machine, letter, *row_of);
        }
    }
    let about = "solid: the belt holds the tool in the middle of its reach; dashed: its motor has turned";
    drawing.text([8.0, size[1] - 8.0], Anchor::Start, about, "class=\"small\"");
    drawing.finish()
}

/// One belt: the cube or square of the tool's reach, and what the belt leaves.
fn panel(drawing: &mut Drawing, [left, top]: [f64; 2], machine: Machine, letter: &str, row: [f64; 3]) {
    let is_flat = machine.axes() < 3;
    // x to the right, y into the depth (on a flat machine: up), z up, of 1 about the middle.
    let at = |[x, y, z]: [f64; 3]| {
        let [right, up] = if is_flat { [x, y] } else { [x + 0.45 * y, z + 0.3 * y] };
        [left + PANEL[0] / 2.0 + 105.0 * right, top + 112.0 - 105.0 * up]
    };
    let title = format!("{}, belt {letter}", Machine::name_of(machine.key()));
    drawing.text([left + 8.0, top + 16.0], Anchor::Start, &title, "font-weight=\"bold\"");
    for [a, b] in edges(is_flat) {
        drawing.line(at(a), at(b), "class=\"thin\"");
    }
    let length = row.iter().map(|part| part * part).sum::<f64>().sqrt();
    let normal = row.map(|part| part / length);
    for (shift, dash) in [(0.0, ""), (TURNED, " stroke-dasharray=\"5 3\"")] {
        let places: Vec<[f64; 2]> = met(normal, shift, is_flat).into_iter().map(at).collect();
        drawing.polyline(&places, &format!("stroke=\"{}\" stroke-width=\"1.6\"{dash}", COLOURS[0]));
    }
    drawing.arrow(at([0.0; 3]), at(normal.map(|part| part * TURNED)), COLOURS[1]);
}

/// Edges of the cube, or of the square.
fn edges(is_flat: bool) -> Vec<[[f64; 3]; 2]> {
    let ends = |free: usize, others: [f64; 2]| {
        [-0.5, 0.5].map(|along| {
            let mut place = [0.0; 3];
            let mut others = others.into_iter();
            for (axis, part) in place.iter_mut().enumerate() {
                *part = if axis == free { along } else { others.next().unwrap_or(0.0) };
            }
            place
        })
    };
    if is_flat {
        return [0, 1].into_iter().flat_map(|free| [-0.5, 0.5].map(|other| ends(free, [other, 0.0]))).collect();
    }
    const CORNERS: [[f64; 2]; 4] = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
    [0, 1, 2].into_iter().flat_map(|free| CORNERS.map(|others| ends(free, others))).collect()
}

/// Where the edges meet the plane n p = shift, in order around it; closed where it is a polygon.
fn met(normal: [f64; 3], shift: f64, is_flat: bool) -> Vec<[f64; 3]> {
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut places: Vec<[f64; 3]> = Vec::new();
    for [a, b] in edges(is_flat) {
        let [before, after] = [a, b].map(|end| dot(normal, end) - shift);
        if before * after > 0.0 || (before - after).abs() < SAME {
            continue;
        }
        let part = before / (before - after);
        let mut place = a;
        place.iter_mut().zip(b).for_each(|(from, to)| *from += part * (to - *from));
        let is_new = |other: &[f64; 3]| other.iter().zip(place).any(|(a, b)| (a - b).abs() > SAME);
        if places.iter().all(is_new) {
            places.push(place);
        }
    }
    if is_flat {
        return places;
    }
    let count = places.len() as f64;
    let middle = places.iter().fold([0.0; 3], |sum, place| {
        let mut sum = sum;
        sum.iter_mut().zip(place).for_each(|(sum, part)| *sum += part / count);
        sum
    });
    // Two directions within the plane.
    let first = places.first().map_or([1.0, 0.0, 0.0], |place| [0, 1, 2].map(|axis| place[axis] - middle[axis]));
    let second = [
        normal[1] * first[2] - normal[2] * first[1],
        normal[2] * first[0] - normal[0] * first[2],
        normal[0] * first[1] - normal[1] * first[0],
    ];
    let angle = |place: &[f64; 3]| {
        let from = [0, 1, 2].map(|axis| place[axis] - middle[axis]);
        atan2(dot(from, second), dot(from, first))
    };
    places.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    places.extend(places.first().copied());
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagonal_plane_cuts_a_cube_in_a_hexagon_and_a_diagonal_line_a_square_at_two_corners() {
        let part = 1.0 / 3.0_f64.sqrt();
        let hexagon = met([part; 3], 0.0, false);
        // Closed: the first place comes again.
        assert_eq!(hexagon.len(), 7);
        assert!(hexagon.iter().all(|place| place.iter().sum::<f64>().abs() < 1e-12));
        assert_eq!(met([part; 3], 0.4, false).len(), 4);
        let part = 1.0 / 2.0_f64.sqrt();
        assert_eq!(met([part, -part, 0.0], 0.0, true).len(), 2);
    }
}
