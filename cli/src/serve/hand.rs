//! Hand: what a person does to the simulated machine, in lines on standard input. So the first hour with a board can be
//! tried without one (`corehbot bringup`).
//!
//! | line | does |
//! |---|---|
//! | `press x` | presses a switch (x, y, z, probe), and lets go of any other one |
//! | `let go` | lets go of it |
//! | `warm hotend` | holds a heater's sensor (hotend, bed, chamber) until it is as warm as a hand |

use corehbot::connectors::Heater;
use corehbot::motors::EndstopSet;
use corehbot_sim::world::World;
use std::io::BufRead as _;
use std::sync::mpsc::{Receiver, channel};

/// A hand, in C.
const WARM: f64 = 33.0;

/// Something that a hand does.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Act {
    Press(EndstopSet),
    Warm(Heater),
}

/// Every line, and its act.
const ACTS: [(&str, Act); 8] = [
    ("press x", Act::Press(EndstopSet::X)),
    ("press y", Act::Press(EndstopSet::Y)),
    ("press z", Act::Press(EndstopSet::Z)),
    ("press probe", Act::Press(EndstopSet::PROBE)),
    ("let go", Act::Press(EndstopSet::NONE)),
    ("warm hotend", Act::Warm(Heater::Hotend)),
    ("warm bed", Act::Warm(Heater::Bed)),
    ("warm chamber", Act::Warm(Heater::Chamber)),
];

/// The lines that have come.
pub(crate) struct Hand(Receiver<String>);

impl Hand {
    /// Reads standard input from now on.
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

    /// Does what the lines say that have come.
    pub fn act(&self, world: &mut World<'_>) {
        for line in self.0.try_iter() {
            match ACTS.iter().find(|(known, _)| *known == line.trim()) {
                Some((_, Act::Press(switches))) => world.press(*switches),
                Some((_, Act::Warm(heater))) => {
                    if let Some(plant) = world.heat().plant() {
                        plant.hold(*heater, WARM);
                    }
                }
                None => {
                    let known: Vec<_> = ACTS.iter().map(|(known, _)| *known).collect();
                    eprintln!("corehbot: `{}` is not what a hand does; expected {}", line.trim(), known.join(", "));
                }
            }
        }
    }
}
