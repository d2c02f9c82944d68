//! Plugs: what a builder may have got wrong, between the board and the machine. Plugs sit in each other's places, are
//! turned round, or have no contact. One row of [`KINDS`] is one kind of mistake; the grammar and its errors follow it.
//!
//! The firmware's steps are those of the drivers, and so is the trace. The machine turns what hangs on them.

use corehbot::motors::{EndstopSet, MOTORS, Motor, MotorSet};
use corehbot::settings::Settings;
use std::fmt;

/// The switches that may be wrong, by their names in machine files.
const SWITCHES: [(&str, EndstopSet); 4] =
    [("x", EndstopSet::X), ("y", EndstopSet::Y), ("z", EndstopSet::Z), ("probe", EndstopSet::PROBE)];

/// The motor at the end of a driver's wires.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Wire {
    motor: Motor,
    is_reversed: bool,
    is_dead: bool,
}

/// The switch at an input.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Contact {
    Switch(EndstopSet),
    Stuck,
    Dead,
}

/// What hangs on each driver and each input.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Plugs {
    wires: [Wire; MOTORS],
    contacts: [Contact; SWITCHES.len()],
    /// Drivers that do not answer.
    pub silent: MotorSet,
}

impl Default for Plugs {
    fn default() -> Self {
        let wire = |motor| Wire { motor, is_reversed: false, is_dead: false };
        let contacts = SWITCHES.map(|(_, switch)| Contact::Switch(switch));
        Self { wires: Motor::ALL.map(wire), contacts, silent: MotorSet::NONE }
    }
}

/// What a mistake is made with.
#[derive(Clone, Copy)]
enum Does {
    Motor(fn(&mut Plugs, usize)),
    Motors(fn(&mut Plugs, usize, usize)),
    Switch(fn(&mut Plugs, usize)),
    Switches(fn(&mut Plugs, usize, usize)),
}

/// A kind of mistake.
#[derive(Clone, Copy)]
pub struct MistakeKind {
    /// Its name.
    pub name: &'static str,
    /// Its description for people.
    pub says: &'static str,
    does: Does,
}

const fn kind(name: &'static str, says: &'static str, does: Does) -> MistakeKind {
    MistakeKind { name, says, does }
}

/// Every kind.
pub const KINDS: [MistakeKind; 7] = [
    kind(
        "swap-motors",
        "two motors in each other's place",
        Does::Motors(|plugs, a, b| {
            plugs.wires.swap(a, b);
        }),
    ),
    kind("reverse-motor", "a motor's plug turned round", Does::Motor(|plugs, a| plugs.wires[a].is_reversed ^= true)),
    kind("dead-motor", "a motor without contact", Does::Motor(|plugs, a| plugs.wires[a].is_dead = true)),
    kind(
        "silent-driver",
        "a driver that does not answer",
        Does::Motor(|plugs, a| plugs.silent = plugs.silent.with(MotorSet::of(Motor::ALL[a]))),
    ),
    kind(
        "swap-endstops",
        "two switches in each other's place",
        Does::Switches(|plugs, a, b| {
            plugs.contacts.swap(a, b);
        }),
    ),
    kind("stuck-endstop", "a switch that always reads pressed", {
        Does::Switch(|plugs, a| plugs.contacts[a] = Contact::Stuck)
    }),
    kind("dead-endstop", "a switch that never reads pressed", {
        Does::Switch(|plugs, a| plugs.contacts[a] = Contact::Dead)
    }),
];

/// Why a text does not describe a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MistakeError {
    /// The kind is unknown.
    MistakeKind(String),
    /// This kind is made with other things: as many of them, with these names.
    Of(&'static str, usize, String),
}

impl fmt::Display for MistakeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MistakeKind(text) => {
                let known: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
                write!(f, "`{text}` is not a mistake; expected {}", known.join(", "))
            }
            Self::Of(kind, 1, names) => write!(f, "expected {kind}: and one of {names}"),
            Self::Of(kind, count, names) => write!(f, "expected {kind}: and {count} different of {names}, as in A,B"),
        }
    }
}

impl std::error::Error for MistakeError {}

