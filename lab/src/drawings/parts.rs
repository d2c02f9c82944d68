//! Parts: the errors of reference parts' dimensions by speed, as a drawing.

use crate::parts::figures::{PartFigures, Parts};
use corehbot_report::svg::chart::{Chart, Curve, Look};
use corehbot_report::svg::{Anchor, Drawing};
use corehbot_twin::routing::Machine;

/// The figure of a curve.
type Figure = fn(&PartFigures) -> f64;

/// The charts; the first curve of each is full, the second is dashed.
const CHARTS: [(&str, [Figure; 2]); 5] = [
    ("Square of 40 mm: corner; side, furthest out", [|p| p.square.corner_outside_um, |p| p.square.side_outside_um]),
    ("Disc of 40 mm: diameter along x; y", [|p| p.circle.x_too_large_um, |p| p.circle.y_too_large_um]),
    ("Holes of 6 mm: diameter along x; y", [|p| p.holes.x_too_large_um, |p| p.holes.y_too_large_um]),
    ("Out of round: disc; holes", [|p| p.circle.out_of_round_um, |p| p.holes.out_of_round_um]),
    (
        "Walls of two lines: thickest; thinnest",
        [
            |p| p.wall_along_x.thickest_um.max(p.wall_along_y.thickest_um),
            |p| p.wall_along_x.thinnest_um.min(p.wall_along_y.thinnest_um),
        ],
    ),
];

/// Names of the two curves of all charts.
const NAMES: [&str; 2] = ["the first of each title", "the second"];

/// Size of a chart, in pixels.
const SIZE: [f64; 2] = [316.0, 240.0];

/// Draws them.
#[must_use]
pub fn picture(parts: &Parts) -> String {
    let mut drawing = Drawing::new([960.0, 520.0], "Errors of the dimensions of reference parts by speed");
    drawing.text(
        [12.0, 20.0],
        Anchor::Start,
        "Errors of dimensions by commanded speed; too large is positive",
        "class=\"title\"",
    );
    let place = |index: usize| [4.0 + SIZE[0] * (index % 3) as f64, 30.0 + SIZE[1] * (index / 3) as f64];
    for (index, (title, figures)) in CHARTS.iter().enumerate() {
        chart(parts, title, figures).draw(&mut drawing, place(index), SIZE);
    }
    let [x, y] = place(CHARTS.len());
    let named = chart(parts, "", &[|_| 0.0; 2]);
    named.legend(&mut drawing, [x + 40.0, y + 30.0]);
    drawing.finish()
}

fn chart(parts: &Parts, title: &str, figures: &[Figure; 2]) -> Chart {
    let machines = parts.parts.chunk_by(|a, b| a.machine == b.machine);
    let curves = machines.enumerate().flat_map(|(colour, of)| {
        figures.iter().zip(NAMES).zip([Look::Solid, Look::Dashed]).map(move |((figure, name), look)| Curve {
            name: format!("{}, {name}", Machine::name_of(of.first().map_or("", |p| p.machine))),
            colour,
            look,
            places: of.iter().map(|p| [p.speed_mm_s, figure(p)]).collect(),
        })
    });
    Chart { title: title.to_owned(), axes: ["mm/s", "um"].map(str::to_owned), curves: curves.collect() }
}
