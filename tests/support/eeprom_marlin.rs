//! OctoPrint's plugin EEPROM-Marlin (cp2004, 3.x) as its source has it: `__init__.py` requests M503 if the firmware's
//! name contains Marlin, and `parser.py` reads the lines of the answer by regular expressions.
#![allow(dead_code, reason = "each test uses a part")]

use std::collections::BTreeMap;

/// Commands that it knows, with the letters of their values (data.py, `ALL_DATA_STRUCTURE`).
const COMMANDS: [(&str, &str); 17] = [
    ("M92", "XYZE"),
    ("M203", "XYZE"),
    ("M201", "XYZE"),
    ("M204", "PRT"),
    ("M851", "XYZ"),
    ("M206", "XYZ"),
    ("M666", "XYZ"),
    ("M665", "LRHSXYZABC"),
    ("M900", "K"),
    ("M200", "D"),
    ("M301", "PID"),
    ("M304", "PID"),
    ("M205", "BEJSTXYZ"),
    ("M420", "SZ"),
    ("M145", "HBFS"),
    ("M906", "EXYZ"),
    ("M913", "XYZE"),
];

/// Whether it takes the firmware for one that it can ask (`is_marlin`).
pub fn asks(firmware_name: &str) -> bool {
    firmware_name.to_lowercase().contains("marlin")
}

/// Its reading of a line (`parse_eeprom_data`): a command and its values. The line must begin with `echo:`, any blanks,
/// and a code of one to three digits.
pub fn parse(line: &str) -> Option<(String, BTreeMap<char, f64>)> {
    let text = line.strip_prefix("echo:")?.trim_start();
    let digits = text.strip_prefix('M')?.chars().take(3).take_while(char::is_ascii_digit).count();
    let code = text.get(..=digits).filter(|_| digits > 0)?;
    let (_, letters) = COMMANDS.iter().find(|(known, _)| *known == code)?;
    let values = letters.chars().filter_map(|letter| Some((letter, value(line, letter)?))).collect();
    Some((code.to_owned(), values))
}

/// `(^|[^A-Za-z])[Xx](?P<value>[-+]?[0-9]*\.?[0-9]+)`
fn value(line: &str, letter: char) -> Option<f64> {
    let bytes = line.as_bytes();
    let is_free = |place: usize| place == 0 || !bytes[place - 1].is_ascii_alphabetic();
    let place = line.char_indices().find(|(place, c)| {
        let next = bytes.get(place + 1).is_some_and(|b| b.is_ascii_digit() || b"+-.".contains(b));
        c.eq_ignore_ascii_case(&letter) && is_free(*place) && next
    })?;
    let number = line[place.0 + 1..].split(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).next()?;
    number.parse().ok()
}