impl Plugs {
    /// Makes the mistake `KIND:NAME` or `KIND:NAME,NAME` on a machine with these settings.
    ///
    /// # Errors
    /// There is no such mistake.
    pub fn make(&mut self, text: &str, settings: &Settings) -> Result<(), MistakeError> {
        let (name, parts) = text.split_once(':').unwrap_or((text, ""));
        let kind =
            KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| MistakeError::MistakeKind(name.to_owned()))?;
        let motors: Vec<_> = settings.motors().map(|(motor, name)| (name.to_string(), motor.index())).collect();
        let switches: Vec<_> = SWITCHES.iter().enumerate().map(|(at, (name, _))| ((*name).to_owned(), at)).collect();
        let (known, count) = match kind.does {
            Does::Motor(_) => (motors, 1),
            Does::Motors(_) => (motors, 2),
            Does::Switch(_) => (switches, 1),
            Does::Switches(_) => (switches, 2),
        };
        let find = |part: &str| known.iter().find(|(name, _)| name == part).map(|(_, at)| *at);
        let found: Option<Vec<usize>> = parts.split(',').map(find).collect();
        match (kind.does, found.as_deref()) {
            (Does::Motor(does) | Does::Switch(does), Some([a])) => does(self, *a),
            (Does::Motors(does) | Does::Switches(does), Some([a, b])) if a != b => does(self, *a, *b),
            _ => {
                let names: Vec<_> = known.into_iter().map(|(name, _)| name).collect();
                return Err(MistakeError::Of(kind.name, count, names.join(", ")));
            }
        }
        Ok(())
    }

    /// The motors that turn when the drivers of `steps` step, and those of them that turn forward.
    #[must_use]
    pub fn turned(&self, steps: MotorSet, forward: MotorSet) -> (MotorSet, MotorSet) {
        let (mut turned, mut ahead) = (MotorSet::NONE, MotorSet::NONE);
        for (driver, wire) in Motor::ALL.into_iter().zip(&self.wires) {
            if steps.has(driver) && !wire.is_dead {
                turned = turned.with(MotorSet::of(wire.motor));
                if forward.has(driver) != wire.is_reversed {
                    ahead = ahead.with(MotorSet::of(wire.motor));
                }
            }
        }
        (turned, ahead)
    }

    /// The inputs that read as pressed while these switches are.
    #[must_use]
    pub fn read(&self, pressed: EndstopSet) -> EndstopSet {
        let is_pressed = |contact: &Contact| match contact {
            Contact::Switch(switch) => pressed.has(*switch),
            Contact::Stuck => true,
            Contact::Dead => false,
        };
        let inputs = SWITCHES.iter().zip(&self.contacts).filter(|(_, contact)| is_pressed(contact));
        inputs.fold(EndstopSet::NONE, |set, ((_, input), _)| set.with(*input))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype::{BELT, M1, M8};

    fn plugs(mistakes: &[&str]) -> Plugs {
        let mut plugs = Plugs::default();
        for mistake in mistakes {
            plugs.make(mistake, &Settings::prototype()).unwrap();
        }
        plugs
    }

    #[test]
    fn straight_plugs_change_nothing() {
        let straight = Plugs::default();
        for bits in 0..=u8::MAX {
            assert_eq!(straight.turned(MotorSet(bits), MotorSet(!bits)), (MotorSet(bits), MotorSet::NONE));
        }
        assert_eq!(straight.read(EndstopSet::ALL), EndstopSet::ALL);
        assert_eq!(straight.read(EndstopSet::Y), EndstopSet::Y);
    }

    #[test]
    fn mistakes_add_up() {
        let wrong = plugs(&["swap-motors:m1,m8", "reverse-motor:m1", "dead-motor:m4"]);
        let [m1, m8] = [M1, M8].map(MotorSet::of);
        assert_eq!(wrong.turned(m1, m1), (m8, MotorSet::NONE), "driver 1 turns motor 8 backward");
        assert_eq!(wrong.turned(m8, m8), (m1, m1));
        assert_eq!(wrong.turned(BELT, MotorSet::NONE).0.0, 0b1101);
        let wrong = plugs(&["swap-endstops:x,y", "stuck-endstop:z"]);
        assert_eq!(wrong.read(EndstopSet::X), EndstopSet::Y.with(EndstopSet::Z));
        assert_eq!(plugs(&["dead-endstop:x"]).read(EndstopSet::ALL).and(EndstopSet::X), EndstopSet::NONE);
    }

    /// Two kinds with one name, or one that does nothing, would be found here.
    #[test]
    fn every_kind_has_a_name_of_its_own_and_changes_something() {
        for kind in &KINDS {
            assert_eq!(KINDS.iter().filter(|other| other.name == kind.name).count(), 1, "{}", kind.name);
            let parts = match kind.does {
                Does::Motor(_) => "m4",
                Does::Motors(_) => "m4,m11",
                Does::Switch(_) => "y",
                Does::Switches(_) => "x,y",
            };
            assert_ne!(plugs(&[&format!("{}:{parts}", kind.name)]), Plugs::default(), "{}", kind.name);
        }
    }

    #[test]
    fn what_is_no_mistake_is_answered_with_those_that_there_are() {
        let wrong = |text: &str| Plugs::default().make(text, &Settings::prototype()).unwrap_err().to_string();
        assert!(wrong("swap:m1,m4").starts_with("`swap` is not a mistake; expected swap-motors, reverse-motor, "));
        assert_eq!(wrong("dead-motor:m9"), "expected dead-motor: and one of m1, m4, m8, m11, z1, z2, e0");
        for text in ["swap-motors:m1", "swap-motors:m1,m1", "swap-motors:m1,m4,m8", "swap-motors"] {
            assert!(wrong(text).starts_with("expected swap-motors: and 2 different of m1, "), "{text}");
        }
        assert_eq!(wrong("stuck-endstop:m1"), "expected stuck-endstop: and one of x, y, z, probe");
    }
}
