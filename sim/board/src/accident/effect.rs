//! Effect: what an accident does to heat and to a probe, and whether a machine can have it.

use super::read::Accident;
use super::table::{Does, Place};
use corehbot::connectors::Heater;
use corehbot::settings::{ProbeKind, Settings};
use corehbot_rig::bed::has_probe;
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::plant::PlantFaults;

/// Why a machine without a probe has no bed of its own, and no accidents of a probe.
pub(crate) const NO_PROBE: &str = "the machine has no probe; its file plugs one in (endstops.probe)";

const NO_BLTOUCH: &str = "the machine has no BLTouch, and no other probe is ever in alarm (probe.kind)";

impl Accident {
    /// It happens to the plant of heat, if it is of that.
    pub fn happen(&self, faults: &mut PlantFaults) {
        match (self.row.does, self.place) {
            (Does::Sensor(fault), Place::SecondSensor) => faults.second_sensor = fault,
            (Does::Sensor(fault), Place::Heater(heater)) => *faults.sensor_of(heater) = fault,
            (Does::Heater(fault), Place::Heater(heater)) => *faults.heater_of(heater) = fault,
            (Does::FanDead, Place::PartFan) => faults.part_fan_broken = true,
            (Does::FanDead, _) => faults.hotend_fan_broken = true,
            (Does::Machine(happens), _) => happens(faults),
            (Does::Sensor(_) | Does::Heater(_) | Does::Probe(_) | Does::Belts(_), _) => {}
        }
    }

    /// The fault of the probe of such a machine, if it is of that.
    #[must_use]
    pub fn probe_fault(&self, settings: &Settings) -> Option<ProbeFault> {
        if let Does::Probe(does) = self.row.does { Some(does(settings)) } else { None }
    }

    /// A part that the machine lacks, so that this cannot happen. Parts of belts are the belt plant's.
    #[must_use]
    pub fn missing(&self, settings: &Settings) -> Option<String> {
        let thermal = &settings.thermal;
        let needed = match self.place {
            Place::Heater(heater) => heater,
            Place::SecondSensor => {
                let has_one = thermal.sensors.iter().any(|extra| extra.guarded().is_some());
                return (!has_one).then(|| "no sensor guards a heater; its file fits one (sensors.second)".to_owned());
            }
            Place::PartFan | Place::HotendFan => Heater::Hotend,
            Place::Machine => return (!thermal.has_heater()).then(|| "the machine has no heater".to_owned()),
            Place::Probe => {
                let is_alarm = self.probe_fault(settings) == Some(ProbeFault::Alarm);
                let is_deaf = is_alarm && settings.probe.kind != ProbeKind::BlTouch;
                let why = if has_probe(settings) { is_deaf.then_some(NO_BLTOUCH) } else { Some(NO_PROBE) };
                return why.map(str::to_owned);
            }
            Place::PartOfBelts => return None,
        };
        let name = needed.name();
        let is_fitted = thermal.heater(needed).is_fitted;
        (!is_fitted).then(|| format!("the machine has no {name}; its file fits one (heaters.{name}.is_fitted = true)"))
    }
}
