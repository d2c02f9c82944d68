//! Values out of range: the old value stays, and with it every other value of the line. The report of all settings
//! (M503) is the same before and after, and the host is told. The table in `src/machine/state/clamps.rs` lists the
//! values that are clamped instead.

use super::legal_settings::{heated, setters};
use super::talk::{HOMED, Steps, Talk};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::run_on;

/// Letters with a switch, a choice, an axis or a driver as number, or with clamping; they have rows of their own below.
const NO_RANGE: [(&str, &str); 9] = [
    ("M113", "S"),
    ("M211", "S"),
    ("M302", "P"),
    ("M306", "E"),
    ("M569", "SXZE"),
    ("M593", "XYT"),
    ("M710", "SRAI"),
    ("M906", "I"),
    ("M914", "I"),
];

/// Settings that are not stored.
const NOT_STORED: [(&str, &str); 2] = [("M207", "SFZ"), ("M208", "SF")];

/// Settings without a range, for which 0 is legal.
const NO_ZERO: [(&str, &str); 6] =
    [("M92", "XYZE"), ("M201", "XYZE"), ("M203", "XYZE"), ("M204", "PRTS"), ("M205", "JXYE"), ("M906", "XZE")];

/// A legal value of another word of the command, which must not be set either.
const LEGAL: [(&str, &str); 11] = [
    ("M92", "Z444"),
    ("M201", "Z111"),
    ("M203", "Z11"),
    ("M204", "R777"),
    ("M205", "S2"),
    ("M207", "Z.7"),
    ("M208", "S.7"),
    ("M301", "P22"),
    ("M306", "C22"),
    ("M710", "D33"),
    ("M906", "Z555"),
];

