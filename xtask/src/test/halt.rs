//! M112 on the board in QEMU: the time from its last byte to the last step, while it steps as fast as it can.

use crate::images;
use crate::qemu::{BOARD, Job};
use crate::tools::{has_emulator, lack_of_emulator};
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, ensure};
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_sim::world::Host;
use std::path::Path;

/// Longest time from the last byte to the last step.
const LIMIT_US: f64 = 1000.0;

/// Lines that are answered before M112 comes, so that it comes at different places of the planning.
const MOMENTS: [usize; 5] = [250, 283, 311, 338, 365];

/// Stops in mid-motion at each of the moments.
pub fn check() -> Result<Verdict> {
    if !has_emulator() {
        return Ok(Verdict::Skipped(lack_of_emulator()));
    }
    let image = images::build_image(BOARD)?;
    let mut worst = f64::MIN;
    for moment in MOMENTS {
        let late = stop(&image, moment)?;
        println!("after {moment} lines: the last step comes {late:.1} us after the last byte");
        worst = worst.max(late);
    }
    ensure!(worst <= LIMIT_US, "the last step comes {worst:.1} us after the last byte of M112");
    Ok(Verdict::Passed(format!("the last step comes at most {worst:.1} us after the last byte")))
}

/// Sends M112 after `moment` answers; returns how long the board stepped after its last byte, in us.
fn stop(image: &Path, moment: usize) -> Result<f64> {
    let job = Job {
        gcode: String::new(),
        settings: Settings::prototype(),
        start: Some([Mm::ZERO; 3]),
        mesh: None,
        patience_ms: 0,
    };
    let mut host = Stopper { moment, answers: 0, sent: 0 };
    let outcome = job.talk(image, None, |stream| crate::qemu::converse(stream, &mut host, None))?;
    let words = outcome.log.iter().find_map(|line| line.split_once("last byte at tick "));
    let (byte, step) = words.and_then(|(_, ticks)| ticks.split_once(", last step at tick ")).context("no ticks")?;
    let (byte, step): (u32, u32) = (byte.trim().parse()?, step.trim().parse()?);
    let ticks = step.wrapping_sub(byte).cast_signed();
    let us = f64::from(ticks) * 1e6 / f64::from(TICKS_PER_SECOND);
    ensure!(us > -LIMIT_US, "it was not moving: the last step came {:.1} us before the last byte of M112", -us);
    Ok(us)
}

/// A host that keeps the look-ahead full with moves of a millimetre at full speed, and then says M112 without waiting.
struct Stopper {
    moment: usize,
    answers: usize,
    sent: usize,
}

impl Host for Stopper {
    fn send(&mut self, out: &mut Vec<u8>) {
        while self.sent <= self.answers && self.sent < self.moment {
            self.sent += 1;
            match self.sent {
                1..=3 => out.extend(["M83\n", "M203 E240\n", "G1 X5 Y100 F6000\n"][self.sent - 1].bytes()),
                // Both pairs of belt motors near 36,000 steps a second, seldom in the same tick, and the extruder.
                moves => {
                    let place = moves as f64;
                    out.extend(format!("G1 X{place:.3} Y{:.4} E.473 F27000\n", 100.0 + place / 37.0).bytes());
                }
            }
        }
        if self.answers == self.moment - 1 && self.sent == self.moment {
            self.sent += 1;
            out.extend(b"M112\n");
        }
    }

    fn hear(&mut self, line: &str) {
        self.answers += usize::from(line.starts_with("ok"));
        if line.starts_with("Error:Printer halted") {
            self.answers = usize::MAX;
        }
    }

    fn is_done(&self) -> bool {
        self.answers == usize::MAX
    }
}
