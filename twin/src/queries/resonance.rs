//! Resonance: the frequency of each axis over the reach, and remedies.
//!
//! The mode of an axis is the one in which the tool has most of its energy along it. The answer includes a shaper for
//! each axis and its band of frequencies ([`crate::shaping`]). It also has the speeds at which full steps, electrical
//! turns and teeth repeat at these frequencies.
//!
//! The bar also yaws on its guides, on a CoreH-bot at a lower frequency than both axes. No shaper is made for it. Only
//! moves along y excite it, the more the further the head is from the middle. The answer has its frequency, and the
//! part that the shaper of y leaves.

use super::{Setup, shown};
use crate::geometry::workspace;
use crate::model::coordinate::Coordinate;
use crate::model::elastic::Freedom;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::shaping::design::{Design, designs};
use crate::shaping::shaper::{impulses, residual};
use crate::solve::NotHeld;
use crate::solve::modes::{Mode, mode_of, modes};
use serde::Serialize;

/// Pitch of the belt's teeth: GT2, \[H\] table 2.
const TOOTH_MM: f64 = 2.0;

/// Frequencies all over the reach.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Resonance {
    /// The machine.
    pub machine: &'static str,
    /// Columns of the grid, from motor 1's axis.
    pub x_mm: Vec<f64>,
    /// Rows of the grid.
    pub y_mm: Vec<f64>,
    /// Results for x.
    pub x: AxisResonance,
    /// Results for y.
    pub y: AxisResonance,
    /// The bar's yaw on its guides, for which no shaper is made.
    pub yaw: YawResonance,
}

/// Yaw frequencies of the bar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct YawResonance {
    /// Row after row of the grid.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<Vec<f64>>,
    /// Lowest and highest of them.
    #[serde(rename = "band_Hz")]
    pub band_hz: [f64; 2],
    /// Viscous damping ratio in the middle of the reach.
    pub damping_ratio: f64,
    /// The part of it that the shaper for y leaves at the worst place, of 1.
    pub left_by_y: Option<f64>,
}

/// Frequencies of an axis, and results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisResonance {
    /// Row after row of the grid.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<Vec<f64>>,
    /// Lowest and highest of them.
    #[serde(rename = "band_Hz")]
    pub band_hz: [f64; 2],
    /// Part of the other axis in the vibration at the worst place, of 1.
    pub coupling: f64,
    /// Viscous damping ratio in the middle of the reach.
    pub damping_ratio: f64,
    /// The suggested shaper.
    pub suggestion: Option<Design>,
    /// The best of each kind.
    pub shapers: Vec<Design>,
    /// The line that sets it.
    pub line: String,
    /// Speeds along the axis at which belt and motors excite the middle of its band.
    pub resonant_speeds: ResonantSpeeds,
}

/// Speeds along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ResonantSpeeds {
    /// One full step per period.
    pub full_step_mm_s: f64,
    /// One electrical turn per period.
    pub electrical_turn_mm_s: f64,
    /// One tooth per period.
    pub tooth_mm_s: f64,
}

impl Resonance {
    /// On a grid of this many columns and rows.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup, columns: usize, rows: usize) -> Result<Self, NotHeld> {
        let reach = workspace(setup.machine, &setup.params);
        let (x_mm, y_mm) = (points(reach.x, columns), points(reach.y, rows));
        let at = |x: f64, y: f64| modes(&Setup { tool: reach.at(x, y), ..setup.clone() }.elastic());
        let grid = y_mm.iter().map(|y| x_mm.iter().map(|x| at(*x, *y)).collect::<Result<Vec<_>, _>>());
        let grid: Vec<Vec<Vec<Mode>>> = grid.collect::<Result<_, _>>()?;
        let middle = at(reach.centre().x, reach.centre().y)?;
        let [x, y] = [("X", Coordinate::X, Coordinate::Y), ("Y", Coordinate::Y, Coordinate::X)]
            .map(|(letter, own, other)| axis(letter, own, other, &grid, &middle, &setup.params));
        let yaw = yaw(setup, &x_mm, &y_mm, &y)?;
        Ok(Self { machine: setup.machine.key(), x_mm, y_mm, x, y, yaw })
    }
}

/// The bar's yaw on a grid, and the part that the shaper for y leaves.
fn yaw(setup: &Setup, x_mm: &[f64], y_mm: &[f64], y: &AxisResonance) -> Result<YawResonance, NotHeld> {
    let freedom = Freedom { yaw: true, ..setup.freedom };
    let mode = |tool: Place| {
        let modes = modes(&Setup { tool, freedom, ..setup.clone() }.elastic())?;
        mode_of(&modes, Coordinate::Yaw).cloned().ok_or(NotHeld)
    };
    let reach = workspace(setup.machine, &setup.params);
    let row = |y: &f64| x_mm.iter().map(|x| Ok(mode(reach.at(*x, *y))?.frequency_hz)).collect();
    let frequencies_hz = y_mm.iter().map(row).collect::<Result<Vec<Vec<f64>>, NotHeld>>()?;
    let all = || frequencies_hz.iter().flatten().copied();
    let band_hz = [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)];
    let damping_ratio = mode(reach.centre())?.damping_ratio;
    let left_by_y = y.suggestion.map(|design| {
        let impulses = impulses(design.kind, design.frequency_hz, y.damping_ratio);
        all().map(|hz| residual(&impulses, hz, damping_ratio)).fold(0.0, f64::max)
    });
    Ok(YawResonance { frequencies_hz, band_hz, damping_ratio, left_by_y })
}

