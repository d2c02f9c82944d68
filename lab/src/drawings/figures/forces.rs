//! Forces: tensions on a simple belt, on the bar and the head at rest, and in motions along the axes.

use super::routing::View;
use crate::queries::paper::pattern::Pattern;
use corehbot_report::svg::{Anchor, Drawing, number};
use corehbot_twin::geometry::layout;
use corehbot_twin::model::loads::load;
use corehbot_twin::routing::{Block, Machine, Place, Stop};

const PULLED: &str = "#d55e00";
const PUSHED: &str = "#0072b2";
const NEITHER: &str = "#777";
const FORCE: &str = "#009e73";

/// Figure 7: a belt over two motors that holds a point.
pub(super) fn simple() -> String {
    let mut drawing = Drawing::new([640.0, 270.0], "Figure 7: a belt over two motors");
    let panels =
        [("(a) at rest", ["T", "T", "T"], false), ("(b) P moves to the left", ["T + dT", "T - dT", "T"], true)];
    for (index, (name, [left, right, back], moves)) in (0..).zip(panels) {
        let [x, y, r] = [50.0 + 320.0 * f64::from(index), 120.0, 26.0];
        let end = x + 210.0;
        drawing.text([x - 26.0, 30.0], Anchor::Start, name, "class=\"title\"");
        let [low, high] = [y + r, y - r].map(number);
        let belt = format!(
            "M{} {high}L{} {high}A26 26 0 0 1 {} {low}L{} {low}A26 26 0 0 1 {} {high}",
            number(x),
            number(end),
            number(end),
            number(x),
            number(x)
        );
        drawing.path(&belt, "fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2\"");
        for (at, motor) in [(x, "1"), (end, "2")] {
            drawing.circle([at, y], r - 1.5, "fill=\"#e69f00\" stroke=\"#222\" stroke-dasharray=\"2 1.4\"");
            drawing.text([at, y + 4.0], Anchor::Middle, motor, "");
        }
        let p = [x + 100.0, y - r];
        drawing.rectangle([p[0] - 7.0, p[1] - 7.0], [p[0] + 7.0, p[1] + 7.0], "fill=\"#222\"");
        drawing.text([p[0], p[1] + 22.0], Anchor::Middle, "P", "");
        drawing.text([x + 48.0, y - r - 6.0], Anchor::Middle, left, "");
        drawing.text([x + 158.0, y - r - 6.0], Anchor::Middle, right, "");
        drawing.text([x + 105.0, y + r - 6.0], Anchor::Middle, back, "");
        if moves {
            drawing.arrow([p[0] - 4.0, p[1] - 30.0], [p[0] - 44.0, p[1] - 30.0], "#222");
            drawing.text([p[0] - 48.0, p[1] - 26.0], Anchor::End, "v", "");
            drawing.arrow([p[0] + 4.0, p[1] - 30.0], [p[0] + 44.0, p[1] - 30.0], FORCE);
            drawing.text([p[0] + 48.0, p[1] - 26.0], Anchor::Start, "Fe = 2 dT", "");
        }
    }
    let notes = [
        "Condition F takes both changes of tension as equal. On an elastic belt they are so in the middle alone: a force Fe moves P until",
        "both sides bear it, each by its stiffness EA / L. So the changes are to each other as the lengths of the other sides.",
        "The part from 1 to 2 on the other side does not change, because both motors hold it.",
    ];
    drawing.notes(210.0, 14.0, &notes);
    drawing.finish()
}

/// Figure 8: the belt's pulls on bar and head at rest.
pub(super) fn free_bodies() -> String {
    let mut drawing = Drawing::new([860.0, 290.0], "Figure 8: the belt's forces on bar and head at rest");
    let view = View::new(Machine::CoreHBot, [56.0, 345.0], 0.78);
    let head = View::new(Machine::CoreHBot, [420.0, 345.0], 0.78);
    for (view, block, name, x) in
        [(&view, Block::Bar, "(a) the bar", 12.0), (&head, Block::Head, "(b) the head", 520.0)]
    {
        drawing.text([x, 24.0], Anchor::Start, name, "class=\"title\"");
        pulls(view, &mut drawing, block);
        let tensions = vec![1.0; view.segments().len()];
        let origin = Place::flat(0.0, 0.0);
        let sum = load(view.machine, &layout(view.machine, &view.params, view.tool), &tensions, block, origin);
        let of = |value: f64| number(value);
        let text =
            format!("sum: x {} T, y {} T; torque about O {} T mm", of(sum.x_n), of(sum.y_n), of(sum.couple_n_mm));
        drawing.text([x, 42.0], Anchor::Start, &text, "class=\"small\"");
    }
    drawing.text([12.0, 278.0], Anchor::Start, "Each arrow is the tension T of a cut segment. The sums are the model's; the paper's equations 26 to 29 ask for the same zeros.", "class=\"small\"");
    drawing.finish()
}

