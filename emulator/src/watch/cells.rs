//! Words of RAM that are damaged.

use super::Watch;
use crate::board::Emulated;
use rigless::emulator::{self, Host};
use rigless::session::Session;
use rigless::soc::Width;

/// A word of RAM that is damaged from a time on, also after a reset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BadWord {
    /// Virtual time before it, in ns.
    pub after: u64,
    /// Its address.
    pub address: u64,
    /// The damage.
    pub damage: Damage,
}

/// The damage of a word.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Damage {
    /// These bits are 1, whatever is written.
    High(u64),
    /// These bits are 0.
    Low(u64),
    /// The word at this address gets its values too: a line of the address has no effect.
    Mirrored(u64),
}

impl Watch {
    /// A word is damaged from now on.
    pub(super) fn damage(&mut self, session: &mut Session<Emulated>, host: &mut dyn Host, word: BadWord) {
        let watch = emulator::Watch::Writes { address: word.address, length: 4 };
        session.watch(watch);
        self.bad_word = Some(word);
        self.spoil(host);
    }

    /// The damaged word was written.
    pub(super) fn spoil(&mut self, host: &mut dyn Host) {
        let Some(BadWord { address, damage, .. }) = self.bad_word else { return };
        let Ok(value) = host.read(address, Width::W32) else { return };
        let written = match damage {
            Damage::High(bits) => host.write(address, Width::W32, value | bits),
            Damage::Low(bits) => host.write(address, Width::W32, value & !bits),
            Damage::Mirrored(other) => host.write(other, Width::W32, value),
        };
        self.is_injectable &= written.is_ok();
    }
}
