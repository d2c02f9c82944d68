//! The owner's texts: a place in every image for lines of G-code with a name, next to its machine.
//!
//! | bytes | content |
//! |---|---|
//! | 0..16 | [`TEXT_MARK`], which stands nowhere else in an image |
//! | 16..18 | length of the body |
//! | 18..22 | CRC-32 of the body |
//! | 22.. | the body, or 0xFF throughout: no texts |
//!
//! The body is ASCII: the name of a text, its lines, and an empty line, for one text after the other. Settings have no
//! room for it: a memory of 4 KB is full, and no sector of the flash is free on an F446. So texts come with the image.

use crate::checksum::crc32;

/// The first bytes of a block.
pub const TEXT_MARK: [u8; 16] = *b"corehbot texts :";

/// Bytes of a block. It stays as it is: a block of another size would reach into the program of earlier images.
pub const TEXT_BLOCK: usize = 2048;

const HEAD: usize = TEXT_MARK.len() + 6;

/// Bytes of the longest body.
pub const LONGEST_TEXTS: usize = TEXT_BLOCK - HEAD;

/// A block without texts.
#[must_use]
pub const fn blank_texts() -> [u8; TEXT_BLOCK] {
    let mut block = [0xFF; TEXT_BLOCK];
    let (mark, _) = block.split_at_mut(TEXT_MARK.len());
    mark.copy_from_slice(&TEXT_MARK);
    block
}

/// The body in a block; empty if there is none, or if it is not whole.
// The mark is not checked: that would put it into images a second time.
#[must_use]
pub fn texts_of(block: &[u8; TEXT_BLOCK]) -> &[u8] {
    let (_, block) = block.split_at(TEXT_MARK.len());
    let [l0, l1, c0, c1, c2, c3, body @ ..] = block else { return &[] };
    let body = body.get(..usize::from(u16::from_le_bytes([*l0, *l1]))).unwrap_or_default();
    if crc32(&[body]) == u32::from_le_bytes([*c0, *c1, *c2, *c3]) { body } else { &[] }
}

/// Puts a body into a block, in place of another. False if it is too long; then nothing has changed.
#[must_use]
pub fn put_texts(block: &mut [u8; TEXT_BLOCK], body: &[u8]) -> bool {
    if body.len() > LONGEST_TEXTS {
        return false;
    }
    let (_, place) = block.split_at_mut(TEXT_MARK.len());
    place.fill(0xFF);
    if body.is_empty() {
        return true;
    }
    let ([l0, l1], [c0, c1, c2, c3]) = ((body.len() as u16).to_le_bytes(), crc32(&[body]).to_le_bytes());
    let bytes = [l0, l1, c0, c1, c2, c3].into_iter().chain(body.iter().copied());
    place.iter_mut().zip(bytes).for_each(|(to, byte)| *to = byte);
    true
}

/// The line that begins at a place of a body, and the place of the next one. `None` behind the last line of a text.
#[must_use]
pub fn line_at(body: &[u8], at: usize) -> Option<(&[u8], usize)> {
    let rest = body.get(at..)?;
    let length = rest.iter().position(|byte| *byte == b'\n')?;
    let line = rest.get(..length).filter(|line| !line.is_empty())?;
    Some((line, at + length + 1))
}

/// The place of the first line of the text with this name, in large or small letters.
#[must_use]
pub fn text_named(body: &[u8], name: &[u8]) -> Option<usize> {
    let mut at = 0;
    while let Some((its, mut next)) = line_at(body, at) {
        if its.eq_ignore_ascii_case(name) {
            return Some(next);
        }
        while let Some((_, after)) = line_at(body, next) {
            next = after;
        }
        at = next + 1;
    }
    None
}

/// A place for a word of the call: the key, and what stands there without that word.
pub struct Gap<'t> {
    /// The key.
    pub key: &'t [u8],
    /// The default.
    pub default: Option<&'t [u8]>,
}

