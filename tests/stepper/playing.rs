//! The stepper on its pins: its effect on the lines, the order, and the times.

use crate::clock::{Clock, NoWake, Timer};
use corehbot::kinematics::{Groupings, Mechanism};
use corehbot::motion::{
    Entry, Link, MoveMemory, MoveQueue, Planner, SpanMemory, StepEvent, StepGenerator, StepQueue, Stepper, Target, Work,
};
use corehbot::motors::prototype;
use corehbot::port::{EndstopSet, GroupSet, MotorSet, StepPort};
use corehbot::settings::Settings;
use corehbot::status::{Late, Overload, Status};
use corehbot::units::{Feed, Mm};
use std::cell::{Cell, RefCell};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    Dir(u8),
    Rise(u8, u64, u32),
    Fall(u8),
}

/// Pins and a clock that can be read from outside.
#[derive(Default)]
struct Bench {
    clock: Clock,
    pressed: Cell<u8>,
    lines: RefCell<Vec<Line>>,
}

struct Pins<'b>(&'b Bench);

fn machine() -> Groupings {
    Groupings::new(&Mechanism::corehbot())
}

impl StepPort for Pins<'_> {
    fn dir(&mut self, forward: GroupSet) {
        self.0.lines.borrow_mut().push(Line::Dir(machine().tool.coupling().forward_motors(forward).0));
    }

    fn rise(&mut self, steps: GroupSet, tick: u64) {
        self.0.lines.borrow_mut().push(Line::Rise(
            machine().tool.coupling().motors(steps).0,
            tick,
            self.0.clock.now.get(),
        ));
    }

    fn fall(&mut self, steps: GroupSet) {
        self.0.lines.borrow_mut().push(Line::Fall(machine().tool.coupling().motors(steps).0));
    }

    fn endstops(&mut self) -> EndstopSet {
        EndstopSet(self.0.pressed.get())
    }
}

/// The group of v = x - y: motor 8 turns with it, motor 1 against it.
const V: GroupSet = GroupSet(2);
/// The motors of that group.
const PAIR: MotorSet = MotorSet::of(prototype::M1).with(MotorSet::of(prototype::M8));
/// Where v falls, and where it grows.
const DOWN: GroupSet = GroupSet::NONE;
const UP: GroupSet = V;

fn event(interval: u32, steps: GroupSet, forward: GroupSet) -> StepEvent {
    StepEvent { interval, steps, forward, epoch: 0, watch: EndstopSet::NONE }
}

/// Plays `events` from the clock's `start`, each alarm rung as late as `delay` says for that ring.
fn play(bench: &Bench, status: &Status, events: &[StepEvent], start: u32, delay: impl Fn(usize) -> u32) -> u64 {
    let mut queue = StepQueue::new();
    let (mut events_in, events_out) = queue.split();
    bench.clock.now.set(start);
    let mut stepper = Stepper::new(events_out, status, Pins(bench), Timer(&bench.clock), NoWake);
    for event in events {
        events_in.enqueue(*event).unwrap();
    }
    stepper.on_alarm();
    for ring in 0..10 * events.len() + 10 {
        let Some(alarm) = bench.clock.alarm.get() else {
            break;
        };
        let wait = (alarm.wrapping_sub(bench.clock.now.get()) as i32).max(0) as u32;
        bench.clock.now.set(bench.clock.now.get().wrapping_add(wait).wrapping_add(delay(ring)));
        stepper.on_alarm();
    }
    assert_eq!(bench.clock.alarm.get(), None, "the stepper rests when all is played");
    stepper.tick()
}

fn rises(bench: &Bench) -> Vec<(u64, u32)> {
    let lines = bench.lines.borrow();
    lines.iter().filter_map(|l| if let Line::Rise(_, tick, at) = l { Some((*tick, *at)) } else { None }).collect()
}

#[test]
fn the_direction_is_set_before_the_step_and_every_pulse_ends() {
    let (bench, status) = (Bench::default(), Status::new());
    let events = [event(1000, V, DOWN), event(500, V, DOWN), event(500, V, UP), event(100, GroupSet::NONE, UP)];
    play(&bench, &status, &events, 0, |_| 0);
    let lines: Vec<Line> = bench.lines.borrow().iter().skip(1).copied().collect();
    assert_eq!(
        lines,
        [
            Line::Rise(PAIR.0, 1000, 1000),
            Line::Fall(PAIR.0),
            Line::Rise(PAIR.0, 1500, 1500),
            Line::Fall(PAIR.0),
            Line::Dir(machine().tool.coupling().forward_motors(UP).0),
            Line::Rise(PAIR.0, 2000, 2000),
            Line::Fall(PAIR.0),
        ]
    );
}

