//! Motion: moves, modes, overrides, retraction.

use super::Command;
use super::grammar::{Grammar, Letters, NO_AXES, WORDS, in_order};
use super::row::Described;
use crate::gcode::axes::{axis_flags, take_axis};
use crate::gcode::code::Code;
use crate::gcode::index::{Absent, Named, Part};
use crate::gcode::lexer::{Word, Words, has, number, numbers};
use crate::gcode::number::Number;
use crate::gcode::parts::{ArcShape, ArcWords, AxisFlags, AxisWords, Flaw, HomeWords, OffsetWords};

/// Moves, modes, overrides, retraction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum MotionCommand {
    /// G0, G1: straight move.
    Line {
        /// Whether it was G0 (a travel move by intent).
        rapid: bool,
        /// The target.
        to: AxisWords,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G0, G1 with C: straight move in which a closed belt circulates.
    Circulate {
        /// The target.
        to: AxisWords,
        /// C: the target of the belt, in mm of belt.
        belt: Number,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G2, G3: arc or helix.
    Arc(ArcWords),
    /// G4: wait this many milliseconds after the motion so far.
    Dwell {
        /// S and P summed, in ms.
        ms: u32,
    },
    /// G10: pull the filament back, and lift the tool.
    Retract,
    /// G11: undo G10.
    Recover,
    /// G28: home axes.
    Home(HomeWords),
    /// G90: positions are absolute.
    Absolute,
    /// G91: positions are relative, E too.
    Relative,
    /// G92: the present position is called this from now on; all zero if no axis is named.
    SetPosition(AxisWords),
    /// M82: E is absolute.
    AbsoluteExtrusion,
    /// M83: E is relative.
    RelativeExtrusion,
    /// M410: stop the motion now and drop all queued moves.
    QuickStop,
    /// M220: feed override in percent, or report.
    FeedPercent(Option<Number>),
    /// M220 B: remember the feed override.
    BackUpFeedPercent,
    /// M220 R: go back to the remembered feed override.
    RestoreFeedPercent,
    /// M290: shift z while moves are under way, or report.
    Babystep {
        /// Z or S.
        by: Option<Number>,
        /// P0: the kept offset stays.
        is_kept: bool,
    },
    /// SET_GCODE_OFFSET: the kept offset of z, or report.
    ZOffset(OffsetWords),
    /// The same command, or M290, for an axis without such an offset.
    NoOffset(&'static str, &'static [u8]),
    /// T0: choose the only tool.
    Tool,
}

/// G0, G1. C is the belt's circulation, which not every machine has.
const LINE: &Grammar = &Grammar::numbers(b"XYZECF").no_axes(b"ABUVW");

pub(super) const ROWS: &[Described] = &[
    Described::g(&[0, 1], |number, text| Some(line(Code { letter: b'G', number, subcode: 0 }, text)))
        .does("X Y Z E F, C", "straight move; C runs a closed belt round, with X, Y and F alone"),
    Described::g(&[2, 3], |number, text| motion(arc(number == 2, text)))
        .grammar(&Grammar::numbers(b"XYZEFIJKRP").no_axes(NO_AXES).not_negative(b"P"))
        .does(
            "X Y Z E F I J K R P",
            "arc or helix, clockwise or counter-clockwise; centre (I J K) or radius (R); P turns",
        ),
    Described::g(&[4], |_, text| motion(dwell(text)))
        .grammar(&Grammar::numbers(b"PS").not_negative(b"PS"))
        .does("P S", "waits for the motion, then P ms and S s"),
    // With P or L it sets a tool's temperatures or offsets (RepRapFirmware).
    Described::g(&[10], |_, text| {
        let is_foreign = Words::new(text).any(|word| matches!(word.letter, b'P' | b'L'));
        if is_foreign { None } else { motion(MotionCommand::Retract) }
    })
    .grammar(WORDS)
    .does("", "retracts as M207 says; with P or L it is another firmware's command and unknown"),
    Described::g(&[11], |_, _| motion(MotionCommand::Recover)).grammar(WORDS).does("", "undoes G10"),
    // With W, Prusa's G28 leaves the mesh; L0 is Marlin's word for it.
    Described::g(&[28], |_, text| motion(MotionCommand::Home(home_words(text))))
        .grammar(&Grammar::numbers(b"R").no_axes(b"ABCUV").not_negative(b"R"))
        .does(
            "X Y Z O R W L",
            "homes the named axes, all without words; O: those that are not homed; R raises Z first; W, L0: no mesh",
        ),
    Described::g(&[90, 91], |number, _| {
        motion(if number == 90 { MotionCommand::Absolute } else { MotionCommand::Relative })
    })
    .grammar(WORDS)
    .does("", "absolute, relative (E too)"),
    Described::g(&[92], |_, text| motion(MotionCommand::SetPosition(position(text))))
        .grammar(&Grammar::numbers(b"").no_axes(NO_AXES))
        .does("X Y Z E", "names the present position; all 0 without words"),
    Described::m(&[82, 83], |number, _| {
        motion(if number == 82 { MotionCommand::AbsoluteExtrusion } else { MotionCommand::RelativeExtrusion })
    })
    .grammar(WORDS)
    .does("", "E absolute, relative"),
    // It must act in any case.
    Described::m(&[410], |_, _| motion(MotionCommand::QuickStop))
        .does("", "brakes along the path and drops queued moves; acts at once"),
    Described::m(&[220], |_, text| motion(feed_percent(text)))
        .grammar(&Grammar::numbers(b"S"))
        .does("S, B, R", "feed in percent; B keeps it, R restores it; or reports"),
    Described::t(|number, _| tool(number))
        .does("", "the only tool; another one is answered `echo:T1 Invalid extruder` once a print"),
];

const fn motion(command: MotionCommand) -> Option<Command<'static>> {
    Some(Command::Motion(command))
}

