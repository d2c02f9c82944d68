//! Texts with a name: the owner's, and START_PRINT and END_PRINT as they are built in. A call is one line of a host;
//! its lines are carried out as if they came from that host, and one `ok` follows the last.

use super::Wake;
use crate::gcode::{Flaw, flaw_of_pairs};
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::JobEnd;
use crate::machine::state::running_texts::{Body, RunningTexts};
use crate::machine::states::States;
use crate::port::BoardFacts;
use crate::protocol::{Echo, LONGEST_LINE};
use crate::storage::{Gap, is_value, line_at, split_at_gap, text_named};
use crate::text::{Packed, is_word};
use heapless::Vec;

/// The place for a line.
pub(in crate::machine) type Line = Vec<u8, LONGEST_LINE>;

/// What became of a name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Called {
    /// It is no text of the owner.
    Unknown,
    /// It is a text that is being carried out: in it, the name means what is built in.
    Inside,
    /// It runs, or was refused in words.
    Taken,
}

/// The name that a line begins with, and the words behind it.
pub(in crate::machine) fn split_name(line: &[u8]) -> (&[u8], &[u8]) {
    let end = line.iter().position(|byte| !(byte.is_ascii_alphanumeric() || *byte == b'_')).unwrap_or(line.len());
    line.split_at(end)
}

/// A call is refused, and nothing of its text is carried out.
fn refuse<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, [name, key]: [&[u8]; 2], why: Packed) -> Called {
    main_loop.say(text!("echo:{} ignored: {}{why}", Echo(name), Echo(key)));
    Called::Taken
}

/// The words of a call are not in order.
pub(super) fn tell_flaw<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, flaw: Flaw<'_>) {
    if let Flaw::NoPair(word) = flaw {
        main_loop.say(text!("echo:line ignored: \"{}\" is not a name with = and a number", Echo(word)));
    }
}

/// Runs the owner's text of that name, if there is one.
pub(in crate::machine) fn call<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    name: &[u8],
    words: &[u8],
) -> Called {
    let body = main_loop.board.texts();
    let Some(first) = text_named(body, name) else { return Called::Unknown };
    if states.texts.runs(first) {
        return Called::Inside;
    }
    if states.texts.is_full() {
        return refuse(main_loop, [name, b""], packed!("texts call each other more than 3 deep"));
    }
    if let Some(flaw) = flaw_of_pairs(words, &[], &mut |_| None) {
        tell_flaw(main_loop, flaw);
        return Called::Taken;
    }
    // Nothing is carried out if a word is missing that a later line needs.
    let (begin, mut at) = (states.texts.words_begin(), first);
    while let Some((mut line, next)) = line_at(body, at) {
        while let Some((_, Gap { key, default }, after)) = split_at_gap(line) {
            line = after;
            let why = match value_of(words, key) {
                _ if states.texts.word_from(begin, key).is_some() => continue,
                None if default.is_some() => continue,
                None => packed!("= is missing"),
                Some(value) if !is_value(value) => packed!("= needs a plain word of at most 24 characters"),
                Some(value) if states.texts.add_word(key, value) => continue,
                Some(_) => packed!("= is too much"),
            };
            states.texts.drop_words(begin);
            return refuse(main_loop, [name, key], why);
        }
        at = next;
    }
    states.texts.call(Body::Own { first: first as u16, next: first as u16 }, begin, &states.modal);
    Called::Taken
}

/// The same with the whole line of a call.
pub(in crate::machine) fn call_line<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    line: &[u8],
) -> Called {
    let (name, words) = split_name(line);
    call(main_loop, states, name, words)
}

/// The value of the key in a call, if it is given. The last one counts.
pub(in crate::machine) fn value_of<'a>(words: &'a [u8], key: &[u8]) -> Option<&'a [u8]> {
    let mut value = None;
    flaw_of_pairs(words, &[], &mut |pair| {
        if is_word(pair.name, key) {
            value = Some(pair.value);
        }
        None
    });
    value
}

