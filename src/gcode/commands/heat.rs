//! Heaters: their temperatures, and the settings of their PID control. Other commands about heat are a file each in
//! `machine::commands::table`.

use super::Command;
use super::grammar::Grammar;
use super::reports::ReportCommand;
use super::row::Described;
use super::settings::plain;
use crate::gcode::index::Part;

pub(super) const ROWS: &[Described] = &[
    Described::m(&[105], |_, _| Some(Command::Report(ReportCommand::Temperatures))).does("", "reports temperatures"),
    Described::m(&[301], plain)
        .grammar(&Grammar::plain().parts(&[(b'E', Part::Extruder), (b'H', Part::Heater), (b'T', Part::Tool)]))
        .does("P I D", "PID gains of the hotend; or reports"),
    Described::m(&[304], plain)
        .grammar(&Grammar::plain().parts(&[(b'H', Part::Heater), (b'T', Part::Tool)]))
        .does("P I D", "the same for the bed"),
];
