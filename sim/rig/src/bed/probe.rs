//! The probe: when it triggers over a bed, with its noise, its drift and its faults.

use super::bltouch::BlTouch;
use super::noise::normal;
use corehbot::units::{TICKS_PER_MS, TICKS_PER_SECOND};

/// How it tells a touch.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ProbeModel {
    /// By a level, as long as it lasts: a switch, an inductive sensor, the nozzle.
    Level,
    /// By a pulse of a BLTouch, of so many ms: 10, clones have 5.
    BlTouch {
        /// Its length.
        pulse_ms: f64,
    },
}

/// A probe, as a simulation asks for it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ProbeSetup {
    /// How it tells a touch.
    pub model: ProbeModel,
    /// Where it is, seen from the nozzle, in mm. It triggers when the nozzle is `-z` over the bed.
    pub offset: [f64; 3],
    /// Sigma of the height at which it triggers, in mm; each touch has its own.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// By how much higher it triggers each minute, in mm.
    pub drift: f64,
    /// Time from the touch to the signal, in ms.
    pub delay_ms: f64,
}

/// What is wrong with it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ProbeFault {
    /// Nothing.
    #[default]
    None,
    /// It always reads as triggered.
    Stuck,
    /// It never reads as triggered: its wire is cut, or it has fallen off.
    Dead,
    /// It triggers 3.5 mm too high.
    Early,
    /// Its height varies by a sigma of 0.2 mm.
    Noisy,
    /// A BLTouch is in alarm.
    Alarm,
}

/// What a fault does.
const EARLY_MM: f64 = 3.5;
const NOISY_MM: f64 = 0.2;

/// A probe has let go of the bed when it is so much farther away than where it triggered, in mm.
const LET_GO_MM: f64 = 0.05;

/// A probe at work.
#[derive(Clone, Debug)]
pub struct Probe {
    setup: ProbeSetup,
    bltouch: Option<BlTouch>,
    fault: ProbeFault,
    /// Touches so far.
    touches: u64,
    /// How far it is from where it triggers, in mm.
    gap: f64,
    /// When it touched, until it lets go.
    touched: Option<u64>,
}

impl Probe {
    /// A sound one.
    #[must_use]
    pub fn new(setup: ProbeSetup) -> Self {
        let ticks = |ms: f64| (ms * f64::from(TICKS_PER_MS)) as u64;
        let bltouch = match setup.model {
            ProbeModel::Level => None,
            ProbeModel::BlTouch { pulse_ms } => Some(BlTouch::new(ticks(pulse_ms))),
        };
        Self { setup, bltouch, fault: ProbeFault::None, touches: 0, gap: f64::MAX, touched: None }
    }

    /// Where it is, seen from the nozzle.
    #[must_use]
    pub const fn offset(&self) -> [f64; 3] {
        self.setup.offset
    }

    /// Something breaks, or is mended.
    pub const fn fail(&mut self, fault: ProbeFault) {
        self.fault = fault;
        if let (ProbeFault::Alarm, Some(bltouch)) = (fault, &mut self.bltouch) {
            bltouch.alarm();
        }
    }

    /// The nozzle is at `height` over the bed where the probe is.
    pub fn follow(&mut self, now: u64, height: f64) {
        let minutes = now as f64 / f64::from(TICKS_PER_SECOND) / 60.0;
        let early = if self.fault == ProbeFault::Early { EARLY_MM } else { 0.0 };
        let sigma = if self.fault == ProbeFault::Noisy { NOISY_MM } else { self.setup.noise };
        let noise = if sigma == 0.0 { 0.0 } else { sigma * normal(self.setup.seed, self.touches) };
        let [_, _, dz] = self.setup.offset;
        self.gap = height - (early + noise + self.setup.drift * minutes - dz);
        match self.touched {
            None if self.gap <= 0.0 => self.touched = Some(now),
            Some(_) if self.gap > LET_GO_MM.max(4.0 * sigma) => {
                self.touched = None;
                self.touches += 1;
            }
            _ => {}
        }
        self.pass(now);
    }