#[test]
fn steps_are_on_time_across_the_wrap_of_the_clock() {
    let (bench, status) = (Bench::default(), Status::new());
    let events: Vec<StepEvent> =
        (0..20).map(|_| event(1 << 29, V, DOWN)).chain([event(1, GroupSet::NONE, DOWN)]).collect();
    let tick = play(&bench, &status, &events, u32::MAX - 5, |_| 0);
    for (i, (tick, at)) in rises(&bench).into_iter().enumerate() {
        let due = (i as u64 + 1) << 29;
        assert_eq!(tick, due, "motion time has 64 bits");
        assert_eq!(at, (u32::MAX - 5).wrapping_add(due as u32), "the clock has 32");
    }
    assert_eq!(tick, (20u64 << 29) + 1);
}

#[test]
fn a_late_interrupt_stretches_time_and_is_counted() {
    let (bench, status) = (Bench::default(), Status::new());
    let events: Vec<StepEvent> =
        (0..10).map(|_| event(1000, V, DOWN)).chain([event(1, GroupSet::NONE, DOWN)]).collect();
    play(&bench, &status, &events, 0, |ring| if ring == 4 { 700 } else { 0 });
    let rises = rises(&bench);
    let ticks: Vec<u64> = rises.iter().map(|(tick, _)| *tick).collect();
    assert_eq!(ticks, (1..=10).map(|i| i * 1000).collect::<Vec<_>>(), "the trace does not change");
    let gaps: Vec<u32> = rises.windows(2).map(|w| w[1].1 - w[0].1).collect();
    assert!(gaps.iter().all(|g| *g >= 1000), "no two steps are closer than planned: {gaps:?}");
    assert_eq!(gaps.iter().filter(|g| **g == 1700).count(), 1);
    assert_eq!(status.overload(), Overload { events: Late { count: 1, worst: 700 }, ..Overload::default() });
}

/// The bound is 10 us, to the tick.
#[test]
fn ten_microseconds_late_is_made_good_and_a_tick_more_is_not() {
    for (late, shift, count) in [(100, 0, 0), (101, 101, 1)] {
        let (bench, status) = (Bench::default(), Status::new());
        let events: Vec<StepEvent> =
            (0..10).map(|_| event(1000, V, DOWN)).chain([event(1, GroupSet::NONE, DOWN)]).collect();
        play(&bench, &status, &events, 0, |ring| if ring == 4 { late } else { 0 });
        let (tick, at) = rises(&bench)[9];
        assert_eq!((tick, at), (10_000, 10_000 + shift), "{late} ticks late");
        assert_eq!(status.overload().events, Late { count, worst: shift });
    }
}

/// Another waiting interrupt gets the processor between two events, even if many are due.
#[test]
fn many_events_that_are_due_at_once_leave_the_processor_in_between() {
    for (steps, most, pause) in [(V, 9, 50), (GroupSet::NONE, 9, 50)] {
        let (bench, status) = (Bench::default(), Status::new());
        let mut queue = StepQueue::new();
        let (mut events_in, events_out) = queue.split();
        let mut stepper = Stepper::new(events_out, &status, Pins(&bench), Timer(&bench.clock), NoWake);
        for _ in 0..90 {
            events_in.enqueue(event(1, steps, DOWN)).unwrap();
        }
        stepper.on_alarm();
        bench.clock.now.set(bench.clock.alarm.get().unwrap() + 90);
        let mut breaks = 0;
        while let Some(alarm) = bench.clock.alarm.get() {
            let now = bench.clock.now.get().max(alarm);
            bench.clock.now.set(now);
            let before = events_in.len();
            stepper.on_alarm();
            let played = before - events_in.len();
            assert!(played <= most, "{played} in one interrupt");
            if let Some(next) = bench.clock.alarm.get().filter(|_| played >= most - 1) {
                assert!(next >= now + pause, "{} ticks", next - now);
                breaks += 1;
            }
        }
        assert!(events_in.is_empty() && breaks > 0, "{breaks} breaks");
    }
}

