//! Rules for clocks that the chip does not enforce and a model does not know. A board that breaks one may start today
//! and fail tomorrow.
//!
//! Section numbers refer to RM0390 rev 6. Every write to RCC, PWR or the flash interface is checked, also the
//! bootloader's writes.
//!
//! | rule | section |
//! |---|---|
//! | ODEN and ODSWEN change, and PWR is reset, only while the system clock is HSI or HSE | 5.1.4, 5.4.1 |
//! | VOS changes only while the PLL is off | 5.4.1 |
//! | PLLCFGR changes only while the PLL is off; 2 <= PLLM, 50 <= PLLN <= 432, 2 <= PLLQ, 2 <= PLLR | 6.3.2 |
//! | the same for PLLSAI, which has no R, when it is switched on | 6.3.24 |
//! | inputs of PLLs 0.95 to 2.1 MHz, their oscillators 100 to 432 MHz | 6.3.2; datasheet, PLL characteristics |
//! | HSEBYP changes only while HSE is off, and is set if another chip gives its clock | 6.2.1, 6.3.1 |
//! | PLL and crystal stay on while the system clock comes from them | 6.3.1 |
//! | wait states: one for every 30 MHz of HCLK begun, less one, also for the clock that is asked for | 3.4.1 |
//! | TIM9 and TIM12 are used only while their clock is on, and at the rate of their model | 6.2, 6.3.13, 6.3.14 |
//! | HCLK, PCLK1, PCLK2 up to 168, 42, 84 MHz; with over-drive up to 180, 45, 90 MHz | 5.1.4, 6.2; datasheet |

use crate::board::Emulated;
use crate::small_timers;
use crate::wiring::{Hse, Timer};
use rigless::emulator::Access;
use rigless::mcu::Operate;
use rigless::soc::Width;
use std::fmt;

/// Where the registers are (section 2.2.2 and the register maps).
const RCC_CR: u64 = 0x4002_3800;
const RCC_PLLCFGR: u64 = 0x4002_3804;
const RCC_CFGR: u64 = 0x4002_3808;
const RCC_APB1RSTR: u64 = 0x4002_3820;
const RCC_PLLSAICFGR: u64 = 0x4002_3888;
const PWR_CR: u64 = 0x4000_7000;
const PWR_CSR: u64 = 0x4000_7004;
const FLASH_ACR: u64 = 0x4002_3C00;

/// PWR_CR (section 5.4.1).
const VOS: u64 = 3 << 14;
const OVER_DRIVE: u64 = 3 << 16;

/// PWR_CSR (section 5.4.2): ODSWRDY.
const ODSWRDY: u64 = 1 << 17;

/// RCC_APB1RSTR (section 6.3.8).
const PWRRST: u64 = 1 << 28;

/// RCC_CR (section 6.3.1).
const HSEON: u64 = 1 << 16;
const HSEBYP: u64 = 1 << 18;
const PLLON: u64 = 1 << 24;
const PLLSAION: u64 = 1 << 28;

/// FLASH_ACR (section 3.8.1): ICEN and DCEN; ICRST and DCRST are two places above them.
const CACHES: u64 = 3 << 9;

/// The internal oscillator (section 6.2.2).
const HSI_HZ: u64 = 16_000_000;

/// HCLK that a wait state is good for, at 2.7 V or more (section 3.4.1).
const HZ_PER_WAIT_STATE: u64 = 30_000_000;

