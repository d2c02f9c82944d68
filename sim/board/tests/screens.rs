//! Screens and plugins that identify their machine: a BTT TFT and OctoPrint's EEPROM-Marlin, as their sources have
//! them.

use crate::btt_tft;
use crate::common::deaf::Deaf;
use crate::eeprom_marlin;
use btt_tft::BttTft;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::load;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Host, run_on};

/// A machine with heaters, a name and silent drivers of z.
const MACHINE: &str = "name = \"Voron 2.4 350\"\nsoft_endstops = false\n[heaters.hotend]\nis_fitted = true\n\
    [heaters.bed]\nis_fitted = true\n[heaters.chamber]\nis_fitted = true\noutput = \"he2\"\nsensor = \"hotend2\"\n\
    [drivers.z]\nstealth = true\n[axes.e]\nsteps_per_mm = 415.5\n";

/// A screen on one line, and a host on the other one.
struct Screen(BttTft);

impl Host for Screen {
    fn send(&mut self, out: &mut Vec<u8>) {
        if let Some(line) = self.0.speak() {
            out.extend_from_slice(format!("{line}\n").as_bytes());
        }
    }

    fn hear(&mut self, line: &str) {
        self.0.hear(line);
    }

    fn is_done(&self) -> bool {
        self.0.is_done()
    }
}

/// Sends lines one by one and keeps the replies.
struct Teller {
    lines: Vec<&'static str>,
    next: usize,
    awaiting: bool,
    heard: Vec<String>,
}

impl Teller {
    fn new(lines: &[&'static str]) -> Self {
        Self { lines: lines.to_vec(), next: 0, awaiting: false, heard: Vec::new() }
    }

    fn count(&self, line: &str) -> usize {
        self.heard.iter().filter(|heard| *heard == line).count()
    }
}

impl Host for Teller {
    fn send(&mut self, out: &mut Vec<u8>) {
        if let Some(line) = self.lines.get(self.next).filter(|_| !self.awaiting) {
            out.extend_from_slice(format!("{line}\n").as_bytes());
            (self.next, self.awaiting) = (self.next + 1, true);
        }
    }

