//! The clock tree: the model of an STM32F427's RCC, changed to an STM32F446's where a bootloader or an image meets the
//! difference. Clocks may have defects.
//!
//! The F446 may take its system clock from the PLL's output R (RM0390 rev 6, section 6.3.3, SW = 3), which the F427
//! lacks. The model gets output P instead, and a read of the register returns the written value. The rate is right as
//! long as both outputs divide alike.

use rigless::device::{Device, DeviceContext, RegisterFile, RequestChange, ResetCause};
use rigless::soc::stm32f427::generated::pwr;
use rigless::soc::stm32f427::generated::rcc::Register;
use rigless::soc::stm32f427::peripherals::pwr::Pwr;
use rigless::soc::stm32f427::peripherals::rcc::Rcc;
use rigless::time::{EventId, VirtualNanos};

/// Configuration register (RM0390 rev 6, section 6.3.3): the wanted source, the current source, and the number of
/// output P.
const SW: u64 = 3;
const SWS: u64 = 3 << 2;
const PLL_P: u64 = 2;

/// A defect of the clocks. A bootloader still starts: without clocks it would never hand over.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Defect {
    /// Nothing.
    #[default]
    None,
    /// The crystal, once stopped, does not start again.
    Crystal,
    /// Neither a crystal nor a clock is connected: HSE never starts.
    NoClock,
    /// The PLL, once stopped, does not lock again.
    Pll,
    /// Over-drive, once left, is not reached again.
    OverDrive,
}

/// A switch that works once.
#[derive(Default, Debug)]
struct Switch {
    bit: u64,
    was_on: bool,
    was_off: bool,
    /// As it was written.
    shown: u64,
}

impl Switch {
    const fn new(bit: u64) -> Self {
        Self { bit, was_on: false, was_off: false, shown: 0 }
    }

    /// One that has worked already.
    const fn spent(bit: u64) -> Self {
        Self { was_off: true, ..Self::new(bit) }
    }

    /// The part of `written` that takes effect.
    fn turn(&mut self, written: u64) -> u64 {
        let on = written & self.bit;
        self.was_off |= self.was_on && on == 0;
        self.was_on |= on != 0;
        self.shown = if self.was_off { on } else { 0 };
        written & !self.shown
    }

    /// The result of a read in place of `value`, if it differs.
    fn read(&self, value: u64) -> Option<u64> {
        (self.shown != 0).then_some(value | self.shown)
    }
}

/// A supply that reaches over-drive once; otherwise the model's.
#[derive(Debug)]
pub struct Supply {
    model: Pwr,
    switch: Switch,
}

impl Supply {
    /// Out of reset.
    #[must_use]
    pub fn new() -> Self {
        // ODEN (RM0390 rev 6, section 5.4.1).
        Self { model: Pwr::new(), switch: Switch::new(1 << 16) }
    }

    /// Puts the board's rail on it, in mV.
    pub fn power(&mut self, millivolts: u32, registers: &mut RegisterFile) {
        self.model.set_supply(millivolts, registers);
    }
}

impl Default for Supply {
    fn default() -> Self {
        Self::new()
    }
}

impl Device for Supply {
    type Register = pwr::Register;

    fn read(
        &mut self,
        register: pwr::Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        match register {
            pwr::Register::Cr => self.switch.read(registers.get(register)),
            _ => Device::read(&mut self.model, register, registers, context),
        }
    }

    fn write(
        &mut self,
        register: pwr::Register,
        value: u64,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) {
        if matches!(register, pwr::Register::Cr) {
            let arrived = self.switch.turn(registers.get(register));
            registers.set(register, arrived);
        }
        Device::write(&mut self.model, register, value, registers, context);
    }

    fn on_event(&mut self, event: EventId, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.model.on_event(event, registers, context);
    }

    fn reset_line(&mut self, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.switch.turn(0);
        Device::reset_line(&mut self.model, registers, context);
    }
}

