//! Why a touch has no result.

use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::ProbeFailure;
use crate::port::Wake;

/// The probe did not do as it should: notes why, and ends the touch. Whoever asked for it gets no other result.
#[inline(never)]
pub(super) fn failed<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, why: ProbeFailure) -> Interrupt {
    main_loop.probing.note_failure(why);
    Interrupt::EndJob
}
