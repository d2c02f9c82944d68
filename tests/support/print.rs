//! Printing: a command as the shortest G-code that reads back as the same command.

mod flaws;
mod words;

use core::fmt::{self, Display, Formatter};

use corehbot::gcode::{ArcShape, ArcWords, Command, MoveCommand, Number};
use flaws::malformed;
pub use words::reduced;
use words::{axes, decimals_of, padded, word, write_text};

/// A command to be printed. One that represents a whole family is printed as one of it: M74 for silent ones. A line
/// that is not in order is printed as one with the same flaw. In a text, `?` stands for every byte that is neither
/// printable ASCII nor a blank.
///
/// A command of the table is printed as the line that it was read from, reduced, unless its words are a text.
pub struct Printed<'c>(pub Command<'c>, pub &'c [u8]);

impl Display for Printed<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0 {
            Command::Move(command) => make(f, command),
            Command::Table(command) if command.takes_text() => {
                // A byte order mark may stand before the code.
                let line = self.1.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(self.1);
                // The bytes of a no-break space are blanks.
                let blank = |byte: &u8| if matches!(byte, 0xC2 | 0xA0) { b' ' } else { *byte };
                write_text(f, &line.iter().map(blank).collect::<Vec<_>>())
            }
            Command::Table(_) => reduced(f, self.1),
            Command::Condition => f.write_str("M622"),
            Command::Malformed(flaw) => malformed(f, flaw),
            Command::Silent => f.write_str("M74"),
            Command::Unknown(text) => write_text(f, text),
        }
    }
}

fn make(f: &mut Formatter<'_>, command: MoveCommand) -> fmt::Result {
    match command {
        MoveCommand::Line { rapid, to, feed } => {
            f.write_str(if rapid { "G0" } else { "G1" })?;
            axes(f, to)?;
            word(f, 'F', feed)
        }
        MoveCommand::Circulate { to, belt, feed } => {
            f.write_str("G1")?;
            axes(f, to)?;
            word(f, 'C', Some(belt))?;
            word(f, 'F', feed)
        }
        MoveCommand::Arc(ArcWords { clockwise, to, feed, shape, turns, decimals }) => {
            f.write_str(if clockwise { "G2" } else { "G3" })?;
            let (i, j, k, r) = match shape {
                ArcShape::Centre { i, j, k } => (Some(i), Some(j), Some(k).filter(|k| *k != Number::ZERO), None),
                ArcShape::Radius(r) => (None, None, None, Some(r)),
                ArcShape::Missing => (None, None, None, None),
            };
            let all = [('X', to.x), ('Y', to.y), ('Z', to.z), ('I', i), ('J', j), ('K', k), ('R', r)];
            let mut words: Vec<_> = all.into_iter().filter_map(|(l, n)| Some(format!("{l}{}", n?))).collect();
            // One has as many decimals as the line has to show.
            let shown = words.iter().map(|word| decimals_of(word)).max();
            if let Some(last) = words.last_mut().filter(|_| shown < Some(usize::from(decimals))) {
                *last = padded(last, usize::from(decimals));
            }
            words.iter().try_for_each(|word| write!(f, " {word}"))?;
            word(f, 'E', to.e)?;
            if turns > 1 {
                write!(f, " P{turns}")?;
            }
            word(f, 'F', feed)
        }
    }
}
