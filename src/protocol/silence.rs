//! Silence: how long a host has sent nothing, and how often it was prompted.
//!
//! The permitted silence is a setting, the patience: `Settings::patience_ms`, with its default in
//! `Settings::prototype`, in a machine file `patience_ms`; stored settings keep their own. It should stay below
//! `lookahead_time`, or a lost line stops the motion.
//!
//! A line may be lost whole, with its line end, or the `ok` for the last one. The host then waits for its `ok` for ever
//! (printcore) or for half a minute (OctoPrint). So a silence in a stream is broken by a **prompt**. A host that pauses
//! looks the same from here, so on a port without damage the prompt is only an `ok`. A waiting host continues, and the
//! next line shows a lost one by its number; any other host ignores it. On a damaged port the prompt asks for the next
//! line, as long as the machine moves. docs/reference/host-protocol/resends.md has the effect on each host, in each
//! of its states.
//!
//! The prompt that asks for the next line is the **question**: `Resend:` and `ok`, without an error (`question` in
//! `reply.rs`). The other one is the `ok` of any line (`Incoming::Acknowledge`); another text for it would need a new
//! variant.
//!
//! | the machine | nothing was ever damaged | something was |
//! |---|---|---|
//! | moves | `ok` | a question, twice, then `ok` |
//! | has come to rest by itself | `ok` | `ok` |
//! | has waited for its motion to end | `ok` if the first number was below 0 (printcore, which waits for ever) | same |
//! | is paused | nothing | nothing |

use crate::units::Instant;

/// Prompts in one silence. The port may lose some of them, or of the lines that answer them, and a windowed host may
/// have lost the reply to each of its lines.
const PROMPTS: u8 = 8;

/// The time between prompts doubles this often: up to 16 times the patience. OctoPrint itself asks after 30 s.
const DOUBLINGS: u8 = 4;

/// The first prompts that may be questions. OctoPrint counts each as a resend, and gives up at the eleventh for the
/// same line (comm.py, maxConsecutiveResends).
const QUESTIONS: u8 = 2;

/// The machine's activity while a host is silent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Activity {
    /// Motion is under way.
    Moving,
    /// It has stopped because nothing more was sent.
    Resting,
    /// A command has waited for the end of the motion, and nothing was planned since.
    Waited,
    /// The same, and the print is paused.
    Paused,
}

/// Kind of prompt.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Prompt {
    /// An `ok`.
    Ok,
    /// The question: the host is asked for the next line.
    Question,
}

impl Activity {
    /// The prompt for a silent host, if any: `is_bad` if the port had damage, `waits_for_ever` if the host never gives
    /// up.
    pub(super) const fn prompt(self, is_bad: bool, waits_for_ever: bool) -> Option<Prompt> {
        match self {
            Self::Moving if is_bad => Some(Prompt::Question),
            Self::Moving | Self::Resting => Some(Prompt::Ok),
            Self::Waited if waits_for_ever => Some(Prompt::Ok),
            Self::Waited | Self::Paused => None,
        }
    }
}

/// The silence of a host.
pub(super) struct Silence {
    since: Option<Instant>,
    /// The expected line at the last prompt.
    line: i32,
    /// Number of prompts for it.
    prompts: u8,
}

impl Silence {
    /// The state at the start.
    pub(super) const fn new() -> Self {
        Self { since: None, line: 0, prompts: 0 }
    }

    /// The host or the firmware has sent something.
    pub(super) const fn end(&mut self) {
        self.since = None;
    }

    /// Whether nothing has been sent for `ms` since the first call.
    pub(super) fn has_lasted(&mut self, ms: u32, now: Instant) -> bool {
        let since = *self.since.get_or_insert(now);
        now >= since.after_ms(ms)
    }

    /// Whether to prompt the host for `line` now: after `patience_ms`, and then each time after twice as long. `None`
    /// after the last prompt.
    pub(super) fn is_over(&mut self, line: i32, patience_ms: u32, now: Instant) -> Option<bool> {
        if line != self.line {
            (self.line, self.prompts) = (line, 0);
        }
        if self.prompts >= PROMPTS {
            return None;
        }
        let is_time = self.has_lasted(patience_ms << self.prompts.min(DOUBLINGS), now);
        if is_time {
            self.prompts += 1;
            self.since = None;
        }
        Some(is_time)
    }

    /// Whether the current prompt may be a question.
    pub(super) const fn may_ask(&self) -> bool {
        self.prompts <= QUESTIONS
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn it_is_broken_at_growing_distance() {
        let mut silence = Silence::new();
        let prompt = |ms: u32| {
            let is_over = silence.is_over(7, 500, Instant(0).after_ms(ms)) == Some(true);
            is_over.then_some((ms, silence.may_ask()))
        };
        let mut expected = vec![(500, true), (1501, true), (3502, false), (7503, false), (15_504, false)];
        expected.extend([(23_505, false), (31_506, false), (39_507, false)]);
        assert_eq!((0..60_000).filter_map(prompt).collect::<Vec<_>>(), expected);
        assert_eq!(silence.is_over(7, 500, Instant(0)), None);
        assert_eq!(silence.is_over(8, 500, Instant(0)), Some(false), "another line is another silence");
    }

    #[test]
    fn whatever_is_said_ends_it() {
        let mut silence = Silence::new();
        for ms in (0..10_000).step_by(499) {
            assert!(!silence.has_lasted(500, Instant(0).after_ms(ms)));
            silence.end();
        }
    }
}
