//! Drawings of figures 3 to 5 of Yin et al., computed again.

use crate::yin::figure::{Errors, Figure3, Figure4, Figure5, MODELS, Panel, SPEEDS, Trend, WAYS};
use corehbot_report::svg::chart::{Chart, Curve, Look};
use corehbot_report::svg::{Anchor, COLOURS, Drawing};
use corehbot_twin::math::hypot;

/// Nearer to its line than this, a place of a path is left out, in pixels.
const FINE: f64 = 0.15;

/// Figure 3: for each speed (columns) and way round (rows) the ideal path and both models' paths.
#[must_use]
pub fn figure_3(figure: &Figure3) -> String {
    const PANEL: f64 = 250.0;
    const MARGIN: f64 = 30.0;
    let mut drawing =
        Drawing::new([3.0 * PANEL, 2.0 * PANEL + 40.0], "Yin et al., figure 3, on a rig of assumed numbers");
    for (index, panel) in figure.panels.iter().enumerate() {
        let (row, column) = (index / SPEEDS.len(), index % SPEEDS.len());
        let [left, top] = [column as f64 * PANEL + MARGIN, row as f64 * PANEL + MARGIN + 4.0];
        // Room for overshoot, a twentieth of the side.
        let scale = (PANEL - 1.5 * MARGIN) / (1.1 * figure.side_mm);
        let at = |[x, y]: [f64; 2]| {
            let inner = 0.05 * figure.side_mm;
            [left + (x + inner) * scale, top + (figure.side_mm + inner - y) * scale]
        };
        let title = format!("{} m/s, {}", panel.speed_m_s, panel.direction);
        drawing.text([left, top - 6.0], Anchor::Start, &title, "");
        drawing.rectangle(at([0.0; 2]), at([figure.side_mm; 2]), "fill=\"none\" stroke=\"#009e73\"");
        for (path, colour) in panel.paths.iter().zip(COLOURS) {
            let places: Vec<[f64; 2]> = path.places.iter().copied().map(at).collect();
            drawing.polyline(&simpler(&places), &format!("stroke=\"{colour}\" stroke-width=\"1.3\""));
        }
        drawing.circle(at([0.0; 2]), 3.0, "fill=\"#222\"");
        for (place, (corner, name)) in corners(panel, figure.side_mm).into_iter().enumerate() {
            let window = [left + 22.0 + 92.0 * place as f64, top + 66.0];
            close_up(&mut drawing, window, panel, corner);
            drawing.text([window[0], window[1] - 4.0], Anchor::Start, name, "class=\"small\"");
        }
    }
    let y = 2.0 * PANEL + 26.0;
    let names = MODELS.map(|(_, name)| name).into_iter().zip(COLOURS).chain([("ideal", COLOURS[2])]);
    for (index, (name, colour)) in names.enumerate() {
        let x = MARGIN + 110.0 * index as f64;
        drawing.line([x, y - 4.0], [x + 24.0, y - 4.0], &format!("stroke=\"{colour}\" stroke-width=\"2\""));
        drawing.text([x + 30.0, y], Anchor::Start, name, "class=\"small\"");
    }
    let about = format!("a square of {} mm (assumed), from the dot; inside, 2.4 mm about two corners", figure.side_mm);
    drawing.text([MARGIN + 340.0, y], Anchor::Start, &about, "class=\"small\"");
    drawing.finish()
}

