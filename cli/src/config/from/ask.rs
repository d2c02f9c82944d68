//! Asks a running printer what it is: over its serial line, at the rate at which it answers.
//!
//! A board with a serial chip resets when its line is opened, and a bootloader listens first. So it may start before it
//! is asked, and it is asked again. M115, M503, M211, M119 and M122 change nothing.

use anyhow::{Result, bail};
use clap::Args;
use corehbot_host::say::note;
use corehbot_host::serial::SerialLine;
use corehbot_machine_file::marlin::{Firmware, is_report};
use corehbot_machine_file::short::short;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(Args)]
pub(crate) struct Printer {
    /// Asks the printer with Marlin on this serial line, such as /dev/ttyUSB0; not while it prints.
    #[arg(long, value_name = "PORT", conflicts_with = "file")]
    serial: Option<PathBuf>,
    /// The rate of the line; left out, 250000 and 115200 baud are tried.
    #[arg(long, requires = "serial")]
    baud: Option<u32>,
}

/// Rates of printers: Marlin's own, and that of most boards for sale.
const BAUDS: [u32; 2] = [250_000, 115_200];

/// After the line was opened: a board that starts says its first word by then, because its bootloader takes 1 to 2 s.
/// A question in that time could keep it in the bootloader.
const FIRST_WORD: Duration = Duration::from_millis(2500);

/// Silence that ends the start of a board: EEPROM and card are read between two words.
const PAUSE: Duration = Duration::from_millis(1200);

/// The longest start of a board.
const LONGEST_START: Duration = Duration::from_secs(20);

/// How long the answer to M115 may take: a bootloader throws the first question away.
const ANSWER: Duration = Duration::from_millis(2000);

/// Silence after which an answer is whole.
const REST: Duration = Duration::from_millis(300);

/// How often M115 is asked at a rate.
const QUESTIONS: usize = 3;

/// How long a printer may be silent in its answer: it says `busy:` every two seconds.
const SILENCE: Duration = Duration::from_secs(8);

/// The longest answer.
const LONGEST_ANSWER: Duration = Duration::from_secs(90);

impl Printer {
    /// The line, if one is to be asked.
    pub fn port(&self) -> Option<&Path> {
        self.serial.as_deref()
    }

    /// All that the printer says of itself.
    pub fn ask(&self, path: &Path) -> Result<String> {
        let bauds = self.baud.map_or_else(|| BAUDS.to_vec(), |baud| vec![baud]);
        let first = bauds.first().copied().unwrap_or(BAUDS[0]);
        let mut talk = Talk { line: SerialLine::open(path, first)?, text: String::new(), garbage: 0, bytes: 0 };
        let (mut has_garbage, mut said) = (false, String::new());
        for baud in &bauds {
            note(format_args!("{}: asking at {baud} baud", path.display()));
            talk.tune(*baud)?;
            if let Some((firmware, name)) = talk.greet()? {
                note(format_args!("{}: {}", path.display(), short(&name)));
                let is_not = || format!("the printer on {} is {}, not Marlin", path.display(), short(&name));
                return match firmware {
                    Firmware::Marlin => talk.interview(&["M211", "M119", "M122"]),
                    // Its M122 has no table of drivers.
                    Firmware::Corehbot => talk.interview(&["M211", "M119"]),
                    // Makers rename Marlin, so the answer tells; the report asks for a look at every line.
                    Firmware::Other => talk
                        .interview(&["M211", "M119"])
                        .map_err(|error| error.context(format!("{}: {}", is_not(), firmware.cure()))),
                    other => bail!("{}: {}", is_not(), other.cure()),
                };
            }
            has_garbage |= talk.is_garbage();
            if !talk.is_garbage() {
                said.push_str(&talk.text);
            }
        }
        let rates = bauds.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ");
        let port = path.display();
        if has_stopped(&said) {
            bail!("the printer on {port} has stopped itself: switch it off and on, and look why");
        }
        if let Some(line) = said.lines().map(str::trim).find(|line| !line.is_empty()) {
            bail!("{port} says {:?}, and nothing to M115: is it a printer with Marlin, and idle?", short(line));
        }
        if has_garbage {
            bail!(
                "something answers on {port}, but not at {rates} baud: say its rate by --baud (BAUDRATE in its \
                 Configuration.h); a board with Klipper does not speak text, and its printer.cfg can be read instead"
            );
        }
        bail!(
            "nothing answers on {port} at {rates} baud: is the printer switched on, is it this port, and does the cable \
             carry data?"
        )
    }
}

/// A conversation at one rate.
struct Talk {
    line: SerialLine,
    /// All that was heard.
    text: String,
    /// Bytes that no text has, of all bytes.
    garbage: usize,
    bytes: usize,
}

/// Lines that a printer says on its own, however long one waits.
fn is_alone(line: &str) -> bool {
    let line = line.trim().trim_start_matches("echo:");
    line.is_empty() || ["T:", "B:", "wait", "X:", "busy:", "ok T:"].iter().any(|beginning| line.starts_with(beginning))
}

