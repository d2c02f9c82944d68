//! The bed and the probe of the simulated machine as commands define them: what differs from a flat bed and a sound
//! probe (`--bed`).
//!
//! By default the probe is where the machine's settings say. With `--bed offset.z=-1.1` it is elsewhere, and the
//! firmware has to find out.

use corehbot::settings::Settings;
use corehbot_rig::bed::BedSetup;
use corehbot_rig::bed::probe::ProbeModel;
use corehbot_rig::bed::screws::ScrewSetup;
use std::fmt;

/// A nozzle that was so far below the bed has damaged it, in mm: a probe's floor is 2 mm below the bed (Marlin,
/// `Z_PROBE_LOW_POINT`).
pub const FLOOR_MM: f64 = 2.0;

/// A key, and its legal values.
struct Key {
    name: &'static str,
    legal: [f64; 2],
    set: fn(&mut BedSetup, f64),
}

const fn key(name: &'static str, least: f64, most: f64, set: fn(&mut BedSetup, f64)) -> Key {
    Key { name, legal: [least, most], set }
}

/// Every key with a number.
const KEYS: [Key; 15] = [
    key("height", -20.0, 20.0, |bed, mm| bed.surface.height = mm),
    key("tilt.x", -0.1, 0.1, |bed, slope| bed.surface.tilt[0] = slope),
    key("tilt.y", -0.1, 0.1, |bed, slope| bed.surface.tilt[1] = slope),
    key("bowl", -5.0, 5.0, |bed, mm| bed.surface.bowl = mm),
    key("wave", -5.0, 5.0, |bed, mm| bed.surface.wave = mm),
    key("wave.length", 10.0, 5000.0, |bed, mm| bed.surface.wave_length = mm),
    key("play", 0.0, 1.0, |bed, mm| bed.screws.iter_mut().for_each(|screw| screw.play = mm)),
    key("offset.x", -200.0, 200.0, |bed, mm| bed.probe.offset[0] = mm),
    key("offset.y", -200.0, 200.0, |bed, mm| bed.probe.offset[1] = mm),
    key("offset.z", -20.0, 20.0, |bed, mm| bed.probe.offset[2] = mm),
    key("noise", 0.0, 1.0, |bed, mm| bed.probe.noise = mm),
    key("drift", -1.0, 1.0, |bed, mm| bed.probe.drift = mm),
    key("delay", 0.0, 1000.0, |bed, ms| bed.probe.delay_ms = ms),
    key("pulse", 0.1, 1000.0, |bed, pulse_ms| {
        if let ProbeModel::BlTouch { .. } = bed.probe.model {
            bed.probe.model = ProbeModel::BlTouch { pulse_ms };
        }
    }),
    key("seed", 0.0, 4_294_967_295.0, |bed, seed| bed.probe.seed = seed as u64),
];

/// The key of a screw with its place and its height.
const SCREW: &str = "screw";

/// Why a text describes no bed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BedError {
    /// It is no `KEY=VALUE`.
    Form(String),
    /// The key is unknown.
    Key(String),
    /// The value is no number, or is out of its range: the key, the range, the text.
    Value(&'static str, String, String),
    /// A screw is no `X/Y/HEIGHT`, or one too many.
    Screw(String),
}

impl fmt::Display for BedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Form(text) => write!(f, "`{text}` is not KEY=VALUE, such as tilt.x=0.0004"),
            Self::Key(text) => {
                let known: Vec<_> = KEYS.iter().map(|key| key.name).collect();
                write!(f, "`{text}` is not a key; expected {}, {SCREW}", known.join(", "))
            }
            Self::Value(key, legal, text) => write!(f, "{key}: `{text}` is not a number of {legal}"),
            Self::Screw(text) => write!(f, "`{text}` is not a screw: X/Y/HEIGHT in mm, for each motor of z, 4 at most"),
        }
    }
}

impl std::error::Error for BedError {}

