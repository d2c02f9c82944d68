//! A board with a machine plugged into it.

use corehbot::connectors::{ConnectorName, FANS};
use corehbot::motors::{MOTORS, prototype};
use corehbot::port::{Motor, MotorSet};
use corehbot::settings::{ConnectorError, EndstopPlug, Settings, Supply};

use crate::{Board, Contact, Input, Pin, Port, Slot, SupplySwitch, bits};

/// A board with each motor of a machine at a driver and each switch at an input. Drivers without a motor are left off.
#[derive(Clone, Copy, Debug)]
pub struct Plugged {
    /// The board.
    pub board: &'static Board,
    /// The drivers by motor; a motor without one is counted, but does not turn.
    pub slots: [Option<Slot>; MOTORS],
    /// Motors with a direction line that is low for forward.
    pub reversed: MotorSet,
    /// Switches of x, y and z.
    pub endstops: [Contact; 3],
    /// The Z probe, if the machine has one.
    pub probe: Option<Contact>,
    /// The filament sensor, if the machine has one.
    pub filament: Option<Contact>,
    /// The line of the servo, if the machine has a probe with one.
    pub servo: Option<Pin>,
    /// The switch of the power supply, if the machine has one.
    pub supply_switch: Option<SupplySwitch>,
    /// The tachometer of each fan that has one.
    pub tachometers: [Option<Input>; FANS],
    /// The frequency of each fan in Hz; 0 is the board's own.
    pub frequencies: [u16; FANS],
}

impl Board {
    /// The board with the prototype plugged in, each motor and each switch in its place of the table.
    #[must_use]
    pub fn usual(&'static self) -> Plugged {
        let mut slots = [None; MOTORS];
        let prototype = slots.iter_mut().take(prototype::COUNT);
        prototype.zip(self.sockets).for_each(|(slot, socket)| *slot = Some(*socket));
        let mut endstops = [Input::plain(Port::A, 0).contact(false); 3];
        endstops.iter_mut().zip(self.inputs).for_each(|(endstop, input)| *endstop = input.contact(false));
        Plugged {
            board: self,
            slots,
            reversed: MotorSet::NONE,
            endstops,
            probe: None,
            filament: None,
            servo: None,
            supply_switch: self.supply_switch(&Settings::prototype().supply),
            tachometers: [None; FANS],
            frequencies: [0; FANS],
        }
    }

    /// The board with a machine plugged in.
    ///
    /// # Errors
    /// A plugged-in part without a connector on the board.
    pub fn plugged(&'static self, machine: &Settings) -> Result<Plugged, ConnectorError> {
        machine.check_connectors(self.connectors)?;
        let mut plugged = Plugged { slots: [None; MOTORS], ..self.usual() };
        let fitted = machine.mechanism.fitted();
        for (motor, place) in Motor::ALL.into_iter().zip(&mut plugged.slots).filter(|(motor, _)| fitted.has(*motor)) {
            let plug = machine.wiring.of(motor);
            *place = self.socket(plug.connector);
            if plug.is_reversed {
                plugged.reversed = plugged.reversed.with(MotorSet::of(motor));
            }
        }
        let switches = &machine.wiring.endstops;
        for (plug, place) in [switches.x, switches.y, switches.z].into_iter().zip(&mut plugged.endstops) {
            *place = self.contact(plug).unwrap_or(place.input.contact(plug.is_normally_open));
        }
        plugged.probe = self.contact(machine.probe_plug);
        plugged.filament = self.contact(machine.filament);
        plugged.supply_switch = self.supply_switch(&machine.supply);
        plugged.servo = self.servo.filter(|_| machine.has_servo());
        plugged.tachometers = machine.fans.map(|fan| self.input(fan.tachometer.input()));
        plugged.frequencies = machine.fan_frequencies(self.connectors);
        Ok(plugged)
    }

    /// The switch of a machine's power supply.
    fn supply_switch(&self, supply: &Supply) -> Option<SupplySwitch> {
        let output = supply.output(self.connectors)?;
        let mut outputs = self.connectors.supply_switches.iter().zip(self.supply_pins);
        let (_, pin) = outputs.find(|(name, _)| **name == output)?;
        Some(SupplySwitch { pin: *pin, is_on_high: supply.is_on_high })
    }

    /// The driver in the socket of that name.
    fn socket(&self, name: ConnectorName) -> Option<Slot> {
        let mut sockets = self.connectors.sockets.iter().zip(self.sockets);
        sockets.find_map(|(socket, slot)| (*socket == name).then_some(*slot))
    }

    /// The contact of that plug, at its input.
    fn contact(&self, plug: EndstopPlug) -> Option<Contact> {
        Some(self.input(plug.connector)?.contact(plug.is_normally_open))
    }

    /// The input of that name.
    fn input(&self, name: ConnectorName) -> Option<Input> {
        let mut inputs = self.connectors.inputs.iter().zip(self.inputs);
        inputs.find_map(|(known, input)| (*known == name).then_some(*input))
    }
}

impl Plugged {
    /// Does something with every input in use.
    pub fn each_input(&self, mut work: impl FnMut(&Input)) {
        self.endstops.iter().for_each(|endstop| work(&endstop.input));
        [&self.probe, &self.filament].into_iter().flatten().for_each(|contact| work(&contact.input));
        self.tachometers.iter().flatten().for_each(work);
    }

    /// Step pins by motor.
    #[must_use]
    pub fn step_pins(&self) -> [Option<Pin>; MOTORS] {
        self.slots.map(|slot| slot.map(|slot| slot.step))
    }

    /// Direction pins by motor.
    #[must_use]
    pub fn dir_pins(&self) -> [Option<Pin>; MOTORS] {
        self.slots.map(|slot| slot.map(|slot| slot.dir))
    }

    /// Motors with a slow step pin, which needs a longer pulse.
    #[must_use]
    pub fn slow(&self) -> MotorSet {
        motors(|motor| self.slots[motor.index()].is_some_and(|slot| slot.step.is_slow()))
    }

    /// The enable lines of `motors` in `port`.
    #[must_use]
    pub fn enable_lines(&self, motors: MotorSet, port: Port) -> u32 {
        let slots = Motor::ALL.into_iter().zip(self.slots).filter(|(motor, _)| motors.has(*motor));
        bits(slots.filter_map(|(_, slot)| slot).map(|slot| slot.enable), port)
    }

    /// The UART of `motor`'s driver.
    #[must_use]
    pub fn uart(&self, motor: Motor) -> Option<Pin> {
        self.slots[motor.index()].and_then(|slot| slot.uart)
    }

    /// Motors with a driver that has a UART.
    #[must_use]
    pub fn uarts(&self) -> MotorSet {
        motors(|motor| self.uart(motor).is_some())
    }
}

fn motors(is_in: impl Fn(Motor) -> bool) -> MotorSet {
    let motors = Motor::ALL.into_iter().filter(|motor| is_in(*motor));
    motors.fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(motor)))
}
