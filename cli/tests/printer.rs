//! `config from --serial`: a scripted printer on a pseudo-terminal. It resets when its line is opened, and speaks text
//! at its own rate only.
#![cfg(unix)]

use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::{Errno, read, write};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::tcgetattr;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

/// What a printer says.
#[derive(Clone, Copy)]
struct Script {
    /// The rate at which its bytes are text; 0 is none, as a board that speaks no text at all.
    baud: u32,
    /// What it says after its bootloader.
    start: &'static str,
    /// Answers, by the beginnings of lines; the first that fits counts. Without one it is silent.
    answers: &'static [(&'static str, &'static str)],
}

const M115: &str = "FIRMWARE_NAME:Marlin 2.1.2.4 (x) SOURCE_CODE_URL:y PROTOCOL_VERSION:1.0 MACHINE_TYPE:Scripted \
                    EXTRUDER_COUNT:1 UUID:z\nCap:EEPROM:1\nok\n";

/// With temperature reports and busy lines in between, as they come from a printer.
const M503: &str = "echo:; Linear Units:\necho:  G21 ; (mm)\necho:; Steps per unit:\necho:busy: processing\necho:  M92 \
                    X80.00 Y80.00 Z400.00 E93.00\nT:21.3 /0.0 B:22.1 /0.0 @:0 B@:0\necho:; Max feedrates (units/s):\n\
                    echo:  M203 X500.00 Y500.00 Z5.00 E25.00\nwait\necho:busy: processing\n\
                    echo:  M201 X500.00 Y500.00 Z100.00 E5000.00\necho:  M204 P500.00 R1000.00 T500.00\n\
                    echo:  M205 B20000.00 S0.00 T0.00 X10.00 Y10.00 Z0.30 E5.00\nok P15 B3\n";

const UNKNOWN: (&str, &str) = ("M", "echo:Unknown command: \"M\"\nok\n");

const MARLIN: Script = Script {
    baud: 250_000,
    start: "start\necho:Marlin 2.1.2.4\necho: Last Updated: 2024-07-01\necho:SD init fail\n",
    answers: &[
        ("M115", M115),
        ("M503", M503),
        ("M211", "echo:Soft endstops: On  Min: X0.00 Y0.00 Z0.00   Max: X235.00 Y230.00 Z250.00\nok\n"),
        ("M119", "Reporting endstop status\nx_min: open\ny_min: open\nz_min: TRIGGERED\nok\n"),
        ("M122", "\t\tX\tY\tZ\tE\nEnabled\t\tfalse\tfalse\tfalse\tfalse\nmsteps\t\t16\t16\t32\t16\nok\n"),
        UNKNOWN,
    ],
};

/// A printer until its line is closed.
fn printer(script: Script) -> (PathBuf, JoinHandle<()>) {
    let near = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&near).and_then(|()| unlockpt(&near)).unwrap();
    let path = PathBuf::from(ptsname(&near, Vec::new()).unwrap().into_string().unwrap());
    // Once opened and closed, the line tells whether it is open.
    drop(open(&path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap());
    fcntl_setfl(&near, OFlags::RDWR | OFlags::NONBLOCK).unwrap();
    let play = spawn(move || play(&near, script));
    (path, play)
}

/// How long the bootloader is deaf.
const BOOTLOADER: Duration = Duration::from_millis(400);

fn play(near: &OwnedFd, script: Script) {
    let mut bytes = [0; 256];
    let (mut opened, mut has_started) = (None::<Instant>, false);
    let mut line = Vec::new();
    let patience = Instant::now();
    while patience.elapsed() < Duration::from_secs(60) {
        let count = match read(near, &mut bytes) {
            Ok(count) => count,
            Err(Errno::AGAIN) => 0,
            // It is closed.
            Err(_) if opened.is_some() => return,
            Err(_) => {
                sleep(Duration::from_millis(2));
                continue;
            }
        };
        let since = opened.get_or_insert_with(Instant::now).elapsed();
        if since < BOOTLOADER {
            sleep(Duration::from_millis(2));
            continue;
        }
        if !has_started {
            has_started = true;
            say(near, script, script.start);
        }
        for byte in &bytes[..count] {
            line.push(*byte);
            if *byte == b'\n' {
                let command = String::from_utf8_lossy(&std::mem::take(&mut line)).trim().to_owned();
                let answer = script.answers.iter().find(|(begin, _)| command.starts_with(begin));
                say(near, script, answer.map_or("", |(_, answer)| answer));
            }
        }
        sleep(Duration::from_millis(2));
    }
}

/// At another rate bytes are broken.
fn say(near: &OwnedFd, script: Script, text: &str) {
    let is_text = tcgetattr(near).unwrap().output_speed() == script.baud;
    let bytes: Vec<u8> = text.bytes().map(|byte| if is_text { byte } else { byte | 0x80 }).collect();
    let mut rest = bytes.as_slice();
    while !rest.is_empty() {
        match write(near, rest) {
            Ok(count) => rest = &rest[count..],
            Err(Errno::AGAIN) => sleep(Duration::from_millis(2)),
            Err(_) => return,
        }
    }
}

fn config(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("config").args(args).output().unwrap()
}

