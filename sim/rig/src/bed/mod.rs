//! The bed plant: a bed on its screws under the nozzle, and the probe that finds it.
//!
//! A machine with a probe has it; [`Rig`](crate::Rig) says where the nozzle is. Heights and places are mm of G-code, in
//! f64 with libm: the host, QEMU and the emulator compute the same bits. The same orders and steps at the same times
//! give the same touches.
//!
//! | file | content |
//! |---|---|
//! | [`surface`] | the bed's height, place by place |
//! | [`screws`] | by how much the motors of z tilt it |
//! | [`probe`] | when the probe triggers: noise, drift, delay, faults |
//! | [`bltouch`] | the pin of a BLTouch, its orders and its alarm |
//! | `noise` | random numbers that repeat |

pub mod bltouch;
mod noise;
pub mod probe;
pub mod screws;
pub mod surface;

use corehbot::motors::{EndstopSet, MOTORS};
use corehbot::settings::{Cartesian, ProbeKind, Settings};
use corehbot::units::Mm;
use probe::{Probe, ProbeFault, ProbeModel, ProbeSetup};
use screws::{MOST_SCREWS, ScrewSetup, Screws};
use surface::Surface;

/// Length of the pulse of a touch of a BLTouch (ANTClabs, BLTouch V3.1), in ms.
const PULSE_MS: f64 = 10.0;

/// The bed and its probe, as a simulation asks for them.
#[derive(Clone, PartialEq, Debug)]
pub struct BedSetup {
    /// The bed.
    pub surface: Surface,
    /// Its screws, in the order of the motors of z; without any it keeps level.
    pub screws: heapless::Vec<ScrewSetup, MOST_SCREWS>,
    /// Its probe.
    pub probe: ProbeSetup,
}

impl BedSetup {
    /// A flat bed, and a sound probe where the settings say.
    #[must_use]
    pub fn of(settings: &Settings) -> Self {
        let model = match settings.probe.kind {
            ProbeKind::BlTouch => ProbeModel::BlTouch { pulse_ms: PULSE_MS },
            ProbeKind::None | ProbeKind::Switch | ProbeKind::Nozzle => ProbeModel::Level,
        };
        let Cartesian { x, y, z } = settings.probe.offset;
        let offset = [x, y, z].map(Mm::to_num);
        let probe = ProbeSetup { model, offset, noise: 0.0, seed: 0, drift: 0.0, delay_ms: 0.0 };
        Self { surface: Surface::flat(settings), screws: heapless::Vec::new(), probe }
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
    surface: Surface,
    screws: Screws,
    probe: Probe,
    deepest: Option<Depth>,
}

impl BedPlant {
    /// The bed and the probe of that setup.
    #[must_use]
    pub fn new(settings: &Settings, setup: &BedSetup) -> Self {
        let screws = Screws::new(settings, &setup.screws);
        Self { surface: setup.surface, screws, probe: Probe::new(setup.probe), deepest: None }
    }

    /// The flat bed of a machine with a probe.
    #[must_use]
    pub fn of(settings: &Settings) -> Option<Self> {
        has_probe(settings).then(|| Self::new(settings, &BedSetup::of(settings)))
    }

    /// The motors' steps are counted from 0 again.
    pub fn restart(&mut self) {
        self.screws.restart();
    }

    /// The nozzle has come to this place by `now`, in ticks, and motors have made these steps.
    pub fn follow(&mut self, now: u64, nozzle: [f64; 3], counts: &[i32; MOTORS]) {
        self.screws.follow(counts);
        let [x, y, z] = nozzle;
        let mm = self.height([x, y]) - z;
        if mm > self.deepest.map_or(0.0, |deepest| deepest.mm) {
            self.deepest = Some(Depth { nozzle, mm });
        }
        let [dx, dy, _] = self.probe.offset();
        let height = z - self.height([x + dx, y + dy]);
        self.probe.follow(now, height);
    }

    /// From `now` on the servo's line has pulses of so many us, or none.
    pub fn servo(&mut self, now: u64, micros: Option<u16>) {
        self.probe.hear(now, micros);
    }

    /// The probe, if it has triggered by `now`.
    #[must_use]
    pub fn endstops(&mut self, now: u64) -> EndstopSet {
        if self.probe.has_triggered(now) { EndstopSet::PROBE } else { EndstopSet::NONE }
    }

    /// When the probe may change without a step, in ticks.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        self.probe.next()
    }

    /// Something breaks, or is mended.
    pub const fn fail(&mut self, fault: ProbeFault) {
        self.probe.fail(fault);
    }

    /// The height of the bed there, as it is now.
    #[must_use]
    pub fn height(&self, at: [f64; 2]) -> f64 {
        self.surface.at(at) + self.screws.at(at)
    }

    /// Whether the probe's pin is out.
    #[must_use]
    pub fn is_out(&self) -> bool {
        self.probe.is_out()
    }

    /// The deepest place of the nozzle in the bed, if it ever was there.
    #[must_use]
    pub const fn deepest(&self) -> Option<Depth> {
        self.deepest
    }
}

/// A probe with its wire off, at an input that its machine says how to read.
#[must_use]
pub const fn cut_wire(settings: &Settings) -> ProbeFault {
    if settings.probe_plug.is_normally_open { ProbeFault::Dead } else { ProbeFault::Stuck }
}

/// Whether a machine has a probe.
#[must_use]
pub const fn has_probe(settings: &Settings) -> bool {
    settings.probe.is_fitted() || !settings.probe_plug.connector.is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plant(offset: [f64; 3]) -> BedPlant {
        let mut setup = BedSetup::of(&Settings::prototype());
        (setup.surface.tilt, setup.probe.offset) = ([0.01, 0.0], offset);
        BedPlant::new(&Settings::prototype(), &setup)
    }

    #[test]
    fn the_probe_triggers_where_it_is_and_not_where_the_nozzle_is() {
        let mut plant = plant([-40.0, 10.0, -1.25]);
        let [x, y] = plant.surface.centre();
        // The bed is 0.4 mm lower at the probe.
        for (z, wanted) in [(0.86, EndstopSet::NONE), (0.84, EndstopSet::PROBE), (0.96, EndstopSet::NONE)] {
            plant.follow(0, [x, y, z], &[0; MOTORS]);
            assert_eq!(plant.endstops(0), wanted, "{z}");
        }
        assert_eq!(plant.deepest(), None);
    }

    #[test]
    fn the_deepest_place_in_the_bed_is_kept() {
        let mut plant = plant([0.0; 3]);
        let [x, y] = plant.surface.centre();
        for z in [1.0, -0.5, -2.25, -1.0] {
            plant.follow(0, [x, y, z], &[0; MOTORS]);
        }
        assert_eq!(plant.deepest(), Some(Depth { nozzle: [x, y, -2.25], mm: 2.25 }));
    }
}
