//! Whatever lines set is legal: M500 stores it, and the next start reads it back. A command with a wider range than
//! `settings::ranges` would let a user lose all settings.

use super::talk::keep;
use crate::common::setting_lines::LINES;
use corehbot::settings::Settings;
use corehbot::settings::plain::CODES;
use corehbot_machine_file as machine_file;
use corehbot_sim::eeprom::Eeprom;
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Codes that set settings with rules of their own, each with its letters. Those of [`LINES`] and of
/// plain settings are added to them.
const SETTERS: [(&str, &str); 13] = [
    ("M205", "JEST"),
    ("M205", "XYE"),
    ("M211", "S"),
    ("M302", "SP"),
    ("M306", "EPCAFRLH"),
    ("M569", "SXZE"),
    ("M572", "SW"),
    ("M593", "XYFDT"),
    ("M710", "RSDAI"),
    ("M900", "K"),
    ("M906", "XYZEI"),
    ("M913", "XYZE"),
    ("M914", "XYZEI"),
];

/// Codes that set settings, each with all of its letters.
pub fn setters() -> Vec<(&'static str, String)> {
    let mut all: Vec<_> = SETTERS.iter().map(|(code, letters)| (*code, (*letters).to_owned())).collect();
    for number in CODES {
        let (mut code, mut letters) = ("", BTreeSet::new());
        Settings::prototype().visit_code(*number, &mut |word, _| {
            code = word.line.code;
            letters.extend(word.letters.split('/'));
        });
        all.push((code, letters.into_iter().collect()));
    }
    for (code, words) in
        LINES.iter().filter(|(_, line)| line.starts_with('M')).filter_map(|(_, line)| line.split_once(' '))
    {
        for letter in words.split(' ').filter_map(|word| word.chars().next()).filter(char::is_ascii_uppercase) {
            if !all.iter().any(|(its, letters)| *its == code && letters.contains(letter)) {
                all.push((code, letter.to_string()));
            }
        }
    }
    all
}

/// Numbers at the edges of types and ranges.
const NUMBERS: [&str; 14] =
    ["0", "1", "-1", "0.0000001", "0.001", "0.05", "0.3", "2", "10", "80", "255", "3000", "65536", "99999999999"];

/// The prototype with hotend, bed and chamber.
pub fn heated() -> Settings {
    let heater = |name: &str| format!("[heaters.{name}]\nis_fitted = true\n");
    machine_file::load(&["hotend", "bed", "chamber"].map(heater).concat()).unwrap()
}

/// The messages of M500 and of the next start after these lines.
fn stored_and_read(lines: &[String]) -> [Option<String>; 2] {
    stored_and_read_on(heated(), lines)
}

fn stored_and_read_on(made: Settings, lines: &[String]) -> [Option<String>; 2] {
    let mut eeprom = Eeprom::blank();
    let mut lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    lines.push("M500");
    let (stored, ..) = keep(&mut eeprom, &made, &lines);
    let (read, ..) = keep(&mut eeprom, &made, &["M503"]);
    let is_news = |line: &String| line.contains("ettings ") && !line.contains("Default");
    [stored, read].map(|heard| heard.into_iter().find(is_news))
}

fn line() -> impl Strategy<Value = String> {
    let words = prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(&NUMBERS[..])), 0..5);
    let named = prop::sample::select(&NUMBERS[..])
        .prop_map(|number| format!("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO={number} SQUARE_CORNER_VELOCITY={number}"));
    let coded = (prop::sample::select(setters()), words).prop_map(|((code, letters), words)| {
        let letters: Vec<char> = letters.chars().collect();
        let words = words.iter().map(|(letter, number)| format!(" {}{number}", letter.get(&letters)));
        words.fold(code.to_owned(), |line, word| line + &word)
    });
    prop_oneof![9 => coded, 1 => named]
}

/// The letter of an axis stands for all of them.
#[test]
fn every_line_that_sets_a_setting_is_here() {
    for line in LINES.map(|(_, line)| line.replace("{}", "X")).into_iter().filter(|line| line.starts_with('M')) {
        let (code, words) = line.split_once(' ').unwrap();
        let letters = words.split(' ').filter_map(|word| word.chars().next());
        for letter in letters {
            let is_here = setters().iter().any(|(its, letters)| *its == code && letters.contains(letter));
            assert!(is_here, "setters: {code} {letter}");
        }
    }
}

/// The motor that makes the most steps has the range of an axis.
#[test]
fn resolutions_have_room_for_pulleys_of_different_sizes() {
    let file = include_str!("../../../../examples/machines/core-unequal.toml");
    for line in ["M92 X25600 Y25600", "M92 X1 Y1", "M203 X3000 Y3000"] {
        let [stored, read] = stored_and_read_on(machine_file::load(file).unwrap(), &[line.to_owned()]);
        assert!(stored.as_ref().is_some_and(|said| said.starts_with("echo:Settings Stored")), "{line}: {stored:?}");
        assert!(read.as_ref().is_some_and(|said| said.contains("stored settings retrieved")), "{line}: {read:?}");
    }
}

#[test]
fn every_word_at_every_edge_alone_can_be_stored_and_read() {
    // All words of a code in one session: a later word must not hide an illegal value.
    for number in NUMBERS {
        for (code, letters) in setters() {
            let lines: Vec<_> = letters.chars().map(|letter| format!("{code} {letter}{number}")).collect();
            let [stored, read] = stored_and_read(&lines);
            assert!(
                stored.as_ref().is_some_and(|said| said.starts_with("echo:Settings Stored")),
                "{lines:?}: {stored:?}"
            );
            assert!(
                read.as_ref().is_some_and(|said| said.contains("stored settings retrieved")),
                "{lines:?}: {read:?}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn whatever_lines_set_can_be_stored_and_read(lines in prop::collection::vec(line(), 1..12)) {
        let [stored, read] = stored_and_read(&lines);
        prop_assert!(stored.as_ref().is_some_and(|said| said.starts_with("echo:Settings Stored")), "{stored:?}");
        prop_assert!(read.as_ref().is_some_and(|said| said.contains("stored settings retrieved")), "{read:?}");
    }
}
