//! Forms of reports: decoration, order, damage, and any text.

use super::{LOGS, of_text, text, translated, verdict};
use crate::configurations;
use corehbot::settings::{AxisEnd, CornerRule, HomedAxis, Settings, ShaperKind};
use corehbot_machine_file::Kind;
use corehbot_machine_file::file_kind::text_of;
use corehbot_machine_file::marlin::{Firmware, Given, is_report, translate};
use proptest::prelude::*;

/// The settings of a log's machine file.
fn settings(name: &str) -> Settings {
    let done = translated(name);
    done.machine.unwrap_or_else(|| panic!("{name}: {:?}\n{}", done.problems, done.text)).settings
}

#[test]
fn every_generation_becomes_a_machine() {
    let steps = |s: &Settings| [s.axes.x, s.axes.y, s.axes.z, s.axes.e].map(|axis| axis.steps_per_mm.to_num::<f64>());
    let mega = settings("mega");
    assert_eq!(steps(&mega)[..3], [80.0, 80.0, 400.0]);
    assert!((steps(&mega)[3] - 96.2).abs() < 1e-3);
    assert_eq!(mega.mechanism.rows[..5], [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]);
    assert_eq!([mega.reach(HomedAxis::Y).least, mega.axes.y.length].map(|mm| mm.to_num::<f64>()), [-6.0, 226.0]);
    assert_eq!([mega.bed.front, mega.bed.depth].map(|mm| mm.to_num::<f64>()), [0.0, 220.0]);
    assert_eq!(mega.endstops.y.position.to_num::<f64>(), -6.0);
    assert!(matches!(mega.corner, CornerRule::SquareCorner(speed) if speed.to_num::<f64>() == 7.0));
    assert_eq!((mega.drivers.belt.current_ma, mega.drivers.z.current_ma, mega.drivers.e.current_ma), (760, 700, 650));
    let core = settings("core");
    assert_eq!(core.mechanism.rows[..2], [[1, 1, 0, 0], [1, -1, 0, 0]]);
    assert_eq!(steps(&core), [160.0, 160.0, 800.0, 415.0]);
    assert!(core.drivers.belt.stealth && core.drivers.z.stealth && core.drivers.e.stealth);
    assert_eq!((core.drivers.belt.microsteps, core.drivers.z.microsteps, core.drivers.e.microsteps), (32, 32, 16));
    assert_eq!(core.axes.z.length.to_num::<f64>(), 320.0);
    let shaped = settings("shaped");
    assert_eq!((shaped.shapers.x.kind, shaped.shapers.y.frequency.to_num::<f64>()), (ShaperKind::Zv, 41.0));
    assert_eq!((shaped.endstops.x.end, shaped.endstops.z.end), (AxisEnd::Max, AxisEnd::Min));
    assert_eq!(shaped.thermal.heaters.hotend.power.to_num::<f64>(), 60.0);
    assert!((shaped.thermal.heaters.hotend.model.fan_loss.to_num::<f64>() - 0.025).abs() < 1e-4);
    assert!(!shaped.thermal.heaters.hotend.is_fitted, "nobody said its output");
    // 3.15 of an inch, to two decimals.
    let inches = settings("inches");
    assert!((steps(&inches)[0] - 80.0).abs() < 0.13, "{:?}", steps(&inches));
    assert!((inches.axes.x.max_speed.to_num::<f64>() - 500.0).abs() < 0.13);
    assert_eq!(inches.axes.x.length.to_num::<f64>(), 100.0, "short, until the owner measures it");
}

/// Nothing in silence: each word of each line that sets something is in the report.
#[test]
fn every_word_has_a_verdict() {
    for (name, _) in LOGS {
        let report = translated(name).report;
        for line in text(name).lines().map(|line| line.trim_start_matches("Recv: ").trim_start_matches("echo:").trim())
        {
            let mut words = line.split(';').next().unwrap().split_whitespace();
            let Some(code) = words.next().filter(|code| {
                code.len() > 1 && code.starts_with(['G', 'M']) && code[1..].bytes().all(|b| b.is_ascii_digit())
            }) else {
                continue;
            };
            let section = report.sections.iter().find(|section| section.name == code).unwrap();
            if section.verdict.as_ref().is_some_and(|verdict| verdict.text.ends_with("lines more)")) {
                continue;
            }
            let said: Vec<_> = section.keys.iter().map(|key| format!("{} {}", key.key, key.value)).collect();
            for word in words {
                let is_said =
                    |said: &String| said.contains(word) || said.contains(&format!("{} {}", &word[..1], &word[1..]));
                assert!(
                    said.iter().any(is_said) || code == "M569" || word == "T0" || word == "E0",
                    "{code} {word}: {said:?}"
                );
            }
        }
    }
}

