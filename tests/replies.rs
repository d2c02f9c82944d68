//! The printer's replies: their words, and that they mean nothing else to any host.

use crate::actions::{Deed, btt_tft, octoprint, printrun};
use corehbot::fault::{Cause, Fault};
use corehbot::protocol::{Action, NoRoom, Replies, ResendReason};

/// As the replies have it.
const CAPACITY: usize = 1024;
const ECHOED: usize = 60;

/// Everything that waits, taken out in the pieces that [`Replies::pending`] gives.
fn drain(replies: &mut Replies) -> String {
    let mut text = String::new();
    while !replies.pending().is_empty() {
        text += std::str::from_utf8(replies.pending()).unwrap();
        replies.sent(replies.pending().len());
    }
    text
}

fn reply(write: impl FnOnce(&mut Replies) -> Result<(), NoRoom>) -> String {
    let mut replies = Replies::new();
    write(&mut replies).unwrap();
    drain(&mut replies)
}

#[test]
fn the_resend_dialogue() {
    assert_eq!(
        reply(|r| r.resend(ResendReason::LineNumber, 12)),
        "Error:Line Number is not Last Line Number+1, Last Line: 12\nResend: 13\nok\n"
    );
    assert_eq!(
        reply(|r| r.resend(ResendReason::ChecksumMismatch, -1)),
        "Error:checksum mismatch, Last Line: -1\nResend: 0\nok\n"
    );
    assert_eq!(
        reply(|r| r.resend(ResendReason::NoChecksum, i32::MAX)),
        "Error:No Checksum with line number, Last Line: 2147483647\nResend: 2147483648\nok\n"
    );
}

#[test]
fn an_unknown_command_is_echoed_without_teeth() {
    assert_eq!(reply(|r| r.unknown(b"G29 A")), "echo:Unknown command: \"G29 A\"\nok\n");
    let nasty = b"FOO T:21 \"\xFF\x00\nok";
    assert_eq!(reply(|r| r.unknown(b"G29\tA")), "echo:Unknown command: \"G29 A\"\nok\n");
    assert_eq!(reply(|r| r.unknown(nasty)), "echo:Unknown command: \"FOO T?21 ????ok\"\nok\n");
    assert_eq!(reply(|r| r.unknown(&[b'x'; 500])).matches('x').count(), ECHOED);
}

#[test]
fn only_text_without_control_characters_leaves() {
    assert_eq!(reply(|r| r.line(format_args!("a\nb\r\0\x7F{}~", "\u{fc}"))), "a?b???\u{fc}~\n");
}

#[test]
fn a_dialogue_that_does_not_fit_leaves_nothing() {
    for filled in 0..120 {
        let mut replies = Replies::new();
        let filling = "x".repeat(CAPACITY - 1 - filled);
        replies.line(format_args!("{filling}")).unwrap();
        let result = replies.resend(ResendReason::NoChecksum, 7);
        let dialogue = "Error:No Checksum with line number, Last Line: 7\nResend: 8\nok\n";
        let fits = dialogue.len() <= filled;
        assert_eq!(result, if fits { Ok(()) } else { Err(NoRoom) });
        let rest = drain(&mut replies);
        assert_eq!(&rest[filling.len() + 1..], if fits { dialogue } else { "" });
    }
}

#[test]
fn replies_that_are_held_take_nothing_and_are_not_sent() {
    let mut replies = Replies::new();
    replies.ok().unwrap();
    replies.hold(true);
    assert_eq!((replies.ok(), replies.room()), (Err(NoRoom), 0));
    assert_eq!((drain(&mut replies), replies.are_sent()), ("ok\n".into(), false));
    replies.hold(false);
    assert_eq!((replies.ok(), replies.room()), (Ok(()), CAPACITY - 3));
}

#[test]
fn lines_survive_the_end_of_the_ring() {
    let mut replies = Replies::new();
    for n in 0..500 {
        replies.line(format_args!("line {n} {}", "x".repeat(n))).unwrap();
        assert_eq!(drain(&mut replies), format!("line {n} {}\n", "x".repeat(n)));
    }
    assert_eq!(replies.room(), CAPACITY);
    replies.sent(5);
    replies.ok().unwrap();
    assert_eq!(replies.room(), CAPACITY - 3);
}