/// The highest number of a tool in any firmware; beyond it a T is something else, or damaged.
const MOST_TOOLS: u16 = 255;

/// T0, and the tools that there are not.
const fn tool(number: u16) -> Option<Command<'static>> {
    if number == 0 {
        return motion(MotionCommand::Tool);
    } else if number > MOST_TOOLS {
        return None;
    }
    let command = Named::Code(b'T', number);
    Some(Command::Malformed(Flaw::Absent(Absent { command, part: Part::Tool, which: b"" })))
}

/// G0 and G1. Only a line with unusual parts is parsed again.
pub(in crate::gcode) fn line(code: Code, text: &[u8]) -> Command<'_> {
    let (mut x, mut y, mut z, mut e, mut feed) = (None, None, None, None, None);
    let mut is_usual = true;
    let mut words = Words::new(text);
    for word in words.by_ref() {
        is_usual &= word.number.is_some();
        match word.letter {
            b'X' => x = word.number,
            b'Y' => y = word.number,
            b'Z' => z = word.number,
            b'E' => e = word.number,
            b'F' => feed = word.number,
            _ => is_usual = false,
        }
    }
    let to = AxisWords { x, y, z, e };
    if !is_usual || words.has_skipped() {
        return unusual_line(code, text, to, feed);
    }
    Command::Motion(MotionCommand::Line { rapid: code.number == 0, to, feed })
}

/// The same for a line with unusual parts. It makes its command itself, so that [`line`] writes one to one place.
#[cold]
#[inline(never)]
fn unusual_line(code: Code, text: &[u8], to: AxisWords, feed: Option<Number>) -> Command<'_> {
    let command = Command::Motion(MotionCommand::Line { rapid: code.number == 0, to, feed });
    in_order(with_belt(command, text), LINE, Letters::NONE, code, text)
}

/// A move in which the belt circulates too, if the line has a C.
fn with_belt<'a>(command: Command<'a>, text: &[u8]) -> Command<'a> {
    match (command, number(text, b'C')) {
        (Command::Motion(MotionCommand::Line { to, feed, .. }), Some(belt)) => {
            Command::Motion(MotionCommand::Circulate { to, belt, feed })
        }
        (command, _) => command,
    }
}

