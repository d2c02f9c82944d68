//! CSV: reads a trace of `corehbot run --trace` (docs/reference/trace.md), and writes its rows.

use super::{Column, StepTrace};
use std::io::{BufRead, Write};

/// First line of a trace.
const MAGIC: &str = "# corehbot-trace v1 ";

/// Columns that a trace may have: a bit each.
const MOST_COLUMNS: usize = 8;

/// More ticks than any trace has: 115 days.
const TOO_LATE: u64 = 100_000_000_000_000;

/// Rows of the CoreH-bot's motors over x, y and z, which a trace names by one word.
const COREHBOT: [(&str, [i8; 3]); 4] =
    [("m1", [-1, 1, 0]), ("m4", [-1, -1, 0]), ("m8", [1, -1, 0]), ("m11", [1, 1, 0])];

/// Why a file is not a trace.
#[derive(Debug)]
pub enum TraceError {
    /// It cannot be read.
    Io(std::io::Error),
    /// It is not a trace of version 1.
    NotATrace,
    /// Its header does not define a step, or a motor.
    Head(&'static str),
    /// A line that is not an instant, counted from 1.
    Row(u64),
    /// A line with a tick before the previous line.
    Backward(u64),
}

impl std::fmt::Display for TraceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Io(error) => write!(f, "cannot be read: {error}"),
            Self::NotATrace => f.write_str("is not a step trace of version 1"),
            Self::Head(what) => write!(f, "its head {what}"),
            Self::Row(line) => write!(f, "line {line} is not a tick with steps of -1, 0 or 1"),
            Self::Backward(line) => write!(f, "line {line} is earlier than the line before"),
        }
    }
}

impl std::error::Error for TraceError {}

/// Reads a trace.
///
/// # Errors
/// The first problem, by its line.
pub fn read(mut from: impl BufRead) -> Result<StepTrace, TraceError> {
    let mut line = String::new();
    let mut comment = String::new();
    let mut number = 0;
    let header = loop {
        line.clear();
        number += 1;
        if from.read_line(&mut line).map_err(TraceError::Io)? == 0 {
            return Err(TraceError::NotATrace);
        }
        match line.strip_prefix(MAGIC) {
            Some(rest) => rest.trim().clone_into(&mut comment),
            None if !line.starts_with('#') => break line.trim().to_owned(),
            None => {}
        }
    };
    if comment.is_empty() {
        return Err(TraceError::NotATrace);
    }
    let mut trace = head(&comment, &header)?;
    let columns = trace.columns.len();
    let mut last = 0;
    loop {
        line.clear();
        number += 1;
        if from.read_line(&mut line).map_err(TraceError::Io)? == 0 {
            return Ok(trace);
        }
        let (tick, steps, forward) = row(line.trim_end(), columns).ok_or(TraceError::Row(number))?;
        if tick < last {
            return Err(TraceError::Backward(number));
        }
        last = tick;
        trace.add(tick, steps, forward);
    }
}

/// Writes the rows of a trace, one for each tick with steps; the caller writes the header.
///
/// # Errors
/// It cannot be written.
pub fn write_rows(trace: &StepTrace, to: &mut impl Write) -> std::io::Result<()> {
    let mut tick = 0_u64;
    for event in &trace.events {
        tick += u64::from(event.gap);
        if event.steps == 0 {
            continue;
        }
        write!(to, "{tick}")?;
        for column in 0..trace.columns.len() {
            let sign = match (event.steps >> column & 1, event.forward >> column & 1) {
                (0, _) => "0",
                (_, 0) => "-1",
                _ => "1",
            };
            write!(to, ",{sign}")?;
        }
        writeln!(to)?;
    }
    Ok(())
}

/// A trace without instants, from the first comment and the header row.
fn head(comment: &str, header: &str) -> Result<StepTrace, TraceError> {
    let field = |key: &str| comment.split(' ').find_map(|word| word.strip_prefix(key)?.strip_prefix('='));
    if field("tick_hz") != Some("10000000") {
        return Err(TraceError::Head("has other ticks than 10 MHz"));
    }
    let kinematics = field("kinematics").ok_or(TraceError::Head("does not name the kinematics"))?;
    let listed =
        field("steps_per_mm").map(|list| list.split('/').map(|v| v.parse().ok()).collect::<Option<Vec<f64>>>());
    let listed = listed.flatten().filter(|all| all.iter().all(|v| v.is_finite() && *v > 0.0)).unwrap_or_default();
    // Of a belt, z and e; or of x, y, z and e.
    let [x, y, z] = match listed[..] {
        [x, y, z, _] => [x, y, z],
        [belt, z, _] => [belt, belt, z],
        [belt, ..] => [belt; 3],
        [] => return Err(TraceError::Head("does not give steps a mm")),
    };
    // All axes of a motor have steps of one size.
    let axis_step = |row: [i8; 3]| {
        let axis = row.iter().zip([x, y, z]).find(|(entry, _)| **entry != 0);
        axis.map_or(1.0, |(_, steps)| x / steps)
    };
    let names = header.strip_prefix("tick,").ok_or(TraceError::Head("has no row of names"))?;
    let rows = rows(kinematics).ok_or(TraceError::Head("has unknown kinematics"))?;
    let row_of = |name: &str| rows.iter().find(|(motor, _)| motor == name).map_or([0; 3], |(_, row)| *row);
    let columns: Vec<Column> = names
        .split(',')
        .map(|name| (name.to_owned(), row_of(name)))
        .map(|(name, row)| Column { name, row, axis_step: axis_step(row) })
        .collect();
    if columns.len() > MOST_COLUMNS {
        return Err(TraceError::Head("has more than eight motors"));
    }
    Ok(StepTrace::new(columns, 1.0 / x))
}

