//! The reports of the Z probe.

use super::report::{Hundredths, Thousandths};
use crate::machine::answers::probe_answer::ProbeAnswer;
use crate::machine::answers::speaker::Speaker;

/// The line of an answer. Marlin's words for a place of the bed (G30.cpp).
pub(in crate::machine) fn report_probe(to: &mut Speaker<'_>, answer: &ProbeAnswer) {
    match *answer {
        ProbeAnswer::None => to.say(format_args!("echo:no probe configured, ignored")),
        ProbeAnswer::OutOfReach { at, reaches } => {
            let [x, y] = at.map(Hundredths::of);
            let [[from_x, to_x], [from_y, to_y]] = reaches.map(|reach| [reach.least, reach.most].map(Hundredths::of));
            to.say(format_args!(
                "echo:ignored: the probe cannot touch at X{x} Y{y}, but from X{from_x} Y{from_y} to X{to_x} Y{to_y}"
            ));
        }
        ProbeAnswer::Bed { at, height } => {
            let [x, y] = at.map(Hundredths::of);
            to.say(format_args!("Bed X:{x} Y:{y} Z:{}", Thousandths(height)));
        }
    }
}
