//! Resonance: the frequency of each axis over the reach, and remedies.
//!
//! The mode of an axis is the one in which the tool has most of its energy along it. The answer includes a shaper for
//! each axis and its band of frequencies ([`crate::shaping`]). It also has the speeds at which full steps, electrical
//! turns and teeth repeat at these frequencies.
//!
//! The bar also yaws on its guides, on a CoreH-bot at a lower frequency than both axes. No shaper is made for it. Only
//! moves along y excite it, the more the further the head is from the middle. The answer has its frequency, and the
//! part that the shaper of y leaves. A soft frame has a mode in x and one in y. Each has its part of the tool's ringing
//! after a jump of speed, and the part that the axis' shaper leaves.
//!
//! Where belts lift the tool, the maps are at half its height. Bands have its lowest and highest places too.

use super::{Setup, shown};
use crate::geometry::{greatest, points, workspace};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::Freedom;
use crate::model::ways::Ways;
use crate::params::TOOTH_MM;
use crate::routing::{Machine, Place};
use crate::shaping::by_tool::{ByTool, by_tool};
use crate::shaping::design::{Design, designs};
use crate::shaping::shaper::{ShaperKind, impulses, residual};
use crate::shaping::wall::Print;
use crate::solve::NotHeld;
use crate::solve::modes::{Mode, Ringing, mode_of, modes};
use serde::Serialize;

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
    /// Results for z, where belts lift the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<AxisResonance>,
    /// The bar's yaw on its guides, for which no shaper is made; none where the bar does not move in y.
    pub yaw: Option<YawResonance>,
    /// A soft frame in x and in y; none of a rigid one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<[FrameResonance; 2]>,
}

/// The mode of a soft frame along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameResonance {
    /// Its lowest and highest frequency over the reach.
    #[serde(rename = "band_Hz")]
    pub band_hz: [f64; 2],
    /// Viscous damping ratio in the middle of the reach.
    pub damping_ratio: f64,
    /// Its largest part of the tool's ringing after a jump of speed, of 1.
    pub part: f64,
    /// The part of this mode that the suggested shaper of the axis leaves at the worst place, of 1.
    pub left_by_shaper: Option<f64>,
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
    /// Part of the other axes in the vibration at the worst place, of 1.
    pub coupling: f64,
    /// Viscous damping ratio in the middle of the reach.
    pub damping_ratio: f64,
    /// The suggested shaper.
    pub suggestion: Option<Design>,
    /// The best of each kind.
    pub shapers: Vec<Design>,
    /// The line that sets it.
    pub line: String,
    /// The ranking by the error of the tool, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_tool: Option<ByTool>,
    /// The line that sets its suggestion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_by_tool: Option<String>,
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
        let at = |tool: Place| modes(&Setup { tool, ..setup.clone() }.elastic());
        let mut all = Vec::new();
        greatest(&reach, [columns, rows], |tool| {
            let modes = at(tool)?;
            let [x, y, z] = Coordinate::TOOL.map(|own| extremes(&modes, own));
            all.push(modes);
            Ok::<_, NotHeld>([x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]])
        })?;
        let places = columns * rows * reach.heights().len();
        let seen = Seen { setup, columns, rows, places, all, middle: at(reach.centre())? };
        let [x, y] =
            [(Coordinate::X, Some("X")), (Coordinate::Y, Some("Y"))].map(|(own, letter)| seen.axis(own, letter));
        // The firmware has no shaper for z.
        let z = setup.machine.lifts().then(|| seen.axis(Coordinate::Z, None));
        let yaw = setup.machine.has_yawing_bar().then(|| yaw(setup, &x_mm, &y_mm, &y)).transpose()?;
        let frame = seen.frame(Coordinate::X, &x).zip(seen.frame(Coordinate::Y, &y)).map(|(x, y)| [x, y]);
        Ok(Self { machine: setup.machine.key(), x_mm, y_mm, x, y, z, yaw, frame })
    }
}

/// The modes all over the reach.
struct Seen<'s> {
    setup: &'s Setup,
    columns: usize,
    rows: usize,
    /// Places of the grid.
    places: usize,
    /// At each place of the grid, height after height, and then where the search for the worst places went.
    all: Vec<Vec<Mode>>,
    middle: Vec<Mode>,
}

/// Figures that are greatest at the ends of an axis's band and where its coupling is.
fn extremes(modes: &[Mode], own: Coordinate) -> [f64; 3] {
    let frequency = mode_of(modes, own).map_or(0.0, |mode| mode.frequency_hz);
    [-frequency, frequency, coupling(modes, own)]
}

