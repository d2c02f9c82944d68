//! Macros: lines of G-code with words of their call become texts. A line that is computed, or that a condition
//! decides about, needs a person, and is named.

use super::work::Work;
use crate::texts::{NamedText, TEXTS, checked};
use crate::translation::Kind;
use std::collections::BTreeMap;

/// The sections of macros.
const SECTION: &str = "gcode_macro ";

/// A macro that becomes a text.
struct Macro {
    name: String,
    /// The entry of its lines.
    entry: usize,
    /// Its lines, each with its number in the file.
    lines: Vec<(usize, String)>,
}

/// Macros without conditions become texts.
pub(super) fn macros(work: &mut Work<'_>) {
    let config = work.config;
    let mut macros = Vec::new();
    for (number, section) in config.sections.iter().enumerate() {
        let Some(name) = section.name.strip_prefix(SECTION).map(|name| name.trim().to_uppercase()) else { continue };
        let value = |key: &str| config.find(&section.name, key).and_then(|entry| config.entries.get(entry));
        let base = value("rename_existing").map(|entry| entry.value.trim().to_uppercase());
        let of_section = config.entries.iter().enumerate().filter(|(_, entry)| entry.section == number);
        for (entry, found) in of_section.filter(|(_, entry)| entry.replaced.is_none()) {
            match found.key.as_str() {
                "gcode" => match lines_of(&found.value, &found.lines, &name, base.as_deref()) {
                    Ok(lines) => macros.push(Macro { name: name.clone(), entry, lines }),
                    Err((line, why)) => refuse(work, entry, line, &why),
                },
                "description" => work.say(entry, Kind::NotNeeded, "a text has none"),
                "rename_existing" => {
                    work.say(entry, Kind::NotNeeded, format!("in its own text, {name} is what is built in"));
                }
                _ => work.say(entry, Kind::NotYet, "a text keeps no values"),
            }
        }
    }
    // One that cannot be a text may be called by others, which cannot be then.
    loop {
        let given: Vec<_> = macros.iter().map(|one| (one.name.clone(), text_of(one))).collect();
        let (texts, errors) = checked(&given);
        let Some(error) = errors.first() else {
            take(work, &macros, &texts);
            return;
        };
        let Some(place) = macros.iter().position(|one| one.name == error.name) else { return };
        let wrong = macros.remove(place);
        let line = error.line.and_then(|line| wrong.lines.get(line.checked_sub(1)?));
        refuse(work, wrong.entry, line.map_or(0, |(number, _)| *number), &error.why);
    }
}

fn text_of(one: &Macro) -> String {
    one.lines.iter().map(|(_, line)| line.as_str()).collect::<Vec<_>>().join("\n")
}

/// Writes the texts into the machine file.
fn take(work: &mut Work<'_>, macros: &[Macro], texts: &[NamedText]) {
    for (one, text) in macros.iter().zip(texts) {
        let from = work.from(one.entry);
        work.lines.set(&format!("{TEXTS}.{}", one.name), text.lines.join("\n").into(), &from);
        let what = format!("{TEXTS}.{}, {} lines", one.name, text.lines.len());
        work.say(one.entry, Kind::Taken, what);
    }
}

/// A macro is no text, because of a line.
fn refuse(work: &mut Work<'_>, entry: usize, line: usize, why: &str) {
    let config = work.config;
    let place = config.entries.get(entry).map(|entry| entry.at);
    let file = place.and_then(|at| config.files.get(at.file)).map_or("", String::as_str);
    let at = if line == 0 { String::new() } else { format!("{file}:{line}: ") };
    work.say(entry, Kind::NotYet, format!("{at}{why}: write its commands into [{TEXTS}], or into the slicer's G-code"));
}

/// The lines of a text, or the first line that needs a person and why.
fn lines_of(
    value: &str,
    numbers: &[usize],
    name: &str,
    base: Option<&str>,
) -> Result<Vec<(usize, String)>, (usize, String)> {
    let (mut lines, mut known) = (Vec::new(), BTreeMap::new());
    for (line, number) in value.lines().zip(numbers) {
        let wrong = |why: String| (*number, why);
        let mut line = line.trim();
        while let Some((set, after)) = statement(line) {
            let (word, value) = setting(set).map_err(wrong)?;
            known.insert(word, value);
            line = after.trim();
        }
        if line.is_empty() {
            continue;
        }
        let line = filled(line, &known).map_err(wrong)?;
        lines.push((*number, own_words(&line, name, base)));
    }
    Ok(lines)
}

/// The statement that a line begins with, and the line behind it.
fn statement(line: &str) -> Option<(&str, &str)> {
    let inside = line.strip_prefix("{%")?;
    let (set, after) = inside.split_once("%}")?;
    Some((set.trim_matches(['-', '+']).trim(), after))
}

