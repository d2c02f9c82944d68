//! Printing: a command as the shortest G-code that reads back as the same command.

use core::fmt::{self, Display, Formatter, Write};

use super::command::{ArcShape, AxisFlags, AxisWords, Command, Flaw, Form, Plane, VelocityWords};
use super::number::Number;

/// Commands that stand for a whole family are printed as one of it: M107 for heaters and fans, M74 for
/// silent ones. A line that is not in order is printed as one with the same flaw. A text is printed with `?` for what is neither printable ASCII nor a tab.
impl Display for Command<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Line { rapid, to, feed } => {
                f.write_str(if rapid { "G0" } else { "G1" })?;
                axes(f, to)?;
                word(f, 'F', feed)
            }
            Self::Arc { clockwise, to, feed, shape, turns } => {
                f.write_str(if clockwise { "G2" } else { "G3" })?;
                axes(f, to)?;
                arc(f, shape)?;
                if turns > 1 {
                    write!(f, " P{turns}")?;
                }
                word(f, 'F', feed)
            }
            Self::Dwell { ms } => write!(f, "G4 P{ms}"),
            Self::Retract => f.write_str("G10"),
            Self::Recover => f.write_str("G11"),
            Self::RetractSettings { length, feed, lift } => {
                f.write_str("M207")?;
                word(f, 'S', length)?;
                word(f, 'F', feed)?;
                word(f, 'Z', lift)
            }
            Self::RecoverSettings { extra, feed } => {
                f.write_str("M208")?;
                word(f, 'S', extra)?;
                word(f, 'F', feed)
            }
            Self::Plane(Plane::Xy) => f.write_str("G17"),
            Self::Plane(Plane::Zx) => f.write_str("G18"),
            Self::Plane(Plane::Yz) => f.write_str("G19"),
            Self::Inches => f.write_str("G20"),
            Self::Millimetres => f.write_str("G21"),
            Self::Home(named) => flags(f, "G28", named),
            Self::Absolute => f.write_str("G90"),
            Self::Relative => f.write_str("G91"),
            Self::SetPosition(to) => axis_line(f, "G92", to),
            Self::EnableMotors(named) => flags(f, "M17", named),
            Self::DisableMotors(named) => flags(f, "M84", named),
            Self::IdleTimeout { seconds } => write!(f, "M84 S{seconds}"),
            Self::AbsoluteExtrusion => f.write_str("M82"),
            Self::RelativeExtrusion => f.write_str("M83"),
            Self::StepsPerMm(words) => axis_line(f, "M92", words),
            Self::ReportTemperatures => f.write_str("M105"),
            Self::Continue => f.write_str("M108"),
            Self::LineNumber => f.write_str("M110"),
            Self::EmergencyStop => f.write_str("M112"),
            Self::Keepalive(seconds) => switch(f, "M113", seconds),
            Self::ReportPosition { real } => f.write_str(if real { "M114 R" } else { "M114" }),
            Self::ReportFirmware => f.write_str("M115"),
            Self::Message => f.write_str("M117"),
            Self::ReportEndstops => f.write_str("M119"),
            Self::Diagnose => f.write_str("M122"),
            Self::AutoReport(seconds) => switch(f, "M155", seconds),
            Self::MaxAcceleration(words) => axis_line(f, "M201", words),
            Self::MaxSpeed(words) => axis_line(f, "M203", words),
            Self::Acceleration { print, retract, travel } => {
                f.write_str("M204")?;
                word(f, 'P', print)?;
                word(f, 'R', retract)?;
                word(f, 'T', travel)
            }
            Self::Corners { deviation, jerk, min_feed, min_travel, min_segment } => {
                axis_line(f, "M205", jerk)?;
                word(f, 'J', deviation)?;
                word(f, 'S', min_feed)?;
                word(f, 'T', min_travel)?;
                word(f, 'B', min_segment)
            }
            Self::SoftEndstops(on) => switch(f, "M211", on.map(|on| Number::from(i32::from(on)))),
            Self::FeedPercent(percent) => switch(f, "M220", percent),
            Self::BackUpFeedPercent => f.write_str("M220 B"),
            Self::RestoreFeedPercent => f.write_str("M220 R"),
            Self::FlowPercent(percent) => switch(f, "M221", percent),
            Self::Finish => f.write_str("M400"),
            Self::QuickStop => f.write_str("M410"),
            Self::SaveSettings => f.write_str("M500"),
            Self::LoadSettings => f.write_str("M501"),
            Self::DefaultSettings => f.write_str("M502"),
            Self::ReportSettings => f.write_str("M503"),
            Self::CheckStorage => f.write_str("M504"),
            Self::Stealth { on: None, .. } => f.write_str("M569"),
            Self::Stealth { on: Some(on), axes } => flags(f, if on { "M569 S1" } else { "M569 S0" }, axes),
            Self::DriverCurrent(words) => axis_line(f, "M906", words),
            Self::HybridThreshold(words) => axis_line(f, "M913", words),
            Self::StallThreshold(words) => axis_line(f, "M914", words),
            Self::Shaper { axes, frequency, damping, kind } => {
                flags(f, "M593", axes)?;
                word(f, 'F', frequency)?;
                word(f, 'D', damping)?;
                word(f, 'T', kind)
            }
            Self::Advance { time, window } => {
                f.write_str("M572")?;
                word(f, 'S', time)?;
                word(f, 'W', window)
            }
            Self::VelocityLimit(limit) => velocity_limit(f, limit),
            Self::Tool(tool) => write!(f, "T{tool}"),
            Self::Heater => f.write_str("M107"),
            Self::HeaterTuning => f.write_str("M303"),
            Self::ColdExtrusion { forbid } => f.write_str(if forbid { "M302 P0" } else { "M302" }),
            Self::PowerOff => f.write_str("M81"),
            Self::PowerLossRecovery(on) => switch(f, "M413", on.map(|on| Number::from(i32::from(on)))),
            Self::Conditional => f.write_str("M622"),
            Self::Restart => f.write_str("M999"),
            Self::Malformed(flaw) => malformed(f, flaw),
            Self::Silent => f.write_str("M74"),
            Self::AwaitUser { filament: true, .. } => f.write_str("M600"),
            Self::AwaitUser { ms: 0, .. } => f.write_str("M0"),
            Self::AwaitUser { ms, .. } => write!(f, "M0 P{ms}"),
            Self::Pause => f.write_str("M25"),
            Self::Resume => f.write_str("M24"),
            Self::Answer => f.write_str("M876"),
            Self::Progress { percent, minutes } => {
                f.write_str("M73")?;
                word(f, 'P', percent)?;
                word(f, 'R', minutes)
            }
            Self::Debug(bits) => switch(f, "M111", bits),
            Self::AutoPosition(seconds) => switch(f, "M154", seconds),
            Self::Tell { form, text } => {
                f.write_str(match form {
                    Form::Plain => "M118 P0 ",
                    Form::Echo => "M118 E1 ",
                    Form::Action => "M118 A1 ",
                })?;
                write_text(f, text)
            }
            Self::ReportLevelling => f.write_str("M420"),
            Self::Object(number) => write!(f, "M486 S{number}"),
            Self::CancelObject => f.write_str("M486 C"),
            Self::Probing => f.write_str("G29"),
            Self::Unknown(text) => write_text(f, text),
        }
    }
}

