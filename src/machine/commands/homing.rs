//! Homing: each axis finds its endstop fast, backs off, and finds it again slowly.
//!
//! The endstops are switches at one end of their axes ([`Endstop`]), and stay pressed beyond the place where they are met. The rig
//! presses them in the same way (`rig/src/lib.rs`). What position that place has is a setting; so is the order of the axes.
//!
//! The Z probe ([`EndstopSet::PROBE`]) takes no part: it is read and reported (M119), but nothing homes by it, and G29,
//! G30 and their relatives (`Command::Probing`) are answered and not carried out. A command that probes would use `approach`,
//! which refuses an endstop that the board does not have. It also needs:
//!
//! - `Command::Probing` taken apart, and letters in `gcode::grammar` (`tests/gcode.rs` asks for them);
//! - a probe in the rig: `Rig::inputs` says which inputs there are, `Rig::endstops` presses them;
//! - a probe in QEMU's port, where `StepPort::inputs` is the default, without one; and one in `emulator/src/wiring.rs`;
//! - the simulator, whose `Desk::new` (`boards/sim/src/world.rs`) connects the switches alone and so masks a probe of the rig, and
//!   its checker (`widen` in `boards/sim/src/limits.rs`), which allows a hard stop for G28 alone;
//! - README.md (what does not hold yet), the row of G29 and G30 in docs/host-protocol.md, the head of `src/motors.rs`;
//! - after `approach`, whose planner stands where the move would have ended, the real position for planner and program, as `stand_at_switch`
//!   gives it after homing, and words of its own where `HomingFailed` speaks of homing (`reports/tell.rs`);
//! - another word than "Probing" in boards/*/README.md, among what is not there.
//!
//! To home Z by the probe instead, moreover:
//!
//! - a setting that says so, by which `axis` chooses the endstop, and the probe's offset;
//! - `Settings::check_connectors` must ask for a probe in the file, which it holds to `BoardConnectors::probes`, and not for a switch of z, which
//!   `Plugged`, `Endstops` (`chips/stm32f446/src/step_pins.rs`), `StepPort::inputs` and M119 take for granted as well;
//! - a probe that is low when it triggers and whose wire is cut reads as not triggered: before each descent it must be seen to work;
//! - the tool over the bed before Z goes down.

use crate::gcode::AxisFlags;
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::notices::Notice;
use crate::motion::Target;
use crate::port::{EndstopSet, Pend};
use crate::settings::{Alignment, Endstop, HomedAxis, Homing};
use crate::units::{Mm, MmPerSec, Steps};

/// How far beyond an axis' length the switch is looked for: the machine may stand a little outside.
const BEYOND: Mm = Mm::const_from_int(10);

/// Why homing failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum HomeError {
    /// The switch did not do what it should.
    Failed(&'static str),
    /// Something else ended it.
    Interrupted(Interrupt),
}

/// The board has no such input: nothing would end the move.
const NOT_FITTED: HomeError = HomeError::Failed("not on this board");

/// The switch was not met on the whole length of the axis.
const NO_TRIGGER: HomeError = HomeError::Failed("not found");

/// The switch was still pressed after backing off.
const STILL_PRESSED: HomeError = HomeError::Failed("does not release");

impl From<Interrupt> for HomeError {
    fn from(interrupt: Interrupt) -> Self {
        Self::Interrupted(interrupt)
    }
}

/// Whether a line names an axis.
const fn is_named(flags: AxisFlags, axis: HomedAxis) -> bool {
    match axis {
        HomedAxis::X => flags.x,
        HomedAxis::Y => flags.y,
        HomedAxis::Z => flags.z,
    }
}

