//! Causes of faults. Each has a fixed number, which is kept over resets and shown as `[E04]`.
//!
//! A new cause gets the next number at the end. The matches below have no wildcard, so the compiler asks for the rest.
//! This is its place in [`Cause::all`], whether only the power supply can end it, its text, its remedy, and the meaning
//! of its numbers. Hosts read the text, so `tests/replies.rs` looks for words that they would misread.

use crate::connectors::Heater;
use crate::text::Packed;
use crate::units::Celsius;
use core::fmt::Write;

/// Why the machine stopped.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Cause {
    /// The sensor reads an open circuit.
    SensorOpen = 1,
    /// The sensor reads a short circuit.
    SensorShort = 2,
    /// The sensor reads colder than allowed; the value is in degrees.
    TooCold = 3,
    /// The sensor reads hotter than allowed.
    TooHot = 4,
    /// The sensor fails for short times, too often.
    SensorFlickers = 5,
    /// The reading does not change after the heater power changed.
    SensorFrozen = 6,
    /// Another heater's sensor follows this heater.
    SensorsSwapped = 7,
    /// It warms more slowly than its model allows; value and limit are degrees in the observed time.
    HeatsTooSlowly = 8,
    /// The temperature was reached and is lost.
    TemperatureLost = 9,
    /// It warms although it is off.
    HeatsWhileOff = 10,
    /// It is far above its target and gets no power.
    Overshoot = 11,
    /// A driven fan does not turn; the subject is its number.
    FanFailed = 12,
    /// The converter's reference reads a wrong value.
    Reference = 13,
    /// The converter delivers nothing.
    ConverterStopped = 14,
    /// Settings in RAM changed without a command.
    SettingsDamaged = 15,
    /// In a self-test the wrong sensor followed, or none; value and limit are the measured and the required rise.
    SelfTest = 16,
    /// A context sends no heartbeat; the subject is its number.
    ContextHangs = 17,
    /// The program panicked; value and limit are addresses of calls that led to it.
    Panic = 18,
    /// The processor refused an instruction or an address; value and limit are CFSR and the program counter.
    HardFault = 19,
    /// The stack ran into its guard.
    StackOverflow = 20,
    /// The crystal's clock failed.
    ClockFailed = 21,
    /// The watchdog's reset, with no other cause known.
    Watchdog = 22,
    /// The supply sagged.
    Supply = 23,
    /// A motor driver failed.
    Driver = 24,
    /// An interrupt came so often that nothing below it ran; the subject is its number in the vector table.
    InterruptStorm = 25,
    /// Cold, it reads otherwise than the other cold heater; the limit is what that one reads. No fault: it refuses to
    /// heat.
    SensorsDiffer = 26,
    /// Heat that goes in shows no longer; value and limit are the rise that was found and the least one, in 3 s.
    HeatMissing = 27,
    /// It is off and cools too slowly; the limit is where it would be without a leak.
    StaysWarm = 28,
    /// The second sensor of a heater reads too hot.
    SecondHot = 29,
    /// The second sensor of a heater is broken.
    SecondBroken = 30,
    /// The target was reached and lost, at full power.
    LostAtFull = 31,
    /// It takes more power and its reading moves less than they did; the value is what its block may have, the limit
    /// the reading.
    ReadsLow = 32,
}

