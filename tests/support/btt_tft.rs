//! A BTT TFT as in its source, as far as it detects its machine: BIGTREETECH's TouchScreenFirmware,
//! Mainboard_AckHandler.c (`parseAck`, `processKnownEcho`), Settings.c (`initMachineSettings`, `setupMachine`),
//! SerialConnection.c (`Serial_Get`, which drops the blanks in front of a line), MPC.c.
#![allow(dead_code, clippy::unwrap_used, reason = "each test uses a part, and fails by panicking")]

use std::collections::{BTreeMap, VecDeque};

/// Echoes that it does not show, or shows for a moment only.
const KNOWN_ECHOES: [&str; 15] = [
    "busy: paused for user",
    "busy: processing",
    "Now fresh file:",
    "Now doing file:",
    "echo:;",
    "echo:  G",
    "echo:  M",
    "echo:Active Mesh",
    "echo:EEPROM can",
    "Cap:",
    "Config:",
    "Settings Stored",
    "echo:Bed",
    "echo:Fade",
    "echo:Active Extruder",
];

/// Lines by which it learns the settings that its menus show, and the letters of their values.
const PARAMETERS: [(&str, &str); 16] = [
    ("M200", "SDT"),
    ("M92 ", "XYZE"),
    ("M201", "XYZE"),
    ("M203", "XYZE"),
    ("M204 P", "PRT"),
    ("M205", "XYZEJ"),
    ("M206 X", "XYZ"),
    ("M207 S", "SWFZ"),
    ("M208 S", "SWFR"),
    ("M301", "PID"),
    ("M304", "PID"),
    ("M593", "FD"),
    ("M900", "K"),
    ("M906", "XYZE"),
    ("M913", "XYZE"),
    ("M914", "XYZ"),
];

/// Number of hotends with a model.
const MODELS: f64 = 6.0;

/// The screen.
pub struct BttTft {
    is_connected: bool,
    pub is_marlin: Option<bool>,
    pub machine_type: String,
    /// `Cap:` lines by name. Where none comes, it takes a probe, a mesh and an EEPROM for there.
    pub capabilities: BTreeMap<String, bool>,
    /// `M92E` and the like, with the value.
    pub parameters: BTreeMap<String, f64>,
    /// Axes and whether their drivers are silent.
    pub silent: BTreeMap<char, bool>,
    pub has_soft_endstops: bool,
    /// Temperature and target of the hotend.
    pub hotend: Option<(f64, f64)>,
    pub has_bed: bool,
    /// The messages that it has shown to the user.
    pub shown: Vec<String>,
    queue: VecDeque<String>,
    awaits_ok: bool,
    is_polling: bool,
}

/// The number behind the first place of `word`, as strtod reads it.
fn value(line: &str, word: &str) -> Option<f64> {
    let (_, after) = line.split_once(word)?;
    let number: String = after.trim_start().chars().take_while(|c| c.is_ascii_digit() || "+-.".contains(*c)).collect();
    Some(number.parse().unwrap_or(0.0))
}

impl BttTft {
    pub fn new() -> Self {
        let assumed = ["EEPROM", "Z_PROBE", "LEVELING_DATA"].map(|name| (name.to_owned(), true));
        Self {
            is_connected: false,
            is_marlin: None,
            machine_type: "3D Printer".to_owned(),
            capabilities: BTreeMap::from(assumed),
            parameters: BTreeMap::new(),
            silent: BTreeMap::new(),
            has_soft_endstops: true,
            hotend: None,
            has_bed: false,
            shown: Vec::new(),
            queue: VecDeque::new(),
            awaits_ok: false,
            is_polling: true,
        }
    }

    /// The command that it sends next; it waits for the `ok` of each.
    pub fn speak(&mut self) -> Option<String> {
        if self.awaits_ok {
            return None;
        }
        let poll = (!self.is_connected && core::mem::take(&mut self.is_polling)).then(|| "M105".to_owned());
        let line = poll.or_else(|| self.queue.pop_front())?;
        self.awaits_ok = true;
        Some(line)
    }

