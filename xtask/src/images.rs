//! Images: built with the compiler's own description of the processor, but without its frame pointer.
//!
//! The compiler's target keeps register r7 as a frame pointer in every function. Nothing here reads it: debuggers unwind
//! by the debug information. Without it the Octopus's image is 16.7 KB smaller, and functions have a register more:
//!
//! | | with | without |
//! |---|---|---|
//! | instructions of the step interrupt, an event | 91.9 | 87.9 |
//! | of the protocol, a line | 6,171 | 5,906 |
//! | from a fault to heaters that are off | 28 | 21 |
//! | share of the processor in the job `s`, with a mesh | 4.39 % | 4.31 % |
//!
//! `cpu = "cortex-m4"` in the description gives 0.1 KB and makes a step pulse a cycle longer; the core library's shorter
//! algorithms give 0.3 KB and slower divisions. Both were left out.
//!
//! A description of our own and a core library that is built with it are unstable in cargo and rustc. Both accept them
//! on the stable toolchain if they are told so ([`ACCEPTS_UNSTABLE`]), as Linux builds its Rust code
//! (Documentation/rust/general-information.rst). The core library comes as source, by rustup.

use crate::checkout::{FLAGS, TARGET, cargo, command_output, compiler, path_flags, root, run, target_dir};
use crate::rustup;
use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::Command;

/// The profile that images are built with.
pub const FIRMWARE: &str = "firmware";

/// The variable by which cargo and rustc accept what is unstable.
const ACCEPTS_UNSTABLE: &str = "RUSTC_BOOTSTRAP";

/// The key of the frame pointer in a description of a target.
const FRAME_POINTER: &str = "frame-pointer";

/// The core library is built like the image.
const WITH_CORE: [&str; 4] = ["-Z", "json-target-spec", "-Z", "build-std=core,alloc"];

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
    rustup::ensure_core_source()?;
    let mut command = cargo([task, "--profile", FIRMWARE, "--target"]);
    command.arg(describe()?).args(WITH_CORE).env(ACCEPTS_UNSTABLE, "1");
    let flags: Vec<_> = [path_flags()?.as_str()].into_iter().chain(OUTLINER).chain(NAMES).map(str::to_owned).collect();
    command.env(FLAGS, flags.join("\x1f"));
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

/// Names of functions as the stable compiler writes them: in the other form the lists of sizes name every port.
const NAMES: [&str; 2] = ["-Zunstable-options", "-Csymbol-mangling-version=legacy"];

/// Writes the description of the processor, and says where it is. Cargo names the folder of the images after it.
fn describe() -> Result<PathBuf> {
    let mut rustc = compiler(&["-Z", "unstable-options", "--print", "target-spec-json", "--target", TARGET]);
    rustc.env(ACCEPTS_UNSTABLE, "1");
    let said = command_output(rustc)?;
    let mut target: Value = serde_json::from_str(&said).context("the compiler's description of the processor")?;
    let kept = target.get_mut(FRAME_POINTER).context("the compiler's description has no frame pointer")?;
    *kept = json!("may-omit");
    let text = format!("{target:#}\n");
    let folder = target_dir()?.join("processor");
    let path = folder.join(TARGET).with_extension("json");
    // Cargo builds all anew if the file is newer.
    if std::fs::read_to_string(&path).is_ok_and(|there| there == text) {
        return Ok(path);
    }
    let write = || std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, text));
    write().with_context(|| format!("cannot write {}", path.display()))?;
    Ok(path)
}
