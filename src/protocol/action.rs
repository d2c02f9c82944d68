//! Host actions: lines by which the printer tells its hosts what it has done, or asks them to do something.
//!
//! The form is Marlin's, `//action:` without a blank (Marlin, feature/host_actions.cpp), because a BTT TFT looks for
//! nothing else (Mainboard_AckHandler.c, `ack_starts_with("//action:")`). OctoPrint takes the line with and without one
//! (comm.py strips what follows the `//`). Printrun takes only what follows the first blank of a line, and only `pause`,
//! `resume`, `cancel` and `disconnect` (pronsole.py, `recvcb_actions`). So what asks for one of these says it twice in
//! its line, and each of the three acts on it once.

use core::fmt;

/// What every line of an action begins with.
pub const ACTION: &str = "//action:";

/// Characters of a question, and of an answer to it, for which a BTT TFT has room (`prompt_begin`, `prompt_button`).
const QUESTION: usize = 28;
const BUTTON: usize = 18;

/// A host action; displayed, it is the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action<'a> {
    /// Hosts shall pause their print, with what they do at a pause.
    Pause,
    /// The printer has paused by itself.
    Paused,
    /// The printer goes on by itself.
    Resumed,
    /// Hosts shall end their print.
    Cancel,
    /// A question to the user begins.
    PromptBegin(&'a str),
    /// An answer that the user may give.
    PromptButton(&'a str),
    /// The question is whole and shall be shown.
    PromptShow,
    /// The question is of no interest any more.
    PromptEnd,
}

impl fmt::Display for Action<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pause => write!(f, "{ACTION}pause action:pause"),
            Self::Paused => write!(f, "{ACTION}paused"),
            Self::Resumed => write!(f, "{ACTION}resumed"),
            Self::Cancel => write!(f, "{ACTION}cancel action:cancel"),
            Self::PromptBegin(text) => write!(f, "{ACTION}prompt_begin {text:.QUESTION$}"),
            Self::PromptButton(text) => write!(f, "{ACTION}prompt_button {text:.BUTTON$}"),
            Self::PromptShow => write!(f, "{ACTION}prompt_show"),
            Self::PromptEnd => write!(f, "{ACTION}prompt_end"),
        }
    }
}
