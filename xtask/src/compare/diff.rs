//! The first difference between two traces, said so that one can look for its cause.

use anyhow::{Context as _, Result};
use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::Path;

/// The first difference, or `None` if the files are equal byte for byte.
pub fn first(expected: &Path, found: &Path) -> Result<Option<String>> {
    let (mut expected, mut found) = (open(expected)?, open(found)?);
    for number in 1_u64.. {
        match (line(&mut expected)?, line(&mut found)?) {
            (None, None) => break,
            (expected, found) if expected == found => {}
            (Some(expected), Some(found)) => {
                return Ok(Some(format!("line {number} is `{found}` and should be `{expected}`")));
            }
            (Some(expected), None) => {
                return Ok(Some(format!("line {number} is missing, it should be `{expected}`")));
            }
            (None, Some(found)) => {
                return Ok(Some(format!("line {number}, `{found}`, is one too many")));
            }
        }
    }
    Ok(None)
}

fn open(path: &Path) -> Result<BufReader<File>> {
    let file = File::open(path).with_context(|| format!("cannot open {}", path.display()))?;
    Ok(BufReader::with_capacity(1 << 16, file))
}

/// The next line, its end made visible if it is not a plain newline.
fn line(file: &mut BufReader<File>) -> Result<Option<String>> {
    let mut bytes = Vec::new();
    if file.read_until(b'\n', &mut bytes)? == 0 {
        return Ok(None);
    }
    let text = bytes.strip_suffix(b"\n").map_or_else(|| [&bytes[..], b" (no line end)"].concat(), <[u8]>::to_vec);
    Ok(Some(String::from_utf8_lossy(&text).into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compare(expected: &str, found: &str) -> Option<String> {
        let folder = std::env::temp_dir();
        let paths = ["a", "b"].map(|name| folder.join(format!("corehbot-diff-{}-{name}", std::process::id())));
        for (path, text) in paths.iter().zip([expected, found]) {
            std::fs::write(path, text).unwrap();
        }
        let difference = first(&paths[0], &paths[1]).unwrap();
        paths.iter().for_each(|path| std::fs::remove_file(path).unwrap());
        difference
    }

    #[test]
    fn the_first_line_that_differs_is_named() {
        assert_eq!(compare("1,0\n2,1\n", "1,0\n2,1\n"), None);
        assert_eq!(compare("1,0\n2,1\n", "1,0\n3,1\n").unwrap(), "line 2 is `3,1` and should be `2,1`");
        assert_eq!(compare("1,0\n2,1\n", "1,0\n").unwrap(), "line 2 is missing, it should be `2,1`");
        assert_eq!(compare("1,0\n", "1,0\n2,1\n").unwrap(), "line 2, `2,1`, is one too many");
    }
}
