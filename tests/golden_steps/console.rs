//! The Console's end of the motion, with all its calls at moments that dice choose. It queues moves, dwells and taps,
//! reads the remaining and made steps, brakes, aborts, and circulates the belt. An endstop is pressed in some moves,
//! and interrupts are late.

use super::{circle, corners, shaped, wild};
use crate::clock::{Clock, Timer};
use crate::dice::Dice;
use crate::line::{plan, shaping};
use corehbot::kinematics::{Grouping, Groupings, MotorTable};
use corehbot::motion::{Link, Move, MoveQueue, SpanMemory, StepGenerator, StepQueue, Stepper, Work};
use corehbot::port::{EndstopSet, GroupSet, MotorSet, StepPort, Wake};
use corehbot::settings::{Settings, ShaperKind, sum};
use corehbot::status::Status;
use corehbot::units::{Steps, SubTicks};
use std::cell::Cell;
use std::hash::Hash;

/// The requests to other contexts.
#[derive(Default)]
struct Pended {
    generator: Cell<bool>,
    stepper: Cell<bool>,
}

impl Wake for &Pended {
    fn wake_generator(&self) {
        self.generator.set(true);
    }

    fn wake_stepper(&self) {
        self.stepper.set(true);
    }
}

/// A sum of all that is seen, in its order.
#[derive(Default)]
struct Seen {
    count: Cell<usize>,
    sum: Cell<u32>,
}

impl Seen {
    fn add(&self, what: &impl Hash) {
        self.count.set(self.count.get() + 1);
        self.sum.set(sum(&(self.sum.get(), what)));
    }
}

struct Pins<'s> {
    table: MotorTable,
    pressed: &'s Cell<u8>,
    seen: &'s Seen,
}

impl StepPort for Pins<'_> {
    fn dir(&mut self, forward: GroupSet) {
        self.seen.add(&(1u8, self.table.forward_motors(forward).0));
    }

    fn rise(&mut self, steps: GroupSet, tick: u64) {
        let MotorSet(motors) = self.table.motors(steps);
        self.seen.add(&(2u8, motors, tick as u32, (tick >> 32) as u32));
    }

    fn fall(&mut self, steps: GroupSet) {
        self.seen.add(&(3u8, self.table.motors(steps).0));
    }

    fn slow_groups(&self) -> GroupSet {
        GroupSet(0b100)
    }

    fn rise_quick(&mut self, steps: GroupSet, tick: u64) {
        self.seen.add(&6u8);
        self.rise(steps, tick);
    }

    fn endstops(&mut self) -> EndstopSet {
        EndstopSet(self.pressed.get())
    }
}

/// Where the counter of the step timer begins: 2 s before it wraps.
const BEGIN: u32 = u32::MAX - 20_000_000;

/// The most rounds for work that ends by itself.
const MOST_ROUNDS: usize = 4_000;

/// A machine with contexts that run at random.
struct Machine<'m> {
    link: Link<'m, &'m Pended>,
    generator: StepGenerator<'m>,
    stepper: Stepper<'m, Pins<'m>, Timer<'m>, &'m Pended>,
    pended: &'m Pended,
    clock: &'m Clock,
    status: &'m Status,
    seen: &'m Seen,
    pressed: &'m Cell<u8>,
    dice: Dice,
}

impl Machine<'_> {
    /// A round: the generator runs if it was asked or dice say so, the Stepper up to twelve times, and the Console
    /// looks.
    fn run(&mut self) {
        if self.pended.generator.replace(false) || self.dice.roll() < 0.1 {
            self.generator.run(&self.pended);
        }
        for _ in 0..1 + (12.0 * self.dice.roll()) as u32 {
            if let Some(alarm) = self.clock.alarm.take() {
                // Mostly at once, now and then too late.
                let late = if self.dice.roll() < 0.02 { (400.0 * self.dice.roll()) as u32 } else { 0 };
                self.clock.now.set(alarm.wrapping_add(late));
            } else if !self.pended.stepper.replace(false) {
                break;
            }
            self.stepper.on_alarm();
        }
        self.look();
    }

    fn look(&mut self) {
        let link = &mut self.link;
        if self.dice.roll() < 0.02 {
            link.look_at_endstops();
        }
        self.seen.add(&(7u8, self.pended.stepper.get(), self.pended.generator.get(), self.status.endstops().0));
        let states = [link.is_idle(), link.is_fresh(), link.has_room(), link.has_stopped()];
        self.seen.add(&(4u8, states, link.left() as u32, link.level() as u32, link.entries(), link.entries_done()));
        self.seen.add(&(5u8, link.counts(), self.stepper.tick() as u32, self.status.triggered().0));
    }

    /// Queues it and runs until all is done, or for `rounds` rounds.
    fn play(&mut self, work: impl IntoIterator<Item = Work>, rounds: usize) {
        let mut left = work.into_iter().peekable();
        for _ in 0..rounds {
            while self.link.has_room() && left.peek().is_some() {
                left.next().into_iter().for_each(|work| self.link.send(work));
            }
            self.run();
            if left.peek().is_none() && self.link.is_idle() {
                break;
            }
        }
    }

    /// Moves into an endstop.
    fn meet_endstop(&mut self, moves: &[Move]) {
        self.play(work(moves), 60);
        self.pressed.set(1);
        self.play([], 60);
        assert!(!self.status.triggered().is_empty());
        self.stop();
    }

    /// Brakes to rest in the middle of the path, as fast as allowed, and stops.
    fn brake(&mut self) {
        assert!(!self.link.is_idle());
        self.link.brake();
        let has_stopped = (0..MOST_ROUNDS).any(|_| {
            self.run();
            self.link.has_stopped()
        });
        assert!(has_stopped);
        self.stop();
    }

    /// Drops the remaining motion, and stands at the origin in any case.
    fn stop(&mut self) {
        self.link.abort();
        for _ in 0..100 {
            self.pended.stepper.set(true);
            self.run();
        }
        self.seen.add(&self.link.is_idle());
        self.pressed.set(0);
        self.link.restart();
        self.play([Work::Position([Steps::ZERO; 4])], 100);
    }
}

