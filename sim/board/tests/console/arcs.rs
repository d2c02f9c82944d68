//! Arcs with rounded ends: they are made, with the intended length. `machine::travel::arcs::slicers` has thousands.

use super::talk::talk_to;
use corehbot::settings::Settings;

/// Step events of these lines, and the messages about arcs.
fn steps_of(lines: &[&str]) -> (u64, Vec<String>) {
    let all: Vec<&str> = [&["G1 F6000"], lines, &["M400", "M114"]].concat();
    let (heard, _, steps) = talk_to(&Settings::prototype(), Some([100.0, 100.0, 10.0]), &all);
    (steps.count, heard.into_iter().filter(|line| line.contains("arc")).collect())
}

/// Whether these lines have as many steps as those, within a few.
fn alike(lines: &[&str], meant: &[&str]) {
    let ((steps, told), (expected, _)) = (steps_of(lines), steps_of(meant));
    assert!(told.is_empty(), "{lines:?}: {told:?}");
    assert!(steps.abs_diff(expected) <= 30 && expected > 500, "{lines:?}: {steps} of {expected}");
}

#[test]
fn a_radius_of_half_the_chord_but_for_rounding_is_a_half_circle() {
    alike(&["G2 X114.143 Y100 R7.071"], &["G2 X114.143 Y100 I7.0715 J0"]);
    alike(&["G3 X114.14 Y100 R7.06"], &["G3 X114.14 Y100 I7.07 J0"]);
    alike(&["G20", "G3 X4.5 Y3.9371 R.2815"], &["G3 X114.3 Y100.00234 I7.15 J0.00117"]);
    let (_, told) = steps_of(&["G2 X114.143 Y100 R7.05"]);
    assert_eq!(told, ["echo:arc ignored: no circle of that R passes through both ends"]);
}

#[test]
fn a_full_circle_behind_relative_moves_is_one() {
    let meant = ["G1 X100.2", "G2 X100.2 Y100 I0 J5"];
    alike(&["G91", "G1 X0.1", "G1 X0.1", "G90", "G2 X100.2 Y100 I0 J5"], &meant);
    alike(&["G91", "G1 X0.1", "G1 X0.1", "G2 X0 Y0 I0 J5", "G90"], &meant);
    alike(&["G92 X0.3", "G91", "G1 X0.1", "G1 X0.1", "G90", "G2 X.5 Y100 I0 J5"], &meant);
    alike(
        &["G20", "G91", "G1 X.1", "G1 X.1", "G90", "G2 X4.137 Y3.937 I0 J.2"],
        &["G1 X105.08", "G2 X105.08 Y100 I0 J5.08"],
    );
    // A short arc is not a full circle.
    alike(&["G1 X105", "G3 X105.1 Y100 I0 J5", "G1 X120"], &["G1 X120"]);
}

/// Rounding of relative moves does not count as motion of an axis that was not homed, as a place beyond the edge, or as
/// filament.
#[test]
fn what_rounding_leaves_is_told_of_nothing() {
    let relative = |word: &str, times: usize| {
        [vec!["G91".to_owned()], vec![format!("G1 {word}"); times], vec!["G90".to_owned()]].concat()
    };
    let mut lines = vec!["G1 F12000 X0 Y0".to_owned()];
    lines.extend(relative("X0.3", 1300));
    lines.extend(["G1 X390".to_owned(), "M400".to_owned()]);
    let all: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (heard, ..) = talk_to(&Settings::prototype(), Some([0.0, 0.0, 10.0]), &all);
    assert!(!heard.iter().any(|line| line.contains("edge")), "{:?}", heard.iter().find(|line| line.contains("edge")));
}
