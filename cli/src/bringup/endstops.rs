//! Endstops: stuck, dead, or in each other's place.

use super::guide::{Failure, Found, Guide};
use super::step_error::StepError;

const PRESSED: Failure = Failure {
    what: "reads pressed although nothing touches it.",
    cure: "move the axis off its switch; else plug it in, or invert it in the machine file (endstops.*: `!` before the connector).",
};
const DEAD: Failure = Failure {
    what: "does not read pressed.",
    cure: "check its plug and its two wires; invert it in the machine file (endstops.*) if it reads pressed when let go.",
};
const SWAPPED: Failure = Failure {
    what: "another input reads pressed.",
    cure: "exchange the two plugs, or their connectors in the machine file (endstops.*).",
};
const STUCK: Failure =
    Failure { what: "stays pressed when it is let go.", cure: "free its lever; then check its wires." };

pub(super) const FAILURES: &[&Failure] = &[&PRESSED, &DEAD, &SWAPPED, &STUCK];

/// A line of M119: the input, and whether it is pressed.
fn inputs(heard: &[String]) -> Vec<(String, bool)> {
    let input = |line: &String| {
        let (name, state) = line.split_once(": ")?;
        match state {
            "TRIGGERED" => Some((name.to_owned(), true)),
            "open" => Some((name.to_owned(), false)),
            _ => None,
        }
    };
    heard.iter().filter_map(input).collect()
}

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    guide.owner.wait("endstops begin", "Move every axis by hand until it touches no switch")?;
    let before = inputs(&guide.ask("M119")?);
    found.problems.extend(before.iter().filter(|(_, pressed)| *pressed).map(|(name, _)| PRESSED.of(name)));
    let is_pressed = |state: &[(String, bool)], name: &str| state.iter().any(|(other, on)| other == name && *on);
    if guide.owner.is_absent() {
        found.note("not pressed by hand");
        return Ok(found);
    }
    for (name, was_pressed) in &before {
        let axis = name.split('_').next().unwrap_or_default().to_owned();
        let key = if name == "z_probe" { "probe".to_owned() } else { axis };
        guide.owner.wait(&format!("endstops press {key}"), &format!("Press the switch {name} by hand and hold it"))?;
        let held = inputs(&guide.ask("M119")?);
        guide.owner.wait(&format!("endstops release {key}"), "Let it go")?;
        let after = inputs(&guide.ask("M119")?);
        let fresh =
            held.iter().filter(|(other, on)| *on && !is_pressed(&before, other)).map(|(other, _)| other.as_str());
        let others: Vec<_> = fresh.filter(|other| other != name).collect();
        if !others.is_empty() {
            found.problems.push(SWAPPED.of(&format!("{name} (it is {})", others.join(", "))));
        } else if *was_pressed {
            // It has its problem already.
        } else if !is_pressed(&held, name) {
            found.problems.push(DEAD.of(name));
        } else if is_pressed(&after, name) {
            found.problems.push(STUCK.of(name));
        } else {
            found.note(format!("{name}: open, pressed, open"));
        }
    }
    Ok(found)
}
