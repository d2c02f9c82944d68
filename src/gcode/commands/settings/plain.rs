//! Plain settings: their codes and letters come from the rows of `settings`.

use super::SettingCommand;
use crate::gcode::commands::Command;
use crate::gcode::lexer::number;
use crate::gcode::parts::PlainWords;
use crate::settings::plain::{MOST_WORDS, letters};

/// The numbers of the letters of a code. An older letter counts without the setting's own.
pub(in crate::gcode::commands) fn plain(code: u16, text: &[u8]) -> Option<Command<'_>> {
    let mut numbers = [None; MOST_WORDS];
    for (place, letters) in numbers.iter_mut().zip(letters(code)) {
        *place = letters.bytes().find_map(|letter| number(text, letter));
    }
    Some(Command::Setting(SettingCommand::Plain(PlainWords { code, numbers })))
}
