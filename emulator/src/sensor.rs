//! The accelerometer on SPI3: an ADXL345 or a LIS2DW12 with its registers, its FIFO, its own clock, and what its data
//! sheet forbids.
//!
//! Sources: ADXL345 datasheet rev E (timing table, FIFO, register definitions); LIS2DW12 datasheet (register
//! description). The sensor samples in virtual time, so a sample that is fetched too late is lost, as in a real sensor.
//!
//! | rule | source |
//! |---|---|
//! | frames of eight bits | serial communications |
//! | at least 150 ns between two selections | ADXL345, t_CS,DIS |
//! | at least 5 us from a sample's last byte to the next sample or FIFO_STATUS | ADXL345, retrieving data from FIFO |
//! | registers that are read only, or are not there, are not written | register maps |
//! | range, rate and FIFO are set at rest | ADXL345, register definitions |

use corehbot::accelerometer::SensorKind;
use rigless::chip::Timeline;
use rigless::chip::spi::Peer;
use rigless::snapshot::Store;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Samples in a FIFO, of either kind.
const FULL: usize = 32;

/// Gravity in mm/s^2.
const G: f64 = 9806.65;

/// A trouble with the sensor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SensorTrouble {
    /// Its plug comes off: the line from it is pulled up.
    Unplugged,
    /// The supply drops for a moment: its registers are as after power came.
    Restarted,
    /// An axis shows the same number from now on.
    Stuck(usize),
}

/// A vibration along all three axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Vibration {
    /// In Hz.
    pub hz: f64,
    /// The amplitude along each axis in mm/s^2.
    pub amplitude: [f64; 3],
    /// The standard deviation of noise in mm/s^2.
    pub noise: f64,
}

/// The sensor.
#[derive(Clone, Debug)]
pub struct Sensor {
    kind: SensorKind,
    /// What the identity register has.
    pub identity: u8,
    /// It answers so many first readings of the identity with zero, as some do after power came.
    pub deaf_readings: u8,
    /// Registers that keep nothing.
    pub dead: Option<u8>,
    /// Its clock over the nominal one.
    pub clock: f64,
    /// What it feels, besides gravity along z.
    pub vibration: Vibration,
    /// A trouble, and its time in ns after the first start.
    pub trouble: Option<(u64, SensorTrouble)>,
    /// What the firmware did against the data sheet, each once.
    pub breaches: Vec<&'static str>,
    /// Registers and values that were written.
    pub written: Vec<[u8; 2]>,
    /// Samples that were made, that were fetched and that were lost.
    pub samples: [u64; 3],
    registers: [u8; 64],
    /// When it was started first, in ns.
    started: Option<u64>,
    /// The first sample comes one period after this, in ns.
    began: Option<u64>,
    made: u64,
    fifo: VecDeque<[i16; 3]>,
    /// The numbers in the data registers.
    shown: [i16; 3],
    is_overrun: bool,
    random: u32,
    /// The command of this selection, and the register that comes next.
    command: Option<u8>,
    register: u8,
    /// Part of a sample was read in this selection.
    has_begun: bool,
    /// When the last word, the last sample and the last selection ended, in ns.
    word: u64,
    taken: Option<u64>,
    released: Option<u64>,
}

impl Sensor {
    /// One as new, at rest.
    #[must_use]
    pub fn new(kind: SensorKind) -> Self {
        let mut sensor = Self {
            kind,
            identity: if kind == SensorKind::Adxl345 { 0xE5 } else { 0x44 },
            deaf_readings: 0,
            dead: None,
            clock: 1.004,
            vibration: Vibration { hz: 50.0, amplitude: [0.0; 3], noise: 60.0 },
            trouble: None,
            breaches: Vec::new(),
            written: Vec::new(),
            samples: [0; 3],
            registers: [0; 64],
            started: None,
            began: None,
            made: 0,
            fifo: VecDeque::new(),
            shown: [0; 3],
            is_overrun: false,
            random: 1,
            command: None,
            register: 0,
            has_begun: false,
            word: 0,
            taken: None,
            released: None,
        };
        sensor.power();
        sensor
    }

    /// Power comes: the registers have their reset values.
    fn power(&mut self) {
        self.registers = [0; 64];
        match self.kind {
            SensorKind::Adxl345 => self.registers[0x2C] = 0x0A,
            SensorKind::Lis2dw12 => self.registers[0x21] = 0x04,
        }
        (self.began, self.is_overrun) = (None, false);
        self.fifo.clear();
    }

