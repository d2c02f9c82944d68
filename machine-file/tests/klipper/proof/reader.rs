//! The other reader: lines to sections and keys, in the few forms that are made here.

use std::collections::BTreeMap;

/// A configuration.
pub(super) struct Read {
    pub sections: BTreeMap<String, BTreeMap<String, String>>,
}

impl Read {
    pub fn of(text: &str) -> Self {
        let mut sections: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
        let (mut section, mut key) = (String::new(), String::new());
        for line in text.lines() {
            if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
                section = name.to_owned();
                sections.entry(section.clone()).or_default();
            } else if line.starts_with("  ") {
                let value = sections.get_mut(&section).unwrap().get_mut(&key).unwrap();
                *value = format!("{value}\n{}", line.trim());
            } else if let Some((name, value)) = line.split_once(": ") {
                key = name.to_owned();
                sections.get_mut(&section).unwrap().insert(key.clone(), value.to_owned());
            }
        }
        Self { sections }
    }

    pub fn has(&self, section: &str) -> bool {
        self.sections.contains_key(section)
    }

    pub fn text(&self, section: &str, key: &str) -> Option<&str> {
        self.sections.get(section)?.get(key).map(String::as_str)
    }

    pub fn number(&self, section: &str, key: &str) -> Option<f64> {
        self.text(section, key)?.parse().ok()
    }

    /// A number, or Klipper's default.
    pub fn or(&self, section: &str, key: &str, default: f64) -> f64 {
        self.number(section, key).unwrap_or(default)
    }

    /// Pairs of numbers, one on each line.
    pub fn pairs(&self, section: &str, key: &str) -> Vec<[f64; 2]> {
        let pair = |line: &str| {
            let (x, y) = line.split_once(',').unwrap();
            [x.trim().parse().unwrap(), y.trim().parse().unwrap()]
        };
        self.text(section, key).map(|text| text.lines().map(pair).collect()).unwrap_or_default()
    }
}
