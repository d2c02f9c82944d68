//! Statements: numbers in the text of \[H\], each with the model's.

use super::pattern::Pattern;
use super::speeds::{Motion, of_tool};
use super::table::{TOOL, touching};
use corehbot_twin::geometry::{layout, workspace};
use corehbot_twin::model::displacements::displacements;
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::geometry::Geometry;
use corehbot_twin::queries::push::Push;
use corehbot_twin::routing::{Machine, Place};
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// A number in the text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statement {
    /// Equation, table or section.
    pub place: &'static str,
    /// What it says.
    pub what: &'static str,
    /// The unit of both numbers.
    pub unit: &'static str,
    /// The paper's number, or the value of its expression.
    pub printed: f64,
    /// The model's.
    pub ours: f64,
    /// Decimals of both.
    pub decimals: usize,
    /// Why they differ; empty where they do not.
    pub why: &'static str,
}

impl Statement {
    /// One of its numbers for people.
    #[must_use]
    pub fn text(&self, value: f64) -> String {
        corehbot_twin::queries::shown(value, self.decimals)
    }
}

/// The machine of the paper's table 2 with a head that is a point, as the paper has H-bot and CoreXY.
fn point() -> Params {
    Params { head_pulleys_mm: 0.0, ..Params::default() }
}

const HEAD: &str =
    "The printed figure is for a head that is a point, or has touching pulleys; this head is 80 mm wide.";

/// Speeds of a CoreXY's two motors, for equation 2.
const TWO_MOTORS_RAD_PER_S: [f64; 2] = [10.0, 4.0];

