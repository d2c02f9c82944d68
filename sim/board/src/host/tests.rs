//! Tests of host.

use super::*;
use corehbot::protocol::BUSY;

fn sent(host: &mut FileHost) -> String {
    let mut out = Vec::new();
    host.send(&mut out);
    String::from_utf8(out).unwrap()
}

#[test]
fn lines_are_numbered_checked_and_sent_one_by_one() {
    let mut host = FileHost::new("; a comment\n\nG28 ; home\n G1 X5 (to the right) Y2\n");
    assert_eq!((host.lines(), host.commands()), (4, 2));
    assert_eq!(sent(&mut host), "N-1 M110 N-1*125\n");
    assert_eq!(sent(&mut host), "");
    host.hear(BUSY);
    host.hear("ok");
    assert_eq!(sent(&mut host), "N0 G28*19\n");
    host.hear("ok");
    assert!(sent(&mut host).starts_with("N1 G1 X5  Y2*"));
    host.hear("ok T:20.0 /0.0");
    assert!(sent(&mut host).starts_with("N2 M400*"));
    assert!(!host.is_done());
    host.hear("ok");
    assert!(host.is_done() && host.failure().is_none() && host.warnings().is_empty());
    assert_eq!(host.answered(), 2);
}

#[test]
fn numbers_and_checksums_of_a_file_are_verified_and_stay_at_home() {
    let mut host = FileHost::new("N0 M110 N0*125\nN1 G28*18\nN2 G1 X5*103 ; right\nN3 G1 Y5\nN4 G1 X6*1\nG1 X7\n");
    assert_eq!(host.commands(), 5);
    for expected in ["N-1 M110", "N0 G28*", "N1 G1 X5*", "N2 G1 Y5*"] {
        let line = sent(&mut host);
        assert!(line.starts_with(expected), "{line}");
        host.hear("ok");
    }
    assert_eq!(sent(&mut host), "");
    let failure = host.failure().unwrap();
    assert_eq!((failure.line, failure.command.as_str()), (5, "G1 X6"));
    assert_eq!(command_of("NOZZLE*5"), ("NOZZLE*5".into(), false));
}

#[test]
fn a_resend_goes_back_and_is_no_failure() {
    let mut host = FileHost::new("G28\nG1 X5\n");
    for _ in 0..3 {
        let _ = sent(&mut host);
        host.hear("ok");
    }
    let _ = sent(&mut host);
    host.hear("Error:checksum mismatch, Last Line: 0");
    host.hear("Resend: 1");
    assert_eq!(sent(&mut host), "");
    host.hear("ok");
    assert!(sent(&mut host).starts_with("N1 G1 X5*"));
    assert_eq!((host.resends(), host.failure()), (1, None));
}

#[test]
fn a_question_for_what_comes_next_is_no_resend() {
    let mut host = FileHost::new("G28\n");
    while !host.is_done() {
        let _ = sent(&mut host);
        host.hear("ok");
    }
    host.hear("Error:checksum mismatch, Last Line: 1");
    host.hear("Resend: 2");
    host.hear("ok");
    assert_eq!((host.resends(), host.failure()), (0, None));
    assert!(host.is_done());
}

#[test]
fn a_printer_that_asks_for_ever_is_given_up() {
    let mut host = FileHost::new("G28\n");
    for _ in 0..20 {
        let _ = sent(&mut host);
        host.hear("Resend: -1");
        host.hear("ok");
    }
    assert!(host.is_done() && host.failure().is_some());
}

#[test]
fn odd_replies_name_the_line_and_errors_end_the_print() {
    let mut host = FileHost::new("\n\nM9999\nG1 X1\n");
    for reply in ["", "echo:Unknown command: \"M9999\"", "Error:Printer halted. kill() called!"] {
        let _ = sent(&mut host);
        host.hear(reply);
        host.hear("ok");
    }
    assert_eq!(host.warnings()[0].to_string(), "3: M9999: echo:Unknown command: \"M9999\"");
    assert_eq!(host.failure().unwrap().line, 4);
    assert!(host.is_done());
}

