//! Every rule for clocks, kept and broken.

use super::*;

/// Factors of 180 MHz from 12 MHz: M, N, P, Q, R are 6, 180, 2, 8, 2.
const FACTORS: u64 = 6 | 180 << 6 | 1 << 22 | 8 << 24 | 2 << 28;

/// A write.
type Write = (u64, u64);

/// To 180 MHz as the manual has it: crystal, PLL, over-drive, wait states, switch (5.1.4, "Entering Over-drive mode").
const UP: [Write; 8] = [
    (RCC_CR, 0x83 | HSEON),
    (RCC_PLLCFGR, FACTORS),
    (RCC_CR, 0x83 | HSEON | PLLON),
    (PWR_CR, VOS | 1 << 16),
    (PWR_CR, VOS | OVER_DRIVE),
    (PWR_CSR, ODSWRDY),
    (FLASH_ACR, 5),
    (RCC_CFGR, 0x9402),
];

/// And back.
const DOWN: [Write; 4] = [(RCC_CFGR, 0x9400), (RCC_CR, 0x83), (RCC_APB1RSTR, PWRRST), (FLASH_ACR, 0)];

/// The rules that `writes` break on a chip in which every write has its effect at once.
fn breaks(writes: &[Write]) -> Vec<Rule> {
    let mut rules = ClockRules::new(Hse::Crystal(12_000_000));
    let mut now = RESET;
    let mut broken = Vec::new();
    for &(address, value) in writes {
        match address {
            RCC_CR => now.cr = value,
            RCC_PLLCFGR => now.pllcfgr = value,
            RCC_CFGR => now.cfgr = value | value << 2 & 0xC,
            RCC_PLLSAICFGR => now.pllsaicfgr = value,
            RCC_APB1RSTR => (now.power, now.power_status) = (RESET.power, 0),
            PWR_CR => now.power = value,
            PWR_CSR => now.power_status = value,
            FLASH_ACR => now.acr = value,
            _ => unreachable!(),
        }
        broken.extend(rules.judge(address, value, &now));
    }
    broken
}

/// The rules that `UP` breaks with another write number `n`.
fn broken_by(n: usize, write: Write) -> Vec<Rule> {
    let mut writes = UP;
    writes[n] = write;
    breaks(&writes)
}

/// The rules that a write breaks at 180 MHz.
fn broken_at_180_mhz(write: Write) -> Vec<Rule> {
    breaks(&[&UP[..], &[write]].concat())
}

#[test]
fn the_manuals_way_up_and_down_breaks_nothing() {
    assert_eq!(breaks(&[UP.as_slice(), &DOWN, &UP, &DOWN].concat()), []);
    assert_eq!(broken_by(7, (RCC_CFGR, 0x9403)), [], "the other output of the PLL");
}

#[test]
fn over_drive_is_not_switched_at_180_mhz() {
    for power in [VOS, VOS | 1 << 16, VOS | 2 << 16] {
        assert_eq!(broken_at_180_mhz((PWR_CR, power)), [Rule::OverDrive]);
    }
    assert_eq!(broken_at_180_mhz((PWR_CR, VOS | OVER_DRIVE | 1 << 8)), [], "another bit of the register");
}

#[test]
fn over_drive_is_not_switched_from_output_r_either() {
    let mut writes = UP.to_vec();
    writes[7] = (RCC_CFGR, 0x9403);
    writes.push((PWR_CR, VOS));
    assert_eq!(breaks(&writes), [Rule::OverDrive]);
}

#[test]
fn power_is_not_reset_at_180_mhz() {
    let broken = broken_at_180_mhz((RCC_APB1RSTR, PWRRST));
    assert_eq!(broken[0], Rule::PowerReset);
    assert!(broken.contains(&Rule::TooFast("HCLK", 180_000_000)), "{broken:?}");
    assert_eq!(broken_at_180_mhz((RCC_APB1RSTR, 0)).first(), Some(&Rule::TooFast("HCLK", 180_000_000)));
    assert_eq!(breaks(&[(RCC_APB1RSTR, PWRRST)]), [], "at HSI");
}

