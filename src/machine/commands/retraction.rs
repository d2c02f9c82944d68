//! Retractions (G10, G11): the limits of their settings, and what ends one without a move. The moves are in `moves`.

use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::Pend;
use crate::settings::Range;
use crate::units::Mm;

/// The longest retraction and the highest lift: bowden tubes need less than a tenth of it.
pub(super) const RETRACTION: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };

/// A retraction left over from one print does not apply to the next. In a pause it is part of what the print goes on
/// with.
pub(super) fn forget_retraction<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>) {
    if !main_loop.job.is_paused() {
        main_loop.commanded.forget_retraction();
    }
}
