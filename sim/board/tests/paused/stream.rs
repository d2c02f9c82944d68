//! A pause that ends because the stream goes on: buttons were pressed in it, and the print is what it would have been.
//!
//! The oracle is the same file without a pause, line by line: the steps of each line that prints are the last ones that
//! the line has caused.

use crate::common::life::{Life, live};
use corehbot::settings::Settings;

/// What a host numbers of its file and the lines of its buttons.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Numbers {
    /// As OctoPrint 1.11 and Pronterface.
    File,
    /// As Repetier-Host, and OctoPrint with `alwaysSendChecksum`.
    All,
    /// As a terminal.
    Nothing,
}

pub(super) const SENDERS: [Numbers; 3] = [Numbers::File, Numbers::All, Numbers::Nothing];

/// Sends lines.
pub(super) struct Host<'l, 'w> {
    pub life: &'l mut Life<'w>,
    pub sender: Numbers,
    pub number: i32,
}

impl Host<'_, '_> {
    fn say(&mut self, line: &str, is_numbered: bool) {
        let text = self.text(line, is_numbered);
        self.life.say(&text);
    }

    fn text(&mut self, line: &str, is_numbered: bool) -> String {
        if !is_numbered {
            return line.to_owned();
        }
        self.number += 1;
        let text = format!("N{} {line}", self.number);
        let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("{text}*{sum}")
    }

    /// A line of the file that is not answered yet.
    pub fn put(&mut self, line: &str) {
        let text = self.text(line, self.sender != Numbers::Nothing);
        self.life.put(0, &text);
    }

    /// A line of the file.
    pub fn stream(&mut self, line: &str) {
        self.say(line, self.sender != Numbers::Nothing);
    }

    /// A line of a button.
    pub fn press(&mut self, line: &str) {
        self.say(line, self.sender == Numbers::All);
    }

    /// A line of the file, and the steps that it has caused: ticks before its end, motors, directions.
    pub fn steps(&mut self, line: &str) -> Vec<(u64, u32, u32)> {
        self.life.mark();
        self.stream(line);
        self.life.say("M400");
        let events = self.life.events();
        let end = events.last().map_or(0, |(tick, ..)| *tick);
        events.into_iter().map(|(tick, steps, forward)| (end - tick, steps, forward)).collect()
    }
}

/// Whether the last steps are these, in this order, within 0.2 ms. A line that begins at rest depends on when the
/// Console is polled, and homing rounds a place to a step.
pub(super) fn ends_with(steps: &[(u64, u32, u32)], last: &[(u64, u32, u32)]) -> bool {
    let Some(begin) = steps.len().checked_sub(last.len()) else { return false };
    let mut pairs = steps[begin..].iter().zip(last);
    pairs.all(|(one, other)| one.0.abs_diff(other.0) <= 2000 && (one.1, one.2) == (other.1, other.2))
}

/// A file whose pause stands at [`PAUSE`], with absolute and with relative filament: straight on, after a change of
/// layer with its travel, and after a retraction by the firmware.
pub(super) fn files(relative: bool) -> [Vec<&'static str>; 3] {
    let e = |absolute: &'static str, length: &'static str| if relative { length } else { absolute };
    let begin = [
        if relative { "M83" } else { "M82" },
        "G92 E0",
        "M204 P2000 T2500",
        "G1 X110 Y100 Z1 F6000",
        e("G1 X130 Y100 E1 F1800", "G1 X130 Y100 E1 F1800"),
        e("G1 X130 Y120 E2", "G1 X130 Y120 E1"),
    ];
    let straight = [e("G1 X110 Y120 E3", "G1 X110 Y120 E1"), e("G1 X110 Y100 E4", "G1 X110 Y100 E1")];
    let layer = [
        e("G1 E1.2 F2400", "G1 E-.8 F2400"),
        "G1 Z1.4 F600",
        "M204 P1500",
        "G92 E0",
        "G1 X140 Y105 F9000",
        "G1 Z1.2 F600",
        "G1 E.8 F2400",
        "G1 F1500",
        e("G1 X110 Y105 E1.8", "G1 X110 Y105 E1"),
        e("G1 X110 E1.8", "G1 X110"),
        e("G3 X120 Y115 I10 E2.8", "G3 X120 Y115 I10 E1"),
        e("G1 X140 Y115 E4", "G1 X140 Y115 E1.2"),
    ];
    let firmware = ["G10", "G1 X115 Y105 F9000", "G11", "G1 F1800", e("G1 X140 Y105 E3", "G1 X140 Y105 E1")];
    [&straight[..], &layer, &firmware].map(|end| [&begin[..], end].concat())
}

