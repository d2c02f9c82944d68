//! The chip: the STM32F427 model with a clock tree of its own, a USB port, and the lines of EXTI.
//!
//! The crate's own model of OTG_FS handles only the reset register, and its tables lack the FIFOs. So OTG_FS is a
//! window ([`UsbPort`]), and the decoder leads to it ([`crate::decoder`]). The crate's own slot only hears its reset
//! line.
//!
//! The calendar counts ([`calendar`](crate::calendar)). TIM6, TIM7, TIM9 and TIM12 have models of their own
//! ([`small_timers`](crate::small_timers)).
//!
//! The crate has no EXTI model, and its table does not connect EXTI with the interrupt of the supply's detector. Here
//! EXTI keeps the written value, and never has a pending interrupt. A test that lets the supply fall checks that the
//! line is armed, and pends the interrupt itself.
//!
//! The crate's flash cannot be written to: the processor's stores to it are dropped. For a board that keeps settings
//! there, [`FlashInterface`] takes them, and the emulator starts with a memory map in which flash has a programmer.

use crate::cable::Plug;
use crate::calendar::Calendar;
use crate::clock_tree::{ClockTree, Defect, Supply};
use crate::flash::FlashSectors;
use crate::flash_interface::FlashInterface;
use crate::line::HostLine;
use crate::small_timers::{self, BasicTimer, SmallTimer, WithRegisters};
use crate::usb_port::{UsbPort, window};
use crate::wiring::RAIL;
use rigless::device::{Device, DeviceContext, ErasedDevice, RegisterFile, ResetCause};
use rigless::emulator::Access;
use rigless::mcu::{Mcu, Operate};
use rigless::soc::stm32f427::generated::exti;
use rigless::soc::stm32f427::generated::otg_fs_global::Register;
use rigless::soc::stm32f427::peripherals::usart::Usart;
use rigless::soc::stm32f427::{MEMORY, Stm32f427};
use rigless::soc::{Bus, Error, Region, Width};
use rigless::time::VirtualNanos;
use std::ops::{Deref, DerefMut};

/// The part's memory, with a flash that may change.
static PROGRAMMABLE: [Region; MEMORY.len()] =
    [MEMORY[0].programmed_by("FLASH"), MEMORY[1], MEMORY[2], MEMORY[3], MEMORY[4]];

/// The chip.
#[derive(Debug)]
pub struct Chip {
    part: Stm32f427,
    usb_reset: UsbReset,
    /// The USB port.
    pub usb: UsbPort<Plug>,
    usb_slot: usize,
    clock_tree: ClockTree,
    supply: Supply,
    lines: Lines,
    /// The calendar, which a reset leaves alone.
    pub calendar: Calendar,
    small_timers: [SmallTimer; small_timers::ALL.len()],
    basic_timers: [BasicTimer; small_timers::BASIC.len()],
    basic_slots: [Option<usize>; small_timers::BASIC.len()],
    /// The flash interface of a board that keeps settings in flash.
    pub flash: Option<FlashInterface>,
    /// A bus with that board's memory, which gives the emulator its map before it starts.
    map: Option<Bus>,
    /// Where the bus has the six, and the small timers.
    slots: [Option<usize>; 6],
    timer_slots: [Option<usize>; small_timers::ALL.len()],
}

/// The crate's slot of OTG_FS, which nothing reaches but the reset line.
#[derive(Debug, Default)]
struct UsbReset {
    was_reset: bool,
}

impl Device for UsbReset {
    type Register = Register;

