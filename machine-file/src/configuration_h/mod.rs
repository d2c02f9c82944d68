//! Marlin's `Configuration.h` and `Configuration_adv.h` as a machine file, with a verdict on every `#define` that
//! counts.
//!
//! | file | job |
//! |---|---|
//! | `expression` | conditions and values |
//! | `defines` | texts to the defines that count |
//! | `words` | defines as words of Marlin |
//! | `parts` | defines that no answer of a printer says: the machine, the bed, heaters |
//! | `homing` | homing, the probe, the place where Z is homed |
//! | `plugs` | directions of motors, levels of switches |
//! | `others` | drivers, fans, pauses, switches of other defines |
//! | `look` | the work on one define |
//! | `tables` | remarks on the rest |
//!
//! Most defines are the numbers that M503 reports, so they become its words (`marlin::source`).

mod defines;
mod expression;
mod homing;
mod look;
mod others;
mod parts;
mod plugs;
mod tables;
mod words;

use crate::marlin::source::Source;
use crate::marlin::work::Work;
use crate::marlin::{Given, parts as of_words};
use crate::translation::{Kind, Translation, Verdict};
use corehbot::connectors::BoardConnectors;
use defines::Defines;

/// Whether a text is a source of Marlin's settings.
#[must_use]
pub fn is_configuration(text: &str) -> bool {
    let is_define = |line: &&str| line.trim_start().trim_start_matches('/').starts_with("#define ");
    let has = |name: &str| text.contains(name);
    text.lines().filter(is_define).count() > 1
        && !has_section(text)
        && (has("MOTHERBOARD") || has("DEFAULT_AXIS_STEPS_PER_UNIT") || has("CONFIGURATION_ADV_H") || has("_CURRENT"))
}

/// Whether a line outside of C's comments is the head of a section: Klipper's comments begin with `#`, as defines do.
fn has_section(text: &str) -> bool {
    let mut is_comment = false;
    text.lines().map(str::trim).any(|line| {
        is_comment |= line.starts_with("/*");
        let is_head = line.strip_prefix('[').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_alphabetic()));
        let is_section = is_head && !is_comment && line.contains(']');
        is_comment &= !line.contains("*/");
        is_section
    })
}

/// Translates files, each with its name; the first one names the machine file.
#[must_use]
pub fn translate(files: &[(&str, &str)], given: Given) -> Translation {
    let defines = Defines::read(files);
    let mut source = Source::of(files.iter().map(|(name, _)| (*name).to_owned()).collect());
    let given = Given { board: given.board.or_else(|| parts::board(&defines)), ..given };
    words::words(&defines, &mut source);
    let (said, places) = (source.said(), source.places());
    let mut work = Work::of(&said, places);
    parts::before(&mut work, &defines, given.board);
    of_words(&mut work, given);
    plugs::after(&mut work, &defines, given);
    let board = given.board.unwrap_or(&BoardConnectors::ANY);
    source.translation(&work, board, "Configuration.h", |item| match tables::remark(&item.key) {
        Some((kind, text)) => Verdict::new(kind, text),
        None => Verdict::new(Kind::NotYet, crate::marlin::tables::NO_SETTING),
    })
}
