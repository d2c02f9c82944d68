//! The first hour with the image: `corehbot bringup` at a pseudo-terminal in place of the board's UART. The rig's heat,
//! switches and drivers are on the pins, and a hand uses them.

use crate::common::{Bench, bench_of, plain_firmware, talk_on};
use corehbot::motors::prototype;
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::eeprom::At24c32;
use corehbot_emulator::run::Seen;
use corehbot_emulator::terminal::Terminal;
use corehbot_emulator::watch::End;
use corehbot_emulator::wiring::OCTOPUS;
use corehbot_host::serial::{Hand, Port, Speed};
use corehbot_host::stop::Stop;
use corehbot_machine_file as machine_file;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::wiring_mistakes::Plugs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::{JoinHandle, spawn};

/// A hotend so light that the tuning takes 40 s instead of three minutes.
const HOTEND: &str = "[heaters.hotend]\nis_fitted = true\n[heaters.hotend.model]\ncapacity = 1\n";

/// The command, which is an example of this crate and is built with its tests.
fn command() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    let command = program.parent().and_then(Path::parent).unwrap().join("examples/command_for_emulator");
    assert!(command.exists(), "{} is built with all tests of this crate", command.display());
    command
}

/// The prototype, and a CoreXY with one screw: it has half as many motors to be looked at.
const COREHBOT: &str = "name = \"first hour\"\nboard = \"octopus\"\n";
const COREXY: &str = "name = \"first hour\"\nboard = \"octopus\"\n\
                      [mechanism]\nm11 = [1, 1, 0]\nm8 = [1, -1, 0]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n";

/// The room of the rig's plant (`ambient_celsius` of sim/rig/src/plant/prototype.rs).
const ROOM_CELSIUS: f64 = 25.0;

/// A reading's noise: 0.8 LSB of 12 bits (`noise_lsb` there) are 0.1 K at an NTC of 100 kOhm under 4.7 kOhm, and a draw
/// is within five deviations.
const NOISE_KELVIN: f64 = 0.5;

/// The silence that the guide bears, in s. A board at work says `busy` every 2 s of its own time, and half a dozen
/// tests on a slow computer make a minute of them.
const PATIENCE: &str = "120";

/// The same where the board is switched off in the middle and the test waits for as long.
const SHORT_PATIENCE: &str = "40";

const STEPS: [&str; 11] = [
    "The board answers",
    "Supply voltages",
    "Thermistors",
    "Endstops",
    "Motor drivers",
    "Motors",
    "Heaters",
    "Homing",
    "Directions",
    "Heater tuning",
    "First layer",
];

/// A folder with a machine file and reports, and a printer at its port.
struct Printer {
    folder: PathBuf,
    machine: String,
    hand: Sender<String>,
    run: Option<JoinHandle<Seen>>,
}

impl Printer {
    /// Switches a printer on that is built after this machine file and has a hotend, with these mistakes and accidents.
    fn new(machine: &str, mistakes: &[&str], accidents: &[&str]) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("corehbot-first-hour-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let machine = machine.to_owned() + HOTEND;
        std::fs::write(folder.join("m.toml"), &machine).unwrap();
        let mut printer = Self { folder, machine: machine.clone(), hand: channel().0, run: None };
        let settings = machine_file::load(&machine).unwrap();
        let mut plugs = Plugs::default();
        mistakes.iter().for_each(|mistake| plugs.make(mistake, &settings).unwrap());
        let accidents = accidents.iter().map(|accident| accident.parse().unwrap()).collect();
        let heat = HeatSetup { truth: None, accidents };
        printer.switch_on(Bench { heat, plugs: Some(plugs), is_untested: true, ..bench_of(settings) });
        printer
    }

    fn switch_on(&mut self, bench: Bench<'static>) {
        let port = Port::open(Some(&self.folder.join("printer"))).unwrap();
        let (hand, lines) = channel();
        let terminal = Terminal::new(port, Speed::Max, Stop::default(), Some(Hand::at(lines)));
        self.hand = hand;
        self.run = Some(spawn(move || talk_on(&plain_firmware(), "", &bench, Some(terminal))));
    }

