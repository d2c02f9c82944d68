//! Heaters and fans for the Console, and its information on the filament.

use super::heat_figures::{HeatFigures, Place, WITH_FIGURES};
use crate::connectors::{FANS, HEATERS, Heater, SENSORS, Sensor};
use crate::fault::Cause;
use crate::units::Celsius;
use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, AtomicU16, AtomicU32, Ordering::Relaxed};

/// Progress of a tuning (M303).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Tuning {
    /// There is none.
    None,
    /// It was too hot, and cools first.
    Cooling,
    /// It runs; the number of finished cycles.
    Cycle(u8),
    /// It is done, and the results can be read.
    Done,
    /// It is done, but with the part fan the heater does not reach the target: the loss to the fan is unknown.
    DoneWithoutFan,
    /// It failed.
    Failed(TuningFailure),
}

/// Why a tuning failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum TuningFailure {
    /// It does not cool to the temperature at which it can begin.
    StaysHot = 0,
    /// Full power does not bring it to the target.
    OutOfReach = 1,
    /// The temperature did not swing as expected.
    NoSwing = 2,
    /// A heater of this power cannot have the result.
    Impossible = 3,
}

impl TuningFailure {
    /// All of them, by number.
    const ALL: [Self; 4] = [Self::StaysHot, Self::OutOfReach, Self::NoSwing, Self::Impossible];
}

/// Numbers of [`Tuning`] as one word: failures have four, cycles the following ones.
const FIRST_FAILURE: u32 = 4;
const FIRST_CYCLE: u32 = FIRST_FAILURE + TuningFailure::ALL.len() as u32;

/// Progress of a self-test. A failure is a fault.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum SelfTest {
    /// None ran, or it was ended.
    None = 0,
    /// It runs.
    Testing = 1,
    /// Each heater warms its own sensor.
    Passed = 2,
    /// A heater is hot, or its sensor has no reading: there is no result.
    PutOff = 3,
}

/// The result of M303, in the bits of the settings' types.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Tuned {
    /// J/K.
    pub capacity: u32,
    /// W/K.
    pub loss: u32,
    /// W/K in addition with the part fan at full speed; 0 if unknown.
    pub fan_loss: u32,
    /// s, from the heater to the sensor.
    pub lag: u32,
    /// Of PID.
    pub p: u32,
    /// Of PID.
    pub i: u32,
    /// Of PID.
    pub d: u32,
    /// Growth of its resistance, in 1/K.
    pub ptc: u32,
}

/// Temperatures, duties and filament. Written by the thermal context; fields with another writer name it.
pub struct Heat {
    /// One more than the last sample of each sensor; 0 for none.
    samples: [AtomicU32; SENSORS],
    /// Bits of a [`Celsius`], as far above the smallest number as they are; 0 for none. (A status of zeros costs no
    /// flash.)
    measured: [AtomicI32; HEATERS],
    /// The processor's temperature in the same form.
    mcu: AtomicI32,
    targets: [AtomicI32; HEATERS],
    /// Numbers of the causes for which heaters are refused; 0 for none.
    ailments: [AtomicU8; HEATERS],
    /// Whether a wait for them is in vain.
    are_slow: [AtomicBool; HEATERS],
    /// What hotend and bed have shown of their heat.
    figures: [Place; WITH_FIGURES.len()],
    /// Of 65,535.
    duties: [AtomicU16; HEATERS],
    fans: [AtomicU16; FANS],
    /// One more than the pulses of each fan's tachometer in the last window, and [`STILL`]; 0 without one.
    tachometers: [AtomicU32; FANS],
    /// One more than whether filament presses the switch of its sensor; 0 without a sensor.
    filament: AtomicU8,
    /// Control periods since start.
    periods: AtomicU32,
    tuning: AtomicU32,
    tuned: [AtomicU32; 8],
    self_test: AtomicU8,
    /// Filament extruded, in um, wrapping; written by the Console.
    extruded_um: AtomicU32,
    /// Heat per K that the filament will take within the hotend's lag, and at its end, in 2^-24 J/K and W/K; written by
    /// the Console.
    coming: AtomicU32,
    then: AtomicU32,
    /// Whether the bed gets no power for now; written by the Console.
    bed_rests: AtomicBool,
    /// Heartbeats of the Console.
    console_beats: AtomicU8,
    /// Heartbeats of the StepGenerator.
    generator_beats: AtomicU8,
}

/// The bit of a fan that stands still though it is driven.
const STILL: u32 = 1 << 31;

/// A stored temperature.
fn celsius(place: &AtomicI32) -> Option<Celsius> {
    let above_least = place.load(Relaxed);
    (above_least != 0).then(|| Celsius::from_bits(above_least.wrapping_add(i32::MIN)))
}

/// A temperature in its stored form.
fn above_least(measured: Option<Celsius>) -> i32 {
    measured.map_or(0, |celsius| celsius.to_bits().wrapping_sub(i32::MIN))
}

