//! The calendar (RTC): its counter of sub-seconds, which the crate's model leaves out.
//!
//! | item | RM0390 rev 6 |
//! |---|---|
//! | keys 0xCA and 0x53 before anything else is written, any other key locks again | 22.3.5, RTC_WPR |
//! | PRER only in the initialization mode, which begins two cycles after INIT | 22.3.5, RTC_ISR |
//! | the counter goes down from PREDIV_S to 0 at RTCCLK over PREDIV_A + 1, and is read without shadow | RTC_SSR |
//!
//! A reset of the chip leaves all of it alone; one of the backup domain resets it.

use rigless::device::{Device, DeviceContext, RegisterFile, RequestChange};
use rigless::soc::stm32f427::generated::rtc::{Register, isr, prer};
use rigless::soc::stm32f427::peripherals::rtc::Rtc;
use rigless::time::VirtualNanos;

/// The keys, in this order.
const KEYS: [u64; 2] = [0xCA, 0x53];

/// BYPSHAD (RTC_CR, bit 5).
const BYPSHAD: u64 = 1 << 5;

/// Cycles until the initialization mode begins.
const ENTRY: u128 = 2;

const NS: u128 = 1_000_000_000;

/// PRER out of reset (RTC_PRER).
const RATES: u64 = 0x007F_00FF;

/// The calendar.
#[derive(Debug)]
pub struct Calendar {
    model: Rtc,
    /// RTCCLK in Hz by the clock tree; 0 while it is off.
    pub hz: u64,
    /// The rate that the slow oscillator has instead.
    pub drift: Option<u64>,
    /// Cycles of RTCCLK up to an instant, in ns, and the rate since then.
    counted: (u128, u64),
    rate: u64,
    /// Keys that were right so far.
    keys: usize,
    /// PRER and CR.
    kept: [u64; 2],
    /// Cycles when INIT was set.
    entered: Option<u128>,
    /// Cycles at which the count began.
    begun: u128,
}

impl Calendar {
    /// Without a clock so far.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            model: Rtc,
            hz: 0,
            drift: None,
            counted: (0, 0),
            rate: 0,
            keys: 0,
            kept: [RATES, 0],
            entered: None,
            begun: 0,
        }
    }

    /// Takes the present rate over, from `at` on.
    pub fn advance(&mut self, at: u64) {
        let rate = if self.hz == 0 { 0 } else { self.drift.unwrap_or(self.hz) };
        if rate != self.rate {
            self.counted = (self.cycles(at), at);
            self.rate = rate;
        }
    }

    /// Cycles of RTCCLK up to `at`.
    fn cycles(&self, at: u64) -> u128 {
        self.counted.0 + u128::from(at.saturating_sub(self.counted.1)) * u128::from(self.rate) / NS
    }

    fn is_initializing(&self, at: u64) -> bool {
        self.entered.is_some_and(|entered| self.cycles(at) >= entered + ENTRY)
    }

    fn shown(&self, register: Register, registers: &RegisterFile, at: u64) -> Option<u64> {
        let [rates, control] = self.kept;
        match register {
            Register::Isr if self.is_initializing(at) => Some(registers.get(register) | isr::INITF.mask()),
            Register::Isr => Some(registers.get(register) & !isr::INITF.mask()),
            Register::Ssr if control & BYPSHAD != 0 => {
                let (slow, fast) = (prer::PREDIV_S.get(rates), prer::PREDIV_A.get(rates));
                let counts = (self.cycles(at) - self.begun) / u128::from(fast + 1);
                Some(slow - (counts % u128::from(slow + 1)) as u64)
            }
            _ => None,
        }
    }
}

impl Default for Calendar {
    fn default() -> Self {
        Self::new()
    }
}

impl Device for Calendar {
    type Register = Register;

    fn read(
        &mut self,
        register: Register,
        registers: &mut RegisterFile,
        context: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        self.advance(context.now().0);
        self.shown(register, registers, context.now().0)
    }

    fn peek(&self, register: Register, registers: &RegisterFile, now: VirtualNanos) -> Option<u64> {
        self.shown(register, registers, now.0)
    }

    fn write(&mut self, register: Register, value: u64, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        let at = context.now().0;
        self.advance(at);
        let (is_open, is_initializing) = (self.keys == KEYS.len(), self.is_initializing(at));
        match register {
            Register::Wpr => self.keys = if KEYS.get(self.keys) == Some(&value) { self.keys + 1 } else { 0 },
            Register::Isr if is_open && value & isr::INIT.mask() != 0 => {
                let cycles = self.cycles(at);
                self.entered.get_or_insert(cycles);
            }
            Register::Isr if is_open => {
                self.entered = None;
                self.begun = self.cycles(at);
            }
            Register::Prer if is_open && is_initializing => self.kept[0] = value,
            Register::Cr if is_open => self.kept[1] = value,
            _ => {}
        }
        let [rates, control] = self.kept;
        registers.set(Register::Prer, rates);
        registers.set(Register::Cr, control);
        Device::write(&mut self.model, register, value, registers, context);
    }

    fn on_request(&mut self, change: RequestChange, registers: &mut RegisterFile, context: &mut DeviceContext<'_>) {
        self.model.on_request(change, registers, context);
    }
}
