//! The processor's clock against the slow oscillator. Only the difference shows, so the slow one is moved here.

use crate::common::{Bench, MS, firmware, heated_bench, print_on};
use corehbot_emulator::heat_pins::Climate;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::{End, Injection};

/// By then its rate is known, in ns.
const KNOWN: u64 = 1700 * MS;

/// A machine that heats and stands for so many seconds, while the slow oscillator gets another rate.
fn run(after: u64, hz: u64, seconds: u32) -> Seen {
    let bench = Bench {
        injection: Some(Injection::SlowOscillator { after, hz }),
        climate: Climate { start: Some([100.0, 25.0]), ..Climate::default() },
        ..heated_bench()
    };
    let seen = print_on(&firmware(), &format!("M104 S100\nM17\nG4 S{seconds}\nM122\n"), &bench);
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    assert!(seen.resets.is_empty(), "{:?}", seen.resets);
    seen
}

fn says(seen: &Seen, words: &str) -> bool {
    seen.line.said.iter().any(|line| line.contains(words))
}

#[test]
fn a_clock_that_is_off_by_more_than_a_tenth_ends_heat_and_motion_in_two_seconds() {
    for hz in [35_500, 28_500, 0] {
        let seen = run(KNOWN, hz, 4);
        assert!(says(&seen, "[E21]"), "{hz} Hz: {:?}", seen.line.said);
        let at = seen.injected.expect("another rate");
        let off = seen.heat.off_since().expect("heaters that are off");
        println!("{hz} Hz: off after {} ms", (off - at) / MS);
        assert!(off > at && off - at < 2100 * MS && seen.safety.powered.is_empty());
    }
}

#[test]
fn a_slow_oscillator_that_drifts_by_less_and_any_that_the_data_sheet_allows_are_no_fault() {
    for (after, hz) in [(KNOWN, 34_500), (KNOWN, 29_500), (0, 17_000), (0, 47_000)] {
        let seen = run(after, hz, if after == 0 { 2 } else { 4 });
        assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{hz} Hz: {:?}", seen.line.said);
        assert!(!says(&seen, "[E21]") && !says(&seen, "not checked"), "{hz} Hz: {:?}", seen.line.said);
    }
}

#[test]
fn a_gross_error_at_the_start_is_found() {
    for hz in [11_000, 70_000] {
        let seen = run(0, hz, 3);
        assert!(says(&seen, "[E21]"), "{hz} Hz: {:?}", seen.line.said);
    }
}

/// A calendar that never counts proves nothing about the clock: the print goes on, and M122 tells.
#[test]
fn a_clock_that_cannot_be_checked_is_told_of() {
    let seen = run(0, 0, 1);
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
    assert!(!says(&seen, "[E21]"), "{:?}", seen.line.said);
    assert!(says(&seen, "echo:the processor's clock is not checked"), "{:?}", seen.line.said);
}
