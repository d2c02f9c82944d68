//! Small timers: TIM6, TIM7, TIM9 and TIM12, which the crate has as registers only.
//!
//! TIM6 and TIM7 have no channel, and an interrupt at the end of each period (RM0390 rev 6, the chapter of TIM6 and
//! TIM7). The others have two channels, count 16 bits up, and have the one-pulse mode (RM0390 rev 6, the chapter of
//! TIM9 to TIM14). The crate models such a timer for another part (its `Kind::TwoChannelSlave`); here it answers from
//! the F427's layout. It runs at the rate that the image's clocks give the timer. Neither timer runs before that, and a
//! rule of [`clock_rules`](crate::clock_rules) finds an access without a clock. The reset bits of RCC do not reach it;
//! a reset of the chip does.

use rigless::device::RegisterFile;
use rigless::soc::st::tim::{Counter, Family, Kind, Part, Tim, Timer};
use rigless::soc::stm32f427::generated::{tim6, tim9};
use rigless::soc::stm32f427::peripherals::tim::PART;

/// Timers with two channels.
#[derive(Clone, Copy, Debug)]
pub struct TwoChannels;

impl Family for TwoChannels {
    type Register = tim9::Register;
    type Instance = Timer;
    const PART: &'static Part = &PART;
    const KINDS: &'static [Kind] = &[Kind::TwoChannelSlave];
}

/// A timer of this kind.
pub type SmallTimer = Tim<TwoChannels>;

/// Timers without channels.
#[derive(Clone, Copy, Debug)]
pub struct NoChannels;

impl Family for NoChannels {
    type Register = tim6::Register;
    type Instance = Timer;
    const PART: &'static Part = &PART;
    const KINDS: &'static [Kind] = &[Kind::Basic];
}

/// A timer of this kind.
pub type BasicTimer = Tim<NoChannels>;

/// The names of the basic timers.
pub const BASIC: [&str; 2] = ["TIM6", "TIM7"];

/// They out of reset, at their rate once the image's clocks run (RM0390 rev 6, section 6.2).
#[must_use]
pub fn basic() -> [BasicTimer; BASIC.len()] {
    BASIC.map(|name| Tim::with_clock(90_000_000, Timer::new(name, Counter::Narrow, Kind::Basic)))
}

/// A timer and its registers.
pub type WithRegisters<'a> = (&'a mut SmallTimer, &'a mut RegisterFile);

/// A timer of the part.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its name in the crate's tables.
    pub name: &'static str,
    /// Its rate in Hz (RM0390 rev 6, section 6.2, figure of the clock tree).
    pub hz: u64,
    /// The bus that it is on, APB1 or APB2: its clock is twice this bus's.
    pub apb: usize,
    /// The register with its clock's bit, and the bit (sections 6.3.13 and 6.3.14).
    pub enable: (u64, u64),
}

/// The timers.
pub const ALL: [Row; 2] = [
    Row { name: "TIM9", hz: 180_000_000, apb: 2, enable: (0x4002_3844, 1 << 16) },
    Row { name: "TIM12", hz: 90_000_000, apb: 1, enable: (0x4002_3840, 1 << 6) },
];

/// Places in that table.
pub const TIM9: usize = 0;
/// See [`TIM9`].
pub const TIM12: usize = 1;

/// The timers out of reset.
#[must_use]
pub fn new() -> [SmallTimer; ALL.len()] {
    ALL.map(|row| Tim::with_clock(row.hz, Timer::new(row.name, Counter::Narrow, Kind::TwoChannelSlave)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::Chip;
    use rigless::device::{Level, ResetCause};
    use rigless::mcu::{Mcu as _, Operate as _};
    use rigless::soc::Width;
    use rigless::soc::stm32f427::peripherals::tim::Channel;
    use rigless::time::VirtualNanos;

    /// TIM12's CR1, EGR, CCMR1, CCER, PSC, ARR and CCR2 (RM0390 rev 6, the register map of TIM9 and TIM12).
    const CR1: u64 = 0x4000_1800;
    const EGR: u64 = CR1 + 0x14;
    const CCMR1: u64 = CR1 + 0x18;
    const CCER: u64 = CR1 + 0x20;
    const PSC: u64 = CR1 + 0x28;
    const ARR: u64 = CR1 + 0x2C;
    const CCR2: u64 = CR1 + 0x38;

    fn write(chip: &mut Chip, at: u64, address: u64, value: u64) {
        chip.write(VirtualNanos(at), address, Width::W32, value).unwrap();
    }

    fn level(chip: &mut Chip, at: u64) -> Option<Level> {
        chip.advance_to(VirtualNanos(at));
        let (timer, registers) = chip.small_timer(TIM12).unwrap();
        timer.output(Channel::new(2).unwrap(), registers)
    }

    /// A period of 60,000 counts of 30 cycles is 20 ms; a pulse of the last 15,000 begins after 15 ms.
    fn pulse() -> Chip {
        let mut chip = Chip::new().unwrap();
        chip.check().unwrap();
        // One pulse, preloads, PWM mode 2 on channel 2.
        for (address, value) in
            [(CR1, 0x8C), (PSC, 29), (ARR, 59_999), (CCR2, 45_000), (CCMR1, 0x7800), (EGR, 1), (CCER, 0x10)]
        {
            write(&mut chip, 0, address, value);
        }
        write(&mut chip, 0, CR1, 0x8D);
        chip
    }

    #[test]
    fn a_pulse_ends_with_the_period_and_the_counter_stops() {
        let mut chip = pulse();
        for (at, high) in [(0, false), (14_999_000, false), (15_001_000, true), (19_999_000, true), (20_001_000, false)]
        {
            assert_eq!(level(&mut chip, at) == Some(Level::High), high, "{at}");
        }
        assert_eq!(chip.read(VirtualNanos(20_002_000), CR1, Width::W32).unwrap() & 1, 0, "it has stopped");
        assert_eq!(level(&mut chip, 90_000_000), Some(Level::Low));
    }

    #[test]
    fn a_reset_of_the_chip_ends_a_pulse() {
        let mut chip = pulse();
        assert_eq!(level(&mut chip, 16_000_000), Some(Level::High));
        chip.reset(VirtualNanos(16_000_000), ResetCause::Core);
        assert_eq!(level(&mut chip, 16_000_001), None);
    }
}
