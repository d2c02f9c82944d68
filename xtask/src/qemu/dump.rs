//! The board's dump of step events, turned into a trace.

use anyhow::{Context as _, Result, ensure};
use corehbot::motors::MotorSet;
use corehbot_sim::trace::{Finished, Header, TraceWriter};
use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

/// Bytes of an event: the tick's lower 48 bits, the motors that step, the directions (boards/qemu,
/// trace.rs).
const RECORD: usize = 8;

/// The trace, and the tick of its last event.
pub struct Dumped {
    /// The written trace.
    pub trace: Finished,
    /// The last tick.
    pub ticks: u64,
}

/// Converts the dump in `path`.
pub fn convert(path: &Path, out: Option<impl Write>, header: Header) -> Result<Dumped> {
    let file = File::open(path).context("the board left no trace")?;
    ensure!(file.metadata()?.len().is_multiple_of(RECORD as u64), "the board's trace ends within an event");
    let mut dump = BufReader::with_capacity(1 << 16, file);
    let mut writer = TraceWriter::new(out, header);
    let mut record = [0; RECORD];
    let mut last = 0;
    loop {
        if dump.read(&mut record[..1])? == 0 {
            break;
        }
        dump.read_exact(&mut record[1..])?;
        let [.., steps, forward] = record;
        let tick = u64::from_le_bytes(record) & 0xFFFF_FFFF_FFFF;
        writer.event(tick, MotorSet(steps), MotorSet(forward));
        last = tick;
    }
    Ok(Dumped { trace: writer.finish().context("cannot write the trace")?, ticks: last })
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::settings::Settings;

    #[test]
    fn a_record_holds_tick_motors_and_directions() {
        let path = std::env::temp_dir().join(format!("corehbot-dump-{}", std::process::id()));
        std::fs::write(&path, [1, 2, 0, 0, 0, 0, 0x41, 0x40, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02, 0x00]).unwrap();
        let mut text = Vec::new();
        let dumped = convert(&path, Some(&mut text), (&Settings::prototype()).into()).unwrap();
        std::fs::remove_file(&path).unwrap();
        let text = String::from_utf8(text).unwrap();
        let rows: Vec<_> = text.lines().skip(2).collect();
        assert_eq!(rows, ["513,-1,0,0,0,0,0,1", "281474976710655,0,-1,0,0,0,0,0"]);
        assert_eq!((dumped.trace.events, dumped.ticks), (2, (1 << 48) - 1));
    }
}
