//! The life of a machine: lines are said one after the other, time passes, and moving and warm parts are checked.

use corehbot::motors::{EndstopSet, MOTORS, Motor, MotorSet};
use corehbot::port::{NoStorage, Storage};
use corehbot::settings::Settings;
use corehbot::surface::Mesh;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_rig::bed::BedPlant;
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::plant::SensorFault;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, HeatPeriod, Sink, World};
use std::cell::RefCell;

/// So long a line may take, in ms.
const PATIENCE_MS: u64 = 600_000;

/// Step events as they come: the tick, the motors that step, and the motors that step forward.
#[derive(Default)]
struct Seen {
    events: Vec<(u64, u32, u32)>,
    heat: Option<HeatPeriod>,
}

struct Recorder<'a>(&'a RefCell<Seen>);

impl Sink for Recorder<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.borrow_mut().events.push((tick, u32::from(steps.0), u32::from(forward.0 & steps.0)));
    }

    fn heat(&mut self, period: &HeatPeriod) {
        self.0.borrow_mut().heat = Some(*period);
    }
}

/// A machine that lives.
pub struct Life<'w> {
    world: World<'w>,
    drivers: &'w Drivers,
    seen: &'w RefCell<Seen>,
    partial: Vec<Vec<u8>>,
    /// The lines that the current host has heard.
    pub heard: Vec<String>,
    all: Vec<Vec<String>>,
    /// Lines that were answered, and answers that were taken for lines.
    answered: Vec<usize>,
    taken: Vec<usize>,
    host: usize,
    mark: (usize, i32),
}

