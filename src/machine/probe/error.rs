//! Why a touch has no result.

use crate::machine::interrupt::Interrupt;
use crate::machine::state::job::ProbeFailure;

/// Why a touch has no result.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum ProbeError {
    /// The probe did not do as it should.
    Failed(ProbeFailure),
    /// Something else ended it.
    Interrupted(Interrupt),
}

impl From<ProbeFailure> for ProbeError {
    fn from(failure: ProbeFailure) -> Self {
        Self::Failed(failure)
    }
}

impl From<Interrupt> for ProbeError {
    fn from(interrupt: Interrupt) -> Self {
        Self::Interrupted(interrupt)
    }
}
