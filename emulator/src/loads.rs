//! Loads: how the firmware drives the pins of heaters and fans, as outputs and through the chip's timers.

use crate::board::Emulated;
use crate::small_timers;
use crate::wiring::{Load, Pin, Timer};
use rigless::device::Level;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::gpioa::Register;
use rigless::soc::stm32f427::peripherals::tim;
use rigless::time::VirtualNanos;

/// The place of TIM1 among the advanced timers of the model, and of TIM2 among the general ones, which follow each
/// other.
const TIM1: usize = 0;
const TIM2: usize = 0;

/// Registers of a timer that drives pins (RM0390 rev 6, register maps of the timers).
const CR1: u64 = 0x00;
const CCER: u64 = 0x20;
const ARR: u64 = 0x2C;
const CCR1: u64 = 0x34;

/// CR1: the counter runs, and stops at its end by itself.
const CEN: u64 = 1;
const OPM: u64 = 1 << 3;

impl Emulated {
    /// Whether the firmware drives `load` high now.
    pub fn drives(&mut self, load: Load) -> bool {
        let (_, registers) = self.mcu.port(load.pin.port);
        match registers.get(Register::Moder) >> (2 * load.pin.bit) & 3 {
            1 => registers.get(Register::Odr) as u16 & load.pin.mask() != 0,
            2 => load.timer.is_some_and(|(timer, channel)| {
                self.function(load.pin) == timer.function() && self.puts_out(timer, channel) == Some(Level::High)
            }),
            _ => false,
        }
    }

    /// The level that a timer puts out on a channel; `None` if it drives none.
    fn puts_out(&mut self, timer: Timer, channel: u8) -> Option<Level> {
        let channel = tim::Channel::new(channel)?;
        let general = match timer {
            Timer::One => {
                let (timer, registers) = self.mcu.advanced_timer(TIM1);
                return timer.output(channel, registers);
            }
            Timer::OneComplementary => {
                let (timer, registers) = self.mcu.advanced_timer(TIM1);
                return timer.complementary_output(channel, registers);
            }
            Timer::Nine | Timer::Twelve => {
                let place = if timer == Timer::Nine { small_timers::TIM9 } else { small_timers::TIM12 };
                let (timer, registers) = self.mcu.small_timer(place)?;
                return timer.output(channel, registers);
            }
            Timer::Two => TIM2,
            Timer::Three => TIM2 + 1,
            Timer::Four => TIM2 + 2,
            Timer::Five => TIM2 + 3,
        };
        let (timer, registers) = self.mcu.timer(general);
        timer.output(channel, registers)
    }

    /// The number of a pin's alternate function.
    pub(crate) fn function(&mut self, pin: Pin) -> u64 {
        self.function_of(pin.port, pin.bit)
    }

    /// That of pin `bit` of port `n`.
    pub(crate) fn function_of(&mut self, n: usize, bit: u8) -> u64 {
        let (_, registers) = self.mcu.port(n);
        let word = registers.get(if bit < 8 { Register::Afrl } else { Register::Afrh });
        word >> (4 * (bit % 8)) & 0xF
    }

    /// The pulse that a channel of a timer puts out now or will before its counter stops: its begin and its end, in
    /// counts of the present period. A level that is high while the counter stands has no end, and neither has the
    /// pulse of a counter that does not stop by itself.
    pub fn pulse(&mut self, timer: Timer, channel: u8) -> Option<(u64, u64)> {
        let is_high = self.puts_out(timer, channel) == Some(Level::High);
        let mut peek = |offset| self.mcu.peek(VirtualNanos(0), timer.base() + offset, Width::W32).unwrap_or(0);
        let place = u64::from(channel) - 1;
        let is_enabled = peek(CCER) >> (4 * place) & 1 != 0;
        let (control, begin, end) = (peek(CR1), peek(CCR1 + 4 * place), peek(ARR) + 1);
        match (is_high, control & CEN != 0) {
            (true, false) => Some((0, u64::MAX)),
            (false, true) if !is_enabled || begin >= end => None,
            (_, true) if control & OPM == 0 => Some((0, u64::MAX)),
            (_, true) => Some((begin, end)),
            (false, false) => None,
        }
    }
}
