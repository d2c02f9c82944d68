//! The generator's calls, with the step interrupt anywhere in between.

use super::atomic;
use super::explore::explore;
use super::interrupt::{Interrupt, Played};
use super::queue::StepEvent;
use super::queue::{PackedEvent, StepQueue, StepsIn};
use crate::motors::MOST_GROUPS;
use crate::port::{EndstopSet, GroupSet};
use std::cell::Cell;
use std::rc::Rc;

/// Events that are made, to have all places there, and taken back before a run.
const BEFORE: u32 = 8;

/// The parts of a run: the generator's end, the events that the interrupt has played, and the epoch.
struct Bench {
    events: StepsIn<'static>,
    played: Played,
    epoch: Rc<Cell<u8>>,
    /// The results of two marks and a withdrawal.
    marks: [bool; 2],
    taken_back: [i32; MOST_GROUPS],
}

impl Bench {
    fn put(&mut self, interval: u32, group: u8) {
        let (steps, epoch) = (GroupSet(1 << group), self.epoch.get());
        let event = StepEvent { interval, steps, forward: GroupSet::NONE, epoch, watch: EndstopSet::NONE };
        assert_eq!(self.events.enqueue(event), Ok(()));
    }

    fn played(&self) -> Vec<(u32, u8)> {
        self.played.borrow().iter().map(|(time, steps, _)| (*time, *steps)).collect()
    }
}

/// Explores `calls` with up to `interrupts` interrupts; the events played in the end must be `expected`.
fn all_orders(interrupts: u32, before: fn(&mut Bench), calls: fn(&mut Bench), check: fn(&Bench)) {
    let runs = explore(|| {
        atomic::reset();
        // The interrupt lives as long as the thread; a queue is leaked with it.
        let (events, events_out) = Box::leak(Box::<StepQueue>::default()).split();
        let (played, epoch) = (Played::default(), Rc::<Cell<u8>>::default());
        let mut bench = Bench {
            events,
            played: played.clone(),
            epoch: epoch.clone(),
            marks: [false; 2],
            taken_back: [0; MOST_GROUPS],
        };
        // All places are there, and stale.
        (0..BEFORE).for_each(|_| bench.put(1, 0));
        bench.events.take_back();
        before(&mut bench);
        let mut interrupt = Interrupt::new(events_out, epoch, played);
        let is_last = Rc::new(Cell::new(false));
        let last = is_last.clone();
        atomic::begin(
            interrupts,
            Box::new(move || if last.get() { interrupt.run_all() } else { interrupt.run_some() }),
        );
        calls(&mut bench);
        is_last.set(true);
        atomic::end();
        check(&bench);
        atomic::reset();
    });
    println!("{runs} runs");
    assert!(runs > 100, "only {runs} runs");
}

#[test]
fn events_put_in_singly_are_played_once_each_at_their_time() {
    all_orders(
        2,
        |bench| bench.put(10, 0),
        |bench| {
            bench.put(20, 1);
            bench.put(30, 2);
        },
        |bench| assert_eq!(bench.played(), [(10, 1), (30, 2), (60, 4)]),
    );
}

#[test]
fn a_run_of_events_is_played_once_each_at_their_time() {
    all_orders(
        2,
        |bench| bench.put(10, 0),
        |bench| {
            let mut now = 10;
            let mut ticks = 1..=3;
            bench.events.put_runs(PackedEvent::waiting(0, EndstopSet::NONE), 3, &mut now, |run| {
                while !run.is_full() {
                    let Some(number) = ticks.next() else { return false };
                    run.put(10 + 20 * number, PackedEvent::steps_of(1));
                }
                true
            });
            assert_eq!((now, bench.events.made()), (70, 4));
        },
        |bench| assert_eq!(bench.played(), [(10, 1), (30, 2), (50, 2), (70, 2)]),
    );
}

#[test]
fn a_mark_that_is_in_time_calls_the_generator_once_and_at_its_event() {
    all_orders(
        3,
        |bench| (0..4).for_each(|_| bench.put(10, 0)),
        |bench| {
            let first = bench.events.mark(2);
            bench.put(10, 0);
            let second = bench.events.mark(1);
            bench.marks = [first, second];
        },
        |bench| {
            assert_eq!(bench.played().len(), 5);
            let calls: Vec<bool> = bench.played.borrow().iter().map(|(.., calls)| *calls).collect();
            // The first mark is at the third event; the second takes it back, if it can, and is at the fifth.
            assert!(!calls[0] && !calls[1] && !calls[3], "{calls:?}");
            assert!(calls[4] || !bench.marks[1], "{calls:?} {:?}", bench.marks);
        },
    );
}

#[test]
fn what_is_taken_back_is_what_was_not_played() {
    all_orders(
        2,
        |bench| (0..3).for_each(|_| bench.put(10, 0)),
        |bench| {
            bench.put(10, 1);
            bench.epoch.set(1);
            bench.taken_back = bench.events.take_back();
            // The caller that begins an epoch pends the generator first and then the Stepper.
            atomic::interrupt();
            bench.put(50, 2);
        },
        |bench| {
            let played = bench.played();
            let of = |group: u8| played.iter().filter(|(_, steps)| *steps == 1 << group).count() as i32;
            let [first, second, third, ..] = bench.taken_back;
            // Directions are backward.
            assert_eq!((of(0) - first, of(1) - second, of(2) - third), (3, 1, 1), "{played:?}");
            let old = (of(0) + of(1)) as u32;
            assert_eq!(played.last(), Some(&(10 * old + 50, 4)));
        },
    );
}
