//! The first layer: how far z really stands from the place that the program names, and what of that is stored.
//!
//! `Settings::z_offset` is kept over homing: z meets its switch at a place that is lower by it. So a homed machine
//! really stands at `position + kept + unkept`. M290 adds to the kept part, with P0 to the other one, and z moves. An
//! order that lets z stand until its next move (SET_GCODE_OFFSET without MOVE) takes from one and adds to the other.
//! Where z homes by the probe, its offset is the kept one: it takes part in homing, and until then counts as unkept.

use crate::settings::{HomedAxis, Range, Settings};
use crate::units::Mm;

/// The offsets of z.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct FirstLayer {
    /// Ends with the next homing of z.
    unkept: Mm,
    /// The kept offset as it is in storage.
    stored: Mm,
    /// The offset that hosts were last told is not stored.
    told: Mm,
}

impl FirstLayer {
    /// With these settings as the stored ones.
    pub const fn new(s: &Settings) -> Self {
        Self { unkept: Mm::ZERO, stored: s.z_offset(), told: s.z_offset() }
    }

    /// The offset changes by so much beside the kept one.
    pub fn shift(&mut self, by: Mm) {
        self.unkept = self.unkept.saturating_add(by);
    }

    /// Z was homed.
    pub const fn forget(&mut self) {
        self.unkept = Mm::ZERO;
    }

    /// The distance of z from the place that the planner knows.
    pub fn aside(&self, s: &Settings) -> Mm {
        s.bed.z_offset.saturating_add(self.unkept)
    }

    /// Where the planner may send z: up to the end of its axis, and down to where the bed is.
    pub fn reach(&self, s: &Settings) -> Range<Mm> {
        let Range { least, most } = s.reach(HomedAxis::Z);
        Range { least: least.saturating_sub(self.unkept.max(Mm::ZERO)), most: most.saturating_sub(self.aside(s)) }
    }

    /// These settings are in storage.
    pub const fn note_stored(&mut self, s: &Settings) {
        self.stored = s.z_offset();
    }

    /// Whether the kept offset is in storage.
    pub fn is_stored(&self, s: &Settings) -> bool {
        self.stored == s.z_offset()
    }

    /// Whether hosts are to be told that it is not. They are told once of each.
    pub fn tells(&mut self, s: &Settings) -> bool {
        let is_news = !self.is_stored(s) && self.told != s.z_offset();
        self.told = s.z_offset();
        is_news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bed_is_the_lower_edge_and_the_frame_the_upper_one() {
        let mut s = Settings::prototype();
        s.bed.z_offset = Mm::lit("-0.25");
        let mut layer = FirstLayer::new(&s);
        assert_eq!(layer.reach(&s), Range { least: Mm::ZERO, most: Mm::lit("335.25") });
        // Up without keeping it: what is down to the bed as kept stays in reach.
        layer.shift(Mm::lit("0.5"));
        assert_eq!(layer.aside(&s), Mm::lit("0.25"));
        assert_eq!(layer.reach(&s), Range { least: Mm::lit("-0.5"), most: Mm::lit("334.75") });
        layer.forget();
        layer.shift(Mm::lit("-0.5"));
        assert_eq!(layer.reach(&s), Range { least: Mm::ZERO, most: Mm::lit("335.75") });
    }

    #[test]
    fn an_offset_that_is_not_stored_is_told_once() {
        let mut s = Settings::prototype();
        let mut layer = FirstLayer::new(&s);
        assert!(!layer.tells(&s) && layer.is_stored(&s));
        s.bed.z_offset = Mm::lit("0.05");
        assert!(layer.tells(&s) && !layer.tells(&s) && !layer.is_stored(&s));
        layer.note_stored(&s);
        assert!(!layer.tells(&s) && layer.is_stored(&s));
    }
}
