//! Ports: the simulator's stand-in for a board's hardware.
//!
//! All of them share one time, which only the world advances.

use crate::accelerometer::SimSensor;
use crate::belt::{BeltPlant, Chips};
use crate::drivers::Drivers;
use crate::ends::{Host, Sink};
use crate::mesh_log::MeshLog;
use crate::queue_log::QueueLog;
use crate::wiring_mistakes::Plugs;
use corehbot::kinematics::MotorTable;
use corehbot::motion::SurfaceFrame;
use corehbot::motors::{EndstopSet, GroupSet, MOTORS, MotorSet};
use corehbot::port::{Clock, Received, Serial, StepClock, StepPort, Wake};
use corehbot::surface::Heights;
use corehbot::units::{Instant, TICKS_PER_SECOND, Tick};
use corehbot_rig::Rig;
use corehbot_rig::bed::BedPlant;
use corehbot_rig::bed::probe::ProbeFault;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;

/// State shared by the ports.
#[derive(Default)]
pub(crate) struct Shared {
    /// Real time in ticks.
    pub now: Cell<u64>,
    pub alarm: Cell<Option<u32>>,
    pub generator: Cell<bool>,
    pub stepper: Cell<bool>,
    /// Switches that a hand presses.
    pub pressed: Cell<EndstopSet>,
    /// Switches that read as pressed no more.
    pub dead: Cell<EndstopSet>,
    /// What the Console has queued for the generator, if moves are followed.
    pub queued: QueueLog,
    /// The accelerometer at the tool.
    pub sensor: RefCell<SimSensor>,
}

/// Bytes in transit between the printer and one host.
#[derive(Default)]
pub struct Wire {
    to_printer: RefCell<VecDeque<Received>>,
    to_host: RefCell<Vec<u8>>,
    /// A line that the printer has begun.
    spoken: RefCell<Vec<u8>>,
    /// The bytes that the printer has overheard; `None` if it cannot, as behind USB.
    overheard: Cell<Option<usize>>,
    /// Bytes that it carries to the host in a second; `None` if it takes no time.
    rate: Cell<Option<u32>>,
    /// If so: bytes in the transmitter's ring, and the tick up to which others have left it.
    sending: Cell<u64>,
    carried_until: Cell<u64>,
}

/// Bytes in the ring of a transmitter, as on the boards.
const SENDING: u64 = 512;

impl Wire {
    /// Hands complete lines to the host.
    pub(crate) fn deliver(&self, host: &mut dyn Host) {
        let mut bytes = self.to_host.borrow_mut();
        if bytes.is_empty() {
            return;
        }
        let mut spoken = self.spoken.borrow_mut();
        for byte in bytes.drain(..) {
            if byte == b'\n' {
                host.hear(&String::from_utf8_lossy(&spoken));
                spoken.clear();
            } else {
                spoken.push(byte);
            }
        }
    }

    /// Takes the bytes from `speak`, and returns their number.
    pub(crate) fn take(&self, speak: impl FnOnce(&mut Vec<u8>)) -> usize {
        let mut bytes = Vec::new();
        speak(&mut bytes);
        if !bytes.is_empty() {
            self.put(bytes.iter().copied());
        }
        bytes.len()
    }

    /// It carries so many bytes to the host in a second.
    pub fn slow_down(&self, bytes: u32) {
        self.rate.set(Some(bytes));
    }

    /// The time is `now`, in ticks.
    pub(crate) fn carry(&self, now: u64) {
        let Some(rate) = self.rate.get().map(u64::from) else { return };
        let bytes = (now - self.carried_until.get()) * rate / u64::from(TICKS_PER_SECOND);
        self.carried_until.update(|until| until + bytes * u64::from(TICKS_PER_SECOND) / rate);
        self.sending.update(|sending| sending.saturating_sub(bytes));
    }

    /// Bytes that it takes at once.
    fn room(&self) -> usize {
        self.rate.get().map_or(usize::MAX, |_| (SENDING - self.sending.get()) as usize)
    }

    /// It ends in a UART's ring, in which the printer may look ahead.
    pub fn end_in_ring(&self) {
        self.overheard.set(Some(0));
    }

    /// The host opens its line.
    pub fn open(&self) {
        self.to_printer.borrow_mut().push_back(Received::Opened);
    }

    /// Bytes arrive at the printer.
    pub fn put(&self, bytes: impl IntoIterator<Item = u8>) {
        self.to_printer.borrow_mut().extend(bytes.into_iter().map(Received::Byte));
    }

