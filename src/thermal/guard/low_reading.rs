//! A sensor that reads low: its heater takes more power than it did, and its reading moves less.
//!
//! A sensor that shows a part s of the rise makes both 1 / s. A draught only takes power, and a wrong capacity only
//! moves less. So the lesser of both counts, over the heater's own [`Baseline`]:
//!
//! | law | | for | then |
//! |---|---|---|---|
//! | R | the lesser, certain | 60 s above 1.6 | stop |
//! | F | the lesser, with the quick answer | 30 s above 1.7; 1.8 without | stop |
//! | D | the power above 1.95, and the quick answer above 1.25 | 30 s, with a baseline | stop |
//! | | R of a hotend above 1.35, of a bed above 1.4 | 300 s | the user is told |
//!
//! Only a hotend stops: a cold plate takes as much of a bed as a sensor that comes off. A heater with the model of
//! another one, which was never tuned, stops only after its baseline was learned. If the bed has the same R, the supply
//! is weak: R then stops only a block that would be above 300 C.

use super::baseline::Baseline;
use super::dither::Dither;
use super::heat_balance::Numbers;
use super::heat_sums::HeatSums;
use super::held_power::HeldPower;
use super::response::{BITS, FINER, Ratio8, Response};
use super::{Alarm, Episode, Seen};
use crate::fault::Cause;
use crate::status::HeatFigures;
use crate::thermal::fixed_point::rise;
use crate::thermal::room::ROOM;
use crate::units::{Celsius, Power};

/// A cycle counts if the reading stays so near the target.
const NEAR: Celsius = Celsius::const_from_int(5);

/// The thresholds, without and with a baseline. Healthy machines of two plants reached 1.47, 1.62, 1.78 with one in 628
/// hours, and 1.34, a bed 1.35, for five minutes. In 630 more hours one reached 1.58.
const R: Ratio8 = 410;
const F: [Ratio8; 2] = [461, 435];
const D: [Ratio8; 2] = [499, 320];
const TELLS: [Ratio8; 2] = [346, 358];

/// Looks for which they must hold, of a hotend: one more than the cycles in 60 and 30 s. For messages of a hotend and a
/// bed: in five minutes.
const R_LOOKS: u8 = 5;
const QUICK_LOOKS: u8 = 3;
const TELL_LOOKS: [u8; 2] = [20, 5];

/// Looks in an hour.
const HOUR: [u8; 2] = [225, 37];

/// Both heaters lack the same power if their R differ by a tenth at most.
const ALIKE: Ratio8 = 10;

/// And if each of them is so great.
const TOGETHER: Ratio8 = 307;

/// No weak supply excuses a block above this.
const HOT: Celsius = Celsius::const_from_int(300);

/// The guard of a heater that holds a target.
#[derive(Clone, Copy, Debug)]
pub struct LowReading {
    dither: Dither,
    hold: Episode<Celsius, Hold>,
    baseline: Baseline,
    figures: HeatFigures,
}

/// What was seen of this hold.
#[derive(Clone, Copy, Debug)]
struct Hold {
    power: HeldPower,
    response: Response,
    /// Nothing has disturbed the cycle so far.
    is_quiet: bool,
    /// Looks for which each law has held: R, F, D, the message.
    held: [u8; 4],
}

/// What the guard knows of its heater.
#[derive(Clone, Copy, Debug)]
pub struct Subject {
    /// Its heat shows within seconds: it is a hotend.
    pub is_quick: bool,
    /// Its model is its own.
    pub is_tuned: bool,
    /// The R of the other heater; 0 is not known.
    pub other: Ratio8,
}

impl Default for LowReading {
    fn default() -> Self {
        Self::new()
    }
}

