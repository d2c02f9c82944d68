//! Routing: belts, pulleys, bar and head of a machine, seen from above.

use super::{TOOL, drawn};
use corehbot_report::svg::{Anchor, COLOURS, Drawing, number};
use corehbot_twin::geometry::{Layout, Segment, layout};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place, Role, Side, Stop};

/// A machine on a drawing: mm become pixels.
pub(super) struct View {
    pub machine: Machine,
    pub params: Params,
    pub tool: Place,
    /// Motor 1's axis, in pixels.
    origin: [f64; 2],
    /// Pixels per mm.
    scale: f64,
    laid: Layout,
    stops: Vec<Stop>,
}

impl View {
    /// With motor 1's axis at a place of the drawing.
    pub(super) fn new(machine: Machine, origin: [f64; 2], scale: f64) -> Self {
        let params = drawn();
        let laid = layout(machine, &params, TOOL);
        Self { machine, laid, stops: machine.stops(), params, tool: TOOL, origin, scale }
    }

    /// A place in mm on the drawing.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    pub(super) fn segments(&self) -> &[Segment] {
        &self.laid.segments
    }

    pub(super) fn stops(&self) -> &[Stop] {
        &self.stops
    }

    /// The centre of a stop on the drawing.
    pub(super) fn centre(&self, stop: &Stop) -> [f64; 2] {
        self.at(stop.centre(&self.params, self.tool))
    }

    /// The place in mm at a part (0 to 1) of a segment.
    pub(super) fn along(segment: &Segment, part: f64) -> [f64; 2] {
        [0, 1].map(|i| segment.begin[i] + part * segment.length_mm * segment.heading[i])
    }

    /// Bar and head, and the guides at both sides.
    pub(super) fn blocks(&self, drawing: &mut Drawing) {
        let (Place { x, y, .. }, p) = (self.tool, &self.params);
        let r = p.pulley_radius_mm;
        for side in [-3.4 * r, p.width_mm + 3.4 * r] {
            drawing.line(self.at([side, -r]), self.at([side, p.depth_mm + r]), "stroke=\"#bbb\" stroke-width=\"3\"");
        }
        let bar = [[-3.8 * r, y - 5.0], [p.width_mm + 3.8 * r, y + 5.0]].map(|at| self.at(at));
        drawing.rectangle(bar[0], bar[1], "fill=\"#ddd\"");
        let half = [p.head_pulleys_mm / 2.0 + 0.3 * r, 0.55 * p.bar_pulleys_mm - 1.6 * r];
        let head = [[x - half[0], y - half[1]], [x + half[0], y + half[1]]].map(|at| self.at(at));
        drawing.rectangle(head[0], head[1], "fill=\"#e9eef5\" stroke=\"#9ab\"");
    }

    /// The belts, each in a colour; the second one is dashed where it may lie over the first.
    pub(super) fn belts(&self, drawing: &mut Drawing) {
        let mut first = 0;
        for (index, belt) in self.machine.belts().iter().enumerate() {
            let count = belt.stops.len() - usize::from(!belt.is_closed());
            let segments = self.laid.segments.get(first..first + count).unwrap_or_default();
            first += count;
            let words = self.words(segments, belt.is_closed());
            let dash = if index > 0 { " stroke-dasharray=\"7 3\"" } else { "" };
            let colour = COLOURS.get(index % COLOURS.len()).copied().unwrap_or("#222");
            drawing.path(&words, &format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dash}"));
        }
    }

    /// Lines and arcs of a belt.
    fn words(&self, segments: &[Segment], is_closed: bool) -> String {
        let mut words = String::new();
        let mut last: Option<&Segment> = None;
        let again = segments.first().filter(|_| is_closed);
        for segment in segments.iter().chain(again) {
            let begin = self.at(segment.begin).map(number).join(" ");
            match last {
                None => words += &format!("M{begin}"),
                Some(into) => words += &self.arc(into, &begin),
            }
            if last.is_none() || !again.is_some_and(|first| std::ptr::eq(first, segment)) {
                words += &format!("L{}", self.at(Self::along(segment, 1.0)).map(number).join(" "));
            }
            last = Some(segment);
        }
        words
    }

    /// The arc on the pulley at the end of a segment. No wrap of these machines is more than half a turn.
    fn arc(&self, into: &Segment, to: &str) -> String {
        let sign = self.stops.get(into.to).map_or(0.0, Stop::sign);
        let radius = number(self.scale * self.params.pulley_radius_mm);
        // Seen from above, counter-clockwise is so on the drawing too.
        format!("A{radius} {radius} 0 0 {} {to}", if sign > 0.0 { 0 } else { 1 })
    }

    /// An arrow in the middle of each segment, in the belt's direction of travel.
    pub(super) fn directions(&self, drawing: &mut Drawing) {
        for segment in self.segments().iter().filter(|segment| segment.length_mm * self.scale > 16.0) {
            let [x, y] = self.at(Self::along(segment, 0.5));
            let [u, v] = segment.heading;
            drawing.head([x + 3.0 * u, y - 3.0 * v], [u, -v], "#222");
        }
    }

    /// Names of the segments by their pulleys, to the right of the belt's way.
    pub(super) fn names(&self, drawing: &mut Drawing) {
        let number = |index: usize| self.stops.get(index).map_or(0, |stop| stop.number);
        for segment in self.segments() {
            let part = if segment.heading[0].abs() > 0.5 { 0.5 } else { 0.62 };
            let [x, y] = self.at(Self::along(segment, part));
            let [u, v] = segment.heading;
            let (anchor, shift) = match (v > 0.5, v < -0.5) {
                (true, _) => (Anchor::Start, [4.0, 3.5]),
                (_, true) => (Anchor::End, [-4.0, 3.5]),
                _ => (Anchor::Middle, [0.0, if u > 0.0 { 12.0 } else { -5.0 }]),
            };
            let name = format!("{}–{}", number(segment.from), number(segment.to));
            drawing.text([x + shift[0], y + shift[1]], anchor, &name, "class=\"small\" fill=\"#555\"");
        }
    }

    /// Pulleys with their numbers: motors filled, toothed ones with a rim of teeth, clamps as squares.
    pub(super) fn pulleys(&self, drawing: &mut Drawing) {
        let radius = self.scale * self.params.pulley_radius_mm;
        for stop in &self.stops {
            let at = self.centre(stop);
            let style = match stop.role {
                Role::Motor => "fill=\"#e69f00\" stroke=\"#222\" stroke-dasharray=\"2 1.4\"",
                Role::Idler(Side::Inside) => "fill=\"#fff\" stroke=\"#222\" stroke-dasharray=\"2 1.4\"",
                Role::Idler(Side::Outside) => "fill=\"#fff\" stroke=\"#222\"",
                Role::Clamp => {
                    let [x, y] = at;
                    drawing.rectangle([x - 3.0, y - 3.0], [x + 3.0, y + 3.0], "fill=\"#222\"");
                    continue;
                }
            };
            drawing.circle(at, radius - 1.5, style);
            drawing.text([at[0], at[1] + 4.0], Anchor::Middle, &stop.number.to_string(), "class=\"small\"");
        }
    }

    /// The tool.
    pub(super) fn tool(&self, drawing: &mut Drawing) {
        let at = self.at([self.tool.x, self.tool.y]);
        drawing.circle(at, 3.0, "fill=\"#d55e00\"");
        drawing.text([at[0] + 5.0, at[1] + 11.0], Anchor::Start, "P", "class=\"small\"");
    }

    /// A dimension with arrows at both ends.
    fn dimension(&self, drawing: &mut Drawing, a: [f64; 2], b: [f64; 2], name: &str) {
        let [a, b] = [a, b].map(|at| self.at(at));
        drawing.line(a, b, "class=\"thin\"");
        let apart = [b[0] - a[0], b[1] - a[1]];
        drawing.head(b, apart, "#999");
        drawing.head(a, apart.map(|v| -v), "#999");
        let middle = [0, 1].map(|i| (a[i] + b[i]) / 2.0);
        drawing.text([middle[0] + 6.0, middle[1] - 4.0], Anchor::Middle, name, "class=\"small\"");
    }
}

