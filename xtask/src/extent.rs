//! How much of a long test runs: a part that finds the same, or all of it by `cargo xtask test --all`.

/// All of it runs where this variable is set. Tests read it too (`tests/support/extent.rs`).
pub const ALL: &str = "COREHBOT_ALL";

/// Whether all of it runs.
pub fn is_all() -> bool {
    std::env::var_os(ALL).is_some()
}
