//! Which libraries have tests in their documentation.
//!
//! Cargo starts rustdoc for each library that may have some. So a library without any says `doctest = false`.
#![cfg(test)]

use crate::checkout::{command_output, root};
use std::fs;
use std::path::{Path, PathBuf};

/// The folders of the workspace's packages that are libraries.
fn libraries() -> Vec<PathBuf> {
    let mut metadata = crate::checkout::cargo(["metadata", "--offline", "--no-deps", "--format-version=1"]);
    metadata.current_dir(root());
    let metadata: serde_json::Value = serde_json::from_str(&command_output(metadata).unwrap()).unwrap();
    let manifests = metadata["packages"].as_array().unwrap().iter().map(|package| &package["manifest_path"]);
    let folders = manifests.map(|path| Path::new(path.as_str().unwrap()).parent().unwrap().to_owned());
    folders.filter(|folder| folder.join("src/lib.rs").exists()).collect()
}

/// All Rust files below a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Whether rustdoc would take a block of the documentation for Rust: no language is named, or one of its own words.
fn has_example(source: &str) -> bool {
    let lines = source.lines().filter_map(|line| {
        let line = line.trim_start();
        line.strip_prefix("///").or_else(|| line.strip_prefix("//!"))
    });
    let fences = lines.filter_map(|line| line.trim_start().strip_prefix("```"));
    let rust = ["", "rust", "should_panic", "no_run", "compile_fail", "ignore", "edition2024"];
    fences.step_by(2).any(|language| language.split([',', ' ']).next().is_some_and(|word| rust.contains(&word)))
}

#[test]
fn examples_in_documentation_are_run_where_there_are_any() {
    let (mut with, mut wrong) = (0, Vec::new());
    for library in libraries() {
        let mut files = Vec::new();
        sources(&library.join("src"), &mut files);
        let has_some = files.iter().any(|file| has_example(&fs::read_to_string(file).unwrap()));
        let is_off = fs::read_to_string(library.join("Cargo.toml")).unwrap().contains("\ndoctest = false\n");
        with += u32::from(has_some);
        if has_some == is_off {
            wrong.push(format!("{}: examples {has_some}, `doctest = false` {is_off}", library.display()));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(with > 0, "the core has some");
}

#[test]
fn a_block_without_a_language_is_an_example() {
    for (source, is_example) in [
        ("/// ```\n/// f();\n/// ```\n", true),
        ("//! ```compile_fail,E0308\n//! f();\n//! ```\n", true),
        ("//! ```text\n//! a -> b\n//! ```\n", false),
        ("//! ```text\n//! a\n//! ```\nfn f() {}\n    /// ```\n    /// f();\n    /// ```\n", true),
        ("let fence = \"```\";\n", false),
    ] {
        assert_eq!(has_example(source), is_example, "{source}");
    }
}
