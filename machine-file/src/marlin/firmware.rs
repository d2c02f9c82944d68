//! Which firmware answers on a line: by its name in M115, or by words that it says at its start.

use super::said::Said;

/// A firmware.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Firmware {
    /// Marlin, whatever its version.
    Marlin,
    /// This firmware.
    Corehbot,
    /// Prusa's, which began as Marlin.
    Prusa,
    /// RepRapFirmware of Duet boards.
    RepRap,
    /// Klipper.
    Klipper,
    /// Grbl and grblHAL, for mills.
    Grbl,
    /// Smoothieware.
    Smoothie,
    /// Repetier-Firmware.
    Repetier,
    /// One that gave another name.
    Other,
}

/// Parts of names, in small letters; the first that fits counts. CoreH-bot's name has Marlin in it, for screens.
const NAMES: [(&str, Firmware); 9] = [
    ("coreh-bot", Firmware::Corehbot),
    ("prusa-firmware", Firmware::Prusa),
    ("reprapfirmware", Firmware::RepRap),
    ("klipper", Firmware::Klipper),
    ("grbl", Firmware::Grbl),
    ("smoothie", Firmware::Smoothie),
    ("repetier", Firmware::Repetier),
    ("marlin", Firmware::Marlin),
    ("creality", Firmware::Marlin),
];

/// Words of firmwares that do not know M115.
const WORDS: [(&str, Firmware); 4] =
    [("Grbl", Firmware::Grbl), ("GrblHAL", Firmware::Grbl), ("error:20", Firmware::Grbl), ("// ", Firmware::Klipper)];

impl Firmware {
    /// The firmware with that FIRMWARE_NAME.
    #[must_use]
    pub fn called(name: &str) -> Self {
        let name = name.to_lowercase();
        NAMES.iter().find(|(part, _)| name.contains(part)).map_or(Self::Other, |(_, firmware)| *firmware)
    }

    /// The firmware that said these lines, and its name.
    #[must_use]
    pub fn heard(text: &str) -> Option<(Self, String)> {
        let said = Said::read(text);
        if let Some(word) = said.find("M115", "FIRMWARE_NAME").and_then(|word| said.words.get(word)) {
            return Some((Self::called(&word.value), word.value.clone()));
        }
        let lines = text.lines().map(str::trim);
        let found = lines.filter_map(|line| WORDS.iter().find(|(word, _)| line.starts_with(word)).map(|f| (f.1, line)));
        found.map(|(firmware, line)| (firmware, line.to_owned())).next()
    }

    /// How else its settings become a machine file.
    #[must_use]
    pub const fn cure(self) -> &'static str {
        match self {
            Self::Marlin => "",
            Self::Corehbot => "`corehbot config get PORT` reads the whole machine",
            Self::Prusa => {
                "its M503 looks like Marlin's: save the answer into a file, read it by `corehbot config from FILE`, and \
                 check every line"
            }
            Self::RepRap => {
                "its settings are the commands of /sys/config.g: `corehbot config from config.g` reads them"
            }
            Self::Klipper => "its settings are in printer.cfg on its host: `corehbot config from printer.cfg` reads it",
            Self::Grbl => {
                "it is firmware for mills; `$$` lists its settings: begin with `corehbot config new`, and take $100 to \
                 $132 from there"
            }
            Self::Smoothie => {
                "its settings are in the file config on its card: begin with `corehbot config new`, and take the \
                 numbers from there"
            }
            Self::Repetier | Self::Other => {
                "begin with `corehbot config new`, and take the numbers from its own settings"
            }
        }
    }
}
