//! Problems of a board's table, for tests to check.

use corehbot::connectors::ConnectorName;
use corehbot::motors::prototype;
use corehbot::port::{FANS, LINES};

use crate::port_writes::{DirWrites, StepWrites};
use crate::{
    Board, FanPin, FanTimer, HEATER_PORTS, HeaterPin, HeaterTimer, Input, MOST_THERMISTORS, Pin, SensorPins,
    SerialPort, Slot, USB,
};

impl Board {
    /// The first problem of the table, if any.
    #[must_use]
    pub fn problem(&self) -> Option<&'static str> {
        let sockets = || self.sockets.iter();
        // The step interrupt makes a store a port, so the tables have room for so many ports and no more.
        if !StepWrites::can_hold(sockets().map(|slot| slot.step))
            || !DirWrites::can_hold(sockets().map(|slot| slot.dir))
        {
            return Some("step or direction pins are on too many ports");
        }
        // `StepPins::dir` stores to four ports, and then to three of them again, which is a slow pin's time. A fifth
        // port has the second store alone.
        if sockets().any(|slot| slot.dir.is_slow()) && !StepWrites::can_hold(sockets().map(|slot| slot.dir)) {
            return Some("a direction pin is slow, and there is no time for it (StepPins::dir)");
        }
        let single = || self.pins_of_one_job();
        let enables = || sockets().map(|slot| slot.enable);
        // An enable line may be that of many sockets, but of nothing else.
        let is_twice = |pin: Pin| single().filter(|other| *other == pin).count() > 1;
        if single().any(is_twice) || enables().any(|enable| single().any(|pin| pin == enable)) {
            return Some("a pin has two jobs");
        }
        let uarts = sockets().filter_map(|slot| slot.uart);
        // The Spider's FAN0 and FAN1 are such pins: the board has no debug port. Sockets are checked below.
        let is_fan = |pin: &Pin| self.fans.iter().any(|fan| fan.pin == *pin);
        if self
            .pins_beside_drivers()
            .filter(|pin| !is_fan(pin))
            .chain(uarts)
            .chain(enables())
            .any(Pin::is_of_debug_port)
        {
            return Some("a pin of the debug port has a job");
        }
        if self.connectors.sockets.len() != self.sockets.len() || self.connectors.inputs.len() != self.inputs.len() {
            return Some("there are more or fewer names than sockets or inputs");
        }
        if self.connectors.supply_switches.len() != self.supply_pins.len() {
            return Some("there are more or fewer names than pins for the supply's switch");
        }
        let inputs = || self.connectors.inputs.iter().zip(self.inputs);
        // The core sees connectors alone. Only by them it can refuse a machine with two switches in one line.
        let is_told = |(a, one): (&ConnectorName, &Input), (b, other): (&ConnectorName, &Input)| {
            self.connectors.is_one_line(*a, *b) == (one.pin == other.pin)
        };
        if inputs().any(|one| inputs().any(|other| !is_told(one, other))) {
            return Some("inputs share a pin and their connectors do not say so, or the reverse");
        }
        let told = self.connectors.sockets.iter().map(|name| self.connectors.debug_sockets.contains(name));
        // A machine without `[wiring]` uses the first sockets, and must not lose the debug port unasked.
        if sockets().take(prototype::COUNT).any(Slot::is_of_debug_port)
            || !sockets().map(Slot::is_of_debug_port).eq(told)
        {
            return Some("a socket takes the debug port without being asked or without its connectors saying so");
        }
        let is_usart_twice = |port: &SerialPort| self.serial.iter().filter(|p| p.usart == port.usart).count() > 1;
        if self.serial.iter().any(is_usart_twice) || self.serial.len() + usize::from(self.has_usb) > LINES {
            return Some("there are more lines to hosts than can be served");
        }
        if self.thermistors.len() > MOST_THERMISTORS {
            return Some("there are too many thermistors");
        }
        let is_of_servo = |heater: &HeaterPin| heater.timer == HeaterTimer::Three;
        if self.servo.is_some() && self.heaters.iter().any(is_of_servo) {
            return Some("a servo and a heater share TIM3");
        }
        if self.servo.is_some() != self.connectors.has_servo {
            return Some("the connectors do not say whether there is a servo");
        }
        if self.accelerometer.is_some() != self.connectors.accelerometer.is_some() {
            return Some("the connectors do not say whether there is one for an accelerometer");
        }
        self.load_problem().or_else(|| self.serial.iter().find_map(SerialPort::problem))
    }

    /// Every pin except the enable lines, which drivers may share.
    fn pins_of_one_job(&self) -> impl Iterator<Item = Pin> {
        let sockets = self.sockets.iter();
        let uarts = sockets.clone().filter_map(|slot| slot.uart);
        sockets.flat_map(|slot| [slot.step, slot.dir]).chain(uarts).chain(self.pins_beside_drivers())
    }

    /// Every pin that leads to no socket.
    fn pins_beside_drivers(&self) -> impl Iterator<Item = Pin> {
        // Lists all fields by name, so that a new field must be classified here: does it have pins? The pins of heaters
        // and fans are among the loads. The pins of sockets are checked elsewhere.
        let Self {
            name: _,
            connectors: _,
            crystal: _,
            sockets: _,
            inputs,
            thermistors,
            loads,
            heaters,
            fans,
            supply_pins,
            servo,
            accelerometer,
            serial,
            has_usb,
            eeprom,
            has_144_pins: _,
            marks: _,
        } = *self;
        // A second pin of a heater or fan would need a check too; so this lists all their fields.
        heaters.iter().for_each(|HeaterPin { output: _, pin: _, timer: _, channel: _ }| {});
        fans.iter().for_each(|FanPin { pin: _, timer: _, channel: _ }| {});
        // Two connectors may share a pin.
        let inputs = inputs
            .iter()
            .enumerate()
            .filter(|(at, input)| inputs.iter().take(*at).all(|earlier| earlier.pin != input.pin));
        let pins = loads.iter().copied().chain(inputs.map(|(_, input)| input.pin));
        pins.chain(serial.iter().flat_map(|port| [port.tx, port.rx]))
            .chain(USB.into_iter().filter(move |_| has_usb))
            .chain(eeprom.into_iter().flatten())
            .chain(thermistors.iter().map(|thermistor| thermistor.pin))
            .chain(supply_pins.iter().copied())
            .chain(servo)
            .chain(
                accelerometer
                    .into_iter()
                    .flat_map(|SensorPins { clock, miso, mosi, select }| [clock, miso, mosi, select]),
            )
    }

    /// The first problem of heaters and fans, if any.
    fn load_problem(&self) -> Option<&'static str> {
        let heaters = || self.heaters.iter();
        let fans = || self.fans.iter();
        if heaters().map(|heater| heater.pin).chain(fans().map(|fan| fan.pin)).any(|pin| !self.loads.contains(&pin)) {
            return Some("a heater or a fan has no safe level");
        }
        let is_twice = |one: &HeaterPin| {
            let is_same = |other: &&HeaterPin| {
                other.output == one.output || (other.timer, other.channel) == (one.timer, one.channel)
            };
            heaters().filter(is_same).count() > 1
        };
        let has_channel = |heater: &HeaterPin| (1..=heater.timer.channels()).contains(&heater.channel);
        if heaters().any(is_twice) || !heaters().all(has_channel) {
            return Some("two heaters share an output or a channel, or there is no such channel");
        }
        if heaters().any(|heater| !HEATER_PORTS.contains(&heater.pin.port)) {
            return Some("a heater is on a port that faults do not look at first");
        }
        let is_shared = |one: &FanPin| {
            one.timer != FanTimer::None
                && fans().filter(|other| (other.timer, other.channel) == (one.timer, one.channel)).count() > 1
        };
        if fans().any(is_shared) || self.fans.len() > FANS {
            return Some("two fans share a channel, or there are too many");
        }
        if !fans().all(|fan| fan.timer.channels().contains(&fan.channel)) {
            return Some("a fan is on a channel that its timer does not have for fans");
        }
        None
    }
}