    /// Switches it off, and returns what was seen on its pins.
    fn switch_off(&mut self) -> Seen {
        let _ = self.hand.send("off".to_owned());
        let seen = self.run.take().unwrap().join().unwrap();
        assert_eq!((seen.end, &seen.safety.dangers, &seen.gaps.found), (End::Done, &vec![], &vec![]));
        assert_eq!((seen.recorder.unpowered, seen.recorder.split_pairs), (0, 0));
        assert!(seen.drivers.iter().all(|line| (line.collisions, line.floating) == (0, 0)));
        println!("{:.1} s of emulated time in {:.1} s", seen.virtual_ns as f64 / 1e9, seen.wall.as_secs_f64());
        seen
    }

    /// Switches it on again with the memory that it had.
    fn switch_on_again(&mut self, eeprom: At24c32) {
        let settings = machine_file::load(&self.machine).unwrap();
        let eeprom = At24c32::holding(eeprom.cells);
        self.switch_on(Bench {
            settings,
            eeprom,
            drivers: DriverLines::new(&OCTOPUS),
            is_untested: true,
            ..Bench::default()
        });
    }

    /// Leads through the guide. `owner` gets the key of each question, and a hand; its answer is a line.
    fn lead(&self, args: &[&str], owner: impl FnMut(&str, &dyn Fn(&str)) -> String) -> Led {
        self.lead_with(PATIENCE, args, owner)
    }

    fn lead_with(&self, patience: &str, args: &[&str], mut owner: impl FnMut(&str, &dyn Fn(&str)) -> String) -> Led {
        let mut guide = Command::new(command());
        guide.arg("bringup").arg(self.folder.join("printer")).arg("--report").arg(self.folder.join("r.md"));
        guide.args(["--patience", patience, "--machine"]).arg(self.folder.join("m.toml")).args(args);
        let mut guide = guide.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (mut out, mut said) = (guide.stdin.take().unwrap(), String::new());
        for line in BufReader::new(guide.stdout.take().unwrap()).lines().map_while(Result::ok) {
            said += &format!("{line}\n");
            let Some((key, _)) = line.strip_prefix("? [").and_then(|line| line.split_once(']')) else { continue };
            let answer = owner(key, &|act| self.hand.send(act.to_owned()).unwrap());
            if writeln!(out, "{answer}").is_err() {
                break;
            }
        }
        let status = guide.wait().unwrap().code();
        Led { status, said, report: std::fs::read_to_string(self.folder.join("r.md")).unwrap() }
    }
}

impl Drop for Printer {
    fn drop(&mut self) {
        let _ = self.hand.send("off".to_owned());
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

struct Led {
    status: Option<i32>,
    said: String,
    report: String,
}

impl Led {
    /// Every step has ended so: its place in the row of steps, and the word of the report.
    fn assert_ended(&self, ends: [&str; STEPS.len()]) {
        let headings: Vec<_> = self.report.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        let expected: Vec<_> =
            (1..).zip(STEPS.iter().zip(ends)).map(|(n, (step, end))| format!("{n}. {step}: {end}")).collect();
        assert_eq!(headings, expected, "{}\n{}", self.said, self.report);
    }

    fn assert_reports(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.report.contains(part), "{part}\n{}", self.report);
        }
    }
}

#[test]
fn the_whole_guide_passes_on_the_image() {
    let mut printer = Printer::new(COREHBOT, &[], &[]);
    let led = printer.lead(&["--yes"], |_, _| String::new());
    led.assert_ended(["passed"; 11]);
    assert_eq!(led.status, Some(0), "{}", led.said);
    led.assert_reports(&[
        "- Machine: first hour\n- Firmware: CoreH-bot ",
        "motors m1 m4 m8 m11 z1 z2 e0\n",
        "m11: answers, not configured yet",
        "m1 m4 m8 m11: wired as in the file",
        "z2 alone, none free: apart",
        "e0: feeds filament in",
        "each of hotend warms its own sensor",
        "Z met its switch",
        "Y: back",
        " J/K, ",
        "stored (M500)",
    ]);
    let cold = led.report.lines().find_map(|line| line.strip_prefix("- hotend: ")?.strip_suffix(" C in the cold"));
    let cold: f64 = cold.expect(&led.report).parse().unwrap();
    assert!((cold - ROOM_CELSIUS).abs() <= NOISE_KELVIN, "{cold}\n{}", led.report);
    let seen = printer.switch_off();
    assert!(seen.resets.is_empty(), "{:?}", seen.resets);
    // 10 mm from the switch of z, where homing has left it, with 800 steps/mm.
    assert!(seen.recorder.events.len() > 10 * 800);
}

