//! Macros of Klipper's owners as texts.

use super::of_text;
use corehbot_machine_file::{Kind, body, parse};

const PRINTER: &str = "[printer]\nkinematics: cartesian\n";

fn verdict_of(text: &str, section: &str, key: &str) -> (Kind, String) {
    let done = of_text(&format!("{PRINTER}{text}"));
    let section = done.report.sections.iter().find(|of| of.name == section).unwrap();
    let key = section.keys.iter().find(|of| of.key == key).unwrap();
    (key.verdict.kind, key.verdict.text.clone())
}

#[test]
fn plain_macros_become_texts_of_a_machine() {
    let text = "[gcode_macro START_PRINT]\ndescription: begins\ngcode:\n  {% set BED = params.BED_TEMP|default(60)|float %}\n\
                \n  # warm\n  M140 S{BED}\n  G28\n  M190 S{BED}\n  _PURGE LENGTH=20\n\
                [gcode_macro _purge]\ngcode: G92 E0\n  G1 E{params.LENGTH|default(10)} F300\n\
                [gcode_macro PAUSE]\nrename_existing: BASE_PAUSE\ngcode:\n  RESPOND MSG=\"paused\"\n  BASE_PAUSE\n";
    let done = of_text(&format!("{PRINTER}{text}"));
    // Without its motors it is no machine; the texts alone are one.
    let (_, texts) = done.text.split_once("\n[texts]").unwrap();
    let machine = parse(&format!("[texts]{}", texts.split("\n[").next().unwrap())).unwrap();
    let body = String::from_utf8(body(&machine.texts)).unwrap();
    let expected = "PAUSE\nM118 E1 paused\nPAUSE\n\nSTART_PRINT\nM140 S{BED_TEMP:60}\nG28\nM190 S{BED_TEMP:60}\n_PURGE LENGTH=20\n\
                    \n_PURGE\nG92 E0\nG1 E{LENGTH:10} F300\n\n";
    assert_eq!(body, expected, "{}", done.text);
    assert_eq!(
        verdict_of(text, "gcode_macro START_PRINT", "gcode"),
        (Kind::Taken, "texts.START_PRINT, 4 lines".to_owned())
    );
    assert_eq!(verdict_of(text, "gcode_macro PAUSE", "rename_existing").0, Kind::NotNeeded);
}

#[test]
fn other_macros_are_named_with_the_line_that_needs_a_person() {
    let end = ": write its commands into [texts], or into the slicer's G-code";
    for (text, why) in [
        (
            "gcode:\n  G28\n  # no\n  {% if x %}\n  G1 X5\n  {% endif %}\n",
            "printer.cfg:7: {% if x %} is a condition or a loop",
        ),
        ("gcode:\n  G28\n  SET_LED RED=1\n", "printer.cfg:6: unknown command \"SET_LED RED=1\""),
        ("gcode: G1 X{printer.x}\n", "printer.cfg:4: {printer.x} is computed"),
        ("gcode:\n  HELLO\n", "it calls itself: HELLO -> HELLO"),
        ("gcode:\n", "it has no lines"),
    ] {
        let text = format!("[gcode_macro HELLO]\n{text}");
        assert_eq!(verdict_of(&text, "gcode_macro HELLO", "gcode"), (Kind::NotYet, format!("{why}{end}")), "{text}");
    }
    // One that calls such a one is none either.
    let text = "[gcode_macro A_]\ngcode:\n  B_\n[gcode_macro B_]\ngcode:\n  SET_LED RED=1\n";
    let (kind, why) = verdict_of(text, "gcode_macro A_", "gcode");
    assert_eq!((kind, why.starts_with("printer.cfg:5: unknown command \"B_\"")), (Kind::NotYet, true), "{why}");
}
