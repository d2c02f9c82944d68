//! Effects of a command on the lines after it.

use super::asker::{answers, before_homing};
use corehbot::settings::Settings;

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

/// Conditional lines would print something else if they were skipped. The job ends, and the machine prints the next.
#[test]
fn conditions_end_the_job_with_a_reason_and_nothing_after_them_acts() {
    let names = ["if {1 > 2}", "elif true", "else", "while true", "break", "continue", "abort \"no\""];
    let of_slicers = ["{if layer_num > 2}", "{elsif true}", "{else}", "{endif}", "[if x]", "[ENDIF]"];
    let of_klipper = ["{% if printer.x %}", "{%- elif y -%}", "{% for i in range(3) %}", "{%endfor%}"];
    // The rest of the job: it would begin a print, move, home, heat, blow, and change settings.
    let rest = "START_PRINT BED=60\nG28\nM75\nM104 S200\nM106 S255\nG1 X120 E5\nG92 X0\nM220 S50\nM92 E500\nM500\n";
    let asks = "M114\nM503 S0\nM105";
    for line in ["M622 J1", "M623"].into_iter().chain(names).chain(of_slicers).chain(of_klipper) {
        for (next, x) in [("M110 N0", "X:130.00"), ("M108", "X:130.00"), ("", "X:110.00")] {
            let text = format!("G1 X110\n{line}\n{rest}{line}\n{asks}\n{next}\nG1 X130\nM114\nM110 N0\nM220");
            let lines: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
            let heard = answers(&lines);
            let count = |begin: &str| heard.iter().filter(|told| told.starts_with(begin)).count();
            let ended =
                "echo:print ended, heaters are off: a line decides which lines run, and this firmware cannot skip";
            assert_eq!((count(ended), count("//action:cancel action:cancel")), (1, 1), "{line}: {heard:?}");
            assert_eq!(count("ok"), lines.len(), "{line}: {heard:?}");
            assert_eq!(count("echo:the print was ended: its lines are ignored until M108 or M110"), 1, "{line}");
            assert_eq!([count("Error"), count("echo:Unknown")], [0; 2], "{line}: {heard:?}");
            assert_eq!([count("  M92 X80 Y80 Z800 E400"), count("FR:100%")], [1; 2], "{line}: {heard:?}");
            let [before, after] = [0, 1].map(|n| heard.iter().filter(|told| told.starts_with("X:")).nth(n).unwrap());
            assert!(before.starts_with("X:110.00 Y:100.00 Z:50.00 E:0.00"), "{line}: {before}");
            assert!(after.starts_with(x), "{line}, {next}: {after}");
        }
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
