//! Kinds of files, by their content: what a file is, and what to do with it.
//!
//! People give a command or the page a file of the wrong kind: a configuration in place of G-code, a model in place of
//! its sliced file. Both then say what the file is and which command takes it, in the words of this table.
//!
//! Names and endings count for nothing. A text is judged by its first bytes ([`START`]); a configuration has
//! to be whole in them.

use crate::{configuration_h, keys, marlin, reprap};
use std::fmt::{self, Display};

/// Bytes from the begin of a file that tell its kind.
pub const START: usize = 1 << 20;

/// Lines in which a text shows what it is.
const LINES: usize = 2000;

/// What a file is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(missing_docs, reason = "`name` says each")]
pub enum FileKind {
    Gcode,
    MachineFile,
    PrinterCfg,
    ConfigurationH,
    Settings,
    SettingCommands,
    ConfigG,
    BinaryGcode,
    Gzip,
    Zip,
    Report,
    Page,
    Trace,
    Recording,
    Packed,
    Csv,
    Json,
    Model,
    Utf16,
    Utf32,
    Program,
    Document,
    Picture,
    Archive,
    Folder,
    Empty,
    Text,
    Binary,
}

/// Each kind's name, and what to do with such a file.
const KINDS: [(FileKind, &str, &str); 28] = [
    (FileKind::Gcode, "G-code", "`corehbot run FILE` prints it"),
    (FileKind::MachineFile, "a machine file", "`--machine FILE` takes it, and `corehbot config check FILE` checks it"),
    (FileKind::PrinterCfg, "Klipper's printer.cfg", FROM),
    (FileKind::ConfigurationH, "Marlin's Configuration.h", FROM),
    (FileKind::Settings, "a printer's answer to M503", FROM),
    (FileKind::SettingCommands, "commands that set a machine", FROM),
    (FileKind::ConfigG, "RepRapFirmware's config.g", FROM),
    (FileKind::BinaryGcode, "binary G-code (.bgcode)", "`corehbot run FILE` prints it"),
    (
        FileKind::Gzip,
        "a file packed by gzip",
        "`corehbot run FILE` prints it if it is G-code, else unpack it by `gunzip`",
    ),
    (
        FileKind::Zip,
        "a ZIP archive (.3mf, .zip)",
        "`corehbot run FILE` prints the G-code in a sliced .3mf; any other one is to be unpacked",
    ),
    (
        FileKind::Report,
        "a page of `corehbot` with figures",
        "a browser shows it; the G-code that was printed is another file",
    ),
    (FileKind::Page, "a web page (HTML)", "a browser shows it"),
    (FileKind::Trace, "a step trace", "`corehbot twin run FILE` plays it"),
    (FileKind::Recording, "a recording of an accelerometer", "`corehbot resonance FILE` reads it"),
    (
        FileKind::Packed,
        "a file packed by zstd",
        "`corehbot resonance FILE` reads Shake&Tune's .stdata; unpack others by `unzstd`",
    ),
    (FileKind::Csv, "a table (CSV)", "a spreadsheet opens it"),
    (FileKind::Json, "JSON", "it is for programs"),
    (FileKind::Model, "a model (STL, STEP)", "slice it first, then give the G-code"),
    (FileKind::Utf16, "text in UTF-16", "save it as UTF-8, or use `iconv -f UTF-16 -t UTF-8 FILE`"),
    (FileKind::Utf32, "text in UTF-32", "save it as UTF-8, or use `iconv -f UTF-32 -t UTF-8 FILE`"),
    (FileKind::Program, "a program (ELF)", "an image of the firmware runs with `cargo xtask emulate`"),
    (FileKind::Document, "a PDF document", "a viewer shows it"),
    (FileKind::Picture, "a picture", "a viewer shows it"),
    (FileKind::Archive, "packed by bzip2, xz or 7-Zip", "unpack it first"),
    (
        FileKind::Folder,
        "a folder",
        "give a file in it; `corehbot config from FOLDER` takes the folder of a printer.cfg",
    ),
    (FileKind::Empty, "an empty file", "save it again where it was made"),
    (FileKind::Text, "a text without anything known in it", "look whether it is the right file"),
    (FileKind::Binary, "binary data", "look whether it is the right file"),
];

