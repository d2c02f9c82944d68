//! Scripts of the laboratory's pages; the frame and the style are the report's ([`corehbot_report::twin::fill`]).

/// The page of a comparison of machines.
pub const COMPARE: &str = include_str!("compare.js");

/// The page of a study.
pub const STUDY: &str = include_str!("study.js");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_need_no_network() {
        for script in [COMPARE, STUDY] {
            assert!(!["http://", "https://", "fetch(", "</script", "<!--"].iter().any(|word| script.contains(word)));
        }
    }
}
