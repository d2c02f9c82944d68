//! The archive: files in order, with one time and one owner, so that its bytes depend on the files alone.

use anyhow::Result;
use flate2::{Compression, GzBuilder};
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;

/// A file of the archive.
pub(super) struct File {
    /// Its path in the archive's folder, with slashes.
    pub path: String,
    pub bytes: Vec<u8>,
    pub is_program: bool,
}

/// Packs files into a folder of that name, with a file of their checksums; `time` is in seconds since 1970.
pub(super) fn archive(folder: &str, time: u64, files: &[File]) -> Result<Vec<u8>> {
    let mut files: Vec<&File> = files.iter().collect();
    files.sort_by(|a, b| a.path.cmp(&b.path));
    let sums = File { path: "SHA256SUMS".to_owned(), bytes: checksums(&files).into_bytes(), is_program: false };
    files.push(&sums);
    // A time in gzip's own header would be the current time.
    let compressed = GzBuilder::new().mtime(0).write(Vec::new(), Compression::best());
    let mut archive = tar::Builder::new(compressed);
    for file in files {
        let mut header = tar::Header::new_gnu();
        header.set_size(file.bytes.len() as u64);
        header.set_mode(if file.is_program { 0o755 } else { 0o644 });
        header.set_mtime(time);
        header.set_uid(0);
        header.set_gid(0);
        archive.append_data(&mut header, format!("{folder}/{}", file.path), &*file.bytes)?;
    }
    Ok(archive.into_inner()?.finish()?)
}

/// The checksums as `sha256sum --check` reads them.
fn checksums(files: &[&File]) -> String {
    files.iter().fold(String::new(), |mut text, file| {
        for byte in Sha256::digest(&file.bytes) {
            let _ = write!(text, "{byte:02x}");
        }
        let _ = writeln!(text, "  {}", file.path);
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read as _;

    fn file(path: &str, is_program: bool) -> File {
        File { path: path.to_owned(), bytes: path.as_bytes().to_vec(), is_program }
    }

    #[test]
    fn the_order_of_files_and_the_day_do_not_matter() {
        let there = archive("it", 1000, &[file("corehbot", true), file("images/a.bin", false)]).unwrap();
        let back = archive("it", 1000, &[file("images/a.bin", false), file("corehbot", true)]).unwrap();
        assert_eq!(there, back);
        let mut unpacked = tar::Archive::new(flate2::read::GzDecoder::new(&*there));
        let seen: Vec<_> = unpacked
            .entries()
            .unwrap()
            .map(|entry| {
                let mut entry = entry.unwrap();
                let mut text = String::new();
                entry.read_to_string(&mut text).unwrap();
                let header = entry.header();
                let path = entry.path().unwrap().to_string_lossy().into_owned();
                (path, header.mode().unwrap(), header.mtime().unwrap(), header.uid().unwrap(), text)
            })
            .collect();
        let sums = "79e8261b2ab870e5c3c8ecd12aa19672e6fa65a208b18ddd895fe0ce07a76031";
        assert_eq!(seen[0], ("it/corehbot".to_owned(), 0o755, 1000, 0, "corehbot".to_owned()));
        assert_eq!(seen[1].0, "it/images/a.bin");
        assert_eq!(seen[2].4.lines().next().unwrap().split_once("  ").unwrap(), (sums, "corehbot"));
    }
}
