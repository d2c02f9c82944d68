//! Radii: equation 8 of the paper, motors with pulleys of four sizes.

use crate::queries::paper::radii::{Corner, Movement, Radii};
use corehbot_report::svg::{Anchor, COLOURS, Drawing, number};
use corehbot_twin::math::{cos, sin};

/// Pixels per mm of a pulley.
const PULLEY: f64 = 5.0;

/// Places of motors 1, 4, 8 and 11 in a panel: from above, x to the right and y to the back.
const PLACES: [[f64; 2]; 4] = [[48.0, 222.0], [204.0, 222.0], [204.0, 92.0], [48.0, 92.0]];

/// Distance of the panels.
const PANEL: f64 = 272.0;

/// The turns of the motors in three movements, and a square by a controller that takes all pulleys for the first one's.
pub(super) fn turns(radii: &Radii) -> String {
    let mut drawing = Drawing::new([860.0, 610.0], "Equation 8: motors with pulleys of four sizes");
    for (movement, left) in radii.movements.iter().zip([20.0, 20.0 + PANEL, 20.0 + 2.0 * PANEL]) {
        motors(&mut drawing, left, radii, movement);
    }
    let notes = [
        "Turn of a motor = its belt / the radius of its own pulley, counter-clockwise positive. Pulleys are to scale.",
        "The dot is the mark of the pulley before the movement. GT2: 2 mm of belt for a tooth.",
    ];
    for (note, y) in notes.into_iter().zip([284.0, 298.0]) {
        drawing.text([20.0, y], Anchor::Start, note, "class=\"small\"");
    }
    square(&mut drawing, radii);
    drawing.finish()
}

/// The four pulleys in a movement of the tool, each with its turn.
fn motors(drawing: &mut Drawing, left: f64, radii: &Radii, movement: &Movement) {
    let [x, y] = movement.tool_mm;
    let title = format!("the tool moves by ({}, {}) mm", number(x), number(y));
    drawing.text([left, 24.0], Anchor::Start, &title, "class=\"title\"");
    let middle = [left + 126.0, 157.0];
    drawing.arrow([middle[0] - x, middle[1] + y], [middle[0] + 1.5 * x, middle[1] - 1.5 * y], "#222");
    let motors = radii.motors.iter().zip(radii.teeth).zip(&radii.radius_mm);
    let turns = movement.belt_mm.iter().zip(&movement.turn_deg);
    for (((motor, teeth), radius_mm), ((belt, turn), [px, py])) in motors.zip(turns.zip(PLACES)) {
        let (at, radius) = ([left + px, py], PULLEY * radius_mm);
        drawing.circle(at, radius, "fill=\"#fff\" stroke=\"#222\" stroke-dasharray=\"2 1.4\"");
        drawing.text([at[0], at[1] + 4.0], Anchor::Middle, &motor.to_string(), "");
        arc(drawing, at, radius - 6.0, turn.to_radians());
        let below = at[1] + radius + 13.0;
        let [belt, turn] = [*belt, *turn].map(signed);
        drawing.text([at[0], at[1] - radius - 5.0], Anchor::Middle, &format!("{teeth} teeth"), "class=\"small\"");
        drawing.text([at[0], below], Anchor::Middle, &format!("{belt} mm: {turn}°"), "class=\"small\"");
    }
}

/// An arc with an arrow's head from the top of a pulley, counter-clockwise, of this angle in radians.
fn arc(drawing: &mut Drawing, at: [f64; 2], radius: f64, turn: f64) {
    let place = |angle: f64| [at[0] - radius * sin(angle), at[1] - radius * cos(angle)];
    drawing.circle(place(0.0), 2.5, "fill=\"#222\"");
    // Below a thousandth of a turn there is nothing to see.
    if turn.abs() < 6e-3 {
        return;
    }
    let [[x1, y1], [x2, y2]] = [0.0, turn].map(|angle| place(angle).map(number));
    let (radius, large) = (number(radius), u8::from(turn.abs() > std::f64::consts::PI));
    let (sweep, colour) = if turn > 0.0 { (0, COLOURS[1]) } else { (1, COLOURS[0]) };
    let path = format!("M{x1} {y1}A{radius} {radius} 0 {large} {sweep} {x2} {y2}");
    drawing.path(&path, &format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\""));
    let along = turn.signum();
    drawing.head(place(turn), [-along * cos(turn), along * sin(turn)], colour);
}

/// The square and what comes of it.
fn square(drawing: &mut Drawing, radii: &Radii) {
    /// Pixels per mm.
    const SCALE: f64 = 2.0;
    let at = |[x, y]: [f64; 2]| [70.0 + SCALE * x, 560.0 - SCALE * y];
    drawing.text(
        [20.0, 332.0],
        Anchor::Start,
        "A square of 100 mm, if the controller takes all pulleys for motor 1's",
        "class=\"title\"",
    );
    let corners = &radii.taken_for_equal;
    let closed =
        |of: fn(&Corner) -> [f64; 2]| corners.iter().chain(corners.first()).map(of).map(at).collect::<Vec<_>>();
    drawing.polyline(&closed(|c| c.commanded_mm), "stroke=\"#777\" stroke-width=\"1.5\" stroke-dasharray=\"6 4\"");
    drawing.polyline(&closed(|c| c.reached_mm), &format!("stroke=\"{}\" stroke-width=\"2\"", COLOURS[1]));
    let mut line = |y: f64, words: [String; 4], style: &str| {
        for (text, x) in words.iter().zip([400.0, 520.0, 660.0, 800.0]) {
            drawing.text([x, y], Anchor::End, text, style);
        }
    };
    line(
        370.0,
        ["commanded, mm", "reached, mm", "runs round, mm", "does not fit, mm"].map(str::to_owned),
        "style=\"font-weight:bold\"",
    );
    for (corner, y) in corners.iter().zip([390.0, 408.0, 426.0, 444.0]) {
        let [commanded, reached] =
            [corner.commanded_mm, corner.reached_mm].map(|[x, y]| format!("({}, {})", minus(x), minus(y)));
        let [round, residual] = [corner.circulation_mm, corner.residual_mm].map(signed);
        line(y, [commanded, reached, round, residual], "");
    }
    let notes = [
        "dashed: commanded; orange: reached, the place that is nearest to all four motors.",
        "Runs round: the mean of the four belts. Does not fit: equation 11, n1 - n4 + n8 - n11, is 0 on a rigid belt.",
        "An elastic belt takes it up by its tension, until a motor slips or a tooth jumps.",
        "With each motor's own radius both are 0, and the tool is where it should be.",
    ];
    for (note, y) in notes.into_iter().zip([476.0, 492.0, 508.0, 524.0]) {
        drawing.text([310.0, y], Anchor::Start, note, "class=\"small\"");
    }
}

/// With a sign, and none for 0.
fn signed(value: f64) -> String {
    let text = minus(value);
    if text == "0" || value < 0.0 { text } else { format!("+{text}") }
}

/// With a true minus.
fn minus(value: f64) -> String {
    number(value).replace('-', "−")
}
