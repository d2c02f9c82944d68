//! Lines of a file as the host reads them: comments, line numbers and checksums taken off, in ASCII as the wire wants
//! it.

use std::borrow::Cow;

/// The command of a line of a file, and whether the checksum there is wrong. The command is empty if the line has none
/// for the printer.
#[must_use]
pub fn command_of(line: &str) -> (Cow<'_, str>, bool) {
    let (text, is_damaged) = verified(strip_comment(line));
    if is_line_number(&text) { (Cow::Borrowed(""), is_damaged) } else { (text, is_damaged) }
}

/// A text without the line number and the checksum that it may have, and whether that checksum is wrong.
fn verified(text: Cow<'_, str>) -> (Cow<'_, str>, bool) {
    let Some(rest) = after_number(&text) else { return (text, false) };
    let (rest, is_damaged) = match text.rsplit_once('*') {
        Some((body, sum)) => {
            let expected = body.bytes().fold(0, |sum, byte| sum ^ byte);
            (rest.rsplit_once('*').map_or(rest, |(rest, _)| rest), sum.trim().parse() != Ok(expected))
        }
        None => (rest, false),
    };
    (Cow::Owned(rest.trim().to_owned()), is_damaged)
}

/// The text after the line number, if there is one.
fn after_number(text: &str) -> Option<&str> {
    let number = text.strip_prefix(['N', 'n'])?.trim_start();
    let digits = number.strip_prefix('-').unwrap_or(number);
    let rest = digits.trim_start_matches(|c: char| c.is_ascii_digit());
    (rest.len() < digits.len()).then_some(rest)
}

/// Whether this is M110, which sets line numbers.
fn is_line_number(text: &str) -> bool {
    matches!(words(text).next(), Some(('M', Some(110.0))))
}

/// A line without its comments and outer blanks, in ASCII as the wire wants it. As printcore does it, `( )` is a
/// comment if it is closed, whatever is in it.
#[must_use]
pub fn strip_comment(line: &str) -> Cow<'_, str> {
    if !line.contains('(') && line.is_ascii() {
        return Cow::Borrowed(line.split(';').next().unwrap_or_default().trim());
    }
    let mut text = String::new();
    let mut rest = line;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        match c {
            ';' => break,
            '(' => match rest.find(['(', ')']) {
                Some(end) if rest[end..].starts_with(')') => rest = &rest[end + 1..],
                _ => text.push(c),
            },
            // A no-break space, and the byte order mark that some editors begin a file with.
            '\u{a0}' => text.push(' '),
            '\u{feff}' => {}
            _ if c.is_ascii() => text.push(c),
            _ => text.push('?'),
        }
    }
    Cow::Owned(text.trim().to_owned())
}

/// The words of a command: a letter, in upper case, and its number.
pub fn words(command: &str) -> impl Iterator<Item = (char, Option<f64>)> + Clone + '_ {
    let mut rest = command;
    std::iter::from_fn(move || {
        let start = rest.find(|c: char| c.is_ascii_alphabetic())?;
        let letter = rest.as_bytes()[start].to_ascii_uppercase() as char;
        let value = &rest[start + 1..];
        let end = value.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(value.len());
        rest = &value[end..];
        Some((letter, value[..end].trim().parse().ok()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_those_of_printcore() {
        for (line, text) in [
            ("G1 X5 (a;b) Y6 ; c", "G1 X5  Y6"),
            ("(a)G1 X5(b)", "G1 X5"),
            ("G1 X5 (a ; b", "G1 X5 (a"),
            ("G1 X5 (a(b) Y6", "G1 X5 (a Y6"),
            ("\u{feff}G1\u{a0}X5\u{a0}", "G1 X5"),
            ("M117 50 \u{b0}C", "M117 50 ?C"),
        ] {
            assert_eq!(strip_comment(line), text, "{line}");
        }
    }
}
