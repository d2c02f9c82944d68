//! The tools: downloads missing ones on a fresh machine.

use crate::checkout::{BROWSER, GUEST, TARGET, cargo, run, sysroot, target_dir};
use crate::qemu::PROGRAM;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result};
use std::fs::File;
use std::process::{Command, Stdio};

/// The package that holds the emulator.
const PACKAGE: &str = "qemu-system-arm";

/// Downloads missing tools.
pub fn ensure() -> Result<Verdict> {
    for component in ["rustfmt", "clippy"] {
        let subcommand = component.trim_start_matches("rust");
        if !succeeds(cargo([subcommand, "--version"])) {
            run(rustup(["component", "add", component])).with_context(|| {
                format!("{component} is missing; install it with: rustup component add {component}")
            })?;
        }
    }
    for target in [TARGET, BROWSER, GUEST] {
        if !has_target(target)? {
            run(rustup(["target", "add", target]))
                .with_context(|| format!("the target is missing; install it with: rustup target add {target}"))?;
        }
    }
    if !has_emulator() {
        install(PACKAGE)?;
    }
    Ok(if has_emulator() { Verdict::Passed(String::new()) } else { Verdict::Skipped(lack_of_emulator()) })
}

/// Whether the emulator can be called.
pub fn has_emulator() -> bool {
    let mut command = Command::new(PROGRAM);
    command.arg("--version");
    succeeds(command)
}

/// The hint about a missing emulator.
pub fn lack_of_emulator() -> String {
    format!("{PROGRAM} is missing; install it with: sudo apt-get install {PACKAGE}")
}

/// The root user gets a package of Debian; other users get a hint. Lanes that need packages at the same time wait for
/// each other, since a second apt-get fails at once, and for a computer that updates itself.
pub fn install(package: &str) -> Result<()> {
    if !is_root() {
        return Ok(());
    }
    let place = target_dir()?.join("packages.lock");
    let lock = File::create(&place).with_context(|| format!("cannot write {}", place.display()))?;
    lock.lock().with_context(|| format!("cannot lock {}", place.display()))?;
    let mut update = Command::new("apt-get");
    update.arg("update");
    let mut install = Command::new("apt-get");
    install.args(["--option", "DPkg::Lock::Timeout=300", "install", "--yes", "--no-install-recommends", package]);
    install.env("DEBIAN_FRONTEND", "noninteractive");
    for mut command in [update, install] {
        command.stdout(Stdio::null());
        run(command)
            .with_context(|| format!("{package} is missing; install it with: sudo apt-get install {package}"))?;
    }
    Ok(())
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

/// Whether the compiler has a standard library for a target, from rustup or elsewhere.
fn has_target(target: &str) -> Result<bool> {
    Ok(sysroot()?.join("lib/rustlib").join(target).is_dir())
}

fn rustup<const N: usize>(args: [&str; N]) -> Command {
    let mut command = Command::new("rustup");
    command.args(args);
    command
}

/// Whether a program ends well.
pub fn succeeds(mut command: Command) -> bool {
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
