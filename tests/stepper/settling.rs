//! The end of motion: the Stepper comes to rest, and misses no event.

use crate::clock::{Clock, NoWake, Timer};
use corehbot::kinematics::{Groupings, Mechanism};
use corehbot::motion::{
    Link, MoveMemory, MoveQueue, Planner, SpanMemory, StepGenerator, StepQueue, Stepper, Target, Work,
};
use corehbot::port::{EndstopSet, GroupSet, StepPort};
use corehbot::settings::Settings;
use corehbot::status::{Overload, Status};
use corehbot::units::{Feed, Mm, Steps};

struct Pins;

impl StepPort for Pins {
    fn dir(&mut self, _forward: GroupSet) {}
    fn rise(&mut self, _steps: GroupSet, _tick: u64) {}
    fn fall(&mut self, _steps: GroupSet) {}
    fn endstops(&mut self) -> EndstopSet {
        EndstopSet::NONE
    }
}

/// The context that is too slow in a run.
#[derive(Clone, Copy, PartialEq)]
enum Sleeper {
    NoWake,
    /// The generator, once, from this alarm on until the Stepper rests.
    Generator(usize),
    /// The host: each move comes when all of the one before is played.
    Host,
    /// The Console, as it is: it hands a move on when less than 50 ms of motion are queued.
    Console,
}

/// The overload in a run of these moves.
fn overload(ways: &[([f64; 2], f64)]) -> Overload {
    overload_with(ways, Sleeper::NoWake)
}

/// The same with one context that is too slow.
fn overload_with(ways: &[([f64; 2], f64)], sleeper: Sleeper) -> Overload {
    let (clock, status, settings) = (Clock::default(), Status::new(), Settings::prototype());
    let groupings = Groupings::new(&Mechanism::corehbot());
    let (mut memory, mut spans) = (MoveMemory::new(), SpanMemory::new());
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (moves_in, moves_out) = move_queue.split();
    let (events_in, events_out) = step_queue.split();
    let mut link = Link::new(moves_in, &status, events_out.counts(&status), NoWake);
    let mut stepper = Stepper::new(events_out, &status, Pins, Timer(&clock), NoWake);
    let mut generator = StepGenerator::new(moves_out, events_in, &mut spans, &status, &groupings);
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    link.send(Work::Position([Steps::ZERO; 4]));
    for ([x, y], speed) in ways {
        let position = [Mm::from_num(*x), Mm::from_num(*y), Mm::ZERO, Mm::ZERO];
        planner.push(
            &Target { position, speed: Feed::from_num(*speed), has_overrides: false, watch: EndstopSet::NONE },
            &settings,
        );
    }
    planner.release_all();
    let is_late = matches!(sleeper, Sleeper::Host | Sleeper::Console);
    while !is_late && let Some(m) = planner.pop() {
        link.send(Work::Move(m));
    }
    let mut sleeps_from = if let Sleeper::Generator(alarm) = sleeper { Some(alarm) } else { None };
    for alarm in 0..1_000_000 {
        let is_asleep = sleeps_from.is_some_and(|from| alarm >= from);
        if !is_asleep {
            generator.run(&NoWake);
        }
        stepper.on_alarm();
        if sleeper == Sleeper::Console
            && link.left() < 500_000
            && let Some(m) = planner.pop()
        {
            link.send(Work::Move(m));
            continue;
        }
        let Some(at) = clock.alarm.get() else {
            clock.now.set(clock.now.get().wrapping_add(1_000_000));
            let next = if sleeper == Sleeper::Host { planner.pop() } else { None };
            let is_over = next.is_none() && !is_asleep;
            next.into_iter().for_each(|m| link.send(Work::Move(m)));
            sleeps_from = None;
            if is_over {
                break;
            }
            continue;
        };
        clock.now.set(at);
        if !is_asleep {
            generator.run(&NoWake);
        }
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

/// Moves that lead on without a rest, each of `length` mm, at `speed` mm/s.
fn chords(count: u32, length: f64, speed: f64) -> Vec<([f64; 2], f64)> {
    (1..=count).map(|i| ([length * f64::from(i), 0.0], speed)).collect()
}

#[test]
fn a_generator_that_sleeps_in_mid_motion_is_counted_once_whether_steps_are_quick_or_slow() {
    for (speed, alarm) in [(100.0, 40), (1.0, 40), (0.1, 20), (0.01, 3)] {
        let told = overload_with(&chords(3, 1.0, speed), Sleeper::Generator(alarm));
        assert_eq!(told, Overload { starved: 1, ..Overload::default() }, "{speed} mm/s");
    }
}

#[test]
fn a_move_that_comes_too_late_is_counted_whether_steps_are_quick_or_slow() {
    for (speed, length) in [(100.0, 5.0), (1.0, 1.0), (0.2, 0.2), (0.01, 0.02)] {
        let told = overload_with(&chords(4, length, speed), Sleeper::Host);
        assert_eq!(told, Overload { starved: 3, ..Overload::default() }, "{speed} mm/s");
    }
}

/// Reproducer: below 20 steps a second each chord counted as a lack of steps. The Console saw time pass only with the
/// steps, and handed the next move on when the last step of the one before was made.
#[test]
fn slow_moves_that_come_50_ms_ahead_are_no_lack_of_steps() {
    for (speed, length) in
        [(100.0, 5.0), (1.0, 1.0), (0.2, 0.2), (0.1, 0.05), (0.05, 0.002), (0.01, 0.02), (0.001, 0.002)]
    {
        assert_eq!(overload_with(&chords(12, length, speed), Sleeper::Console), Overload::default(), "{speed} mm/s");
    }
}