/// A text, with `?` for what is neither printable ASCII nor a tab.
fn write_text(f: &mut Formatter<'_>, text: &[u8]) -> fmt::Result {
    text.iter().try_for_each(|&byte| {
        f.write_char(match byte {
            b' '..=b'~' => byte as char,
            b'\t' => ' ',
            _ => '?',
        })
    })
}

/// A line with that flaw.
fn malformed(f: &mut Formatter<'_>, flaw: Flaw<'_>) -> fmt::Result {
    match flaw {
        Flaw::NoWord(text) | Flaw::SecondCommand(text) => {
            f.write_str("G1 ")?;
            write_text(f, text)
        }
        Flaw::OutOfRange(text) => {
            f.write_str(if matches!(text, [b'f' | b'F', ..]) { "M593 " } else { "G4 " })?;
            write_text(f, text)
        }
        Flaw::NoPair(_) => f.write_str("SET_VELOCITY_LIMIT ACCEL="),
        Flaw::NoNumber(letter) => {
            f.write_str(match letter {
                b'S' | b'T' | b'B' => "M205 ",
                b'D' => "M593 ",
                b'W' => "M572 ",
                _ => "G2 ",
            })?;
            f.write_char(letter as char)
        }
        Flaw::NoAxis(letter) => write!(f, "G1 {}0", letter as char),
    }
}

