//! Self-test: each heater must warm its own sensor, and no other.
//!
//! ```text
//!  power  __####______________    a pulse for 3 C by the heater's model, of at most 30 s
//!  own    ____..--''''''''''''    judged two lags after the pulse: by 1 C at least ...
//!  other  ____________________    ... and twice as much as any other sensor has risen
//! ```
//!
//! The model only gives a careful first pulse: a heater that is heavier than its model gets a second pulse, twice as
//! long, and a third. Seven times the first pulse warms a block or a bed of twenty times its model's mass by 1 C.
//!
//! Heaters are tested one after the other, from the slowest to the quickest, so that heat on its way to a sensor is
//! small compared to the next rise. The test begins with everything cold and no heat under way, and targets wait until
//! it is over. All guards stay on.
//!
//! A heater that was warm cools meanwhile, perhaps faster than its pulse warms it. Heat comes late, so its reading
//! falls at first. Such a test proves nothing, and is put off.

use super::fixed_point::RATE;
use super::guard::Alarm;
use crate::connectors::{HEATERS, Heater};
use crate::fault::Cause;
use crate::settings::{HeaterSettings, ThermalSettings, sum};
use crate::units::Celsius;

/// The intended rise of a pulse: thirty times the noise of a reading, and harmless.
const RISE: i64 = 3;

/// Required rise of its own sensor: ten times the noise of a reading.
const LEAST: Celsius = Celsius::ONE;

/// A reading that falls this far below its begin shows a heater that cools: five times the noise of a reading.
const COOLS: Celsius = Celsius::from_bits(LEAST.to_bits() / 2);

/// Pulses of a heater, each twice as long as the one before.
const PULSES: u32 = 3;

/// The longest first pulse, in periods: 30 s.
const LONGEST: i64 = 30 * RATE as i64;

/// From this temperature on a block loses too much heat to be tested: Marlin's fan of a hotend runs from here on
/// (EXTRUDER_AUTO_FAN_TEMPERATURE, Configuration_adv.h, 2.1).
const COLD: Celsius = Celsius::const_from_int(50);

/// From the slowest to the quickest.
const ORDER: [Heater; HEATERS] = [Heater::Bed, Heater::Chamber, Heater::Hotend];

/// The subject of a test as one number: the image that heats, and the output and sensor of each heater.
#[must_use]
pub fn subject(settings: &ThermalSettings, image: u32) -> u32 {
    let heaters = Heater::ALL.map(|heater| {
        let HeaterSettings { is_fitted, output, sensor, thermistor, .. } = *settings.heater(heater);
        is_fitted.then_some((output, sensor, thermistor))
    });
    sum(&(image, heaters))
}

/// The reading of each heater's sensor; `None` where no heater is fitted.
pub type Readings = [Option<Celsius>; HEATERS];

/// Result of a test.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum End {
    /// Each heater warms its own sensor.
    Passed,
    /// A sensor did not follow, or another one did.
    Failed(Heater, Alarm),
    /// Something is hot, cools or has no reading: there is no result now.
    PutOff,
}

/// The heater that is being tested.
#[derive(Clone, Copy, Debug)]
struct Pulse {
    place: usize,
    before: Readings,
    /// The lowest reading of its own sensor since then.
    lowest: Celsius,
    /// Pulses of this heater so far, with this one.
    number: u32,
    /// Periods since the begin of the pulse, with power, and until the rise is judged.
    elapsed: u32,
    power: u32,
    judged: u32,
}

/// A running test.
#[derive(Clone, Copy, Debug)]
pub struct SelfTest {
    pulse: Pulse,
    /// The targets of the heaters after the test.
    held: [Celsius; HEATERS],
}

impl SelfTest {
    /// A test, if everything is cold and a heater is fitted; heaters get `held` as targets afterwards.
    #[must_use]
    pub fn new(settings: [&HeaterSettings; HEATERS], readings: &Readings, held: [Celsius; HEATERS]) -> Option<Self> {
        pulse(0, settings, readings).map(|pulse| Self { pulse, held })
    }

