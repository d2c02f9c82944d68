//! M118: who hears a message.

use crate::gcode::{Audience, Form};
use crate::machine::answers::answer::Answer;
use crate::machine::crank::Crank;
use crate::machine::ports::PortSet;
use crate::port::Pend;

/// Tells other hosts what is for them, and returns what the sender hears. A line that there is not stands for the
/// sender's, as in Marlin (M118.cpp).
pub(super) fn send_message<'a, P: PortSet, W: Pend>(
    crank: &mut Crank<'_, P, W>,
    (form, to): (Form, Audience),
    text: &'a [u8],
) -> Answer<'a> {
    match to {
        Audience::Sender => {}
        Audience::All => crank.message_others(form, text),
        Audience::Line(line) => {
            if crank.message_other(usize::from(line).wrapping_sub(1), form, text) {
                return Answer::Nothing;
            }
        }
    }
    Answer::Message(form, text)
}
