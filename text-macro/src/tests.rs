//! The dictionary against the texts in the source. `BLESS=1` makes it again.

use crate::code::{Packer, unpack};
use crate::learn::{learn, packed_len, texts};
use crate::words::{PACKED, PLAIN, WORDS};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A line of the dictionary's file.
const LINE: usize = 116;

fn written(words: &[&str], plain: usize, packed: usize) -> String {
    let mut file = String::from(
        "//! The dictionary. `BLESS=1 cargo test -p corehbot-text-macro` makes it of the texts in `src`.\n\n\
         /// Bytes of these texts.\n#[cfg(test)]\n",
    );
    write!(
        file,
        "pub const PLAIN: usize = {plain};\n\n/// Bytes of the packed texts and of the words.\n#[cfg(test)]\n"
    )
    .unwrap();
    write!(file, "pub const PACKED: usize = {packed};\n\n").unwrap();
    write!(file, "/// The words by their numbers, the frequent ones first.\n#[rustfmt::skip]\n").unwrap();
    write!(file, "pub const WORDS: [&str; {}] = [", words.len()).unwrap();
    let mut width = LINE;
    for word in words.iter().map(|word| format!(" {word:?},")) {
        if width + word.len() > LINE {
            file += "\n   ";
            width = 3;
        }
        width += word.len();
        file += &word;
    }
    file + "\n];\n"
}

#[test]
fn the_dictionary_fits_the_texts() {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let texts = texts(&crate_folder.join("../src"));
    let plain: usize = texts.iter().map(String::len).sum();
    if std::env::var_os("BLESS").is_some() {
        let words = learn(&texts);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let packed = packed_len(&texts, &words);
        fs::write(crate_folder.join("src/words.rs"), written(&words, plain, packed)).unwrap();
        return;
    }
    let packed = packed_len(&texts, &WORDS);
    // Three hundredths more than when it was made.
    assert!(
        packed * PLAIN * 100 <= PACKED * plain * 103,
        "{plain} bytes of texts take {packed}: BLESS=1 makes it again"
    );
    let packer = Packer::new(WORDS);
    for text in texts {
        assert_eq!(unpack(&packer.pack(&text), &WORDS), text);
    }
}
