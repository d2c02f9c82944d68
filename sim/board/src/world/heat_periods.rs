//! Heat of a world: the control periods, the accidents, and the plant of the heaters.

use super::World;
use crate::ends::{HeatPeriod, HeaterPeriod};
use corehbot::connectors::Heater;
use corehbot::thermal::PERIOD_MS;
use corehbot::units::{Celsius, TICKS_PER_MS, TICKS_PER_SECOND};
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::plant::Plant;
use corehbot_rig::thermal_plant::Heat;

impl World<'_> {
    /// A control period passes, if one is due.
    pub(super) fn keep_heat(&mut self) {
        if self.shared.now.get() < self.next_period {
            return;
        }
        self.next_period += u64::from(PERIOD_MS) * u64::from(TICKS_PER_MS);
        self.befall();
        self.thermal.period();
        let extruded = self.extruded();
        self.thermal.port().advance(extruded, f64::from(PERIOD_MS) / 1000.0);
        if self.thermal.port().plant().is_some() {
            let period = self.heat_period();
            self.stepper.port().sink.heat(&period);
        }
    }

    /// Applies the accidents that are due by now.
    fn befall(&mut self) {
        let seconds = self.shared.now.get() as f64 / f64::from(TICKS_PER_SECOND);
        while let Some((_, fault)) = self.probe_accidents.pop_front_if(|(at_s, _)| *at_s <= seconds) {
            self.fail_probe(fault);
        }
        while let [first, later @ ..] = self.accidents {
            if first.at_s * f64::from(TICKS_PER_SECOND) > self.shared.now.get() as f64 {
                return;
            }
            self.accidents = later;
            if let Some(plant) = self.thermal.port().plant() {
                first.happen(plant.faults());
            }
        }
    }

    /// The extruder's steps, for the plant of the heaters. Without a plant nothing asks for them, and counting takes
    /// a look at each event in the queue.
    fn extruded(&mut self) -> i32 {
        if self.thermal.port().plant().is_none() {
            return 0;
        }
        let counts = self.turned.motors(self.counts.read());
        self.extruder.map_or(0, |motor| counts[motor.index()])
    }

    fn heat_period(&mut self) -> HeatPeriod {
        let (now, tick, known) = (self.shared.now.get(), self.stepper.tick(), self.status.heat());
        let heat = self.thermal.port();
        let heaters = Heater::ALL.map(|heater| {
            let duty = heat.duty(heater)?;
            Some(HeaterPeriod { measured: known.measured(heater), target: known.target(heater), duty })
        });
        HeatPeriod { now, tick, heaters, fans: heat.fan_duties() }
    }

    /// Its heat.
    pub const fn heat(&mut self) -> &mut Heat {
        self.thermal.port()
    }

    /// The probe fails, or is whole again, at once.
    pub fn fail_probe(&mut self, fault: ProbeFault) {
        self.stepper.port().fail(fault);
    }

    /// Its heat, for the next world: a restart of the firmware cools nothing.
    pub fn take_plant(&mut self) -> Option<Box<Plant>> {
        self.thermal.port().take_plant().map(Box::new)
    }

    /// Whether anything is to be warm, which takes its time.
    #[must_use]
    pub fn is_heating(&self) -> bool {
        Heater::ALL.into_iter().any(|heater| self.status.heat().target(heater) > Celsius::ZERO)
    }
}