    /// A target that came during the test.
    pub const fn hold(&mut self, heater: Heater, target: Celsius) {
        self.held[heater as usize] = target;
    }

    /// The targets of the heaters after the test.
    #[must_use]
    pub const fn held(&self) -> [Celsius; HEATERS] {
        self.held
    }

    /// The heater that has power in the coming period.
    #[must_use]
    pub fn powered(&self) -> Option<Heater> {
        ORDER.get(self.pulse.place).copied().filter(|_| self.pulse.elapsed < self.pulse.power)
    }

    /// One control period; returns the result if the test has ended.
    pub fn period(&mut self, settings: [&HeaterSettings; HEATERS], readings: &Readings) -> Option<End> {
        self.pulse.elapsed += 1;
        let own = ORDER.get(self.pulse.place).copied()?;
        // Kept over all pulses of a heater: a fall before the second one still says that it cools.
        self.pulse.lowest = readings[own as usize].map_or(self.pulse.lowest, |reading| reading.min(self.pulse.lowest));
        if self.pulse.elapsed < self.pulse.judged {
            return None;
        }
        let rise = |heater: Heater| {
            let (now, before) = (readings[heater as usize]?, self.pulse.before[heater as usize]?);
            Some(now.saturating_sub(before))
        };
        let Some(value) = rise(own) else { return Some(End::PutOff) };
        let others = Heater::ALL.into_iter().filter(|heater| *heater != own).filter_map(rise);
        let limit = others.map(|rise| rise.saturating_mul_int(2)).fold(LEAST, Celsius::max);
        if value < limit {
            let fell = self.pulse.before[own as usize].map(|before| before.saturating_sub(self.pulse.lowest));
            if fell.is_some_and(|fell| fell >= COOLS) {
                return Some(End::PutOff);
            }
            // While no other sensor has risen either, it may be heavy.
            if limit < LEAST * 2 && self.pulse.number < PULSES {
                self.pulse.again();
                return None;
            }
            return Some(End::Failed(own, Alarm { cause: Cause::SelfTest, value, limit }));
        }
        let next = self.pulse.place + 1;
        if (next..HEATERS).all(|place| !settings[ORDER[place] as usize].is_fitted) {
            return Some(End::Passed);
        }
        let Some(pulse) = pulse(next, settings, readings) else { return Some(End::PutOff) };
        self.pulse = pulse;
        None
    }
}

impl Pulse {
    /// Another pulse, twice as long.
    const fn again(&mut self) {
        (self.number, self.elapsed) = (self.number + 1, 0);
        (self.power, self.judged) = (2 * self.power, self.judged + self.power);
    }
}