    fn breach(&mut self, what: &'static str) {
        if !self.breaches.contains(&what) {
            self.breaches.push(what);
        }
    }

    /// The trouble that it has at `at` ns.
    fn trouble_at(&self, at: u64) -> Option<SensorTrouble> {
        let (after, trouble) = self.trouble?;
        (at >= self.started? + after).then_some(trouble)
    }

    /// Samples a second; 0 at rest.
    fn rate(&self) -> f64 {
        let nominal = match self.kind {
            SensorKind::Adxl345 if self.registers[0x2D] & 8 == 0 => 0.0,
            SensorKind::Adxl345 => 3200.0 / f64::from(1 << (0x0F - (self.registers[0x2C] & 0xF))),
            SensorKind::Lis2dw12 => match self.registers[0x20] >> 4 {
                0 => 0.0,
                code => 1600.0 / f64::from(1 << 9_u8.saturating_sub(code)),
            },
        };
        nominal * self.clock
    }

    /// Whether new samples take the place of the oldest in a full FIFO.
    const fn is_streaming(&self) -> bool {
        match self.kind {
            SensorKind::Adxl345 => self.registers[0x38] >> 6 == 2,
            SensorKind::Lis2dw12 => self.registers[0x2E] >> 5 == 6,
        }
    }

    /// What it feels at `at` ns, in its own numbers.
    fn feel(&mut self, at: u64) -> [i16; 3] {
        let Vibration { hz, amplitude, noise } = self.vibration;
        let phase = (at as f64 / 1e9 * hz * TAU).sin();
        let mut axes = [0; 3];
        for (axis, out) in axes.iter_mut().enumerate() {
            // Twelve numbers between 0 and 1 have a variance of 1 together.
            let sum: f64 = (0..12).map(|_| self.chance()).sum();
            let felt = amplitude[axis] * phase + noise * (sum - 6.0) + if axis == 2 { G } else { 0.0 };
            *out = match self.kind {
                SensorKind::Adxl345 => {
                    let mg = if axis == 2 { 3.906 } else { 3.774 };
                    (felt / G * 1000.0 / mg).round().clamp(-4096.0, 4095.0) as i16
                }
                SensorKind::Lis2dw12 => ((felt / 4.785_645 / 4.0).round().clamp(-8192.0, 8191.0) * 4.0) as i16,
            };
        }
        if let Some(SensorTrouble::Stuck(axis)) = self.trouble_at(at) {
            axes[axis] = 77;
        }
        axes
    }

