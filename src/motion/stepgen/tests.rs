//! Tests of stepgen.

use super::{BATCH, LEAST_ROOM, LONGEST_INTERVAL, SCRUB, StepGenerator, SubTicks, TURN_AHEAD};
use crate::fault::Cause;
use crate::kinematics::Groupings;
use crate::motion::planner::{Planner, Target};
use crate::motion::trajectory::{ADVANCE, AXES, Tap};
use crate::motion::work::{Entry, Work};
use crate::motion::{MoveMemory, MoveQueue, SpanMemory, StepQueue};
use crate::port::{EndstopSet, Wake};
use crate::settings::Settings;
use crate::status::Status;
use crate::units::{Feed, Mm, StepsPerMm};

struct NoWake;

impl Wake for NoWake {
    fn wake_generator(&self) {}
    fn wake_stepper(&self) {}
}

#[test]
fn f40_a_tap_that_changes_by_itself_is_found_before_the_count_of_calls_wraps() {
    let groupings = Groupings::new(&Settings::prototype().mechanism);
    for (axis, bit) in (0..ADVANCE).flat_map(|axis| (0..32).map(move |bit| (axis, bit))) {
        let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
        let ((_, moves_out), (steps_in, _)) = (move_queue.split(), step_queue.split());
        let (mut spans, status) = (SpanMemory::new(), Status::new());
        let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
        let call_for_each_axis = |generator: &mut StepGenerator<'_>| {
            (0..AXES * usize::from(SCRUB)).for_each(|_| _ = generator.run(&NoWake));
            status.fault().fault().map(|fault| fault.cause)
        };
        assert_eq!(call_for_each_axis(&mut generator), None);
        if let Some(tap) = generator.trajectory.damage(axis) {
            *tap = if bit % 2 == 0 {
                Tap { delay: tap.delay ^ 1 << bit, ..*tap }
            } else {
                Tap { weight: f32::from_bits(tap.weight.to_bits() ^ 1 << bit), ..*tap }
            };
        }
        assert_eq!(call_for_each_axis(&mut generator), Some(Cause::SettingsDamaged), "axis {axis}, bit {bit}");
    }
}

#[test]
fn the_console_is_told_what_it_may_wait_for_and_not_of_every_call() {
    let groupings = Groupings::new(&Settings::prototype().mechanism);
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let ((mut moves_in, moves_out), (steps_in, mut steps_out)) = (move_queue.split(), step_queue.split());
    let (mut spans, status) = (SpanMemory::new(), Status::new());
    let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    let mut passed = 0u64;
    // One life after another: each begins with an entry that is taken, and ends with one that is done, and rest.
    for _ in 0..3 {
        assert!(generator.run(&NoWake), "at rest there is nothing else to tell");
        let work = Work::Dwell(SubTicks::of_ticks(100 * u64::from(LONGEST_INTERVAL)));
        assert!(moves_in.enqueue(Entry { epoch: 0, work }).is_ok());
        let (mut is_done, mut told, mut calls) = (false, 0, 0);
        while !is_done {
            let before = (moves_in.len(), status.entries_done());
            let is_told = generator.run(&NoWake);
            let has_moved = (moves_in.len(), status.entries_done()) != before;
            assert!(is_told || !has_moved, "an entry was taken or is done");
            (told, calls) = (told + u32::from(is_told), calls + 1);
            if let Some(event) = steps_out.dequeue() {
                passed += u64::from(event.interval);
                status.event_played(passed as u32);
            } else {
                is_done = moves_in.is_empty() && !has_moved;
            }
        }
        assert!(calls > 10 && 2 * told < calls + 6, "told {told} times in {calls} calls");
        assert!(generator.run(&NoWake));
    }
}

