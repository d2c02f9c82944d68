//! G34: the screws of z are levelled by the probe; and its names in Klipper.

use super::screws::{LevelWords, level_screws};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Mark, Nature, Number, flaw_of_pairs};

pub(in crate::machine) const ENTRY: Entry = Entry::g("Motors and drivers", &[34])
    .nature(Nature::Work)
    .mark(Mark::NeedsProbe)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"ITA"))
    .does("I T A E", "levels the screws of z: rounds, accuracy in mm, share of a correction; E keeps the probe out")
    .examples(&[("G34", &["echo:no probe configured, ignored"])]);

pub(in crate::machine) const BY_NAME: Entry =
    Entry::name("Motors and drivers", &["Z_TILT_ADJUST", "QUAD_GANTRY_LEVEL"])
        .nature(Nature::Work)
        .mark(Mark::NeedsProbe)
        .mark(Mark::FindsBed)
        .judge(|_, text| by_name(text).err().into())
        .does("RETRIES= RETRY_TOLERANCE=", "G34 in Klipper's words")
        .examples(&[
            ("Z_TILT_ADJUST RETRIES=3", &["echo:no probe configured, ignored"]),
            ("QUAD_GANTRY_LEVEL", &["echo:no probe configured, ignored"]),
        ]);

/// Klipper's words: RETRIES come after the first round. Its other words are for its own probes.
#[inline(never)]
fn by_name(text: &[u8]) -> Result<LevelWords, Flaw<'_>> {
    const NAMES: [&str; 2] = ["RETRIES", "RETRY_TOLERANCE"];
    let mut level = LevelWords::default();
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        if pair.place >= NAMES.len() {
            return None;
        }
        let Some((number, _)) = Number::read(pair.value) else { return Some(pair.flaw()) };
        if pair.place == 0 {
            level.rounds = Some(Number::from(number.to_int().saturating_add(1)));
        } else {
            level.within = Some(number);
        }
        None
    });
    flaw.map_or(Ok(level), Err)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let words = if command.code() == 34 {
        let [rounds, within, share] = command.numbers(b"ITA");
        LevelWords { rounds, within, share, keeps_out: command.has(b'E') }
    } else {
        by_name(command.text()).unwrap_or_default()
    };
    level_screws(main_loop, clamps, &words).await
}
