//! Compares the steps on the pins with the steps of the host simulator.
//!
//! The sequence, which motors step in which direction, has to be equal, without exception. Then two things are checked:
//! whether the firmware plays each event at the host's tick, and how late the edges are.

use crate::steps::StepEvent;
use crate::timer::Schedule;
use anyhow::Result;
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::port::{NoStorage, Storage};
use corehbot::settings::Settings;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{self, Desk, Sink};
use std::fmt;

/// A step event of the host simulator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Scheduled {
    /// Motion time.
    pub tick: u64,
    /// The motors that step.
    pub steps: MotorSet,
    /// The stepping motors that step forward.
    pub forward: MotorSet,
}

/// Prints `gcode` on the host simulator.
///
/// # Errors
/// If printer and host wait for each other.
pub fn scheduled(gcode: &str, settings: &Settings) -> Result<Vec<Scheduled>> {
    scheduled_with(gcode, settings, NoStorage, None)
}

/// The same with stored settings, which override the machine's first settings, and with a belt.
///
/// # Errors
/// If printer and host wait for each other, or the twin has no such machine.
pub fn scheduled_with(
    gcode: &str,
    settings: &Settings,
    storage: impl Storage,
    belt: Option<&BeltSetup>,
) -> Result<Vec<Scheduled>> {
    printed(gcode, [settings, settings], storage, belt)
}

/// Prints on a simulator that was built as the first machine and pulls the belts of the second one.
fn printed(
    gcode: &str,
    [built, pulled]: [&Settings; 2],
    storage: impl Storage,
    belt: Option<&BeltSetup>,
) -> Result<Vec<Scheduled>> {
    struct Steps(Vec<Scheduled>);
    impl Sink for Steps {
        fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
            if !steps.is_empty() {
                self.0.push(Scheduled { tick, steps, forward: MotorSet(forward.0 & steps.0) });
            }
        }
    }
    let mut steps = Steps(Vec::new());
    let mut desk = Desk::new(1);
    if let Some(setup) = belt {
        desk.belt = Some(Box::new(BeltPlant::new(pulled, None, false, setup.clone(), 0)?));
    }
    let (drivers, mut host) = (Drivers::new(), FileHost::new(gcode));
    world::run_at(&mut desk, built, None, storage, &drivers, &mut [&mut host], &mut steps)?;
    Ok(steps.0)
}

/// The same on the machine `settings`, which is stored in `eeprom`: the firmware takes it from there.
///
/// # Errors
/// If printer and host wait for each other, or the twin has no such machine.
pub fn scheduled_stored(
    gcode: &str,
    settings: &Settings,
    eeprom: &mut Eeprom,
    belt: Option<&BeltSetup>,
) -> Result<Vec<Scheduled>> {
    let prototype = Settings::prototype();
    // A simulator built as the prototype lacks the heaters and the mechanism that the EEPROM may ask for.
    if settings.thermal.has_heater() || settings.mechanism != prototype.mechanism {
        return scheduled_with(gcode, settings, NoStorage, belt);
    }
    // It would lack the accelerometer too: then the firmware finds none, and makes no sweep.
    let built = Settings { accelerometer: settings.accelerometer, ..prototype };
    printed(gcode, [&built, settings], eeprom, belt)
}

/// The part of `events` that a board shows if it has only the motors `motors`.
#[must_use]
pub fn of_motors(events: &[Scheduled], motors: MotorSet) -> Vec<Scheduled> {
    let seen = |event: &Scheduled| Scheduled {
        steps: MotorSet(event.steps.0 & motors.0),
        forward: MotorSet(event.forward.0 & motors.0),
        ..*event
    };
    events.iter().map(seen).filter(|event| !event.steps.is_empty()).collect()
}

