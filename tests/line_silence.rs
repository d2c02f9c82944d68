//! Lines that are lost whole or lose their end, and fragments without a checksum.

use crate::support::machine::{Machine, PATIENCE_MS, numbered};
use corehbot::port::Received;
use corehbot::protocol::Activity;

/// A machine that has taken lines 1 to `last` of a stream.
fn streaming(last: i32) -> Machine {
    let mut machine = Machine::new();
    for number in 1..=last {
        assert_eq!(machine.say(numbered(number, "G1 X1")), "ok\n");
    }
    machine.commands.clear();
    machine
}

/// The machine's output during this much silence.
fn wait(machine: &mut Machine, ms: u32) -> String {
    for _ in 0..ms {
        machine.ms += 1;
        machine.answer_one();
    }
    machine.take_replies()
}

/// A machine that has lost bytes on its line before it took lines 1 to `last` of a stream.
fn streaming_badly(last: i32) -> Machine {
    let mut machine = Machine::new();
    assert!(machine.say("N1 G1 X1*1\n").starts_with("Error:checksum mismatch"));
    for number in 1..=last {
        assert_eq!(machine.say(numbered(number, "G1 X1")), "ok\n");
    }
    machine.commands.clear();
    machine
}

const QUESTION: &str = "Resend: 8\nok\n";
const MISMATCH: &str = "Error:checksum mismatch, Last Line: 7\nResend: 8\nok\n";

/// The host gets an `ok`, continues with the line after the lost one, and so shows that there was one.
#[test]
fn a_line_that_is_lost_whole_is_missed() {
    let mut machine = streaming(7);
    assert_eq!(wait(&mut machine, PATIENCE_MS - 1), "");
    assert_eq!(wait(&mut machine, 1), "ok\n");
    let missed = "Error:Line Number is not Last Line Number+1, Last Line: 7\nResend: 8\nok\n";
    assert_eq!(machine.say(numbered(9, "G1 X9")), missed);
    assert_eq!(machine.say(numbered(8, "G1 X8") + &numbered(9, "G1 X9")), "ok\nok\n");
    // From then on it is a line that loses something.
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "Resend: 10\nok\n");
    assert_eq!(machine.commands, ["G1 X8", "G1 X9"]);
}

#[test]
fn an_answer_that_is_lost_is_given_again() {
    let mut machine = streaming(7);
    assert_eq!(wait(&mut machine, PATIENCE_MS), "ok\n");
    assert_eq!(machine.say(numbered(8, "G1 X8")), "ok\n");
    assert_eq!(machine.commands, ["G1 X8"]);
}

#[test]
fn a_line_that_is_lost_whole_on_a_bad_line_is_asked_for() {
    let mut machine = streaming_badly(7);
    assert_eq!(wait(&mut machine, PATIENCE_MS - 1), "");
    assert_eq!(wait(&mut machine, 1), QUESTION);
    assert_eq!(machine.say(numbered(8, "G1 X8")), "ok\n");
    assert_eq!(machine.commands, ["G1 X8"]);
}

/// Pronsole sends nothing when it pauses, so it looks like a host that waits. It does not show an `ok`.
#[test]
fn whoever_pauses_on_a_good_line_is_asked_for_nothing() {
    for activity in [Activity::Moving, Activity::Resting] {
        let mut machine = streaming(7);
        machine.activity = activity;
        assert_eq!(wait(&mut machine, 600_000), "ok\n".repeat(8));
        assert_eq!(machine.say("M105\n".to_owned() + &numbered(8, "G1 X8")), "ok\nok\n");
    }
}