    /// The printer's output since the last call.
    #[must_use]
    pub fn heard(&self) -> Vec<u8> {
        self.to_host.take()
    }

    /// Whether the printer has taken all that arrived.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.to_printer.borrow().is_empty()
    }
}

#[derive(Clone, Copy)]
pub(crate) struct SimWake<'w>(pub &'w Shared);

impl Wake for SimWake<'_> {
    fn wake_generator(&self) {
        self.0.generator.set(true);
    }

    fn wake_stepper(&self) {
        self.0.stepper.set(true);
    }
}

pub(crate) struct Timer<'w>(pub &'w Shared);

impl StepClock for Timer<'_> {
    fn now(&self) -> Tick {
        Tick(self.0.now.get() as u32)
    }

    fn alarm(&mut self, at: Tick) -> bool {
        self.0.alarm.set(Some(at.0));
        StepClock::now(self).is_before(at)
    }

    fn silence(&mut self) {
        self.0.alarm.set(None);
    }
}

impl Clock for Timer<'_> {
    fn now(&self) -> Instant {
        Instant(self.0.now.get())
    }
}

pub(crate) struct SimLine<'w>(pub &'w Wire);

impl Serial for SimLine<'_> {
    fn recv(&mut self) -> Option<Received> {
        self.0.overheard.update(|heard| heard.map(|heard| heard.saturating_sub(1)));
        self.0.to_printer.borrow_mut().pop_front()
    }

    fn overhear(&mut self) -> Option<Received> {
        let heard = self.0.overheard.get()?;
        let next = self.0.to_printer.borrow().get(heard).copied()?;
        self.0.overheard.set(Some(heard + 1));
        Some(next)
    }

    fn was_overheard(&self) -> bool {
        self.0.overheard.get().is_some_and(|heard| heard > 0)
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        let bytes = &bytes[..bytes.len().min(self.0.room())];
        self.0.to_host.borrow_mut().extend_from_slice(bytes);
        self.0.sending.update(|sending| sending + bytes.len() as u64);
        bytes.len()
    }
}

/// The mechanics on the step pins.
pub(crate) enum Mechanics<'w> {
    /// Steps are ways.
    Rigid(Box<Rig>),
    /// Belts stretch and rotors skip.
    Belt(&'w mut BeltPlant),
}

impl Mechanics<'_> {
    /// Where the nozzle is, in mm.
    pub fn nozzle(&self) -> [f64; 3] {
        match self {
            Self::Rigid(rig) => rig.nozzle(),
            Self::Belt(plant) => plant.nozzle(),
        }
    }

    /// Steps of each motor.
    const fn counts(&self) -> [i32; MOTORS] {
        match self {
            Self::Rigid(rig) => rig.counts(),
            Self::Belt(plant) => plant.counts(),
        }
    }
}

pub(crate) struct Pins<'w> {
    pub mechanics: Mechanics<'w>,
    /// The bed under the nozzle, on a machine with a probe.
    pub bed: Option<&'w mut BedPlant>,
    /// What a mesh does, if that is asked for.
    pub mesh_log: Option<&'w mut MeshLog>,
    pub shared: &'w Shared,
    /// Whether there is an accelerometer.
    pub has_sensor: bool,
    pub drivers: &'w Drivers,
    /// What hangs on drivers and inputs, if it is not what belongs there.
    pub plugs: Option<&'w Plugs>,
    pub table: MotorTable,
    pub forward: MotorSet,
    /// The program's z on a mesh, as the sink was told it last.
    pub told_z: Option<f64>,
    pub sink: &'w mut dyn Sink,
}

