//! The step timer as the bus shows it: TIM2, what its alarm is set to and when it is silenced.
//!
//! The alarm that the firmware writes is the scheduled tick of the next event. That is how the schedule is
//! known although it is not on the pins, and without help from the image.

use crate::board::Emulated;
use crate::steps::Alarm;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// TIM2 (RM0390 rev 6, section 2.2.2).
const TIM2: u64 = 0x4000_0000;
const DIER: u64 = 0x0C;
const CNT: u64 = 0x24;
const CCR1: u64 = 0x34;
const CCR4: u64 = 0x40;

/// The four compare interrupts in DIER.
const COMPARE: u64 = 0x1E;

/// A tick of the step timer.
pub const NS_PER_TICK: u64 = 100;

/// What a write to the step timer means.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Meaning {
    /// The alarm was set.
    Alarm(Alarm),
    /// No alarm until the next one.
    Silence,
}

/// What a write of `value` to `address` at `at` means, if it went to the step timer.
pub fn meaning(board: &mut Emulated, at: VirtualNanos, address: u64, value: u64) -> Option<Meaning> {
    match address.checked_sub(TIM2)? {
        CCR1..=CCR4 => {
            let now = count(board, at)?;
            let ticks = value as u32;
            let wait = i64::from(ticks.wrapping_sub(now) as i32);
            let due = next_tick(board, at, now).0 as i64 + (wait - 1) * NS_PER_TICK as i64;
            Some(Meaning::Alarm(Alarm { ticks, due }))
        }
        DIER if value & COMPARE == 0 => Some(Meaning::Silence),
        _ => None,
    }
}

/// What the counter reads at a time.
fn count(board: &mut Emulated, at: VirtualNanos) -> Option<u32> {
    board.mcu.peek(at, TIM2 + CNT, Width::W32).ok().map(|count| count as u32)
}

/// When the counter, which reads `now` at `at`, next changes, to the nanosecond.
fn next_tick(board: &mut Emulated, at: VirtualNanos, now: u32) -> VirtualNanos {
    let (mut before, mut by) = (at.0, at.0 + NS_PER_TICK);
    while by - before > 1 {
        let middle = before.midpoint(by);
        if count(board, VirtualNanos(middle)) == Some(now) {
            before = middle;
        } else {
            by = middle;
        }
    }
    VirtualNanos(by)
}