/// Runs `body` on a machine that stands at X100 Y100 Z50 as if homed, with `hosts` hosts.
pub fn live(settings: &Settings, hosts: usize, body: impl FnOnce(&mut Life<'_>)) {
    live_at(settings, Some([100, 100, 50].map(Mm::from_num)), hosts, body);
}

/// The same of one that stands there, or somewhere.
pub fn live_at(settings: &Settings, start: Option<[Mm; 3]>, hosts: usize, body: impl FnOnce(&mut Life<'_>)) {
    live_on(settings, start, None, hosts, body);
}

/// The same on a mesh that z follows.
pub fn live_on(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    mesh: Option<Mesh>,
    hosts: usize,
    body: impl FnOnce(&mut Life<'_>),
) {
    let mut desk = Desk::new(hosts);
    desk.mesh = mesh;
    live_with(settings, start, (&mut desk, hosts), NoStorage, body);
}

/// The same of one with these surroundings, which outlive it.
pub fn live_with(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    (desk, hosts): (&mut Desk, usize),
    storage: impl Storage,
    body: impl FnOnce(&mut Life<'_>),
) {
    let (drivers, seen) = (Drivers::new(), RefCell::new(Seen::default()));
    let mut sink = Recorder(&seen);
    let world = World::new(desk, settings, start, storage, &drivers, &mut sink);
    let mut life = Life {
        world,
        drivers: &drivers,
        seen: &seen,
        partial: vec![Vec::new(); hosts],
        heard: Vec::new(),
        all: vec![Vec::new(); hosts],
        answered: vec![0; hosts],
        taken: vec![0; hosts],
        host: 0,
        mark: (0, 0),
    };
    life.rest(200);
    body(&mut life);
}

impl Life<'_> {
    fn turn(&mut self) {
        self.world.poll();
        for (host, partial) in self.partial.iter_mut().enumerate() {
            partial.extend(self.world.wires()[host].heard());
            while let Some(end) = partial.iter().position(|byte| *byte == b'\n') {
                let line = String::from_utf8(partial.drain(..=end).collect()).unwrap().trim_end().to_owned();
                self.answered[host] += usize::from(line.starts_with("ok"));
                let to = if host == self.host { &mut self.heard } else { &mut self.all[host] };
                to.push(line);
            }
        }
        self.world.advance();
    }

    /// Time passes.
    pub fn rest(&mut self, ms: u64) {
        let until = self.world.now() + ms * u64::from(TICKS_PER_MS);
        while self.world.now() < until {
            self.turn();
        }
    }

    /// From now on the other host is spoken to and heard.
    pub fn switch_to(&mut self, host: usize) {
        self.all[self.host] = std::mem::take(&mut self.heard);
        self.host = host;
        self.heard = std::mem::take(&mut self.all[host]);
    }

    /// Puts a line on a wire, whatever was answered.
    pub fn put(&mut self, host: usize, line: &str) {
        self.world.wires()[host].put(format!("{line}\n").into_bytes());
    }

    /// The time in ticks.
    pub fn now(&self) -> u64 {
        self.world.now()
    }

    /// How many lines were answered.
    pub fn oks(&self) -> usize {
        self.answered[self.host]
    }

    /// Answers so far belong to lines from another source.
    pub fn forget_answers(&mut self) {
        self.taken[self.host] = self.oks();
    }

    /// The next answer comes.
    pub fn await_ok(&mut self) {
        self.await_within(PATIENCE_MS);
    }

    fn await_within(&mut self, ms: u64) {
        let until = self.world.now() + ms * u64::from(TICKS_PER_MS);
        while self.oks() == self.taken[self.host] {
            assert!(self.world.now() < until, "no answer: {:#?}", self.last_heard());
            self.turn();
        }
        self.taken[self.host] += 1;
    }

    /// The last lines, without those that come by themselves.
    fn last_heard(&self) -> Vec<&String> {
        let mut told: Vec<_> = self.heard.iter().filter(|line| !line.starts_with("echo:busy")).collect();
        told.split_off(told.len().saturating_sub(20))
    }

    /// Says a line, and waits for its answer.
    pub fn say(&mut self, line: &str) {
        self.say_within(line, PATIENCE_MS);
    }

    pub fn say_within(&mut self, line: &str, ms: u64) {
        self.put(self.host, line);
        self.await_within(ms);
    }

    /// The first line of the answer that begins so.
    pub fn ask(&mut self, line: &str, begin: &str) -> String {
        let before = self.heard.len();
        self.say("M400");
        self.say(line);
        self.heard[before..].iter().find(|line| line.starts_with(begin)).unwrap().clone()
    }

    /// How many lines begin so.
    pub fn count(&self, begin: &str) -> usize {
        self.heard.iter().filter(|line| line.starts_with(begin)).count()
    }

    /// Steps that the extruder has made.
    pub fn extruder_steps(&self) -> i32 {
        self.counts()[6]
    }

    /// Steps that the motors have made.
    pub fn counts(&self) -> [i32; MOTORS] {
        self.world.outcome().counts
    }

    /// The wires of these switches break.
    pub fn unplug(&self, switches: EndstopSet) {
        self.world.unplug(switches);
    }

    /// From here on, steps are checked.
    pub fn mark(&mut self) {
        self.mark = (self.seen.borrow().events.len(), self.extruder_steps());
    }

    pub fn extruder_since_mark(&self) -> i32 {
        self.extruder_steps() - self.mark.1
    }

    /// Step events since the mark, with ticks from the first one on.
    pub fn events(&self) -> Vec<(u64, u32, u32)> {
        let seen = self.seen.borrow();
        let events = &seen.events[self.mark.0..];
        let begin = events.first().map_or(0, |(tick, ..)| *tick);
        events.iter().map(|(tick, steps, forward)| (tick - begin, *steps, *forward)).collect()
    }

    /// Whether the motors have power.
    pub fn has_power(&self) -> bool {
        !self.drivers.enabled().is_empty()
    }

    /// The motors that have power.
    pub fn powered(&self) -> Vec<usize> {
        self.drivers.enabled().iter().map(Motor::index).collect()
    }

    fn heat(&self) -> HeatPeriod {
        self.seen.borrow().heat.unwrap()
    }

    /// The targets of hotend and bed, once they are known.
    pub fn targets(&mut self) -> [f64; 2] {
        self.rest(100);
        [0, 1].map(|place| self.heat().heaters[place].unwrap().target.to_num())
    }

    pub fn duties(&self) -> [u16; 2] {
        [0, 1].map(|place| self.heat().heaters[place].unwrap().duty)
    }

    /// Duty of the part fan, of 255, after its kick.
    pub fn part_fan(&mut self) -> u16 {
        self.rest(2000);
        self.heat().fans[0] / 257
    }

    /// The hotend's temperature.
    pub fn celsius(&self) -> f64 {
        self.heat().heaters[0].unwrap().measured.unwrap().to_num()
    }

    /// The probe breaks, or is mended.
    pub fn fail_probe(&mut self, fault: ProbeFault) {
        self.world.bed().unwrap().fail(fault);
    }

    /// The bed, and its probe.
    pub fn bed(&mut self) -> &mut BedPlant {
        self.world.bed().unwrap()
    }

    /// Where the nozzle is, in mm.
    pub fn nozzle(&mut self) -> [f64; 3] {
        self.world.nozzle()
    }

    pub fn open_hotend_sensor(&mut self) {
        self.world.heat().plant().unwrap().faults().hotend_sensor = SensorFault::Open;
    }

    pub fn is_halted(&self) -> bool {
        self.world.outcome().halted
    }
}
