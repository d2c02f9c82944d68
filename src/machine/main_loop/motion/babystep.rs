//! The live offset of z: its total since z was homed, and its steps between program and motors.
//!
//! The planner knows nothing of it: positions of moves and of the program are without the offset, counts of steps are
//! with it. The generator adds it to the path of z. Every position that is adopted takes in the offset of that moment.

use super::Motion;
use crate::port::Wake;
use crate::settings::AxisSettings;
use crate::units::{Mm, Steps, StepsPerMm};

/// The offset as the Console counts it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Babystep {
    /// Since z was homed.
    total: Mm,
    /// The same in whole steps.
    whole: i32,
    /// Steps since the start that the present counts of the motors take in.
    taken_in: i32,
}

impl Babystep {
    /// The total in steps of this size, to the nearest one, so that parts of steps add up.
    fn count(&mut self, resolution: StepsPerMm) {
        self.whole = (self.total * resolution).wrapping_round().to_num();
    }
}

impl<W: Wake> Motion<'_, W> {
    /// Shifts z by a length from now on, while moves are under way.
    pub fn shift_z(&mut self, by: Mm, z: &AxisSettings) {
        let before = self.babystep.whole;
        self.babystep.total = self.babystep.total.saturating_add(by);
        self.babystep.count(z.steps_per_mm);
        self.link.shift_z(self.babystep.whole.wrapping_sub(before), z);
    }

    /// The sum of all shifts since z was homed.
    pub const fn shifted_z(&self) -> Mm {
        self.babystep.total
    }

    /// Whether z is still to rise by a shift.
    pub fn is_raising(&self) -> bool {
        self.link.is_raising()
    }

    /// Z was homed at its present place.
    pub fn forget_shifts(&mut self) {
        (self.babystep.total, self.babystep.whole) = (Mm::ZERO, 0);
    }

    /// Z has steps of another size.
    pub(super) fn resize_shifts(&mut self, resolution: StepsPerMm) {
        self.babystep.count(resolution);
    }

    /// Steps by which z stands aside of its path.
    pub(super) fn aside(&self) -> Steps {
        Steps::wrapping_from_num(self.link.shifted_z().wrapping_sub(self.babystep.taken_in).into())
    }

    /// The position that is adopted takes in the offset.
    pub(super) fn take_in_shifts(&mut self) {
        self.babystep.taken_in = self.link.shifted_z();
    }
}
