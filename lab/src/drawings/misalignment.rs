//! Misalignment: what pulleys off their places do to tension and tool along both strokes, as a drawing.

use crate::queries::misalignment::{Misalignment, OnStroke};
use corehbot_report::svg::chart::{Chart, Curve, Look};
use corehbot_report::svg::{Anchor, Drawing};

/// Size of a chart, in pixels.
const SIZE: [f64; 2] = [316.0, 240.0];

/// Draws it.
#[must_use]
pub fn picture(answer: &Misalignment) -> String {
    let off = |offset: &crate::queries::misalignment::Offset| {
        let [x, y] = offset.off_mm;
        format!("{} by ({x}, {y}) mm", offset.pulley)
    };
    let title = format!("Pulleys off their places: {}", answer.offsets.iter().map(off).collect::<Vec<_>>().join(", "));
    let mut drawing = Drawing::new([960.0, 300.0], &title);
    drawing.text([12.0, 20.0], Anchor::Start, &title, "class=\"title\"");
    let along_y = tensions(&answer.along_y, "Tension along the stroke of y", "y, mm", |place| place.y_mm);
    let along_x = tensions(&answer.along_x, "Tension along the stroke of x", "x, mm", |place| place.x_mm);
    for (index, chart) in [&along_y, &along_x, &tool(answer)].into_iter().enumerate() {
        chart.draw(&mut drawing, [4.0 + SIZE[0] * index as f64, 30.0], SIZE);
    }
    along_y.legend(&mut drawing, [60.0, 58.0]);
    tool(answer).legend(&mut drawing, [60.0 + 2.0 * SIZE[0], 58.0]);
    drawing.finish()
}

/// The change of each span's tension.
fn tensions(stroke: &[OnStroke], title: &str, axis: &str, at: fn(&OnStroke) -> f64) -> Chart {
    let names = stroke.first().map(|place| place.tension_change_n.keys().copied()).into_iter().flatten();
    let curve = |(colour, name): (usize, &str)| Curve {
        name: format!("span {name}"),
        colour,
        // Spans that pull alike lie on each other.
        look: if colour % 2 == 1 { Look::Dashed } else { Look::Solid },
        places: stroke
            .iter()
            .map(|place| [at(place), place.tension_change_n.get(name).copied().unwrap_or(0.0)])
            .collect(),
    };
    let curves = names.enumerate().map(curve).collect();
    Chart { title: title.to_owned(), axes: [axis, "N"].map(str::to_owned), curves }
}

/// Displacement of the tool along both strokes.
fn tool(answer: &Misalignment) -> Chart {
    type Of = fn(&OnStroke) -> f64;
    let curve = |(colour, (name, stroke, at, of)): (usize, (&str, &[OnStroke], Of, Of))| Curve {
        name: name.to_owned(),
        colour,
        look: if colour % 2 == 1 { Look::Dashed } else { Look::Solid },
        places: stroke.iter().map(|place| [at(place), 1000.0 * of(place)]).collect(),
    };
    let curves: [(&str, &[OnStroke], Of, Of); 4] = [
        ("dx along y", &answer.along_y, |place| place.y_mm, |place| place.dx_mm),
        ("dy along y", &answer.along_y, |place| place.y_mm, |place| place.dy_mm),
        ("dx along x", &answer.along_x, |place| place.x_mm, |place| place.dx_mm),
        ("dy along x", &answer.along_x, |place| place.x_mm, |place| place.dy_mm),
    ];
    let axes = ["place on the stroke, mm", "um"].map(str::to_owned);
    Chart {
        title: "Displacement of the tool".to_owned(),
        axes,
        curves: curves.into_iter().enumerate().map(curve).collect(),
    }
}
