//! Compares the steps on the pins with those of the host simulator.
//!
//! The sequence, which motors step which way, has to be equal, without exception. Then each event of the
//! pins has the host's tick as its schedule, and two things are looked at: whether the alarms that the
//! firmware set agree with that schedule to the tick, and how late the edges are.

use crate::steps::StepEvent;
use crate::timer::NS_PER_TICK;
use anyhow::Result;
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{self, Sink};
use std::fmt;

/// The firmware moves all that follow when an event is later than this (`motion::stepper`, GRACE).
const GRACE_NS: i64 = 10_000;

/// Without this much more time between two events than the schedule has, motion has not rested.
const REST_NS: i64 = 1_000_000;

/// A step event of the host simulator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Scheduled {
    /// Motion time.
    pub tick: u64,
    /// The motors that step.
    pub steps: MotorSet,
    /// Those of them that step forward.
    pub forward: MotorSet,
}

/// Prints `gcode` on the host simulator.
///
/// # Errors
/// If printer and host wait for each other.
pub fn scheduled(gcode: &str, settings: &Settings) -> Result<Vec<Scheduled>> {
    struct Steps(Vec<Scheduled>);
    impl Sink for Steps {
        fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
            if !steps.is_empty() {
                self.0.push(Scheduled { tick, steps, forward: MotorSet(forward.0 & steps.0) });
            }
        }
    }
    let mut steps = Steps(Vec::new());
    world::run(settings, None, &mut FileHost::new(gcode), &mut steps)?;
    Ok(steps.0)
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
    let name = |m: &Motor| format!("{}{}", if forward.has(*m) { '+' } else { '-' }, m.name());
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
    /// Events whose alarm is the scheduled tick exactly.
    pub exact_alarms: u64,
    /// Events whose alarm is another tick.
    pub other_alarms: u64,
    /// Events that followed another in one interrupt, without an alarm of their own.
    pub no_alarm: u64,
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

/// Holds the edges of `pins` to the schedule of `host`; the sequences are equal.
#[must_use]
pub fn timing(pins: &[StepEvent], host: &[Scheduled]) -> Timing {
    let mut timing = Timing::default();
    // Real time in ns, alarm and motion time of one and the same instant.
    let mut base: Option<(i64, Option<u32>, u64)> = None;
    let mut last = None;
    let mut motion = Vec::new();
    for (event, planned) in pins.iter().zip(host) {
        let at = event.at as i64;
        timing.spread = timing.spread.max(event.spread);
        let due = |(begin, _, tick): (i64, Option<u32>, u64)| begin + ((planned.tick - tick) * NS_PER_TICK) as i64;
        let rested = event.rested
            || last.is_none_or(|(then, tick)| at - then - (planned.tick - tick) as i64 * NS_PER_TICK as i64 > REST_NS);
        last = Some((at, planned.tick));
        let start = base.filter(|_| !rested);
        let Some(start) = start else {
            timing.starts += 1;
            let due = event.alarm.map_or(at, |a| a.due);
            timing.late.0.push(at - due);
            timing.keep_longest(&mut motion);
            motion.push(at - due);
            base = Some((due, event.alarm.map(|a| a.ticks), planned.tick));
            continue;
        };
        match (event.alarm, start.1) {
            (Some(alarm), Some(begin)) => {
                let scheduled = begin.wrapping_add((planned.tick - start.2) as u32);
                let is_exact = alarm.ticks == scheduled;
                timing.exact_alarms += u64::from(is_exact);
                timing.other_alarms += u64::from(!is_exact);
            }
            _ => timing.no_alarm += 1,
        }
        let late = at - due(start);
        timing.late.0.push(late);
        motion.push(late);
        if late > GRACE_NS {
            timing.stretched += 1;
            // From here on the schedule counts from the moment at which the event was played.
            base = Some((at, None, planned.tick));
        }
    }
    timing.keep_longest(&mut motion);
    timing.late.0.sort_unstable();
    timing.longest.0.sort_unstable();
    timing
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::Alarm;

    fn event(at: u64, ticks: u32, due: i64, rested: bool) -> StepEvent {
        let alarm = Some(Alarm { ticks, due });
        StepEvent { at, steps: MotorSet::BELT, forward: MotorSet::NONE, spread: 8, alarm, rested }
    }

    fn planned(tick: u64) -> Scheduled {
        Scheduled { tick, steps: MotorSet::BELT, forward: MotorSet::NONE }
    }

    #[test]
    fn the_schedule_is_taken_anew_at_each_start_of_motion() {
        let pins = [
            event(1300, 10, 1000, true),
            event(11_700, 110, 11_000, false),
            event(900_400, 9000, 900_000, true),
            event(910_500, 9100, 910_000, false),
        ];
        let host = [planned(50), planned(150), planned(160), planned(260)];
        assert_eq!(difference(&pins, &host), None);
        let timing = timing(&pins, &host);
        assert_eq!(timing.late.0, [300, 400, 500, 700]);
        assert_eq!(timing.longest.0, [300, 700], "the first of two alike");
        assert_eq!((timing.starts, timing.exact_alarms, timing.other_alarms, timing.late.max()), (2, 2, 0, 700));
    }

    #[test]
    fn an_alarm_one_tick_off_is_seen() {
        let pins = [event(1000, 10, 1000, true), event(11_000, 111, 11_000, false)];
        let timing = timing(&pins, &[planned(0), planned(100)]);
        assert_eq!((timing.exact_alarms, timing.other_alarms), (0, 1));
    }

    #[test]
    fn the_first_difference_is_named() {
        let pins = [event(1000, 10, 1000, true)];
        let host = [planned(0), planned(100)];
        let found = difference(&pins, &host).unwrap();
        assert_eq!(found.to_string(), "event 1: the pins are silent, the host steps -m1 -m4 -m8 -m11 at tick 100");
    }
}