#[test]
fn a_little_lateness_is_made_good() {
    let (bench, status) = (Bench::default(), Status::new());
    let events: Vec<StepEvent> =
        (0..10).map(|_| event(1000, V, DOWN)).chain([event(1, GroupSet::NONE, DOWN)]).collect();
    play(&bench, &status, &events, 0, |ring| u32::from(ring % 2 == 0) * 60);
    assert!(rises(&bench).iter().all(|(tick, at)| u64::from(*at) - tick <= 60));
    assert_eq!(status.overload(), Overload::default());
}

#[test]
fn a_pressed_endstop_ends_the_motion_that_watches_it() {
    let (bench, status) = (Bench::default(), Status::new());
    bench.pressed.set(EndstopSet::X.0);
    let watched = |watch| StepEvent { watch, ..event(1000, V, DOWN) };
    // Y is not pressed, so its watcher steps; X is, so nothing after it does.
    let events = [watched(EndstopSet::Y), watched(EndstopSet::X), watched(EndstopSet::NONE), event(1000, V, DOWN)];
    let tick = play(&bench, &status, &events, 0, |_| 0);
    assert_eq!(rises(&bench), [(1000, 1000)]);
    assert_eq!(tick, 1000, "motion time ends with the motion");
    assert_eq!(status.triggered(), EndstopSet::X);
}

/// Lets the stepper play until it rests.
fn play_on(bench: &Bench, stepper: &mut Stepper<'_, Pins<'_>, Timer<'_>, NoWake>) {
    stepper.on_alarm();
    while let Some(alarm) = bench.clock.alarm.get() {
        bench.clock.now.set(alarm);
        stepper.on_alarm();
    }
}

#[test]
fn events_of_a_past_epoch_make_no_steps_and_are_taken_back() {
    let (bench, status) = (Bench::default(), Status::new());
    let mut queue = MoveQueue::new();
    let (moves_in, _moves_out) = queue.split();
    let mut queue = StepQueue::new();
    let (mut events_in, events_out) = queue.split();
    let mut link = Link::new(moves_in, &status, events_out.counts(&status), NoWake);
    let mut stepper = Stepper::new(events_out, &status, Pins(&bench), Timer(&bench.clock), NoWake);
    for steps in [V, V, GroupSet(3)] {
        events_in.enqueue(event(1000, steps, GroupSet(1))).unwrap();
    }
    stepper.on_alarm();
    bench.clock.now.set(bench.clock.alarm.get().unwrap());
    stepper.on_alarm();
    assert_eq!(rises(&bench).len(), 1);
    link.abort();
    stepper.on_alarm();
    assert_eq!(bench.clock.alarm.get(), None, "there is nothing that it may play");
    assert_eq!(events_in.take_back(), [1, -2, 0, 0, 0]);
    assert!(events_in.is_empty());
    let fresh = StepEvent { epoch: 1, ..event(300, V, DOWN) };
    events_in.enqueue(fresh).unwrap();
    events_in.enqueue(StepEvent { steps: GroupSet::NONE, ..fresh }).unwrap();
    play_on(&bench, &mut stepper);
    let ticks: Vec<u64> = rises(&bench).into_iter().map(|(tick, _)| tick).collect();
    assert_eq!(ticks, [1000, 1300], "motion time goes on where it stood");
    assert_eq!(status.overload(), Overload::default());
}

#[test]
fn another_coupling_has_the_direction_lines_set_anew() {
    let (bench, status) = (Bench::default(), Status::new());
    let mut queue = StepQueue::new();
    let (mut events_in, events_out) = queue.split();
    let mut stepper = Stepper::new(events_out, &status, Pins(&bench), Timer(&bench.clock), NoWake);
    events_in.enqueue(event(1000, V, V)).unwrap();
    play_on(&bench, &mut stepper);
    let before = bench.lines.take();
    let mut is_changed = false;
    stepper.recouple(|_| {
        assert_eq!(bench.lines.take(), [], "the lines are those of the new coupling");
        is_changed = true;
    });
    assert!(is_changed);
    let forward = Line::Dir(machine().tool.coupling().forward_motors(V).0);
    assert!(before.contains(&forward), "{before:?}");
    assert_eq!(bench.lines.take(), [forward]);
}

