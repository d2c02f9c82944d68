//! Inputs for contacts: switches, probes, sensors with an output that switches.
//!
//! A machine says of each contact whether it opens or closes when it triggers. The connector says which level an open
//! contact has at the processor, and so which resistor the processor adds.

use crate::Pin;

/// An input connector of a board.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Input {
    /// Its pin.
    pub pin: Pin,
    /// The way from the connector to the pin.
    pub circuit: Circuit,
}

/// The way from a contact to a pin.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Circuit {
    /// A closed contact connects the pin to ground, an open one leaves it to a pull-up.
    Plain,
    /// A closed contact lights an optocoupler, which connects the pin to 3.3 V; an open one leaves it to a pull-down.
    /// With a pull-up the pin would be high for ever.
    Optocoupler,
}

impl Circuit {
    /// The pin's level while the contact is open: the processor pulls the pin there.
    #[must_use]
    pub const fn is_high_when_open(self) -> bool {
        matches!(self, Self::Plain)
    }

    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain, pull-up",
            Self::Optocoupler => "optocoupler, pull-down",
        }
    }
}

impl Input {
    /// An input with that circuit at pin `number` of a port.
    const fn new((port, number): (crate::Port, u8), circuit: Circuit) -> Self {
        Self { pin: Pin::new(port, number), circuit }
    }

    /// A plain input.
    #[must_use]
    pub const fn plain(port: crate::Port, number: u8) -> Self {
        Self::new((port, number), Circuit::Plain)
    }

    /// An input behind an optocoupler.
    #[must_use]
    pub const fn optocoupler(port: crate::Port, number: u8) -> Self {
        Self::new((port, number), Circuit::Optocoupler)
    }

    /// The input with a contact plugged in that closes when it triggers, or opens.
    #[must_use]
    pub const fn contact(self, is_normally_open: bool) -> Contact {
        Contact { input: self, is_normally_open }
    }
}

/// A contact at an input.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Contact {
    /// The input.
    pub input: Input,
    /// It closes when it triggers; otherwise it opens.
    pub is_normally_open: bool,
}

impl Contact {
    /// The pin's level when it has triggered.
    #[must_use]
    pub const fn is_high_when_triggered(self) -> bool {
        self.input.circuit.is_high_when_open() != self.is_normally_open
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Port;

    #[test]
    fn the_level_of_a_triggered_contact_follows_from_circuit_and_contact() {
        let (plain, behind) = (Input::plain(Port::G, 15), Input::optocoupler(Port::B, 7));
        for (input, is_normally_open, is_high) in
            [(plain, false, true), (plain, true, false), (behind, false, false), (behind, true, true)]
        {
            assert_eq!(input.contact(is_normally_open).is_high_when_triggered(), is_high, "{input:?}");
        }
        assert!(plain.circuit.is_high_when_open() && !behind.circuit.is_high_when_open());
    }
}
