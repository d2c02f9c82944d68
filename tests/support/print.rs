//! Printing: a command as the shortest G-code that reads back as the same command.

use core::fmt::{self, Display, Formatter, Write};

use corehbot::connectors::Heater;
use corehbot::gcode::{
    Absent, ArcShape, Audience, AxisFlags, AxisWords, Command, Flaw, Form, MachineRecord, Named, Number, ParkWords,
    Part, Plane, VelocityWords,
};

/// A command to be printed. One that represents a whole family is printed as one of it: M74 for silent ones. A line
/// that is not in order is printed as one with the same flaw. In a text, `?` stands for every byte that is neither
/// printable ASCII nor a tab.
pub struct Printed<'c>(pub Command<'c>);

impl Display for Printed<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0 {
            Command::Line { rapid, to, feed } => {
                f.write_str(if rapid { "G0" } else { "G1" })?;
                axes(f, to)?;
                word(f, 'F', feed)
            }
            Command::Circulate { to, belt, feed } => {
                f.write_str("G1")?;
                axes(f, to)?;
                word(f, 'C', Some(belt))?;
                word(f, 'F', feed)
            }
            Command::Arc { clockwise, to, feed, shape, turns, decimals } => {
                f.write_str(if clockwise { "G2" } else { "G3" })?;
                let (i, j, k, r) = match shape {
                    ArcShape::Centre { i, j, k } => (Some(i), Some(j), Some(k).filter(|k| *k != Number::ZERO), None),
                    ArcShape::Radius(r) => (None, None, None, Some(r)),
                    ArcShape::Missing => (None, None, None, None),
                };
                let all = [('X', to.x), ('Y', to.y), ('Z', to.z), ('I', i), ('J', j), ('K', k), ('R', r)];
                let mut words: Vec<_> = all.into_iter().filter_map(|(l, n)| Some(format!("{l}{}", n?))).collect();
                // One has as many decimals as the line has to show.
                let shown = words.iter().map(|word| decimals_of(word)).max();
                if let Some(last) = words.last_mut().filter(|_| shown < Some(usize::from(decimals))) {
                    *last = padded(last, usize::from(decimals));
                }
                words.iter().try_for_each(|word| write!(f, " {word}"))?;
                word(f, 'E', to.e)?;
                if turns > 1 {
                    write!(f, " P{turns}")?;
                }
                word(f, 'F', feed)
            }
            Command::Dwell { ms } => write!(f, "G4 P{ms}"),
            Command::Retract => f.write_str("G10"),
            Command::Recover => f.write_str("G11"),
            Command::RetractSettings { length, feed, lift } => {
                f.write_str("M207")?;
                word(f, 'S', length)?;
                word(f, 'F', feed)?;
                word(f, 'Z', lift)
            }
            Command::RecoverSettings { extra, feed } => {
                f.write_str("M208")?;
                word(f, 'S', extra)?;
                word(f, 'F', feed)
            }
            Command::Plane(Plane::Xy) => f.write_str("G17"),
            Command::Plane(Plane::Zx) => f.write_str("G18"),
            Command::Plane(Plane::Yz) => f.write_str("G19"),
            Command::Inches => f.write_str("G20"),
            Command::Millimetres => f.write_str("G21"),
            Command::Home(named) => flags(f, "G28", named),
            Command::Absolute => f.write_str("G90"),
            Command::Relative => f.write_str("G91"),
            Command::SetPosition(to) => axis_line(f, "G92", to),
            Command::EnableMotors(named) => flags(f, "M17", named),
            Command::DisableMotors(named) => flags(f, "M84", named),
            Command::IdleTimeout { seconds } => write!(f, "M84 S{seconds}"),
            Command::AbsoluteExtrusion => f.write_str("M82"),
            Command::RelativeExtrusion => f.write_str("M83"),
            Command::StepsPerMm(words) => axis_line(f, "M92", words),
            Command::ReportTemperatures => f.write_str("M105"),
            Command::Continue => f.write_str("M108"),
            Command::LineNumber => f.write_str("M110"),
            Command::EmergencyStop => f.write_str("M112"),
            Command::Keepalive(seconds) => switch(f, "M113", seconds),
            Command::ReportPosition { real } => f.write_str(if real { "M114 R" } else { "M114" }),
            Command::ReportFirmware => f.write_str("M115"),
            Command::Message => f.write_str("M117"),
            Command::ReportEndstops => f.write_str("M119"),
            Command::Diagnose => f.write_str("M122"),
            Command::AutoReport(seconds) => switch(f, "M155", seconds),
            Command::MaxAcceleration(words) => axis_line(f, "M201", words),
            Command::MaxSpeed(words) => axis_line(f, "M203", words),
            Command::Acceleration { print, retract, travel } => {
                f.write_str("M204")?;
                word(f, 'P', print)?;
                word(f, 'R', retract)?;
                word(f, 'T', travel)
            }
            Command::Corners { deviation, jerk, min_feed, min_travel, min_segment } => {
                axis_line(f, "M205", jerk)?;
                word(f, 'J', deviation)?;
                word(f, 'S', min_feed)?;
                word(f, 'T', min_travel)?;
                word(f, 'B', min_segment)
            }
            Command::SoftEndstops(on) => switch(f, "M211", on.map(|on| Number::from(i32::from(on)))),
            Command::FeedPercent(percent) => switch(f, "M220", percent),
            Command::BackUpFeedPercent => f.write_str("M220 B"),
            Command::RestoreFeedPercent => f.write_str("M220 R"),
            Command::FlowPercent(percent) => switch(f, "M221", percent),
            Command::Finish => f.write_str("M400"),
            Command::QuickStop => f.write_str("M410"),
            Command::SaveSettings => f.write_str("M500"),
            Command::LoadSettings => f.write_str("M501"),
            Command::DefaultSettings => f.write_str("M502"),
            Command::ReportSettings { for_replay } => f.write_str(if for_replay { "M503 S0" } else { "M503" }),
            Command::CheckStorage => f.write_str("M504"),
            Command::Stealth { on: None, .. } => f.write_str("M569"),
            Command::Stealth { on: Some(on), axes } => flags(f, if on { "M569 S1" } else { "M569 S0" }, axes),
            Command::DriverCurrent(words) => axis_line(f, "M906", words),
            Command::HybridThreshold(words) => axis_line(f, "M913", words),
            Command::StallThreshold(words) => axis_line(f, "M914", words),
            Command::AlignBelt { diagnoses, repairs } => {
                f.write_str("M915")?;
                f.write_str(if diagnoses { " D" } else { "" })?;
                f.write_str(if repairs { " R" } else { "" })
            }
            Command::Shaper { axes, frequency, damping, kind } => {
                flags(f, "M593", axes)?;
                word(f, 'F', frequency)?;
                word(f, 'D', damping)?;
                word(f, 'T', kind)
            }
            Command::Advance { time, window } => {
                f.write_str("M572")?;
                word(f, 'S', time)?;
                word(f, 'W', window)
            }
            Command::VelocityLimit(limit) => velocity_limit(f, limit),
            Command::Tool => f.write_str("T0"),
            Command::HeaterTarget { heater, target } => {
                f.write_str(["M104", "M140", "M141"][heater as usize])?;
                word(f, 'S', target)
            }
            Command::HeaterWait { heater, target, cools } => {
                f.write_str(["M109", "M190", "M191"][heater as usize])?;
                word(f, if cools { 'R' } else { 'S' }, target)
            }
            Command::AwaitHeaters => f.write_str("M116"),
            Command::FanSpeed { fan, speed } => write!(f, "M106 P{fan} S{speed}"),
            Command::Pid { heater, gains: [p, i, d] } => {
                f.write_str(if heater == Heater::Bed { "M304" } else { "M301" })?;
                word(f, 'P', p)?;
                word(f, 'I', i)?;
                word(f, 'D', d)
            }
            Command::TuneHeater { heater, target, cycles, applies } => {
                write!(f, "M303 {}", index(heater))?;
                word(f, 'S', target)?;
                word(f, 'C', cycles)?;
                f.write_str(if applies { " U1" } else { "" })
            }
            Command::SelfTest => f.write_str("SELF_TEST"),
            Command::MachineRecord(MachineRecord::Get) => f.write_str("MACHINE_GET"),
            Command::MachineRecord(MachineRecord::Store) => f.write_str("MACHINE_STORE"),
            Command::MachineRecord(MachineRecord::Put { at, hex }) => {
                write!(f, "MACHINE_PUT AT={at} HEX=")?;
                write_text(f, hex)
            }
            Command::ColdExtrusion { least, allow } => {
                switch(f, "M302", least)?;
                word(f, 'P', allow.map(|allow| Number::from(i32::from(allow))))
            }
            Command::HeaterModel { heater, is_named, words } => {
                write!(f, "M306 {}", if is_named { index(heater) } else { "" })?;
                for (letter, number) in [
                    ('P', words.power),
                    ('C', words.capacity),
                    ('A', words.loss),
                    ('F', words.fan_loss),
                    ('R', words.responsiveness),
                    ('L', words.heater_lag),
                    ('H', words.filament),
                ] {
                    word(f, letter, number)?;
                }
                Ok(())
            }
            Command::ControllerFan { speed, run_on, resets, other } => {
                switch(f, "M710", speed)?;
                word(f, 'D', run_on)?;
                f.write_str(if resets { " R" } else { "" })?;
                other.map_or(Ok(()), |letter| write!(f, " {}", letter as char))
            }
            Command::PowerOff => f.write_str("M81"),
            Command::PowerLossRecovery(on) => switch(f, "M413", on.map(|on| Number::from(i32::from(on)))),
            Command::Conditional => f.write_str("M622"),
            Command::Restart => f.write_str("M999"),
            Command::Malformed(flaw) => malformed(f, flaw),
            Command::Silent => f.write_str("M74"),
            Command::AwaitUser { filament: true, park, .. } => parked(f, "M600", 'E', park),
            Command::AwaitUser { ms: 0, park, .. } if park == ParkWords::default() => f.write_str("M0"),
            Command::AwaitUser { ms: 0, park, .. } => parked(f, "M601", 'E', park),
            Command::AwaitUser { ms, .. } => write!(f, "M0 P{ms}"),
            Command::Pause { parks: false, .. } => f.write_str("M25"),
            Command::Pause { parks: true, park } => parked(f, "M125", 'L', park),
            Command::BeginJob => f.write_str("M75"),
            Command::EndJob => f.write_str("M77"),
            Command::Cancel => f.write_str("M524"),
            Command::BeginUpload(name) => {
                f.write_str("M28 ")?;
                write_text(f, name)
            }
            Command::EndUpload => f.write_str("M29"),
            Command::Resume => f.write_str("M24"),
            Command::Answer => f.write_str("M876"),
            Command::Progress { percent, minutes } => {
                f.write_str("M73")?;
                word(f, 'P', percent)?;
                word(f, 'R', minutes)
            }
            Command::Debug(bits) => switch(f, "M111", bits),
            Command::AutoPosition(seconds) => switch(f, "M154", seconds),
            Command::Tell { form, to, text } => {
                f.write_str("M118 ")?;
                match to {
                    // The letters in front of a text end there, or the text could be taken for more of them.
                    Audience::Sender => f.write_str("E0 ")?,
                    Audience::All => f.write_str("P0 ")?,
                    Audience::Line(line) => write!(f, "P{line} ")?,
                }
                f.write_str(match form {
                    Form::Plain => "",
                    Form::Echo => "E1 ",
                    Form::Action => "A1 ",
                })?;
                write_text(f, text)
            }
            Command::ReportLevelling => f.write_str("M420"),
            Command::Object(number) => write!(f, "M486 S{number}"),
            Command::CancelObject => f.write_str("M486 C"),
            Command::Probing => f.write_str("G29"),
            Command::Unknown(text) => write_text(f, text),
        }
    }
}

