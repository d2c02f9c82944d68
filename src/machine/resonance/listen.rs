//! Listening: samples become blocks with their commanded acceleration, and a sensor that fails is noticed.
//!
//! A sensor counts its samples by a clock of its own, some percent off. So the time of each sample comes from their
//! number and the Console's time, slowly corrected.

use super::plan::{SweepAxis, parts_of};
use super::response::Response;
use crate::accelerometer::{Sample, SensorFault};
use crate::motion::{Piece, Pieces, Sweep};
use crate::port::Accelerometer;
use crate::settings::{AccelerometerSettings, Cartesian};
use crate::units::{Instant, SubTicks, TICKS_PER_MS, TICKS_PER_SECOND, whole_root};

/// Blocks a second: up to 150 Hz the means take little of a vibration, and as much of the command.
const BLOCKS_A_SECOND: u16 = 400;

/// A sample along the machine's axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct RawSample {
    /// Its time in us.
    pub us: u32,
    /// mm/s^2 along x, y, z.
    pub axes: [i32; 3],
}

/// Samples taken at once.
pub(super) const AT_ONCE: usize = 32;

/// Without a sample for so long the sensor is silent.
const SILENT_MS: u32 = 250;

/// More noise is a bad cable, or no rest (Klipper's MEASURE_AXES_NOISE: 1 to 100 are usual, 1000 is a fault).
pub(super) const MOST_NOISE: u32 = 1000;

/// The commanded speed over time.
struct Commanded {
    pieces: Pieces,
    piece: Piece,
    /// Begin of the piece, from the begin of the sweep.
    begin: SubTicks,
    /// The tool rests again.
    is_over: bool,
}

impl Commanded {
    fn new(sweep: &Sweep) -> Self {
        Self { pieces: sweep.pieces(), piece: Piece::NONE, begin: SubTicks::ZERO, is_over: false }
    }

    /// The speed at a time, in mm/s. Times come in order.
    fn speed_at(&mut self, time: SubTicks) -> f32 {
        while !self.is_over && time >= self.begin + self.piece.time {
            self.begin += self.piece.time;
            match self.pieces.next() {
                Some(piece) => self.piece = piece,
                None => self.is_over = true,
            }
        }
        if self.is_over || time < self.begin {
            return 0.0;
        }
        self.piece.speed_after(time - self.begin) as f32 * const { 1.0 / 4_294_967_296.0 }
    }
}

/// Noise of a resting sensor.
#[derive(Clone, Copy, Default)]
pub(super) struct Noise {
    count: u32,
    axes: [AxisNoise; 3],
}

/// The first value along an axis, and sums of the differences from it.
#[derive(Clone, Copy, Default)]
struct AxisNoise {
    first: i32,
    sum: i64,
    squares: u64,
}

impl Noise {
    fn add(&mut self, sample: &Sample) {
        for (axis, value) in self.axes.iter_mut().zip(sample.axes) {
            if self.count == 0 {
                axis.first = value;
            }
            let value = i64::from(value) - i64::from(axis.first);
            axis.sum += value;
            axis.squares += (value * value).cast_unsigned();
        }
        self.count += 1;
    }

    /// The mean sample.
    pub fn mean(&self) -> Sample {
        let count = i64::from(self.count.max(1));
        let mut mean = Sample::default();
        for (value, axis) in mean.axes.iter_mut().zip(&self.axes) {
            *value = axis.first + (axis.sum / count) as i32;
        }
        mean
    }

    /// Standard deviation of each axis in mm/s^2.
    #[inline(never)]
    pub fn deviation(&self) -> [u32; 3] {
        let count = u64::from(self.count.max(1));
        let mut deviation = [0; 3];
        for (value, axis) in deviation.iter_mut().zip(&self.axes) {
            let mean = axis.sum.unsigned_abs() / count;
            *value = whole_root((axis.squares / count).saturating_sub(mean * mean)) as u32;
        }
        deviation
    }
}

/// What is done with samples.
enum Use {
    /// The tool rests.
    Noise,
    /// The tool is swept since then.
    Response(Commanded, Instant),
}

/// The reader of a sensor.
pub(super) struct Listener {
    sensor: AccelerometerSettings,
    /// Parts of the machine's x and y along the sweep.
    parts: [f32; 2],
    pub noise: Noise,
    used_for: Use,
    /// Samples since then, and when the last ones came.
    since: Instant,
    count: u32,
    is_counting: bool,
    last: Instant,
    /// Samples of a block, those that it has, and their sum along the sweep.
    of_block: u16,
    in_block: u16,
    sum: f32,
    /// Time of the last sample, and from one to the next, in ticks times 2^16.
    time: u64,
    period: u64,
    /// Commanded speed and time at the begin of the block.
    before: (f32, u64),
    /// The last value along the sweep, and how many were the same.
    same: (i32, u32),
    /// The samples that were taken last.
    taken: [Sample; AT_ONCE],
}