    fn hear(&mut self, line: &str) {
        self.awaiting &= !line.starts_with("ok");
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.next == self.lines.len() && !self.awaiting
    }
}

fn talk(settings: &Settings, hosts: &mut [&mut dyn Host]) {
    let start = Some([100, 100, 50].map(Mm::from_num));
    run_on(settings, start, NoStorage, &Drivers::new(), hosts, &mut Deaf).unwrap();
}

#[test]
fn a_btt_screen_learns_the_machine_and_shows_no_trouble() {
    let mut screen = Screen(BttTft::new());
    talk(&load(MACHINE).unwrap(), &mut [&mut screen]);
    let screen = screen.0;
    assert_eq!(screen.is_marlin, Some(true));
    assert_eq!(screen.machine_type, "Voron 2.4 350");
    for (name, is_there) in [
        ("EEPROM", false),
        ("Z_PROBE", false),
        ("LEVELING_DATA", false),
        ("AUTOLEVEL", false),
        ("SDCARD", false),
        ("BABYSTEPPING", true),
        ("CHAMBER_TEMPERATURE", true),
        ("EMERGENCY_PARSER", true),
        ("PROMPT_SUPPORT", true),
        ("AUTOREPORT_TEMP", true),
        ("THERMAL_PROTECTION", true),
    ] {
        assert_eq!(screen.capabilities.get(name), Some(&is_there), "{name}");
    }
    for (parameter, value) in [
        ("M92E", 415.5),
        ("M92X", 80.0),
        ("M203Z", 20.0),
        ("M201X", 5000.0),
        ("M204T", 5000.0),
        ("M205J", 0.013),
        ("M207S", 3.0),
        ("M900K", 0.0),
        ("M906X", 800.0),
    ] {
        assert_eq!(screen.parameters.get(parameter), Some(&value), "{parameter}");
    }
    for parameter in ["M301P", "M304P", "M306E0P", "M306E0H"] {
        assert!(screen.parameters.contains_key(parameter), "{parameter}: {:?}", screen.parameters);
    }
    assert_eq!(screen.silent.get(&'Z'), Some(&true));
    assert_eq!(screen.silent.get(&'X'), Some(&false));
    assert!(!screen.has_soft_endstops && screen.has_bed && screen.hotend.is_some());
    assert_eq!(screen.shown, <[String; 0]>::default());
}

#[test]
fn a_machine_without_a_name_is_called_as_marlin_calls_it() {
    let settings = load("[mechanism]\nm11 = [1, 0, 0]\nm4 = [0, 1, 0]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n").unwrap();
    let mut screen = Screen(BttTft::new());
    talk(&settings, &mut [&mut screen]);
    assert_eq!(screen.0.machine_type, "3D Printer");
    assert_eq!(screen.0.capabilities.get("CHAMBER_TEMPERATURE"), Some(&false));
}

#[test]
fn the_eeprom_editor_of_octoprint_asks_and_reads_every_line_that_it_knows() {
    let mut host = Teller::new(&["M115", "M503"]);
    talk(&load(MACHINE).unwrap(), &mut [&mut host]);
    let name = host.heard.iter().find_map(|line| line.strip_prefix("FIRMWARE_NAME:")).unwrap();
    assert!(eeprom_marlin::asks(name.split(" SOURCE_CODE_URL:").next().unwrap()), "{name}");
    let read: Vec<_> = host.heard.iter().filter_map(|line| eeprom_marlin::parse(line)).collect();
    let value = |code: &str, letter: char| {
        let (_, values) = read.iter().find(|(read, _)| read == code)?;
        values.get(&letter).copied()
    };
    for (code, letter, number) in [
        ("M92", 'E', 415.5),
        ("M203", 'X', 300.0),
        ("M201", 'Z', 200.0),
        ("M204", 'P', 3000.0),
        ("M205", 'J', 0.013),
        ("M900", 'K', 0.0),
        ("M906", 'E', 800.0),
    ] {
        assert_eq!(value(code, letter), Some(number), "{code} {letter}: {:?}", host.heard);
    }
    for code in ["M301", "M304"] {
        assert!("PID".chars().all(|letter| value(code, letter).is_some()), "{code}: {:?}", host.heard);
    }
}

#[test]
fn settings_for_a_replay_are_commands_and_nothing_else() {
    let settings = load(MACHINE).unwrap();
    let mut host = Teller::new(&["M503 S0"]);
    talk(&settings, &mut [&mut host]);
    let lines: Vec<_> = host.heard.iter().filter_map(|line| line.strip_prefix("  ")).map(str::to_owned).collect();
    assert!(lines.len() > 20, "{:?}", host.heard);
    assert!(host.heard.iter().skip(2).all(|line| line.starts_with("  ") || line == "ok"), "{:?}", host.heard);
    // Sent back, they are taken without a word, and say the same again.
    let again: Vec<&'static str> = lines.iter().map(|line| &*line.clone().leak()).chain(["M503 S0"]).collect();
    let mut second = Teller::new(&again);
    talk(&settings, &mut [&mut second]);
    // M420 always says where it stands, as in Marlin.
    let is_state = |line: &str| line.starts_with("echo:Bed Leveling ") || line.starts_with("echo:Fade Height ");
    let heard: Vec<_> = second.heard.iter().skip(2).filter(|line| !is_state(line)).cloned().collect();
    assert!(heard.iter().take(lines.len()).all(|line| line == "ok"), "{:?}", second.heard);
    assert_eq!(host.heard[2..], heard[lines.len()..]);
}

#[test]
fn a_message_reaches_the_lines_that_it_is_for() {
    let mut sender = Teller::new(&[
        "M118 mine",
        "M118 P0 all",
        "M118 P0 A1 action:notification hi",
        "M118 P2 E1 second",
        "M118 P9 nowhere",
    ]);
    let mut other = Teller::new(&[]);
    talk(&Settings::prototype(), &mut [&mut sender, &mut other]);
    for (line, counts) in [
        ("mine", (1, 0)),
        ("all", (1, 1)),
        ("//action:notification hi", (1, 1)),
        ("echo:second", (0, 1)),
        // A line that is not there is the sender's, as in Marlin.
        ("nowhere", (1, 0)),
    ] {
        assert_eq!((sender.count(line), other.count(line)), counts, "{line}: {:?} {:?}", sender.heard, other.heard);
    }
    assert_eq!(sender.count("ok"), 5);
}
