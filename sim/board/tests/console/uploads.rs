//! M28 to M29: the lines of an upload are not printed. Pronsole does not wait for the answer to M28, so the lines of
//! the file arrive whatever the answer; they get their `ok`s and nothing moves.

use super::talk::{HOMED, Steps, Talk, talk};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::run_with;

/// A line as a host sends it, with number and checksum.
fn numbered(number: i32, text: &str) -> String {
    let line = format!("N{number} {text}");
    let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{line}*{sum}")
}

const FILE: [&str; 6] =
    ["START_MACRO BED=60", "M104 S200", "G28", "G1 X50 Y50 E5 F6000", "M115 U3.13.0", "G1 X100 F6000"];

/// Pronsole's upload: M28 and the print go out together (pronsole.py, do_upload), with a reading of the temperatures
/// between two lines.
fn upload() -> Vec<String> {
    let mut lines = vec!["M28 test.gco".to_owned(), format!("!{}", numbered(-1, "M110 N-1"))];
    for (number, text) in (0..).zip(FILE) {
        lines.push(format!("{}{}", if number == 0 { "!" } else { "" }, numbered(number, text)));
        if number == 3 {
            lines.push("M105".to_owned());
        }
    }
    lines.extend([numbered(-1, "M110 N-1"), "M29 test.gco".to_owned()]);
    lines
}

fn said<'a>(heard: &'a [String], what: &str) -> Vec<&'a String> {
    heard.iter().filter(|line| line.contains(what)).collect()
}

const OPEN_FAILED: &str = "echo:open failed, File: test.gco. There is no card; lines up to M29 are ignored";

#[test]
fn an_upload_of_pronsole_moves_nothing_and_a_print_after_it_does() {
    let lines = upload();
    let all: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (heard, _, steps) = talk(&all);
    assert_eq!(steps.count, 0, "{heard:?}");
    let oks = heard.iter().filter(|line| line.starts_with("ok")).count();
    assert_eq!(oks, all.len(), "{heard:?}");
    assert_eq!(heard.iter().filter(|line| *line == OPEN_FAILED).count(), 1, "{heard:?}");
    assert_eq!(said(&heard, "ok T:").len(), 1, "{heard:?}");
    let ended = "echo:upload ended: there is no card, ignored lines: 6";
    assert_eq!(said(&heard, "upload ended"), [ended], "{heard:?}");
    assert!(said(&heard, "Unknown").is_empty() && said(&heard, "heaters").is_empty(), "{heard:?}");
    // A life: the upload again, and the same file printed.
    let mut lines = upload();
    lines.extend(upload());
    lines.push(numbered(-1, "M110 N-1"));
    lines.extend((0..).zip(FILE).map(|(number, text)| numbered(number, text)));
    lines.push("M114".to_owned());
    let all: Vec<&str> = lines.iter().map(String::as_str).collect();
    let (heard, _, steps) = talk(&all);
    assert_eq!(said(&heard, "upload ended").len(), 2, "{heard:?}");
    assert!(steps.count > 0 && said(&heard, "X:100.00 Y:50.00").len() == 1, "{heard:?}");
    assert_eq!(said(&heard, "Unknown").len(), 1, "{heard:?}");
}

#[test]
fn m29_ends_it_and_says_so() {
    let (heard, _, steps) =
        talk(&["M28 a.gco", "G1 X5 F6000", "nonsense", "M29", "M29", "G1 X7 F6000", "M400", "M114"]);
    assert_eq!(said(&heard, "upload ended"), ["echo:upload ended: there is no card, ignored lines: 2"]);
    assert!(steps.count > 0 && heard.iter().any(|line| line.starts_with("X:7.00 ")), "{heard:?}");
    assert_eq!(heard.iter().filter(|line| *line == "ok").count(), 8, "{heard:?}");
}

/// OctoPrint sets the line number before M28, and numbers the lines after it.
#[test]
fn damaged_lines_of_an_upload_are_asked_for_again() {
    let [begin, first, second, end] = [(1, "M28 test.gco"), (2, "G1 X5 F6000"), (3, "G1 X9"), (4, "M29")]
        .map(|(number, text)| numbered(number, text));
    let damaged = second.replace("X9", "X8");
    let lines = [&numbered(0, "M110 N0"), &begin, &first, &damaged, &second, &first, &second, &end, "M114"];
    let (heard, _, steps) = talk(&lines);
    assert_eq!((steps.count, said(&heard, "Resend: 3").len()), (0, 1), "{heard:?}");
    // A line that comes twice counts once.
    assert_eq!(said(&heard, "upload ended"), ["echo:upload ended: there is no card, ignored lines: 2"]);
    assert_eq!(heard.iter().filter(|line| *line == "ok").count(), 9, "{heard:?}");
}

#[test]
fn a_host_that_never_says_m29_gets_its_printer_back() {
    let hello = numbered(0, "M110 N0");
    for words in [vec![hello.as_str()], vec!["M115"], vec!["M105", &hello, &hello, "M115", "M105"]] {
        let mut lines = vec!["M28 a.gco", "G1 X5 F6000"];
        lines.extend(&words);
        lines.extend(["G1 X7 F6000", "M400", "M114"]);
        let (heard, _, steps) = talk(&lines);
        assert_eq!(said(&heard, "upload ended").len(), 1, "{words:?}: {heard:?}");
        assert!(steps.count > 0 && heard.iter().any(|line| line.starts_with("X:7.00 ")), "{words:?}: {heard:?}");
    }
}

#[test]
fn emergencies_act_in_an_upload_and_do_not_end_it() {
    let (heard, outcome, steps) = talk(&["M28 a.gco", "G1 X5 F6000", "M112"]);
    assert!(outcome.halted && steps.count == 0, "{heard:?}");
    let (heard, _, steps) = talk(&["M28 a.gco", "G1 X5 F6000", "M108", "M410", "G1 X6 F6000", "M29", "M114"]);
    assert_eq!(steps.count, 0, "{heard:?}");
    assert_eq!(said(&heard, "upload ended"), ["echo:upload ended: there is no card, ignored lines: 2"]);
    // M410 overtakes M28, and forgets the lines before it: the file must not be printed for that.
    let (heard, _, steps) = talk(&["G4 S5", "!M28 a.gco", "~M410", "G1 X6 F6000", "M29", "M114"]);
    assert_eq!((steps.count, said(&heard, "upload ended").len()), (0, 1), "{heard:?}");
}

#[test]
fn the_upload_of_one_host_leaves_another_alone() {
    let mut uploads = Talk::new(&["M28 a.gco", "G1 X5 F6000", "G1 X6", "G1 X7"]);
    let mut prints = Talk::new(&["G1 Y5 F6000", "G1 Y9", "M400", "M114"]);
    let mut steps = Steps::default();
    let start = HOMED.map(|at| at.map(Mm::from_num));
    run_with(&Settings::prototype(), start, NoStorage, &mut [&mut uploads, &mut prints], &mut steps).unwrap();
    assert!(prints.heard.iter().any(|line| line.starts_with("X:0.00 Y:9.00 ")), "{:?}", prints.heard);
    assert!(said(&prints.heard, "upload").is_empty() && said(&prints.heard, "open failed").is_empty());
}
