//! M-codes: switches, limits, reports.

use super::code::Code;
use super::command::{AxisFlags, AxisWords, Command};
use super::lexer::{Word, Words};
use super::number::Number;
use super::parse::{axis_flags, axis_words, take_axis};
use super::quiet::{is_heater, is_silent};
use super::shaping::{linear_advance, pressure_advance, shaper};
use super::text::{await_user, object, tell};

/// The command of an M-code, or `None` if it is not understood.
pub(super) fn parse_m(code: Code, text: &[u8]) -> Option<Command<'_>> {
    if is_silent(code) {
        return Some(Command::Silent);
    }
    if is_heater(code) {
        return Some(Command::Heater);
    }
    if code.letter != b'M' || code.subcode != 0 {
        return None;
    }
    Some(match code.number {
        0 | 1 | 600 | 601 => await_user(text, code.number == 600),
        17 => Command::EnableMotors(axis_flags(text)),
        18 | 84 => release_motors(text),
        24 | 602 => Command::Resume,
        25 => Command::Pause,
        48 | 290 | 851 => Command::Probing,
        73 => Command::Progress { percent: number(text, b'P'), minutes: number(text, b'R') },
        81 => Command::PowerOff,
        82 => Command::AbsoluteExtrusion,
        83 => Command::RelativeExtrusion,
        92 => Command::StepsPerMm(axis_words(text)),
        105 => Command::ReportTemperatures,
        108 => Command::Continue,
        110 => Command::LineNumber,
        111 => Command::Debug(number(text, b'S')),
        112 => Command::EmergencyStop,
        113 => Command::Keepalive(number(text, b'S')),
        114 => Command::ReportPosition { real: last(text, b'R').is_some() },
        115 => Command::ReportFirmware,
        117 => Command::Message,
        118 => tell(text),
        119 => Command::ReportEndstops,
        122 => Command::Diagnose,
        154 => Command::AutoPosition(number(text, b'S')),
        155 => Command::AutoReport(number(text, b'S')),
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
        301 | 303 | 304 => Command::HeaterTuning,
        302 => Command::ColdExtrusion { forbid: forbids_cold(text) },
        400 => Command::Finish,
        410 => Command::QuickStop,
        413 => Command::PowerLossRecovery(switch(text)),
        420 => Command::ReportLevelling,
        486 => object(text),
        500 => Command::SaveSettings,
        501 => Command::LoadSettings,
        502 => Command::DefaultSettings,
        503 => Command::ReportSettings,
        504 => Command::CheckStorage,
        // With P it is RepRapFirmware's, and turns a motor round.
        569 if last(text, b'P').is_none() => stealth(text),
        572 => pressure_advance(text),
        593 => shaper(text),
        622 | 623 => Command::Conditional,
        876 => Command::Answer,
        900 => linear_advance(text),
        906 => Command::DriverCurrent(axis_words(text)),
        913 => Command::HybridThreshold(axis_words(text)),
        914 => Command::StallThreshold(axis_words(text)),
        999 => Command::Restart,
        _ => return None,
    })
}

/// The last word of that letter.
fn last(text: &[u8], letter: u8) -> Option<Word<'_>> {
    Words::new(text).filter(|word| word.letter == letter).last()
}

/// The number of the last word of that letter.
fn number(text: &[u8], letter: u8) -> Option<Number> {
    last(text, letter)?.number
}

/// S0 is off, any other S is on.
fn switch(text: &[u8]) -> Option<bool> {
    last(text, b'S').map(|word| word.number != Some(Number::ZERO))
}

