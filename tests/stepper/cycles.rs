//! The stepper with a clock like the boards': a cycle counter that wraps long before ticks do, and a timer that rings
//! early, often, and not for near times.

use corehbot::motion::{StepEvent, StepQueue, Stepper};
use corehbot::port::{EndstopSet, GroupSet, StepClock, StepPort};
use corehbot::status::{Late, Status};
use corehbot::units::Tick;
use std::cell::{Cell, RefCell};

use crate::clock::NoWake;

/// Cycles a tick, the longest and the shortest time that the timer is set to, and how early it rings
/// (`chips/stm32f446`, step_timer.rs).
const CYCLES: u32 = 18;
const LONGEST: u32 = (1 << 22) + 71;
const NEAR: u32 = 72;
const EARLY: u32 = 12;

/// The record: cycles since the start without a loss; when the timer rings; rises, in cycles.
#[derive(Default)]
struct World {
    cycles: Cell<u64>,
    rings: Cell<Option<u64>>,
    last: Cell<u32>,
    rises: RefCell<Vec<u64>>,
}

struct Core<'w>(&'w World);

impl Core<'_> {
    fn until(&self, tick: Tick) -> u32 {
        tick.0.wrapping_mul(CYCLES).wrapping_sub(self.0.cycles.get() as u32)
    }

    fn ring_in(&self, cycles: u32) -> bool {
        self.0.rings.set(Some(self.0.cycles.get() + u64::from(cycles - EARLY)));
        true
    }
}

impl StepClock for Core<'_> {
    fn now(&self) -> Tick {
        let last = self.0.last.get();
        let passed = self.until(Tick(last)).wrapping_neg().cast_signed();
        self.0.last.set(last.wrapping_add_signed(passed.div_euclid(CYCLES as i32)));
        Tick(self.0.last.get())
    }

    fn is_due(&self, at: Tick, ticks: u32) -> bool {
        self.until(at) >= (ticks * CYCLES).wrapping_neg()
    }

    fn alarm(&mut self, at: Tick) -> bool {
        let left = at.0.wrapping_sub(self.now().0).cast_signed();
        let cycles = self.until(at).cast_signed().max(NEAR.cast_signed()).unsigned_abs();
        left > 0 && self.ring_in(if left.unsigned_abs() > LONGEST / CYCLES { LONGEST } else { cycles })
    }

    fn alarm_again(&mut self, at: Tick) -> bool {
        let left = self.until(at);
        (NEAR..=LONGEST).contains(&left) && self.ring_in(left)
    }

    fn silence(&mut self) {
        self.0.rings.set(None);
    }
}

struct Pins<'w>(&'w World);

impl StepPort for Pins<'_> {
    fn dir(&mut self, _: GroupSet) {}

    fn rise(&mut self, _: GroupSet, _: u64) {
        self.0.rises.borrow_mut().push(self.0.cycles.get());
    }

    fn fall(&mut self, _: GroupSet) {}

    fn endstops(&mut self) -> EndstopSet {
        EndstopSet::NONE
    }
}

/// Plays events after these intervals; `entry` cycles go by from a ring to the handler. Says when the lines rose, in
/// cycles since the first was due.
fn play(intervals: &[u32], start: u64, entry: u64) -> (Vec<i64>, Status) {
    let (world, status) = (World::default(), Status::new());
    world.cycles.set(start);
    let mut queue = StepQueue::new();
    let (mut events_in, events_out) = queue.split();
    let mut stepper = Stepper::new(events_out, &status, Pins(&world), Core(&world), NoWake);
    for (number, interval) in intervals.iter().enumerate() {
        let event = StepEvent {
            interval: *interval,
            // Motors take turns: two pulses of one are 1.7 us apart.
            steps: GroupSet(1 << (number % 5)),
            forward: GroupSet::NONE,
            epoch: 0,
            watch: EndstopSet::NONE,
        };
        events_in.enqueue(event).unwrap();
    }
    // The first is due after 20 us at least, from a tick that has begun.
    let begun = Core(&world).until(Core(&world).now()).wrapping_neg();
    let first = start - u64::from(begun) + u64::from(intervals[0].max(200)) * u64::from(CYCLES);
    stepper.on_alarm();
    while let Some(rings) = world.rings.take() {
        world.cycles.set(world.cycles.get().max(rings) + entry);
        stepper.on_alarm();
    }
    let rises = world.rises.borrow().iter().map(|rise| rise.wrapping_sub(first).cast_signed()).collect();
    (rises, status)
}

#[test]
fn no_step_is_early_and_none_is_late_however_far_apart_they_are() {
    // 24 s and 48 s are a lap of the cycle counter and two, 107 s the longest that there is.
    let far = [238_609_294, 477_218_588, 238_609_300, 1 << 30, 119_304_650, 1, 4, 5, 6, 50, 23_302, 23_303];
    let near = (0..60).map(|i| 1 + (i * i * 7919) % 30_000);
    let intervals: Vec<u32> = [1000].into_iter().chain(far).chain(near).chain(far).collect();
    for start in [0, 17, 1 << 31, (1 << 32) - 2000, 77_777_777_777] {
        let (rises, status) = play(&intervals, start, 30);
        assert_eq!(rises.len(), intervals.len());
        let mut due = 0;
        for (number, rise) in rises.iter().enumerate() {
            // Events that are looked at closely keep 1 us from the event before, so a few close ones are late.
            let is_close = intervals[number.saturating_sub(4)..=number].iter().any(|interval| *interval < 17);
            let most = if is_close { 40 * i64::from(CYCLES) } else { 40 };
            assert!((0..=most).contains(&(rise - due)), "event {number}: {} cycles late, from {start}", rise - due);
            due += intervals.get(number + 1).map_or(0, |interval| i64::from(*interval) * i64::from(CYCLES));
        }
        assert_eq!(status.overload().events, Late::default());
    }
}
