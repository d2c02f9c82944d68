//! A machine to a board and back, over its serial line.

use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use corehbot::settings::Settings;
use corehbot::storage::{LONGEST, machine_in, record_of};
use corehbot_host::say::say;
use corehbot_host::serial::SerialLine;
use corehbot_host::status::DONE;
use corehbot_machine_file as machine_file;
use corehbot_machine_file::printable;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Bytes of a piece of a record: a line holds them in hexadecimal digits, with its number and checksum.
const PIECE: usize = 24;

/// A board's words before the reason why it does not take a machine.
const REFUSED: &str = "echo:machine not stored: ";

/// And when it did.
const STORED: &str = "echo:machine stored ";

/// What becomes of a mesh that the board has stored.
const MESH: &str = "Stored mesh ";

/// First word of every piece.
const PIECE_SAID: &str = "machine ";

#[derive(Args)]
pub(crate) struct Send {
    /// The machine file.
    #[arg(value_name = "M.toml")]
    file: PathBuf,
    #[command(flatten)]
    port: Port,
}

#[derive(Args)]
pub(crate) struct Get {
    #[command(flatten)]
    port: Port,
}

#[derive(Args)]
struct Port {
    /// The serial line to the board, such as /dev/ttyACM0.
    #[arg(value_name = "PORT")]
    path: PathBuf,
    /// Its rate; on USB any will do.
    #[arg(long, default_value_t = 250_000)]
    baud: u32,
}

impl Port {
    fn talk(&self, commands: &str) -> Result<Vec<String>> {
        SerialLine::open(&self.path, self.baud)?.talk(commands)
    }
}

/// Sends the machine of a file, which the board checks and stores.
pub(super) fn send(args: &Send) -> Result<u8> {
    let machine = machine_file::read(&args.file)?;
    let heard = args.port.talk(&lines_of(&machine.settings)?)?;
    if let Some(why) = heard.iter().find_map(|line| line.strip_prefix(REFUSED)) {
        bail!("the board refused it: {}", printable::line(why));
    }
    let stored = heard.iter().find_map(|line| line.strip_prefix(STORED));
    let stored = stored.context("the board did not confirm that it stored it: does it run this firmware?")?;
    say(format_args!("{}: stored {}", args.file.display(), printable::line(stored)))?;
    mesh_news(&heard).try_for_each(|news| say(format_args!("{}", printable::line(news))))?;
    if !machine.texts.is_empty() {
        say(format_args!("its texts were not sent: a board has them in its image (corehbot image)"))?;
    }
    Ok(DONE)
}

/// Gets the machine that the board is, as a machine file.
pub(super) fn get(args: &Get) -> Result<u8> {
    let heard = args.port.talk("MACHINE_GET\n")?;
    let text = machine_file::written(&machine_said(&heard)?)?;
    super::say(&text)
}

/// What the board has told of its mesh.
fn mesh_news(heard: &[String]) -> impl Iterator<Item = &str> {
    heard.iter().filter_map(|line| line.strip_prefix("echo:")).filter(|line| line.starts_with(MESH))
}

/// The lines that send a machine.
fn lines_of(machine: &Settings) -> Result<String> {
    let mut record = [0; LONGEST];
    let length = record_of(machine, &mut record).context("the machine does not fit into a record")?;
    let mut lines = String::new();
    for (number, piece) in record[..length].chunks(PIECE).enumerate() {
        write!(lines, "MACHINE_PUT AT={} HEX=", PIECE * number)?;
        piece.iter().try_for_each(|byte| write!(lines, "{byte:02x}"))?;
        lines.push('\n');
    }
    lines += "MACHINE_STORE\n";
    Ok(lines)
}

/// The machine in the pieces that a board said.
pub(crate) fn machine_said(heard: &[String]) -> Result<Settings> {
    let mut record = Vec::new();
    for words in heard.iter().filter_map(|line| line.strip_prefix(PIECE_SAID)) {
        if let Some(end) = words.strip_prefix("END=") {
            ensure!(end.parse() == Ok(record.len()), "a piece of the machine is missing");
            return machine_in(&record).map_err(|why| anyhow::anyhow!("the board's machine: {why}"));
        }
        let piece = words.strip_prefix("AT=").and_then(|words| words.split_once(" HEX="));
        let (at, hex) = piece.with_context(|| format!("no piece of a machine: {}", printable::line(words)))?;
        ensure!(at.parse() == Ok(record.len()), "a piece of the machine is missing");
        record.extend(bytes_of(hex).context("a piece of the machine is not a hexadecimal number")?);
    }
    bail!("the board says no machine: does this firmware run on it?")
}

fn bytes_of(hex: &str) -> Option<Vec<u8>> {
    let (pairs, odd) = hex.as_bytes().as_chunks::<2>();
    let byte = |pair: &[u8; 2]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    if odd.is_empty() { pairs.iter().map(byte).collect() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_that_ends_with_another_machine_is_told() {
        let heard = ["echo:Stored mesh ends with the next start: axes", "echo:machine stored 700 bytes", "ok"];
        let heard = heard.map(str::to_owned);
        assert_eq!(mesh_news(&heard).collect::<Vec<_>>(), ["Stored mesh ends with the next start: axes"]);
    }

    /// The replies of a board to these lines.
    fn said(lines: &str) -> Vec<String> {
        let pieces: Vec<_> = lines.lines().filter_map(|line| line.strip_prefix("MACHINE_PUT ")).collect();
        let digits: usize = pieces.iter().map(|piece| piece.split_once("HEX=").unwrap().1.len()).sum();
        let pieces = pieces.iter().map(|piece| format!("machine {piece}"));
        pieces.chain([format!("machine END={}", digits / 2), "ok".to_owned()]).collect()
    }

    #[test]
    fn what_is_sent_is_what_is_got() {
        let mut machine = Settings::prototype();
        machine.keepalive_s = 11;
        let lines = lines_of(&machine).unwrap();
        assert!(lines.lines().all(|line| line.len() < 80) && lines.ends_with("\nMACHINE_STORE\n"));
        assert_eq!(machine_said(&said(&lines)).unwrap(), machine);
    }

    #[test]
    fn a_missing_or_damaged_piece_is_found() {
        let whole = said(&lines_of(&Settings::prototype()).unwrap());
        for (change, told) in [
            (
                (|heard: &mut Vec<String>| drop(heard.remove(3))) as fn(&mut Vec<String>),
                "a piece of the machine is missing",
            ),
            (|heard| heard[2] = heard[2].replace("HEX=", "HEX=0"), "not a hexadecimal number"),
            (|heard| heard[2] = heard[2].replace("HEX=", "HEX=x"), "not a hexadecimal number"),
            (|heard| heard[2] = "machine gun".to_owned(), "no piece of a machine: gun"),
            (|heard| heard.truncate(3), "the board says no machine"),
            (|heard| heard.clear(), "the board says no machine"),
        ] {
            let mut heard = whole.clone();
            change(&mut heard);
            assert!(machine_said(&heard).unwrap_err().to_string().contains(told), "{told}");
        }
    }
}
