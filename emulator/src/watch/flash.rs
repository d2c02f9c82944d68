//! The processor's view of flash: its stores reach the interface, and their changes land in its memory.

use super::Watch;
use crate::board::Emulated;
use rigless::emulator::{Access, AccessKind, Host};
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::ops::Range;

/// Flash of the processor (RM0390 rev 6, section 2.2.2).
const FLASH: Range<u64> = 0x0800_0000..0x0808_0000;

impl Watch {
    /// A board that keeps settings in flash has come to `at`, by an access or without.
    pub(super) fn look_at_flash(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn Host,
        at: VirtualNanos,
        access: Option<&Access>,
    ) {
        let chip = &mut session.board_mut().mcu;
        if let Some(store) = access.filter(|a| a.kind == AccessKind::Write && FLASH.contains(&a.address)) {
            chip.store_to_flash(store);
        }
        let Some(flash) = chip.flash.as_mut() else { return };
        flash.advance(at);
        for (address, word) in flash.take_changes() {
            if host.program(address, Width::W32, word.into()).is_err() {
                flash.sectors.faults.push("the emulator does not let flash change");
            }
        }
        let is_holding = flash.is_holding();
        if std::mem::replace(&mut self.is_holding, is_holding) != is_holding {
            host.hold(is_holding);
        }
    }

    /// Makes the run stop at the next event of its own.
    pub(super) fn pause(&self, session: &mut Session<Emulated>) {
        let flash = session.board_mut().mcu.flash.as_ref().and_then(crate::flash_interface::FlashInterface::next);
        session
            .pause_at([self.drivers.next, self.mechanics.next(), flash].into_iter().flatten().min().map(VirtualNanos));
    }
}
