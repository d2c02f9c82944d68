//! Motor drivers: whether each one answers over its wire, and with what.

use super::guide::{Failure, Found, Guide, Problem};
use super::step_error::StepError;

const FAULTY: Failure = Failure {
    what: "its driver has a fault.",
    cure: "switch off first. Check that it sits straight in its socket, the jumpers for UART (the board's README), and the \
           motor supply.",
};

pub(super) const FAILURES: &[&Failure] = &[&FAULTY];

/// What a driver says of itself when it is well.
const WELL: [&str; 2] = ["configured, ", "not configured yet, "];

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let heard = guide.ask("M122")?;
    for line in &heard {
        let Some((name, words)) = line.strip_prefix("Driver ").and_then(|line| line.split_once(": ")) else { continue };
        if words.starts_with("no UART") {
            found.note(format!("{name}: {words}; set its current by its potentiometer before it gets power"));
        } else if WELL.iter().any(|well| words.starts_with(well)) {
            found.note(format!("{name}: answers, {words}"));
        } else {
            found.problems.push(Problem { what: format!("{name}: {words}"), cure: FAULTY.cure.to_owned() });
        }
    }
    if found.notes.is_empty() && found.problems.is_empty() {
        found.problems.push(FAULTY.of("M122 names no driver"));
    }
    Ok(found)
}
