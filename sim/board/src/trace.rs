//! Step trace: every step event as a row of CSV, and a digest of it all.
//!
//! Version 1 of the format: comment lines, a header row that names the motors, then one row an instant with
//! the signed steps (-1, 0, +1) of each motor. Ticks are motion time and never fall. The digest is SHA-256
//! over exactly the bytes of the file; it is computed even if no file is written, so two runs can be
//! compared without keeping gigabytes.
//!
//! A print has tens of millions of rows, so rows are joined from prepared pieces instead of being formatted. The digits
//! of a tick before its last six change ten times a second and are kept in between.

use corehbot::kinematics::Mechanism;
use corehbot::motors::{MOTORS, MotorName, MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::{StepsPerMm, TICKS_PER_SECOND};
use sha2::{Digest as _, Sha256};
use std::io::{self, Write};

/// Bytes gathered before they are hashed and written.
const CHUNK: usize = 1 << 16;

/// Longest row: 20 digits and eight signed columns with their commas and line end.
const LONGEST_ROW: usize = 64;

/// A tick is written as its last six digits and all digits before them.
const LOW_TICKS: u64 = 1_000_000;
const LOW_DIGITS: usize = 6;

/// Digits before the last six, at most: a tick has 20. Two more, because 16 bytes are copied faster than 14.
const HIGH_DIGITS: usize = 16;

/// The numbers below 100 in two digits.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut number = 0;
    while number < pairs.len() {
        pairs[number] = [b'0' + (number / 10) as u8, b'0' + (number % 10) as u8];
        number += 1;
    }
    pairs
};

/// The machine's description in the first comment of a trace.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Header {
    /// How far each motor turns for a step of each axis.
    pub mechanism: Mechanism,
    /// The names of the motors: a column each.
    pub motors: [MotorName; MOTORS],
    /// Resolution of x, y, z and e.
    pub steps_per_mm: [StepsPerMm; 4],
}

impl From<&Settings> for Header {
    fn from(s: &Settings) -> Self {
        Self { mechanism: s.mechanism, motors: s.motor_names, steps_per_mm: s.axes.map(|a| a.steps_per_mm).to_array() }
    }
}

impl Header {
    /// The comment and the header row.
    fn text(&self) -> String {
        let names = self.names().map(|name| format!(",{name}")).collect::<String>();
        let (kinematics, resolutions) = (self.kinematics(), self.resolutions());
        format!(
            "# corehbot-trace v1 tick_hz={TICKS_PER_SECOND} kinematics={kinematics} steps_per_mm={resolutions}\ntick{names}\n"
        )
    }

    /// The names of the columns.
    fn names(&self) -> impl Iterator<Item = MotorName> {
        self.motors.into_iter().take_while(|name| !name.is_none())
    }

    fn is_corehbot(&self) -> bool {
        (self.mechanism, self.motors) == (Mechanism::corehbot(), prototype::NAMES)
    }

    /// The mechanism in one word: the CoreH-bot by its name, others by the row of each motor.
    fn kinematics(&self) -> String {
        if self.is_corehbot() {
            return "corehbot".to_owned();
        }
        let fitted = self.mechanism.fitted();
        let motors = self.mechanism.motors().zip(self.motors).filter(|((motor, _), _)| fitted.has(*motor));
        let rows = motors.map(|((_, row), name)| format!("{name}({})", row.map(|times| times.to_string()).join(",")));
        rows.collect::<Vec<_>>().join(";")
    }

    /// Steps/mm of the belt, of z and of e for the CoreH-bot; of x, y, z and e for others.
    fn resolutions(&self) -> String {
        let [x, y, z, e] = self.steps_per_mm.map(exact);
        if self.is_corehbot() { format!("{x}/{z}/{e}") } else { format!("{x}/{y}/{z}/{e}") }
    }
}

