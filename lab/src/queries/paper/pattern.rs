//! Pattern: the belt in a motion along an axis, by the paper's condition F: each segment is pulled, pushed or neither,
//! and all changes of tension have one magnitude, dT.

use corehbot_twin::geometry::layout;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::links::Links;
use corehbot_twin::model::loads::load;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Block, Machine, Place};

/// Smaller entries of a row are zero.
const NOTHING: f64 = 1e-9;

/// The effect of dT = 1 N.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Change of tension of each segment in N: 1, 0 or -1.
    pub tensions_n: Vec<f64>,
    /// Force of the belt on all that moves along x, and along y, in N.
    pub force_n: [f64; 2],
    /// Couple of the belt on head and bar about the tool in N mm, counter-clockwise (the paper's torque on the bar's
    /// guides, where the bar has no mass).
    pub couple_n_mm: f64,
    /// The same on the bar alone.
    pub bar_couple_n_mm: f64,
    /// The same about the origin, the center of pulley 1 (equations 33 and 34).
    pub bar_couple_about_origin_n_mm: f64,
    /// Torque of each motor, ascending, in N mm, counter-clockwise.
    pub torques_n_mm: Vec<f64>,
}

impl Pattern {
    /// For a motion along x (0) or y (1) against a force.
    #[must_use]
    pub fn new(machine: Machine, params: &Params, tool: Place, axis: usize) -> Self {
        // The force holds the tool back, and so stretches the spans that pull.
        let spans = Links::spans(machine, params, tool);
        let of_axis = spans.index(Coordinate::TOOL[axis.min(1)]);
        let pulled = |row: &[f64]| {
            let stretch = of_axis.and_then(|axis| row.get(axis)).map_or(0.0, |grows| -grows);
            if stretch.abs() < NOTHING { 0.0 } else { stretch.signum() }
        };
        let segments = Links::segments(machine, params, tool);
        let span = |name: &str| spans.links.iter().find(|span| span.span == name);
        let tension = |name: &str| span(name).map_or(0.0, |span| pulled(&span.row));
        let tensions_n: Vec<f64> = segments.links.iter().map(|link| tension(link.span)).collect();
        let laid = layout(machine, params, tool);
        let [head, bar] = [Block::Head, Block::Bar].map(|block| load(machine, &laid, &tensions_n, block, tool));
        let torque = |(index, motor): (usize, u8)| {
            let at = segments.index(Coordinate::Motor(motor));
            let entry = |row: &[f64]| at.and_then(|at| row.get(at)).copied().unwrap_or(0.0);
            let forces = segments.links.iter().zip(&tensions_n).map(|(link, tension)| entry(&link.row) * tension);
            params.radius_mm(index) * forces.sum::<f64>()
        };
        let torques_n_mm = machine.motors().into_iter().enumerate().map(torque).collect();
        Self {
            force_n: [head.x_n, head.y_n + bar.y_n],
            couple_n_mm: head.couple_n_mm + bar.couple_n_mm,
            bar_couple_n_mm: bar.couple_n_mm,
            bar_couple_about_origin_n_mm: load(machine, &laid, &tensions_n, Block::Bar, Place::flat(0.0, 0.0))
                .couple_n_mm,
            tensions_n,
            torques_n_mm,
        }
    }
}
