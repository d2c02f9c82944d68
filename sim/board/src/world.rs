//! The world: the firmware's handles and a simulated machine, in virtual time.
//!
//! All of it runs in one thread. Time advances only by the Stepper's alarm, or by a millisecond when nothing moves, so
//! a print takes as long as its computation. The host of [`run`] answers at once: time stands still while the printer
//! waits for a line.

mod beyond;
mod desk;
mod follow;
mod heat_periods;
mod runs;
mod turned;
mod z_shifts;

use crate::accelerometer::Sensor;
use crate::accident::Accident;
use crate::any_storage::AnyStorage;
use crate::drivers::{Bus, Drivers, Power, ServoLine};
pub use crate::ends::{HeatPeriod, HeaterPeriod, Host, Sink};
use crate::heat_plant::HeatSetup;
use crate::moves::Tap;
use crate::odometer::Odometer;
pub use crate::ports::Wire;
use crate::ports::{Mechanics, Pins, Shared, SimLine, SimWake, Timer};
use crate::reach::Reach;
use corehbot::app::{Parts, StepPorts, assemble};
use corehbot::driver::Tmc2209;
use corehbot::kinematics::{Groups, MotorTable};
use corehbot::machine::{PortSet, Ports, Restart};
use corehbot::motion::{StepCounts, StepGenerator, Stepper};
use corehbot::motors::{Coupling, EndstopSet, MOST_GROUPS, MOTORS, Motor, MotorSet};
use corehbot::port::Storage;
use corehbot::settings::Settings;
use corehbot::status::Status;
use corehbot::thermal::ThermalControl;
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_rig::Rig;
use corehbot_rig::bed::BedPlant;
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::thermal_plant::Heat;
pub use desk::{Desk, SimBoard};
pub use runs::{WorldError, run, run_at, run_on, run_with};
use std::collections::VecDeque;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Waker};
use turned::Turned;
pub use z_shifts::{ZShift, ZShifts};

/// How a print ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Motion time in ticks of 0.1 us.
    pub ticks: u64,
    /// Moves planned.
    pub moves: u32,
    /// Moves that a mesh has made slower.
    pub slowed_moves: u32,
    /// Path of the tool, in um.
    pub path_um: u64,
    /// How often the host was too slow for the look-ahead.
    pub underruns: u32,
    /// Fewest moves in the look-ahead while the stream ran, if it was ever full.
    pub low_water: Option<u32>,
    /// Steps emitted by each motor, signed.
    pub counts: [i32; MOTORS],
    /// Whether an emergency stop holds.
    pub halted: bool,
}

/// Events played between two turns of the Console.
const EVENTS_A_TURN: usize = 128;

/// Time passes by no more than this between two turns of the Console, which a board polls every millisecond.
const TURN: u64 = TICKS_PER_MS as u64;

/// Whether the Console wants another turn at once.
#[derive(Default)]
struct Wakes(AtomicBool);

impl Wakes {
    /// Whether it does, once.
    fn take(&self) -> bool {
        self.0.load(Ordering::Relaxed) && self.0.swap(false, Ordering::Relaxed)
    }
}

impl std::task::Wake for Wakes {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The types of the simulated ports.
impl<'w> PortSet for &'w Shared {
    type Serial = SimLine<'w>;
    type Motors = Power<'w>;
    type Drivers = Bus<'w>;
    type Chip = Tmc2209;
    type Servo = ServoLine<'w>;
    type Board = SimBoard;
    type Clock = Timer<'w>;
    type Storage = AnyStorage<'w>;
    type Accelerometer = Sensor<'w>;
}

/// The firmware and its machine.
pub struct World<'w> {
    shared: &'w Shared,
    drivers: &'w Drivers,
    wires: &'w [Wire],
    turned: Turned,
    extruder: Option<Motor>,
    status: &'w Status,
    counts: StepCounts<'w>,
    stepper: Stepper<'w, Pins<'w>, Timer<'w>, SimWake<'w>>,
    generator: StepGenerator<'w>,
    thermal: ThermalControl<'w, Heat, SimWake<'w>>,
    /// Accidents still to come, by time.
    accidents: &'w [Accident],
    /// Faults of the probe still to come, and when, in s.
    probe_accidents: VecDeque<(f64, ProbeFault)>,
    /// When the next control period is due, in ticks.
    next_period: u64,
    /// Until it asks for a restart.
    console: Option<Pin<Box<dyn Future<Output = Restart> + 'w>>>,
    /// The switches that had ended a motion when the pins were last updated.
    met: EndstopSet,
    /// Whether the sink knows of a halt.
    was_halted: bool,
    wakes: Arc<Wakes>,
    waker: Waker,
    odometer: Odometer,
    /// Follows the moves, if the sink wants them.
    tap: Option<Box<Tap>>,
    z_shifts: &'w mut ZShifts,
    /// The firmware's position of each group, less its steps.
    origin: [i32; MOST_GROUPS],
    /// The ends of the axes, and the motors' coupling for which they hold.
    reach: Reach,
    tool: Coupling,
    /// Whether a homed axis beyond its end ends the program.
    is_strict: bool,
    /// mm of a step of z.
    step_of_z: f64,
}

