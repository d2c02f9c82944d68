//! Table 1 of \[H\], for a head with touching pulleys (e = 2 r).

use corehbot_twin::geometry::layout;
use corehbot_twin::params::Params;
use corehbot_twin::queries::geometry::numbers;
use corehbot_twin::routing::{Machine, Place};
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI};

/// The place of the tool for which the lengths are compared: anywhere but in the middle.
pub const TOOL: Place = Place::flat(150.0, 180.0);

/// The machine of the paper's table 2 with a head as small as its pulleys allow, as in table 1.
pub(super) fn touching() -> Params {
    let nominal = Params::default();
    Params { head_pulleys_mm: 2.0 * nominal.pulley_radius_mm, ..nominal }
}

/// A length.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Numbers of the two pulleys; twice the same is the wrap on it.
    pub between: [u8; 2],
    /// The paper's expression.
    pub expression: &'static str,
    /// Its value.
    pub printed_mm: f64,
    /// By the model.
    pub ours_mm: f64,
}

/// The paper's expressions for the straight segments: factors of x, y, W, D, r and d.
const SEGMENTS: [(&str, [f64; 6]); 14] = [
    ("y - d/2", [0.0, 1.0, 0.0, 0.0, 0.0, -0.5]),
    ("W - 4r", [0.0, 0.0, 1.0, 0.0, -4.0, 0.0]),
    ("y - d/2", [0.0, 1.0, 0.0, 0.0, 0.0, -0.5]),
    ("y - 2r", [0.0, 1.0, 0.0, 0.0, -2.0, 0.0]),
    ("W - x - r", [-1.0, 0.0, 1.0, 0.0, -1.0, 0.0]),
    ("W - x - r", [-1.0, 0.0, 1.0, 0.0, -1.0, 0.0]),
    ("D - y - 2r", [0.0, -1.0, 0.0, 1.0, -2.0, 0.0]),
    ("D - y - d/2", [0.0, -1.0, 0.0, 1.0, 0.0, -0.5]),
    ("W - 4r", [0.0, 0.0, 1.0, 0.0, -4.0, 0.0]),
    ("D - y - d/2", [0.0, -1.0, 0.0, 1.0, 0.0, -0.5]),
    ("D - y - 2r", [0.0, -1.0, 0.0, 1.0, -2.0, 0.0]),
    ("x - r", [1.0, 0.0, 0.0, 0.0, -1.0, 0.0]),
    ("x - r", [1.0, 0.0, 0.0, 0.0, -1.0, 0.0]),
    ("y - 2r", [0.0, 1.0, 0.0, 0.0, -2.0, 0.0]),
];

/// The pulleys that the belt leaves the way it came; on the others it turns by a right angle.
const HALF: [u8; 6] = [1, 4, 6, 8, 11, 13];

/// The table, for the dimensions of the paper's table 2.
pub(super) fn table_1() -> Vec<Row> {
    let p = touching();
    let of = [TOOL.x, TOOL.y, p.width_mm, p.depth_mm, p.pulley_radius_mm, p.bar_pulleys_mm];
    let laid = layout(Machine::CoreHBot, &p, TOOL);
    let number = numbers(Machine::CoreHBot);
    let segment = |(laid, (expression, factors)): (&corehbot_twin::geometry::Segment, (&'static str, [f64; 6]))| Row {
        between: [number(laid.from), number(laid.to)],
        expression,
        printed_mm: factors.iter().zip(of).map(|(factor, of)| factor * of).sum(),
        ours_mm: laid.length_mm,
    };
    let segments = laid.segments.iter().zip(SEGMENTS).map(segment);
    let wraps = laid.wraps.iter().map(|wrap| wrapped(number(wrap.stop), wrap.angle_rad, &p));
    segments.chain(wraps).collect()
}

fn wrapped(pulley: u8, angle_rad: f64, params: &Params) -> Row {
    let (expression, angle) = if HALF.contains(&pulley) { ("pi r", PI) } else { ("pi/2 r", FRAC_PI_2) };
    let radius = params.pulley_radius_mm;
    Row { between: [pulley; 2], expression, printed_mm: angle * radius, ours_mm: angle_rad * radius }
}
