//! The bed plant: a bed under the nozzle, and the probe that finds it.
//!
//! A machine with a probe has it; [`Rig`](crate::Rig) says where the nozzle is. Heights and places are mm of G-code, in
//! f64 with libm: the host, QEMU and the emulator compute the same bits.
//!
//! | file | content |
//! |---|---|
//! | [`surface`] | the bed's height, place by place |

pub mod surface;

use corehbot::motors::EndstopSet;
use corehbot::settings::Settings;
use surface::Surface;

/// The bed and its probe, as a simulation asks for them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BedSetup {
    /// The bed.
    pub surface: Surface,
    /// Where the probe is, seen from the nozzle. It triggers when the nozzle is `-z` over the bed.
    pub offset: [f64; 3],
}

impl BedSetup {
    /// A flat bed, and the probe where the settings say.
    #[must_use]
    pub fn of(settings: &Settings) -> Self {
        Self { surface: Surface::flat(settings), offset: [0.0; 3] }
    }
}

/// The deepest place of the nozzle in the bed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Depth {
    /// Where the nozzle was.
    pub nozzle: [f64; 3],
    /// How far below the bed, in mm.
    pub mm: f64,
}

/// A bed and a probe.
#[derive(Clone, Debug)]
pub struct BedPlant {
    setup: BedSetup,
    /// Where the nozzle is.
    nozzle: [f64; 3],
    deepest: Option<Depth>,
}

impl BedPlant {
    /// The bed and the probe of that setup.
    #[must_use]
    pub const fn new(setup: BedSetup) -> Self {
        Self { setup, nozzle: [0.0; 3], deepest: None }
    }

    /// The flat bed of a machine with a probe.
    #[must_use]
    pub fn of(settings: &Settings) -> Option<Self> {
        (!settings.probe.connector.is_none()).then(|| Self::new(BedSetup::of(settings)))
    }

    /// The nozzle has come to this place.
    pub fn follow(&mut self, nozzle: [f64; 3]) {
        self.nozzle = nozzle;
        let [x, y, z] = nozzle;
        let mm = self.setup.surface.at([x, y]) - z;
        if mm > self.deepest.map_or(0.0, |deepest| deepest.mm) {
            self.deepest = Some(Depth { nozzle, mm });
        }
    }

    /// The probe, if it has triggered by `now`, in ticks.
    #[must_use]
    pub fn endstops(&mut self, _now: u64) -> EndstopSet {
        let ([x, y, z], [dx, dy, dz]) = (self.nozzle, self.setup.offset);
        let gap = z - self.setup.surface.at([x + dx, y + dy]);
        if gap <= -dz { EndstopSet::PROBE } else { EndstopSet::NONE }
    }

    /// The deepest place of the nozzle in the bed, if it ever was there.
    #[must_use]
    pub const fn deepest(&self) -> Option<Depth> {
        self.deepest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plant(offset: [f64; 3]) -> BedPlant {
        let mut setup = BedSetup::of(&Settings::prototype());
        (setup.surface.tilt, setup.offset) = ([0.01, 0.0], offset);
        BedPlant::new(setup)
    }

    #[test]
    fn the_probe_triggers_where_it_is_and_not_where_the_nozzle_is() {
        let mut plant = plant([-40.0, 10.0, -1.25]);
        let [x, y] = plant.setup.surface.centre();
        // The bed is 0.4 mm lower at the probe.
        for (z, wanted) in [(0.86, EndstopSet::NONE), (0.84, EndstopSet::PROBE), (0.86, EndstopSet::NONE)] {
            plant.follow([x, y, z]);
            assert_eq!(plant.endstops(0), wanted, "{z}");
        }
        assert_eq!(plant.deepest(), None);
    }

    #[test]
    fn the_deepest_place_in_the_bed_is_kept() {
        let mut plant = plant([0.0; 3]);
        let [x, y] = plant.setup.surface.centre();
        for z in [1.0, -0.5, -2.25, -1.0] {
            plant.follow([x, y, z]);
        }
        assert_eq!(plant.deepest(), Some(Depth { nozzle: [x, y, -2.25], mm: 2.25 }));
    }
}
