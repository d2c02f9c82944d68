//! Serial ports of this computer: which there are, and why one cannot be opened.

use rustix::io::Errno;
use std::fs::{metadata, read_dir, read_to_string};
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;

/// Where ports of printers are, by the beginnings of their names: first the names that stay the same.
const PLACES: [(&str, &str); 6] = [
    ("/dev/serial/by-id", ""),
    ("/dev", "ttyACM"),
    ("/dev", "ttyUSB"),
    ("/dev", "ttyAMA"),
    ("/dev", "cu.usb"),
    ("/dev", "cu.wchusb"),
];

/// Why a serial line cannot be used, and the cure.
pub fn cannot_open(path: &Path, error: Errno) -> anyhow::Error {
    let why = match error {
        Errno::NOENT => format!("there is no such port; {}", there_are()),
        Errno::ACCESS | Errno::PERM => {
            let group = group_of(path).unwrap_or_else(|| "dialout".to_owned());
            format!("you may not use it: `sudo usermod -aG {group} $USER` puts you into its group, then log in again")
        }
        Errno::BUSY => "another program has it open: close OctoPrint, Pronterface or the slicer's monitor".to_owned(),
        Errno::NOTTY | Errno::ISDIR => format!("it is none; {}", there_are()),
        Errno::NXIO | Errno::NODEV | Errno::IO => format!("nothing is plugged in there; {}", there_are()),
        error => error.to_string(),
    };
    anyhow::anyhow!("cannot open {} as a serial line: {why}", path.display())
}

/// The ports that there are, in words.
fn there_are() -> String {
    let mut found = Vec::new();
    for (folder, beginning) in PLACES {
        let names =
            read_dir(folder).into_iter().flatten().filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        found.extend(names.filter(|name| name.starts_with(beginning)).map(|name| format!("{folder}/{name}")));
    }
    if found.is_empty() {
        return "this computer has none: plug in the USB cable, and switch the printer on".to_owned();
    }
    found.sort();
    format!("there are {}", found.join(", "))
}

/// The group that may use a port.
fn group_of(path: &Path) -> Option<String> {
    let wanted = metadata(path).ok()?.gid().to_string();
    let groups = read_to_string("/etc/group").ok()?;
    let mut groups = groups.lines().map(|line| line.split(':').collect::<Vec<_>>());
    let found = groups.find(|fields| fields.get(2) == Some(&wanted.as_str()))?;
    found.first().map(|name| (*name).to_owned()).filter(|name| name != "root")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_error_has_its_cure() {
        for (error, cure) in [
            (Errno::NOENT, "there is no such port; th"),
            (Errno::ACCESS, "sudo usermod -aG dialout $USER"),
            (Errno::BUSY, "close OctoPrint"),
            (Errno::NOTTY, "it is none; th"),
            (Errno::NXIO, "nothing is plugged in there"),
        ] {
            let said = cannot_open(Path::new("/dev/no-such-port"), error).to_string();
            assert!(
                said.starts_with("cannot open /dev/no-such-port as a serial line: ") && said.contains(cure),
                "{said}"
            );
        }
    }
}
