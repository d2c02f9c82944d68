//! M118: the receivers of a message.

use crate::gcode::{Audience, Form};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::message::Message;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Wake;

/// Sends a message to other hosts, and returns the reply to the sender. A serial line that does not exist stands for
/// the sender's, as in Marlin (M118.cpp).
pub(super) fn send_message<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    (form, to): (Form, Audience),
    text: &'a [u8],
) -> Answer<'a> {
    match to {
        Audience::Sender => {}
        Audience::All => main_loop.hosts.notify_others(format_args!("{}", Message { form, text })),
        Audience::Line(line) => {
            if main_loop
                .hosts
                .notify_other(usize::from(line).wrapping_sub(1), format_args!("{}", Message { form, text }))
            {
                return Answer::Nothing;
            }
        }
    }
    Answer::Message(form, text)
}
