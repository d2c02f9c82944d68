//! A script of lines and mishaps, and the steps and replies that it led to.

use corehbot::motors::{Motor, MotorSet};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::tmc2209;
use corehbot_sim::world::{Host, Outcome, Sink, run_on};
use std::collections::VecDeque;

/// An action of the host or the user, one after the other.
pub enum Act<'d> {
    /// A line to the printer; the next act waits for its `ok`.
    Say(String),
    /// Something happens to the drivers.
    Do(Box<dyn FnOnce(&Drivers) + 'd>),
}

pub fn say<'d>(line: &str) -> Act<'d> {
    Act::Say(line.to_owned())
}

pub fn act<'d>(change: impl FnOnce(&Drivers) + 'd) -> Act<'d> {
    Act::Do(Box::new(change))
}

pub struct Script<'d> {
    pub drivers: &'d Drivers,
    pub acts: VecDeque<Act<'d>>,
    pub is_awaiting: bool,
    pub heard: Vec<String>,
    /// A line that is sent without waiting once the chips have said so much.
    pub interjection: Option<(u32, &'static str)>,
    pub interjected: u64,
}

impl Host for Script<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        while !self.is_awaiting {
            match self.acts.pop_front() {
                None => return,
                Some(Act::Do(change)) => change(self.drivers),
                Some(Act::Say(line)) => {
                    out.extend(line.bytes().chain([b'\n']));
                    self.is_awaiting = true;
                }
            }
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let replies = |motor: &Motor| self.drivers.chip(*motor).replies();
        if let Some((_, line)) = self.interjection.take_if(|(at, _)| Motor::ALL.iter().map(replies).sum::<u32>() >= *at)
        {
            out.extend(line.bytes().chain([b'\n']));
            self.interjected = self.drivers.seen();
        }
    }

    fn hear(&mut self, line: &str) {
        self.is_awaiting &= !line.starts_with("ok");
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.acts.is_empty() && !self.is_awaiting
    }
}

/// Something that happens to the drivers at a step.
pub type Strike<'d> = (u64, Box<dyn FnMut(&Drivers) + 'd>);

/// Sees every step, and whether the motors were fit for it.
#[derive(Default)]
pub struct Steps<'d> {
    pub drivers: Option<&'d Drivers>,
    pub strike: Option<Strike<'d>>,
    pub struck: u64,
    pub count: u64,
    pub tick: u64,
    /// Steps of motors without power, or with a driver that makes other microsteps, before any fault.
    pub unfit: u64,
}

impl Sink for Steps<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        (self.count, self.tick) = (self.count + 1, tick);
        let Some(drivers) = self.drivers else { return };
        if let Some((_, strike)) = self.strike.as_mut().filter(|(at, _)| *at == self.count) {
            strike(drivers);
            self.struck = tick;
        }
        if self.struck == 0 {
            self.unfit += u64::from(!steps.without(drivers.enabled()).is_empty() || !drivers.astray(16).is_empty());
        }
    }
}

impl Steps<'_> {
    /// Milliseconds from the strike to the last step.
    pub fn aftermath_ms(&self) -> u64 {
        (self.tick - self.struck) / u64::from(TICKS_PER_MS)
    }
}

/// A machine that cuts all power at once whichever driver fails; `belt/limp.rs` has one that parks its tool first.
pub fn cutting() -> Settings {
    let mut settings = Settings::prototype();
    settings.belt.limp_lift = Mm::ZERO;
    settings
}

/// The result of a script.
pub struct Played<'d> {
    pub heard: Vec<String>,
    pub outcome: Outcome,
    pub steps: Steps<'d>,
    pub interjected: u64,
}

impl Played<'_> {
    pub fn has(&self, part: &str) -> bool {
        self.heard.iter().any(|line| line.contains(part))
    }

    pub fn errors(&self) -> Vec<&String> {
        self.heard.iter().filter(|line| line.starts_with("Error:")).collect()
    }
}

pub fn play<'d>(drivers: &'d Drivers, acts: Vec<Act<'d>>, strike: Option<Strike<'d>>) -> Played<'d> {
    play_with(drivers, acts, strike, None)
}

pub fn play_with<'d>(
    drivers: &'d Drivers,
    acts: Vec<Act<'d>>,
    strike: Option<Strike<'d>>,
    interjection: Option<(u32, &'static str)>,
) -> Played<'d> {
    let (acts, heard) = (acts.into(), Vec::new());
    let mut host = Script { drivers, acts, is_awaiting: false, heard, interjection, interjected: 0 };
    let mut steps = Steps { drivers: Some(drivers), strike, ..Steps::default() };
    let start = Some([Mm::ZERO; 3]);
    let outcome = run_on(&cutting(), start, NoStorage, drivers, &mut [&mut host], &mut steps).unwrap();
    assert_eq!(steps.unfit, 0);
    assert_eq!(drivers.betrayed(), MotorSet::NONE);
    Played { heard: host.heard.into_iter().skip(2).collect(), outcome, steps, interjected: host.interjected }
}

pub fn lines<'d>(lines: &[&str]) -> Vec<Act<'d>> {
    lines.iter().map(|line| say(line)).collect()
}

pub fn each(drivers: &Drivers, change: impl Fn(&mut tmc2209::Tmc2209)) {
    Motor::ALL.into_iter().for_each(|motor| change(&mut drivers.chip(motor)));
}

pub const LONG_MOVE: [&str; 2] = ["G1 X300 Y300 Z10 E20 F6000", "M400"];

pub fn script<'d>(drivers: &'d Drivers, lines: &[&str]) -> Script<'d> {
    let acts = lines.iter().map(|line| say(line)).collect();
    Script { drivers, acts, is_awaiting: false, heard: Vec::new(), interjection: None, interjected: 0 }
}