/// Figure 5: the CoreH-bot with numbers of pulleys and segments, directions, and the frame of coordinates.
pub(super) fn corehbot() -> String {
    let mut drawing = Drawing::new([640.0, 640.0], "Figure 5: the belt of a CoreH-bot, seen from above");
    let view = View::new(Machine::CoreHBot, [88.0, 552.0], 1.0);
    drawing.text([12.0, 20.0], Anchor::Start, "CoreH-bot: one closed belt, seen from above", "class=\"title\"");
    view.blocks(&mut drawing);
    view.belts(&mut drawing);
    view.directions(&mut drawing);
    view.pulleys(&mut drawing);
    view.names(&mut drawing);
    view.tool(&mut drawing);
    let origin = view.at([0.0, 0.0]);
    drawing.arrow([origin[0] - 40.0, origin[1] + 34.0], [origin[0] + 20.0, origin[1] + 34.0], "#555");
    drawing.arrow([origin[0] - 40.0, origin[1] + 34.0], [origin[0] - 40.0, origin[1] - 26.0], "#555");
    drawing.text([origin[0] + 24.0, origin[1] + 38.0], Anchor::Start, "x", "");
    drawing.text([origin[0] - 43.0, origin[1] - 30.0], Anchor::Middle, "y", "");
    let notes = [
        "Filled: motors 1, 4, 8 and 11. Dotted rim: pulleys on the toothed side. Full rim: pulleys on the back, which may be smooth.",
        "Arrows: travel of the belt that turns motors counter-clockwise. The origin is motor 1's axis.",
    ];
    drawing.notes(618.0, 13.0, &notes);
    drawing.finish()
}