/// G2 and G3. With a radius, I, J and K do not count (Marlin).
fn arc(clockwise: bool, text: &[u8]) -> MotionCommand {
    let mut to = AxisWords::default();
    let (mut feed, mut i, mut j, mut k, mut radius, mut turns) = (None, None, None, None, None, None);
    let mut decimals = 0;
    let mut words = Words::new(text);
    let mut remaining = text;
    while let Some(word) = words.next() {
        let written = remaining.get(..remaining.len() - words.remaining().len()).unwrap_or_default();
        remaining = words.remaining();
        if matches!(word.letter, b'X' | b'Y' | b'Z' | b'I' | b'J' | b'K' | b'R') {
            decimals = decimals.max(decimals_of(written));
        }
        match word.letter {
            b'F' => feed = word.number,
            b'I' => i = word.number,
            b'J' => j = word.number,
            b'K' => k = word.number,
            b'R' => radius = word.number,
            b'P' => turns = word.number,
            _ => take_axis(&mut to, word),
        }
    }
    let shape = match radius {
        Some(radius) => ArcShape::Radius(radius),
        None if i.or(j).or(k).is_none() => ArcShape::Missing,
        None => {
            let [i, j, k] = [i, j, k].map(Option::unwrap_or_default);
            ArcShape::Centre { i, j, k }
        }
    };
    let turns = turns.map_or(1, Number::to_u32).clamp(1, u32::from(u16::MAX)) as u16;
    MotionCommand::Arc(ArcWords { clockwise, to, feed, shape, turns, decimals })
}

/// Decimals that count: the fifth of an inch is a quarter of a micrometre.
const MOST_DECIMALS: usize = 5;

/// Decimals of the number that `written` ends with.
fn decimals_of(written: &[u8]) -> u8 {
    let number = written.rsplit(u8::is_ascii_alphabetic).next().unwrap_or_default();
    let decimals = number.split(|byte| *byte == b'.').nth(1).unwrap_or_default();
    decimals.iter().take_while(|byte| byte.is_ascii_digit()).take(MOST_DECIMALS).count() as u8
}

fn home_words(text: &[u8]) -> HomeWords {
    let axes = AxisFlags { e: false, ..axis_flags(text) };
    let [raise, keeps] = numbers(text, b"RL");
    let drops_mesh = has(text, b'W') || keeps == Some(Number::ZERO);
    HomeWords { axes, only_lost: has(text, b'O'), raise, drops_mesh }
}

/// G4. The sum stays below the largest number, so that it can be printed and read again.
fn dwell(text: &[u8]) -> MotionCommand {
    let [milliseconds, seconds] = numbers(text, b"PS").map(Option::unwrap_or_default);
    let sum = u64::from(milliseconds.to_u32()) + seconds.to_thousandths().max(0) as u64;
    MotionCommand::Dwell { ms: sum.min(Number::LIMIT as u64) as u32 }
}

/// The words of G92: a letter without a number is zero, and so is everything if there is no letter.
fn position(text: &[u8]) -> AxisWords {
    let mut words = AxisWords::default();
    for word in Words::new(text) {
        take_axis(&mut words, Word { number: Some(word.number.unwrap_or_default()), ..word });
    }
    if words == AxisWords::default() {
        let zero = Some(Number::ZERO);
        words = AxisWords { x: zero, y: zero, z: zero, e: zero };
    }
    words
}

/// M220. B and R stand alone in practice; with either of them S is ignored.
fn feed_percent(text: &[u8]) -> MotionCommand {
    if has(text, b'B') {
        MotionCommand::BackUpFeedPercent
    } else if has(text, b'R') {
        MotionCommand::RestoreFeedPercent
    } else {
        MotionCommand::FeedPercent(number(text, b'S'))
    }
}
