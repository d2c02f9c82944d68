//! What the page has inside as text: WebAssembly in base64, and the examples.

use crate::checkout::root;
use anyhow::{Context as _, Result};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;

/// Folders with files to print and machine files. The clients' files heat; no other ones do.
const FOLDERS: [&str; 4] = ["examples", "examples/belt", "examples/machines", "xtask/clients"];

/// The examples and the machine files, as a script.
pub(super) fn examples() -> Result<String> {
    let (mut gcode, mut machines) = (BTreeMap::new(), BTreeMap::new());
    for folder in FOLDERS {
        let folder = root().join(folder);
        for entry in fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let files = match path.extension().and_then(|kind| kind.to_str()) {
                Some("gcode") => &mut gcode,
                Some("toml") => &mut machines,
                _ => continue,
            };
            files.insert(name, fs::read_to_string(&path).with_context(|| format!("cannot open {}", path.display()))?);
        }
    }
    let all = serde_json::json!({ "gcode": gcode, "machines": machines });
    Ok(format!("'use strict';\nconst EXAMPLES = {all};\n"))
}

/// Bytes as DEFLATE (RFC 1951) in base64 (RFC 4648).
pub(super) fn deflated(bytes: &[u8]) -> Result<String> {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    let packed = encoder.finish()?;
    let mut text = String::with_capacity(packed.len().div_ceil(3) * 4);
    for three in packed.chunks(3) {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(three.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= three.len() { digit.into() } else { '=' });
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_are_all_there() {
        let script = examples().unwrap();
        for name in ["first-print.gcode", "skip-and-repair.gcode", "prototype.toml", "hbot.toml", "heat.toml"] {
            assert!(script.contains(&format!("\"{name}\":")), "{name}");
        }
    }
}
