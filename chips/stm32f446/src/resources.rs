//! Which peripheral does which job: alternate functions, DMA streams, timers and interrupts.
//!
//! Plain numbers and names, so that a host test can compare them with the chip description behind stm32-metapac
//! (`tests/chip.rs`); the code uses these.

use crate::wiring::{FanTimer, HeaterTimer, Usart};

/// USART1 to 3 (STM32F446 datasheet, table of alternate functions).
pub const USART_FUNCTION: u8 = 7;

/// I2C1 to 3 (the same table).
pub const I2C_FUNCTION: u8 = 4;

/// SPI3 on PB3 to PB5 and PC10 to PC12 (the same table).
pub const SPI_FUNCTION: u8 = 6;

/// OTG_FS (the same table).
pub const USB_FUNCTION: u8 = 10;

/// The timer of a heater, and its alternate function (the same table).
#[must_use]
pub const fn heater_timer(timer: HeaterTimer) -> (&'static str, u8) {
    match timer {
        HeaterTimer::Three => ("TIM3", 2),
        HeaterTimer::Five => (HEAT, 2),
        HeaterTimer::Twelve => ("TIM12", 9),
    }
}

/// The timer of a fan, its alternate function (the same table), and the letter after its channel; `None` for a fan that
/// is only switched.
#[must_use]
pub const fn fan_timer(timer: FanTimer) -> Option<(&'static str, u8, &'static str)> {
    match timer {
        FanTimer::One => Some(("TIM1", 1, "")),
        FanTimer::OneComplementary => Some(("TIM1", 1, "N")),
        FanTimer::Two => Some((TIME, 1, "")),
        FanTimer::Four => Some(("TIM4", 2, "")),
        FanTimer::Nine => Some(("TIM9", 3, "")),
        FanTimer::None => None,
    }
}

/// A stream of a DMA controller, and which of its peripherals it serves.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Channel {
    /// DMA1 or DMA2.
    pub controller: u8,
    /// The stream.
    pub stream: usize,
    /// The manual's name for the channel: the request that the stream listens to.
    pub request: u8,
}

/// ADC3 (RM0390, table of DMA2 requests).
pub const CONVERTER: Channel = Channel { controller: 2, stream: 0, request: 2 };

/// The receiver of a USART (RM0390, tables of DMA1 and DMA2 requests). USART1 uses stream 5 and not 2, which TIM8 and
/// the second ADC may want. No other user of stream 5 is in use here: neither TIM1 nor SPI1.
#[must_use]
pub const fn receiver(usart: Usart) -> Channel {
    match usart {
        Usart::One => Channel { controller: 2, stream: 5, request: 4 },
        Usart::Two => Channel { controller: 1, stream: 5, request: 4 },
    }
}

/// The accelerometer's bus.
pub const SENSOR_BUS: &str = "SPI3";

/// Bytes from the accelerometer, and bytes to it (RM0390, table of DMA1 requests). The other streams of SPI3 are 2, and
/// 5, which a USART has.
pub const SENSOR_INPUT: Channel = Channel { controller: 1, stream: 0, request: 0 };
/// See [`SENSOR_INPUT`].
pub const SENSOR_OUTPUT: Channel = Channel { controller: 1, stream: 7, request: 0 };

/// Timers, and the bus that each is on: APB1 or APB2.
pub const TIMERS: [(&str, u8); 10] = [
    (TIME, 1),
    (DRIVER_BITS, 2),
    (HEAT, 1),
    (TACHOMETERS, 1),
    (SAMPLING, 1),
    ("TIM1", 2),
    (SERVO, 1),
    ("TIM4", 1),
    ("TIM9", 2),
    ("TIM12", 1),
];

/// The time. Its 32 bits count as 16. The two heaters of the Spider on TIM3 leave that timer to them, and no
/// board here needs a channel of TIM2 for a heater.
pub const TIME: &str = "TIM2";
/// Bits to and from the motor drivers.
pub const DRIVER_BITS: &str = "TIM8";

/// Looks at tachometers.
pub const TACHOMETERS: &str = "TIM7";

/// Begins transfers from an accelerometer.
pub const SAMPLING: &str = "TIM6";

/// The control period, and the pulses of heaters on its pins. Besides TIM2 this is the only timer with 32 bits on the
/// Octopus's heater pins, and on TIM2 two pairs of heaters would share channels.
pub const HEAT: &str = "TIM5";

/// The pulses of a servo, on a board without heaters on that timer.
pub const SERVO: &str = "TIM3";

/// An interrupt in use: its owner, its purpose, and its number in the vector table.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// The peripheral.
    pub peripheral: &'static str,
    /// The event that it signals.
    pub signal: &'static str,
    /// Its number.
    pub number: u16,
}

const fn source(peripheral: &'static str, signal: &'static str, number: u16) -> Source {
    Source { peripheral, signal, number }
}

/// The interrupts in use besides the core's own timer (SysTick), which triggers steps. The supply's interrupt comes
/// through line 16 of EXTI, which the chip description leaves out, so it goes by its name.
pub const SOURCES: [Source; 14] = [
    source("PVD", "", 1),
    source(SERVO, "UP", 29),
    source(TIME, "UP", 28),
    source("USART1", "GLOBAL", 37),
    source("USART2", "GLOBAL", 38),
    source("DMA2", "CH5", 68),
    source("DMA1", "CH5", 16),
    source("USB_OTG_FS", "GLOBAL", 67),
    source(DRIVER_BITS, "UP", 44),
    source(TACHOMETERS, "UP", 55),
    source(SAMPLING, "UP", 54),
    source("DMA1", "CH0", 11),
    source("CAN2", "SCE", 66),
    source(HEAT, "UP", 50),
];
