//! A printer on the belt plant, or on the rigid rig, that is sent lines.

use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Host, Outcome, Sink, run_at};
use corehbot_twin::params::Params;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};

/// Sends each line when the previous one is answered.
pub struct Lines {
    lines: VecDeque<String>,
    is_waiting: bool,
    pub heard: Vec<String>,
}

impl Lines {
    pub fn new<'l>(lines: impl IntoIterator<Item = &'l str>) -> Self {
        let lines = lines.into_iter().map(str::to_owned).collect();
        Self { lines, is_waiting: false, heard: Vec::new() }
    }
}

impl Host for Lines {
    fn send(&mut self, out: &mut Vec<u8>) {
        if let Some(line) = (!self.is_waiting).then(|| self.lines.pop_front()).flatten() {
            out.extend(line.as_bytes());
            out.push(b'\n');
            self.is_waiting = true;
        }
    }

    fn hear(&mut self, line: &str) {
        self.is_waiting &= !line.starts_with("ok");
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && !self.is_waiting
    }
}

/// Step events: motion time, motors, and the motors that step forward.
#[derive(Default)]
pub struct Events(pub Vec<(u64, u8, u8)>);

impl Sink for Events {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.push((tick, steps.0, forward.0 & steps.0));
    }
}

/// The result of a print.
pub struct Printed {
    pub events: Vec<(u64, u8, u8)>,
    pub outcome: Outcome,
    pub heard: Vec<String>,
    pub drivers: Drivers,
}

/// On a rigid machine, or on this plant.
pub fn print_on(plant: &mut Option<Box<BeltPlant>>, start: Option<[f64; 3]>, lines: &[&str]) -> Printed {
    print_as(&Settings::prototype(), plant, start, lines)
}

/// The same with other settings.
pub fn print_as(
    settings: &Settings,
    plant: &mut Option<Box<BeltPlant>>,
    start: Option<[f64; 3]>,
    lines: &[&str],
) -> Printed {
    let (mut host, mut events, drivers) = (Lines::new(lines.iter().copied()), Events::default(), Drivers::new());
    let mut desk = Desk::new(1);
    desk.belt = plant.take();
    let start = start.map(|start| start.map(Mm::from_num));
    let outcome = run_at(&mut desk, settings, start, NoStorage, &drivers, &mut [&mut host], &mut events).unwrap();
    *plant = desk.belt.take();
    Printed { events: events.0, outcome, heard: host.heard, drivers }
}

/// A CoreH-bot as it is switched on, with the tool at a known place or somewhere.
pub fn plant(start: Option<[f64; 3]>, seed: Option<u64>, accidents: Accidents) -> Option<Box<BeltPlant>> {
    let setup = BeltSetup { seed, accidents, ..BeltSetup::default() };
    let place = start.map(|start| start.map(Mm::from_num));
    Some(Box::new(BeltPlant::new(&Settings::prototype(), place, start.is_some(), setup, 0).unwrap()))
}

/// Prints on a plant without phases, and hands the plant back.
pub fn print(start: Option<[f64; 3]>, accidents: Accidents, lines: &[&str]) -> (Printed, Box<BeltPlant>) {
    let mut plant = plant(start, None, accidents);
    let printed = print_on(&mut plant, start, lines);
    (printed, plant.unwrap())
}

/// A CoreH-bot with a belt of another stiffness.
pub fn plant_of(params: Params, start: [f64; 3], seed: u64, accidents: Accidents) -> Option<Box<BeltPlant>> {
    let setup = BeltSetup { twin: params.into(), seed: Some(seed), accidents };
    let place = Some(start.map(Mm::from_num));
    Some(Box::new(BeltPlant::new(&Settings::prototype(), place, true, setup, 0).unwrap()))
}

/// The number of seeds of a study: a few, or the number from the soak.
pub fn seeds(few: u64) -> std::ops::Range<u64> {
    let asked = std::env::var("COREHBOT_SOAK_SEEDS").ok().map(|text| text.parse().unwrap());
    0..asked.unwrap_or(few)
}

/// Does the work of each seed on all processors; in the order of the seeds.
pub fn of_each<T: Send>(seeds: std::ops::Range<u64>, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let next = AtomicU64::new(seeds.start);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return done;
            }
            done.push((seed, work(seed)));
        }
    };
    let mut all: Vec<(u64, T)> = std::thread::scope(|scope| {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(worker)).collect();
        handles.into_iter().flat_map(|handle| handle.join().unwrap()).collect()
    });
    all.sort_by_key(|(seed, _)| *seed);
    all.into_iter().map(|(_, done)| done).collect()
}
