//! Pin states that must never happen, whatever the firmware does.

use crate::board::Port;
use crate::wiring::{PORTS, Wiring};
use corehbot::connectors::{Output, OutputSet};
use corehbot::motors::MotorSet;

/// Why a pin was not safe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Danger {
    /// An output was driven high, or is to be by a timer, or was handed to another peripheral, with no heater fitted on
    /// it.
    HeaterLive(Output),
    /// A motor got power before the firmware had greeted its host.
    PoweredBeforeStart(MotorSet),
}

/// Watches enable lines and heaters.
#[derive(Debug)]
pub struct Safety {
    wiring: &'static Wiring,
    /// Motors that have power.
    pub powered: MotorSet,
    /// Dangers and their times in ns.
    pub dangers: Vec<(u64, Danger)>,
    /// When motors got or lost power, in ns.
    pub switched: Vec<(u64, MotorSet)>,
    masks: [u16; PORTS],
    heaters: [u16; PORTS],
    /// Outputs that may heat.
    fitted: OutputSet,
    hot: [u16; PORTS],
}

impl Safety {
    /// A watch over the pins of `wiring`, all of them undriven; only the outputs of `fitted` may heat.
    #[must_use]
    pub fn new(wiring: &'static Wiring, fitted: OutputSet) -> Self {
        let (mut masks, mut heaters) = ([0; PORTS], [0; PORTS]);
        for slot in wiring.slots.iter().flatten() {
            masks[slot.enable.port] |= slot.enable.mask();
        }
        for &(_, load) in wiring.heaters {
            heaters[load.pin.port] |= load.pin.mask();
        }
        Self {
            wiring,
            powered: MotorSet::NONE,
            dangers: Vec::new(),
            switched: Vec::new(),
            masks,
            heaters,
            fitted,
            hot: [0; PORTS],
        }
    }

    /// Port `n` changed at `at`; `greeted` is whether the firmware has said that it is there.
    pub fn store(&mut self, at: u64, n: usize, port: Port, greeted: bool) {
        let hot = (port.high() | port.live) & self.heaters[n];
        let new = hot & !self.hot[n];
        self.hot[n] = hot;
        if new != 0 {
            for &(output, load) in self.wiring.heaters {
                let is_new = load.pin.port == n && new & load.pin.mask() != 0;
                if is_new && !(greeted && self.fitted.has(output)) {
                    self.dangers.push((at, Danger::HeaterLive(output)));
                }
            }
        }
        if self.masks[n] == 0 {
            return;
        }
        let mut powered = self.powered;
        for slot in self.wiring.slots.iter().flatten() {
            if slot.enable.port == n {
                let one = MotorSet::of(slot.motor);
                powered = powered.without(one);
                // A pull-up on the board keeps an undriven driver off.
                if port.low() & slot.enable.mask() != 0 {
                    powered = powered.with(one);
                }
            }
        }
        if powered != self.powered {
            let more = powered.without(self.powered);
            if !(more.is_empty() || greeted) {
                self.dangers.push((at, Danger::PoweredBeforeStart(more)));
            }
            self.powered = powered;
            self.switched.push((at, powered));
        }
    }

    /// The chip was reset at `at`: every pin is an input again.
    pub fn reset(&mut self, at: u64) {
        self.hot = [0; PORTS];
        if !self.powered.is_empty() {
            self.powered = MotorSet::NONE;
            self.switched.push((at, MotorSet::NONE));
        }
    }

    /// Motors with power, and since when, in ns.
    #[must_use]
    pub fn supplied(&self) -> (MotorSet, u64) {
        (self.powered, self.switched.last().map_or(0, |(at, _)| *at))
    }

    /// Heaters that are driven high now, or may be.
    #[must_use]
    pub fn is_hot(&self) -> bool {
        self.hot.iter().any(|&pins| pins != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wiring::OCTOPUS;
    use corehbot::motors::prototype;

    #[test]
    fn a_heater_on_a_timer_with_a_pulse_is_live() {
        let mut safety = Safety::new(&OCTOPUS, OutputSet::NONE);
        safety.store(5, 0, Port { outputs: 1 << 1, ..Port::default() }, true);
        safety.store(5, 0, Port { alternate: 1 << 1, ..Port::default() }, true);
        assert!(safety.dangers.is_empty());
        safety.store(6, 0, Port { alternate: 1 << 1, live: 1 << 1, ..Port::default() }, true);
        assert_eq!(safety.dangers, [(6, Danger::HeaterLive(Output::Bed))]);
        assert!(safety.is_hot());
    }

    #[test]
    fn a_heater_that_is_fitted_is_a_danger_before_the_greeting_only() {
        let live = Port { alternate: 1 << 2, live: 1 << 2, ..Port::default() };
        for (greeted, dangers) in [(false, 1), (true, 0)] {
            let mut safety = Safety::new(&OCTOPUS, OutputSet::NONE.with(Output::He0));
            safety.store(5, 0, live, greeted);
            assert_eq!((safety.dangers.len(), safety.is_hot()), (dangers, true));
        }
    }

    #[test]
    fn an_enable_line_is_active_only_if_it_is_driven_low() {
        let mut safety = Safety::new(&OCTOPUS, OutputSet::NONE);
        safety.store(1, 5, Port::default(), false);
        assert!(safety.powered.is_empty());
        safety.store(2, 5, Port { outputs: 1 << 14, ..Port::default() }, false);
        assert_eq!(safety.powered, MotorSet::of(prototype::M1));
        assert_eq!(safety.dangers, [(2, Danger::PoweredBeforeStart(MotorSet::of(prototype::M1)))]);
        safety.reset(9);
        assert!(safety.powered.is_empty());
    }
}
