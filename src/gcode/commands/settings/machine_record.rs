//! The record of the machine, in pieces: MACHINE_GET, MACHINE_PUT AT=.. HEX=.., MACHINE_STORE. No firmware has codes
//! for it, so they have names.

use super::super::Command;
use super::SettingCommand;
use crate::gcode::commands::pairs::flaw_of_pairs;
use crate::gcode::parts::{Flaw, MachineRecord};
use crate::text::read_digits;

pub(super) fn put(text: &[u8]) -> Command<'_> {
    let (mut at, mut hex) = (None, None);
    let flaw = flaw_of_pairs(text, &["AT", "HEX"], &mut |pair| {
        match pair.place {
            0 => {
                let (number, after) = read_digits(pair.value);
                if pair.value.is_empty() || !after.is_empty() {
                    return Some(pair.flaw());
                }
                at = Some(number);
            }
            1 => hex = Some(pair.value),
            _ => return Some(pair.flaw()),
        }
        None
    });
    if let Some(flaw) = flaw {
        return Command::Malformed(flaw);
    }
    match (at, hex) {
        (Some(at), Some(hex)) => Command::Setting(SettingCommand::MachineRecord(MachineRecord::Put { at, hex })),
        _ => Command::Malformed(Flaw::NoPair(text.trim_ascii())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_of_a_machine_has_a_place_and_bytes() {
        let piece = Command::Setting(SettingCommand::MachineRecord(MachineRecord::Put { at: 32, hex: b"0aFF" }));
        assert_eq!([put(b"AT=32 HEX=0aFF"), put(b"hex=0aFF at=32")], [piece, piece]);
        for (text, word) in [
            ("AT= HEX=00", "AT="),
            ("AT=1x HEX=00", "AT=1x"),
            ("AT=-1 HEX=00", "AT=-1"),
            ("AT=1 BYTES=00", "BYTES=00"),
            ("AT=1 HEX", "HEX"),
            ("AT=1", "AT=1"),
            ("HEX=00", "HEX=00"),
        ] {
            assert_eq!(put(text.as_bytes()), Command::Malformed(Flaw::NoPair(word.as_bytes())), "{text}");
        }
    }
}
