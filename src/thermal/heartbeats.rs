//! Heartbeats: the watchdog is fed only while every context sends one.
//!
//! | context | heartbeat |
//! |---|---|
//! | converter | samples come, or the board has none |
//! | control period | none needed: it is the code that checks |
//! | Stepper | it has played an event, or answered being pended |
//! | StepGenerator | it has run after being pended |
//! | Console | each turn of the main loop |

use crate::fault::{Cause, Fault};
use crate::status::Status;

/// A context that sends heartbeats; its number is the subject of a fault.
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

/// Control periods that a context may be silent for: 0.4 s. Storage blocks the Console for 25 ms, a driver for slightly
/// more.
const MOST: u8 = 20;

/// Checks the heartbeats.
#[derive(Clone, Copy, Debug, Default)]
pub struct Heartbeats {
    last: [u32; 3],
    silent: [u8; 3],
}

impl Heartbeats {
    /// No heartbeat yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: [0; 3], silent: [0; 3] }
    }

    /// Checks once in a control period; returns a fault if a context has been silent for too long.
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

    /// Contexts without a heartbeat in the last period; the caller pends them. Others run by themselves, and an extra
    /// interrupt would delay a step.
    #[must_use]
    pub const fn is_silent(&self, context: Context) -> bool {
        self.silent[context as usize] > 0
    }

    /// Whether each has sent a heartbeat within half of its permitted time.
    #[must_use]
    pub fn all_beat(&self) -> bool {
        self.silent.iter().all(|silent| *silent < MOST / 2)
    }
}
