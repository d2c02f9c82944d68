//! The terminal: a pseudo-terminal for a host outside, with a hand at the machine. Programs of this computer open it as
//! they would the port of an adapter at the board's UART.
//!
//! | turn | emulated time |
//! |---|---|
//! | the host's | real time; at full speed it first stands for 0.25 s at most, as in `corehbot serve` |
//! | the board's: a line has no answer | `--speed 1`: real time, or slower if the computer is; `max`: the fastest |
//!
//! So a wait of the board (heating, homing) may take less than real time. A time-out of a host never has more emulated
//! time than real time. Time that a slow computer loses is not made up for.

use crate::line::HostLine;
use crate::tick::NS_PER_TICK;
use anyhow::Result;
use corehbot_host::serial::{Hand, Pace, Port, Speed};
use corehbot_host::stop::Stop;
use corehbot_sim::user_actions::Act;
use std::time::{Duration, Instant};

/// An answer that takes less is no wait, in ns of emulated time: a host that asks again and again sees time go on.
const SHORT: u64 = 100_000_000;

/// A board that works on a line says so every 2 s (M113). After twice that silence in ns it waits for its host,
/// whatever was not answered: a line that is no command, or M112.
const SILENCE: u64 = 4_000_000_000;

/// How long a wait in real time may keep from looking at signals and the hand.
const LOOK: Duration = Duration::from_millis(20);

/// The terminal.
#[derive(Debug)]
pub struct Terminal {
    port: Port,
    pace: Pace,
    begin: Instant,
    stop: Stop,
    hand: Option<Hand>,
    /// Since when it has been the board's turn, in ns.
    asked: Option<u64>,
    is_off: bool,
    /// Why it does not work any more.
    pub failure: Option<anyhow::Error>,
}

impl Terminal {
    /// A terminal for the run that begins now, until `stop` is set or the hand switches off.
    #[must_use]
    pub fn new(port: Port, speed: Speed, stop: Stop, hand: Option<Hand>) -> Self {
        let begin = Instant::now();
        Self { port, pace: Pace::new(speed), begin, stop, hand, asked: None, is_off: false, failure: None }
    }

    /// What the hand does at the emulated time `at`, in ns.
    pub fn acts(&mut self, at: u64) -> Vec<Act> {
        let acts: Vec<_> = self.hand.iter_mut().flat_map(|hand| hand.acts(at / NS_PER_TICK)).collect();
        self.is_off |= acts.contains(&Act::Off);
        acts
    }

    /// Whether it was switched off.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.is_off || self.stop.is_set() || self.failure.is_some()
    }

    /// Passes bytes on, both ways, and waits for the emulated time `at`, in ns. The motors have made `events`.
    pub fn attend(&mut self, line: &mut HostLine, at: u64, events: usize) {
        if let Err(error) = self.pass(line, at, events) {
            self.failure.get_or_insert(error);
        }
    }

    fn pass(&mut self, line: &mut HostLine, at: u64, events: usize) -> Result<()> {
        self.port.write(line.take_said().into_iter())?;
        loop {
            let mut bytes = Vec::new();
            self.port.read(&mut bytes)?;
            if !bytes.is_empty() {
                self.pace.hear(events as u32);
                line.send(&bytes);
            }
            let wait = self.wait(line, at);
            if wait.is_zero() || self.stop.is_set() {
                return Ok(());
            }
            self.port.wait(wait.min(LOOK), None)?;
        }
    }

    /// How long to wait before time goes on from `at`.
    fn wait(&mut self, line: &HostLine, at: u64) -> Duration {
        let is_asked = line.is_asked() && at < line.active + SILENCE;
        let since = if is_asked { *self.asked.get_or_insert(at) } else { at };
        if !is_asked {
            self.asked = None;
        } else if at < since + SHORT {
            return Duration::ZERO;
        }
        self.pace.wait(self.begin.elapsed(), at / NS_PER_TICK, !is_asked)
    }
}
