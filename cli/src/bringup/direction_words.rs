//! Ways: where a tool goes, in the words of its owner.

use super::wiring::Way;

/// What an owner has seen.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Seen {
    Way(Way),
    Unsure,
    /// The board did not move: its words.
    Refused(String),
}

/// Every word, its axis and its sign. Apart is the nozzle from the bed.
const WORDS: [(&str, usize, i8); 6] =
    [("right", 0, 1), ("left", 0, -1), ("back", 1, 1), ("front", 1, -1), ("apart", 2, 1), ("closer", 2, -1)];

/// A way in words; no word is nothing.
pub(super) fn words(way: Way) -> String {
    let words: Vec<_> = WORDS.iter().filter(|(_, axis, sign)| way[*axis] == *sign).map(|(word, ..)| *word).collect();
    if words.is_empty() { "nothing".to_owned() } else { words.join(" ") }
}

/// Words, or their first letters: `right back`, `rb`.
pub(super) fn read_seen(answer: &str) -> Option<Seen> {
    match answer {
        "?" => return Some(Seen::Unsure),
        "nothing" | "n" => return Some(Seen::Way([0; 3])),
        _ => {}
    }
    let split = |c: char| !c.is_ascii_alphabetic();
    let parts: Vec<&str> = answer.split(split).filter(|part| !part.is_empty() && *part != "and").collect();
    let mut way = [0; 3];
    let mut take = |known: &dyn Fn(&str) -> bool| {
        let (_, axis, sign) = WORDS.iter().find(|(word, ..)| known(word))?;
        let is_fresh = way[*axis] == 0;
        way[*axis] = *sign;
        is_fresh.then_some(())
    };
    for part in &parts {
        if WORDS.iter().any(|(word, ..)| word == part) {
            take(&|word| word == *part)?;
        } else {
            part.chars().try_for_each(|letter| take(&|word| word.starts_with(letter)))?;
        }
    }
    (!parts.is_empty()).then_some(Seen::Way(way))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_are_read_in_words_and_letters() {
        for (answer, way) in [
            ("right", [1, 0, 0]),
            ("right back", [1, 1, 0]),
            ("lf", [-1, -1, 0]),
            ("left and front", [-1, -1, 0]),
            ("a", [0, 0, 1]),
            ("closer", [0, 0, -1]),
            ("nothing", [0, 0, 0]),
        ] {
            assert_eq!(read_seen(answer), Some(Seen::Way(way)), "{answer}");
            assert_eq!(read_seen(&words(way)), Some(Seen::Way(way)), "{answer}");
        }
        assert_eq!(read_seen("?"), Some(Seen::Unsure));
        for bad in ["", "up", "right left", "rl", "x", "12"] {
            assert_eq!(read_seen(bad), None, "{bad}");
        }
    }
}
