//! The owner's texts: lines of G-code with a name, in `[texts]`. What is wrong with one is found here, before a board
//! has it.

use corehbot::gcode::{Command, Flaw};
use corehbot::machine::{names, parse};
use corehbot::storage::{Gap, LONGEST_TEXTS, MOST_VALUE, is_value, split_at_gap};
use std::fmt::{self, Display};

/// The table of texts.
pub(crate) const TEXTS: &str = "texts";

/// Texts, and lines of a text.
const MOST_TEXTS: usize = 16;
const MOST_LINES: usize = 64;

/// Bytes of a name, and of a line. A longer line would be too long for hosts that send it by hand.
const LONGEST_NAME: usize = 24;
const LONGEST_LINE: usize = 95;

/// Gaps of a line: with the longest value in each it still fits into a line of the firmware.
const MOST_GAPS: usize = 7;

/// Texts that call each other.
const DEEPEST: usize = 3;

/// Names that are built in and that a text may replace.
const REPLACED: [&str; 7] = ["START_PRINT", "PRINT_START", "END_PRINT", "PRINT_END", "PAUSE", "RESUME", "CANCEL_PRINT"];

/// Codes that act as they arrive from a host. In a text they would do nothing.
const URGENT: [&str; 6] = ["M108", "M410", "M524", "M876", "M999", "CANCEL_PRINT"];

/// Lines of G-code with a name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NamedText {
    /// The name, in capital letters.
    pub name: String,
    /// The lines, without comments and empty ones.
    pub lines: Vec<String>,
}

/// What is wrong with a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TextError {
    /// Its name.
    pub name: String,
    /// The line of the text, from 1 and with comments and empty lines; none if all of it is meant.
    pub line: Option<usize>,
    /// The problem and its cure.
    pub why: String,
}

impl Display for TextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{TEXTS}.{}", crate::short::short(&self.name))?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}", self.why)
    }
}

/// A line without its comment and the blanks around it.
fn command_of(line: &str) -> &str {
    line.split(';').next().unwrap_or_default().trim()
}

/// Whether a word is a name: of a text, or of a word of its call.
fn is_name(name: &str) -> bool {
    let is_legal = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_';
    (1..=LONGEST_NAME).contains(&name.len())
        && name.bytes().all(is_legal)
        && !name.starts_with(|c: char| c.is_ascii_digit())
}

/// Whether it is a letter and a number: a code.
fn is_code(name: &str) -> bool {
    name.len() > 1 && name.bytes().skip(1).all(|byte| byte.is_ascii_digit())
}

/// What is wrong with a name.
fn wrong_name(name: &str) -> Option<String> {
    if !is_name(name) {
        return Some(format!("a name has up to {LONGEST_NAME} capital letters, digits and _, and no digit first"));
    }
    if is_code(name) {
        return Some("a letter and a number are a code: give it another name".to_owned());
    }
    (names().any(|known| known == name) && !REPLACED.contains(&name))
        .then(|| format!("this is a command of the firmware; a text may replace {}", REPLACED.join(", ")))
}

/// The lines of a text as a file has it, each with its number.
fn lines_of(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().map(command_of).enumerate().map(|(at, line)| (at + 1, line)).filter(|(_, line)| !line.is_empty())
}

/// The line with `1` or the default in each gap, or what is wrong with a gap.
fn filled(line: &str) -> Result<String, String> {
    let (mut filled, mut rest, mut gaps) = (Vec::new(), line.as_bytes(), 0);
    while let Some((before, Gap { key, default }, after)) = split_at_gap(rest) {
        let key = String::from_utf8_lossy(key);
        if !is_name(&key) {
            return Err(format!("{{{key}}} is no word of a call: {{KEY}} or {{KEY:default}}, in capital letters"));
        }
        if default.is_some_and(|default| !is_value(default)) {
            return Err(format!("the default of {{{key}}} is a plain word of at most {MOST_VALUE} characters"));
        }
        gaps += 1;
        filled.extend_from_slice(before);
        filled.extend_from_slice(default.unwrap_or(b"1"));
        rest = after;
    }
    filled.extend_from_slice(rest);
    if filled.iter().any(|byte| matches!(byte, b'{' | b'}')) {
        return Err("braces stand around words of the call: {KEY} or {KEY:default}".to_owned());
    }
    if gaps > MOST_GAPS {
        return Err(format!("a line has at most {MOST_GAPS} words of the call"));
    }
    Ok(String::from_utf8_lossy(&filled).into_owned())
}

/// The name that a line begins with.
fn name_of(line: &str) -> &str {
    let end = line.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(line.len());
    &line[..end]
}