/// The lines before the pause.
pub(super) const PAUSE: usize = 6;

/// Whether a line prints.
pub(super) fn prints(line: &str) -> bool {
    line.contains('E') && (line.contains(" X") || line.contains(" Y")) && line != "G1 X110 E1.8"
}

/// The steps of each line of a file without a pause.
pub(super) fn undisturbed(settings: &Settings, file: &[&str]) -> Vec<Vec<(u64, u32, u32)>> {
    let mut all = Vec::new();
    live(settings, 1, |life| {
        let mut host = Host { life, sender: Numbers::Nothing, number: 0 };
        all = file.iter().map(|line| host.steps(line)).collect();
    });
    all
}

/// Buttons: OctoPrint's lines (printer/standard.py 1.11.8), and what other hosts send.
const BUTTONS: [(&str, &[&str]); 12] = [
    ("nothing", &[]),
    ("extrude", &["G91", "M83", "G1 E5 F300", "M82", "G90"]),
    ("retract", &["G91", "M83", "G1 E-5 F300", "M82", "G90"]),
    ("jog up", &["G91", "G0 Z5 F200", "G90"]),
    ("jog aside", &["G91", "G0 X20 Y30 F6000", "G90", "G91", "G0 X-3.3 F6000", "G90"]),
    ("home", &["G91", "G28 X0 Y0", "G90"]),
    ("filament", &["G91", "M83", "G1 E-40 F300", "M82", "G90", "G91", "M83", "G1 E45 F300", "M82", "G90"]),
    ("modes", &["M83", "G1 E2 F100", "M82"]),
    ("purge and wipe", &["G91", "M83", "G1 X10 E3 F600", "G1 X-10 E3", "M82", "G90"]),
    ("purge there", &["M83", "G1 X30 Y5 E5 F1200", "G1 X10 E5", "M82"]),
    ("inches", &["G91", "G20", "G0 Z0.1 F100", "G21", "G90"]),
    // printcore 2.2.0, `resume`, where the file has sent the tool.
    ("resume", &["G90", "G1 X130 Y120 F6000", "G1 Z1 F600", "G92 E2", "G1 F1800"]),
];

