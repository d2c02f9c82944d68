//! Rules: what the line of a plain code keeps to, besides the ranges of its rows.
//!
//! One table has a row for each code with a rule, and a row names its functions. `plain::CONDITIONS` in
//! `crate::settings` says who must be told of new values.

use super::plain_words::PlainWords;
use crate::connectors::Heater;
use crate::gcode::Number;
use crate::machine::heat::heating::model_of;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::machine::state::notices::{Notice, Notices};
use crate::settings::rows::Legal;
use crate::settings::{Control, CornerRule, Settings, ranges};
use crate::text::Packed;
use crate::units::MmPerSec;
use core::fmt::{self, Display, Formatter};
use fixed::types::I32F32;

/// What a line can be answered before its values are read, if it is not carried out.
type Refuses = fn(&Settings) -> Option<Packed>;

/// The legal values of a part, from those of its row.
type LegalValues = fn(&Settings, usize, Legal) -> Legal;

/// Takes the words that are no settings.
type Begins = fn(&PlainWords, &mut Settings, &Modal, &mut Clamps);

/// What follows from the values when all are legal.
type Ends = fn(&PlainWords, &mut Settings, &mut Notices) -> Ending;

/// How a line ends.
pub(in crate::machine) enum Ending {
    /// The values count.
    Done,
    /// They count, and the host gets a remark.
    Remark(Remark),
    /// They do not count.
    Refusal(Remark),
}

/// What the host gets to know.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Remark {
    /// M92 would give axes that share motors different steps.
    SharedMotors(&'static str),
    /// M92 has lowered speeds.
    Lowered,
    /// M205: some words do not count.
    Corners,
}

impl Display for Remark {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::SharedMotors(axes) => put!(f, "echo:M92 ignored: {axes} share motors and need the same value"),
            Self::Lowered => {
                let most = ranges::STEP_RATE.whole();
                put!(f, "echo:M92 lowered speed limits, a motor steps {most} times a second at most")
            }
            Self::Corners => put!(f, "echo:M205: one value for X and Y, the lesser, or J instead; B is not used"),
        }
    }
}

/// The rule of a code.
#[derive(Clone, Copy)]
pub(in crate::machine) struct Rule {
    code: u16,
    pub refuses: Refuses,
    pub legal: LegalValues,
    pub begins: Begins,
    pub ends: Ends,
}

/// The codes with a rule.
const RULES: [Rule; 5] = [
    Rule { legal: resolution_of_motors, ends: check_resolutions, ..Rule::none(92) },
    Rule { legal: speed_of_motors, ..Rule::none(203) },
    Rule { begins: choose_corner_rule, ends: remark_on_corners, ..Rule::none(205) },
    Rule { refuses: |s| model_of(&s.thermal, Some(Heater::Hotend)).err(), ends: by_hotend_gains, ..Rule::none(301) },
    Rule { refuses: |s| model_of(&s.thermal, Some(Heater::Bed)).err(), ends: by_bed_gains, ..Rule::none(304) },
];

impl Rule {
    /// None.
    const fn none(code: u16) -> Self {
        Self {
            code,
            refuses: |_| None,
            legal: |_, _, legal| legal,
            begins: |_, _, _, _| {},
            ends: |_, _, _| Ending::Done,
        }
    }

    /// The rule of a code.
    pub fn of(code: u16) -> Self {
        RULES.into_iter().find(|rule| rule.code == code).unwrap_or(const { Self::none(0) })
    }
}

/// M203: a motor steps only so fast.
fn speed_of_motors(s: &Settings, axis: usize, legal: Legal) -> Legal {
    let fastest = ranges::STEP_RATE / s.finest(axis);
    Legal { most: legal.most.min(fastest.to_bits().into()), ..legal }
}

/// M92: the motor that makes the most steps of the axis has the same range.
fn resolution_of_motors(s: &Settings, axis: usize, legal: Legal) -> Legal {
    let times = s.mechanism.most_times(axis).max(1).unsigned_abs();
    Legal { most: legal.most / i64::from(times), ..legal }
}

/// M92: axes that share motors have one step. Speeds fall with finer steps, because the step rate of a motor is
/// limited.
fn check_resolutions(_: &PlainWords, s: &mut Settings, _: &mut Notices) -> Ending {
    if let Err(axes) = s.check_shared_motors() {
        return Ending::Refusal(Remark::SharedMotors(axes));
    }
    let mut is_lowered = false;
    let mut lower = |speed: &mut MmPerSec, most: MmPerSec| {
        is_lowered |= *speed > most;
        *speed = most.min(*speed);
    };
    for number in 0..4 {
        let most = ranges::STEP_RATE / s.finest(number);
        if let Some(axis) = s.axes.get_mut(number) {
            lower(&mut axis.max_speed, most);
        }
        // A belt motor is as fast as x and y allow.
        if number < 2 {
            lower(&mut s.motor_max_speed, most);
        }
    }
    if is_lowered { Ending::Remark(Remark::Lowered) } else { Ending::Done }
}

/// M205: J sets junction deviation. A jerk of X or Y without J is a square-corner velocity, because a corner of 90
/// degrees changes the speed of each axis by exactly that. So the lesser of both counts; Y alone leaves what X has set
/// if that is less.
fn choose_corner_rule(words: &PlainWords, s: &mut Settings, modal: &Modal, clamps: &mut Clamps) {
    let corner = if let Some(number) = words.number("J") {
        let old = if let CornerRule::JunctionDeviation(old) = s.corner { Some(old) } else { None };
        let legal = clamps.length_of(modal, ["M205", "J"], number, ranges::TOLERANCE, old);
        legal.map(CornerRule::JunctionDeviation)
    } else if let Some((number, letter)) = lesser_jerk(words) {
        let old = if let CornerRule::SquareCorner(old) = s.corner { Some(old) } else { None };
        let legal = clamps.length_of(modal, ["M205", letter], number, ranges::SPEED, old);
        let most = old.filter(|_| words.number("X").is_none()).unwrap_or(MmPerSec::MAX);
        legal.map(|legal| CornerRule::SquareCorner(legal.min(most)))
    } else {
        None
    };
    s.corner = corner.unwrap_or(s.corner);
}

/// The lesser of the jerks of X and Y, with its letter.
fn lesser_jerk(words: &PlainWords) -> Option<(Number, &'static str)> {
    let jerks = ["X", "Y"].into_iter().filter_map(|letter| Some((words.number(letter)?, letter)));
    jerks.min()
}

/// M205: the words that do not count are named once.
fn remark_on_corners(words: &PlainWords, s: &mut Settings, notices: &mut Notices) -> Ending {
    let [x, y, deviation, min_segment] = ["X", "Y", "J", "B"].map(|letter| words.number(letter));
    let is_left = |y: &Number| matches!(s.corner, CornerRule::SquareCorner(w) if y.value() > I32F32::from(w));
    let is_doubtful = deviation.and(x.or(y)).is_some() || y.filter(is_left).or(x.filter(is_left)).is_some();
    if !(is_doubtful || min_segment.is_some()) || !notices.give(Notice::Corners) {
        return Ending::Done;
    }
    Ending::Remark(Remark::Corners)
}

/// M301: a gain selects PID, as a number of M306 selects the model.
fn by_hotend_gains(_: &PlainWords, s: &mut Settings, _: &mut Notices) -> Ending {
    s.thermal.heaters.hotend.control = Control::Pid;
    Ending::Done
}

/// M304: the same.
fn by_bed_gains(_: &PlainWords, s: &mut Settings, _: &mut Notices) -> Ending {
    s.thermal.heaters.bed.control = Control::Pid;
    Ending::Done
}
