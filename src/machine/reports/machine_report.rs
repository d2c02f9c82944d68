//! What is said of a machine that comes or goes over a serial line.

use crate::machine::answers::machine_answer::MachineAnswer;
use crate::machine::answers::speaker::Speaker;
use crate::machine::state::machine_pieces::MachinePieces;
use core::fmt;

/// Says what there is to tell of it.
pub(in crate::machine) fn say_machine(to: &mut Speaker<'_>, answer: &MachineAnswer, pieces: &MachinePieces) {
    match answer {
        MachineAnswer::Piece(at) => match pieces.piece(*at) {
            Some(piece) => to.say(format_args!("machine AT={at} HEX={}", Hex(piece))),
            None => to.say(format_args!("machine END={at}")),
        },
        MachineAnswer::Refused(why) => to.say(format_args!("echo:machine not stored: {why}")),
        MachineAnswer::Stored(receipt, counts) => {
            let since = if *counts { "it counts from now on" } else { "it counts after the next reset" };
            to.say(format_args!("echo:machine stored {receipt}, {since}"));
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