impl<'w> World<'w> {
    /// A machine that stands at `start` (x, y, z) as if homed, or somewhere, and has just been switched on.
    pub fn new(
        desk: &'w mut Desk,
        settings: &'w Settings,
        start: Option<[Mm; 3]>,
        storage: impl Storage + 'w,
        drivers: &'w Drivers,
        sink: &'w mut dyn Sink,
    ) -> Self {
        Self::standing(desk, settings, start, start, storage, drivers, sink)
    }

    /// The same with a tool that stands at `place`, whatever the firmware knows of it.
    pub fn standing(
        desk: &'w mut Desk,
        settings: &'w Settings,
        place: Option<[Mm; 3]>,
        start: Option<[Mm; 3]>,
        storage: impl Storage + 'w,
        drivers: &'w Drivers,
        sink: &'w mut dyn Sink,
    ) -> Self {
        Self::switched_on(desk, settings, place, start, AnyStorage::of(storage), drivers, sink)
    }

    fn switched_on(
        desk: &'w mut Desk,
        settings: &'w Settings,
        place: Option<[Mm; 3]>,
        start: Option<[Mm; 3]>,
        storage: AnyStorage<'w>,
        drivers: &'w Drivers,
        sink: &'w mut dyn Sink,
    ) -> Self {
        let Desk {
            memory,
            shared,
            wires,
            endstops,
            bed,
            probe_accidents,
            mesh,
            mesh_log,
            z_shifts,
            belt,
            plugs,
            sensor,
            heat,
            board,
            is_strict,
            plant: left,
        } = desk;
        let (shared, wires, heat): (&'w Shared, &'w [Wire], &'w HeatSetup) = (shared, wires, heat);
        shared.sensor.borrow_mut().truth = settings.accelerometer.kind.map(|_| sensor.clone().unwrap_or_default());
        let groups = Groups::new(&settings.mechanism);
        let mechanics = match belt {
            Some(plant) => {
                plant.connect(*endstops);
                Mechanics::Belt(plant)
            }
            None => Mechanics::Rigid(Box::new(Rig::new(settings, place).with_inputs(*endstops))),
        };
        let table = MotorTable::new(&groups.coupling());
        *bed = BedPlant::of(settings).map(|flat| bed.take().unwrap_or_else(|| Box::new(flat)));
        let mut bed = bed.as_deref_mut();
        bed.iter_mut().for_each(|bed| bed.restart());
        let plugs = plugs.as_ref();
        let mesh_log = mesh_log.as_deref_mut();
        let tap = sink.wants_moves().then(|| Box::new(Tap::new(settings, mechanics.nozzle())));
        let (has_sensor, told_z) = (settings.accelerometer.kind.is_some(), None);
        let forward = MotorSet::NONE;
        let pins = Pins { mechanics, bed, mesh_log, shared, has_sensor, drivers, plugs, table, forward, told_z, sink };
        let step_ports = StepPorts { pins, clock: Timer(shared) };
        let ports: Ports<&'w Shared> = Ports {
            serial: wires.iter().map(SimLine).collect(),
            motors: drivers.power(&shared.now),
            drivers: drivers.bus(&shared.now),
            servo: drivers.servo(&shared.now),
            board: *board,
            clock: Timer(shared),
            storage,
            accelerometer: Sensor { sensor: &shared.sensor, now: &shared.now },
        };
        let plant = heat.truth.as_ref().map_or_else(|| Heat::new(settings), |truth| Heat::with(settings, truth));
        let plant = plant.standing_on(left.take().map(|plant| *plant));
        let Parts { stepper, generator, thermal, mut console, status, counts } =
            assemble(memory, settings, start, step_ports, plant, ports, SimWake(shared));
        if tap.is_some() {
            console.observe(&shared.queued);
        }
        if let Some(mesh) = mesh {
            console.lay_mesh(mesh);
        }
        let console = Box::pin(async move { console.run().await });
        z_shifts.restart();
        let wakes = Arc::<Wakes>::default();
        Self {
            shared,
            drivers,
            wires,
            turned: Turned::new(groups.coupling()),
            extruder: groups.mechanism().extruder(),
            status,
            counts,
            stepper,
            generator,
            thermal,
            accidents: &heat.accidents,
            probe_accidents: probe_accidents.iter().filter_map(|a| Some((a.at_s, a.probe_fault(settings)?))).collect(),
            next_period: shared.now.get(),
            console: Some(console),
            met: EndstopSet::NONE,
            was_halted: false,
            waker: Waker::from(Arc::clone(&wakes)),
            wakes,
            odometer: Odometer::default(),
            tap,
            z_shifts,
            origin: [0; MOST_GROUPS],
            reach: Reach::new(settings),
            is_strict: *is_strict,
            tool: groups.coupling(),
            step_of_z: 1.0 / settings.axes.z.steps_per_mm.to_num::<f64>(),
        }
    }

