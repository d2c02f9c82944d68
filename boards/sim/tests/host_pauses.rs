//! Hosts that pause: anywhere and for any time. The steps stay what they are, or the pause is counted.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "common/trace.rs"]
mod trace;

use corehbot::port::NoStorage;
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Outcome, World};
use proptest::prelude::*;
use trace::Trace;

/// Sends a line for each `ok`; before line i it takes `pauses[i]` ms.
fn print(settings: &Settings, lines: &[String], pauses: &[u32]) -> (Outcome, u64) {
    let (mut trace, drivers, mut desk) = (Trace::default(), Drivers::new(), Desk::new(1));
    let start = Some([100, 100, 10].map(Mm::from_num));
    let mut world = World::new(&mut desk, settings, start, NoStorage, &drivers, &mut trace);
    let (mut sent, mut answered, mut due, mut heard) = (0, 0, None, String::new());
    while answered < lines.len() {
        world.poll();
        heard.push_str(&String::from_utf8(world.wires()[0].heard()).unwrap());
        while let Some(end) = heard.find('\n') {
            answered += usize::from(heard.starts_with("ok"));
            heard.drain(..=end);
        }
        if sent == answered && sent < lines.len() {
            let pause = u64::from(pauses.get(sent).copied().unwrap_or(0)) * u64::from(TICKS_PER_MS);
            if world.now() >= *due.get_or_insert(world.now() + pause) {
                world.wires()[0].put(lines[sent].bytes().chain([b'\n']));
                (sent, due) = (sent + 1, None);
                continue;
            }
        }
        world.advance();
    }
    let outcome = world.outcome();
    drop(world);
    (outcome, trace.hash())
}

/// Moves of all kinds, and here and there a command that waits for them.
fn program() -> impl Strategy<Value = Vec<String>> {
    let line = prop_oneof![
        12 => (-40i32..40, -40i32..40, 0i32..20, 10u32..250)
            .prop_map(|(x, y, e, v)| format!("G1 X{:.1} Y{:.1} E{:.2} F{}", f64::from(x) * 0.2, f64::from(y) * 0.2, f64::from(e) * 0.01, v * 60)),
        4 => (1i32..60, 10u32..250).prop_map(|(x, v)| format!("G1 X{:.1} F{}", f64::from(x) * 0.3, v * 60)),
        1 => Just("G1 E-0.8 F2400".to_owned()),
        1 => Just("M400".to_owned()),
        1 => Just("M204 S1500".to_owned()),
    ];
    proptest::collection::vec(line, 2..60).prop_map(|lines| {
        let begin = ["M83", "G91", "M211 S0"].map(str::to_owned);
        begin.into_iter().chain(lines).chain(["M400".to_owned()]).collect()
    })
}

/// Pauses before a few lines; most of them near the times that matter.
fn pauses() -> impl Strategy<Value = Vec<u32>> {
    let pause = prop_oneof![60 => Just(0u32), 3 => 1u32..60, 3 => 60u32..140, 2 => 140u32..1100, 1 => 1100u32..20_000];
    proptest::collection::vec(pause, 64)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_pause_changes_no_step_or_is_counted(lines in program(), pauses in pauses(), is_shaped in any::<bool>()) {
        let mut settings = Settings::prototype();
        if is_shaped {
            settings.shapers.x = Shaper { kind: ShaperKind::Mzv, frequency: Hertz::from_num(60), ..settings.shapers.x };
        }
        let (whole, steps) = print(&settings, &lines, &[]);
        prop_assert_eq!(whole.underruns, 0);
        let (paused, steps_of_paused) = print(&settings, &lines, &pauses);
        prop_assert_eq!(whole.counts, paused.counts);
        prop_assert!(paused.underruns > 0 || (whole.ticks, steps) == (paused.ticks, steps_of_paused));
    }
}

/// Wherever the one pause of a short print is, and however long.
#[test]
fn one_pause_near_the_start_changes_no_step_or_is_counted() {
    let settings = Settings::prototype();
    let mut lines = vec!["G91".to_owned()];
    lines.extend((0..24).map(|i| format!("G1 X{} Y{} F9000", 1 + i % 3, i % 2)));
    lines.push("M400".to_owned());
    let (whole, steps) = print(&settings, &lines, &[]);
    assert_eq!(whole.underruns, 0);
    let (mut counted, mut same) = (0, 0);
    for place in [2, 3, 5, 8, 13, 24] {
        for ms in [10, 50, 95, 100, 105, 150, 300, 1000] {
            let mut pauses = [0; 32];
            pauses[place] = ms;
            let (paused, steps_of_paused) = print(&settings, &lines, &pauses);
            let is_same = (whole.ticks, steps) == (paused.ticks, steps_of_paused);
            assert!(is_same || paused.underruns > 0, "{ms} ms before line {place}");
            counted += u32::from(paused.underruns > 0);
            same += u32::from(is_same);
        }
    }
    println!("{counted} of 48 counted, {same} with the same steps");
    assert!(same >= 12, "{same}");
}

/// What ends by itself was no slow host: nothing is counted before something follows.
#[test]
fn the_end_of_a_stream_is_no_underrun() {
    let lines = |words: &[&str]| words.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
    let settings = Settings::prototype();
    // M114 waits for nothing, M400 for the motion; neither of them is a move that came too late.
    let (outcome, _) =
        print(&settings, &lines(&["G1 X120 F6000", "M114", "M400", "G1 X140", "M400"]), &[0, 800, 3000, 3000, 800]);
    assert_eq!(outcome.underruns, 0);
    let (outcome, _) = print(&settings, &lines(&["G1 X120 F6000", "G1 X140", "M400"]), &[0, 3000, 0]);
    assert_eq!(outcome.underruns, 1, "the tool has stopped at X120 where nobody wanted it to");
}

/// Jogs a few seconds apart are as fast as commanded: nobody is slow who has paused for so long.
#[test]
fn jogs_are_not_slowed_down() {
    let settings = Settings::prototype();
    let jogs: Vec<String> = (1..=6).map(|i| format!("G1 X{} F6000", 100 + 5 * i)).chain(["M400".to_owned()]).collect();
    let ticks = |ms| print(&settings, &jogs, &[0, ms, ms, ms, ms, ms, 0]).0.ticks;
    // 5 mm from rest to rest with the minimum cruise ratio, and nothing more.
    let one = print(&settings, &[jogs[0].clone(), "M400".to_owned()], &[]).0.ticks;
    assert_eq!(ticks(2000), 6 * one);
}
