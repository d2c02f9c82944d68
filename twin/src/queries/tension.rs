//! Tension: the pitch of each straight part of the belts for a wanted tension, and the tension for a heard pitch.
//!
//! A plucked part between two pulleys is a string, `f = sqrt(T / m) / (2 L)` (Mersenne). At rest all parts of a belt
//! have one tension, except for friction of pulleys. Belt outside the rectangle of W and D is no part here, since its
//! run is not known.

use super::{At, Setup, shown};
use crate::calibration::span_tension_n;
use crate::geometry::layout;
use crate::model::links::Links;
use serde::Serialize;

/// Shortest part in mm with a pitch that bending hardly raises.
const LONG_ENOUGH_MM: f64 = 150.0;

/// Shorter parts have no pitch to hear.
const LEAST_MM: f64 = 10.0;

/// Parts of one belt that differ by more than this, of 1, are held apart by friction: a pitch is known to 2 %, so a
/// tension to 4 %.
const ALIKE: f64 = 0.1;

/// Pitches at a place of the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tension {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// The straight parts, belt after belt in the direction of travel.
    pub parts: Vec<SpanTension>,
    /// Belts of which a pitch was heard.
    pub heard: Vec<Heard>,
}

/// A straight part of a belt.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpanTension {
    /// Its number, from 1.
    pub part: usize,
    /// Its belt, from 1.
    pub belt: usize,
    /// The span that it belongs to.
    pub span: &'static str,
    /// Numbers of the pulleys at its ends; 0 is a clamp.
    pub between: [u8; 2],
    /// Free length.
    pub length_mm: f64,
    /// Whether it is the longest of its belt, which is the best one to pluck.
    pub is_longest: bool,
    /// The wanted tension.
    #[serde(rename = "wanted_N")]
    pub wanted_n: f64,
    /// Pitch at the wanted tension; none for a part that is too short.
    #[serde(rename = "pitch_Hz")]
    pub pitch_hz: Option<f64>,
    /// The pitch that was heard.
    #[serde(rename = "heard_Hz")]
    pub heard_hz: Option<f64>,
    /// Its tension by that pitch.
    #[serde(rename = "tension_N")]
    pub tension_n: Option<f64>,
}

/// A belt by its pitches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Heard {
    /// The belt, from 1.
    pub belt: usize,
    /// Mean tension of its parts.
    #[serde(rename = "tension_N")]
    pub tension_n: f64,
    /// The wanted tension.
    #[serde(rename = "wanted_N")]
    pub wanted_n: f64,
    /// Greatest difference of a part from the mean, of 1.
    pub spread: f64,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TensionError {
    /// There is no part of this number; the machine has so many.
    NoPart(usize, usize),
    /// This part, with a free length in mm, has no pitch.
    Short(usize, f64),
    /// This part has several pitches.
    Twice(usize),
}

impl std::fmt::Display for TensionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoPart(part, count) => write!(f, "there is no part {part}; the belts have 1 to {count}"),
            Self::Twice(part) => write!(f, "part {part} has two pitches; give one"),
            Self::Short(part, mm) => write!(f, "part {part} is too short for a pitch, {mm:.1} mm; move the tool"),
        }
    }
}

impl std::error::Error for TensionError {}

