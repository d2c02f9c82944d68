//! A production line for the tests: planner, step generator and Stepper, without Console.

use corehbot::kinematics::{Groupings, MotorTable};
use corehbot::motion::{
    Entry, Move, MoveMemory, MoveQueue, Planner, SpanMemory, StepGenerator, StepQueue, Stepper, SurfaceFrame, Target,
    Work, advance_window, stiffenings, surface_work, taps,
};
use corehbot::port::{EndstopSet, GroupSet, MotorSet, StepClock, StepPort, Wake};
use corehbot::settings::Settings;
use corehbot::status::Status;
use corehbot::surface::Mesh;
use corehbot::units::{Feed, Mm, Seconds, Steps, Tick};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

#[derive(Clone, Copy)]
struct NoWake;

impl Wake for NoWake {
    fn wake_generator(&self) {}
    fn wake_stepper(&self) {}
}

/// One step event with its tick counted up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    pub tick: u64,
    pub steps: MotorSet,
    pub forward: MotorSet,
}

/// Keeps every step.
struct Pins {
    table: MotorTable,
    forward: MotorSet,
    steps: Rc<RefCell<Vec<Step>>>,
}

impl StepPort for Pins {
    fn dir(&mut self, forward: GroupSet) {
        self.forward = self.table.forward_motors(forward);
    }

    fn rise(&mut self, steps: GroupSet, tick: u64) {
        let steps = self.table.motors(steps);
        self.steps.borrow_mut().push(Step { tick, steps, forward: self.forward });
    }

    fn fall(&mut self, _steps: GroupSet) {}

    fn endstops(&mut self) -> EndstopSet {
        EndstopSet::NONE
    }
}

/// A clock in which it is always time for the next alarm.
struct Hurry<'a>(&'a Cell<Option<u32>>, u32);

impl StepClock for Hurry<'_> {
    fn now(&self) -> Tick {
        Tick(self.0.get().unwrap_or(self.1))
    }

    fn alarm(&mut self, at: Tick) -> bool {
        self.0.set(Some(at.0));
        true
    }

    fn silence(&mut self) {
        self.1 = self.now().0;
        self.0.set(None);
    }
}

/// All moves that targets became, released in order.
pub fn plan(targets: &[([f64; 4], f64)], settings: &Settings) -> Vec<Move> {
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, settings, [Mm::ZERO; 4]);
    let mut moves = Vec::new();
    for (position, speed) in targets {
        if !planner.has_room() {
            planner.release_some();
            moves.extend(std::iter::from_fn(|| planner.pop()));
        }
        planner.push(&target(*position, *speed), settings);
    }
    planner.release_all();
    moves.extend(std::iter::from_fn(|| planner.pop()));
    moves
}

/// The same for a stream, with chords joined where they are one line.
pub fn stream(targets: &[([f64; 4], f64)], settings: &Settings) -> Vec<Move> {
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, settings, [Mm::ZERO; 4]);
    let mut moves = Vec::new();
    for (position, speed) in targets {
        while !planner.has_room() {
            if !planner.has_ready() && !planner.close_line(settings) {
                planner.release_some();
            }
            moves.extend(std::iter::from_fn(|| planner.pop()));
        }
        planner.add(&target(*position, *speed), settings);
    }
    planner.close_line(settings);
    planner.release_all();
    moves.extend(std::iter::from_fn(|| planner.pop()));
    moves
}

pub fn target(position: [f64; 4], speed: f64) -> Target {
    let speed = Feed::from_num(speed);
    Target { position: position.map(Mm::from_num), speed, has_overrides: true, watch: EndstopSet::NONE }
}

/// All steps that moves from the origin become.
pub fn generate(moves: &[Move]) -> Vec<Step> {
    generate_on(moves, &Settings::prototype())
}

/// The same on the mechanism of `settings`.
pub fn generate_on(moves: &[Move], settings: &Settings) -> Vec<Step> {
    generate_from(moves.iter().map(|m| Work::Move(*m)), settings)
}

/// All steps that moves from the origin become with the input shapers and the pressure advance of `settings`.
pub fn generate_shaped(moves: &[Move], settings: &Settings) -> Vec<Step> {
    generate_from(shaping(settings).chain(moves.iter().map(|m| Work::Move(*m))), settings)
}

/// The window of the pressure advance, if there is one.
pub fn window(settings: &Settings) -> Option<Seconds> {
    (settings.advance.time > Seconds::ZERO).then(|| advance_window(settings))
}

/// The work that makes axes follow the input shapers and the pressure advance of `settings`.
pub fn shaping(settings: &Settings) -> impl Iterator<Item = Work> {
    let follow = taps(&settings.shapers, window(settings))
        .into_iter()
        .enumerate()
        .map(|(axis, taps)| Work::Follow(axis as u8, taps));
    let stiffen = stiffenings(settings).into_iter().enumerate().map(|(axis, law)| Work::Stiffen(axis as u8, law));
    stiffen.chain(follow)
}

/// The work that makes z follow a mesh, on which the machine stands at the origin.
pub fn on_mesh(mesh: &Mesh, s: &Settings) -> impl Iterator<Item = Work> {
    let resolutions = [s.axes.x, s.axes.y, s.axes.z].map(|axis| axis.steps_per_mm);
    surface_work(SurfaceFrame::new(mesh, resolutions), mesh.heights()).chain([Work::Position([Steps::ZERO; 4])])
}

/// The largest number of Stepper calls without a step.
const MOST_CALLS: usize = 100_000;

pub fn generate_from(work: impl Iterator<Item = Work>, settings: &Settings) -> Vec<Step> {
    let (status, groupings) = (Status::new(), Groupings::new(&settings.mechanism));
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (mut moves_in, moves_out) = move_queue.split();
    let (steps_in, steps_out) = step_queue.split();
    let mut spans = SpanMemory::new();
    let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    let pins =
        Pins { table: MotorTable::new(&groupings.tool.coupling()), forward: MotorSet::NONE, steps: Rc::default() };
    let alarm = Cell::new(None);
    let steps = pins.steps.clone();
    let mut stepper = Stepper::new(steps_out, &status, pins, Hurry(&alarm, 0), NoWake);
    let mut left = work;
    let mut held = left.next();
    let mut idle = 0;
    // Steps so far, and calls in a row that made none.
    let (mut made, mut stalled) = (0, 0);
    let mut has_called = || {
        let count = steps.borrow().len();
        stalled = if count > made { 0 } else { stalled + 1 };
        made = count;
        assert!(stalled < MOST_CALLS, "no further step comes");
    };
    while idle < 2 {
        while let Some(work) = held.take() {
            if let Err(entry) = moves_in.enqueue(Entry { epoch: 0, work }) {
                held = Some(entry.work);
                break;
            }
            held = left.next();
        }
        generator.run(&NoWake);
        idle += 1;
        stepper.on_alarm();
        has_called();
        while alarm.get().is_some() {
            stepper.on_alarm();
            has_called();
            idle = 0;
        }
        if held.is_some() {
            idle = 0;
        }
    }
    drop(stepper);
    steps.take()
}