#[test]
fn the_voltage_scale_waits_for_the_pll_to_be_off() {
    assert_eq!(breaks(&[UP[0], UP[1], UP[2], (PWR_CR, 1 << 14)]), [Rule::VoltageScale]);
    assert_eq!(breaks(&[UP[0], UP[1], (PWR_CR, 1 << 14)]), []);
}

#[test]
fn factors_do_not_change_under_a_running_pll() {
    assert_eq!(breaks(&[UP[0], UP[1], UP[2], (RCC_PLLCFGR, FACTORS ^ 1 << 16)]), [Rule::Locked]);
    assert_eq!(breaks(&[UP[0], UP[1], UP[2], UP[1]]), [], "the same again");
}

#[test]
fn every_factor_has_its_range() {
    let with = |shift: u32, width: u32, value: u64| FACTORS & !(((1 << width) - 1) << shift) | value << shift;
    for (name, factors, value) in [
        ("PLLM", with(0, 6, 1), 1),
        ("PLLM", with(0, 6, 0), 0),
        ("PLLN", with(6, 9, 49), 49),
        ("PLLN", with(6, 9, 433), 433),
        ("PLLQ", with(24, 4, 1), 1),
        ("PLLQ", with(24, 4, 0), 0),
        ("PLLR", with(28, 3, 1), 1),
        ("PLLR", with(28, 3, 0), 0),
    ] {
        assert_eq!(breaks(&[(RCC_PLLCFGR, factors)]), [Rule::Factor(name, value)]);
    }
    // The values that embassy-stm32 0.6.0 writes if the firmware does not ask for Q and R.
    let both = [Rule::Factor("PLLQ", 0), Rule::Factor("PLLR", 0)];
    assert_eq!(breaks(&[(RCC_PLLCFGR, 6 | 180 << 6 | 1 << 22)]), both);
}

#[test]
fn a_pll_has_its_frequencies() {
    let too_slow = FACTORS & !0x3F | 13;
    assert_eq!(breaks(&[(RCC_PLLCFGR, too_slow)]), [Rule::Frequency("PLL", 923_076)]);
    let too_fast = FACTORS & !0x3F | 5;
    assert_eq!(breaks(&[(RCC_PLLCFGR, too_fast)]), [Rule::Frequency("PLL", 2_400_000)]);
    let oscillator = FACTORS & !(0x1FF << 6) | 217 << 6;
    assert_eq!(breaks(&[(RCC_PLLCFGR, oscillator)]), [Rule::Frequency("PLL", 434_000_000)]);
}

#[test]
fn the_second_pll_is_looked_at_when_it_is_switched_on() {
    let on = (RCC_CR, 0x83 | HSEON | PLLSAION);
    let usb = 6 | 96 << 6 | 1 << 16 | 4 << 24;
    assert_eq!(breaks(&[UP[1], (RCC_PLLSAICFGR, usb), on]), []);
    // Out of reset it has no PLLM.
    assert_eq!(breaks(&[UP[1], on]), [Rule::Factor("PLLM", 0)]);
    assert_eq!(breaks(&[UP[1], (RCC_PLLSAICFGR, usb ^ 4 << 24), on]), [Rule::Factor("PLLQ", 0)]);
}

#[test]
fn what_the_system_runs_from_stays_on() {
    assert_eq!(broken_at_180_mhz((RCC_CR, 0x83 | HSEON)), [Rule::InUse("the PLL")]);
    assert_eq!(broken_at_180_mhz((RCC_CR, 0x83 | PLLON)), [Rule::InUse("the crystal")]);
    assert_eq!(breaks(&[UP[0], (RCC_CFGR, 1), (RCC_CR, 0x83)]), [Rule::InUse("the crystal")]);
}

