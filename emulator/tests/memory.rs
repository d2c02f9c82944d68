//! RAM that is damaged: found before anything starts, and within 11 s while the firmware runs. Heaters and motors are
//! off, and the hosts are told.

use crate::common::{Bench, MS, firmware, heated_bench, print_on};
use corehbot_emulator::heat_pins::Climate;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::{BadWord, Damage, End, Injection};

/// Words that no other code writes often: at the end of the stack above its guard, and the last of RAM.
const STACK: u64 = 0x2000_0404;
const LAST: u64 = 0x2001_FFF0;

/// A whole walk: 8,128 rows, 16 in each control period of 20 ms.
const WALK: u64 = 10_160 * MS;

/// Damage to a machine that heats and stands.
fn damaged(after: u64, address: u64, damage: Damage) -> Seen {
    let bench = Bench {
        injection: Some(Injection::BadWord(BadWord { after, address, damage })),
        climate: Climate { start: Some([100.0, 25.0]), ..Climate::default() },
        after_reset: 300 * MS,
        whole: if after == 0 { 1500 * MS } else { 20_000 * MS },
        ..heated_bench()
    };
    print_on(&firmware(), "M104 S100\nM17\nG4 S15\n", &bench)
}

fn says(seen: &Seen, words: &str) -> bool {
    seen.line.said.iter().any(|line| line.contains(words))
}

#[test]
fn a_cell_that_breaks_while_the_printer_heats_is_found_in_eleven_seconds() {
    let seen = damaged(1500 * MS, LAST, Damage::Low(1 << 31));
    assert_eq!(seen.end, End::Reset, "{:?}", seen.line.said);
    let (at, reset) = (seen.injected.expect("damage"), seen.resets[0].at.0);
    println!("reset after {} ms", (reset - at) / MS);
    assert!(reset - at < WALK + 100 * MS);
    let off = seen.heat.off_since().expect("heaters that are off");
    assert!(off <= reset && !seen.safety.is_hot() && seen.safety.powered.is_empty());
    // The start finds it again, and only talks.
    assert!(says(&seen, &format!("came after memory at {LAST:08x} does not keep its bits")), "{:?}", seen.line.said);
    assert!(says(&seen, &format!("Error:memory at {LAST:08x} does not keep its bits, heaters and motors stay off")));
}

#[test]
fn a_board_with_damaged_memory_does_not_start() {
    let cases = [
        (STACK, Damage::Low(1), 0x2000_0400_u64),
        (LAST, Damage::High(1 << 16), LAST),
        // A line of the address that has no effect: two words are one.
        (0x2001_0400, Damage::Mirrored(0x2000_0400), 0x2000_0400),
    ];
    for (address, damage, row) in cases {
        let seen = damaged(0, address, damage);
        println!("{damage:?} at {address:08x}: {:?}", seen.line.said);
        assert!(says(&seen, &format!("Error:memory at {row:08x} does not keep its bits")), "{:?}", seen.line.said);
        assert!(seen.heat.edges.is_empty() && seen.safety.switched.is_empty(), "no heat and no motor");
    }
}