impl Tension {
    /// The answer for a wanted tension in N (nothing is each belt's own), and for pitches in Hz of parts by number.
    ///
    /// # Errors
    /// A pitch of a part that does not exist or that has none, or two pitches of one.
    pub fn new(setup: &Setup, wanted_n: Option<f64>, heard: &[(usize, f64)]) -> Result<Self, TensionError> {
        let (machine, params) = (setup.machine, &setup.params);
        let stops = machine.stops();
        let number = |stop: usize| stops.get(stop).map_or(0, |stop| stop.number);
        let segments = layout(machine, params, setup.tool).segments;
        let links = Links::segments(machine, params, setup.tool).links;
        let part = |(index, (segment, link)): (usize, (&crate::geometry::Segment, &crate::model::links::Link))| {
            let mass = params.belt_kg_per_m.of(link.belt);
            let wanted_n = wanted_n.unwrap_or_else(|| params.preload_n.of(link.belt));
            let unit = span_tension_n(segment.length_mm, mass, 1.0);
            let heard_hz = heard.iter().find(|(part, _)| *part == index + 1).map(|(_, hz)| *hz);
            SpanTension {
                part: index + 1,
                belt: link.belt + 1,
                span: link.span,
                between: [number(segment.from), number(segment.to)],
                length_mm: segment.length_mm,
                is_longest: false,
                wanted_n,
                pitch_hz: (segment.length_mm >= LEAST_MM).then(|| (wanted_n / unit).sqrt()),
                heard_hz,
                tension_n: heard_hz.map(|hz| unit * hz * hz),
            }
        };
        let mut parts: Vec<SpanTension> = segments.iter().zip(&links).enumerate().map(part).collect();
        for (index, (wanted, _)) in heard.iter().enumerate() {
            if heard.iter().skip(index + 1).any(|(other, _)| other == wanted) {
                return Err(TensionError::Twice(*wanted));
            }
            let part = parts.iter().find(|part| part.part == *wanted);
            let part = part.ok_or(TensionError::NoPart(*wanted, parts.len()))?;
            if part.pitch_hz.is_none() {
                return Err(TensionError::Short(*wanted, part.length_mm));
            }
        }
        let belts = parts.iter().map(|part| part.belt).max().unwrap_or(0);
        for belt in 1..=belts {
            let own = parts.iter_mut().filter(|part| part.belt == belt);
            if let Some(longest) = own.max_by(|a, b| a.length_mm.total_cmp(&b.length_mm)) {
                longest.is_longest = true;
            }
        }
        let heard = (1..=belts).filter_map(|belt| by_belt(belt, &parts)).collect();
        Ok(Self { at: setup.at(), parts, heard })
    }
}

fn by_belt(belt: usize, parts: &[SpanTension]) -> Option<Heard> {
    let own = || parts.iter().filter(|part| part.belt == belt);
    let tensions: Vec<f64> = own().filter_map(|part| part.tension_n).collect();
    if tensions.is_empty() {
        return None;
    }
    let tension_n = tensions.iter().sum::<f64>() / tensions.len() as f64;
    let spread = tensions.iter().map(|tension| (tension / tension_n - 1.0).abs()).fold(0.0, f64::max);
    Some(Heard { belt, tension_n, wanted_n: own().next()?.wanted_n, spread })
}

impl std::fmt::Display for Tension {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.at)?;
        writeln!(f, "    part  span      pulleys   free length  wanted     pitch")?;
        for part in &self.parts {
            let mark = if part.is_longest { "*" } else { " " };
            let [from, to] = part.between.map(|n| if n == 0 { "clamp".to_owned() } else { n.to_string() });
            let pitch = part.pitch_hz.map_or_else(|| "none".to_owned(), |hz| format!("{hz:.1} Hz"));
            write!(f, "  {mark} {:>4}  {:<8} {from:>5} - {to:<5}", part.part, part.span)?;
            write!(f, " {:>8} mm  {:>4} N {pitch:>9}", shown(part.length_mm, 1), shown(part.wanted_n, 0))?;
            if let (Some(hz), Some(tension)) = (part.heard_hz, part.tension_n) {
                write!(f, "   heard {hz:.1} Hz: {tension:.1} N")?;
            }
            if part.pitch_hz.is_some() && part.length_mm < LONG_ENOUGH_MM {
                write!(f, "  short: bending raises the pitch")?;
            }
            writeln!(f)?;
        }
        writeln!(f, "  * pluck the longest part of each belt, with the machine at rest")?;
        for heard in &self.heard {
            let Heard { belt, tension_n, wanted_n, spread } = heard;
            let more = 100.0 * (tension_n / wanted_n - 1.0);
            let more = if *wanted_n > 0.0 { format!(", {more:+.0} % of {wanted_n:.1} N") } else { String::new() };
            writeln!(f, "  belt {belt}: {tension_n:.1} N{more}")?;
            if *spread > ALIKE {
                let percent = 100.0 * spread;
                writeln!(f, "    its parts differ by {percent:.0} %: move the tool about, and pluck again")?;
            }
        }
        Ok(())
    }
}
