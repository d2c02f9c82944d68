//! Printing: a command as the shortest G-code that reads back as the same command.

mod bed;
mod flaws;
mod words;

use bed::{bed, level, probe};
use core::fmt::{self, Display, Formatter};

use corehbot::gcode::{
    ArcShape, ArcWords, Audience, Command, Form, HomeWords, JobCommand, MachineRecord, MotionCommand, MotorCommand,
    Number, ParkWords, PlainWords, RefusedCommand, ReportCommand, ResonanceCommand, SettingCommand, ShaperWords,
};
use corehbot::settings::plain::letters;
use flaws::malformed;
pub use words::reduced;
use words::{axes, axis_line, decimals_of, flags, padded, parked, switch, velocity_limit, word, write_text};

/// A command to be printed. One that represents a whole family is printed as one of it: M74 for silent ones. A line
/// that is not in order is printed as one with the same flaw. In a text, `?` stands for every byte that is neither
/// printable ASCII nor a tab.
///
/// A command without a form of its own here is printed as the line that it was read from, reduced.
pub struct Printed<'c>(pub Command<'c>, pub &'c [u8]);

impl Display for Printed<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0 {
            Command::Motion(command) => motion(f, command, self.1),
            Command::Motor(command) => motor(f, command, self.1),
            Command::Setting(command) => setting(f, command, self.1),
            Command::Job(command) => job(f, command, self.1),
            Command::Probe(command) => probe(f, command, self.1),
            Command::Bed(command) => bed(f, command, self.1),
            Command::Resonance(command) => resonance(f, command, self.1),
            Command::Report(command) => report(f, command, self.1),
            // The only name.
            Command::Own(command) if command.code() == 0 => f.write_str("SELF_TEST"),
            Command::Own(_) => reduced(f, self.1),
            Command::Refused(command) => refused(f, command),
            Command::Malformed(flaw) => malformed(f, flaw),
            Command::Silent => f.write_str("M74"),
            Command::Unknown(text) => write_text(f, text),
        }
    }
}