fn work(moves: &[Move]) -> impl Iterator<Item = Work> + '_ {
    moves.iter().map(|m| Work::Move(*m))
}

/// The number of observed values, and a sum of all.
pub fn run(seed: u64) -> (usize, u32) {
    let settings = shaped([ShaperKind::Mzv, ShaperKind::Zvd], [0, 700]);
    let (status, groupings) = (Status::new(), Groupings::new(&settings.mechanism));
    let (mut move_queue, mut step_queue, mut spans) = (MoveQueue::new(), StepQueue::new(), SpanMemory::new());
    let (pended, clock, seen, pressed) = (Pended::default(), Clock::default(), Seen::default(), Cell::new(0));
    clock.now.set(BEGIN);
    let (moves_in, moves_out) = move_queue.split();
    let (steps_in, steps_out) = step_queue.split();
    let link = Link::new(moves_in, &status, steps_out.counts(&status), &pended);
    let table = |grouping| MotorTable::new(&groupings.of(grouping).coupling());
    let pins = Pins { table: table(Grouping::Tool), pressed: &pressed, seen: &seen };
    let stepper = Stepper::new(steps_out, &status, pins, Timer(&clock), &pended);
    let generator = StepGenerator::new(moves_out, steps_in, &mut spans, &status, &groupings);
    let dice = Dice(seed);
    let (pended, clock, status) = (&pended, &clock, &status);
    let mut machine = Machine { link, generator, stepper, pended, clock, status, seen: &seen, pressed: &pressed, dice };
    let plain = Settings::prototype();
    let (corners, circle) = (plan(&corners(), &plain), plan(&circle(), &plain));
    let watched = plan(&wild(seed, 12), &plain).into_iter().map(|m| Move { watch: EndstopSet(1), ..m });
    let watched: Vec<_> = watched.collect();
    machine.look();
    // In the first epoch, too.
    machine.meet_endstop(&watched);
    // A whole path with a dwell, while an endstop is pressed that no move watches; then paths that are aborted sooner
    // and later.
    machine.pressed.set(2);
    machine.play(work(&corners).chain([Work::Dwell(SubTicks::of_ticks(30_000))]), MOST_ROUNDS);
    machine.stop();
    for rounds in [3, 40, 90, 140, 260] {
        machine.play(work(&circle), rounds);
        machine.brake();
        machine.play(work(&corners).chain(work(&circle)), 2 * rounds);
        assert!(!machine.link.is_idle());
        if rounds % 4 == 0 { machine.brake() } else { machine.stop() }
    }
    machine.meet_endstop(&watched);
    // With shapers and pressure advance.
    machine.play(shaping(&settings), 100);
    let (shaped_corners, shaped_circle) = (plan(&super::corners(), &settings), plan(&super::circle(), &settings));
    machine.play(work(&shaped_corners), 300);
    machine.brake();
    for rounds in [12, 30, 55, 80, 120, 11, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29] {
        machine.play(work(&shaped_circle).chain(work(&shaped_corners)), rounds);
        machine.brake();
    }
    // So many short moves that they take more rounds.
    machine.play(work(&plan(&super::fine_circle(), &settings)[..300]), MOST_ROUNDS);
    assert!(machine.status.overload().spans.count > 0, "{:?}", machine.status.overload());
    machine.stop();
    // Between two moves, with the second one late, and while time passes.
    for rounds in [120, 250, 280, 310, 340, 370, 400, 800] {
        machine.play(work(&shaped_circle[..20]), rounds);
        machine.link.brake();
        machine.play(work(&shaped_circle[20..]), 60);
        machine.stop();
    }
    machine.link.send(Work::Dwell(SubTicks::of_ticks(300_000)));
    machine.generator.run(&machine.pended);
    machine.brake();
    // The belt circulates.
    for grouping in [Grouping::Circulation, Grouping::Trim, Grouping::Tool] {
        machine.play([Work::Regroup(grouping), Work::Position([Steps::ZERO; 4])], 100);
        machine.stepper.recouple(|pins| pins.table = table(grouping));
        machine.play(work(&plan(&wild(seed + 1, 6), &plain)), MOST_ROUNDS);
        assert!(machine.link.is_idle());
        machine.stop();
    }
    // The counter has wrapped, and interrupts were late.
    assert!(clock.now.get() < BEGIN && status.overload().events.count > 0);
    seen.add(&format!("{:?}", status.overload()));
    (seen.count.get(), seen.sum.get())
}
