//! Words about layers and pictures that files of Klipper and Bambu printers have: told once a print, without effect.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};

const FAMILY: &str = "Jobs, pauses and waits";

pub(in crate::machine) const FRAME: Entry = Entry::name(FAMILY, &["TIMELAPSE_TAKE_FRAME"])
    .does("", "a picture: no effect, told once a print")
    .examples(&[("TIMELAPSE_TAKE_FRAME", &["echo:TIMELAPSE_TAKE_FRAME has no effect here, told once a print"])]);

pub(in crate::machine) const VIDEO: Entry = Entry::name(FAMILY, &["TIMELAPSE_RENDER"])
    .does("", "a video: no effect, told once a print")
    .examples(&[("TIMELAPSE_RENDER", &["echo:TIMELAPSE_RENDER has no effect here, told once a print"])]);

pub(in crate::machine) const LAYERS: Entry = Entry::name(FAMILY, &["SET_PRINT_STATS_INFO"])
    .does("", "layers for a display: no effect, told once a print")
    .examples(&[(
        "SET_PRINT_STATS_INFO TOTAL_LAYER=9 CURRENT_LAYER=1",
        &["echo:SET_PRINT_STATS_INFO has no effect here, told once a print"],
    )]);

/// A second carriage (Marlin), and Bambu's notes.
pub(in crate::machine) const CODES: Entry = Entry::m(FAMILY, &[605, 1002])
    .does("", "a second carriage, notes for a display: no effect, told once a print")
    .examples(&[
        ("M605 S0", &["echo:M605 has no effect here, told once a print"]),
        ("M1002 gcode_claim_action : 0", &["echo:M1002 has no effect here, told once a print"]),
    ]);

/// All of them.
const WORDS: [&str; 5] = ["TIMELAPSE_TAKE_FRAME", "TIMELAPSE_RENDER", "SET_PRINT_STATS_INFO", "M605", "M1002"];

/// The place of a command among them.
fn place_of(command: &TableCommand<'_>) -> usize {
    match command.code() {
        605 => 3,
        1002 => 4,
        _ => WORDS.iter().position(|name| command.is_named(name)).unwrap_or_default(),
    }
}

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { notices, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let place = place_of(command);
    if !notices.give_absent(place as u32) {
        return Answer::Nothing;
    }
    let name = WORDS.get(place).copied().unwrap_or_default();
    main_loop.say(text!("echo:{name} has no effect here, told once a print"));
    Answer::Said
}
