//! Archives: the plates of a sliced .3mf (Bambu Studio, OrcaSlicer), or the one G-code file in another ZIP archive.
//!
//! A .3mf has the G-code of its first plate in `Metadata/plate_1.gcode`. Other archives number their files in the order
//! of their names.

use crate::error::GcodeFileError;
use crate::plate::Plate;
use corehbot_machine_file::file_kind::FileKind;
use flate2::read::DeflateDecoder;
use rawzip::{CompressionMethod, RECOMMENDED_BUFFER_SIZE, ZipArchive, ZipArchiveEntryWayfinder};
use std::io::{Read, Seek};

/// More entries than this are no print.
const MOST_ENTRIES: usize = 10_000;

/// An entry with G-code.
struct Entry {
    plate: Plate,
    way: ZipArchiveEntryWayfinder,
    method: CompressionMethod,
    is_encrypted: bool,
}

/// What an archive has.
struct Found {
    entries: Vec<Entry>,
    /// A packed file by the end of its name: packed again, it is not read.
    packed: Option<FileKind>,
}

/// Ends of names of files that are packed themselves.
const PACKED: [(&str, FileKind); 4] =
    [(".bgcode", FileKind::BinaryGcode), (".gz", FileKind::Gzip), (".3mf", FileKind::Zip), (".zip", FileKind::Zip)];

fn damaged(error: &rawzip::Error) -> GcodeFileError {
    GcodeFileError::damaged(format!("it is no whole ZIP archive ({error})"))
}

/// The entries with G-code, by their numbers.
fn entries<R: rawzip::ReaderAt>(archive: &ZipArchive<R>) -> Result<Found, GcodeFileError> {
    let (mut buffer, mut found, mut packed) = (vec![0; RECOMMENDED_BUFFER_SIZE], Vec::new(), None);
    let mut entries = archive.entries(&mut buffer);
    let mut count = 0;
    while let Some(entry) = entries.next_entry().map_err(|error| damaged(&error))? {
        count += 1;
        if count > MOST_ENTRIES {
            return Err(GcodeFileError::damaged(format!("it has more than {MOST_ENTRIES} entries")));
        }
        let name = String::from_utf8_lossy(entry.file_path().as_bytes()).into_owned();
        let lower = name.to_ascii_lowercase();
        // macOS adds a folder with a shadow of each file.
        if lower.starts_with("__macosx/") {
            continue;
        }
        if ![".gcode", ".gco", ".g"].iter().any(|end| lower.ends_with(end)) {
            packed = packed.or(PACKED.iter().find(|(end, _)| lower.ends_with(end)).map(|(_, kind)| *kind));
            continue;
        }
        let stem = lower.rsplit('/').next().and_then(|file| file.strip_prefix("plate_")?.strip_suffix(".gcode"));
        let number = stem.and_then(|number| number.parse().ok()).unwrap_or(0);
        let (way, method) = (entry.wayfinder(), entry.compression_method());
        let is_encrypted = entry.flags().is_encrypted();
        found.push(Entry { plate: Plate { number, name }, way, method, is_encrypted });
    }
    found.sort_by(|a, b| (a.plate.number, &a.plate.name).cmp(&(b.plate.number, &b.plate.name)));
    let numbers: Vec<_> = found.iter().map(|entry| entry.plate.number).collect();
    let are_numbered = numbers.iter().all(|number| *number > 0) && numbers.windows(2).all(|pair| pair[0] < pair[1]);
    if !are_numbered {
        found.iter_mut().zip(1..).for_each(|(entry, number)| entry.plate.number = number);
    }
    Ok(Found { entries: found, packed })
}

/// The plates of an archive.
pub(crate) fn plates(from: impl Read + Seek) -> Result<Vec<Plate>, GcodeFileError> {
    let mut buffer = vec![0; RECOMMENDED_BUFFER_SIZE];
    let archive = ZipArchive::from_seekable(from, &mut buffer).map_err(|error| damaged(&error))?;
    Ok(entries(&archive)?.entries.into_iter().map(|entry| entry.plate).collect())
}

/// Hands the text of the chosen plate to `take`, or of the only one.
pub(crate) fn unpack(
    from: impl Read + Seek,
    chosen: Option<u32>,
    take: impl FnOnce(&mut dyn Read) -> Result<(), GcodeFileError>,
) -> Result<(), GcodeFileError> {
    let mut buffer = vec![0; RECOMMENDED_BUFFER_SIZE];
    let archive = ZipArchive::from_seekable(from, &mut buffer).map_err(|error| damaged(&error))?;
    let Found { entries: mut found, packed } = entries(&archive)?;
    let plates = |found: Vec<Entry>| found.into_iter().map(|entry| entry.plate).collect();
    let at = match (chosen, found.len()) {
        (_, 0) => return Err(packed.map_or(GcodeFileError::Unsliced, GcodeFileError::Nested)),
        (None, 1) => 0,
        (None, _) => return Err(GcodeFileError::Several(plates(found))),
        (Some(number), _) => match found.iter().position(|entry| entry.plate.number == number) {
            Some(at) => at,
            None => return Err(GcodeFileError::NoPlate(number, plates(found))),
        },
    };
    let Entry { plate, way, method, is_encrypted } = found.swap_remove(at);
    if is_encrypted {
        return Err(GcodeFileError::Unknown(format!("{} in it has a password", plate.name)));
    }
    let entry = archive.get_entry(way).map_err(|error| damaged(&error))?;
    match method {
        CompressionMethod::STORE => take(&mut entry.verifying_reader(entry.reader())),
        CompressionMethod::DEFLATE => take(&mut entry.verifying_reader(DeflateDecoder::new(entry.reader()))),
        other => Err(GcodeFileError::Unknown(format!("{} in it is packed as {other}", plate.name))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// An archive of one empty file, after APPNOTE.TXT 4.3.
    fn archive(name: &str) -> Vec<u8> {
        let length = (name.len() as u16).to_le_bytes();
        let part = |mark: &[u8], zeros: [usize; 2]| {
            [mark, &vec![0; zeros[0]], &length, &vec![0; zeros[1]], name.as_bytes()].concat()
        };
        let (file, entry) = (part(b"PK\x03\x04", [22, 2]), part(b"PK\x01\x02", [24, 16]));
        let [at, size] = [file.len() as u32, entry.len() as u32].map(u32::to_le_bytes);
        let end = [&b"PK\x05\x06\0\0\0\0\x01\0\x01\0"[..], &size, &at, b"\0\0"].concat();
        [file, entry, end].concat()
    }

    /// Reproducer: "there is no G-code in this archive" was said of one with a .bgcode.
    #[test]
    fn a_packed_file_in_an_archive_is_named() {
        let of = |name: &str| unpack(Cursor::new(archive(name)), None, |_| Ok(())).map_err(|error| error.to_string());
        assert_eq!(of("a.gcode"), Ok(()));
        for (name, said) in [
            ("Part.BGCODE", "in it is binary G-code (.bgcode); unpack it first"),
            ("part.gcode.gz", "in it is a file packed by gzip; unpack it first"),
            ("part.3mf", "in it is a ZIP archive (.3mf, .zip); unpack it first"),
            ("readme.txt", "there is no G-code in this archive: slice the project, and export the sliced file"),
            (
                "__MACOSX/part.bgcode",
                "there is no G-code in this archive: slice the project, and export the sliced file",
            ),
        ] {
            assert_eq!(of(name), Err(said.to_owned()), "{name}");
        }
    }
}
