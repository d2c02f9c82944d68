//! Which pressure advance is in use, which decides how late all axes are.

use crate::motion::advance_window;
use crate::settings::Settings;
use crate::units::Seconds;

/// The window of the pressure advance that the generator follows, if it follows one. Once it does, that stays so: all
/// axes are as late as its window needs, and an advance of 0 is one like any other.
///
/// | settings change | motion that is under way |
/// |---|---|
/// | the first advance above 0 | rests, for all axes are later from then on |
/// | another window is asked for, or "auto" instead of a window | rests |
/// | "auto" needs a longer window, as the advance is greater | rests |
/// | "auto" could do with a shorter one | goes on; it is shorter from the next rest on at which taps are set |
///
/// So an advance that goes up and down from line to line stops the motion only when it has never been as great.
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
