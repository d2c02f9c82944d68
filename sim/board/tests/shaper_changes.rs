//! What a sink is told of shapers: the taps of x and y from the instant on at which the axes follow them.

use corehbot::motors::MotorSet;
use corehbot::settings::{Settings, ShaperKind};
use corehbot::units::{Hertz, Mm};
use corehbot_sim::host::FileHost;
use corehbot_sim::moves::{MadeMove, ShaperChange};
use corehbot_sim::world::{Sink, run};

#[derive(Default)]
struct Kept {
    moves: Vec<MadeMove>,
    changes: Vec<ShaperChange>,
    last_step: u64,
    /// The last step before each change.
    steps_before: Vec<u64>,
}

impl Sink for Kept {
    fn event(&mut self, tick: u64, _: MotorSet, _: MotorSet) {
        self.last_step = tick;
    }

    fn wants_moves(&self) -> bool {
        true
    }

    fn moved(&mut self, made: &MadeMove) {
        self.moves.push(*made);
    }

    fn reshaped(&mut self, change: &ShaperChange) {
        self.changes.push(change.clone());
        self.steps_before.push(self.last_step);
    }
}

fn print(settings: &Settings, gcode: &str) -> Kept {
    let mut kept = Kept::default();
    let mut host = FileHost::new(gcode);
    run(settings, Some([Mm::ZERO; 3]), &mut host, &mut kept).unwrap();
    assert!(host.failure().is_none());
    kept
}

/// The changes of x: when, in order, and how many copies.
fn of_x(kept: &Kept) -> Vec<(u64, usize)> {
    kept.changes.iter().filter(|change| change.axis == 0).map(|change| (change.tick, change.taps.len())).collect()
}

/// M593 waits for the motion, tails of shapers included. A setting that changes no shaper is no change.
#[test]
fn a_change_is_told_between_the_moves_that_it_parts() {
    let gcode = "G1 X30 F6000\nM593 F40 D0.1 T2\nG1 X60\nM593 F40 D0.1 T2\nM204 P900\nG1 X30\nM593 F0\nG1 X0\nM400\n";
    let kept = print(&Settings::prototype(), gcode);
    let changes = of_x(&kept);
    assert_eq!(changes.iter().map(|(_, taps)| *taps).collect::<Vec<_>>(), [1, 3, 1]);
    let [first, second, third] = [0, 1, 2].map(|at: usize| changes[at].0);
    assert_eq!((first, kept.moves.len()), (0, 4));
    let [a, b, c, d] = [0, 1, 2, 3].map(|at: usize| kept.moves[at]);
    assert!((a.end()..=b.begin).contains(&second), "{second} is not between {} and {}", a.end(), b.begin);
    // The copies of the third move end later than its plan, and no step of theirs is later than the change.
    assert!(third > c.end() && third <= d.begin, "{third} is not between {} and {}", c.end(), d.begin);
    assert!(kept.changes.iter().zip(&kept.steps_before).all(|(change, step)| *step <= change.tick));
}

/// So the taps in force are known at any time.
#[test]
fn settings_of_the_machine_are_told_before_the_first_move() {
    let mut settings = Settings::prototype();
    (settings.shapers.x.kind, settings.shapers.x.frequency) = (ShaperKind::Mzv, Hertz::from_num(50));
    let kept = print(&settings, "G1 X30 F6000\nM593 F50\nG1 X0\n");
    assert_eq!(of_x(&kept)[0], (0, 3));
    assert_eq!(of_x(&print(&Settings::prototype(), "G1 X9\n")), [(0, 1)]);
}