#[test]
fn an_epoch_that_comes_round_again_is_not_the_one_that_ended() {
    let (bench, status) = (Bench::default(), Status::new());
    bench.pressed.set(EndstopSet::X.0);
    let mut queue = StepQueue::new();
    let (mut events_in, events_out) = queue.split();
    let counts = events_out.counts(&status);
    let mut stepper = Stepper::new(events_out, &status, Pins(&bench), Timer(&bench.clock), NoWake);
    events_in.enqueue(StepEvent { watch: EndstopSet::X, ..event(0, V, DOWN) }).unwrap();
    bench.clock.now.set(1000);
    stepper.on_alarm();
    bench.clock.now.set(2000);
    stepper.on_alarm();
    assert_eq!(status.triggered(), EndstopSet::X);
    let mut queue = MoveQueue::new();
    let (moves_in, _moves_out) = queue.split();
    let mut link = Link::new(moves_in, &status, counts, NoWake);
    for _ in 0..256 {
        link.abort();
        events_in.take_back();
        stepper.on_alarm();
    }
    assert_eq!(status.epoch(), 0);
    events_in.enqueue(event(0, V, DOWN)).unwrap();
    stepper.on_alarm();
    bench.clock.now.set(3000);
    stepper.on_alarm();
    assert_eq!(rises(&bench).len(), 1);
}

/// The moves from the origin to these places (x, y, z in mm) one behind the other, and how fast, in mm/s.
fn moves(places: &[[i32; 3]], speed: i32, watch: EndstopSet) -> Vec<Entry> {
    let settings = Settings::prototype();
    let mut memory = MoveMemory::new();
    let mut planner = Planner::new(&mut memory, &settings, [Mm::ZERO; 4]);
    for [x, y, z] in places {
        let position = [Mm::from_num(*x), Mm::from_num(*y), Mm::from_num(*z), Mm::ZERO];
        planner.push(&Target { position, speed: Feed::from_num(speed), has_overrides: false, watch }, &settings);
    }
    planner.release_all();
    std::iter::from_fn(|| planner.pop()).map(|m| Entry { epoch: 0, work: Work::Move(m) }).collect()
}

/// Reproducer: the generator made all 400,000 events of a long approach, and the stepper discarded each. For a second
/// nothing of lower priority ran, including the Console with its M112.
#[test]
fn a_motion_that_has_met_its_endstop_is_not_made_to_its_end() {
    let (bench, status) = (Bench::default(), Status::new());
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (mut moves_in, moves_out) = move_queue.split();
    let (steps_in, mut steps_out) = step_queue.split();
    let mut spans = SpanMemory::new();
    let groupings = machine();
    let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    for entry in moves(&[[0, 0, -300]], 10, EndstopSet::Z) {
        moves_in.enqueue(entry).unwrap();
    }
    generator.run(&NoWake);
    assert!(steps_out.dequeue().is_some());
    bench.pressed.set(EndstopSet::Z.0);
    play(&bench, &status, &[StepEvent { watch: EndstopSet::Z, ..event(1000, V, UP) }], 0, |_| 0);
    assert_eq!(status.triggered(), EndstopSet::Z);
    while steps_out.dequeue().is_some() {}
    generator.run(&NoWake);
    assert!(steps_out.dequeue().is_none(), "nothing is made that would be discarded");
}

/// A step that needs its direction lines set first would be a microsecond late.
#[test]
fn directions_are_set_ahead_of_the_step_that_needs_them() {
    let (status, groupings) = (Status::new(), machine());
    let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
    let (mut moves_in, moves_out) = move_queue.split();
    let (steps_in, mut steps_out) = step_queue.split();
    let mut spans = SpanMemory::new();
    let mut generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    for entry in moves(&[[3, 0, 0], [3, 2, 0], [-1, 2, 0], [0, 0, 0]], 100, EndstopSet::NONE) {
        moves_in.enqueue(entry).unwrap();
    }
    // Motion time stands, so events are made 10 ms ahead at the most, and a few at a time behind that.
    let events = std::iter::from_fn(|| {
        generator.run(&NoWake);
        steps_out.dequeue()
    });
    let (mut forward, mut turns, mut since_turn) = (GroupSet::NONE, 0, u32::MAX);
    for event in events {
        since_turn = since_turn.saturating_add(event.interval);
        if event.forward != forward {
            assert_eq!(event.steps, GroupSet::NONE, "no step comes sooner than 6 us behind the last one here");
            (forward, since_turn, turns) = (event.forward, 0, turns + 1);
        } else if !event.steps.is_empty() {
            assert!(since_turn >= 30, "3 us ahead, but was {since_turn}");
            since_turn = u32::MAX;
        }
    }
    assert_eq!(turns, 4, "u and v forward, v back, u back, v forward");
}
