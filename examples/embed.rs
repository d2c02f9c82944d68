//! Embeds the core in a program: bytes of G-code go in, step events come out.
//!
//! `cargo run --example embed` prints the replies and the first and last step event of one move. The program is the
//! board: it implements the traits of [`corehbot::port`]. Time is a number, which jumps from alarm to alarm.

use corehbot::app::{Memory, Parts, StepPorts, assemble};
use corehbot::driver::Tmc2209;
use corehbot::kinematics::Groups;
use corehbot::machine::{PortSet, Ports};
use corehbot::motors::{Coupling, EndstopSet, GroupSet, Motor, MotorSet};
use corehbot::port::{
    AnyBoard, Clock, MotorPower, NoAccelerometer, NoBus, NoHeaters, NoServo, NoStorage, Received, Serial, StepClock,
    StepPort, Wake,
};
use corehbot::settings::Settings;
use corehbot::units::{Instant, Mm, TICKS_PER_MS, TICKS_PER_SECOND, Tick};
use std::cell::{Cell, RefCell};
use std::task::{Context, Waker};

/// M400 is answered when the motion has ended.
const PROGRAM: &str = "G1 X10 Y5 F3000\nM400\n";

#[derive(Default)]
struct Board {
    /// In ticks.
    now: Cell<u64>,
    alarm: Cell<Option<u64>>,
    is_generator_woken: Cell<bool>,
    is_stepper_woken: Cell<bool>,
    /// Bytes of the program that the core has taken.
    sent: Cell<usize>,
    replies: RefCell<Vec<u8>>,
    forward: Cell<GroupSet>,
    /// Tick, groups that step, and groups whose direction is forward.
    events: RefCell<Vec<(u64, GroupSet, GroupSet)>>,
}

impl Board {
    /// Whether an alarm rings until `end`; then it is the time of the alarm.
    fn rings(&self, end: u64) -> bool {
        let due = self.alarm.get().filter(|due| *due <= end);
        due.inspect(|due| self.now.set(*due)).is_some()
    }
}

impl StepPort for &Board {
    fn dir(&mut self, forward: GroupSet) {
        self.forward.set(forward);
    }
    fn rise(&mut self, steps: GroupSet, tick: u64) {
        self.events.borrow_mut().push((tick, steps, self.forward.get()));
    }
    fn fall(&mut self, _steps: GroupSet) {}
    fn endstops(&mut self) -> EndstopSet {
        EndstopSet::NONE
    }
}

impl StepClock for &Board {
    fn now(&self) -> Tick {
        Tick(self.now.get() as u32)
    }
    fn alarm(&mut self, at: Tick) -> bool {
        let wait = at.since(StepClock::now(self)).cast_signed();
        self.alarm.set(u64::try_from(wait).ok().filter(|wait| *wait > 0).map(|wait| self.now.get() + wait));
        self.alarm.get().is_some()
    }
    fn silence(&mut self) {
        self.alarm.set(None);
    }
}

impl Clock for &Board {
    fn now(&self) -> Instant {
        Instant(self.now.get())
    }
}

impl Wake for &Board {
    fn wake_generator(&self) {
        self.is_generator_woken.set(true);
    }
    fn wake_stepper(&self) {
        self.is_stepper_woken.set(true);
    }
}

impl Serial for &Board {
    fn recv(&mut self) -> Option<Received> {
        let byte = *PROGRAM.as_bytes().get(self.sent.get())?;
        self.sent.update(|sent| sent + 1);
        Some(Received::Byte(byte))
    }
    fn send(&mut self, bytes: &[u8]) -> usize {
        self.replies.borrow_mut().extend(bytes);
        bytes.len()
    }
}

/// This program does not record power.
impl MotorPower for &Board {
    fn enable(&mut self, _on: MotorSet) {}
    fn couple(&mut self, _coupling: &Coupling) {}
}

/// The drivers run as their jumpers say, and there are neither a servo nor storage.
impl<'b> PortSet for &'b Board {
    type Serial = &'b Board;
    type Motors = &'b Board;
    type Drivers = NoBus;
    type Chip = Tmc2209;
    type Servo = NoServo;
    type Board = AnyBoard;
    type Clock = &'b Board;
    type Storage = NoStorage;
    type Accelerometer = NoAccelerometer;
}

fn main() {
    let (board, settings, mut memory) = (&Board::default(), Settings::prototype(), Memory::new());
    let step_ports = StepPorts { pins: board, clock: board };
    let serial = [board].into_iter().collect();
    let ports: Ports<&Board> = Ports {
        serial,
        motors: board,
        drivers: NoBus,
        servo: NoServo,
        board: AnyBoard,
        clock: board,
        storage: NoStorage,
        accelerometer: NoAccelerometer,
    };
    // The tool stands at the origin, as if homed.
    let start = Some([Mm::ZERO; 3]);
    let Parts { mut stepper, mut generator, mut console, status, counts, .. } =
        assemble(&mut memory, &settings, start, step_ports, NoHeaters, ports, board);
    let mut console = std::pin::pin!(console.run());
    let mut context = Context::from_waker(Waker::noop());

    // The contexts take turns of a millisecond. A machine with heaters calls `Parts::thermal` every 20 ms too.
    while board.sent.get() < PROGRAM.len() || !status.is_awaiting_input() {
        if console.as_mut().poll(&mut context).is_ready() {
            break; // The console wants a reset.
        }
        let end = board.now.get() + u64::from(TICKS_PER_MS);
        loop {
            if board.is_generator_woken.take() {
                generator.run(&board);
            } else if board.is_stepper_woken.take() || board.rings(end) {
                stepper.on_alarm();
            } else {
                break;
            }
        }
        board.now.set(end);
    }

    print!("{}", String::from_utf8_lossy(&board.replies.borrow()));
    let (events, coupling) = (board.events.borrow(), Groups::new(&settings.mechanism).coupling());
    println!("{} step events", events.len());
    for (tick, steps, forward) in events.first().into_iter().chain(events.last()) {
        let (steps, forward) = (coupling.motors(*steps), coupling.forward_motors(*forward));
        print!("{:.7} s:", *tick as f64 / f64::from(TICKS_PER_SECOND));
        for motor in Motor::ALL.into_iter().filter(|motor| steps.has(*motor)) {
            print!(" {}{}", settings.name_of(motor), if forward.has(motor) { '+' } else { '-' });
        }
        println!();
    }
    println!("steps of m1 to e0: {:?}", coupling.motor_counts(counts.read()));
}
