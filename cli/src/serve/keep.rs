//! Where a served printer keeps its settings: as a board does, it finds them again after it was switched off.
//!
//! Each machine has an EEPROM of its own in the user's folder for data (XDG Base Directory Specification, which needs
//! no crate). Its name ends with a digest of the machine, so an edited machine file begins with an empty one: what was
//! stored for the old machine would hide the edit.

use anyhow::{Context as _, Result};
use corehbot::settings::Settings;
use corehbot::storage::{LONGEST, record_of};
use corehbot_host::say::note;
use corehbot_machine_file::printable;
use corehbot_sim::eeprom::Eeprom;
use sha2::{Digest as _, Sha256};
use std::env::var_os;
use std::fmt::Write as _;
use std::fs::{File, create_dir_all};
use std::path::{Path, PathBuf};

/// The folder within the one for data.
const FOLDER: &str = "corehbot";

/// Bytes of the digest in a name: two machines of one name differ in it.
const DIGEST: usize = 4;

/// The user's folder for data, if the surroundings say one.
fn data() -> Option<PathBuf> {
    let absolute = |name: &str| var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    absolute("XDG_DATA_HOME").or_else(|| Some(absolute("HOME")?.join(".local/share")))
}

/// The EEPROM of a machine, and the lock on its file; it says where that is. A printer without one is served too, and
/// says why.
pub(super) fn eeprom(name: Option<&str>, machine: &Settings) -> (Option<Eeprom>, Option<File>) {
    let Some(path) = image(name, machine) else {
        note("corehbot: settings are not kept: HOME names no folder (--storage E.bin keeps them)");
        return (None, None);
    };
    let shown = path.display().to_string();
    let shown = printable::line(&shown);
    match opened(&path) {
        Ok(Some((eeprom, lock))) => {
            note(format_args!("corehbot: settings are kept in {shown} (--storage none keeps nothing)"));
            (Some(eeprom), Some(lock))
        }
        Ok(None) => {
            note(format_args!("corehbot: settings are not kept: another printer is served with {shown}"));
            (None, None)
        }
        Err(error) => {
            note(format_args!("corehbot: settings are not kept: {}", printable::line(&format!("{error:#}"))));
            (None, None)
        }
    }
}

/// The EEPROM and its lock; `None` if another printer has it.
fn opened(path: &Path) -> Result<Option<(Eeprom, File)>> {
    if let Some(folder) = path.parent() {
        create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    }
    // Before it is read.
    let lock = path.with_extension("lock");
    let lock = File::create(&lock).with_context(|| format!("cannot create {}", lock.display()))?;
    if lock.try_lock().is_err() {
        return Ok(None);
    }
    Ok(Some((Eeprom::open(path)?, lock)))
}

/// The image of a machine's EEPROM.
fn image(name: Option<&str>, machine: &Settings) -> Option<PathBuf> {
    let mut record = [0; LONGEST];
    let length = record_of(machine, &mut record)?;
    let name: String =
        name.unwrap_or("machine").chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let mut file = name.to_ascii_lowercase();
    file.push('-');
    for byte in Sha256::digest(&record[..length]).iter().take(DIGEST) {
        let _ = write!(file, "{byte:02x}");
    }
    Some(data()?.join(FOLDER).join(file + ".eeprom"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_printer_at_a_time_has_an_image() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/x.eeprom");
        let first = opened(&path).unwrap().unwrap();
        assert!(opened(&path).unwrap().is_none());
        drop(first);
        assert!(opened(&path).unwrap().is_some());
    }

    #[test]
    fn every_machine_has_an_image_of_its_own() {
        let first = Settings::prototype();
        let second = Settings { keepalive_s: first.keepalive_s + 1, ..first };
        let of = |name: &str, machine: &Settings| image(Some(name), machine).unwrap();
        let path = of("My CoreXY/2", &first);
        let file = path.file_name().unwrap().to_str().unwrap();
        assert!(file.starts_with("my-corexy-2-") && file.len() == "my-corexy-2-12345678.eeprom".len(), "{file}");
        assert_ne!(path, of("My CoreXY/2", &second));
        assert_eq!(path, of("My CoreXY/2", &first));
        assert_eq!(path.parent().unwrap().file_name().unwrap(), "corehbot");
    }
}
