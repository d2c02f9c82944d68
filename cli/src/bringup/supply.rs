//! Supply voltages: no board of this firmware measures them, so the owner does.

use super::guide::{Failure, Found, Guide};
use super::step_error::StepError;

const OFF: Failure = Failure {
    what: "more than a twentieth off.",
    cure: "set the supply's trimmer, or take another supply; check its terminals for a loose wire.",
};

pub(super) const FAILURES: &[&Failure] = &[&OFF];

/// What is measured, and the values that it should have: supplies of 12 and 24 V, and the rails of every board.
const RAILS: [(&str, &str, &[f64]); 3] = [
    ("supply", "the voltage at the board's power terminals", &[12.0, 24.0]),
    ("5v", "the voltage at a 5 V pin of the board", &[5.0]),
    ("3v3", "the voltage at a 3.3 V pin, the reference of the thermistors", &[3.3]),
];

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    for (key, what, right) in RAILS {
        let question = format!("Measure {what}, in V");
        let volts = guide.owner.ask(&format!("supply {key}"), &question, "not measured", |answer| {
            if answer == "not measured" { Some(None) } else { volts(answer).map(Some) }
        })?;
        let Some(volts) = volts else {
            found.note(format!("{what}: not measured"));
            continue;
        };
        found.note(format!("{what}: {volts} V"));
        if !right.iter().any(|right| (volts / right - 1.0).abs() <= 0.05) {
            found.problems.push(OFF.of(&format!("{what}, {volts} V")));
        }
    }
    Ok(found)
}

/// A voltage, with a point or a comma.
fn volts(answer: &str) -> Option<f64> {
    let number = answer.trim_end_matches('v').trim().replace(',', ".");
    number.parse().ok().filter(|volts| (0.0..=100.0).contains(volts))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voltages_are_read_as_people_write_them() {
        assert_eq!(
            ["24", "24.1 v", "23,9v", "nan", "-1", "much"].map(volts),
            [Some(24.0), Some(24.1), Some(23.9), None, None, None]
        );
    }
}
