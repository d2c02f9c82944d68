//! The servo's line: the pulses that the firmware makes on it, measured edge by edge.

use crate::board::Port;
use crate::wiring::Pin;

/// A pause from which on the next pulse is another order's, in ns.
const PAUSE_NS: u64 = 40_000_000;

/// A pulse.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pulse {
    /// When it began, in ns.
    pub at: u64,
    /// Its length in ns.
    pub ns: u64,
}

/// The line, if the board has one.
#[derive(Clone, Default, Debug)]
pub struct ServoLine {
    pin: Option<Pin>,
    /// Since when it is high.
    risen: Option<u64>,
    /// The pulses so far.
    pub pulses: Vec<Pulse>,
    /// Whether the line is driven.
    pub is_driven: bool,
}

impl ServoLine {
    /// A line that was never driven.
    #[must_use]
    pub fn new(pin: Option<Pin>) -> Self {
        Self { pin, ..Self::default() }
    }

    /// Port `n` changed at `at`, in ns. Returns when the first pulse of an order began, and its length in us.
    pub fn store(&mut self, at: u64, n: usize, port: Port) -> Option<(u64, u16)> {
        let mask = self.pin.filter(|pin| pin.port == n)?.mask();
        self.is_driven |= port.outputs & mask != 0;
        let is_high = port.high() & mask != 0;
        match (self.risen, is_high) {
            (None, true) => self.risen = Some(at),
            (Some(risen), false) => {
                self.risen = None;
                let pulse = Pulse { at: risen, ns: at - risen };
                let last = self.pulses.last().copied();
                self.pulses.push(pulse);
                let micros = |pulse: Pulse| ((pulse.ns + 500) / 1000) as u16;
                let goes_on = |last: Pulse| risen < last.at + PAUSE_NS && micros(last).abs_diff(micros(pulse)) < 40;
                return (!last.is_some_and(goes_on)).then(|| (risen, micros(pulse)));
            }
            _ => {}
        }
        None
    }
}
