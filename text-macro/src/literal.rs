//! Literals of strings: the text of one in the source, and the parts of a template.

use crate::code::Packer;

/// The text of a literal as the source has it, with quotes. None if it is no literal of a string.
pub fn text_of(source: &str) -> Option<String> {
    if let Some(raw) = source.strip_prefix('r') {
        return Some(raw.trim_matches('#').strip_prefix('"')?.strip_suffix('"')?.to_owned());
    }
    let mut rest = source.strip_prefix('"')?.strip_suffix('"')?.chars();
    let mut text = String::new();
    while let Some(character) = rest.next() {
        if character != '\\' {
            text.push(character);
            continue;
        }
        match rest.next()? {
            'n' => text.push('\n'),
            't' => text.push('\t'),
            '\n' => rest = rest.as_str().trim_start().chars(),
            same @ ('"' | '\'' | '\\') => text.push(same),
            _ => return None,
        }
    }
    Some(text)
}

/// The parts of a template, and whether each is a place for a value.
pub fn parts(template: &str) -> Vec<(&str, bool)> {
    let (mut parts, mut rest) = (Vec::new(), template);
    while let Some(open) = rest.find('{') {
        let (before, place) = rest.split_at(open);
        if let Some(after) = place.strip_prefix("{{") {
            // A brace of the text.
            parts.extend([(before, false), ("{{", true)]);
            rest = after;
        } else {
            let end = place.find('}').map_or(place.len(), |end| end + 1);
            parts.extend([(before, false), (&place[..end], true)]);
            rest = &place[end..];
        }
    }
    parts.push((rest, false));
    parts.retain(|(part, _)| !part.is_empty());
    parts
}

/// A packed template: places for values stay.
pub fn pack_template(template: &str, packer: &Packer<'_>) -> String {
    let pack = |(part, is_place): (&str, bool)| if is_place { part.to_owned() } else { packer.pack(part) };
    parts(template).into_iter().map(pack).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_literal_is_its_text() {
        assert_eq!(text_of(r#""a \"b\" \\ c\n""#).unwrap(), "a \"b\" \\ c\n");
        assert_eq!(text_of("\"one \\\n      line\"").unwrap(), "one line");
        assert_eq!(text_of("r#\"a\\\"#").unwrap(), "a\\");
        assert_eq!(text_of("b\"bytes\""), None);
    }

    #[test]
    fn places_are_told_from_text() {
        let all = [("at ", false), ("{x:.3}", true), (" ", false), ("{{", true), ("}}", false), ("{}", true)];
        assert_eq!(parts("at {x:.3} {{}}{}"), all);
    }
}