/// Puts the next line of the texts that run into `line`. False if all are over.
pub(in crate::machine) fn next_line<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    line: &mut Line,
) -> bool {
    while let Some(body) = states.texts.innermost().copied() {
        line.clear();
        let (step, next) = match body {
            Body::Own { first, next } => match line_at(main_loop.board.texts(), usize::from(next)) {
                Some((text, after)) => {
                    if fill(text, &states.texts, line).is_none() {
                        // What is left of it may be another command.
                        line.clear();
                        main_loop.say(text!("echo:a line of a text is left out: its words are too long"));
                    }
                    (Step::Line, Body::Own { first, next: after as u16 })
                }
                None => (Step::Over, body),
            },
            Body::Start(step) => {
                let has_mesh = main_loop.bed.mesh().is_some();
                (line_of_start(step, &states.texts, has_mesh, line), Body::Start(step + 1))
            }
            Body::End(step) => (line_of_end(main_loop, step, line), Body::End(step + 1)),
        };
        if let Some(body) = states.texts.innermost() {
            *body = next;
        }
        match step {
            Step::Line if line.is_empty() => {}
            Step::Line => return true,
            Step::Over => {
                if let Some(modal) = states.texts.end() {
                    states.modal = states.modal.restored(&modal);
                }
            }
        }
    }
    if core::mem::take(&mut states.texts.is_of_cancel) {
        // The rest of the print's stream may still come.
        main_loop.job.end_early(JobEnd::Cancelled);
    }
    false
}

/// A step of a text.
enum Step {
    /// A line, which may be empty.
    Line,
    /// There is none left.
    Over,
}

/// Puts parts into a line; `None` if they do not fit.
fn put(line: &mut Line, parts: &[&[u8]]) -> Option<()> {
    parts.iter().try_for_each(|part| line.extend_from_slice(part).ok())
}

/// Puts a line of a text into `line`, with the words of its call in its gaps.
fn fill(mut text: &[u8], texts: &RunningTexts, line: &mut Line) -> Option<()> {
    while let Some((before, Gap { key, default }, after)) = split_at_gap(text) {
        put(line, &[before, texts.word(key).or(default).unwrap_or_default()])?;
        text = after;
    }
    put(line, &[text])
}

/// START_PRINT: all warm up while the axes are homed; the hotend waits at 150 C, where it does not drip.
fn line_of_start(step: u8, texts: &RunningTexts, has_mesh: bool, line: &mut Line) -> Step {
    let with = |line: &mut Line, key: &[u8], code: &[u8]| texts.word(key).and_then(|value| put(line, &[code, value]));
    let _ = match step {
        0 => with(line, b"C", b"M141 S"),
        1 => with(line, b"B", b"M140 S"),
        2 if texts.word(b"E").is_some() => put(line, &[b"M104 S150"]),
        3 => put(line, &[b"G28"]),
        4 => with(line, b"B", b"M190 S"),
        5 if has_mesh => put(line, &[b"M420 S1"]),
        6 => with(line, b"C", b"M191 S"),
        // Without a word, what the lines before have set is waited for.
        7 => with(line, b"E", b"M109 S").or_else(|| put(line, &[b"M116"])),
        2 | 5 => None,
        _ => return Step::Over,
    };
    Step::Line
}

/// END_PRINT, after the filament was pulled back: the tool leaves the part, and all goes off. Motors that carry the bed
/// hold it.
fn line_of_end<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>, step: u8, line: &mut Line) -> Step {
    let mechanism = main_loop.motion.groups().mechanism();
    let [x, y, z] = [0, 1, 2].map(|axis| mechanism.motors_of(axis));
    let has_z_apart = !x.with(y).intersects(z);
    let text: &[u8] = match step {
        0 if !main_loop.homed.lacks_one_of([true; 3]) => b"G27",
        0 => b"",
        1 => b"M77",
        2 => b"M104 S0",
        3 => b"M140 S0",
        4 => b"M141 S0",
        5 => b"M107",
        6 if has_z_apart => b"M84 X Y E",
        6 => b"M84 E",
        _ => return Step::Over,
    };
    let _ = put(line, &[text]);
    Step::Line
}
