//! Lanes: two rows of steps side by side, because much of the work keeps one processor busy: linking, the longest of
//! some tests, a waiting client.
//!
//! Shared dependencies are built before the lanes begin, and the emulator has a build folder of its own, so neither
//! lane waits for the other's cargo for long. The second lane is a process of its own. Its output is kept in a file
//! until the first lane has ended, and then shown as it comes.

use crate::checkout::target_dir;
use anyhow::{Context as _, Result};
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Time between two reads of the second lane's output.
const LOOK: Duration = Duration::from_millis(200);

/// The second lane under way.
pub struct Images {
    process: Child,
    words: PathBuf,
    results: PathBuf,
}

/// Begins the steps on the images.
pub fn begin() -> Result<Images> {
    let folder = target_dir()?.join("test");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let (words, results) = (folder.join("images.log"), folder.join("images.results"));
    // Results of an earlier run do not count for this one.
    if results.exists() {
        std::fs::remove_file(&results).with_context(|| format!("cannot remove {}", results.display()))?;
    }
    let file = File::create(&words).with_context(|| format!("cannot write {}", words.display()))?;
    let mut command = Command::new(std::env::current_exe().context("cannot find this program's own path")?);
    command.args(["test", "--images"]).arg(&results).stdin(Stdio::null()).stderr(file.try_clone()?).stdout(file);
    let process = command.spawn().context("cannot run this program again")?;
    println!("\nmeanwhile the images are tested, of which {} tells", words.display());
    Ok(Images { process, words, results })
}

impl Images {
    /// Shows the output of the steps until they have ended, and returns their results.
    pub fn end(mut self) -> Result<String> {
        let mut words = File::open(&self.words).with_context(|| format!("cannot open {}", self.words.display()))?;
        loop {
            // Asked first, so that nothing is said after the last look.
            let status = self.process.try_wait()?;
            let mut news = Vec::new();
            words.read_to_end(&mut news)?;
            std::io::stdout().write_all(&news)?;
            if status.is_some() {
                break;
            }
            std::thread::sleep(LOOK);
        }
        std::fs::read_to_string(&self.results).context("the steps on the images did not come to their end")
    }
}

impl Drop for Images {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
