//! Tally: figures of a run, gathered while it runs and in bounded memory.
//!
//! The tool's speed is its way within the last [`SPEED_WINDOW_MS`] over that time. A position known in whole steps of
//! 1/80 mm is wrong by up to one step, so 20 ms can add at most 0.6 mm/s. Shorter peaks are shown lower than they are.
//! The event rate counts the events of the last [`RATE_WINDOW_MS`].

use crate::axis_sums::AxisSums;
use crate::counts::Counts;
use crate::sampler::{SAMPLE_TICKS, SAMPLES_PER_SECOND, Sample, Sampler};
use crate::series::{Cursor, Series};
use corehbot::motors::{MOTORS, Motor, MotorSet};
use corehbot::settings::Settings;

/// Window over which the tool's speed is measured.
pub const SPEED_WINDOW_MS: u32 = 20;

/// Window over which step events are counted for their peak rate.
pub const RATE_WINDOW_MS: u32 = 10;

const SPEED_WINDOW: usize = (SPEED_WINDOW_MS * SAMPLES_PER_SECOND / 1000) as usize;
const RATE_WINDOW: usize = (RATE_WINDOW_MS * SAMPLES_PER_SECOND / 1000) as usize;

/// Counts and measures the events of a run.
pub struct Tally {
    /// Events so far, and how many of them each set of motors had.
    events: u64,
    sets: Box<[u64; 1 << MOTORS]>,
    /// mm of a unit of the sums of x, y and z, and where they began.
    unit: [f64; 3],
    origin: [f64; 3],
    /// The last places, in a ring; `oldest` is the next to be replaced.
    places: [Place; SPEED_WINDOW + 1],
    oldest: usize,
    /// Events up to each of the last samples, in a ring, and up to the last one.
    totals: [u64; RATE_WINDOW],
    oldest_total: usize,
    last_total: u64,
    peak_speed: f64,
    peak_rate: f64,
    series: Series,
    /// Where the series was last added to: speeds lag behind events.
    cursors: [Cursor; 2],
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
        let over = AxisSums::new(&s.mechanism).over();
        let pitch = [s.axes.x, s.axes.y, s.axes.z].map(|a| 1.0 / a.steps_per_mm.to_num::<f64>());
        Self {
            events: 0,
            sets: Box::new([0; 1 << MOTORS]),
            unit: std::array::from_fn(|i| pitch[i] / over[i] as f64),
            origin,
            places: [Place { at: origin, ..Place::default() }; SPEED_WINDOW + 1],
            oldest: 0,
            totals: [0; RATE_WINDOW],
            oldest_total: 0,
            last_total: 0,
            peak_speed: 0.0,
            peak_rate: 0.0,
            series: Series::default(),
            cursors: [Cursor::default(); 2],
        }
    }

    /// One instant in which `steps` move; all samples before it were shown.
    #[inline]
    pub fn event(&mut self, steps: MotorSet) {
        self.events += u64::from(!steps.is_empty());
        self.sets[usize::from(steps.0)] += 1;
    }

    /// The figures of a run that lasted `ticks`, with the run's sampler.
    #[must_use]
    pub fn finish(mut self, mut sampler: Sampler, ticks: u64) -> Figures {
        // The windows lag, so the tool rests for one more.
        let end = ticks + SPEED_WINDOW as u64 * SAMPLE_TICKS + 1;
        sampler.advance(end, |sample| self.sample(sample));
        let pulses = |motor| {
            let with = self.sets.iter().enumerate().filter(|(set, _)| MotorSet(*set as u8).has(motor));
            with.map(|(_, events)| events).sum()
        };
        Figures {
            events: self.events,
            pulses: Motor::ALL.map(pulses),
            position: *sampler.counts(),
            peak_speed: self.peak_speed,
            peak_rate: self.peak_rate,
            series: self.series,
        }
    }

    /// Measures what the next sample shows.
    pub fn sample(&mut self, sample: &Sample) {
        let here = self.place(sample);
        let length = self.places.len();
        // The oldest place is one sample before the window.
        let [then, centre] = [1, 1 + SPEED_WINDOW / 2].map(|later| self.places[(self.oldest + later) % length]);
        let way = distance(here.at, then.at);
        let speed = way * 1000.0 / f64::from(SPEED_WINDOW_MS);
        self.peak_speed = self.peak_speed.max(speed);

        let rate = (self.events - self.totals[self.oldest_total]) as f64 * 1000.0 / f64::from(RATE_WINDOW_MS);
        self.peak_rate = self.peak_rate.max(rate);
        let fresh = self.events - self.last_total;
        self.last_total = self.events;
        self.totals[self.oldest_total] = self.events;
        self.oldest_total = (self.oldest_total + 1) % RATE_WINDOW;

        // A chord of the path over the whole window, shared among its samples, is free of the zig-zag of steps.
        let path = way / SPEED_WINDOW as f64;
        let [speeds, rates] = &mut self.cursors;
        self.series.add(speeds, centre.tick, |bin| bin.go(path as f32, speed as f32));
        self.series.add(rates, sample.tick, |bin| bin.events += fresh as u32);
        self.places[self.oldest] = here;
        self.oldest = (self.oldest + 1) % length;
    }

    fn place(&self, sample: &Sample) -> Place {
        let [x, y, z, _] = sample.sums.map(|sum| sum as f64);
        let [along_x, along_y, along_z] = self.unit;
        let [from_x, from_y, from_z] = self.origin;
        Place { at: [from_x + x * along_x, from_y + y * along_y, from_z + z * along_z], tick: sample.tick }
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
        let mut sampler = Sampler::new(&Settings::prototype().mechanism);
        for i in 1..=8000 {
            sampler.event(i * 1250, prototype::BELT, MotorSet(0x0C), |sample| tally.sample(sample));
            tally.event(prototype::BELT);
        }
        tally.finish(sampler, u64::from(TICKS_PER_SECOND))
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