    /// Whether it touches at `now`, in its own opinion.
    fn is_touching(&self, now: u64) -> bool {
        let delay = (self.setup.delay_ms * f64::from(TICKS_PER_MS)) as u64;
        self.gap <= 0.0 && self.touched.is_some_and(|at| at + delay <= now)
    }

    fn pass(&mut self, now: u64) {
        let is_touching = self.is_touching(now);
        if let Some(bltouch) = &mut self.bltouch {
            bltouch.pass(now, is_touching);
        }
    }

    /// From `now` on its servo's line has pulses of so many us, or none.
    pub fn hear(&mut self, now: u64, micros: Option<u16>) {
        let is_touching = self.is_touching(now);
        if let Some(bltouch) = &mut self.bltouch {
            bltouch.hear(now, micros, is_touching);
        }
    }

    /// Whether it reads as triggered at `now`.
    pub fn has_triggered(&mut self, now: u64) -> bool {
        self.pass(now);
        match self.fault {
            ProbeFault::Stuck => true,
            ProbeFault::Dead => false,
            ProbeFault::None | ProbeFault::Early | ProbeFault::Noisy | ProbeFault::Alarm => {
                self.bltouch.map_or_else(|| self.is_touching(now), |bltouch| bltouch.is_high())
            }
        }
    }

    /// Whether its pin is out, if it has one.
    #[must_use]
    pub fn is_out(&self) -> bool {
        self.bltouch.is_some_and(|bltouch| bltouch.is_out())
    }

    /// When its signal may change without a step, if it may.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        self.bltouch.and_then(|bltouch| bltouch.next())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const LEVEL: ProbeSetup = ProbeSetup {
        model: ProbeModel::Level,
        offset: [0.0, 0.0, -1.5],
        noise: 0.0,
        seed: 1,
        drift: 0.0,
        delay_ms: 0.0,
    };

    /// The height at which a probe triggers on its way down in steps of 1 um, a ms each.
    fn height(probe: &mut Probe, now: &mut u64) -> f64 {
        let mut um = 6000;
        loop {
            probe.follow(*now, f64::from(um) / 1000.0);
            if probe.has_triggered(*now) || um == 0 {
                probe.follow(*now, 6.0);
                return f64::from(um) / 1000.0;
            }
            um -= 1;
            *now += u64::from(TICKS_PER_MS);
        }
    }

    #[test]
    fn a_level_comes_at_its_height_with_its_delay_and_its_faults() {
        let at = |setup, fault| {
            let mut probe = Probe::new(setup);
            probe.fail(fault);
            height(&mut probe, &mut 0)
        };
        assert_eq!(at(LEVEL, ProbeFault::None), 1.5);
        assert_eq!(at(ProbeSetup { delay_ms: 10.0, ..LEVEL }, ProbeFault::None), 1.49);
        assert_eq!([ProbeFault::Stuck, ProbeFault::Dead, ProbeFault::Early].map(|f| at(LEVEL, f)), [6.0, 0.0, 5.0]);
    }

    #[test]
    fn each_touch_has_its_own_noise_and_a_run_repeats() {
        let heights = |seed| {
            let (mut probe, mut now) = (Probe::new(ProbeSetup { noise: 0.005, seed, ..LEVEL }), 0);
            (0..50).map(|_| height(&mut probe, &mut now)).collect::<std::vec::Vec<_>>()
        };
        let found = heights(3);
        let mean = found.iter().sum::<f64>() / 50.0;
        let sigma = libm::sqrt(found.iter().map(|h| (h - mean) * (h - mean)).sum::<f64>() / 50.0);
        assert!((mean - 1.5).abs() < 0.0026 && (sigma / 0.005 - 1.0).abs() < 0.3, "{mean} {sigma}");
        assert_eq!(found, heights(3));
        assert_ne!(found, heights(4));
    }

    #[test]
    fn a_sensor_that_gets_warm_triggers_higher() {
        let mut probe = Probe::new(ProbeSetup { drift: 0.1, ..LEVEL });
        probe.follow(u64::from(TICKS_PER_SECOND) * 60, 1.59);
        assert!(probe.has_triggered(u64::from(TICKS_PER_SECOND) * 60));
    }
}
