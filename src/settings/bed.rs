//! The bed: where the machine can print, which may be less than where its tool can go.

use super::rows::rows;
use super::{Probe, Range, Settings, ranges};
use crate::units::Mm;
use serde::{Deserialize, Serialize};

/// A rectangle in the coordinates of the homed machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Bed {
    /// Its size in x.
    pub width: Mm,
    /// Its size in y.
    pub depth: Mm,
    /// x of its left edge.
    pub left: Mm,
    /// y of its front edge.
    pub front: Mm,
    /// How far z stands above the place that the program names, from homing on (M290, SET_GCODE_OFFSET).
    pub z_offset: Mm,
}

impl Bed {
    /// All that the tool reaches.
    #[must_use]
    pub const fn of_reach(x: Range<Mm>, y: Range<Mm>) -> Self {
        let (width, depth) = (x.most.saturating_sub(x.least), y.most.saturating_sub(y.least));
        Self { width, depth, left: x.least, front: y.least, z_offset: Mm::ZERO }
    }
}

/// Where an offset of z is kept over homing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ZStore {
    /// With the program: [`Bed::z_offset`] (SET_GCODE_OFFSET).
    Program,
    /// With the probe, where it homes z: the z of its offset (M851).
    Probe,
}

impl Settings {
    /// Where M290 keeps its shift: it corrects the place at which z was homed. Klipper's start of a print sets the
    /// program's offset, and would take the correction with it.
    #[must_use]
    pub const fn store_of_shifts(&self) -> ZStore {
        if self.homes_z_by_probe() { ZStore::Probe } else { ZStore::Program }
    }

    /// The offset of z that is kept there.
    #[must_use]
    pub const fn z_offset(&self, store: ZStore) -> Mm {
        match store {
            ZStore::Program => self.bed.z_offset,
            ZStore::Probe => self.probe.offset.z,
        }
    }

    /// Sets it.
    pub const fn set_z_offset(&mut self, store: ZStore, offset: Mm) {
        match store {
            ZStore::Program => self.bed.z_offset = offset,
            ZStore::Probe => self.probe.offset.z = offset,
        }
    }

    /// Both offsets that are kept over homing; the probe's is 0 where it does not home z.
    #[must_use]
    pub const fn z_offsets(&self) -> [Mm; 2] {
        [self.bed.z_offset, if self.homes_z_by_probe() { self.probe.offset.z } else { Mm::ZERO }]
    }

    /// The probe in the program's z from homing on: where it homes z, the program's offset lies between its zero and
    /// the bed.
    #[must_use]
    pub const fn probe_in_program(&self) -> Probe {
        let mut probe = self.probe;
        if self.homes_z_by_probe() {
            probe.offset.z = probe.offset.z.saturating_add(self.bed.z_offset);
        }
        probe
    }
}

rows! {
    for bed in |s, _| Some(&mut s.bed), named &["bed"];

    /// Size in x.
    27 "width" = &mut bed.width, "mm", [ranges::AXIS_LENGTH.spec()];
    /// Size in y.
    28 "depth" = &mut bed.depth, "mm", [ranges::AXIS_LENGTH.spec()];
    /// x of its left edge.
    29 "left" = &mut bed.left, "mm", [ranges::PLACE.spec()];
    /// y of its front edge.
    30 "front" = &mut bed.front, "mm", [ranges::PLACE.spec()];
    /// How far z stands above the place that the program names, from homing on (M290, SET_GCODE_OFFSET).
    125 "z_offset" = &mut bed.z_offset, "mm", [ranges::Z_OFFSET.spec()];
}
