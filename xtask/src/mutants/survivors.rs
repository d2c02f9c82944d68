//! Survivors: mutants that no test notices, and the reasons.

use anyhow::{Context as _, Result};

/// One survivor a line: file, change, and reason, with tabs in between.
const LIST: &str = include_str!("survivors.tsv");

/// Survivors that are known.
pub struct Survivors(Vec<[&'static str; 3]>);

impl Survivors {
    /// The list next to this file.
    pub fn known() -> Result<Self> {
        Self::read(LIST)
    }

    fn read(list: &'static str) -> Result<Self> {
        let row = |line: &'static str| {
            let parts: Vec<_> = line.split('\t').filter(|part| !part.is_empty()).collect();
            <[&str; 3]>::try_from(parts).ok().with_context(|| format!("no file, change and reason: {line}"))
        };
        Ok(Self(list.lines().filter(|line| !line.starts_with('#')).map(row).collect::<Result<_>>()?))
    }

    /// Why a mutant (`file:line:column: change`) survives, if that is known. Lines move, so they do not count.
    pub fn reason(&self, mutant: &str) -> Option<&'static str> {
        let (place, change) = mutant.split_once(": ")?;
        let file = place.split(':').next()?;
        self.0.iter().find(|[a, b, _]| *a == file && *b == change).map(|[.., reason]| *reason)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkout::root;

    #[test]
    fn a_survivor_is_known_wherever_it_moves() {
        let known = Survivors::read("# file, change, reason\nsrc/a/b.rs\treplace + with - in f\tthe same\n").unwrap();
        assert_eq!(known.reason("src/a/b.rs:12:3: replace + with - in f"), Some("the same"));
        assert_eq!(known.reason("src/a/b.rs:12:3: replace + with * in f"), None);
        assert!(Survivors::read("src/a/b.rs\treplace + with -\n").is_err());
        let known = Survivors::known().unwrap().0;
        assert!(known.iter().all(|[file, ..]| root().join(file).is_file()));
    }
}
