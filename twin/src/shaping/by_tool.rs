//! By tool: the shaper with the least error of the tool on printed walls, while the frequency is uncertain.
//!
//! A shaper's frequency is searched for each kind. The worst of several machines counts, which ring at the nominal
//! frequency and at the ends of its uncertainty.

use super::design::worst_residual;
use super::shaper::{Impulse, ShaperKind, impulses, residual};
use super::wall::{Lag, Print, Unshaped, WallError, net_rounding};
use crate::math::powf;
use serde::Serialize;

/// Shapers within this factor of the least error are equally good; the one with the shorter delay is suggested.
const ALIKE: f64 = 1.03;

/// A shaper may leave this part of the ringing at the nominal frequency, as EI's are made for. Without this limit a
/// short shaper would be set too high: it rounds less and rings more.
pub const RINGING: f64 = 0.05;

/// Frequencies of a shaper that are tried, over the nominal one.
const TRIED: [f64; 2] = [0.6, 2.2];

/// Steps of the first search, and of the one around its best.
const STEPS: [usize; 2] = [64, 8];

/// Dampings for which all fits of shapers hold, and frequencies in Hz that the firmware takes (`settings::ranges`).
const DAMPINGS: [f64; 2] = [0.0, 0.3];
const FREQUENCIES: [f64; 2] = [10.0, 500.0];

/// A machine, and others that it may be.
#[derive(Debug)]
pub struct Machines {
    nominal: Unshaped,
    others: Vec<Unshaped>,
    strongest: Lag,
}

impl Machines {
    /// The nominal modes, the strongest first, and others with a factor of their frequencies. `None` without a mode.
    #[must_use]
    pub fn new<'m>(print: &Print, nominal: &[Lag], others: impl IntoIterator<Item = (&'m [Lag], f64)>) -> Option<Self> {
        Some(Self {
            nominal: Unshaped::new(print, nominal, 1.0),
            others: others.into_iter().map(|(modes, factor)| Unshaped::new(print, modes, factor)).collect(),
            strongest: *nominal.first()?,
        })
    }

    /// Error of the walls of the nominal one.
    #[must_use]
    pub fn error(&self, impulses: &[Impulse]) -> WallError {
        self.nominal.error(impulses)
    }

    /// The worst of all.
    #[must_use]
    pub fn worst(&self, impulses: &[Impulse]) -> WallError {
        let all = std::iter::once(&self.nominal).chain(&self.others).map(|machine| machine.error(impulses));
        all.max_by(|a, b| a.rms_um.total_cmp(&b.rms_um)).unwrap_or_default()
    }

    /// Damping of a shaper for them, as a line has it.
    #[must_use]
    pub fn damping(&self) -> f64 {
        (self.strongest.damping_ratio.clamp(DAMPINGS[0], DAMPINGS[1]) * 1000.0).round() / 1000.0
    }

    /// Frequency of a kind with the least error at the worst of them, as a line has it.
    #[must_use]
    pub fn frequency_hz(&self, kind: ShaperKind) -> f64 {
        let (own, damping) = (&self.strongest, self.damping());
        let worst = |hz: f64| {
            let impulses = impulses(kind, hz, damping);
            let ringing = residual(&impulses, own.frequency_hz, own.damping_ratio);
            // Beyond the limit the nearest to it is the best.
            if ringing > RINGING { 1e6 * ringing } else { self.worst(&impulses).rms_um }
        };
        let search = |from: f64, to: f64, steps: usize| {
            let tried = (0..=steps).map(|i| from * powf(to / from, i as f64 / steps as f64));
            let tried = tried.map(|hz| (hz, worst(hz)));
            tried.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(from, |(hz, _)| hz)
        };
        let f = own.frequency_hz;
        let coarse = search(TRIED[0] * f, TRIED[1] * f, STEPS[0]);
        let width = powf(TRIED[1] / TRIED[0], 1.0 / STEPS[0] as f64);
        let fine = search(coarse / width, coarse * width, STEPS[1]).clamp(FREQUENCIES[0], FREQUENCIES[1]);
        (fine * 10.0).round() / 10.0
    }
}