/// The word that a statement sets, and its value: a word of the call or a constant.
fn setting(statement: &str) -> Result<(String, String), String> {
    let set = statement.strip_prefix("set ").and_then(|set| set.split_once('='));
    let (word, value) = set.ok_or_else(|| format!("{{% {statement} %}} is a condition or a loop"))?;
    Ok((word.trim().to_owned(), expression(value, &BTreeMap::new())?))
}

/// A line with the words of the call in place of its expressions.
fn filled(line: &str, known: &BTreeMap<String, String>) -> Result<String, String> {
    let (mut filled, mut rest) = (String::new(), line);
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, after) = after.split_once('}').ok_or_else(|| format!("{line}: a brace is open"))?;
        if inside.starts_with('%') {
            return Err(format!("{line}: a condition or a loop"));
        }
        filled += before;
        filled += &expression(inside, known)?;
        rest = after;
    }
    Ok(filled + rest)
}

/// What stands in a text for an expression.
fn expression(expression: &str, known: &BTreeMap<String, String>) -> Result<String, String> {
    let computed = || format!("{{{}}} is computed", expression.trim());
    let mut parts = expression.split('|').map(str::trim);
    let word = parts.next().unwrap_or_default();
    let mut default = None;
    for filter in parts {
        match filter.split_once('(') {
            Some(("default", value)) => default = Some(constant(value.trim_end_matches(')')).ok_or_else(computed)?),
            None if ["int", "float", "string"].contains(&filter) => {}
            _ => return Err(computed()),
        }
    }
    if let Some(key) = word.strip_prefix("params.") {
        let is_key = key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let default = default.map(|default| format!(":{default}")).unwrap_or_default();
        return if is_key { Ok(format!("{{{}{default}}}", key.to_uppercase())) } else { Err(computed()) };
    }
    known.get(word).cloned().or_else(|| constant(word)).ok_or_else(computed)
}

/// A number, or a word in quotes.
fn constant(text: &str) -> Option<String> {
    let text = text.trim();
    let quoted = ['"', '\''].iter().find_map(|quote| text.strip_prefix(*quote)?.strip_suffix(*quote));
    let is_number = !text.is_empty() && text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '-' | '+'));
    quoted.or(is_number.then_some(text)).map(str::to_owned)
}

/// A line in the words of this firmware: messages, and what the macro was before it was renamed.
fn own_words(line: &str, name: &str, base: Option<&str>) -> String {
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    if base.is_some_and(|base| word.eq_ignore_ascii_case(base)) {
        return format!("{name} {rest}").trim().to_owned();
    }
    if !word.eq_ignore_ascii_case("RESPOND") {
        return line.to_owned();
    }
    let Some((before, said)) = rest.split_once("MSG=") else { return line.to_owned() };
    let said = said.trim().trim_matches(['"', '\'']);
    let form = if before.contains("TYPE=command") { "A1 " } else { "E1 " };
    format!("M118 {form}{said}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: &str) -> Result<Vec<String>, (usize, String)> {
        let numbers: Vec<_> = (1..=value.lines().count()).collect();
        let lines = lines_of(value, &numbers, "PAUSE", Some("BASE_PAUSE"))?;
        Ok(lines.into_iter().map(|(_, line)| line).collect())
    }

    #[test]
    fn words_of_the_call_and_constants_are_taken() {
        let value = "{% set BED = params.BED_TEMP|default(60)|float %}\n{% set T = params.TOOL %}\n\
                     {% set SPEED = 600 %}\nM140 S{BED}\nM109 S{ T|int }\nG1 Z5 F{SPEED}\n\
                     M104 S{params.S|default(\"150\")|int}\nRESPOND MSG=\"hi there\"\nBASE_PAUSE X=1";
        let expected =
            ["M140 S{BED_TEMP:60}", "M109 S{TOOL}", "G1 Z5 F600", "M104 S{S:150}", "M118 E1 hi there", "PAUSE X=1"];
        assert_eq!(of(value).unwrap(), expected);
    }

    #[test]
    fn a_line_that_needs_a_person_is_named() {
        for (value, line, why) in [
            ("G28\n{% if printer.x %}\nG1 X5\n{% endif %}", 2, "{% if printer.x %} is a condition or a loop"),
            ("G1 X{params.X|float * 2}", 1, "{params.X|float * 2} is computed"),
            ("G1 X{printer.toolhead.position.x}", 1, "{printer.toolhead.position.x} is computed"),
            ("M117 a\nG1 Z5 {% if x %} F5{% endif %}", 2, "G1 Z5 {% if x %} F5{% endif %}: a condition or a loop"),
            ("{% set Z = printer.z + 5 %}", 1, "{printer.z + 5} is computed"),
        ] {
            assert_eq!(of(value), Err((line, why.to_owned())), "{value}");
        }
    }
}
