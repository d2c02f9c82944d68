//! Talking to a machine that heats, in virtual time.

use super::deaf;
use corehbot::connectors::Heater;
use corehbot::port::Storage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Outcome, World};
use deaf::Deaf;

/// A machine with these heaters.
pub fn machine(fitted: &[Heater]) -> Settings {
    let mut settings = Settings::prototype();
    for heater in fitted {
        settings.thermal.heater_mut(*heater).is_fitted = true;
    }
    settings
}

/// Says `lines` one after the other, each after the `ok` of the previous one, and lets the given time pass in all. A
/// line that begins with a number of ms and a colon is said at that time, whether or not an answer came. Returns the
/// replies.
pub fn talk_with(
    settings: &Settings,
    storage: impl Storage,
    ms: u64,
    lines: &[&str],
    mut look: impl FnMut(u64, &mut World<'_>),
) -> (Vec<String>, Outcome) {
    let drivers = Drivers::new();
    let mut desk = Desk::new(1);
    let start = Some([100, 100, 50].map(Mm::from_num));
    let mut sink = Deaf;
    let mut world = World::new(&mut desk, settings, start, storage, &drivers, &mut sink);
    let (mut heard, mut partial, mut next, mut awaiting) = (Vec::<String>::new(), Vec::new(), 0, 0);
    while world.now() < ms * u64::from(TICKS_PER_MS) {
        world.poll();
        partial.extend(world.wires()[0].heard());
        while let Some(end) = partial.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = partial.drain(..=end).collect();
            let line = String::from_utf8(line).unwrap().trim_end().to_owned();
            awaiting -= i32::from(line.starts_with("ok"));
            heard.push(line);
        }
        let now = world.now() / u64::from(TICKS_PER_MS);
        look(now, &mut world);
        if let Some(line) = lines.get(next) {
            let (at, text) = line.split_once(':').map_or((None, *line), |(at, text)| (Some(at), text));
            if at.map_or(awaiting == 0 && now >= 100, |at| now >= at.parse::<u64>().unwrap()) {
                world.wires()[0].put(format!("{text}\n").into_bytes());
                (next, awaiting) = (next + 1, awaiting + 1);
                continue;
            }
        }
        world.advance();
    }
    assert_eq!(next, lines.len(), "{heard:?}");
    heard.retain(|line| line != "echo:busy: processing");
    (heard.split_off(2), world.outcome())
}
