//! Heaters and fans.

use super::Command;
use super::grammar::Grammar;
use super::row::Described;
use super::settings::plain;
use crate::connectors::Heater;
use crate::gcode::index::Part;
use crate::gcode::lexer::{has, number, numbers};
use crate::gcode::number::Number;
use crate::gcode::parts::{ModelWords, TuningWords};

/// Heaters and fans.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum HeatCommand {
    /// M104, M140, M141: set the target of a heater; no effect without S or R.
    HeaterTarget {
        /// Which heater.
        heater: Heater,
        /// S or R, in degrees Celsius.
        target: Option<Number>,
    },
    /// M109, M190, M191: the same, and wait for the target; no effect without S or R.
    HeaterWait {
        /// Which heater.
        heater: Heater,
        /// S or R, in degrees Celsius.
        target: Option<Number>,
        /// Whether to wait while it cools, too (R).
        cools: bool,
    },
    /// M116: wait for all heaters that are on.
    AwaitHeaters,
    /// M105: report temperatures.
    ReportTemperatures,
    /// M106, M107: set the speed of a fan, in its turn among the moves.
    FanSpeed {
        /// P: which fan; 255 for one that no machine has.
        fan: u8,
        /// S, of 255; 0 for M107.
        speed: Number,
    },
    /// M303, M306 T: find out how a heater behaves.
    TuneHeater(TuningWords),
    /// M306: the model of a heater, or report.
    HeaterModel {
        /// E, as for M303.
        heater: Option<Heater>,
        /// Whether there is an E.
        is_named: bool,
        /// Its numbers.
        words: ModelWords,
    },
    /// SELF_TEST: find out whether each heater warms its own sensor.
    SelfTest,
}

pub(super) const ROWS: &[Described] = &[
    Described::m(&[104, 109], |number, text| heat(target(Heater::Hotend, number == 109, text)))
        .grammar(&Grammar::numbers(b"SRT").parts(&[(b'T', Part::Tool), (b'I', Part::Preset)]))
        .does("S R T", "target of the hotend; M109 waits, R waits while it cools too"),
    Described::m(&[140, 190], |number, text| heat(target(Heater::Bed, number == 190, text)))
        .grammar(&Grammar::numbers(b"SR").parts(&[(b'P', Part::Bed), (b'H', Part::Heater), (b'I', Part::Preset)]))
        .does("S R", "the same for the bed"),
    Described::m(&[141, 191], |number, text| heat(target(Heater::Chamber, number == 191, text)))
        .grammar(&Grammar::numbers(b"SR").parts(&[(b'P', Part::Chamber), (b'H', Part::Heater)]))
        .does("S R", "the same for the chamber"),
    Described::m(&[116], |_, _| heat(HeatCommand::AwaitHeaters))
        .grammar(&Grammar::numbers(b"").parts(&[(b'P', Part::Tool)]))
        .does("", "waits for all heaters that are on"),
    Described::m(&[105], |_, _| heat(HeatCommand::ReportTemperatures)).does("", "reports temperatures"),
    Described::m(&[106], |_, text| heat(fan(text, false)))
        .grammar(&Grammar::numbers(b"SP").parts(&[(b'I', Part::Preset)]))
        .does("P S", "fan P: S of 255"),
    Described::m(&[107], |_, text| heat(fan(text, true))).grammar(&Grammar::numbers(b"P")).does("P", "fan P is off"),
    Described::m(&[301], plain)
        .grammar(&Grammar::plain().parts(&[(b'E', Part::Extruder), (b'H', Part::Heater), (b'T', Part::Tool)]))
        .does("P I D", "PID gains of the hotend; or reports"),
    Described::m(&[304], plain)
        .grammar(&Grammar::plain().parts(&[(b'H', Part::Heater), (b'T', Part::Tool)]))
        .does("P I D", "the same for the bed"),
    Described::m(&[303], |_, text| heat(tune(text)))
        .grammar(&Grammar::numbers(b"ECS").parts(&[(b'T', Part::Tool), (b'H', Part::Heater)]))
        .does("E C S U", "finds gains and model by C swings around S; U1 uses them"),
    Described::m(&[306], |_, text| heat(model(text)))
        .grammar(&Grammar::numbers(b"EPCAFRLH"))
        .does("E P C A F R L H", "model of a heater; T tunes; or reports"),
    Described::name(&["SELF_TEST"], |_, _| heat(HeatCommand::SelfTest))
        .does("", "tests that each heater warms its own sensor"),
];

const fn heat(command: HeatCommand) -> Option<Command<'static>> {
    Some(Command::Heat(command))
}

/// M106 without S: full speed.
const FULL_SPEED: i32 = 255;

/// M104, M109 and those of bed and chamber. To set a target R is as good as S; with both it is S, as in Marlin.
fn target(heater: Heater, waits: bool, text: &[u8]) -> HeatCommand {
    let [heats, both] = numbers(text, b"SR");
    let target = heats.or(both);
    if waits {
        HeatCommand::HeaterWait { heater, target, cools: heats.is_none() && both.is_some() }
    } else {
        HeatCommand::HeaterTarget { heater, target }
    }
}

/// M106, and M107 with speed 0.
fn fan(text: &[u8], stops: bool) -> HeatCommand {
    let [fan, speed] = numbers(text, b"PS");
    let fan = fan.map_or(0, |fan| u8::try_from(fan.to_int()).unwrap_or(u8::MAX));
    let speed = if stops { Number::ZERO } else { speed.unwrap_or(Number::from(FULL_SPEED)) };
    HeatCommand::FanSpeed { fan, speed }
}

/// The heater of E.
fn heater(text: &[u8]) -> Option<Heater> {
    match number(text, b'E').map_or(0, Number::to_int) {
        0 => Some(Heater::Hotend),
        -1 => Some(Heater::Bed),
        -2 => Some(Heater::Chamber),
        _ => None,
    }
}

/// M303. U alone is U1.
fn tune(text: &[u8]) -> HeatCommand {
    let [target, cycles, applies] = numbers(text, b"SCU");
    let applies = has(text, b'U') && applies != Some(Number::ZERO);
    HeatCommand::TuneHeater(TuningWords { heater: heater(text), target, cycles, applies })
}

/// M306. With T it tunes and uses the result.
fn model(text: &[u8]) -> HeatCommand {
    let heater = heater(text);
    if has(text, b'T') {
        return HeatCommand::TuneHeater(TuningWords { heater, target: None, cycles: None, applies: true });
    }
    let [power, capacity, loss, fan_loss, responsiveness, heater_lag, filament] = numbers(text, b"PCAFRLH");
    let words = ModelWords { power, capacity, loss, fan_loss, responsiveness, heater_lag, filament };
    HeatCommand::HeaterModel { heater, is_named: has(text, b'E'), words }
}
