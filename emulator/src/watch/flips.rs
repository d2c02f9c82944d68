//! Bits of registers that flip by themselves, one after the other.

use super::Watch;
use crate::board::Emulated;
use corehbot::motors::prototype;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// Registers of which each bit of a mask flips twice: just after a heater's pin has gone high, and a ms after the end
/// of a pulse, when a control period has begun.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FlipEach {
    /// Virtual time before the first, in ns.
    pub after: u64,
    /// Virtual time from one to the next at least, in ns.
    pub every: u64,
    /// Addresses and masks.
    pub registers: &'static [(u64, u32)],
}

/// A bit that flipped.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Flip {
    /// When, in ns.
    pub at: u64,
    /// The register's address.
    pub address: u64,
    /// The bit, as a mask.
    pub bit: u32,
    /// Just after a heater's pin had gone high; otherwise a ms after it had gone low.
    pub is_hot: bool,
    /// Whether the bit had its earlier value when the next one flipped.
    pub is_back: bool,
}

impl FlipEach {
    /// The flip after `count` of them.
    fn next(&self, count: usize) -> Option<(u64, u32, bool)> {
        let bits = self.registers.iter().flat_map(|&(address, mask)| {
            let bits = (0..32).map(|place| 1 << place).filter(move |bit| mask & bit != 0);
            bits.flat_map(move |bit| [(address, bit, true), (address, bit, false)])
        });
        bits.into_iter().nth(count)
    }
}

impl Watch {
    /// Flips the next bit if it is time for that.
    pub(super) fn flip_next(&mut self, board: &mut Emulated, at: u64, each: &FlipEach) {
        let due = self.flips.last().map_or(each.after, |last| last.at + each.every);
        if at < due {
            return;
        }
        let next = each.next(self.flips.len());
        let is_now = |is_hot| if is_hot { self.heat.has_just_gone_on(at) } else { self.heat.has_gone_off(at) };
        if next.is_some_and(|(_, _, is_hot)| !is_now(is_hot)) {
            return;
        }
        if let Some(last) = self.flips.last_mut() {
            let now = board.mcu.peek(VirtualNanos(at), last.address, Width::W32).unwrap_or(0);
            last.is_back = (now as u32 ^ self.before_flip) & last.bit == 0;
        }
        let Some((address, bit, is_hot)) = next else {
            self.injection = None;
            return;
        };
        let before = board.mcu.peek(VirtualNanos(at), address, Width::W32);
        self.before_flip = before.as_ref().map_or(0, |before| *before as u32);
        let flipped = u64::from(self.before_flip ^ bit);
        self.is_injectable &= before.is_ok() && board.mcu.write(VirtualNanos(at), address, Width::W32, flipped).is_ok();
        self.flips.push(Flip { at, address, bit, is_hot, is_back: false });
        self.heat.look(board, at, self.mechanics.counts()[prototype::E0.index()]);
        self.injected = Some(at);
    }
}