#[test]
fn the_wait_states_come_before_the_clock_and_go_after_it() {
    assert!(broken_by(6, (FLASH_ACR, 4)).contains(&Rule::WaitStates(4, 5)));
    assert_eq!(broken_at_180_mhz((FLASH_ACR, 4)), [Rule::WaitStates(4, 5)]);
    // 30 MHz need no wait state, one Hz more needs one: 180 MHz by 4 and by 8.
    let by = |hpre: u64, acr| breaks(&[&UP[..6], &[(FLASH_ACR, acr), (RCC_CFGR, 2 | hpre << 4)]].concat());
    assert_eq!(by(9, 1), []);
    assert_eq!(by(9, 0), [Rule::WaitStates(0, 1)]);
    assert_eq!(by(10, 0), []);
}

#[test]
fn a_clock_that_is_only_asked_for_counts() {
    let mut rules = ClockRules::new(Hse::Crystal(12_000_000));
    let now = Registers { cfgr: 2, pllcfgr: FACTORS, power_status: ODSWRDY, ..RESET };
    assert!(rules.judge(RCC_CFGR, 2, &now).contains(&Rule::WaitStates(0, 5)));
}

#[test]
fn the_oscillator_is_bypassed_for_a_clock_and_only_for_that() {
    let broken = |hse, writes: &[u64]| {
        let mut rules = ClockRules::new(hse);
        let each = writes.iter().flat_map(|cr| rules.judge(RCC_CR, *cr, &Registers { cr: *cr, ..RESET }));
        each.collect::<Vec<_>>()
    };
    let bypassed = [0x83 | HSEBYP, 0x83 | HSEBYP | HSEON];
    for (hse, right, wrong) in [
        (Hse::Crystal(12_000_000), &[0x83 | HSEON][..], &bypassed[..]),
        (Hse::Clock(8_000_000), &bypassed[..], &[0x83 | HSEON][..]),
    ] {
        assert_eq!((broken(hse, right), broken(hse, wrong)), (vec![], vec![Rule::Bypass]), "{hse:?}");
    }
    assert_eq!(broken(Hse::Clock(8_000_000), &[bypassed[1], 0x83 | HSEON]), [Rule::Bypass]);
}

#[test]
fn the_buses_have_their_limits() {
    assert_eq!(broken_by(7, (RCC_CFGR, 0x8002)), [Rule::TooFast("PCLK1", 180_000_000)]);
    assert_eq!(broken_by(7, (RCC_CFGR, 0x1402)), [Rule::TooFast("PCLK2", 180_000_000)]);
    // Without over-drive.
    let tame: Vec<_> = UP.into_iter().filter(|write| write.0 != PWR_CSR).collect();
    let all = [("HCLK", 180), ("PCLK1", 45), ("PCLK2", 90)].map(|(name, mhz)| Rule::TooFast(name, mhz * 1_000_000));
    assert_eq!(breaks(&tame), all);
    // 168 MHz may do without.
    let slower = (RCC_PLLCFGR, FACTORS & !(0x1FF << 6) | 168 << 6);
    let tame: Vec<_> = tame.into_iter().map(|write| if write.0 == RCC_PLLCFGR { slower } else { write }).collect();
    assert_eq!(breaks(&tame), []);
}

#[test]
fn a_breach_says_who_and_what() {
    let breach = Breach { at: 1_234_567, from: 0x0800_9ABC, rule: Rule::OverDrive };
    let text =
        "1.235 ms, from 0x08009abc: over-drive switched while the system clock comes from the PLL (RM0390, 5.4.1)";
    assert_eq!(breach.to_string(), text);
}

#[test]
fn caches_are_emptied_while_they_are_off_before_they_are_on_again() {
    let [on, off, empty] = [7 << 8 | 5, 5, 3 << 11 | 5].map(|value| (FLASH_ACR, value));
    assert_eq!(broken_at_180_mhz(on), []);
    let again = |writes: &[Write]| breaks(&[&UP[..], writes].concat());
    assert_eq!(again(&[on, off, empty, off, on]), []);
    assert_eq!(again(&[on, off, on]), [Rule::StaleCache]);
    assert_eq!(again(&[on, (FLASH_ACR, 1 << 11 | on.1)]), [Rule::CacheInUse]);
    // Only one of them was emptied.
    assert_eq!(again(&[on, off, (FLASH_ACR, 1 << 11 | 5), off, on]), [Rule::StaleCache]);
}
