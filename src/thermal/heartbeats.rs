//! Hearts: the watchdog is fed only while everybody has been heard of.
//!
//! | context | heard of by |
//! |---|---|
//! | converter | samples come, or the board has none |
//! | control period | needs no sign: it is the code that looks |
//! | Stepper | it has emitted an event, or answered being pended |
//! | StepGenerator | it has run after being pended |
//! | Console | it has come by |

use crate::fault::{Cause, Fault};
use crate::status::Status;

/// A context whose heart is listened to; its number is the subject of a fault.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Context {
    /// Commands.
    Console = 0,
    /// Step times.
    Generator = 1,
    /// Steps.
    Stepper = 2,
}

/// Control periods that a context may be silent for: 0.4 s. Storage keeps a Console for 25 ms, a driver for some more.
const MOST: u8 = 20;

/// Listens to the contexts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Heartbeats {
    last: [u32; 3],
    silent: [u8; 3],
}

impl Heartbeats {
    /// Nobody heard yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: [0; 3], silent: [0; 3] }
    }

    /// Listens once in a control period; what it finds is a context that has been silent for too long.
    pub fn listen(&mut self, status: &Status) -> Option<Fault> {
        let [console, generator] = status.heat().beats();
        let beats = [u32::from(console), u32::from(generator), status.stepper_beat()];
        for ((last, silent), beat) in self.last.iter_mut().zip(&mut self.silent).zip(beats) {
            *silent = if *last == beat { silent.saturating_add(1) } else { 0 };
            *last = beat;
        }
        let contexts = [Context::Console, Context::Generator, Context::Stepper];
        let silent = contexts.into_iter().zip(self.silent).find(|(_, silent)| *silent >= MOST)?;
        Some(Fault { cause: Cause::ContextHangs, subject: silent.0 as u8, value: 0, limit: 0 })
    }

    /// Whom to pend so that it can be heard: who has been silent in the last period. Others come by themselves, and an interrupt
    /// more would delay a step.
    #[must_use]
    pub const fn is_silent(&self, context: Context) -> bool {
        self.silent[context as usize] > 0
    }

    /// Whether all have been heard of in the last half of the time that they have.
    #[must_use]
    pub fn all_beat(&self) -> bool {
        self.silent.iter().all(|silent| *silent < MOST / 2)
    }
}
