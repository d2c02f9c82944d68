//! Answers: the result of a command, as a value. `answer` holds the result, `report` the wording.
//!
//! A command returns its answer; `main_loop::reply` writes it, and the Console then sends the `ok`. What a command says
//! on its way it tells at once (`MainLoop::say` and `tell`), in room that is kept for that. A new reply is a
//! function in the file of its command ([`Answer::says`]). Elsewhere it is a variant here and an arm in
//! `main_loop::reply`. A reply of several lines gets its own function in `reports`. An
//! `echo:` that is no trouble also goes into `EXPECTED` of `sim/board/src/host.rs`, or `corehbot run` warns of it.

use super::belt_answer::BeltAnswer;
use super::buzz_answer::BuzzAnswer;
use super::machine_answer::MachineAnswer;
use super::mesh_answer::MeshAnswer;
use super::message::Message;
use super::next_step::NextStep;
use super::probe_answer::ProbeAnswer;
use super::resonance_answer::ResonanceAnswer;
use super::says::{Say, Says};
use super::screw_answer::ScrewAnswer;
use super::setting::HeatSetting;
use super::setting::Setting;
use super::storage_news::StorageNews;
use super::words::Words;
use crate::connectors::Heater;
use crate::driver::{DriverError, Reading};
use crate::fault;
use crate::gcode::{Flaw, Number};
use crate::machine::state::retraction::RetractionSettings;
use crate::port::{EndstopSet, Motor};
use crate::protocol::ResendReason;
use crate::status::Tuned;
use crate::text::Packed;

/// An answer. Public numbers are read when the answer is written; numbers that a command keeps for itself are part of
/// the answer.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Answer<'a> {
    /// Nothing except the `ok`.
    Nothing,
    /// The `ok` that ends an answer, unless it stands in the answer itself (`has_ok`).
    Ok,
    /// M110, with the line number that it requested.
    LineNumber(Option<i32>),
    TooLong,
    /// Nothing yet: something is awaited first. The dispatch does that, and nobody else gets this one.
    Then(NextStep),
    /// Nothing, and no `ok` for now: the line is kept.
    Kept,
    /// To a silent host: asks for the line after this one.
    Question(i32),
    Resend(ResendReason, i32),
    Unknown(&'a [u8]),
    /// A line that is not in order.
    Malformed(Flaw<'a>),
    /// A command, and the name of a word of it that is not supported.
    NotObeyed(&'static str, &'a [u8]),
    /// A move that must not be made before G28.
    NotHomed,
    /// M290: the offset of z.
    ZOffset,
    /// M105, in the line of the `ok`.
    Temperatures,
    /// The first lines after a reset.
    Start,
    /// A line that is always the same.
    Line(Packed),
    /// Words in the file of the command.
    Says(Says),
    /// M118.
    Message(Message<'a>),
    /// M28, with the name of the file: there is no card.
    NoCard(&'a [u8]),
    /// An upload to a card has ended; this many lines were not carried out.
    UploadEnded(u32),
    Position {
        real: bool,
    },
    Firmware,
    Endstops(EndstopSet),
    /// M122: the fault, heaters and sensors.
    Heat,
    /// Temperatures while a command waits for them, and the seconds that are missing.
    Heating(Option<u32>),
    /// A command would heat with a sensor that cannot be right.
    NoHeat(&'static str, fault::Fault),
    /// A command for a driver of an axis that has no such driver, or whose drivers have one value.
    NoDriver(&'static str, Number),
    HeatSetting(HeatSetting),
    /// M303: the result of the tuning.
    Tuned(Heater, Tuned),
    /// M122: overload since the start.
    Overload,
    /// A setting as the line that sets it.
    Setting(Setting),
    /// Values that a command keeps for itself, as the line that sets them.
    Words(Words),
    /// M503: all of them, and how G10 and G11 retract.
    Settings {
        retraction: RetractionSettings,
        /// As lines that can be sent back unchanged, and nothing else.
        for_replay: bool,
    },
    /// M92 would give axes that share motors different steps.
    SharedMotors(&'static str),
    /// M122: a driver and its reading; `None` without a UART.
    Driver(Motor, Option<Result<Reading, DriverError>>),
    /// Motors that can pull against each other.
    Belt(BeltAnswer),
    /// STEPPER_BUZZ.
    Buzz(BuzzAnswer),
    /// The Z probe.
    Probe(ProbeAnswer),
    /// The mesh of the bed.
    Mesh(MeshAnswer),
    /// G34 and G35.
    Screws(ScrewAnswer),
    /// Resonance tests.
    Resonance(ResonanceAnswer),
    Storage(StorageNews),
    /// A machine over the serial line.
    Machine(MachineAnswer<'a>),
}

impl Answer<'_> {
    /// Words in the file of the command, with a number that it keeps for itself.
    pub const fn says(say: Say, number: i32) -> Self {
        Self::Says(Says::new(say, number))
    }

    /// Whether the `ok` is part of it.
    pub const fn has_ok(&self) -> bool {
        matches!(
            self,
            Self::Ok
                | Self::LineNumber(_)
                | Self::TooLong
                | Self::Question(_)
                | Self::Resend(..)
                | Self::Unknown(_)
                | Self::Temperatures
        )
    }
}
