//! Index words: letters with a number that selects one of several parts. A command for a part that is not there does
//! nothing and is refused by name; `M221 T1 S50` must not halve the flow of the only extruder.
//!
//! The rows of commands name them (`commands`, `Grammar::parts`), read against Marlin 2.1
//! (`get_target_extruder_from_command` and the `I`, `E` and `D` of its commands), RepRapFirmware 3 and
//! Prusa-Firmware-Buddy. Left out with a reason:
//!
//! - P of M106 and M107: the machine knows its number of fans (`machine::heat::fans`).
//! - I of M906 and M914: the machine knows the drivers of an axis (`machine::motors::drivers`).
//! - E of M303 and M306: 0, -1 and -2 are hotend, bed and chamber (`machine::heat::heater_settings`). T of M306
//!   requests a tuning, T of M204 and M205 is for travel.
//! - Reports (M105 T, M114, M122 P): their result does not depend on their words.
//! - Pauses (M600 T): a print that needs its user waits, for any tool.
//! - M104 T0, M106 P0, M200 D0, `G10 P0`, M141: slicers write them for machines with one extruder and no chamber.

use super::number::Number;
use crate::text::is_word;

/// The part that a word addresses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// An extruder; there is one.
    Extruder,
    /// A tool; there is one, and its answer has the words by which OctoPrint learns that.
    Tool,
    /// A heated bed, or a zone of it; there is one.
    Bed,
    /// A chamber; there is one.
    Chamber,
    /// A driver of an axis, where all drivers of an axis have one value.
    Driver,
    /// A fan.
    Fan,
    /// A motor, by its name.
    Motor,
    /// A set of temperatures for a material (Marlin); there is none.
    Preset,
    /// A heater by a number (RepRapFirmware); heaters have none.
    Heater,
    /// A value that M900 S chooses (Marlin, EXTRA_LIN_ADVANCE_K); there is one.
    Slot,
    /// The value that is not chosen (M900 L); there is none.
    Other,
}

impl Part {
    /// Whether a machine with one extruder has the part of that number.
    pub(super) fn is_there(self, number: Number) -> bool {
        match self {
            // A fraction names no extruder: `M900 K0.02 T0.03` has Klipper's smoothing time behind it.
            Self::Extruder if number != Number::from(number.to_int()) => true,
            Self::Extruder | Self::Tool | Self::Bed | Self::Chamber | Self::Slot => number == Number::ZERO,
            // -1 is all of them (Marlin, M906.cpp).
            Self::Driver => number == Number::ZERO || number == Number::from(-1),
            Self::Fan => true,
            Self::Motor | Self::Preset | Self::Heater | Self::Other => false,
        }
    }

    /// Its name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Extruder => "extruder",
            Self::Tool => "tool",
            Self::Bed => "bed",
            Self::Chamber => "chamber",
            Self::Driver => "driver of an axis",
            Self::Fan => "fan",
            Self::Motor => "motor",
            Self::Preset => "preset",
            Self::Heater => "heater",
            Self::Slot | Self::Other => "other K",
        }
    }
}

/// The command that a word stands behind.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Named {
    /// A letter and a number.
    Code(u8, u16),
    /// A name.
    Name(&'static str),
}

/// A word for a part that is not there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Absent<'a> {
    /// The command.
    pub command: Named,
    /// The part.
    pub part: Part,
    /// Its number or name as it was written, without its letter.
    pub which: &'a [u8],
}

impl Absent<'_> {
    /// A number that is the same for the same command, part and number: FNV-1a (Fowler, Noll and Vo; 32 bits).
    #[must_use]
    pub fn key(&self) -> u32 {
        let step = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        let [letter, high, low] = match self.command {
            Named::Code(letter, number) => {
                let [high, low] = number.to_be_bytes();
                [letter, high, low]
            }
            Named::Name(name) => name.bytes().fold([0; 3], |[a, b, c], byte| [b, c, a ^ byte]),
        };
        let text = [letter, high, low, self.part as u8].into_iter().chain(self.which.iter().copied());
        text.fold(0x811c_9dc5, step)
    }
}

/// The part that a word is for, if it is for one that is not there.
pub(super) fn absent(words: &[(u8, Part)], letter: u8, number: Option<Number>) -> Option<Part> {
    let (_, part) = words.iter().find(|(its, _)| *its == letter)?;
    number.filter(|number| !part.is_there(*number)).map(|_| *part)
}

/// The extruder of a named command, if it is one that is not there. Klipper calls the first one `extruder`.
#[must_use]
pub fn absent_extruder<'a>(command: &'static str, name: &'a [u8]) -> Option<Absent<'a>> {
    let is_there = is_word(name, b"extruder");
    (!is_there).then_some(Absent { command: Named::Name(command), part: Part::Extruder, which: name })
}
