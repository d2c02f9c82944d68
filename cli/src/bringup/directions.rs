//! Directions: right is more X, back is more Y, and the nozzle leaves the bed with more Z.

use super::direction_words::{Seen, read_seen, words};
use super::guide::{Failure, Found, Guide};
use super::step_error::StepError;
use corehbot::settings::AxisEnd;

const OTHER: Failure = Failure {
    what: "it went elsewhere.",
    cure: "prints would be mirrored. Reverse every motor of this axis in [motors], and name the other end of its switch \
           (homing.*.end). If another axis moved, do the step of the motors again.",
};
const UNHOMED: Failure = Failure { what: "the board did not move it.", cure: "do the step of homing first." };

pub(super) const FAILURES: &[&Failure] = &[&OTHER, &UNHOMED];

/// How far, in mm, and how fast, in mm/min.
const WAY: i32 = 10;
const FEED: [i32; 3] = [1200, 1200, 300];

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let ends = guide.machine.endstops.to_array().map(|endstop| endstop.end);
    for (axis, end) in ends.into_iter().enumerate() {
        let letter = ['X', 'Y', 'Z'][axis];
        // Away from its switch.
        let sign: i8 = if end == AxisEnd::Min { 1 } else { -1 };
        let mut expected = [0; 3];
        expected[axis] = sign;
        let key = letter.to_ascii_lowercase();
        let begin = format!("{letter} moves by {} mm now", i32::from(sign) * WAY);
        guide.owner.wait(&format!("directions start {key}"), &begin)?;
        guide.ask("G91")?;
        let mut heard = guide.ask(&format!("G1 {letter}{} F{}", i32::from(sign) * WAY, FEED[axis]))?;
        heard.extend(guide.ask("M400")?);
        guide.ask("G90")?;
        if let Some(why) = heard.iter().find(|line| line.starts_with("echo:") || line.starts_with("Error:")) {
            found.problems.push(UNHOMED.of(&format!("{letter}, {why}")));
            continue;
        }
        let question =
            "Where did the tool go? right, left, back, front, apart (nozzle from bed), closer, or two of them";
        let seen = guide.owner.ask(&format!("directions {key}"), question, &words(expected), read_seen)?;
        if seen == Seen::Way(expected) {
            found.note(format!("{letter}: {}", words(expected)));
        } else {
            found.problems.push(OTHER.of(&format!("{letter}, expected {}", words(expected))));
        }
    }
    Ok(found)
}