impl LowReading {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { dither: Dither::new(), hold: Episode::none(), baseline: Baseline::new(), figures: HeatFigures::NONE }
    }

    /// The same heater without a reading: what was learned of it counts on.
    pub const fn end(&mut self) {
        *self = Self { baseline: self.baseline, ..Self::new() };
    }

    /// Its baseline, as it was stored; zeros begin to learn it.
    pub const fn know(&mut self, known: [Ratio8; 2]) {
        self.baseline = Baseline::stored(known);
        self.figures.learned = [0; 2];
    }

    /// The dither of its heater.
    pub const fn dither(&mut self) -> &mut Dither {
        &mut self.dither
    }

    /// The power that the dither gave last, and the answer that the reading has of it.
    #[must_use]
    pub const fn told(&self) -> (Power, Celsius) {
        self.dither.told()
    }

    /// What was found.
    #[must_use]
    pub const fn figures(&self) -> HeatFigures {
        self.figures
    }

    /// Follows a control period: the heater, the target that it holds, the readings, and both sums of heat.
    pub fn look(
        &mut self,
        n: &Numbers,
        subject: Subject,
        target: Option<Celsius>,
        seen: &Seen,
        sums: &HeatSums,
    ) -> Option<Alarm> {
        let is_quick = subject.is_quick;
        let begin = || Hold { power: HeldPower::new(), response: Response::new(), is_quiet: false, held: [0; 4] };
        let (Some(hold), Some(target)) = (self.hold.follow(target, begin), target) else {
            self.dither.begin();
            self.dither.follow(n, is_quick);
            self.figures = HeatFigures { learned: self.figures.learned, ..HeatFigures::NONE };
            return None;
        };
        let phase = self.dither.follow(n, is_quick);
        let off = seen.smooth.saturating_sub(target).saturating_abs();
        hold.is_quiet &= off < NEAR && !seen.rests;
        hold.response.follow(sums, phase);
        hold.power.follow(sums);
        if !phase.is_last {
            return None;
        }
        let is_quiet = core::mem::replace(&mut hold.is_quiet, true);
        hold.power.end(is_quiet);
        hold.response.end(is_quiet && phase.is_dithered, is_quick);
        if !is_quiet {
            return None;
        }
        let cycle = i64::from(HeatSums::memory(is_quick)) * i64::from(Dither::cycle(is_quick));
        let full = i64::from(rise(n.most, n.warming).to_bits() >> FINER) * cycle;
        let power = hold.power.more(i32::try_from(full).unwrap_or(i32::MAX)).unwrap_or_default();
        let [less, quick] = hold.response.less().map(Option::unwrap_or_default);
        let place = usize::from(!is_quick);
        if power > 0 && less > 0 {
            self.baseline.learn([power, less], HOUR[place]);
        }
        let is_known = self.baseline.is_known();
        let [power, less, quick] = self.baseline.compare([power, less, quick]);
        let low = power.min(less);
        self.figures = HeatFigures {
            power,
            less,
            has_baseline: is_known,
            is_low: hold.holds(3, low > TELLS[place], TELL_LOOKS[place]),
            learned: self.baseline.learned(HOUR[place]).unwrap_or_default(),
        };
        let block = |ratio: Ratio8| hidden(seen.smooth, ratio);
        let is_alike = is_alike(low, subject.other);
        let laws = [
            hold.holds(0, low > R && !(is_alike && block(low) <= HOT), R_LOOKS),
            hold.holds(1, power.min(quick) > F[usize::from(is_known)], QUICK_LOOKS),
            hold.holds(2, is_known && power > D[0] && quick > D[1], QUICK_LOOKS),
        ];
        let may_stop = is_quick && (is_known || subject.is_tuned && !self.figures.is_far_off());
        let limit = seen.measured;
        (may_stop && laws.contains(&true)).then(|| {
            let value = block(power.min(less.max(quick)));
            Alarm { cause: Cause::ReadsLow, value, limit }
        })
    }
}

/// Whether two heaters lack the same power.
#[must_use]
pub fn is_alike(low: Ratio8, other: Ratio8) -> bool {
    other > TOGETHER && low.abs_diff(other) <= low / ALIKE
}

impl Hold {
    /// Whether a law has held for so many looks.
    fn holds(&mut self, law: usize, does: bool, looks: u8) -> bool {
        let held = &mut self.held[law];
        *held = if does { held.saturating_add(1) } else { 0 };
        *held >= looks
    }
}

/// The temperature of a block whose sensor shows its rise so many times too small.
#[must_use]
pub fn hidden(shown: Celsius, ratio: Ratio8) -> Celsius {
    let rise = i64::from(shown.saturating_sub(ROOM).to_bits()) * i64::from(ratio);
    ROOM.saturating_add(Celsius::from_bits(i32::try_from(rise >> BITS).unwrap_or(i32::MAX)))
}