/// A block with its pulleys and an arrow for each cut segment.
fn pulls(view: &View, drawing: &mut Drawing, block: Block) {
    /// Length of an arrow, in pixels.
    const ARROW: f64 = 34.0;
    let of_block = |index: usize| view.stops().get(index).filter(|stop| stop.block() == block);
    let radius = 18.0 * 0.78;
    let centres: Vec<[f64; 2]> = view.stops().iter().filter(|s| s.block() == block).map(|s| view.centre(s)).collect();
    let bounds = |i: usize| {
        let all = centres.iter().filter_map(|at| at.get(i).copied());
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ((left, right), (top, bottom)) = (bounds(0), bounds(1));
    drawing.rectangle(
        [left - 8.0, top.min(bottom - 10.0) - 4.0],
        [right + 8.0, bottom.max(top + 10.0) + 4.0],
        "fill=\"#eee\" stroke=\"#bbb\"",
    );
    for stop in view.stops().iter().filter(|stop| stop.block() == block) {
        let at = view.centre(stop);
        drawing.circle(at, radius, "fill=\"#fff\" stroke=\"#222\"");
        drawing.text([at[0], at[1] + 4.0], Anchor::Middle, &stop.number.to_string(), "class=\"small\"");
    }
    for segment in view.segments() {
        for (stop, part, sign) in [(segment.from, 0.0, 1.0), (segment.to, 1.0, -1.0)] {
            if of_block(stop).is_none() {
                continue;
            }
            let [x, y] = view.at(View::along(segment, part));
            let [u, v] = segment.heading.map(|along| sign * along);
            drawing.arrow([x, y], [x + ARROW * u, y - ARROW * v], PULLED);
            drawing.text([x + (ARROW + 8.0) * u, y - (ARROW + 8.0) * v + 4.0], Anchor::Middle, "T", "class=\"small\"");
        }
    }
}

/// Figure 9: signs of the changes of tension, torques and forces in motions along x and y.
pub(super) fn motions() -> String {
    let mut drawing = Drawing::new([920.0, 470.0], "Figure 9: the CoreH-bot moves along x and along y");
    for (axis, name, x) in [(0, "(a) along +x", 56.0), (1, "(b) along +y", 516.0)] {
        let view = View::new(Machine::CoreHBot, [x, 402.0], 0.74);
        drawing.text([x - 44.0, 15.0], Anchor::Start, name, "class=\"title\"");
        let pattern = Pattern::new(view.machine, &view.params, view.tool, axis);
        view.blocks(&mut drawing);
        view.belts(&mut drawing);
        view.pulleys(&mut drawing);
        for (segment, tension) in view.segments().iter().zip(&pattern.tensions_n) {
            let (sign, colour) = match tension {
                t if *t > 0.5 => ("+", PULLED),
                t if *t < -0.5 => ("−", PUSHED),
                _ => ("0", NEITHER),
            };
            let [x, y] = view.at(View::along(segment, 0.5));
            drawing.circle([x, y], 7.0, &format!("fill=\"#fff\" stroke=\"{colour}\""));
            drawing.text([x, y + 4.0], Anchor::Middle, sign, &format!("style=\"fill:{colour}\""));
        }
        torques(&view, &mut drawing, &pattern);
        let along = if axis == 0 { [1.0, 0.0] } else { [0.0, -1.0] };
        let [px, py] = view.at([view.tool.x, view.tool.y]);
        // Next to the tool, where no belt and no pulley is.
        let (aside, name) = if axis == 0 { ([0.0, -14.0], [0.0, -5.0]) } else { ([-12.0, 0.0], [9.0, 4.0]) };
        let to = |by: f64, off: [f64; 2]| [0, 1].map(|i| [px, py][i] + by * along[i] + aside[i] + off[i]);
        for (by, colour, words) in [(30.0, "#222", "v"), (-30.0, FORCE, "Fe")] {
            drawing.arrow(to(by / 15.0, [0.0; 2]), to(by, [0.0; 2]), colour);
            drawing.text(to(by / 2.0, name), Anchor::Middle, words, "class=\"small\"");
        }
        drawing.circle([px, py], 3.0, "fill=\"#d55e00\"");
        let p = &view.params;
        let force = pattern.force_n.get(axis).copied().unwrap_or(0.0);
        let couple = pattern.couple_n_mm / (p.width_mm - 2.0 * view.tool.x);
        let racks = if axis == 0 { "0".to_owned() } else { format!("{} dT (W - 2x)", number(couple)) };
        let frame = pattern.torques_n_mm.iter().sum::<f64>() / p.pulley_radius_mm;
        let text = format!(
            "Fe = {} dT against the motion (green). Bar: {racks}. Motors together: {} r dT.",
            number(force),
            number(frame)
        );
        drawing.text([x - 44.0, 448.0], Anchor::Start, &text, "class=\"small\"");
    }
    drawing.text(
        [12.0, 464.0],
        Anchor::Start,
        "+, −, 0: the segment's tension is T + dT, T - dT or T. The bar is without mass, as in the paper.",
        "class=\"small\"",
    );
    drawing.finish()
}

/// The torque of each motor, with its direction.
fn torques(view: &View, drawing: &mut Drawing, pattern: &Pattern) {
    let radius = view.params.pulley_radius_mm;
    for (motor, torque) in view.machine.motors().into_iter().zip(&pattern.torques_n_mm) {
        let Some(stop) = view.stops().iter().find(|stop| stop.motor() == Some(motor)) else { continue };
        let [x, y] = view.centre(stop);
        let is_front = is_in_front(stop, view);
        let turns = if *torque > 0.0 { "↺" } else { "↻" };
        let text = format!("{turns} τ{motor} = {} r dT", number(torque.abs() / radius));
        drawing.text([x, if is_front { y + 27.0 } else { y - 20.0 }], Anchor::Middle, &text, "class=\"small\"");
    }
}

fn is_in_front(stop: &Stop, view: &View) -> bool {
    stop.centre(&view.params, view.tool)[1] < view.params.depth_mm / 2.0
}