/// A rule that was broken.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Rule {
    /// Over-drive was switched while the PLL is the system clock.
    OverDrive,
    /// PWR was reset while the PLL is the system clock.
    PowerReset,
    /// The voltage scale changed while the PLL is on.
    VoltageScale,
    /// The PLL's factors changed while it is on.
    Locked,
    /// A factor of a PLL is out of range.
    Factor(&'static str, u64),
    /// A frequency in a PLL is out of range, in Hz.
    Frequency(&'static str, u64),
    /// The source of the system clock was switched off.
    InUse(&'static str),
    /// HSE was switched on with a crystal taken for a clock or a clock for a crystal, or HSEBYP changed while it is on.
    Bypass,
    /// Wait states that are set, and wait states that are needed.
    WaitStates(u64, u64),
    /// A clock is faster than it may be, in Hz.
    TooFast(&'static str, u64),
    /// A small timer was used while its clock is off, or has another rate than its model.
    Unclocked(&'static str),
    /// A cache was emptied while it was on.
    CacheInUse,
    /// A cache was switched on with lines from before.
    StaleCache,
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OverDrive => {
                f.write_str("over-drive switched while the system clock comes from the PLL (RM0390, 5.4.1)")
            }
            Self::PowerReset => f.write_str(
                "PWR reset, and over-drive with it, while the system clock comes from the PLL (RM0390, 5.4.1)",
            ),
            Self::VoltageScale => f.write_str("VOS changed while the PLL is on (RM0390, 5.4.1)"),
            Self::Locked => f.write_str("PLLCFGR changed while the PLL is on (RM0390, 6.3.2)"),
            Self::Factor(name, value) => write!(f, "{name} = {value} is out of range (RM0390, 6.3.2, 6.3.24)"),
            Self::Frequency(name, hz) => {
                write!(f, "{name} at {hz} Hz is out of range (datasheet, PLL characteristics)")
            }
            Self::InUse(name) => write!(f, "{name} switched off while the system clock comes from it (RM0390, 6.3.1)"),
            Self::Bypass => {
                f.write_str("HSEBYP is not for the source that HSE has, or changed while HSE is on (RM0390, 6.3.1)")
            }
            Self::WaitStates(has, needs) => {
                write!(f, "{has} wait states of flash, the clock needs {needs} (RM0390, 3.4.1)")
            }
            Self::Unclocked(name) => {
                write!(f, "{name} used without a clock or at a rate unknown to its model (RM0390, 6.2)")
            }
            Self::CacheInUse => f.write_str("a cache of flash emptied while it is on (RM0390, 3.8.1)"),
            Self::StaleCache => f.write_str("a cache of flash switched on again without emptying it (RM0390, 3.8.1)"),
            Self::TooFast(name, hz) => write!(f, "{name} at {hz} Hz is too fast (RM0390, 5.1.4, 6.2)"),
        }
    }
}

/// A broken rule, and the code that broke it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Breach {
    /// When, in ns.
    pub at: u64,
    /// The instruction.
    pub from: u64,
    /// The rule.
    pub rule: Rule,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} ms, from {:#010x}: {}", self.at as f64 / 1e6, self.from, self.rule)
    }
}

/// The registers that the rules are about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Registers {
    cr: u64,
    pllcfgr: u64,
    cfgr: u64,
    pllsaicfgr: u64,
    acr: u64,
    power: u64,
    power_status: u64,
}

/// Out of reset (sections 3.8.1, 5.4.1, 5.4.2, 6.3.1 to 6.3.3, 6.3.24).
const RESET: Registers = Registers {
    cr: 0x83,
    pllcfgr: 0x2400_3010,
    cfgr: 0,
    pllsaicfgr: 0x2400_3000,
    acr: 0,
    power: 0xC000,
    power_status: 0,
};

/// Watches over the rules.
#[derive(Debug)]
pub struct ClockRules {
    hse: Hse,
    before: Registers,
    /// Caches that were on since they were emptied, as their bits of ACR.
    used_caches: u64,
    /// The broken rules, each once.
    pub breaches: Vec<Breach>,
}

impl ClockRules {
    /// A watch over a chip out of reset with that source of the high-speed clock.
    #[must_use]
    pub const fn new(hse: Hse) -> Self {
        Self { hse, before: RESET, used_caches: 0, breaches: Vec::new() }
    }

    /// The chip was reset.
    pub fn reset(&mut self) {
        (self.before, self.used_caches) = (RESET, 0);
    }

