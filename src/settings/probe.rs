//! The Z probe: its kind, its offset from the nozzle, and how it touches the bed.

use super::rows::{Choice, Chosen, Field, Spec, Value, rows};
use super::{Cartesian, Settings, ranges};
use crate::units::{Mm, MmPerSec, Seconds};
use serde::{Deserialize, Serialize};

/// How a probe is put out and triggers.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum ProbeKind {
    /// There is none.
    None,
    /// A switch or an inductive sensor, fixed or docked: it is always out.
    Switch,
    /// A BLTouch or a relative: a servo's pulses put its pin out.
    BlTouch,
    /// The nozzle itself touches.
    Nozzle,
}

impl Choice for ProbeKind {
    const ALL: &'static [(Self, &'static str)] =
        &[(Self::None, "none"), (Self::Switch, "switch"), (Self::BlTouch, "bltouch"), (Self::Nozzle, "nozzle")];
}

/// The probe, and how it is used. Its connector is [`Settings::probe_plug`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Probe {
    /// Its kind.
    pub kind: ProbeKind,
    /// Its place minus the nozzle's when it triggers: its z is negative if it triggers with the nozzle above the bed.
    pub offset: Cartesian<Mm>,
    /// Speed of the first touch at a place.
    pub fast: MmPerSec,
    /// Speed of the touches that count.
    pub slow: MmPerSec,
    /// Touches that count.
    pub samples: u8,
    /// Greatest difference between them.
    pub tolerance: Mm,
    /// How often they are repeated if they differ more.
    pub retries: u8,
    /// Distance of the probe from the bed between touches.
    pub clearance: Mm,
    /// The same while it is put out and taken in.
    pub deploy_clearance: Mm,
    /// Speed from place to place.
    pub travel: MmPerSec,
    /// Whether G28 homes z by the probe.
    pub homes_z: bool,
    /// Where the probe touches for that, in x and y; by default in the middle of the bed.
    pub home: [Option<Mm>; 2],
    /// Rest before a touch.
    pub quiet: Seconds,
    /// Whether the bed's heater is off while a touch is awaited.
    pub bed_heater_off: bool,
}

impl Probe {
    /// No probe. The speeds, clearances and the rest are Marlin's and Klipper's (Configuration.h 2.1:
    /// `Z_PROBE_FEEDRATE_FAST`, `Z_CLEARANCE_*`, `XY_PROBE_FEEDRATE`; Klipper: `samples_tolerance`); a fast touch at 4
    /// mm/s stops within a step.
    pub(super) const fn prototype() -> Self {
        Self {
            kind: ProbeKind::None,
            offset: Cartesian { x: Mm::ZERO, y: Mm::ZERO, z: Mm::ZERO },
            fast: MmPerSec::const_from_int(4),
            slow: MmPerSec::const_from_int(2),
            samples: 2,
            tolerance: const { Mm::lit("0.1") },
            retries: 1,
            clearance: Mm::const_from_int(5),
            deploy_clearance: Mm::const_from_int(10),
            travel: MmPerSec::const_from_int(133),
            homes_z: false,
            home: [None; 2],
            quiet: const { Seconds::lit("0.2") },
            bed_heater_off: false,
        }
    }

    /// Whether there is one.
    #[must_use]
    pub const fn is_fitted(&self) -> bool {
        !matches!(self.kind, ProbeKind::None)
    }

    /// How far the probe's place in x and y is from here, seen from the nozzle.
    #[must_use]
    pub const fn way_to(&self, other: &Self) -> [Mm; 2] {
        [other.offset.x.saturating_sub(self.offset.x), other.offset.y.saturating_sub(self.offset.y)]
    }

    /// The height of the nozzle above the bed at which the probe is to trigger.
    #[must_use]
    pub fn trigger_height(&self) -> Mm {
        -self.offset.z
    }

    /// The height of the nozzle at which the probe is so far above a flat bed, and so is the nozzle.
    #[must_use]
    pub fn nozzle_at(&self, clearance: Mm) -> Mm {
        clearance.saturating_add(self.trigger_height().max(Mm::ZERO))
    }
}

fn parts(s: &mut Settings) -> [&mut Probe; 1] {
    [&mut s.probe]
}

