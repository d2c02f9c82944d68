//! M622, M623, `if`, `while` and the like: which lines run depends on it, and this firmware runs them all. So they end
//! the job. They are answered whatever words they have.

use crate::gcode::Entry;

pub(in crate::machine) const ROWS: &[Entry] = &[
    Entry::m("Refused", &[622, 623]).refused("a condition: the job ends, because the firmware cannot skip lines"),
    // Conditions and loops of RepRapFirmware.
    Entry::name("Refused", &["if", "elif", "else", "while", "break", "continue", "abort"]).refused("the same"),
];
