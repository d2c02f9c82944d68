//! Mechanics: the load on the motors. It is the simulator's rigid rig; with `--plant belt` also its belt plant, and
//! then the plant's switches and loads count.
//!
//! The plant lives in virtual time; motion time follows the firmware's schedule. Switches follow the rig with each
//! step. The belt's tool also moves between steps, so its switches are checked every [`LOOK_NS`] while it is near one
//! of them.

use crate::driver_line::DriverLines;
use crate::tick::NS_PER_TICK;
use anyhow::{Context, Result};
use corehbot::motors::{EndstopSet, MOTORS, Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot_rig::Rig;
use corehbot_rig::bed::BedPlant;
use corehbot_sim::belt::figures::BeltFigures;
use corehbot_sim::belt::{BeltPlant, BeltSetup, Chips};
use corehbot_sim::tmc2209::Tmc2209;
use corehbot_sim::wiring_mistakes::Plugs;

/// How often switches are checked while the belt's tool is near one: at 20 mm/s it goes 0.2 um.
const LOOK_NS: u64 = 10_000;

/// The load on the motors.
pub struct Mechanics {
    rig: Rig,
    belt: Option<Box<BeltPlant>>,
    /// The bed of a machine with a probe.
    bed: Option<BedPlant>,
    /// Motion time of the last event.
    tick: u64,
    /// When to check the switches of the belt.
    next: Option<u64>,
    /// Mistakes of the wiring; a belt has none.
    pub plugs: Option<Plugs>,
    /// Switches that a hand presses.
    pub held: EndstopSet,
}

/// The plant's view of the board's drivers.
struct OnBoard<'w> {
    drivers: &'w mut DriverLines,
    /// Motors with power, and since when, in ticks.
    powered: (MotorSet, u64),
}

impl Chips for OnBoard<'_> {
    fn powered(&self) -> (MotorSet, u64) {
        self.powered
    }

    fn with(&mut self, motor: Motor, act: &mut dyn FnMut(&mut Tmc2209)) {
        act(self.drivers.chip(motor));
    }
}

impl Mechanics {
    /// The machine of these settings, rigid.
    #[must_use]
    pub fn rigid(settings: &Settings) -> Self {
        Self {
            rig: Rig::new(settings, None),
            belt: None,
            bed: BedPlant::of(settings),
            tick: 0,
            next: None,
            plugs: None,
            held: EndstopSet::NONE,
        }
    }

    /// The same with a belt.
    ///
    /// # Errors
    /// The twin has no such machine.
    pub fn with_belt(settings: &Settings, setup: &BeltSetup) -> Result<Self> {
        let plant = BeltPlant::new(settings, None, false, setup.clone(), 0).context("--plant belt")?;
        Ok(Self { belt: Some(Box::new(plant)), ..Self::rigid(settings) })
    }

    /// Motors step at an instant in ns; `tick` is the low half of its motion time, if it is known.
    pub fn step(
        &mut self,
        at: u64,
        tick: Option<u32>,
        (steps, forward): (MotorSet, MotorSet),
        drivers: &mut DriverLines,
        powered: (MotorSet, u64),
    ) {
        let (turned, ahead) = self.plugs.as_ref().map_or((steps, forward), |plugs| plugs.turned(steps, forward));
        self.rig.step(turned, ahead);
        if let Some(tick) = tick {
            self.tick += u64::from(tick.wrapping_sub(self.tick as u32));
        }
        if let Some(plant) = &mut self.belt {
            let (powered, since) = powered;
            let mut chips = OnBoard { drivers, powered: (powered, since / NS_PER_TICK) };
            plant.step(at / NS_PER_TICK, self.tick, steps, forward, &mut chips);
        }
    }

    /// Motors may have got or lost power, since an instant in ns.
    pub fn attend(&mut self, at: u64, (powered, since): (MotorSet, u64)) {
        if let Some(plant) = &mut self.belt {
            plant.attend(at / NS_PER_TICK, (powered, since / NS_PER_TICK));
        }
    }

    /// The endstops that are pressed at an instant in ns.
    pub fn endstops(&mut self, at: u64) -> EndstopSet {
        let now = at / NS_PER_TICK;
        self.next = None;
        let (switches, nozzle) = match &mut self.belt {
            None => (self.rig.endstops(), self.rig.nozzle()),
            Some(plant) => {
                let switches = plant.endstops(now);
                self.next = plant.is_near_switch().then_some(at + LOOK_NS);
                (switches, plant.nozzle())
            }
        };
        let mut pressed = switches.with(self.held);
        if let Some(bed) = &mut self.bed {
            bed.follow(now, nozzle, &self.rig.counts());
            pressed = pressed.with(bed.endstops(now));
            self.next = self.next.into_iter().chain(bed.next().map(|tick| (tick + 1) * NS_PER_TICK)).min();
        }
        self.plugs.as_ref().map_or(pressed, |plugs| plugs.read(pressed))
    }

    /// The servo of the probe gets its first pulse of so many us at an instant in ns.
    pub fn servo(&mut self, at: u64, micros: u16) {
        if let Some(bed) = &mut self.bed {
            bed.servo(at / NS_PER_TICK, Some(micros));
            self.next = Some(at);
        }
    }

    /// Uses another bed.
    pub fn lay(&mut self, bed: BedPlant) {
        self.bed = Some(bed);
    }

    /// The bed of a machine with a probe.
    #[must_use]
    pub const fn bed(&self) -> Option<&BedPlant> {
        self.bed.as_ref()
    }

    /// When to check the switches, if there is no step before, in ns.
    #[must_use]
    pub const fn next(&self) -> Option<u64> {
        self.next
    }

    /// Steps of each motor.
    #[must_use]
    pub fn counts(&self) -> [i32; MOTORS] {
        self.rig.counts()
    }

    /// The belt's figures, half a second after the last step.
    #[must_use]
    pub fn figures(self) -> Option<BeltFigures> {
        self.belt.map(|mut plant| {
            plant.ring_out();
            plant.figures()
        })
    }
}
