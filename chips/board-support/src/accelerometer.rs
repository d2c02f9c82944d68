//! An accelerometer on a wire (SPI): how it is set up, when its samples are fetched, and their bytes.
//!
//! A chip's crate carries the bytes ([`Wire`], and the transfers that a [`Reader`] asks for). All that depends on the
//! kind of sensor is a `Row`.
//!
//! **Set-up.** The identity is read up to three times after a reading that does not count. Many sensors answer the
//! first reading after power came with another number (Klipper's issue 3637, BTT's issue 156 of the Octopus). Every
//! register that was written is read back.
//!
//! **Sampling.** The sensor keeps up to 32 samples in a FIFO. Every millisecond the reader asks how many there are, and
//! then fetches each by a transfer of its own:
//!
//! | state | event | then |
//! |---|---|---|
//! | at rest | timer | transfer of the status |
//! | status | it came | the samples that wait, one by one; without any, rest |
//! | sample | it came | the next one that waits, or rest |
//! | any | no sample for `QUIET` timer events | [`SensorFault::Silent`] |
//!
//! A transfer that some noise has damaged is one sample at the most: the last good one is repeated. Many such transfers
//! are [`SensorFault::Stuck`].
//!
//! Sources: ADXL345 datasheet rev E, register definitions and FIFO; LIS2DW12 datasheet, register description; values
//! as Klipper sets them (adxl345.py, lis2dw.py).

#[cfg(test)]
mod tests;

use corehbot::accelerometer::{Sample, SensorFault, SensorKind};

/// How often the timer event comes.
pub const TIMER_HZ: u32 = 1000;

/// A sensor without a sample for so many timer events is silent. In this time the slowest rate makes 40.
const QUIET: u16 = 100;

/// An axis that has shown the same number so often is stuck: noise moves the last bit of a sound one all the time.
const SAME: u16 = 2000;

/// A damaged transfer adds so much, a good one takes one away, and so much in all is too much: five in a row, or one in
/// sixteen.
const DAMAGE: u8 = 16;
const TOO_DAMAGED: u8 = 5 * DAMAGE - 4;

/// The first bit of a command: the register is read.
const READ: u8 = 0x80;

/// The most bytes of a transfer: a command, three axes of two bytes, and two registers of an ADXL345's FIFO.
pub const LONGEST: usize = 9;

/// Room for the bytes of a transfer.
pub type Bytes = [u8; LONGEST];

/// A sample as the sensor has it.
pub type Raw = [i16; 3];

/// The wires to the sensor.
pub trait Wire {
    /// Selects the sensor, sends the bytes, puts the sensor's bytes in their place, and lets go of it.
    fn transfer(&mut self, bytes: &mut [u8]);
}

/// A transfer: its first byte, behind which zeros are sent, and its length.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Transfer {
    /// The command.
    pub command: u8,
    /// Bytes, with the command.
    pub length: u8,
}

/// A register and its value.
type Setting = [u8; 2];

/// A kind of sensor.
struct Row {
    /// The register of its identity, and the value there.
    identity: Setting,
    /// The registers to set, in this order; the first one stops the sensor.
    settings: [Setting; 6],
    /// Which of them holds the rate.
    rate: usize,
    /// The highest rate in Hz, its code in that register, the difference to the next code below, which has half the
    /// rate, and how many such codes are in use.
    fastest: u16,
    slower: u8,
    halvings: u8,
    /// The register with the number of samples that wait. Bit 6 says that samples were lost, if it says anything.
    status: u8,
    /// Fetches the oldest sample.
    sample: Transfer,
    /// mm/s^2 by bit of each axis, in units of 1/4096.
    scale: [i32; 3],
    /// These show a damaged transfer. In a sound transfer the bits of a number from here on all equal its sign. The
    /// bits of a mask are zeros, and the register behind the sample has a value.
    sign_from: u8,
    zeros: i16,
    behind: Option<u8>,
}