impl Cause {
    /// Every cause.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::successors(Some(Self::SensorOpen), |cause| cause.next())
    }

    /// The cause with the next number. There is no wildcard: a new cause is added here, or [`Self::of`] would not find
    /// it.
    const fn next(self) -> Option<Self> {
        match self {
            Self::SensorOpen => Some(Self::SensorShort),
            Self::SensorShort => Some(Self::TooCold),
            Self::TooCold => Some(Self::TooHot),
            Self::TooHot => Some(Self::SensorFlickers),
            Self::SensorFlickers => Some(Self::SensorFrozen),
            Self::SensorFrozen => Some(Self::SensorsSwapped),
            Self::SensorsSwapped => Some(Self::HeatsTooSlowly),
            Self::HeatsTooSlowly => Some(Self::TemperatureLost),
            Self::TemperatureLost => Some(Self::HeatsWhileOff),
            Self::HeatsWhileOff => Some(Self::Overshoot),
            Self::Overshoot => Some(Self::FanFailed),
            Self::FanFailed => Some(Self::Reference),
            Self::Reference => Some(Self::ConverterStopped),
            Self::ConverterStopped => Some(Self::SettingsDamaged),
            Self::SettingsDamaged => Some(Self::SelfTest),
            Self::SelfTest => Some(Self::ContextHangs),
            Self::ContextHangs => Some(Self::Panic),
            Self::Panic => Some(Self::HardFault),
            Self::HardFault => Some(Self::StackOverflow),
            Self::StackOverflow => Some(Self::ClockFailed),
            Self::ClockFailed => Some(Self::Watchdog),
            Self::Watchdog => Some(Self::Supply),
            Self::Supply => Some(Self::Driver),
            Self::Driver => Some(Self::InterruptStorm),
            Self::InterruptStorm => Some(Self::SensorsDiffer),
            Self::SensorsDiffer => Some(Self::HeatMissing),
            Self::HeatMissing => Some(Self::StaysWarm),
            Self::StaysWarm => Some(Self::SecondHot),
            Self::SecondHot => Some(Self::SecondBroken),
            Self::SecondBroken => Some(Self::LostAtFull),
            Self::LostAtFull => Some(Self::ReadsLow),
            Self::ReadsLow => None,
        }
    }

    /// The cause with this number.
    #[must_use]
    pub fn of(number: u8) -> Option<Self> {
        // The Console asks in every turn, and hardly ever is there one.
        if number == 0 {
            return None;
        }
        Self::all().find(|cause| *cause as u8 == number)
    }

    /// Whether the heater may be on whatever the firmware does, so that only the power supply can end it.
    #[must_use]
    pub const fn is_stuck_on(self) -> bool {
        matches!(self.heat(), Heat::On)
    }

    /// Whether the heater's temperature is no longer known. A switch that sticks would then heat unseen.
    #[must_use]
    pub const fn hides_heat(self) -> bool {
        matches!(self.heat(), Heat::Hidden)
    }

    /// What it tells of a heater's switch.
    const fn heat(self) -> Heat {
        match self {
            Self::TooHot | Self::HeatsWhileOff | Self::Overshoot | Self::StaysWarm | Self::SecondHot => Heat::On,
            Self::SensorOpen
            | Self::SensorShort
            | Self::TooCold
            | Self::SensorFlickers
            | Self::SensorFrozen
            | Self::SensorsSwapped
            | Self::HeatsTooSlowly
            | Self::TemperatureLost
            | Self::LostAtFull
            | Self::HeatMissing
            | Self::ReadsLow
            | Self::Reference
            | Self::ConverterStopped => Heat::Hidden,
            Self::FanFailed
            | Self::SettingsDamaged
            | Self::SelfTest
            | Self::ContextHangs
            | Self::Panic
            | Self::HardFault
            | Self::StackOverflow
            | Self::ClockFailed
            | Self::Watchdog
            | Self::Supply
            | Self::Driver
            | Self::InterruptStorm
            | Self::SensorsDiffer
            | Self::SecondBroken => Heat::Other,
        }
    }

    /// Its message.
    const fn text(self) -> Packed {
        match self {
            Self::SensorOpen => packed!("sensor open or unplugged"),
            Self::SensorShort => packed!("sensor shorted"),
            Self::TooCold => packed!("colder than its sensor may read (MINTEMP)"),
            Self::TooHot => packed!("hotter than it may get (MAXTEMP)"),
            Self::SensorFlickers => packed!("sensor has a loose contact"),
            Self::SensorFrozen => packed!("reading stands still"),
            Self::SensorsSwapped => packed!("another sensor follows this heater: swapped?"),
            Self::HeatsTooSlowly => packed!("heating failed, warms too slowly"),
            Self::TemperatureLost => packed!("thermal runaway, temperature lost"),
            Self::LostAtFull => packed!("thermal runaway, full power does not hold it"),
            Self::HeatsWhileOff => packed!("gets warmer while switched off"),
            Self::Overshoot => packed!("far above its target without power"),
            Self::FanFailed => packed!("fan stands still"),
            Self::Reference => packed!("reference voltage of the converter is wrong"),
            Self::ConverterStopped => packed!("analog converter stopped"),
            Self::SettingsDamaged => packed!("settings in RAM are damaged"),
            Self::SelfTest => packed!("self-test failed, its sensor did not follow it, or another one did"),
            Self::ContextHangs => packed!("a part of the firmware hangs"),
            Self::Panic => packed!("firmware gave up (panic)"),
            Self::HardFault => packed!("processor fault"),
            Self::StackOverflow => packed!("stack overflow"),
            Self::ClockFailed => packed!("crystal failed"),
            Self::Watchdog => packed!("watchdog reset"),
            Self::Supply => packed!("supply voltage fell"),
            Self::Driver => packed!("motor driver"),
            Self::InterruptStorm => packed!("came without end (interrupt storm), masked"),
            Self::SensorsDiffer => packed!("cold, and reads otherwise than the other cold heater"),
            Self::HeatMissing => packed!("its heat shows no longer, sensor or heater loose?"),
            Self::StaysWarm => packed!("stays warm while switched off"),
            Self::SecondHot => packed!("second sensor hotter than it may get"),
            Self::SecondBroken => packed!("second sensor has no valid reading"),
            Self::ReadsLow => packed!("takes more power and moves less than it did, sensor or heater loose?"),
        }
    }

    /// The remedy. A `#` stands for the heater's E in M303 and M306.
    const fn way_out(self) -> Packed {
        match self {
            Self::SensorOpen => packed!("plug its sensor in, or mend the wire"),
            Self::SensorShort => packed!("mend the sensor's wire"),
            Self::TooCold => packed!("warm the room, or set the sensor's kind (thermistor)"),
            Self::TooHot => {
                packed!("unplug the heater if it stays hot; check its switch and the sensor's kind (thermistor)")
            }
            Self::SensorFlickers => packed!("mend the contact of its sensor"),
            Self::SensorFrozen => packed!("check its sensor, then reset"),
            Self::SensorsSwapped => packed!("check which plug is where, and the names in the machine's file"),
            Self::HeatsTooSlowly => {
                packed!("check heater and sensor; if it is heavier than its model, M303 E# U1 finds that")
            }
            Self::TemperatureLost => {
                packed!("check heater, sensor and draught; if all is well, M303 E# U1 finds its model")
            }
            Self::LostAtFull => {
                packed!("lower its target, fan or flow, keep draughts off; check sensor, heater and supply")
            }
            Self::HeatsWhileOff => packed!("unplug the heater, its switch is stuck"),
            Self::Overshoot => {
                packed!("unplug the heater if it gets hotter, its switch is stuck; if not, M303 E# U1 finds its model")
            }
            Self::FanFailed => packed!("free the fan, or plug it in"),
            Self::Reference => packed!("measure the board's 3.3 V; no sensor's wire may touch 24 V"),
            Self::SelfTest => packed!("check which plug is where, set its power (M306 E# P), then SELF_TEST"),
            Self::SensorsDiffer => packed!("set the kind of each sensor (thermistor), or let both get as warm"),
            Self::HeatMissing => {
                packed!("see that sensor and heater sit firmly; if all is well, M303 E# U1 finds its model")
            }
            Self::ReadsLow => {
                packed!("see that sensor and heater sit firmly, and measure the supply; then M303 E# U1")
            }
            Self::StaysWarm => {
                packed!("unplug the heater, its switch leaks; if it is cold then, replace the board's output")
            }
            Self::SecondHot => packed!("see that either sensor sits firmly, and set its limit (most)"),
            Self::SecondBroken => packed!("plug the second sensor in, mend its wire, or set its kind (thermistor)"),
            Self::Supply => packed!("check the power supply and its wires"),
            Self::Driver => packed!("M122 tells which"),
            Self::ConverterStopped | Self::SettingsDamaged | Self::ClockFailed => {
                packed!("reset; if it comes again, replace the board")
            }
            Self::ContextHangs
            | Self::Panic
            | Self::HardFault
            | Self::StackOverflow
            | Self::Watchdog
            | Self::InterruptStorm => packed!("reset, and report it with what M122 says"),
        }
    }

    /// The meaning of its subject's number.
    const fn subject(self) -> Subject {
        match self {
            Self::SensorOpen
            | Self::SensorShort
            | Self::TooCold
            | Self::TooHot
            | Self::SensorFlickers
            | Self::SensorFrozen
            | Self::SensorsSwapped
            | Self::HeatsTooSlowly
            | Self::TemperatureLost
            | Self::LostAtFull
            | Self::HeatsWhileOff
            | Self::Overshoot
            | Self::SelfTest
            | Self::SensorsDiffer
            | Self::HeatMissing
            | Self::StaysWarm
            | Self::SecondHot
            | Self::SecondBroken
            | Self::ReadsLow => Subject::Heater,
            Self::FanFailed => Subject::Fan,
            Self::Reference
            | Self::ConverterStopped
            | Self::SettingsDamaged
            | Self::ContextHangs
            | Self::Panic
            | Self::HardFault
            | Self::StackOverflow
            | Self::ClockFailed
            | Self::Watchdog
            | Self::Supply
            | Self::Driver => Subject::Other,
            Self::InterruptStorm => Subject::Interrupt,
        }
    }

    /// The side of its limit that was left, if its value and limit are degrees.
    const fn limit(self) -> Option<Limit> {
        match self {
            Self::TooHot | Self::HeatsWhileOff | Self::Overshoot | Self::StaysWarm | Self::SecondHot => {
                Some(Limit::AtMost)
            }
            Self::TooCold
            | Self::HeatsTooSlowly
            | Self::TemperatureLost
            | Self::LostAtFull
            | Self::SelfTest
            | Self::HeatMissing => Some(Limit::AtLeast),
            Self::SensorOpen
            | Self::SensorShort
            | Self::SensorFlickers
            | Self::SensorFrozen
            | Self::SensorsSwapped
            | Self::FanFailed
            | Self::Reference
            | Self::ConverterStopped
            | Self::SettingsDamaged
            | Self::ContextHangs
            | Self::Panic
            | Self::HardFault
            | Self::StackOverflow
            | Self::ClockFailed
            | Self::Watchdog
            | Self::Supply
            | Self::Driver
            | Self::InterruptStorm
            | Self::SecondBroken => None,
            Self::SensorsDiffer => Some(Limit::Other),
            Self::ReadsLow => Some(Limit::Reads),
        }
    }
}

