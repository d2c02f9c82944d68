//! `twin shaper`: the rating of a given shaper.

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use corehbot_host::answer::Json;
use corehbot_host::values::number;
use corehbot_twin::queries::shaper::Rating;
use corehbot_twin::shaping::shaper::ShaperKind;

/// `twin shaper`.
#[derive(Args)]
pub(crate) struct Shaper {
    /// The kind of the shaper.
    #[arg(long, value_enum, ignore_case = true)]
    kind: KindArg,
    /// The frequency in Hz for which it is made, without damping (F of M593): 10 to 500.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = number(10.0, 500.0))]
    frequency: f64,
    /// The damping for which it is made, of critical damping (D of M593): 0 to 0.5; to 0.3 of 2HUMP_EI.
    #[arg(long, value_name = "PART", allow_negative_numbers = true, value_parser = parse_damping, default_value = "0.1")]
    damping: f64,
    /// Vibrations that it is to remove: their frequencies in Hz, without damping.
    #[arg(long, value_name = "HZ,...", allow_negative_numbers = true, value_delimiter = ',', value_parser = parse_frequency, required = true)]
    ring: Vec<f64>,
    /// The damping of the vibrations, of critical damping; that of the shaper without it.
    #[arg(long, value_name = "PART", allow_negative_numbers = true, value_parser = parse_damping)]
    ring_damping: Option<f64>,
    #[command(flatten)]
    json: Json,
}

/// Greatest damping for which the parts of 2HUMP_EI are known.
const TWO_HUMPS: f64 = 0.3;

/// A kind by its word.
#[derive(Clone, Copy, ValueEnum)]
enum KindArg {
    Zv,
    Mzv,
    Zvd,
    Ei,
    #[value(name = "2hump-ei", alias = "2hump_ei")]
    TwoHumpEi,
}

impl Shaper {
    pub(super) fn answer(&self) -> Result<u8> {
        let kind = match self.kind {
            KindArg::Zv => ShaperKind::Zv,
            KindArg::Mzv => ShaperKind::Mzv,
            KindArg::Zvd => ShaperKind::Zvd,
            KindArg::Ei => ShaperKind::Ei,
            KindArg::TwoHumpEi => ShaperKind::TwoHumpEi,
        };
        let is_fitted = !matches!(kind, ShaperKind::TwoHumpEi) || self.damping <= TWO_HUMPS;
        ensure!(is_fitted, "2HUMP_EI is known for dampings up to {TWO_HUMPS} alone, not for {}", self.damping);
        let ring_damping = self.ring_damping.unwrap_or(self.damping);
        self.json.give(&Rating::new(kind, self.frequency, self.damping, &self.ring, ring_damping), [])
    }
}

fn parse_frequency(text: &str) -> Result<f64, String> {
    let legal = text.trim().parse().ok().filter(|v| (1.0..=1000.0).contains(v));
    legal.ok_or_else(|| format!("`{text}` is not a frequency from 1 to 1000 Hz"))
}

fn parse_damping(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| (0.0..=0.5).contains(v));
    legal.ok_or_else(|| format!("`{text}` is not a damping from 0 to 0.5"))
}