/// POWER_CTL, DATA_FORMAT (full resolution, 16 g), FIFO_CTL (empty, then stream) and BW_RATE. A sample is followed by
/// FIFO_CTL and FIFO_STATUS. 3.774 mg a bit in x and y at 3.3 V, 3.906 mg in z (Klipper).
const ADXL345: Row = Row {
    identity: [0x00, 0xE5],
    settings: [[0x2D, 0x00], [0x31, 0x0B], [0x38, 0x00], [0x2C, 0x0F], [0x38, 0x90], [0x2D, 0x08]],
    rate: 3,
    fastest: 3200,
    slower: 0x01,
    halvings: 3,
    status: 0x39,
    sample: Transfer { command: READ | 0x40 | 0x32, length: 9 },
    scale: [151_594, 151_594, 156_896],
    sign_from: 12,
    zeros: 0,
    behind: Some(0x90),
};

/// CTRL1 (off), CTRL2 (addresses count up, no I2C), CTRL6 (16 g, low noise), FIFO_CTRL (empty, then continuous) and
/// CTRL1 with rate and high performance. The scale is 4.785645 mm/s^2 a bit of 16, and the last two bits are zeros.
const LIS2DW12: Row = Row {
    identity: [0x0F, 0x44],
    settings: [[0x20, 0x00], [0x21, 0x06], [0x25, 0x34], [0x2E, 0x00], [0x2E, 0xC0], [0x20, 0x94]],
    rate: 5,
    fastest: 1600,
    slower: 0x10,
    halvings: 2,
    status: 0x2F,
    sample: Transfer { command: READ | 0x28, length: 7 },
    scale: [19_602; 3],
    sign_from: 15,
    zeros: 3,
    behind: None,
};

const fn row(kind: SensorKind) -> &'static Row {
    match kind {
        SensorKind::Adxl345 => &ADXL345,
        SensorKind::Lis2dw12 => &LIS2DW12,
    }
}

/// Identifies a sensor and starts it at the rate next to `rate`.
///
/// # Errors
/// [`SensorFault::WrongId`] and [`SensorFault::Register`].
pub fn start(kind: SensorKind, rate: u16, wire: &mut impl Wire) -> Result<(), SensorFault> {
    let row = row(kind);
    let [register, identity] = row.identity;
    let read = |wire: &mut _| register_of(wire, register);
    // It does not count: see the head.
    read(wire);
    let mut id = 0;
    if !(0..3).any(|_| {
        id = read(wire);
        id == identity
    }) {
        return Err(SensorFault::WrongId(id));
    }
    // The next rate by ratio: the border between two lies at three quarters of the higher one.
    let halvings = (0..row.halvings).take_while(|n| u32::from(row.fastest >> n) * 3 > u32::from(rate) * 4).count();
    for (at, [register, mut value]) in row.settings.into_iter().enumerate() {
        if at == row.rate {
            value -= row.slower * halvings as u8;
        }
        wire.transfer(&mut [register, value]);
        if register_of(wire, register) != value {
            return Err(SensorFault::Register);
        }
    }
    Ok(())
}

/// Stops the sensor.
pub fn stop(kind: SensorKind, wire: &mut impl Wire) {
    let [mut off, ..] = row(kind).settings;
    wire.transfer(&mut off);
}

fn register_of(wire: &mut impl Wire, register: u8) -> u8 {
    let mut bytes = [READ | register, 0];
    wire.transfer(&mut bytes);
    bytes[1]
}

/// A sample in mm/s^2.
#[must_use]
pub fn scaled(kind: SensorKind, raw: Raw) -> Sample {
    let mut axes = row(kind).scale;
    axes.iter_mut().zip(raw).for_each(|(axis, raw)| *axis = (i32::from(raw) * *axis + (1 << 11)) >> 12);
    Sample { axes }
}