impl Listener {
    pub fn new(sensor: AccelerometerSettings, axis: SweepAxis, now: Instant) -> Self {
        Self {
            sensor,
            parts: parts_of(axis).map(|part| part as f32 / 65_536.0),
            noise: Noise::default(),
            used_for: Use::Noise,
            since: now,
            count: 0,
            is_counting: false,
            last: now,
            of_block: 1,
            in_block: 0,
            sum: 0.0,
            time: 0,
            period: 0,
            before: (0.0, 0),
            same: (0, 0),
            taken: [Sample::default(); AT_ONCE],
        }
    }

    /// Samples a second so far.
    #[inline(never)]
    pub fn rate(&self) -> u32 {
        let ticks = self.last.0.saturating_sub(self.since.0).max(1);
        ((u64::from(self.count) * u64::from(TICKS_PER_SECOND) + ticks / 2) / ticks) as u32
    }

    /// Blocks a second.
    pub fn blocks_a_second(&self) -> f32 {
        let ticks = self.last.0.saturating_sub(self.since.0).max(1);
        self.count as f32 * TICKS_PER_SECOND as f32 / ticks as f32 / f32::from(self.of_block)
    }

    /// From now on the tool is swept.
    pub fn begin(&mut self, sweep: &Sweep, now: Instant) {
        let rate = self.rate();
        self.of_block = ((rate + u32::from(BLOCKS_A_SECOND) / 2) / u32::from(BLOCKS_A_SECOND)).max(1) as u16;
        self.period = ((u64::from(TICKS_PER_SECOND)) << 16) / u64::from(rate.max(1));
        self.time = now.0 << 16;
        self.used_for = Use::Response(Commanded::new(sweep), now);
        self.before = (0.0, self.time);
    }

    /// Takes samples that have come, up to [`AT_ONCE`], and returns their number. Call it until there are fewer.
    pub fn listen(
        &mut self,
        sensor: &mut impl Accelerometer,
        now: Instant,
        response: &mut Response,
    ) -> Result<usize, SensorFault> {
        let taken = sensor.take(&mut self.taken)?;
        for place in 0..taken {
            let Some(sample) = self.taken.get(place).copied() else { break };
            self.count += 1;
            self.take(&sample, response)?;
        }
        if taken == 0 {
            let is_silent = now.0 > self.last.after_ms(SILENT_MS).0;
            return if is_silent { Err(SensorFault::Silent) } else { Ok(0) };
        }
        if !self.is_counting {
            // These may have waited; the time of all others counts from here.
            (self.is_counting, self.since, self.count, self.noise) = (true, now, 0, Noise::default());
        }
        self.last = now;
        if taken < AT_ONCE {
            self.correct(now);
        }
        Ok(taken)
    }

    /// One of the samples that were taken last, of so many: its time from `begin` in us, and the acceleration along the
    /// machine's axes.
    pub fn raw(&self, place: usize, of: usize, begin: Instant) -> RawSample {
        let sample = self.taken.get(place).copied().unwrap_or_default();
        let before = (of - 1).saturating_sub(place) as u64 * self.period;
        let ticks = (self.time.saturating_sub(before) >> 16).saturating_sub(begin.0);
        let Cartesian { x, y, z } = self.sensor.axes;
        RawSample { us: (ticks / 10) as u32, axes: [x, y, z].map(|axis| sample.along(axis)) }
    }

    /// Corrects the time of the last sample, which has just come, and the period, slowly.
    fn correct(&mut self, now: Instant) {
        if matches!(self.used_for, Use::Response(..)) {
            let late = (now.0 << 16).wrapping_sub(self.time).cast_signed();
            self.time = self.time.wrapping_add_signed(late / 64);
            let ticks = now.0.saturating_sub(self.since.0);
            if self.count > 0 && ticks > 2 * u64::from(TICKS_PER_MS) * 1000 {
                self.period = (ticks << 16) / u64::from(self.count);
            }
        }
    }

    fn take(&mut self, sample: &Sample, response: &mut Response) -> Result<(), SensorFault> {
        let Cartesian { x, y, .. } = self.sensor.axes;
        let [of_x, of_y] = self.parts;
        let along = if of_x == 0.0 { sample.along(y) } else { sample.along(x) };
        let (last, times) = self.same;
        self.same = (along, if last == along { times + 1 } else { 0 });
        if self.same.1 > u32::from(self.sensor.rate) / 4 {
            return Err(SensorFault::Stuck);
        }
        let Use::Response(commanded, begin) = &mut self.used_for else {
            self.noise.add(sample);
            return Ok(());
        };
        let rest = self.noise.mean();
        let [x, y] = [x, y].map(|axis| (sample.along(axis) - rest.along(axis)) as f32);
        self.sum += of_x * x + of_y * y;
        self.in_block += 1;
        self.time += self.period;
        if self.in_block < self.of_block {
            return Ok(());
        }
        let (speed_before, time_before) = self.before;
        let speed = commanded.speed_at(SubTicks(self.time.saturating_sub(begin.0 << 16)));
        let seconds =
            self.time.saturating_sub(time_before) as f32 * const { 1.0 / (65_536.0 * TICKS_PER_SECOND as f32) };
        let wanted = if seconds > 0.0 { (speed - speed_before) / seconds } else { 0.0 };
        response.add([wanted, self.sum / f32::from(self.in_block)]);
        (self.before, self.in_block, self.sum) = ((speed, self.time), 0, 0.0);
        Ok(())
    }
}