    fn reset_line(&mut self, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {
        self.was_reset = true;
    }
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
        let mut part = Stm32f427::new()?;
        let usb_slot = part.bus_mut().add_window(window())?;
        let usb = UsbPort::new(part.bus().slots()[usb_slot].peripheral().registers);
        let slot_of = |name| part.bus().slots().iter().position(|slot| slot.peripheral().name == name);
        let slots = ["OTG_FS_GLOBAL", "RCC", "PWR", "EXTI", "FLASH", "RTC"].map(slot_of);
        let timer_slots = small_timers::ALL.map(|timer| slot_of(timer.name));
        let basic_slots = small_timers::BASIC.map(slot_of);
        Ok(Self {
            part,
            usb_reset: UsbReset::default(),
            usb,
            usb_slot,
            clock_tree: ClockTree::new(),
            supply: Supply::new(),
            lines: Lines,
            calendar: Calendar::new(),
            small_timers: small_timers::new(),
            basic_timers: small_timers::basic(),
            basic_slots,
            flash: None,
            map: None,
            slots,
            timer_slots,
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
        if let (Some(flash), Some(slot)) = (&mut self.flash, self.slots[4]) {
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
        if let Some(slot) = self.slots[2].filter(|_| self.clock_tree.defect() == Defect::OverDrive) {
            self.supply.power(RAIL, self.part.bus_mut().slot_mut(slot).registers_mut());
        }
    }

    /// The host on the USB cable, and the USARTs.
    pub fn lines(&mut self) -> (Option<&mut HostLine>, &mut [Usart]) {
        let line = match &mut self.usb.cable {
            Some(Plug::Line(cable)) => Some(&mut cable.line),
            Some(Plug::Network(_)) | None => None,
        };
        (line, &mut self.part.usart)
    }

    /// A small timer with its registers, by its place in [`small_timers::ALL`].
    pub fn small_timer(&mut self, place: usize) -> Option<WithRegisters<'_>> {
        let slot = self.timer_slots[place]?;
        Some((&mut self.small_timers[place], self.part.bus_mut().slot_mut(slot).registers_mut()))
    }

    /// The rate of the calendar's clock in Hz; 0 while it is off.
    fn slow_clock(&self) -> u64 {
        let Some(slot) = self.slots[1] else { return 0 };
        self.clock_tree.rates().rtc_clock(self.part.bus().slots()[slot].registers())
    }

    /// The rates of HCLK, PCLK1 and PCLK2 in Hz.
    #[must_use]
    pub fn rates(&self) -> [u64; 3] {
        let Some(slot) = self.slots[1] else { return [0; 3] };
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
        if slot == self.usb_slot {
            if std::mem::take(&mut self.usb_reset.was_reset) {
                self.usb.reset();
            }
            return (self.part.bus_mut(), Some(&mut self.usb));
        }
        if let Some(place) = self.timer_slots.iter().position(|mine| *mine == Some(slot)) {
            return (self.part.bus_mut(), Some(&mut self.small_timers[place]));
        }
        if let Some(place) = self.basic_slots.iter().position(|mine| *mine == Some(slot)) {
            return (self.part.bus_mut(), Some(&mut self.basic_timers[place]));
        }
        if self.slots[5] == Some(slot) {
            self.calendar.hz = self.slow_clock();
        }
        let model: &mut dyn ErasedDevice = match self.slots.iter().position(|mine| *mine == Some(slot)) {
            Some(0) => &mut self.usb_reset,
            Some(1) => &mut self.clock_tree,
            Some(2) if self.clock_tree.defect() == Defect::OverDrive => &mut self.supply,
            Some(3) => &mut self.lines,
            Some(4) if let Some(flash) = &mut self.flash => flash,
            Some(5) => &mut self.calendar,
            _ => return self.part.split(slot),
        };
        (self.part.bus_mut(), Some(model))
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.part.reset(at, cause);
        self.usb.reset();
        self.supply = Supply::new();
        self.small_timers = small_timers::new();
        self.basic_timers = small_timers::basic();
        if let Some(slot) = self.slots[1] {
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
    use crate::decoder::WINDOW;

    const AHB2ENR: u64 = 0x4002_3834;
    const AHB2RSTR: u64 = 0x4002_3814;
    const GINTSTS: u64 = WINDOW + 0x14;
    const DCFG: u64 = WINDOW + 0x800;

    #[test]
    fn the_usb_core_answers_while_its_clock_is_on_and_forgets_all_when_it_is_reset() {
        let mut chip = Chip::new().unwrap();
        let at = VirtualNanos(1);
        chip.check().unwrap();
        assert!(chip.read(at, DCFG, Width::W32).is_err());
        chip.write(at, AHB2ENR, Width::W32, 1 << 7).unwrap();
        chip.write(at, GINTSTS, Width::W32, u64::from(u32::MAX)).unwrap();
        // Nothing has happened on a bus without a host (RM0390 rev 6, section 31.15.6).
        assert_eq!(chip.read(at, GINTSTS, Width::W32), Ok(0x0400_0020));
        chip.write(at, DCFG, Width::W32, 3).unwrap();
        assert_eq!(chip.read(at, DCFG, Width::W32), Ok(3));
        chip.write(at, AHB2RSTR, Width::W32, 1 << 7).unwrap();
        chip.write(at, AHB2RSTR, Width::W32, 0).unwrap();
        assert_eq!(chip.read(at, DCFG, Width::W32), Ok(0));
    }
}