#[test]
fn decoration_does_not_count() {
    let whole = text("shaped");
    let machine = |text: &str| {
        let done = of_text("x", text, None);
        done.machine.unwrap_or_else(|| panic!("{:?}\n{text}", done.problems)).settings
    };
    let each = |change: fn(&str) -> String| whole.lines().map(|line| change(line) + "\n").collect::<String>();
    for other in [
        whole.replace('\n', "\r\n"),
        whole.replace("echo:", ""),
        whole.replace("echo:", "echo: "),
        each(|line| format!("Recv: {line}")),
        each(|line| format!("[12:00:07] Recv: {line}")),
        each(|line| format!("16:52:24.183 -> {line}")),
        each(|line| format!(">>> {line}")),
        each(|line| format!("READ: {line}")),
        each(|line| format!("> READ: {line}")),
        each(|line| format!("Printer: {line}")),
        each(|line| format!("04:52:24 PM <<< {line}")),
        (1..).zip(whole.lines()).map(|(number, line)| format!("{number}: {line}\n")).collect(),
        each(|line| format!("2026-05-01 16:52:24,183 - [16:52:24] <<< {line}")),
        format!("16:52:24.000 -> M503\nSENT: M503\n>>> M115\n{whole}"),
        each(|line| format!("{line}\nT:21.50 /0.00 B:22.00 /0.00 @:0 B@:0\necho:busy: processing\nwait\n")),
        each(|line| line.split(" ; ").next().unwrap().to_owned()),
        whole.lines().rev().collect::<Vec<_>>().join("\n"),
        whole.clone() + &whole,
    ] {
        assert_eq!(machine(&other), machine(&whole), "{other}");
    }
}

/// A motor without a word for its mode has no mode by its neighbour's.
#[test]
fn the_mode_of_one_motor_is_not_anothers() {
    let of = |lines: &str| of_text("x", &format!("M92 X80 Y80 Z400 E90\nM906 X800 Y800\n{lines}\n"), Some("corexy"));
    let told = |lines: &str| {
        let notes = of(lines).report.notes;
        notes.into_iter().filter(|note| note.kind == Kind::Decide && note.text.contains("is not said")).count()
    };
    for (lines, count) in [
        ("M569 S1 X", 1),
        ("M569 S1 Y", 1),
        ("M569 S1 X Y", 0),
        ("M569 S0 X", 0),
        ("M906 I1 X800\nM569 S1 X Y", 0),
        ("", 0),
    ] {
        assert_eq!(told(lines), count, "{lines}: {:?}", of(lines).report.notes);
    }
}

/// Levelling words of M503: what the printer says is taken, and which probe it has is to be filled in.
#[test]
fn the_probe_the_mesh_and_the_screws_are_taken() {
    let lines = "M92 X80 Y80 Z400 E90\nM420 S1 Z10.00 ; Leveling ON\nM851 X-45.00 Y-5.00 Z-1.20 ; (mm)\n\
                 M422 S1 X10.00 Y100.00\nM422 S2 X200.00 Y101.00\nM422 W1 X-20.00 Y100.00\nG29 W I0 J0 Z0.1\n";
    let done = of_text("x", lines, Some("cartesian"));
    for line in [
        "[mesh]\nis_on = true",
        "fade = 10",
        "[probe.offset]\nx = -45",
        "y = -5",
        "z = -1.2",
        "[screws.1]\npoint_x = 10",
        "[screws.2]\npoint_x = 200",
        "point_y = 101",
        "x = -20",
        "z1 = [0, 0, 1]",
    ] {
        assert!(done.text.contains(line), "{line}: {}", done.text);
    }
    assert_eq!(verdict(&done.report, "M851", "X"), (Kind::Taken, "probe.offset.x = -45"));
    assert!(done.report.open.iter().any(|open| open.starts_with("probe.kind = \"none\"")), "{:?}", done.report.open);
}

#[test]
fn a_later_line_replaces_an_earlier_one() {
    let done = of_text("x", "M92 X80 Y80 Z400 E90\nM92 X81", Some("cartesian"));
    let section = &done.report.sections[0];
    assert_eq!(section.keys[0].verdict.text, "line 2 replaces it");
    assert_eq!(verdict(&done.report, "M92", "X"), (Kind::Taken, "axes.x.steps_per_mm = 81"));
}

#[test]
fn a_report_is_told_from_a_configuration_and_from_a_print() {
    for (name, _) in LOGS {
        assert!(is_report(&text(name)), "{name}");
    }
    assert!(!is_report("[printer]\nkinematics: corexy\n[gcode_macro A]\ngcode:\n  M204 S500\n"));
    assert!(!is_report("M204 S500\nG28\nG1 X5\n"));
    assert!(!is_report(""));
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain("M92 X80".bytes().flat_map(|byte| [byte, 0])).collect();
    assert!(is_report(&text_of(&wide)) && is_report(&text_of(b"\xef\xbb\xbfM92 X80")));
    assert!(is_report(&text_of(b"\xff\x00\xc3\nM92 X80\n")));
}