#[test]
fn every_answer_has_its_words() {
    assert_eq!(reply(Replies::ok), "ok\n");
    assert_eq!(reply(Replies::busy), "echo:busy: processing\n");
    assert_eq!(reply(Replies::paused), "echo:busy: paused for user\n");
    assert_eq!(reply(Replies::start), "start\n");
    assert_eq!(reply(Replies::too_long), "echo:Line too long, ignored\nok\n");
    assert_eq!(reply(Replies::killed), "Error:Printer halted. kill() called! Send M999 or reset\n");
    let killed_by = "Error:Printer halted. kill() called! (no steps) Send M999 or reset\n";
    assert_eq!(reply(|r| r.killed_by("no steps")), killed_by);
    let killed_after = "Error:too hot\nError:Printer halted. kill() called! Send M999 or reset\n";
    assert_eq!(reply(|r| r.killed_after("too hot")), killed_after);
    assert_eq!(reply(|r| r.question(12)), "Resend: 13\nok\n");
    assert_eq!(
        (reply(|r| r.line_number(Some(5))), reply(|r| r.line_number(None))),
        ("Line: 5\nok\n".into(), "ok\n".into())
    );
    // Marlin's lines have 96 bytes (Configuration_adv.h, MAX_CMD_SIZE).
    assert_eq!(reply(|r| r.advanced_ok(Some(7), 15, 96 * 10 + 95)), "ok N7 P15 B10\n");
    assert_eq!(reply(|r| r.advanced_ok(None, 0, 95)), "ok P0 B0\n");
}

/// Forbidden beginnings of a line, unless intended (printcore, OctoPrint comm.py).
const RESERVED_BEGINNINGS: [&str; 11] =
    ["ok", "start", "rs", "resend", "wait", "error", "fatal", "!!", "//", "debug_", "cap:"];

/// Words forbidden anywhere in a line (OctoPrint, Printrun, Cura); the last two for old versions of Cura.
const RESERVED_WORDS: [&str; 26] = [
    "X:",
    " T:",
    "T0:",
    " B:",
    "NAME:",
    "TargetExtr",
    "TargetBed",
    "Begin file list",
    "End file list",
    "File opened",
    "File selected",
    "Writing to file",
    "Done printing file",
    "Done saving file",
    "File deleted",
    "SD printing byte",
    "Not SD printing",
    "SD card ok",
    "SD init fail",
    "Invalid extruder",
    " Count ",
    "_min",
    "_max",
    "start",
    "ok",
    "rs",
];

#[test]
fn our_words_mean_nothing_else_to_any_host() {
    let fixed = [
        reply(|r| r.resend(ResendReason::LineNumber, 1)),
        reply(|r| r.resend(ResendReason::ChecksumMismatch, 1)),
        reply(|r| r.resend(ResendReason::NoChecksum, 1)),
        reply(|r| r.line_number(Some(5))),
        reply(Replies::too_long),
        reply(|r| r.question(1)),
        reply(|r| r.unknown(b"G29")),
        reply(Replies::busy),
        reply(Replies::paused),
        reply(Replies::killed),
        reply(Replies::start),
        reply(Replies::ok),
    ]
    .concat();
    let fixed = Cause::all().fold(fixed, |lines, cause| format!("{lines}{}\n", Fault::plain(cause)));
    let is_meant =
        |line: &str| ["ok", "start"].contains(&line) || line.starts_with("Resend: ") || line.starts_with("Error:");
    for line in fixed.lines() {
        if !is_meant(line) {
            let small = line.to_lowercase();
            assert!(!RESERVED_BEGINNINGS.iter().any(|word| small.starts_with(word)), "{line}");
        }
        if !["ok", "start"].contains(&line) {
            assert!(!RESERVED_WORDS.iter().any(|word| line.contains(word)), "{line}");
        }
    }
    // An error ends the print unless it has one of these words (OctoPrint comm.py) or must end it.
    for error in fixed.lines().filter(|line| line.starts_with("Error:")) {
        let small = error.to_lowercase();
        assert!(["line number", "checksum", "kill() called"].iter().any(|word| small.contains(word)));
        assert!(!small.contains("no line number with checksum"));
    }
}

#[test]
fn octoprint_printrun_and_a_btt_screen_act_on_every_action() {
    let long = "A question that is too long for the screen of a printer";
    // The line, what OctoPrint and the screen do, and what Printrun does.
    for (action, both, by_printrun) in [
        (Action::Pause, Some(Deed::Pause), Some(Deed::Pause)),
        (Action::Paused, Some(Deed::NotePaused), None),
        (Action::PausedAtOnce, Some(Deed::NotePaused), Some(Deed::Pause)),
        (Action::Resumed, Some(Deed::NoteResumed), None),
        (Action::Cancel, Some(Deed::Cancel), Some(Deed::Pause)),
        (Action::PromptBegin("Change the filament"), Some(Deed::Begin), None),
        (Action::PromptBegin(long), Some(Deed::Begin), None),
        (Action::PromptButton("Continue"), Some(Deed::Button), None),
        (Action::PromptButton(long), Some(Deed::Button), None),
        (Action::PromptShow, Some(Deed::Show), None),
    ] {
        let line = action.to_string();
        assert_eq!((octoprint(&line), btt_tft(&line), printrun(&line)), (both, both, by_printrun), "{line}");
        assert!(!line.contains("ok") && !line.contains("rs"), "{line}");
    }
    // A screen closes its question itself.
    let line = Action::PromptEnd.to_string();
    assert_eq!((octoprint(&line), btt_tft(&line), printrun(&line)), (Some(Deed::Close), None, None));
}

#[test]
fn an_error_has_words() {
    assert_eq!(NoRoom.to_string(), "no room for the reply");
}
