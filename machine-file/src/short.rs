//! Shortens foreign text in messages: a line of a file may have a megabyte.

use std::borrow::Cow;

/// Characters of a text that are printed.
const MOST: usize = 80;

/// A foreign text for a message: if it is long, its beginning and its length.
#[must_use]
pub fn short(text: &str) -> Cow<'_, str> {
    shortened(text, MOST)
}

/// The same, with at most so many characters.
#[must_use]
pub fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => Cow::Borrowed(text),
        Some((end, _)) => Cow::Owned(format!("{}... ({} bytes)", &text[..end], text.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_cut_between_characters_and_says_how_long_it_is() {
        let text = "\u{e9}".repeat(MOST);
        assert_eq!(short(&text), text);
        assert_eq!(short(&format!("{text}x")), format!("{text}... (161 bytes)"));
        assert_eq!(short(&"G1 X5 ".repeat(200_000)).len(), MOST + "... (1200000 bytes)".len());
    }
}
