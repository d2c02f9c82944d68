//! G-code: one line of text in, one [`Command`] out.
//!
//! The dialect is that which slicers and hosts write for Marlin 2, plus the commands of Klipper, RepRapFirmware and
//! Prusa in sliced files. This room knows the words of each command: its letters, its names in other firmwares, its
//! illegal numbers, and the meaning of a missing number. It also knows which commands need nothing but `ok`. Room
//! `machine` carries the command out; room `protocol` has already removed a line's number and checksum. No state is
//! kept: a line gives the same command after any other lines.
//!
//! `parse` finds the code and its row in `commands`. Each family of commands has a file there, with the type, the
//! reader of its words, its rules for them, and its line in docs/reference/gcode.md. Codes and letters of plain
//! settings come from the rows of `settings`. `parse_with` looks into the own table of room `machine` too, where a file
//! has all of a command. `index` has the parts that words select. The other files read letters, numbers and axes.

mod axes;
mod code;
mod commands;
mod index;
mod lexer;
mod number;
mod parse;
mod parts;

pub use commands::{
    BedCommand, Command, Example, Forgets, Grammar, JobCommand, Line, MotionCommand, MotorCommand, Nature, OwnCommand,
    OwnEntry, OwnRow, ProbeCommand, RefusedCommand, ReportCommand, ResonanceCommand, SettingCommand, ShaperName, Text,
    Treatment, codes, described, names, places,
};
pub use index::{Absent, Named, Part};
pub use number::Number;
pub use parse::{parse, parse_with};
pub use parts::{
    ArcShape, ArcWords, Audience, AxisFlags, AxisWords, Flaw, Form, GridWords, HomeWords, LevelWords, LevellingWords,
    MachineRecord, MeshPoint, OffsetWords, ParkWords, PlainWords, Plane, PointWords, ShaperWords, SweepAxis,
    SweepWords, TuningWords, VelocityWords,
};
