//! Where the probe can touch the bed.

use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::port::{EndstopSet, Pend};
use crate::settings::{HomedAxis, Range, Settings};
use crate::units::Mm;

/// Whether the machine has a probe, at an input of its board.
pub(in crate::machine) fn has_probe<P: PortSet, W: Pend>(main_loop: &MainLoop<'_, P, W>) -> bool {
    main_loop.settings.probe.is_fitted() && main_loop.status.inputs().has(EndstopSet::PROBE)
}

/// The bed's edge is no place to touch: clips, and chamfers (Marlin's `PROBING_MARGIN`, Configuration.h 2.1).
const MARGIN: Mm = Mm::const_from_int(10);

/// The x and the y where the probe can touch: over the bed, and with the nozzle inside the reachable space.
pub(in crate::machine) fn reach(s: &Settings) -> [Range<Mm>; 2] {
    let (bed, offset) = (&s.bed, &s.probe.offset);
    let of = |axis: HomedAxis, offset: Mm, begin: Mm, length: Mm| {
        let nozzle = s.reach(axis);
        let end = begin.saturating_add(length).saturating_sub(MARGIN);
        Range {
            least: nozzle.least.saturating_add(offset).max(begin.saturating_add(MARGIN)),
            most: nozzle.most.saturating_add(offset).min(end),
        }
    };
    [of(HomedAxis::X, offset.x, bed.left, bed.width), of(HomedAxis::Y, offset.y, bed.front, bed.depth)]
}

/// The place where the probe touches to home z.
pub(in crate::machine) fn home_place(s: &Settings) -> [Mm; 2] {
    let bed = &s.bed;
    let middle = [bed.left.saturating_add(bed.width / 2), bed.front.saturating_add(bed.depth / 2)];
    let [x, y] = s.probe.home;
    let [middle_x, middle_y] = middle;
    [if x == Mm::ZERO { middle_x } else { x }, if y == Mm::ZERO { middle_y } else { y }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mm(mm: f64) -> Mm {
        Mm::from_num(mm)
    }

    #[test]
    fn the_probe_reaches_where_the_nozzle_can_take_it_over_the_bed() {
        let mut s = Settings::prototype();
        let ends = |s: &Settings| reach(s).map(|Range { least, most }| [least, most]);
        assert_eq!(ends(&s), [[mm(10.0), mm(380.0)], [mm(10.0), mm(417.6) - mm(10.0)]]);
        (s.probe.offset.x, s.probe.offset.y) = (mm(-45.0), mm(30.0));
        assert_eq!(ends(&s), [[mm(10.0), mm(345.0)], [mm(30.0), mm(417.6) - mm(10.0)]]);
        (s.bed.left, s.bed.width) = (mm(-20.0), mm(430.0));
        assert_eq!(ends(&s)[0], [mm(-10.0), mm(345.0)]);
    }

    #[test]
    fn z_is_homed_in_the_middle_of_the_bed_unless_a_place_is_set() {
        let mut s = Settings::prototype();
        assert_eq!(home_place(&s), [mm(195.0), mm(417.6) / 2]);
        s.probe.home = [mm(50.0), mm(0.0)];
        assert_eq!(home_place(&s), [mm(50.0), mm(417.6) / 2]);
    }
}
