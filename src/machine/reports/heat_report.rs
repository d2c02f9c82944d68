//! Reports of heat: temperatures (M105, M155, waits), heaters and the fault (M122).

use super::fan_report::report_fans;
use super::sensors::{Extra, ExtraReadings, extra_readings, report_extra, report_sensors, what_is_wrong};
use crate::connectors::{HEATERS, Heater};
use crate::fault::Cause;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::words::Facts;
use crate::machine::numbers::Hundredths;
use crate::status::{HeatFigures, SelfTest};
use crate::thermal::sensor::Reading;
use crate::thermal::{hidden, refusal};
use crate::units::Celsius;
use core::fmt;
use fixed::types::U8F8;

/// The letters of heaters in reports.
const LETTERS: [char; HEATERS] = ['T', 'B', 'C'];

/// Measured or why not, target, and duty of 127.
type Heated = (Result<Celsius, Reading>, Celsius, u16);

/// The temperatures of the heaters and sensors that are fitted, as M105 has them. Without heaters hosts take the form
/// of the line as a sign of life.
pub(in crate::machine) struct Temperatures {
    heaters: [Option<Heated>; HEATERS],
    extra: ExtraReadings,
}

impl Temperatures {
    /// The latest readings, with the ordered targets.
    pub fn of(facts: &Facts<'_>) -> Self {
        let (thermal, heat) = (&facts.settings.thermal, facts.status.heat());
        Self {
            extra: extra_readings(facts.settings, heat),
            heaters: Heater::ALL.map(|heater| {
                let measured = heat.measured(heater).ok_or_else(|| match heat.ailment(heater) {
                    Some(Cause::SensorOpen) => Reading::Open,
                    Some(Cause::SensorShort) => Reading::Short,
                    _ => Reading::Silent,
                });
                let is_fitted = thermal.heater(heater).is_fitted;
                is_fitted.then(|| {
                    let target = facts.targets[heater as usize];
                    // Its order to go off, or the end of a self-test, is on its way.
                    let is_test_over = !facts.is_testing && heat.self_test() == SelfTest::Testing;
                    let is_going_off = target <= Celsius::ZERO && (is_test_over || heat.target(heater) > Celsius::ZERO);
                    (measured, target, if is_going_off { 0 } else { heat.duty(heater) >> 9 })
                })
            }),
        }
    }
}

impl fmt::Display for Temperatures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.heaters == [None; HEATERS] {
            put!(f, "T:0.00 /0.00 B:0.00 /0.00")?;
            return put!(f, "{} @:0 B@:0", Extra(&self.extra));
        }
        let mut gap = "";
        for (letter, (measured, target, _)) in LETTERS.into_iter().zip(self.heaters).filter_map(|(l, h)| Some((l, h?)))
        {
            write!(f, "{gap}{letter}:")?;
            match measured {
                Ok(measured) => write!(f, "{}", Hundredths::of(measured))?,
                Err(broken) => f.write_str(what_is_wrong(broken))?,
            }
            write!(f, " /{}", Hundredths::of(target))?;
            gap = " ";
        }
        write!(f, "{}", Extra(&self.extra))?;
        for (letter, (.., duty)) in ["", "B", "C"].into_iter().zip(self.heaters).filter_map(|(l, h)| Some((l, h?))) {
            write!(f, " {letter}@:{duty}")?;
        }
        Ok(())
    }
}

/// M105, with the `ok`.
pub(in crate::machine) fn report_temperatures(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    let temperatures = Temperatures::of(facts);
    to.say(text!("ok {temperatures}"));
}

/// A ratio with 8 fractional bits, with two decimals.
pub(in crate::machine) struct Ratio8(pub u16);

impl fmt::Display for Ratio8 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Hundredths::of(U8F8::from_bits(self.0)))
    }
}

/// What a heater takes and moves, and the temperature that its block has if its sensor reads low.
pub(in crate::machine) struct LowReading {
    pub name: &'static str,
    pub figures: HeatFigures,
    pub measured: Celsius,
}

impl fmt::Display for LowReading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, figures, measured } = self;
        let (power, less) = (Ratio8(figures.power), Ratio8(figures.less));
        let than = if figures.has_baseline { "when it was healthy" } else { "by its model" };
        put!(f, "{name} takes {power} times its power and moves {less} times less than {than}")?;
        if figures.low() > ROUND {
            let block = hidden(*measured, figures.low()).to_num::<i32>();
            put!(f, ": about {block} C if its sensor sits loosely")?;
        }
        Ok(())
    }
}

/// Below this ratio a sensor reads right: 1.1.
const ROUND: u16 = 282;

/// What a heater that held a target has shown of its heat, once that is known.
fn report_figures(to: &mut ReplyWriter<'_>, name: &'static str, figures: HeatFigures, measured: Option<Celsius>) {
    if figures.are_known() {
        let shown = LowReading { name, figures, measured: measured.unwrap_or_default() };
        to.say(text!("echo:heater {shown}"));
    }
}

/// Part of M122: the fault, the heaters, the sensors.
pub(in crate::machine) fn report_heat(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    let (settings, heat, fault_latch) = (facts.settings, facts.status.heat(), facts.status.fault());
    let thermal = &settings.thermal;
    match fault_latch.fault() {
        Some(fault) => to.say(text!("echo:fault: {fault}; {} more since", fault_latch.more())),
        None => to.say(text!("echo:fault: none")),
    }
    for (heater, target) in Heater::ALL.into_iter().zip(facts.targets).filter(|(h, _)| thermal.heater(*h).is_fitted) {
        let name = heater.name();
        let (target, duty) = (Hundredths::of(target), u32::from(heat.duty(heater)) * 100 / 65_535);
        match heat.measured(heater) {
            Some(measured) => {
                let measured = Hundredths::of(measured);
                to.say(text!("echo:heater {name} {measured} C, target {target} C, duty {duty} %"));
            }
            None => to.say(text!("echo:heater {name} has no reading, target {target} C, duty {duty} %")),
        }
        report_figures(to, name, heat.figures(heater), heat.measured(heater));
        if let Some(fault) = refusal(heat, heater, thermal) {
            to.say(text!("echo:heating is refused, {fault}"));
        }
    }
    report_extra(to, &extra_readings(settings, heat));
    report_fans(to, settings, heat);
    report_sensors(to, heat);
}
