//! The highest demand of a print, on the board in QEMU: more lines in a second than any sliced file had in its busiest.

use crate::qemu::Job;
use anyhow::{Context as _, Result, ensure};
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use std::fmt::Write as _;
use std::path::Path;

/// Commands in the busiest second of 25 sliced files (an upper bound).
const DEMAND: f64 = 495.0;

/// Lines of the print, each a move of 0.15 mm at 100 mm/s on a circle.
const LINES: u16 = 2000;

/// Prints them; the look-ahead must never run short, and the print go as fast as that.
pub fn check(image: &Path) -> Result<String> {
    let mut gcode = String::from("M83\nG1 F6000\n");
    for line in 1..=LINES {
        let (sin, cos) = (f64::from(line) * 0.15 / 20.0).sin_cos();
        writeln!(gcode, "G1 X{:.3} Y{:.3} E.00499", 100.0 + 20.0 * cos, 100.0 + 20.0 * sin)?;
    }
    let start = [120, 100, 0].map(Mm::from_num);
    let job = Job { gcode, settings: Settings::prototype(), start: Some(start), mesh: None, patience_ms: 0 };
    let outcome = job.run(image, None)?;
    let overload = outcome.log.iter().find(|line| line.contains("too slow")).context("no word of overload")?;
    ensure!(overload.contains("too slow: 0, the generator: 0, the stepper: 0"), "{overload}");
    let rate = f64::from(LINES) * f64::from(TICKS_PER_SECOND) / outcome.ticks as f64;
    ensure!(rate >= DEMAND, "{rate:.0} lines a second");
    Ok(format!("{rate:.0} lines a second"))
}