/// What a fault tells of a heater's switch.
#[derive(Clone, Copy)]
enum Heat {
    /// It may stick.
    On,
    /// Nothing would show that it sticks.
    Hidden,
    /// Nothing.
    Other,
}

/// A limit in degrees.
#[derive(Clone, Copy)]
enum Limit {
    /// The value had to stay below it.
    AtMost,
    /// The value had to reach it.
    AtLeast,
    /// It is the reading of the other one.
    Other,
    /// It is the reading, and the value is what that hides.
    Reads,
}

impl Limit {
    const fn words(self) -> Packed {
        match self {
            Self::AtMost => packed!("at most"),
            Self::AtLeast => packed!("at least"),
            Self::Other => packed!("the other"),
            Self::Reads => packed!("reads"),
        }
    }
}

/// The meaning of the number of a fault's subject.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Subject {
    /// A heater, shown by name.
    Heater,
    /// A fan.
    Fan,
    /// An interrupt.
    Interrupt,
    /// Something else, or nothing.
    Other,
}

/// A cause with its numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fault {
    /// Why.
    pub cause: Cause,
    /// The number of the heater, fan, context or interrupt.
    pub subject: u8,
    /// The measured value; degrees as in [`Celsius`].
    pub value: i32,
    /// The limit, in the same unit.
    pub limit: i32,
}

