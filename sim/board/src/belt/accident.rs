//! Accidents of the machine during a print.
//!
//! A hit is an obstacle for the tool: when the tool first comes within 1 mm of a place on its way, a force acts against
//! its motion for a time. The force opposes motion up to a limit in newtons; a tool that has stopped is held, and not
//! thrown back. Parts that break are rows of the [table](crate::accident::table).

use crate::accident::Accident;
use corehbot::units::TICKS_PER_MS;
use corehbot_twin::math::hypot;

/// The tool is at a place when it is so near, in mm.
const NEAR_MM: f64 = 1.0;

/// A tool that is slower than this, in mm/s, runs into nothing: it trembles.
const ON_ITS_WAY_MM_S: f64 = 1.0;

/// Greatest force accepted, in N: a hundred times the holding force of a motor.
const MOST_N: f64 = 10_000.0;

/// Longest hit, in ms.
const LONGEST_MS: f64 = 60_000.0;

/// Farthest place, in mm: as `--assume-homed` has it.
const FARTHEST_MM: f64 = 5000.0;

/// A force on the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Where, in x and y of G-code.
    pub at_mm: [f64; 2],
    /// How strong.
    pub force_n: f64,
    /// How long.
    pub ms: f64,
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub struct Accidents {
    /// Hits.
    pub hits: Vec<Hit>,
    /// Parts that break or rub.
    pub parts: Vec<Accident>,
}

/// Why a text does not describe a hit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HitError {
    /// It has not four parts.
    Parts,
    /// A part that is not a legal number: the allowed values, and the given text.
    Number(&'static str, String),
}

impl std::fmt::Display for HitError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Parts => f.write_str("expected X,Y,N,MS"),
            Self::Number(what, text) => write!(f, "`{text}` is not a {what}"),
        }
    }
}

impl std::error::Error for HitError {}

/// A number within bounds, both included.
fn number(text: &str, what: &'static str, [least, most]: [f64; 2]) -> Result<f64, HitError> {
    let number = text.trim().parse::<f64>().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| HitError::Number(what, text.to_owned()))
}

fn force_of(text: &str) -> Result<f64, HitError> {
    number(text, "force of 0 to 10,000 N", [0.0, MOST_N])
}

/// With 0 it would end as it begins.
fn duration_ms(text: &str) -> Result<f64, HitError> {
    number(text, "time above 0 and up to 60,000 ms", [f64::MIN_POSITIVE, LONGEST_MS])
}

impl std::str::FromStr for Hit {
    type Err = HitError;

    fn from_str(text: &str) -> Result<Self, HitError> {
        let [x, y, force, ms] = text.split(',').collect::<Vec<_>>()[..] else {
            return Err(HitError::Parts);
        };
        let place = |text| number(text, "position in mm", [-FARTHEST_MM, FARTHEST_MM]);
        let ms = duration_ms(ms)?;
        Ok(Self { at_mm: [place(x)?, place(y)?], force_n: force_of(force)?, ms })
    }
}

/// How far an accident has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AccidentState {
    /// The tool has not come near, or its time has not come.
    Waiting,
    /// It acts with this many N, until a time in ticks.
    Acting(f64, u64),
    /// It is over.
    Over,
}

impl AccidentState {
    /// Acts from `now` on, for a time or for good.
    pub(super) fn start(&mut self, force_n: f64, ms: Option<f64>, now: u64) {
        if *self == Self::Waiting {
            *self = Self::Acting(force_n, ms.map_or(u64::MAX, |ms| now + ticks(ms)));
        }
    }

    /// When it ends, if it acts.
    pub(super) const fn end(&self) -> Option<u64> {
        match self {
            Self::Acting(_, end) => Some(*end),
            Self::Waiting | Self::Over => None,
        }
    }

    /// Ends if it acts no longer than to `now`, and returns whether it did.
    pub(super) fn end_at(&mut self, now: u64) -> bool {
        let ends = self.end().is_some_and(|end| end <= now);
        if ends {
            *self = Self::Over;
        }
        ends
    }

    /// The N with which it acts.
    pub(super) const fn force_n(&self) -> f64 {
        match self {
            Self::Acting(force, _) => *force,
            Self::Waiting | Self::Over => 0.0,
        }
    }

    /// Begins if the tool is there and on its way.
    pub(super) fn begin(&mut self, hit: &Hit, now: u64, tool_mm: [f64; 2], [vx, vy]: [f64; 2]) {
        let away = hypot(tool_mm[0] - hit.at_mm[0], tool_mm[1] - hit.at_mm[1]);
        if *self == Self::Waiting && away <= NEAR_MM && hypot(vx, vy) > ON_ITS_WAY_MM_S {
            *self = Self::Acting(hit.force_n, now + ticks(hit.ms));
        }
    }
}

/// Milliseconds in ticks.
fn ticks(ms: f64) -> u64 {
    (ms * f64::from(TICKS_PER_MS)).round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_are_read_or_named() {
        assert_eq!("100,85.5,200,30".parse(), Ok(Hit { at_mm: [100.0, 85.5], force_n: 200.0, ms: 30.0 }));
        let hit = |text: &str| text.parse::<Hit>().unwrap_err().to_string();
        assert_eq!(hit("1,2,3"), "expected X,Y,N,MS");
        assert_eq!(hit("1,nan,3,4"), "`nan` is not a position in mm");
        assert_eq!(hit("1,2,-3,4"), "`-3` is not a force of 0 to 10,000 N");
        assert_eq!(hit("1,2,3,inf"), "`inf` is not a time above 0 and up to 60,000 ms");
    }

    #[test]
    fn a_hit_acts_once_and_for_its_time() {
        let hit = Hit { at_mm: [10.0, 0.0], force_n: 50.0, ms: 2.0 };
        let mut state = AccidentState::Waiting;
        state.begin(&hit, 0, [8.9, 0.0], [100.0, 0.0]);
        state.begin(&hit, 0, [9.5, 0.0], [0.5, 0.0]);
        assert_eq!(state, AccidentState::Waiting);
        state.begin(&hit, 100, [9.1, 0.0], [30.0, 40.0]);
        assert_eq!((state.force_n(), state.end()), (50.0, Some(20_100)));
        assert!(!state.end_at(20_099));
        assert_eq!(state.end(), Some(20_100));
        assert!(state.end_at(20_100) && !state.end_at(20_100));
        state.begin(&hit, 30_000, [10.0, 0.0], [100.0, 0.0]);
        assert_eq!((state, state.force_n()), (AccidentState::Over, 0.0));
    }
}