/// A line up to its first gap, that gap, and the line after it. Braces with anything but a gap are none.
#[must_use]
pub fn split_at_gap(line: &[u8]) -> Option<(&[u8], Gap<'_>, &[u8])> {
    let open = line.iter().position(|byte| *byte == b'{')?;
    let (before, rest) = line.split_at_checked(open)?;
    let close = rest.iter().position(|byte| *byte == b'}')?;
    let (inside, after) = (rest.get(1..close)?, rest.get(close + 1..)?);
    let colon = inside.iter().position(|byte| *byte == b':');
    let gap = match colon {
        Some(colon) => Gap { key: inside.get(..colon)?, default: inside.get(colon + 1..) },
        None => Gap { key: inside, default: None },
    };
    Some((before, gap, after))
}

/// Whether a value may stand in a gap: it makes no second word, comment or line.
#[must_use]
pub fn is_value(value: &[u8]) -> bool {
    let is_legal = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | b'+' | b'-');
    (1..=MOST_VALUE).contains(&value.len()) && value.iter().all(is_legal)
}

/// Bytes of the longest value.
pub const MOST_VALUE: usize = 24;

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: &[u8] = b"START_PRINT\nG28\nM109 S{EXTRUDER:200}\n\nHELLO\nM118 {A}-{B:x}\n\n";

    #[test]
    fn a_block_gives_back_the_texts_that_were_put_in() {
        let mut block = blank_texts();
        assert_eq!((texts_of(&block), &block[..16]), (&[][..], &TEXT_MARK[..]));
        assert!(put_texts(&mut block, BODY));
        assert_eq!(texts_of(&block), BODY);
        for at in 16..HEAD + BODY.len() {
            for bit in 0..8 {
                block[at] ^= 1 << bit;
                assert_ne!(texts_of(&block), BODY, "{at}");
                block[at] ^= 1 << bit;
            }
        }
        assert!(!put_texts(&mut block, &[b'x'; LONGEST_TEXTS + 1]) && texts_of(&block) == BODY);
        assert!(put_texts(&mut block, &[b'x'; LONGEST_TEXTS]) && texts_of(&block).len() == LONGEST_TEXTS);
        assert!(put_texts(&mut block, b"") && block == blank_texts());
    }

    #[test]
    fn a_text_is_found_by_its_name_and_read_line_by_line() {
        let at = text_named(BODY, b"hello").unwrap();
        assert_eq!(line_at(BODY, at), Some((&b"M118 {A}-{B:x}"[..], BODY.len() - 1)));
        assert_eq!(line_at(BODY, BODY.len() - 1), None);
        let at = text_named(BODY, b"START_PRINT").unwrap();
        let (line, next) = line_at(BODY, at).unwrap();
        assert_eq!((line, line_at(BODY, next).unwrap().0), (&b"G28"[..], &b"M109 S{EXTRUDER:200}"[..]));
        // A line is no name.
        assert_eq!([text_named(BODY, b"G28"), text_named(BODY, b"START"), text_named(b"", b"HELLO")], [None; 3]);
    }

    #[test]
    fn gaps_have_a_key_and_may_have_a_default() {
        let (before, gap, after) = split_at_gap(b"M118 {A}-{B:x}").unwrap();
        assert_eq!((before, gap.key, gap.default, after), (&b"M118 "[..], &b"A"[..], None, &b"-{B:x}"[..]));
        let (before, gap, after) = split_at_gap(after).unwrap();
        assert_eq!((before, gap.key, gap.default, after), (&b"-"[..], &b"B"[..], Some(&b"x"[..]), &b""[..]));
        assert!(split_at_gap(b"G28 } {").is_none() && split_at_gap(b"").is_none());
    }

    #[test]
    fn a_value_is_one_plain_word() {
        for value in ["60", "-1.5e+3", "PLA_1", "a23456789012345678901234"] {
            assert!(is_value(value.as_bytes()), "{value}");
        }
        for value in ["", "a;b", "a b", "{x}", "a\n", "\u{e4}", "a234567890123456789012345", "G1*5"] {
            assert!(!is_value(value.as_bytes()), "{value}");
        }
    }
}