#[test]
fn a_dwell_passes_to_the_tick_in_events_without_steps() {
    // Shorter than one event can be, as long, and longer.
    let longest = u64::from(LONGEST_INTERVAL);
    for ticks in [1, longest - 1, longest, longest + 1, 3 * longest + 7] {
        let groupings = Groupings::new(&Settings::prototype().mechanism);
        let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
        let ((mut moves_in, moves_out), (steps_in, mut steps_out)) = (move_queue.split(), step_queue.split());
        let (mut spans, status) = (SpanMemory::new(), Status::new());
        let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
        let work = Work::Dwell(SubTicks::of_ticks(ticks));
        assert!(moves_in.enqueue(Entry { epoch: 0, work }).is_ok());
        let mut passed = 0u64;
        for _ in 0..10 {
            generator.make_events();
            for event in core::iter::from_fn(|| steps_out.dequeue()) {
                passed += u64::from(event.interval);
                status.event_played(passed as u32);
            }
        }
        assert_eq!(passed, ticks);
    }
}

#[test]
fn the_lines_of_direction_turn_a_set_time_before_the_first_step() {
    let settings = Settings::prototype();
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    let position = [Mm::const_from_int(10), Mm::ZERO, Mm::ZERO, Mm::ZERO];
    let speed = Feed::const_from_int(50);
    planner.push(&Target { position, speed, has_overrides: false, watch: EndstopSet::NONE }, &settings);
    planner.release_all();
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let ((mut moves_in, moves_out), (steps_in, mut steps_out)) = (move_queue.split(), step_queue.split());
    let (mut spans, status, groupings) = (SpanMemory::new(), Status::new(), Groupings::new(&settings.mechanism));
    let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    if let Some(m) = planner.pop() {
        assert!(moves_in.enqueue(Entry { epoch: 0, work: Work::Move(m) }).is_ok());
    }
    (0..10).for_each(|_| _ = generator.make_events());
    let [turn, step] =
        [steps_out.dequeue(), steps_out.dequeue()].map(|event| event.map(|e| (e.steps.is_empty(), e.interval)));
    assert!(turn.is_some_and(|(is_without_steps, _)| is_without_steps), "{turn:?}");
    assert_eq!(step, Some((false, TURN_AHEAD)));
}

/// Reproducer: at 300,000 events a second the generator filled every slot as the Stepper freed it, one event a
/// call. This took four times as long as usual and left the Console no time.
#[test]
fn a_queue_that_is_nearly_full_is_left_alone() {
    let mut settings = Settings::prototype();
    settings.axes.x.steps_per_mm = StepsPerMm::const_from_int(640);
    settings.axes.y.steps_per_mm = StepsPerMm::const_from_int(640);
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    let position = [Mm::const_from_int(60), Mm::const_from_int(25), Mm::ZERO, Mm::ZERO];
    let speed = Feed::const_from_int(300);
    planner.push(&Target { position, speed, has_overrides: false, watch: EndstopSet::NONE }, &settings);
    planner.release_all();
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (mut moves_in, moves_out) = move_queue.split();
    let (steps_in, mut steps_out) = step_queue.split();
    let (mut spans, status, groupings) = (SpanMemory::new(), Status::new(), Groupings::new(&settings.mechanism));
    let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    if let Some(m) = planner.pop() {
        assert!(moves_in.enqueue(Entry { epoch: 0, work: Work::Move(m) }).is_ok());
    }
    let mut tick = 0u32;
    let mut play = |count: usize| {
        for event in core::iter::from_fn(|| steps_out.dequeue()).take(count) {
            tick = tick.wrapping_add(event.interval);
            status.event_played(tick);
        }
    };
    // Up to full speed, where the queue is full before it reaches far enough ahead.
    for _ in 0..300 {
        generator.make_events();
        play(100);
    }
    for _ in 0..5 {
        generator.make_events();
    }
    let full = generator.events.len();
    assert!(generator.events.room() < LEAST_ROOM, "{full} events");
    play(10);
    generator.make_events();
    assert_eq!(generator.events.len(), full - 10, "too few slots to begin with");
    play(200);
    generator.make_events();
    assert_eq!(generator.events.len(), full - 210 + BATCH as usize);
}
