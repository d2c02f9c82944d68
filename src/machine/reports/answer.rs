//! Answers: what a command has to say, as a value.
//!
//! A command does what it does and returns its answer, which is written here alone, in parts: lines, or lines that
//! must not be separated. Nothing waits between them. When a part finds no room, the world goes round and the whole
//! answer is written once more, without the parts that were said before. So a report is a plain function, and an
//! answer has one place to wait in, not one for every line.

use super::driver_report::DriverReport;
use super::report::Temperatures;
use crate::driver::Fault;
use crate::gcode::{Flaw, Form};
use crate::machine::commands::clamps::Clamp;
use crate::machine::commands::drivers::DriverValue;
use crate::machine::commands::settings::shown::Setting;
use crate::machine::commands::settings::stored::StorageNews;
use crate::machine::commands::shaping::shortest;
use crate::machine::console::{Console, Interrupt, PortSet};
use crate::port::{EndstopSet, Pend};
use crate::protocol::{Echo, NoRoom, Replies, ResendReason};
use crate::settings::ranges;
use core::fmt;

/// What there is to say. Numbers that the Console knows are looked up when they are written.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Answer<'a> {
    /// Nothing, but for the `ok`.
    Nothing,
    /// The `ok` that ends an answer, unless it stands in the answer itself as in the next six.
    Ok,
    /// M110, with the number that it asked for.
    LineNumber(Option<i32>),
    TooLong,
    Probe(i32),
    Resend(ResendReason, i32),
    Unknown(&'a [u8]),
    /// A line that is not in order.
    Malformed(Flaw<'a>),
    /// A command, and the name of a word of it that is not obeyed.
    NotObeyed(&'static str, &'a [u8]),
    /// A value that was out of range.
    Clamp(Clamp),
    /// A move that must not be made before G28.
    NotHomed,
    /// M105, in the line of the `ok`.
    Temperatures,
    /// The first lines after a reset.
    Start,
    /// A line that is always the same.
    Line(&'static str),
    /// M118.
    Message(Form, &'a [u8]),
    /// M900.
    Advance,
    FeedPercent,
    FlowPercent,
    DebugFlags,
    Keepalive,
    InvalidTool(u8),
    Position {
        real: bool,
    },
    Firmware,
    Endstops(EndstopSet),
    SoftEndstops,
    Sensors,
    /// M122: what was too slow.
    Overload,
    /// A setting as the line that sets it.
    Setting(Setting),
    /// M503: all of them.
    Settings,
    /// A command whose X and Y differ.
    OneBelt(&'static str),
    /// M92 would give axes that share motors different steps.
    SharedMotors(&'static str),
    LoweredSpeeds,
    TooMuchFilament,
    DriverValues(DriverValue),
    IllegalCurrent(&'static str),
    Driver(DriverReport),
    Storage(StorageNews),
    /// Why motors have no power.
    NoPower(Fault),
    HomingFailed {
        axis: char,
        why: &'static str,
    },
}

impl Answer<'_> {
    /// Whether the `ok` is part of it.
    pub const fn has_ok(&self) -> bool {
        matches!(
            self,
            Self::Ok
                | Self::LineNumber(_)
                | Self::TooLong
                | Self::Probe(_)
                | Self::Resend(..)
                | Self::Unknown(_)
                | Self::Temperatures
        )
    }
}

/// How far an answer has been written.
#[derive(Clone, Copy, Default)]
pub(in crate::machine) struct Progress {
    /// Parts said, at this time or before.
    said: usize,
    /// Parts looked at this time.
    seen: usize,
}

impl Progress {
    /// Begins at the first part again.
    pub const fn begin(&mut self) {
        self.seen = 0;
    }

    /// Whether the next part is to be said now: it has not been, and everything before it has.
    const fn is_next(&mut self) -> bool {
        self.seen += 1;
        self.seen == self.said + 1
    }

    /// The part was said.
    const fn note_said(&mut self) {
        self.said += 1;
    }

    /// Whether all parts looked at have been said.
    pub const fn is_complete(&self) -> bool {
        self.said == self.seen
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Tells the host being served, as soon as there is room for it.
    pub(in crate::machine) async fn tell(&mut self, answer: Answer<'_>) -> Result<(), Interrupt> {
        self.telling = Progress::default();
        loop {
            self.telling.begin();
            self.write(&answer);
            if self.telling.is_complete() {
                return Ok(());
            }
            self.turn().await?;
        }
    }

    /// Says one line of the present answer. Inlined, it would stand in fifty places.
    #[inline(never)]
    pub(in crate::machine) fn say(&mut self, line: fmt::Arguments<'_>) {
        self.put(&|replies| replies.line(line));
    }

    /// Says a part of the present answer, unless that has been said, or something before it could not be.
    #[inline(never)]
    fn put(&mut self, write: &dyn Fn(&mut Replies) -> Result<(), NoRoom>) {
        if self.telling.is_next() && self.hosts.replies().is_none_or(|replies| write(replies).is_ok()) {
            self.telling.note_said();
            self.hosts.send();
        }
    }

    pub(in crate::machine) fn write(&mut self, answer: &Answer<'_>) {
        match *answer {
            Answer::Nothing => {}
            Answer::Ok => self.say_ok(),
            Answer::LineNumber(number) => self.put(&|replies| replies.line_number(number)),
            Answer::TooLong => self.put(&Replies::too_long),
            Answer::Probe(last) => self.put(&|replies| replies.probe(last)),
            Answer::Resend(reason, last) => self.put(&|replies| replies.resend(reason, last)),
            Answer::Unknown(text) => self.put(&|replies| replies.unknown(text)),
            Answer::Malformed(flaw) => self.say_malformed(flaw),
            Answer::NotObeyed(command, word) => {
                self.say(format_args!("echo:{command} {} is not obeyed by this firmware", Echo(word)));
            }
            Answer::Clamp(clamp) => self.say(format_args!("echo:{clamp}")),
            Answer::NotHomed => self.say(format_args!("echo:move ignored: home its axes first (G28)")),
            Answer::Temperatures => self.say(format_args!("ok {Temperatures}")),
            Answer::Start => {
                self.put(&Replies::start);
                self.say(format_args!("echo:corehbot {}", env!("CARGO_PKG_VERSION")));
            }
            Answer::Line(line) => self.say(format_args!("{line}")),
            Answer::Message(form, text) => self.say_message(form, text),
            Answer::Advance => {
                let time = shortest(self.settings.advance.time);
                self.say(format_args!("echo:Advance K={time}"));
            }
            Answer::FeedPercent => {
                let percent = self.planner.feed_percent();
                self.say(format_args!("FR:{percent}%"));
            }
            Answer::FlowPercent => {
                let percent = self.modal.flow_percent;
                self.say(format_args!("echo:E0 ReleasePolicy: {percent}%"));
            }
            Answer::DebugFlags => {
                let flags = if self.modal.dry_run { "DRYRUN" } else { "off" };
                self.say(format_args!("echo:DEBUG:{flags}"));
            }
            Answer::Keepalive => {
                let seconds = self.settings.keepalive_s;
                self.say(format_args!("echo:M113 S{seconds}"));
            }
            Answer::InvalidTool(number) => self.say(format_args!("echo:T{number} Invalid extruder")),
            Answer::Position { real } => self.say(format_args!("{}", self.position(real))),
            Answer::Firmware => self.say_firmware(),
            Answer::Endstops(pressed) => self.say_endstops(pressed),
            Answer::SoftEndstops => self.say_soft_endstops(),
            Answer::Sensors => self.say_sensors(),
            Answer::Overload => self.say_overload(),
            Answer::Setting(setting) => self.say_setting(setting),
            Answer::Settings => self.say_settings(),
            Answer::OneBelt(code) => {
                self.say(format_args!("echo:{code} ignored: X and Y move one belt and need the same value"));
            }
            Answer::SharedMotors(axes) => {
                self.say(format_args!("echo:M92 ignored: {axes} share motors and need the same value"));
            }
            Answer::LoweredSpeeds => {
                let most = ranges::STEP_RATE;
                self.say(format_args!("echo:M92 lowered speed limits, a motor steps {most} times a second at most"));
            }
            Answer::TooMuchFilament => {
                let most = self.settings.axes.e.length.to_num::<i32>();
                self.say(format_args!("echo:E left out: more than {most} mm of filament in one move"));
            }
            Answer::DriverValues(value) => self.say_driver_values(value),
            Answer::IllegalCurrent(code) => {
                let (least, most) = (ranges::CURRENT_MA.least, ranges::CURRENT_MA.most);
                self.say(format_args!("echo:{code} ignored: {least} to {most} mA"));
            }
            Answer::Driver(report) => self.say_driver(&report),
            Answer::Storage(news) => self.say_storage(&news),
            Answer::NoPower(fault) => self.say(format_args!("Error:{fault}; no motor was given power")),
            Answer::HomingFailed { axis, why } => self.say(format_args!("Error:Homing failed: {axis} endstop {why}")),
        }
    }

    /// Says why a line was not carried out.
    fn say_malformed(&mut self, flaw: Flaw<'_>) {
        match flaw {
            Flaw::NoWord(text) => {
                self.say(format_args!("echo:line ignored: \"{}\" is no letter with a number", Echo(text)));
            }
            Flaw::NoPair(text) => {
                self.say(format_args!("echo:line ignored: \"{}\" is no name with = and a number", Echo(text)));
            }
            Flaw::NoNumber(letter) => self.say(format_args!("echo:line ignored: {} needs a number", letter as char)),
            Flaw::OutOfRange(text) => self.say(format_args!("echo:line ignored: {} is out of range", Echo(text))),
            Flaw::NoAxis(letter) => self.say(format_args!("echo:line ignored: there is no axis {}", letter as char)),
            Flaw::SecondCommand(text) => {
                self.say(format_args!("echo:line ignored: {} is a second command on it", Echo(text)));
            }
        }
    }

    /// Says `ok`, with what a host that fills a window wants to know if it is to be told.
    fn say_ok(&mut self) {
        if !self.settings.advanced_ok {
            return self.put(&Replies::ok);
        }
        let (line, bytes) = self.hosts.progress();
        let moves = if self.has_room() { self.planner.room() } else { 0 };
        self.put(&|replies| replies.advanced_ok(line, moves, bytes));
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
                    // The part at 3 is long: those behind it would fit, but must wait.
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
