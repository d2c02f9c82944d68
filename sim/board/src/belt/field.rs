//! Field: by how much a driver turns the field of its motor at a step.
//!
//! A TMC2209 that was reset runs by its pins, mostly 8 microsteps instead of 16, so a step turns the field twice as
//! far. It also counts its microsteps from 0 again (MSCNT, datasheet rev 1.09, section 5.4). So the field jumps to its
//! power-up place in the electrical turn.

use crate::tmc2209::Tmc2209;

/// Full steps of an electrical turn.
const TURN: i64 = 4;

/// The source of its step size.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Sized {
    /// Its jumpers, which the settings name: the driver was never configured.
    ByJumpers,
    /// The firmware's configuration.
    AsTold,
    /// Its pins, because it was reset.
    ByPins,
}

/// The state of one driver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    /// Microsteps that the firmware counts on.
    microsteps: u32,
    sized: Sized,
}

impl Field {
    pub(super) const fn new(microsteps: u32) -> Self {
        Self { microsteps, sized: Sized::ByJumpers }
    }

    /// A step of +1 or -1 of a motor that has stepped to `count`; in steps that the firmware counts on.
    pub(super) fn step(&mut self, step: i64, count: i64, chip: &Tmc2209) -> i64 {
        if chip.is_configured() {
            self.sized = Sized::AsTold;
        }
        let longer = step * i64::from(self.microsteps / chip.microsteps().max(1)).max(1);
        match self.sized {
            Sized::ByJumpers => step,
            Sized::AsTold if chip.is_configured() => step,
            Sized::AsTold => {
                self.sized = Sized::ByPins;
                let turn = TURN * i64::from(self.microsteps);
                longer - ((count + turn / 2).rem_euclid(turn) - turn / 2)
            }
            Sized::ByPins => longer,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_that_was_reset_begins_its_turn_anew_and_makes_longer_steps() {
        let mut chip = Tmc2209::new(0);
        let mut field = Field::new(16);
        assert_eq!(field.step(1, 10, &chip), 1, "by its jumpers");
        chip.set(0x00, 1 << 7);
        assert_eq!(field.step(-1, 10, &chip), -1);
        chip.reset();
        // 74 is 10 past a turn of 64, 120 is 8 before one; 8 microsteps are half as many.
        assert_eq!(field.step(1, 74, &chip), 2 - 10);
        assert_eq!(field.step(-1, 66, &chip), -2);
    }
}