/// OctoPrint makes the printer wait for its motion, and then report its position.
#[test]
fn whoever_has_waited_for_the_motion_hears_nothing() {
    for mut machine in [streaming(5), streaming_badly(5)] {
        machine.activity = Activity::Waited;
        assert_eq!(machine.say(numbered(6, "M400") + &numbered(7, "M114")), "ok\nok\n");
        assert_eq!(wait(&mut machine, 600_000), "");
        machine.activity = Activity::Paused;
        assert_eq!(wait(&mut machine, 600_000), "");
    }
    // But printcore would wait for ever.
    let mut machine = Machine::new();
    machine.say("N-1 M110 N-1*125\n".to_owned() + &numbered(0, "G28"));
    machine.activity = Activity::Waited;
    assert_eq!(wait(&mut machine, 600_000), "ok\n".repeat(8));
    machine.activity = Activity::Paused;
    assert_eq!(machine.say(numbered(1, "M25")), "ok\n");
    assert_eq!(wait(&mut machine, 600_000), "");
}

#[test]
fn nobody_is_asked_for_lines_once_the_motion_has_ended() {
    let mut machine = streaming_badly(7);
    machine.activity = Activity::Resting;
    assert_eq!(wait(&mut machine, 600_000), "ok\n".repeat(8));
}

#[test]
fn eight_prompts_and_the_stream_is_over() {
    let mut machine = streaming_badly(7);
    assert_eq!(wait(&mut machine, 600_000), QUESTION.repeat(2) + &"ok\n".repeat(6));
    // Typed lines have no timeout now, and need no numbers.
    assert_eq!(machine.say("M1"), "");
    assert_eq!(wait(&mut machine, 10_000), "");
    assert_eq!(machine.say("05\n"), "ok\n");
    // The stream continues where it paused, and may lose lines again.
    assert_eq!(machine.say(numbered(8, "G1 X8") + &numbered(9, "G1 X9")), "ok\nok\n");
    assert_eq!(wait(&mut machine, 600_000), "Resend: 10\nok\n".repeat(2) + &"ok\n".repeat(6));
    assert_eq!(machine.commands, ["M105", "G1 X8", "G1 X9"]);
    // The eighth prompt may be the one that arrives, and the very next line be lost.
    assert_eq!(machine.say(numbered(10, "G1 X10")), "ok\n");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "Resend: 11\nok\n");
}

#[test]
fn nobody_else_is_asked() {
    for text in ["", "M105\n", "M105\nM105\nM105\n", "N1 M115*39\n", "M110 N5\nM114\n", "M1"] {
        let mut machine = Machine::new();
        machine.say(text);
        assert_eq!(wait(&mut machine, 60_000), "", "{text:?}");
    }
    // One numbered line is no stream, alone or between lines without numbers.
    for text in ["N1 G90*17\nM105\nN2 G91*19\nM105\n", "N0 M110 N0*125\nM21\n", "N0 M110 N0*125\nN1 M115*39\nM21\n"] {
        let mut machine = Machine::new();
        machine.say(text);
        assert_eq!(wait(&mut machine, 60_000), "", "{text:?}");
    }
    // M110 ends a stream, as printcore does after a print.
    let mut machine = streaming(7);
    machine.say("N-1 M110 N-1*125\n");
    assert_eq!(wait(&mut machine, 60_000), "");
}

/// The lines of OctoPrint 1.11.8 when it connects, and afterwards.
#[test]
fn an_octoprint_that_does_not_print_is_left_in_peace() {
    let mut machine = Machine::new();
    for before in ["", "after a print"] {
        for line in ["N0 M110 N0*125", "N0 M110 N0*125", "N0 M110 N0*125", "N1 M115*39", "M21", "M155 S2", "M154 S5"] {
            assert_eq!(machine.say(format!("{line}\n")), "ok\n");
            assert_eq!(wait(&mut machine, 20_000), "", "{line}, {before}");
        }
        for _ in 0..20 {
            assert_eq!(machine.say("M105\n"), "ok\n");
            assert_eq!(wait(&mut machine, 5000), "", "M105, {before}");
        }
        machine.say(numbered(0, "M110 N0") + &numbered(1, "G28") + &numbered(2, "G1 X1"));
    }
}

