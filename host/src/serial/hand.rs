//! Hand: what a person does to the simulated machine, in lines on standard input, in the words of
//! [`corehbot_sim::user_actions`]. So the first hour with a board can be tried without one (`corehbot bringup`).
//!
//! `reset in 2 s` does so two seconds of the printer's time later. So an act falls into the middle of a wait, however
//! fast the computer is.

use crate::say::note;
use corehbot::units::TICKS_PER_SECOND;
use corehbot_sim::user_actions::{ACTS, Act};
use std::io::BufRead as _;
use std::sync::mpsc::{Receiver, channel};

/// The lines that have come.
#[derive(Debug)]
pub struct Hand {
    lines: Receiver<String>,
    /// Acts that are due at a tick of the printer's time.
    later: Vec<(u64, Act)>,
}

impl Hand {
    /// A hand that does what the lines say that come here.
    #[must_use]
    pub const fn at(lines: Receiver<String>) -> Self {
        Self { lines, later: Vec::new() }
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
        Self::at(receive)
    }

    /// The acts that are due at the tick `now`. An unknown line is answered with those that there are.
    pub fn acts(&mut self, now: u64) -> Vec<Act> {
        for line in self.lines.try_iter() {
            match read(line.trim()) {
                Some((seconds, act)) => self.later.push((now + seconds * u64::from(TICKS_PER_SECOND), act)),
                None => {
                    let known: Vec<_> = ACTS.iter().map(|(known, _)| *known).collect();
                    let (line, known) = (line.trim(), known.join(", "));
                    note(format_args!(
                        "corehbot: `{line}` is not what a hand does; expected {known}, or one of them `in 2 s`"
                    ));
                }
            }
        }
        self.later.extract_if(.., |(due, _)| *due <= now).map(|(_, act)| act).collect()
    }
}

/// Reads a line: in how many seconds, and what.
fn read(line: &str) -> Option<(u64, Act)> {
    let Some((line, wait)) = line.rsplit_once(" in ") else { return Some((0, Act::called(line)?)) };
    let seconds: u16 = wait.strip_suffix(" s")?.parse().ok()?;
    Some((seconds.into(), Act::called(line)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::EndstopSet;

    #[test]
    fn a_hand_acts_at_once_or_later() {
        let (send, lines) = channel();
        let mut hand = Hand::at(lines);
        for line in ["off in 2 s", "press x", "let go ", "jump", "reset in 1", "reset in -1 s", "jump in 1 s"] {
            send.send(line.to_owned()).unwrap();
        }
        let second = u64::from(TICKS_PER_SECOND);
        assert_eq!(hand.acts(second), [Act::Press(EndstopSet::X), Act::Press(EndstopSet::NONE)]);
        assert_eq!(hand.acts(3 * second - 1), []);
        assert_eq!(hand.acts(3 * second), [Act::Off]);
        assert_eq!(hand.acts(4 * second), []);
    }
}
