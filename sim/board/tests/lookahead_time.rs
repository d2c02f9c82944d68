//! The look-ahead's reach in time: a pause or a cancel takes effect soon, and no step changes by the limit.

use crate::common::trace::Trace;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, Seconds, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::file_line::strip_comment;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Desk, Outcome, World, run};
use std::path::Path;

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name);
    std::fs::read_to_string(path).unwrap()
}

fn reaching(seconds: f64) -> Settings {
    Settings { lookahead_time: Seconds::from_num(seconds), ..Settings::prototype() }
}

/// Prints as OctoPrint does, and pauses after every `gap_ms` of printing: the line under way is answered, then comes
/// M400. How long each pause takes to come to rest, in s.
fn pauses(settings: &Settings, gcode: &str, gap_ms: u64) -> Vec<f64> {
    let (mut trace, drivers, mut desk) = (Trace::default(), Drivers::new(), Desk::new(1));
    let start = Some([0, 0, 10].map(Mm::from_num));
    let mut world = World::new(&mut desk, settings, start, NoStorage, &drivers, &mut trace);
    let mut lines = gcode.lines().map(strip_comment).filter(|line| !line.is_empty());
    let gap = gap_ms * u64::from(TICKS_PER_MS);
    let (mut due, mut pressed, mut heard, mut took) = (gap, None, String::new(), Vec::new());
    let (mut is_asked, mut is_pausing) = (false, false);
    loop {
        world.poll();
        heard.push_str(&String::from_utf8(world.wires()[0].heard()).unwrap());
        while let Some(end) = heard.find('\n') {
            is_asked &= !heard.starts_with("ok");
            heard.drain(..=end);
        }
        if pressed.is_none() && world.now() >= due {
            pressed = Some(world.now());
        }
        if is_asked {
            world.advance();
            continue;
        }
        if is_pausing {
            took.push((world.now() - pressed.take().unwrap()) as f64 / 1e7);
            due = world.now() + gap;
        }
        is_pausing = pressed.is_some();
        let line = if is_pausing { Some("M400".into()) } else { lines.next() };
        let Some(line) = line else { return took };
        world.wires()[0].put(line.bytes().chain([b'\n']));
        is_asked = true;
    }
}

/// Zigzags of 30 mm, 0.5 mm apart, at 100 mm/s: 0.33 s each with their ramps.
fn zigzags(count: u32) -> String {
    let line = |i: u32| format!("G1 X{} F6000\nG1 Y{:.1}\n", 30 * (i % 2), f64::from(i) * 0.5);
    "M83\n".to_owned() + &(1..=count).map(line).collect::<String>()
}

#[test]
fn a_pause_is_heard_within_the_look_ahead() {
    for (seconds, least, most) in [(0.5, 0.5, 1.3), (2.0, 2.0, 3.0), (5.0, 5.0, 6.5)] {
        let took = pauses(&reaching(seconds), &zigzags(200), 3100);
        println!("{seconds} s: {took:.2?}");
        assert!(took.len() >= 6);
        assert!(took.iter().all(|took| (least..most).contains(took)), "{took:.2?}");
    }
}

/// Moves of 4 s each: one is under way, and as the end of the next is not known without a third, two wait. Another one
/// is in the line. With a look-ahead of moves alone it was ten minutes.
#[test]
fn long_moves_are_few() {
    let gcode: String = (1..=12).map(|i| format!("G1 X{} F4500\n", 300 * (i % 2))).collect();
    let took = pauses(&reaching(2.0), &gcode, 9000);
    println!("{took:.2?}");
    assert!(!took.is_empty() && took.iter().all(|took| *took < 16.5), "{took:.2?}");
}

/// The whole of a print.
fn print(settings: &Settings, gcode: &str) -> (Outcome, u64) {
    let mut trace = Trace::default();
    let outcome = run(settings, None, &mut FileHost::new(gcode), &mut trace).unwrap();
    (outcome, trace.hash())
}

#[test]
fn no_step_is_another_one() {
    // Long moves, long straight ways in short pieces, and some that never come to speed.
    let rows: String = (1..=90).map(|i| format!("G1 X{:.1} F18000\n", f64::from(i) * 4.0)).collect();
    let mixed = format!("G28\n{}M204 P80 T80\n{rows}G1 X0 F600\nG1 Y300 F6000\n{}", zigzags(40), zigzags(20));
    // Straight ways in fine chords, more than the look-ahead has places for.
    let chords: String = (1..=1200).map(|i| format!("G1 X{:.3} Y{}\n", 0.25 * f64::from(i), i / 400)).collect();
    let chords = format!("G28\nM204 P300 T300\nG1 F18000\n{chords}");
    for gcode in [example("first-print.gcode"), example("circle.gcode"), mixed, chords] {
        let (outcome, steps) = print(&reaching(60.0), &gcode);
        for seconds in [0.5, 2.0] {
            let (other, other_steps) = print(&reaching(seconds), &gcode);
            assert_eq!((outcome.ticks, steps, other.underruns), (other.ticks, other_steps, 0), "{seconds} s");
        }
    }
}
