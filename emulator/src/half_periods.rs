//! Laps: whether the firmware counts the half laps of its clock's timer as the timer makes them.
//!
//! The firmware's time is TIM2, 16 bits, and a count of its half laps. The count's last bit has to equal the counter's
//! highest bit, so that a read just after a half lap differs from a read before it. If these bits differ, the time
//! sometimes goes back.

use crate::board::Emulated;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// TIM2 (RM0390 rev 6, section 2.2.2).
const TIM2: u64 = 0x4000_0000;
const SR: u64 = 0x10;
const CNT: u64 = 0x24;

/// Update and compare 1: the end of a lap, and its half.
const HALVES: u64 = 0b11;

/// Counts half laps as the firmware does.
#[derive(Clone, Copy, Default, Debug)]
pub struct Laps {
    count: u32,
    /// Half laps after which the count was out of step.
    pub out_of_step: u32,
}

impl Laps {
    /// The firmware wrote `value` to `address`.
    pub fn written(&mut self, board: &mut Emulated, at: VirtualNanos, address: u64, value: u64) {
        if address != TIM2 + SR {
            return;
        }
        // Writing 0 clears flags. Clearing all of them at once is not a half lap, but a start.
        if value & u64::from(u16::MAX) == 0 {
            *self = Self::default();
            return;
        }
        let halves = (!value & HALVES).count_ones();
        if halves == 0 {
            return;
        }
        self.count = self.count.wrapping_add(halves);
        let Ok(counter) = board.mcu.peek(at, TIM2 + CNT, Width::W32) else { return };
        self.out_of_step += u32::from(u64::from(self.count & 1) != counter >> 15 & 1);
    }
}