/// Reproducer: what the printer said of a sweep was left out.
#[test]
fn answers_are_kept_by_the_command_that_asked() {
    let mut host = FileHost::new("M119\nG28\nTEST_RESONANCES AXIS=X\n");
    host.hear("start");
    host.hear("echo:corehbot 0.1.0");
    for replies in [
        &[][..],
        &["Reporting endstop status", "x_min: open"],
        &["echo:busy: processing", " T:20.00 /0.00 B:20.00 /0.00 @:0 B@:0"],
        &["echo:swept X", "resonance X 48.6 Hz"],
    ] {
        let _ = sent(&mut host);
        replies.iter().for_each(|reply| host.hear(reply));
        host.hear("ok");
    }
    let found: Vec<_> = host.answers().iter().map(|answer| (answer.line, answer.command.as_str())).collect();
    assert_eq!(found, [(1, "M119"), (3, "TEST_RESONANCES AXIS=X")]);
    assert_eq!(host.answers()[1].replies, ["echo:swept X", "resonance X 48.6 Hz"]);
    assert_eq!((host.answers_total(), host.warnings_total()), (2, 0));
}

#[test]
fn a_user_who_is_not_there_answers_after_a_while() {
    let mut host = FileHost::new("M600 ; change\nM0 S60\nG28\n");
    let interjected = |host: &mut FileHost, seconds: u64| {
        let mut out = Vec::new();
        host.clock(seconds * u64::from(TICKS_PER_SECOND));
        host.interject(&mut out);
        String::from_utf8(out).unwrap()
    };
    let _ = sent(&mut host);
    host.hear("ok");
    assert!(sent(&mut host).starts_with("N0 M600"));
    interjected(&mut host, 100);
    host.hear("//action:prompt_show");
    assert_eq!(interjected(&mut host, 104), "");
    assert_eq!(interjected(&mut host, 105), "M108\n");
    assert_eq!(interjected(&mut host, 300), "");
    host.hear("//action:prompt_end");
    host.hear("ok");
    assert_eq!(sent(&mut host), "", "the answer to M108 is still to come");
    host.hear("ok");
    assert!(sent(&mut host).starts_with("N1 M0 S60"));
    host.hear("//action:prompt_show");
    assert_eq!(interjected(&mut host, 359), "", "this wait has an end");
    host.hear("//action:prompt_end");
    host.hear("ok");
    assert_eq!(host.pauses_total(), 1);
    assert_eq!(host.pauses()[0].to_string(), "1: M600: went on by itself after 5 s (M108)");
}

#[test]
fn only_the_last_commands_are_kept() {
    let mut host = FileHost::new(&"G1 X5\n".repeat(5000));
    for _ in 0..4000 {
        let _ = sent(&mut host);
        host.hear("ok");
    }
    assert!(host.recent.len() <= RECENT);
    host.hear("Resend: 3990");
    host.hear("ok");
    assert!(sent(&mut host).starts_with("N3990 G1 X5*"));
    host.hear("Resend: 17");
    host.hear("ok");
    assert_eq!(sent(&mut host), "");
    assert!(host.is_done() && host.failure().is_some_and(|why| why.reply.contains("long ago")));
}

#[test]
fn words_are_letters_with_numbers() {
    let words: Vec<_> = words("g1x-.5 Y2 F").collect();
    assert_eq!(words, [('G', Some(1.0)), ('X', Some(-0.5)), ('Y', Some(2.0)), ('F', None)]);
}

#[test]
fn waits_for_heat_last_from_the_command_to_its_answer() {
    let mut host = FileHost::new("M140 S60\nM190 S60\nG1 X5\nM109 S200\n");
    for tick in [10, 20, 30, 40, 50] {
        host.clock(tick);
        sent(&mut host);
        host.clock(tick + 7);
        host.hear("echo:busy: processing");
        host.hear("ok");
    }
    let waits: Vec<_> = host.heat_waits().iter().map(|wait| (wait.command.as_str(), wait.time)).collect();
    assert_eq!(waits, [("M190 S60", [30, 37]), ("M109 S200", [50, 57])]);
}

#[test]
fn a_print_that_the_printer_ends_failed_for_what_it_said_before() {
    let end = |lines: &[&str]| {
        let mut host = FileHost::new("G28\nG1 X5\n");
        sent(&mut host);
        host.hear("echo:no such servo");
        host.hear("ok");
        let line = sent(&mut host);
        assert!(line.starts_with("N0 G28*"), "{line}");
        lines.iter().for_each(|line| host.hear(line));
        host.hear("ok");
        assert!(host.is_done());
        host.failure().unwrap().clone()
    };
    let why = "print ended, heaters are off: homing failed: Y endstop was not met within 10 mm. Check its switch";
    let failure = end(&[&format!("echo:{why}"), "//action:cancel action:cancel"]);
    assert_eq!((failure.line, failure.reply.as_str()), (1, why));
    // The words to another command are not the reason.
    assert_eq!(end(&["//action:cancel action:cancel"]).reply, "the printer has ended the print");
}
