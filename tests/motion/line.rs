//! A production line for the tests: planner and step generator, without Console and Stepper.

use corehbot::motion::{Entry, Move, MoveQueue, Planner, StepEvent, StepGenerator, StepQueue, Target, Work};
use corehbot::port::{EndstopSet, MotorSet, Pend};
use corehbot::settings::Settings;
use corehbot::status::Status;
use corehbot::units::{Mm, MmPerSec};

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
    Target { position: position.map(Mm::from_num), speed: MmPerSec::from_num(speed), watch: EndstopSet::NONE }
}

/// All steps that moves from the origin become.
pub fn generate(moves: &[Move]) -> Vec<Step> {
    let status = Status::new();
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (mut moves_in, moves_out) = move_queue.split();
    let (steps_in, mut steps_out) = step_queue.split();
    let mut generator = StepGenerator::new(moves_out, steps_in, &status, Nobody);
    let mut steps = Vec::new();
    let mut tick = 0;
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
        while let Some(event) = steps_out.dequeue() {
            let StepEvent { interval, steps: motors, forward, .. } = event;
            tick += u64::from(interval);
            if !motors.is_empty() {
                steps.push(Step { tick, steps: motors, forward });
            }
            idle = 0;
        }
        if held.is_some() {
            idle = 0;
        }
    }
    steps
}
