//! `cargo xtask bundle`: uPlot's committed files against its release on npm, and its script made again.
//!
//! npm fetches the versions of `xtask/bundle/package-lock.json` and checks their SHA-512. The release has its script
//! twice: as a text to read, and shortened. The committed script must be the shortened one, and the same bytes must
//! come from the text to read, by the tool and the options that uPlot's own build has. The tool's version matters:
//! terser 5.31.6 makes the released bytes. Versions 5.34.1 to 5.39.0 make 11 less: they write a constant, not its name.
//!
//! The text to read is what rollup puts together from uPlot's sources, which are not on npm. The style is not made
//! again: its source is not there either.

use crate::checkout::{command_output, root, run, target_dir};
use crate::tools::succeeds;
use anyhow::{Context as _, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The client of the registry.
const NPM: &str = "npm";

/// What it fetches, and the SHA-512 of each package.
const WANTED: &str = "xtask/bundle";

/// The files of that folder.
const LISTS: [&str; 2] = ["package.json", "package-lock.json"];

/// The committed files.
const COMMITTED: &str = "report/src/viewer/uplot";

/// Each of them, and where it is in the release.
const FILES: [(&str, &str); 3] =
    [("LICENSE", "LICENSE"), (SCRIPT, "dist/uPlot.iife.min.js"), ("uPlot.min.css", "dist/uPlot.min.css")];

/// The script.
const SCRIPT: &str = "uPlot.iife.min.js";

/// Where npm unpacks the release.
const RELEASE: &str = "node_modules/uplot";

/// The script to read.
const READABLE: &str = "node_modules/uplot/dist/uPlot.iife.js";

/// The script made again.
const MADE: &str = "made.js";

/// Options of terser in uPlot's `rollup.config.js`.
const OPTIONS: [&str; 3] = [
    "--mangle",
    "--compress",
    "inline=0,passes=2,keep_fargs=false,pure_getters=true,unsafe=true,unsafe_comps=true,unsafe_math=true,unsafe_undefined=true",
];

/// Compares, or says that npm is missing.
pub fn main() -> Result<()> {
    ensure!(has_npm(), "{}", lack_of_npm());
    println!("{}", check()?);
    Ok(())
}

/// Whether npm can be called.
pub fn has_npm() -> bool {
    let mut npm = Command::new(NPM);
    npm.arg("--version");
    succeeds(npm)
}

/// The hint about a missing npm.
pub fn lack_of_npm() -> String {
    format!("{NPM} is missing; install it with: sudo apt-get install {NPM}")
}

/// Fetches, makes the script again, and compares; says what is the same.
pub fn check() -> Result<String> {
    let folder = fetch_and_make()?;
    for (name, path) in FILES {
        ensure_same(name, &folder.join(RELEASE).join(path), "the file of the release on npm")?;
    }
    ensure_same(SCRIPT, &folder.join(MADE), "the script made again from the release's text")?;
    let count = FILES.len();
    Ok(format!("{count} files of uPlot are those of its release, and its script, made again, has the same bytes"))
}

/// Fetches the packages and makes the script, unless that is done; returns the folder.
fn fetch_and_make() -> Result<PathBuf> {
    let folder = target_dir()?.join("bundle");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let mut wanted = OPTIONS.concat().into_bytes();
    for name in LISTS {
        let bytes = read(&root().join(WANTED).join(name))?;
        fs::write(folder.join(name), &bytes).with_context(|| format!("cannot write {name}"))?;
        wanted.extend(bytes);
    }
    let complete = folder.join("complete");
    if fs::read(&complete).is_ok_and(|made| made == wanted) {
        return Ok(folder);
    }
    let mut npm = Command::new(NPM);
    // Scripts of packages are not run. A missing network should show soon.
    npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error", "--fetch-retries=1"]);
    npm.current_dir(&folder).stdout(Stdio::null());
    run(npm).context("npm fetches uPlot and terser, which takes a network the first time")?;
    let mut terser = Command::new("node");
    terser.args(["node_modules/terser/bin/terser", READABLE]).args(OPTIONS).current_dir(&folder);
    let script = command_output(terser)?;
    // uPlot's build writes a line before terser's text.
    let version = version(&read(&folder.join("package.json"))?)?;
    let made = format!("/*! https://github.com/leeoniya/uPlot (v{version}) */\n{}\n", script.trim_end());
    fs::write(folder.join(MADE), made).and_then(|()| fs::write(complete, wanted)).context("cannot write there")?;
    Ok(folder)
}

/// The version of uPlot that a list of packages wants.
fn version(list: &[u8]) -> Result<String> {
    let list: serde_json::Value = serde_json::from_slice(list)?;
    let version = list["dependencies"]["uplot"].as_str().context("the list of packages has no uplot")?;
    Ok(version.to_owned())
}

/// Fails where two files differ, with the place.
fn ensure_same(name: &str, other: &Path, what: &str) -> Result<()> {
    let differs = difference(&read(&root().join(COMMITTED).join(name))?, &read(other)?);
    differs.map_or(Ok(()), |differs| bail!("{COMMITTED}/{name} differs from {what} at {differs}"))
}

/// Where two texts differ, and how they go on there.
fn difference(one: &[u8], other: &[u8]) -> Option<String> {
    let place = one.iter().zip(other).position(|(one, other)| one != other);
    let place = place.or_else(|| (one.len() != other.len()).then(|| one.len().min(other.len())))?;
    let [one, other] = [one, other].map(|text| {
        let rest = text.get(place..text.len().min(place + 30)).unwrap_or_default();
        format!("{:?} of {} bytes", String::from_utf8_lossy(rest), text.len())
    });
    Some(format!("byte {place}: {one}, {other}"))
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("cannot open {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_told_with_its_place() {
        let told = |one: &str, other: &str| difference(one.as_bytes(), other.as_bytes());
        assert_eq!(told("same", "same"), None);
        assert_eq!(told("abc", "abd").unwrap(), "byte 2: \"c\" of 3 bytes, \"d\" of 3 bytes");
        assert_eq!(told("abc", "ab").unwrap(), "byte 2: \"c\" of 3 bytes, \"\" of 2 bytes");
    }

    #[test]
    fn the_version_to_fetch_is_the_committed_one() {
        let version = version(&read(&root().join(WANTED).join(LISTS[0])).unwrap()).unwrap();
        let script = fs::read_to_string(root().join(COMMITTED).join(SCRIPT)).unwrap();
        assert!(script.starts_with(&format!("/*! https://github.com/leeoniya/uPlot (v{version}) */\n")), "{version}");
    }
}