/// All of them, in the order of the paper.
pub(super) fn statements() -> Vec<Statement> {
    let say = |place, what, unit, (printed, ours), decimals, why| Statement {
        place,
        what,
        unit,
        printed,
        ours,
        decimals,
        why,
    };
    let p = Params::default();
    let (w, d_frame, r, d) = (p.width_mm, p.depth_mm, p.pulley_radius_mm, p.bar_pulleys_mm);
    let (small, none) = (touching(), point());
    let belt = |machine, params: &Params| -> f64 {
        layout(machine, params, workspace(machine, params).centre()).belt_lengths_mm.into_iter().fold(0.0, f64::max)
    };
    let reach = |machine, params: &Params, axis: usize| {
        let reach = workspace(machine, params);
        let [low, high] = if axis == 0 { reach.x } else { reach.y };
        high - low
    };
    let area = |machine, params: &Params| reach(machine, params, 0) * reach(machine, params, 1);
    let geometry = Geometry::new(&Setup::nominal(Machine::CoreHBot, TOOL.x, TOOL.y));
    let [hbot, corexy, corehbot] = [Machine::HBot, Machine::CoreXy, Machine::CoreHBot];
    let pulleys = |machine: Machine| {
        let short = geometry.machines.iter().find(|short| short.machine == machine.key());
        short.map_or([0.0; 2], |short| short.toothed_of.map(|n| n as f64))
    };
    let moved = |machine, tool, axis| Pattern::new(machine, &p, tool, axis);
    let centre = Place::flat(w / 2.0, d_frame / 2.0);
    let force = |machine, axis: usize| moved(machine, centre, axis).force_n.get(axis).copied().unwrap_or(0.0);
    let on_frame = |machine, axis| moved(machine, centre, axis).torques_n_mm.iter().sum::<f64>().abs();
    let (rank, unknowns, equations) = degrees();
    let off = Place::flat(147.5, 235.0);
    let edge = Place::flat(workspace(corehbot, &p).x[0], 235.0);
    let motion = Motion { pulley_rad_per_s: 2.0, head_mm_per_s: [10.0, 20.0] };
    let (printed, ours) = (motion.printed(r), motion.of_motors(&p));
    let tool_speed = of_tool(corexy, &p, TWO_MOTORS_RAD_PER_S).map(f64::abs);
    let [first, second] = TWO_MOTORS_RAD_PER_S;
    vec![
        say(
            "(2)",
            "speed of a CoreXY's tool along x, motors at 10 and 4 rad/s",
            "mm/s",
            (r * (first + second) / 2.0, tool_speed[0]),
            3,
            "",
        ),
        say(
            "(2)",
            "speed of a CoreXY's tool along y, motors at 10 and 4 rad/s",
            "mm/s",
            (r * (first - second) / 2.0, tool_speed[1]),
            3,
            "",
        ),
        say(
            "(9)",
            "speed of motor 1, head at 10 and 20 mm/s, pulley 13 at 2 rad/s",
            "rad/s",
            (printed[0], ours[0]),
            3,
            "",
        ),
        say("(9)", "speed of motor 4 in the same motion", "rad/s", (printed[1], ours[1]), 3, ""),
        say("(9)", "speed of motor 8 in the same motion", "rad/s", (printed[2], ours[2]), 3, ""),
        say("(9)", "speed of motor 11 in the same motion", "rad/s", (printed[3], ours[3]), 3, ""),
        say("(7)", "equations", "", (60.0, equations), 0, ""),
        say("(7)", "unknowns", "", (62.0, unknowns), 0, ""),
        say("section 2.2", "degrees of freedom", "", (3.0, unknowns - rank), 0, ""),
        say(
            "section 1.2",
            "pulleys of a CoreXY beyond those of an H-bot",
            "",
            (2.0, pulleys(corexy)[1] - pulleys(hbot)[1]),
            0,
            "",
        ),
        say(
            "section 2.1",
            "pulleys of a CoreH-bot beyond those of a CoreXY",
            "",
            (4.0, pulleys(corehbot)[1] - pulleys(corexy)[1]),
            0,
            "",
        ),
        say("section 2.2", "toothed pulleys of a CoreH-bot", "", (8.0, pulleys(corehbot)[0]), 0, ""),
        say(
            "(16)",
            "belt of a CoreH-bot, e = 2r",
            "mm",
            (4.0 * w + 4.0 * d_frame - 2.0 * d - 20.0 * r + 10.0 * PI * r, belt(corehbot, &small)),
            1,
            "",
        ),
        say(
            "(16)",
            "belt of a CoreH-bot, head of 80 mm",
            "mm",
            (4.0 * w + 4.0 * d_frame - 2.0 * d - 20.0 * r + 10.0 * PI * r, belt(corehbot, &p)),
            1,
            HEAD,
        ),
        say(
            "section 4",
            "belt, about 8 W",
            "mm",
            (8.0 * w, belt(corehbot, &p)),
            1,
            "The paper leaves out radii and the widths of bar and head.",
        ),
        say(
            "table 2",
            "belt loop",
            "mm",
            (3600.0, belt(corehbot, &p)),
            1,
            "1800 teeth; the slots of the four motors take up 0.86 mm each.",
        ),
        say(
            "(17)",
            "belt of an H-bot",
            "mm",
            (2.0 * w + 4.0 * d_frame - 2.0 * d - 8.0 * r + 6.0 * PI * r, belt(hbot, &none)),
            1,
            "",
        ),
        say(
            "(18)",
            "each belt of a CoreXY",
            "mm",
            (2.0 * w + 2.0 * d_frame - d - 2.0 * r + 3.0 * PI * r, belt(corexy, &none)),
            1,
            "",
        ),
        say("(20)", "reach of a CoreH-bot in x, e = 2r", "mm", (w - 2.0 * r, reach(corehbot, &small, 0)), 1, ""),
        say("(20)", "reach of a CoreH-bot in x, head of 80 mm", "mm", (w - 2.0 * r, reach(corehbot, &p, 0)), 1, HEAD),
        say("(20)", "reach of a CoreH-bot in y", "mm", (d_frame - d, reach(corehbot, &p, 1)), 1, ""),
        say("(21)", "reach of an H-bot in x", "mm", (w - 4.0 * r, reach(hbot, &none, 0)), 1, ""),
        say("(21)", "reach of a CoreXY in x", "mm", (w - 4.0 * r, reach(corexy, &none, 0)), 1, ""),
        say(
            "(21)",
            "reach of H-bot and CoreXY in x, head of 80 mm",
            "mm",
            (w - 4.0 * r, reach(corexy, &p, 0)),
            1,
            HEAD,
        ),
        say("(21)", "reach of H-bot and CoreXY in y", "mm", (d_frame - d, reach(corexy, &p, 1)), 1, ""),
        say(
            "(20), (21)",
            "workspace beyond a CoreXY's, each with its own head",
            "cm2",
            (2.0 * r * (d_frame - d) / 100.0, (area(corehbot, &small) - area(corexy, &none)) / 100.0),
            1,
            "",
        ),
        say(
            "(20), (21)",
            "workspace beyond a CoreXY's, both with a head of 80 mm",
            "cm2",
            (2.0 * r * (d_frame - d) / 100.0, (area(corehbot, &p) - area(corexy, &p)) / 100.0),
            1,
            "Pulleys on the bar at 2r cost the CoreXY 2r on each side, and the heads are alike.",
        ),
        say(
            "section 4",
            "least W for 300 mm of reach",
            "mm",
            (300.0, 300.0 + w - reach(corehbot, &p, 0)),
            1,
            "The head's 80 mm come on top.",
        ),
        say(
            "table 2",
            "print area in x",
            "mm",
            (430.0, reach(corehbot, &p, 0)),
            1,
            "The bed is 40 mm wider than the reach: its edges cannot be printed on.",
        ),
        say(
            "table 2",
            "print area in y",
            "mm",
            (400.0, reach(corehbot, &p, 1)),
            1,
            "The reach is 17.6 mm deeper than the bed.",
        ),
        say(
            "table 2",
            "pulley radius, 20 teeth of 2 mm",
            "mm",
            (r, 40.0 / TAU),
            3,
            "Teeth decide: 40 mm a turn, not 39.90. With r for the steps a part would be 0.25 % too large.",
        ),
        say(
            "(25)",
            "transmission error",
            "mm",
            (0.099, geometry.transmission_error_mm),
            3,
            "Cut off, not rounded: 0.09975.",
        ),
        say("after (32)", "Fe / dT along x, CoreH-bot", "", (4.0, force(corehbot, 0)), 1, ""),
        say("after (32)", "Fe / dT along y, CoreH-bot", "", (4.0, force(corehbot, 1)), 1, ""),
        say("after (32)", "Fe / dT along x, H-bot", "", (2.0, force(hbot, 0)), 1, ""),
        say("after (32)", "Fe / dT along y, H-bot", "", (4.0, force(hbot, 1)), 1, ""),
        say("after (32)", "Fe / dT along x, CoreXY", "", (4.0, force(corexy, 0)), 1, ""),
        say("after (32)", "Fe / dT along y, CoreXY", "", (4.0, force(corexy, 1)), 1, ""),
        say(
            "Fig. 9",
            "torque of each motor over r dT",
            "",
            (1.0, most(&moved(corehbot, centre, 0).torques_n_mm) / r),
            1,
            "",
        ),
        say(
            "condition F",
            "dT on the right over dT on the left, tool at x = 147.5",
            "",
            (1.0, sides(&p, off)),
            3,
            "The paper takes all changes as equal. They are in the middle; elsewhere the shorter side pulls more.",
        ),
        say(
            "(33)",
            "belts on the bar about pulley 1, along x, dT = 1 N",
            "N mm",
            (4.0 * off.y, moved(corehbot, off, 0).bar_couple_about_origin_n_mm),
            1,
            "",
        ),
        say(
            "(34)",
            "belts on the bar about pulley 1, along y, dT = 1 N",
            "N mm",
            (2.0 * w, moved(corehbot, off, 1).bar_couple_about_origin_n_mm),
            1,
            "",
        ),
        say(
            "(35)",
            "torque on the bar along x, CoreH-bot, dT = 1 N",
            "N mm",
            (0.0, moved(corehbot, off, 0).couple_n_mm),
            1,
            "",
        ),
        say(
            "(37)",
            "torque on the bar along y at x = 147.5, bar without mass",
            "N mm",
            (2.0 * (w - 2.0 * off.x), moved(corehbot, off, 1).couple_n_mm),
            1,
            "",
        ),
        say(
            "(37)",
            "torque on the bar along y at x = 147.5, bar of 1.2 kg",
            "N mm",
            (2.0 * (w - 2.0 * off.x), racking(&p, off)),
            1,
            "Only the head accelerates off the middle of the bar; the bar's own mass does not rack it.",
        ),
        say(
            "after (38)",
            "largest torque on the bar along y, close to 2 dT W",
            "N mm",
            (2.0 * w, moved(corehbot, edge, 1).couple_n_mm),
            1,
            "At x = 40, the end of the reach; bar without mass.",
        ),
        say(
            "(38)",
            "torque on the bar along x, H-bot, dT = 1 N",
            "N mm",
            (-(d + w), moved(hbot, off, 0).bar_couple_n_mm),
            1,
            "A couple cannot depend on the origin: the sum is -dT (d + W - 4r).",
        ),
        say(
            "(38)",
            "the same, head with its mass in the middle of the bar",
            "N mm",
            (-(d + w), moved(hbot, off, 0).couple_n_mm),
            1,
            "The belt pulls such a head at its front, d/2 - r before its middle, and this turns the bar back a little.",
        ),
        say(
            "after (38)",
            "the same, close to -dT W",
            "N mm",
            (-w, moved(hbot, off, 0).bar_couple_n_mm),
            1,
            "The paper leaves out d, and so the 4r.",
        ),
        say("after (38)", "motors' torque on the frame along x, H-bot", "N mm", (2.0 * r, on_frame(hbot, 0)), 1, ""),
        say("after (38)", "motors' torque on the frame along x, CoreXY", "N mm", (4.0 * r, on_frame(corexy, 0)), 1, ""),
        say(
            "after (38)",
            "motors' torque on the frame along x, CoreH-bot",
            "N mm",
            (4.0 * r, on_frame(corehbot, 0)),
            1,
            "By equation 12 the motors of a pair turn against each other, and so do their torques.",
        ),
        say(
            "after (38)",
            "motors' torque on the frame along y, all three",
            "N mm",
            (0.0, [hbot, corexy, corehbot].map(|m| on_frame(m, 1)).into_iter().fold(0.0, f64::max)),
            1,
            "",
        ),
    ]
}

