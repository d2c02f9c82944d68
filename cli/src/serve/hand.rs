//! Hand: what a person does to the simulated machine, in lines on standard input. So the first hour with a board can be
//! tried without one (`corehbot bringup`).
//!
//! | line | does |
//! |---|---|
//! | `press x` | presses a switch (x, y, z, probe), and lets go of any other one |
//! | `let go` | lets go of it |
//! | `warm hotend` | holds a heater's sensor (hotend, bed, chamber) until it is as warm as a hand |
//! | `reset` | presses the board's reset button |
//! | `off` | switches the printer off |

use corehbot::connectors::Heater;
use corehbot::motors::EndstopSet;
use std::io::BufRead as _;
use std::sync::mpsc::{Receiver, channel};

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

/// Every line, and its act.
const ACTS: [(&str, Act); 10] = [
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

/// The lines that have come.
#[derive(Debug)]
pub struct Hand(Receiver<String>);

impl Hand {
    /// A hand that does what the lines say that come here.
    #[must_use]
    pub const fn at(lines: Receiver<String>) -> Self {
        Self(lines)
    }

    /// Reads standard input from now on.
    #[must_use]
    pub fn at_input() -> Self {
        let (send, receive) = channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
                if send.send(line).is_err() {
                    return;
                }
            }
        });
        Self(receive)
    }

    /// The acts of the lines that have come. An unknown line is answered with those that there are.
    pub fn acts(&self) -> impl Iterator<Item = Act> {
        self.0.try_iter().filter_map(|line| {
            let found = ACTS.iter().find(|(known, _)| *known == line.trim());
            if found.is_none() {
                let known: Vec<_> = ACTS.iter().map(|(known, _)| *known).collect();
                eprintln!("corehbot: `{}` is not what a hand does; expected {}", line.trim(), known.join(", "));
            }
            found.map(|(_, act)| *act)
        })
    }
}
