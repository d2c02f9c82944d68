//! Properties of heaters for all readings and orders: one body for the fuzzer and for the property tests.

use corehbot::connectors::{HEATERS, Heater, OUTPUTS, OutputSet, Sensor};
use corehbot::fault::Cause;
use corehbot::port::{ThermalPort, Wake};
use corehbot::settings::{Control, ExtraSensor, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Pid};
use corehbot::settings::{ThermalSettings, Thermistor};
use corehbot::status::{SelfTest, Status};
use corehbot::thermal::{Common, Order, OrderQueue, ThermalControl};
use corehbot::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use std::cell::Cell;
use std::rc::Rc;

/// Periods after which a sensor without a reading has cost its heater the power: 0.4 s, and one.
const SILENT: u32 = 21;

/// A port with given readings.
#[derive(Default)]
struct Wild {
    samples: Cell<[Option<u16>; 3]>,
    duties: Cell<[u16; OUTPUTS]>,
}

struct WildPort(Rc<Wild>);

const fn place(sensor: Sensor) -> usize {
    match sensor {
        Sensor::Hotend0 => 0,
        Sensor::Bed => 1,
        _ => 2,
    }
}

impl ThermalPort for WildPort {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        self.0.samples.get()[place(sensor)]
    }

    fn outputs(&self) -> OutputSet {
        OutputSet(0x1F)
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.0.duties.set(*duties);
    }

    fn fans(&self) -> usize {
        6
    }
}

#[derive(Clone, Copy)]
struct NoWake;

impl Wake for NoWake {
    fn wake_generator(&self) {}
    fn wake_stepper(&self) {}
}

/// Numbers out of bytes; zeros after their end.
struct Bytes<'d>(&'d [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| match self.0.split_first() {
            Some((byte, rest)) => {
                self.0 = rest;
                *byte
            }
            None => 0,
        })
    }

    fn byte(&mut self) -> u8 {
        u8::from_le_bytes(self.take())
    }

    fn half(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn celsius(&mut self) -> Celsius {
        Celsius::from_bits(i32::from_le_bytes(self.take()))
    }

    fn heater(&mut self) -> Heater {
        Heater::ALL[usize::from(self.byte()) % HEATERS]
    }

    /// Every fourth sensor has stopped.
    fn sample(&mut self) -> Option<u16> {
        let sample = self.half();
        (!sample.is_multiple_of(4)).then_some(sample)
    }

    /// Settings that no machine file may have, for a heater at the connectors of `base`.
    fn settings(&mut self, base: &HeaterSettings) -> HeaterSettings {
        HeaterSettings {
            thermistor: Thermistor::Beta { ohms: self.word(), beta: self.half(), cubic: self.half() },
            most: self.celsius(),
            power: Watts::from_bits(self.word()),
            max_duty: Ratio::from_bits(self.word()),
            period_ms: self.half(),
            control: if self.byte().is_multiple_of(2) { Control::Pid } else { Control::Model },
            model: HeaterModel {
                capacity: JoulesPerKelvin::from_bits(self.word()),
                loss: WattsPerKelvin::from_bits(self.word()),
                fan_loss: WattsPerKelvin::from_bits(self.word()),
                heater_lag: Seconds::from_bits(self.word()),
                sensor_lag: Seconds::from_bits(self.word()),
                ptc: Ratio::from_bits(self.word()),
            },
            pid: Pid {
                p: Ratio::from_bits(self.word()),
                i: Ratio::from_bits(self.word()),
                d: Ratio::from_bits(self.word()),
            },
            guards: Guards { heating: Ratio::from_bits(self.word()), lost_s: self.byte(), ..base.guards },
            ..*base
        }
    }

    fn order(&mut self, machine: &ThermalSettings) -> Order {
        match self.byte() % 10 {
            0..=2 => Order::Target(self.heater(), self.celsius()),
            3 => Order::Tune(self.heater(), self.celsius(), self.byte()),
            4 => Order::Fan(self.byte(), self.half()),
            5 => Order::Motors(self.byte().is_multiple_of(2)),
            6 => [Order::Off, Order::StopTrials, Order::SelfTest, Order::SelfTest][usize::from(self.byte() % 4)],
            7 => {
                let heater = self.heater();
                Order::Heater(heater, self.settings(machine.heater(heater)))
            }
            8 => Order::Common(Common {
                hotend_fan_above: self.celsius(),
                fan_run_on_s: self.half(),
                filament: WattsPerKelvin::from_bits(self.word()),
                sensors: machine.sensors.map(|extra| ExtraSensor {
                    is_fitted: self.byte().is_multiple_of(4),
                    guards: Some(self.heater()),
                    most: self.celsius(),
                    ..extra
                }),
            }),
            _ => {
                let role = [FanRole::Commanded, FanRole::Hotend, FanRole::Controller, FanRole::Part]
                    [usize::from(self.byte() % 4)];
                let (least, most) = (Ratio::from_bits(self.word()), Ratio::from_bits(self.word()));
                Order::FanSettings(self.byte(), FanSettings { role, kick_ms: self.half(), least, most })
            }
        }
    }
}

