//! M-codes: switches, limits, reports. `heat` has the codes of heaters and fans.

use super::axes::{axis_flags, axis_words, take_axis};
use super::code::Code;
use super::command::Command;
use super::heat;
use super::lexer::{Words, last, number};
use super::number::Number;
use super::parts::{AxisFlags, AxisWords, ParkWords};
use super::quiet::is_silent;
use super::shaping::{linear_advance, pressure_advance, shaper};
use super::text::{await_user, change_filament, file_name, object, park_words, tell};
use crate::connectors::Heater;

/// The command of an M-code, or `None` if it is not understood.
pub(super) fn parse_m(code: Code, text: &[u8]) -> Option<Command<'_>> {
    let otherwise = is_silent(code).then_some(Command::Silent);
    if code.letter != b'M' || code.subcode != 0 {
        return otherwise;
    }
    Some(match code.number {
        0 | 1 => await_user(text),
        600 | 601 => change_filament(text, code.number == 600),
        17 => Command::EnableMotors(axis_flags(text)),
        18 | 84 => release_motors(text),
        24 | 602 => Command::Resume,
        25 => Command::Pause { parks: false, park: ParkWords::default() },
        75 => Command::BeginJob,
        77 => Command::EndJob,
        125 => Command::Pause { parks: true, park: park_words(text, b'L') },
        524 => Command::Cancel,
        28 => Command::BeginUpload(file_name(text)),
        29 => Command::EndUpload,
        48 | 290 | 851 => Command::Probing,
        73 => Command::Progress { percent: number(text, b'P'), minutes: number(text, b'R') },
        81 => Command::PowerOff,
        82 => Command::AbsoluteExtrusion,
        83 => Command::RelativeExtrusion,
        92 => Command::StepsPerMm(axis_words(text)),
        104 => heat::target(Heater::Hotend, text),
        105 => Command::ReportTemperatures,
        106 => heat::fan(text, false),
        107 => heat::fan(text, true),
        108 => Command::Continue,
        109 => heat::wait(Heater::Hotend, text),
        110 => Command::LineNumber,
        111 => Command::Debug(number(text, b'S')),
        112 => Command::EmergencyStop,
        113 => Command::Keepalive(number(text, b'S')),
        114 => Command::ReportPosition { real: last(text, b'R').is_some() },
        115 => Command::ReportFirmware,
        116 => Command::AwaitHeaters,
        117 => Command::Message,
        118 => tell(text),
        119 => Command::ReportEndstops,
        122 => Command::Diagnose,
        140 => heat::target(Heater::Bed, text),
        141 => heat::target(Heater::Chamber, text),
        154 => Command::AutoPosition(number(text, b'S')),
        155 => Command::AutoReport(number(text, b'S')),
        190 => heat::wait(Heater::Bed, text),
        191 => heat::wait(Heater::Chamber, text),
        200 if !is_volumetric(text) => Command::Silent,
        201 => Command::MaxAcceleration(axis_words(text)),
        203 => Command::MaxSpeed(axis_words(text)),
        204 => acceleration(text),
        205 => corners(text),
        207 => {
            let [length, feed, lift] = [b'S', b'F', b'Z'].map(|letter| number(text, letter));
            Command::RetractSettings { length, feed, lift }
        }
        208 => Command::RecoverSettings { extra: number(text, b'S'), feed: number(text, b'F') },
        211 => Command::SoftEndstops(switch(text)),
        220 => feed_percent(text),
        221 => Command::FlowPercent(number(text, b'S')),
        301 => heat::pid(Heater::Hotend, text),
        302 => heat::cold_extrusion(text),
        303 => heat::tune(text),
        304 => heat::pid(Heater::Bed, text),
        306 => heat::model(text),
        400 => Command::Finish,
        410 => Command::QuickStop,
        413 => Command::PowerLossRecovery(switch(text)),
        420 => Command::ReportLevelling,
        486 => object(text),
        500 => Command::SaveSettings,
        501 => Command::LoadSettings,
        502 => Command::DefaultSettings,
        503 => Command::ReportSettings { for_replay: switch(text) == Some(false) },
        504 => Command::CheckStorage,
        // With P it is RepRapFirmware's, and turns a motor round.
        569 if last(text, b'P').is_none() => stealth(text),
        572 => pressure_advance(text),
        593 => shaper(text),
        622 | 623 => Command::Conditional,
        710 => heat::controller_fan(text),
        876 => Command::Answer,
        900 => linear_advance(text),
        906 => Command::DriverCurrent(axis_words(text)),
        913 => Command::HybridThreshold(axis_words(text)),
        914 => Command::StallThreshold(axis_words(text)),
        915 => {
            // RepRapFirmware's M915 is another command; it has these words in addition to its axes, and a number at its
            // R.
            let is_foreign = b"PSFHT".iter().any(|letter| last(text, *letter).is_some());
            let [diagnoses, repairs] = [b'D', b'R'].map(|letter| last(text, letter));
            let has_number = [diagnoses, repairs].into_iter().flatten().any(|word| word.number.is_some());
            if is_foreign || has_number || diagnoses.is_some() && repairs.is_some() {
                return otherwise;
            }
            Command::AlignBelt { diagnoses: diagnoses.is_some(), repairs: repairs.is_some() }
        }
        999 => Command::Restart,
        _ => return otherwise,
    })
}

