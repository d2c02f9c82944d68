//! Tests of the commands: what their words become.

extern crate std;

use super::*;
use crate::gcode::number::Number;
use crate::gcode::parse::parse;
use crate::gcode::parts::{AxisFlags, ParkWords, PlainWords};
use crate::settings::plain::MOST_WORDS;

/// The command of a code with numbers for its first settings.
fn plain<const N: usize>(code: u16, first: [Option<Number>; N]) -> Command<'static> {
    let mut numbers = [None; MOST_WORDS];
    numbers[..N].copy_from_slice(&first);
    Command::Setting(SettingCommand::Plain(PlainWords { code, numbers }))
}

#[test]
fn a_t_word_is_not_a_tool_change() {
    let five_hundred = Some(Number::from(500));
    let expected = plain(204, [five_hundred, None, five_hundred]);
    assert_eq!(parse(b"M204 P500 T500"), expected);
    assert_eq!(parse(b"M204 S500"), expected);
}

#[test]
fn releasing_motors_or_setting_their_timeout() {
    assert_eq!(parse(b"M84 S0"), Command::Motor(MotorCommand::IdleTimeout { seconds: 0 }));
    assert_eq!(parse(b"M18 S120.7"), Command::Motor(MotorCommand::IdleTimeout { seconds: 120 }));
    assert_eq!(parse(b"M84"), Command::Motor(MotorCommand::DisableMotors(AxisFlags::default())));
    let expected = Command::Motor(MotorCommand::DisableMotors(AxisFlags { x: true, y: true, z: false, e: true }));
    assert_eq!(parse(b"M84 X Y E ;disable"), expected);
}

#[test]
fn feed_override_in_its_three_forms() {
    assert_eq!(parse(b"M220 S80"), Command::Motion(MotionCommand::FeedPercent(Some(Number::from(80)))));
    assert_eq!(parse(b"M220"), Command::Motion(MotionCommand::FeedPercent(None)));
    assert_eq!(parse(b"M220 B"), Command::Motion(MotionCommand::BackUpFeedPercent));
    assert_eq!(parse(b"M220 R"), Command::Motion(MotionCommand::RestoreFeedPercent));
}

#[test]
fn drivers() {
    let axes = AxisFlags { x: true, y: true, z: false, e: false };
    assert_eq!(parse(b"M569 S1 X Y"), Command::Motor(MotorCommand::Stealth { on: Some(true), axes }));
    assert_eq!(parse(b"M569"), Command::Motor(MotorCommand::Stealth { on: None, axes: AxisFlags::default() }));
    assert_eq!(parse(b"M569 P0 S0"), Command::Unknown(b"M569 P0 S0"));
    assert_eq!(parse(b"M122"), Command::Report(ReportCommand::Diagnose));
}

#[test]
fn the_belt_is_aligned_and_looked_at() {
    let align = |diagnoses, repairs| Command::Motor(MotorCommand::AlignBelt { diagnoses, repairs });
    assert_eq!(parse(b"M915"), align(false, false));
    assert_eq!(parse(b"M915 D"), align(true, false));
    assert_eq!(parse(b"M915 R"), align(false, true));
    // Of another firmware, or two things at once.
    for line in ["M915 D R", "M915 R1", "M915 D0", "M915 X S3", "M915 R F0", "M915 H200 T1"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()), "{line}");
    }
}

#[test]
fn what_cannot_be_done_has_a_name() {
    for line in ["M622 J1", "M623", "if {x > 1}", "while true", "  ELSE", "break", "{if layer}"] {
        assert_eq!(parse(line.as_bytes()), Command::Refused(RefusedCommand::Conditional), "{line}");
    }
    for line in ["iffy", "elsewhere X", "O100 sub", "whilefoo"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()), "{line}");
    }
}