/// What to do with another firmware's settings.
const FROM: &str = "`corehbot config from FILE` makes a machine file of it";

/// Kinds by the first bytes of their files.
const BEGINS: [(&[u8], FileKind); 16] = [
    (b"GCDE", FileKind::BinaryGcode),
    (b"PK\x03\x04", FileKind::Zip),
    (b"PK\x05\x06", FileKind::Zip),
    (b"\x1f\x8b", FileKind::Gzip),
    (b"\x28\xb5\x2f\xfd", FileKind::Packed),
    (b"BZh", FileKind::Archive),
    (b"\xfd7zXZ\0", FileKind::Archive),
    (b"7z\xbc\xaf\x27\x1c", FileKind::Archive),
    (b"\xff\xfe\0\0", FileKind::Utf32),
    (b"\x7fELF", FileKind::Program),
    (b"%PDF", FileKind::Document),
    (b"\x89PNG", FileKind::Picture),
    (b"\xff\xd8\xff", FileKind::Picture),
    (b"solid ", FileKind::Model),
    (b"ISO-10303-21", FileKind::Model),
    (b"# corehbot-trace", FileKind::Trace),
];

/// Sections of a printer.cfg that no machine file has as a table.
const OF_KLIPPER: [&str; 8] = ["printer", "mcu", "include", "stepper_", "gcode_macro", "tmc", "extruder", "heater_"];

/// Keys and tables of a machine file that are no settings of the firmware.
const OF_OURS: [&str; 5] = ["name", "board", "mechanism", "motors", "twin"];

/// First lines of recordings and their spectra.
const OF_RECORDINGS: [&str; 3] = ["#time,accel_x", "sample,x,y,z", "freq,psd_"];

impl FileKind {
    /// The kind of a file of `length` bytes by its first [`START`] bytes, or all that it has.
    #[must_use]
    pub fn of(start: &[u8], length: u64) -> Self {
        if let Some((_, kind)) = BEGINS.iter().find(|(begin, _)| start.starts_with(begin)) {
            return *kind;
        }
        // A logged answer of a printer may be in UTF-16, as PowerShell writes it.
        let is_marked = start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff");
        if is_marked {
            let kind = of_text(&text_of(start), true);
            return if kind == Self::Settings { kind } else { Self::Utf16 };
        }
        let head = &start[..start.len().min(512)];
        let zeros = head.iter().filter(|byte| **byte == 0).count();
        // Without a mark, half of the bytes of such a text are 0 all the same.
        let is_half = |pair: &[u8]| pair.contains(&0) != pair.iter().all(|byte| *byte == 0);
        match zeros {
            _ if is_binary_stl(start, length) => Self::Model,
            0 => of_text(&text_of(start), start.len() as u64 >= length),
            _ if 5 * zeros > 2 * head.len() && head.chunks(2).all(is_half) => Self::Utf16,
            _ => Self::Binary,
        }
    }

    fn row(self) -> &'static (Self, &'static str, &'static str) {
        KINDS.iter().find(|(kind, ..)| *kind == self).unwrap_or(&KINDS[KINDS.len() - 1])
    }

    /// Its name, with its article.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// What to do with such a file.
    #[must_use]
    pub fn way(self) -> &'static str {
        self.row().2
    }
}

/// A binary STL says in its 80th byte how many triangles of 50 bytes follow.
fn is_binary_stl(start: &[u8], length: u64) -> bool {
    let count = start.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| count > 0 && length == 84 + 50 * u64::from(count))
}

/// Lines that are not empty, without blanks around them.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty())
}

