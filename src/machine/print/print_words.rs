//! START_PRINT, END_PRINT: the begin and the end of a print in Klipper's words, as the owner's text or as built in.

use super::job::end_by_line;
use super::named_texts::{Called, call, tell_flaw};
use super::parking::change;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Nature, Number, flaw_of_pairs};
use crate::machine::state::running_texts::Body;

const FAMILY: &str = "Jobs, pauses and waits";

/// They are not refused after a print was ended: they say that there is another.
pub(in crate::machine) const START: Entry = Entry::name(FAMILY, &["START_PRINT", "PRINT_START"])
    .does(
        "BED_TEMP= EXTRUDER_TEMP= CHAMBER_TEMP=",
        "begins a print: heats, homes, uses a mesh if there is one, and waits; or the owner's text",
    )
    .examples(&[
        ("START_PRINT BED_TEMP=60 EXTRUDER_TEMP=210", &["echo:no heaters configured"]),
        ("PRINT_START", &["echo:no heaters configured"]),
        ("START_PRINT BED_TEMP=warm", &["echo:line ignored: \"BED_TEMP=warm\" is not a name with = and a number"]),
    ]);

pub(in crate::machine) const END: Entry = Entry::name(FAMILY, &["END_PRINT", "PRINT_END"])
    .nature(Nature::Work)
    .does("", "ends a print: filament back, parks, all off but the motors of Z; or the owner's text")
    .examples(&[("END_PRINT", &["echo:no heaters configured"]), ("PRINT_END", &["echo:no heaters configured"])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let begins = command.is_named("START_PRINT");
    if begins {
        if flaw_of_start(command.text(), &mut |_, _| true).is_some() {
            // What prints is held until the axes are homed.
            let host = main_loop.hosts.serving();
            main_loop.job.begin_by_unknown_name(host);
        }
        begin(main_loop, states).await?;
    }
    let names: [&[u8]; 2] = if begins { [b"START_PRINT", b"PRINT_START"] } else { [b"END_PRINT", b"PRINT_END"] };
    if names.into_iter().any(|name| call(main_loop, states, name, command.text()) == Called::Taken) {
        return Ok(Answer::Nothing);
    }
    if states.texts.is_full() {
        return Ok(Answer::Line(packed!("echo:ignored: texts call each other more than 3 deep")));
    }
    if begins {
        begin_as_built_in(main_loop, states, command.text());
        return Ok(Answer::Nothing);
    }
    if !states.is_too_cold(main_loop) {
        let pause = main_loop.settings.pause;
        change(main_loop, states, pause.retract.saturating_neg(), pause.retract_speed).await?;
    }
    let begin = states.texts.words_begin();
    states.texts.call(Body::End(0), begin, &states.modal);
    Ok(Answer::Nothing)
}

/// A print begins. One that is still paused was cancelled.
async fn begin<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, states: &mut States) -> Result<(), Interrupt> {
    if main_loop.job.is_paused() {
        end_by_line(main_loop, &mut states.modal).await?;
    }
    main_loop.job.forgive();
    if !main_loop.job.is_under_way() {
        main_loop.commanded.settle();
        states.notices.renew_for_print();
    }
    let host = main_loop.hosts.serving();
    main_loop.job.begin(host);
    Ok(())
}

/// The words are kept, and the lines begin. A word that is no temperature refuses the line.
fn begin_as_built_in<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, states: &mut States, words: &[u8]) {
    let begin = states.texts.words_begin();
    if let Some(flaw) = flaw_of_start(words, &mut |key, value| states.texts.add_word(&[key], value)) {
        states.texts.drop_words(begin);
        tell_flaw(main_loop, flaw);
        return;
    }
    states.texts.call(Body::Start(0), begin, &states.modal);
}

/// Names that files have for the temperatures of bed, hotend and chamber.
const NAMES: [&str; 14] = [
    "BED_TEMP",
    "BED",
    "BED_TEMPERATURE",
    "EXTRUDER_TEMP",
    "EXTRUDER",
    "EXTRUDER_TEMPERATURE",
    "HOTEND_TEMP",
    "HOTEND",
    "NOZZLE_TEMP",
    "NOZZLE",
    "TOOL_TEMP",
    "CHAMBER_TEMP",
    "CHAMBER",
    "CHAMBER_TEMPERATURE",
];

/// Gives the temperatures in the words of START_PRINT to `keep`, by `B`, `E` and `C`. Other words do not count.
#[inline(never)]
fn flaw_of_start<'a>(words: &'a [u8], keep: &mut dyn FnMut(u8, &[u8]) -> bool) -> Option<Flaw<'a>> {
    flaw_of_pairs(words, &NAMES, &mut |pair| {
        let key = match pair.place {
            0..=2 => b'B',
            3..=10 => b'E',
            11..=13 => b'C',
            _ => return None,
        };
        match Number::read(pair.value) {
            // 0 is what a heater has that is not named.
            Some((Number::ZERO, b"")) => None,
            Some((_, b"")) if keep(key, pair.value) => None,
            _ => Some(pair.flaw()),
        }
    })
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::String;

    #[test]
    fn start_print_has_the_words_of_many_profiles() {
        let kept = |words: &'static str| {
            let mut kept = String::new();
            let flaw = flaw_of_start(words.as_bytes(), &mut |key, value| {
                kept += &std::format!("{}{} ", key as char, str::from_utf8(value).unwrap());
                true
            });
            (kept, flaw.is_some())
        };
        for (words, expected) in [
            ("", ""),
            (" BED_TEMP=60 EXTRUDER_TEMP=210", "B60 E210 "),
            (" EXTRUDER=245.5 BED=100 CHAMBER=40", "E245.5 B100 C40 "),
            (" extruder_temp=200 bed_temp=0 MATERIAL=PLA FILAMENT_NAME=\"a b\" SIZE=10_20_30_40", "E200 "),
        ] {
            assert_eq!(kept(words), (String::from(expected), false), "{words}");
        }
        for words in [" 60 210", " BED=warm", " BED=", " EXTRUDER=2e2", " BED=60;70 X"] {
            assert_eq!(kept(words).1, words != " BED=60;70 X", "{words}");
        }
    }
}