/// What could break a machine is left open, and the rest of a damaged report counts.
#[test]
fn damage_is_left_to_the_owner() {
    let whole = text("mega");
    for (from, to) in
        [("Z400.00", "Z"), ("Z400.00", "Znan"), ("Z400.00", "Z1e999"), ("Z400.00", ""), ("Z400.00", "Z-4")]
    {
        let done = of_text("x", &whole.replacen(from, to, 1), Some("cartesian"));
        assert!(done.machine.is_none() && !done.is_whole(), "{to}: {}", done.text);
        assert!(done.report.notes.iter().any(|note| note.text.contains("axes.z.steps_per_mm")), "{to}");
    }
    for (row, is_machine) in [("16\t16\t8", true), ("16\t32\t8", false), ("16\t17\t8", true)] {
        let done = of_text("x", &format!("{whole}\n\t\tX\tY\tZ\nmsteps\t\t{row}\n"), Some("cartesian"));
        assert_eq!(done.machine.is_some(), is_machine, "{row}");
        assert_eq!(verdict(&done.report, "M122", "Y").0 == Kind::Taken, row == "16\t16\t8", "{row}");
    }
    for (from, to, kind) in [
        ("M203 X300.00", "M203 Xovf", Kind::Decide),
        ("M203 X300.00", "M203 X1000000", Kind::Approximated),
        ("M203 X300.00", "M203 X-5", Kind::Approximated),
    ] {
        let done = of_text("x", &whole.replacen(from, to, 1), Some("cartesian"));
        assert_eq!(verdict(&done.report, "M203", "X").0, kind, "{to}");
    }
    let done = of_text("x", &(whole + "M999999\nM98 P\"x\"\n=5\nM1234 Q7 =\n"), Some("cartesian"));
    assert_eq!(verdict(&done.report, "M98", "P"), (Kind::NotYet, "no setting for it"));
    assert_eq!(verdict(&done.report, "M1234", "=").0, Kind::NotYet);
    assert_eq!(verdict(&done.report, "other lines", "=5").0, Kind::NotNeeded);
    assert!(done.machine.is_some());
}

#[test]
fn what_the_printer_does_not_say_is_to_be_filled_in() {
    let done = translate("x", &text("inches"), Given::default());
    let open = done.report.open.join("\n");
    for key in ["board", "motors.x", "endstops.z", "axes.y.length", "homing.z.end", "microsteps", "current_ma"] {
        assert!(open.contains(key), "{key}: {open}");
    }
    assert!(done.text.contains("# board = "), "{}", done.text);
    assert!(done.text.contains("\nlength = 100  # to be filled in\n"), "{}", done.text);
    // The machine is one, but motors that nobody plugged in do not turn, and nobody said how they move it.
    assert!(done.machine.is_some(), "{:?}", done.problems);
    assert!(!done.is_whole() && done.report.notes.iter().any(|note| note.text.contains("--kinematics")));
    // A delta has no matrix.
    let delta = of_text("x", &(text("mega") + "M665 L250 R125 H300\n"), None);
    assert!(!delta.is_whole() && verdict(&delta.report, "M665", "L250 R125 H300").0 == Kind::Decide);
}