/// Evenly from one end to the other.
pub(super) fn points([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    match count {
        0 | 1 => vec![(low + high) / 2.0],
        _ => (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect(),
    }
}

fn axis(
    letter: &str,
    own: Coordinate,
    other: Coordinate,
    grid: &[Vec<Vec<Mode>>],
    middle: &[Mode],
    params: &Params,
) -> AxisResonance {
    let frequency = |modes: &Vec<Mode>| mode_of(modes, own).map_or(0.0, |mode| mode.frequency_hz);
    let frequencies_hz: Vec<Vec<f64>> = grid.iter().map(|row| row.iter().map(frequency).collect()).collect();
    let all = || frequencies_hz.iter().flatten().copied();
    let band_hz = [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)];
    let part = |modes: &Vec<Mode>| mode_of(modes, own).map_or(0.0, |mode| mode.share(other));
    let coupling = grid.iter().flatten().map(part).fold(0.0, f64::max);
    let damping_ratio = mode_of(middle, own).map_or(0.0, |mode| mode.damping_ratio);
    let (shapers, suggestion) = designs(band_hz, damping_ratio);
    let line = suggestion.map_or_else(String::new, |design| {
        let (frequency, kind) = (design.frequency_hz, design.kind.number());
        format!("M593 {letter} F{frequency:.1} D{damping_ratio:.3} T{kind}")
    });
    let middle_hz = mode_of(middle, own).map_or(0.0, |mode| mode.frequency_hz);
    let resonant_speeds = ResonantSpeeds {
        full_step_mm_s: middle_hz * params.full_step_mm(0),
        electrical_turn_mm_s: middle_hz * 4.0 * params.full_step_mm(0),
        tooth_mm_s: middle_hz * TOOTH_MM,
    };
    AxisResonance { frequencies_hz, band_hz, coupling, damping_ratio, suggestion, shapers, line, resonant_speeds }
}

impl std::fmt::Display for Resonance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = Machine::name_of(self.machine);
        writeln!(f, "{name}, {} places", self.x_mm.len() * self.y_mm.len())?;
        for (letter, axis) in [("x", &self.x), ("y", &self.y)] {
            let [low, high] = axis.band_hz;
            let (damping, coupling) = (100.0 * axis.damping_ratio, shown(100.0 * axis.coupling, 0));
            write!(f, "  {letter}  {low:.1} to {high:.1} Hz, damping {damping:.1} %")?;
            writeln!(f, ", the other axis has up to {coupling} % of it")?;
            self.map(f, axis)?;
            for design in &axis.shapers {
                let mark = if axis.suggestion == Some(*design) { "*" } else { " " };
                let (kind, frequency, smoothing) = (design.kind.name(), design.frequency_hz, design.smoothing_mm);
                let left = 100.0 * design.worst_residual;
                writeln!(f, "   {mark} {kind:<9} {frequency:>6.1} Hz  leaves {left:>4.1} %  rounds {smoothing:.3} mm")?;
            }
            writeln!(f, "     {}", axis.line)?;
            let ResonantSpeeds { full_step_mm_s, electrical_turn_mm_s, tooth_mm_s } = axis.resonant_speeds;
            write!(f, "     rings at {full_step_mm_s:.1} mm/s (full steps), ")?;
            writeln!(f, "{electrical_turn_mm_s:.1} (electrical turns), {tooth_mm_s:.1} (teeth)")?;
        }
        let YawResonance { band_hz: [low, high], damping_ratio, left_by_y, .. } = &self.yaw;
        let damping = 100.0 * damping_ratio;
        writeln!(f, "  yaw of the bar on its guides  {low:.1} to {high:.1} Hz, damping {damping:.1} %")?;
        writeln!(
            f,
            "     moves along y excite it, the more so the further the head is from the middle; no line above is made for it"
        )?;
        if let Some(left) = left_by_y {
            writeln!(f, "     the line for Y leaves up to {:.0} % of it; stiffer guides raise it", 100.0 * left)?;
        }
        Ok(())
    }
}

/// Largest number of grid columns shown to people.
const SHOWN: usize = 12;

impl Resonance {
    /// The grid as a map, the back of the machine first.
    fn map(&self, f: &mut std::fmt::Formatter<'_>, axis: &AxisResonance) -> std::fmt::Result {
        if self.x_mm.len() > SHOWN || self.y_mm.len() > SHOWN {
            return Ok(());
        }
        for (y, row) in self.y_mm.iter().zip(&axis.frequencies_hz).rev() {
            let row: Vec<String> = row.iter().map(|hz| format!("{hz:>6.1}")).collect();
            writeln!(f, "     y {y:>5.1} |{}", row.concat())?;
        }
        let columns: Vec<String> = self.x_mm.iter().map(|x| format!("{x:>6.1}")).collect();
        writeln!(f, "           x{}", columns.concat())
    }
}
