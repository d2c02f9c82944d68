//! Lines of `config.g`: commands with their words. Texts stand in quotes, and lists have colons.

/// A word: a letter and its value, without quotes.
#[derive(Clone, Debug)]
pub(super) struct Word {
    pub letter: char,
    pub value: String,
    /// Its number among all words of the file.
    pub item: usize,
}

impl Word {
    /// The numbers of a list.
    pub fn numbers(&self) -> Vec<f64> {
        self.value.split(':').filter_map(|number| number.trim().parse().ok()).filter(|n: &f64| n.is_finite()).collect()
    }

    /// The first number.
    pub fn number(&self) -> Option<f64> {
        self.numbers().first().copied()
    }
}

/// A command.
#[derive(Clone, Debug)]
pub(super) struct Command {
    /// `M92`; of lines that are no command, their first word.
    pub code: String,
    pub words: Vec<Word>,
    /// The word that chooses a part, in front of other words in the report: `P0 `.
    pub chosen: String,
    pub line: usize,
    /// It stands under a condition or in a loop.
    pub is_nested: bool,
}

impl Command {
    pub fn word(&self, letter: char) -> Option<&Word> {
        self.words.iter().find(|word| word.letter == letter)
    }

    pub fn has(&self, letter: char) -> bool {
        self.word(letter).is_some()
    }

    pub fn number(&self, letter: char) -> Option<f64> {
        self.word(letter)?.number()
    }
}

/// Commands that are kept.
const MOST: usize = 5000;

/// Reads all commands.
pub(super) fn read(text: &str) -> Vec<Command> {
    let mut commands: Vec<Command> = Vec::new();
    let (mut item, mut is_mill, mut block) = (0, false, None);
    for (number, line) in text.lines().enumerate() {
        let line = without_comment(line, is_mill);
        let trimmed = line.trim();
        if trimmed.is_empty() || commands.len() >= MOST {
            continue;
        }
        let (code, rest) = parted(trimmed);
        let indent = line.len() - line.trim_start().len();
        block = block.filter(|outer| indent > *outer);
        let is_nested = block.is_some();
        if block.is_none() && ["if", "elif", "else", "while"].contains(&code.as_str()) {
            block = Some(indent);
        }
        let mut words: Vec<Word> = Vec::new();
        if is_code(&code) {
            let mut rest = rest;
            while let Some((letter, value, others)) = next(rest) {
                words.push(Word { letter, value, item: item + words.len() });
                rest = others;
            }
        }
        if words.is_empty() {
            words.push(Word { letter: ' ', value: rest.trim().to_owned(), item });
        }
        item += words.len();
        is_mill = if code == "M453" { true } else { is_mill && !["M451", "M452"].contains(&code.as_str()) };
        let selector = match code.as_str() {
            "M569" | "M308" | "M106" | "M563" => &['P', 'S'][..],
            "M950" => &['H', 'F', 'E', 'J', 'P'],
            "M307" | "M143" => &['H'],
            _ => &[],
        };
        let chosen = words.iter().find(|word| selector.contains(&word.letter));
        let mut chosen = chosen.map(|word| format!("{}{} ", word.letter, word.value)).unwrap_or_default();
        if code == "M574" {
            chosen.extend(words.iter().map(|word| word.letter).filter(|letter| "XYZ".contains(*letter)));
            chosen.push(' ');
        }
        commands.push(Command { code, words, chosen, line: number + 1, is_nested });
    }
    commands
}

fn is_code(code: &str) -> bool {
    let digits = code.get(1..).unwrap_or_default();
    code.starts_with(['G', 'M']) && digits.starts_with(|c: char| c.is_ascii_digit())
}

/// The command of a line: words may follow without a blank.
fn parted(line: &str) -> (String, &str) {
    let is_gm = line.starts_with(['G', 'M', 'g', 'm']) && line[1..].starts_with(|c: char| c.is_ascii_digit());
    let end = if is_gm {
        1 + line[1..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(line.len() - 1)
    } else {
        line.find(char::is_whitespace).unwrap_or(line.len())
    };
    let code = if is_gm { line[..end].to_ascii_uppercase() } else { line[..end].to_owned() };
    (code, &line[end..])
}

/// The next word, its value, and the text behind it.
fn next(text: &str) -> Option<(char, String, &str)> {
    let text = text.trim_start();
    let letter = text.chars().next()?;
    let rest = &text[letter.len_utf8()..];
    if let Some(inner) = rest.strip_prefix('"') {
        let end = inner.find('"').unwrap_or(inner.len());
        return Some((letter.to_ascii_uppercase(), inner[..end].to_owned(), inner.get(end + 1..).unwrap_or_default()));
    }
    if letter == '(' {
        let end = rest.find(')').map_or(rest.len(), |end| end + 1);
        return Some((letter, rest[..end].trim_end_matches(')').to_owned(), &rest[end..]));
    }
    if rest.starts_with('{') {
        let end = end_of_braces(rest);
        return Some((letter.to_ascii_uppercase(), rest[..end].to_owned(), &rest[end..]));
    }
    // `Pmyprinter`: a text without quotes.
    let is_text = letter.eq_ignore_ascii_case(&'P') && rest.starts_with(|c: char| c.is_ascii_alphabetic());
    let is_end = |c: char| c.is_whitespace() || c == '(' || (c.is_ascii_alphabetic() && !is_text);
    let end = rest.find(is_end).unwrap_or(rest.len());
    // 7.06e-8 has a letter in it.
    let exponent = rest[end..].starts_with(['e', 'E']) && end > 0;
    let end = if exponent {
        let tail = &rest[end + 1..];
        let more = tail.find(|c: char| !c.is_ascii_digit() && c != '-' && c != '+').unwrap_or(tail.len());
        if more > 0 { end + 1 + more } else { end }
    } else {
        end
    };
    Some((letter.to_ascii_uppercase(), rest[..end].to_owned(), &rest[end..]))
}

/// The end of an expression in braces, which may have braces and texts in it.
fn end_of_braces(text: &str) -> usize {
    let (mut depth, mut is_text) = (0, false);
    for (at, letter) in text.char_indices() {
        match letter {
            '"' => is_text = !is_text,
            '{' if !is_text => depth += 1,
            '}' if !is_text => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + letter.len_utf8();
        }
    }
    text.len()
}

/// A line without its comments. Those in brackets are comments for a mill alone, behind M453 (`StringParser::Put` in
/// `src/GCodes/GCodeBuffer/StringParser.cpp`): for a printer their letters are words (`FindParameters`).
fn without_comment(line: &str, is_mill: bool) -> String {
    let (mut kept, mut is_text, mut braces, mut is_comment) = (String::new(), false, 0_usize, false);
    for letter in line.chars() {
        match letter {
            ')' if is_comment => {
                is_comment = false;
                continue;
            }
            _ if is_comment => continue,
            '"' => is_text = !is_text,
            ';' if !is_text => break,
            '{' if !is_text => braces += 1,
            '}' if !is_text => braces = braces.saturating_sub(1),
            '(' if is_mill && !is_text && braces == 0 => {
                is_comment = true;
                continue;
            }
            _ => {}
        }
        kept.push(letter);
    }
    kept
}
