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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ways to make markup or a script of a text, which may be the name of a file or the answer of a printer.
    const FORBIDDEN: [&str; 15] = [
        "innerHTML",
        "outerHTML",
        "insertAdjacentHTML",
        "document.write",
        "createContextualFragment",
        "DOMParser",
        "setHTMLUnsafe",
        "parseHTMLUnsafe",
        "setHTML(",
        "eval(",
        "new Function",
        "javascript:",
        "importScripts",
        "setAttribute(\"on",
        "setAttribute('on",
    ];

    /// Where scripts and pages are.
    const SOURCES: [&str; 2] = ["page", "report"];

    /// Scripts, styles and pages in a folder and its folders.
    fn texts(folder: &Path, found: &mut Vec<(PathBuf, String)>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let kind = path.extension().and_then(|kind| kind.to_str()).unwrap_or_default();
            if path.is_dir() {
                texts(&path, found);
            } else if ["js", "html", "css"].contains(&kind) {
                let text = fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }

    #[test]
    fn texts_of_files_and_printers_are_never_markup() {
        let mut found = Vec::new();
        for folder in SOURCES {
            texts(&root().join(folder), &mut found);
        }
        for name in ["printing.js", "terminal.js", "facts.js", "compare.js", "uPlot.iife.min.js", "page.js"] {
            assert!(found.iter().any(|(path, _)| path.ends_with(name)), "{name} is not looked at");
        }
        for (path, text) in &found {
            let words: Vec<_> = FORBIDDEN.iter().filter(|word| text.contains(**word)).collect();
            assert!(words.is_empty(), "{}: {words:?}", path.display());
            // An attribute of markup that is a script.
            let markup = if path.extension().is_some_and(|kind| kind == "html") { text.as_str() } else { "" };
            assert!(!markup.split_whitespace().any(|word| word.starts_with("on") && word.contains('=')), "{path:?}");
        }
        let frames = found.iter().map(|(_, text)| text.matches("srcdoc").count()).sum::<usize>();
        assert_eq!(frames, 1, "the report's frame is the only one that is given a page");
    }

    #[test]
    fn the_page_and_its_report_ask_no_network_and_the_report_is_in_a_sandbox() {
        let page = fs::read_to_string(root().join(FOLDER).join("index.html")).unwrap();
        let report = fs::read_to_string(root().join("report/src/print/head.html")).unwrap();
        for text in [&page, &report] {
            let (_, policy) = text.split_once("Content-Security-Policy\" content=\"").unwrap();
            let (policy, _) = policy.split_once('"').unwrap();
            let rules: Vec<_> = policy.split("; ").map(|rule| rule.split_once(' ').unwrap()).collect();
            let sources = |name: &str| rules.iter().find(|(own, _)| *own == name).map(|(_, sources)| *sources);
            for name in ["default-src", "script-src-attr", "form-action", "base-uri"] {
                assert_eq!(sources(name), Some("'none'"), "{name}");
            }
            assert!(sources("connect-src").is_none_or(|sources| sources == "'none'"));
            let allowed = ["'none'", "'self'", "'unsafe-inline'", "'wasm-unsafe-eval'", "blob:", "data:"];
            assert!(rules.iter().flat_map(|(_, sources)| sources.split(' ')).all(|source| allowed.contains(&source)));
        }
        let (_, frame) = page.split_once("<iframe").unwrap();
        let (_, sandbox) = frame.split_once("sandbox=\"").unwrap();
        assert_eq!(sandbox.split('"').next(), Some("allow-scripts allow-downloads"));
    }
}
