//! Words in the file of a command: a function that says them, and the values that the command keeps for itself.

use super::reply_writer::ReplyWriter;
use crate::connectors::Heater;
use crate::settings::Settings;
use crate::status::Status;

/// What words may depend on. Settings and status are read when the answer is written.
pub(in crate::machine) struct Facts<'f> {
    pub settings: &'f Settings,
    pub status: &'f Status,
    /// The number that the command keeps for itself.
    pub number: i32,
}

impl Facts<'_> {
    /// The name of the heater of that number.
    pub fn heater(&self) -> &'static str {
        Heater::ALL.into_iter().find(|heater| *heater as i32 == self.number).map_or("", Heater::name)
    }
}

/// Says the words.
pub(in crate::machine) type Say = fn(&mut ReplyWriter<'_>, &Facts<'_>);

/// An answer with words of its own.
#[derive(Clone, Copy)]
pub(in crate::machine) struct Says {
    say: Say,
    number: i32,
}

impl Says {
    pub const fn new(say: Say, number: i32) -> Self {
        Self { say, number }
    }

    /// Says it to `to`.
    pub fn write(&self, to: &mut ReplyWriter<'_>, settings: &Settings, status: &Status) {
        (self.say)(to, &Facts { settings, status, number: self.number });
    }
}