/// The transfer under way.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Rest,
    Status,
    Sample,
}

/// Fetches the samples of a sensor that was started.
pub struct Reader {
    row: &'static Row,
    state: State,
    /// Samples that wait in the sensor.
    waiting: u8,
    /// Timer events since the last sample.
    quiet: u16,
    /// Damaged transfers, as [`DAMAGE`] counts them.
    damage: u8,
    last: Raw,
    /// How often each axis has shown its last number.
    same: [u16; 3],
}

impl Reader {
    /// A reader of a sensor that has just been started.
    #[must_use]
    pub const fn new(kind: SensorKind) -> Self {
        Self { row: row(kind), state: State::Rest, waiting: 0, quiet: 0, damage: 0, last: [0; 3], same: [0; 3] }
    }

    /// The timer event: the transfer that is to begin, if none is under way.
    ///
    /// # Errors
    /// [`SensorFault::Silent`].
    pub fn on_timer(&mut self) -> Result<Option<Transfer>, SensorFault> {
        self.quiet += 1;
        if self.quiet > QUIET {
            return Err(SensorFault::Silent);
        }
        let is_at_rest = self.state == State::Rest;
        if is_at_rest {
            self.state = State::Status;
        }
        Ok(is_at_rest.then_some(Transfer { command: READ | self.row.status, length: 2 }))
    }

    /// The transfer has brought these bytes: the sample in them, and the transfer that is to begin.
    ///
    /// # Errors
    /// [`SensorFault::Silent`], [`SensorFault::Overflow`] and [`SensorFault::Stuck`].
    pub fn on_transfer(&mut self, bytes: &Bytes) -> Result<(Option<Raw>, Option<Transfer>), SensorFault> {
        let sample = match core::mem::replace(&mut self.state, State::Rest) {
            State::Rest => return Ok((None, None)),
            State::Status => {
                self.waiting = waiting(bytes[1])?;
                None
            }
            State::Sample => {
                self.waiting -= 1;
                Some(self.sample(bytes)?)
            }
        };
        if self.waiting > 0 {
            self.state = State::Sample;
        }
        Ok((sample, (self.waiting > 0).then_some(self.row.sample)))
    }

    /// The sample, or the last good one if it was damaged.
    fn sample(&mut self, bytes: &Bytes) -> Result<Raw, SensorFault> {
        let [_, x0, x1, y0, y1, z0, z1, behind, _] = *bytes;
        let raw = [[x0, x1], [y0, y1], [z0, z1]].map(i16::from_le_bytes);
        let is_possible =
            // The bits above the number repeat its sign, so only all ones or all zeros are possible there.
            raw.iter().all(|axis| matches!(axis >> self.row.sign_from, 0 | -1) && axis & self.row.zeros == 0);
        if !is_possible || self.row.behind.is_some_and(|value| value != behind) {
            self.damage = self.damage.saturating_add(DAMAGE);
            return if self.damage > TOO_DAMAGED { Err(SensorFault::Stuck) } else { Ok(self.last) };
        }
        self.damage = self.damage.saturating_sub(1);
        self.quiet = 0;
        for ((same, now), last) in self.same.iter_mut().zip(raw).zip(self.last) {
            *same = if now == last { *same + 1 } else { 0 };
            if *same > SAME {
                return Err(SensorFault::Stuck);
            }
        }
        self.last = raw;
        Ok(raw)
    }
}

/// Samples that wait, by the sensor's status.
fn waiting(status: u8) -> Result<u8, SensorFault> {
    /// Samples in a full FIFO.
    const FULL: u8 = 32;
    /// Samples were lost.
    const LOST: u8 = 0x40;
    match status {
        // The line is pulled up, and nothing drives it.
        0xFF => Err(SensorFault::Silent),
        _ if status & LOST != 0 || status & 0x3F >= FULL => Err(SensorFault::Overflow),
        _ => Ok(status & 0x3F),
    }
}
