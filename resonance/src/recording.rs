//! Recording: the text of a raw file, checked, as samples of three axes at one rate.
//!
//! Klipper writes `#time,accel_x,accel_y,accel_z` in s and mm/s^2. RepRapFirmware writes `Sample,X,Y,Z` in g and ends
//! with `Rate 1344, overflows 0`. A recording that would mislead is refused with its line; one with a small flaw is
//! taken with a remark.

use std::borrow::Cow;
use std::fmt;

/// Header of Klipper's raw files, without a `#`.
const KLIPPER: &str = "time,accel_x,accel_y,accel_z";

/// Header of RepRapFirmware's files.
const REPRAP: &str = "sample,x,y,z";

/// Standard gravity in mm/s^2 (CGPM, 1901).
const GRAVITY: f64 = 9806.65;

/// Slowest rate in Hz: a sweep goes to 135 Hz, and a third of the rate is left for the sensor's filter.
const SLOWEST_HZ: f64 = 400.0;

/// Highest rate in Hz. Sensors of printers have 3200; 26.7 kHz is the fastest of all in use (IIS3DWB).
const FASTEST_HZ: f64 = 30_000.0;

/// Shortest recording in s: four windows of a spectrum.
const SHORTEST_S: f64 = 1.0;

/// A step in time longer than this many samples is a gap.
const GAP: f64 = 2.5;

/// A gap of more samples than this spoils a window of the spectrum.
const LONGEST_GAP: f64 = 16.0;

/// Part of the samples that may be lost in small gaps.
const LOST: f64 = 0.005;

/// Samples at the greatest value of an axis, one after the other, that look like the end of the sensor's range.
const CLIPPED: usize = 4;

/// The smallest range of sensors is 2 g. Below it, equal values are a still axis in whole steps.
const LEAST_RANGE: f64 = 1.9 * GRAVITY;

/// Samples of three axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Samples a second, by the recording's own times.
    pub rate_hz: f64,
    /// Acceleration along x, y and z in mm/s^2.
    pub axes: [Vec<f64>; 3],
    /// Small flaws.
    pub remarks: Vec<String>,
}

/// Why a text is no recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Flaw {
    /// Nothing in it.
    Empty,
    /// A header, but no samples.
    NoSamples,
    /// Not text; it looks like this.
    NotText(&'static str),
    /// The frequencies of a spectrum are too few, not even, or do not begin at 0.
    Frequencies,
    /// The first line is no known header.
    Header(String),
    /// A line with too few or too many columns: its number, how many it has, and how many there must be.
    Columns(usize, usize, usize),
    /// A line with a word that is no finite number.
    Number(usize, String),
    /// Time does not grow at this line: the time before it, and its own.
    Backwards(usize, f64, f64),
    /// A gap before this line, and its length in s.
    Gap(usize, f64),
    /// This part of the samples is lost in small gaps.
    Lost(f64),
    /// The recording lasts only so many s.
    Short(f64),
    /// A rate in Hz that no sensor has.
    Rate(f64),
    /// No axis moves.
    Still,
    /// A line of an .stdata file is no recording: its number, and why.
    Json(usize, String),
    /// A recording within an .stdata file: its name, and its flaw, with a sample's number in place of a line's.
    In(String, Box<Self>),
    /// RepRapFirmware's last line with the rate is missing.
    NoRate,
    /// RepRapFirmware lost samples so many times.
    Overflows(u64),
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the file is empty; the recording did not begin, or was not written to its end"),
            Self::NoSamples => f.write_str("the file has a header and no samples; is the sensor connected?"),
            Self::NotText(kind) => write!(f, "expected a CSV file, found {kind}"),
            Self::Frequencies => f.write_str(
                "the frequencies of this spectrum are too few, not even, or do not begin at 0 Hz; it is not whole",
            ),
            Self::Header(found) => {
                write!(f, "line 1: expected the header `#{KLIPPER}` (Klipper) or `Sample,X,Y,Z` ")?;
                write!(f, "(RepRapFirmware), found `{found}`")
            }
            Self::Columns(line, count, known) => write!(f, "line {line}: expected {known} columns, found {count}"),
            Self::Number(line, word) => write!(f, "line {line}: `{word}` is not a number"),
            Self::Backwards(line, before, time) => {
                write!(
                    f,
                    "line {line}: time does not grow, {time} s after {before} s; are these two recordings in one?"
                )
            }
            Self::Gap(line, gap) => {
                write!(f, "line {line}: {:.1} ms without samples before it; record again, ", 1000.0 * gap)?;
                f.write_str("with less load on the host or a lower rate of the sensor")
            }
            Self::Lost(part) => {
                write!(f, "{:.1} % of the samples are missing in small gaps; record again, ", 100.0 * part)?;
                f.write_str("with less load on the host or a lower rate of the sensor")
            }
            Self::Short(seconds) => write!(f, "it lasts {seconds:.2} s; at least {SHORTEST_S} s are needed"),
            Self::Rate(hz) if *hz > FASTEST_HZ => {
                write!(f, "{hz:.0} samples a second are more than any sensor has; the time must be in seconds")
            }
            Self::Rate(hz) => {
                write!(f, "{hz:.1} samples a second are too few, at least {SLOWEST_HZ} are needed; ")?;
                f.write_str("the time must be in seconds")
            }
            Self::Still => f.write_str("no axis moves; is the sensor connected, and did the sweep run?"),
            Self::Json(line, why) => write!(f, "line {line}, unpacked, is no recording of Shake&Tune: {why}"),
            Self::In(name, flaw) => write!(f, "{name}: {flaw}"),
            Self::NoRate => f.write_str("the last line, `Rate ..., overflows ...`, is missing: the file is not whole"),
            Self::Overflows(count) => write!(f, "the sensor lost samples {count} times; record again at a lower rate"),
        }
    }
}

