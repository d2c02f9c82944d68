//! Errors of G-code files, in words for the person who has the file.

use crate::plate::Plate;
use corehbot_machine_file::file_kind::{FileKind, WrongFile};
use std::fmt::{self, Display};
use std::io;

/// Why there is no text.
#[derive(Debug)]
pub enum GcodeFileError {
    /// It cannot be read, or the text not be written.
    Io(io::Error),
    /// It is something else.
    Wrong(WrongFile),
    /// It is damaged: where, and how.
    Damaged(String),
    /// It is packed in a way that nothing here reads.
    Unknown(String),
    /// It inflates to more bytes than these.
    TooLong(u64),
    /// A packed file in a packed file.
    Nested(FileKind),
    /// It has these plates, and none is chosen.
    Several(Vec<Plate>),
    /// It has these plates, and not the chosen one.
    NoPlate(u32, Vec<Plate>),
    /// A plate is chosen of a file that has none.
    NoPlates,
    /// No file in the archive is G-code.
    Unsliced,
}

impl GcodeFileError {
    /// Damage at a place.
    pub(crate) fn damaged(text: impl Into<String>) -> Self {
        Self::Damaged(text.into())
    }
}

/// Numbers as people list them.
fn listed(plates: &[Plate]) -> String {
    let numbers: Vec<_> = plates.iter().map(|plate| plate.number.to_string()).collect();
    match numbers.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("plates {} and {last}", rest.join(", ")),
        Some((last, _)) => format!("plate {last}"),
        None => "no plate".to_owned(),
    }
}

impl Display for GcodeFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Wrong(wrong) => wrong.fmt(f),
            Self::Damaged(how) => write!(f, "the file is damaged: {how}; copy or export it again"),
            Self::Unknown(how) => write!(f, "{how}; export plain G-code"),
            Self::TooLong(most) => write!(f, "it inflates to more than {} MiB, which no print needs", most >> 20),
            Self::Nested(kind) => write!(f, "in it is {}; unpack it first", kind.name()),
            Self::Several(plates) => write!(f, "it has {}; choose one by --plate N", listed(plates)),
            Self::NoPlate(number, plates) => write!(f, "it has no plate {number}, but {}", listed(plates)),
            Self::NoPlates => f.write_str("--plate is for a .3mf with several plates"),
            Self::Unsliced => {
                f.write_str("there is no G-code in this archive: slice the project, and export the sliced file")
            }
        }
    }
}

impl std::error::Error for GcodeFileError {}

impl From<WrongFile> for GcodeFileError {
    fn from(wrong: WrongFile) -> Self {
        Self::Wrong(wrong)
    }
}

impl From<io::Error> for GcodeFileError {
    /// Readers of packed data tell damage, and `Bounded` its bound, by errors of input.
    fn from(error: io::Error) -> Self {
        use io::ErrorKind::{FileTooLarge, InvalidData, InvalidInput, UnexpectedEof};
        match error.kind() {
            FileTooLarge => match error.get_ref().and_then(|why| why.to_string().parse().ok()) {
                Some(most) => Self::TooLong(most),
                None => Self::Io(error),
            },
            UnexpectedEof => Self::damaged("its end is missing"),
            InvalidData | InvalidInput => Self::Damaged(error.to_string()),
            _ if error.get_ref().is_some_and(|why| why.is::<rawzip::Error>()) => Self::Damaged(error.to_string()),
            _ => Self::Io(error),
        }
    }
}
