//! The kernel of the computer: Debian's packages, unpacked into a folder and not installed.

use crate::checkout::{command_output, run};
use crate::tools::{install, succeeds};
use anyhow::{Context as _, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The package that depends on the newest kernel.
const KERNEL: &str = "linux-image-amd64";

/// The shell of the memory disk.
const SHELL: &str = "busybox-static";

/// The packages, unpacked.
pub struct Packages {
    folder: PathBuf,
    version: String,
}

/// What is missing here, if anything is; the root user gets the computer's program.
pub fn lack(program: &str, package: &str) -> Result<Option<String>> {
    let is_there = |program: &str| {
        let mut command = Command::new(program);
        command.arg("--version");
        succeeds(command)
    };
    if !is_there("apt-get") || !is_there("dpkg") {
        return Ok(Some("needs Debian's packages of a kernel: apt-get and dpkg".to_owned()));
    }
    // This also fetches the list of packages, which a new machine lacks.
    if !is_there(program) || kernel().is_err() {
        install(package)?;
    }
    Ok(match kernel() {
        Err(error) => Some(format!("{error:#}")),
        Ok(_) if !is_there(program) => {
            Some(format!("{program} is missing; install it with: sudo apt-get install {package}"))
        }
        Ok(_) => None,
    })
}

/// The name of the newest kernel's package.
fn kernel() -> Result<String> {
    let mut depends = Command::new("apt-cache");
    depends.args(["depends", KERNEL]);
    let depends = command_output(depends)?;
    let name = depends.split_whitespace().find(|word| word.starts_with("linux-image-") && *word != KERNEL);
    Ok(name.with_context(|| format!("apt-cache knows no {KERNEL}; try: sudo apt-get update"))?.to_owned())
}

impl Packages {
    /// Downloads and unpacks them, unless they are there.
    pub fn fetch(target: &Path) -> Result<Self> {
        let name = kernel()?;
        let version = name.trim_start_matches("linux-image-").to_owned();
        let folder = target.join(&version);
        let packages = Self { folder: folder.clone(), version };
        if !packages.kernel().is_file() || !packages.busybox().is_file() {
            let downloads = target.join("downloads");
            // What an interrupted download has left is in the way.
            if downloads.exists() {
                fs::remove_dir_all(&downloads)?;
            }
            fs::create_dir_all(&downloads)?;
            let mut download = Command::new("apt-get");
            download.args(["download", "--quiet", &name, SHELL]).current_dir(&downloads);
            run(download)?;
            for file in fs::read_dir(&downloads)? {
                let mut unpack = Command::new("dpkg");
                unpack.arg("-x").arg(file?.path()).arg(&folder);
                run(unpack)?;
            }
            fs::remove_dir_all(&downloads)?;
        }
        Ok(packages)
    }

    /// The kernel's version.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The kernel.
    pub fn kernel(&self) -> PathBuf {
        self.folder.join(format!("boot/vmlinuz-{}", self.version))
    }

    /// The shell.
    pub fn busybox(&self) -> PathBuf {
        self.folder.join("bin/busybox")
    }

    /// A module of the kernel. Since Debian 13 they are compressed.
    pub fn module(&self, name: &str) -> Result<Vec<u8>> {
        let path = self.folder.join(format!("lib/modules/{}/kernel/{name}.ko", self.version));
        let packed = path.with_extension("ko.xz");
        if packed.is_file() && !path.is_file() {
            let mut unpack = Command::new("xz");
            unpack.args(["--decompress", "--keep"]).arg(&packed);
            run(unpack)?;
        }
        fs::read(&path).with_context(|| path.display().to_string())
    }
}