impl Heat {
    pub(super) const fn new() -> Self {
        Self {
            samples: [const { AtomicU32::new(0) }; SENSORS],
            measured: [const { AtomicI32::new(0) }; HEATERS],
            mcu: AtomicI32::new(0),
            targets: [const { AtomicI32::new(0) }; HEATERS],
            ailments: [const { AtomicU8::new(0) }; HEATERS],
            are_slow: [const { AtomicBool::new(false) }; HEATERS],
            figures: [const { Place::new() }; WITH_FIGURES.len()],
            duties: [const { AtomicU16::new(0) }; HEATERS],
            fans: [const { AtomicU16::new(0) }; FANS],
            tachometers: [const { AtomicU32::new(0) }; FANS],
            filament: AtomicU8::new(0),
            periods: AtomicU32::new(0),
            tuning: AtomicU32::new(0),
            tuned: [const { AtomicU32::new(0) }; 8],
            self_test: AtomicU8::new(SelfTest::None as u8),
            extruded_um: AtomicU32::new(0),
            coming: AtomicU32::new(0),
            then: AtomicU32::new(0),
            bed_rests: AtomicBool::new(false),
            console_beats: AtomicU8::new(0),
            generator_beats: AtomicU8::new(0),
        }
    }

    /// Whether the bed gets no power for now.
    pub(crate) fn bed_rests(&self) -> bool {
        self.bed_rests.load(Relaxed)
    }

    pub(crate) fn set_bed_rests(&self, rests: bool) {
        self.bed_rests.store(rests, Relaxed);
    }

    /// The last sample of a sensor, in units of 1/65,536 of the reference.
    #[must_use]
    pub fn sample(&self, sensor: Sensor) -> Option<u16> {
        Some(self.samples[sensor as usize].load(Relaxed).checked_sub(1)? as u16)
    }

    /// The temperature of a heater; `None` without such a heater or a reading.
    #[must_use]
    pub fn measured(&self, heater: Heater) -> Option<Celsius> {
        celsius(&self.measured[heater as usize])
    }

    /// The processor's own temperature; `None` if it is not measured.
    #[must_use]
    pub fn mcu(&self) -> Option<Celsius> {
        celsius(&self.mcu)
    }

    /// Its target; 0 is off.
    #[must_use]
    pub fn target(&self, heater: Heater) -> Celsius {
        Celsius::from_bits(self.targets[heater as usize].load(Relaxed))
    }

    /// Its duty, of 65,535.
    #[must_use]
    pub fn duty(&self, heater: Heater) -> u16 {
        self.duties[heater as usize].load(Relaxed)
    }

    /// Why it must not heat: its sensor is broken. It stays off until the sensor works.
    #[must_use]
    pub fn ailment(&self, heater: Heater) -> Option<Cause> {
        Cause::of(self.ailments[heater as usize].load(Relaxed))
    }

    /// Whether it warms so slowly at full power that a wait for it is in vain.
    #[must_use]
    pub fn is_slow(&self, heater: Heater) -> bool {
        self.are_slow[heater as usize].load(Relaxed)
    }

    /// What it has shown of its heat; a chamber shows nothing.
    #[must_use]
    pub fn figures(&self, heater: Heater) -> HeatFigures {
        self.figures.get(heater as usize).map_or(HeatFigures::NONE, Place::load)
    }

    /// Whether any heater has one.
    pub(crate) fn has_ailment(&self) -> bool {
        self.ailments.iter().any(|ailment| ailment.load(Relaxed) != 0)
    }

    /// A fan's duty, of 65,535.
    #[must_use]
    pub fn fan(&self, fan: usize) -> u16 {
        self.fans.get(fan).map_or(0, |duty| duty.load(Relaxed))
    }

    /// The pulses of a fan's tachometer in the last window of 2 s; `None` without a tachometer.
    #[must_use]
    pub fn tachometer(&self, fan: usize) -> Option<u16> {
        Some((self.tachometers.get(fan)?.load(Relaxed) & !STILL).checked_sub(1)? as u16)
    }

    /// Fans that stand still though they are driven, a bit each.
    #[must_use]
    pub fn still_fans(&self) -> u8 {
        let fans = self.tachometers.iter().rev();
        fans.fold(0, |bits, fan| bits << 1 | u8::from(fan.load(Relaxed) & STILL != 0))
    }

    /// Whether filament presses the switch of its sensor; `None` without a sensor.
    #[must_use]
    pub fn filament(&self) -> Option<bool> {
        self.filament.load(Relaxed).checked_sub(1).map(|is_there| is_there > 0)
    }

    /// Control periods of 20 ms since start.
    #[must_use]
    pub fn periods(&self) -> u32 {
        self.periods.load(Relaxed)
    }

    /// The progress of a tuning.
    #[must_use]
    pub fn tuning(&self) -> Tuning {
        match self.tuning.load(Relaxed) {
            0 => Tuning::None,
            1 => Tuning::Done,
            2 => Tuning::Cooling,
            3 => Tuning::DoneWithoutFan,
            number => match TuningFailure::ALL.get((number - FIRST_FAILURE) as usize) {
                Some(failure) => Tuning::Failed(*failure),
                None => Tuning::Cycle((number - FIRST_CYCLE) as u8),
            },
        }
    }

