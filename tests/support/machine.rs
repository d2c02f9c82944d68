//! A machine that uses the protocol and carries nothing out.

use corehbot::port::Received;
use corehbot::protocol::{Activity, Emergency, Incoming, Receiver, Replies};
use corehbot::settings::Settings;
use corehbot::units::Instant;

/// As the prototype has it.
pub const PATIENCE_MS: u32 = Settings::prototype().patience_ms as u32;

// From the last prompt but one to the last it is 16 times as long, and OctoPrint gives up after 30 s
// (docs/reference/host-protocol/resends.md).
const _: () = assert!(16 * PATIENCE_MS < 30_000);

/// A machine that takes every command and answers as the protocol wants it.
pub struct Machine {
    pub receiver: Receiver,
    replies: Replies,
    pub commands: Vec<String>,
    pub emergencies: Vec<Emergency>,
    pub ms: u32,
    /// Its activity, for the host's silence.
    pub activity: Activity,
}

impl Machine {
    pub fn new() -> Self {
        Self {
            receiver: Receiver::new(),
            replies: Replies::new(),
            commands: Vec::new(),
            emergencies: Vec::new(),
            ms: 0,
            activity: Activity::Moving,
        }
    }

    pub fn feed(&mut self, received: Received) {
        self.emergencies.extend(self.receiver.feed(received));
    }

    /// Takes one line and answers it; false if there is none.
    pub fn answer_one(&mut self) -> bool {
        let now = Instant(0).after_ms(self.ms);
        let mut incoming = self.receiver.next_line(now);
        if incoming.is_none() {
            let activity = self.activity;
            incoming = self.receiver.break_silence(now, PATIENCE_MS, || activity);
        }
        match incoming {
            None => return false,
            Some(Incoming::Command(text)) => {
                assert!(!text.is_empty());
                assert!(![text.first(), text.last()].iter().any(|end| matches!(end, Some(b' ' | b'\t'))));
                self.commands.push(String::from_utf8_lossy(text).into_owned());
                self.replies.ok()
            }
            Some(Incoming::Acknowledge) => self.replies.ok(),
            Some(Incoming::LineNumber { report }) => self.replies.line_number(report),
            Some(Incoming::TooLong) => self.replies.too_long(),
            Some(Incoming::Resend { reason, last }) => self.replies.resend(reason, last),
            Some(Incoming::Question { last }) => self.replies.question(last),
        }
        .unwrap();
        true
    }

    pub fn take_replies(&mut self) -> String {
        let mut text = String::new();
        while !self.replies.pending().is_empty() {
            let pending = self.replies.pending();
            text += std::str::from_utf8(pending).unwrap();
            let length = pending.len();
            self.replies.sent(length);
        }
        text
    }

    /// Sends text and returns the answers.
    pub fn say(&mut self, text: impl AsRef<[u8]>) -> String {
        let mut answers = String::new();
        for &byte in text.as_ref() {
            self.feed(Received::Byte(byte));
            while self.answer_one() {
                answers += &self.take_replies();
            }
        }
        answers
    }
}

/// A numbered line with its checksum, as hosts write it.
pub fn numbered(number: i32, text: &str) -> String {
    let body = format!("N{number} {text}");
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{body}*{sum}\n")
}
