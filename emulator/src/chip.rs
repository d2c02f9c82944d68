//! The chip: the STM32F427 model with a clock tree of its own, a USB port with nothing plugged in, and the lines of
//! EXTI.
//!
//! The crate's own model of OTG_FS handles only the reset register; all other registers keep the written value. A
//! firmware that clears interrupt flags by writing ones would find all of them set, and would always see a host.
//!
//! The crate has no EXTI model, and its table does not connect EXTI with the interrupt of the supply's detector. Here
//! EXTI keeps the written value, and never has a pending interrupt. A test that lets the supply fall checks that the
//! line is armed, and pends the interrupt itself.
//!
//! The crate's flash cannot be written to: the processor's stores to it are dropped. For a board that keeps settings
//! there, [`FlashInterface`] takes them, and the emulator starts with a memory map in which flash has a programmer.

use crate::board::RAIL;
use crate::clock_tree::{ClockTree, Defect, Supply};
use crate::flash::FlashSectors;
use crate::flash_interface::FlashInterface;
use rigless::device::{Device, DeviceContext, ErasedDevice, RegisterFile, ResetCause};
use rigless::emulator::Access;
use rigless::mcu::{Mcu, Operate};
use rigless::soc::stm32f427::generated::otg_fs_global::Register;
use rigless::soc::stm32f427::generated::{exti, otg_fs_device};
use rigless::soc::stm32f427::peripherals::otg::Otg;
use rigless::soc::stm32f427::{MEMORY, Stm32f427};
use rigless::soc::{Bus, Error, Region, Width};
use rigless::time::VirtualNanos;
use std::ops::{Deref, DerefMut};

/// GINTSTS of a core in device mode on which nothing has happened (RM0390 rev 6, section 31.15.6).
const NOTHING_HAPPENED: u64 = 0x0400_0020;

/// The part's memory, with a flash that may change.
static PROGRAMMABLE: [Region; MEMORY.len()] =
    [MEMORY[0].programmed_by("FLASH"), MEMORY[1], MEMORY[2], MEMORY[3], MEMORY[4]];

/// The chip.
#[derive(Debug)]
pub struct Chip {
    part: Stm32f427,
    core: Core,
    device: Block,
    clock_tree: ClockTree,
    supply: Supply,
    lines: Lines,
    /// The flash interface of a board that keeps settings in flash.
    pub flash: Option<FlashInterface>,
    /// A bus with that board's memory, which gives the emulator its map before it starts.
    map: Option<Bus>,
    /// Where the bus has the six.
    slots: [Option<usize>; 6],
}

/// The global registers of OTG_FS.
#[derive(Debug, Default)]
struct Core(Otg);

impl Device for Core {
    type Register = Register;

    fn write(&mut self, register: Register, value: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        match register {
            Register::FsGintsts => registers.set(Register::FsGintsts, NOTHING_HAPPENED),
            // No session has ever ended.
            Register::FsGotgint => registers.set(Register::FsGotgint, 0),
            _ => Device::write(&mut self.0, register, value, registers, context),
        }
    }
}

/// The device registers of OTG_FS, which keep the written value: without a host they have no effect.
#[derive(Debug, Default)]
struct Block;

impl Device for Block {
    type Register = otg_fs_device::Register;
}

/// The lines of EXTI, on which nothing happens.
#[derive(Debug, Default)]
struct Lines;

impl Device for Lines {
    type Register = exti::Register;

    fn write(&mut self, register: exti::Register, _: u64, registers: &mut RegisterFile, _: &mut DeviceContext<'_>) {
        if register == exti::Register::Pr {
            // Writing ones clears pending bits (RM0390 rev 6, section 10.3.6).
            registers.set(exti::Register::Pr, 0);
        }
    }
}

impl Chip {
    /// A chip out of reset.
    ///
    /// # Errors
    /// If the model contradicts itself.
    pub fn new() -> Result<Self, Error> {
        let part = Stm32f427::new()?;
        let slots = ["OTG_FS_GLOBAL", "OTG_FS_DEVICE", "RCC", "PWR", "EXTI", "FLASH"]
            .map(|name| part.bus().slots().iter().position(|slot| slot.peripheral().name == name));
        Ok(Self {
            part,
            core: Core::default(),
            device: Block,
            clock_tree: ClockTree::new(),
            supply: Supply::new(),
            lines: Lines,
            flash: None,
            map: None,
            slots,
        })
    }

    /// Fits a crystal of `crystal` Hz, and breaks a part of the clocks.
    pub fn fit(&mut self, crystal: u64, defect: Defect) {
        self.clock_tree.fit(crystal);
        self.clock_tree.weaken(defect);
        self.power();
    }

    /// Uses these sectors as the flash with settings.
    ///
    /// # Errors
    /// If the model contradicts itself.
    pub fn keep_settings(&mut self, sectors: FlashSectors) -> Result<(), Error> {
        let bus = self.part.bus();
        self.map = Some(Bus::builder(bus.cpu(), &PROGRAMMABLE, bus.peripherals().copied()).build()?);
        self.flash = Some(FlashInterface::new(sectors));
        Ok(())
    }

