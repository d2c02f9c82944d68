//! Reach: where the tool can go, and where the probe can touch.

use super::{HomedAxis, Range, Settings};
use crate::units::Mm;

impl Settings {
    /// Where an axis can be.
    #[must_use]
    pub fn reach(&self, axis: HomedAxis) -> Range<Mm> {
        let (least, length) =
            (self.axis_min.of(axis), self.axes.get(axis as usize).map_or(Mm::ZERO, |axis| axis.length));
        Range { least, most: least.saturating_add(length) }
    }

    /// The x and the y where the probe can touch: over the bed less a `margin` at its edges, and with the nozzle inside
    /// the reachable space. Every touch is held to it.
    #[must_use]
    pub fn probe_reach(&self, margin: Mm) -> [Range<Mm>; 2] {
        let (bed, offset) = (&self.bed, &self.probe.offset);
        let of = |axis: HomedAxis, offset: Mm, begin: Mm, length: Mm| {
            let nozzle = self.reach(axis);
            let end = begin.saturating_add(length).saturating_sub(margin);
            Range {
                least: nozzle.least.saturating_add(offset).max(begin.saturating_add(margin)),
                most: nozzle.most.saturating_add(offset).min(end),
            }
        };
        [of(HomedAxis::X, offset.x, bed.left, bed.width), of(HomedAxis::Y, offset.y, bed.front, bed.depth)]
    }

    /// Whether the probe can touch at a place.
    #[must_use]
    pub fn can_touch(&self, at: [Mm; 2]) -> bool {
        self.probe_reach(Mm::ZERO).iter().zip(at).all(|(reach, at)| reach.holds(at))
    }

    /// Where the probe touches to home z.
    #[must_use]
    pub fn probe_home(&self) -> [Mm; 2] {
        let (bed, [x, y]) = (&self.bed, self.probe.home);
        let middle = |begin: Mm, length: Mm| begin.saturating_add(length / 2);
        [x.unwrap_or_else(|| middle(bed.left, bed.width)), y.unwrap_or_else(|| middle(bed.front, bed.depth))]
    }
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
        let ends = |s: &Settings, margin: f64| s.probe_reach(mm(margin)).map(|Range { least, most }| [least, most]);
        assert_eq!(ends(&s, 0.0), [[mm(0.0), mm(390.0)], [mm(0.0), mm(417.6)]]);
        assert_eq!(ends(&s, 10.0), [[mm(10.0), mm(380.0)], [mm(10.0), mm(417.6) - mm(10.0)]]);
        (s.probe.offset.x, s.probe.offset.y) = (mm(-45.0), mm(30.0));
        assert_eq!(ends(&s, 0.0), [[mm(0.0), mm(345.0)], [mm(30.0), mm(417.6)]]);
        assert_eq!(ends(&s, 10.0), [[mm(10.0), mm(345.0)], [mm(30.0), mm(417.6) - mm(10.0)]]);
        (s.bed.left, s.bed.width) = (mm(-20.0), mm(430.0));
        assert_eq!(ends(&s, 10.0)[0], [mm(-10.0), mm(345.0)]);
        assert!(s.can_touch([mm(-20.0), mm(30.0)]) && !s.can_touch([mm(-20.0), mm(29.9)]));
    }

    #[test]
    fn z_is_homed_in_the_middle_of_the_bed_unless_a_place_is_set() {
        let mut s = Settings::prototype();
        assert_eq!(s.probe_home(), [mm(195.0), mm(417.6) / 2]);
        s.probe.home = [Some(mm(50.0)), None];
        assert_eq!(s.probe_home(), [mm(50.0), mm(417.6) / 2]);
        // The place 0 is a place.
        s.probe.home = [Some(mm(0.0)); 2];
        assert_eq!(s.probe_home(), [mm(0.0); 2]);
    }
}
