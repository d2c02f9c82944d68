//! Images of boards: how they are built, and where they are.

use crate::checkout::{FLAGS, TARGET, cargo, path_flags, root, run, target_dir};
use anyhow::{Context as _, Result, ensure};
use std::path::PathBuf;
use std::process::Command;

/// The profile that images are built with.
pub const FIRMWARE: &str = "firmware";

/// A board's image.
pub fn image(package: &str) -> Result<PathBuf> {
    Ok(target_dir()?.join(TARGET).join(FIRMWARE).join(package))
}

/// Packages of the boards that have a processor of their own, which is said in their `.cargo/config.toml`.
pub fn boards() -> Result<Vec<String>> {
    let dir = root().join("boards");
    let mut boards = Vec::new();
    for entry in std::fs::read_dir(&dir).with_context(|| format!("cannot list {}", dir.display()))? {
        let entry = entry?;
        let [has_target, is_linked] = [".cargo/config.toml", "build.rs"].map(|file| entry.path().join(file).exists());
        ensure!(
            has_target || !is_linked,
            "{} has no .cargo/config.toml, which names its processor",
            entry.path().display()
        );
        if has_target {
            boards.push(format!("corehbot-{}", entry.file_name().to_string_lossy()));
        }
    }
    boards.sort();
    Ok(boards)
}

/// Builds the image of a board and says where it is.
pub fn build_image(package: &str) -> Result<PathBuf> {
    let mut build = for_boards("build")?;
    build.args(["--package", package]);
    run(build)?;
    image(package)
}

/// Cargo's `task` for images.
pub fn for_boards(task: &str) -> Result<Command> {
    let mut command = cargo([task, "--profile", FIRMWARE, "--target", TARGET]);
    command.env(FLAGS, [path_flags()?.as_str(), OUTLINER[0], OUTLINER[1]].join("\x1f"));
    Ok(command)
}

/// At the least size, LLVM puts parts that functions share into functions of their own: the outliner. Without a bound
/// it saves 6.5 KB of the Octopus's image, but a line takes 3 % and an event 5 % more instructions. The bound is the
/// bytes that a part must save.
///
/// | bound | saved | a line | a move in the planner | an event |
/// |---|---|---|---|---|
/// | 16 | 4.5 KB | +1.1 % | +12.5 % | +2.2 % |
/// | 40 | 2.8 KB | +0.3 % | +0.4 % | 0 |
/// | 60 | 1.6 KB | -0.1 % | -0.8 % | 0 |
const OUTLINER: [&str; 2] = ["-C", "llvm-args=-enable-machine-outliner=always -outliner-benefit-threshold=60"];
