//! The settings in use: all parts read them, and each way to change them keeps the rest of the machine in step.
//!
//! | settings | change by | and then |
//! |---|---|---|
//! | limits, soft endstops, plain numbers | [`MainLoop::live_settings`] | the open line keeps its limits |
//! | heaters and fans | [`MainLoop::heat_settings`] | the heater control gets them |
//! | home offsets | `use_home_offsets` of [`offsets`](super::offsets) | the program's zero moves |
//! | the offset of z | `shift_z`, `let_z_stand` of [`offsets`](super::offsets) | z or the program's zero moves |
//! | drivers | [`MainLoop::use_driver_settings`] | the drivers get them |
//! | pressure advance | [`MainLoop::use_advance`] | motion comes to rest before a new delay |
//! | all, with size of a step and shapers | [`MainLoop::use_settings`] | it rests before, all get the position |
//!
//! So no command holds `&mut Settings`: it could change the size of a step while moves wait.

use super::MainLoop;
use crate::kinematics::{Residuals, SCREWS};
use crate::machine::numbers::to_thousandth;
use crate::machine::ports::PortSet;
use crate::machine::state::program::Dynamics;
use crate::port::Wake;
use crate::settings::{Advance, Belt, DriverGroups, Kept, Screw, Settings, ThermalSettings, ZStore, sum};
use crate::units::{Instant, Mm};
use core::ops::Deref;
use fixed::types::I32F32;

/// Interval of the scrub in ms: a flipped bit is found within a second even by a Console that storage keeps busy.
const SCRUB_MS: u32 = 500;

/// What sums of decimals leave over at most, in bits of 2^-32 mm: one nm, a hundredth of the finest step.
const REST_BITS: u64 = 1 << 12;

/// The settings, and those that the machine was made with.
pub(in crate::machine) struct SettingsInUse<'m> {
    now: Kept<Settings>,
    /// Those that the machine was made with, where the board has them, and their sum.
    made_with: &'m Settings,
    sum: u32,
    /// When the next scrub is due.
    scrub_due: Instant,
}

impl Deref for SettingsInUse<'_> {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        &self.now
    }
}

impl<'m> SettingsInUse<'m> {
    pub(super) fn new(settings: &'m Settings, now: Instant) -> Self {
        Self { now: Kept::new(*settings), made_with: settings, sum: sum(settings), scrub_due: now }
    }

