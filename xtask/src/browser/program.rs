//! The browser and its driver, which Debian packs together.

use crate::checkout::command_output;
use crate::tools::install;
use anyhow::Result;
use std::path::PathBuf;
use std::process::Command;

/// The package of the driver, which brings the browser of its version.
const PACKAGE: &str = "chromium-driver";

/// Names of the browser: in Debian, in other distributions, as its maker calls it.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// The driver.
const DRIVER: &str = "chromedriver";

/// Both of them.
pub(super) struct Programs {
    browser: PathBuf,
    driver: PathBuf,
    /// The browser's name and version.
    pub version: String,
}

impl Programs {
    /// Finds them. The root user gets them if they are missing; the inner error is the command for other users.
    pub fn find_or_install() -> Result<Result<Self, String>> {
        if Self::find().is_none() {
            install(PACKAGE)?;
        }
        let lack = || format!("a headless Chromium is missing; install it with: sudo apt-get install {PACKAGE}");
        Ok(Self::find().ok_or_else(lack))
    }

    fn find() -> Option<Self> {
        let browser = BROWSERS.iter().find_map(|name| path(name))?;
        let mut version = Command::new(&browser);
        version.arg("--version");
        let version = command_output(version).ok()?.trim().to_owned();
        Some(Self { browser, driver: path(DRIVER)?, version })
    }

    /// Tells a trial where they are.
    pub fn tell(&self, command: &mut Command) {
        command.env("CHROMIUM", &self.browser).env("CHROMEDRIVER", &self.driver);
    }
}

/// Where a program is.
fn path(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| path.is_file())
}
