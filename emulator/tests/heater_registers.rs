//! Bits that flip in the registers of the heaters' timers and pins: a pin is high for two control periods at most, and
//! the register is set right.

use crate::common::{Bench, MS, firmware, heated_bench, print_on};
use corehbot_emulator::heat_pins::{Climate, Edge};
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::{End, Flip, FlipEach, Injection};

/// Two control periods.
const LONGEST: u64 = 40 * MS;

/// TIM5, GPIOA and RCC (RM0390 rev 6, section 2.2.2).
const TIM5: u64 = 0x4000_0C00;
const GPIOA: u64 = 0x4002_0000;
const RCC: u64 = 0x4002_3800;

/// Both fields of pins 1 (the bed) and 2 (HE0) in a register with so many bits a pin.
const fn pins(bits: u32) -> u32 {
    ((1 << bits) - 1) << bits | ((1 << bits) - 1) << (2 * bits)
}

/// Registers with a right value, in a table of the manual's names. Bits that a register lacks are left out.
const KEPT: [(&str, u64, u32); 12] = [
    ("TIM5_CR1", TIM5, 0x03FF),
    ("TIM5_SMCR", TIM5 + 0x08, 0xFFF7),
    ("TIM5_DIER", TIM5 + 0x0C, 0x5F5F),
    ("TIM5_CCMR1", TIM5 + 0x18, 0xFFFF),
    ("TIM5_CCMR2", TIM5 + 0x1C, 0xFFFF),
    ("TIM5_CCER", TIM5 + 0x20, 0xBBBB),
    ("TIM5_PSC", TIM5 + 0x28, 0xFFFF),
    ("GPIOA_MODER", GPIOA, pins(2)),
    ("GPIOA_OTYPER", GPIOA + 0x04, pins(1)),
    ("GPIOA_PUPDR", GPIOA + 0x0C, pins(2)),
    ("GPIOA_AFRL", GPIOA + 0x20, pins(4)),
    ("RCC_APB1ENR", RCC + 0x40, 1 << 3),
];

/// Some bits of a value that each period writes.
const SOME: u32 = 0x8421_8421;

/// Registers that each period writes, or that count.
const WRITTEN: [(&str, u64, u32); 5] = [
    ("TIM5_CNT", TIM5 + 0x24, u32::MAX),
    ("TIM5_ARR", TIM5 + 0x2C, SOME),
    ("TIM5_CCR2", TIM5 + 0x38, SOME),
    ("TIM5_CCR3", TIM5 + 0x3C, SOME),
    ("RCC_APB1RSTR", RCC + 0x20, 1 << 3),
];

const fn without_names<const N: usize>(named: [(&str, u64, u32); N]) -> [(u64, u32); N] {
    let mut registers = [(0, 0); N];
    let mut n = 0;
    while n < N {
        registers[n] = (named[n].1, named[n].2);
        n += 1;
    }
    registers
}

static KEPT_REGISTERS: [(u64, u32); KEPT.len()] = without_names(KEPT);
static WRITTEN_REGISTERS: [(u64, u32); WRITTEN.len()] = without_names(WRITTEN);

/// A hotend that is held at 120 C while each of these bits flips, and then M122.
fn flip_each(registers: &'static [(u64, u32)]) -> Seen {
    let flips: u32 = registers.iter().map(|(_, mask)| 2 * mask.count_ones()).sum();
    // A flip, the wait for a pulse after it, and the start.
    let seconds = 4 + flips * 70 / 1000;
    let bench = Bench {
        injection: Some(Injection::FlipEach(FlipEach { after: 3000 * MS, every: 41 * MS, registers })),
        climate: Climate { start: Some([119.0, 25.0]), ..Climate::default() },
        ..heated_bench()
    };
    let seen = print_on(&firmware(), &format!("M104 S120\nG4 S{seconds}\nM122\n"), &bench);
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
    // A pin without a fitted heater may go high by such a bit too: its edges are measured like the others'.
    assert!(seen.resets.is_empty(), "{:?}", seen.resets);
    assert!(!seen.line.said.iter().any(|line| line.contains("[E")), "{:?}", seen.line.said);
    assert_eq!(seen.flips.len(), flips as usize, "all of them came");
    seen
}

/// How long a heater's pin was high without a break, in ns, at most, in the time of a flip.
fn longest_high(edges: &[Edge], flip: &Flip) -> u64 {
    let of_flip = |up: &Edge, down: u64| down > flip.at && up.at < flip.at + 41 * MS;
    let ups = edges.iter().enumerate().filter(|(_, edge)| edge.is_high);
    let highs = ups.filter_map(|(n, up)| {
        let down = edges[n..].iter().find(|edge| edge.output == up.output && !edge.is_high)?.at;
        of_flip(up, down).then_some(down - up.at)
    });
    highs.max().unwrap_or(0)
}

/// The hotend's own pulses at 120 C are shorter.
const PULSE: u64 = 6 * MS;

/// Says which bits did something, and returns the longest time.
fn report(seen: &Seen, named: &[(&str, u64, u32)]) -> u64 {
    let mut longest = 0;
    for flip in &seen.flips {
        let high = longest_high(&seen.heat.edges, flip);
        longest = longest.max(high);
        if high > PULSE {
            let name = named.iter().find(|(_, address, _)| *address == flip.address).unwrap().0;
            println!("{name} bit {}: high for {:.1} ms", flip.bit.trailing_zeros(), high as f64 / MS as f64);
        }
    }
    longest
}

#[test]
fn a_bit_that_flips_in_a_heaters_timer_or_pin_acts_for_two_control_periods_at_most() {
    let seen = flip_each(&KEPT_REGISTERS);
    let longest = report(&seen, &KEPT);
    // CEN is the count itself, which stops and starts.
    let is_count = |flip: &Flip| (flip.address, flip.bit) == (TIM5, 1);
    let not_back: Vec<_> = seen.flips.iter().filter(|flip| !flip.is_back && !is_count(flip)).collect();
    assert!(not_back.is_empty(), "{not_back:?}");
    assert!((18 * MS..=LONGEST).contains(&longest), "{longest} ns");
    let told = seen.line.said.iter().find(|line| line.contains("registers of the heaters")).expect("M122 tells it");
    println!("{} flips: {told}", seen.flips.len());
}

#[test]
fn a_bit_that_flips_in_the_count_or_in_what_each_period_writes_does_so_too() {
    let seen = flip_each(&WRITTEN_REGISTERS);
    let longest = report(&seen, &WRITTEN);
    assert!(longest <= LONGEST, "{longest} ns");
}
