//! The servo line of a BLTouch: its pulses at rest, and machines that leave it alone.

use crate::common::{Bench, bench_of, firmware, print_on};
use corehbot_emulator::watch::End;
use corehbot_machine_file as machine_file;

/// A BLTouch on the Octopus.
const BLTOUCH: &str = "[endstops]\nprobe = \"BLTOUCH\"\n[probe]\nkind = \"bltouch\"\noffset = { z = -1.5 }\n";

/// How far a pulse may be off, in ns: two orders are 100 us apart.
const TOLERANCE_NS: u64 = 10_000;

/// At least five periods, and then the line is low.
#[test]
fn an_order_is_as_many_pulses_as_a_bltouch_hears() {
    let bench = bench_of(machine_file::load(BLTOUCH).unwrap());
    let seen = print_on(&firmware(), "M280 P0 S647\nG4 S1\nM280 P0 S1472\nG4 S1\n", &bench);
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    let of = |us: u64| seen.servo.pulses.iter().filter(|pulse| pulse.ns.abs_diff(us * 1000) <= TOLERANCE_NS).count();
    assert_eq!((of(647), of(1472), seen.servo.pulses.len()), (6, 6, 12));
}

/// The pin is left alone without a BLTouch.
#[test]
fn a_machine_without_a_bltouch_never_drives_the_line() {
    for file in ["", "[endstops]\nprobe = \"BLTOUCH\"\n[probe]\nkind = \"switch\"\n"] {
        let bench: Bench<'_> = bench_of(machine_file::load(file).unwrap());
        let seen = print_on(&firmware(), "M280 P0 S647\nG4 P300\n", &bench);
        assert!(!seen.servo.is_driven && seen.servo.pulses.is_empty());
    }
}
