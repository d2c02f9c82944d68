//! Drawings of the tool's path at step resolution, and of a CoreXYZ's gantry that belts tilt.

use crate::queries::level::{Case, Kind, Level};
use crate::queries::zigzag::{AXES, Zigzag};
use corehbot_report::svg::{Anchor, COLOURS, Drawing};
use corehbot_twin::routing::Machine;

/// Gap between panels, and room for their titles, in pixels.
const GAP: f64 = 24.0;

/// The paths of some machines, one below the other, each from above, from the front and from the right.
#[must_use]
pub fn zigzag(machines: &[Zigzag]) -> String {
    const VIEW: f64 = 200.0;
    const HIGH: f64 = 110.0;
    /// Title and axes of a view: which coordinate is drawn to the right and which up.
    const VIEWS: [(&str, usize, usize); 3] = [("from above", 0, 1), ("from the front", 0, 2), ("from the right", 1, 2)];
    let width = 3.0 * (VIEW + GAP) + GAP;
    let height = machines.len() as f64 * (HIGH + 2.3 * GAP) + 1.6 * GAP;
    let mut drawing = Drawing::new([width, height], "the tool's path at step resolution");
    for (row, path) in machines.iter().enumerate() {
        let top = row as f64 * (HIGH + 2.3 * GAP) + 1.5 * GAP;
        let order = path.order.join(" ");
        let title =
            format!("{}: {order}, steps of {} mm in {}", Machine::name_of(path.machine), path.step_mm, path.axis);
        drawing.text([GAP, top - 18.0], Anchor::Start, &title, "font-weight=\"bold\"");
        let lifts = path.one_after_the_other_mm.iter().any(|place| place[2] != 0.0);
        // One scale for all views of a machine; the path begins in the middle of what it needs.
        let all = || path.one_after_the_other_mm.iter().chain(&path.in_one_instant_mm);
        let range =
            |axis: usize| all().fold([0.0_f64; 2], |[low, high], place| [low.min(place[axis]), high.max(place[axis])]);
        let ranges = [range(0), range(1), range(2)];
        let extent = |[low, high]: [f64; 2]| f64::max(high - low, path.step_mm / 2.0);
        let fits = |(_, right, up): &(&str, usize, usize)| {
            let (across, upward) = (extent(ranges[*right]), extent(ranges[*up]));
            (0.8 * VIEW / across).min(0.8 * HIGH / upward)
        };
        let scale = VIEWS.iter().map(fits).fold(f64::INFINITY, f64::min);
        let views = VIEWS.iter().take(if lifts { 3 } else { 1 });
        for (column, (name, right, up)) in views.enumerate() {
            let left = column as f64 * (VIEW + GAP) + GAP;
            let middle = |axis: usize| (ranges[axis][0] + ranges[axis][1]) / 2.0;
            let at = |place: &[f64; 3]| {
                let x = left + VIEW / 2.0 + (place[*right] - middle(*right)) * scale;
                [x, top + HIGH / 2.0 - (place[*up] - middle(*up)) * scale]
            };
            drawing.rectangle([left, top], [left + VIEW, top + HIGH], "class=\"thin\"");
            let about = format!("{name}: {} right, {} up", AXES[*right], AXES[*up]);
            drawing.text([left + 3.0, top - 4.0], Anchor::Start, &about, "class=\"small\"");
            let line = |drawing: &mut Drawing, places: &[[f64; 3]], colour: &str, dot: f64| {
                let places: Vec<[f64; 2]> = places.iter().map(at).collect();
                drawing.polyline(&places, &format!("stroke=\"{colour}\" stroke-width=\"1.3\""));
                places.iter().for_each(|place| drawing.circle(*place, dot, &format!("fill=\"{colour}\"")));
            };
            line(&mut drawing, &path.one_after_the_other_mm, COLOURS[1], 2.0);
            line(&mut drawing, &path.in_one_instant_mm, COLOURS[0], 3.0);
        }
        let legend = format!("widest {:.4} steps aside", path.aside_steps);
        drawing.text([GAP, top + HIGH + 14.0], Anchor::Start, &legend, "class=\"small\"");
    }
    for (index, (name, colour)) in
        [("one after the other", COLOURS[1]), ("in one instant", COLOURS[0])].iter().enumerate()
    {
        let place = [GAP + 150.0 * index as f64, height - 10.0];
        drawing.circle([place[0] + 4.0, place[1] - 4.0], 3.0, &format!("fill=\"{colour}\""));
        drawing.text([place[0] + 12.0, place[1]], Anchor::Start, name, "class=\"small\"");
    }
    drawing.finish()
}

