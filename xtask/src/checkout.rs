//! The checkout: where things are, and how cargo is called for them.

use anyhow::{Context as _, Result, bail};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The target of the boards' processors.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The target of browsers.
pub const BROWSER: &str = "wasm32-unknown-unknown";

/// The target of the program on the computer that has the board on its USB cable. It needs no C library.
pub const GUEST: &str = "x86_64-unknown-linux-musl";

/// The workspace's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Cargo's build folder: this program lies in `<target>/debug`.
pub fn target_dir() -> Result<PathBuf> {
    let program = std::env::current_exe().context("cannot find this program's own path")?;
    let dir = program.ancestors().nth(2).context("this program lies in no target folder")?;
    Ok(dir.to_owned())
}

/// Builds `corehbot` for this computer and says where it is. Together with xtask it is built with the dependencies that
/// are there already.
pub fn build_command() -> Result<PathBuf> {
    run(cargo(["build", "--package", "corehbot-cli", "--package", "xtask"]))?;
    Ok(target_dir()?.join("debug").join("corehbot").with_extension(std::env::consts::EXE_EXTENSION))
}

/// Builds `corehbot-lab` in the same way.
pub fn build_laboratory() -> Result<PathBuf> {
    run(cargo(["build", "--package", "corehbot-lab", "--package", "xtask"]))?;
    Ok(target_dir()?.join("debug").join("corehbot-lab").with_extension(std::env::consts::EXE_EXTENSION))
}

/// The variable that hands flags on to the compiler; paths in them may have spaces.
pub const FLAGS: &str = "CARGO_ENCODED_RUSTFLAGS";

/// Flags, in the form of [`FLAGS`], that remove the build folder from all binaries. The same source then gives the same
/// bytes in every folder, and images are tested as they are released. Paths of our own files are relative to the root
/// by themselves.
pub fn path_flags() -> Result<String> {
    let home = cargo_home()?;
    let places =
        [(home.join("registry/src"), "registry"), (home.join("git/checkouts"), "git"), (target_dir()?, "target")];
    let flags = places.map(|(path, name)| format!("--remap-path-prefix={}={name}", path.display()));
    Ok(flags.join("\x1f"))
}

/// Cargo's folder for downloads.
pub fn cargo_home() -> Result<PathBuf> {
    let set = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    set.or_else(|| std::env::home_dir().map(|home| home.join(".cargo"))).context("cannot find cargo's folder")
}

/// The folder of the compiler and its libraries.
pub fn sysroot() -> Result<PathBuf> {
    Ok(PathBuf::from(command_output(compiler(&["--print", "sysroot"]))?.trim()))
}

/// The compiler, asked for something.
pub fn compiler(args: &[&str]) -> Command {
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.args(args).current_dir(root());
    rustc
}

/// This computer, as the compiler calls it.
pub fn host() -> Result<String> {
    let said = command_output(compiler(&["-vV"]))?;
    let host = said.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc does not say what computer this is")?.to_owned())
}

/// The compiler's name and version.
pub fn version_of_compiler() -> Result<String> {
    Ok(command_output(compiler(&["--version"]))?.trim().to_owned())
}

/// Cargo in the root, as the user called it.
///
/// Cargo tells this program of its own package by variables. A build script that reads them (ring's) would run again at
/// each change from a user's cargo to this one, and all that needs it would be built again, this program too. So they
/// are not handed on.
pub fn cargo<I: IntoIterator<Item = S>, S: AsRef<OsStr>>(args: I) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args).current_dir(root());
    for (name, _) in std::env::vars_os() {
        if ["CARGO_PKG_", "CARGO_MANIFEST_"].iter().any(|begin| name.to_string_lossy().starts_with(begin)) {
            command.env_remove(name);
        }
    }
    command
}

/// Runs a command that has to succeed.
pub fn run(mut command: Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot run {}", words(&command)))?;
    if !status.success() {
        bail!("{} failed: {status}", words(&command));
    }
    Ok(())
}

/// The output of a command that has to succeed.
pub fn command_output(mut command: Command) -> Result<String> {
    let output = command.output().with_context(|| format!("cannot run {}", words(&command)))?;
    if !output.status.success() {
        bail!("{} failed: {}", words(&command), String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The command as one would type it.
pub fn words(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default();
    let words: Vec<_> = [program].into_iter().chain(command.get_args()).map(OsStr::to_string_lossy).collect();
    words.join(" ")
}
