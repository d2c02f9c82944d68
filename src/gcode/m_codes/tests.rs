//! Tests of m_codes.

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
