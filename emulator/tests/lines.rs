//! Two hosts at once, fast and slow lines, and lines that damage their bytes.

use crate::common::{firmware, from_home, print, root, serve};
use corehbot::settings::Settings;
use corehbot_emulator::compare::{difference, scheduled};
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::{LineSeen, Seen};
use corehbot_emulator::watch::End;

/// A file that moves, long enough to wrap around the receiver's ring of 2048 bytes several times.
fn file() -> String {
    from_home(&root().join("examples/tiny.gcode"))
}

/// The other host's questions, enough to outlast the print. This host too says M400 when it is done. An M400 under way
/// brings the motion of both to rest, and that gives other steps than the file alone.
fn questions() -> String {
    "M105\nM115\nM114\nM119\n".repeat(150)
}

fn count(line: &LineSeen, begin: &str) -> usize {
    line.said.iter().filter(|said| said.starts_with(begin)).count()
}

/// Both hosts are done, and the steps are the steps of `gcode`.
fn check(seen: &Seen, gcode: &str) {
    let second = seen.second.as_ref().expect("a second host");
    assert_eq!((seen.end, seen.resets.len()), (End::Done, 0));
    assert_eq!((&seen.line.failure, &second.failure), (&None, &None));
    let host = scheduled(gcode, &Settings::prototype()).unwrap();
    if let Some(difference) = difference(&seen.recorder.events, &host) {
        panic!("{difference}");
    }
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
}

#[test]
fn two_hosts_are_served_at_once_and_each_hears_what_it_asked() {
    let (gcode, questions) = (file(), questions());
    let seen = serve(&firmware(), &gcode, Some(&questions), Manner::default(), None);
    check(&seen, &gcode);
    let second = seen.second.as_ref().unwrap();
    assert_eq!((seen.line.resends, second.resends), (0, 0));
    assert_eq!((count(&seen.line, "start"), count(second, "start")), (1, 1));
    // The first 400 lines are kept; a round of questions takes some 45, most of them of M115.
    assert_eq!((count(&seen.line, "ok T:"), count(&seen.line, "FIRMWARE_NAME")), (0, 0));
    assert!(count(second, "ok T:") > 5 && count(second, "FIRMWARE_NAME") > 5, "{:?}", second.said);
    println!("{:?} and {:?} bytes", seen.line.bytes, second.bytes);
}

/// At the fastest rate the ring holds 20 ms. It had room if the hosts do not have to send lines again.
#[test]
fn slow_and_fast_lines_lose_nothing() {
    for baud in [115_200, 1_000_000] {
        let gcode = file();
        let manner = Manner { baud: Some(baud), ..Manner::default() };
        let seen = serve(&firmware(), &gcode, Some(&questions()), manner, None);
        check(&seen, &gcode);
        let second = seen.second.as_ref().unwrap();
        for line in [&seen.line, second] {
            assert!((line.baud / f64::from(baud) - 1.0).abs() < 0.005, "{}", line.baud);
            assert_eq!(line.resends, 0);
        }
        println!(
            "{baud} baud: {:?} and {:?} bytes in {} ms",
            seen.line.bytes,
            second.bytes,
            seen.virtual_ns / 1_000_000
        );
    }
}

#[test]
fn the_image_itself_sets_both_lines_to_its_rate() {
    let seen = serve(&firmware(), "M105\n", Some("M105\n"), Manner::default(), None);
    assert_eq!((seen.line.baud, seen.second.unwrap().baud), (250_000.0, 250_000.0));
}

#[test]
fn a_host_is_served_with_nobody_on_the_other_line() {
    let seen = print(&firmware(), "M105\n", None);
    assert!(seen.end == End::Done && seen.second.is_none() && count(&seen.line, "ok T:") == 1);
}

/// The receiver's ring and the Console's hold 2900 bytes between them, less a line that is not complete.
#[test]
fn hosts_that_do_not_wait_for_answers_lose_nothing_up_to_what_the_rings_hold() {
    let text = "G28 X\n".to_owned() + &"M114 this is a longer line\n".repeat(107);
    assert!((2800..2900).contains(&text.len()), "{}", text.len());
    let manner = Manner { baud: Some(1_000_000), is_impatient: true, ..Manner::default() };
    let seen = serve(&firmware(), &text, Some(&text), manner, None);
    assert_eq!((seen.end, seen.resets.len()), (End::Done, 0));
    for line in [&seen.line, seen.second.as_ref().unwrap()] {
        assert_eq!(line.bytes[0], text.len() as u64);
        assert_eq!((count(line, "Error"), count(line, "echo:Unknown")), (0, 0), "{:?}", line.said);
    }
}

#[test]
fn a_damaged_line_is_asked_for_again_and_not_carried_out() {
    let gcode = file();
    let manner = Manner { damaged: 2000, ..Manner::default() };
    let seen = serve(&firmware(), &gcode, Some(&questions()), manner, None);
    check(&seen, &gcode);
    let second = seen.second.as_ref().unwrap();
    println!("{} and {} commands sent again", seen.line.resends, second.resends);
    assert!(seen.line.resends > 10 && second.resends > 0);
}