/// The number of a heater in E.
const fn index(heater: Option<Heater>) -> &'static str {
    match heater {
        Some(Heater::Hotend) => "E0",
        Some(Heater::Bed) => "E-1",
        Some(Heater::Chamber) => "E-2",
        None => "E7",
    }
}

/// A text, with `?` for every byte that is neither printable ASCII nor a tab.
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
                b'A' | b'C' | b'H' | b'L' => "M306 ",
                _ => "G2 ",
            })?;
            f.write_char(letter as char)
        }
        Flaw::NoAxis(letter) => write!(f, "G92 {}0", letter as char),
        Flaw::Absent(absent) => absent_part(f, absent),
    }
}

/// A line for a part that is not there.
fn absent_part(f: &mut Formatter<'_>, Absent { command, part, which }: Absent<'_>) -> fmt::Result {
    match command {
        Named::Code(b'T', number) => return write!(f, "T{number}"),
        Named::Name(name) => write!(f, "{name} EXTRUDER=")?,
        Named::Code(letter, number) => {
            let word = match (part, number) {
                (Part::Extruder, 17 | 18 | 84 | 301) => 'E',
                (Part::Extruder, 572) => 'D',
                (Part::Tool, 116 | 207 | 208) | (Part::Bed | Part::Chamber, _) => 'P',
                (Part::Preset | Part::Driver, _) => 'I',
                (Part::Heater, _) => 'H',
                (Part::Slot, _) => 'S',
                (Part::Other, _) => 'L',
                _ => 'T',
            };
            write!(f, "{}{number} {word}", letter as char)?;
        }
    }
    write_text(f, which)
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
fn parked(f: &mut Formatter<'_>, code: &str, back: char, park: ParkWords) -> fmt::Result {
    f.write_str(code)?;
    for (letter, number) in [('X', park.x), ('Y', park.y), ('Z', park.z), (back, park.e), ('R', park.target)] {
        word(f, letter, number)?;
    }
    for (letter, number) in [('U', park.unload), ('L', park.load)] {
        word(f, letter, number)?;
    }
    park.other.map_or(Ok(()), |letter| write!(f, " {}0", letter as char))
}

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

/// The decimals of a word.
fn decimals_of(word: &str) -> usize {
    word.split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

/// A word with a number of decimals.
fn padded(word: &str, decimals: usize) -> String {
    let point = if word.contains('.') { "" } else { "." };
    format!("{word}{point}{}", "0".repeat(decimals - decimals_of(word)))
}
