//! The record of the machine, in pieces: MACHINE_GET, MACHINE_PUT AT=.. HEX=.., MACHINE_STORE. No firmware has codes for it, so
//! they have names.

use super::command::Command;
use super::parts::{Flaw, MachineRecord};
use super::shaping::{named_value, words};
use crate::text::read_digits;

pub(super) const fn get(_: &[u8]) -> Command<'_> {
    Command::MachineRecord(MachineRecord::Get)
}

pub(super) const fn store(_: &[u8]) -> Command<'_> {
    Command::MachineRecord(MachineRecord::Store)
}

pub(super) fn put(text: &[u8]) -> Command<'_> {
    let (mut at, mut hex) = (None, None);
    for word in words(text) {
        match named_value(word) {
            Some((name, value)) if name.eq_ignore_ascii_case(b"AT") => {
                let (number, after) = read_digits(value);
                if value.is_empty() || !after.is_empty() {
                    return Command::Malformed(Flaw::NoPair(word));
                }
                at = Some(number);
            }
            Some((name, value)) if name.eq_ignore_ascii_case(b"HEX") => hex = Some(value),
            _ => return Command::Malformed(Flaw::NoPair(word)),
        }
    }
    match (at, hex) {
        (Some(at), Some(hex)) => Command::MachineRecord(MachineRecord::Put { at, hex }),
        _ => Command::Malformed(Flaw::NoPair(text.trim_ascii())),
    }
}
