//! The pressure advance in use, which decides the delay of all axes.

use crate::motion::advance_window;
use crate::settings::Settings;
use crate::units::Seconds;

/// The window of the pressure advance that the generator follows, if it follows one. Once it does, that stays so: all
/// axes are delayed as its window needs, and an advance of 0 is treated as any other.
///
/// | change of settings | motion under way |
/// |---|---|
/// | the first advance above 0 | rests, because all axes are delayed from then on |
/// | another window, or "auto" instead of a window | rests |
/// | "auto" needs a longer window, as the advance is greater | rests |
/// | a shorter window is enough for "auto" | continues; the window is shorter from the next rest that sets taps |
///
/// So an advance that rises and falls from line to line stops the motion only when it reaches a new maximum.
#[derive(Debug)]
pub(in crate::machine) struct AdvanceInUse(Option<Seconds>);

impl AdvanceInUse {
    pub const fn new() -> Self {
        Self(None)
    }

    /// The window that the generator follows, if any.
    pub const fn window(&self) -> Option<Seconds> {
        self.0
    }

    /// The window that the generator follows from now on with these settings, if any.
    pub fn follow(&mut self, settings: &Settings) -> Option<Seconds> {
        if self.0.is_some() || settings.advance.time > Seconds::ZERO {
            self.0 = Some(advance_window(settings));
        }
        self.0
    }

    /// Whether motion must rest before the advance of `wanted` counts.
    pub fn needs_rest(&self, settings: &Settings, wanted: &Settings) -> bool {
        let is_another = wanted.advance.window != settings.advance.window;
        match self.0 {
            None => is_another || wanted.advance.time > Seconds::ZERO,
            Some(window) => is_another || (wanted.advance != settings.advance && advance_window(wanted) > window),
        }
    }
}
