//! The Z probe: its kind, its offset from the nozzle, and how it touches the bed.

use super::field::Number;
use super::rows::{Choice, Spec, numbers, rows};
use super::{Cartesian, ranges};
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

    numbers!(None Switch BlTouch Nozzle);
}

/// The probe, and how it is used. Its connector is [`Settings::probe_plug`](super::Settings::probe_plug).
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

    const fn switch_mut(&mut self, part: usize) -> Option<&mut bool> {
        match part {
            0 => Some(&mut self.homes_z),
            1 => Some(&mut self.bed_heater_off),
            _ => None,
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

rows! {
    for probe in |s, _| Some(&mut s.probe), named &["probe"];

    /// The Z probe at the connector endstops.probe: "none"; "switch", any switch or inductive sensor; "bltouch", whose
    /// pin a servo puts out; "nozzle", which touches the bed itself.
    110 "kind" = &mut probe.kind, "", [Spec::choice::<ProbeKind>()];
    /// Speed of the first touch at a place, which only finds the bed.
    112 "fast" = &mut probe.fast, "mm/s", [ranges::PROBE_SPEED.spec()];
    /// Speed of the touches that count.
    113 "slow" = &mut probe.slow, "mm/s", [ranges::PROBE_SPEED.spec()];
    /// Touches at a place that count; the height is their mean.
    114 "samples" = &mut probe.samples, "", [ranges::PROBE_SAMPLES.spec()];
    /// How far these touches may differ.
    115 "tolerance" = &mut probe.tolerance, "mm", [ranges::PROBE_TOLERANCE.spec()];
    /// How often they are repeated if they differ more.
    116 "retries" = &mut probe.retries, "", [ranges::PROBE_RETRIES.spec()];
    /// Distance of the probe from the bed between touches.
    117 "clearance" = &mut probe.clearance, "mm", [ranges::PROBE_CLEARANCE.spec()];
    /// Distance of the probe from the bed while it is put out.
    118 "deploy_clearance" = &mut probe.deploy_clearance, "mm", [ranges::PROBE_CLEARANCE.spec()];
    /// Speed from place to place.
    119 "travel" = &mut probe.travel, "mm/s", [ranges::SPEED.spec()];
}

/// Rows of the switches: two parts of one row, because a record has hardly room for another row.
pub(super) mod switches {
    use super::*;

    rows! {
        for is_on in |s, part| s.probe.switch_mut(part), named &["probe.z_home", "probe.bed_heater_off"];

        /// Whether G28 homes z by the probe instead of a switch (z_home). Whether the bed's heater is off while a touch
        /// is awaited (bed_heater_off): its current is noise for some probes.
        120 "" = is_on, "", [Spec::SWITCH];
    }
}

/// Row of the rest, apart because ids that follow each other are shorter.
pub(super) mod quiet {
    use super::*;

    rows! {
        for probe in |s, _| Some(&mut s.probe), named &["probe"];

        /// Rest before a touch.
        121 "quiet" = &mut probe.quiet, "s", [ranges::PROBE_QUIET.spec()];
    }
}

/// A place, or none, such as the middle of the bed. Records say 0 for none, so they say the least number above 0 for
/// the place 0: earlier records and earlier firmware mean the same by their numbers.
impl Number for Option<Mm> {
    fn value(&self) -> Option<i64> {
        let zero = if self.is_some() { Mm::DELTA } else { Mm::ZERO };
        self.filter(|place| *place != Mm::ZERO).unwrap_or(zero).value()
    }

    fn put(&mut self, number: i64) -> bool {
        let mut place = Mm::ZERO;
        let is_one = place.put(number);
        if is_one {
            let place = (place != Mm::ZERO).then_some(place);
            *self = place.map(|place| if place == Mm::DELTA { Mm::ZERO } else { place });
        }
        is_one
    }
}

/// Rows of the place where z is homed.
pub(super) mod home {
    use super::*;

    rows! {
        for place in |s, part| s.probe.home.get_mut(part), named &["probe.home.x", "probe.home.y"];

        /// Where the probe touches to home z; "auto" is the middle of the bed.
        122 "" = place, "mm", [ranges::PLACE.spec().or_auto()];
    }
}

/// Rows of [`Probe::offset`].
pub(super) mod offset {
    use super::*;

    const XY: Spec = ranges::PROBE_OFFSET.spec();

    rows! {
        for offset in |s, part| s.probe.offset.get_mut(part),
            named &["probe.offset.x", "probe.offset.y", "probe.offset.z"];

        /// Place of the probe minus the nozzle's. In z it is the negative height of the nozzle above the bed at which
        /// the probe triggers.
        111 "" = offset, "mm", [XY, XY, ranges::PROBE_OFFSET_Z.spec()], "M851" "X" "Y" "Z";
    }
}
