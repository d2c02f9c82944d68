//! `corehbot-page-bind IN.wasm DIR`: the glue between a page's script and its WebAssembly, by wasm-bindgen's own
//! library in the version of Cargo.lock. A program of its own, so that only `cargo xtask page` waits for its build.

use anyhow::{Context as _, Result};
use std::path::PathBuf;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let (input, folder) = paths.next().zip(paths.next()).context("usage: corehbot-page-bind IN.wasm DIR")?;
    let mut bindgen = Bindgen::new();
    // Workers that are begun from text have no modules.
    bindgen.input_path(input).no_modules(true)?.typescript(false);
    bindgen.remove_name_section(true).remove_producers_section(true);
    bindgen.generate(folder)
}
