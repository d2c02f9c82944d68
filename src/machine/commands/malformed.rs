//! Lines that are not in order, as hosts read it.

use crate::gcode::{Absent, Flaw, Named, Part};
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::protocol::Echo;

/// Says which part of a machine a line was for that is not there. OctoPrint learns from its own words for tools which
/// ones there are (comm.py, "Invalid extruder").
fn report_absent(to: &mut ReplyWriter<'_>, absent: &Absent<'_>) {
    let which = Echo(absent.which);
    let part = absent.part.name();
    match (absent.command, absent.part) {
        (Named::Code(b'T', number), _) => to.say(text!("echo:T{number} Invalid extruder")),
        (Named::Code(b'M', 104 | 109), Part::Tool) => to.say(text!("echo:T{which} Invalid extruder")),
        (Named::Code(letter, number), _) => {
            let letter = letter as char;
            to.say(text!("echo:{letter}{number} ignored: there is no {part} {which}"));
        }
        (Named::Name(name), _) => to.say(text!("echo:{name} ignored: there is no {part} {which}")),
    }
}

/// Says why a line was not carried out.
pub(super) fn report_malformed(to: &mut ReplyWriter<'_>, flaw: &Flaw<'_>) {
    match *flaw {
        Flaw::NoWord(text) => {
            to.say(text!("echo:line ignored: \"{}\" is not a letter with a number", Echo(text)));
        }
        Flaw::NoPair(text) => {
            to.say(text!("echo:line ignored: \"{}\" is not a name with = and a number", Echo(text)));
        }
        Flaw::NoNumber(letter) => to.say(text!("echo:line ignored: {} needs a number", letter as char)),
        Flaw::OutOfRange(text) => to.say(text!("echo:line ignored: {} is out of range", Echo(text))),
        Flaw::NoAxis(letter) => to.say(text!("echo:line ignored: there is no axis {}", letter as char)),
        Flaw::SecondCommand(text) => {
            to.say(text!("echo:line ignored: {} is a second command on it", Echo(text)));
        }
        Flaw::Absent(ref absent) => report_absent(to, absent),
    }
}
