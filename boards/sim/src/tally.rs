//! Tally: figures of a run, gathered while it runs and in bounded memory.
//!
//! The tool's speed is its way within the last [`SPEED_WINDOW_MS`] over that time. A position known in whole steps of
//! 1/80 mm is wrong by up to one step, so 20 ms can add at most 0.6 mm/s. Shorter peaks are shown lower than they are.
//! The event rate counts the events of the last [`RATE_WINDOW_MS`].

use crate::sampler::{Counts, SAMPLES_PER_SECOND, Sample, Sampler};
use crate::series::{Bin, Series};
use corehbot::kinematics::ForwardKinematics;
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::settings::Settings;

/// Window over which the tool's speed is measured.
pub const SPEED_WINDOW_MS: u32 = 20;

/// Window over which step events are counted for their peak rate.
pub const RATE_WINDOW_MS: u32 = 10;

const SPEED_WINDOW: usize = (SPEED_WINDOW_MS * SAMPLES_PER_SECOND / 1000) as usize;
const RATE_WINDOW: usize = (RATE_WINDOW_MS * SAMPLES_PER_SECOND / 1000) as usize;

/// Counts and measures the events of a run.
pub struct Tally {
    sampler: Sampler,
    measure: Measure,
    pulses: [u64; MOTORS],
    events: u64,
}

/// Measurements on samples.
struct Measure {
    /// Where motors bring the tool.
    back: ForwardKinematics<{ MOTORS }>,
    /// mm a step of x, y and z.
    step: [f64; 3],
    origin: [f64; 3],
    /// The last places, in a ring: `index` counts all samples.
    places: [Place; SPEED_WINDOW + 1],
    index: u64,
    /// Events up to each of the last samples.
    totals: [u64; RATE_WINDOW],
    peak_speed: f64,
    peak_rate: f64,
    series: Series,
}

/// A sample in mm.
#[derive(Clone, Copy, Default)]
struct Place {
    at: [f64; 3],
    tick: u64,
}

/// The figures of a finished run.
#[derive(Clone, PartialEq, Debug)]
pub struct Figures {
    /// Step events.
    pub events: u64,
    /// Pulses of each motor, whatever their direction.
    pub pulses: [u64; MOTORS],
    /// Where each motor ended, in steps from where it began.
    pub position: Counts,
    /// Greatest speed of the tool in mm/s.
    pub peak_speed: f64,
    /// Greatest rate of step events in events/s.
    pub peak_rate: f64,
    /// Speed and event rate over time.
    pub series: Series,
}

impl Tally {
    /// A tally for a tool that begins at `origin` (mm).
    #[must_use]
    pub fn new(s: &Settings, origin: [f64; 3]) -> Self {
        let measure = Measure {
            back: s.mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE),
            step: [s.axes.x, s.axes.y, s.axes.z].map(|a| 1.0 / a.steps_per_mm.to_num::<f64>()),
            origin,
            places: [Place { at: origin, ..Place::default() }; SPEED_WINDOW + 1],
            index: 0,
            totals: [0; RATE_WINDOW],
            peak_speed: 0.0,
            peak_rate: 0.0,
            series: Series::default(),
        };
        Self { sampler: Sampler::default(), measure, pulses: [0; MOTORS], events: 0 }
    }

    /// One instant in which `steps` move, each forward or backward.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        if steps.is_empty() {
            return;
        }
        let Self { sampler, measure, events, .. } = self;
        sampler.event(tick, steps, forward, |sample| measure.sample(sample, *events));
        self.events += 1;
        for (i, pulses) in self.pulses.iter_mut().enumerate() {
            *pulses += u64::from(steps.0 >> i & 1);
        }
    }

    /// The figures of a run that lasted `ticks`.
    #[must_use]
    pub fn finish(mut self, ticks: u64) -> Figures {
        let Self { sampler, measure, events, .. } = &mut self;
        // The windows lag, so the tool rests for one more.
        let end = ticks + SPEED_WINDOW as u64 * crate::sampler::SAMPLE_TICKS + 1;
        sampler.advance(end, |sample| measure.sample(sample, *events));
        Figures {
            events: self.events,
            pulses: self.pulses,
            position: *self.sampler.counts(),
            peak_speed: self.measure.peak_speed,
            peak_rate: self.measure.peak_rate,
            series: self.measure.series,
        }
    }
}

impl Measure {
    fn sample(&mut self, sample: &Sample, events: u64) {
        let here = self.place(sample);
        let length = self.places.len() as u64;
        let slot = |back: u64| ((self.index + length - back) % length) as usize;
        let (then, centre) = (self.places[slot(length - 1)], self.places[slot(length / 2)]);
        let speed = distance(here.at, then.at) * 1000.0 / f64::from(SPEED_WINDOW_MS);
        self.peak_speed = self.peak_speed.max(speed);

        let rate_slot = (self.index % RATE_WINDOW as u64) as usize;
        let rate = (events - self.totals[rate_slot]) as f64 * 1000.0 / f64::from(RATE_WINDOW_MS);
        self.peak_rate = self.peak_rate.max(rate);
        let before = self.totals[((self.index + RATE_WINDOW as u64 - 1) % RATE_WINDOW as u64) as usize];
        self.totals[rate_slot] = events;

        // A chord of the path over the whole window, shared among its samples, is free of the zig-zag of steps.
        let path = distance(here.at, then.at) / SPEED_WINDOW as f64;
        self.series.add(centre.tick, Bin { path: path as f32, peak_speed: speed as f32, events: 0 });
        self.series.add(sample.tick, Bin { events: (events - before) as u32, ..Bin::default() });
        self.places[slot(0)] = here;
        self.index += 1;
    }

    fn place(&self, sample: &Sample) -> Place {
        let way = self.back.fractions(&sample.counts);
        let at = std::array::from_fn(|i| {
            let (sum, over) = way[i];
            self.origin[i] + sum as f64 * (self.step[i] / over as f64)
        });
        Place { at, tick: sample.tick }
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::{per_motor, prototype};
    use corehbot::units::TICKS_PER_SECOND;

    /// One second along +x at 100 mm/s from (10, 20, 0): all four motors step every 125 us.
    fn run() -> Figures {
        let mut tally = Tally::new(&Settings::prototype(), [10.0, 20.0, 0.0]);
        for i in 1..=8000 {
            tally.event(i * 1250, prototype::BELT, MotorSet(0x0C));
        }
        tally.finish(u64::from(TICKS_PER_SECOND))
    }

    #[test]
    fn a_steady_move_has_its_speed_and_rate() {
        let figures = run();
        assert_eq!((figures.events, figures.pulses), (8000, per_motor(&[8000, 8000, 8000, 8000], 0)));
        assert_eq!(figures.position, per_motor(&[-8000, -8000, 8000, 8000], 0));
        assert!((figures.peak_speed - 100.0).abs() < 0.7, "{}", figures.peak_speed);
        assert!((figures.peak_rate - 8000.0).abs() <= 100.0, "{}", figures.peak_rate);
        let way: f32 = figures.series.bins().iter().map(|b| b.path).sum();
        assert!((way - 100.0).abs() < 0.1, "{way}");
        assert_eq!(figures.series.bins().iter().map(|b| b.events).sum::<u32>(), 8000);
    }
}