impl std::error::Error for Flaw {}

/// First bytes of files that people mistake for raw data.
const KINDS: [(&[u8], &str); 6] = [
    (b"\x28\xb5\x2f\xfd", "a file packed by zstd (.stdata); Shake&Tune's older versions and Klipper write CSV"),
    (b"PK\x03\x04", "a ZIP archive; unpack it"),
    (b"\x1f\x8b", "a file packed by gzip; unpack it"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xfe", "text in UTF-16; save it as UTF-8"),
    (b"\xfe\xff", "text in UTF-16; save it as UTF-8"),
];

/// Text of a file, if it is one.
///
/// # Errors
/// It is something else.
pub fn text(bytes: &[u8]) -> Result<Cow<'_, str>, Flaw> {
    if let Some((_, kind)) = KINDS.iter().find(|(head, _)| bytes.starts_with(head)) {
        return Err(Flaw::NotText(kind));
    }
    if bytes.contains(&0) {
        return Err(Flaw::NotText("binary data"));
    }
    Ok(String::from_utf8_lossy(bytes))
}

/// Reads a raw file.
///
/// # Errors
/// It is no recording, or one that would mislead.
pub fn read(bytes: &[u8]) -> Result<Recording, Flaw> {
    let text = text(bytes)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())).filter(|(_, l)| !l.is_empty());
    let (_, first) = lines.next().ok_or(Flaw::Empty)?;
    let header = first.trim_start_matches('#').to_ascii_lowercase().replace(' ', "");
    if header == REPRAP {
        return reprap(lines);
    }
    if header != KLIPPER {
        return Err(Flaw::Header(first.chars().take(60).collect()));
    }
    let mut rows = Rows::default();
    for (number, line) in lines.filter(|(_, line)| !line.starts_with('#')) {
        let [time, x, y, z] = columns(number, line)?;
        rows.push(number, time, [x, y, z])?;
    }
    rows.checked()
}

/// Samples of RepRapFirmware: a number instead of the time, g instead of mm/s^2.
fn reprap<'t>(lines: impl Iterator<Item = (usize, &'t str)>) -> Result<Recording, Flaw> {
    let (mut samples, mut end) = (Vec::new(), None);
    for (number, line) in lines {
        match line.to_ascii_lowercase().strip_prefix("rate ") {
            Some(rest) => end = Some((number, rest.to_owned())),
            None => samples.push((number, columns(number, line)?)),
        }
    }
    let (number, end) = end.ok_or(Flaw::NoRate)?;
    let mut words = end.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let word = words.next().unwrap_or_default();
    let rate: f64 = word.parse().map_err(|_| Flaw::Number(number, word.to_owned()))?;
    if !(SLOWEST_HZ..=FASTEST_HZ).contains(&rate) {
        return Err(Flaw::Rate(rate));
    }
    match words.find_map(|word| word.parse::<u64>().ok()) {
        Some(count) if count > 0 => return Err(Flaw::Overflows(count)),
        _ => {}
    }
    let mut rows = Rows::default();
    for (number, [sample, x, y, z]) in samples {
        rows.push(number, sample / rate, [x, y, z].map(|g| g * GRAVITY))?;
    }
    rows.checked()
}

/// Four finite numbers.
fn columns(number: usize, line: &str) -> Result<[f64; 4], Flaw> {
    let mut found = [0.0; 4];
    let mut count = 0;
    for word in line.split(',').map(str::trim) {
        if let Some(place) = found.get_mut(count) {
            let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
            *place = value.ok_or_else(|| Flaw::Number(number, word.chars().take(30).collect()))?;
        }
        count += 1;
    }
    if count == found.len() { Ok(found) } else { Err(Flaw::Columns(number, count, found.len())) }
}