/// The values watched from outside.
struct Watch {
    machine: ThermalSettings,
    /// Periods without a reading of each sensor.
    silent: [u32; 3],
    /// Which heaters had a target in the period before. A tuning that is over ends with its period.
    had_target: [bool; HEATERS],
    cause: Option<Cause>,
}

impl Watch {
    /// Checks the invariants after a period.
    fn look(&mut self, status: &Status, wild: &Wild) {
        let duties = wild.duties.get();
        for (silent, sample) in self.silent.iter_mut().zip(wild.samples.get()) {
            *silent = if sample.is_none() { *silent + 1 } else { 0 };
        }
        let mut powered = OutputSet::NONE;
        for heater in Heater::ALL {
            let settings = self.machine.heater(heater);
            let target = status.heat().target(heater);
            assert!(target <= settings.most.max(Celsius::ZERO), "{heater:?}: {target} above {}", settings.most);
            let (output, duty) = (settings.output, duties[settings.output as usize]);
            if !settings.is_fitted {
                continue;
            }
            // A self-test has its own pulses.
            let has_target = target > Celsius::ZERO || status.heat().self_test() == SelfTest::Testing;
            if std::mem::replace(&mut self.had_target[heater as usize], has_target) || has_target {
                powered = powered.with(output);
            }
            let is_refused = status.heat().ailment(heater).is_some();
            assert!(!is_refused || duty == 0 && target <= Celsius::ZERO, "{heater:?} has {duty}, and is refused");
            let is_silent = self.silent[place(settings.sensor)] >= SILENT;
            assert!(!is_silent || duty == 0, "{heater:?} has {duty} without a sensor");
            let is_relay = settings.period_ms > 0;
            let most = (u64::from(settings.max_duty.to_bits()) * 65_535) >> 16;
            assert!(is_relay || u64::from(duty) <= most, "{heater:?} has {duty} of {most}");
        }
        for (place, duty) in duties.into_iter().enumerate() {
            assert!(duty == 0 || powered.0 & 1 << place != 0, "output {place} has {duty} without a target");
        }
        // The first fault stays, and no heater gets power after it.
        let fault = status.fault().fault();
        assert!(self.cause.is_none() || fault.map(|fault| fault.cause) == self.cause);
        self.cause = fault.map(|fault| fault.cause);
        assert!(self.cause.is_none() || duties == [0; OUTPUTS], "{duties:?} after {:?}", self.cause);
    }
}

/// Orders and readings out of `data` for a machine with a hotend and a bed. Each order is followed by readings and by
/// up to 63 control periods, in which some contexts may stop.
pub fn heat_orders(data: &[u8]) {
    let mut machine = ThermalSettings::prototype();
    machine.heater_mut(Heater::Hotend).is_fitted = true;
    machine.heater_mut(Heater::Bed).is_fitted = true;
    let wild = Rc::new(Wild::default());
    let (mut queue, status) = (OrderQueue::new(), Status::new());
    let (mut orders, orders_in) = queue.split();
    let mut control = ThermalControl::new(&machine, orders_in, &status, WildPort(wild.clone()), NoWake);
    let mut watch = Watch { machine, silent: [0; 3], had_target: [false; HEATERS], cause: None };
    let mut bytes = Bytes(data);
    while !bytes.0.is_empty() {
        let order = bytes.order(&watch.machine);
        assert!(orders.enqueue(order).is_ok());
        if let Order::Heater(heater, settings) = order {
            *watch.machine.heater_mut(heater) = settings;
        }
        wild.samples.set([bytes.sample(), bytes.sample(), bytes.sample()]);
        status.heat().set_extruded_um(bytes.word());
        status.heat().set_filament_ahead([bytes.word(), bytes.word()]);
        let (periods, heartbeats) = (bytes.byte() % 64, bytes.byte());
        for _ in 0..=periods {
            if heartbeats & 1 == 0 || heartbeats > 7 {
                status.heat().beat_of_console();
            }
            if heartbeats & 2 == 0 || heartbeats > 7 {
                status.heat().beat_of_generator();
            }
            if heartbeats & 4 == 0 || heartbeats > 7 {
                status.count_look();
            }
            control.period();
            watch.look(&status, &wild);
        }
    }
}