impl Fault {
    /// A cause without numbers.
    #[must_use]
    pub const fn plain(cause: Cause) -> Self {
        Self { cause, subject: 0, value: 0, limit: 0 }
    }
}

impl core::fmt::Display for Fault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let subject = self.cause.subject();
        match subject {
            Subject::Heater => {
                let heater = Heater::ALL.get(usize::from(self.subject)).map_or("heater", |heater| heater.name());
                write!(f, "{heater}: ")?;
            }
            Subject::Fan => put!(f, "FAN{}: ", self.subject)?,
            Subject::Interrupt => put!(f, "interrupt {}: ", self.subject)?,
            Subject::Other => {}
        }
        write!(f, "{}", self.cause.text())?;
        if let Some(side) = self.cause.limit() {
            let tenths = |bits: i32| (i64::from(bits) * 10) >> Celsius::FRAC_NBITS;
            let (value, limit) = (tenths(self.value), tenths(self.limit));
            let sign = |tenths: i64| if tenths < 0 { "-" } else { "" };
            let ([a, b], side) = ([value.unsigned_abs(), limit.unsigned_abs()], side.words());
            put!(f, " ({}{}.{} C, {side} {}{}.{} C)", sign(value), a / 10, a % 10, sign(limit), b / 10, b % 10)?;
        } else if subject == Subject::Other && (self.value != 0 || self.limit != 0) {
            write!(f, " ({:#x}, {:#x})", self.value, self.limit)?;
        }
        write!(f, " [E{:02}]: ", self.cause as u8)?;
        // M303 and M306 number heaters 0, -1, -2.
        let number = ["0", "-1", "-2"].get(usize::from(self.subject)).copied().unwrap_or("0");
        write!(Numbered { f, number }, "{}", self.cause.way_out())
    }
}