#[test]
fn keeping_settings() {
    assert_eq!(parse(b"M500"), Command::Setting(SettingCommand::SaveSettings));
    assert_eq!(parse(b"M501 ; as stored"), Command::Setting(SettingCommand::LoadSettings));
    assert_eq!(parse(b"M502"), Command::Setting(SettingCommand::DefaultSettings));
    assert_eq!(parse(b"M504"), Command::Setting(SettingCommand::CheckStorage));
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
fn an_answer_to_a_question_is_known() {
    assert_eq!(parse(b"M876 S0"), Command::Job(JobCommand::Answer));
}

#[test]
fn quiet_commands_swallow_any_text() {
    for line in ["M74 W5", "M486 ACube (1)*", "M862.3 P \"MK4S\"", "M300", "M20"] {
        assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
    }
    assert_eq!(parse(b"M117 E5 * ; x"), Command::Report(ReportCommand::Message));
    assert_eq!(parse(b"M115 U6.2.6+8948"), Command::Report(ReportCommand::ReportFirmware));
}

#[test]
fn every_code_has_its_command() {
    let one = Some(Number::from(1));
    let no_flags = AxisFlags::default();
    for (line, command) in [
        ("M17", Command::Motor(MotorCommand::EnableMotors(no_flags))),
        ("M24", Command::Job(JobCommand::Resume)),
        ("M602", Command::Job(JobCommand::Resume)),
        ("M25", Command::Job(JobCommand::Pause { parks: false, park: ParkWords::default() })),
        ("M290", Command::Motion(MotionCommand::Babystep { by: None, is_kept: true })),
        ("M290 S1 P0", Command::Motion(MotionCommand::Babystep { by: one, is_kept: false })),
        ("M290 Z1 S2 P1", Command::Motion(MotionCommand::Babystep { by: one, is_kept: true })),
        ("M290 Z1 R", Command::Motion(MotionCommand::Babystep { by: None, is_kept: true })),
        ("M290 Z1 Y1", Command::Motion(MotionCommand::NoOffset("M290", b"Y"))),
        ("M851 Z1", plain(851, [None, None, one])),
        ("M82", Command::Motion(MotionCommand::AbsoluteExtrusion)),
        ("M83", Command::Motion(MotionCommand::RelativeExtrusion)),
        ("M92", plain(92, [])),
        ("M105", Command::Report(ReportCommand::Temperatures)),
        ("M108", Command::Job(JobCommand::Continue)),
        ("M110 N5", Command::Report(ReportCommand::LineNumber)),
        ("M112", Command::Job(JobCommand::EmergencyStop)),
        ("M113 S1", plain(113, [one])),
        ("M119", Command::Report(ReportCommand::ReportEndstops)),
        ("M201", plain(201, [])),
        ("M203 X1 Z1", plain(203, [one, None, one])),
        ("M410", Command::Motion(MotionCommand::QuickStop)),
        ("M503", Command::Setting(SettingCommand::ReportSettings { for_replay: false })),
        ("M503 S", Command::Setting(SettingCommand::ReportSettings { for_replay: false })),
        ("M503 S1", Command::Setting(SettingCommand::ReportSettings { for_replay: false })),
        ("M503 S0", Command::Setting(SettingCommand::ReportSettings { for_replay: true })),
        ("M999", Command::Job(JobCommand::Restart)),
    ] {
        assert_eq!(parse(line.as_bytes()), command, "{line}");
    }
}

#[test]
fn letters_that_only_one_code_knows() {
    let [one, two, three, four] = [1, 2, 3, 4].map(|n| Some(Number::from(n)));
    assert_eq!(parse(b"M204 P1 R2 T3 S4"), plain(204, [one, two, three]));
    // E, S, T and Z of rows; X, Y, J and B of the rule.
    let expected = plain(205, [None, two, three, None, None, four, one, four]);
    assert_eq!(parse(b"M205 J1 S2 T3 B4 Y4"), expected);
    for (line, code) in [("M301 D3 P1", 301), ("M304 D3 P1", 304)] {
        assert_eq!(parse(line.as_bytes()), plain(code, [one, None, three]));
    }
}

#[test]
fn a_subcode_makes_it_another_command() {
    for line in ["M104.1 S200", "M204.1 P500", "M17.2", "M74.1"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()));
    }
}
