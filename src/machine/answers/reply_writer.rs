//! The reply writer: sends the parts of one answer to the host being served, each once and in order.
//!
//! A part is a line, or lines that must not be separated. Nothing waits between parts. If a part finds no room,
//! `main_loop::reply` polls the main loop and runs the whole report again; parts that were already sent are skipped. So
//! a report is a plain function, and has no place to wait in.

use crate::machine::hosts::serving::Hosts;
use crate::port::Serial;
use crate::protocol::{NoRoom, Replies};
use crate::text::Text;

/// Writes a part into the replies of a host.
type Part<'w> = dyn Fn(&mut Replies) -> Result<(), NoRoom> + 'w;

/// Where the parts of an answer go.
pub(in crate::machine) trait ReplySink {
    /// Takes a part, all of it or nothing. False if there is no room for it.
    fn accept(&mut self, part: &Part<'_>) -> bool;
}

impl<S: Serial> ReplySink for Hosts<'_, S> {
    /// A host that has disconnected accepts every part.
    fn accept(&mut self, part: &Part<'_>) -> bool {
        let (told, host) = self.output();
        let fits = host.is_none_or(|(place, replies)| told.put(place, replies, part));
        if fits {
            self.send();
        }
        fits
    }
}

/// Writes an answer.
pub(in crate::machine) struct ReplyWriter<'s> {
    progress: &'s mut Progress,
    sink: &'s mut dyn ReplySink,
    /// Whether settings are said with `echo:`, and with remarks.
    is_echo: bool,
}

impl<'s> ReplyWriter<'s> {
    /// Sends to `sink` the parts that `progress` does not count as sent.
    pub fn new(progress: &'s mut Progress, sink: &'s mut dyn ReplySink) -> Self {
        Self { progress, sink, is_echo: false }
    }

    /// Has settings said with `echo:` from now on, and with remarks: M503 without S0.
    pub const fn echo_settings(&mut self) {
        self.is_echo = true;
    }

    /// Says a setting as the line that sets it. Alone, and for M503 S0, it stands without `echo:`, as in Marlin
    /// (gcode.h, `report_echo_start`): a BTT TFT takes no other.
    #[inline(never)]
    pub fn setting(&mut self, line: Text<'_>) {
        let echo = if self.is_echo { "echo:" } else { "" };
        self.say(text!("{echo}  {line}"));
    }

    /// Writes a value that no line sets, as a comment of M503.
    #[inline(never)]
    pub fn remark(&mut self, text: Text<'_>) {
        if self.is_echo {
            self.say(text!("echo:; {text}"));
        }
    }

    /// Says a setting as the line that sets it, a line of another kind than G and a number. A BTT TFT would show it to
    /// the user as trouble, so it is a remark where settings are said with `echo:`.
    pub fn named_setting(&mut self, line: Text<'_>) {
        if self.is_echo { self.remark(line) } else { self.setting(line) }
    }

    /// Sends one line. Inlined, it would be repeated in fifty places.
    #[inline(never)]
    pub fn say(&mut self, line: Text<'_>) {
        self.put(&|replies| replies.line(format_args!("{line}")));
    }

    /// Says a part, unless that has been said, or something before it could not be.
    #[inline(never)]
    pub fn put(&mut self, part: &Part<'_>) {
        if self.progress.is_next() && self.sink.accept(part) {
            self.progress.note_said();
        }
    }
}

/// The progress of an answer.
#[derive(Clone, Copy, Default)]
pub(in crate::machine) struct Progress {
    /// Parts said, at this time or before.
    said: usize,
    /// Parts seen in this run.
    seen: usize,
}

impl Progress {
    /// Begins at the first part again.
    pub const fn begin(&mut self) {
        self.seen = 0;
    }

    /// Whether the next part is to be sent now: it was not sent yet, and everything before it was.
    const fn is_next(&mut self) -> bool {
        self.seen += 1;
        self.seen == self.said + 1
    }

    /// The part was said.
    const fn note_said(&mut self) {
        self.said += 1;
    }

    /// Whether all parts seen were sent.
    pub const fn is_complete(&self) -> bool {
        self.said == self.seen
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    #[test]
    fn each_part_is_said_once_and_in_order_whatever_room_there_is() {
        for room in 1..=6 {
            let (mut progress, mut heard) = (Progress::default(), Vec::new());
            loop {
                progress.begin();
                let mut left = room;
                for part in 0..5 {
                    // The part at 3 is long: the following ones would fit, but must wait.
                    let is_fitting = left > 0 && (part != 3 || left == room);
                    if progress.is_next() && is_fitting {
                        progress.note_said();
                        heard.push(part);
                        left -= 1;
                    }
                }
                if progress.is_complete() {
                    break;
                }
            }
            assert_eq!(heard, [0, 1, 2, 3, 4]);
        }
    }
}
