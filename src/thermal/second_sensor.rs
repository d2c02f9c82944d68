//! The second sensor of a heater: a limit at another place than the one that is controlled.
//!
//! A mat under a thick plate is much hotter than the plate. With one sensor in each, the plate is held at its target,
//! and the mat's sensor takes the power where the mat may not get hotter.
//!
//! | second sensor | heater | |
//! |---|---|---|
//! | above its limit | any | no power, as long as it lasts |
//! | 15 C above it | any, after a reading within | fault, supply off (E29) |
//! | broken, or too cold | on | fault (E30) |
//! | broken, too cold, or too hot from its first reading on | off | it refuses to heat |

use super::guard::{Alarm, Window};
use super::sensor::{Contact, Curve, Filter};
use crate::fault::Cause;
use crate::settings::{ExtraSensor, Thermistor};
use crate::units::Celsius;

/// So far above its limit is a fault: an element's heat on its way is less.
const BEYOND: Celsius = Celsius::const_from_int(15);

/// The state of one.
#[derive(Clone, Copy, Debug)]
pub struct SecondSensor {
    curve: Curve,
    filter: Filter,
    window: Window,
    verdict: Verdict,
}

/// Its verdict on a heater.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Verdict {
    /// Why the heater must not heat.
    pub refused: Option<Cause>,
    /// The heater gets no power for now.
    pub is_hot: bool,
}

impl Verdict {
    /// Both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { refused: self.refused.or(other.refused), is_hot: self.is_hot || other.is_hot }
    }
}

impl SecondSensor {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(kind: Thermistor) -> Self {
        Self { curve: Curve::new(kind), filter: Filter::new(), window: Window::new(), verdict: Verdict::default() }
    }

    /// Its curve, for the sum of the settings.
    pub const fn curve(&self) -> &Curve {
        &self.curve
    }

    /// Follows a control period.
    ///
    /// # Errors
    /// The alarm; the heater must go off.
    pub fn look(&mut self, sample: Option<u16>, extra: &ExtraSensor, is_off: bool) -> Result<Verdict, Alarm> {
        self.verdict.refused = match self.filter.take(self.curve.read(sample)) {
            Contact::Good(measured) => {
                self.verdict.is_hot = measured > extra.most;
                let most = extra.most.saturating_add(BEYOND);
                let seen = self.window.look(most, measured, is_off);
                let of_second = |cause| if cause == Cause::TooHot { Cause::SecondHot } else { Cause::SecondBroken };
                seen.map_err(|alarm| Alarm { cause: of_second(alarm.cause), ..alarm })?.map(of_second)
            }
            // As before.
            Contact::Doubtful => self.verdict.refused,
            Contact::Broken(_) if is_off || !self.window.is_seen() => Some(Cause::SecondBroken),
            Contact::Broken(_) => {
                return Err(Alarm { cause: Cause::SecondBroken, value: Celsius::ZERO, limit: Celsius::ZERO });
            }
        };
        Ok(self.verdict)
    }
}
