//! Which board a configuration is on: the one with all its pins.
//!
//! Boards share single pins by chance: a step pin of an Ender 3 is one of a CNC shield too. So every pin of a motor, a
//! heater and a temperature sensor has to be on a connector for it. Pins of other processors, and of headers where
//! anything may be plugged in, count neither way.

use super::config::Config;
use super::pin::{Aliases, FIRST_MCU, PinText};
use corehbot::connectors::BoardConnectors;
use corehbot_boards::{Entry, Job, entries};
use corehbot_wiring::{Pin, Port};

/// A pin of the main processor, and its job.
struct Used {
    section: String,
    key: String,
    text: String,
    pin: Option<Pin>,
    job: Job,
}

/// The pins of a configuration that tell its board.
pub(super) struct Pinned {
    used: Vec<Used>,
    fans: Vec<Pin>,
    /// The processor in the name of its serial port.
    pub chip: Option<String>,
    /// Comments, names of sections and files, and serial ports: boards are named there.
    words: String,
}

/// Keys of pins that tell a board, in which sections, and their jobs.
const JOBS: [(&str, &[&str], Job); 6] = [
    ("step_pin", &["stepper_", "extruder", "manual_stepper ", "dual_carriage"], Job::Step),
    ("dir_pin", &["stepper_", "extruder", "manual_stepper ", "dual_carriage"], Job::Dir),
    ("enable_pin", &["stepper_", "extruder", "manual_stepper ", "dual_carriage"], Job::Enable),
    ("uart_pin", &["tmc22"], Job::Uart),
    ("heater_pin", &["extruder", "heater_"], Job::Heater),
    ("sensor_pin", &["extruder", "heater_", "temperature_"], Job::Sensor),
];

/// Sensors with a chip of their own: their pin is a line of a bus.
const OF_BUS: &str = "MAX";

impl Pinned {
    /// Those of a configuration.
    pub fn of(config: &Config, aliases: &Aliases) -> Self {
        let (mut used, mut fans) = (Vec::new(), Vec::new());
        for entry in config.entries.iter().filter(|entry| entry.replaced.is_none()) {
            let Some(section) = config.sections.get(entry.section).map(|section| section.name.as_str()) else {
                continue;
            };
            let read = aliases.resolve(&entry.value);
            if !read.is_on_board() || read.name.is_empty() {
                continue;
            }
            let pin = pin_called(&read.name);
            if entry.key == "pin" && section.contains("fan") {
                fans.extend(pin);
            }
            let is_of = |(key, sections, _): &&(&str, &[&str], Job)| {
                *key == entry.key && sections.iter().any(|start| section.starts_with(start))
            };
            let Some((.., job)) = JOBS.iter().find(is_of) else { continue };
            let kind = config.find(section, "sensor_type").and_then(|entry| config.entries.get(entry));
            if *job == Job::Sensor && kind.is_some_and(|kind| kind.value.starts_with(OF_BUS)) {
                continue;
            }
            let (section, key) = (section.to_owned(), entry.key.clone());
            used.push(Used { section, key, text: read.name, pin, job: *job });
        }
        let serial = config.find(FIRST_MCU, "serial").and_then(|entry| config.entries.get(entry));
        let serial = serial.map_or("", |entry| entry.value.as_str()).to_lowercase();
        let names = config.sections.iter().map(|section| &section.name).chain(&config.files);
        let words = names.fold(config.comments.clone(), |words, name| words + &name.to_lowercase() + "\n") + &serial;
        // A name may go on in the next line.
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        Self { used, fans, chip: chip_in(&serial), words }
    }

    /// Whether any motor is on the main processor.
    fn has_motors(&self) -> bool {
        self.used.iter().any(|used| used.job == Job::Step)
    }

    /// The pins that a board has no connector for.
    fn strangers(&self, entry: &Entry) -> Vec<&Used> {
        let is_strange = |used: &&Used| {
            used.pin
                .is_none_or(|pin| !entry.printed.has(entry.board, used.job, pin) && !entry.printed.is_of_header(pin))
        };
        self.used.iter().filter(is_strange).collect()
    }

    /// Whether half of the motors or more are in sockets of a board: all of them might be on its headers.
    fn is_in_sockets(&self, entry: &Entry) -> bool {
        let steps = || self.used.iter().filter(|used| used.job == Job::Step);
        let is_here = |used: &&Used| used.pin.is_some_and(|pin| entry.printed.has(entry.board, Job::Step, pin));
        let here = steps().filter(is_here).count();
        here > 0 && 2 * here >= steps().count()
    }

