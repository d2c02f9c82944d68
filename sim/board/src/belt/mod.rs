//! The belt plant: the twin's machine in the place of the rigid rig, while the firmware drives it.
//!
//! ```text
//!  step events, at the world's time ──┐                        ┌──> endstops X and Y: where the tool is
//!  motors with power (Drivers) ───────┼──> twin: rotors, belt ─┼──> load of each driver (SG_RESULT)
//!  accidents ─────────────────────────┘                        └──> figures at the end
//!  step events of Z and E ───────────────> rigid rig ─────────────> endstop Z
//! ```
//!
//! Words:
//!
//! - A *phase* is the place of a motor's magnetic zero against the belt at power-up.
//! - A *skip* is a rotor that settled in another electrical turn than its field.
//! - A *hit* is an obstacle in the tool's way. A motor that *rubs* has friction at its rotor.
//! - The *torque share* is the part of its available torque that a motor bears.
//! - A tool is *off* by its distance from the place that the steps say, counted from the place where homing met each
//!   switch.
//!
//! Places here are G-code places; X0 Y0 is the corner of the reach.
//!
//! | file | content |
//! |---|---|
//! | [`layout`] | which machine of the twin the settings are, and which motor turns which |
//! | [`accident`] | hits, as the command line has them, and how far an accident has come |
//! | `find` | the part of a machine that an accident names |
//! | `active_accidents` | what accidents do to the machine, and since when |
//! | `timeline` | motion time of an instant that has passed |
//! | [`course`] | shares and residual over time |
//! | `field` | by how much a driver turns its field at a step |
//! | `load` | a driver's measurement of its motor's load |
//! | [`figures`] | the figures reported at the end |

pub mod accident;
mod active_accidents;
pub mod course;
mod field;
pub mod figures;
mod find;
pub mod layout;
mod load;
mod timeline;

use crate::drivers::Drivers;
use crate::tmc2209::Tmc2209;
use accident::Accidents;
use active_accidents::ActiveAccidents;
use corehbot::motors::{EndstopSet, MOTORS, Motor, MotorSet};
use corehbot::settings::{AxisEnd, Endstop, Settings};
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_rig::{AT_POWER_UP, Rig};
use corehbot_twin::description::Description;
use corehbot_twin::math::hypot;
use corehbot_twin::routing::Place;
use corehbot_twin::stepped_machine::{Live, phases_mm};
use course::{Course, CourseBin};
use field::Field;
use figures::SkipFigures;
use layout::{Layout, LayoutError};
use load::Load;
use timeline::Timeline;

/// The endstops of the belt's axes: of z too where belts lift the tool.
const SWITCHES: [EndstopSet; 3] = [EndstopSet::X, EndstopSet::Y, EndstopSet::Z];

/// How long a machine rings out, in ticks: 0.5 s, in which 0.1 mm at 57 Hz and 4 % damping become 0.1 um.
const RING_OUT: u64 = 5_000_000;

/// Where the tool is near a switch: within 0.1 mm.
const NEAR_MM: f64 = 0.1;

/// The drivers of the motors, on whatever board they are.
pub trait Chips {
    /// Motors with current from their drivers, and since when in ticks, if the firmware switched them on.
    fn powered(&self) -> (MotorSet, u64);

    /// Applies an action to the driver of a motor.
    fn with(&mut self, motor: Motor, act: &mut dyn FnMut(&mut Tmc2209));
}

impl Chips for &Drivers {
    fn powered(&self) -> (MotorSet, u64) {
        let is_driving = |motor: &Motor| self.enabled().has(*motor) && self.chip(*motor).is_driving();
        let driving = Motor::ALL.into_iter().filter(is_driving);
        (driving.fold(MotorSet::NONE, |all, motor| all.with(MotorSet::of(motor))), self.switched())
    }

    fn with(&mut self, motor: Motor, act: &mut dyn FnMut(&mut Tmc2209)) {
        act(&mut self.chip(motor));
    }
}

/// The setup of the belt plant besides the machine's settings.
#[derive(Clone, Debug, Default)]
pub struct BeltSetup {
    /// The machine's belts and numbers, as its file has them.
    pub twin: Description,
    /// Seed of the phases at power-up, and of the noise of load measurements; without one all phases are 0.
    pub seed: Option<u64>,
    /// Its accidents.
    pub accidents: Accidents,
}

