//! Heaters: the firmware's self-test warms each one by some degrees, at a power and for a time that its model allows.

use super::guide::{Failure, Found, Guide, STOPPED};
use super::step_error::StepError;
use corehbot::connectors::Heater;

const COLD: Failure = Failure {
    what: "no sensor got warmer.",
    cure: "switch off. Check the heater's wires, its fuse, and which output the machine file names (heaters.*.output).",
};
const SWAPPED: Failure = Failure {
    what: "another sensor got warmer.",
    cure: "switch off. Exchange the plugs of the heaters, or their outputs in the machine file (heaters.*.output).",
};
const UNTESTED: Failure = Failure {
    what: "the self-test gave no result.",
    cure: "let everything cool below 50 C, see that every sensor has a reading, and do this step again.",
};

pub(super) const FAILURES: &[&Failure] = &[&COLD, &SWAPPED, &UNTESTED, &STOPPED];

/// The words of a passed test.
const PASSED: &str = "echo:Self-test passed";

/// A rise that counts, in K, as in the self-test.
const RISE: f64 = 1.0;

/// Letters of heaters in reports of temperatures.
const LETTERS: [(&str, Heater); 3] = [("T", Heater::Hotend), ("B", Heater::Bed), ("C", Heater::Chamber)];

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let heaters = guide.heaters();
    if heaters.is_empty() {
        found.note("no heaters");
        return Ok(found);
    }
    guide
        .owner
        .wait("heaters begin", "Every heater gets warm by some degrees. Keep a hand at the plug of the mains")?;
    let mut readings: Vec<Vec<(Heater, f64)>> = Vec::new();
    let asked = guide.board.ask_and("SELF_TEST", &guide.owner, |_, line| {
        readings.extend(line.map(temperatures).filter(|all| !all.is_empty()));
        Ok(())
    });
    match asked {
        Ok(heard) if heard.iter().any(|line| line.starts_with(PASSED)) => {
            let names: Vec<_> = heaters.iter().map(|heater| heater.name()).collect();
            found.note(format!("each of {} warms its own sensor", names.join(", ")));
        }
        Ok(heard) => {
            let why = heard.into_iter().rev().find(|line| line.starts_with("echo:")).unwrap_or_default();
            found.problems.push(UNTESTED.of(why.trim_start_matches("echo:")));
        }
        Err(StepError::Halted(why)) => {
            guide.board.restart(&guide.owner)?;
            let tested = heaters.iter().find(|heater| why.contains(heater.name()));
            let risen = rises(&readings).into_iter().filter(|(_, kelvin)| *kelvin >= RISE);
            let most = risen.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(heater, _)| heater);
            found.problems.push(match (tested, most) {
                (Some(tested), Some(other)) if other != *tested => {
                    SWAPPED.of(&format!("{} (its output warms the sensor of {})", tested.name(), other.name()))
                }
                (Some(tested), None) => COLD.of(tested.name()),
                _ => STOPPED.of(&why),
            });
        }
        Err(trouble) => return Err(trouble),
    }
    Ok(found)
}

/// The temperatures in a line like ` T:25.00 /0.00 B:24.90 /0.00 T@:0`.
fn temperatures(line: &str) -> Vec<(Heater, f64)> {
    let word = |word: &str| {
        let (letter, number) = word.split_once(':')?;
        let (_, heater) = LETTERS.into_iter().find(|(known, _)| *known == letter)?;
        Some((heater, number.parse().ok()?))
    };
    line.split_whitespace().filter_map(word).collect()
}

/// By how much each sensor has risen in the last part of the test: since its lowest reading.
fn rises(readings: &[Vec<(Heater, f64)>]) -> Vec<(Heater, f64)> {
    let Some(last) = readings.last() else { return Vec::new() };
    let lowest = |heater: Heater| {
        let all = readings.iter().flatten().filter(|(other, _)| *other == heater).map(|(_, celsius)| *celsius);
        all.fold(f64::INFINITY, f64::min)
    };
    last.iter().map(|(heater, celsius)| (*heater, celsius - lowest(*heater))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_of_a_wait_are_read() {
        let line = " T:25.12 /0.00 B:24.90 /60.00 @:0 B@:64";
        assert_eq!(temperatures(line), [(Heater::Hotend, 25.12), (Heater::Bed, 24.9)]);
        assert_eq!(temperatures("echo:busy: processing"), []);
        let readings = [temperatures("T:25.0 B:25.5"), temperatures("T:24.5 B:25.0"), temperatures("T:24.75 B:28.0")];
        assert_eq!(rises(&readings), [(Heater::Hotend, 0.25), (Heater::Bed, 3.0)]);
    }
}
