//! M999 after a stop: the chip resets with motors and heaters off, and the host is greeted again.

use crate::common::{Bench, firmware, print_on};
use corehbot_emulator::line::Manner;
use corehbot_emulator::watch::End;

#[test]
fn m999_resets_the_chip_and_the_host_is_greeted_again() {
    // M112 acts as soon as it has arrived. The comments take a second on the line, and M17 gives power in that time.
    let filling = ";---------------------------------------------------------------\n".repeat(384);
    let gcode = format!("M17\nG1 X60 F600\n{filling}M112\nM999\n");
    let manner = Manner { is_impatient: true, ..Manner::default() };
    let seen = print_on(&firmware(), &gcode, &Bench { manner, ..Bench::default() });
    let said = &seen.line.said;
    assert_eq!((seen.end, seen.resets.len()), (End::Reset, 1), "{said:?}");
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert!(seen.safety.powered.is_empty() && !seen.safety.is_hot());
    let had_power = seen.safety.switched.iter().any(|(_, on)| !on.is_empty());
    assert!(had_power, "{:?}", seen.safety.switched);
    assert_eq!(said.iter().filter(|line| *line == "start").count(), 2, "{said:?}");
    // A requested reset needs no reason.
    assert!(!said.iter().any(|line| line.contains("the last reset came")), "{said:?}");
}
