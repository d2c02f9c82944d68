//! The belt: settings that the motors of x and y share.

use super::ranges;
use super::rows::{Choice, Spec, numbers, rows};
use crate::units::{Mm, MmPerSec, MmPerSec2};
use serde::{Deserialize, Serialize};

/// The settings of the belt besides the motors' rows.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Belt {
    /// One closed belt runs over all motors that move x or y, and forward is the same way round for each of them. So it
    /// can circulate while the tool stands (C in G0 and G1).
    pub is_closed: bool,
    /// Milliseconds between two motors that get power and can pull against each other.
    pub settling_ms: u16,
    /// Speed limit of the circulation, in mm of belt a second.
    pub max_speed: MmPerSec,
    /// Acceleration limit of the circulation, in mm of belt a second squared.
    pub max_acceleration: MmPerSec2,
    /// Distance that the belt circulates after x and y are homed, so that it does not always bend at the same teeth; 0
    /// switches this off.
    pub homing_advance: Mm,
    /// The reaction to motors that pull against each other and were not aligned since they got power.
    pub alignment: Alignment,
    /// The strain of the belt after alignment: the sum of the motors' residual, in mm of belt.
    pub preload: Mm,
    /// The relation of the drivers' sine tables when nothing strained the belt. It is the sum of each residual, in
    /// 1024ths of an electrical turn, or [`NO_PHASE`](Self::NO_PHASE). It is a mark of the machine: where rotors and
    /// pulleys sit on the belt.
    pub phases: [u16; PHASES],
    /// Lift of z after a motor of the belt has failed, before the others park the tool; with 0 all power is cut at
    /// once.
    pub limp_lift: Mm,
}

/// Residuals that a machine may have phases of: an AWD CoreXY has two.
pub const PHASES: usize = 2;

/// The reaction to motors that pull against each other and were not aligned since they got power.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum Alignment {
    /// None; M915 aligns them.
    Off,
    /// The host gets a warning at the first printing move.
    Warning,
    /// Printing moves are refused.
    Required,
    /// They are aligned when x and y are homed.
    Automatic,
}

impl Alignment {
    /// All of them with their names in machine files.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::Off, "off"), (Self::Warning, "warning"), (Self::Required, "required"), (Self::Automatic, "automatic")];

    /// Its name in machine files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| name)
    }
}

impl Belt {
    /// No phase: it is not known. Phases are less than an electrical turn.
    pub const NO_PHASE: u16 = ranges::NO_PHASE;

    /// The settings of the CoreH-bot.
    ///
    /// A rotor that gets power swings with the tool at 58 Hz and a damping of 4 % or more (docs/research/twin.md, modes
    /// with rotors). The swing falls to a quarter within 100 ms. The limits are a fifth of the motors' own, because
    /// there is no hurry. 10 mm are beyond the reach of a hot nozzle's heat and drips.
    pub(super) const fn prototype() -> Self {
        Self {
            is_closed: true,
            settling_ms: 100,
            max_speed: MmPerSec::const_from_int(100),
            max_acceleration: MmPerSec2::const_from_int(1500),
            homing_advance: Mm::ZERO,
            alignment: Alignment::Off,
            preload: Mm::ZERO,
            phases: [Self::NO_PHASE; PHASES],
            limp_lift: Mm::const_from_int(10),
        }
    }
}

impl Choice for Alignment {
    const ALL: &'static [(Self, &'static str)] = &Self::ALL;

    numbers!(Off Warning Required Automatic);
}

rows! {
    for belt in |s, _| Some(&mut s.belt), named &["belt"];

    /// Whether one closed belt runs over all motors that move x or y, each turning it the same way round when it turns
    /// forward. Such a belt can circulate while the tool stands (C in G0 and G1). A file with a mechanism has none
    /// unless it says so.
    31 "closed" = &mut belt.is_closed, "", [Spec::SWITCH];
    /// Time between two motors of one belt that get power.
    32 "settling" = &mut belt.settling_ms, "ms", [ranges::SETTLING_MS.spec()];
    /// Speed limit of the circulation.
    33 "max_speed" = &mut belt.max_speed, "mm/s", [ranges::SPEED.spec()];
    /// Acceleration limit of the circulation.
    34 "max_acceleration" = &mut belt.max_acceleration, "mm/s2", [ranges::ACCELERATION.spec()];
    /// How far the belt circulates after x and y are homed, so that it does not always bend at the same teeth; 0 is not
    /// at all.
    35 "homing_advance" = &mut belt.homing_advance, "mm", [ranges::HOMING_ADVANCE.spec()];
    /// What happens with motors of one belt that were not aligned (M915) since they got power. Off: nothing. Warning:
    /// the host is told of the first printing move. Required: printing moves are refused. Automatic: they are aligned
    /// when x and y are homed.
    36 "alignment" = &mut belt.alignment, "", [Spec::choice::<Alignment>()];
    /// How much aligned motors strain the belt, as the sum of their residual.
    37 "preload" = &mut belt.preload, "mm", [ranges::PRELOAD.spec()];
    /// How far z is raised when a motor of the belt has failed, before the others park the tool; 0 cuts all power at
    /// once.
    38 "limp_lift" = &mut belt.limp_lift, "mm", [ranges::LIMP_LIFT.spec()];
}

/// Rows of [`Belt::phases`].
pub(super) mod phases {
    use super::*;

    rows! {
        for phase in |s, part| s.belt.phases.get_mut(part), named &["belt.phases"; PHASES];

        /// Where the drivers of a belt's motors stood to each other when nothing strained the belt: a number for each
        /// residual. M915 finds it. Left out, it is not known.
        39 "" = phase, "1/1024 of an electrical turn", [ranges::PHASE.spec()];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_align_has_the_name_that_machine_files_use() {
        let names =
            [Alignment::Off, Alignment::Warning, Alignment::Required, Alignment::Automatic].map(Alignment::name);
        assert_eq!(names, ["off", "warning", "required", "automatic"]);
    }
}
