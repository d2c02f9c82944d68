//! `resonance sweep`: G-code that shakes an axis, for firmwares without a sweep.

use super::{along, parse_axis, parse_range};
use anyhow::{Context as _, Result, ensure};
use clap::{Args, Subcommand};
use corehbot_host::output::Outputs;
use corehbot_host::say::note;
use corehbot_host::status::DONE;
use corehbot_host::stop::Stop;
use corehbot_host::values::number;
use corehbot_resonance::gcode::{direction, greatest_acceleration, lines, reach_mm};
use corehbot_resonance::label;
use corehbot_resonance::sweep::Sweep;
use std::io::Write as _;
use std::path::PathBuf;

/// Other things than recordings.
#[derive(Subcommand)]
pub(super) enum Part {
    /// Writes G-code that shakes an axis from low to high frequencies, to record meanwhile.
    Sweep(Excite),
}

/// `resonance sweep`.
#[derive(Args)]
pub(super) struct Excite {
    /// Axis: x, y, or the belt paths a (1,-1) and b (1,1).
    #[arg(long, value_name = "AXIS", value_parser = parse_axis)]
    axis: label::Axis,
    /// The tool's place, in mm.
    #[arg(long, value_name = "X,Y", value_parser = parse_place, allow_hyphen_values = true)]
    at: [f64; 2],
    /// First and last frequency, in Hz.
    #[arg(long, value_name = "FROM-TO", value_parser = parse_range, default_value = "5-135")]
    sweep: [f64; 2],
    /// Growth of the frequency, in Hz per second.
    #[arg(long, value_name = "HZ_PER_S", allow_negative_numbers = true, value_parser = number(0.1, 10.0), default_value = "1")]
    growth: f64,
    /// Acceleration over frequency, in mm/s^2 per Hz. The machine must allow it times the last frequency.
    #[arg(long, value_name = "MM_S2_PER_HZ", allow_negative_numbers = true, value_parser = number(1.0, 500.0), default_value = "34")]
    accel_per_hz: f64,
    /// Length of a step of x and y, in mm: moves are whole steps, so that they last as long as they should.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = number(0.0, 1.0), default_value = "0.0125")]
    resolution: f64,
    /// Where the G-code goes; `-` is standard output.
    #[arg(long, short, value_name = "SWEEP.gcode")]
    output: PathBuf,
}

impl Part {
    pub(super) fn run(&self) -> Result<u8> {
        let Self::Sweep(args) = self;
        ensure!(direction(args.axis).is_some(), "z is not swept: it would shake the bed or the gantry");
        let [from_hz, to_hz] = args.sweep;
        let sweep = Sweep {
            from_hz,
            to_hz,
            hz_per_s: args.growth,
            accel_per_hz: args.accel_per_hz,
            swing_accel: 0.0,
            swing_period_s: 0.0,
            resolution_mm: along(args.axis, args.resolution),
        };
        let mut outputs = Outputs::new([], Stop::default());
        let mut out = outputs.open(&args.output)?;
        let all = lines(&sweep, args.axis, args.at);
        let written = all.iter().try_for_each(|line| writeln!(out, "{line}")).and_then(|()| out.flush());
        written.context("cannot write the G-code")?;
        drop(out);
        outputs.keep()?;
        let (moves, seconds) = (sweep.halves().count(), sweep.lasts_s());
        note(format_args!(
            "{moves} moves in {seconds:.0} s, up to {:.2} mm from the place, up to {:.0} mm/s2: M201 must allow that. The \
             last ones need {:.0} lines a second: send by USB or from a card, not by a slow serial line.",
            reach_mm(&sweep),
            greatest_acceleration(&sweep),
            2.0 * to_hz
        ));
        Ok(DONE)
    }
}

/// `150,150`.
fn parse_place(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|v| v.is_finite() && v.abs() < 1e4);
    let pair = text.split_once(',').and_then(|(x, y)| Some([number(x)?, number(y)?]));
    pair.ok_or_else(|| format!("`{text}` is no place like 150,150"))
}