#[test]
fn firmwares_are_known_by_their_names() {
    for (said, firmware) in [
        ("FIRMWARE_NAME:Marlin 2.1.2 (x) SOURCE_CODE_URL:y", Firmware::Marlin),
        ("FIRMWARE_NAME:CoreH-bot 0.1.0 (Marlin dialect) SOURCE_CODE_URL:-", Firmware::Corehbot),
        ("FIRMWARE_NAME:Prusa-Firmware 3.14.1 based on Marlin FIRMWARE_URL:x", Firmware::Prusa),
        ("FIRMWARE_NAME: RepRapFirmware for Duet 2 WiFi FIRMWARE_VERSION: 3.4.5", Firmware::RepRap),
        ("ok FIRMWARE_VERSION:v0.12.0 FIRMWARE_NAME:Klipper", Firmware::Klipper),
        ("// Klipper state: Ready", Firmware::Klipper),
        ("GrblHAL 1.1f ['$' or '$HELP' for help]", Firmware::Grbl),
        ("error:20", Firmware::Grbl),
        ("FIRMWARE_NAME:Repetier_1.0.4 FIRMWARE_URL:x", Firmware::Repetier),
        ("FIRMWARE_NAME:Bread V2", Firmware::Other),
    ] {
        assert_eq!(Firmware::heard(&format!("start\n{said}\nok\n")).unwrap().0, firmware, "{said}");
    }
    assert_eq!(Firmware::heard("start\nok\n"), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_text_becomes_a_file_and_a_report(choice in any::<u8>(), text in any_report()) {
        configurations::any(&[&[choice], text.as_bytes()].concat());
    }

    #[test]
    fn any_bytes_become_a_file_and_a_report(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        configurations::any(&bytes);
    }

    /// If each line is whole, the file is a machine, unless a measure is out of its range: that is told.
    #[test]
    fn a_whole_report_becomes_a_machine(numbers in prop::collection::vec(number(), 40), kind in 0..9usize) {
        let mut numbers = numbers.into_iter();
        let whole = text("mega").lines().map(|line| {
            let words = line.split(' ').map(|word| match word.chars().next() {
                Some(letter) if letter.is_ascii_uppercase() && word[1..].parse::<f64>().is_ok() && !"MGI".contains(letter) => {
                    numbers.next().map_or_else(|| word.to_owned(), |number| format!("{letter}{number}"))
                }
                _ => word.to_owned(),
            });
            words.collect::<Vec<_>>().join(" ") + "\n"
        }).collect::<String>();
        let kinematics = Some(&corehbot_machine_file::marlin::Kinematics::ALL[kind]);
        let done = translate("x", &whole, Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics });
        let is_told = |problem: &corehbot_machine_file::Problem| {
            let problem = problem.to_string();
            let path = problem.split(" = ").next().and_then(|text| text.split(' ').next_back()).unwrap_or_default();
            let said = format!("{path} = ");
            done.report.sections.iter().flat_map(|section| &section.keys).any(|key| {
                key.verdict.kind == Kind::Decide && key.verdict.text.contains(&said) && key.verdict.text.contains("its range is")
            })
        };
        let is_open = done.problems.iter().any(|problem| problem.to_string().contains("is outside") && is_told(problem));
        prop_assert!(done.machine.is_some() || is_open, "{:?}\n{}", done.problems.iter().map(ToString::to_string).collect::<Vec<_>>(), done.text);
    }
}

/// Positive numbers of all sizes.
fn number() -> impl Strategy<Value = f64> {
    (-2.0..5.0f64).prop_map(|exponent| (10f64.powf(exponent) * 100.0).round().max(1.0) / 100.0)
}

/// Texts near reports: known lines with all kinds of values, cut and mixed.
fn any_report() -> impl Strategy<Value = String> {
    let code = prop::sample::select(vec![
        "M92", "M203", "M201", "M204", "M205", "M206", "M211", "M301", "M304", "M306", "M593", "M900", "M906", "M913",
        "M569", "M422", "M665", "G20", "G29", "M710", "M572", "m92", "M", "G123456", "M115",
    ]);
    let word = prop_oneof![
        4 => (prop::sample::select("XYZEPIDTSFJKCRAHLW".chars().collect::<Vec<_>>()), any_value())
            .prop_map(|(letter, value)| format!("{letter}{value}")),
        1 => "[ -~]{0,6}",
        1 => "\\PC{0,4}",
    ];
    let line = prop_oneof![
        6 => (code, prop::collection::vec(word, 0..6)).prop_map(|(code, words)| format!("echo:  {code} {}\n", words.join(" "))),
        1 => any_value().prop_map(|value| format!("echo:Soft endstops: On  Min: X{value} Y0 Z  Max: X{value} Z{value}\n")),
        1 => any_value().prop_map(|value| format!("area:{{full:{{min:{{x:{value},y:0}},max:{{x:{value}}}}},work:{{}}\n")),
        1 => "(FIRMWARE_NAME:[ -~]{0,9} )?(MACHINE_TYPE|KINEMATICS|EXTRUDER_COUNT):[ -~]{0,30}\n",
        1 => "[xyz]_(min|max): (open|TRIGGERED)\n",
        1 => "\t(X|Y|Z2|E9|é)?\tX(\tE1)?\n(msteps\t\t[0-9]{0,4}\t[0-9a-z]{0,3}\n)?",
        1 => "[ -~\t]{0,40}\n?",
        1 => "[\u{0}-\u{1f}\u{7f}-\u{a0}\u{2028}]{0,6}",
    ];
    prop::collection::vec(line, 0..60).prop_map(|lines| lines.concat())
}

fn any_value() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => "-?[0-9]{1,7}(\\.[0-9]{1,4})?",
        1 => prop::sample::select(vec!["", "nan", "inf", "-inf", "1e999", "-0", "0", "9e8", "0x10", "1,5", "ovf"])
            .prop_map(str::to_owned),
        1 => "[ -~]{0,5}",
    ]
}