/// An axis that can be homed.
#[derive(Clone, Copy)]
struct Axis {
    index: usize,
    name: char,
    switch: EndstopSet,
    endstop: Endstop,
    homing: Homing,
    length: Mm,
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// G28. Whichever axis fails, the print must not go on: the machine halts.
    pub(in crate::machine) async fn home(&mut self, flags: AxisFlags) -> Result<(), Interrupt> {
        let aligns = self.settings.belt.alignment == Alignment::Automatic && self.lacks_alignment();
        self.home_and_align(flags, aligns).await
    }

    /// The same; with `aligns` the motors of a belt are aligned as soon as x and y are home, which are homed again then.
    pub(in crate::machine) async fn home_and_align(&mut self, flags: AxisFlags, aligns: bool) -> Result<(), Interrupt> {
        self.finish().await?;
        // Power first: where there is none, nothing is homed and the axes keep their homes.
        self.power(self.real.groups().fitted()).await?;
        let all = !(flags.x || flags.y || flags.z);
        let mut is_home = [false; 3];
        let mut aligns = aligns;
        for axis in self.settings.homing_order {
            if !(all || is_named(flags, axis)) {
                continue;
            }
            self.home_named(axis).await?;
            if let Some(is_home) = is_home.get_mut(axis as usize) {
                *is_home = true;
            }
            if let [true, true, _] = is_home
                && core::mem::take(&mut aligns)
            {
                self.align_and_tell().await?;
                self.home_named(HomedAxis::X).await?;
                self.home_named(HomedAxis::Y).await?;
            }
        }
        if let [true, true, _] = is_home {
            self.advance_belt().await?;
        }
        self.notices.renew(Notice::Edge);
        Ok(())
    }

    async fn home_named(&mut self, axis: HomedAxis) -> Result<(), Interrupt> {
        let axis = self.axis(axis);
        self.homed.begin(axis.index);
        let result = self.home_axis(&axis).await;
        self.end_homing(&axis, result).await
    }

    /// Tells why homing failed, if it did; then the print must not go on.
    async fn end_homing<T>(&mut self, axis: &Axis, result: Result<T, HomeError>) -> Result<T, Interrupt> {
        if !matches!(result, Err(HomeError::Interrupted(_))) {
            self.homed.stop();
        }
        match result {
            Ok(found) => Ok(found),
            Err(HomeError::Interrupted(interrupt)) => Err(interrupt),
            Err(HomeError::Failed(why)) => {
                self.tell(Answer::HomingFailed { axis: axis.name, why }).await?;
                Err(Interrupt::Halt)
            }
        }
    }

    /// Meets the switch of an axis once more, and backs off. Gives how many steps beside its place it was met: the tool stands so far
    /// beside where the steps say.
    pub(in crate::machine) async fn touch(&mut self, axis: HomedAxis) -> Result<i32, Interrupt> {
        let axis = self.axis(axis);
        let result = self.touch_axis(&axis).await;
        self.end_homing(&axis, result).await
    }

    async fn touch_axis(&mut self, axis: &Axis) -> Result<i32, HomeError> {
        let back_off = self.find_switch(axis).await?;
        let met = self.real_steps();
        let places = self.planner.steps([axis.endstop.position; 4]);
        let aside = places.get(axis.index).zip(met.get(axis.index)).map(|(place, met)| place.wrapping_sub(*met));
        self.travel(axis, -axis.endstop.towards(back_off), axis.homing.fast, EndstopSet::NONE).await?;
        self.modal.position = self.retraction.commanded(self.planner.mm(self.planner.end()));
        Ok(aside.unwrap_or_default().wrapping_round().to_num())
    }

    /// What there is to know of an axis.
    fn axis(&self, axis: HomedAxis) -> Axis {
        let s = &self.settings;
        let (switch, length) = match axis {
            HomedAxis::X => (EndstopSet::X, s.axes.x.length),
            HomedAxis::Y => (EndstopSet::Y, s.axes.y.length),
            HomedAxis::Z => (EndstopSet::Z, s.axes.z.length),
        };
        let (endstop, homing) = (s.endstops.of(axis), s.homing.of(axis));
        Axis { index: axis as usize, name: axis.letter(), switch, endstop, homing, length }
    }