/// The buttons of a host. One that prints in the mode of the file is a line of the file to a printer, unless the host
/// numbers the file alone.
fn buttons(sender: Numbers, relative: bool) -> impl Iterator<Item = (&'static str, &'static [&'static str])> + Clone {
    let can_be_told = !relative || sender == Numbers::File;
    BUTTONS.into_iter().filter(move |(button, _)| can_be_told || *button != "purge there")
}

/// What a button leaves behind is the filament that it has moved, and nothing else.
#[test]
fn a_print_that_streams_on_after_buttons_prints_what_it_would_have_printed() {
    let settings = Settings::prototype();
    for relative in [false, true] {
        for file in files(relative) {
            let whole = undisturbed(&settings, &file);
            for sender in SENDERS {
                for (button, lines) in buttons(sender, relative) {
                    live(&settings, 1, |life| {
                        let mut host = Host { life, sender, number: 0 };
                        let what = format!("{button} {sender:?} relative {relative} {:?}", &file[PAUSE..]);
                        for line in &file[..PAUSE] {
                            host.stream(line);
                        }
                        host.stream("M25");
                        lines.iter().for_each(|line| host.press(line));
                        let mut is_on = false;
                        for (line, alone) in file.iter().zip(&whole).skip(PAUSE) {
                            let steps = host.steps(line);
                            is_on |= prints(line);
                            assert!(!is_on || ends_with(&steps, alone), "{what}: {line}");
                            assert_eq!(host.life.count("//action:resumed"), usize::from(is_on), "{what}: {line}");
                        }
                    });
                }
            }
        }
    }
}

/// OctoPrint's scripts at a pause and at its end, as its documentation has them. It numbers them as it does the file.
#[test]
fn scripts_of_the_host_around_buttons_change_nothing() {
    let paused = ["G91", "M83", "G1 E-2 F2400", "G1 Z10", "M82", "G90", "G1 X0 Y0 F6000"];
    let resumed = ["M83", "G1 E2 F2400", "M82", "G92 E2", "G1 X130 Y120 F6000", "G1 Z1", "G1 F1800"];
    let settings = Settings::prototype();
    for relative in [false, true] {
        for file in files(relative) {
            let whole = undisturbed(&settings, &file);
            for sender in SENDERS {
                for (button, lines) in buttons(sender, relative) {
                    live(&settings, 1, |life| {
                        let mut host = Host { life, sender, number: 0 };
                        file[..PAUSE].iter().for_each(|line| host.stream(line));
                        host.stream("M25");
                        paused.iter().for_each(|line| host.stream(line));
                        lines.iter().for_each(|line| host.press(line));
                        resumed.iter().for_each(|line| host.stream(line));
                        let mut is_on = false;
                        for (line, alone) in file.iter().zip(&whole).skip(PAUSE) {
                            let steps = host.steps(line);
                            is_on |= prints(line);
                            let what = format!("{button} {sender:?} relative {relative} {line}");
                            assert!(!is_on || ends_with(&steps, alone), "{what}");
                        }
                    });
                }
            }
        }
    }
}

/// A pause before each line of a file, cancelled at its end, and all of it again on the same printer.
#[test]
fn a_printer_that_is_paused_again_and_again_prints_the_same_twice() {
    let settings = Settings::prototype();
    for relative in [false, true] {
        for file in files(relative) {
            let whole = undisturbed(&settings, &file);
            for sender in SENDERS {
                live(&settings, 1, |life| {
                    let mut host = Host { life, sender, number: 0 };
                    for (round, end) in ["M524", "M84"].into_iter().enumerate() {
                        host.life.say("N0 M110 N0*125");
                        host.number = 0;
                        host.stream("G28");
                        let pressed = buttons(sender, relative).filter(|(button, _)| *button != "resume");
                        let mut buttons = pressed.cycle().skip(round);
                        for (place, (line, alone)) in file.iter().zip(&whole).enumerate() {
                            let (button, lines) = buttons.next().unwrap();
                            if place >= PAUSE {
                                host.stream("M25");
                                lines.iter().for_each(|line| host.press(line));
                            }
                            let steps = host.steps(line);
                            let what = format!("{round} {button} {sender:?} relative {relative} {line}");
                            assert!(!prints(line) || ends_with(&steps, alone), "{what}");
                        }
                        host.stream(end);
                    }
                });
            }
        }
    }
}

/// An offset that is set in a pause counts for the rest of the print, whichever way that goes on.
#[test]
fn offsets_of_a_pause_stay() {
    for go_on in ["M24", "G1 X120 E2"] {
        for (offset, z) in [("SET_GCODE_OFFSET Z=0.2", 1.7), ("M206 Z-0.3", 1.8), ("M290 Z0.1", 1.6)] {
            live(&Settings::prototype(), 1, |life| {
                for line in ["G1 X110 Z1 F6000", "G1 X115 E1", "M25", offset, go_on, "G1 Z1.5", "G1 X130 E3", "M400"] {
                    life.say(line);
                }
                let [.., stands] = life.nozzle();
                assert!((stands - z).abs() < 0.002, "{offset}, {go_on}: {stands} instead of {z}");
            });
        }
    }
}

/// The stream goes on, but an axis has lost its home in the pause: the line is held, and nothing of the stream is lost.
#[test]
fn a_stream_that_cannot_go_on_yet_goes_on_later_as_it_was() {
    let settings = Settings::prototype();
    for relative in [false, true] {
        for file in files(relative) {
            let whole = undisturbed(&settings, &file);
            live(&settings, 2, |life| {
                let mut host = Host { life, sender: Numbers::File, number: 0 };
                file[..PAUSE].iter().for_each(|line| host.stream(line));
                host.stream("M25");
                BUTTONS[1].1.iter().for_each(|line| host.press(line));
                ["G91", "G0 X200 F12000", "G90", "M400"].iter().for_each(|line| host.press(line));
                // Homing is broken off.
                host.life.put(0, "G28 X");
                host.life.rest(1000);
                host.press("M410");
                host.life.await_ok();
                let first = PAUSE + file[PAUSE..].iter().position(|line| prints(line)).unwrap();
                file[PAUSE..first].iter().for_each(|line| host.stream(line));
                host.put(file[first]);
                host.life.rest(3000);
                assert_eq!(host.life.count("echo:print held: axes are no longer homed"), 1, "{:?}", host.life.heard);
                host.life.switch_to(1);
                host.life.say("G28 X");
                host.life.say("M24");
                host.life.switch_to(0);
                host.life.await_ok();
                host.life.say("M400");
                for (line, alone) in file.iter().zip(&whole).skip(first + 1) {
                    let steps = host.steps(line);
                    assert!(!prints(line) || ends_with(&steps, alone), "relative {relative}: {line}");
                }
                assert_eq!(host.life.count("//action:resumed"), 1);
            });
        }
    }
}
