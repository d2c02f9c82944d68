//! Whether pressure advance is in use, which decides how late all axes are.

use crate::settings::Settings;
use crate::units::Seconds;

/// Whether the generator follows a pressure advance. Once it does, that stays so: all axes are as late as its window
/// needs, and an advance of 0 is one like any other.
#[derive(Debug)]
pub(in crate::machine) struct AdvanceInUse(bool);

impl AdvanceInUse {
    pub const fn new() -> Self {
        Self(false)
    }

    /// The window that the generator is to follow with these settings, if any.
    pub fn window(&mut self, settings: &Settings) -> Option<Seconds> {
        self.0 |= settings.advance.time > Seconds::ZERO;
        self.0.then_some(settings.advance.window)
    }

    /// Whether motion must rest before `wanted` counts: its window is another, or it is the first advance.
    pub fn needs_rest(&self, settings: &Settings, wanted: &Settings) -> bool {
        let is_first = !self.0 && wanted.advance.time > Seconds::ZERO;
        is_first || wanted.advance.window != settings.advance.window
    }
}
