//! Relative links in the documents: every file and every heading that they name is there. The changelog is in order.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders that are made, or belong to other programs.
const PASSED_OVER: [&str; 3] = ["target", ".git", "node_modules"];

fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !PASSED_OVER.contains(&name.as_str()) {
                documents(&path, found);
            }
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
}

/// The lines of a document outside of code blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// The targets of the links in a line: `[text](target)`, code spans apart.
fn targets(line: &str) -> Vec<&str> {
    line.split('`')
        .step_by(2)
        .flat_map(|part| part.split("](").skip(1))
        .filter_map(|part| part.split(')').next())
        .collect()
}

/// A link in a line, where its text may hold code spans.
fn all_targets(line: &str) -> BTreeSet<&str> {
    let whole = line.split("](").skip(1).filter_map(|part| part.split(')').next());
    whole.filter(|target| !target.contains('`') && !target.contains(' ')).chain(targets(line)).collect()
}

/// GitHub's anchor for a heading: small letters, digits, `-` and `_`; blanks become `-`.
fn anchor(heading: &str) -> String {
    // A link in a heading counts as its text.
    let mut text = String::new();
    let mut rest = heading;
    while let Some((before, after)) = rest.split_once("](") {
        text += before;
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    text += rest;
    let kept = text.trim().to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in prose(text).filter(|line| line.starts_with('#')) {
        let name = anchor(line.trim_start_matches('#'));
        // A second heading of one name gets a number.
        let names = std::iter::once(name.clone()).chain((1..).map(|n| format!("{name}-{n}")));
        let free = names.into_iter().find(|name| !found.contains(name)).unwrap();
        found.insert(free);
    }
    found
}

#[test]
fn every_relative_link_leads_to_a_file_and_a_heading() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    documents(root, &mut files);
    assert!(files.len() > 20, "the documents were not found");
    let mut broken = Vec::new();
    let mut count = 0;
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        for target in prose(&text).flat_map(all_targets) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (path, heading) = target.split_once('#').map_or((target, None), |(path, name)| (path, Some(name)));
            let to = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
            let is_there =
                to.exists() && heading.is_none_or(|name| anchors(&fs::read_to_string(&to).unwrap()).contains(name));
            if !is_there {
                broken.push(format!("{}: {target}", file.strip_prefix(root).unwrap().display()));
            }
        }
    }
    assert!(count > 100, "only {count} links were found");
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

#[test]
fn headings_become_the_anchors_that_github_makes() {
    for (heading, expected) in [
        ("Skips: M915 D, M915 R", "skips-m915-d-m915-r"),
        ("The first board: what to measure, in which order", "the-first-board-what-to-measure-in-which-order"),
        ("`--plant belt` and [links](a.md)", "--plant-belt-and-links"),
    ] {
        assert_eq!(anchor(heading), expected);
    }
    assert_eq!(anchors("# A\n```\n# no\n```\n# A\n").into_iter().collect::<Vec<_>>(), ["a", "a-1"]);
}

/// Two branches that both write the changelog are joined line by line, which may bring a section back.
#[test]
fn the_changelog_begins_with_this_version_and_has_each_section_once() {
    let text = include_str!("../CHANGELOG.md");
    let versions: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    assert_eq!(versions.first(), Some(&env!("CARGO_PKG_VERSION")));
    let headings: Vec<_> = text.lines().filter(|line| line.starts_with('#')).collect();
    let of_first = headings.iter().skip(2).take_while(|line| !line.starts_with("## "));
    let sections: BTreeSet<_> = of_first.clone().collect();
    assert_eq!(sections.len(), of_first.count(), "a section stands twice: {headings:?}");
    assert!(!versions.contains(&"Unreleased"), "the present version's section is for what is not released yet");
}