/// Where figure 6 has d, in mm: between the rail and the belts.
const BESIDE_BELTS: f64 = -40.0;

/// About where the pulleys on the left of the bar are, in mm.
const BAR_PULLEYS: f64 = 30.0;

/// Figure 6: the three routings with their dimensions.
pub(super) fn three() -> String {
    let mut drawing = Drawing::new([1030.0, 400.0], "Figure 6: the belts of H-bot, CoreXY and CoreH-bot");
    let panels = [(Machine::HBot, "(a) H-bot"), (Machine::CoreXy, "(b) CoreXY"), (Machine::CoreHBot, "(c) CoreH-bot")];
    for (index, (machine, name)) in (0..).zip(panels) {
        let view = View::new(machine, [50.0 + 334.0 * f64::from(index), 336.0], 0.52);
        drawing.text(view.at([-40.0, 570.0]), Anchor::Start, name, "class=\"title\"");
        view.blocks(&mut drawing);
        view.belts(&mut drawing);
        view.directions(&mut drawing);
        view.pulleys(&mut drawing);
        view.tool(&mut drawing);
        let p = &view.params;
        view.dimension(&mut drawing, [0.0, -45.0], [p.width_mm, -45.0], "W");
        view.dimension(&mut drawing, [p.width_mm + 85.0, 0.0], [p.width_mm + 85.0, p.depth_mm], "D");
        let (low, high) = (view.tool.y - p.bar_pulleys_mm / 2.0, view.tool.y + p.bar_pulleys_mm / 2.0);
        // Left of all belts: between them it would seem to belong to other pulleys.
        view.dimension(&mut drawing, [BESIDE_BELTS, low], [BESIDE_BELTS, high], "d");
        for height in [low, high] {
            drawing.line(view.at([BESIDE_BELTS, height]), view.at([BAR_PULLEYS, height]), "class=\"thin\"");
        }
        let half = p.head_pulleys_mm / 2.0;
        let under = view.tool.y - 105.0;
        view.dimension(&mut drawing, [view.tool.x - half, under], [view.tool.x + half, under], "e");
    }
    let notes = "Motors are filled. The CoreXY's belts lie in two planes; the dashed one is above. Squares: the belt is clamped to the head.";
    drawing.text([12.0, 390.0], Anchor::Start, notes, "class=\"small\"");
    drawing.finish()
}
