//! Keys of machine files that texts name: each exists in the schema. Texts are all documents, and the string literals
//! of the code.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Folders with documents or code that people read the texts of.
const ROOMS: [&str; 7] = ["docs", "cli/src", "examples", "machine-file/src", "report/src", "src", "twin/src"];

/// Ends of file names, which look like keys.
const FILES: [&str; 10] = ["csv", "gcode", "html", "js", "json", "md", "py", "rs", "svg", "toml"];

fn schema() -> Value {
    serde_json::from_str(&fs::read_to_string("examples/machines/machine.schema.json").unwrap()).unwrap()
}

/// Whether a key leads to something; `*` is any part, and `x.*` may end in any of its keys.
fn has(schema: &Value, key: &[&str]) -> bool {
    let Some((first, rest)) = key.split_first() else { return true };
    let named = schema["properties"].as_object();
    let parts = named.into_iter().flatten().filter(|(name, _)| *first == "*" || name == first).map(|(_, part)| part);
    let free = schema["additionalProperties"].as_object().map(|_| &schema["additionalProperties"]);
    let patterned = schema["patternProperties"].as_object().into_iter().flat_map(serde_json::Map::values);
    parts.chain(free).chain(patterned).any(|part| has(part, rest))
}

/// The words of a text that look like keys: names with points, the first of which is a table of the schema.
fn keys<'t>(text: &'t str, tables: &BTreeSet<String>) -> Vec<&'t str> {
    let is_inner = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_.*".contains(c);
    // Bold words end in stars.
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(begin) = rest.find(is_inner) {
        let before = rest[..begin].chars().next_back();
        let end = rest[begin..].find(|c| !is_inner(c)).map_or(rest.len(), |end| begin + end);
        let after = rest[end..].chars().next();
        let word = rest[begin..end].trim_end_matches("**").trim_end_matches('.');
        let is_whole = !before.is_some_and(|c| c.is_alphanumeric() || "/:$-}[".contains(c));
        let is_text = !after.is_some_and(|c| c.is_alphanumeric() || "/({".contains(c));
        let parts: Vec<&str> = word.split('.').collect();
        let is_file = parts.last().is_some_and(|last| FILES.contains(last));
        if is_whole && is_text && !is_file && parts.len() > 1 && tables.contains(parts[0]) {
            found.push(word);
        }
        rest = &rest[end..];
    }
    found
}

/// The string literals of code, with lines that go on joined. Characters and comments have no literals.
fn literals(code: &str) -> String {
    let (mut texts, mut chars) = (String::new(), code.chars().peekable());
    let mut is_in = false;
    while let Some(c) = chars.next() {
        match (is_in, c) {
            (true, '\\') => match chars.next() {
                Some('\n') => while chars.next_if(|c| c.is_whitespace()).is_some() {},
                _ => texts.push(' '),
            },
            (true, '"') => (is_in, _) = (false, texts.push('\n')),
            (true, c) => texts.push(c),
            (false, '"') => is_in = true,
            (false, '/') if chars.next_if_eq(&'/').is_some() => while chars.next_if(|c| *c != '\n').is_some() {},
            // A quote as a character.
            (false, '\'') => {
                let is_escaped = chars.next_if_eq(&'\\').is_some();
                if is_escaped || chars.peek() == Some(&'"') {
                    chars.next();
                }
            }
            _ => {}
        }
    }
    texts
}

fn files(folder: &Path, each: &mut impl FnMut(&Path)) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.extension().and_then(|end| end.to_str()) {
            _ if path.is_dir() => files(&path, each),
            Some("md" | "rs") => each(&path),
            _ => {}
        }
    }
}

#[test]
fn every_key_that_a_text_names_exists() {
    let schema = schema();
    let tables = schema["properties"].as_object().unwrap().iter().filter(|(_, part)| part["type"] == "object");
    let tables: BTreeSet<String> = tables.map(|(name, _)| name.clone()).collect();
    let (mut wrong, mut count) = (Vec::new(), 0);
    for room in ROOMS {
        files(Path::new(room), &mut |path| {
            let whole = fs::read_to_string(path).unwrap();
            let text = if path.extension().is_some_and(|end| end == "rs") { literals(&whole) } else { whole };
            for key in keys(&text, &tables) {
                count += 1;
                if !has(&schema, &key.split('.').collect::<Vec<_>>()) {
                    wrong.push(format!("{}: {key}", path.display()));
                }
            }
        });
    }
    assert!(wrong.is_empty(), "these keys do not exist:\n{}", wrong.join("\n"));
    assert!(count > 300, "only {count} keys were found");
}

#[test]
fn keys_over_two_lines_and_with_stars_are_seen() {
    let tables: BTreeSet<String> = ["endstops", "homing"].map(str::to_owned).into();
    let code = "let a = '\"'; // \"endstops.q\"\n note(\"the end (endstops.*.end)\", \
                \"see \\\n   homing.z.\\\n  position.\");";
    assert_eq!(keys(&literals(code), &tables), ["endstops.*.end", "homing.z.position"]);
    let schema = schema();
    assert!(has(&schema, &["homing", "*", "end"]) && has(&schema, &["drivers", "z1", "current_ma"]));
    assert!(!has(&schema, &["endstops", "*", "end"]) && !has(&schema, &["endstops", "z", "position"]));
}
