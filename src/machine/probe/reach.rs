//! Where the probe can touch the bed.

use crate::machine::answers::probe_answer::ProbeAnswer;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::{EndstopSet, Wake};
use crate::settings::{Range, Settings};
use crate::units::Mm;

/// Whether the machine has a probe, at an input of its board.
pub(in crate::machine) fn has_probe<P: PortSet, W: Wake>(main_loop: &MainLoop<'_, P, W>) -> bool {
    main_loop.settings.probe.is_fitted() && main_loop.status.inputs().has(EndstopSet::PROBE)
}

/// The bed's edge is no place to measure: clips, and chamfers (Marlin's `PROBING_MARGIN`, Configuration.h 2.1). A place
/// that a file or a line names for a touch may be there.
const MARGIN: Mm = Mm::const_from_int(10);

/// The x and the y that can be measured by many touches.
pub(in crate::machine) fn area_reach(s: &Settings) -> [Range<Mm>; 2] {
    s.probe_reach(MARGIN)
}

/// The place of the nozzle for a touch at a place; an answer if the probe cannot touch there. Every touch asks here.
pub(in crate::machine) fn nozzle_for(s: &Settings, at: [Mm; 2]) -> Result<[Mm; 2], ProbeAnswer> {
    if !s.can_touch(at) {
        return Err(ProbeAnswer::OutOfReach { at, reaches: s.probe_reach(Mm::ZERO) });
    }
    let ([x, y], offset) = (at, s.probe.offset);
    Ok([x.saturating_sub(offset.x), y.saturating_sub(offset.y)])
}
