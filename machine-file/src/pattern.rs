//! Patterns of names, as in a shell: `*`, `?` and `[a-z]`.

/// Whether a name is a pattern, which may mean no file at all.
#[must_use]
pub fn is_pattern(name: &str) -> bool {
    name.contains(['*', '?', '['])
}

/// Whether a pattern means the name. As in a shell, a leading point has to be said.
#[must_use]
pub fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    if name.first() == Some(&'.') && pattern.first() != Some(&'.') {
        return false;
    }
    // The last star that was passed, and the place in the name up to which it reaches.
    let (mut p, mut n, mut star) = (0, 0, None);
    while let Some(letter) = name.get(n) {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
                continue;
            }
            Some(_) => {
                if let Some(length) = one(&pattern[p..], *letter) {
                    p += length;
                    n += 1;
                    continue;
                }
            }
            None => {}
        }
        let Some((at, reach)) = star else { return false };
        star = Some((at, reach + 1));
        (p, n) = (at + 1, reach + 1);
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// The length of the pattern's first part if it means that letter.
fn one(pattern: &[char], letter: char) -> Option<usize> {
    match pattern {
        ['?', ..] => Some(1),
        ['[', rest @ ..] => {
            let is_not = matches!(rest, ['!', ..]);
            let start = usize::from(is_not);
            // A bracket right at the beginning is one of the letters.
            let length = rest.iter().skip(start + 1).position(|c| *c == ']')? + 1;
            let letters = rest.get(start..start + length)?;
            let mut is_in = false;
            let mut at = 0;
            while let Some(from) = letters.get(at) {
                let to = letters.get(at + 2).filter(|_| letters.get(at + 1) == Some(&'-'));
                is_in |= (*from..=*to.unwrap_or(from)).contains(&letter);
                at += if to.is_some() { 3 } else { 1 };
            }
            (is_in != is_not).then_some(2 + start + length)
        }
        [c, ..] => (*c == letter).then_some(1),
        [] => None,
    }
}

/// A name that a pattern means.
#[cfg(test)]
pub(crate) fn sample(pattern: &str) -> String {
    let (mut name, mut letters) = (String::new(), pattern.chars());
    while let Some(letter) = letters.next() {
        match letter {
            '*' | '?' => name.push('x'),
            '[' => {
                name.extend(letters.next());
                letters.by_ref().find(|letter| *letter == ']');
            }
            letter => name.push(letter),
        }
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn patterns_mean_what_a_shell_means() {
        for (pattern, name, is_meant) in [
            ("*.cfg", "a.cfg", true),
            ("*.cfg", ".a.cfg", false),
            (".*", ".a.cfg", true),
            ("*.cfg", "a.cfg.bak", false),
            ("a*b*c", "aXbXbc", true),
            ("a*b*c", "acb", false),
            ("?.cfg", "ab.cfg", false),
            ("[a-c]?.cfg", "bx.cfg", true),
            ("[!a-c].cfg", "b.cfg", false),
            ("[]x].cfg", "].cfg", true),
            ("[", "[", false),
            ("", "", true),
            ("**", "", true),
        ] {
            assert_eq!(matches(pattern, name), is_meant, "{pattern} {name}");
        }
    }

    proptest! {
        #[test]
        fn any_pattern_is_tried_to_its_end(pattern in r"[*?\[\]!a-c.-]{0,12}", name in "[a-c.]{0,12}") {
            let _ = matches(&pattern, &name);
            prop_assert!(name.starts_with('.') || matches("*", &name));
            prop_assert!(is_pattern(&name) || matches(&name, &name));
        }
    }
}
