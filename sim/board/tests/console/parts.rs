//! Words for parts that the machine lacks, and the start of prints that slicers write for many machines. Each is
//! refused once, by name, and the machine's own parts stay untouched.

use super::talk::{HOMED, Steps, Talk, talk, talk_to};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::run_on;

/// The replies besides the `ok`s.
fn told(lines: &[&str]) -> Vec<String> {
    let (heard, ..) = talk(lines);
    heard.into_iter().filter(|line| !line.starts_with("ok") && !line.starts_with("echo:busy")).collect()
}

/// Reproducer: `M221 T1 S50` halved the flow of the only extruder.
#[test]
fn a_word_for_another_extruder_leaves_the_only_one_alone() {
    assert_eq!(told(&["M221 T1 S50", "M221"]), ["echo:M221 ignored: there is no extruder 1", "echo:E0 Flow: 100%"]);
    assert_eq!(told(&["M221 T0 S50", "M221"]), ["echo:E0 Flow: 50%"]);
    for (line, report, part) in [
        ("M900 T1 K.2", "M900", "M900 ignored: there is no extruder 1"),
        ("M900 S1 K.2", "M900", "M900 ignored: there is no other K 1"),
        ("M572 D1 S.2", "M900", "M572 ignored: there is no extruder 1"),
        (
            "SET_PRESSURE_ADVANCE EXTRUDER=extruder1 ADVANCE=.2",
            "M900",
            "SET_PRESSURE_ADVANCE ignored: there is no extruder extruder1",
        ),
        ("M92 T1 E500", "M92", "M92 ignored: there is no extruder 1"),
        ("M203 T1 E50", "M203", "M203 ignored: there is no extruder 1"),
        ("M201 T1 E500", "M201", "M201 ignored: there is no extruder 1"),
        ("M207 P1 S9", "M207", "M207 ignored: there is no tool 1"),
        ("M569 T1 S1 E", "M569", "M569 ignored: there is no extruder 1"),
        ("M906 I1 X500", "M906", "M906 ignored: there is no driver of an axis 1"),
    ] {
        let before = told(&[report]);
        let mut expected = vec![format!("echo:{part}")];
        expected.extend(before);
        assert_eq!(told(&[line, report]), expected, "{line}");
    }
}

#[test]
fn a_part_that_is_not_there_is_told_once_a_print_and_each_by_name() {
    let told_of = ["echo:M221 ignored: there is no extruder 1", "echo:M221 ignored: there is no extruder 2"];
    let mut lines = vec!["M221 T1 S50"; 40];
    lines.extend(["M221 T2 S50"; 40]);
    assert_eq!(told(&lines), told_of);
    let print = [&lines[..], &["M110 N0"], &lines[..]].concat();
    assert_eq!(told(&print), [told_of, told_of].concat());
    assert_eq!(
        told(&["T1", "T1", "M104 T1 S200", "T2", "M106 P9 S10", "M106 P9 S20", "M107 P9", "M106 P-1 S5"]),
        [
            "echo:T1 Invalid extruder",
            "echo:T1 Invalid extruder",
            "echo:T2 Invalid extruder",
            "echo:M106 ignored: there is no fan 9",
            "echo:M106 ignored: there is no fan of that number",
        ]
    );
    assert_eq!(
        told(&["M106 P1 S9", "M106 P1", "M106 P2"]),
        ["echo:fan 1 is not commanded", "echo:fan 2 is not commanded"]
    );
    // More of them than in any print do not flood the host either.
    let many: Vec<String> = (1..200).map(|tool| format!("T{tool}")).collect();
    assert_eq!(told(&many.iter().map(String::as_str).collect::<Vec<_>>()).len(), 16);
}

/// Words that slicers write for machines with one extruder.
#[test]
fn words_for_the_only_extruder_are_silent() {
    let lines = [
        "T0",
        "M200 D0",
        "M200 T0 D0",
        "M106 P0 S255",
        "M107 P0",
        "M141 S0",
        "M191 S0",
        "M221 T0 S100",
        "M900 T0 K0",
        "M572 D0 S0",
        "SET_PRESSURE_ADVANCE EXTRUDER=extruder ADVANCE=0",
        "M106 P3 S100",
        "M84 X Y E",
        "M18 E0",
    ];
    assert_eq!(told(&lines), [""; 0]);
    assert_eq!(told(&["G10 P0 S200"]), ["echo:Unknown command: \"G10 P0 S200\""]);
}

