//! A production line for the tests: planner, step generator and Stepper, without Console.

use corehbot::motion::{Entry, Move, MoveQueue, Planner, StepGenerator, StepQueue, Stepper, Target, Work};
use corehbot::port::{EndstopSet, MotorSet, Pend, StepClock, StepPort};
use corehbot::settings::Settings;
use corehbot::status::Status;
use corehbot::units::{Mm, MmPerSec, Tick};
use std::cell::Cell;

#[derive(Clone, Copy)]
struct Nobody;

impl Pend for Nobody {
    fn pend_generator(&self) {}
    fn pend_stepper(&self) {}
}

/// One step event with its tick counted up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    pub tick: u64,
    pub steps: MotorSet,
    pub forward: MotorSet,
}

/// Keeps every step.
#[derive(Default)]
struct Pins {
    forward: MotorSet,
    steps: std::rc::Rc<std::cell::RefCell<Vec<Step>>>,
}

impl StepPort for Pins {
    fn dir(&mut self, forward: MotorSet) {
        self.forward = forward;
    }

    fn rise(&mut self, steps: MotorSet, tick: u64) {
        self.steps.borrow_mut().push(Step { tick, steps, forward: self.forward });
    }

    fn fall(&mut self, _steps: MotorSet) {}

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

    fn alarm(&mut self, at: Tick) {
        self.0.set(Some(at.0));
    }

    fn silence(&mut self) {
        self.1 = self.now().0;
        self.0.set(None);
    }
}

/// All moves that targets became, released in order.
pub fn plan(targets: &[([f64; 4], f64)], settings: &Settings) -> Vec<Move> {
    let mut planner = Planner::new(settings, [Mm::ZERO; 4]);
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

pub fn target(position: [f64; 4], speed: f64) -> Target {
    let speed = MmPerSec::from_num(speed);
    Target { position: position.map(Mm::from_num), speed, has_overrides: true, watch: EndstopSet::NONE }
}

/// All steps that moves from the origin become.
pub fn generate(moves: &[Move]) -> Vec<Step> {
    let status = Status::new();
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (mut moves_in, moves_out) = move_queue.split();
    let (steps_in, steps_out) = step_queue.split();
    let mut generator = StepGenerator::new(moves_out, steps_in, &status, Nobody);
    let (pins, alarm) = (Pins::default(), Cell::new(None));
    let steps = pins.steps.clone();
    let mut stepper = Stepper::new(steps_out, &status, pins, Hurry(&alarm, 0), Nobody);
    let mut left = moves.iter();
    let mut held = left.next();
    let mut idle = 0;
    while idle < 2 {
        while let Some(m) = held {
            if moves_in.enqueue(Entry { epoch: 0, work: Work::Move(*m) }).is_err() {
                break;
            }
            held = left.next();
        }
        generator.run();
        idle += 1;
        stepper.on_alarm();
        while alarm.get().is_some() {
            stepper.on_alarm();
            idle = 0;
        }
        if held.is_some() {
            idle = 0;
        }
    }
    drop(stepper);
    steps.take()
}
