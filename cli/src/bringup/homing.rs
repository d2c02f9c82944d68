//! Homing: one axis after the other, slowly, with a hand at the key that stops everything.

use super::guide::{Failure, Found, Guide};
use super::step_error::StepError;
use corehbot::settings::HomedAxis;

const MISSED: Failure = Failure {
    what: "did not find its switch.",
    cure: "do the steps of the endstops and of the motors again; the axis must be free over its whole length.",
};
const AWAY: Failure = Failure {
    what: "did not go gently to its switch.",
    cure: "if it went away from it, the machine file names the wrong end (homing.*.end), or the step of the motors is not done.",
};
const STOPPED: Failure =
    Failure { what: "was stopped by you.", cure: "see why; the board has restarted, so do this step again." };

pub(super) const FAILURES: &[&Failure] = &[&MISSED, &AWAY, &STOPPED];

/// Speeds at which a hand is quicker than the machine, in mm/s of x, y and z.
const SLOW: [f64; 3] = [25.0, 25.0, 5.0];

const LETTERS: [char; 3] = ['X', 'Y', 'Z'];

/// M203 with these speeds.
fn speeds(of: [f64; 3]) -> String {
    let words = LETTERS.iter().zip(of).map(|(letter, speed)| format!(" {letter}{speed}"));
    format!("M203{}", words.collect::<String>())
}

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let axes = guide.machine.axes;
    let own = [axes.x, axes.y, axes.z].map(|axis| axis.max_speed.to_num::<f64>());
    let slow: [f64; 3] = std::array::from_fn(|axis| own[axis].min(SLOW[axis]));
    guide.ask(&speeds(slow))?;
    let found = home(guide);
    // Never are the slow speeds stored: the step after next sends M500.
    match &found {
        Ok(_) => drop(guide.ask(&speeds(own))?),
        Err(_) => guide.board.tell(&speeds(own))?,
    }
    found
}

/// Why a homing failed, in a line that says so: an error, or the end of a job.
fn failure(line: &str) -> Option<&str> {
    const FAILED: &str = "homing failed: ";
    let at = line.to_ascii_lowercase().find(FAILED).map(|at| at + FAILED.len());
    at.and_then(|at| line.get(at..)).or_else(|| line.strip_prefix("Error:"))
}

fn home(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    guide.owner.tell("  Enter stops everything at once while an axis moves.");
    for axis in guide.machine.homing_order {
        let letter = match axis {
            HomedAxis::X => 'X',
            HomedAxis::Y => 'Y',
            HomedAxis::Z => 'Z',
        };
        let key = letter.to_ascii_lowercase();
        guide.owner.wait(&format!("homing start {key}"), &format!("{letter} goes to its switch now"))?;
        match guide.board.ask_watched(&format!("G28 {letter}"), &guide.owner) {
            Ok(heard) => {
                if let Some(why) = heard.iter().find_map(|line| failure(line)) {
                    found.problems.push(MISSED.of(&format!("{letter}, {why}")));
                    // It has ended a job, after which heating is refused until someone goes on.
                    guide.ask("M108")?;
                    return Ok(found);
                }
            }
            Err(StepError::Halted(why)) => {
                guide.board.restart(&guide.owner)?;
                found.problems.push(STOPPED.of(&format!("{letter}, {why}")));
                return Ok(found);
            }
            Err(trouble) => return Err(trouble),
        }
        if guide
            .owner
            .agrees(&format!("homing met {key}"), &format!("Did {letter} go to its switch and stop there?"))?
        {
            found.note(format!("{letter} met its switch"));
        } else {
            found.problems.push(AWAY.of(&letter.to_string()));
            return Ok(found);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_is_found_wherever_it_stands() {
        for line in ["Error:Homing failed: X endstop open", "echo:print ended: homing failed: X endstop open"] {
            assert_eq!(failure(line), Some("X endstop open"));
        }
        assert_eq!(failure("Error:driver of motor m1 does not answer"), Some("driver of motor m1 does not answer"));
        assert_eq!(failure("echo:motion before homing"), None);
    }
}