rows! {
    for probe in parts, named &["probe"];

    /// The Z probe at the connector endstops.probe: "none"; "switch", any switch or inductive sensor; "bltouch", whose
    /// pin a servo puts out; "nozzle", which touches the bed itself.
    110 "kind" = Chosen(&mut probe.kind), "", [Spec::choice::<ProbeKind>()];
    /// Speed of the first touch at a place, which only finds the bed.
    112 "fast" = probe.fast, "mm/s", [ranges::PROBE_SPEED.spec()];
    /// Speed of the touches that count.
    113 "slow" = probe.slow, "mm/s", [ranges::PROBE_SPEED.spec()];
    /// Touches at a place that count; the height is their mean.
    114 "samples" = probe.samples, "", [ranges::PROBE_SAMPLES.spec()];
    /// How far these touches may differ.
    115 "tolerance" = probe.tolerance, "mm", [ranges::PROBE_TOLERANCE.spec()];
    /// How often they are repeated if they differ more.
    116 "retries" = probe.retries, "", [ranges::PROBE_RETRIES.spec()];
    /// Distance of the probe from the bed between touches.
    117 "clearance" = probe.clearance, "mm", [ranges::PROBE_CLEARANCE.spec()];
    /// Distance of the probe from the bed while it is put out.
    118 "deploy_clearance" = probe.deploy_clearance, "mm", [ranges::PROBE_CLEARANCE.spec()];
    /// Speed from place to place.
    119 "travel" = probe.travel, "mm/s", [ranges::SPEED.spec()];
}

/// Rows of the switches: two parts of one row, because a record has hardly room for another row.
pub(super) mod switches {
    use super::*;

    fn parts(s: &mut Settings) -> [&mut bool; 2] {
        [&mut s.probe.homes_z, &mut s.probe.bed_heater_off]
    }

    rows! {
        for is_on in parts, named &["probe.z_home", "probe.bed_heater_off"];

        /// Whether G28 homes z by the probe instead of a switch (z_home). Whether the bed's heater is off while a touch
        /// is awaited (bed_heater_off): its current is noise for some probes.
        120 "" = *is_on, "", [Spec::SWITCH];
    }
}

/// Row of the rest, apart because ids that follow each other are shorter.
pub(super) mod quiet {
    use super::*;

    fn parts(s: &mut Settings) -> [&mut Probe; 1] {
        [&mut s.probe]
    }

    rows! {
        for probe in parts, named &["probe"];

        /// Rest before a touch.
        121 "quiet" = probe.quiet, "s", [ranges::PROBE_QUIET.spec()];
    }
}

/// A place, or none, such as the middle of the bed. Records say 0 for none, so they say the least number above 0 for
/// the place 0: earlier records and earlier firmware mean the same by their numbers.
pub(super) struct Place<'a>(pub &'a mut Option<Mm>);

impl Field for Place<'_> {
    fn get(&self) -> Value {
        let zero = if self.0.is_some() { Mm::DELTA } else { Mm::ZERO };
        self.0.filter(|place| *place != Mm::ZERO).unwrap_or(zero).get()
    }

    fn set(&mut self, value: &Value) -> bool {
        let mut place = Mm::ZERO;
        let is_one = place.set(value);
        if is_one {
            let place = (place != Mm::ZERO).then_some(place);
            *self.0 = place.map(|place| if place == Mm::DELTA { Mm::ZERO } else { place });
        }
        is_one
    }
}

/// Rows of the place where z is homed.
pub(super) mod home {
    use super::*;

    fn parts(s: &mut Settings) -> [&mut Option<Mm>; 2] {
        s.probe.home.each_mut()
    }

    rows! {
        for place in parts, named &["probe.home.x", "probe.home.y"];

        /// Where the probe touches to home z; "auto" is the middle of the bed.
        122 "" = Place(place), "mm", [ranges::PLACE.spec().or_auto()];
    }
}

/// Rows of [`Probe::offset`].
pub(super) mod offset {
    use super::*;

    fn parts(s: &mut Settings) -> [&mut Mm; 3] {
        let Cartesian { x, y, z } = &mut s.probe.offset;
        [x, y, z]
    }

    const XY: Spec = ranges::PROBE_OFFSET.spec();

    rows! {
        for offset in parts, named &["probe.offset.x", "probe.offset.y", "probe.offset.z"];

        /// Place of the probe minus the nozzle's. In z it is the negative height of the nozzle above the bed at which
        /// the probe triggers.
        111 "" = *offset, "mm", [XY, XY, ranges::PROBE_OFFSET_Z.spec()], "M851" "X" "Y" "Z";
    }
}
