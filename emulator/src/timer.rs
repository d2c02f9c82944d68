//! The schedule: when the firmware means to play the event that is on the pins.
//!
//! Its time is the core's cycle counter, and its alarm the core's own timer, which no bus sees. So the schedule is read
//! from the firmware's memory: `STEPPER` in the image is the Stepper. Its first words are laid out for the step
//! interrupt (`motion::stepper`), and it leads to the status (`status`).

use crate::board::Emulated;
use crate::tick::NS_PER_TICK;
use rigless::emulator::Host;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// The cycle counter (ARM DDI 0403E, C1.8.8).
const CYCCNT: u64 = 0xE000_1004;

/// The Stepper's words: when the event is due, by how much motion time lags, the status.
const DUE: u64 = 0;
const LAG: u64 = 4;
const STATUS: u64 = 16;

/// In the status: events that came so late that time was stretched.
const LATE: u64 = 32;

/// Cycles of 180 MHz in a tick.
const CYCLES_PER_TICK: u32 = 18;

/// The firmware's schedule when the step lines of an event rise.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Schedule {
    /// When the event is due, in ticks of the step timer.
    pub due: u32,
    /// By how many ticks motion time lags the step timer.
    pub lag: u32,
    /// Events so far for which the firmware moved all that follow.
    pub stretched: u32,
    /// From the begin of the tick to the edge, in ns.
    pub late: i64,
}

impl Schedule {
    /// Reads it while an edge is made at `at`; `stepper` is where the image keeps the Stepper.
    pub fn read(board: &mut Emulated, host: &mut dyn Host, at: VirtualNanos, stepper: u32) -> Option<Self> {
        let mut word = |address: u64| host.read(address, Width::W32).ok();
        let place = u64::from(stepper);
        let (due, lag) = (word(place + DUE)? as u32, word(place + LAG)? as u32);
        let status = word(place + STATUS)?;
        let stretched = word(status + LATE)? as u32;
        let now = board.mcu.peek(at, CYCCNT, Width::W32).ok()? as u32;
        let cycles = now.wrapping_sub(due.wrapping_mul(CYCLES_PER_TICK)).cast_signed();
        let late = i64::from(cycles) * NS_PER_TICK as i64 / i64::from(CYCLES_PER_TICK);
        Some(Self { due, lag, stretched, late })
    }

    /// The event's motion time, low 32 bits.
    #[must_use]
    pub const fn tick(&self) -> u32 {
        self.due.wrapping_sub(self.lag)
    }
}