/// The bed of `KEY=VALUE,...`, where it differs from the flat one of a machine.
///
/// # Errors
/// A key or value that is none.
pub fn read(text: &str, settings: &Settings) -> Result<BedSetup, BedError> {
    let mut bed = BedSetup::of(settings);
    let pairs = text.split(',').map(|pair| pair.trim().split_once('=').ok_or_else(|| BedError::Form(pair.to_owned())));
    let pairs: Vec<_> = pairs.collect::<Result<_, _>>()?;
    // Screws first: their play is for all of them.
    for (_, value) in pairs.iter().filter(|(name, _)| *name == SCREW) {
        let wrong = || BedError::Screw((*value).to_owned());
        let numbers: Option<Vec<f64>> = value.split('/').map(|number| number.parse().ok()).collect();
        let Some([x, y, height]) = numbers.as_deref() else { return Err(wrong()) };
        let is_near = |number: &f64, most: f64| number.abs() <= most;
        if !(is_near(x, 5000.0) && is_near(y, 5000.0) && is_near(height, 20.0)) {
            return Err(wrong());
        }
        bed.screws.push(ScrewSetup { at: [*x, *y], height: *height, play: 0.0 }).map_err(|_| wrong())?;
    }
    for (name, value) in pairs.into_iter().filter(|(name, _)| *name != SCREW) {
        let key = KEYS.iter().find(|key| key.name == name).ok_or_else(|| BedError::Key(name.to_owned()))?;
        let [least, most] = key.legal;
        let number = value.parse().ok().filter(|number| (least..=most).contains(number));
        let wrong = || BedError::Value(key.name, format!("{least} to {most}"), value.to_owned());
        (key.set)(&mut bed, number.ok_or_else(wrong)?);
    }
    Ok(bed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bed_is_what_its_keys_say() {
        let settings = Settings::prototype();
        let text = "tilt.x=0.0004,bowl=0.25,play=0.02,screw=-25/200/0.31,screw=455/200/-0.17,offset.z=-1.5,noise=0.005";
        let bed = read(text, &settings).unwrap();
        assert_eq!((bed.surface.tilt, bed.surface.bowl), ([0.0004, 0.0], 0.25));
        assert_eq!((bed.probe.offset[2], bed.probe.noise), (-1.5, 0.005));
        let screws = [([-25.0, 200.0], 0.31), ([455.0, 200.0], -0.17)];
        assert_eq!(bed.screws[..], screws.map(|(at, height)| ScrewSetup { at, height, play: 0.02 }));
    }

    #[test]
    fn what_is_no_bed_is_answered_with_what_there_is() {
        let wrong = |text: &str| read(text, &Settings::prototype()).unwrap_err().to_string();
        assert_eq!(wrong("tilt"), "`tilt` is not KEY=VALUE, such as tilt.x=0.0004");
        assert!(wrong("tilt=1").starts_with("`tilt` is not a key; expected height, tilt.x, tilt.y, bowl, "));
        for text in ["noise=nan", "noise=2", "noise=", "noise=-1"] {
            assert!(wrong(text).ends_with("is not a number of 0 to 1"), "{text}: {}", wrong(text));
        }
        let screw = "is not a screw: X/Y/HEIGHT in mm, for each motor of z, 4 at most";
        for text in ["screw=1/2", "screw=1/2/nan", "screw=1/2/3/4", &["screw=1/2/3"; 5].join(",")] {
            assert!(wrong(text).ends_with(screw), "{text}");
        }
    }

    /// Two keys with one name, or one that sets nothing, would be found here.
    #[test]
    fn every_key_has_a_name_of_its_own_and_sets_something() {
        let mut flat = BedSetup::of(&Settings::prototype());
        flat.probe.model = ProbeModel::BlTouch { pulse_ms: 10.0 };
        flat.screws.push(ScrewSetup { at: [0.0; 2], height: 0.0, play: 0.0 }).unwrap();
        for key in &KEYS {
            assert_eq!(KEYS.iter().filter(|other| other.name == key.name).count(), 1, "{}", key.name);
            let mut bed = flat.clone();
            (key.set)(&mut bed, key.legal[1]);
            assert_ne!(bed, flat, "{}", key.name);
        }
    }
}