/// The replies of a machine with heaters and drivers.
fn heard(settings: &Settings, lines: &[String]) -> Vec<String> {
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (mut host, drivers) = (Talk::new(&lines), Drivers::new());
    let start = HOMED.map(|at| at.map(Mm::from_num));
    run_on(settings, start, NoStorage, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
    host.heard
}

/// The settings after these lines, and the other replies.
fn after(lines: &[String]) -> (Vec<String>, Vec<String>) {
    let mut all = lines.to_vec();
    all.push("M503".to_owned());
    let heard = heard(&heated(), &all);
    let is_setting = |line: &&String| line.starts_with("echo:  ");
    let settings = heard.iter().filter(is_setting).cloned().collect();
    (settings, heard.into_iter().filter(|line| line.contains("out of range")).collect())
}

/// Every word that has a range, with its command.
fn words() -> impl Iterator<Item = (&'static str, char)> {
    let has_range =
        |code: &str, letter: char| !NO_RANGE.iter().any(|(its, letters)| *its == code && letters.contains(letter));
    let not_stored = NOT_STORED.into_iter().map(|(code, letters)| (code, letters.to_owned()));
    let all = setters().into_iter().chain(not_stored).flat_map(|(code, letters)| {
        let letters: Vec<_> = letters.chars().collect();
        letters.into_iter().map(move |letter| (code, letter))
    });
    all.filter(move |(code, letter)| has_range(code, *letter))
}

fn zeros() -> impl Iterator<Item = (&'static str, char)> {
    NO_ZERO.into_iter().flat_map(|(code, letters)| letters.chars().map(move |letter| (code, letter)))
}

#[test]
fn a_value_out_of_range_leaves_all_settings_as_they_were() {
    let (before, _) = after(&[]);
    let too_much = words().map(|(code, letter)| format!("{code} {letter}99999999999"));
    // M206 and M851 may be negative.
    let below = words()
        .filter(|word| *word != ("M593", 'F') && !["M206", "M851"].contains(&word.0))
        .map(|(code, letter)| format!("{code} {letter}-1"));
    let zero = zeros().map(|(code, letter)| format!("{code} {letter}0"));
    let named = ["ACCEL=0", "ACCEL_TO_DECEL=0", "MINIMUM_CRUISE_RATIO=2", "SQUARE_CORNER_VELOCITY=0"]
        .map(|word| format!("SET_VELOCITY_LIMIT {word}"));
    let advance = ["M900 K30", "M572 S30", "SET_PRESSURE_ADVANCE ADVANCE=30", "SET_PRESSURE_ADVANCE SMOOTH_TIME=9"];
    let lines: Vec<_> = too_much.chain(below).chain(zero).chain(named).chain(advance.map(str::to_owned)).collect();
    let (settings, told) = after(&lines);
    assert_eq!(settings, before);
    // S of M204 sets P and T, and each is reported.
    let twice = lines.iter().filter(|line| line.starts_with("M204 S")).count();
    assert_eq!(told.len(), lines.len() + twice, "{told:#?}");
    assert!(told.iter().all(|line| line.contains(" ignored: ")), "{told:#?}");
}

#[test]
fn with_one_value_out_of_range_no_value_of_the_line_is_set() {
    let (before, _) = after(&[]);
    for (code, legal) in LEGAL {
        assert_ne!(
            after(&[format!("{code} {legal}")]).0,
            before,
            "{code} {legal} is another value than the present one"
        );
        let of_code = words().filter(|(its, letter)| *its == code && !legal.starts_with(*letter));
        let lines: Vec<_> = of_code.map(|(_, letter)| format!("{code} {legal} {letter}99999999999")).collect();
        assert!(!lines.is_empty() || code == "M710");
        assert_eq!(after(&lines).0, before, "{lines:?}");
    }
    // One that has an edge goes with the line.
    let (settings, told) = after(&["M710 S999 D9999".to_owned()]);
    assert_eq!((settings, told.len()), (before, 1));
}

/// A clamped value is set to the end of its range, and reported.
#[test]
fn where_the_edge_is_meant_it_is_set() {
    for (line, report, expected) in [
        ("M113 S99", "M113", "echo:M113 S60"),
        ("M113 S-1", "M113", "echo:M113 S0"),
        ("M220 S5", "M220", "FR:10%"),
        ("M220 S5000", "M220", "FR:999%"),
        ("M710 S999", "M710", "  M710 S255 D60"),
    ] {
        let heard = heard(&heated(), &[line, report].map(str::to_owned));
        assert!(heard.iter().any(|said| said == expected), "{line}: {heard:?}");
        assert!(heard.iter().any(|said| said.contains("is out of range, set to ")), "{line}: {heard:?}");
    }
    for line in ["M221 S5000", "M221 S0", "M221 S-20"] {
        let heard = heard(&heated(), &[line, "M221"].map(str::to_owned));
        assert!(heard.contains(&"echo:E0 Flow: 100%".to_owned()), "{line}: {heard:?}");
    }
}

/// Reproducer: K of Linear Advance 1.0 in profiles derived from Prusa's became 4 s, and the extruder's way 6.8 times as
/// long.
#[test]
fn k_of_linear_advance_1_0_moves_not_one_step_more() {
    let run = |line: &str| {
        let mut steps = Steps::default();
        let print = ["M302 P1", line, "G1 F6000", "G1 X20 E1", "G1 X40 E2", "G1 X60 Y20 E3", "M400"];
        let mut host = Talk::new(&print);
        let start = HOMED.map(|at| at.map(Mm::from_num));
        let drivers = Drivers::new();
        let outcome = run_on(&heated(), start, NoStorage, &drivers, &mut [&mut host], &mut steps).unwrap();
        (outcome.counts, steps.count, host.heard)
    };
    let (counts, events, _) = run("M117");
    let (with_k, events_with_k, heard) = run("M900 K30");
    assert_eq!((with_k, events_with_k), (counts, events));
    assert!(heard.iter().any(|line| line.contains("K is in seconds (Linear Advance 1.5)")), "{heard:?}");
}