/// The text of a file of settings: UTF-8 or UTF-16, with any ends of lines.
#[must_use]
pub fn text_of(bytes: &[u8]) -> String {
    let pairs = |word: fn([u8; 2]) -> u16| {
        let words: Vec<u16> = bytes.as_chunks::<2>().0.iter().skip(1).map(|pair| word(*pair)).collect();
        String::from_utf16_lossy(&words)
    };
    let text = match bytes {
        [0xff, 0xfe, ..] => pairs(u16::from_le_bytes),
        [0xfe, 0xff, ..] => pairs(u16::from_be_bytes),
        _ => String::from_utf8_lossy(bytes).trim_start_matches('\u{feff}').to_owned(),
    };
    with_line_feeds(text)
}

/// A text in which a carriage return alone ends no line: a line feed does, at the same place.
#[must_use]
pub fn with_line_feeds(text: String) -> String {
    let is_old = |at: usize| text.as_bytes().get(at + 1) != Some(&b'\n');
    if !text.match_indices('\r').any(|(at, _)| is_old(at)) {
        return text;
    }
    let each = text.char_indices().map(|(at, c)| if c == '\r' && is_old(at) { '\n' } else { c });
    each.collect()
}

/// The kind of a text; only a whole one can be a configuration that commands make up.
fn of_text(text: &str, is_whole: bool) -> FileKind {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if text.is_empty() {
        return FileKind::Empty;
    }
    let begin: String = text.chars().take(400).collect::<String>().to_ascii_lowercase();
    if begin.starts_with("<!doctype html") || begin.starts_with("<html") {
        return if begin.contains("corehbot") { FileKind::Report } else { FileKind::Page };
    }
    if begin.starts_with('{') {
        return FileKind::Json;
    }
    if OF_RECORDINGS.iter().any(|first| begin.starts_with(first)) {
        return FileKind::Recording;
    }
    if configuration_h::is_configuration(text) {
        return FileKind::ConfigurationH;
    }
    if let Some(kind) = of_sections(text) {
        return kind;
    }
    let moves = lines(text).take(LINES).any(|line| ["G0 ", "G1 ", "G28"].iter().any(|code| line.starts_with(code)));
    // RepRapFirmware's own commands for drivers may stand in a sliced file too.
    if is_whole && (!moves || text.contains("M584")) && reprap::is_config(text) {
        return FileKind::ConfigG;
    }
    if is_whole && !moves && marlin::is_report(text) {
        let is_printed = lines(text).all(|line| line.starts_with(';') || is_command(line) && !line.contains(':'));
        return if is_printed { FileKind::SettingCommands } else { FileKind::Settings };
    }
    let first = lines(text).find(|line| !line.starts_with([';', '#', '(']));
    match first {
        _ if moves || lines(text).take(LINES).any(is_command) => FileKind::Gcode,
        None if text.starts_with([';', '(']) => FileKind::Gcode,
        Some(line) if line.matches(',').count() > 1 && !line.contains(' ') => FileKind::Csv,
        _ => FileKind::Text,
    }
}

/// A machine file or a printer.cfg, by its first tables, sections and keys.
fn of_sections(text: &str) -> Option<FileKind> {
    let of_ours = keys::names_in("", &[]);
    let is_ours = |path: &str| {
        let word = path.split('.').next().unwrap_or_default().trim_matches(['"', '[']);
        OF_OURS.contains(&word) || of_ours.iter().any(|known| known == word)
    };
    let is_word = |text: &str| {
        !text.is_empty() && text.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
    };
    let mut table = None;
    // A motor's key looks as a command does: `m8 = [1, -1, 0]`.
    let is_key = |line: &str| line.split_once('=').is_some_and(|(key, _)| key.trim().split('.').all(is_word));
    for line in lines(text).take(LINES).filter(|line| !line.starts_with(['#', ';'])) {
        if is_command(line) && !is_key(line) {
            return None;
        }
        if let Some((header, _)) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            let first = header.trim().split(' ').next().unwrap_or_default();
            let is_known = OF_KLIPPER.iter().any(|section| first.starts_with(section));
            if is_known || is_word(first) && first.len() < header.trim().len() {
                return Some(FileKind::PrinterCfg);
            }
            table = Some(is_ours(header.trim()));
            continue;
        }
        let Some(at) = line.find(['=', ':']) else { continue };
        let key = line[..at].trim();
        if line[at..].starts_with(':') && table.is_some() && is_word(key) {
            return Some(FileKind::PrinterCfg);
        }
        if line[at..].starts_with('=') && table.unwrap_or_else(|| is_ours(key)) {
            return Some(FileKind::MachineFile);
        }
    }
    (table == Some(true)).then_some(FileKind::MachineFile)
}