/// SET_VELOCITY_LIMIT with its words.
fn velocity_limit(f: &mut Formatter<'_>, limit: VelocityWords<'_>) -> fmt::Result {
    f.write_str("SET_VELOCITY_LIMIT")?;
    for (name, number) in [
        ("ACCEL", limit.acceleration),
        ("ACCEL_TO_DECEL", limit.to_deceleration),
        ("MINIMUM_CRUISE_RATIO", limit.cruise_ratio),
        ("SQUARE_CORNER_VELOCITY", limit.square_corner),
    ] {
        if let Some(number) = number {
            write!(f, " {name}={number}")?;
        }
    }
    if let Some(name) = limit.other {
        f.write_str(" ")?;
        write_text(f, name)?;
        f.write_str("=0")?;
    }
    Ok(())
}

/// One word, if it has a value.
fn word(f: &mut Formatter<'_>, letter: char, number: Option<Number>) -> fmt::Result {
    match number {
        Some(number) => write!(f, " {letter}{number}"),
        None => Ok(()),
    }
}

/// The axis words.
fn axes(f: &mut Formatter<'_>, words: AxisWords) -> fmt::Result {
    word(f, 'X', words.x)?;
    word(f, 'Y', words.y)?;
    word(f, 'Z', words.z)?;
    word(f, 'E', words.e)
}

/// A command of axis words alone.
fn axis_line(f: &mut Formatter<'_>, code: &str, words: AxisWords) -> fmt::Result {
    f.write_str(code)?;
    axes(f, words)
}

/// A command with an S word or nothing.
fn switch(f: &mut Formatter<'_>, code: &str, value: Option<Number>) -> fmt::Result {
    f.write_str(code)?;
    word(f, 'S', value)
}

/// A command of axis names.
fn flags(f: &mut Formatter<'_>, code: &str, named: AxisFlags) -> fmt::Result {
    f.write_str(code)?;
    for (is_named, name) in [(named.x, " X"), (named.y, " Y"), (named.z, " Z"), (named.e, " E")] {
        if is_named {
            f.write_str(name)?;
        }
    }
    Ok(())
}

/// The centre or radius of an arc.
fn arc(f: &mut Formatter<'_>, shape: ArcShape) -> fmt::Result {
    match shape {
        ArcShape::Centre { i, j, k } => {
            write!(f, " I{i} J{j}")?;
            word(f, 'K', Some(k).filter(|k| *k != Number::ZERO))
        }
        ArcShape::Radius(radius) => write!(f, " R{radius}"),
        ArcShape::Missing => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::super::parse::parse;
    use std::string::ToString;

    #[test]
    fn the_canonical_form() {
        for (line, canonical) in [
            ("g1x.5y-12.300e-.04f1800", "G1 X0.5 Y-12.3 E-0.04 F1800"),
            ("G3 Z.76 I.194 J1.201 P1  F30000", "G3 Z0.76 I0.194 J1.201 F30000"),
            ("G28 X0 Y0", "G28 X Y"),
            ("M84 S0", "M84 S0"),
            ("M205 J.02 X8", "M205 X8 J0.02"),
            ("M204 S800", "M204 P800 T800"),
            ("M211 S3", "M211 S1"),
            ("M900 K1e-05", "M572 S0.00001"),
            ("M593 T2 F60 Y X", "M593 X Y F60 T2"),
            ("say \u{fc}", "say ??"),
        ] {
            assert_eq!(parse(line.as_bytes()).to_string(), canonical);
        }
    }
}
