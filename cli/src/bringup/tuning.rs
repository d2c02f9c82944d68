//! Heater tuning: M303 for every heater, and M500.

use super::guide::{Failure, Found, Guide, the};
use super::step_error::StepError;
use corehbot::connectors::Heater;

const FAILED: Failure = Failure {
    what: "the tuning did not succeed.",
    cure: "see that no draught and no part fan cools it, and that its power in the machine file is right; then do this step \
           again.",
};
const UNSTORED: Failure = Failure {
    what: "the board did not store its settings.",
    cure: "M504 says why; the gains are lost at the next reset.",
};

pub(super) const FAILURES: &[&Failure] = &[&FAILED, &UNSTORED];

/// The words of M303 for a heater: E, and a temperature of use.
const fn words(heater: Heater) -> (i8, u16) {
    match heater {
        Heater::Hotend => (0, 200),
        Heater::Bed => (-1, 60),
        Heater::Chamber => (-2, 45),
    }
}

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let mut has_tuned = false;
    for heater in guide.heaters() {
        let (name, (e, celsius)) = (heater.name(), words(heater));
        let question = format!("Heat {} to {celsius} C now, for some minutes?", the(heater));
        if !guide.owner.agrees(&format!("tuning {name}"), &question)? {
            found.note(format!("{name}: not tuned"));
            continue;
        }
        let heard = match guide.ask(&format!("M303 E{e} S{celsius} U1")) {
            Ok(heard) => heard,
            Err(StepError::Halted(why)) => {
                guide.board.restart(&guide.owner)?;
                found.problems.push(FAILED.of(&format!("{name}, {why}")));
                return Ok(found);
            }
            Err(trouble) => return Err(trouble),
        };
        if heard.iter().any(|line| line.starts_with("PID Autotune finished")) {
            has_tuned = true;
            let about = format!("echo:{name}: ");
            let told = heard.iter().filter_map(|line| line.strip_prefix(&about)).filter(|words| words.contains("J/K"));
            found.note(format!("{name}: {}", told.collect::<Vec<_>>().join(", ")));
        } else {
            let why = heard.iter().rev().find(|line| !line.starts_with(' ')).cloned().unwrap_or_default();
            found.problems.push(FAILED.of(&format!("{name}, {why}")));
        }
    }
    if has_tuned {
        let heard = guide.ask("M500")?;
        if heard.iter().any(|line| line.contains("Settings Stored")) {
            found.note("stored (M500)");
        } else {
            found.problems.push(UNSTORED.of(&heard.join(", ")));
        }
    }
    Ok(found)
}
