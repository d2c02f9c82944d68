//! The dictionary is made of the texts in the source. Pairs of symbols are joined as long as a pair is frequent
//! (byte-pair encoding, Gage 1994). Then the joined words that save least are left out, round by round.

use crate::code::{MOST, Packer, Part, RESERVED};
use crate::literal::{parts, text_of};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Bytes of a word besides its letters: its length.
const ENTRY: usize = 1;

/// Joins at most, of which most are left out again.
const JOINS: usize = 3000;

/// The macros that pack, as they begin in the source, and whether theirs is a template.
const MACROS: [(&str, bool); 3] = [("text!(", true), ("put!(", true), ("packed!(", false)];

/// The texts that the core packs, places for values apart.
pub fn texts(folder: &Path) -> Vec<String> {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let mut all = Vec::new();
    for path in entries {
        if path.is_dir() {
            all.extend(texts(&path));
        } else if path.extension().is_some_and(|end| end == "rs") {
            all.extend(texts_of(&fs::read_to_string(path).unwrap()));
        }
    }
    all
}

/// The texts that a source file packs, its tests apart.
fn texts_of(source: &str) -> Vec<String> {
    let code = source.split("#[cfg(test)]\nmod tests").next().unwrap();
    let lines: Vec<&str> = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = lines.join("\n");
    let mut all = Vec::new();
    for (name, is_template) in MACROS {
        for (at, _) in code.match_indices(name) {
            let Some(begin) = code[at..].find('"').map(|quote| at + quote) else { continue };
            let mut end = begin + 1;
            while !code[end..].starts_with('"') {
                end += if code[end..].starts_with('\\') { 2 } else { code[end..].chars().next().unwrap().len_utf8() };
            }
            let text = text_of(&code[begin..=end]).unwrap();
            if is_template {
                let plain = parts(&text).into_iter().filter(|(_, is_place)| !is_place);
                all.extend(plain.map(|(part, _)| part.to_owned()));
            } else {
                all.push(text);
            }
        }
    }
    all
}

/// Bytes of the texts packed by these words, and of the words.
pub fn packed_len(texts: &[String], words: &[&str]) -> usize {
    let packer = Packer::new(words.iter().copied());
    let texts: usize = texts.iter().map(|text| packer.pack(text).len()).sum();
    texts + words.iter().filter(|word| !word.is_empty()).map(|word| packer.pack_word(word).len() + ENTRY).sum::<usize>()
}

/// Words that are frequent in `texts`.
fn candidates(texts: &[String]) -> BTreeSet<String> {
    let mut symbols: Vec<String> = (0..128u8).map(|byte| (byte as char).to_string()).collect();
    let mut all: Vec<Vec<usize>> = texts.iter().map(|text| text.bytes().map(usize::from).collect()).collect();
    for _ in 0..JOINS {
        let mut pairs: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for pair in all.iter().flat_map(|text| text.windows(2)) {
            *pairs.entry((pair[0], pair[1])).or_default() += 1;
        }
        let Some((pair, 2..)) = pairs.into_iter().max_by_key(|(pair, times)| (*times, Reverse(*pair))) else {
            break;
        };
        let joined = symbols.len();
        symbols.push(format!("{}{}", symbols[pair.0], symbols[pair.1]));
        for text in &mut all {
            let mut at = 0;
            while at + 1 < text.len() {
                if (text[at], text[at + 1]) == pair {
                    text.splice(at..at + 2, [joined]);
                }
                at += 1;
            }
        }
    }
    symbols.drain(128..).collect()
}

/// The dictionary for `texts`: the most used words first, no word at the reserved numbers.
pub fn learn(texts: &[String]) -> Vec<String> {
    let mut words: Vec<String> = candidates(texts).into_iter().collect();
    loop {
        let mut valued = valued(texts, &with_reserved(&words));
        let losing = valued.iter().filter(|(saved, _, _)| *saved <= 0).count();
        let surplus = losing.max(valued.len().saturating_sub(MOST - RESERVED.len()));
        // A few at a time, because others are used in their places.
        valued.sort_unstable();
        valued.drain(..surplus.min(valued.len() / 200 + 1));
        valued.sort_unstable_by_key(|(_, uses, word)| (Reverse(*uses), word.clone()));
        words = valued.into_iter().map(|(_, _, word)| word).collect();
        if surplus == 0 {
            return with_reserved(&words);
        }
    }
}

/// Bytes that each word saves, how often it is used in texts and other words, and the word.
fn valued(texts: &[String], words: &[String]) -> Vec<(isize, usize, String)> {
    let packer = Packer::new(words.iter().map(String::as_str));
    let mut uses = vec![0; words.len()];
    let packed = texts.iter().flat_map(|text| packer.parts(text));
    for part in packed.chain(words.iter().flat_map(|word| packer.parts_of_word(word))) {
        if let Part::Word(number) = part {
            uses[number] += 1;
        }
    }
    let in_order = words.iter().zip(uses).enumerate().filter(|(_, (word, _))| !word.is_empty());
    let valued = in_order.map(|(number, (word, uses))| {
        // Without it, its parts would stand in each of its places.
        let parts: usize = packer.parts_of_word(word).into_iter().map(Part::len).sum();
        let (with, without) = (Part::Word(number).len() * uses + parts + ENTRY, parts * uses);
        (without as isize - with as isize, uses, word.clone())
    });
    valued.collect()
}

/// The words, with empty ones at the reserved numbers.
fn with_reserved(words: &[String]) -> Vec<String> {
    let mut numbered = words.to_vec();
    for reserved in RESERVED {
        numbered.insert(reserved.min(numbered.len()), String::new());
    }
    numbered
}
