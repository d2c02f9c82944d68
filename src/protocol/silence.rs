//! Silence: how long a host has said nothing, and how often the host was prompted for its silence.
//!
//! How long it may be silent is a setting, the patience: `Settings::patience_ms`, by default in `Settings::prototype`, in a machine
//! file by `patience_ms`; stored settings keep their own. It should stay below `lookahead_time`, or a lost line costs a stop.
//!
//! A line may be lost whole, line end and all, or the `ok` for the last one. A host that waits for its `ok` then waits for
//! ever (printcore) or for half a minute (OctoPrint). So a silence in the middle of a stream is broken. A host that merely
//! pauses looks just the same from here, so on a line that has lost nothing so far it hears an `ok` and no more: who
//! waits for one goes on, and if a line was lost, the next one shows it by its number; who waits for none does not care.
//! On a line that has lost something the next line is asked for, as long as the machine moves. docs/host-protocol.md says
//! what each host makes of either, in each of its states.
//!
//! Either of them is a **prompt**. The request for the next line is the **question**: `Resend:` and `ok`, without an error (`question`
//! in `reply.rs`). The `ok` is that of any line (`Incoming::Acknowledge`); another text for it would be a variant of its own.
//!
//! | the machine | nothing was ever damaged | something was |
//! |---|---|---|
//! | moves | `ok` | a question, twice, then `ok` |
//! | has come to rest by itself | `ok` | `ok` |
//! | has waited for its motion to end | `ok` if the host began its numbers below 0, as printcore does, which waits for ever | the same |
//! | is paused | nothing | nothing |

use crate::units::Instant;

/// Prompts in one silence: the line may lose some of them, or of the lines that answer them, and a host with several lines
/// under way may have lost an answer to each.
const PROMPTS: u8 = 8;

/// From one prompt to the next the time doubles, so many times at most: to 16 times the patience. OctoPrint
/// itself asks after 30 s.
const DOUBLINGS: u8 = 4;

/// So many of the first prompts may be questions. OctoPrint counts each as a resend, and gives up at the eleventh for the
/// same line (comm.py, maxConsecutiveResends).
const QUESTIONS: u8 = 2;

/// What the machine is doing while a host is silent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Activity {
    /// Motion is under way.
    Moving,
    /// It has come to rest because nothing more was sent.
    Resting,
    /// A command has waited for the end of the motion, and nothing was planned since.
    Waited,
    /// The same, and the print is paused.
    Paused,
}

/// How a silence is broken.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Prompt {
    /// By an `ok`.
    Ok,
    /// By the question: the host is asked for the next line.
    Question,
}

impl Activity {
    /// How to break the silence of a host on a line that has lost something or not, who would wait for an answer for ever
    /// or not.
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
    /// The line that was awaited when the host was prompted most recently.
    line: i32,
    /// How often it was.
    prompts: u8,
}

impl Silence {
    /// Nothing is known yet.
    pub(super) const fn new() -> Self {
        Self { since: None, line: 0, prompts: 0 }
    }

    /// Something was said.
    pub(super) const fn end(&mut self) {
        self.since = None;
    }

    /// Whether nothing has been said for `ms`, as far as anybody listened.
    pub(super) fn has_lasted(&mut self, ms: u32, now: Instant) -> bool {
        let since = *self.since.get_or_insert(now);
        now >= since.after_ms(ms)
    }

    /// Whether to prompt the host for `line` now: after `patience_ms`, and each time after twice as long. `None` if that
    /// was done often enough.
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

    /// Whether the present prompt may be a question.
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