/// Where the sequences part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Difference {
    /// Number of the event, from 0.
    pub event: usize,
    /// The pins' event, if there is one.
    pub pins: Option<StepEvent>,
    /// The host's event, if there is one.
    pub host: Option<Scheduled>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "event {}: ", self.event)?;
        match self.pins {
            Some(e) => write!(f, "the pins step {} at {} ns", motors(e.steps, e.forward), e.at)?,
            None => f.write_str("the pins are silent")?,
        }
        match self.host {
            Some(e) => write!(f, ", the host steps {} at tick {}", motors(e.steps, e.forward), e.tick),
            None => f.write_str(", the host is silent"),
        }
    }
}

fn motors(steps: MotorSet, forward: MotorSet) -> String {
    // The boards here have the prototype's motors.
    let name = |m: &Motor| format!("{}{}", if forward.has(*m) { '+' } else { '-' }, prototype::NAMES[m.index()]);
    Motor::ALL.iter().filter(|m| steps.has(**m)).map(name).collect::<Vec<_>>().join(" ")
}

/// The first difference of the sequences, if there is any.
#[must_use]
pub fn difference(pins: &[StepEvent], host: &[Scheduled]) -> Option<Difference> {
    let event = (0..pins.len().max(host.len())).find(|&i| match (pins.get(i), host.get(i)) {
        (Some(p), Some(h)) => (p.steps, p.forward) != (h.steps, h.forward),
        _ => true,
    })?;
    Some(Difference { event, pins: pins.get(event).copied(), host: host.get(event).copied() })
}

/// Lateness of events in ns, sorted.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Lateness(pub Vec<i64>);

impl Lateness {
    /// The lateness that `share` of the events does not exceed, in ns.
    #[must_use]
    pub fn quantile(&self, share: f64) -> i64 {
        let last = self.0.len().saturating_sub(1);
        self.0.get((last as f64 * share).round() as usize).copied().unwrap_or(0)
    }

    /// The greatest lateness in ns.
    #[must_use]
    pub fn max(&self) -> i64 {
        self.quantile(1.0)
    }
}

/// How the edges keep to the schedule.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Timing {
    /// Of every event.
    pub late: Lateness,
    /// Of the events of the longest motion without a rest.
    pub longest: Lateness,
    /// Starts of motion.
    pub starts: u64,
    /// Events so late that the firmware moved all that follow.
    pub stretched: u64,
    /// Events that the firmware plays at the host's tick.
    pub exact: u64,
    /// Events played at another tick than scheduled, or with a schedule that could not be read.
    pub inexact: u64,
    /// Longest time from the first edge of an event to its last, in ns.
    pub spread: u32,
}

impl Timing {
    /// A motion has ended.
    fn keep_longest(&mut self, motion: &mut Vec<i64>) {
        let motion = std::mem::take(motion);
        if motion.len() > self.longest.0.len() {
            self.longest = Lateness(motion);
        }
    }
}

/// Compares the schedule of `pins` with the schedule of `host`, which has the same sequence, and the edges with the
/// schedule.
#[must_use]
pub fn timing(pins: &[StepEvent], host: &[Scheduled]) -> Timing {
    let mut timing = Timing::default();
    let mut last: Option<Schedule> = None;
    let mut motion = Vec::new();
    for (event, planned) in pins.iter().zip(host) {
        timing.spread = timing.spread.max(event.spread);
        let is_exact = event.schedule.is_some_and(|schedule| schedule.tick() == planned.tick as u32);
        timing.exact += u64::from(is_exact);
        timing.inexact += u64::from(!is_exact);
        let Some(schedule) = event.schedule else { continue };
        let stretched = schedule.stretched.wrapping_sub(last.map_or(0, |last| last.stretched));
        timing.stretched += u64::from(stretched);
        // Motion time stands still at rest, and while time is stretched.
        if stretched == 0 && last.is_none_or(|last| last.lag != schedule.lag) {
            timing.starts += 1;
            timing.keep_longest(&mut motion);
        }
        timing.late.0.push(schedule.late);
        motion.push(schedule.late);
        last = Some(schedule);
    }
    timing.keep_longest(&mut motion);
    timing.late.0.sort_unstable();
    timing.longest.0.sort_unstable();
    timing
}

#[cfg(test)]
mod tests;