/// What is wrong with a line. `is_text` knows the names of all texts.
pub(crate) fn wrong_line(line: &str, is_text: impl Fn(&str) -> bool) -> Option<String> {
    if line.len() > LONGEST_LINE {
        return Some(format!("a line has at most {LONGEST_LINE} bytes"));
    }
    if let Some(odd) = line.chars().find(|c| !(' '..='~').contains(c)) {
        return Some(format!("{odd:?} is no letter of G-code: ASCII alone"));
    }
    let filled = match filled(line) {
        Ok(filled) => filled,
        Err(why) => return Some(why),
    };
    let name = name_of(&filled).to_ascii_uppercase();
    if URGENT.contains(&name.as_str()) {
        return Some(format!("{name} acts only when a host sends it"));
    }
    match parse(filled.as_bytes()) {
        Command::Unknown(_) if is_text(&name) => None,
        Command::Unknown(_) => Some(format!("unknown command {:?}", crate::short::short(&filled))),
        Command::Condition => Some("a condition: this firmware runs every line".to_owned()),
        Command::Malformed(flaw) => Some(words_of(flaw)),
        Command::Move(_) | Command::Table(_) | Command::Silent => None,
    }
}

/// Why a line would not be carried out.
fn words_of(flaw: Flaw<'_>) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    match flaw {
        Flaw::NoWord(word) => format!("{:?} is not a letter with a number", text(word)),
        Flaw::NoPair(word) => format!("{:?} is not a name with = and a number", text(word)),
        Flaw::NoNumber(letter) => format!("{} needs a number", char::from(letter)),
        Flaw::OutOfRange(word) => format!("{} is out of range", text(word)),
        Flaw::NoAxis(letter) => format!("there is no axis {}", char::from(letter)),
        Flaw::SecondCommand(word) => format!("{} is a second command on the line", text(word)),
        Flaw::Absent(absent) => format!("there is no {} {}", absent.part.name(), text(absent.which)),
    }
}

/// The texts of a table, with what is wrong with them.
pub(crate) fn checked(given: &[(String, String)]) -> (Vec<NamedText>, Vec<TextError>) {
    let (mut texts, mut errors) = (Vec::new(), Vec::new());
    let is_text = |name: &str| given.iter().any(|(text, _)| text == name);
    for (name, text) in given {
        let mut wrong = |line: Option<usize>, why: String| errors.push(TextError { name: name.clone(), line, why });
        if let Some(why) = wrong_name(name) {
            wrong(None, why);
        }
        for (number, line) in lines_of(text) {
            if let Some(why) = wrong_line(line, is_text) {
                wrong(Some(number), why);
            }
        }
        match lines_of(text).count() {
            0 => wrong(None, "it has no lines".to_owned()),
            1..=MOST_LINES => {}
            count => wrong(None, format!("it has {count} lines; {MOST_LINES} at most")),
        }
        texts.push(NamedText { name: name.clone(), lines: lines_of(text).map(|(_, line)| line.to_owned()).collect() });
    }
    if errors.is_empty() {
        errors.extend(texts.iter().filter_map(|text| {
            let why = wrong_calls(text, &texts, &mut Vec::new())?;
            Some(TextError { name: text.name.clone(), line: None, why })
        }));
    }
    if let Some(last) = texts.last() {
        let bytes = body(&texts).len();
        let why = if texts.len() > MOST_TEXTS {
            Some(format!("there are {} texts; {MOST_TEXTS} at most", texts.len()))
        } else if bytes > LONGEST_TEXTS {
            Some(format!("all texts take {bytes} bytes; an image has room for {LONGEST_TEXTS}"))
        } else {
            None
        };
        errors.extend(why.map(|why| TextError { name: last.name.clone(), line: None, why }));
    }
    (texts, errors)
}

/// What is wrong with the calls of a text, behind the texts that have called it.
fn wrong_calls<'t>(text: &'t NamedText, all: &'t [NamedText], above: &mut Vec<&'t str>) -> Option<String> {
    if above.len() >= DEEPEST {
        let way = above.join(" -> ");
        return Some(format!("texts call each other more than {DEEPEST} deep: {way} -> {}", text.name));
    }
    above.push(&text.name);
    for line in &text.lines {
        let name = name_of(line).to_ascii_uppercase();
        let Some(called) = all.iter().find(|text| text.name == name) else { continue };
        // In the text of its name, it is what is built in.
        if above.contains(&called.name.as_str()) {
            if REPLACED.contains(&name.as_str()) {
                continue;
            }
            return Some(format!("it calls itself: {} -> {name}", above.join(" -> ")));
        }
        if let Some(why) = wrong_calls(called, all, above) {
            return Some(why);
        }
    }
    above.pop();
    None
}

