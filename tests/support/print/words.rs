//! Words of printed commands, and a line reduced to its words.

use core::fmt::{self, Formatter, Write};

use corehbot::gcode::{AxisWords, Number};

/// A line of letters and numbers with the last word of each letter, without comments and texts in quotes.
pub fn reduced(f: &mut Formatter<'_>, line: &[u8]) -> fmt::Result {
    // The bytes of a no-break space are blanks, and all others beyond ASCII are rubbish.
    let is_space = |byte: &u8| matches!(byte, b' ' | b'\t' | 0xC2 | 0xA0);
    let plain = |byte: &u8| match byte {
        byte if is_space(byte) => ' ',
        byte if byte.is_ascii() => char::from(byte.to_ascii_uppercase()),
        _ => '?',
    };
    let text: String = line.iter().map(plain).collect();
    let is_blank = |c: char| matches!(c, ' ' | ';' | '(' | '"');
    let until_blank = |text: &'_ str| text.find(is_blank).unwrap_or(text.len());
    let (mut words, mut rest) = (Vec::<(char, String)>::new(), text.as_str());
    while let Some(first) = rest.chars().next() {
        let after = &rest[first.len_utf8()..];
        rest = match first {
            ';' => "",
            '(' => after.split_once(')').map_or("", |(_, after)| after),
            '"' => after.split_once('"').map_or("", |(_, after)| after),
            'A'..='Z' => {
                let number = after.trim_start_matches(' ');
                let end = number
                    .find(|c: char| !matches!(c, '0'..='9' | '.' | '+' | '-' | ':' | ','))
                    .unwrap_or(number.len());
                let (number, after) = number.split_at(end);
                // Rubbish that is glued to a word ends at the next blank.
                let is_rubbish = after.starts_with(|c: char| !is_blank(c) && !c.is_ascii_alphabetic());
                let after = if is_rubbish { &after[until_blank(after)..] } else { after };
                // The code stays in front.
                let place = words.iter().skip(1).position(|(letter, _)| *letter == first);
                place.map(|place| words.remove(place + 1));
                words.push((first, number.to_owned()));
                after
            }
            ' ' => after,
            // So does rubbish that stands alone.
            _ => &after[until_blank(after)..],
        };
    }
    let words: Vec<_> = words.into_iter().map(|(letter, number)| format!("{letter}{number}")).collect();
    f.write_str(&words.join(" "))
}

/// A text, with `?` for every byte that is neither printable ASCII nor a tab.
pub fn write_text(f: &mut Formatter<'_>, text: &[u8]) -> fmt::Result {
    text.iter().try_for_each(|&byte| {
        f.write_char(match byte {
            b' '..=b'~' => byte as char,
            b'\t' => ' ',
            _ => '?',
        })
    })
}

/// One word, if it has a value.
pub fn word(f: &mut Formatter<'_>, letter: char, number: Option<Number>) -> fmt::Result {
    match number {
        Some(number) => write!(f, " {letter}{number}"),
        None => Ok(()),
    }
}

/// The axis words.
pub fn axes(f: &mut Formatter<'_>, words: AxisWords) -> fmt::Result {
    word(f, 'X', words.x)?;
    word(f, 'Y', words.y)?;
    word(f, 'Z', words.z)?;
    word(f, 'E', words.e)
}

/// The decimals of a word.
pub fn decimals_of(word: &str) -> usize {
    word.split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

/// A word with a number of decimals.
pub fn padded(word: &str, decimals: usize) -> String {
    let point = if word.contains('.') { "" } else { "." };
    format!("{word}{point}{}", "0".repeat(decimals - decimals_of(word)))
}