/// The machine of belt, rotors and tool, with the rigid rig for the other axes.
pub struct BeltPlant {
    live: Live,
    rig: Rig,
    /// The endstops that are connected.
    inputs: EndstopSet,
    layout: Layout,
    /// Where G-code's X0 Y0 is for the twin.
    origin: Place,
    switches: [Endstop; 3],
    /// Motors with a direction line that is low for forward.
    reversed: MotorSet,
    powered: MotorSet,
    /// Motors of the filament.
    filament: MotorSet,
    trouble: ActiveAccidents,
    /// Whether homing or printing has begun.
    has_begun: bool,
    /// The tool's position error where each switch was met; `None` before.
    met: [Option<f64>; 3],
    largest_off_mm: f64,
    loads: Vec<Load>,
    fields: Vec<Field>,
    course: Course,
    timeline: Timeline,
    skips: Vec<SkipFigures>,
    seed: Option<u64>,
}

/// The motors with a direction line that is low for forward.
fn reversed(settings: &Settings) -> MotorSet {
    let all = Motor::ALL.into_iter().filter(|motor| settings.wiring.of(*motor).is_reversed);
    all.fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(motor)))
}

impl BeltPlant {
    /// The plant of these settings with its tool at `place` (x, y, z), or somewhere, at a time in ticks. `is_known` if
    /// the firmware knows that place, as if it had homed.
    ///
    /// # Errors
    /// The twin has no such machine, or the tool does not reach so far.
    pub fn new(
        settings: &Settings,
        place: Option<[Mm; 3]>,
        is_known: bool,
        setup: BeltSetup,
        now: u64,
    ) -> Result<Self, LayoutError> {
        let BeltSetup { twin, seed, accidents } = setup;
        let place = place.unwrap_or(AT_POWER_UP);
        let layout = Layout::new(settings, &twin)?;
        let (origin, start) = layout.places(settings, place)?;
        let (trouble, idlers) = ActiveAccidents::new(accidents, &layout, start)?;
        let motors = layout.drives.len();
        let phases = seed.map_or_else(Vec::new, |seed| phases_mm(seed, motors, &layout.params));
        // A motor's steps are those of the axes that it moves.
        let axes = [&settings.axes.x, &settings.axes.y, &settings.axes.z].map(|axis| axis.steps_per_mm.to_num::<f64>());
        let step_mm = |drive: &layout::MotorDrive| {
            let axis = settings.mechanism.axis_of(drive.motor).and_then(|axis| axes.get(axis));
            drive.belt_part / axis.copied().unwrap_or(axes[0]) / f64::from(drive.multiple)
        };
        let step_mm: Vec<f64> = layout.drives.iter().map(step_mm).collect();
        let noise = seed.unwrap_or_default();
        Ok(Self {
            live: Live::new(layout.machine, &layout.params, start, &step_mm, &phases, now).with_idlers(&idlers),
            rig: Rig::new(settings, Some(place)),
            inputs: EndstopSet::SWITCHES,
            loads: (0..motors).map(|motor| Load::new(noise, motor)).collect(),
            fields: vec![Field::new(settings.drivers.belt.microsteps.into()); motors],
            course: Course::default(),
            layout,
            origin,
            switches: [settings.endstops.x, settings.endstops.y, settings.endstops.z],
            reversed: reversed(settings),
            powered: MotorSet::NONE,
            filament: settings.mechanism.motors_of(3),
            trouble,
            has_begun: is_known,
            met: [is_known.then_some(0.0); 3],
            largest_off_mm: 0.0,
            timeline: Timeline::default(),
            skips: Vec::new(),
            seed,
        })
    }

    /// The endstops that are connected.
    pub(crate) const fn connect(&mut self, inputs: EndstopSet) {
        self.inputs = inputs;
    }

    /// The endstops that there are.
    pub(crate) const fn inputs(&self) -> EndstopSet {
        self.inputs
    }

