//! Hosts that pause anywhere and for any time. The steps stay the same, or the pause is counted.

use crate::common::trace::Trace;
use corehbot::port::NoStorage;
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Outcome, World};
use proptest::prelude::*;

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

/// Straight ways in fine chords, and lines between them: corners, other settings, a fan, an offset, filament.
fn chords() -> impl Strategy<Value = Vec<String>> {
    let way = prop_oneof![
        6 => (1i32..12, -9i32..9, 2usize..40, 40u32..300).prop_map(|(x, y, count, v)| {
            vec![format!("G1 X{:.3} Y{:.3} F{}", f64::from(x) * 0.01, f64::from(y) * 0.01, v * 60); count]
        }),
        1 => (1i32..40, 40u32..300).prop_map(|(x, v)| vec![format!("G1 Y{} F{}", x - 20, v * 60)]),
        1 => (500u32..5000).prop_map(|a| vec![format!("M204 S{a}")]),
        1 => Just(vec!["M106 S100".to_owned()]),
        1 => Just(vec!["G92 X10".to_owned()]),
        1 => Just(vec!["M114".to_owned()]),
        1 => Just(vec!["M400".to_owned()]),
    ];
    proptest::collection::vec(way, 2..14).prop_map(|ways| {
        let begin = ["M83", "G91", "M211 S0"].map(str::to_owned);
        begin.into_iter().chain(ways.into_iter().flatten()).chain(["M400".to_owned()]).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_pause_in_a_straight_line_changes_no_step_or_is_counted(
        lines in chords(),
        few in proptest::collection::vec((0usize..200, 1u32..1200), 0..5),
    ) {
        let settings = Settings::prototype();
        let (whole, steps) = print(&settings, &lines, &[]);
        prop_assert_eq!(whole.underruns, 0);
        let mut pauses = vec![0; 200];
        few.iter().for_each(|(place, ms)| pauses[*place] = *ms);
        let (paused, steps_of_paused) = print(&settings, &lines, &pauses);
        prop_assert_eq!(whole.counts, paused.counts);
        prop_assert!(paused.underruns > 0 || (whole.ticks, steps) == (paused.ticks, steps_of_paused));
    }
}

/// A pause in the middle of a line stops the tool there, which is counted once. At its end it changes nothing.
#[test]
fn a_line_that_is_held_up_is_an_underrun() {
    let settings = Settings::prototype();
    let mut lines = vec!["G91".to_owned()];
    lines.extend(vec!["G1 X0.05 F12000".to_owned(); 20]);
    lines.extend(["G1 Y5".to_owned(), "M400".to_owned()]);
    let (whole, steps) = print(&settings, &lines, &[]);
    // At 200 mm/s and 5 m/s2 a line of 0.25 mm is long enough.
    assert_eq!((whole.underruns, whole.moves), (0, 5));
    let paused = |before: usize| {
        let mut pauses = vec![0; lines.len()];
        pauses[before] = 600;
        print(&settings, &lines, &pauses)
    };
    let (held, _) = paused(13);
    assert_eq!((held.underruns, held.counts), (1, whole.counts));
    // Nothing of the line follows, but a corner that the tool would have passed without a stop.
    assert_eq!(paused(21).0.underruns, 1);
    let (at_end, steps_at_end) = paused(22);
    assert_eq!((at_end.underruns, at_end.ticks, steps_at_end), (0, whole.ticks, steps));
}

/// A command between two chords acts there: the result equals the one with one line before it and one after it.
#[test]
fn a_command_between_two_chords_ends_the_line() {
    let mut settings = Settings::prototype();
    // Which is a matter of how long a move is.
    settings.minimum_cruise_ratio = corehbot::units::Ratio::ZERO;
    let far = "G1 X30 F18000";
    for (between, is_end) in [
        ("M204 S700", true),
        ("M205 J0.02", true),
        ("M203 X90", true),
        ("M106 S100", true),
        ("M220 S60", false),
        ("M221 S90", false),
        ("M114", false),
        ("M105", false),
        ("G92 Y7", false),
    ] {
        let text = |half: &[String]| {
            let lines = ["G91", far].map(str::to_owned).into_iter().chain(half.iter().cloned());
            let lines = lines.chain([between.to_owned()]).chain(half.iter().cloned());
            lines.chain([far.to_owned(), "M400".to_owned()]).collect::<Vec<_>>()
        };
        let (chords, steps) = print(&settings, &text(&vec!["G1 X0.04 F18000".to_owned(); 6]), &[]);
        let (one, steps_of_one) = print(&settings, &text(&["G1 X0.24 F18000".to_owned()]), &[]);
        assert_eq!((chords.ticks, steps), (one.ticks, steps_of_one), "{between}");
        assert_eq!(chords.moves, if is_end { 4 } else { 3 }, "{between}");
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

/// A stream that ends did not have a slow host: nothing is counted before more lines follow.
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

/// Jogs a few seconds apart are as fast as commanded: a host that paused for so long is not slow.
#[test]
fn jogs_are_not_slowed_down() {
    let settings = Settings::prototype();
    let jogs: Vec<String> = (1..=6).map(|i| format!("G1 X{} F6000", 100 + 5 * i)).chain(["M400".to_owned()]).collect();
    let ticks = |ms| print(&settings, &jogs, &[0, ms, ms, ms, ms, ms, 0]).0.ticks;
    // 5 mm from rest to rest with the minimum cruise ratio, and nothing more.
    let one = print(&settings, &[jogs[0].clone(), "M400".to_owned()], &[]).0.ticks;
    assert_eq!(ticks(2000), 6 * one);
}