/// Whether a printer has stopped itself, as it does when a heater fails.
fn has_stopped(text: &str) -> bool {
    text.contains("kill() called") || text.contains("Printer halted")
}

impl Talk {
    fn tune(&mut self, baud: u32) -> Result<()> {
        self.line.retune(baud)?;
        (self.text, self.garbage, self.bytes) = (String::new(), 0, 0);
        Ok(())
    }

    /// At the wrong rate bytes are broken. A board in its bootloader may say a few at another rate than later.
    const fn is_garbage(&self) -> bool {
        self.garbage > 2 && 4 * self.garbage > self.bytes
    }

    /// Hears for a tenth of a second; returns whether a word came that the printer does not say on its own.
    fn hear(&mut self) -> Result<bool> {
        let mut bytes = [0; 512];
        let count = self.line.read(&mut bytes)?;
        let new = &bytes[..count];
        self.bytes += count;
        let is_text = |byte: &&u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
        self.garbage += count - new.iter().filter(is_text).count();
        let before = self.text.rfind('\n').map_or(0, |end| end + 1);
        self.text.push_str(&String::from_utf8_lossy(new));
        Ok(count > 0 && !self.text[before..].lines().all(is_alone))
    }

    /// Hears until it is silent for so long; no longer than `most`.
    fn hear_out(&mut self, silence: Duration, most: Duration) -> Result<()> {
        let (start, mut active) = (Instant::now(), Instant::now());
        while active.elapsed() < silence && start.elapsed() < most {
            if self.hear()? {
                active = Instant::now();
            }
        }
        Ok(())
    }

    /// Asks for the firmware's name.
    fn greet(&mut self) -> Result<Option<(Firmware, String)>> {
        self.hear_out(FIRST_WORD, FIRST_WORD)?;
        if self.bytes > 0 && !self.is_garbage() {
            self.hear_out(PAUSE, LONGEST_START)?;
        }
        for _ in 0..QUESTIONS {
            // A printer that has stopped itself answers nothing.
            if self.is_garbage() || has_stopped(&self.text) {
                break;
            }
            // The line end ends whatever another program has begun.
            self.line.write(b"\nM115\n")?;
            let start = Instant::now();
            while start.elapsed() < ANSWER {
                self.hear()?;
                // A whole line, because a name may come in pieces.
                let whole = self.text.rfind('\n').map_or("", |end| &self.text[..end]);
                if let Some(found) = Firmware::heard(whole) {
                    self.hear_out(REST, LONGEST_START)?;
                    return Ok(Some(found));
                }
            }
        }
        Ok(None)
    }

    /// Asks for the settings and for `more`, and returns all that was said from M115 on.
    fn interview(&mut self, more: &[&str]) -> Result<String> {
        let answer = self.answer("M503")?;
        if !is_report(&answer) {
            if answer.contains("Unknown command") {
                bail!(
                    "this Marlin was built without M503 (DISABLE_M503): begin with `corehbot config new`, and take the \
                     numbers from its Configuration.h"
                );
            }
            let lines = answer.lines().count();
            bail!("the printer answers M503 with {lines} lines, and none of them sets anything: try again");
        }
        // What they would have said is to be filled in then.
        for code in more {
            if let Err(error) = self.answer(code) {
                note(format_args!("{error:#}"));
            }
        }
        self.hear_out(REST, LONGEST_START)?;
        Ok(std::mem::take(&mut self.text))
    }

    /// The answer to a command, up to its `ok`.
    fn answer(&mut self, code: &str) -> Result<String> {
        let from = self.text.len();
        self.line.write(format!("{code}\n").as_bytes())?;
        let (start, mut active) = (Instant::now(), Instant::now());
        while active.elapsed() < SILENCE && start.elapsed() < LONGEST_ANSWER {
            let before = self.text.len();
            self.hear()?;
            if self.text.len() > before {
                active = Instant::now();
            }
            let answer = &self.text[from..];
            if has_stopped(answer) {
                bail!("the printer has stopped itself: switch it off and on, and look why");
            }
            if answer.contains("busy: paused") {
                bail!("the printer waits for a button (`busy: paused`): press it, then try again");
            }
            let whole = answer.rfind('\n').map_or("", |end| &answer[..end]);
            // An `ok` may be that of a line which another program has begun.
            let is_done = code != "M503" || is_report(whole) || whole.contains("Unknown command");
            if is_done && whole.lines().any(|line| line.trim_start().starts_with("ok")) {
                return Ok(answer.to_owned());
            }
        }
        let heard = &self.text[from..];
        if heard.trim().is_empty() {
            bail!("the printer answers M115, and nothing to {code}: try again");
        }
        bail!("the printer does not end its answer to {code}: is it printing? Try again when it is idle")
    }
}