/// Whether a line is a command of G-code: a letter and a number.
fn is_command(line: &str) -> bool {
    let mut bytes = line.bytes();
    matches!(bytes.next(), Some(b'G' | b'M' | b'T' | b'N' | b'g' | b'm' | b't' | b'n'))
        && bytes.next().is_some_and(|b| b.is_ascii_digit())
}

/// What a command or a field takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Wanted {
    /// G-code, packed or not.
    Gcode,
    /// A machine file.
    Machine,
    /// Another firmware's settings.
    Configuration,
    /// A recording of an accelerometer.
    Recording,
    /// A study for `corehbot-lab sweep`, in TOML.
    Study,
    /// Measurements for `corehbot twin fit`, in TOML.
    Measurements,
    /// The heaters of a simulated machine, in TOML.
    Heaters,
    /// The numbers of a test rig, in TOML.
    Rig,
    /// The figures of a command (`--json`).
    Figures,
    /// The settings that a printer has stored.
    Storage,
    /// An image of the firmware.
    Image,
}

impl Wanted {
    const fn name(self) -> &'static str {
        match self {
            Self::Gcode => "G-code",
            Self::Machine => "a machine file",
            Self::Configuration => "another firmware's settings",
            Self::Recording => "a recording",
            Self::Study => "a study (TOML)",
            Self::Measurements => "measurements (TOML)",
            Self::Heaters => "a file of heaters (TOML)",
            Self::Rig => "a file of a rig (TOML)",
            Self::Figures => "figures (JSON)",
            Self::Storage => "stored settings",
            Self::Image => "an image of this firmware",
        }
    }

    /// Whether it may be of this kind. What nothing is known of is read, and its first error told.
    const fn takes(self, kind: FileKind) -> bool {
        use FileKind::{Binary, BinaryGcode, ConfigG, ConfigurationH, Csv, Empty, Gcode, Gzip, Json, MachineFile};
        use FileKind::{Packed, PrinterCfg, Program, Recording, SettingCommands, Settings, Text, Zip};
        matches!(kind, Text | Empty)
            || match self {
                Self::Gcode => matches!(kind, Gcode | SettingCommands | BinaryGcode | Gzip | Zip),
                Self::Machine => matches!(kind, MachineFile),
                Self::Configuration => {
                    matches!(kind, PrinterCfg | ConfigurationH | Settings | SettingCommands | ConfigG)
                }
                Self::Recording => matches!(kind, Recording | Packed | Csv),
                // Other files of TOML may have tables of a machine.
                Self::Study | Self::Measurements | Self::Heaters | Self::Rig => matches!(kind, MachineFile),
                Self::Figures => matches!(kind, Json),
                Self::Storage => matches!(kind, Binary),
                Self::Image => matches!(kind, Binary | Program),
            }
    }

    /// Refuses a file of another kind.
    ///
    /// # Errors
    /// What it is, and what to do with it.
    pub const fn check(self, kind: FileKind) -> Result<(), WrongFile> {
        if self.takes(kind) { Ok(()) } else { Err(WrongFile { kind, wanted: self }) }
    }
}

/// A file of another kind than the wanted one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WrongFile {
    /// What it is.
    pub kind: FileKind,
    /// What was wanted.
    pub wanted: Wanted,
}

impl Display for WrongFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "this is {}, not {}: {}", self.kind.name(), self.wanted.name(), self.kind.way())
    }
}

impl std::error::Error for WrongFile {}

#[cfg(test)]
mod tests;