    /// The processor has made a store to flash.
    pub fn store_to_flash(&mut self, store: &Access) {
        if let (Some(flash), Some(slot)) = (&mut self.flash, self.slots[5]) {
            let registers = self.part.bus_mut().slot_mut(slot).registers_mut();
            flash.store(store.virtual_time, store.address, store.width, store.value & store.width.mask(), registers);
        }
    }

    /// Runs the slow oscillator at `hz` Hz.
    pub fn calibrate_slow_oscillator(&mut self, hz: u64) {
        self.clock_tree.calibrate(hz);
    }

    /// Stops the crystal. The clock security system reacts at once (RM0390 rev 6, section 6.2.7), except for the
    /// exception, which the model does not raise. Returns whether the system watched for it.
    pub fn stop_crystal(&mut self, at: VirtualNanos) -> bool {
        /// RCC_CR and RCC_CIR, and CSSF in the latter (RM0390 rev 6, sections 6.3.1 and 6.3.4).
        const CONTROL: u64 = 0x4002_3800;
        const INTERRUPTS: u64 = 0x4002_380C;
        const HAS_FAILED: u64 = 1 << 7;
        self.clock_tree.stop_crystal();
        let control = self.peek(at, CONTROL, Width::W32).unwrap_or(0);
        let written = self.write(at, CONTROL, Width::W32, control);
        let flags = self.peek(at, INTERRUPTS, Width::W32).unwrap_or(0);
        written.is_ok() && flags & HAS_FAILED != 0
    }

    /// Puts the board's rail on the supply that is broken, if it is in use.
    fn power(&mut self) {
        if let Some(slot) = self.slots[3].filter(|_| self.clock_tree.defect() == Defect::OverDrive) {
            self.supply.power(RAIL, self.part.bus_mut().slot_mut(slot).registers_mut());
        }
    }

    /// The rates of HCLK, PCLK1 and PCLK2 in Hz.
    #[must_use]
    pub fn rates(&self) -> [u64; 3] {
        let Some(slot) = self.slots[2] else { return [0; 3] };
        let (rates, registers) = (self.clock_tree.rates(), self.part.bus().slots()[slot].registers());
        [rates.hclk(registers), rates.pclk1(registers), rates.pclk2(registers)]
    }
}

impl Deref for Chip {
    type Target = Stm32f427;

    fn deref(&self) -> &Stm32f427 {
        &self.part
    }
}

impl DerefMut for Chip {
    fn deref_mut(&mut self) -> &mut Stm32f427 {
        &mut self.part
    }
}

/// The rest of [`Mcu`] is for memory with check bits, which this part has not.
impl Mcu for Chip {
    fn bus(&self) -> &Bus {
        self.map.as_ref().unwrap_or_else(|| self.part.bus())
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.part.bus_mut()
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        let model: &mut dyn ErasedDevice = match self.slots.iter().position(|mine| *mine == Some(slot)) {
            Some(0) => &mut self.core,
            Some(1) => &mut self.device,
            Some(2) => &mut self.clock_tree,
            Some(3) if self.clock_tree.defect() == Defect::OverDrive => &mut self.supply,
            Some(4) => &mut self.lines,
            Some(5) if let Some(flash) = &mut self.flash => flash,
            _ => return self.part.split(slot),
        };
        (self.part.bus_mut(), Some(model))
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.part.reset(at, cause);
        self.supply = Supply::new();
        if let Some(slot) = self.slots[2] {
            self.clock_tree.restarted(cause, self.part.bus_mut().slot_mut(slot).registers_mut());
        }
        self.power();
        if let Some(flash) = &mut self.flash {
            flash.restarted();
        }
    }

    fn poll(&mut self, now: VirtualNanos) {
        // The run has begun, so the emulator has its map.
        self.map = None;
        self.part.poll(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AHB2ENR: u64 = 0x4002_3834;
    const GRSTCTL: u64 = 0x5000_0010;
    const GINTSTS: u64 = 0x5000_0014;

    #[test]
    fn without_a_cable_the_usb_core_is_idle_and_nothing_ever_happens() {
        let mut chip = Chip::new().unwrap();
        let at = VirtualNanos(1);
        chip.check().unwrap();
        chip.write(at, AHB2ENR, Width::W32, 1 << 7).unwrap();
        chip.write(at, GINTSTS, Width::W32, u64::from(u32::MAX)).unwrap();
        assert_eq!(chip.read(at, GINTSTS, Width::W32), Ok(NOTHING_HAPPENED));
        // The flush of all FIFOs is over at once, and the core's own bus is idle.
        chip.write(at, GRSTCTL, Width::W32, 0x430).unwrap();
        assert_eq!(chip.read(at, GRSTCTL, Width::W32), Ok(0x8000_0400));
    }
}