    /// Time has come to `now`, and motors may have got or lost power.
    pub fn attend(&mut self, now: u64, (powered, since): (MotorSet, u64)) {
        if powered != self.powered {
            self.advance(since.min(now));
            self.powered = powered;
            for (index, drive) in self.layout.drives.iter().enumerate() {
                self.live.give(index, if powered.has(drive.motor) { 1.0 } else { 0.0 });
            }
        }
        self.advance(now);
    }

    /// Motors step at `now`, which is `tick` of motion time.
    pub fn step(&mut self, now: u64, tick: u64, steps: MotorSet, forward: MotorSet, chips: &mut impl Chips) {
        self.timeline.event(now, tick);
        self.trouble.date(self.timeline.now_s(), |motion_s| self.timeline.instant(motion_s));
        self.attend(now, chips.powered());
        self.rig.step(steps, forward);
        self.has_begun |= steps.intersects(self.filament) || self.met.iter().take(self.axes()).all(Option::is_some);
        if self.layout.drives.iter().all(|drive| !steps.has(drive.motor)) {
            return;
        }
        let mut each = [0; layout::MOST_MOTORS];
        let counts = self.live.counts();
        let drives = self.layout.drives.iter().zip(&mut self.fields).zip(counts);
        for (step, ((drive, field), count)) in each.iter_mut().zip(drives) {
            let sense = if forward.has(drive.motor) { drive.sense } else { -drive.sense };
            if steps.has(drive.motor) {
                chips.with(drive.motor, &mut |chip| *step = field.step(i64::from(sense), *count, chip));
            }
        }
        self.live.step(&each);
        self.meet_hits(now);
        self.watch();
        self.measure(now, steps, chips);
    }

    /// The endstops that are pressed at `now`.
    pub fn endstops(&mut self, now: u64) -> EndstopSet {
        self.advance(now);
        let tool = self.place_mm();
        let own = || SWITCHES.into_iter().take(self.axes());
        let others = self.rig.endstops().0 & !own().fold(0, |all, set| all | set.0);
        let mut pressed = EndstopSet(others);
        for ((at, switch), set) in tool.into_iter().zip(self.switches).zip(own()) {
            let inside = at - switch.position.to_num::<f64>();
            let is_met = match switch.end {
                AxisEnd::Min => inside <= 0.0,
                AxisEnd::Max => inside >= 0.0,
            };
            if is_met {
                pressed = pressed.with(set);
            }
        }
        pressed.and(self.inputs)
    }

    /// Whether a switch of x or y may be met or left before the tool has gone far.
    #[must_use]
    pub fn is_near_switch(&self) -> bool {
        let all = self.place_mm().into_iter().zip(self.switches).take(self.axes());
        all.map(|(at, switch)| at - switch.position.to_num::<f64>()).any(|inside| inside.abs() < NEAR_MM)
    }

    /// A switch has ended a motion: its axis is from now on where the switch is.
    pub(crate) fn meet(&mut self, met: EndstopSet) {
        let (tool, stepped, axes) = (self.place_mm(), self.in_gcode(self.live.stepped_to()), self.axes());
        let all = SWITCHES.into_iter().zip(&mut self.met).zip(tool.into_iter().zip(stepped));
        for ((set, at), (tool, stepped)) in all.take(axes) {
            if !met.and(set).is_empty() {
                *at = Some(tool - stepped);
                self.largest_off_mm = 0.0;
            }
        }
    }

    /// Where the tool is, in x and y of G-code.
    #[must_use]
    pub fn tool_mm(&self) -> [f64; 2] {
        let [x, y, _] = self.place_mm();
        [x, y]
    }

    /// The same with z, which is 0 where no belts lift the tool.
    fn place_mm(&self) -> [f64; 3] {
        self.in_gcode(self.live.tool())
    }

    /// Axes that belts move.
    fn axes(&self) -> usize {
        self.layout.machine.axes()
    }

    /// Where the nozzle is, in mm.
    #[must_use]
    pub fn nozzle(&self) -> [f64; 3] {
        let ([x, y, lifted], [_, _, z]) = (self.place_mm(), self.rig.nozzle());
        [x, y, if self.layout.machine.lifts() { lifted } else { z }]
    }

    /// Steps of each motor.
    #[must_use]
    pub const fn counts(&self) -> [i32; MOTORS] {
        self.rig.counts()
    }