/// Part of the other axes in the vibration along an axis, of 1.
fn coupling(modes: &[Mode], own: Coordinate) -> f64 {
    let others = Coordinate::TOOL.into_iter().filter(|other| *other != own);
    mode_of(modes, own).map_or(0.0, |mode| others.map(|other| mode.share(other)).sum())
}

/// Lowest and highest.
fn band(all: impl Iterator<Item = f64>) -> [f64; 2] {
    all.fold([f64::INFINITY, 0.0], |[low, high], hz| [low.min(hz), high.max(hz)])
}

impl Seen<'_> {
    fn axis(&self, own: Coordinate, letter: Option<&str>) -> AxisResonance {
        let frequency = |modes: &Vec<Mode>| mode_of(modes, own).map_or(0.0, |mode| mode.frequency_hz);
        let each: Vec<f64> = self.all.iter().map(frequency).collect();
        // The heights are as many below the map's as above it.
        let a_map = self.columns * self.rows;
        let below = a_map * (self.places / a_map / 2);
        let map = each.iter().copied().skip(below).take(a_map).collect::<Vec<_>>();
        let band_hz = band(each.into_iter());
        let coupling = self.all.iter().map(|modes| coupling(modes, own)).fold(0.0, f64::max);
        let damping_ratio = mode_of(&self.middle, own).map_or(0.0, |mode| mode.damping_ratio);
        let (shapers, suggestion) = designs(band_hz, damping_ratio);
        let line = suggestion
            .zip(letter)
            .map_or_else(String::new, |(design, letter)| line(letter, design.kind, design.frequency_hz, damping_ratio));
        let middle_hz = mode_of(&self.middle, own).map_or(0.0, |mode| mode.frequency_hz);
        let full_step_mm = self.full_step_mm(own);
        let resonant_speeds = ResonantSpeeds {
            full_step_mm_s: middle_hz * full_step_mm,
            electrical_turn_mm_s: middle_hz * 4.0 * full_step_mm,
            tooth_mm_s: middle_hz * TOOTH_MM,
        };
        let frequencies_hz = map.chunks(self.columns).map(<[f64]>::to_vec).collect();
        AxisResonance {
            frequencies_hz,
            band_hz,
            coupling,
            damping_ratio,
            suggestion,
            shapers,
            line,
            by_tool: None,
            line_by_tool: None,
            resonant_speeds,
        }
    }

    /// A full step of the first motor that moves an axis.
    fn full_step_mm(&self, own: Coordinate) -> f64 {
        let Setup { machine, params, .. } = self.setup;
        let axis = Coordinate::TOOL.iter().position(|known| *known == own).unwrap_or_default();
        let moves = |row: &[f64; 3]| row.get(axis).is_some_and(|way| way.abs() > 0.5);
        params.full_step_mm(Ways::new(*machine, params).rows.iter().position(moves).unwrap_or_default())
    }

    /// The frame's mode along an axis of the tool, if it is soft.
    fn frame(&self, own: Coordinate, axis: &AxisResonance) -> Option<FrameResonance> {
        let each: Vec<Ringing> = self.all.iter().filter_map(|modes| Ringing::of(modes, own)).collect();
        let all = || each.iter().filter_map(|ringing| Some(ringing.frame?.frequency_hz));
        let damping_ratio = Ringing::of(&self.middle, own)?.frame?.damping_ratio;
        let left_by_shaper = axis.suggestion.map(|design| {
            let impulses = impulses(design.kind, design.frequency_hz, axis.damping_ratio);
            all().map(|hz| residual(&impulses, hz, damping_ratio)).fold(0.0, f64::max)
        });
        let part = each.iter().map(Ringing::part_of_frame).fold(0.0, f64::max);
        Some(FrameResonance { band_hz: band(all()), damping_ratio, part, left_by_shaper })
    }
}

impl Resonance {
    /// The same with shapers ranked by the error of the tool on walls that are printed so. On each axis the worst of
    /// its middle and of both ends of its band counts. Some seconds of work.
    #[must_use]
    pub fn ranked_by_tool(mut self, print: &Print) -> Self {
        for (letter, axis) in [("X", &mut self.x), ("Y", &mut self.y)] {
            // Both ends are as far from the middle of the band.
            let middle_hz = (axis.band_hz[0] * axis.band_hz[1]).sqrt();
            axis.by_tool = by_tool(middle_hz, axis.band_hz, axis.damping_ratio, print);
            let ranked = axis.by_tool.as_ref().map(|ranked| (ranked.suggestion, ranked.damping_ratio));
            axis.line_by_tool = ranked.map(|(best, damping)| line(letter, best.kind, best.frequency_hz, damping));
        }
        self
    }
}