/// Asks a scripted printer; returns the status and all that was said.
fn ask(script: Script, args: &[&str]) -> (Option<i32>, String) {
    let (path, play) = printer(script);
    let output = config(&[&["from", "--serial", path.to_str().unwrap()], args].concat());
    play.join().unwrap();
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (output.status.code(), said.concat())
}

fn file(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_file(&path);
    path
}

#[test]
fn a_printer_that_resets_becomes_a_machine() {
    // At the rate that is tried first, and at the second.
    for baud in [250_000, 115_200] {
        let path = file(&format!("scripted-{baud}.toml"));
        let name = path.to_str().unwrap();
        let args = ["--board", "octopus", "--kinematics", "cartesian", "-o", name];
        let (status, said) = ask(Script { baud, ..MARLIN }, &args);
        assert_eq!(status, Some(0), "{baud}: {said}");
        for told in [
            &*format!("asking at {baud} baud"),
            "Marlin 2.1.2.4 (x)",
            "X = 80.00 -> axes.x.steps_per_mm = 80",
            "axes.y.length = 230",
            "Z = 32 -> drivers.z.microsteps = 32",
            "to be filled in\n  motors.x = \"M0\"",
        ] {
            assert!(said.contains(told), "{told}: {said}");
        }
        let check = config(&["check", name]);
        assert_eq!(check.status.code(), Some(0), "{}", String::from_utf8_lossy(&check.stdout));
        let machine = corehbot_machine_file::read(&path).unwrap();
        assert_eq!(machine.name.as_deref(), Some("Scripted"));
        assert_eq!(machine.settings.axes.z.length.to_num::<f64>(), 250.0);
        // An existing file stays, and the printer is not asked.
        let (status, said) = (config(&["from", "--serial", "/dev/null", "-o", name]).status.code(), said);
        assert_eq!(status, Some(2), "{said}");
    }
}

/// Makers give Marlin a name of their own.
#[test]
fn a_firmware_with_another_name_that_answers_as_marlin_is_taken() {
    const ANSWERS: &[(&str, &str)] =
        &[("M115", "FIRMWARE_NAME:Maker UFW 2.97 MACHINE_TYPE:Mine\nok\n"), ("M503", M503), UNKNOWN];
    let (status, said) = ask(Script { answers: ANSWERS, ..MARLIN }, &["--kinematics", "corexy"]);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("Maker UFW 2.97 is not Marlin: check every line"), "{said}");
}

#[test]
fn other_firmwares_have_their_own_cures() {
    let mut waiting = Vec::new();
    for (answers, start, cure) in [
        (
            &[("M115", "FIRMWARE_NAME: RepRapFirmware for Duet 2 WiFi FIRMWARE_VERSION: 3.4.5\nok\n")][..],
            "",
            "/sys/config.g",
        ),
        (&[("M115", "ok FIRMWARE_VERSION:v0.12.0 FIRMWARE_NAME:Klipper\n")], "", "config from printer.cfg"),
        (
            &[("M115", "FIRMWARE_NAME:Prusa-Firmware 3.14.1 based on Marlin FIRMWARE_URL:x\nok\n")],
            "start\n",
            "config from FILE",
        ),
        (&[("M", "error:20\n")], "GrblHAL 1.1f ['$' or '$HELP' for help]\n", "$100 to $132"),
        (&[("M115", "FIRMWARE_NAME:Bread V2 PROTOCOL_VERSION:1.0\nok\n"), UNKNOWN], "", "is Bread V2, not Marlin"),
    ] {
        waiting.push(spawn(move || {
            let (status, said) = ask(Script { answers, start, baud: 250_000 }, &[]);
            assert!(status == Some(2) && said.contains(cure), "{cure}: {said}");
            assert!(said.contains("not Marlin: "), "{said}");
        }));
    }
    waiting.into_iter().for_each(|case| case.join().unwrap());
}

#[test]
fn a_printer_that_cannot_answer_is_told_with_the_cure() {
    // At once, because each waits for silence.
    let mut waiting = Vec::new();
    let quiet = Script { baud: 250_000, start: "", answers: &[] };
    for (script, cure) in [
        (quiet, "is the printer switched on"),
        (Script { baud: 0, answers: &[("", "garbage of a wrong rate\n")], ..quiet }, "say its rate by --baud"),
        (Script { start: "Error:Printer halted. kill() called!\n", ..quiet }, "switch it off and on"),
        (Script { start: "Hello, a 3D scanner\n", ..quiet }, "says \"Hello, a 3D scanner\", and nothing to M115"),
        (Script { answers: &[("M115", M115), UNKNOWN], ..quiet }, "DISABLE_M503"),
        (Script { answers: &[("M115", M115), ("M503", "echo:busy: paused for user\n")], ..quiet }, "press it"),
    ] {
        waiting.push(spawn(move || {
            let (status, said) = ask(script, &["--baud", "250000"]);
            assert!(status == Some(2) && said.contains(cure), "{cure}: {said}");
        }));
    }
    waiting.into_iter().for_each(|case| case.join().unwrap());
}

#[test]
fn a_port_that_cannot_be_opened_is_told_with_the_cure() {
    for (port, cure) in [("/dev/no-such-port", "there is no such port; th"), ("/dev/null", "it is none; th")] {
        let output = config(&["from", "--serial", port]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(cure), "{said}");
        assert!(said.contains("as a serial line"), "{said}");
    }
}