fn motion(f: &mut Formatter<'_>, command: MotionCommand, line: &[u8]) -> fmt::Result {
    match command {
        MotionCommand::Line { rapid, to, feed } => {
            f.write_str(if rapid { "G0" } else { "G1" })?;
            axes(f, to)?;
            word(f, 'F', feed)
        }
        MotionCommand::Circulate { to, belt, feed } => {
            f.write_str("G1")?;
            axes(f, to)?;
            word(f, 'C', Some(belt))?;
            word(f, 'F', feed)
        }
        MotionCommand::Arc(ArcWords { clockwise, to, feed, shape, turns, decimals }) => {
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
        MotionCommand::Dwell { ms } => write!(f, "G4 P{ms}"),
        MotionCommand::Retract => f.write_str("G10"),
        MotionCommand::Recover => f.write_str("G11"),
        MotionCommand::Home(HomeWords { axes, only_lost, raise, drops_mesh }) => {
            flags(f, "G28", axes)?;
            f.write_str(if only_lost { " O" } else { "" })?;
            f.write_str(if drops_mesh { " W" } else { "" })?;
            word(f, 'R', raise)
        }
        MotionCommand::Absolute => f.write_str("G90"),
        MotionCommand::Relative => f.write_str("G91"),
        MotionCommand::SetPosition(to) => axis_line(f, "G92", to),
        MotionCommand::AbsoluteExtrusion => f.write_str("M82"),
        MotionCommand::RelativeExtrusion => f.write_str("M83"),
        MotionCommand::FeedPercent(percent) => switch(f, "M220", percent),
        MotionCommand::BackUpFeedPercent => f.write_str("M220 B"),
        MotionCommand::RestoreFeedPercent => f.write_str("M220 R"),
        MotionCommand::Babystep { by, is_kept } => {
            f.write_str("M290")?;
            word(f, 'Z', by)?;
            f.write_str(if is_kept { "" } else { " P0" })
        }
        MotionCommand::ZOffset(words) => {
            f.write_str("SET_GCODE_OFFSET")?;
            for (name, number) in [("Z", words.to), ("Z_ADJUST", words.by)] {
                if let Some(number) = number {
                    write!(f, " {name}={number}")?;
                }
            }
            f.write_str(if words.moves { " MOVE=1" } else { "" })
        }
        MotionCommand::NoOffset("M290", word) => write!(f, "M290 {}", String::from_utf8_lossy(word)),
        MotionCommand::NoOffset(command, word) => write!(f, "{command} {}=1", String::from_utf8_lossy(word)),
        MotionCommand::QuickStop => f.write_str("M410"),
        MotionCommand::Tool => f.write_str("T0"),
        _ => reduced(f, line),
    }
}

fn motor(f: &mut Formatter<'_>, command: MotorCommand, line: &[u8]) -> fmt::Result {
    match command {
        MotorCommand::LevelScrews(words) => level(f, words),
        MotorCommand::EnableMotors(named) => flags(f, "M17", named),
        MotorCommand::DisableMotors(named) => flags(f, "M84", named),
        MotorCommand::IdleTimeout { seconds } => write!(f, "M84 S{seconds}"),
        MotorCommand::Stealth { on: None, .. } => f.write_str("M569"),
        MotorCommand::Stealth { on: Some(on), axes } => flags(f, if on { "M569 S1" } else { "M569 S0" }, axes),
        MotorCommand::AlignBelt { diagnoses, repairs } => {
            f.write_str("M915")?;
            f.write_str(if diagnoses { " D" } else { "" })?;
            f.write_str(if repairs { " R" } else { "" })
        }
        MotorCommand::Buzz { motor, free } => {
            write!(f, "STEPPER_BUZZ STEPPER={motor}")?;
            free.map_or(Ok(()), |free| write!(f, " FREE={free}"))
        }
        _ => reduced(f, line),
    }
}

fn setting(f: &mut Formatter<'_>, command: SettingCommand<'_>, line: &[u8]) -> fmt::Result {
    match command {
        SettingCommand::Plain(PlainWords { code, numbers }) => {
            write!(f, "M{code}")?;
            let named = letters(code).filter_map(|letters| letters.chars().next()).zip(numbers);
            named.into_iter().try_for_each(|(letter, number)| word(f, letter, number))
        }
        SettingCommand::SaveSettings => f.write_str("M500"),
        SettingCommand::LoadSettings => f.write_str("M501"),
        SettingCommand::DefaultSettings => f.write_str("M502"),
        SettingCommand::ReportSettings { for_replay } => f.write_str(if for_replay { "M503 S0" } else { "M503" }),
        SettingCommand::CheckStorage => f.write_str("M504"),
        SettingCommand::Shaper(ShaperWords { axes, frequency, damping, kind }) => {
            flags(f, "M593", axes)?;
            word(f, 'F', frequency)?;
            word(f, 'D', damping)?;
            word(f, 'T', kind)
        }
        SettingCommand::Advance { time, window } => {
            f.write_str("M572")?;
            word(f, 'S', time)?;
            word(f, 'W', window)
        }
        SettingCommand::VelocityLimit(limit) => velocity_limit(f, limit),
        SettingCommand::MachineRecord(MachineRecord::Get) => f.write_str("MACHINE_GET"),
        SettingCommand::MachineRecord(MachineRecord::Store) => f.write_str("MACHINE_STORE"),
        SettingCommand::MachineRecord(MachineRecord::Put { at, hex }) => {
            write!(f, "MACHINE_PUT AT={at} HEX=")?;
            write_text(f, hex)
        }
        _ => reduced(f, line),
    }
}

fn job(f: &mut Formatter<'_>, command: JobCommand<'_>, line: &[u8]) -> fmt::Result {
    match command {
        JobCommand::Continue => f.write_str("M108"),
        JobCommand::EmergencyStop => f.write_str("M112"),
        JobCommand::Restart => f.write_str("M999"),
        JobCommand::AwaitUser { filament: true, park, .. } => parked(f, "M600", 'E', park),
        JobCommand::AwaitUser { ms: 0, park, .. } if park == ParkWords::default() => f.write_str("M0"),
        JobCommand::AwaitUser { ms: 0, park, .. } => parked(f, "M601", 'E', park),
        JobCommand::AwaitUser { ms, .. } => write!(f, "M0 P{ms}"),
        JobCommand::Pause { parks: false, .. } => f.write_str("M25"),
        JobCommand::Pause { parks: true, park } => parked(f, "M125", 'L', park),
        JobCommand::BeginJob => f.write_str("M75"),
        JobCommand::EndJob => f.write_str("M77"),
        JobCommand::Cancel => f.write_str("M524"),
        JobCommand::BeginUpload(name) => {
            f.write_str("M28 ")?;
            write_text(f, name)
        }
        JobCommand::EndUpload => f.write_str("M29"),
        JobCommand::Resume => f.write_str("M24"),
        JobCommand::Answer => f.write_str("M876"),
        JobCommand::Object(number) => write!(f, "M486 S{number}"),
        JobCommand::CancelObject => f.write_str("M486 C"),
        _ => reduced(f, line),
    }
}

fn report(f: &mut Formatter<'_>, command: ReportCommand<'_>, line: &[u8]) -> fmt::Result {
    match command {
        ReportCommand::LineNumber => f.write_str("M110"),
        ReportCommand::ReportFirmware => f.write_str("M115"),
        ReportCommand::Message => f.write_str("M117"),
        ReportCommand::ReportEndstops => f.write_str("M119"),
        ReportCommand::Diagnose => f.write_str("M122"),
        ReportCommand::Tell { form, to, text } => {
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
        _ => reduced(f, line),
    }
}

fn resonance(f: &mut Formatter<'_>, command: ResonanceCommand, line: &[u8]) -> fmt::Result {
    match command {
        ResonanceCommand::Sensor => f.write_str("M955"),
        ResonanceCommand::Samples { count } => {
            f.write_str("M956")?;
            word(f, 'S', count)
        }
        ResonanceCommand::Sweep(words) => {
            let name = if words.chooses { "SHAPER_CALIBRATE" } else { "TEST_RESONANCES" };
            write!(f, "{name} AXIS={:?}", words.axis)?;
            let numbers = [
                ("FREQ_START", words.from),
                ("FREQ_END", words.to),
                ("ACCEL_PER_HZ", words.accel_per_hz),
                ("HZ_PER_SEC", words.hz_per_s),
                ("SWEEPING_ACCEL", words.swing),
                ("SWEEPING_PERIOD", words.period),
            ];
            for (name, number) in numbers {
                number.map_or(Ok(()), |number| write!(f, " {name}={number}"))?;
            }
            f.write_str(if words.wants_raw { " OUTPUT=raw_data" } else { "" })
        }
        _ => reduced(f, line),
    }
}

fn refused(f: &mut Formatter<'_>, command: RefusedCommand) -> fmt::Result {
    match command {
        RefusedCommand::Conditional => f.write_str("M622"),
        _ => Err(fmt::Error),
    }
}