/// A thermistor without contact, two switches in each other's place, and a driver that is silent: the report names each
/// with its cure. Nothing gets warm, and no motor of the driver's belt moves.
#[test]
fn the_report_names_what_is_wired_wrongly() {
    let mistakes = ["swap-endstops:x,y", "silent-driver:m8"];
    let mut printer = Printer::new(COREXY, &mistakes, &["open:hotend@0s"]);
    let led = printer.lead(&[], |key, hand| {
        let words: Vec<_> = key.split(' ').collect();
        match words[..] {
            ["endstops", "press", switch] => hand(&format!("press {switch}")),
            ["endstops", "release", _] => hand("let go"),
            ["supply", "supply"] => return "24".to_owned(),
            [_, "needs" | "decide"] => return "skip".to_owned(),
            _ => {}
        }
        String::new()
    });
    let (good, bad) = ("passed", "skipped");
    led.assert_ended([good, good, bad, bad, bad, bad, bad, bad, bad, bad, good]);
    assert_eq!(led.status, Some(1));
    led.assert_reports(&[
        "power terminals: 24 V",
        "**hotend: its sensor is open.** Cure: plug it in",
        "**x_min (it is y_min): another input reads pressed.** Cure: exchange the two plugs",
        "**y_min (it is x_min): another input reads pressed.** Cure: exchange the two plugs",
        "- z_min: open, pressed, open\n",
        "motors m8 m11 z1 e0\n",
        "**m8: does not answer: is the motor supply on",
        "- m11: answers, ",
        "**m8: ",
        "Cure: do the step of the drivers again.",
    ]);
    let seen = printer.switch_off();
    assert!(
        seen.recorder.events.iter().all(|event| !event.steps.intersects(prototype::BELT)),
        "it moved without a driver"
    );
    assert!(seen.heat.edges.iter().all(|edge| !edge.is_high), "it got warm without a sensor");
}

/// The reset button in mid-heating, and the plug of the mains in mid-homing. Both times the guide says so, and goes on
/// where it was.
#[test]
fn a_guide_goes_on_after_a_reset_and_after_a_power_cut() {
    let mut printer = Printer::new(COREXY, &[], &[]);
    let mut has_reset = false;
    let led = printer.lead_with(SHORT_PATIENCE, &[], |key, hand| {
        match key {
            "sensors hotend" => hand("warm hotend"),
            "endstops press x" | "endstops press y" | "endstops press z" => hand(&key["endstops ".len()..]),
            "endstops release x" | "endstops release y" | "endstops release z" => hand("let go"),
            // The self-test takes 6 s.
            "heaters begin" if !has_reset => {
                has_reset = true;
                hand("reset in 2 s");
            }
            "heaters decide" => return "again".to_owned(),
            "homing start z" => hand("off in 1 s"),
            _ => {}
        }
        String::new()
    });
    assert_eq!(led.status, Some(1), "{}", led.said);
    assert!(led.said.contains("the board restarted in the middle of this step."), "{}", led.said);
    assert!(led.said.contains("the board does not answer any more"), "{}", led.said);
    assert!(led.said.contains("goes on with this step"), "{}", led.said);
    led.assert_reports(&["hotend: follows a warm hand by ", "x_min: open, pressed, open", "## 7. Heaters: passed"]);
    assert!(!led.report.contains("Homing"), "{}", led.report);
    let first = printer.switch_off();
    assert_eq!(first.resets.len(), 1);
    printer.switch_on_again(first.eeprom);
    let mut keys = Vec::new();
    let led = printer.lead(&[], |key, _| {
        keys.push(key.to_owned());
        if key.starts_with("tuning") { "no".to_owned() } else { String::new() }
    });
    assert_eq!(keys[0], "homing start x", "{}", led.said);
    led.assert_ended(["passed"; 11]);
    assert_eq!(led.status, Some(0), "{}", led.said);
    printer.switch_off();
}
