//! The job of this run, from the emulator's command line.
//!
//! `arg=IMAGE,arg=SETTINGS,arg=TRACE`: paths on the host without blanks. SETTINGS holds the machine, the position to be
//! assumed at start and the mesh that z follows. It is `(Settings, Option<[Mm; 3]>, Option<Mesh>)` in postcard, with a
//! mesh as heights and corners. TRACE takes the step events.

use core::ffi::CStr;

use corehbot::settings::Settings;
use corehbot::surface::{Heights, Mesh};
use corehbot::units::Mm;
use semihosting::experimental::env;
use semihosting::fs::File;
use semihosting::io::Read as _;

use super::fault::give_up;

/// Longest command line, and longest path in it.
const LINE: usize = 512;

/// Room for the settings in postcard; they take a few hundred bytes.
const BLOB: usize = 4096;

/// Points of a mesh along x and along y.
const POINTS: usize = 5;

/// A mesh in the blob: heights row by row, the first and the last corner, the fade height.
type MeshBlob = ([[i16; POINTS]; POINTS], [[Mm; 2]; 2], Mm);

/// The settings of a run.
pub struct Job {
    /// The machine.
    pub settings: Settings,
    /// Where the tool stands, if that is to be assumed.
    pub start: Option<[Mm; 3]>,
    /// The mesh of the bed, if there is one.
    pub mesh: Option<Mesh>,
    /// Takes the step events.
    pub trace: File,
}

/// Whether that word is on the command line in place of a job.
pub fn is_asked_for(asked: &str) -> bool {
    env::args::<LINE>().is_ok_and(|line| (&line).skip(1).any(|word| word == Ok(asked)))
}

/// Reads the job. There is nothing to run without one, so each failure ends the run.
pub fn read() -> Job {
    let Ok(line) = env::args::<LINE>() else { give_up(format_args!("no command line of at most {LINE} bytes")) };
    let mut words = (&line).skip(1).map(|word| word.unwrap_or_default());
    let (Some(settings), Some(trace)) = (words.next(), words.next()) else {
        give_up(format_args!("the command line is IMAGE SETTINGS TRACE"));
    };
    let mut blob = [0; BLOB];
    let blob = load(settings, &mut blob);
    let Ok((machine, start, mesh)) = postcard::from_bytes::<(Settings, Option<[Mm; 3]>, Option<MeshBlob>)>(blob) else {
        give_up(format_args!("{settings} holds no settings of this version"));
    };
    let Ok(trace) = with_path(trace, |path| File::create(path)) else { give_up(format_args!("cannot create {trace}")) };
    Job { settings: machine, start, mesh: mesh.and_then(laid), trace }
}

/// The mesh of its blob.
fn laid((rows, [first, last], fade): MeshBlob) -> Option<Mesh> {
    let heights = Heights::filled(POINTS, POINTS, |column, row| rows.get(row)?.get(column).copied())?;
    Mesh::new(heights, first, last, fade).ok()
}

/// Reads a whole file.
fn load<'b>(path: &str, buffer: &'b mut [u8; BLOB]) -> &'b [u8] {
    let Ok(mut file) = with_path(path, |path| File::open(path)) else { give_up(format_args!("cannot open {path}")) };
    let mut length = 0;
    loop {
        match file.read(&mut buffer[length..]) {
            Ok(0) => break &buffer[..length],
            Ok(count) => length += count,
            Err(_) => give_up(format_args!("cannot read {path}")),
        }
    }
}

/// Calls `work` with `path` as the C string that semihosting takes.
fn with_path<R>(path: &str, work: impl FnOnce(&CStr) -> R) -> R {
    let mut bytes = [0; LINE + 1];
    // The command line, which contains `path`, has at most LINE bytes.
    bytes[..path.len()].copy_from_slice(path.as_bytes());
    match CStr::from_bytes_until_nul(&bytes) {
        Ok(path) => work(path),
        Err(_) => give_up(format_args!("a path without an end")),
    }
}