    /// A number between 0 and 1 (Numerical Recipes' quick generator).
    fn chance(&mut self) -> f64 {
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.random >> 8) / f64::from(1 << 24)
    }

    /// Makes the samples up to `now`.
    fn advance(&mut self, now: u64) {
        if self.trouble_at(now) == Some(SensorTrouble::Restarted) {
            self.trouble = None;
            self.power();
        }
        let (Some(began), rate) = (self.began, self.rate()) else { return };
        loop {
            let at = began + ((self.made + 1) as f64 / rate * 1e9) as u64;
            if at > now {
                return;
            }
            self.made += 1;
            let sample = self.feel(at);
            self.samples[0] += 1;
            if !self.is_streaming() {
                self.fifo.clear();
            } else if self.fifo.len() == FULL {
                self.fifo.pop_front();
                self.samples[2] += 1;
                self.is_overrun = true;
            }
            self.fifo.push_back(sample);
        }
    }

    /// The sample in the data registers was read: the next one takes its place.
    fn pop(&mut self, now: u64) {
        if std::mem::take(&mut self.has_begun) && self.fifo.pop_front().is_some() {
            self.samples[1] += 1;
            self.is_overrun = false;
            self.taken = Some(now);
        }
    }

    /// The data registers are 0x32 to 0x37 of an ADXL345, 0x28 to 0x2D of a LIS2DW12.
    const fn data(&self) -> u8 {
        match self.kind {
            SensorKind::Adxl345 => 0x32,
            SensorKind::Lis2dw12 => 0x28,
        }
    }

    /// Reads the next register. The byte began on the wire at `began`.
    fn read(&mut self, began: u64) -> u8 {
        let register = self.register;
        let place = register.wrapping_sub(self.data());
        let is_status = register == if self.kind == SensorKind::Adxl345 { 0x39 } else { 0x2F };
        let is_new = place == 0 || is_status;
        if is_new && self.kind == SensorKind::Adxl345 && self.taken.is_some_and(|taken| began < taken + 5000) {
            self.breach("5 us have not passed since the last sample");
        }
        if place < 6 {
            if !self.has_begun {
                self.shown = self.fifo.front().copied().unwrap_or(self.shown);
                self.has_begun = true;
            }
            return self.shown[usize::from(place / 2)].to_le_bytes()[usize::from(place % 2)];
        }
        if is_status {
            let waiting = self.fifo.len() as u8;
            return match self.kind {
                SensorKind::Adxl345 => waiting,
                // The threshold is 0 as it is set, so bit 7 stands.
                SensorKind::Lis2dw12 => waiting | u8::from(self.is_overrun) << 6 | 0x80,
            };
        }
        if register == if self.kind == SensorKind::Adxl345 { 0x00 } else { 0x0F } {
            if self.deaf_readings > 0 {
                self.deaf_readings -= 1;
                return 0;
            }
            return self.identity;
        }
        self.registers[usize::from(register)]
    }

    fn write(&mut self, value: u8, now: u64) {
        let register = self.register;
        self.written.push([register, value]);
        let (may, control, at_rest): (&[std::ops::RangeInclusive<u8>], u8, &[u8]) = match self.kind {
            SensorKind::Adxl345 => (&[0x1D..=0x2A, 0x2C..=0x2F, 0x31..=0x31, 0x38..=0x38], 0x2D, &[0x2C, 0x31, 0x38]),
            SensorKind::Lis2dw12 => (&[0x20..=0x25, 0x2E..=0x2E, 0x30..=0x36, 0x3C..=0x3F], 0x20, &[0x21, 0x25, 0x2E]),
        };
        if !may.iter().any(|range| range.contains(&register)) {
            return self.breach("a register that is read only was written");
        }
        if self.began.is_some() && at_rest.contains(&register) {
            self.breach("the range, the rate or the FIFO was changed while it measures");
        }
        if self.dead == Some(register) {
            return;
        }
        self.registers[usize::from(register)] = value;
        if register == control {
            self.made = 0;
            // Turn-on time of an ADXL345 (datasheet rev E, power modes), within which a LIS2DW12 has settled too.
            self.began = (self.rate() > 0.0).then_some(now + 1_100_000);
            self.started = self.started.or(self.began);
        }
        // Bypass empties the FIFO.
        if register == if self.kind == SensorKind::Adxl345 { 0x38 } else { 0x2E } && !self.is_streaming() {
            self.fifo.clear();
            self.is_overrun = false;
        }
    }

    /// The register after this one; a LIS2DW12 goes round in its data registers.
    fn step(&mut self, now: u64, counts_up: bool) {
        if !counts_up {
            return;
        }
        let is_last = self.register == self.data() + 5;
        self.register = match self.kind {
            SensorKind::Lis2dw12 if is_last => self.data(),
            _ => (self.register + 1) & 0x3F,
        };
        if is_last {
            self.pop(now);
        }
    }
}

impl Store for Sensor {}

impl Peer for Sensor {
    fn transfer(&mut self, mosi: u32, bits: u8, context: &mut Timeline<'_, '_>) -> u32 {
        let now = context.now().0;
        let began = std::mem::replace(&mut self.word, now);
        self.advance(now);
        if bits != 8 {
            self.breach("a frame has not eight bits");
        }
        if self.trouble_at(now) == Some(SensorTrouble::Unplugged) {
            return 0xFF;
        }
        let byte = mosi as u8;
        let Some(command) = self.command else {
            self.command = Some(byte);
            self.register = byte & 0x3F;
            return 0;
        };
        let answer = if command & 0x80 == 0 {
            self.write(byte, now);
            0
        } else {
            self.read(began)
        };
        let counts_up = match self.kind {
            SensorKind::Adxl345 => command & 0x40 != 0,
            SensorKind::Lis2dw12 => self.registers[0x21] & 4 != 0,
        };
        self.step(now, counts_up);
        u32::from(answer)
    }

    fn select(&mut self, context: &mut Timeline<'_, '_>) {
        let now = context.now().0;
        if self.released.is_some_and(|released| now < released + 150) {
            self.breach("selected again within 150 ns");
        }
        (self.command, self.word) = (None, now);
    }

    fn deselect(&mut self, context: &mut Timeline<'_, '_>) {
        let now = context.now().0;
        self.pop(now);
        self.released = Some(now);
    }
}
