//! Shaper: what a given shaper leaves of vibrations of given frequencies, and what it costs.

use crate::shaping::shaper::{CORNER_SPEED, SMOOTHED_ACCELERATION, ShaperKind, impulses, residual, smoothing_mm};
use serde::Serialize;

/// The rating of a shaper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rating {
    /// Its kind.
    #[serde(rename = "type")]
    pub kind: ShaperKind,
    /// Its frequency.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Its damping, of critical damping.
    pub damping: f64,
    /// Parts of a command, of 1, and their delays.
    pub parts: Vec<PartOf>,
    /// Mean delay of a command.
    pub delay_ms: f64,
    /// Corner rounding at 5 m/s^2, as in Klipper.
    pub smoothing_mm: f64,
    /// Vibrations.
    pub rings: Vec<Left>,
}

/// A part of a command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PartOf {
    /// Its size, of 1.
    pub amount: f64,
    /// Its delay.
    pub time_ms: f64,
}

/// A vibration after the shaper.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Left {
    /// Its frequency without damping.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Its damping, of critical damping.
    pub damping: f64,
    /// The amplitude that the shaper leaves after its last part, of 1: relative to the whole command at once.
    pub residual: f64,
}

impl Rating {
    /// For vibrations of these frequencies and this damping.
    #[must_use]
    pub fn new(kind: ShaperKind, frequency_hz: f64, damping: f64, rings_hz: &[f64], ring_damping: f64) -> Self {
        let parts = impulses(kind, frequency_hz, damping);
        let left = |frequency_hz: &f64| Left {
            frequency_hz: *frequency_hz,
            damping: ring_damping,
            residual: residual(&parts, *frequency_hz, ring_damping),
        };
        Self {
            kind,
            frequency_hz,
            damping,
            delay_ms: 1000.0 * parts.iter().map(|part| part.amount * part.time_s).sum::<f64>(),
            smoothing_mm: smoothing_mm(&parts),
            rings: rings_hz.iter().map(left).collect(),
            parts: parts.iter().map(|part| PartOf { amount: part.amount, time_ms: 1000.0 * part.time_s }).collect(),
        }
    }
}

impl std::fmt::Display for Rating {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { kind, frequency_hz, damping, delay_ms, smoothing_mm, .. } = self;
        writeln!(f, "{} for {frequency_hz} Hz, damping {damping}", kind.name())?;
        for PartOf { amount, time_ms } in &self.parts {
            writeln!(f, "  {amount:.5} of a command after {time_ms:.4} ms")?;
        }
        writeln!(f, "  delays a command by {delay_ms:.2} ms")?;
        writeln!(
            f,
            "  rounds corners by {smoothing_mm:.3} mm at {SMOOTHED_ACCELERATION} mm/s2 and {CORNER_SPEED} mm/s"
        )?;
        for Left { frequency_hz, damping, residual } in &self.rings {
            writeln!(f, "  leaves {:.3} % of {frequency_hz} Hz, damping {damping}", 100.0 * residual)?;
        }
        Ok(())
    }
}
