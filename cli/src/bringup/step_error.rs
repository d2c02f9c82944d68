//! Step error: why a step could not be carried to its end.

use std::fmt;

/// Why a step could not be carried to its end.
#[derive(Debug)]
pub(super) enum StepError {
    /// Ctrl-C.
    Stopped,
    /// The owner wants to go on later, or the input has ended.
    Left,
    /// The board is not one to go on with.
    Unfit(String),
    /// The port is gone, or nothing answers.
    Lost(String),
    /// The firmware has stopped everything and waits for M999; its words.
    Halted(String),
    /// The board has greeted in mid-answer; the reason that it gave.
    Restarted(String),
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => f.write_str("stopped by Ctrl-C"),
            Self::Left => f.write_str("left by the owner"),
            Self::Unfit(why) => f.write_str(why),
            Self::Lost(why) => write!(f, "the board does not answer any more: {why}"),
            Self::Halted(why) => write!(f, "the firmware has stopped: {why}"),
            Self::Restarted(why) => write!(f, "the board has restarted: {why}"),
        }
    }
}

impl From<anyhow::Error> for StepError {
    fn from(error: anyhow::Error) -> Self {
        Self::Lost(format!("{error:#}"))
    }
}