/// S0 is off, any other S is on.
fn switch(text: &[u8]) -> Option<bool> {
    last(text, b'S').map(|word| word.number != Some(Number::ZERO))
}

/// M569; a report is of all axes.
fn stealth(text: &[u8]) -> Command<'static> {
    let on = switch(text);
    Command::Stealth { on, axes: if on.is_some() { axis_flags(text) } else { AxisFlags::default() } }
}

/// M18 and M84: with S a time, otherwise axes.
fn release_motors(text: &[u8]) -> Command<'static> {
    match number(text, b'S') {
        Some(seconds) => Command::IdleTimeout { seconds: seconds.to_u32() },
        None => Command::DisableMotors(axis_flags(text)),
    }
}

/// Whether M200 requests volumetric extrusion, which would print wrongly if it were ignored: a diameter or S1.
/// `M200 D0` and `M200 S0` are how slicers make sure that it is off.
fn is_volumetric(text: &[u8]) -> bool {
    let is_set = |number: Option<Number>| number.is_some_and(|number| number != Number::ZERO);
    match number(text, b'S') {
        Some(switch) => is_set(Some(switch)),
        None => is_set(number(text, b'D')),
    }
}

/// M204; S is the old name for printing and travelling at once.
fn acceleration(text: &[u8]) -> Command<'static> {
    let (mut print, mut retract, mut travel, mut both) = (None, None, None, None);
    for word in Words::new(text) {
        match word.letter {
            b'P' => print = word.number,
            b'R' => retract = word.number,
            b'T' => travel = word.number,
            b'S' => both = word.number,
            _ => {}
        }
    }
    Command::Acceleration { print: print.or(both), retract, travel: travel.or(both) }
}

/// M205.
fn corners(text: &[u8]) -> Command<'static> {
    let mut jerk = AxisWords::default();
    let (mut deviation, mut min_feed, mut min_travel, mut min_segment) = (None, None, None, None);
    for word in Words::new(text) {
        match word.letter {
            b'B' => min_segment = word.number,
            b'J' => deviation = word.number,
            b'S' => min_feed = word.number,
            b'T' => min_travel = word.number,
            _ => take_axis(&mut jerk, word),
        }
    }
    Command::Corners { deviation, jerk, min_feed, min_travel, min_segment }
}

/// M220. B and R stand alone in practice; with either of them S is ignored.
fn feed_percent(text: &[u8]) -> Command<'static> {
    if last(text, b'B').is_some() {
        Command::BackUpFeedPercent
    } else if last(text, b'R').is_some() {
        Command::RestoreFeedPercent
    } else {
        Command::FeedPercent(number(text, b'S'))
    }
}

#[cfg(test)]
mod tests;
