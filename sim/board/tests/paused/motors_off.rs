//! Motors lose their power while a print is paused (M84): the print waits until the axes are homed again, and goes on
//! where it was.
//!
//! The oracle is that of [`stream`](super::stream): the same file without a pause.

use super::stream::{Host, Numbers, PAUSE, SENDERS, ends_with, files, prints, undisturbed};
use super::{MINUTE, heated, place, print};
use crate::common::life::{Life, live, live_at};
use corehbot::settings::{AxisEnd, Settings};

/// What M84 says in a pause.
const STAYS: &str = "echo:the print stays paused. To go on, home the axes (G28) and send M24; M524 ends it";

/// How the print goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Way {
    /// Homed, then M24; the file comes after that.
    Resumed,
    /// Homed, and the file goes on.
    Streamed,
    /// The file goes on, and its first line that moves an axis is held. Another host homes and answers: M24, M108, the
    /// prompt.
    Held(&'static str),
}

const WAYS: [Way; 5] = [Way::Resumed, Way::Streamed, Way::Held("M24"), Way::Held("M108"), Way::Held("M876 S0")];

/// Another host says lines.
fn other_says(life: &mut Life<'_>, lines: &[&str]) {
    life.switch_to(1);
    lines.iter().for_each(|line| life.say(line));
    life.switch_to(0);
}

/// Whether a line of the files moves an axis.
fn moves(line: &str) -> bool {
    [" X", " Y", " Z"].iter().any(|word| line.contains(word))
}

/// The print goes on with this line of the file, which is held and answered.
fn answer_held(host: &mut Host<'_, '_>, way: Way, line: &str) {
    host.life.mark();
    host.put(line);
    host.life.rest(3000);
    assert!(host.life.events().is_empty(), "nothing moves");
    if let Way::Held(answer) = way {
        // M24 was told the same before.
        assert_eq!(host.life.count("echo:print held: axes are no longer homed"), 2, "{:?}", host.life.heard);
        other_says(host.life, &["M24"]);
        host.life.rest(1000);
        assert_eq!(host.life.count("//action:resumed"), 0, "not without a home");
        other_says(host.life, &["G28", answer]);
    } else {
        // It may be another file.
        assert_eq!(host.life.count("echo:print held: its motors were off"), 1, "{:?}", host.life.heard);
        other_says(host.life, &["M24"]);
    }
    host.life.await_ok();
    host.life.say("M400");
}

/// Reproducer: M84 in a pause ended the print. Its file went on all the same: unhomed, at the height where it was
/// parked, and after G28 at Z0.
#[test]
fn a_print_whose_motors_were_off_in_a_pause_goes_on_where_it_was_once_homed() {
    let settings = Settings::prototype();
    for relative in [false, true] {
        for file in files(relative) {
            let whole = undisturbed(&settings, &file);
            for (sender, way) in SENDERS.into_iter().flat_map(|sender| WAYS.map(|way| (sender, way))) {
                live(&settings, 2, |life| {
                    let mut host = Host { life, sender, number: 0 };
                    let what = format!("{sender:?} {way:?} relative {relative} {:?}", &file[PAUSE..]);
                    file[..PAUSE].iter().for_each(|line| host.stream(line));
                    host.stream("M25");
                    host.press("M84");
                    assert!(!host.life.has_power() && host.life.count(STAYS) == 1, "{what}: {:?}", host.life.heard);
                    host.press("M24");
                    assert_eq!(host.life.count("echo:print held: axes are no longer homed"), 1, "{what}");
                    if !matches!(way, Way::Held(_)) {
                        host.press("G28");
                    }
                    if way == Way::Resumed {
                        host.press("M24");
                    }
                    let mut waits = way != Way::Resumed && (way != Way::Streamed || sender == Numbers::Nothing);
                    let mut is_on = way == Way::Resumed;
                    for (line, alone) in file.iter().zip(&whole).skip(PAUSE) {
                        if waits && (prints(line) || way != Way::Streamed && moves(line)) {
                            answer_held(&mut host, way, line);
                            (waits, is_on) = (false, true);
                            continue;
                        }
                        is_on |= prints(line);
                        let steps = host.steps(line);
                        assert!(!is_on || ends_with(&steps, alone), "{what}: {line}");
                    }
                    assert_eq!(host.life.count("//action:resumed"), 1, "{what}");
                });
            }
        }
    }
}

/// Where the tool is after the first two lines of the next print.
fn print_next(life: &mut Life<'_>) -> [f64; 4] {
    for line in ["N0 M110 N0*125", "G28", "G92 E0", "M302 P1", "G1 X50 Y50 Z1 F6000", "G1 X80 E5", "M400"] {
        life.say(line);
    }
    assert_eq!(life.count("//action:pause action:pause"), 0, "{:?}", life.heard);
    place(life)
}

