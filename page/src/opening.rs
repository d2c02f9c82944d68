//! Opening: what a chosen file is by its content, and the G-code in it.

use anyhow::Result;
use corehbot_gcode_file::{Plate, Unpacked, plates, unpack};
use corehbot_machine_file::file_kind::{FileKind, START, Wanted};
use serde::Serialize;
use std::io::Cursor;

/// Bytes of the text in a packed file. A browser gives a page 4 GiB, and the text is kept more than once.
const MOST: u64 = 512 << 20;

/// What the page does with a file.
#[derive(Serialize)]
struct Told {
    /// `gcode`, `machine`, or neither.
    kind: Option<&'static str>,
    /// Numbers of plates, if there are several to choose from.
    plates: Vec<u32>,
    /// Why the file is of no use here, and where it is.
    trouble: Option<String>,
}

/// What a file of `length` bytes is, as JSON: by its begin, or by all of it if it is an archive. Browsers cannot read
/// folders.
#[must_use]
pub fn told(begin: Option<&[u8]>, length: u64, is_machine_wanted: bool) -> String {
    let wanted = if is_machine_wanted { Wanted::Machine } else { Wanted::Gcode };
    let kind = begin.map_or(FileKind::Folder, |begin| FileKind::of(&begin[..begin.len().min(START)], length));
    let trouble = |trouble: String| Told { kind: None, plates: Vec::new(), trouble: Some(trouble) };
    let told = match (kind, wanted.check(kind)) {
        (FileKind::MachineFile, _) => Told { kind: Some("machine"), plates: Vec::new(), trouble: None },
        (_, Err(wrong)) => trouble(wrong.to_string()),
        (FileKind::Zip, Ok(())) => match plates(Cursor::new(begin.unwrap_or_default())) {
            Ok(plates) => {
                let plates = plates.iter().map(|Plate { number, .. }| *number).collect();
                Told { kind: Some("gcode"), plates, trouble: None }
            }
            Err(error) => trouble(error.to_string()),
        },
        (_, Ok(())) => Told { kind: Some("gcode"), plates: Vec::new(), trouble: None },
    };
    serde_json::to_string(&told).unwrap_or_default()
}

/// The text of G-code, whatever packs it.
///
/// # Errors
/// It is none, damaged, too long, or the plate is to choose.
pub fn text(file: Vec<u8>, plate: Option<u32>) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    match unpack(Cursor::new(&file), &mut text, plate, MOST)? {
        Unpacked::AsItIs => Ok(file),
        Unpacked::Written => Ok(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(file: &[u8]) -> serde_json::Value {
        serde_json::from_str(&told(Some(file), file.len() as u64, false)).unwrap()
    }

    #[test]
    fn a_file_is_known_by_its_content() {
        assert_eq!(kind(b"G28\n"), serde_json::json!({ "kind": "gcode", "plates": [], "trouble": null }));
        assert_eq!(kind(b"[axes.x]\nlength = 5\n")["kind"], "machine");
        let klipper = kind(b"[printer]\nkinematics: corexy\n");
        let words = "this is Klipper's printer.cfg, not G-code: `corehbot config from FILE` makes a machine file of it";
        assert_eq!((&klipper["kind"], &klipper["trouble"]), (&serde_json::Value::Null, &words.into()));
        assert!(told(None, 0, false).contains("this is a folder, not G-code"));
        assert!(told(Some(b"G28\n"), 4, true).contains("this is G-code, not a machine file"));
        assert!(kind(b"PK\x03\x04")["trouble"].as_str().unwrap().contains("damaged"));
    }

    #[test]
    fn text_is_taken_as_it_is_and_old_ends_of_lines_are_ends() {
        assert_eq!(text(b"G28\n".to_vec(), None).unwrap(), b"G28\n");
        assert_eq!(text(b";x\rG28\r".to_vec(), None).unwrap(), b";x\nG28\n");
        assert!(text(b"G28\n".to_vec(), Some(2)).is_err());
    }
}
