//! Workspaces: the reach of the three machines in their frame, to scale.

use corehbot_report::svg::{Anchor, COLOURS, Drawing, number};
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::routing::Machine;

/// The three machines, with the width of the head for which the paper has their reach, in radii of a pulley.
const MACHINES: [(Machine, f64); 3] = [(Machine::CoreHBot, 2.0), (Machine::HBot, 0.0), (Machine::CoreXy, 0.0)];

/// Pixels per mm.
const SCALE: f64 = 0.62;

/// Two panels: each machine with the smallest head, and all with the prototype's.
pub(super) fn workspaces() -> String {
    let mut drawing = Drawing::new([860.0, 440.0], "The reach of CoreH-bot, H-bot and CoreXY");
    let nominal = Params::default();
    let small = |radii: f64| Params { head_pulleys_mm: radii * nominal.pulley_radius_mm, ..nominal.clone() };
    let same = |_: f64| nominal.clone();
    let panels: [(&str, &dyn Fn(f64) -> Params); 2] =
        [("heads as small as can be (equations 20 and 21)", &small), ("heads of 80 mm", &same)];
    for ((name, params), left) in panels.into_iter().zip([24.0, 450.0]) {
        drawing.text([left, 22.0], Anchor::Start, name, "class=\"title\"");
        let at = |x: f64, y: f64| [left + SCALE * x, 330.0 - SCALE * y];
        drawing.rectangle(at(0.0, 0.0), at(nominal.width_mm, nominal.depth_mm), "fill=\"#f6f6f6\" stroke=\"#999\"");
        drawing.text(at(4.0, 4.0), Anchor::Start, "frame W x D, between the motors' axes", "class=\"small\"");
        for (index, (machine, radii)) in MACHINES.into_iter().enumerate() {
            let reach = workspace(machine, &params(radii));
            let colour = COLOURS.get(index % COLOURS.len()).copied().unwrap_or("#222");
            let dash = ["", " stroke-dasharray=\"8 4\"", " stroke-dasharray=\"2 4\""].get(index).copied().unwrap_or("");
            let style = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dash}");
            drawing.rectangle(at(reach.x[0], reach.y[0]), at(reach.x[1], reach.y[1]), &style);
            let [wide, deep] = [reach.x, reach.y].map(|[low, high]| high - low);
            let line = 356.0 + 16.0 * index as f64;
            drawing.line([left, line - 4.0], [left + 24.0, line - 4.0], &style);
            let text = format!(
                "{}: x {} to {}, y {} to {} mm; {} x {} mm, {} cm2",
                machine.name(),
                number(reach.x[0]),
                number(reach.x[1]),
                number(reach.y[0]),
                number(reach.y[1]),
                number(wide),
                number(deep),
                number(wide * deep / 100.0)
            );
            drawing.text([left + 30.0, line], Anchor::Start, &text, "class=\"small\"");
        }
    }
    let note = "y is the middle of the bar on each machine. Equation 21 counts y of H-bot and CoreXY from the belt's line at the head, 19.85 mm in front of it.";
    drawing.text([12.0, 424.0], Anchor::Start, note, "class=\"small\"");
    drawing.finish()
}