    /// The firmware wrote to a register.
    pub fn written(&mut self, board: &mut Emulated, access: &Access) {
        let small = [Timer::Nine, Timer::Twelve].iter().position(|timer| timer.has(access.address));
        if let Some(timer) = small.map(|place| &small_timers::ALL[place]) {
            let (register, bit) = timer.enable;
            let is_on = board.mcu.peek(access.virtual_time, register, Width::W32).unwrap_or(0) & bit != 0;
            if !is_on || 2 * board.mcu.rates()[timer.apb] != timer.hz {
                self.note(access, Rule::Unclocked(timer.name));
            }
        }
        if !matches!(access.address & !0x3FF, 0x4002_3800 | 0x4002_3C00 | 0x4000_7000) {
            return;
        }
        let mut peek = |address| board.mcu.peek(access.virtual_time, address, Width::W32).unwrap_or(0);
        let now = Registers {
            cr: peek(RCC_CR),
            pllcfgr: peek(RCC_PLLCFGR),
            cfgr: peek(RCC_CFGR),
            pllsaicfgr: peek(RCC_PLLSAICFGR),
            acr: peek(FLASH_ACR),
            power: peek(PWR_CR),
            power_status: peek(PWR_CSR),
        };
        for rule in self.judge(access.address, access.value, &now) {
            self.note(access, rule);
        }
    }

    /// Notes that an access breaks a rule; a clock that is too fast is so at the next write, too.
    fn note(&mut self, access: &Access, rule: Rule) {
        if self.breaches.iter().all(|earlier| earlier.rule != rule) {
            let from = access.program_counter.unwrap_or(0);
            self.breaches.push(Breach { at: access.virtual_time.0, from, rule });
        }
    }

    /// The rules that a write of `value` breaks; afterwards the registers are `now`.
    fn judge(&mut self, address: u64, value: u64, now: &Registers) -> Vec<Rule> {
        let before = std::mem::replace(&mut self.before, *now);
        let mut broken = Vec::new();
        match address {
            PWR_CR => {
                if now.is_on_pll() && (value ^ before.power) & OVER_DRIVE != 0 {
                    broken.push(Rule::OverDrive);
                }
                if now.cr & PLLON != 0 && (value ^ before.power) & VOS != 0 {
                    broken.push(Rule::VoltageScale);
                }
            }
            FLASH_ACR => {
                let (were_on, are_on, emptied) = (before.acr & CACHES, value & CACHES, value >> 2 & CACHES);
                if emptied & were_on != 0 {
                    broken.push(Rule::CacheInUse);
                }
                self.used_caches &= !emptied;
                if are_on & !were_on & self.used_caches != 0 {
                    broken.push(Rule::StaleCache);
                }
                self.used_caches |= are_on;
            }
            RCC_APB1RSTR if now.is_on_pll() && value & PWRRST != 0 => broken.push(Rule::PowerReset),
            RCC_PLLCFGR => {
                if now.cr & PLLON != 0 && value != before.pllcfgr {
                    broken.push(Rule::Locked);
                }
                broken.extend(self.pll(value, "PLL").into_iter().chain(factor("PLLR", value >> 28 & 7)));
            }
            RCC_CR => {
                if now.is_on_pll() && value & PLLON == 0 {
                    broken.push(Rule::InUse("the PLL"));
                }
                if now.is_from_crystal() && value & HSEON == 0 {
                    broken.push(Rule::InUse("the crystal"));
                }
                let is_bypassed = value & HSEBYP != 0;
                let is_wrong = value & !before.cr & HSEON != 0 && is_bypassed != matches!(self.hse, Hse::Clock(_));
                if is_wrong || before.cr & HSEON != 0 && (value ^ before.cr) & HSEBYP != 0 {
                    broken.push(Rule::Bypass);
                }
                if value & !before.cr & PLLSAION != 0 {
                    // The source is the PLL's.
                    broken.extend(self.pll(now.pllsaicfgr & !(1 << 22) | now.pllcfgr & 1 << 22, "PLLSAI"));
                }
            }
            _ => {}
        }
        // The source in SW takes effect without a write once it is ready.
        let (wanted, source) = (now.cfgr & 3, now.cfgr >> 2 & 3);
        for source in [Some(source), Some(wanted).filter(|wanted| *wanted != source)].into_iter().flatten() {
            let hclk = self.hclk(source, now);
            let needs = hclk.saturating_sub(1) / HZ_PER_WAIT_STATE;
            if now.acr & 0xF < needs {
                broken.push(Rule::WaitStates(now.acr & 0xF, needs));
            }
            let is_driven = now.power_status & ODSWRDY != 0;
            let most: [u64; 3] = if is_driven { [180, 45, 90] } else { [168, 42, 84] };
            let buses = [hclk, hclk / apb(now.cfgr >> 10), hclk / apb(now.cfgr >> 13)];
            for ((name, hz), most) in ["HCLK", "PCLK1", "PCLK2"].into_iter().zip(buses).zip(most) {
                if hz > most * 1_000_000 {
                    broken.push(Rule::TooFast(name, hz));
                }
            }
        }
        broken
    }

