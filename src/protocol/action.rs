//! Host actions: lines that tell hosts about an action of the printer, or ask them for one.
//!
//! The form is Marlin's, `//action:` without a blank (Marlin, feature/host_actions.cpp), because a BTT TFT accepts no
//! other (Mainboard_AckHandler.c, `ack_starts_with("//action:")`). OctoPrint accepts the line with and without a blank
//! (comm.py strips the text that follows the `//`). Printrun reads only the text after the first blank of a line, and
//! only `pause`, `resume`, `cancel` and `disconnect` (pronsole.py, `recvcb_actions`). So a line that asks for one of
//! these contains it twice, and each of the three hosts acts on it once. M25 is such a line: it has its `ok`, and
//! Printrun would send on. Printrun does not read `paused`, so the word for it is `pause`.

use core::fmt;

/// Prefix of every action line.
pub const ACTION: &str = "//action:";

/// Length of a question, and of an answer, that a BTT TFT can show (`prompt_begin`, `prompt_button`).
const QUESTION: usize = 28;
const BUTTON: usize = 18;

/// A host action; its `Display` is the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action<'a> {
    /// Hosts shall pause their print, with their own pause scripts.
    Pause,
    /// The printer has paused by itself, and waits before it sends its `ok`.
    Paused,
    /// The printer has paused by itself, and hosts shall send nothing more of the print.
    PausedAtOnce,
    /// The printer continues by itself.
    Resumed,
    /// Hosts shall end their print.
    Cancel,
    /// A question to the user begins.
    PromptBegin(&'a str),
    /// An answer that the user may give.
    PromptButton(&'a str),
    /// The question is complete and shall be shown.
    PromptShow,
    /// The question is withdrawn.
    PromptEnd,
}

impl fmt::Display for Action<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pause => put!(f, "{ACTION}pause action:pause"),
            Self::Paused => put!(f, "{ACTION}paused"),
            Self::PausedAtOnce => put!(f, "{ACTION}paused action:pause"),
            Self::Resumed => put!(f, "{ACTION}resumed"),
            Self::Cancel => put!(f, "{ACTION}cancel action:cancel"),
            Self::PromptBegin(text) => put!(f, "{ACTION}prompt_begin {text:.QUESTION$}"),
            Self::PromptButton(text) => put!(f, "{ACTION}prompt_button {text:.BUTTON$}"),
            Self::PromptShow => put!(f, "{ACTION}prompt_show"),
            Self::PromptEnd => put!(f, "{ACTION}prompt_end"),
        }
    }
}