/// The corners of both turns that count, with their names.
fn corners(panel: &Panel, side: f64) -> [([f64; 2], &'static str); 2] {
    let [x_to_y, y_to_x] =
        if panel.direction == WAYS[0].1 { [[0.0, side], [side, side]] } else { [[side, side], [side, 0.0]] };
    [(x_to_y, Errors::TURNS[0]), (y_to_x, Errors::TURNS[1])]
}

/// The paths about a corner, 2.4 mm wide.
fn close_up(drawing: &mut Drawing, window: [f64; 2], panel: &Panel, corner: [f64; 2]) {
    const SIZE: f64 = 82.0;
    const HALF_MM: f64 = 1.2;
    let at = |[x, y]: [f64; 2]| {
        let part = [x - corner[0], corner[1] - y].map(|v| (v / HALF_MM + 1.0) / 2.0 * SIZE);
        [window[0] + part[0], window[1] + part[1]]
    };
    let is_near = |place: &&[f64; 2]| (0..2).all(|axis| (place[axis] - corner[axis]).abs() <= HALF_MM);
    drawing.rectangle(window, [window[0] + SIZE, window[1] + SIZE], "class=\"thin\"");
    let outwards = [0, 1].map(|axis| if corner[axis] > 0.0 { 1.0 } else { -1.0 });
    let sides = [
        at([corner[0] - HALF_MM * outwards[0], corner[1]]),
        at(corner),
        at([corner[0], corner[1] - HALF_MM * outwards[1]]),
    ];
    drawing.polyline(&sides, &format!("stroke=\"{}\"", COLOURS[2]));
    for (path, colour) in panel.paths.iter().zip(COLOURS) {
        let places: Vec<[f64; 2]> = path.places.iter().filter(is_near).copied().map(at).collect();
        drawing.polyline(&simpler(&places), &format!("stroke=\"{colour}\" stroke-width=\"1.3\""));
    }
}

/// Figure 4: the errors of both turns over the speed; the names have R2 of the least-squares lines.
#[must_use]
pub fn figure_4(figure: &Figure4) -> String {
    let chart = |turn: usize, name: &str| {
        let curve = |trend: &Trend| {
            let r_squared = trend.lines.get(turn).map_or(0.0, |line| line.r_squared);
            Curve {
                name: format!("{}, {}: R2 of a line {r_squared:.5}", trend.model, trend.direction),
                colour: MODELS.iter().position(|(_, name)| *name == trend.model).unwrap_or(0),
                look: look(trend.direction),
                places: trend.points(turn).iter().map(|(v, error)| [*v, *error]).collect(),
            }
        };
        let curves = figure.trends.iter().map(curve).collect();
        Chart { title: format!("from {name}"), axes: ["speed, m/s".to_owned(), "contour error, mm".to_owned()], curves }
    };
    charts(
        "Yin et al., figure 4, on a rig of assumed numbers",
        [chart(0, Errors::TURNS[0]), chart(1, Errors::TURNS[1])],
    )
}

/// Figure 5: the errors of both turns over relative parameters, by the full model.
#[must_use]
pub fn figure_5(figure: &Figure5) -> String {
    let chart = |turn: usize, name: &str| {
        let curve = |one: &crate::yin::figure::Varied| {
            let exponent = one.exponents.get(turn).copied().flatten();
            let exponent = exponent.map_or_else(|| "no exponent".to_owned(), |n| format!("exponent {n:.2}"));
            let colour = ["friction", "stiffness", "mass"].iter().position(|name| *name == one.name).unwrap_or(0);
            let places = one.points(turn).iter().map(|(factor, error)| [*factor, *error]).collect();
            let name = format!("{}, {}: {exponent}", one.name, one.direction);
            Curve { name, colour, look: look(one.direction), places }
        };
        let curves = figure.varied.iter().map(curve).collect();
        let title = format!("from {name}, {} m/s", figure.speed_m_s);
        Chart { title, axes: ["relative parameter".to_owned(), "contour error, mm".to_owned()], curves }
    };
    charts(
        "Yin et al., figure 5, on a rig of assumed numbers",
        [chart(0, Errors::TURNS[0]), chart(1, Errors::TURNS[1])],
    )
}

/// The paper's way round is a line. The other one has nearly the same errors, so it is rings about the line.
fn look(direction: &str) -> Look {
    if direction == WAYS[0].1 { Look::Solid } else { Look::Rings }
}

/// Two charts side by side, each with its legend below.
fn charts(title: &str, both: [Chart; 2]) -> String {
    const SIZE: [f64; 2] = [370.0, 280.0];
    let lines = both.iter().map(|chart| chart.curves.len()).max().unwrap_or(0);
    let mut drawing = Drawing::new([2.0 * SIZE[0], SIZE[1] + 14.0 * lines as f64 + 12.0], title);
    for (index, chart) in both.iter().enumerate() {
        let left = index as f64 * SIZE[0];
        chart.draw(&mut drawing, [left, 0.0], SIZE);
        chart.legend(&mut drawing, [left + 52.0, SIZE[1]]);
    }
    drawing.finish()
}

/// A path with fewer places: each left-out place is nearer than [`FINE`] to the line (Douglas and Peucker, 1973).
fn simpler(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut keeps = vec![false; places.len()];
    let mut parts = vec![(0, places.len().saturating_sub(1))];
    while let Some((from, to)) = parts.pop() {
        let (Some(a), Some(b)) = (places.get(from), places.get(to)) else { continue };
        [from, to].into_iter().for_each(|end| keeps.iter_mut().skip(end).take(1).for_each(|keep| *keep = true));
        let inner = places.iter().enumerate().take(to).skip(from + 1);
        let farthest = inner.map(|(i, place)| (i, distance(*place, *a, *b))).max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((middle, far)) = farthest
            && far > FINE
        {
            parts.extend([(from, middle), (middle, to)]);
        }
    }
    places.iter().zip(keeps).filter(|(_, keep)| *keep).map(|(place, _)| *place).collect()
}

/// Distance of a place from a chord.
fn distance([x, y]: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let square = dx * dx + dy * dy;
    let part = if square > 0.0 { (((x - a[0]) * dx + (y - a[1]) * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    hypot(x - a[0] - part * dx, y - a[1] - part * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_keeps_its_corners_and_loses_the_places_between() {
        let around: Vec<[f64; 2]> = (0..=200)
            .map(f64::from)
            .map(|i| if i < 100.0 { [i, 0.05 * (i % 2.0)] } else { [100.0, i - 100.0] })
            .collect();
        assert_eq!(simpler(&around), [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]);
        assert_eq!(simpler(&[]), Vec::<[f64; 2]>::new());
        assert_eq!(simpler(&[[1.0, 1.0]; 3]).len(), 2);
    }
}
