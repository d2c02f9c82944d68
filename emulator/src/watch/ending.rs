//! When a run is over, and why.

use super::{LOOK_NS, Watch};
use crate::board::Emulated;
use rigless::session::Session;

/// A run continues for this long after the host is done: 50 ms. A fan that is switched on then has turned its timer
/// round, and a whole sample shows it.
const LAST_NS: u64 = 50_000_000;

/// Why a run ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum End {
    /// The host was done.
    Done,
    /// The chip was reset.
    Reset,
    /// Neither a byte nor a step for this long, in ms.
    Stalled(u64),
    /// The power of the board went.
    PowerCut,
    /// Virtual time ran out.
    Late,
}

/// How long a run may take.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Virtual time in ns.
    pub whole: u64,
    /// Virtual time without a byte or a step, in ns.
    pub silent: u64,
    /// Virtual time to continue after a reset, in ns.
    pub after_reset: u64,
}

impl Watch {
    /// Whether the run is over at `at`.
    pub(super) fn look(&mut self, session: &mut Session<Emulated>, at: u64) -> bool {
        self.restore_supply(session, at);
        // A host outside is there for more than one start.
        let reset_at = session.resets().first().map(|r| r.at.0).filter(|_| self.terminal.is_none());
        let steps_at = self.recorder.events.last().map_or(0, |e| e.at);
        let board = session.board_mut();
        if board.eeprom().is_some_and(|eeprom| eeprom.is_cut())
            || board.mcu.flash.as_ref().is_some_and(|flash| flash.sectors.is_cut())
        {
            self.end = End::PowerCut;
            return true;
        }
        self.poke(session, at);
        let mut active = steps_at;
        let mut is_done = true;
        for line in session.board_mut().hosts() {
            self.greeted |= line.started.is_some();
            is_done &= line.is_done();
            active = active.max(line.active);
        }
        if let Some(network) = session.board_mut().network() {
            // The computer decides how long it takes.
            self.greeted |= network.was_attached();
            (is_done, active) = (network.is_over(), at);
        }
        if let Some(terminal) = &self.terminal {
            (is_done, active) = (terminal.is_over(), at);
        }
        if is_done && self.done.is_none() {
            self.done = Some(at);
        }
        self.end = match (reset_at, self.done) {
            (Some(reset), _) if at >= reset + self.patience.after_reset => End::Reset,
            (None, Some(done)) if at >= done + LAST_NS => End::Done,
            (None, None) if at >= active + self.patience.silent => End::Stalled((at - active) / LOOK_NS),
            _ if at >= self.patience.whole => End::Late,
            _ => return false,
        };
        true
    }
}