/// All digits of a resolution: a fraction of 16 bits ends after 16 decimal places.
fn exact(value: StepsPerMm) -> String {
    // 10^16 / 2^16 = 5^16, so the fraction's digits are an exact integer.
    let fraction = u64::from(value.to_bits() & 0xFFFF) * 5u64.pow(16);
    let text = format!("{}.{fraction:016}", value.to_bits() >> 16);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Summary of a finished trace.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Finished {
    /// SHA-256 of the trace in hexadecimal.
    pub sha256: String,
    /// Rows.
    pub events: u64,
}

/// A SHA-256 under way. The library has `sha2`'s, which runs everywhere; a caller may have a faster one.
pub trait Digest {
    /// Takes in more bytes.
    fn update(&mut self, bytes: &[u8]);
    /// The digest of all bytes.
    fn finish(self) -> [u8; 32];
}

impl Digest for Sha256 {
    fn update(&mut self, bytes: &[u8]) {
        sha2::Digest::update(self, bytes);
    }

    fn finish(self) -> [u8; 32] {
        self.finalize().into()
    }
}

/// A few characters of a row.
#[derive(Clone, Copy, Default)]
struct Piece {
    text: [u8; 16],
    length: u8,
}

/// The digits of a tick before its last six.
#[derive(Clone, Copy, Default)]
struct High {
    /// The first tick that has them.
    from: u64,
    text: [u8; HIGH_DIGITS],
    /// 0 for ticks of six digits and fewer.
    length: usize,
}

impl High {
    fn new(tick: u64) -> Self {
        let value = tick / LOW_TICKS;
        let mut digits = [0; LONGEST_ROW];
        let length = if value == 0 { 0 } else { decimal(value, &mut digits) };
        let mut text = [0; HIGH_DIGITS];
        text.copy_from_slice(&digits[..HIGH_DIGITS]);
        Self { from: value * LOW_TICKS, text, length }
    }

    /// Writes `tick` to the begin of `out` and returns its length.
    #[inline]
    fn write(&mut self, tick: u64, out: &mut [u8; LONGEST_ROW]) -> usize {
        if tick < self.from || tick - self.from >= LOW_TICKS {
            *self = Self::new(tick);
        }
        if self.length == 0 {
            return decimal(tick, out);
        }
        let low = (tick - self.from) as u32;
        let pair = |number: u32| PAIRS[number as usize % PAIRS.len()];
        let ([a, b], [c, d], [e, f]) = (pair(low / 10_000), pair(low / 100), pair(low));
        out[..HIGH_DIGITS].copy_from_slice(&self.text);
        put(out, self.length, [a, b, c, d, e, f]);
        self.length + LOW_DIGITS
    }
}

/// Puts bytes at a place of a row.
#[inline]
fn put<const N: usize>(row: &mut [u8; LONGEST_ROW], at: usize, bytes: [u8; N]) {
    row[at..at + N].copy_from_slice(&bytes);
}

/// Writes a trace and computes its digest.
///
/// An I/O error is kept and returned by [`finish`](Self::finish), so that a sink need not fail.
pub struct TraceWriter<W, D = Sha256> {
    out: Option<W>,
    hash: D,
    /// Bytes not hashed yet: the first `filled` of them.
    buffer: Box<[u8]>,
    filled: usize,
    events: u64,
    high: High,
    error: Option<io::Error>,
    /// The first four columns, by steps and directions.
    first: Box<[Piece; 256]>,
    /// The other columns and the line end, by steps and directions.
    others: Box<[Piece; 256]>,
}

impl<W: Write> TraceWriter<W> {
    /// A trace that goes to `out`, or only into the digest.
    #[must_use]
    pub fn new(out: Option<W>, header: Header) -> Self {
        Self::with_digest(out, header, Sha256::new())
    }
}

impl<W: Write, D: Digest> TraceWriter<W, D> {
    /// The same with a digest of the caller, which has taken in nothing yet.
    #[must_use]
    pub fn with_digest(out: Option<W>, header: Header, hash: D) -> Self {
        let text = header.text();
        let mut buffer = vec![0; text.len() + CHUNK + LONGEST_ROW].into_boxed_slice();
        buffer[..text.len()].copy_from_slice(text.as_bytes());
        let columns = header.names().count();
        let of = |columns, end| Box::new(std::array::from_fn(|i| piece(i as u8 & 0xF, i as u8 >> 4, columns, end)));
        let first = of(columns.min(4) as u8, b"");
        let others = of(columns.saturating_sub(4) as u8, b"\n");
        let (filled, high) = (text.len(), High::default());
        Self { out, hash, buffer, filled, events: 0, high, error: None, first, others }
    }

    /// One instant in which `steps` move, each forward or backward. An instant without steps has no row.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        if steps.is_empty() {
            return;
        }
        self.events += 1;
        let (s, f) = (usize::from(steps.0), usize::from(forward.0));
        let first = &self.first[(s & 0xF) | (f & 0xF) << 4];
        let others = &self.others[(s >> 4 & 0xF) | (f >> 4 & 0xF) << 4];
        // There is always room for a row.
        let Some(row) = self.buffer[self.filled..].first_chunk_mut::<LONGEST_ROW>() else { return };
        let mut length = self.high.write(tick, row);
        for piece in [first, others] {
            put(row, length, piece.text);
            length += usize::from(piece.length);
        }
        self.filled += length;
        if self.filled >= CHUNK {
            self.flush();
        }
    }

    /// Ends the trace.
    ///
    /// # Errors
    /// The first error that the output reported.
    pub fn finish(mut self) -> io::Result<Finished> {
        self.flush();
        if let Some(out) = &mut self.out
            && self.error.is_none()
        {
            out.flush()?;
        }
        match self.error {
            Some(error) => Err(error),
            None => Ok(Finished { sha256: hex(&self.hash.finish()), events: self.events }),
        }
    }

    // A function of its own, so that counts of instructions tell it from the rows.
    #[inline(never)]
    fn flush(&mut self) {
        let bytes = &self.buffer[..self.filled];
        self.hash.update(bytes);
        if let Some(out) = &mut self.out
            && self.error.is_none()
        {
            self.error = out.write_all(bytes).err();
        }
        self.filled = 0;
    }
}

/// The columns of `motors` motors.
fn piece(steps: u8, forward: u8, motors: u8, end: &[u8]) -> Piece {
    let mut text = Vec::new();
    for motor in 0..motors {
        text.extend_from_slice(match (steps >> motor & 1, forward >> motor & 1) {
            (0, _) => b",0",
            (_, 0) => b",-1",
            _ => b",1",
        });
    }
    text.extend_from_slice(end);
    let mut piece = Piece { length: text.len() as u8, ..Piece::default() };
    piece.text[..text.len()].copy_from_slice(&text);
    piece
}

/// Writes `value` in decimal to the begin of `out` and returns its length.
fn decimal(mut value: u64, out: &mut [u8; LONGEST_ROW]) -> usize {
    let mut digits = [0; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    let length = digits.len() - at;
    out[..length].copy_from_slice(&digits[at..]);
    length
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests;
