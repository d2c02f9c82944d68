//! Settings, and where they are kept.

mod machine_record;
mod plain;
mod shaping;

use super::Command;
use super::grammar::Grammar;
use super::row::Described;
use crate::gcode::index::Part;
use crate::gcode::lexer::switch;
use crate::gcode::number::Number;
use crate::gcode::parts::{MachineRecord, PlainWords, ShaperWords, VelocityWords};
use crate::settings::plain::{AXIS_CODES, MACHINE_CODES};
pub(super) use plain::plain;
pub use shaping::ShaperName;
use shaping::{linear_advance, pressure_advance, set_pressure_advance, set_velocity_limit, shaper};

/// Settings, and where they are kept.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum SettingCommand<'a> {
    /// Numbers of rows of `settings`, or report.
    Plain(PlainWords),
    /// M593: the input shapers of the named axes, both if none is named, or report.
    Shaper(ShaperWords),
    /// M900, M572, SET_PRESSURE_ADVANCE: pressure advance, or report.
    Advance {
        /// K or S, in s.
        time: Option<Number>,
        /// W: the time over which the speed is averaged, in s.
        window: Option<Number>,
    },
    /// SET_VELOCITY_LIMIT: acceleration, corner speed and the part of a move over which its speed holds at least, or
    /// report.
    VelocityLimit(VelocityWords<'a>),
    /// M500: keep the settings in storage.
    SaveSettings,
    /// M501: take the settings that are in storage.
    LoadSettings,
    /// M502: take the settings that the machine was made with.
    DefaultSettings,
    /// M503: report the settings as G-code.
    ReportSettings {
        /// S0: as lines that can be sent back unchanged, and nothing else.
        for_replay: bool,
    },
    /// M504: look whether the settings in storage are whole.
    CheckStorage,
    /// MACHINE_GET, MACHINE_PUT, MACHINE_STORE: the machine, as a record in pieces.
    MachineRecord(MachineRecord<'a>),
}

/// A number for each axis.
const AXES: &Grammar = &Grammar::plain().parts(&[(b'T', Part::Extruder)]);

pub(super) const ROWS: &[Described] = &[
    Described::m(AXIS_CODES, plain).grammar(AXES),
    Described::m(MACHINE_CODES, plain).grammar(&Grammar::plain()),
    Described::m(&[205], plain)
        .grammar(&Grammar::plain())
        .does("X Y Z E J S T B", "jerks, junction deviation, least feeds; B is not used; or reports"),
    Described::m(&[593], |_, text| Some(shaper(text)))
        .grammar(&Grammar::numbers(b"FDTS").not_negative(b"F"))
        .does("X Y F D T S P", "input shaper: frequency, damping (D or S), kind; or reports"),
    Described::m(&[900], |_, text| Some(linear_advance(text)))
        .grammar(&Grammar::numbers(b"KT").parts(&[(b'T', Part::Extruder), (b'S', Part::Slot), (b'L', Part::Other)]))
        .does("K T", "pressure advance in s; or reports"),
    Described::m(&[572], |_, text| Some(pressure_advance(text)))
        .grammar(&Grammar::numbers(b"SWD").parts(&[(b'D', Part::Extruder)]))
        .does("S W D", "pressure advance in s (S), its window (W); or reports"),
    Described::name(&["SET_PRESSURE_ADVANCE"], |_, text| Some(set_pressure_advance(text)))
        .does("ADVANCE= SMOOTH_TIME=", "M572 in Klipper's words"),
    Described::name(&["SET_VELOCITY_LIMIT"], |_, text| Some(set_velocity_limit(text))).does(
        "ACCEL= SQUARE_CORNER_VELOCITY= MINIMUM_CRUISE_RATIO= ACCEL_TO_DECEL=",
        "acceleration, corner speed, cruise ratio; or reports",
    ),
    Described::m(&[500, 501, 502], |number, _| {
        setting(match number {
            500 => SettingCommand::SaveSettings,
            501 => SettingCommand::LoadSettings,
            _ => SettingCommand::DefaultSettings,
        })
    })
    .does("", "saves, loads, restores the defaults"),
    Described::m(&[503], |_, text| setting(SettingCommand::ReportSettings { for_replay: switch(text) == Some(false) }))
        .does("S", "reports all settings; S0 as lines to send back"),
    Described::m(&[504], |_, _| setting(SettingCommand::CheckStorage)).does("", "checks what is stored"),
    Described::name(&["MACHINE_GET"], |_, _| setting(SettingCommand::MachineRecord(MachineRecord::Get)))
        .does("", "the machine as a record in lines"),
    Described::name(&["MACHINE_PUT"], |_, text| Some(machine_record::put(text)))
        .does("AT= HEX=", "a piece of a record"),
    Described::name(&["MACHINE_STORE"], |_, _| setting(SettingCommand::MachineRecord(MachineRecord::Store)))
        .does("", "checks and stores the record"),
];

const fn setting(command: SettingCommand<'_>) -> Option<Command<'_>> {
    Some(Command::Setting(command))
}
