//! The flash interface of a board that keeps settings in flash (RM0390 rev 6, chapter 3).
//!
//! - Keys, LOCK, write access only while unlocked, option bytes (3.5.1, 3.6): the crate's model.
//! - SER, SNB, STRT: a sector is erased, BSY until then (3.5.3): the crate's model. The effect on the cells is here.
//! - A store to flash: a word is programmed, BSY until then (3.5.4): here.
//! - PGSERR: PG not set, or an erase selected. PGAERR: beyond a row of 128 bits. PGPERR: another width than PSIZE.
//!   WRPERR (3.5.4, 3.8.4). All are here.
//! - Operations and writes to CR while BSY is set: the manual says that the bus waits (3.5.1). Here they are a fault of
//!   the image.
//!
//! While a sector is erased the processor stands still (3.5: no code can be fetched), so the watch holds it. While a
//! word is programmed it continues, also if it waits for BSY in the instruction cache.

use crate::flash::{FlashSectors, Operation, Tear};
use crate::wiring::RAIL;
use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::flash::{Register, cr, optcr, sr};
use rigless::soc::stm32f427::peripherals::flash::{Flash, LOCK};
use rigless::time::{EventId, VirtualNanos};
use std::num::NonZeroU32;

/// To program a word, typical (STM32F446 datasheet, t_prog).
const PROGRAM_NS: u64 = 16_000;

/// Longest time to erase a sector of 16 KiB, at 8, 16 and 32 bits (STM32F446 datasheet, t_ERASE16KB). The crate's model
/// is done earlier, at the typical time; the processor stands still until this one.
const ERASE_NS: [u64; 3] = [800_000_000, 600_000_000, 500_000_000];

/// HCLK out of reset (RM0390 rev 6, section 6.2.2).
const RESET_HZ: u64 = 16_000_000;

/// A row, beyond which no store may reach.
const ROW: u64 = 16;

/// The interface.
#[derive(Debug)]
pub struct FlashInterface {
    model: Flash,
    /// The content of the sectors.
    pub sectors: FlashSectors,
    /// The current operation, and its end.
    work: Option<(Operation, u64)>,
    /// Words that are another now, and that the processor does not see yet.
    changes: Vec<(u64, u32)>,
}

impl FlashInterface {
    /// Out of reset.
    #[must_use]
    pub fn new(sectors: FlashSectors) -> Self {
        Self { model: fresh(), sectors, work: None, changes: Vec::new() }
    }

    /// The processor stores `value` at `address`.
    pub fn store(&mut self, at: VirtualNanos, address: u64, width: Width, value: u64, registers: &mut RegisterFile) {
        if self.work.is_some() {
            self.sectors.faults.push("flash is written to while BSY is set");
            return;
        }
        if let Some(flag) = refusal(address, width, registers) {
            let control = registers.get(Register::Cr);
            let operation_error = if cr::ERRIE.is_set(control) { sr::OPERR.mask() } else { 0 };
            registers.set(Register::Sr, registers.get(Register::Sr) | flag | operation_error);
            return;
        }
        let size = width.bytes() as usize;
        self.begin(Operation::Program { address, size, value }, at.0 + PROGRAM_NS);
    }

    fn begin(&mut self, operation: Operation, until: u64) {
        self.work = self.sectors.begin(operation).map(|operation| (operation, until));
        if let (true, Some(cut)) = (self.sectors.is_cut(), self.sectors.cut) {
            self.tear(cut.tear);
        }
    }

    /// Leaves the current operation unfinished. Without power it stays so.
    fn tear(&mut self, tear: Tear) {
        if let Some((operation, _)) = self.work {
            self.changes.extend(self.sectors.end(operation, Some(tear)));
        }
    }

    /// Comes to `at`: an operation may be done.
    pub fn advance(&mut self, at: VirtualNanos) {
        if let Some((operation, until)) = self.work
            && until <= at.0
            && !self.sectors.is_cut()
        {
            self.work = None;
            self.changes.extend(self.sectors.end(operation, None));
        }
    }