/// Motors and their rows over x, y and z: `corehbot`, or `m8(1,-1,0,0);m11(1,1,0,0)`.
fn rows(kinematics: &str) -> Option<Vec<(String, [i8; 3])>> {
    if kinematics == "corehbot" {
        return Some(COREHBOT.map(|(name, row)| (name.to_owned(), row)).to_vec());
    }
    let motor = |text: &str| {
        let (name, row) = text.strip_suffix(')')?.split_once('(')?;
        let mut entries = row.split(',').map(|entry| entry.parse().ok());
        Some((name.to_owned(), [entries.next()??, entries.next()??, entries.next()??]))
    };
    kinematics.split(';').map(motor).collect()
}

/// The tick, the columns that step, and those that step forward.
fn row(line: &str, columns: usize) -> Option<(u64, u8, u8)> {
    let mut fields = line.split(',');
    let tick = fields.next()?.parse().ok().filter(|tick| *tick < TOO_LATE)?;
    let (mut steps, mut forward) = (0, 0);
    for column in 0..columns {
        match fields.next()? {
            "0" => {}
            "1" => (steps, forward) = (steps | 1 << column, forward | 1 << column),
            "-1" => steps |= 1 << column,
            _ => return None,
        }
    }
    fields.next().is_none().then_some((tick, steps, forward))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "# corehbot-trace v1 tick_hz=10000000 kinematics=corehbot steps_per_mm=80/800/400\n\
                        tick,m1,m4,m8,m11,z1,z2,e0\n";

    #[test]
    fn a_trace_is_read_with_its_motors() {
        let trace = read(format!("{HEAD}5,-1,-1,1,1,0,0,0\n9,0,0,0,0,0,0,1\n").as_bytes()).unwrap();
        assert!((trace.step_mm - 0.0125).abs() < 1e-15);
        assert_eq!(trace.columns[2].row, [1, -1, 0]);
        assert_eq!(trace.columns[6].row, [0, 0, 0]);
        let counted: Vec<_> = trace.counted().collect();
        assert_eq!(counted, [(5, [-1, -1, 1, 1, 0, 0, 0, 0]), (9, [-1, -1, 1, 1, 0, 0, 1, 0])]);
    }

    #[test]
    fn rows_are_written_as_they_were_read() {
        let rows = "5,-1,-1,1,1,0,0,0\n9,0,0,0,0,0,0,1\n5000000000,0,1,0,0,-1,0,0\n";
        let mut written = Vec::new();
        write_rows(&read(format!("{HEAD}{rows}").as_bytes()).unwrap(), &mut written).unwrap();
        assert_eq!(String::from_utf8(written).unwrap(), rows);
    }

    #[test]
    fn other_machines_say_their_rows() {
        let head = "# corehbot-trace v1 tick_hz=10000000 kinematics=m8(1,-1,0,0);m11(1,1,0,0) \
            steps_per_mm=100/100/400/400\n\
                    tick,m1,m4,m8,m11,z1,z2,e0\n";
        let trace = read(head.as_bytes()).unwrap();
        assert_eq!((trace.columns[2].row, trace.columns[3].row), ([1, -1, 0], [1, 1, 0]));
        assert_eq!(trace.columns[0].row, [0, 0, 0]);
    }

    #[test]
    fn axes_may_have_steps_of_their_own() {
        let head = "# corehbot-trace v1 tick_hz=10000000 kinematics=m1(1,0,0,0);m4(0,1,0,0) steps_per_mm=80/100/400/400\n\
                    tick,m1,m4\n";
        let trace = read(head.as_bytes()).unwrap();
        // 80 steps/mm of x, 100 of y: a step of m4 is four fifths of a step of m1.
        assert!((trace.step_mm - 0.0125).abs() < 1e-15);
        assert_eq!([0, 1].map(|column| trace.columns[column].axis_step), [1.0, 0.8]);
    }

    #[test]
    fn what_is_no_trace_is_named_by_its_line() {
        let wrong = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        assert!(wrong("").contains("not a step trace"));
        assert!(wrong("G28\n").contains("not a step trace"));
        assert!(wrong(&format!("{HEAD}5,1,0,0\n")).contains("line 3"));
        assert!(wrong(&format!("{HEAD}5,2,0,0,0,0,0,0\n")).contains("line 3"));
        assert!(wrong(&format!("{HEAD}5,1,0,0,0,0,0,0\n4,1,0,0,0,0,0,0\n")).contains("earlier"));
        assert!(wrong(&HEAD.replace("10000000", "1000")).contains("10 MHz"));
    }

    /// Bytes of a trace are replaced, dropped and doubled in every place. It is read or refused, and a read trace has
    /// an end.
    #[test]
    fn no_bytes_do_harm() {
        let text = format!("{HEAD}5,-1,-1,1,1,0,0,0\n99999999999999,0,0,0,0,0,0,1\n").into_bytes();
        for at in 0..text.len() {
            for byte in [0, b'\n', b',', b'-', b'0', b'9', 0xFF] {
                let (mut replaced, mut added) = (text.clone(), text.clone());
                replaced[at] = byte;
                added.insert(at, byte);
                for bytes in [replaced, added] {
                    let events = read(bytes.as_slice()).map_or(0, |trace| trace.events.len());
                    assert!(events < 100_000, "{}", String::from_utf8_lossy(&bytes));
                }
            }
        }
    }
}
