//! Response: motion of the tool by each source, through the machine's modes.
//!
//! At the angular frequency w the coordinates q move by `(K + i w C - w^2 M) q = F`. All three matrices are symmetric,
//! so one solution for a unit force on the tool gives the tool's answer to every source. Answers are computed at
//! frequencies close to each other, and are straight lines between them.
//!
//! A source meets a mode at one speed for each direction, and at one or two directions for each speed. Peaks are
//! narrow, so whoever looks for the worst looks there, and not at even distances alone.

use super::source::{Amounts, RippleKind, sources};
use crate::math::{acos, atan2, hypot, ln, powi, sin_cos};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, ElasticPart, Freedom};
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::NotHeld;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// N/mm over kg, in 1/s^2: 1 N moves 1 kg by 1000 mm/s^2.
const MM_PER_M: f64 = 1000.0;

/// Belt that hardly moves repeats nothing: mm per mm of the tool.
const AT_REST: f64 = 1e-9;

/// Lowest frequency in Hz, below which the machine is at rest; and each one over the one before. A resonance of 1 %
/// damping is wider by a factor of four.
const LOWEST_HZ: f64 = 0.5;
const RATIO: f64 = 1.005;

/// Frequencies: up to 10 kHz, far above all modes that move the tool.
const COUNT: usize = 1987;

/// Peaks lower than this part of the greatest one are none.
const PEAK: f64 = 0.02;

/// Motion of the tool in x and in y.
type Moved = [Complex<f64>; 2];

/// A source, and the tool's motion by it.
#[derive(Clone, Debug)]
struct Pulls {
    kind: RippleKind,
    pulley: u8,
    pitch_mm: f64,
    belt_per_mm: [f64; 2],
    /// In phase, and a quarter later, at each frequency.
    moved: Vec<[Moved; 2]>,
    /// Frequencies at which the tool moves most.
    peaks_hz: Vec<f64>,
}

/// A machine that moves at constant speed.
#[derive(Clone, Debug)]
pub struct Response {
    pulls: Vec<Pulls>,
}

/// Motion of the tool by one source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaken {
    /// What repeats.
    pub kind: RippleKind,
    /// Number of its motor or idler.
    pub pulley: u8,
    /// Its frequency.
    pub frequency_hz: f64,
    /// Path of the tool from one repeat to the next.
    pub wave_mm: f64,
    /// Amplitude of the tool's motion across its path, which a wall shows.
    pub across_um: f64,
    /// Amplitude along its path.
    pub along_um: f64,
}

impl Response {
    /// The machine with its tool at a place. With `yaw`, the bar may yaw on its guides.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(machine: Machine, params: &Params, tool: Place, amounts: &Amounts, yaw: bool) -> Result<Self, NotHeld> {
        let freedom = Freedom { idlers: true, rotors: true, yaw, free_motor: None };
        let elastic = Elastic::new(machine, params, tool, freedom);
        let moving = elastic.with_part(ElasticPart::Moves);
        let sources = sources(&elastic, params, amounts, tool);
        let own = |all: &DVector<f64>| DVector::from_iterator(moving.len(), moving.iter().map(|i| all[*i]));
        let forces: Vec<[DVector<f64>; 2]> = sources.iter().map(|source| source.force_n.each_ref().map(own)).collect();
        let mut moved = vec![Vec::with_capacity(COUNT); sources.len()];
        for hz in (0..COUNT).map(frequency_hz) {
            let (tool, damper) =
                (answers(&elastic, &moving, params, tool, TAU * hz)?, params.belt_damping_s * TAU * hz);
            for ((source, forces), moved) in sources.iter().zip(&forces).zip(&mut moved) {
                let factor = Complex::new(1.0, if source.is_stretch { damper } else { 0.0 });
                let by = |force: &DVector<f64>| {
                    let along = |unit: &DVector<Complex<f64>>| unit.iter().zip(force.iter()).map(|(u, f)| u * f).sum();
                    tool.each_ref().map(along).map(|moved: Complex<f64>| moved * factor)
                };
                moved.push(forces.each_ref().map(by));
            }
        }
        let pulls = sources.iter().zip(moved).map(|(source, moved)| Pulls {
            kind: source.kind,
            pulley: source.pulley,
            pitch_mm: source.pitch_mm,
            belt_per_mm: source.belt_per_mm,
            peaks_hz: peaks_hz(&moved),
            moved,
        });
        Ok(Self { pulls: pulls.collect() })
    }

    /// Motion of the tool by each source that repeats within `longest_mm` of the path, in the direction `angle_rad`
    /// from x towards y.
    pub fn at(&self, angle_rad: f64, speed_mm_s: f64, longest_mm: f64) -> impl Iterator<Item = Shaken> + '_ {
        let (sin, cos) = sin_cos(angle_rad);
        self.pulls.iter().filter_map(move |pulls| {
            let belt = pulls.belt_per_mm[0] * cos + pulls.belt_per_mm[1] * sin;
            let wave_mm = pulls.pitch_mm / belt.abs();
            if belt.abs() < AT_REST || wave_mm > longest_mm {
                return None;
            }
            let frequency_hz = speed_mm_s / wave_mm;
            let [x, y] = pulls.moved(frequency_hz, belt.signum());
            let um = |v: Complex<f64>| 1000.0 * hypot(v.re, v.im);
            Some(Shaken {
                kind: pulls.kind,
                pulley: pulls.pulley,
                frequency_hz,
                wave_mm,
                across_um: um(y * cos - x * sin),
                along_um: um(x * cos + y * sin),
            })
        })
    }

    /// Directions in radians, from 0 to below a half turn, in which a source meets a peak at this speed, and the ones
    /// nearest to it of sources that are too slow.
    pub fn resonant_angles(&self, speed_mm_s: f64) -> impl Iterator<Item = f64> + '_ {
        self.pulls.iter().flat_map(move |pulls| {
            let [x, y] = pulls.belt_per_mm;
            // The belt is most * cos(angle - fastest).
            let (most, fastest) = (hypot(x, y).max(AT_REST), atan2(y, x));
            pulls.peaks_hz.iter().flat_map(move |hz| {
                let aside = acos((hz * pulls.pitch_mm / speed_mm_s / most).min(1.0));
                [fastest - aside, fastest + aside].map(|angle| angle.rem_euclid(PI))
            })
        })
    }

    /// Speeds in mm/s at which a source meets a peak in a direction.
    pub fn resonant_speeds(&self, angle_rad: f64) -> impl Iterator<Item = f64> + '_ {
        let (sin, cos) = sin_cos(angle_rad);
        self.pulls.iter().flat_map(move |pulls| {
            let belt = (pulls.belt_per_mm[0] * cos + pulls.belt_per_mm[1] * sin).abs().max(AT_REST);
            pulls.peaks_hz.iter().map(move |hz| hz * pulls.pitch_mm / belt)
        })
    }
}

