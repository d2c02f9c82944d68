//! Gantry: what the belts of a CoreXYZ stretch by when the gantry tilts and the bar yaws.
//!
//! The bar yaws about its middle, with the head on it. The gantry tilts about the middle of the machine, with bar and
//! head on it: a stop there rises by `tilt_x (y - D/2) - tilt_y (x - W/2)`. By the segment law this stretches the
//! upright parts of a belt alone.

use super::coordinate::Coordinate;
use super::links::Links;
use crate::geometry::layout;
use crate::params::Params;
use crate::routing::{Machine, Place, Stop};
use nalgebra::{DMatrix, DVector};

/// Coordinates of [`GantryPart::row`].
pub const COORDINATES: usize = 6;

/// The bar's yaw, and the gantry's tilts about x and y, among them; x, y and z of the tool stand before.
pub const YAW: usize = 3;
/// The tilt about x, which lifts the back.
pub const TILT_X: usize = 4;
/// The tilt about y, which lifts the left side.
pub const TILT_Y: usize = 5;

/// N mm in an N m.
const MM_PER_M: f64 = 1000.0;

/// A part of a belt with one tension: a span between clamp and motor, or a whole belt that its motor lets slip.
#[derive(Clone, Debug, PartialEq)]
pub struct GantryPart {
    /// Its name.
    pub name: &'static str,
    /// Its belt, in the order of the machine's belts.
    pub belt: usize,
    /// Free length in mm.
    pub length_mm: f64,
    /// Its stretch in mm for a unit of each coordinate: mm and rad.
    pub row: [f64; COORDINATES],
    /// Its stretch in mm for a mm of each motor.
    pub motors: Vec<f64>,
    /// Stiffness in N/mm.
    pub stiffness: f64,
}

/// The machine's belts about a place of its tool, with the guides of bar and gantry.
#[derive(Clone, Debug, PartialEq)]
pub struct Gantry {
    /// The parts of the belts.
    pub parts: Vec<GantryPart>,
    /// Stiffness of the guides at each coordinate: N/mm, N mm/rad.
    pub guides: [f64; COORDINATES],
}

/// Changes from the machine at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Displacement of each coordinate, mm and rad.
    pub moved: [f64; COORDINATES],
    /// Change of each part's tension, N.
    pub tensions_n: Vec<f64>,
}

impl Gantry {
    /// Spans from clamps to motors, with motors that hold.
    #[must_use]
    pub fn held(machine: Machine, params: &Params, tool: Place) -> Self {
        let spans = Links::spans(machine, params, tool);
        let tilts = tilts(machine, params, tool);
        let of = |row: &[f64], coordinate| spans.index(coordinate).and_then(|i| row.get(i)).copied().unwrap_or(0.0);
        let part = |(span, [x, y]): (&super::links::Link, [f64; 2])| {
            let [along_x, along_y, up] = Coordinate::TOOL.map(|axis| of(&span.row, axis));
            GantryPart {
                name: span.span,
                belt: span.belt,
                length_mm: span.length_mm,
                row: [along_x, along_y, up, of(&span.row, Coordinate::Yaw), x, y],
                motors: machine.motors().iter().map(|number| of(&span.row, Coordinate::Motor(*number))).collect(),
                stiffness: span.stiffness(params),
            }
        };
        let parts = spans.links.iter().zip(tilts).map(part).collect();
        let tilt = params.gantry_tilt_stiffness_nm_per_rad * MM_PER_M;
        Self { parts, guides: [0.0, 0.0, 0.0, params.bar_yaw_stiffness_nm_per_rad * MM_PER_M, tilt, tilt] }
    }

    /// Whole belts, which slip over motors without power. The tool's place strains none of them.
    #[must_use]
    pub fn loose(machine: Machine, params: &Params, tool: Place) -> Self {
        let Self { parts, guides } = Self::held(machine, params, tool);
        let mut belts: Vec<GantryPart> = Vec::new();
        for part in parts {
            match belts.last_mut() {
                Some(belt) if belt.belt == part.belt => {
                    belt.length_mm += part.length_mm;
                    belt.stiffness = 1.0 / (1.0 / belt.stiffness + 1.0 / part.stiffness);
                    belt.row.iter_mut().zip(part.row).for_each(|(entry, more)| *entry += more);
                    belt.motors.iter_mut().zip(part.motors).for_each(|(entry, more)| *entry += more);
                }
                _ => belts.push(part),
            }
        }
        Self { parts: belts, guides }
    }

    /// With a spring of this stiffness in N/mm in each part.
    #[must_use]
    pub fn with_springs(mut self, spring: f64) -> Self {
        for part in &mut self.parts {
            part.stiffness = 1.0 / (1.0 / part.stiffness + 1.0 / spring);
        }
        self
    }

    /// The equilibrium under forces (N, N mm) at the coordinates, with this belt taken up in each part, mm. `from` is
    /// the first coordinate that moves: 0, or [`YAW`] where the tool is held otherwise. `None` if nothing holds them.
    #[must_use]
    pub fn settle(&self, from: usize, force: [f64; COORDINATES], taken_mm: &[f64]) -> Option<Given> {
        let moves = COORDINATES.checked_sub(from)?;
        let mut stiffness = DMatrix::from_fn(moves, moves, |i, j| {
            if i == j { self.guides.get(from + i).copied().unwrap_or(0.0) } else { 0.0 }
        });
        let mut pull = DVector::from_iterator(moves, force.into_iter().skip(from));
        for (part, taken) in self.parts.iter().zip(taken_mm) {
            let row = DVector::from_iterator(moves, part.row.into_iter().skip(from));
            pull -= &row * (part.stiffness * taken);
            stiffness += &row * row.transpose() * part.stiffness;
        }
        let solved = stiffness.cholesky()?.solve(&pull);
        let mut moved = [0.0; COORDINATES];
        moved.iter_mut().skip(from).zip(solved.iter()).for_each(|(to, way)| *to = *way);
        let stretch = |part: &GantryPart| part.row.iter().zip(moved).map(|(row, moved)| row * moved).sum::<f64>();
        let tensions_n =
            self.parts.iter().zip(taken_mm).map(|(part, taken)| part.stiffness * (stretch(part) + taken)).collect();
        Some(Given { moved, tensions_n })
    }
}

/// Stretch of each span in mm per rad of the tilts about x and y.
fn tilts(machine: Machine, params: &Params, tool: Place) -> Vec<[f64; 2]> {
    let stops = machine.stops();
    let rises = |stop: &Stop| {
        let [x, y] = stop.centre(params, tool);
        [y - params.depth_mm / 2.0, params.width_mm / 2.0 - x].map(|arm| stop.follows(2) * arm)
    };
    let segments = Links::segments(machine, params, tool).links;
    let mut sums: Vec<(&'static str, [f64; 2])> = Vec::new();
    for (segment, link) in layout(machine, params, tool).segments.iter().zip(segments) {
        let (Some(from), Some(to)) = (stops.get(segment.from), stops.get(segment.to)) else { continue };
        let (from, to) = (rises(from), rises(to));
        let stretch = [0, 1].map(|i: usize| segment.rise * (to[i] - from[i]));
        match sums.last_mut() {
            Some((name, sum)) if *name == link.span => *sum = [sum[0] + stretch[0], sum[1] + stretch[1]],
            _ => sums.push((link.span, stretch)),
        }
    }
    sums.into_iter().map(|(_, sum)| sum).collect()
}
