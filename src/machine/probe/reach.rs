//! Where the probe can touch the bed.

use crate::machine::answers::answer::Answer;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::Hundredths;
use crate::machine::ports::PortSet;
use crate::port::{EndstopSet, Wake};
use crate::settings::{Range, Settings};
use crate::units::Mm;

/// The answer of a machine without a probe.
pub(in crate::machine) const NO_PROBE: Answer<'static> = Answer::Line(packed!("echo:no probe configured, ignored"));

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

/// The probe cannot touch at a place, but within these.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct OutOfReach {
    pub at: [Mm; 2],
    pub reaches: [Range<Mm>; 2],
}

impl OutOfReach {
    /// Says so, as the answer.
    pub fn answer<P: PortSet, W: Wake>(self, main_loop: &mut MainLoop<'_, P, W>) -> Answer<'static> {
        let [x, y] = self.at.map(Hundredths::of);
        let [[from_x, to_x], [from_y, to_y]] = self.reaches.map(|reach| [reach.least, reach.most].map(Hundredths::of));
        main_loop.say(text!(
            "echo:ignored: the probe cannot touch at X{x} Y{y}, but from X{from_x} Y{from_y} to X{to_x} Y{to_y}"
        ));
        Answer::Said
    }
}

/// The place of the nozzle for a touch at a place, if the probe can touch there. Every touch asks here.
pub(in crate::machine) fn nozzle_for(s: &Settings, at: [Mm; 2]) -> Result<[Mm; 2], OutOfReach> {
    if !s.can_touch(at) {
        return Err(OutOfReach { at, reaches: s.probe_reach(Mm::ZERO) });
    }
    let ([x, y], offset) = (at, s.probe.offset);
    Ok([x.saturating_sub(offset.x), y.saturating_sub(offset.y)])
}
