//! Port writes: a table of the values to store to the ports' set/reset registers (BSRR) for each set of motor groups.

use crate::{Pin, Port};
use corehbot::kinematics::SETS;
use corehbot::motors::{Coupling, MOST_GROUPS, MOTORS};
use corehbot::port::{GroupSet, MotorSet};

/// Ports that the step pins of all motors may be spread over.
pub const STEP_PORTS: usize = 4;

/// Ports that the direction pins of all motors may be spread over: on the Octopus, with its eighth socket, five.
pub const DIR_PORTS: usize = 5;

/// Ports that a quick step is stored to, the first of them.
pub const QUICK: usize = 3;

/// For every set of groups, the value for each port's BSRR: one load of neighbouring values and one store a port,
/// however many motors there are. Lies in RAM, where no flash wait state delays it.
pub struct PortWrites<const PORTS: usize> {
    /// The ports; those not needed repeat the first, and their values are 0.
    pub ports: [Port; PORTS],
    /// Values of BSRR by set of groups and port.
    values: [[u32; PORTS]; SETS],
}

/// Port writes that make steps.
pub type StepWrites = PortWrites<STEP_PORTS>;

/// Port writes that set directions.
pub type DirWrites = PortWrites<DIR_PORTS>;

impl<const PORTS: usize> PortWrites<PORTS> {
    /// Whether all of `pins` are on ports that there is room for.
    #[must_use]
    pub fn can_hold(pins: impl Iterator<Item = Pin> + Clone) -> bool {
        let ports = Ports::<PORTS>::of(pins.clone());
        pins.into_iter().all(|pin| ports.ports[..ports.used].contains(&pin.port))
    }

    /// Writes that set the step pins of the motors in the groups and leave the other pins. Pins on one port too many
    /// get no write; [`can_hold`](Self::can_hold) reports that. The ports of motors that are not `slow` come first.
    #[must_use]
    pub fn pulses(pins: [Option<Pin>; MOTORS], slow: MotorSet, coupling: &Coupling) -> Self {
        let of = |are_slow| {
            let motors = pins.iter().enumerate();
            motors.filter(move |(motor, _)| (slow.0 & 1 << motor != 0) == are_slow).filter_map(|(_, pin)| *pin)
        };
        let ports = Ports::of(of(false).chain(of(true)));
        Self::new(pins, ports, |set| coupling.motors(set), |pin, is_in| if is_in { pin.mask() } else { 0 })
    }

    /// Groups that write to a port after the first [`QUICK`].
    #[must_use]
    pub fn beyond_quick(&self) -> GroupSet {
        let is_beyond = |group: &usize| self.values[1 << group][QUICK..].iter().any(|value| *value != 0);
        GroupSet((0..MOST_GROUPS).filter(is_beyond).map(|group| 1 << group).sum())
    }

    /// Writes that set the direction pins if the coordinates of the groups grow and all other coordinates fall. A pin
    /// is high for a motor that turns forward, or backward if it is `reversed`.
    #[must_use]
    pub fn levels(pins: [Option<Pin>; MOTORS], reversed: MotorSet, coupling: &Coupling) -> Self {
        let high = |set| MotorSet(coupling.forward_motors(set).0 ^ reversed.0);
        let ports = Ports::of(pins.into_iter().flatten());
        Self::new(pins, ports, high, |pin, is_in| if is_in { pin.mask() } else { pin.mask() << 16 })
    }

    fn new(
        pins: [Option<Pin>; MOTORS],
        ports: Ports<PORTS>,
        motors: impl Fn(GroupSet) -> MotorSet,
        value: impl Fn(Pin, bool) -> u32,
    ) -> Self {
        let Ports { mut ports, used } = ports;
        for port in used..PORTS {
            ports[port] = ports[0];
        }
        let mut values = [[0; PORTS]; SETS];
        for (set, values) in values.iter_mut().enumerate() {
            let motors = motors(GroupSet(set as u8));
            for (motor, pin) in pins.iter().enumerate() {
                if let Some(pin) = *pin
                    && let Some(column) = ports[..used].iter().position(|port| *port == pin.port)
                {
                    values[column] |= value(pin, motors.0 & 1 << motor != 0);
                }
            }
        }
        Self { ports, values }
    }

    /// The value of each port for `groups`.
    #[inline(always)]
    #[must_use]
    pub const fn of(&self, groups: GroupSet) -> &[u32; PORTS] {
        &self.values[groups.0 as usize % SETS]
    }
}

/// Ports in the order in which they were met.
struct Ports<const PORTS: usize> {
    ports: [Port; PORTS],
    used: usize,
}

impl<const PORTS: usize> Ports<PORTS> {
    /// The ports of `pins`, as far as there is room.
    fn of(pins: impl Iterator<Item = Pin>) -> Self {
        let (mut ports, mut used) = ([Port::A; PORTS], 0);
        for pin in pins {
            if !ports[..used].contains(&pin.port) && used < PORTS {
                ports[used] = pin.port;
                used += 1;
            }
        }
        Self { ports, used }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bits;
    use corehbot::kinematics::{Groups, Mechanism};
    use corehbot::motors::{Motor, per_motor, prototype};

    #[test]
    fn writes_hold_the_bits_of_exactly_the_motors_asked_for() {
        let pins =
            [(Port::F, 13), (Port::G, 0), (Port::F, 9), (Port::G, 4), (Port::F, 11), (Port::C, 13), (Port::E, 2)];
        let pins = pins.map(|(port, number)| Pin::new(port, number));
        let reversed = MotorSet::of(prototype::M4);
        let machine = Groups::new(&Mechanism::corehbot()).coupling();
        let pins_of = per_motor(&pins.map(Some), None);
        let pulses = StepWrites::pulses(pins_of, MotorSet::NONE, &machine);
        let levels = StepWrites::levels(pins_of, reversed, &machine);
        for groups in (0..SETS).map(|set| GroupSet(set as u8)) {
            for port in Port::ALL {
                let written = |writes: &StepWrites| -> u32 {
                    let values = writes.ports.iter().zip(writes.of(groups));
                    values.filter(|(p, _)| **p == port).map(|(_, value)| value).sum()
                };
                let of = |motors: MotorSet| {
                    let chosen = Motor::ALL.into_iter().zip(pins).filter(move |(motor, _)| motors.has(*motor));
                    bits(chosen.map(|(_, pin)| pin), port)
                };
                let high = MotorSet(machine.forward_motors(groups).0 ^ reversed.0);
                assert_eq!(written(&pulses), of(machine.motors(groups)), "{groups:?} {port:?}");
                assert_eq!(written(&levels), of(high) | of(prototype::ALL.without(high)) << 16, "{groups:?} {port:?}");
            }
        }
    }

    #[test]
    fn ports_without_a_motor_get_no_bits() {
        let mut pins = [None; MOTORS];
        pins[0] = Some(Pin::new(Port::B, 3));
        let writes = StepWrites::pulses(pins, MotorSet::NONE, &Groups::new(&Mechanism::corehbot()).coupling());
        assert_eq!(writes.ports, [Port::B; STEP_PORTS]);
        assert_eq!(writes.of(GroupSet(15)), &[1 << 3, 0, 0, 0]);
    }
}
