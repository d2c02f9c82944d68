//! Lines: each is answered once, whatever it holds. Conditions end the print: `commands/effects.rs`.

use super::talk::{HOMED, keep, talk, talk_to};
use corehbot::gcode::Command;
use corehbot::machine::parse;
use corehbot::settings::Settings;
use corehbot_sim::eeprom::Eeprom;
use proptest::prelude::*;

#[test]
fn every_line_has_one_ok_and_blank_lines_have_none() {
    let (heard, ..) = talk(&["G21", "M105", "G1 X5 F6000", "FOO", "T0", "T3", "M117 hello *", "G4 P1", "M400"]);
    assert_eq!(heard.iter().filter(|l| l.starts_with("ok")).count(), 9);
    assert!(heard.contains(&"echo:Unknown command: \"FOO\"".to_owned()), "{heard:?}");
    assert!(heard.iter().any(|l| l.starts_with("ok T:")), "{heard:?}");
}

/// Hosts send them as they stand in the file, and wait.
#[test]
fn a_line_of_comments_alone_is_answered_and_is_no_command() {
    let lines = ["(comment)", "(a) (b)", " ( M112 )", "(a;b)", "()", "N1 (comment)*45", "G1 X5 (there)"];
    let (heard, outcome, _) = talk(&lines);
    assert_eq!(heard.iter().filter(|line| *line == "ok").count(), lines.len(), "{heard:?}");
    assert!(!outcome.halted && !heard.iter().any(|line| line.contains("echo:Unknown")), "{heard:?}");
}

#[test]
fn texts_pass_letter_by_letter() {
    for text in
        ["Größe", "voilà", "à la carte", "°C", "¡Hola!", "Ω\u{a0}5", "Слой 3", "第3層", "🖨 ready", "50 µm (ca.)"]
    {
        for (line, told) in [
            (format!("M118 {text}"), text.to_owned()),
            (format!("M118 E1 {text} "), format!("echo:{text}")),
            (format!("M118 A1 P0 {text}"), format!("//{text}")),
        ] {
            let (heard, ..) = talk(&[&line]);
            assert!(heard.contains(&told), "{line}: {heard:?}");
        }
        let lines = [format!("M117 {text}"), format!("M1 S1 {text}"), format!("M0 P1 {text}"), format!("M486 A{text}")];
        let (heard, ..) = talk(&lines.each_ref().map(String::as_str));
        assert_eq!(heard.iter().filter(|line| *line == "ok").count(), 4, "{heard:?}");
        assert!(!heard.iter().any(|line| line.starts_with("echo:")), "{heard:?}");
    }
}

#[test]
fn an_advanced_ok_tells_line_and_room() {
    let mut settings = Settings::prototype();
    settings.advanced_ok = true;
    let (heard, ..) = talk_to(&settings, HOMED, &["N1 G90*17", "M82", "N2 *92", "M110", "N3 G1 X5*1"]);
    assert_eq!(heard[..3], ["ok N1 P144 B10", "ok P144 B10", "ok N2 P144 B10"]);
    assert_eq!(heard[3..5], ["Line: 2", "ok"]);
    assert!(heard[5].starts_with("Error:checksum"), "{heard:?}");
}

#[test]
fn a_bad_line_costs_a_resend_and_nothing_else() {
    let sum = |text: &str| format!("{text}*{}", text.bytes().fold(0, |a, b| a ^ b));
    let lines = [sum("N0 M110 N0"), sum("N1 G1 X10 F6000"), "N2 G1 X20*1".to_owned(), sum("N2 G1 X20"), sum("N3 M400")];
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (heard, outcome, _) = talk(&lines);
    let dialogue = ["Error:checksum mismatch, Last Line: 1", "Resend: 2", "ok"];
    assert!(heard.windows(3).any(|w| w == dialogue), "{heard:?}");
    assert_eq!(outcome.counts[3], 1600);
}

/// Whether a print stops at a line, or waits there for the user or for the time in the line. It would also wait for
/// heaters, but there are none.
fn stops(line: &str) -> bool {
    const STOPPING: [(char, u16); 9] =
        [('G', 4), ('M', 0), ('M', 1), ('M', 25), ('M', 112), ('M', 125), ('M', 600), ('M', 601), ('M', 999)];
    let stops = match parse(line.as_bytes()) {
        Command::Table(command) => STOPPING.into_iter().any(|(letter, number)| command.is(letter, number)),
        Command::Condition => true,
        _ => false,
    };
    // M112 is heard wherever it stands in a line; the two signs make a host wait.
    stops || line.starts_with(['!', '~']) || line.to_ascii_uppercase().replace(' ', "").contains("M112")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Whatever lines look like, each is answered once, nothing panics, and the pairs stay pairs.
    #[test]
    fn any_lines_are_answered_once_each(
        lines in proptest::collection::vec(
            prop_oneof![
                4 => "G[0-3]( ?[XYZE]-?[0-9]{1,3}(\\.[0-9]{0,4})?){1,3}( F[1-9][0-9]{3})?( [IJR]-?[0-9]{1,2}){0,2}",
                2 => "M2(0[1245]|11|2[01])( [XYZESTPRJ]-?[0-9]{0,5}(\\.[0-9]{0,3})?){0,4}",
                // At the least legal speed, 0.01 mm/s, a move takes hours.
                1 => "M203( [XYZE][1-9][0-9]{0,3}(\\.[0-9]{0,3})?){0,4}",
                1 => "G(9[0-2]|2[01]|17|4 P[0-9]{1,3})",
                1 => "M(17|18|84|82|83|92 E[0-9]{1,4}|105|114 ?R?|115|119|220 S[0-9]{1,5}|221|400|410|50[0-4]|122)",
                1 => "M(569|906|91[34])( [SXYZE]-?[0-9]{0,4}(\\.[0-9]{0,3})?){0,4}",
                1 => "G1 [XYE]-?[0-9]{5,30}",
                1 => "[ -~]{1,40}".prop_filter("it must have an answer, no number and no checksum, and nothing to wait for", |line| {
                    let line = line.trim();
                    !line.is_empty() && !line.starts_with([';', '(', 'N', 'n']) && !line.contains('*') && !stops(line)
                }),
            ],
            1..25,
        ),
    ) {
        // A print that has lost its place waits for the user, so the axes are homed again after M18 and M84.
        let homes = |line: &str| if line.starts_with("M18") || line.starts_with("M84") { Some("G28") } else { None };
        let mut lines: Vec<&str> = lines.iter().flat_map(|line| [Some(line.as_str()), homes(line)]).flatten().collect();
        lines.push("M400");
        let (heard, outcome, _) = keep(&mut Eeprom::blank(), &Settings::prototype(), &lines);
        prop_assert!(!outcome.halted);
        prop_assert_eq!(heard.iter().filter(|l| l.starts_with("ok")).count(), lines.len(), "{:?}", heard);
        let [n1, n4, n8, n11, z1, z2, ..] = outcome.counts;
        prop_assert_eq!((n1, n4, z1), (-n8, -n11, z2));
    }
}