/// The pulse of the next fitted heater; `None` if there is no such heater, or not everything is cold.
fn pulse(from: usize, settings: [&HeaterSettings; HEATERS], readings: &Readings) -> Option<Pulse> {
    let is_cold = |heater: Heater| {
        !settings[heater as usize].is_fitted || readings[heater as usize].is_some_and(|reading| reading < COLD)
    };
    let place = (from..HEATERS).find(|place| settings[ORDER[*place] as usize].is_fitted)?;
    if !Heater::ALL.into_iter().all(is_cold) {
        return None;
    }
    let settings = settings[ORDER[place] as usize];
    // W: power and duty have 16 fractional bits each. Whole numbers do for a careful first pulse.
    let power = ((u64::from(settings.power.to_bits()) * u64::from(settings.max_duty.to_bits())) >> 32) as i64;
    let rate = i64::from(RATE);
    let capacity = settings.model.capacity.to_num::<i64>().max(1);
    let periods = (RISE * capacity * rate / power.max(1)).clamp(1, LONGEST);
    // One more second for the fractions that are cut off.
    let lags = settings.model.heater_lag.saturating_add(settings.model.sensor_lag).to_num::<u32>() + 1;
    let periods = periods as u32;
    Some(Pulse {
        place,
        before: *readings,
        lowest: readings[ORDER[place] as usize]?,
        number: 1,
        elapsed: 0,
        power: periods,
        judged: periods + 2 * lags * RATE.unsigned_abs(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Ratio, Watts};

    /// The result of a test of hotend and bed: rises of both sensors by the bed's pulse, and by the hotend's.
    fn ends(by_bed: [i32; 2], by_hotend: [i32; 2]) -> End {
        let mut thermal = ThermalSettings::prototype();
        (thermal.heaters.hotend.is_fitted, thermal.heaters.bed.is_fitted) = (true, true);
        let settings = Heater::ALL.map(|heater| thermal.heater(heater));
        let mut readings = [Some(Celsius::const_from_int(25)), Some(Celsius::const_from_int(25)), None];
        let mut test = SelfTest::new(settings, &readings, [Celsius::ZERO; HEATERS]).unwrap();
        for (heater, rises) in [(Heater::Bed, by_bed), (Heater::Hotend, by_hotend)] {
            assert_eq!(test.powered(), Some(heater));
            for (reading, rise) in readings.iter_mut().flatten().zip(rises) {
                *reading += Celsius::from_num(rise);
            }
            while test.pulse.place == ORDER.iter().position(|other| *other == heater).unwrap() {
                if let Some(end) = test.period(settings, &readings) {
                    return end;
                }
            }
        }
        panic!("it has no end")
    }

    /// Reproducer: power and duty beyond their ranges, which only failing memory can have, overflowed.
    #[test]
    fn any_power_and_duty_have_a_pulse() {
        let mut thermal = ThermalSettings::prototype();
        let hotend = &mut thermal.heaters.hotend;
        (hotend.is_fitted, hotend.power, hotend.max_duty) = (true, Watts::MAX, Ratio::MAX);
        let settings = Heater::ALL.map(|heater| thermal.heater(heater));
        let readings = [Some(Celsius::const_from_int(25)), None, None];
        let test = SelfTest::new(settings, &readings, [Celsius::ZERO; HEATERS]).unwrap();
        assert_eq!((test.powered(), test.pulse.power), (Some(Heater::Hotend), 1));
    }

    #[test]
    fn the_own_sensor_must_rise_and_twice_as_much_as_any_other() {
        let failed = |heater, value: i32, limit: i32| {
            let [value, limit] = [value, limit].map(Celsius::from_num);
            End::Failed(heater, Alarm { cause: Cause::SelfTest, value, limit })
        };
        assert_eq!(ends([0, 3], [3, 0]), End::Passed);
        assert_eq!(ends([1, 2], [2, 1]), End::Passed);
        assert_eq!(ends([2, 3], [3, 0]), failed(Heater::Bed, 3, 4));
        assert_eq!(ends([0, 3], [3, 2]), failed(Heater::Hotend, 3, 4));
        assert!(matches!(ends([0, 0], [3, 0]), End::Failed(Heater::Bed, _)));
        assert!(matches!(ends([0, 3], [0, 0]), End::Failed(Heater::Hotend, _)));
        assert_eq!(ends([30, 3], [3, 0]), failed(Heater::Bed, 3, 60));
        assert_eq!(ends([0, 30], [3, 0]), End::PutOff, "the bed is hot now");
    }

    /// Reproducer: a chamber that cooled faster than its pulses warmed it failed its test.
    #[test]
    fn a_heater_that_cools_is_put_off_if_it_does_not_rise() {
        assert_eq!(ends([0, -2], [3, 0]), End::PutOff);
        assert_eq!(ends([-1, 3], [-1, 3]), End::PutOff, "a swapped one is found when all is cold");
        assert_eq!(ends([-3, 3], [3, -3]), End::Passed, "others may cool");
    }
}