/// OctoPrint's script sends M84 while the print is paused, and no M524 (comm.py 1.11.8, `cancelPrint`).
#[test]
fn a_print_that_is_cancelled_behind_m84_leaves_nothing_to_the_next_one() {
    let file = ["G28", "G1 X10 Y10 Z1 F6000", "M83", "G92 E0", "G1 X20 E3", "G92 X5 E7", "M25"];
    let octoprint = ["M400", "M114", "M84", "M104 T0 S0", "M140 S0", "M106 S0"];
    let mut places = Vec::new();
    for end in [&["M84", "M524", "G28"][..], &["M524", "M84"], &octoprint, &["M84", "G28", "M77"]] {
        live(&Settings::prototype(), 1, |life| {
            file.iter().chain(end).for_each(|line| life.say(line));
            let first = life.extruder_steps();
            let [x, y, z, e] = print_next(life);
            places.push([x, y, z, e - f64::from(first) / 400.0]);
            assert_eq!(life.count("//action:resumed"), 0, "{end:?}");
        });
    }
    assert!(places.iter().all(|place| *place == [80.0, 50.0, 1.0, 5.0]), "{places:?}");
}

/// Nothing of the print knows the places of its axes, but they have changed since.
#[test]
fn axes_that_were_never_homed_must_be_homed_when_their_motors_were_off() {
    live_at(&Settings::prototype(), None, 1, |life| {
        for line in ["G1 X10 E1 F6000", "M25", "M84 X Y", "M24", "G28 X", "M24"] {
            life.say(line);
        }
        assert_eq!(life.count("echo:print held: axes are no longer homed"), 2, "{:?}", life.heard);
        life.say("G28 Y");
        life.say("M24");
        assert_eq!(life.count("//action:resumed"), 1, "{:?}", life.heard);
    });
}

/// A line that waits for its user, or until its time is over, waits on, and says once why.
#[test]
fn a_line_that_waits_for_its_user_waits_until_the_axes_are_homed() {
    for wait in ["M0 S5", "M0", "M600"] {
        live(&Settings::prototype(), 2, |life| {
            life.say("G28");
            life.put(0, wait);
            life.rest(1000);
            other_says(life, &["M84"]);
            life.rest(10_000);
            life.put(0, "M108");
            life.rest(1000);
            let told = life.count("echo:print held: axes are no longer homed");
            assert!((1..=2).contains(&told), "{wait}: {:?}", life.heard);
            assert_eq!(life.count("//action:resumed"), 0);
            other_says(life, &["G28", "M24"]);
            life.rest(3000);
            assert_eq!(life.count("//action:resumed"), 1, "{wait}: {:?}", life.heard);
        });
    }
}

/// Z goes down to where the part may be, unless its switch is above.
#[test]
fn the_user_is_told_when_homing_z_may_hit_the_part() {
    for (end, m84, is_told) in
        [(AxisEnd::Min, "M84", 1), (AxisEnd::Min, "M18 X Y", 0), (AxisEnd::Max, "M84", 0), (AxisEnd::Min, "M84 Z", 1)]
    {
        let mut settings = Settings::prototype();
        settings.endstops.z.end = end;
        live(&settings, 1, |life| {
            for line in ["G1 X110 E1 F6000", "M25", m84] {
                life.say(line);
            }
            let told = life.count(&format!("{STAYS}. Homing Z may hit the part: then end the print"));
            assert_eq!((life.count(STAYS), told), (1, is_told), "{end:?} {m84}: {:?}", life.heard);
        });
    }
}

/// A pause outside of a print, as M125 makes it to park the tool, ends with its motors.
#[test]
fn a_pause_that_no_print_and_no_line_waits_for_ends_with_m84() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["M125", "M84", "M24"] {
            life.say(line);
        }
        assert_eq!(life.count(STAYS) + life.count("//action:resumed"), 0, "{:?}", life.heard);
    });
}

/// Motors hold while a paused print knows its place, and no longer.
#[test]
fn motors_that_were_off_in_a_pause_lose_their_power_again_unless_they_are_homed() {
    for (home, holds) in [("G28", true), ("G28 X", false)] {
        live(&Settings::prototype(), 1, |life| {
            for line in ["G1 X110 E1 F6000", "M25", "M84", home] {
                life.say(line);
            }
            life.rest(11 * MINUTE);
            assert_eq!(life.has_power(), holds, "{home}");
        });
    }
}

/// Filament that the program has pulled back before the pause comes forth after it, once.
#[test]
fn a_retraction_by_the_program_is_still_one_after_the_motors_were_off() {
    for lines in [&[][..], &["M84", "G28"], &["G28 X"], &["M84 E"]] {
        live(&heated(), 1, |life| {
            print(life);
            let begin = place(life);
            for line in [&["M207 S4", "G10", "M25"][..], lines, &["M24", "G11", "G1 X160 E6", "M400"]].concat() {
                life.say(line);
            }
            let [x, y, z, e] = begin;
            assert_eq!(place(life), [x + 10.0, y, z, e + 1.0], "{lines:?}: {:?}", life.heard);
        });
    }
}