    /// The settings that the machine was made with.
    pub const fn defaults(&self) -> &'m Settings {
        self.made_with
    }

    /// The residuals of the motors of x and y: the ways in which they can strain the belt.
    pub fn residuals(&self) -> Residuals {
        Residuals::new(&self.mechanism, self.belt.is_closed)
    }

    /// The preload in steps of belt.
    pub fn preload_steps(&self) -> i32 {
        (self.belt.preload * self.axes.x.steps_per_mm).wrapping_round().to_num()
    }

    /// Thousandths of a step of belt as a length.
    pub fn belt_length(&self, thousandths: i64) -> Mm {
        self.axes.x.steps_per_mm.length_of_parts(thousandths, 1000)
    }

    /// The phase that is known of a residual.
    pub(super) fn known_phase(&self, number: usize) -> Option<i32> {
        let phase = self.belt.phases.get(number).filter(|phase| **phase < Belt::NO_PHASE);
        phase.map(|phase| i32::from(*phase))
    }

    /// Keeps a phase that was found; false if it was known.
    pub(super) fn keep_phase(&mut self, number: usize, found: u16) -> bool {
        let known = self.now.belt.phases.get_mut(number).filter(|known| **known != found);
        known.map(|known| *known = found).is_some()
    }

    /// Takes others. The caller gives them to the rest of the machine.
    pub(super) fn replace(&mut self, wanted: &Settings) {
        *self.now = *wanted;
    }

    /// Takes another advance, which needs no rest.
    pub(super) fn replace_advance(&mut self, wanted: Advance) {
        self.now.advance = wanted;
    }

    /// Takes others for what the program counts more after homing.
    pub(super) fn replace_home_offsets(&mut self, [x, y, z]: [Mm; 3]) {
        let homing = &mut self.now.homing;
        (homing.x.offset, homing.y.offset, homing.z.offset) = (x, y, z);
    }

    /// Changes a kept offset of z by so much. The open line goes on: no plan depends on it.
    ///
    /// A thousandth of a mm is no fraction of two, so 0.05 three times is not quite 0.15. A sum of thousandths is made
    /// one again, and the host reads no `0.1500000001`.
    pub(super) fn shift_z_offset(&mut self, store: ZStore, by: Mm) {
        let sum = self.now.z_offset(store).saturating_add(by);
        let round = Mm::from_bits(to_thousandth(I32F32::from_bits(sum.to_bits())).to_bits());
        let is_rest = round.to_bits().abs_diff(sum.to_bits()) <= REST_BITS;
        self.now.set_z_offset(store, if is_rest { round } else { sum });
    }

    /// Takes others for the drivers. The caller gives them to the drivers.
    pub(super) fn replace_drivers(&mut self, wanted: DriverGroups) {
        self.now.drivers = wanted;
    }

    /// Whether a scrub is due. Legal changes up to now are right.
    pub(super) fn is_scrub_due(&mut self, now: Instant) -> bool {
        self.now.settle();
        let is_due = now >= self.scrub_due;
        if is_due {
            self.scrub_due = now.after_ms(SCRUB_MS);
        }
        is_due
    }

    /// Whether they are unchanged since they were set.
    pub(super) fn is_whole(&self) -> bool {
        self.now.is_whole() && sum(self.made_with) == self.sum
    }

    /// Those in use, for changes that are none of these ways.
    #[cfg(test)]
    pub(super) const fn now_mut(&mut self) -> &mut Kept<Settings> {
        &mut self.now
    }

    /// Those that the machine was made with become these, without another sum.
    #[cfg(test)]
    pub(super) const fn damage_made_with(&mut self, damaged: &'m Settings) {
        self.made_with = damaged;
    }
}

/// The settings, of which those may change that the next move can take, while other moves wait.
pub(in crate::machine) struct LiveSettings<'s>(&'s mut Kept<Settings>);

impl Deref for LiveSettings<'_> {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        self.0
    }
}

impl LiveSettings<'_> {
    /// Sets the limits that a program changes as it goes.
    pub fn set_dynamics(&mut self, dynamics: &Dynamics) {
        dynamics.put(self.0);
    }

    /// Takes the settings of a line that has changed plain ones without an owner.
    pub fn set_plain(&mut self, wanted: &Settings) {
        **self.0 = *wanted;
    }

    /// Has z follow the mesh, or not.
    pub fn set_mesh_on(&mut self, is_on: bool) {
        self.0.mesh.is_on = is_on;
    }

    /// Sets the height at which the mesh has faded out.
    pub fn set_fade(&mut self, fade: Mm) {
        self.0.mesh.fade = fade;
    }

    /// Sets the screws of z.
    pub fn set_screws(&mut self, screws: [Screw; SCREWS]) {
        self.0.screws = screws;
    }

    /// Turns the soft endstops on or off.
    pub fn set_soft_endstops(&mut self, on: bool) {
        self.0.soft_endstops = on;
    }
}

impl<P: PortSet, W: Wake> MainLoop<'_, P, W> {
    /// The settings that may change for the following moves.
    pub fn live_settings(&mut self) -> LiveSettings<'_> {
        self.motion.close_line(&self.settings);
        LiveSettings(&mut self.settings.now)
    }

    /// The settings of heaters and fans, to change them.
    pub fn heat_settings(&mut self) -> &mut ThermalSettings {
        self.motion.close_line(&self.settings);
        self.heat.note_settings();
        &mut self.settings.now.thermal
    }
}
