//! Thermistors: open, shorted, of another kind, or in each other's place.

use super::guide::{Failure, Found, Guide, the};
use super::step_error::StepError;
use corehbot::connectors::{Heater, Sensor};
use std::time::{Duration, Instant};

const OPEN: Failure =
    Failure { what: "its sensor is open.", cure: "plug it in, or mend its wire; then do this again." };
const SHORTED: Failure =
    Failure { what: "its sensor is shorted.", cure: "look for bare wires at the block and at the plug." };
const MUTE: Failure = Failure {
    what: "its sensor has no reading.",
    cure: "check which connector the machine file names (heaters.*.sensor), and the sensor's plug.",
};
const ODD: Failure = Failure {
    what: "this is not the room's temperature.",
    cure: "let everything cool; if it stays, set the sensor's kind (heaters.*.thermistor) and check its plug.",
};
const SWAPPED: Failure = Failure {
    what: "another sensor follows its warmth.",
    cure: "exchange the two plugs, or their names in the machine file (heaters.*.sensor).",
};
const UNMOVED: Failure = Failure {
    what: "its sensor does not follow a warm hand.",
    cure: "check that the sensor sits in its hole, and which plug is where.",
};

pub(super) const FAILURES: &[&Failure] = &[&OPEN, &SHORTED, &MUTE, &ODD, &SWAPPED, &UNMOVED];

/// A room, in C.
const ROOM: std::ops::RangeInclusive<f64> = 5.0..=45.0;

/// Sensors in one room agree within this, in K: two thermistors of 5 % and a converter of 12 bits.
const APART: f64 = 6.0;

/// A hand warms a sensor by this at least, in K: ten times the noise of a reading.
const RISE: f64 = 2.0;

/// A sensor that has more than this, in C, is hardly warmed by a hand of 33 C.
const COOL: f64 = 30.0;

/// It does so within this time, at a board that is as fast as it should be.
const PATIENCE: Duration = Duration::from_secs(25);

/// Between two looks.
const LOOK: Duration = Duration::from_millis(400);

/// Shares of the reference, of 65,536, beyond which a thermistor is open or shorted. Of 100 kOhm under 4.7 kOhm they
/// are -40 C and 600 C.
const OPEN_ABOVE: u32 = 65_300;
const SHORTED_BELOW: u32 = 500;

pub(super) fn run(guide: &mut Guide) -> Result<Found, StepError> {
    let mut found = Found::default();
    let cold = guide.temperatures()?;
    if cold.is_empty() {
        found.note("no heaters, no thermistors");
        return Ok(found);
    }
    let shares = guide.ask("M122")?;
    for (heater, celsius) in &cold {
        match celsius {
            Some(celsius) => found.note(format!("{}: {celsius:.1} C in the cold", heater.name())),
            None => {
                let sensor = guide.machine.thermal.heater(*heater).sensor;
                let failure = match share(&shares, sensor) {
                    Some(OPEN_ABOVE..) => &OPEN,
                    Some(..SHORTED_BELOW) => &SHORTED,
                    _ => &MUTE,
                };
                found.problems.push(failure.of(heater.name()));
            }
        }
    }
    let read: Vec<_> = cold.iter().filter_map(|(heater, celsius)| Some((*heater, (*celsius)?))).collect();
    let middle = median(read.iter().map(|(_, celsius)| *celsius).collect());
    for (heater, celsius) in &read {
        if !ROOM.contains(celsius) || (celsius - middle).abs() > APART {
            found.problems.push(ODD.of(&format!("{}, {celsius:.1} C", heater.name())));
        }
    }
    // A sensor that has followed its own hand is no other's, though it may be on its way for a while.
    let mut proven = Vec::new();
    for (heater, _) in read {
        if warm(guide, heater, &proven, &mut found)? {
            proven.push(heater);
        }
    }
    Ok(found)
}

/// The owner warms a sensor; which one rises, apart from those that are proven? Returns whether it is this one.
fn warm(guide: &mut Guide, heater: Heater, proven: &[Heater], found: &mut Found) -> Result<bool, StepError> {
    let name = heater.name();
    if guide.owner.is_absent() {
        found.note(format!("{name}: not warmed by hand"));
        return Ok(false);
    }
    let mut before = guide.temperatures()?;
    let own = before.iter().find(|(other, _)| *other == heater).and_then(|(_, celsius)| *celsius);
    if let Some(celsius) = own.filter(|celsius| *celsius > COOL) {
        let request = format!("The sensor of {} has {celsius:.1} C. Let it cool below {COOL} C", the(heater));
        guide.owner.wait(&format!("sensors cool {name}"), &request)?;
        before = guide.temperatures()?;
    }
    guide.owner.wait(&format!("sensors {name}"), &format!("Hold the sensor of {} in a warm hand", the(heater)))?;
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE.max(guide.board.patience) {
        guide.owner.look_at_stop()?;
        let now = guide.temperatures()?;
        let rises =
            now.iter().zip(&before).filter_map(|((heater, now), (_, before))| Some((*heater, (*now)? - (*before)?)));
        let most = rises.filter(|(heater, _)| !proven.contains(heater)).max_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((risen, kelvin)) = most.filter(|(_, kelvin)| *kelvin >= RISE) {
            let is_own = risen == heater;
            if is_own {
                found.note(format!("{name}: follows a warm hand by {kelvin:.1} K"));
            } else {
                found.problems.push(SWAPPED.of(&format!("{name} (now it is {})", risen.name())));
            }
            return Ok(is_own);
        }
        std::thread::sleep(LOOK);
    }
    found.problems.push(UNMOVED.of(name));
    Ok(false)
}

/// A sensor's share of the reference in the lines of M122.
fn share(heard: &[String], sensor: Sensor) -> Option<u32> {
    let (_, name) = Sensor::ALL.into_iter().find(|(known, _)| *known == sensor)?;
    let words = heard.iter().find_map(|line| line.strip_prefix(&format!("echo:sensor {name} ")))?;
    words.split('/').next()?.parse().ok()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or_default()
}