/// Writes a heater's number in place of each `#`.
struct Numbered<'f, 'b> {
    f: &'f mut core::fmt::Formatter<'b>,
    number: &'static str,
}

impl Write for Numbered<'_, '_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        text.split_inclusive('#').try_for_each(|part| match part.strip_suffix('#') {
            Some(before) => self.f.write_str(before).and_then(|()| self.f.write_str(self.number)),
            None => self.f.write_str(part),
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn every_fault_says_what_to_do() {
        for cause in Cause::all() {
            let told = std::format!("{}", Fault { subject: 1, ..Fault::plain(cause) });
            let (_, way_out) = told.split_once(&std::format!("[E{:02}]: ", cause as u8)).unwrap();
            assert!(way_out.len() > 10 && told.len() < 200 && !told.contains('#'), "{told}");
        }
        let bed = std::format!("{}", Fault { subject: 1, ..Fault::plain(Cause::HeatsTooSlowly) });
        assert!(bed.ends_with("M303 E-1 U1 finds that"), "{bed}");
    }

    #[test]
    fn numbers_have_no_gap_and_lead_back_to_their_cause() {
        for (cause, number) in Cause::all().zip(1..) {
            assert_eq!((cause as u8, Cause::of(number)), (number, Some(cause)));
        }
        let count = Cause::all().count() as u8;
        assert_eq!([Cause::of(0), Cause::of(count + 1)], [None; 2]);
        // Decoders know every variant, so `next` lacks no cause.
        assert_eq!(postcard::from_bytes(&[count - 1]), Ok(Cause::ReadsLow));
        assert!(postcard::from_bytes::<Cause>(&[count]).is_err());
    }
}
