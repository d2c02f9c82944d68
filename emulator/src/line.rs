//! A serial line to a host, with bytes at the firmware's own baud rate. The host is scripted, or it is outside and
//! [`crate::terminal`] connects it.
//!
//! A scripted host waits for the greeting before it sends, and answers at once. The delays of a computer and its
//! adapter are no property of the image. The firmware sets the rate; [`crate::run`] compares it with the stated one.

use crate::tick::NS_PER_TICK;
use crate::usb_habits::UsbHabits;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use rigless::chip::Timeline;
use rigless::chip::uart::{Errors, Peer, Rate};
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;
use std::collections::VecDeque;

/// Lines that are kept for a person to read.
const KEPT: usize = 400;

/// How hosts talk.
#[derive(Clone, Copy, Default, Debug)]
pub struct Manner {
    /// The lines' rate, if it differs from the image's: then the watch overwrites the image's divisor, as if the
    /// board's table had this rate.
    pub baud: Option<u32>,
    /// How many of a million bytes arrive at the board with a framing error.
    pub damaged: u32,
    /// They send all lines at once, as they are, and only count the answers.
    pub is_impatient: bool,
    /// The first one is on the USB cable, with these habits.
    pub usb: Option<UsbHabits>,
    /// Impatient ones say it all again whenever they hear that the machine stays off.
    pub insists: bool,
}

/// The end for a host outside.
#[derive(Default, Debug)]
struct Outside {
    /// Bytes that it has yet to hear.
    said: Vec<u8>,
    /// Its lines that have no answer yet.
    asked: usize,
}

/// The far end of the line.
pub struct HostLine {
    /// Set if the host is outside.
    outside: Option<Outside>,
    manner: Manner,
    /// The text of an impatient host, its number of lines, and the number of answered lines.
    text: String,
    all: String,
    asked: usize,
    answered: usize,
    /// The host that prints a file.
    pub host: FileHost,
    to_board: VecDeque<u8>,
    heard: Vec<u8>,
    /// When the greeting came, in ns.
    pub started: Option<u64>,
    /// When the line last carried a byte, in ns.
    pub active: u64,
    /// The first lines that the board said.
    pub said: Vec<String>,
    /// Bytes that went to the board and came from it.
    pub bytes: [u64; 2],
}

impl HostLine {
    /// A host that will print `gcode`.
    #[must_use]
    pub fn new(gcode: &str, manner: Manner) -> Self {
        Self {
            outside: None,
            manner,
            text: gcode.to_owned(),
            all: gcode.to_owned(),
            asked: gcode.lines().count(),
            answered: 0,
            host: FileHost::new(gcode),
            to_board: VecDeque::new(),
            heard: Vec::new(),
            started: None,
            active: 0,
            said: Vec::new(),
            bytes: [0; 2],
        }
    }
}

impl HostLine {
    /// An end for a host outside.
    #[must_use]
    pub fn open() -> Self {
        Self { outside: Some(Outside::default()), ..Self::new("", Manner::default()) }
    }

    /// The host outside sends bytes.
    pub fn send(&mut self, bytes: &[u8]) {
        if let Some(outside) = &mut self.outside {
            outside.asked += bytes.iter().filter(|byte| **byte == b'\n').count();
        }
        self.to_board.extend(bytes);
    }

    /// The bytes that the host outside has yet to hear.
    pub fn take_said(&mut self) -> Vec<u8> {
        self.outside.as_mut().map(|outside| std::mem::take(&mut outside.said)).unwrap_or_default()
    }

    /// Whether a line of the host outside has no answer yet.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.outside.as_ref().is_some_and(|outside| outside.asked > 0)
    }

    /// Whether everything was sent and answered.
    #[must_use]
    pub fn is_done(&self) -> bool {
        if self.manner.is_impatient { self.answered >= self.asked } else { self.host.is_done() }
    }

    /// Damages the bytes to the board; the same bytes in every run.
    pub fn damage(&self, errors: &mut Errors) {
        errors.framing = Rate { name: "framing", per_million: self.manner.damaged };
    }
}

impl std::fmt::Debug for HostLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("HostLine").field("started", &self.started).finish_non_exhaustive()
    }
}

impl HostLine {
    /// A byte comes from the board at `now`, in ns.
    pub fn hear(&mut self, byte: u8, now: u64) {
        self.active = now;
        self.bytes[1] += 1;
        if let Some(outside) = &mut self.outside {
            outside.said.push(byte);
        }
        if byte != b'\n' {
            self.heard.push(byte);
            return;
        }
        let line = String::from_utf8_lossy(&self.heard).trim_end().to_owned();
        self.heard.clear();
        if line == "start" && self.started.is_none() {
            self.started = Some(now);
        }
        if let Some(outside) = &mut self.outside {
            match line.as_str() {
                "start" => outside.asked = 0,
                line if line.starts_with("ok") => outside.asked = outside.asked.saturating_sub(1),
                _ => {}
            }
        } else if !self.manner.is_impatient {
            self.host.hear(&line);
        } else if line.starts_with("ok") {
            self.answered += 1;
        } else if self.manner.insists && line.contains("stay off") {
            self.text.clone_from(&self.all);
        }
        if self.said.len() < KEPT {
            self.said.push(line);
        }
    }

    /// The next byte to the board, at `now`.
    pub fn say(&mut self, now: u64) -> Option<u8> {
        let is_outside = self.outside.is_some();
        if !is_outside {
            self.started?;
        }
        if self.to_board.is_empty() && !is_outside {
            let mut bytes = Vec::new();
            if self.manner.is_impatient {
                bytes.append(&mut std::mem::take(&mut self.text).into_bytes());
            } else {
                self.host.clock(now / NS_PER_TICK);
                self.host.interject(&mut bytes);
                self.host.send(&mut bytes);
            }
            self.to_board.extend(bytes);
        }
        let byte = self.to_board.pop_front()?;
        self.active = now;
        self.bytes[0] += 1;
        Some(byte)
    }
}

impl Store for HostLine {}

impl Peer for HostLine {
    fn receive(&mut self, word: u16, context: &mut Timeline<'_, '_>) {
        self.hear(word as u8, context.now().0);
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        self.say(now.0).map(u16::from)
    }
}
