//! Step counts, which are not kept event by event, against pins that count each event.

use crate::clock::{Clock, NoWake, Timer};
use corehbot::kinematics::{Groupings, Mechanism};
use corehbot::motion::{
    Link, MoveMemory, MoveQueue, Planner, SpanMemory, StepCounts, StepGenerator, StepQueue, Stepper, Target, Work,
};
use corehbot::motors::MOST_GROUPS;
use corehbot::port::{EndstopSet, GroupSet, StepPort};
use corehbot::settings::Settings;
use corehbot::status::Status;
use corehbot::units::{Feed, Mm};
use proptest::prelude::*;
use std::cell::Cell;

/// Pins that count, and a clock that is set from outside.
#[derive(Default)]
struct Bench {
    clock: Clock,
    forward: Cell<u8>,
    pressed: Cell<u8>,
    counts: Cell<[i32; MOST_GROUPS]>,
}

struct Pins<'b>(&'b Bench);

impl StepPort for Pins<'_> {
    fn dir(&mut self, forward: GroupSet) {
        self.0.forward.set(forward.0);
    }

    fn rise(&mut self, steps: GroupSet, _tick: u64) {
        let mut counts = self.0.counts.get();
        for (group, count) in counts.iter_mut().enumerate().filter(|(group, _)| steps.0 >> group & 1 == 1) {
            *count += if self.0.forward.get() >> group & 1 == 1 { 1 } else { -1 };
        }
        self.0.counts.set(counts);
    }

    fn fall(&mut self, _steps: GroupSet) {}

    fn slow_groups(&self) -> GroupSet {
        GroupSet(4)
    }

    fn endstops(&mut self) -> EndstopSet {
        EndstopSet(self.0.pressed.get())
    }
}

/// Plays up to `alarms` alarms and compares the counts after each; the generator comes every `turns`-th time.
fn play(
    bench: &Bench,
    (stepper, generator): (&mut Stepper<'_, Pins<'_>, Timer<'_>, NoWake>, &mut StepGenerator<'_>),
    counts: &StepCounts<'_>,
    (alarms, turns): (usize, usize),
) {
    for alarm in 0..alarms {
        if alarm % turns == 0 {
            generator.run(&NoWake);
            stepper.on_alarm();
        }
        assert_eq!(counts.read(), bench.counts.get());
        let Some(at) = bench.clock.alarm.get() else { continue };
        bench.clock.now.set(at);
        stepper.on_alarm();
        assert_eq!(counts.read(), bench.counts.get());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn counts_are_those_of_the_pins_at_any_moment(
        ways in prop::collection::vec(prop::array::uniform3(-300..300i32), 1..6),
        stop in 0..3000usize,
        turns in 1..60usize,
        ends_at_switch in any::<bool>(),
    ) {
        let (bench, status, settings) = (Bench::default(), Status::new(), Settings::prototype());
        let groupings = Groupings::new(&Mechanism::corehbot());
        let (mut memory, mut spans) = (MoveMemory::new(), SpanMemory::new());
        let (mut move_queue, mut step_queue) = (MoveQueue::new(), StepQueue::new());
        let (moves_in, moves_out) = move_queue.split();
        let (events_in, events_out) = step_queue.split();
        let counts = events_out.counts(&status);
        let mut link = Link::new(moves_in, &status, counts, NoWake);
        let mut stepper = Stepper::new(events_out, &status, Pins(&bench), Timer(&bench.clock), NoWake);
        let mut generator = StepGenerator::new(moves_out, events_in, &mut spans, &status, &groupings);
        for round in 0..2 {
            // A new name for the place, without motion.
            let begin = [Mm::from_num(round), Mm::ZERO, Mm::ZERO, Mm::ZERO];
            let mut planner = Planner::new(&mut memory, &settings, begin);
            link.send(Work::Position(planner.steps(begin)));
            let watch = if ends_at_switch { EndstopSet::X } else { EndstopSet::NONE };
            for [x, y, z] in &ways {
                let [x, y, z] = [x, y, z].map(|hundredths| Mm::from_num(*hundredths) / 100);
                let target = Target { position: [x, y, z / 10, x + y], speed: Feed::from_num(100), has_overrides: false, watch };
                planner.push(&target, &settings);
            }
            planner.release_all();
            while let Some(m) = planner.pop() {
                link.send(Work::Move(m));
            }
            play(&bench, (&mut stepper, &mut generator), &counts, (stop, turns));
            if ends_at_switch {
                bench.pressed.set(EndstopSet::X.0);
                play(&bench, (&mut stepper, &mut generator), &counts, (20, 3));
                bench.pressed.set(0);
            }
            link.abort();
            play(&bench, (&mut stepper, &mut generator), &counts, (20, 1));
            prop_assert!(link.is_idle());
            link.restart();
        }
        prop_assert_eq!(counts.read(), bench.counts.get());
        prop_assert_eq!(link.counts(), bench.counts.get());
    }
}
