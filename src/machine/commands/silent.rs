//! Quiet commands: hosts and slicers send them, but this machine has nothing to do for them.
//!
//! An echo for each would flood the host's console and cost link time. Only commands that change nothing on the plate
//! are here: a command with a missing effect that a user must know of is answered in words.

use crate::gcode::{Entry, Grammar, Number, Part, Verdict, numbers};

const FAMILY: &str = "Accepted silently";

const fn quiet(numbers: &'static [u16], why: &'static str) -> Entry {
    Entry::m(FAMILY, numbers).silently(why)
}

/// Unless a row gives another reason, it asks for a part (lamp, beeper, display, power switch, second extruder) that
/// this machine does not have. A code with a meaning that it did not have before leaves this table.
pub(in crate::machine) const ROWS: &[Entry] = &[
    quiet(&[2], "end of program: the end of the file is the end").examples(&[("M2", &[])]),
    quiet(&[20, 21], "card: there is none; hosts send these when they connect").examples(&[("M20", &[]), ("M21", &[])]),
    quiet(&[74], "weight of the print (Prusa)").examples(&[("M74 W12.5", &[])]),
    quiet(&[76], "stops a job timer; the print goes on").examples(&[("M76", &[])]),
    quiet(&[80], "power supply on: it is on").examples(&[("M80", &[])]),
    quiet(&[142], "heatbreak temperature (Prusa): no such sensor").examples(&[("M142 S36", &[])]),
    quiet(&[150, 355], "lamps: none").examples(&[("M150 R255", &[]), ("M355 S1", &[])]),
    quiet(&[200], "volumetric extrusion off (`D0`, `S0`); with a diameter or S1 it is unknown")
        .grammar(&Grammar::numbers(b"").parts(&[(b'T', Part::Extruder)]))
        .judge(|_, text| if is_volumetric(text) { Verdict::Unknown } else { Verdict::Silent })
        .examples(&[("M200 D0", &[])]),
    quiet(&[202], "travel acceleration (Repetier): M204 T does that").examples(&[("M202 X5000", &[])]),
    quiet(&[217], "tool change: one tool").examples(&[("M217 S10", &[])]),
    quiet(&[240], "photo: no camera").examples(&[("M240", &[])]),
    quiet(&[300], "beeper: none").examples(&[("M300 S440 P100", &[])]),
    quiet(&[403], "filament of a multi-material unit: none").examples(&[("M403 E0 F0", &[])]),
    quiet(&[425], "backlash compensation: none").examples(&[("M425 F1", &[])]),
    quiet(&[530, 532], "print mode and progress (Repetier): not shown")
        .examples(&[("M530 S1", &[]), ("M532 X50", &[])]),
    quiet(&[862], "asks whether nozzle, model and firmware fit (PrusaSlicer, with a subcode)")
        .with_subcodes()
        .examples(&[("M862.1 P0.4", &[]), ("M862.3 P \"MK4S\"", &[])]),
    quiet(&[870], "Prusa's own").examples(&[("M870", &[])]),
    quiet(&[907], "motor current by a potentiometer: M906 sets it").examples(&[("M907 E500", &[])]),
    Entry::g(FAMILY, &[12]).silently("nozzle wiper: none").examples(&[("G12", &[])]),
    // The names of a print's objects, and the begin and end of each. Nothing here depends on it.
    Entry::name(FAMILY, &["EXCLUDE_OBJECT_START", "EXCLUDE_OBJECT_END"])
        .silently("names of objects: not used")
        .examples(&[("EXCLUDE_OBJECT_START NAME=cube", &[]), ("EXCLUDE_OBJECT_END NAME=cube", &[])]),
];

/// Whether M200 requests volumetric extrusion, which would print wrongly if it were ignored: a diameter or S1.
/// `M200 D0` and `M200 S0` are how slicers make sure that it is off.
fn is_volumetric(text: &[u8]) -> bool {
    let [switch, diameter] = numbers(text, b"SD");
    switch.or(diameter).is_some_and(|number| number != Number::ZERO)
}