    /// Whether it knows all the values that it requests.
    pub fn is_done(&self) -> bool {
        self.is_connected && self.queue.is_empty() && !self.awaits_ok
    }

    fn store(&mut self, lines: &[&str]) {
        self.queue.extend(lines.iter().map(|line| (*line).to_owned()));
    }

    pub fn hear(&mut self, line: &str) {
        let line = line.trim_start_matches(' ');
        if !self.is_connected {
            if !(line.contains('@') && line.contains("T:") || line.contains("T0:")) {
                return;
            }
            self.is_connected = true;
            self.has_bed = line.contains("B:");
            self.store(&["M503", "M92", "M211", "M115"]);
        }
        if line.starts_with("ok") {
            self.awaits_ok = false;
            if line == "ok" || line.contains('P') && line.contains('B') {
                return;
            }
        }
        self.interpret(line);
    }

    /// The chain of `parseAck`: the first branch that fits has the line.
    fn interpret(&mut self, line: &str) {
        let begins = |word: &str| line.starts_with(word);
        let parameter = PARAMETERS.iter().find(|(begin, _)| begins(begin));
        if begins("wait") {
        } else if line.contains('@') && line.contains("T:") || line.contains("T0:") {
            let target = line.split_once('/').and_then(|(_, after)| value(after, ""));
            self.hotend = Some((value(line, "T:").unwrap_or(0.0), target.unwrap_or(-0.5)));
        } else if ["Count E:", "FR:", "Flow:"].iter().any(|word| line.contains(word)) || begins("X:") {
        } else if begins("M211") || line.contains("Soft endstops") {
            self.has_soft_endstops = line.contains("ON");
        } else if line.contains("Case light:") || line.contains("MPC Autotune") || begins("PID Autotune") {
        } else if let Some((begin, letters)) = parameter {
            let code = begin.split(' ').next().unwrap();
            for letter in letters.chars() {
                // The first place of the letter counts, at any position.
                if let Some(value) = value(line, &letter.to_string()) {
                    self.parameters.insert(format!("{code}{letter}"), value);
                }
            }
        } else if begins("M306") && self.is_marlin == Some(true) {
            if let Some((_, after)) = line.split_once('E') {
                let index = value(line, "E").unwrap();
                for letter in ["P", "H"].iter().filter(|letter| after.contains(**letter)) {
                    // It does not check whether there is such a place.
                    assert!((0.0..MODELS).contains(&index), "writes beside its memory: {line}");
                    self.parameters.insert(format!("M306E{index}{letter}"), value(after, letter).unwrap());
                }
            }
        } else if line.contains("Driver stepping mode:") {
            self.store(&["M569"]);
        } else if line.contains("driver mode:") {
            let axis = "XYZE".chars().find(|axis| line.contains(*axis)).unwrap();
            self.silent.insert(axis, line.contains("stealthChop"));
        } else if let Some((_, name)) = line.split_once("FIRMWARE_NAME:") {
            if self.is_marlin.is_none() {
                self.is_marlin = Some(name.contains("Marlin"));
                self.store(&["M503 S0", "M82", "G90"]);
            }
            if let Some((_, machine)) = name.split_once("MACHINE_TYPE:")
                && let Some((machine, _)) = machine.split_once(" EXTRUDER_COUNT:")
            {
                assert!(machine.len() < 64, "{machine}");
                self.machine_type = machine.to_owned();
            }
        } else if let Some((name, value)) = line.strip_prefix("Cap:").and_then(|cap| cap.split_once(':')) {
            self.capabilities.insert(name.to_owned(), value.starts_with('1'));
            if (name, value) == ("AUTOREPORT_TEMP", "1") {
                self.store(&["M155 S3"]);
            }
        } else if let Some((_, trouble)) = line.split_once("Error:") {
            self.shown.push(trouble.to_owned());
        } else if begins("echo:") {
            let is_known = KNOWN_ECHOES.iter().any(|echo| line.contains(echo));
            if !is_known && !line.contains("Advance K=") && !line.contains("BLTouch HS mode") {
                self.shown.push(line.to_owned());
            }
        }
    }
}