/// The line that sets a shaper.
fn line(letter: &str, kind: ShaperKind, frequency_hz: f64, damping: f64) -> String {
    format!("M593 {letter} F{frequency_hz:.1} D{damping:.3} T{}", kind.number())
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
    let band_hz = band(all());
    let damping_ratio = mode(reach.centre())?.damping_ratio;
    let left_by_y = y.suggestion.map(|design| {
        let impulses = impulses(design.kind, design.frequency_hz, y.damping_ratio);
        all().map(|hz| residual(&impulses, hz, damping_ratio)).fold(0.0, f64::max)
    });
    Ok(YawResonance { frequencies_hz, band_hz, damping_ratio, left_by_y })
}

impl std::fmt::Display for Resonance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = Machine::name_of(self.machine);
        writeln!(f, "{name}, {} places", self.x_mm.len() * self.y_mm.len())?;
        for (letter, axis) in [("x", Some(&self.x)), ("y", Some(&self.y)), ("z", self.z.as_ref())] {
            let Some(axis) = axis else { continue };
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
            let line = if letter == "z" { "the firmware has no shaper for z" } else { &axis.line };
            writeln!(f, "     {line}")?;
            told_by_tool(f, axis)?;
            let ResonantSpeeds { full_step_mm_s, electrical_turn_mm_s, tooth_mm_s } = axis.resonant_speeds;
            write!(f, "     rings at {full_step_mm_s:.1} mm/s (full steps), ")?;
            writeln!(f, "{electrical_turn_mm_s:.1} (electrical turns), {tooth_mm_s:.1} (teeth)")?;
        }
        for (letter, frame) in ["x", "y"].into_iter().zip(self.frame.iter().flatten()) {
            let FrameResonance { band_hz: [low, high], damping_ratio, part, left_by_shaper } = frame;
            let [damping, part] = [damping_ratio, part].map(|of| 100.0 * of);
            write!(
                f,
                "  frame in {letter}  {low:.1} to {high:.1} Hz, damping {damping:.1} %, {part:.1} % of the ringing"
            )?;
            let left =
                left_by_shaper.map_or(String::new(), |left| format!(", {:.0} % with the line above", 100.0 * left));
            writeln!(f, "{left}")?;
        }
        let Some(YawResonance { band_hz: [low, high], damping_ratio, left_by_y, .. }) = &self.yaw else {
            return Ok(());
        };
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

fn told_by_tool(f: &mut std::fmt::Formatter<'_>, axis: &AxisResonance) -> std::fmt::Result {
    let (Some(ranked), Some(line)) = (&axis.by_tool, &axis.line_by_tool) else { return Ok(()) };
    let Print { acceleration_mm_s2, speed_mm_s, .. } = ranked.print;
    writeln!(f, "     by the error of the tool on walls, at {acceleration_mm_s2:.0} mm/s2 and {speed_mm_s:.0} mm/s:")?;
    for s in &ranked.shapers {
        let mark = if *s == ranked.suggestion { "*" } else { " " };
        let (kind, hz, net) = (s.kind.name(), s.frequency_hz, s.net_rounding_a_per_w2);
        write!(f, "   {mark} {kind:<9} {hz:>6.1} Hz  net rounding {net:>5.2} a/w2  {:>6.1} um RMS", s.wall.rms_um)?;
        writeln!(f, ", at the worst place {:.1} um", s.worst_wall.rms_um)?;
    }
    writeln!(f, "     {line}")?;
    let by_vibration = axis.suggestion.filter(|other| other.kind != ranked.suggestion.kind);
    let Some(other) = by_vibration else { return Ok(()) };
    let of = |kind: ShaperKind| ranked.shapers.iter().find(|s| s.kind == kind).map_or(0.0, |s| s.worst_wall.rms_um);
    let (own, its) = (ranked.suggestion.kind, other.kind);
    // Each as its line sets it: both rankings have a kind at other frequencies.
    let [its_left, own_left] = [other.worst_residual, ranked.suggestion.worst_residual].map(|left| 100.0 * left);
    write!(f, "     Two lines: {} leaves {its_left:.1} % of the ringing at the worst place and ", its.name())?;
    write!(f, "{} {own_left:.1} %. ", own.name())?;
    write!(f, "But belts lag, which cancels most of a shaper's rounding, so walls are off by ")?;
    writeln!(f, "{:.1} um with {} and by {:.1} um with {}.", of(own), own.name(), of(its), its.name())
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