/// Whether M302 forbids to extrude below a temperature: S above 0, or P0.
fn forbids_cold(text: &[u8]) -> bool {
    number(text, b'S').is_some_and(|least| least > Number::ZERO) || number(text, b'P') == Some(Number::ZERO)
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

/// Whether M200 asks for volumetric extrusion, which would print wrongly if it were ignored: a diameter
/// or S1. `M200 D0` and `M200 S0` are how slicers make sure that it is off.
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

/// M220. B and R stand alone in practice; beside them S is ignored.
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
mod tests {
    extern crate std;

    use super::super::parse::parse;
    use super::*;

    #[test]
    fn a_t_word_is_not_a_tool_change() {
        let five_hundred = Some(Number::from(500));
        let expected = Command::Acceleration { print: five_hundred, retract: None, travel: five_hundred };
        assert_eq!(parse(b"M204 P500 T500"), expected);
        assert_eq!(parse(b"M204 S500"), expected);
        assert_eq!(parse(b"M104 T0 S200"), Command::Heater);
    }

    #[test]
    fn releasing_motors_or_setting_their_timeout() {
        assert_eq!(parse(b"M84 S0"), Command::IdleTimeout { seconds: 0 });
        assert_eq!(parse(b"M18 S120.7"), Command::IdleTimeout { seconds: 120 });
        assert_eq!(parse(b"M84"), Command::DisableMotors(AxisFlags::default()));
        let expected = Command::DisableMotors(AxisFlags { x: true, y: true, z: false, e: true });
        assert_eq!(parse(b"M84 X Y E ;disable"), expected);
    }

    #[test]
    fn feed_override_in_its_three_forms() {
        assert_eq!(parse(b"M220 S80"), Command::FeedPercent(Some(Number::from(80))));
        assert_eq!(parse(b"M220"), Command::FeedPercent(None));
        assert_eq!(parse(b"M220 B"), Command::BackUpFeedPercent);
        assert_eq!(parse(b"M220 R"), Command::RestoreFeedPercent);
    }

    #[test]
    fn switches_and_flags() {
        assert_eq!(parse(b"M211"), Command::SoftEndstops(None));
        assert_eq!(parse(b"M211 S0"), Command::SoftEndstops(Some(false)));
        assert_eq!(parse(b"M211 S"), Command::SoftEndstops(Some(true)));
        assert_eq!(parse(b"M114 R"), Command::ReportPosition { real: true });
        assert_eq!(parse(b"M114 D"), Command::ReportPosition { real: false });
    }

    #[test]
    fn drivers() {
        let axes = AxisFlags { x: true, y: true, z: false, e: false };
        assert_eq!(parse(b"M569 S1 X Y"), Command::Stealth { on: Some(true), axes });
        assert_eq!(parse(b"M569"), Command::Stealth { on: None, axes: AxisFlags::default() });
        assert_eq!(parse(b"M569 P0 S0"), Command::Unknown(b"M569 P0 S0"));
        let words = AxisWords { x: Some(Number::from(900)), ..AxisWords::default() };
        assert_eq!(parse(b"M906 X900"), Command::DriverCurrent(words));
        assert_eq!(parse(b"M122"), Command::Diagnose);
    }

    #[test]
    fn what_cannot_be_done_has_a_name() {
        assert_eq!(parse(b"M303 E0 S200"), Command::HeaterTuning);
        assert_eq!(parse(b"M81"), Command::PowerOff);
        assert_eq!(parse(b"M413 S1"), Command::PowerLossRecovery(Some(true)));
        assert_eq!(parse(b"M413"), Command::PowerLossRecovery(None));
        for (line, forbid) in
            [("M302", false), ("M302 S0", false), ("M302 P1", false), ("M302 P0", true), ("M302 S170", true)]
        {
            assert_eq!(parse(line.as_bytes()), Command::ColdExtrusion { forbid }, "{line}");
        }
        for line in ["M622 J1", "M623", "if {x > 1}", "while true", "  ELSE", "break", "{if layer}"] {
            assert_eq!(parse(line.as_bytes()), Command::Conditional, "{line}");
        }
        for line in ["iffy", "elsewhere X", "O100 sub", "whilefoo"] {
            assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()), "{line}");
        }
    }

    #[test]
    fn keeping_settings() {
        assert_eq!(parse(b"M500"), Command::SaveSettings);
        assert_eq!(parse(b"M501 ; as stored"), Command::LoadSettings);
        assert_eq!(parse(b"M502"), Command::DefaultSettings);
        assert_eq!(parse(b"M504"), Command::CheckStorage);
        assert_eq!(parse(b"M500.1"), Command::Unknown(b"M500.1"));
    }

    #[test]
    fn volumetric_extrusion_is_only_ever_switched_off() {
        for line in ["M200 D0", "M200 S0 D1.75", "M200"] {
            assert_eq!(parse(line.as_bytes()), Command::Silent);
        }
        for line in ["M200 D1.75", "M200 S1"] {
            assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()));
        }
    }

    #[test]
    fn progress_and_reports_by_themselves() {
        let (five, twelve) = (Some(Number::from(5)), Some(Number::from(12)));
        assert_eq!(parse(b"M73 P5 R12"), Command::Progress { percent: five, minutes: twelve });
        assert_eq!(parse(b"M73 Q7 S3"), Command::Progress { percent: None, minutes: None });
        assert_eq!(parse(b"M154 S5"), Command::AutoPosition(five));
        assert_eq!(parse(b"M155 S5"), Command::AutoReport(five));
        assert_eq!(parse(b"M876 S0"), Command::Answer);
    }

    #[test]
    fn quiet_commands_swallow_any_text() {
        for line in ["M74 W5", "M486 ACube (1)*", "M862.3 P \"MK4S\"", "M300", "M20"] {
            assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
        }
        assert_eq!(parse(b"M117 E5 * ; x"), Command::Message);
        assert_eq!(parse(b"M115 U6.2.6+8948"), Command::ReportFirmware);
        assert_eq!(parse(b"M109 S205;"), Command::Heater);
    }
}