    /// Where it would be if it had gone from its start as the steps say.
    #[must_use]
    pub fn stepped_mm(&self) -> [f64; 2] {
        let [x, y, _] = self.in_gcode(self.live.stepped_to());
        [x, y]
    }

    /// The tool's position error in x, y and, where belts lift it, z; `None` before homing.
    #[must_use]
    pub fn off_mm(&self) -> Option<[f64; 3]> {
        let (tool, stepped) = (self.place_mm(), self.in_gcode(self.live.stepped_to()));
        let mut off = [0.0; 3];
        for (((off, tool), stepped), met) in off.iter_mut().zip(tool).zip(stepped).zip(self.met).take(self.axes()) {
            *off = tool - stepped - met?;
        }
        Some(off)
    }

    /// Shares and residual over motion time.
    #[must_use]
    pub const fn course(&self) -> &Course {
        &self.course
    }

    /// The machine as the twin has it.
    #[must_use]
    pub const fn live(&self) -> &Live {
        &self.live
    }

    /// Lets the machine ring out after the last step, so that the final figures describe a machine at rest.
    pub fn ring_out(&mut self) {
        self.advance(self.live.now() + RING_OUT);
    }

    /// Pushes the tool for `ms` with `force_n` in x and y, after the print.
    pub fn push(&mut self, force_n: [f64; 2], ms: u32) {
        self.live.push(force_n);
        self.advance(self.live.now() + u64::from(ms) * u64::from(TICKS_PER_MS));
        self.live.push([0.0; 2]);
    }

    fn in_gcode(&self, place: Place) -> [f64; 3] {
        [place.x - self.origin.x, place.y - self.origin.y, place.z - self.origin.z]
    }

    /// Moves on to `now`, with the begins and ends of accidents on the way.
    fn advance(&mut self, now: u64) {
        while let Some(change) = self.trouble.next_change().filter(|change| *change <= now) {
            self.live.advance(change);
            self.trouble.change(change, &mut self.live);
        }
        self.live.advance(now);
        for skip in self.live.take_skips() {
            self.skips.extend(self.layout.drives.get(skip.motor).map(|drive| SkipFigures {
                motor: drive.name,
                turns: skip.turns * i32::from(drive.sense),
                time_s: self.timeline.motion_s(skip.tick),
                at_mm: [skip.tool.x - self.origin.x, skip.tool.y - self.origin.y],
            }));
        }
        if let Some([x, y, z]) = self.off_mm() {
            self.largest_off_mm = self.largest_off_mm.max(hypot(hypot(x, y), z));
        }
    }

    /// Hits begin.
    fn meet_hits(&mut self, now: u64) {
        if self.has_begun && self.trouble.missed_hits() > 0 {
            let tool = self.tool_mm();
            self.trouble.meet(now, tool, &mut self.live);
        }
    }

    /// Records the motors' load for the report.
    fn watch(&mut self) {
        let mut seen = CourseBin::default();
        for (share, rotor) in seen.shares.iter_mut().zip(self.live.rotors()) {
            *share = rotor.share() as f32;
        }
        seen.residual_mm = self.live.residual_mm().map_or(0.0, f64::abs) as f32;
        self.course.add(self.timeline.motion(), seen);
    }

    /// Drivers measure the load of motors that have stepped.
    fn measure(&mut self, now: u64, steps: MotorSet, chips: &mut impl Chips) {
        let drives = &self.layout.drives;
        for (index, (drive, load)) in drives.iter().zip(&mut self.loads).enumerate() {
            // Of motors in series the driver sees the sum, which the first one stands for.
            let is_first = drives.iter().take(index).all(|other| other.motor != drive.motor);
            if is_first && steps.has(drive.motor) {
                let count = self.live.counts().get(index).copied().unwrap_or(0);
                let forward = count * i64::from(drive.sense);
                let series = || drives.iter().enumerate().filter(|(_, other)| other.motor == drive.motor);
                chips.with(drive.motor, &mut |chip| {
                    load.step(now, count, chip, || {
                        let sum: f64 = series().map(|(motor, _)| self.live.take_share(motor)).sum();
                        sum / series().count() as f64
                    });
                    // A direction line is high for forward, unless its motor is reversed.
                    chip.step_to(if self.reversed.has(drive.motor) { forward } else { -forward });
                });
            }
        }
    }
}
