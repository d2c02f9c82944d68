//! The needs of eleven printers that owners have published, in configurations of our own, and the verdicts on each.
//!
//! The table in docs/reference/machines.md (What other printers need) sums up these verdicts.

mod others;
mod vorons;
mod vzbots;

use super::{read, verdict};
use corehbot_boards::entries;
use corehbot_machine_file::klipper::Kind::{self, Decide};
use corehbot_machine_file::klipper::{Report, translate};
use others::OTHERS;
use std::fmt::Write as _;
use vorons::VORONS;
use vzbots::VZBOTS;

/// A printer.
#[derive(Clone)]
struct Printer {
    name: &'static str,
    /// The key of its board.
    board: &'static str,
    kinematics: &'static str,
    /// Each motor's section and its socket.
    motors: &'static [(&'static str, &'static str)],
    /// The rest of its configuration.
    rest: &'static str,
    /// What becomes of the keys that matter: section, key, verdict, words in it.
    needs: &'static [(&'static str, &'static str, Kind, &'static str)],
    /// Whether it is a machine, and how much is left to decide.
    is_machine: bool,
    decisions: usize,
}

/// Axes, switches and limits that no printer here is about.
const REST: &str = "
[printer]
max_velocity: 300
max_accel: 3000
max_z_velocity: 15
max_z_accel: 350
[stepper_x]
position_max: 350
[stepper_y]
position_max: 350
position_endstop: 0
[stepper_z]
position_max: 330
[extruder]
rotation_distance: 4.6
";

/// The configuration of a printer, with the pins of its sockets. Later keys count, so `rest` says what is different.
fn config_of(printer: &Printer) -> String {
    let board = entries().find(|entry| entry.board.connectors.key == printer.board).unwrap().board;
    let mut text = format!("[printer]\nkinematics: {}\n", printer.kinematics);
    for (section, socket) in printer.motors {
        let at = board.connectors.sockets.iter().position(|name| name.as_str() == *socket).unwrap();
        let slot = &board.sockets[at];
        let uart = slot.uart.unwrap();
        let [step, dir, enable, uart] = [slot.step, slot.dir, slot.enable, uart].map(|pin| (pin.port, pin.number()));
        writeln!(
            text,
            "[{section}]\nstep_pin: P{:?}{}\ndir_pin: P{:?}{}\nenable_pin: !P{:?}{}\nmicrosteps: 16\n\
             rotation_distance: 40\n[tmc2209 {section}]\nuart_pin: P{:?}{}\nrun_current: 0.8",
            step.0, step.1, dir.0, dir.1, enable.0, enable.1, uart.0, uart.1
        )
        .unwrap();
    }
    text += REST;
    // The toolhead boards have the extruder.
    if printer.motors.iter().any(|(section, _)| *section == "extruder") {
        let fan = board.fans[0].pin;
        let (heater, sensor) = if printer.board == "spider" { ("PB15", "PC0") } else { ("PA2", "PF4") };
        writeln!(
            text,
            "heater_pin: {heater}\nsensor_pin: {sensor}\nsensor_type: ATC Semitec 104GT-2\ncontrol: watermark\n\
             min_temp: 0\nmax_temp: 270\n[heater_fan hotend]\npin: P{:?}{}",
            fan.port,
            fan.number()
        )
        .unwrap();
    }
    text + printer.rest
}

/// The verdict on a key: its own words, or those on its section.
fn said<'r>(report: &'r Report, section: &str, key: &str) -> (Kind, &'r str) {
    let (kind, words) = verdict(report, section, key);
    let of_section =
        report.sections.iter().find(|known| known.name == section).and_then(|known| known.verdict.as_ref());
    (kind, of_section.filter(|_| words.is_empty()).map_or(words, |verdict| verdict.text.as_str()))
}

#[test]
fn each_printers_needs_are_taken_or_told() {
    let printers = [VORONS, VZBOTS, OTHERS].concat();
    assert_eq!(printers.len(), 11);
    let mut wrong = Vec::new();
    for printer in &printers {
        let config = read(&config_of(printer)).unwrap();
        let board = entries().find(|entry| entry.board.connectors.key == printer.board).unwrap().board.connectors;
        let done = translate(&config, Some(board)).unwrap();
        for (section, key, kind, words) in printer.needs {
            let (found, text) = said(&done.report, section, key);
            if found != *kind || !text.contains(words) {
                wrong.push(format!("{}: [{section}] {key}: {found:?}: {text}", printer.name));
            }
        }
        let decisions = done.report.counts().iter().find(|(kind, _)| *kind == Decide).map(|(_, count)| *count);
        if (decisions, done.machine.is_some()) != (Some(printer.decisions), printer.is_machine) {
            wrong.push(format!(
                "{}: {decisions:?} {:?} {}",
                printer.name,
                done.problems,
                done.report.to_string().split("to decide\n").last().unwrap()
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
