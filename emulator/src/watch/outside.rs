//! The world outside: a host at the terminal, and the hand of a person.

use super::Watch;
use crate::board::Emulated;
use corehbot_sim::user_actions::Act;
use rigless::emulator::{Host, Stop};
use rigless::session::Session;

impl Watch {
    /// Passes on what the host says and hears, and does what the hand does.
    pub(super) fn attend_outside(&mut self, session: &mut Session<Emulated>, host: &mut dyn Host, stop: &Stop) {
        let Some(terminal) = &mut self.terminal else { return };
        if let Some(line) = session.board_mut().hosts().next() {
            terminal.attend(line, stop.at.0, self.recorder.events.len());
        }
        for act in terminal.acts(stop.at.0) {
            match act {
                Act::Press(switches) => {
                    self.mechanics.held = switches;
                    self.press(session, stop.at);
                }
                Act::Warm(heater) => self.heat.hold(heater),
                Act::Reset => session.reset_by_pin(stop.at, stop.instruction_count, host),
                Act::Off => {}
            }
        }
    }
}