/// The beginning of a print in slicers' profiles, and the messages about it.
const PROFILES: [(&str, &[&str], &[&str]); 4] = [
    // PrusaSlicer 2.7, Original Prusa i3 MK3S (resources/profiles/PrusaResearch.ini), without G80; its filament has
    // both K.
    (
        "PrusaSlicer MK3",
        &[
            "M73 P0 R12",
            "M201 X1000 Y1000 Z200 E5000",
            "M203 X200 Y200 Z12 E120",
            "M204 P1250 R1250 T1250",
            "M205 X8.00 Y8.00 Z0.40 E4.50",
            "M205 S0 T0",
            "M107",
            "M862.3 P \"MK3S\"",
            "M862.1 P0.4",
            "M115 U3.13.0",
            "G90",
            "M83",
            "G28 W",
            "G1 Z0.2 F720",
            "G1 Y3 F1000",
            "G92 E0",
            "G1 X60 E9 F1000",
            "G1 X100 E12.5 F1000",
            "G92 E0",
            "M221 S95",
            "M900 K0.05",
            "M900 K30",
            "G21",
            "G90",
            "M83",
            "M900 K0.05",
            "M204 S1000",
            "G1 X110 Y20 E1",
            "M221 S100",
            "M107",
        ],
        &["M900 ignored: K30"],
    ),
    // Cura 5, Creality (creality_base.def.json).
    (
        "Cura",
        &[
            "M105",
            "M82",
            "M201 X500.00 Y500.00 Z100.00 E5000.00",
            "M203 X500.00 Y500.00 Z10.00 E50.00",
            "M204 P500.00 R1000.00 T500.00",
            "M205 X8.00 Y8.00 Z0.40 E5.00",
            "M220 S100",
            "M221 S100",
            "G28",
            "G92 E0",
            "G1 Z2.0 F3000",
            "G1 X10.1 Y20 Z0.28 F5000.0",
            "G1 X10.1 Y145.0 Z0.28 F1500.0 E15",
            "G1 X10.4 Y145.0 Z0.28 F5000.0",
            "G1 X10.4 Y20 Z0.28 F1500.0 E30",
            "G92 E0",
            "G1 Z2.0 F3000",
            "M107",
        ],
        &[],
    ),
    // OrcaSlicer, MyMarlin and a profile of a machine with more fans.
    (
        "Orca",
        &[
            "M201 X1000 Y1000 Z100 E5000",
            "M203 X300 Y300 Z10 E60",
            "M204 P1500 R1500 T1500",
            "M205 X9.00 Y9.00 Z0.20 E2.50",
            "M106 S0",
            "M106 P2 S0",
            "M106 P3 S0",
            "M106 P9 S0",
            "M141 S0",
            "M191 S0",
            "T0",
            "G90",
            "M83",
            "G28",
            "G1 X20 Y20 Z0.3 F1000",
            "M900 K0.02",
            "M900 K1e-05",
            "SET_VELOCITY_LIMIT ACCEL=2000 ACCEL_TO_DECEL=1000",
            "G17",
            "G3 Z.76 I.194 J1.201 P1  F30000",
            "G1 X60 E5 F1200",
            "M106 P2 S178",
            "M106 P9 S178",
            "M107",
        ],
        &["fan 2 is not commanded", "there is no fan 9"],
    ),
    // A profile of a machine with two extruders, and one of RepRapFirmware.
    (
        "two extruders",
        &[
            "T0",
            "G92 E0",
            "M104 T1 S200",
            "M221 T1 S50",
            "M900 T1 K.4",
            "M203 X18000 Y18000",
            "G28",
            "G1 X10 E1 F1200",
            "T1",
            "G1 X20 E2",
            "T0",
            "M221 T1 S50",
            "G1 X30 E3",
        ],
        &[
            "T1 Invalid extruder",
            "M221 ignored",
            "M900 ignored",
            "M203 ignored: X18000",
            "M203 ignored: Y18000",
            "T1 Invalid extruder",
        ],
    ),
];

/// Lives: the same print twice on one machine. The messages are the same, settings end the same, and the filament moves
/// as far.
#[test]
fn profiles_of_other_machines_print_twice_alike() {
    for (name, profile, told_of) in PROFILES {
        let print: Vec<&str> = [&["M110 N0"], profile, &["M400"]].concat();
        let twice = [&print[..], &["M503"], &print[..], &["M503"]].concat();
        let (heard, outcome, _) = talk(&twice);
        let settings: Vec<_> = heard.iter().filter(|line| line.starts_with("echo:  ")).collect();
        let (first, second) = settings.split_at(settings.len() / 2);
        assert_eq!(first, second, "{name}");
        let is_setting = |line: &str| line.starts_with("echo:  ") || line.starts_with("echo:;");
        let is_told = |line: &&String| line.starts_with("echo:") && !line.starts_with("echo:busy") && !is_setting(line);
        let told: Vec<_> = heard.iter().filter(is_told).collect();
        assert_eq!(told.len(), 2 * told_of.len(), "{name}: {told:#?}");
        for (line, part) in told.iter().zip(told_of.iter().cycle()) {
            assert!(line.contains(part), "{name}: {line} {part}");
        }
        let (_, once, _) = talk(&[&print[..], &["M503"]].concat());
        assert_eq!(outcome.counts[6], 2 * once.counts[6], "{name}");
        if name == "PrusaSlicer MK3" {
            assert!(first.contains(&&"echo:  M900 K0.05".to_owned()), "{first:?}");
        }
    }
}

/// Drivers have words of their own.
#[test]
fn drivers_of_an_axis_have_no_numbers() {
    let mut host = Talk::new(&["M906", "M906 I1 X500 E500", "M906 T1 E500", "M906 I0 E500", "M906"]);
    let start = HOMED.map(|at| at.map(Mm::from_num));
    run_on(&Settings::prototype(), start, NoStorage, &Drivers::new(), &mut [&mut host], &mut Steps::default()).unwrap();
    let told: Vec<_> = host.heard.iter().filter(|line| line.contains("current") || line.contains("ignored")).collect();
    assert_eq!(
        told[4..],
        [
            "echo:M906 ignored: there is no driver of an axis 1",
            "echo:M906 ignored: there is no extruder 1",
            "X driver current: 800",
            "Y driver current: 800",
            "Z driver current: 800",
            "E driver current: 500",
        ]
    );
    let (heard, ..) = talk_to(&Settings::prototype(), HOMED, &["M301 E1 P10"]);
    assert_eq!(heard[0], "echo:M301 ignored: there is no extruder 1");
}