/// Texts as an image has them.
#[must_use]
pub fn body(texts: &[NamedText]) -> Vec<u8> {
    let mut body = Vec::new();
    for NamedText { name, lines } in texts {
        for line in std::iter::once(name).chain(lines) {
            body.extend_from_slice(line.as_bytes());
            body.push(b'\n');
        }
        body.push(b'\n');
    }
    body
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(given: &[(&str, &str)]) -> Vec<String> {
        let given: Vec<_> = given.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
        checked(&given).1.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn texts_are_as_an_image_has_them() {
        let given = [("START_PRINT".to_owned(), "\nM140 S{BED:60} ; warm\n\n  G28\n; done\n".to_owned())];
        let (texts, errors) = checked(&given);
        assert_eq!(errors, []);
        assert_eq!(body(&texts), b"START_PRINT\nM140 S{BED:60}\nG28\n\n");
    }

    #[test]
    fn a_bad_line_is_named_with_its_number() {
        for (line, why) in [
            ("G99", "unknown command \"G99\""),
            ("G1 X", ""),
            ("G1 X{a}", "{a} is no word of a call"),
            ("G1 X{A:1 2}", "the default of {A} is a plain word"),
            ("G1 X{A", "braces stand around"),
            ("M109 S{}", "{} is no word of a call"),
            ("{% if x %}", "{% if x %} is no word of a call"),
            ("M118 \u{e4}", "'\u{e4}' is no letter of G-code"),
            ("M524", "M524 acts only when a host sends it"),
            ("cancel_print", "CANCEL_PRINT acts only when a host sends it"),
            ("while true", "a condition"),
            ("M118 {A}{A}{A}{A}{A}{A}{A}{A}", "a line has at most 7 words"),
            (&format!("M118 {}", "x".repeat(91)), "a line has at most 95 bytes"),
        ] {
            let errors = errors(&[("HELLO", &format!("G28\n\n{line}\n"))]);
            if line == "G1 X" {
                continue;
            }
            assert_eq!(errors.len(), 1, "{line}: {errors:?}");
            assert!(errors[0].starts_with(&format!("texts.HELLO, line 3: {why}")), "{line}: {errors:?}");
        }
        assert_eq!(errors(&[("HELLO", &format!("M118 {}", "x".repeat(90)))]), [""; 0]);
    }

    #[test]
    fn a_name_is_no_code_and_no_command() {
        for name in [
            "",
            "hello",
            "M5",
            "G1",
            "5A",
            "A B",
            "M117",
            "T0",
            "G28",
            "BED_MESH_CALIBRATE",
            "A234567890123456789012345",
        ] {
            assert_eq!(errors(&[(name, "G28")]).len(), 1, "{name}");
        }
        for name in ["A", "_A", "M5_", "START_PRINT", "CANCEL_PRINT", "AB3456789012345678901234"] {
            assert_eq!(errors(&[(name, "G28")]), [""; 0], "{name}");
        }
    }

    #[test]
    fn texts_are_few_short_and_not_deep() {
        let line = |count: usize| "G28\n".repeat(count);
        assert_eq!(errors(&[("A", &line(64))]), [""; 0]);
        assert_eq!(errors(&[("A", &line(65))]), ["texts.A: it has 65 lines; 64 at most"]);
        assert_eq!(errors(&[("A", "; nothing\n")]), ["texts.A: it has no lines"]);
        let chain = [("A", "B"), ("B", "c X=1"), ("C", "G28"), ("D", "G28")];
        assert_eq!(errors(&chain), [""; 0]);
        let deep = [("A", "B"), ("B", "C"), ("C", "D"), ("D", "G28")];
        assert_eq!(errors(&deep), ["texts.A: texts call each other more than 3 deep: A -> B -> C -> D"]);
        assert_eq!(errors(&[("A", "B"), ("B", "A")]).len(), 2);
        assert_eq!(errors(&[("A", "A")]), ["texts.A: it calls itself: A -> A"]);
        assert_eq!(errors(&[("PAUSE", "M118 x\nPAUSE\nG27")]), [""; 0], "what is built in");
        let many: Vec<_> = (0..17).map(|n| (format!("A{n}_"), "G28".to_owned())).collect();
        assert_eq!(checked(&many).1[0].why, "there are 17 texts; 16 at most");
        let long: Vec<_> = (0..3).map(|n| (format!("A{n}_"), "M118 0123456789\n".repeat(60))).collect();
        assert!(checked(&long).1[0].why.starts_with("all texts take 2"), "{:?}", checked(&long).1);
    }
}
