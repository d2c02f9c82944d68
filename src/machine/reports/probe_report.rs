//! The reports of the Z probe.

use super::report::Hundredths;
use crate::machine::answers::probe_answer::{ProbeAnswer, Spread};
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::Thousandths;
use core::fmt;

/// Nanometres as mm with six decimals.
struct Millionths(i64);

impl fmt::Display for Millionths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sign, size) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        write!(f, "{sign}{}.{:06}", size / 1_000_000, size % 1_000_000)
    }
}

/// The line of an answer. Marlin's words for a place of the bed (G30.cpp).
pub(in crate::machine) fn report_probe(to: &mut ReplyWriter<'_>, answer: &ProbeAnswer) {
    match *answer {
        ProbeAnswer::None => to.say(text!("echo:no probe configured, ignored")),
        ProbeAnswer::OutOfReach { at, reaches } => {
            let [x, y] = at.map(Hundredths::of);
            let [[from_x, to_x], [from_y, to_y]] = reaches.map(|reach| [reach.least, reach.most].map(Hundredths::of));
            to.say(text!(
                "echo:ignored: the probe cannot touch at X{x} Y{y}, but from X{from_x} Y{from_y} to X{to_x} Y{to_y}"
            ));
        }
        ProbeAnswer::Bed { at, height } => {
            let [x, y] = at.map(Hundredths::of);
            to.say(text!("Bed X:{x} Y:{y} Z:{}", Thousandths(height)));
        }
        // The words of Marlin's M48.cpp.
        ProbeAnswer::Test => to.say(text!("M48 Z-Probe Repeatability Test")),
        ProbeAnswer::Sample { number, of, height } => {
            to.say(text!("{number} of {of}: z: {}", Thousandths(height)));
        }
        ProbeAnswer::Finished { spread: Spread { mean_nm, least, most, sigma_nm }, is_verbose } => {
            to.say(text!("Finished!"));
            if is_verbose {
                let range = Thousandths(most.saturating_sub(least));
                let [least, most] = [least, most].map(Thousandths);
                to.say(text!("Mean: {} Min: {least} Max: {most} Range: {range}", Millionths(mean_nm)));
            }
            to.say(text!("Standard Deviation: {}", Millionths(sigma_nm.cast_signed())));
        }
        ProbeAnswer::Servo(Some(angle)) => to.say(text!("echo: Servo 0: {angle}")),
        ProbeAnswer::Servo(None) => to.say(text!("echo: Servo 0: off")),
        ProbeAnswer::Quick(is_quick) => {
            to.say(text!("echo:BLTouch HS mode {}", if is_quick { "ON" } else { "OFF" }));
        }
    }
}
