//! The end of motion: the Stepper comes to rest, and misses nothing.

use super::clock::{Clock, Nobody, Timer};
use corehbot::kinematics::{Groupings, Mechanism};
use corehbot::motion::{
    Link, MoveMemory, MoveQueue, Planner, SpanMemory, StepGenerator, StepQueue, Stepper, Target, Work,
};
use corehbot::port::{EndstopSet, GroupSet, StepPort};
use corehbot::settings::Settings;
use corehbot::status::{Overload, Status};
use corehbot::units::{Mm, MmPerSec, Steps};

struct Pins;

impl StepPort for Pins {
    fn dir(&mut self, _forward: GroupSet) {}
    fn rise(&mut self, _steps: GroupSet, _tick: u64) {}
    fn fall(&mut self, _steps: GroupSet) {}
    fn endstops(&mut self) -> EndstopSet {
        EndstopSet::NONE
    }
}

/// What was too slow in a run of these moves, which the generator always makes in time.
fn overload(ways: &[([f64; 2], f64)]) -> Overload {
    let (clock, status, settings) = (Clock::default(), Status::new(), Settings::prototype());
    let groupings = Groupings::new(&Mechanism::corehbot());
    let (mut memory, mut spans) = (MoveMemory::new(), SpanMemory::new());
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (moves_in, moves_out) = move_queue.split();
    let (events_in, events_out) = step_queue.split();
    let mut link = Link::new(moves_in, &status, events_out.counts(&status), Nobody);
    let mut stepper = Stepper::new(events_out, &status, Pins, Timer(&clock), Nobody);
    let mut generator = StepGenerator::new(moves_out, events_in, &mut spans, &status, &groupings);
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    link.send(Work::Position([Steps::ZERO; 4]));
    for ([x, y], speed) in ways {
        let position = [Mm::from_num(*x), Mm::from_num(*y), Mm::ZERO, Mm::ZERO];
        planner.push(
            &Target { position, speed: MmPerSec::from_num(*speed), has_overrides: false, watch: EndstopSet::NONE },
            &settings,
        );
    }
    planner.release_all();
    while let Some(m) = planner.pop() {
        link.send(Work::Move(m));
    }
    for _ in 0..1_000_000 {
        generator.run(&Nobody);
        stepper.on_alarm();
        let Some(at) = clock.alarm.get() else { break };
        clock.now.set(at);
        generator.run(&Nobody);
        stepper.on_alarm();
    }
    assert!(link.is_idle(), "{ways:?}");
    status.overload()
}

/// Reproducer: a last step at the very end of the motion was taken for a queue that had run dry.
#[test]
fn an_end_on_a_step_is_no_lack_of_steps() {
    for i in 1..=600u32 {
        let half_steps = |n: u32| f64::from(n) / 160.0;
        let speed = 5.0 + f64::from(i % 97) * 1.3;
        let first = [half_steps(i), half_steps(i % 5)];
        let second = [half_steps(i + i % 7), half_steps(i % 3)];
        assert_eq!(overload(&[(first, speed), (second, speed)]), Overload::default(), "program {i}");
        assert_eq!(overload(&[(first, speed)]), Overload::default(), "program {i}");
    }
}
