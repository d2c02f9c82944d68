//! Lanes: rows of steps side by side, because much of the work keeps one processor busy: linking, the longest of
//! some tests, a waiting client.
//!
//! Images and the page are built in folders of their own, while this computer's programs are built in theirs. A lane
//! that needs a program then waits for the cargo that builds it. Each further lane is a process of its own. Its output
//! is kept in a file until the lane that began it has ended, and then shown as it comes.

use super::Lane;
use crate::checkout::target_dir;
use anyhow::{Context as _, Result};
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Time between two reads of a further lane's output.
const LOOK: Duration = Duration::from_millis(200);

/// A further lane under way.
pub struct Further {
    process: Child,
    words: PathBuf,
    results: PathBuf,
}

/// Begins the steps of a lane.
pub fn begin(lane: Lane) -> Result<Further> {
    let name = lane.name();
    let folder = target_dir()?.join("test");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let (words, results) = (folder.join(format!("{name}.log")), folder.join(format!("{name}.results")));
    // Results of an earlier run do not count for this one.
    if results.exists() {
        std::fs::remove_file(&results).with_context(|| format!("cannot remove {}", results.display()))?;
    }
    let file = File::create(&words).with_context(|| format!("cannot write {}", words.display()))?;
    let mut command = Command::new(std::env::current_exe().context("cannot find this program's own path")?);
    command
        .args(["test", "--lane", name, "--results"])
        .arg(&results)
        .stdin(Stdio::null())
        .stderr(file.try_clone()?)
        .stdout(file);
    let process = command.spawn().context("cannot run this program again")?;
    println!("\nmeanwhile other steps run ({name}): {} has their output", words.display());
    Ok(Further { process, words, results })
}

impl Further {
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
        std::fs::read_to_string(&self.results).context("a lane of steps did not come to its end")
    }
}

impl Drop for Further {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
