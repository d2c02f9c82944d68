//! Circulation: the distance by which a closed belt has circulated, and the place of z during it.

use crate::units::{Mm, Steps, StepsPerMm, part_of};

/// The belt's third degree of freedom, besides the two that move the tool.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Circulation {
    /// Where the program has sent it.
    commanded: Mm,
    /// Steps that every motor of the belt has made for it since the start, signed.
    steps: i64,
    /// Where z stands while the belt has its place in the planner, in steps and in mm.
    z: (Steps, Mm),
}

impl Circulation {
    /// The belt lies where it lay at the start.
    pub const fn new() -> Self {
        Self { commanded: Mm::ZERO, steps: 0, z: (Steps::ZERO, Mm::ZERO) }
    }

    /// Where the program has sent it.
    pub const fn commanded(&self) -> Mm {
        self.commanded
    }

    /// The program sends it there.
    pub const fn go_to(&mut self, commanded: Mm) {
        self.commanded = commanded;
    }

    /// The distance by which it has circulated.
    pub fn length(&self, resolution: StepsPerMm) -> Mm {
        resolution.length_of(self.steps)
    }

    /// Steps so far, signed.
    pub const fn steps(&self) -> i64 {
        self.steps
    }

    /// The belt takes the place of z, which stands there.
    pub const fn begin(&mut self, z: (Steps, Mm)) {
        self.z = z;
    }

    /// It has circulated by `steps` more.
    pub const fn add(&mut self, steps: i64) {
        self.steps = self.steps.wrapping_add(steps);
    }

    /// A step is of another length from now on.
    pub fn rescale(&mut self, before: StepsPerMm, now: StepsPerMm) {
        self.steps = part_of(self.steps, now.to_bits().into(), before.to_bits().max(1).into());
    }

    /// Where z stands, in steps and in mm.
    pub const fn z(&self) -> (Steps, Mm) {
        self.z
    }
}