/// Frequencies at which a source moves the tool more than at those beside them, in x or in y. Peaks far below the
/// greatest one are left out.
fn peaks_hz(moved: &[[Moved; 2]]) -> Vec<f64> {
    let size = |[now, later]: &[Moved; 2], axis: usize| now[axis].norm_sqr() + later[axis].norm_sqr();
    let greatest = [0, 1].into_iter().flat_map(|axis| moved.iter().map(move |moved| size(moved, axis)));
    let least = PEAK * PEAK * greatest.fold(0.0, f64::max);
    let is_peak = |axis: usize, three: &[[Moved; 2]]| match three {
        [before, at, after] => {
            let at = size(at, axis);
            at > least && at > size(before, axis) && at >= size(after, axis)
        }
        _ => false,
    };
    let three = moved.windows(3).enumerate();
    three.filter(|(_, w)| is_peak(0, w) || is_peak(1, w)).map(|(i, _)| frequency_hz(i + 1)).collect()
}

impl Pulls {
    /// Complex amplitude of the tool in mm, while the belt runs forwards (1) or backwards (-1).
    fn moved(&self, frequency_hz: f64, forwards: f64) -> Moved {
        let place = (ln(frequency_hz / LOWEST_HZ) / ln(RATIO)).clamp(0.0, (COUNT - 1) as f64);
        let (below, part) = (place as usize, place.fract());
        let at = |index: usize| {
            // cos of a wheel that turns backwards is the same, sin is negative.
            let quarter = Complex::new(0.0, -forwards);
            let [now, later] = self.moved.get(index.min(COUNT - 1)).copied().unwrap_or_default();
            [now[0] + quarter * later[0], now[1] + quarter * later[1]]
        };
        let (from, to) = (at(below), at(below + 1));
        [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * part)
    }
}

fn frequency_hz(index: usize) -> f64 {
    LOWEST_HZ * powi(RATIO, index as i32)
}

/// Motion of the moving coordinates in mm for 1 N on the tool along x, and along y.
fn answers(
    elastic: &Elastic,
    moving: &[usize],
    params: &Params,
    tool: Place,
    omega: f64,
) -> Result<[DVector<Complex<f64>>; 2], NotHeld> {
    let dynamic = DMatrix::from_fn(moving.len(), moving.len(), |i, j| match (moving.get(i), moving.get(j)) {
        (Some(i), Some(j)) => {
            let at = (*i, *j);
            let inertia = omega * omega * elastic.mass[at] / MM_PER_M;
            Complex::new(elastic.stiffness[at] - inertia, omega * elastic.damping[at])
        }
        _ => Complex::new(0.0, 0.0),
    });
    let solved = dynamic.lu();
    let at = |coordinate: Coordinate| {
        let index = elastic.links.index(coordinate);
        index.and_then(|index| moving.iter().position(|i| *i == index))
    };
    let answer = |axis: Coordinate, arm: f64| {
        let mut unit = DVector::from_element(moving.len(), Complex::new(0.0, 0.0));
        for (coordinate, lever) in [(axis, 1.0), (Coordinate::Yaw, arm)] {
            if let Some(at) = at(coordinate) {
                unit[at] += Complex::new(lever, 0.0);
            }
        }
        solved.solve(&unit).ok_or(NotHeld)
    };
    // A yaw of the bar moves the tool by its distance from the bar's middle.
    Ok([answer(Coordinate::X, 0.0)?, answer(Coordinate::Y, tool.x - params.width_mm / 2.0)?])
}