impl Pins<'_> {
    /// Time has passed, and motors may have been switched.
    pub(crate) fn attend(&mut self) {
        self.listen();
        if let Mechanics::Belt(plant) = &mut self.mechanics {
            plant.attend(self.shared.now.get(), self.drivers.powered());
        }
    }

    /// The accelerometer takes its samples up to now.
    #[inline]
    fn listen(&mut self) {
        if self.has_sensor {
            self.sample();
        }
    }

    #[inline(never)]
    fn sample(&mut self) {
        let (now, mut sensor) = (self.shared.now.get(), self.shared.sensor.borrow_mut());
        while let Some(due) = sensor.due(now) {
            match &mut self.mechanics {
                Mechanics::Rigid(rig) => {
                    sensor.vibrate(due, rig.nozzle());
                    sensor.sample_rigid();
                }
                Mechanics::Belt(plant) => {
                    plant.attend(due, self.drivers.powered());
                    sensor.move_at(plant.live().velocity_mm_s());
                }
            }
        }
        // Where the nozzle is takes a few products for each event.
        if let Mechanics::Rigid(rig) = &self.mechanics
            && sensor.vibrates()
        {
            sensor.vibrate(now, rig.nozzle());
        }
    }

    /// The log learns where the nozzle is as the firmware counts it, and which surface z follows.
    pub(crate) fn note_surface(&mut self, counts: &[i32; MOTORS], surface: Option<(&SurfaceFrame, &Heights)>) {
        if let Some(log) = &mut self.mesh_log {
            log.stand(self.mechanics.nozzle(), counts);
            log.follow(surface);
        }
    }

    /// Motors step on belts. Like the other rare parts of a step it is a function of its own, which makes an ordinary
    /// step a short one.
    #[inline(never)]
    fn step_belt(&mut self, tick: u64, steps: MotorSet) {
        if let Mechanics::Belt(plant) = &mut self.mechanics {
            plant.step(self.shared.now.get(), tick, steps, self.forward, &mut self.drivers);
        }
    }

    /// The log follows the nozzle over the mesh, and the program's z is told where it has changed.
    #[inline(never)]
    fn follow_mesh(&mut self) {
        let Some(log) = &mut self.mesh_log else { return };
        if log.is_on() {
            log.event(self.mechanics.nozzle(), &self.mechanics.counts(), self.bed.as_deref());
        }
        let z = log.z();
        if z != self.told_z {
            self.told_z = z;
            self.sink.stand_on_mesh(z);
        }
    }

    /// The bed meets the nozzle where it is now, and its probe hears the servo.
    #[inline]
    fn attend_bed(&mut self) {
        if self.bed.is_some() {
            self.follow_bed();
        }
    }

    #[inline(never)]
    fn follow_bed(&mut self) {
        let Some(bed) = &mut self.bed else { return };
        if let Some((at, micros)) = self.drivers.take_servo() {
            bed.servo(at, micros);
        }
        bed.follow(self.shared.now.get(), self.mechanics.nozzle(), &self.mechanics.counts());
    }

    /// The probe breaks, or is mended.
    pub(crate) fn fail(&mut self, fault: ProbeFault) {
        if let Some(bed) = &mut self.bed {
            bed.fail(fault);
        }
    }

    /// These switches have ended a motion.
    pub(crate) fn meet(&mut self, met: EndstopSet, tick: u64) {
        if !met.is_empty() {
            self.sink.stopped(tick);
        }
        if let Mechanics::Belt(plant) = &mut self.mechanics {
            plant.meet(met);
        }
    }
}

impl StepPort for Pins<'_> {
    fn dir(&mut self, forward: GroupSet) {
        self.forward = self.table.forward_motors(forward);
    }

    fn rise(&mut self, steps: GroupSet, tick: u64) {
        let steps = self.table.motors(steps);
        let (turned, forward) = self.plugs.map_or((steps, self.forward), |plugs| plugs.turned(steps, self.forward));
        self.listen();
        match &mut self.mechanics {
            Mechanics::Rigid(rig) => rig.step(turned, forward),
            Mechanics::Belt(_) => self.step_belt(tick, steps),
        }
        self.attend_bed();
        if self.told_z.is_some() || self.mesh_log.as_ref().is_some_and(|log| log.is_on()) {
            self.follow_mesh();
        }
        self.sink.event(tick, steps, self.forward);
    }

    fn fall(&mut self, _steps: GroupSet) {}

    fn endstops(&mut self) -> EndstopSet {
        let now = self.shared.now.get();
        let met = match &mut self.mechanics {
            Mechanics::Rigid(rig) => rig.endstops(),
            Mechanics::Belt(plant) => plant.endstops(now),
        };
        self.attend_bed();
        let probe = self.bed.as_mut().map_or(EndstopSet::NONE, |bed| bed.endstops(now));
        let pressed = met.with(probe).with(self.shared.pressed.get()).and(self.inputs());
        let pressed = pressed.and(EndstopSet(!self.shared.dead.get().0));
        self.plugs.map_or(pressed, |plugs| plugs.read(pressed).and(self.inputs()))
    }

    fn inputs(&self) -> EndstopSet {
        let switches = match &self.mechanics {
            Mechanics::Rigid(rig) => rig.inputs(),
            Mechanics::Belt(plant) => plant.inputs(),
        };
        switches.with(if self.bed.is_some() { EndstopSet::PROBE } else { EndstopSet::NONE })
    }
}
