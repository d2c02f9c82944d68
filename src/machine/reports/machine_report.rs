//! Reports for a machine record sent or received over a serial line.

use crate::machine::answers::machine_answer::MachineAnswer;
use crate::machine::answers::reply_writer::ReplyWriter;
use core::fmt;

/// Reports a machine answer.
pub(in crate::machine) fn report_machine(to: &mut ReplyWriter<'_>, answer: &MachineAnswer<'_>) {
    match answer {
        MachineAnswer::Piece(at, piece) => to.say(text!("machine AT={at} HEX={}", Hex(piece))),
        MachineAnswer::End(length) => to.say(text!("machine END={length}")),
        MachineAnswer::Refused(why) => to.say(text!("echo:machine not stored: {why}")),
        MachineAnswer::Stored(receipt, counts) => {
            let since = if *counts { packed!("in effect now") } else { packed!("in effect after the next reset") };
            to.say(text!("echo:machine stored {receipt}, {since}"));
        }
    }
}

/// Bytes as two digits each.
struct Hex<'a>(&'a [u8]);

impl fmt::Display for Hex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