/// The clock tree.
#[derive(Debug)]
pub struct ClockTree {
    model: Rcc,
    defect: Defect,
    /// The system clock, or the one that is wanted, is the PLL's output R.
    is_from_r: bool,
    /// The switch for the defect.
    switch: Switch,
    /// The crystal is about to stop.
    stops: bool,
}

impl ClockTree {
    /// A clock tree out of reset.
    #[must_use]
    pub fn new() -> Self {
        Self { model: Rcc::new(), defect: Defect::None, is_from_r: false, switch: Switch::default(), stops: false }
    }

    /// Fits a crystal of `crystal` Hz.
    pub fn fit(&mut self, crystal: u64) {
        self.model.attach_crystals(crystal, 0);
    }

    /// Runs the slow oscillator at `hz` Hz, 17,000 to 47,000 (STM32F446 datasheet, LSI).
    pub fn calibrate(&mut self, hz: u64) {
        self.model.calibrate_lsi(hz);
    }

    /// Stops the crystal at the next write to any register.
    pub const fn stop_crystal(&mut self) {
        self.stops = true;
    }

    /// Breaks something.
    pub fn weaken(&mut self, defect: Defect) {
        self.defect = defect;
        // HSEON and PLLON (RM0390 rev 6, section 6.3.1).
        self.switch = match defect {
            Defect::Crystal => Switch::new(1 << 16),
            Defect::NoClock => Switch::spent(1 << 16),
            Defect::Pll => Switch::new(1 << 24),
            Defect::None | Defect::OverDrive => Switch::default(),
        };
    }

    /// The current defect.
    #[must_use]
    pub const fn defect(&self) -> Defect {
        self.defect
    }

    /// The rates.
    #[must_use]
    pub const fn rates(&self) -> &Rcc {
        &self.model
    }

    /// The part was reset: all state starts again, except soldered parts.
    pub fn restarted(&mut self, cause: ResetCause, registers: &mut RegisterFile) {
        let (crystal, slow, defect) = (self.model.crystals().0, self.model.lsi_hz(), self.defect);
        *self = Self::new();
        self.fit(crystal);
        self.calibrate(slow);
        self.weaken(defect);
        // The part has put its flags there already; this one only has to know.
        self.model.restarted(cause, registers.get(Register::Csr), registers);
    }

    /// The value that a read of `register` returns, if it differs from the model's value.
    fn shown(&self, register: Register, registers: &RegisterFile) -> Option<u64> {
        let value = registers.get(register);
        match register {
            Register::Cr => self.switch.read(value),
            Register::Cfgr if self.is_from_r => {
                let is_switched = value & SWS == PLL_P << 2;
                Some(value | SW | if is_switched { SWS } else { 0 })
            }
            _ => None,
        }
    }
}

impl Default for ClockTree {
    fn default() -> Self {
        Self::new()
    }
}

impl Device for ClockTree {
    type Register = Register;

    fn read(&mut self, register: Register, registers: &mut RegisterFile, _: &mut DeviceContext<'_>) -> Option<u64> {
        self.shown(register, registers)
    }

    fn peek(&self, register: Register, registers: &RegisterFile, _: VirtualNanos) -> Option<u64> {
        self.shown(register, registers)
    }

    fn write(&mut self, register: Register, value: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let landed = registers.get(register);
        match register {
            Register::Cr => registers.set(register, self.switch.turn(landed)),
            Register::Cfgr => {
                self.is_from_r = landed & SW == SW;
                if self.is_from_r {
                    registers.set(register, landed & !SW | PLL_P);
                }
            }
            _ => {}
        }
        Device::write(&mut self.model, register, value, registers, context);
        if std::mem::take(&mut self.stops) {
            self.model.fail_hse(registers, context);
            self.is_from_r = false;
        }
    }

    fn on_event(&mut self, event: EventId, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.model.on_event(event, registers, context);
    }

    fn on_request(&mut self, change: RequestChange, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.model.on_request(change, registers, context);
    }
}
