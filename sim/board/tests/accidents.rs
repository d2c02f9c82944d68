//! Every accident, before a heater is used and while it is: every wait for it ends.

use crate::common::deaf::Deaf;
use crate::common::heated::heated;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::TICKS_PER_SECOND;
use corehbot_sim::accident::{Accident, Family, ROWS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, World};

/// When the accident happens, and when the heater is asked for: before and after, in s.
const TIMES: [(f64, f64); 2] = [(1.0, 3.0), (4.0, 3.0)];

/// How it ended.
#[derive(Debug, PartialEq)]
enum End {
    /// The machine halted.
    Fault,
    /// The job ended, the machine stays.
    Job,
    /// The heater is at its target, or is known.
    Done,
}

/// Says a line at its time on a machine that breaks at another. Returns the end, its time in s, and the messages.
fn life(settings: &Settings, accident: Accident, line: &str, at_s: f64, most_s: f64) -> (End, f64, String) {
    let (drivers, mut desk, mut deaf) = (Drivers::new(), Desk::new(1), Deaf);
    let word = accident.row.word;
    desk.heat.accidents = vec![accident];
    let mut world = World::new(&mut desk, settings, None, NoStorage, &drivers, &mut deaf);
    let (mut heard, mut begun) = (String::new(), None);
    let (mut is_answered, mut is_cancelled) = (false, false);
    loop {
        world.poll();
        let said = world.wires()[0].heard();
        if !said.is_empty() && begun.is_some() {
            let from = heard.rfind('\n').map_or(0, |end| end + 1);
            heard.push_str(&String::from_utf8(said).unwrap());
            is_answered |= heard[from..].lines().any(|line| line.starts_with("ok"));
            is_cancelled |= heard[from..].contains("//action:cancel");
        }
        let now = world.now() as f64 / f64::from(TICKS_PER_SECOND);
        if begun.is_none() && now >= at_s {
            world.wires()[0].put(format!("{line}\n").into_bytes());
            begun = Some(now);
        }
        let seconds = now - begun.unwrap_or(now);
        if world.status().is_halted() {
            return (End::Fault, seconds, heard);
        }
        if is_answered {
            return (if is_cancelled { End::Job } else { End::Done }, seconds, heard);
        }
        assert!(seconds < most_s, "{line} waits for ever after {word}: {heard}");
        world.advance();
    }
}

/// The floor of the guards allows a hotend half an hour for 2 C, and a bed an hour (`thermal::guard::floor`).
#[test]
fn whatever_breaks_no_wait_for_heat_lasts_longer_than_the_guards_allow() {
    for (line, place, most_s) in
        [("M109 S200", "hotend", 1800.0), ("M190 S60", "bed", 3600.0), ("M303 E0 S200 C3", "hotend", 1800.0)]
    {
        for row in ROWS.iter().filter(|row| matches!(row.family, Family::Heat | Family::Supply)) {
            for (broken_s, at_s) in TIMES {
                let place = if row.names().any(|name| name == place) { format!(":{place}") } else { String::new() };
                let accident: Accident = format!("{}{place}@{broken_s}s", row.word).parse().unwrap();
                let (end, seconds, heard) = life(&heated(), accident, line, at_s, most_s);
                println!("{line}, {} at {broken_s} s: {end:?} after {seconds:.1} s", row.word);
                // A wait does not start for an unreadable sensor.
                let is_unread = matches!(row.word, "open" | "short" | "converter" | "channels");
                assert!(!is_unread || seconds < 4.0, "{line}, {}: {seconds} s: {heard}", row.word);
                assert!(!is_unread || line.starts_with("M303") || end != End::Done, "{line}, {}: {heard}", row.word);
            }
        }
    }
}

/// A part that broke before any heating is not a fault: the job ends, and the machine can be homed, moved and queried.
#[test]
fn a_heater_without_a_reading_ends_the_job_and_says_why() {
    for (kind, line, name) in
        [("open", "M109 S200", "hotend"), ("short:bed", "M190 S60", "bed"), ("converter", "M190 S60", "bed")]
    {
        let accident = format!("{kind}@1s").parse().unwrap();
        let (end, _, heard) = life(&heated(), accident, line, 3.0, 60.0);
        assert_eq!(end, End::Job, "{heard}");
        let told = format!("echo:print ended, heaters are off: {name} has no reading. Check its sensor");
        assert!(heard.lines().any(|line| line.starts_with(&told)), "{heard}");
        assert!(!heard.contains("Error") && !heard.contains("!!"), "{heard}");
    }
}