    async fn home_axis(&mut self, axis: &Axis) -> Result<(), HomeError> {
        self.find_switch(axis).await?;
        self.stand_at_switch(axis).await?;
        self.homed.arrive(axis.index);
        self.modal.forget_origin(axis.index);
        Ok(())
    }

    /// Finds the switch fast, backs off and finds it slowly. Gives how far it backed off.
    async fn find_switch(&mut self, axis: &Axis) -> Result<Mm, HomeError> {
        let start = self.real_steps();
        if !self.approach(axis, axis.endstop.longest_way(axis.length) + BEYOND, axis.homing.fast).await? {
            return Err(NO_TRIGGER);
        }
        // Who did not move stood at the switch already, or anywhere behind it.
        let depth = if self.real_steps() == start { axis.endstop.depth(axis.length) } else { Mm::ZERO };
        let back_off = axis.homing.back_off + depth;
        self.travel(axis, -axis.endstop.towards(back_off), axis.homing.fast, EndstopSet::NONE).await?;
        // Twice the distance backed off finds any switch that is still there.
        let sought = back_off * 2;
        let before = self.real_steps();
        if !self.approach(axis, sought, axis.homing.slow).await? {
            return Err(NO_TRIGGER);
        }
        if self.real_steps() == before {
            return Err(STILL_PRESSED);
        }
        self.homed.note_met(axis.index, self.planner.path());
        Ok(back_off)
    }

    /// Moves towards the switch; true if it was met.
    async fn approach(&mut self, axis: &Axis, distance: Mm, speed: MmPerSec) -> Result<bool, HomeError> {
        if !self.link.status().inputs().has(axis.switch) {
            return Err(NOT_FITTED);
        }
        self.travel(axis, axis.endstop.towards(distance), speed, axis.switch).await?;
        let met = !self.link.status().triggered().is_empty();
        self.drop_motion().await?;
        Ok(met)
    }

    /// Moves one axis, and waits until it is there or has met what it watches for. Where four coordinates hold three axes,
    /// the move takes them to whole steps, where all counts agree. From there an axis alone takes all its motors along at
    /// once, and the counts agree wherever a switch ends the move.
    async fn travel(&mut self, axis: &Axis, distance: Mm, speed: MmPerSec, watch: EndstopSet) -> Result<(), Interrupt> {
        let mut steps = self.planner.end();
        if self.real.groups().is_redundant() {
            steps = steps.map(Steps::wrapping_round);
        }
        let mut position = self.planner.mm(steps);
        if let Some(at) = position.get_mut(axis.index) {
            *at = at.saturating_add(distance);
        }
        self.plan(Target { position, speed, has_overrides: false, watch }).await?;
        self.finish().await
    }

    /// The axis stands at its switch, or at the whole step next to it. Motors stand on whole steps, so an axis that shares them
    /// with this one may lie between two steps of its own; it moves to a whole one, half a step beside. Where motors have pulleys of
    /// different sizes the step of an axis is long, and no whole one is where all of them stand.
    async fn stand_at_switch(&mut self, axis: &Axis) -> Result<(), Interrupt> {
        let mechanism = self.real.groups().mechanism();
        let mut position = self.real_steps();
        let [x, y, z, _] = self.planner.steps([axis.endstop.position; 4]);
        for (other, (at, switch)) in position.iter_mut().zip([x, y, z]).enumerate() {
            if other == axis.index {
                *at = if mechanism.has_multiples() { switch } else { switch.wrapping_round() };
            } else if !mechanism.has_multiples() && mechanism.share(other, axis.index) {
                *at = at.wrapping_round();
            }
        }
        self.adopt_position(position).await?;
        if axis.index == 2 {
            self.retraction.forget_lift();
        }
        self.modal.position = self.retraction.commanded(self.planner.mm(position));
        Ok(())
    }
}