/// The suggested one of several, the shortest first, by their errors: the shortest of the nearly least.
#[must_use]
pub fn suggested(errors_um: &[f64]) -> Option<usize> {
    let least = errors_um.iter().copied().fold(f64::INFINITY, f64::min);
    errors_um.iter().position(|error| *error <= ALIKE * least)
}

/// A kind at its best frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ranked {
    /// Its kind.
    #[serde(rename = "type")]
    pub kind: ShaperKind,
    /// Its frequency.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Error of slow changes in `a/w^2`; positive is inside of a corner.
    pub net_rounding_a_per_w2: f64,
    /// Ringing that it leaves at the worst place of the band, of 1.
    pub worst_residual: f64,
    /// Error of the wall at the nominal frequency.
    pub wall: WallError,
    /// The worst over the band.
    pub worst_wall: WallError,
}

/// All kinds by the error of the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByTool {
    /// The print with the walls that count.
    pub print: Print,
    /// Without a shaper.
    pub unshaped_wall: WallError,
    /// Damping that the shapers are made for.
    pub damping_ratio: f64,
    /// The best of each kind, the shortest first.
    pub shapers: Vec<Ranked>,
    /// The suggested one.
    pub suggestion: Ranked,
}

/// The kinds for an axis that rings at `nominal_hz` and within a band of frequencies in Hz. `None` without a frequency.
#[must_use]
pub fn by_tool(nominal_hz: f64, band_hz: [f64; 2], damping_ratio: f64, print: &Print) -> Option<ByTool> {
    let own = [Lag { frequency_hz: nominal_hz, damping_ratio, part: 1.0 }];
    let ends = band_hz.map(|hz| (&own[..], hz / nominal_hz));
    let machines = Machines::new(print, &own, ends).filter(|_| nominal_hz > 0.0)?;
    let damping = machines.damping();
    let ranked = |kind: ShaperKind| {
        let frequency_hz = machines.frequency_hz(kind);
        let impulses = impulses(kind, frequency_hz, damping);
        Ranked {
            kind,
            frequency_hz,
            net_rounding_a_per_w2: net_rounding(&impulses, &own),
            worst_residual: worst_residual(&impulses, band_hz, damping_ratio),
            wall: machines.error(&impulses),
            worst_wall: machines.worst(&impulses),
        }
    };
    let shapers = ShaperKind::ALL.map(ranked);
    let suggestion = *shapers.get(suggested(&shapers.map(|s| s.worst_wall.rms_um))?)?;
    let unshaped_wall = machines.error(&[Impulse { amount: 1.0, time_s: 0.0 }]);
    Some(ByTool { print: *print, unshaped_wall, damping_ratio: damping, shapers: shapers.to_vec(), suggestion })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 10 m/s^2 and 62.6 Hz the twin on whole prints has 4.3 um for ZV and 9.2 um for MZV. With a frequency 13 % off
    /// it has 9.6 and 11.7 (docs/explanation/resonance.md). The shorter one wins.
    #[test]
    fn the_shorter_shaper_is_suggested_although_it_leaves_more_ringing() {
        let print = Print { acceleration_mm_s2: 10_000.0, ..Print::default() };
        let found = by_tool(62.6, [62.6 * 0.95, 62.6 * 1.05], 0.042, &print).unwrap();
        assert_eq!(found.suggestion.kind, ShaperKind::Zv, "{found:?}");
        let of = |kind: ShaperKind| found.shapers.iter().find(|s| s.kind == kind).unwrap();
        let ratio = of(ShaperKind::Zv).wall.rms_um / of(ShaperKind::Mzv).wall.rms_um;
        assert!((ratio / (4.3 / 9.2) - 1.0).abs() < 0.25, "{ratio}");
        assert!(of(ShaperKind::Zv).net_rounding_a_per_w2 < of(ShaperKind::Mzv).net_rounding_a_per_w2);
        assert!(found.shapers.iter().all(|s| s.wall.rms_um < found.unshaped_wall.rms_um));
        assert_eq!(by_tool(0.0, [0.0; 2], 0.04, &print), None);
    }
}