    /// The progress of a self-test.
    #[must_use]
    pub fn self_test(&self) -> SelfTest {
        match self.self_test.load(Relaxed) {
            1 => SelfTest::Testing,
            2 => SelfTest::Passed,
            3 => SelfTest::PutOff,
            _ => SelfTest::None,
        }
    }

    /// The result of a tuning.
    #[must_use]
    pub fn tuned(&self) -> Tuned {
        let [capacity, loss, fan_loss, lag, p, i, d, ptc] = self.tuned.each_ref().map(|word| word.load(Relaxed));
        Tuned { capacity, loss, fan_loss, lag, p, i, d, ptc }
    }

    pub(crate) fn set_sample(&self, sensor: Sensor, sample: Option<u16>) {
        self.samples[sensor as usize].store(sample.map_or(0, |sample| u32::from(sample) + 1), Relaxed);
    }

    pub(crate) fn set_mcu(&self, measured: Option<Celsius>) {
        self.mcu.store(above_least(measured), Relaxed);
    }

    pub(crate) fn set_heater(&self, heater: Heater, measured: Option<Celsius>, target: Celsius, duty: u16) {
        self.measured[heater as usize].store(above_least(measured), Relaxed);
        self.targets[heater as usize].store(target.to_bits(), Relaxed);
        self.duties[heater as usize].store(duty, Relaxed);
    }

    pub(crate) fn set_ailment(&self, heater: Heater, ailment: Option<Cause>) {
        self.ailments[heater as usize].store(ailment.map_or(0, |cause| cause as u8), Relaxed);
    }

    pub(crate) fn set_slow(&self, heater: Heater, is_slow: bool) {
        self.are_slow[heater as usize].store(is_slow, Relaxed);
    }

    pub(crate) fn set_figures(&self, heater: Heater, figures: HeatFigures) {
        if let Some(place) = self.figures.get(heater as usize) {
            place.store(figures);
        }
    }

    pub(crate) fn set_fan(&self, fan: usize, duty: u16) {
        if let Some(place) = self.fans.get(fan) {
            place.store(duty, Relaxed);
        }
    }

    pub(crate) fn set_tachometer(&self, fan: usize, pulses: u16, is_still: bool) {
        if let Some(place) = self.tachometers.get(fan) {
            place.store((u32::from(pulses) + 1) | if is_still { STILL } else { 0 }, Relaxed);
        }
    }

    pub(crate) fn set_filament(&self, is_there: Option<bool>) {
        self.filament.store(is_there.map_or(0, |is_there| 1 + u8::from(is_there)), Relaxed);
    }

    pub(crate) fn count_period(&self) {
        self.periods.store(self.periods().wrapping_add(1), Relaxed);
    }

    pub(crate) fn set_tuning(&self, tuning: Tuning) {
        let number = match tuning {
            Tuning::None => 0,
            Tuning::Done => 1,
            Tuning::Cooling => 2,
            Tuning::DoneWithoutFan => 3,
            Tuning::Failed(failure) => FIRST_FAILURE + failure as u32,
            Tuning::Cycle(cycles) => FIRST_CYCLE + u32::from(cycles),
        };
        self.tuning.store(number, Relaxed);
    }

    pub(crate) fn set_self_test(&self, state: SelfTest) {
        self.self_test.store(state as u8, Relaxed);
    }

    pub(crate) fn set_tuned(&self, tuned: &Tuned) {
        let Tuned { capacity, loss, fan_loss, lag, p, i, d, ptc } = *tuned;
        for (place, bits) in self.tuned.iter().zip([capacity, loss, fan_loss, lag, p, i, d, ptc]) {
            place.store(bits, Relaxed);
        }
    }

    /// Filament extruded, in um, wrapping.
    pub(crate) fn extruded_um(&self) -> u32 {
        self.extruded_um.load(Relaxed)
    }

    /// Sets the extruded filament; the Console calls it.
    pub fn set_extruded_um(&self, um: u32) {
        self.extruded_um.store(um, Relaxed);
    }

    /// Heat per K that the filament will take within the hotend's lag, in 2^-24 J/K, and at its end, in 2^-24 W/K.
    pub(crate) fn filament_ahead(&self) -> [u32; 2] {
        [self.coming.load(Relaxed), self.then.load(Relaxed)]
    }

    /// Sets the heat that the filament will take; the Console calls it.
    pub fn set_filament_ahead(&self, [coming, then]: [u32; 2]) {
        self.coming.store(coming, Relaxed);
        self.then.store(then, Relaxed);
    }

    /// Heartbeats of Console and StepGenerator, wrapping.
    pub(crate) fn beats(&self) -> [u8; 2] {
        [self.console_beats.load(Relaxed), self.generator_beats.load(Relaxed)]
    }

    /// A heartbeat of the Console.
    pub fn beat_of_console(&self) {
        self.console_beats.store(self.console_beats.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// A heartbeat of the StepGenerator.
    pub fn beat_of_generator(&self) {
        self.generator_beats.store(self.generator_beats.load(Relaxed).wrapping_add(1), Relaxed);
    }
}