/// The gantry and its bar in the cases of belts and motors, and the bar under the preload, seen from the front right.
#[must_use]
pub fn level(level: &Level) -> String {
    const PANEL: [f64; 2] = [230.0, 150.0];
    const COLUMNS: usize = 3;
    let drawn = level.cases.iter().filter(|case| case.kind != Kind::Motion);
    // Those would be one picture again and again.
    let (flat, cases): (Vec<&Case>, Vec<&Case>) = drawn.partition(|case| is_flat(case));
    let rows = cases.len().div_ceil(COLUMNS);
    let size = [COLUMNS as f64 * PANEL[0], rows as f64 * PANEL[1] + 36.0];
    let mut drawing = Drawing::new(size, "a CoreXYZ's gantry, tilted and racked by its belts");
    for (index, case) in cases.iter().enumerate() {
        let corner = [(index % COLUMNS) as f64 * PANEL[0], (index / COLUMNS) as f64 * PANEL[1]];
        gantry(&mut drawing, corner, case);
    }
    let about = format!(
        "belts taken up and motors turned by {} mm; each panel has its own scale of tilt and racking, dashed is level",
        level.taken_up_mm
    );
    drawing.text([8.0, size[1] - 22.0], Anchor::Start, &about, "class=\"small\"");
    let names: Vec<&str> = flat.iter().map(|case| case.name.as_str()).collect();
    let names = format!("level and not racked: {}", names.join("; "));
    drawing.text([8.0, size[1] - 6.0], Anchor::Start, &names, "class=\"small\"");
    drawing.finish()
}

/// mrad and mm that count as none.
const NONE: f64 = 1e-6;

/// Whether the gantry stays level and the bar square.
fn is_flat(case: &Case) -> bool {
    case.bar_mrad.abs() < NONE && case.corners_mm.iter().all(|rise| rise.abs() < NONE)
}

/// One gantry as a parallelogram with its bar.
fn gantry(drawing: &mut Drawing, [left, top]: [f64; 2], case: &Case) {
    /// Pixels of the largest rise, and of the largest way of the bar's end.
    const FARTHEST: f64 = 13.0;
    let most = case.corners_mm.iter().fold(0.0_f64, |most, rise| most.max(rise.abs()));
    let per_mm = if most > NONE { FARTHEST / most } else { 0.0 };
    let racked = if case.bar_mrad.abs() > NONE { 0.12 * case.bar_mrad.signum() } else { 0.0 };
    // x to the right and y into the depth, of 1 about the middle; a rise goes up.
    let at = |x: f64, y: f64, rise: f64| {
        [left + 115.0 + 112.0 * x + 34.0 * y, top + 74.0 + 10.0 * x - 44.0 * y - rise * per_mm]
    };
    const CORNERS: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let outline = |rises: [f64; 4]| {
        let mut places: Vec<[f64; 2]> = CORNERS.iter().zip(rises).map(|([x, y], rise)| at(*x, *y, rise)).collect();
        places.extend(places.first().copied());
        places
    };
    drawing.polyline(&outline([0.0; 4]), "stroke=\"#999\" stroke-dasharray=\"3 3\"");
    drawing.polyline(&outline(case.corners_mm), &format!("stroke=\"{}\" stroke-width=\"2\"", COLOURS[0]));
    let [front_left, front_right, back_right, back_left] = case.corners_mm;
    let middle = |a: f64, b: f64| (a + b) / 2.0;
    let bar = [at(-0.5, -racked, middle(front_left, back_left)), at(0.5, racked, middle(front_right, back_right))];
    drawing.polyline(&bar, &format!("stroke=\"{}\" stroke-width=\"3\"", COLOURS[1]));
    drawing.text([left + 8.0, top + 16.0], Anchor::Start, &case.name, "font-weight=\"bold\"");
    for ([x, y], rise) in CORNERS.iter().zip(case.corners_mm) {
        let [px, py] = at(*x, *y, rise);
        let (anchor, aside) = if *x < 0.0 { (Anchor::End, -4.0) } else { (Anchor::Start, 4.0) };
        drawing.text([px + aside, py + 4.0], anchor, &format!("{:+.3}", rounded(rise)), "class=\"small\"");
    }
    let numbers = format!("bar {:+.3} mrad; corners in mm", rounded(case.bar_mrad));
    drawing.text([left + 8.0, top + 138.0], Anchor::Start, &numbers, "class=\"small\"");
}

/// To three decimals, without -0.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0 + 0.0
}
