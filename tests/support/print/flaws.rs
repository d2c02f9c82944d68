//! Lines that are not in order, as the shortest line with the same flaw.

use core::fmt::{self, Formatter, Write};

use super::words::write_text;
use corehbot::gcode::{Absent, Flaw, Named, Part};

/// A line with that flaw.
pub fn malformed(f: &mut Formatter<'_>, flaw: Flaw<'_>) -> fmt::Result {
    match flaw {
        Flaw::NoWord(text) | Flaw::SecondCommand(text) => {
            f.write_str("G1 ")?;
            write_text(f, text)?;
            // The letter may be one that G1 ignores.
            f.write_str(if matches!(flaw, Flaw::NoWord(_)) { " %" } else { "" })
        }
        Flaw::OutOfRange(text) => {
            f.write_str(match text {
                [b'f' | b'F', ..] => "M593 ",
                [b'r' | b'R', ..] => "G28 ",
                _ => "G4 ",
            })?;
            write_text(f, text)
        }
        Flaw::NoPair(_) => f.write_str("SET_VELOCITY_LIMIT ACCEL="),
        Flaw::NoNumber(letter) => {
            f.write_str(match letter {
                b'S' | b'T' | b'B' => "M205 ",
                b'D' => "M593 ",
                b'W' => "M572 ",
                b'A' | b'C' | b'H' | b'L' => "M306 ",
                _ => "G2 ",
            })?;
            f.write_char(letter as char)
        }
        Flaw::NoAxis(letter) => write!(f, "G92 {}0", letter as char),
        Flaw::Absent(absent) => absent_part(f, absent),
    }
}

/// A line for a part that is not there.
fn absent_part(f: &mut Formatter<'_>, Absent { command, part, which }: Absent<'_>) -> fmt::Result {
    match command {
        Named::Code(b'T', number) => return write!(f, "T{number}"),
        Named::Name(name) => write!(f, "{name} EXTRUDER=")?,
        Named::Code(letter, number) => {
            let word = match (part, number) {
                (Part::Extruder, 17 | 18 | 84 | 301) => 'E',
                (Part::Extruder, 572) => 'D',
                (Part::Tool, 116 | 207 | 208) | (Part::Bed | Part::Chamber, _) => 'P',
                (Part::Preset | Part::Driver, _) => 'I',
                (Part::Heater, _) => 'H',
                (Part::Slot, _) => 'S',
                (Part::Other, _) => 'L',
                _ => 'T',
            };
            write!(f, "{}{number} {word}", letter as char)?;
        }
    }
    write_text(f, which)
}
