//! `cargo xtask page`: the page with the firmware inside, as a folder of static files.
//!
//! The firmware and the simulator become WebAssembly, wasm-bindgen's library makes the script that loads it, and both
//! go into the page as text. So the page opens from its file, without a server: browsers let no page of a file read
//! other files, nor begin a worker from one.

mod embedded;

use crate::checkout::{self, BROWSER, cargo, root, run, target_dir};
use anyhow::{Context as _, Result};
use embedded::{deflated, examples};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The profile of the WebAssembly.
const PROFILE: &str = "page";

/// The package, and its library's name.
const PACKAGE: [&str; 2] = ["corehbot-page", "corehbot_page"];

/// The program that makes the script, and its package's folder.
const BIND: [&str; 2] = ["corehbot-page-bind", "page/bind"];

/// Where the page's own files are.
const FOLDER: &str = "page/www";

/// The look of all pages, of reports too.
const LOOK: &str = "report/src/print/page.css";

/// The file there that is the worker's script; it becomes text in the page.
const WORKER: &str = "worker.js";

/// Where to write the page.
#[derive(clap::Args)]
pub struct Args {
    /// The folder to write into; target/page-files if left out.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// A file of the page.
pub struct File {
    /// Its name; there are no folders.
    pub name: String,
    pub bytes: Vec<u8>,
}

/// Builds the page.
pub fn main(args: &Args) -> Result<()> {
    let index = write(args.output.as_deref())?;
    println!("open {} in a browser", index.display());
    Ok(())
}

/// Builds the page into a folder and says where its first file is.
pub fn write(folder: Option<&Path>) -> Result<PathBuf> {
    let folder = folder.map_or_else(|| target_dir().map(|dir| dir.join("page-files")), |dir| Ok(dir.to_owned()))?;
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let mut total = 0;
    for File { name, bytes } in files()? {
        total += bytes.len();
        let path = folder.join(name);
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    }
    println!("the page: {} ({total} bytes)", folder.display());
    Ok(folder.join("index.html"))
}

/// Builds all files of the page, in the order of their names.
pub fn files() -> Result<Vec<File>> {
    let folder = root().join(FOLDER);
    let mut files = Vec::new();
    for entry in fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name != WORKER {
            files.push(File { name, bytes: read(&path)? });
        }
    }
    files.push(File { name: "look.css".to_owned(), bytes: read(&root().join(LOOK))? });
    files.push(File { name: "firmware.js".to_owned(), bytes: firmware()?.into_bytes() });
    files.push(File { name: "examples.js".to_owned(), bytes: examples()?.into_bytes() });
    files.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(files)
}

/// The script of the worker and the WebAssembly, as a script that defines two texts.
fn firmware() -> Result<String> {
    let mut build = cargo(["build", "--package", PACKAGE[0], "--profile", PROFILE, "--target", BROWSER]);
    build.env(checkout::FLAGS, checkout::path_flags()?);
    run(build)?;
    let built = target_dir()?.join(BROWSER).join(PROFILE).join(format!("{}.wasm", PACKAGE[1]));
    run(build_binder()?)?;
    let folder = target_dir()?.join("page-glue");
    let program = binder_dir()?.join("debug").join(BIND[0]).with_extension(std::env::consts::EXE_EXTENSION);
    let mut bind = Command::new(program);
    bind.arg(built).arg(&folder);
    run(bind)?;
    let glue = fs::read_to_string(folder.join(format!("{}.js", PACKAGE[1]))).context("no script was made")?;
    let worker = fs::read_to_string(root().join(FOLDER).join(WORKER)).context("no worker")?;
    let wasm = read(&folder.join(format!("{}_bg.wasm", PACKAGE[1])))?;
    let script = serde_json::to_string(&(glue + "\n" + &worker))?;
    Ok(format!("'use strict';\nconst FIRMWARE = {{ script: {script}, wasm: \"{}\" }};\n", deflated(&wasm)?))
}

/// Builds the program that makes the script.
pub fn build_binder() -> Result<Command> {
    let mut build = cargo_of_binder("build");
    build.arg("--target-dir").arg(binder_dir()?);
    Ok(build)
}

/// A task of cargo for this program, which is a workspace of its own.
pub fn cargo_of_binder(task: &str) -> Command {
    let mut command = cargo([task, "--manifest-path"]);
    command.arg(root().join(BIND[1]).join("Cargo.toml"));
    command
}

fn binder_dir() -> Result<PathBuf> {
    Ok(target_dir()?.join(BIND[0]))
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("cannot open {}", path.display()))
}