    /// The Console has its turn, and another one as long as it wants one at once.
    pub fn poll(&mut self) {
        while let Some(console) = &mut self.console {
            if console.as_mut().poll(&mut Context::from_waker(&self.waker)).is_ready() {
                self.console = None;
            }
            if let Some(tap) = &mut self.tap {
                tap.after_console(self.status, &self.shared.queued);
            }
            if !self.wakes.take() {
                break;
            }
        }
        self.odometer.follow(self.status.planned().1);
    }

    /// Lets time pass: by a millisecond, or by a number of step events. Returns whether there was motion.
    ///
    /// # Panics
    /// If a homed axis has gone beyond its end, at a desk that [is strict](Desk::is_strict).
    pub fn advance(&mut self) -> bool {
        let shared = self.shared;
        if let Some(coupling) = self.drivers.take_coupling() {
            self.stepper.recouple(|pins| pins.table = MotorTable::new(&coupling));
            self.turned.recouple(coupling, self.counts.read());
        }
        let mut moved = false;
        self.tell_halt();
        // The Console may have switched motors.
        self.stepper.port().attend();
        let end_of_turn = shared.now.get() + TURN;
        for _ in 0..EVENTS_A_TURN {
            if shared.generator.get() {
                self.generate();
            }
            if !shared.stepper.replace(false) {
                let Some(alarm) = shared.alarm.get() else {
                    break;
                };
                let now = shared.now.get();
                let wait = (alarm.wrapping_sub(now as u32) as i32).max(0).unsigned_abs();
                let due = now + u64::from(wait);
                shared.now.set(due.min(end_of_turn));
                if due > end_of_turn {
                    moved = true;
                    break;
                }
            }
            moved = true;
            self.stepper.on_alarm();
            self.tell_met();
        }
        if !moved {
            shared.now.set(end_of_turn);
        }
        if moved {
            self.hold_to_reach();
        }
        self.keep_heat();
        moved
    }

    /// The generator has its turns, and their moves are followed. A function of its own, because most events need no
    /// turn.
    #[inline(never)]
    fn generate(&mut self) {
        while self.shared.generator.replace(false) {
            self.generator.run(&SimWake(self.shared));
            self.follow_moves();
            self.note_surface();
            self.z_shifts.attend(self.status, self.stepper.tick());
        }
    }

    /// The host has sent a line.
    pub(crate) fn read(&mut self, (line, kind, command): (u32, u16, &str)) {
        if let Some(tap) = &mut self.tap {
            tap.read(line, kind, command);
        }
    }

    /// Whether the Console has no work before a host sends more.
    #[must_use]
    pub fn is_awaiting_hosts(&self) -> bool {
        self.wires.iter().all(Wire::is_silent) && self.status.is_awaiting_input()
    }

    /// Whether it asks for a restart (M999 after a stop). Nothing happens in this world any more.
    #[must_use]
    pub const fn has_ended(&self) -> bool {
        self.console.is_none()
    }

    /// Time since it was switched on, in ticks.
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.shared.now.get()
    }

    /// The serial lines.
    #[must_use]
    pub const fn wires(&self) -> &'w [Wire] {
        self.wires
    }

    /// A hand presses these switches and no others, from now on.
    pub fn press(&self, switches: EndstopSet) {
        self.shared.pressed.set(switches);
    }

    /// The wires of these switches break, and of no others.
    pub fn unplug(&self, switches: EndstopSet) {
        self.shared.dead.set(switches);
    }

    /// Where the nozzle is, in mm.
    pub fn nozzle(&mut self) -> [f64; 3] {
        self.stepper.port().mechanics.nozzle()
    }

    /// The bed, if it has a probe.
    pub fn bed(&mut self) -> Option<&mut BedPlant> {
        self.stepper.port().bed.as_deref_mut()
    }

    /// The status shared by its contexts.
    #[must_use]
    pub const fn status(&self) -> &'w Status {
        self.status
    }

    /// The result so far.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let status = self.status;
        Outcome {
            ticks: self.stepper.tick(),
            moves: status.planned().0,
            slowed_moves: status.slowed_moves(),
            path_um: self.odometer.um(),
            underruns: status.overload().underruns + status.overload().starved,
            low_water: status.low_water(),
            counts: self.turned.motors(self.counts.read()),
            halted: status.is_halted(),
        }
    }
}
