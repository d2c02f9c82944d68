//! Loads: how the firmware drives the pins of heaters and fans, as outputs and through the chip's timers.

use crate::board::Emulated;
use crate::wiring::{Load, Pin, Timer};
use rigless::device::Level;
use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::gpioa::Register;
use rigless::soc::stm32f427::generated::tim2;
use rigless::soc::stm32f427::peripherals::tim;
use rigless::time::VirtualNanos;

/// Places of TIM1 among the advanced timers of the model, and of TIM4 and TIM5 among the general ones.
const TIM1: usize = 0;
const TIM4: usize = 2;
const TIM5: usize = 3;

/// CR1, CCER, ARR and CCR1 of TIM9 (RM0390 rev 6, section 2.2.2 and the chapter of TIM9 to TIM14).
const TIM9: [u64; 4] = [0x4001_4000, 0x4001_4020, 0x4001_402C, 0x4001_4034];

impl Emulated {
    /// How the firmware drives `load` now: 0 is off, 1 on. For a timer without a model it is the share of the time.
    pub fn drives(&mut self, at: VirtualNanos, load: Load) -> f64 {
        let (_, registers) = self.mcu.port(load.pin.port);
        match registers.get(Register::Moder) >> (2 * load.pin.bit) & 3 {
            1 => f64::from(registers.get(Register::Odr) as u16 & load.pin.mask() != 0),
            2 => load.timer.map_or(0.0, |timer| self.timer_drives(at, load.pin, timer)),
            _ => 0.0,
        }
    }

    fn timer_drives(&mut self, at: VirtualNanos, pin: Pin, (timer, channel): (Timer, u8)) -> f64 {
        if self.function(pin) != timer.function() {
            return 0.0;
        }
        let Some(channel) = tim::Channel::new(channel) else { return 0.0 };
        let level = match timer {
            Timer::Nine => return self.share_of_tim9(at),
            Timer::One => {
                let (timer, registers) = self.mcu.advanced_timer(TIM1);
                timer.output(channel, registers)
            }
            Timer::Four | Timer::Five => {
                let (timer, registers) = self.mcu.timer(if timer == Timer::Four { TIM4 } else { TIM5 });
                timer.output(channel, registers)
            }
        };
        f64::from(level == Some(Level::High))
    }

    /// The share of the time that the first channel of TIM9 is on, from its registers: PWM mode 1 (RM0390, TIM9).
    fn share_of_tim9(&mut self, at: VirtualNanos) -> f64 {
        let [control, enable, reload, compare] =
            TIM9.map(|address| self.mcu.peek(at, address, Width::W32).unwrap_or(0));
        if control & 1 == 0 || enable & 1 == 0 {
            return 0.0;
        }
        (compare as f64 / (reload as f64 + 1.0)).min(1.0)
    }

    /// The number of a pin's alternate function.
    pub(crate) fn function(&mut self, pin: Pin) -> u64 {
        let (_, registers) = self.mcu.port(pin.port);
        let word = registers.get(if pin.bit < 8 { Register::Afrl } else { Register::Afrh });
        word >> (4 * (pin.bit % 8)) & 0xF
    }

    /// The pulse that a channel of TIM5 puts out now or will before its counter stops: its begin and its end, in counts
    /// of the present period. A level that is high while the counter stands has no end.
    pub fn pulse(&mut self, channel: u8) -> Option<(u64, u64)> {
        let number = tim::Channel::new(channel)?;
        let (timer, registers) = self.mcu.timer(TIM5);
        let is_high = timer.output(number, registers) == Some(Level::High);
        let enabled = registers.get(tim2::Register::Ccer) >> (4 * (u32::from(channel) - 1)) & 1 != 0;
        let compare = [tim2::Register::Ccr1, tim2::Register::Ccr2, tim2::Register::Ccr3, tim2::Register::Ccr4];
        let (begin, end) = (registers.get(compare[usize::from(channel) - 1]), registers.get(tim2::Register::Arr) + 1);
        let is_running = registers.get(tim2::Register::Cr1) & 1 != 0;
        match (is_high, is_running) {
            (true, false) => Some((0, u64::MAX)),
            (false, true) if !enabled || begin >= end => None,
            (_, true) => Some((begin, end)),
            (false, false) => None,
        }
    }
}
