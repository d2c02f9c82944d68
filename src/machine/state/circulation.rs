//! Circulation: how far a closed belt has run round, and where z stands while it does.

use crate::units::{Mm, Steps, StepsPerMm};

/// The belt's third way to go, besides those that move the tool.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Circulation {
    /// Steps that every motor of the belt has made for it since the start, signed.
    steps: i64,
    /// Where z stands while the belt has its place in the planner, in steps.
    z: Steps,
}

impl Circulation {
    /// The belt lies where it lay at the start.
    pub const fn new() -> Self {
        Self { steps: 0, z: Steps::ZERO }
    }

    /// How far it has run round.
    pub fn length(&self, resolution: StepsPerMm) -> Mm {
        // Steps by steps a millimetre, the latter in 2^-16ths or whatever fraction they have.
        let bits = (i128::from(self.steps) << (StepsPerMm::FRAC_NBITS + Mm::FRAC_NBITS))
            / i128::from(resolution.to_bits().max(1));
        Mm::from_bits(bits as i64)
    }

    /// The belt takes the place of z, which stands there.
    pub const fn begin(&mut self, z: Steps) {
        self.z = z;
    }

    /// It has run on by so many steps.
    pub const fn add(&mut self, steps: i64) {
        self.steps = self.steps.wrapping_add(steps);
    }

    /// Where z stands, in steps.
    pub const fn z(&self) -> Steps {
        self.z
    }
}
