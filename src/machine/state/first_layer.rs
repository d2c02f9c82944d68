//! The first layer: how far z really stands from the place that the program names, and what of that is stored.
//!
//! `Bed::z_offset` is kept over homing: z meets its switch, or the bed by its probe, at a place that is lower by it. So
//! a homed machine really stands at `position + kept + unkept`. SET_GCODE_OFFSET adds to the kept part. M290 does so
//! too where a switch homes z, with P0 to the other one, and z moves. An order that lets z stand until its next move
//! (SET_GCODE_OFFSET without MOVE) takes from one and adds to the other. Where z homes by the probe, M290 changes the
//! probe's offset: it takes part in homing, and until then ends with it. With another offset of M851 the place of z
//! gets another name at once, as if it were homed again.

use crate::settings::{HomedAxis, Probe, Range, Settings};
use crate::units::Mm;

/// The offsets of z.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct FirstLayer {
    /// Ends with the next homing of z.
    unkept: Mm,
    /// So does this: the part that M290 has added to the probe's offset. Homing finds it there.
    of_probe: Mm,
    /// How far below the end of its axis z may go, for the sum of both. It is told in each turn, so it is kept.
    below: Mm,
    /// The kept offsets as they are in storage.
    stored: [Mm; 2],
    /// The offsets that hosts were last told are not stored.
    told: [Mm; 2],
}

impl FirstLayer {
    /// With these settings as the stored ones.
    pub const fn new(s: &Settings) -> Self {
        Self { unkept: Mm::ZERO, of_probe: Mm::ZERO, below: Mm::ZERO, stored: s.z_offsets(), told: s.z_offsets() }
    }

    /// The offset changes by so much beside the kept one.
    pub fn shift(&mut self, by: Mm) {
        self.pass(self.unkept.saturating_add(by), self.of_probe);
    }

    /// The offset of the probe that homes z changes by so much, and z with it.
    pub fn shift_with_probe(&mut self, by: Mm) {
        self.pass(self.unkept, self.of_probe.saturating_add(by));
    }

    /// Z has the place that it would have if it were homed with the probe's offset as it is.
    pub fn believe_probe(&mut self) {
        self.pass(self.unkept, Mm::ZERO);
    }

    /// Z was homed.
    pub fn forget(&mut self) {
        self.pass(Mm::ZERO, Mm::ZERO);
    }

    fn pass(&mut self, unkept: Mm, of_probe: Mm) {
        (self.unkept, self.of_probe) = (unkept, of_probe);
        self.below = self.passing().max(Mm::ZERO);
    }

    /// What ends with the next homing.
    fn passing(&self) -> Mm {
        self.unkept.saturating_add(self.of_probe)
    }

    /// The distance of z from the place that the planner knows.
    pub fn aside(&self, s: &Settings) -> Mm {
        s.bed.z_offset.saturating_add(self.passing())
    }

    /// The probe in the planner's z: where it homes z, it finds the bed where it says, whatever offsets the program has
    /// and wherever they have taken its zero.
    pub fn probe(&self, s: &Settings) -> Probe {
        let mut probe = s.probe_in_program();
        if s.homes_z_by_probe() {
            probe.offset.z = probe.offset.z.saturating_add(self.unkept);
        }
        probe
    }

    /// Where the planner may send z: up to the end of its axis, and down to where the bed is.
    pub fn reach(&self, s: &Settings) -> Range<Mm> {
        let Range { least, most } = s.reach(HomedAxis::Z);
        Range { least: least.saturating_sub(self.below()), most: most.saturating_sub(self.aside(s)) }
    }

    /// How far below the end of its axis z may go.
    pub const fn below(&self) -> Mm {
        self.below
    }

    /// These settings are in storage.
    pub const fn note_stored(&mut self, s: &Settings) {
        self.stored = s.z_offsets();
    }

    /// Whether the kept offsets are in storage.
    pub fn are_stored(&self, s: &Settings) -> [bool; 2] {
        let ([program, probe], [stored, stored_of_probe]) = (s.z_offsets(), self.stored);
        [program == stored, probe == stored_of_probe]
    }

    /// Whether hosts are to be told that it is not. They are told once of each.
    pub fn tells(&mut self, s: &Settings) -> bool {
        let is_news = self.stored != s.z_offsets() && self.told != s.z_offsets();
        self.told = s.z_offsets();
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
        assert!(!layer.tells(&s) && layer.are_stored(&s) == [true; 2]);
        s.bed.z_offset = Mm::lit("0.05");
        assert!(layer.tells(&s) && !layer.tells(&s) && layer.are_stored(&s) == [false, true]);
        layer.note_stored(&s);
        assert!(!layer.tells(&s) && layer.are_stored(&s) == [true; 2]);
    }
}