    /// Broken rules about the factors that two PLLs have in the same places.
    fn pll(&self, factors: u64, which: &'static str) -> Vec<Rule> {
        let (m, n) = (factors & 0x3F, factors >> 6 & 0x1FF);
        let mut broken: Vec<_> = factor("PLLM", m).into_iter().chain(factor("PLLQ", factors >> 24 & 0xF)).collect();
        if !(50..=432).contains(&n) {
            broken.push(Rule::Factor("PLLN", n));
        }
        if broken.is_empty() {
            let input = self.source(factors) / m;
            if !(950_000..=2_100_000).contains(&input) {
                broken.push(Rule::Frequency(which, input));
            } else if !(100_000_000..=432_000_000).contains(&(input * n)) {
                broken.push(Rule::Frequency(which, input * n));
            }
        }
        broken
    }

    /// The input frequency of the PLLs.
    const fn source(&self, pllcfgr: u64) -> u64 {
        if pllcfgr & 1 << 22 == 0 { HSI_HZ } else { self.hse.hz() }
    }

    /// HCLK if the system clock came from `source`, which is numbered as in SW.
    fn hclk(&self, source: u64, now: &Registers) -> u64 {
        let vco = || self.source(now.pllcfgr) * (now.pllcfgr >> 6 & 0x1FF) / (now.pllcfgr & 0x3F).max(1);
        let system = match source {
            0 => HSI_HZ,
            1 => self.hse.hz(),
            2 => vco() / (2 * (now.pllcfgr >> 16 & 3) + 2),
            _ => vco() / (now.pllcfgr >> 28 & 7).max(1),
        };
        // HPRE (section 6.3.3): there is no 32.
        match now.cfgr >> 4 & 0xF {
            hpre @ 8..=11 => system >> (hpre - 7),
            hpre @ 12..=15 => system >> (hpre - 6),
            _ => system,
        }
    }
}

impl Registers {
    /// The system clock comes from either output of the PLL (section 6.3.3, SWS).
    const fn is_on_pll(&self) -> bool {
        self.cfgr >> 3 & 1 != 0
    }

    /// The system clock comes from the crystal, by the PLL or not.
    const fn is_from_crystal(&self) -> bool {
        self.cfgr >> 2 & 3 == 1 || (self.is_on_pll() && self.pllcfgr & 1 << 22 != 0)
    }
}

/// A factor that must be 2 or more.
fn factor(name: &'static str, value: u64) -> Option<Rule> {
    (value < 2).then_some(Rule::Factor(name, value))
}

/// The divisor for the three bits of PPRE1 or PPRE2 (section 6.3.3).
const fn apb(bits: u64) -> u64 {
    match bits & 7 {
        ppre @ 4.. => 1 << (ppre - 3),
        _ => 1,
    }
}

#[cfg(test)]
#[path = "clock_rules_tests.rs"]
mod tests;
