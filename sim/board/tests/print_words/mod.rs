//! Prints in Klipper's words: what is built in, and the owner's texts.

mod built_in;
mod pauses;
mod places;
mod texts;

use crate::common::heated::heated;
use crate::common::life::{Life, live, live_with};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::Desk;

const MINUTE: u64 = 60_000;

/// A machine with these texts, homed at X100 Y100 Z50.
fn live_with_texts(settings: &Settings, texts: &str, hosts: usize, body: impl FnOnce(&mut Life<'_>)) {
    let mut desk = Desk::new(hosts);
    // A board has them in its image, for good.
    desk.board.texts = Box::leak(texts.as_bytes().to_vec().into_boxed_slice());
    live_with(settings, Some([100, 100, 50].map(Mm::from_num)), (&mut desk, hosts), NoStorage, body);
}

/// No word was out of place.
fn is_sound(life: &Life<'_>) {
    for begin in ["Error", "!!", "//action:cancel", "//action:pause", "echo:Unknown", "echo:ignored", "echo:line"] {
        assert_eq!(life.count(begin), 0, "{begin}: {:#?}", life.heard);
    }
}

/// The numbers X, Y, Z of a place that is reported.
fn place(life: &mut Life<'_>, ask: &str) -> [f64; 3] {
    let told = life.ask(ask, "X:");
    let number = |letter: &str| {
        let (_, rest) = told.split_once(letter).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    [number("X:"), number("Y:"), number("Z:")]
}
