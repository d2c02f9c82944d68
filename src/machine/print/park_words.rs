//! Where the tool waits while a print is paused: the words of M125, M600 and M601.

use crate::gcode::{Number, TableCommand};

/// The words; as the machine is set where one is left out.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct ParkWords {
    /// X: the parking place.
    pub x: Option<Number>,
    /// Y: the same.
    pub y: Option<Number>,
    /// Z: the lift of the tool.
    pub z: Option<Number>,
    /// E, or L of M125: the length of filament to pull back.
    pub e: Option<Number>,
    /// R: the hotend's target when the print continues.
    pub target: Option<Number>,
    /// U of M600: the length of filament to pull out then.
    pub unload: Option<Number>,
    /// L of M600: the length to push in before the print continues; less than 0, it is Prusa's word for the length to
    /// pull out.
    pub load: Option<Number>,
    /// The letter of another word with a number, as of Marlin's M125 U.
    pub other: Option<u8>,
}

impl ParkWords {
    /// The words of M125, where L pulls back.
    pub fn of_pause(command: &TableCommand<'_>) -> Self {
        Self::read(command, b'L', b"XYZRLTBPS")
    }

    /// The words of M600 and M601.
    pub fn of_wait(command: &TableCommand<'_>) -> Self {
        let [unload, load] = command.numbers(b"UL");
        Self { unload, load, ..Self::read(command, b'E', b"XYZREULTBPS") }
    }

    /// `back` is the letter of the filament that is pulled back. T is a tool (there is only one); B beeps; P and S say
    /// whether to ask.
    fn read(command: &TableCommand<'_>, back: u8, known: &[u8]) -> Self {
        let [x, y, z, target, e] = command.numbers(&[b'X', b'Y', b'Z', b'R', back]);
        // Without a number it is a letter of a name: M600 AUTO.
        let others = command.words().filter(|word| word.number.is_some() && !known.contains(&word.letter));
        Self { x, y, z, target, e, other: others.last().map(|word| word.letter), ..Self::default() }
    }
}