/// Pronterface polls while it prints: printcore has its unnumbered M105 between two lines of the stream.
#[test]
fn a_line_that_is_lost_after_an_unnumbered_one_is_missed() {
    let mut machine = streaming(7);
    for _ in 0..3 {
        assert_eq!(machine.say("M105\n"), "ok\n");
    }
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
    assert!(machine.say(numbered(9, "G1 X9")).ends_with(QUESTION));
    assert_eq!(machine.say(numbered(8, "G1 X8")), "ok\n");
    let mut machine = Machine::new();
    machine.say("N-1 M110 N-1*125\nM105\n");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
}

#[test]
fn the_first_line_of_a_print_may_be_lost_as_well() {
    let mut machine = Machine::new();
    machine.say("N-1 M110 N-1*125\n");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
    assert!(machine.say(numbered(1, "G1 X1")).ends_with("Resend: 0\nok\n"));
    assert_eq!(machine.say(numbered(0, "G28")), "ok\n");
}

#[test]
fn a_host_that_was_only_slow_hears_no_more_than_oks() {
    // The `ok` and line 8 cross, so line 9 follows at once; then two lines are under way, and both sides stay in step.
    let mut machine = streaming(7);
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
    assert_eq!(machine.say(numbered(8, "G1 X8") + &numbered(9, "G1 X9")), "ok\nok\n");
    // A question and line 10 cross, so it is sent twice.
    let mut machine = streaming_badly(9);
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "Resend: 10\nok\n");
    assert_eq!(machine.say(numbered(10, "G1 X10").repeat(2)), "ok\nok\n");
    assert_eq!(machine.say(numbered(11, "G1 X11")), "ok\n");
    assert_eq!(machine.commands, ["G1 X10", "G1 X11"]);
}

#[test]
fn a_numbered_line_without_an_end_is_asked_for() {
    let mut machine = streaming(7);
    assert_eq!(machine.say("N8 G1 X8*"), "");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), MISMATCH);
    assert_eq!(machine.say(numbered(8, "G1 X8")), "ok\n");
    // Also without its head, and without being in a stream.
    assert_eq!(machine.say("X8*99"), "");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), MISMATCH.replace('8', "9").replace('7', "8"));
    let mut machine = Machine::new();
    machine.say("N1 G1 X");
    assert!(wait(&mut machine, PATIENCE_MS + 1).ends_with("Resend: 1\nok\n"));
}

#[test]
fn a_whole_m110_without_an_end_is_taken() {
    let mut machine = streaming(7);
    assert_eq!(machine.say("N-1 M110 N-1*125"), "");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
    assert_eq!(machine.receiver.last_line(), -1);
    let mut machine = streaming(7);
    machine.say("N-1 M110 N-1*12");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), MISMATCH);
}

#[test]
fn a_damaged_line_without_an_end_is_asked_for_sooner() {
    let mut machine = streaming(7);
    machine.say("N8 G1");
    machine.feed(Received::Lost);
    assert_eq!(wait(&mut machine, 100), "");
    assert_eq!(wait(&mut machine, 1), MISMATCH);
    // The answer to that may be lost as well.
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), QUESTION);
}

#[test]
fn a_piece_between_two_false_line_ends_is_not_carried_out() {
    let missing = "Error:No Checksum with line number, Last Line: 7\nResend: 8\nok\n";
    let mut machine = streaming(7);
    assert_eq!(machine.say("N8\nG28\nX8 Y9*55\n"), missing);
    // A false line end and a star that came through as something else.
    assert_eq!(machine.say("N8\nM110 N2.34\n"), missing);
    // It may have been an intended line. Then its host is waiting now.
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), QUESTION);
    assert_eq!(machine.say(numbered(8, "G1 X8")), "ok\n");
    assert_eq!(machine.say("M105\n"), "ok\n", "all is well again");
    assert_eq!(machine.commands, ["G1 X8", "M105"]);
}