    /// Whether it is that board, as far as pins tell.
    pub fn fits(&self, entry: &Entry) -> bool {
        self.strangers(entry).is_empty() && self.is_in_sockets(entry)
    }

    /// Whether it may be that board: a part of a configuration may have no motors.
    pub fn may_be(&self, entry: &Entry) -> bool {
        let fits = self.fits(entry) || (!self.has_motors() && self.strangers(entry).is_empty());
        fits && self.namesake(entry).is_none()
    }

    /// The name of a board that only shares pins with this one, if that one is named.
    fn namesake(&self, entry: &Entry) -> Option<&'static str> {
        let alike: Vec<&'static Entry> = entries().filter(|other| self.fits(other)).collect();
        let (name, _) = self.first_name(&alike).filter(|(_, entry)| entry.is_none())?;
        entry.printed.namesakes.contains(&name).then_some(name)
    }

    /// How many of the fans are at outputs of a board.
    fn fans_of(&self, entry: &Entry) -> usize {
        entry.board.fans.iter().filter(|fan| self.fans.contains(&fan.pin)).count()
    }

    /// Whether no other board with these pins has more of the fans.
    pub fn has_fans_of(&self, entry: &Entry) -> bool {
        let most = entries().filter(|entry| self.fits(entry)).map(|entry| self.fans_of(entry)).max();
        most.is_none_or(|most| self.fans_of(entry) == most)
    }

    /// That the pins are not those of a board, if so.
    pub fn strange_on(&self, board: &BoardConnectors) -> Option<String> {
        let entry = entries().find(|entry| entry.board.connectors.key == board.key && !self.may_be(entry))?;
        let why = match self.namesake(entry).filter(|_| self.strangers(entry).is_empty()) {
            Some(name) => format!("a comment or a name says {name}"),
            None => format!("it differs in {}", self.differs(entry)),
        };
        Some(format!("these are not the pins of the {}, as {why}: so each pin counts as another board's", board.name))
    }

    /// Whether a processor's name says that it is not the board's.
    pub fn is_other_chip(&self, entry: &Entry) -> bool {
        self.chip.as_ref().is_some_and(|chip| !entry.chip.to_lowercase().starts_with(chip.as_str()))
    }

    /// The board with all pins. Of boards with the same pins it is the board with most fans. Then it is the board that
    /// a comment, a section, a file or the serial port names. Otherwise it is the board that the firmware takes for
    /// granted.
    ///
    /// # Errors
    /// The reason why it cannot be told, and what to do.
    pub fn board(&self) -> Result<&'static BoardConnectors, String> {
        if !self.has_motors() {
            return Err("cannot tell the board, because the main processor has no motors: name one by --board".into());
        }
        let fitting: Vec<&Entry> = entries().filter(|entry| self.fits(entry)).collect();
        let most = fitting.iter().map(|entry| self.fans_of(entry)).max();
        let alike: Vec<&Entry> = fitting.into_iter().filter(|entry| Some(self.fans_of(entry)) == most).collect();
        if alike.is_empty() {
            return Err(self.nearest());
        }
        let board = self.named(&alike)?;
        if self.is_other_chip(board) {
            let (name, chip) = (board.board.connectors.name, self.chip.as_deref().unwrap_or_default().to_uppercase());
            return Err(format!(
                "these are the pins of the {name}, but [mcu] serial says that its processor is an {chip}, and the \
                 firmware has images for the {} alone: this board is not supported; --board names the one that the \
                 machine gets instead",
                family(board.chip)
            ));
        }
        Ok(board.board.connectors)
    }

    /// Of boards alike so far the one that is named. The first name counts, because notes on others come later; of two
    /// at one place the longer one, because "octopus pro" names the Octopus too.
    fn named(&self, alike: &[&'static Entry]) -> Result<&'static Entry, String> {
        let key = |entry: &Entry| entry.board.connectors.key;
        match self.first_name(alike) {
            Some((_, Some(entry))) => return Ok(entry),
            Some((name, None)) => {
                return Err(format!(
                    "these are pins of the {}, but a comment or a name says {name}, which is not supported; --board \
                     names the board that the machine gets instead",
                    alike.iter().map(|entry| entry.board.connectors.name).collect::<Vec<_>>().join(" and the ")
                ));
            }
            None => {}
        }
        let unmarked = || alike.iter().find(|entry| entry.board.marks.is_empty());
        let only = if alike.len() == 1 { alike.first() } else { unmarked() };
        only.copied().ok_or_else(|| {
            let keys: Vec<_> = alike.iter().map(|entry| key(entry)).collect();
            format!("cannot tell the board: {} have these pins; name yours by --board", keys.join(" and "))
        })
    }

    /// The first name of a board, or of one that only shares pins with it.
    fn first_name<'e>(&self, boards: &[&'e Entry]) -> Option<(&'e str, Option<&'e Entry>)> {
        let own = boards.iter().map(|entry| (entry.board.connectors.key, Some(*entry)));
        let others = boards.iter().flat_map(|entry| entry.printed.namesakes.iter().map(|name| (*name, None)));
        let place = |name: &str| {
            let spelled = [" ", "-", "_"].map(|between| name.replace(['-', ' '], between));
            let all = spelled.iter().flat_map(|name| self.words.match_indices(name.as_str()).map(|(at, _)| at));
            all.filter(|at| !self.words.get(..*at).is_some_and(is_denied)).min()
        };
        let found = own.chain(others).filter_map(|(name, entry)| Some((place(name)?, name, entry)));
        let first = found.min_by_key(|(place, name, _)| (*place, std::cmp::Reverse(name.len())));
        first.map(|(_, name, entry)| (name, entry))
    }

    /// That no board has these pins.
    fn nearest(&self) -> String {
        let Some(nearest) = entries().min_by_key(|entry| self.strangers(entry).len()) else { return String::new() };
        let chip = self.chip.as_ref().map(|chip| format!(", an {},", chip.to_uppercase())).unwrap_or_default();
        format!(
            "the board of this configuration{chip} is not supported, because no board here has its pins (nearest: {}, \
             which differs in {}); --board names the one that the machine gets instead",
            nearest.board.connectors.name,
            self.differs(nearest)
        )
    }

    /// The pins that a board has no connector for, in words.
    fn differs(&self, entry: &Entry) -> String {
        let strangers = self.strangers(entry);
        let told = |used: &&Used| format!("[{}] {} {}", used.section, used.key, used.text);
        let mut differs: Vec<_> = strangers.iter().take(MOST_TOLD).map(told).collect();
        if strangers.len() > MOST_TOLD {
            differs.push(format!("{} more", strangers.len() - MOST_TOLD));
        }
        if differs.is_empty() {
            differs.push("its motors, which are on headers".to_owned());
        }
        differs.join(", ")
    }
}

