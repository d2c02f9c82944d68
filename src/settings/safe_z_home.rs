//! Homing of z at a place: the tool rises before anything is homed, and z is homed by its switch where the bed is, or
//! where the switch is. Klipper's `[safe_z_home]`. A probe that homes z has a place of its own ([`super::Probe`]).

use super::rows::{Spec, rows};
use super::{HomedAxis, Settings, ranges};
use crate::units::{Mm, MmPerSec};
use serde::{Deserialize, Serialize};

/// How z is homed by its switch, and how far z rises before and after that.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct SafeZHome {
    /// Where the nozzle is meanwhile, in x and y; `None` is where it stands.
    pub place: [Option<Mm>; 2],
    /// The height to which z rises before; by so much if its place is not known. 0 is not at all.
    pub z_hop: Mm,
    /// Speed of that rise.
    pub z_hop_speed: MmPerSec,
    /// Speed to the place and back.
    pub speed: MmPerSec,
    /// Whether the tool goes back to where x and y were before.
    pub move_to_previous: bool,
}

impl SafeZHome {
    /// Z is homed where the tool stands. The speeds are Klipper's defaults (docs/Config_Reference.md, safe_z_home).
    pub(super) const fn prototype() -> Self {
        Self {
            place: [None; 2],
            z_hop: Mm::ZERO,
            z_hop_speed: MmPerSec::const_from_int(15),
            speed: MmPerSec::const_from_int(50),
            move_to_previous: false,
        }
    }

    /// The place, where x and y count that have none.
    #[must_use]
    pub fn place_from(&self, [x, y]: [Mm; 2]) -> [Mm; 2] {
        let [to_x, to_y] = self.place;
        [to_x.unwrap_or(x), to_y.unwrap_or(y)]
    }
}

impl Settings {
    /// Whether z is homed at a place by its switch.
    #[must_use]
    pub const fn homes_z_at_place(&self) -> bool {
        !self.homes_z_by_probe() && !matches!(self.safe_z_home.place, [None, None])
    }

    /// The place where z is homed by its switch that the nozzle does not reach, if there is one; 0 stands for a part
    /// that it has not.
    #[must_use]
    pub fn unreached_z_home(&self) -> Option<[Mm; 2]> {
        let place = self.safe_z_home.place;
        let misses = |(axis, at): (HomedAxis, Option<Mm>)| at.is_some_and(|at| !self.reach(axis).holds(at));
        let is_missed = self.homes_z_at_place() && HomedAxis::ALL.into_iter().zip(place).any(misses);
        is_missed.then(|| self.safe_z_home.place_from([Mm::ZERO; 2]))
    }
}

rows! {
    for home in |s, _| Some(&mut s.safe_z_home), named &["safe_z_home"];

    /// Height to which z rises before G28 homes anything, and after it has homed z; by so much where the place of z is
    /// not known. 0 is not at all.
    153 "z_hop" = &mut home.z_hop, "mm", [ranges::Z_HOP.spec()];
    /// Speed of that rise.
    154 "z_hop_speed" = &mut home.z_hop_speed, "mm/s", [ranges::SPEED.spec()];
    /// Speed to the place where z is homed, and back.
    155 "speed" = &mut home.speed, "mm/s", [ranges::SPEED.spec()];
    /// Whether the tool goes back to where x and y were before z was homed.
    156 "move_to_previous" = &mut home.move_to_previous, "", [Spec::SWITCH];
}

/// Rows of the place.
pub(super) mod place {
    use super::*;

    rows! {
        for place in |s, part| s.safe_z_home.place.get_mut(part), named &["safe_z_home.x", "safe_z_home.y"];

        /// Where the nozzle is while z is homed by its switch; "auto" is where x and y stand. A probe homes z at
        /// probe.home.
        152 "" = place, "mm", [ranges::PLACE.spec().or_auto()];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_that_the_nozzle_does_not_reach_is_found_where_it_counts() {
        let mm = |mm: i32| Some(Mm::from_num(mm));
        let mut s = Settings::prototype();
        assert!(!s.homes_z_at_place() && s.unreached_z_home().is_none());
        s.safe_z_home.place = [mm(0), mm(417)];
        assert!(s.homes_z_at_place() && s.unreached_z_home().is_none());
        s.safe_z_home.place = [None, mm(418)];
        assert_eq!(s.unreached_z_home(), Some([Mm::ZERO, Mm::from_num(418)]));
        assert_eq!(s.safe_z_home.place_from([Mm::from_num(7); 2]), [Mm::from_num(7), Mm::from_num(418)]);
        s.safe_z_home.place = [mm(-1), None];
        assert!(s.unreached_z_home().is_some());
        // The probe's place counts then.
        (s.probe.kind, s.probe.homes_z) = (crate::settings::ProbeKind::Switch, true);
        assert!(!s.homes_z_at_place() && s.unreached_z_home().is_none());
    }
}
