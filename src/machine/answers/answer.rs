//! Answers: the result of a command, as a value.
//!
//! A command returns its answer; `main_loop::reply` writes it, and the Console then sends the `ok`. The words of an
//! answer stand in the file of the command, or of the room that decides it. There is no variant for each: a command
//! tells at once what it has to say (`MainLoop::say` and `tell`), in room that is kept for that, and the answer is
//! [`Said`](Answer::Said). What may be long waits for room: [`Words`] that the command returns, or gives
//! to `MainLoop::reply`. An `echo:` that is no trouble also goes into `EXPECTED` of `sim/board/src/host.rs`, or
//! `corehbot run` warns of it.

use super::reply_writer::ReplyWriter;
use super::words::{Facts, Words};
use crate::protocol::ResendReason;
use crate::text::Packed;

/// An answer.
#[derive(Clone, Copy)]
pub(in crate::machine) enum Answer<'a> {
    /// Nothing except the `ok`.
    Nothing,
    /// The command has told it already. Nothing is left except the `ok`.
    Said,
    /// The `ok` that ends an answer, unless it stands in the answer itself (`has_ok`).
    Ok,
    /// M110, with the line number that it requested.
    LineNumber(Option<i32>),
    TooLong,
    /// Nothing, and no `ok` for now: the line is held.
    Held,
    /// To a silent host: asks for the line after this one.
    Question(i32),
    Resend(ResendReason, i32),
    Unknown(&'a [u8]),
    /// A command, and the name of a word of it that is not supported.
    NotObeyed(&'static str, &'a [u8]),
    /// A move that must not be made before G28.
    NotHomed,
    /// A line that is always the same.
    Line(Packed),
    /// Lines that wait for room.
    Words(&'a dyn Words),
    /// The same, with the `ok` in them.
    WordsWithOk(&'a dyn Words),
}

impl<'a> Answer<'a> {
    /// Lines that wait for room, from a function, or from a closure that the command keeps until they are written.
    pub const fn words<F: Fn(&mut ReplyWriter<'_>, &Facts<'_>)>(words: &'a F) -> Self {
        Self::Words(words)
    }

    /// The same, with the `ok` in them.
    pub const fn words_with_ok<F: Fn(&mut ReplyWriter<'_>, &Facts<'_>)>(words: &'a F) -> Self {
        Self::WordsWithOk(words)
    }

    /// Whether the `ok` is part of it.
    pub const fn has_ok(&self) -> bool {
        matches!(
            self,
            Self::Ok
                | Self::LineNumber(_)
                | Self::TooLong
                | Self::Question(_)
                | Self::Resend(..)
                | Self::Unknown(_)
                | Self::WordsWithOk(_)
        )
    }
}