/// Whether the words before a name say that it is not meant: `not for the`.
fn is_denied(before: &str) -> bool {
    const DENY: [&str; 5] = ["not", "no", "isn't", "unlike", "instead"];
    let sentence = before.rsplit(['.', ',', ';', ':', '!', '(']).next().unwrap_or_default();
    sentence.split(' ').rev().take(WORDS_BEFORE).any(|word| DENY.contains(&word))
}

/// Words between `not` and the name: `not for the BTT`.
const WORDS_BEFORE: usize = 5;

/// Pins that a message names.
const MOST_TOLD: usize = 3;

/// The family of a processor: `STM32F446`.
fn family(chip: &str) -> &str {
    chip.get(..9).unwrap_or(chip)
}

/// The pin of that name.
fn pin_called(name: &str) -> Option<Pin> {
    let mut rest = name.strip_prefix('P')?.chars();
    let letter = rest.next()?;
    let port = Port::ALL.into_iter().find(|port| format!("{port:?}") == letter.to_string())?;
    let number = rest.as_str().parse::<u8>().ok().filter(|number| *number < 16)?;
    Some(Pin::new(port, number))
}

/// Whether a pin's text is on no connector of a board but printed on it, and its printed name.
pub(super) fn printed(board: &BoardConnectors, pin: &PinText) -> Option<&'static str> {
    let entry = entries().find(|entry| entry.board.connectors.key == board.key)?;
    let pin = pin_called(&pin.name)?;
    let mut all = entry.printed.heaters.iter().chain(entry.printed.sensors);
    all.find(|(_, known)| *known == pin).map(|(name, _)| *name)
}

/// Beginnings of the names of processors, as Klipper's serial ports have them (`src/*/Kconfig`, MCU).
const CHIPS: [&str; 9] = ["stm32", "lpc1", "rp2", "sam3", "sam4", "samd", "same", "atmega", "hc32"];

/// The processor in the name of a serial port: `stm32f446` in `usb-Klipper_stm32f446xx_1234-if00`.
fn chip_in(serial: &str) -> Option<String> {
    let mut words = serial.split(|c: char| !c.is_ascii_alphanumeric());
    let word = words.find(|word| CHIPS.iter().any(|start| word.starts_with(start)))?;
    Some(word.trim_end_matches('x').to_owned())
}
