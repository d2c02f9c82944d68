//! G10 and G11: the filament goes back and forth, and the program's coordinates know nothing of it.

use crate::common::deaf::Deaf;
use crate::common::lines::Lines;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Outcome, run};

/// The reports of M114, and the outcome.
fn print(lines: &[&'static str]) -> (Vec<String>, Outcome) {
    let mut host = Lines::new(lines.iter().map(|line| (*line).to_owned()).collect());
    let start = Some([100, 100, 10].map(Mm::from_num));
    let outcome = run(&Settings::prototype(), start, &mut host, &mut Deaf).unwrap();
    (host.heard.into_iter().filter(|line| line.starts_with("X:")).collect(), outcome)
}

#[test]
fn back_and_forth_is_nothing() {
    let (told, outcome) = print(&["G1 X110 E1 F3000", "G10", "M114", "G1 X120", "G11", "G1 X130 E2", "M400", "M114 R"]);
    assert!(told[0].starts_with("X:110.00 Y:100.00 Z:10.00 E:1.00 "), "{told:?}");
    assert!(told[1].starts_with("X:130.00 Y:100.00 Z:10.00 E:2.00 "), "{told:?}");
    assert_eq!(outcome.counts[6], 800, "two millimetres at 400 steps/mm");
}

#[test]
fn a_retracted_machine_stays_away_by_length_and_lift() {
    let (told, outcome) = print(&["M207 S2 Z0.5", "G10", "G10", "G1 X110 Z11 F3000", "M400", "M114", "M114 R"]);
    assert!(told[0].starts_with("X:110.00 Y:100.00 Z:11.00 E:0.00 "), "{told:?}");
    assert!(told[1].starts_with("X:110.00 Y:100.00 Z:11.50 E:-2.00 "), "{told:?}");
    assert_eq!((outcome.counts[4], outcome.counts[6]), (1200, -800));
}

#[test]
fn what_is_pushed_in_addition_stays() {
    let (told, outcome) =
        print(&["M83", "M208 S.25 F600", "G10", "G11", "G11", "G1 E1 F300", "G10", "G11", "M400", "M114"]);
    assert!(told[0].contains(" E:1.00 "), "{told:?}");
    assert_eq!(outcome.counts[6], 400 + 2 * 100);
}

#[test]
fn a_length_that_changes_meanwhile_is_recovered_as_it_was_retracted() {
    let (_, outcome) = print(&["G10", "M207 S8 Z2", "G11", "M400"]);
    assert_eq!((outcome.counts[4], outcome.counts[6]), (0, 0));
}

#[test]
fn stops_homing_and_other_resolutions_leave_the_way_back_right() {
    let (told, outcome) = print(&["M207 Z1", "G10", "G1 X110 F6000", "M400", "M410", "M114", "G11", "M400", "M114 R"]);
    assert_eq!(told[0].split(" E").next(), told[1].split(" E").next());
    assert_eq!((outcome.counts[4], outcome.counts[6]), (0, 0));
    let (told, outcome) = print(&["M207 Z1", "G10", "G28 Z", "M114", "G11", "M400", "M114 R"]);
    assert!(told.iter().all(|told| told.starts_with("X:100.00 Y:100.00 Z:0.00 ")), "{told:?}");
    // Homing begins another print: filament that was pulled back before does not matter to it, and stays where it is.
    assert_eq!(outcome.counts[6], -1200);
    let (told, _) = print(&["M207 Z1", "G10", "M92 Z1600", "G11", "M400", "M114", "M114 R"]);
    assert_eq!(told[0], told[1]);
}
