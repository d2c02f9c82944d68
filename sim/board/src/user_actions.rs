//! Hand: what a person does to the simulated machine, in words. So the first hour with a board can be tried without
//! one.
//!
//! | words | do |
//! |---|---|
//! | `press x` | presses a switch (x, y, z, probe), and lets go of any other one |
//! | `let go` | lets go of it |
//! | `warm hotend` | holds a heater's sensor (hotend, bed, chamber) until it is as warm as a hand |
//! | `reset` | presses the board's reset button |
//! | `off` | switches the printer off |

use crate::world::World;
use corehbot::connectors::Heater;
use corehbot::motors::EndstopSet;

/// A hand, in C.
pub const WARM: f64 = 33.0;

/// Something that a hand does.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Act {
    /// Presses these switches, and lets go of all others.
    Press(EndstopSet),
    /// Holds the sensor of this heater until it has [`WARM`].
    Warm(Heater),
    /// Presses the reset button.
    Reset,
    /// Switches the printer off.
    Off,
}

/// All words, and their acts.
pub const ACTS: [(&str, Act); 10] = [
    ("press x", Act::Press(EndstopSet::X)),
    ("press y", Act::Press(EndstopSet::Y)),
    ("press z", Act::Press(EndstopSet::Z)),
    ("press probe", Act::Press(EndstopSet::PROBE)),
    ("let go", Act::Press(EndstopSet::NONE)),
    ("warm hotend", Act::Warm(Heater::Hotend)),
    ("warm bed", Act::Warm(Heater::Bed)),
    ("warm chamber", Act::Warm(Heater::Chamber)),
    ("reset", Act::Reset),
    ("off", Act::Off),
];

impl Act {
    /// The act of these words.
    #[must_use]
    pub fn called(words: &str) -> Option<Self> {
        ACTS.iter().find(|(known, _)| *known == words).map(|(_, act)| *act)
    }

    /// Does it, where a running world can. Its owner ends the world at a reset, and when it is switched off.
    pub fn touch(self, world: &mut World<'_>) {
        match self {
            Self::Press(switches) => world.press(switches),
            Self::Warm(heater) => {
                if let Some(plant) = world.heat().plant() {
                    plant.hold(heater, WARM);
                }
            }
            Self::Reset | Self::Off => {}
        }
    }
}
