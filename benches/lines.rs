//! How many lines a second the way from bytes to planned moves takes on this computer: `cargo bench --bench lines`.
//!
//! Wall times differ from computer to computer; `cargo xtask bench` counts the cost of a line on the board.
#![allow(clippy::panic, missing_docs, reason = "a measurement that fails has nothing to say")]

use corehbot::gcode::{Command, MoveCommand, Number};
use corehbot::machine::parse;
use corehbot::motion::{MoveMemory, Planner, Target};
use corehbot::port::{EndstopSet, Received};
use corehbot::protocol::{Incoming, Receiver};
use corehbot::settings::Settings;
use corehbot::units::{Feed, Instant, Mm};
use divan::Bencher;
use divan::counter::ItemsCount;

/// Lines that are sent.
const LINES: u32 = 1000;

/// A circle in chords of half a millimetre, as a host sends it.
fn lines() -> Vec<String> {
    let line = |i: u32| {
        let angle = f64::from(i) * 0.02;
        let (x, y) = (100.0 + 25.0 * angle.cos(), 100.0 + 25.0 * angle.sin());
        let text = format!("N{i} G1 X{x:.3} Y{y:.3} E{:.5}", 0.01745 * f64::from(i));
        let checksum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("{text}*{checksum}\n")
    };
    (1..=LINES).map(line).collect()
}

/// Has `take` take every command that arrives.
fn receive(lines: &[String], mut take: impl FnMut(&[u8])) {
    let mut receiver = Receiver::new();
    for byte in b"N0 M110 N0*125\n" {
        receiver.feed(Received::Byte(*byte));
    }
    while receiver.next_line(Instant(0)).is_some() {}
    for line in lines {
        for byte in line.bytes() {
            receiver.feed(Received::Byte(byte));
        }
        match receiver.next_line(Instant(0)) {
            Some(Incoming::Command(text)) => take(text),
            other => panic!("{line} arrives as {other:?}"),
        }
    }
}

fn mm(number: Option<Number>) -> Mm {
    number.map_or(Mm::ZERO, |number| Mm::from_num(number.value()))
}

/// From bytes to lines that are verified.
#[divan::bench]
fn received(bencher: Bencher) {
    let lines = lines();
    bencher.counter(ItemsCount::new(LINES)).bench(|| {
        receive(&lines, |text| {
            divan::black_box(text);
        });
    });
}

/// From bytes to commands.
#[divan::bench]
fn parsed(bencher: Bencher) {
    let lines = lines();
    bencher.counter(ItemsCount::new(LINES)).bench(|| {
        receive(&lines, |text| {
            divan::black_box(parse(text));
        });
    });
}

/// From bytes to moves that leave the look-ahead.
#[divan::bench]
fn planned(bencher: Bencher) {
    let (lines, settings) = (lines(), Settings::prototype());
    bencher.counter(ItemsCount::new(LINES)).bench(|| {
        let mut memory = MoveMemory::new();
        let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
        receive(&lines, |text| {
            let Command::Move(MoveCommand::Line { to, .. }) = parse(text) else { panic!("a line is no move") };
            let position = [mm(to.x), mm(to.y), mm(to.z), mm(to.e)];
            let speed = Feed::const_from_int(100);
            if !planner.has_room() && !planner.has_ready() {
                planner.release_next();
            }
            while let Some(released) = planner.pop() {
                divan::black_box(released);
            }
            planner.push(&Target { position, speed, has_overrides: true, watch: EndstopSet::NONE }, &settings);
        });
    });
}

fn main() {
    divan::main();
}