/// Samples with their times, and the lines that they come from.
#[derive(Default)]
pub(crate) struct Rows {
    lines: Vec<usize>,
    times: Vec<f64>,
    axes: [Vec<f64>; 3],
}

impl Rows {
    pub(crate) fn push(&mut self, line: usize, time: f64, sample: [f64; 3]) -> Result<(), Flaw> {
        if let Some(before) = self.times.last().copied().filter(|before| time <= *before) {
            return Err(Flaw::Backwards(line, before, time));
        }
        self.lines.push(line);
        self.times.push(time);
        for (axis, value) in self.axes.iter_mut().zip(sample) {
            axis.push(value);
        }
        Ok(())
    }

    pub(crate) fn checked(self) -> Result<Recording, Flaw> {
        let (Some(first), Some(last)) = (self.times.first(), self.times.last()) else { return Err(Flaw::NoSamples) };
        let lasts = last - first;
        if self.times.len() < 3 {
            return Err(Flaw::Short(lasts));
        }
        let mut steps: Vec<f64> = self.times.iter().zip(self.times.iter().skip(1)).map(|(a, b)| b - a).collect();
        let middle = steps.len() / 2;
        let (_, usual, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        let usual = *usual;
        // The rate before the length: with a time in milliseconds both would be wrong.
        if !(SLOWEST_HZ..=FASTEST_HZ).contains(&(1.0 / usual)) {
            return Err(Flaw::Rate(1.0 / usual));
        }
        if lasts < SHORTEST_S {
            return Err(Flaw::Short(lasts));
        }
        let mut lost = 0.0;
        for (pair, line) in self.times.windows(2).zip(self.lines.iter().skip(1)) {
            let step = pair.iter().copied().fold(0.0, |a, b| b - a);
            if step > LONGEST_GAP * usual {
                return Err(Flaw::Gap(*line, step));
            }
            if step > GAP * usual {
                lost += step / usual - 1.0;
            }
        }
        let part = lost / self.times.len() as f64;
        if part > LOST {
            return Err(Flaw::Lost(part));
        }
        let mut remarks = Vec::new();
        if lost > 0.0 {
            remarks.push(format!("some {lost:.0} samples are missing in small gaps"));
        }
        let still = self.axes.iter().map(|axis| is_still(axis));
        let still: Vec<char> = "xyz".chars().zip(still).filter(|(_, is)| *is).map(|(letter, _)| letter).collect();
        if still.len() == 3 {
            return Err(Flaw::Still);
        }
        for letter in still {
            remarks.push(format!("{letter} has the same value in every sample: the sensor's axis is stuck"));
        }
        for (letter, axis) in "xyz".chars().zip(&self.axes) {
            if is_clipped(axis) {
                remarks.push(format!("{letter} reaches the end of the sensor's range, so peaks are too low"));
            }
        }
        remarks.extend(other_unit(&self.axes));
        // As Klipper: samples over time from the first to the last.
        Ok(Recording { rate_hz: self.times.len() as f64 / lasts, axes: self.axes, remarks })
    }
}

/// A remark if the mean acceleration is gravity in another unit than mm/s^2, within a tenth.
fn other_unit(axes: &[Vec<f64>; 3]) -> Option<String> {
    let means = axes.each_ref().map(|axis| axis.iter().sum::<f64>() / axis.len().max(1) as f64);
    let mean = means.iter().map(|v| v * v).sum::<f64>().sqrt();
    let units = [("g", 1.0), ("m/s^2", GRAVITY / 1000.0)];
    let (unit, _) = units.into_iter().find(|(_, gravity)| (0.9..1.1).contains(&(mean / gravity)))?;
    Some(format!(
        "the mean acceleration is {mean:.1}, so this is in {unit} and not in mm/s^2: \
         frequencies, dampings and shapers hold, heights of spectra do not"
    ))
}

/// Whether all samples are alike.
fn is_still(axis: &[f64]) -> bool {
    axis.first().is_none_or(|first| axis.iter().all(|value| value == first))
}

/// Whether samples stay at the greatest or the least value, which a signal does only at the end of a range.
fn is_clipped(axis: &[f64]) -> bool {
    let (least, most) = axis.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    let mut length = 0;
    axis.iter().any(|value| {
        let is_end = (*value == least || *value == most) && value.abs() > LEAST_RANGE;
        length = if is_end { length + 1 } else { 0 };
        length >= CLIPPED
    })
}

#[cfg(test)]
mod tests;