#[test]
fn a_piece_of_a_line_number_is_damage() {
    for (piece, outside) in
        [("N\n", "ok\n"), ("8\n", "ok\n"), ("-\n", "ok\n"), ("\u{1}\n", "ok\n"), ("n x\n", "ok\n"), ("\u{7f}\n", "")]
    {
        let mut machine = streaming(7);
        assert_eq!(machine.say(format!("{piece}G28\n")), MISMATCH, "{piece}");
        assert_eq!(Machine::new().say(piece), outside, "outside of a stream it is only unknown, or was erased");
    }
}

#[test]
fn nothing_is_doubted_for_long_nor_outside_a_stream() {
    let mut machine = streaming(7);
    assert_eq!(machine.say("N8 G1 X8*1\n"), MISMATCH);
    machine.ms += 1000;
    assert_eq!(machine.say("G28\n"), "ok\n");
    let mut machine = Machine::new();
    machine.say("N1 G1 X8*1\n");
    assert_eq!(machine.say("G28\n"), "ok\n");
}

#[test]
fn an_emergency_is_never_doubted() {
    for code in ["M112\n", "M108\n", "M410\n"] {
        let mut machine = streaming(7);
        assert_eq!(machine.say("N8 G1 X8*1\n"), MISMATCH);
        assert_eq!(machine.say(code), "ok\n");
        assert_eq!((machine.emergencies.len(), machine.commands.len()), (1, 1));
    }
}

#[test]
fn whoever_comes_after_a_host_that_vanished_in_a_line_is_heard() {
    let mut machine = streaming(7);
    assert_eq!(machine.say("N8 G1 X"), "");
    assert_eq!(wait(&mut machine, 600_000), MISMATCH.to_owned() + &QUESTION.repeat(2) + &"ok\n".repeat(6));
    assert_eq!(machine.say("N0 M110 N0*125\nN1 M115*39\n"), "ok\nok\n");
    assert_eq!(machine.commands, ["M115"]);
}

#[test]
fn at_the_end_of_the_numbers_only_m110_helps() {
    let mut machine = Machine::new();
    machine.say(format!("M110 N{}\n", i32::MAX - 2));
    machine.say(numbered(i32::MAX - 1, "G1 X1") + &numbered(i32::MAX, "G1 X2"));
    let asked = "Resend: 2147483648\nok\n";
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
    assert!(machine.say("N2147483648 G1 X3*1\n").ends_with(asked));
    assert_eq!(wait(&mut machine, PATIENCE_MS * 2 + 1), asked);
    assert_eq!(machine.say(numbered(0, "M110 N0") + &numbered(1, "G1 X3")), "ok\nok\n");
    assert_eq!(machine.commands, ["G1 X1", "G1 X2", "G1 X3"]);
}

/// Blanks are no line; a comment may have been a line with an N that arrived as a semicolon.
#[test]
fn a_stream_that_pauses_after_blanks_has_lost_nothing() {
    let mut machine = streaming(7);
    assert_eq!(machine.say(" \t"), "");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
    let mut machine = streaming(7);
    assert_eq!(machine.say(";8 G1 X8"), "");
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), MISMATCH);
}

#[test]
fn a_host_that_hears_answers_is_not_in_silence() {
    let mut machine = streaming(7);
    for _ in 0..3 {
        assert_eq!(wait(&mut machine, PATIENCE_MS - 1), "");
        machine.receiver.hold_silence();
    }
    assert_eq!(wait(&mut machine, PATIENCE_MS + 1), "ok\n");
}

/// It sends the question by itself after a while.
#[test]
fn an_octoprint_that_has_waited_for_the_motion_hears_nothing() {
    let mut machine = Machine::new();
    machine.say("N0 M110 N0*125\n".to_owned() + &numbered(1, "G28") + &numbered(2, "M400"));
    machine.activity = Activity::Waited;
    assert_eq!(wait(&mut machine, 600_000), "");
}