/// Rank, unknowns and equations of (7).
fn degrees() -> (f64, f64, f64) {
    let matrix = displacements(Machine::CoreHBot, &Params::default());
    let (equations, unknowns) = matrix.shape();
    (matrix.rank(1e-9) as f64, unknowns as f64, equations as f64)
}

fn most(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Change of tension on the right over the one on the left, for a force along x on elastic belts.
fn sides(params: &Params, tool: Place) -> f64 {
    let setup = Setup { params: params.clone(), ..Setup::nominal(Machine::CoreHBot, tool.x, tool.y) };
    Push::new(&setup, [-1.0, 0.0]).map_or(f64::NAN, |push| {
        let of = |span: &str| push.strain.tension_change_n.get(span).copied().unwrap_or(f64::NAN);
        -of("R") / of("L")
    })
}

/// Torque with which the guides hold the bar square in a motion along y with dT = 1 N, where the bar has a mass. The
/// belt's couple about the tool accelerates the bar, with its mass in the middle; the guides bear the rest.
fn racking(params: &Params, tool: Place) -> f64 {
    let pattern = Pattern::new(Machine::CoreHBot, params, tool, 1);
    let [_, along_y, _] = Machine::CoreHBot.masses_kg(params);
    let bar_part = params.bar_mass_kg / along_y;
    pattern.couple_n_mm - bar_part * pattern.force_n[1] * (params.width_mm / 2.0 - tool.x)
}