    /// When the current operation is done.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        self.work.map(|(_, until)| until).filter(|_| !self.sectors.is_cut())
    }

    /// Whether the processor stands still.
    #[must_use]
    pub const fn is_holding(&self) -> bool {
        self.sectors.is_cut() || matches!(self.work, Some((Operation::Erase { .. }, _)))
    }

    /// Words that have changed since this was asked last, and where.
    pub fn take_changes(&mut self) -> Vec<(u64, u32)> {
        std::mem::take(&mut self.changes)
    }

    /// The part was reset. An operation under way leaves a mixture (RM0390 rev 6, section 3.5).
    pub fn restarted(&mut self) {
        if !self.sectors.is_cut() {
            self.tear(Tear::Bits);
            self.work = None;
        }
        self.model = fresh();
    }

    fn shown(&self, register: Register, registers: &RegisterFile) -> Option<u64> {
        (register == Register::Sr && self.work.is_some()).then(|| registers.get(register) | sr::BSY.mask())
    }

    /// Starts the operation that a write to the control register asks for.
    fn controlled(&mut self, was_busy: bool, registers: &RegisterFile, context: &DeviceContext<'_>) {
        let control = registers.get(Register::Cr);
        if was_busy || !sr::BSY.is_set(registers.get(Register::Sr)) {
            return;
        }
        if cr::MER.is_set(control) || cr::MER1.is_set(control) {
            self.sectors.faults.push("all of flash is erased");
            return;
        }
        let time = ERASE_NS[(cr::PSIZE.get(control) as usize).min(2)];
        self.begin(Operation::Erase { sector: cr::SNB.get(control) }, context.now().0 + time);
    }
}

/// Why a store is not carried out, as its flag.
fn refusal(address: u64, width: Width, registers: &RegisterFile) -> Option<u64> {
    let control = registers.get(Register::Cr);
    let erases = cr::SER.mask() | cr::MER.mask() | cr::MER1.mask();
    let bytes = u64::from(width.bytes());
    if LOCK.is_set(control) || !cr::PG.is_set(control) || control & erases != 0 {
        Some(sr::PGSERR.mask())
    } else if address % ROW + bytes > ROW {
        Some(sr::PGAERR.mask())
    } else if bytes != 1 << cr::PSIZE.get(control) {
        Some(sr::PGPERR.mask())
    } else {
        // nWRP is low for a sector that is protected (section 3.8.6); 16 KiB each, as far as settings may be.
        let sector = (address - 0x0800_0000) / crate::flash::SECTOR;
        let is_free = sector > 3 || optcr::NWRP.get(registers.get(Register::Optcr)) >> sector & 1 != 0;
        (!is_free).then(|| sr::WRPERR.mask())
    }
}

/// The crate's model on the board's rail.
fn fresh() -> Flash {
    let mut model = Flash::with_clock(RESET_HZ);
    if let Some(rail) = NonZeroU32::new(RAIL) {
        model.set_supply(rail);
    }
    model
}

impl Device for FlashInterface {
    type Register = Register;

    fn read(&mut self, register: Register, registers: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        self.shown(register, registers)
    }

    fn peek(&self, register: Register, registers: &RegisterFile, _: VirtualNanos) -> Option<u64> {
        self.shown(register, registers)
    }

    fn write(&mut self, register: Register, value: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let was_busy = sr::BSY.is_set(registers.get(Register::Sr));
        if register == Register::Cr && self.work.is_some() {
            self.sectors.faults.push("CR is written to while BSY is set");
        }
        Device::write(&mut self.model, register, value, registers, context);
        if register == Register::Cr {
            self.controlled(was_busy, registers, context);
        }
    }

    fn on_event(&mut self, event: EventId, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.model.on_event(event, registers, context);
    }

    fn on_clock(&mut self, hz: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        Device::on_clock(&mut self.model, hz, registers, context);
    }
}

#[cfg(test)]
#[path = "flash_interface_tests.rs"]
mod tests;
