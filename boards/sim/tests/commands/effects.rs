//! Effects of a command on the lines after it.

use super::asker::{Asker, answers, before_homing};
use super::deaf::Deaf;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::run;

#[test]
fn a_dry_run_moves_everything_but_the_filament() {
    let heard = answers(&["M111 S8", "M111", "G1 X110 E5 F6000", "M400", "M114 R", "M114"]);
    assert!(heard.contains(&"echo:DEBUG:DRYRUN".to_owned()), "{heard:?}");
    let told: Vec<_> = heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert_eq!(told[0], "X:110.00 Y:100.00 Z:50.00 E:5.00 C:0.00 Count A:16800 B:800 Z:40000");
    assert_eq!(told[0], told[1]);
}

/// A line that is not carried out leaves everything as it was.
#[test]
fn a_line_that_is_ignored_changes_nothing() {
    for line in
        ["G1 X150 Y1,5 F1200 E3", "G1 X150 F1200 U3", "G1 X150 F1200 Y", "G2 X150 F1200", "G2 X150 I25 F1200 Y,"]
    {
        let heard = answers(&["G1 X110 F6000 E1", line, "G1 F", "M114", "G91", "G1 X1 F0", "M114"]);
        let told: Vec<_> = heard.iter().filter(|line| line.starts_with("X:")).collect();
        assert!(told[0].starts_with("X:110.00 Y:100.00 Z:50.00 E:1.00"), "{line}: {heard:?}");
        assert!(told[1].starts_with("X:111.00"), "{line}: {heard:?}");
        assert!(heard.contains(&"echo:F0 is out of range, stays 6000".to_owned()), "{line}: {heard:?}");
    }
}

#[test]
fn moves_before_homing_are_warned_of_once_or_refused() {
    let told = "echo:motion before homing (G28): the ends of the axes are unknown";
    let settings = Settings::prototype();
    let lines = ["G1 E5 F600", "G1 X5 F6000", "G1 Y5", "G2 X7 I1", "M114"];
    let heard = before_homing(&settings, &lines);
    assert_eq!(heard[0], told);
    assert!(heard[1].starts_with("X:7.00 Y:5.00") && heard.len() == 2, "{heard:?}");
    // Once a print.
    let heard = before_homing(&settings, &["G1 X5", "M110 N0", "G1 X6", "G28 X", "M110 N0", "G1 X7", "G1 Y7"]);
    assert_eq!(heard, [told; 3]);
    let strict = Settings { require_homing: true, ..settings };
    let heard =
        before_homing(&strict, &["G1 E5 F600", "G1 X5 F6000", "G2 X7 I1", "M114", "G28 X", "G1 X5", "G1 Z1", "M114"]);
    let refused = "echo:move ignored: home its axes first (G28)";
    assert_eq!([&heard[0], &heard[1], &heard[3]], [refused; 3]);
    assert!(heard[2].starts_with("X:0.00 Y:0.00 Z:0.00 E:5.00"), "{heard:?}");
    assert!(heard[4].starts_with("X:5.00 Y:0.00 Z:0.00"), "{heard:?}");
}

/// Conditional lines would print something else if they were skipped.
#[test]
fn conditions_stop_the_print_with_a_reason() {
    let names = ["if {1 > 2}", "elif true", "else", "while true", "break", "continue", "abort \"no\""];
    let of_slicers = ["{if layer_num > 2}", "{elsif true}", "{else}", "{endif}"];
    for line in ["M622 J1", "M623"].into_iter().chain(names).chain(of_slicers) {
        let lines = ["G1 X110", line, "G1 X120"].map(str::to_owned).to_vec();
        let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
        let start = Some([100, 100, 50].map(Mm::from_num));
        let outcome = run(&Settings::prototype(), start, &mut host, &mut Deaf).unwrap();
        assert!(outcome.halted, "{line}");
        let [.., reason, halted] = host.heard.as_slice() else { panic!("{:?}", host.heard) };
        assert!(reason.starts_with("Error:this line decides which lines run"), "{line}: {reason}");
        assert!(halted.starts_with("Error:Printer halted. kill() called!"), "{line}: {halted}");
    }
}

#[test]
fn arcs_end_where_they_should_in_every_plane() {
    for (line, end) in [
        ("G17\nG2 X120 I10", "X:120.00 Y:100.00 Z:50.00"),
        ("G18\nG2 X120 I10", "X:120.00 Y:100.00 Z:50.00"),
        ("G18\nG3 Z70 K10", "X:100.00 Y:100.00 Z:70.00"),
        ("G19\nG2 Y120 J10", "X:100.00 Y:120.00 Z:50.00"),
        ("G19\nG3 Z70 K10 X110", "X:110.00 Y:100.00 Z:70.00"),
    ] {
        let mut lines: Vec<&str> = line.split('\n').collect();
        lines.extend(["M114", "G17", "M114"]);
        let heard = answers(&lines);
        assert!(heard.iter().any(|line| line.starts_with(end)), "{line}: {heard:?}");
    }
    assert!(answers(&["G18", "G2 X120 J10"])[1].starts_with("echo:arc ignored: its centre is not in its plane"));
}
